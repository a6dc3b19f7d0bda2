//! Work–precision diagrams: errors against the time of computation, for our methods of orders 2 to 10 and for the classical ones.

use std::time::Instant;

use coadjoint::erased;
use coadjoint::prelude::*;
use nalgebra::Vector6;

use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};
use coadjoint_app::simulation::{self, Order, Retraction, SimulationError, each_step};
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
    /// The best time of so many repetitions counts.
    pub(crate) repetitions: u32,
}

impl Sampling {
    /// For the figure.
    pub(crate) const FULL: Self = Self { most: 1 << 18, reference: 1 << 13, repetitions: 5 };
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
    /// The largest error of the energy, J.
    pub(crate) energy: f64,
    /// The largest error of `Π·Γ`, kg m²/s.
    pub(crate) casimir: f64,
}

/// All runs of one method, from few steps to many.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// Its name.
    pub(crate) name: String,
    /// Its runs.
    pub(crate) costs: Vec<Cost>,
}

/// A heavy top that is neither round nor fast, for 20 s: all methods.
#[derive(Clone, Debug)]
pub(crate) struct Work {
    /// Ours first.
    pub(crate) methods: Vec<Method>,
}

/// The last so many methods are the classical ones.
const CLASSICAL: usize = 2;

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
type Integrate<'a> = dyn Fn(u64, Option<&mut Observe<'_>>) -> Option<AttitudeState<6>> + 'a;

impl Work {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step of the run that counts as exact cannot be taken.
    pub(crate) fn measure(sampling: &Sampling) -> Result<Self, Error> {
        let (top, start) = top();
        let classical_top = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
        let from = AttitudeState { attitude: start.attitude, y: body(&start) };
        let exact = {
            let end = integrate_to_end(
                &top,
                start,
                (Retraction::Exponential, Order::Ten),
                sampling.reference,
                None,
            )?;
            coordinates(&end.attitude, &end.y)
        };
        let ours: [(&str, Box<Integrate<'_>>); 7] = [
            (
                "exponential, order 2",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Exponential, Order::Two), n, observe).ok()
                }),
            ),
            (
                "Cayley, order 2",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Cayley, Order::Two), n, observe).ok()
                }),
            ),
            (
                "Cayley, order 4",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Cayley, Order::Four), n, observe).ok()
                }),
            ),
            (
                "Cayley, order 6",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Cayley, Order::Six), n, observe).ok()
                }),
            ),
            (
                "Cayley, order 8",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Cayley, Order::Eight), n, observe).ok()
                }),
            ),
            (
                "Cayley, order 10",
                Box::new(|n, observe| {
                    integrate_to_end(&top, start, (Retraction::Cayley, Order::Ten), n, observe).ok()
                }),
            ),
            (
                "RK4 on quaternions, projected",
                Box::new(|n, observe| classical(&Rk4Quaternion, &classical_top, from, n, observe)),
            ),
        ];
        let rkmk: Box<Integrate<'_>> =
            Box::new(|n, observe| classical(&Rkmk4, &classical_top, from, n, observe));
        let methods =
            ours.iter().map(|(name, integrate_to_end)| (*name, integrate_to_end)).chain([("RKMK4", &rkmk)]);
        let methods = methods.map(|(name, integrate_to_end)| Method {
            name: name.to_owned(),
            costs: (6..)
                .map(|k| 1_u64 << k)
                .take_while(|&steps| steps <= sampling.most)
                .filter_map(|steps| {
                    cost(integrate_to_end.as_ref(), steps, sampling.repetitions, &classical_top, &exact)
                })
                .collect(),
        });
        Ok(Self { methods: methods.collect() })
    }

    /// Three errors against time.
    pub(crate) fn figure(&self) -> Figure {
        let panel = |title: &str, label: &str, error: fn(&Cost) -> f64| {
            let series = self.methods.iter().map(|method| Series {
                label: method.name.clone(),
                points: method
                    .costs
                    .iter()
                    // beyond the length of the motion nothing is accurate
                    .filter(|cost| cost.trajectory < 3.0)
                    .map(|cost| (cost.time * 1e6, error(cost)))
                    .collect(),
                style: if method.name == "RKMK4" { Style::DashedMarked } else { Style::Marked },
            });
            Panel::new(
                Axis::logarithmic("µs of computation for 1 s of motion"),
                Axis::logarithmic(label),
                series.collect(),
            )
            .titled(title)
        };
        let named = |methods: &[Method], error: f64| match cheapest(methods, error) {
            Some((name, time)) => format!("{:.2} µs with {name}", time * 1e6),
            None => "out of reach".to_owned(),
        };
        let (ours, classical) = self.methods.split_at(self.methods.len().saturating_sub(CLASSICAL));
        let prices = [(1e-4, "10⁻⁴"), (1e-8, "10⁻⁸"), (1e-11, "10⁻¹¹")].map(|(error, text)| {
            format!(
                "{text} costs {} of ours, {} of the classical ones",
                named(ours, error),
                named(classical, error)
            )
        });
        Figure {
            title: "Work and precision: a heavy top for 20 s".to_owned(),
            caption: vec![
                "I = diag(1, 2, 2.5) kg m², mgχ = (0.3, 0.2, 1) N m, |Π₀| = 1.7 kg m²/s. Every mark is a run with twice as many steps \
                 as the one before it."
                    .to_owned(),
                format!(
                    "For each second of motion, a trajectory error of {}. Times were measured on the machine that drew this. The \
                     Casimir errors of ours are roundoff with any step, whatever the order.",
                    prices.join("; of ")
                ),
            ],
            columns: 3,
            cell: (480.0, 440.0),
            key: Key::Below,
            panels: vec![
                panel("(a) trajectory", "relative error at 20 s", |cost| cost.trajectory),
                panel("(b) energy", "largest |H − H₀|, J", |cost| cost.energy),
                panel("(c) Casimir", "largest |Π·Γ − Π₀·Γ₀|, kg m²/s", |cost| cost.casimir),
            ],
        }
    }
}

