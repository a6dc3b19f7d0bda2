//! Work–precision diagrams: errors against the time of computation, for our methods of orders 2 to 10 and for the classical ones.

use std::sync::Arc;
use std::time::Instant;

use coadjoint::erased;
use coadjoint::prelude::*;
use nalgebra::Vector6;

use super::Data;
use super::caption::{Caption, Paragraph, Piece, given, measured, paragraph, verdict};
use super::each_step::each_step;
use super::methods::{
    CAYLEY, EXPONENTIAL, HAMILTON_JACOBI, ORDER_4, ORDER_6, ORDER_8, ORDER_10, RK4, RKMK4, marked,
};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Figure, Key, Panel};
use coadjoint_app::setup::{self, Order, Retraction};
use coadjoint_app::simulate;
use coadjoint_systems::catalogue::CATALOGUE;
use coadjoint_systems::classical::{AttitudeState, Rk4Quaternion, Rkmk4, Timed, bodies, integrate};
use coadjoint_systems::heavy_top::{HeavyTop, HeavyTopState};

/// How long the motion is followed, s.
pub(crate) const DURATION: f64 = 20.0;

/// The extent of the measurement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    /// The most steps of a run.
    pub(crate) most: u64,
    /// Steps of the run that counts as exact, with order 10.
    pub(crate) reference: u64,
    /// Steps are timed for so many seconds.
    pub(crate) seconds: f64,
}

impl Sampling {
    /// For the figure.
    pub(crate) const FULL: Self = Self { most: 1 << 18, reference: 1 << 13, seconds: 0.04 };
}

/// One run of one method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    /// Steps taken.
    #[cfg(test)]
    pub(crate) steps: u64,
    /// Time of computation for each second of motion, s.
    pub(crate) time: f64,
    /// Distance of the end state from the exact one, relative to its size.
    pub(crate) trajectory: f64,
    /// The largest error of `Π·Γ`, kg m²/s.
    pub(crate) casimir: f64,
}

/// All runs of one method, from few steps to many.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// Its name.
    pub(crate) name: &'static str,
    /// Its runs.
    pub(crate) costs: Vec<Cost>,
}

/// A heavy top that is neither round nor fast, for 20 s: all methods.
#[derive(Clone, Debug)]
pub(crate) struct Work {
    /// Ours first.
    pub(crate) methods: Vec<Method>,
}

/// The top and its start.
pub(super) fn top() -> (HeavyTop, HeavyTopState) {
    let top = HeavyTop { inertia: vector![1.0, 2.0, 2.5], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
    (top, HeavyTop::start(attitude, vector![0.4, -0.8, 1.5]))
}

/// `(Π, Γ)`
pub(super) fn body(state: &HeavyTopState) -> Vector6<f64> {
    let HeavyTopState { momentum, gamma, .. } = state;
    Vector6::new(momentum.x, momentum.y, momentum.z, gamma.x, gamma.y, gamma.z)
}

/// What the system keeps, of `(Π, Γ)`.
pub(super) fn invariants(top: &bodies::HeavyTop, y: &Vector6<f64>) -> [f64; 2] {
    [top.energy(y), y[0] * y[3] + y[1] * y[4] + y[2] * y[5]]
}

/// The state as eleven numbers, the sign of the quaternion left out.
fn coordinates(attitude: &UnitQuaternion<f64>, y: &Vector6<f64>) -> ([f64; 9], Vector6<f64>) {
    let mut entries = [0.0; 9];
    entries.copy_from_slice(attitude.to_rotation_matrix().matrix().as_slice());
    (entries, *y)
}

/// Observes `(Π, Γ)` at every step.
type Observe<'a> = dyn FnMut(&Vector6<f64>) + 'a;

/// A method's run: from the start with so many steps to the end.
type Integrate<'a> = dyn Fn(u64, &mut Observe<'_>) -> Option<AttitudeState<6>> + 'a;

/// A run that goes on with so many steps more, each time it is called. Whether they could be taken.
type Run<'a> = Box<dyn FnMut() -> bool + 'a>;

/// The most steps of a batch that is timed: others at work on the machine disturb few of them.
const BATCH: u64 = 1024;

/// One method: a run from the start that is observed, and runs to be timed.
struct Candidate<'a> {
    name: &'static str,
    integrate: Box<Integrate<'a>>,
    /// With a step of this size, in batches of so many.
    run: Box<dyn Fn(f64, u64) -> Option<Run<'a>> + 'a>,
}

/// One of ours.
type Scheme = (setup::Method, Retraction, Order);

/// Ours, with their order.
const OURS: [(&str, Scheme); 7] = [
    (EXPONENTIAL, (setup::Method::Standard, Retraction::Exponential, Order::Two)),
    (CAYLEY, (setup::Method::Standard, Retraction::Cayley, Order::Two)),
    (ORDER_4, (setup::Method::Standard, Retraction::Cayley, Order::Four)),
    (ORDER_6, (setup::Method::Standard, Retraction::Cayley, Order::Six)),
    (ORDER_8, (setup::Method::Standard, Retraction::Cayley, Order::Eight)),
    (ORDER_10, (setup::Method::Standard, Retraction::Cayley, Order::Ten)),
    (HAMILTON_JACOBI, (setup::Method::HAMILTON_JACOBI, Retraction::Exponential, Order::Six)),
];

