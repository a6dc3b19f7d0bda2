//! Headers for C, compiled and held against Rust: states and iterations are the same to the last bit, step by step and many at once.
//!
//! A binary of its own, for it needs a C compiler: where there is none, each test says loudly that it was skipped.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, LazyLock};

use coadjoint::composition::{Coefficients as _, Suzuki4};
use coadjoint::erased;
use coadjoint::prelude::*;
use coadjoint::{Scheme, StepError, System};
use coadjoint_app::Entry;
use coadjoint_codegen::emit::c99::{Options, Steps};
use coadjoint_codegen::quantity::ScalarType;
use coadjoint_systems::catalogue::CATALOGUE;
use proc_macro2::TokenStream;
use quote::ToTokens;

/// Steps that are taken with each scheme, and after how many a state is looked at.
const STEPS: u64 = 10_000;
const EVERY: u64 = 1_000;

/// The C compiler, if there is one. Loud where there is none.
fn compiler() -> Option<&'static str> {
    static FOUND: LazyLock<Option<&str>> = LazyLock::new(|| {
        let is_there = |name: &&str| {
            let version =
                Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            version.is_ok_and(|status| status.success())
        };
        ["cc", "gcc", "clang"].into_iter().find(|name| is_there(name))
    });
    if FOUND.is_none() {
        println!("SKIPPED: there is no C compiler, so that headers were not held against Rust");
    }
    *FOUND
}

/// Whether Rust multiplies and adds with one rounding, which no flag makes a C compiler do in the same places.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

/// The attribute and the struct of this name in a text.
fn description(text: &str, name: &str) -> (TokenStream, TokenStream) {
    let file = syn::parse_file(text).expect("a source");
    let described = file.items.into_iter().find_map(|item| match item {
        syn::Item::Struct(mut item) if item.ident == name => {
            let is_ours = |attribute: &syn::Attribute| attribute.path().is_ident("lie_poisson_system");
            let place = item.attrs.iter().position(is_ours)?;
            let syn::Meta::List(list) = item.attrs.remove(place).meta else { return None };
            Some((list.tokens, item.into_token_stream()))
        }
        _ => None,
    });
    described.expect("a description")
}

/// A directory of its own for a test.
fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("c99-{name}-{}", std::process::id()));
    fs::create_dir_all(&path).expect("a writable target directory");
    path
}