/// The method with the least time that has at most this error, and its time, by interpolation between runs.
pub(crate) fn cheapest(methods: &[Method], error: f64) -> Option<(&str, f64)> {
    let time = |method: &Method| {
        method.costs.windows(2).find_map(|pair| {
            let [a, b] = pair else { return None };
            let (x, y) = ((a.trajectory / error).ln(), (b.trajectory / error).ln());
            (x > 0.0 && y <= 0.0).then(|| (a.time.ln() + (b.time / a.time).ln() * x / (x - y)).exp())
        })
    };
    let times = methods.iter().filter_map(|method| Some((method.name.as_str(), time(method)?)));
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn cost(
    integrate_to_end: &Integrate<'_>,
    steps: u64,
    repetitions: u32,
    top: &bodies::HeavyTop,
    exact: &([f64; 9], Vector6<f64>),
) -> Option<Cost> {
    let mut initial: Option<[f64; 2]> = None;
    let mut errors = [0.0_f64; 2];
    let mut observe = |y: &Vector6<f64>| {
        let now = invariants(top, y);
        let initial = initial.get_or_insert(now);
        errors = std::array::from_fn(|i| errors[i].max((now[i] - initial[i]).abs()));
    };
    let end = integrate_to_end(steps, Some(&mut observe))?;
    let (attitude, y) = coordinates(&end.attitude, &end.y);
    let turned = attitude.iter().zip(&exact.0).map(|(is, should)| (is - should).powi(2)).sum::<f64>();
    let size = 3.0 + exact.1.norm_squared();
    let trajectory = ((turned + (y - exact.1).norm_squared()) / size).sqrt();
    let mut time = f64::INFINITY;
    for _ in 0..repetitions {
        let start = Instant::now();
        std::hint::black_box(integrate_to_end(steps, None));
        time = time.min(start.elapsed().as_secs_f64());
    }
    Some(Cost {
        #[cfg(test)]
        steps,
        time: time / DURATION,
        trajectory,
        energy: errors[0],
        casimir: errors[1],
    })
}

fn integrate_to_end(
    top: &HeavyTop,
    start: HeavyTopState,
    (retraction, order): (Retraction, Order),
    steps: u64,
    observe: Option<&mut Observe<'_>>,
) -> Result<AttitudeState<6>, Error> {
    let (scheme, step) = ((simulation::Method::Standard, retraction, order), DURATION / steps as f64);
    let mut end = start;
    match observe {
        Some(observe) => each_step(top, &start, scheme, (step, steps), |_, _, state| {
            observe(&body(state));
            end = *state;
        })?,
        // as users take steps that nobody has to observe
        None => {
            let scheme = simulation::scheme(scheme.0, scheme.1, scheme.2)?;
            let mut stepper = erased::Stepper::new(top, &scheme, step).map_err(SimulationError::from)?;
            let mut components = start.to_components();
            stepper.steps(&mut components, &[], steps)?;
            end = HeavyTopState::from_components(&components);
        }
    }
    Ok(AttitudeState { attitude: end.attitude, y: body(&end) })
}

fn classical<I: Timed<bodies::HeavyTop, AttitudeState<6>>>(
    method: &I,
    top: &bodies::HeavyTop,
    start: AttitudeState<6>,
    steps: u64,
    observe: Option<&mut Observe<'_>>,
) -> Option<AttitudeState<6>> {
    let step = DURATION / steps as f64;
    match observe {
        Some(observe) => integrate(method, top, 0.0, start, step, steps, |_, _, state| observe(&state.y)),
        None => method.run(top, start, step, steps),
    }
    .ok()
}