impl Work {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step of the run that counts as exact cannot be taken.
    pub(crate) fn measure(sampling: &Sampling) -> Result<Self, Error> {
        let (top, start) = top();
        let classical_top = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
        let from = AttitudeState { attitude: start.attitude, y: body(&start) };
        let best = (setup::Method::Standard, Retraction::Exponential, Order::Ten);
        let end = integrate_to_end(&top, start, best, sampling.reference, &mut |_| {})?;
        let exact = coordinates(&end.attitude, &end.y);
        // with steps that are compiled with the catalogue
        let erased = CATALOGUE.erased(&top)?;
        let top = &top;
        let ours = OURS.into_iter().map(|(name, scheme)| Candidate {
            name,
            integrate: Box::new(move |n, observe| integrate_to_end(top, start, scheme, n, observe).ok()),
            run: {
                let erased = erased.clone();
                Box::new(move |step, n| run(erased.clone(), start, scheme, (step, n)))
            },
        });
        let classical: [Candidate<'_>; 2] = [
            Candidate {
                name: RK4,
                integrate: Box::new(|n, observe| classical(&Rk4Quaternion, &classical_top, from, n, observe)),
                run: Box::new(|step, n| classical_run(&Rk4Quaternion, &classical_top, from, (step, n))),
            },
            Candidate {
                name: RKMK4,
                integrate: Box::new(|n, observe| classical(&Rkmk4, &classical_top, from, n, observe)),
                run: Box::new(|step, n| classical_run(&Rkmk4, &classical_top, from, (step, n))),
            },
        ];
        let methods = ours.chain(classical).map(|method| Method {
            name: method.name,
            costs: costs(&method, sampling, &classical_top, &exact),
        });
        Ok(Self { methods: methods.collect() })
    }

    /// Errors against time.
    pub(crate) fn figure(&self) -> Figure {
        let panel = |title: &str, label: &str, error: fn(&Cost) -> f64| {
            let series = self.methods.iter().map(|method| {
                // beyond the length of the motion nothing is accurate
                let costs = method.costs.iter().filter(|cost| cost.trajectory < 1.0);
                marked(method.name, costs.map(|cost| (cost.time * 1e6, error(cost))).collect())
            });
            let time = Axis::logarithmic("µs of computation for 1 s of motion");
            Panel::new(time, Axis::logarithmic(label), series.collect()).titled(title)
        };
        Figure {
            title: "Work and precision: a heavy top".to_owned(),
            columns: 2,
            cell: (520.0, 460.0),
            key: Key::Above,
            shared: (true, false),
            panels: vec![
                panel("(a) trajectory", "relative error after 20 s, no unit", |cost| cost.trajectory),
                panel("(b) Casimir", "largest |Π·Γ − Π₀·Γ₀|, kg m²/s", |cost| cost.casimir),
            ],
        }
    }
}

/// What an error costs with ours, and with the classical methods.
pub(crate) fn caption(data: &Data) -> Caption {
    let mut caption = vec![paragraph![
        given("I = diag(1, 2, 2.5) kg m², mgχ = (0.3, 0.2, 1) N m, |Π₀| = 1.7 kg m²/s"),
        ". Every mark is a run with twice as many steps as the one before it, up to roundoff. Steps are timed as in a \
         long run, in batches of at most ",
        given(BATCH),
        ", on the machine that drew this."
    ]];
    let mut pieces: Vec<Piece> = vec!["For each second of motion a relative error of ".into()];
    for (k, (error, name)) in [(1e-4, "10⁻⁴"), (1e-8, "10⁻⁸"), (1e-11, "10⁻¹¹")].into_iter().enumerate()
    {
        pieces.extend([if k > 0 { "; of ".into() } else { "".into() }, given(name), " costs ".into()]);
        let ours: Vec<&str> = OURS.iter().map(|(name, ..)| *name).collect();
        for (k, methods) in [&ours[..], &[RK4, RKMK4]].into_iter().enumerate() {
            let separate = if k > 0 { " and " } else { "" };
            pieces.push(separate.into());
            match cheapest(data, methods, error) {
                Some((name, time)) => {
                    pieces.extend([measured(time), " µs with ".into(), verdict(name)]);
                }
                None => pieces.push(verdict("more than was tried")),
            }
        }
    }
    pieces.push(". Named is the first method whose time is within a quarter of the least".into());
    pieces.push(". The Casimir errors of ours are roundoff with any step, whatever the order.".into());
    caption.push(Paragraph(pieces));
    caption
}