/// Writes a header and a program beside it, compiles it without a warning, runs it, and gives what it printed.
fn run(name: &str, header: &str, main: &str) -> String {
    let path = directory(name);
    fs::write(path.join("system.h"), header).expect("written");
    fs::write(path.join("main.c"), main).expect("written");
    let compiler = compiler().expect("looked for before");
    let flags = [
        "-std=c99",
        "-O2",
        "-ffp-contract=off",
        "-Wall",
        "-Wextra",
        "-Wconversion",
        "-pedantic",
        "-Werror",
        "-o",
        "main",
        "main.c",
        "-lm",
    ];
    let compiled = Command::new(compiler).args(flags).current_dir(&path).output().expect("a compiler");
    assert!(compiled.status.success(), "{name}: {}", String::from_utf8_lossy(&compiled.stderr));
    // a header is one for C++ too, if there is a compiler
    fs::write(path.join("main.cc"), "#include \"system.h\"\nint used();\nint used() { return 0; }\n")
        .expect("written");
    let flags = ["-std=c++11", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fsyntax-only", "main.cc"];
    if let Ok(compiled) = Command::new("c++").args(flags).current_dir(&path).output() {
        assert!(compiled.status.success(), "{name}: {}", String::from_utf8_lossy(&compiled.stderr));
    }
    let output = Command::new(path.join("main")).output().expect("it runs");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
    fs::remove_dir_all(&path).expect("removed");
    String::from_utf8(output.stdout).expect("text")
}

/// What is held against Rust.
struct Case {
    /// The system's prefix in C, and the numbers of its parameters, state and controls.
    prefix: String,
    parameters: Vec<f64>,
    state: Vec<f64>,
    control: Vec<f64>,
    step: f64,
}

impl Case {
    /// A program that takes steps with each stepper, and prints states as numbers that are read back to the last bit, and iterations.
    fn program(&self, header: &str, steppers: &[String]) -> String {
        let p = &self.prefix;
        let list =
            |numbers: &[f64]| numbers.iter().map(|x| format!("(real){x:?}")).collect::<Vec<_>>().join(", ");
        let has = |function: &str, argument: &str| {
            let line =
                header.lines().find(|line| line.contains(&format!(" {function}("))).unwrap_or_default();
            line.contains(argument)
        };
        let mut code = format!(
            "#include \"system.h\"\n#include <stdio.h>\n\ntypedef {p}_real real;\n\nstatic int show(const {p}_state *x, int iterations)\n{{\n"
        );
        let n = self.state.len();
        _ = writeln!(
            code,
            "    real numbers[{n}];\n    int i;\n    {p}_state_to(numbers, x);\n    for (i = 0; i < {n}; i++)\n        printf(\"%.17g \", (double)numbers[i]);\n    printf(\"%d\\n\", iterations);\n    return 0;\n}}\n\nint main(void)\n{{"
        );
        for (name, numbers) in
            [("parameters", &self.parameters), ("state", &self.state), ("control", &self.control)]
        {
            if !numbers.is_empty() {
                _ = writeln!(
                    code,
                    "    const real {name}_numbers[{}] = {{ {} }};\n    {p}_{name} {name};",
                    numbers.len(),
                    list(numbers)
                );
            }
        }
        let (parameters, control) = (!self.parameters.is_empty(), !self.control.is_empty());
        if !parameters {
            _ = writeln!(code, "    {p}_parameters parameters = {{ 0 }};");
        }
        _ = writeln!(code, "    const double h = {:?};\n    unsigned long k, taken;", self.step);
        if parameters {
            _ = writeln!(code, "    {p}_parameters_from(&parameters, parameters_numbers);");
        }
        if control {
            _ = writeln!(code, "    {p}_control_from(&control, control_numbers);");
        }
        let energy = format!("{p}_energy");
        let time = |function: &str, given: &str| {
            if has(function, "real time") { format!(", {given}") } else { String::new() }
        };
        let held = if control { ", &control" } else { "" };
        for stepper in steppers {
            let (step, steps) = (format!("{stepper}_step"), format!("{stepper}_steps"));
            let (at, from) = (time(&step, "(real)((double)k * h)"), time(&steps, "(real)0"));
            let energy_held = if has(&energy, "_control *control") { held } else { "" };
            let energy_at = time(&energy, "(real)0");
            _ = write!(
                code,
                "    {{\n        static {stepper}_stepper stepper;\n        int iterations = 0;\n        \
                 {p}_state_from(&state, state_numbers);\n        \
                 if ({stepper}_init(&stepper, &parameters, (real)h))\n            return 1;\n        \
                 printf(\"%.17g\\n\", (double){energy}(&parameters, &state{energy_at}{energy_held}));\n        \
                 for (k = 0; k < {STEPS}; k++) {{\n            if ({step}(&stepper, &state{at}{held}))\n                return 2;\n            \
                 iterations += {stepper}_iterations(&stepper);\n            if ((k + 1) % {EVERY} == 0)\n                show(&state, iterations);\n        }}\n        \
                 {p}_state_from(&state, state_numbers);\n        if ({stepper}_init(&stepper, &parameters, (real)h))\n            return 1;\n        \
                 if ({steps}(&stepper, &state{from}{held}, {STEPS}, &taken) || taken != {STEPS})\n            return 3;\n        show(&state, 0);\n    }}\n"
            );
        }
        code + "    return 0;\n}\n"
    }

    /// What the program prints, as Rust takes the steps.
    fn expected(&self, energy: f64, mut step: impl FnMut(&mut Vec<f64>) -> u32) -> Vec<Vec<f64>> {
        let (mut state, mut iterations) = (self.state.clone(), 0);
        let mut lines = vec![vec![energy]];
        for k in 1..=STEPS {
            iterations += step(&mut state);
            if k % EVERY == 0 {
                lines.push([&state[..], &[f64::from(iterations)]].concat());
            }
        }
        lines.push([&state[..], &[0.0]].concat());
        lines
    }
}

/// What a program has printed, against what it should: to the last bit.
fn compare(name: &str, printed: &str, expected: &[Vec<f64>]) {
    let numbers = |line: &str| {
        line.split_whitespace().map(|number| number.parse().expect("a number")).collect::<Vec<f64>>()
    };
    let lines: Vec<Vec<f64>> = printed.lines().map(numbers).collect();
    assert_eq!(lines.len(), expected.len(), "{name}");
    for (place, (line, expected)) in lines.iter().zip(expected).enumerate() {
        assert_eq!(line, expected, "{name}, line {place}");
    }
}

/// The schemes of a system: standard steps on all retractions, all others that it asks for on one, and a composition.
fn schemes(entry: &Entry) -> Vec<Scheme> {
    let system: Arc<dyn erased::System> = entry.system(&entry.example.parameters);
    let is_there = |text: &String| {
        let scheme: Scheme = text.parse().expect("a scheme");
        erased::Stepper::new(system.clone(), &scheme, entry.step).is_ok()
    };
    let retractions = ["Exponential", "Cayley", "SecondKind"].map(str::to_owned);
    let there: Vec<String> = retractions.into_iter().filter(is_there).collect();
    let one = if there.contains(&"Cayley".to_owned()) { "Cayley" } else { &there[0] };
    let others = [
        "StormerVerlet<R>",
        "SymplecticEulerB<R>",
        "Midpoint<R>",
        "Family<R, 1, 4>",
        "TangentLift<R>",
        "TangentMidpoint<R>",
        "HamiltonJacobi<R, 6>",
        "Order4<R>",
    ];
    let others: Vec<String> =
        others.iter().map(|name| name.replace("<R", &format!("<{one}"))).filter(is_there).collect();
    there.iter().chain(&others).map(|text| text.parse().expect("a scheme")).collect()
}

/// A scheme as a header's options name it.
fn steps(scheme: &Scheme) -> Steps {
    let text = scheme.to_string();
    match text.strip_prefix("Order4<").and_then(|text| text.strip_suffix('>')) {
        Some(base) => Steps { scheme: base.to_owned(), gamma: Suzuki4::GAMMA.to_vec() },
        None => Steps::of(text),
    }
}

/// All systems of the catalogue with all kinds of schemes that they have.
fn is_as_rust(name: &str) {
    let entry = CATALOGUE.find(name).expect("it is there");
    if compiler().is_none() {
        return;
    }
    if FUSED {
        println!("SKIPPED: Rust is built to multiply and add with one rounding");
        return;
    }
    let setup = &entry.example;
    let schemes = schemes(entry);
    let options = Options { steps: schemes.iter().map(steps).collect(), ..Options::default() };
    let (attribute, item) = description(entry.source, entry.description.name);
    let header = match coadjoint_codegen::c99(attribute, item, &options) {
        Ok(header) => header,
        // constants that Rust alone knows
        Err(error) if name == "affine_body" => return assert!(error.to_string().contains("PI"), "{error}"),
        Err(error) => panic!("{name}: {error}"),
    };
    let mut control = vec![0.0; setup.controls.len()];
    if let Some(law) = entry.law(setup) {
        law(&setup.state, 0.0, &mut control);
    }
    let case = Case {
        prefix: header_prefix(&header),
        parameters: setup.parameters.clone(),
        state: setup.state.clone(),
        control,
        step: entry.step,
    };
    let steppers = options.prefixes(entry.description.name);
    let printed = run(name, &header, &case.program(&header, &steppers));
    let system = entry.system(&setup.parameters);
    let energy = system.energy(&case.state, 0.0, &case.control);
    let mut expected = Vec::new();
    for scheme in &schemes {
        let mut stepper = erased::Stepper::new(system.clone(), scheme, case.step).expect("it is there");
        expected.extend(case.expected(energy, |state| {
            stepper
                .step(state, &case.control)
                .unwrap_or_else(|error| panic!("{name}, {scheme}: {error}"))
                .iterations
        }));
    }
    compare(name, &printed, &expected);
}

/// What all names of a header begin with.
fn header_prefix(header: &str) -> String {
    let line = header
        .lines()
        .find(|line| line.starts_with("typedef ") && line.ends_with("_real;"))
        .expect("numbers");
    line.rsplit(' ').next().and_then(|name| name.strip_suffix("_real;")).expect("a name").to_owned()
}

/// One test for each system, so that they run side by side.
macro_rules! systems {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                is_as_rust(stringify!($name));
            }
        )*

        #[test]
        fn no_system_is_left_out() {
            let is_system = |entry: &&Entry| entry.source.contains(&format!("struct {}", entry.description.name));
            let mut names: Vec<&str> = CATALOGUE.entries().iter().filter(is_system).map(|entry| entry.name.as_str()).collect();
            // further examples of a system that is there
            names.retain(|name| !["lagrange_top", "kovalevskaya_top", "hovering_quadrotor"].contains(name));
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}
systems! {
    harmonic_oscillator kepler two_bodies planar_pendulum double_pendulum driven_pendulum spherical_pendulum free_rigid_body full_rigid_body
    heavy_top heavy_top_on_se3 magnetic_top quadrotor rigid_body_in_space hanging_plate gyrostat satellite_with_wheels coupled_bodies kirchhoff
    ellipsoidal_fluid nuclear_spin spin_chain four_dimensional_body affine_body navigation three_level_atom
}

