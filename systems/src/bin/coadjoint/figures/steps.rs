//! Large steps for long times: the errors of each method, up to the step at which it fails.

use super::work::{body, invariants, top};
use coadjoint_app::Error;
use coadjoint_app::conservation::DriftStats;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};
use coadjoint_app::simulation::{self, Order, Retraction, each_step};
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
    pub(crate) name: String,
    /// The runs that succeeded.
    pub(crate) trials: Vec<Trial>,
    /// The first step with which a run did not: the equation could not be solved, or the state was not finite.
    pub(crate) breaks: Option<f64>,
}

/// The same top as in [`work`](super::work), for a long time.
#[derive(Clone, Debug)]
pub(crate) struct Steps {
    /// Exponential, Cayley, Cayley of order 4, RK4 on quaternions, RKMK4.
    pub(crate) methods: Vec<Method>,
    duration: f64,
}

impl Method {
    /// The power of the step with which the energy error grows, over the smallest steps.
    pub(crate) fn growth(&self) -> f64 {
        match self.trials.get(..6) {
            Some([first, .., last]) => {
                (last.energy.error / first.energy.error).ln() / (last.step / first.step).ln()
            }
            _ => f64::NAN,
        }
    }

    /// The step from which on this method's energy error is smaller than the other's, up to where the errors of both exceed the energy: there
    /// neither follows the motion, and chance says which is larger.
    pub(crate) fn better_from(&self, other: &Method) -> Option<f64> {
        let pairs = self.trials.iter().zip(&other.trials);
        let pairs = pairs.filter(|(ours, theirs)| ours.energy.error.min(theirs.energy.error) < 1.0);
        let worse = pairs.clone().rfind(|(ours, theirs)| ours.energy.error >= theirs.energy.error);
        let mut better = pairs.filter(|(ours, _)| worse.is_none_or(|(worse, _)| ours.step > worse.step));
        better.next().map(|(ours, _)| ours.step)
    }
}

impl Steps {
    /// Makes the runs.
    ///
    /// # Errors
    /// None; a run that breaks is a result.
    pub(crate) fn measure(duration: f64) -> Result<Self, Error> {
        Ok(Self {
            methods: vec![
                method("exponential", |step| ours(Retraction::Exponential, Order::Two, step, duration)),
                method("Cayley", |step| ours(Retraction::Cayley, Order::Two, step, duration)),
                method("Cayley, order 4", |step| ours(Retraction::Cayley, Order::Four, step, duration)),
                method("RK4 on quaternions, projected", |step| classical(&Rk4Quaternion, step, duration)),
                method("RKMK4", |step| classical(&Rkmk4, step, duration)),
            ],
            duration,
        })
    }

    /// Largest errors against the step.
    pub(crate) fn figure(&self) -> Figure {
        let panel = |title: &str, label: &str, error: fn(&Trial) -> f64| {
            let series = self.methods.iter().map(|method| Series {
                label: method.name.clone(),
                points: method.trials.iter().map(|trial| (trial.step, error(trial))).collect(),
                style: if method.name == "RKMK4" { Style::DashedMarked } else { Style::Marked },
            });
            let horizontal = Axis::logarithmic("step h, s").within(SMALLEST, LARGEST);
            Panel::new(horizontal, Axis::logarithmic(label), series.collect()).titled(title)
        };
        let breaks = self.methods.iter().map(|method| match method.breaks {
            Some(step) => format!("{} breaks at h = {step:.2} s", method.name),
            None => format!("{} comes to its end with every step tried", method.name),
        });
        let growth = self.methods.get(3).map_or(f64::NAN, Method::growth);
        let smaller = self.methods.iter().take(3).map(|method| match self.methods.get(3) {
            Some(rk4) => match method.better_from(rk4) {
                Some(step) => format!("with {} from h = {step:.2} s on", method.name),
                None => format!("with {} from none of these steps on", method.name),
            },
            None => String::new(),
        });
        Figure {
            title: format!("Large steps for a long time: a heavy top for {} s", self.duration),
            caption: vec![
                "I = diag(1, 2, 2.5) kg m², mgχ = (0.3, 0.2, 1) N m, |Π₀| = 1.7 kg m²/s: a turn takes some 6 s. A step of order 4 is made \
                 of five."
                    .to_owned(),
                format!(
                    "RK4's energy error after this time grows like h to the power {growth:.1}, and it grows with the time; ours do not. \
                     The energy error stays below RK4's {}. Our Casimir errors are roundoff with every step.",
                    smaller.collect::<Vec<_>>().join(", ")
                ),
                format!("{}.", breaks.collect::<Vec<_>>().join("; ")),
            ],
            columns: 2,
            cell: (600.0, 440.0),
            key: Key::Below,
            panels: vec![
                panel("(a) energy", "largest |H − H₀|, J", |trial| trial.energy.error),
                panel("(b) Casimir", "largest |Π·Γ − Π₀·Γ₀|, kg m²/s", |trial| trial.casimir.error),
            ],
        }
    }
}

fn method(name: &str, run: impl Fn(f64) -> Option<(DriftStats, DriftStats)>) -> Method {
    let mut method = Method { name: name.to_owned(), trials: Vec::new(), breaks: None };
    let steps = (0..).map(|k| SMALLEST * RATIO.powi(k)).take_while(|&step| step <= LARGEST);
    for step in steps {
        match run(step) {
            Some((energy, casimir)) => method.trials.push(Trial { step, energy, casimir }),
            None => {
                method.breaks.get_or_insert(step);
            }
        }
    }
    method
}

/// How many steps the duration is.
fn count(step: f64, duration: f64) -> u64 {
    (duration / step).round() as u64
}

fn ours(retraction: Retraction, order: Order, step: f64, duration: f64) -> Option<(DriftStats, DriftStats)> {
    let (top, start) = top();
    let by_hand = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
    let [mut energy, mut casimir] = invariants(&by_hand, &body(&start)).map(DriftStats::new);
    let scheme = (simulation::Method::Standard, retraction, order);
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