/// The method with the least time that has at most this error, and its time, by interpolation between runs. What is cheaper by less than a
/// fifth is not said to be: the first of them in the list counts, as timings differ from run to run; the caption says so.
pub(crate) fn cheapest<'a>(data: &Data, methods: &[&'a str], error: f64) -> Option<(&'a str, f64)> {
    let time = |name: &&'a str| {
        let runs = data.curve(1, name).points();
        // the fewest steps may do
        if let Some(first) = runs.first().filter(|first| first.1 <= error) {
            return Some((*name, first.0));
        }
        let time = runs.windows(2).find_map(|pair| {
            let &[a, b] = pair else { return None };
            let (x, y) = ((a.1 / error).ln(), (b.1 / error).ln());
            (x > 0.0 && y <= 0.0).then(|| (a.0.ln() + (b.0 / a.0).ln() * x / (x - y)).exp())
        })?;
        Some((*name, time))
    };
    let least = methods.iter().filter_map(time).map(|(_, time)| time).reduce(f64::min)?;
    methods.iter().filter_map(time).find(|(_, time)| *time <= 1.25 * least)
}

/// Runs with more and more steps, until roundoff is all that is left of the error.
fn costs(
    method: &Candidate<'_>,
    sampling: &Sampling,
    top: &bodies::HeavyTop,
    exact: &([f64; 9], Vector6<f64>),
) -> Vec<Cost> {
    let mut costs: Vec<Cost> = Vec::new();
    for steps in (6..).map(|k| 1_u64 << k).take_while(|&steps| steps <= sampling.most) {
        let cost = cost(method, steps, sampling, top, exact);
        let least = costs.iter().map(|cost| cost.trajectory).fold(f64::INFINITY, f64::min);
        if let Some(cost) = cost {
            costs.push(cost);
            if cost.trajectory < 1e-10 && cost.trajectory > least {
                break;
            }
        }
    }
    costs
}

fn cost(
    method: &Candidate<'_>,
    steps: u64,
    sampling: &Sampling,
    top: &bodies::HeavyTop,
    exact: &([f64; 9], Vector6<f64>),
) -> Option<Cost> {
    let mut initial: Option<[f64; 2]> = None;
    let mut errors = [0.0_f64; 2];
    let end = (method.integrate)(steps, &mut |y: &Vector6<f64>| {
        let now = invariants(top, y);
        let initial = initial.get_or_insert(now);
        errors = std::array::from_fn(|i| errors[i].max((now[i] - initial[i]).abs()));
    })?;
    let (attitude, y) = coordinates(&end.attitude, &end.y);
    let turned = attitude.iter().zip(&exact.0).map(|(is, should)| (is - should).powi(2)).sum::<f64>();
    let size = 3.0 + exact.1.norm_squared();
    let trajectory = ((turned + (y - exact.1).norm_squared()) / size).sqrt();
    Some(Cost {
        #[cfg(test)]
        steps,
        time: duration(method, steps, sampling.seconds)? / DURATION,
        trajectory,
        casimir: errors[1],
    })
}

/// The time of so many steps: the median of batches, one after the other, for so many seconds and not less than three. The first is for warming up.
fn duration(method: &Candidate<'_>, steps: u64, seconds: f64) -> Option<f64> {
    let batch = steps.min(BATCH);
    let mut run = (method.run)(DURATION / steps as f64, batch)?;
    run().then_some(())?;
    let mut times: Vec<f64> = Vec::new();
    let begin = Instant::now();
    while begin.elapsed().as_secs_f64() < seconds || times.len() < 3 {
        let start = Instant::now();
        run().then_some(())?;
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Some(times[times.len() / 2] * steps as f64 / batch as f64)
}

fn integrate_to_end(
    top: &HeavyTop,
    start: HeavyTopState,
    scheme: Scheme,
    steps: u64,
    observe: &mut Observe<'_>,
) -> Result<AttitudeState<6>, Error> {
    let mut end = start;
    each_step(top, &start, scheme, (DURATION / steps as f64, steps), |_, _, state| {
        observe(&body(state));
        end = *state;
    })?;
    Ok(AttitudeState { attitude: end.attitude, y: body(&end) })
}

/// As users take steps that nobody has to observe: a batch with one call.
fn run(
    top: Arc<dyn erased::System>,
    start: HeavyTopState,
    (method, retraction, order): Scheme,
    (step, batch): (f64, u64),
) -> Option<Run<'static>> {
    let scheme = simulate::scheme(method, retraction, order).ok()?;
    let mut stepper = erased::Stepper::new(top, &scheme, step).ok()?;
    let mut components = start.to_components();
    Some(Box::new(move || stepper.steps(components.as_mut(), &[], batch).is_ok()))
}

fn classical<I: Timed<bodies::HeavyTop, AttitudeState<6>>>(
    method: &I,
    top: &bodies::HeavyTop,
    start: AttitudeState<6>,
    steps: u64,
    observe: &mut Observe<'_>,
) -> Option<AttitudeState<6>> {
    let step = DURATION / steps as f64;
    integrate(method, top, 0.0, start, step, steps, |_, _, state| observe(&state.y)).ok()
}

fn classical_run<'a, I: Timed<bodies::HeavyTop, AttitudeState<6>>>(
    method: &'a I,
    top: &'a bodies::HeavyTop,
    mut state: AttitudeState<6>,
    (step, batch): (f64, u64),
) -> Option<Run<'a>> {
    Some(Box::new(move || match method.run(top, state, step, batch) {
        Ok(end) => {
            state = end;
            true
        }
        Err(_) => false,
    }))
}