/// A system, and its text.
macro_rules! described {
    ($name:ident: $($tokens:tt)*) => {
        $($tokens)*

        const $name: &str = stringify!($($tokens)*);
    };
}

described! {
    SINGLE:
    /// A top in single precision.
    #[lie_poisson_system(
        group = SO3,
        advected(gamma: R3),
        potential = weight * gamma.dot(&chi),
        force = -drag * velocity.norm() * velocity,
        methods(Midpoint),
    )]
    struct SingleTop {
        #[inertia]
        inertia: Vector3<f32>,
        weight: f32,
        drag: f32,
        chi: Vector3<f32>,
    }
}

/// Numbers of 32 bits, at turns that are small and at turns that are large: what Stumpff functions compute there.
#[test]
fn single_precision_is_as_rust() {
    if compiler().is_none() || FUSED {
        return;
    }
    let (attribute, item) = description(SINGLE, "SingleTop");
    let names = ["Exponential", "Cayley", "Midpoint<Exponential>"];
    let options = Options { steps: names.into_iter().map(Steps::of).collect(), ..Options::default() };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    assert!(header.contains("typedef float "));
    let top =
        SingleTop { inertia: vector![1.0, 2.0, 3.5], weight: 0.7, drag: 0.0625, chi: vector![0.1, 0.2, 0.9] };
    for (spin, h) in [(1.5_f32, 0.0078125_f32), (40.0, 0.0625)] {
        let state =
            SingleTopState { momentum: vector![0.3, spin, -0.4], gamma: Vector3::z(), ..Default::default() };
        let wide = |numbers: &[f32]| numbers.iter().map(|x| f64::from(*x)).collect::<Vec<f64>>();
        let case = Case {
            prefix: header_prefix(&header),
            parameters: wide(&top.to_parameters()),
            state: wide(&state.to_components()),
            control: Vec::new(),
            step: f64::from(h),
        };
        let printed =
            run(&format!("single-{spin}"), &header, &case.program(&header, &options.prefixes("SingleTop")));
        let energy = f64::from(top.energy(&state));
        macro_rules! steps {
            ($scheme:ty) => {{
                let mut stepper = top.stepper::<$scheme>(h).expect("a stepper");
                case.expected(energy, |numbers| {
                    let mut components = state.to_components();
                    components.iter_mut().zip(&*numbers).for_each(|(to, x)| *to = *x as f32);
                    let mut at = SingleTopState::from_components(&components);
                    let report = stepper.step(&mut at).expect("a step");
                    *numbers = wide(&at.to_components());
                    report.iterations
                })
            }};
        }
        let expected = [steps!(Exponential), steps!(Cayley), steps!(Midpoint<Exponential>)].concat();
        compare("single precision", &printed, &expected);
    }
}

