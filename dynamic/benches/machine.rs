//! What machine code costs next to what the macro makes: `cargo bench -p coadjoint-dynamic --features jit --bench machine`. From the text to the end
//! of the first step, a step in a run, the same in C by `gcc -O3`, a step by itself, and a step of a member of an ensemble; all variants in turns,
//! of each the least of many rounds, on one thread. `-- ensembles` after it measures these alone.
#![allow(clippy::unwrap_used, missing_docs, reason = "items are the macro's")]
#![allow(unsafe_code, reason = "what a C compiler made is called")]

use std::ffi::{CString, c_char, c_int, c_ulong, c_void};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use coadjoint::erased::{self, Ensemble, EnsembleSystem, System};
use coadjoint::prelude::*;
use coadjoint_codegen::emit::c99::{Options, Steps as Kernel};
use coadjoint_codegen::source::Source;
use coadjoint_dynamic::Model;

/// Items, and their text.
macro_rules! described {
    ($($text:ident: { $($tokens:tt)* })*) => { $(
        $($tokens)*
        const $text: &str = stringify!($($tokens)*);
    )* };
}

described! {
    HEAVY_TOP: {
        #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
        #[derive(Clone)]
        struct HeavyTop {
            #[inertia]
            inertia: Vector3<f64>,
            weight: f64,
            chi: Vector3<f64>,
        }
    }
    QUADROTOR: {
        #[lie_poisson_system(
            group(attitude: SO3, position: R3),
            control(moment: R3, thrust: f64),
            potential = mass * gravity * position.z,
            force(attitude = moment, position = attitude * (thrust * Vector3::z())),
        )]
        #[derive(Clone)]
        struct Quadrotor {
            #[inertia(attitude)]
            inertia: Vector3<f64>,
            #[inertia(position)]
            mass: f64,
            gravity: f64,
        }
    }
    COUPLED_BODIES: {
        #[lie_poisson_system(
            group(first: SO3, second: SO3),
            potential = {
                let between = first.inverse() * second;
                2.0 * stiffness * (1.0 - between.w.powi(2))
            },
        )]
        #[derive(Clone)]
        struct CoupledBodies {
            #[inertia(first)]
            first_inertia: Vector3<f64>,
            #[inertia(second)]
            second_inertia: Vector3<f64>,
            stiffness: f64,
        }
    }
    DOUBLE_PENDULUM: {
        #[lie_poisson_system(
            group(first: SO2, second: SO2),
            lagrangian = {
                let (upper, lower) = (first_velocity.x, second_velocity.x);
                let between = first.inverse() * second;
                let kinetic = (upper_mass + lower_mass) * upper_length.powi(2) * upper.powi(2) / 2.0
                    + lower_mass * lower_length.powi(2) * lower.powi(2) / 2.0
                    + lower_mass * upper_length * lower_length * upper * lower * between.cos_angle();
                let potential = -(upper_mass + lower_mass) * gravity * upper_length * first.cos_angle()
                    - lower_mass * gravity * lower_length * second.cos_angle();
                kinetic - potential
            },
        )]
        #[derive(Clone)]
        struct DoublePendulum {
            upper_mass: f64,
            lower_mass: f64,
            upper_length: f64,
            lower_length: f64,
            gravity: f64,
        }
    }
    NAVIGATION: {
        #[lie_poisson_system(
            group = SE2(3),
            control(gyroscope: R3, accelerometer: R3),
            hamiltonian = {
                let attitude = element.fixed_view::<3, 3>(0, 0);
                let velocity = element.fixed_view::<3, 1>(0, 3);
                let of_attitude = momentum.fixed_rows::<3>(0);
                let of_velocity = momentum.fixed_rows::<3>(3);
                let of_position = momentum.fixed_rows::<3>(6);
                let dead_reckoning = of_attitude.dot(&gyroscope)
                    + of_velocity.dot(&(accelerometer + attitude.tr_mul(&gravity)))
                    + of_position.dot(&attitude.tr_mul(&velocity));
                dead_reckoning + gyroscope_noise / 2.0 * of_attitude.norm_squared()
                    + accelerometer_noise / 2.0 * of_velocity.norm_squared()
            },
            retractions(Cayley),
        )]
        #[derive(Clone)]
        struct Navigation {
            gravity: Vector3<f64>,
            gyroscope_noise: f64,
            accelerometer_noise: f64,
        }
    }
}

