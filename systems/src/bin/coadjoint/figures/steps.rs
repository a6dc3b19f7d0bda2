//! Large steps for long times: the errors of each method, up to the step at which it fails.

use super::caption::{Caption, Paragraph, Piece, given, paragraph, verdict, with_places};
use super::each_step::each_step;
use super::methods::{CAYLEY, EXPONENTIAL, HAMILTON_JACOBI, ORDER_4, RK4, RKMK4, marked};
use super::work::{body, invariants, top};
use super::{Curve, Data};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Figure, Key, Panel};
use coadjoint_app::record::DriftStats;
use coadjoint_app::setup::{self, Order, Retraction};
use coadjoint_systems::classical::{AttitudeState, Integrator, Rk4Quaternion, Rkmk4, bodies, integrate};

/// How long the motion is followed, s: some six hundred of the top's swings.
pub(crate) const DURATION: f64 = 5_000.0;
/// The smallest step, s.
const SMALLEST: f64 = 0.02;
/// Neighbouring steps' ratio.
const RATIO: f64 = 1.25;
/// No method is useful with larger steps.
const LARGEST: f64 = 3.0;

/// One run with one step.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    /// The step, s.
    pub(crate) step: f64,
    /// The drift of the energy.
    pub(crate) energy: DriftStats,
    /// The drift of `Π·Γ`.
    pub(crate) casimir: DriftStats,
}

/// One method, with ever larger steps.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// Its name.
    pub(crate) name: &'static str,
    /// The runs that succeeded; with other steps the equation could not be solved, or the state was not finite.
    pub(crate) trials: Vec<Trial>,
}

/// The same top as in [`work`](super::work), for a long time.
#[derive(Clone, Debug)]
pub(crate) struct Steps {
    /// Exponential, Cayley, Cayley of order 4, Hamilton–Jacobi of order 6, RK4 on quaternions, RKMK4.
    pub(crate) methods: Vec<Method>,
}

impl Steps {
    /// Makes the runs.
    ///
    /// # Errors
    /// None; a run that breaks is a result.
    pub(crate) fn measure(duration: f64) -> Result<Self, Error> {
        Ok(Self {
            methods: vec![
                method(EXPONENTIAL, |step| {
                    ours((setup::Method::Standard, Retraction::Exponential, Order::Two), step, duration)
                }),
                method(CAYLEY, |step| {
                    ours((setup::Method::Standard, Retraction::Cayley, Order::Two), step, duration)
                }),
                method(ORDER_4, |step| {
                    ours((setup::Method::Standard, Retraction::Cayley, Order::Four), step, duration)
                }),
                method(HAMILTON_JACOBI, |step| {
                    ours(
                        (setup::Method::HAMILTON_JACOBI, Retraction::Exponential, Order::Six),
                        step,
                        duration,
                    )
                }),
                method(RK4, |step| classical(&Rk4Quaternion, step, duration)),
                method(RKMK4, |step| classical(&Rkmk4, step, duration)),
            ],
        })
    }

    /// Largest errors against the step.
    pub(crate) fn figure(&self) -> Figure {
        let panel = |title: &str, label: &str, error: fn(&Trial) -> f64| {
            let series = self.methods.iter().map(|method| {
                let points = method.trials.iter().map(|trial| (trial.step, error(trial)));
                marked(method.name, points.collect())
            });
            let horizontal = Axis::logarithmic("step h, s").within(SMALLEST, LARGEST);
            Panel::new(horizontal, Axis::logarithmic(label), series.collect()).titled(title)
        };
        Figure {
            title: "Large steps for a long time: a heavy top".to_owned(),
            columns: 2,
            cell: (460.0, 400.0),
            key: Key::Above,
            shared: (false, false),
            panels: vec![
                panel("(a) energy", "largest |H − H₀|, J", |trial| trial.energy.error),
                panel("(b) Casimir", "largest |Π·Γ − Π₀·Γ₀|, kg m²/s", |trial| {
                    trial.casimir.error
                }),
            ],
        }
    }
}

/// The power of the step with which the largest energy error grows, over the smallest steps.
pub(crate) fn growth(errors: Curve<'_>) -> f64 {
    match errors.points().get(..6) {
        Some([first, .., last]) => (last.1 / first.1).ln() / (last.0 / first.0).ln(),
        _ => f64::NAN,
    }
}