described! {
    DRIVEN:
    /// A body on a spring that time winds, with a motor.
    #[lie_poisson_system(
        group = SO3,
        control(torque: R3),
        potential = stiffness * (1.0 + t.sin() / 4.0) * attitude.w * attitude.w,
        force = torque - drag * velocity,
        methods(Midpoint),
        derivatives,
    )]
    struct Wound {
        #[inertia]
        inertia: Matrix3<f64>,
        stiffness: f64,
        drag: f64,
    }
}

fn wound() -> (Wound, WoundState) {
    let inertia = Matrix3::new(2.0, 0.1, 0.0, 0.1, 1.5, -0.2, 0.0, -0.2, 1.0);
    let start = WoundState { momentum: vector![0.5, -1.0, 2.0], ..Default::default() };
    (Wound { inertia, stiffness: 1.25, drag: 0.5 }, start)
}

/// Derivatives of steps, of one equation and of two, are those of Rust but for rounding: sums there are in lanes.
#[test]
fn derivatives_are_those_of_rust() {
    use coadjoint::derivative::{WrtControl, WrtParameters, WrtState};
    if compiler().is_none() {
        return;
    }
    let (attribute, item) = description(DRIVEN, "Wound");
    let names = ["StormerVerlet<Cayley>", "Midpoint<Exponential>"];
    let options = Options { steps: names.into_iter().map(Steps::of).collect(), ..Options::default() };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    let (wound, start) = wound();
    let torque = WoundControl { torque: vector![0.3, 0.1, -0.2] };
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let mut main = format!(
        "#include \"system.h\"\n#include <stdio.h>\n\nint main(void)\n{{\n    const double p[] = {{ {} }}, x[] = {{ {} }}, u[] = {{ {} }};\n    \
         wound_parameters parameters;\n    wound_state state;\n    wound_control control;\n    wound_derivative d;\n    int i, j, k;\n    \
         wound_parameters_from(&parameters, p);\n    wound_control_from(&control, u);\n",
        list(&wound.to_parameters()),
        list(&start.to_components()),
        list(&coadjoint::Control::to_components(&torque)),
    );
    for stepper in options.prefixes("Wound") {
        _ = write!(
            main,
            "    {{\n        {stepper}_stepper s;\n        wound_state_from(&state, x);\n        if ({stepper}_init(&s, &parameters, 0.05))\n            return 1;\n        \
             for (k = 0; k < 40; k++)\n            if ({stepper}_step_with_derivative(&s, &state, k * 0.05, &control, &d))\n                return 2;\n        \
             for (i = 0; i < 6; i++) {{\n            for (j = 0; j < 6; j++)\n                printf(\"%.17g \", d.wrt_state[j][i]);\n            \
             for (j = 0; j < 3; j++)\n                printf(\"%.17g \", d.wrt_control[j][i]);\n            \
             for (j = 0; j < 11; j++)\n                printf(\"%.17g \", d.wrt_parameters[j][i]);\n            printf(\"\\n\");\n        }}\n    }}\n"
        );
    }
    let printed = run("derivatives", &header, &(main + "    return 0;\n}\n"));
    let printed: Vec<f64> =
        printed.split_whitespace().map(|number| number.parse().expect("a number")).collect();
    let mut expected = Vec::new();
    macro_rules! matrices {
        ($scheme:ty) => {{
            let (mut stepper, mut state) = (wound.stepper::<$scheme>(0.05).expect("a stepper"), start);
            let mut last = None;
            for _ in 0..40 {
                let jacobian =
                    stepper.step_with_jacobian(&mut state, &torque, (WrtState, WrtControl, WrtParameters));
                last = Some(jacobian.expect("a derivative").0);
            }
            let (by_state, by_control, by_parameters) = last.expect("forty steps");
            for i in 0..6 {
                expected.extend((0..6).map(|j| by_state[(i, j)]));
                expected.extend((0..3).map(|j| by_control[(i, j)]));
                expected.extend((0..11).map(|j| by_parameters[(i, j)]));
            }
        }};
    }
    matrices!(StormerVerlet<Cayley>);
    matrices!(Midpoint<Exponential>);
    assert_eq!(printed.len(), expected.len());
    for (place, (c, rust)) in printed.iter().zip(&expected).enumerate() {
        assert!((c - rust).abs() <= 1e-12 * rust.abs().max(1.0), "{place}: {c} instead of {rust}");
    }
}