/// Steps that are taken by one of the variants: so many.
type Steps<'a> = Box<dyn FnMut(u64) + 'a>;

/// So few that mostly nothing comes between on a machine that others use too.
const STEPS: u64 = 500;
const ROUNDS: usize = 2_000;

/// Members of an ensemble, and as many steps at a time.
const MEMBERS: u64 = 64;
const TOGETHER: u64 = 50;

/// The least time of a step of each variant, ns, in turns: of so many rounds, and so many steps in each.
fn each(mut variants: Vec<Steps<'_>>, rounds: usize, count: u64) -> Vec<f64> {
    variants.iter_mut().for_each(|steps| steps(2 * count));
    let mut least = vec![f64::INFINITY; variants.len()];
    for _ in 0..rounds {
        for (least, steps) in least.iter_mut().zip(&mut variants) {
            let start = Instant::now();
            steps(count);
            *least = least.min(1e9 * start.elapsed().as_secs_f64() / count as f64);
        }
    }
    least
}

/// Steps of an ensemble of states near to this one.
fn ensemble_steps<'a>(
    system: &dyn EnsembleSystem,
    scheme: &str,
    step: f64,
    state: &[f64],
    control: &[f64],
) -> Steps<'a> {
    let parameters = system.parameters();
    let members = (0..MEMBERS).map(|member| {
        let mut state = state.to_vec();
        if let Some(last) = state.last_mut() {
            *last += 1e-5 * member as f64;
        }
        (parameters.clone(), state)
    });
    let mut ensemble = Ensemble::new(system, &scheme.parse().unwrap(), members, step).unwrap();
    ensemble.control(|_, _, to| to.copy_from_slice(control));
    Box::new(move |count| assert_eq!(ensemble.run(count), MEMBERS * count))
}

/// Steps of a system from a text, in runs or one by one.
fn erased_steps<'a>(
    system: Arc<dyn System>,
    scheme: &str,
    step: f64,
    state: &[f64],
    control: &'a [f64],
    is_run: bool,
) -> Steps<'a> {
    let mut stepper = erased::Stepper::new(system, &scheme.parse().unwrap(), step).unwrap();
    let mut state = state.to_vec();
    Box::new(move |count| {
        if is_run {
            stepper.steps(&mut state, control, count).unwrap();
        } else {
            (0..count).for_each(|_| _ = stepper.step(&mut state, control).unwrap());
        }
    })
}