/// The steps with which these errors are smaller than the others: the ends of ranges of steps that were tried, up to the step from which on both
/// exceed 1 J: there neither follows the motion, and chance says which is larger.
pub(crate) fn better(ours: Curve<'_>, theirs: Curve<'_>) -> Vec<(f64, f64)> {
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    let mut goes_on = false;
    for (&(step, error), (_, other)) in ours.points().iter().zip(theirs.points()) {
        if error.min(*other) > 1.0 {
            break;
        }
        let is_better = error < *other;
        match ranges.last_mut().filter(|_| goes_on) {
            Some(range) if is_better => range.1 = step,
            _ if is_better => ranges.push((step, step)),
            _ => {}
        }
        goes_on = is_better;
    }
    ranges
}

/// Where each method is better than RK4, and up to which step it comes.
pub(crate) fn caption(data: &Data) -> Caption {
    let energy = |method| data.curve(1, method);
    let mut caption = vec![
        paragraph![
            given("I = diag(1, 2, 2.5) kg m², mgχ = (0.3, 0.2, 1) N m, |Π₀| = 1.7 kg m²/s"),
            ", for ",
            given(DURATION),
            " s. A step of order ",
            given(4),
            " is made of five, one of order ",
            given(6),
            " is one equation. RKMK4, rings, is on RK4."
        ],
        paragraph![
            "Over the six smallest steps RK4's largest energy error grows like h to the power ",
            with_places(growth(energy(RK4)), 0),
            ". Our Casimir errors are roundoff with every step."
        ],
    ];
    let mut pieces: Vec<Piece> = vec!["The energy error is smaller than RK4's".into()];
    for (k, method) in [EXPONENTIAL, CAYLEY, ORDER_4, HAMILTON_JACOBI].into_iter().enumerate() {
        pieces.extend([if k > 0 { "; with ".into() } else { " with ".into() }, given(method)]);
        let ranges = better(energy(method), energy(RK4));
        if ranges.is_empty() {
            pieces.push(verdict(" at none of these steps"));
        }
        for (k, (low, high)) in ranges.into_iter().enumerate() {
            pieces.push(if k > 0 { " and from ".into() } else { " from h = ".into() });
            pieces.extend([with_places(low, 2), " s to ".into(), with_places(high, 2), " s".into()]);
        }
    }
    pieces.push(". It is compared up to where both exceed ".into());
    pieces.extend([given(1), " J.".into()]);
    caption.push(Paragraph(pieces));
    let mut pieces: Vec<Piece> = vec!["The largest step tried with which a run came to its end was ".into()];
    for (k, method) in [EXPONENTIAL, CAYLEY, ORDER_4, HAMILTON_JACOBI, RK4, RKMK4].into_iter().enumerate() {
        let largest = energy(method).points().last().map_or(f64::NAN, |point| point.0);
        let separate = if k > 0 { ", " } else { "" };
        pieces.extend([separate.into(), with_places(largest, 2), " s with ".into(), given(method)]);
    }
    pieces.push(".".into());
    caption.push(Paragraph(pieces));
    caption
}

fn method(name: &'static str, run: impl Fn(f64) -> Option<(DriftStats, DriftStats)>) -> Method {
    let mut method = Method { name, trials: Vec::new() };
    let steps = (0..).map(|k| SMALLEST * RATIO.powi(k)).take_while(|&step| step <= LARGEST);
    for step in steps {
        if let Some((energy, casimir)) = run(step) {
            method.trials.push(Trial { step, energy, casimir });
        }
    }
    method
}

/// How many steps the duration is.
fn count(step: f64, duration: f64) -> u64 {
    (duration / step).round() as u64
}

fn ours(
    scheme: (setup::Method, Retraction, Order),
    step: f64,
    duration: f64,
) -> Option<(DriftStats, DriftStats)> {
    let (top, start) = top();
    let by_hand = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
    let [mut energy, mut casimir] = invariants(&by_hand, &body(&start)).map(DriftStats::new);
    let run = each_step(&top, &start, scheme, (step, count(step, duration)), |_, time, state| {
        let now = invariants(&by_hand, &body(state));
        energy.push(time, now[0]);
        casimir.push(time, now[1]);
    });
    run.ok().map(|_| (energy, casimir))
}

fn classical<I>(method: &I, step: f64, duration: f64) -> Option<(DriftStats, DriftStats)>
where
    I: Integrator<bodies::HeavyTop, AttitudeState<6>>,
{
    let (top, start) = top();
    let by_hand = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
    let from = AttitudeState { attitude: start.attitude, y: body(&start) };
    let [mut energy, mut casimir] = invariants(&by_hand, &from.y).map(DriftStats::new);
    let run = integrate(method, &by_hand, 0.0, from, step, count(step, duration), |_, time, state| {
        let now = invariants(&by_hand, &state.y);
        energy.push(time, now[0]);
        casimir.push(time, now[1]);
    });
    run.ok().map(|_| (energy, casimir))
}