/// Input that is wrong, and steps that are too long, have the status that is Rust's error; the state is then as before.
#[test]
fn errors_are_told() {
    if compiler().is_none() {
        return;
    }
    let (attribute, item) = description(DRIVEN, "Wound");
    let options = Options { steps: vec![Steps::of("Exponential")], ..Options::default() };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    let (wound, start) = wound();
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let main = format!(
        "#include \"system.h\"\n#include <stdio.h>\n#include <string.h>\n\n\
         static const double p[] = {{ {} }}, x[] = {{ {} }};\nstatic wound_parameters parameters;\nstatic wound_state state, before;\n\
         static wound_control control;\nstatic wound_stepper s;\n\n\
         static void init(double h)\n{{\n    printf(\"%d\\n\", (int)wound_init(&s, &parameters, h));\n    wound_parameters_from(&parameters, p);\n}}\n\n\
         static void step(double time)\n{{\n    before = state;\n    printf(\"%d\", (int)wound_step(&s, &state, time, &control));\n    \
         printf(\" %d\\n\", memcmp(&before, &state, sizeof state) == 0);\n    wound_state_from(&state, x);\n    control.torque[0] = 0;\n}}\n\n\
         int main(void)\n{{\n    wound_parameters_from(&parameters, p);\n    wound_state_from(&state, x);\n    memset(&control, 0, sizeof control);\n    \
         init(0.05);\n    step(0);\n    \
         state.momentum[1] = NAN;\n    step(0);\n    \
         state.attitude[0] = 1.5;\n    step(0);\n    \
         control.torque[0] = INFINITY;\n    step(0);\n    \
         step(NAN);\n    \
         parameters.inertia[1] = 0.7;\n    init(0.05);\n    \
         parameters.inertia[0] = -1;\n    init(0.05);\n    \
         parameters.drag = NAN;\n    init(0.05);\n    \
         init(0);\n    init(INFINITY);\n    \
         init(0.05);\n    state.momentum[2] = 1e9;\n    step(0);\n    \
         init(500);\n    step(0);\n    return 0;\n}}\n",
        list(&wound.to_parameters()),
        list(&start.to_components()),
    );
    let printed = run("errors", &header, &main);
    let status = |name: &str| {
        let mut names = header.lines().skip_while(|line| *line != "typedef enum {").skip(1);
        let place = names
            .position(|line| line.trim().trim_start_matches("WOUND_").split([',', ' ']).next() == Some(name));
        place.unwrap_or_else(|| panic!("{name}"))
    };
    let fails = |name: &str| format!("{} 1", status(name));
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines[..2], ["0", "0 0"], "{printed}");
    assert_eq!(
        lines[2..6],
        [fails("NOT_FINITE"), fails("NOT_ON_GROUP"), fails("NOT_FINITE"), fails("NOT_FINITE")],
        "{printed}"
    );
    let parameters =
        ["NOT_SYMMETRIC", "NOT_POSITIVE_DEFINITE", "PARAMETER_NOT_FINITE", "BAD_STEP", "BAD_STEP"];
    assert_eq!(lines[6..11], parameters.map(|name| status(name).to_string()), "{printed}");
    // as Rust says it of the same steps
    let code = |error: StepError| match error {
        StepError::NotFinite => "NOT_FINITE",
        StepError::NotOnGroup { .. } => "NOT_ON_GROUP",
        StepError::NoConvergence { .. } => "NO_CONVERGENCE",
        StepError::NoSolution { .. } => "NO_SOLUTION",
        StepError::SeveralSolutions => "SEVERAL_SOLUTIONS",
        StepError::SingularJacobian => "SINGULAR_JACOBIAN",
        StepError::OutsideDomain => "OUTSIDE_DOMAIN",
        StepError::NoDerivative => "NO_DERIVATIVE",
        other => panic!("no step in C fails with {other}"),
    };
    let failing = |step: f64, spin: f64| {
        let mut state = WoundState { momentum: vector![start.momentum.x, start.momentum.y, spin], ..start };
        let error = wound
            .stepper::<Exponential>(step)
            .expect("a stepper")
            .step(&mut state)
            .expect_err("it is too long");
        fails(code(error))
    };
    assert_eq!([lines[12], lines[14]], [failing(0.05, 1e9), failing(500.0, start.momentum.z)], "{printed}");
    // every error that a step has
    let errors = include_str!("../../runtime/src/error.rs");
    let errors = errors
        .split_once("pub enum StepError {")
        .expect("they are there")
        .1
        .split_once("\n}")
        .expect("an end")
        .0;
    let variants = errors
        .lines()
        .filter_map(|line| line.strip_prefix("    "))
        .filter(|line| line.starts_with(char::is_uppercase));
    for variant in variants {
        let name = variant.trim_end_matches([',', '{', ' ']);
        let mut code = String::new();
        name.chars().for_each(|letter| {
            if letter.is_uppercase() && !code.is_empty() {
                code.push('_');
            }
            code.extend(letter.to_uppercase());
        });
        // of lists of numbers, of runs, and of Taylor steps
        let others =
            ["LENGTH", "OUT_OF_REACH", "TOO_MANY_EVENTS", "NO_PROGRESS", "NO_EVENT", "NO_END", "JUMPS"];
        if !others.contains(&code.as_str()) {
            status(&code);
        }
    }
}