unsafe extern "C" {
    fn dlopen(file: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// What is compiled around a header.
const AROUND: &str = "#include \"system.h\"
static NAME_parameters parameters;
static NAME_state state;
static NAME_stepper stepper;
CONTROL
int start(const double *numbers, const double *from, const double *controls, double step)
{
    (void)controls;
    NAME_parameters_from(&parameters, numbers);
    NAME_state_from(&state, from);
    TAKE
    return NAME_init(&stepper, &parameters, step);
}
int steps(unsigned long count)
{
    unsigned long taken;
    return NAME_steps(&stepper, &state, HELD count, &taken);
}
";

/// Steps of a description's header in C, from these numbers on; none, and a line, where there is no `gcc`.
fn c_steps<'a>(
    text: &str,
    scheme: &str,
    [parameters, state, control]: [&[f64]; 3],
    step: f64,
) -> Option<Steps<'a>> {
    let source = Source::find(text.parse().unwrap());
    let described = source.described().iter().next().unwrap();
    let options = Options { steps: vec![Kernel::of(scheme)], ..Options::default() };
    let header =
        coadjoint_codegen::c99(described.attribute.clone(), described.item.clone(), &options).unwrap();
    let declared = header.lines().find(|line| line.starts_with("typedef ") && line.ends_with("_real;"));
    let name = declared.and_then(|line| line.rsplit(' ').next()?.strip_suffix("_real;")).unwrap();
    let [kept, take, held] = match control {
        [] => [""; 3],
        _ => ["static NAME_control control;", "NAME_control_from(&control, controls);", "&control,"],
    };
    let around = AROUND.replace("CONTROL", kept).replace("TAKE", take).replace("HELD", held);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{scheme}"));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("system.h"), &header).unwrap();
    std::fs::write(folder.join("steps.c"), around.replace("NAME", name)).unwrap();
    let flags =
        ["-O3", "-std=c99", "-ffp-contract=off", "-shared", "-fPIC", "steps.c", "-o", "steps.so", "-lm"];
    let compiled = Command::new("gcc").args(flags).current_dir(&folder).output();
    if !compiled.is_ok_and(|compiled| compiled.status.success()) {
        println!("SKIPPED: there is no gcc, so that steps in C are not measured");
        return None;
    }
    let file = CString::new(folder.join("steps.so").to_str().unwrap()).unwrap();
    // SAFETY: a library that was just made, whose functions have these types
    let (start, steps) = unsafe {
        let library = dlopen(file.as_ptr(), 2);
        assert!(!library.is_null(), "{file:?}");
        (
            std::mem::transmute::<
                *mut c_void,
                unsafe extern "C" fn(*const f64, *const f64, *const f64, f64) -> c_int,
            >(dlsym(library, c"start".as_ptr())),
            std::mem::transmute::<*mut c_void, unsafe extern "C" fn(c_ulong) -> c_int>(dlsym(
                library,
                c"steps".as_ptr(),
            )),
        )
    };
    // SAFETY: as many numbers as the description says; its library is never closed
    assert_eq!(unsafe { start(parameters.as_ptr(), state.as_ptr(), control.as_ptr(), step) }, 0);
    // SAFETY: as above
    Some(Box::new(move |count| assert_eq!(unsafe { steps(count) }, 0)))
}

macro_rules! case {
    // what is compiled for registers of each width takes long, for all systems
    (@ensembles compiled, $ensemble:expr) => { Some($ensemble) };
    (@ensembles text, $ensemble:expr) => { None::<Steps<'_>> };
    ($text:ident, $system:expr, $state:expr, $control:expr, $step:literal, $($scheme:ident)*; $has_ensembles:ident) => {{
        let (system, state, control) = ($system, $state, $control);
        let numbers = state.to_components().as_ref().to_vec();
        let held = control.to_components().as_ref().to_vec();
        let typed: Arc<dyn System> = Arc::new(system.clone());
        let parameters = typed.parameters();
        let name = typed.description().name;
        let first = [$(stringify!($scheme)),*][0].parse().unwrap();
        let has_all = !std::env::args().any(|argument| argument == "ensembles");
        let to_first = (0..30).map(|_| {
            let start = Instant::now();
            let model = Model::from_text($text).unwrap();
            let mut stepper = erased::Stepper::new(Arc::new(model.system(&parameters)), &first, $step).unwrap();
            stepper.step(&mut numbers.clone(), &held).unwrap();
            start.elapsed().as_secs_f64()
        });
        if has_all {
            println!("{name}: text to first step {:.1} ms", 1e3 * to_first.fold(f64::INFINITY, f64::min));
        }
        let model = Model::from_text($text).unwrap();
        $({
            let ensemble = |system: &dyn EnsembleSystem| {
                ensemble_steps(system, stringify!($scheme), $step, &numbers, &held)
            };
            let mut variants = vec![
                ensemble(&model.system(&parameters)),
                ensemble(&model.interpreted().system(&parameters)),
            ];
            variants.extend(case!(@ensembles $has_ensembles, ensemble(&system)));
            let least = each(variants, ROUNDS, TOGETHER).iter().map(|x| x / MEMBERS as f64).collect::<Vec<_>>();
            println!(
                "{name}, {}: a member of an ensemble by machine code {:.1} ns, interpreted {:.1}, compiled {}",
                stringify!($scheme), least[0], least[1], least.get(2).map_or_else(|| "not".to_owned(), |x| format!("{x:.1} ns")),
            );
        })*
        $(if has_all {
            let mut run = system.stepper::<$scheme>($step).unwrap();
            let mut one = run.clone();
            let [mut at, mut from] = [state.clone(), state.clone()];
            let steps = |model: &Model, is_run| {
                let system = Arc::new(model.system(&parameters));
                erased_steps(system, stringify!($scheme), $step, &numbers, &held, is_run)
            };
            let mut variants: Vec<Steps<'_>> = vec![
                Box::new(|count| _ = run.steps_with(&mut at, &control, count).unwrap()),
                steps(&model, true),
                steps(&model.interpreted(), true),
                Box::new(|count| (0..count).for_each(|_| _ = one.step_with(&mut from, &control).unwrap())),
                steps(&model, false),
            ];
            variants.extend(c_steps($text, stringify!($scheme), [&parameters, &numbers, &held], $step));
            let least = each(variants, ROUNDS, STEPS);
            let c = least.get(5).copied().unwrap_or(f64::NAN);
            println!(
                "{name}, {}: in runs {:.1} ns, machine code {:.1} ({:.2}), C {:.1} ({:.2}), interpreted {:.0}; by itself {:.1} ns, machine code {:.1} ({:.2})",
                stringify!($scheme), least[0], least[1], least[1] / least[0], c, c / least[0], least[2], least[3], least[4], least[4] / least[3],
            );
        })*
    }};
}