/// The shorter solver takes the same steps but for rounding.
#[test]
fn the_compact_solver_takes_the_same_steps() {
    if compiler().is_none() {
        return;
    }
    for name in ["heavy_top", "double_pendulum", "quadrotor", "kepler"] {
        let entry = CATALOGUE.find(name).expect("it is there");
        let (attribute, item) = description(entry.source, entry.description.name);
        let options = Options { steps: vec![Steps::of("Exponential")], compact: true, ..Options::default() };
        let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
        let setup = &entry.example;
        let mut control = vec![0.0; setup.controls.len()];
        if let Some(law) = entry.law(setup) {
            law(&setup.state, 0.0, &mut control);
        }
        let case = Case {
            prefix: header_prefix(&header),
            parameters: setup.parameters.clone(),
            state: setup.state.clone(),
            control,
            step: entry.step,
        };
        let printed = run(
            &format!("compact-{name}"),
            &header,
            &case.program(&header, &options.prefixes(entry.description.name)),
        );
        let mut stepper = erased::Stepper::new(
            entry.system(&setup.parameters),
            &"Exponential".parse().expect("a scheme"),
            entry.step,
        )
        .expect("a stepper");
        let mut state = setup.state.clone();
        for _ in 0..EVERY {
            stepper.step(&mut state, &case.control).expect("a step");
        }
        let line = printed.lines().nth(1).expect("the state after so many steps");
        let size = state.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        for (c, rust) in line.split_whitespace().map(|x| x.parse::<f64>().expect("a number")).zip(&state) {
            // a unit of rounding a step, as it grows
            assert!((c - rust).abs() <= 1e-10 * size, "{name}: {c} instead of {rust}");
        }
    }
}

/// The firmware of the guide, on this machine: its motion is that of Rust, as far as numbers of 32 bits go.
#[test]
fn firmware_takes_the_steps_of_rust() {
    if compiler().is_none() {
        return;
    }
    let entry = CATALOGUE.find("heavy_top").expect("it is there");
    let (attribute, item) = description(entry.source, "HeavyTop");
    let options = Options {
        steps: vec![Steps::of("Cayley")],
        scalar: Some(ScalarType::F32),
        compact: true,
        ..Options::default()
    };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    let guide = include_str!("../../runtime/src/guide/headers.md");
    let code = guide.split("```c\n").nth(1).and_then(|rest| rest.split("```").next()).expect("the loop");
    let code = code.replace("heavy_top.h", "system.h");
    let board = "#include <stdio.h>\n\nstatic unsigned long shown;\n\nvoid wait_for_tick(void) {}\n\n\
                 void show(const heavy_top_state *now)\n{\n    if (++shown == 1000)\n        \
                 printf(\"%.9g %.9g %.9g %.9g\\n\", (double)now->attitude[0], (double)now->momentum[0], (double)now->momentum[1], (double)now->gamma[2]);\n}\n\n\
                 int main(void)\n{\n    return run(1000);\n}\n";
    let printed = run("firmware", &header, &format!("{code}\n{board}"));
    let mut stepper = erased::Stepper::new(
        entry.system(&entry.example.parameters),
        &"Cayley".parse().expect("a scheme"),
        0.01,
    )
    .expect("a stepper");
    let mut state = entry.example.state.clone();
    for _ in 0..1000 {
        stepper.step(&mut state, &[]).expect("a step");
    }
    let expected = [state[0], state[4], state[5], state[9]];
    for (c, rust) in printed.split_whitespace().map(|x| x.parse::<f64>().expect("a number")).zip(expected) {
        assert!((c - rust).abs() < 1e-4, "{c} instead of {rust}");
    }
    fits_a_microcontroller(&header, &code, [3000, 512]);
    let exponential = Options { steps: vec![Steps::of("Exponential")], ..options };
    let (attribute, item) = description(entry.source, "HeavyTop");
    let header = coadjoint_codegen::c99(attribute, item, &exponential).expect("a header");
    fits_a_microcontroller(&header, &code, [6000, 640]);
}

/// No more than so many bytes of code and of stack on a Cortex-M4.
fn fits_a_microcontroller(header: &str, code: &str, most: [u32; 2]) {
    let path = directory("thumb");
    fs::write(path.join("system.h"), header).expect("written");
    fs::write(path.join("main.c"), code).expect("written");
    let flags = [
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfpu=fpv4-sp-d16",
        "-mfloat-abi=hard",
        "-std=c99",
        "-fno-math-errno",
        "-Os",
        "-fstack-usage",
        "-c",
        "main.c",
    ];
    let compiled = Command::new("arm-none-eabi-gcc").args(flags).current_dir(&path).output();
    let sizes = Command::new("arm-none-eabi-size").arg("main.o").current_dir(&path).output();
    let (Ok(compiled), Ok(sizes)) = (compiled, sizes) else {
        println!("SKIPPED: there is no arm-none-eabi-gcc, so that the firmware's size was not looked at");
        return;
    };
    let said = String::from_utf8_lossy(&compiled.stderr);
    if said.contains("math.h: No such file") {
        println!(
            "SKIPPED: arm-none-eabi-gcc has no C library, so that the firmware's size was not looked at"
        );
        return;
    }
    assert!(compiled.status.success(), "{said}");
    let sizes = String::from_utf8_lossy(&sizes.stdout).into_owned();
    let text = sizes.lines().nth(1).and_then(|line| line.split_whitespace().next()?.parse::<u32>().ok());
    assert!(text.is_some_and(|bytes| bytes <= most[0]), "{sizes}");
    let frames = fs::read_to_string(path.join("main.su")).expect("frames");
    let largest = frames.lines().filter_map(|line| line.split('\t').nth(1)?.parse::<u32>().ok()).max();
    assert!(largest.is_some_and(|bytes| bytes <= most[1]), "{frames}");
    fs::remove_dir_all(&path).expect("removed");
}