fn main() {
    case!(
        HEAVY_TOP,
        HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() },
        HeavyTopState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0], gamma: Vector3::z() },
        NoControl::default(),
        0.01,
        Exponential Cayley; compiled
    );
    let quadrotor = Quadrotor { inertia: vector![0.082, 0.0845, 0.1377], mass: 4.34, gravity: 9.81 };
    case!(
        QUADROTOR,
        quadrotor.clone(),
        QuadrotorState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: vector![0.004, 0.002, 0.05],
            position: Vector3::z(),
            position_momentum: Vector3::zeros(),
        },
        QuadrotorControl { moment: Vector3::zeros(), thrust: quadrotor.mass * quadrotor.gravity },
        0.01,
        Exponential Cayley; text
    );
    case!(
        COUPLED_BODIES,
        CoupledBodies {
            first_inertia: vector![2.0, 3.0, 4.0],
            second_inertia: vector![1.5, 1.0, 0.8],
            stiffness: 2.0,
        },
        CoupledBodiesState {
            first: UnitQuaternion::identity(),
            first_momentum: vector![0.5, 2.0, 1.0],
            second: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.0),
            second_momentum: vector![-0.3, 0.2, 0.6],
        },
        NoControl::default(),
        0.01,
        Exponential Cayley; text
    );
    case!(
        DOUBLE_PENDULUM,
        DoublePendulum { upper_mass: 1.0, lower_mass: 1.0, upper_length: 1.0, lower_length: 1.0, gravity: 9.81 },
        DoublePendulumState {
            first: UnitComplex::new(100_f64.to_radians()),
            first_momentum: vector![0.0],
            second: UnitComplex::new(150_f64.to_radians()),
            second_momentum: vector![0.0],
        },
        NoControl::default(),
        0.005,
        Exponential Cayley; text
    );
    let mut element = SMatrix::<f64, 5, 5>::identity();
    element[(0, 3)] = 20.0;
    let of_attitude = [327.189_357_188, 189.388_918_394, 22.746_393_720_3];
    let of_velocity = [-0.428_688_131_187, -1.130_231_485_51, 15.576_777_440_6];
    let of_position = [-0.007_144_802_189_44, -0.018_837_191_432_6, 0.259_612_957_343];
    let momentum = SVector::from_iterator([of_attitude, of_velocity, of_position].concat());
    case!(
        NAVIGATION,
        Navigation { gravity: vector![0.0, 0.0, -9.81], gyroscope_noise: 3e-6, accelerometer_noise: 1e-4 },
        NavigationState { element, momentum },
        NavigationControl { gyroscope: vector![0.0, 0.0, 0.1], accelerometer: vector![0.0, 2.0, 9.81] },
        0.05,
        Cayley; text
    );
}