/// Kernels for GPUs, run on the processor: each member goes as it does by itself. CUDA's front end looks at them too, where it is there.
#[test]
fn kernels_take_each_member_as_it_is() {
    if compiler().is_none() {
        return;
    }
    let (attribute, item) = description(DRIVEN, "Wound");
    let options = Options { steps: vec![Steps::of("Cayley")], kernels: true, ..Options::default() };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    let (wound, start) = wound();
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    // the words of CUDA for one thread after the other
    let shim = "static unsigned long member;\n#define WOUND_KERNEL static\n#define WOUND_MEMBER member\n";
    let main = format!(
        "{shim}#include \"system.h\"\n#include <stdio.h>\n\n\
         enum {{ MEMBERS = 5, STEPS = 60, EVERY = 20 }};\n\n\
         int main(void)\n{{\n    static const double p[] = {{ {} }}, x[] = {{ {} }};\n    \
         static double state[7 * MEMBERS], controls[3 * 3 * MEMBERS], samples[3 * 7 * MEMBERS], alone[7];\n    static int status[MEMBERS];\n    \
         int i, k, sample, same = 1;\n    \
         for (i = 0; i < MEMBERS; i++) {{\n        for (k = 0; k < 7; k++)\n            state[k * MEMBERS + i] = x[k] + (k == 6 ? 0.1 * i : 0);\n        \
         for (k = 0; k < 9; k++)\n            controls[k * MEMBERS + i] = 0.1 * k - 0.05 * i;\n    }}\n    \
         for (member = 0; member < MEMBERS + 3; member++)\n        \
         wound_ensemble(p, 1, state, 0.05, 0, controls, 3, STEPS, EVERY, samples, status, MEMBERS);\n    \
         for (i = 0; i < MEMBERS; i++) {{\n        wound_stepper s;\n        wound_parameters parameters;\n        wound_state one;\n        wound_control u;\n        \
         double from[7];\n        \
         for (k = 0; k < 7; k++)\n            from[k] = x[k] + (k == 6 ? 0.1 * i : 0);\n        \
         wound_parameters_from(&parameters, p);\n        wound_state_from(&one, from);\n        if (wound_init(&s, &parameters, 0.05))\n            return 1;\n        \
         for (sample = 0; sample < 3; sample++) {{\n            for (k = 0; k < 3; k++)\n                u.torque[k] = controls[(sample * 3 + k) * MEMBERS + i];\n            \
         if (wound_steps(&s, &one, sample * EVERY * 0.05, &u, EVERY, 0))\n                return 2;\n            \
         wound_state_to(alone, &one);\n            for (k = 0; k < 7; k++)\n                same = same && samples[(sample * 7 + k) * MEMBERS + i] == alone[k];\n        }}\n        \
         for (k = 0; k < 7; k++)\n            same = same && state[k * MEMBERS + i] == alone[k];\n        same = same && status[i] == 0;\n    }}\n    \
         printf(\"%d\\n\", same);\n    return 0;\n}}\n",
        list(&wound.to_parameters()),
        list(&start.to_components()),
    );
    // times that are made otherwise differ by rounding
    let printed = run("kernels", &header, &main);
    assert_eq!(printed.trim(), "1");

    let path = directory("cuda");
    let words = "#define __host__ __attribute__((host))\n#define __device__ __attribute__((device))\n#define __global__ __attribute__((global))\n\
                 #define __noinline__ __attribute__((noinline))\n#define __forceinline__ inline __attribute__((always_inline))\n\
                 struct Place { unsigned x, y, z; };\nextern const __device__ __attribute__((weak)) Place blockIdx, blockDim, threadIdx;\n\
                 #include <math.h>\n__device__ double sqrt(double x) { return __builtin_sqrt(x); }\n\
                 __device__ double fabs(double x) { return __builtin_fabs(x); }\n__device__ double sin(double x);\n__device__ double cos(double x);\n\
                 __device__ double exp(double x);\n#define __CUDACC__ 1\n#include \"system.h\"\n";
    fs::write(path.join("system.h"), &header).expect("written");
    fs::write(path.join("main.cu"), words).expect("written");
    let flags = [
        "-x",
        "cuda",
        "-nocudainc",
        "-nocudalib",
        "--cuda-gpu-arch=sm_70",
        "--cuda-device-only",
        "-Werror",
        "-O1",
        "-S",
        "-o",
        "main.ptx",
        "main.cu",
    ];
    match Command::new("clang").args(flags).current_dir(&path).output() {
        Ok(compiled) => assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr)),
        Err(_) => println!("SKIPPED: there is no clang, whose front end would look at the kernels as CUDA"),
    }
    fs::remove_dir_all(&path).expect("removed");
}

/// Numbers of another precision than the description's.
#[test]
fn precision_can_be_chosen() {
    let (attribute, item) = description(DRIVEN, "Wound");
    let options = Options { scalar: Some(ScalarType::F32), ..Options::default() };
    let header = coadjoint_codegen::c99(attribute, item, &options).expect("a header");
    assert!(header.contains("typedef float ") && !header.contains("typedef double "));
}
