//! Every system, with each of its schemes, at states drawn to cancel: what twice the digits solve is not refused, and
//! what is accepted is as good as its operations can be.

use std::collections::BTreeMap;
use std::sync::Arc;

use coadjoint::State;
use coadjoint::certify::{Frame, Linear};
use coadjoint::erased::{At, RetractionKind, Solved, System, Trial, Units, units};
use coadjoint::error::StepError;
use coadjoint::scheme::Rule;
use coadjoint_support::random::Random;
use coadjoint_systems::catalogue::CATALOGUE;

/// How far an accepted step may be off, in units of what rounding may leave.
const MOST: f64 = 8.0;
/// The longest step: half of a radian, or of what else the motion takes to lead to something else entirely.
const LONGEST: f64 = 0.5;
/// The steps that the generator knows.
pub(crate) const RULES: [Rule; 9] = [
    Rule::Family(0, 1),
    Rule::Family(1, 1),
    Rule::Family(1, 2),
    Rule::Family(1, 3),
    Rule::Family(2, 3),
    Rule::Family(1, 4),
    Rule::Family(3, 4),
    Rule::TangentLift(0, 1),
    Rule::TangentLift(1, 2),
];

/// How many states a scheme of a system is tried at, unless `COADJOINT_STATES` says it.
const STATES: usize = 60;

pub(crate) fn states() -> usize {
    std::env::var("COADJOINT_STATES").ok().and_then(|states| states.parse().ok()).unwrap_or(STATES)
}

/// A system with an example of its states.
pub(crate) struct Subject {
    name: String,
    system: Arc<dyn System>,
    state: Vec<f64>,
}

impl Subject {
    /// Of a system of these tests.
    pub(crate) fn of<S: coadjoint::System<Scalar = f64> + System + 'static>(
        system: S,
        state: &S::State,
    ) -> Self {
        let (system, state) = (Arc::new(system), state.to_components().as_ref().to_vec());
        Self { name: S::NAME.to_owned(), system, state }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }
}

/// How a state is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// All numbers at random.
    General,
    /// No momentum.
    AtRest,
    /// A momentum or an advected parameter is zero.
    OneZero,
    /// All but one of them are.
    OneLeft,
    /// The velocity is what is left of momenta that cancel.
    Balanced,
    /// Hardly any momentum.
    Tiny,
    /// Where forces balance, with no momentum or hardly any.
    Settled,
    /// The example's configuration, and all else along one axis.
    Aligned,
    /// A million times as far from the origin as anything else is large.
    Far,
    /// Another unit of mass, a billion times as large or as small.
    Units,
}

pub(crate) const KINDS: [Kind; 10] = [
    Kind::General,
    Kind::AtRest,
    Kind::OneZero,
    Kind::OneLeft,
    Kind::Balanced,
    Kind::Tiny,
    Kind::Settled,
    Kind::Aligned,
    Kind::Far,
    Kind::Units,
];

/// A step to be taken.
pub(crate) struct Draw {
    pub(crate) kind: Kind,
    pub(crate) system: Arc<dyn System>,
    pub(crate) state: Vec<f64>,
    pub(crate) control: Vec<f64>,
    pub(crate) time: f64,
    pub(crate) step: f64,
    /// Steps of one stepper, of which the last is looked at too.
    then: usize,
}

/// Draws steps of a system.
pub(crate) struct Drawer<'a> {
    subject: &'a Subject,
    pub(crate) around: Frame<'a>,
    controls: usize,
    /// The powers with which parameters scale in other units of mass.
    powers: Option<Vec<i32>>,
    random: Random,
}

impl<'a> Drawer<'a> {
    pub(crate) fn new(subject: &'a Subject, seed: u64) -> Self {
        let description = subject.system.description();
        let controls = description.controls.iter().map(|control| control.components.len()).sum();
        let none = vec![0.0; controls];
        let around = Frame::new(&*subject.system, &subject.state, &none, 0.0).expect("local coordinates");
        let mut drawer = Self { subject, around, controls, powers: None, random: Random::new(seed) };
        drawer.powers = drawer.powers();
        drawer
    }

    /// As many momenta as configurations have components.
    fn momenta(&self) -> usize {
        self.around.configuration.len()
    }

    fn unit(&mut self) -> f64 {
        self.random.between(-1.0, 1.0)
    }

    /// A power of ten.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.random.between(low, high))
    }

    fn general(&mut self) -> Vec<f64> {
        let around = self.around.clone();
        let random = &mut self.random;
        let mut state = moved(&around, &self.subject.state, |_| random.between(-1.0, 1.0));
        let size = self.power(-2.0, 0.5);
        for (k, Linear { tangent, component }) in around.linear.iter().enumerate() {
            let by = around.scale[*tangent] * self.unit();
            state[*component] = if k < self.momenta() { size * by } else { state[*component] + 0.5 * by };
        }
        state
    }

    pub(crate) fn draw(&mut self, kind: Kind) -> Option<Draw> {
        let Frame { linear, scale, .. } = self.around.clone();
        let momenta = self.momenta();
        let mut state = self.general();
        let control: Vec<f64> = match self.random.bits() % 2 {
            0 => vec![0.0; self.controls],
            _ => (0..self.controls).map(|_| self.unit()).collect(),
        };
        let time = self.random.one_of(&[0.0, 0.0, 1.7]);
        let place = |k: usize| linear[k].component;
        let mut example = self.subject.state.clone();
        let mut system = self.subject.system.with_parameters(&[]);
        match kind {
            Kind::General => {}
            Kind::AtRest => (0..momenta).for_each(|k| state[place(k)] = 0.0),
            Kind::OneZero => state[place(self.random.bits() as usize % linear.len())] = 0.0,
            Kind::OneLeft => {
                let left = self.random.bits() as usize % linear.len();
                (0..linear.len()).filter(|k| *k != left).for_each(|k| state[place(k)] = 0.0);
            }
            Kind::Balanced => {
                self.balance(&mut state, time, &control);
                if self.random.bits().is_multiple_of(2) {
                    let by = self.power(-14.0, -3.0);
                    for k in 0..momenta {
                        state[place(k)] += by * scale[linear[k].tangent] * self.unit();
                    }
                }
            }
            Kind::Tiny => {
                let by = self.power(-200.0, -6.0);
                (0..momenta).for_each(|k| state[place(k)] *= by);
            }
            Kind::Settled => {
                (0..momenta).for_each(|k| state[place(k)] = 0.0);
                state = self.settled(state, time, &control);
                if self.random.bits().is_multiple_of(2) {
                    let by = self.power(-14.0, -3.0);
                    for k in 0..momenta {
                        state[place(k)] += by * scale[linear[k].tangent] * self.unit();
                    }
                }
            }
            Kind::Aligned => {
                let axis = self.random.bits() as usize % 3;
                let mut aligned = self.subject.state.clone();
                for k in 0..linear.len() {
                    let index = if k < momenta { k } else { k - momenta };
                    aligned[place(k)] = if index % 3 == axis { state[place(k)] } else { 0.0 };
                }
                state = aligned;
            }
            Kind::Far => {
                let far = self.power(2.0, 6.0);
                let (random, around) = (&mut self.random, self.around.clone());
                state = moved(&around, &state, |_| far * random.between(-1.0, 1.0));
            }
            Kind::Units => {
                let by: f64 = self.random.one_of(&[1e9, 1e-9]);
                system = self.in_units(by, self.powers.as_ref()?);
                for state in [&mut state, &mut example] {
                    (0..momenta).for_each(|k| state[place(k)] *= by);
                }
            }
        }
        // not every group has a metric of its own: far from the origin its elements are hardly regular
        let most = |state: &[f64]| state.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let is_near = most(&state) <= 1e7 * most(&example).max(1e3);
        if system.validate().is_err() || !is_near || !(system.deviation(&state) <= 1e-9) {
            return None;
        }
        let rate = rate(&*system, &state, time, &control).max(rate(&*system, &example, time, &control));
        let longest = if rate > 0.0 { LONGEST / rate } else { LONGEST };
        let part = self.random.one_of(&[0.0, 0.0, 1.0, 3.0, 6.0]);
        let step = longest * self.power(-part, 0.0) * self.random.one_of(&[1.0, 1.0, 1.0, -1.0]);
        let then = self.random.one_of(&[0, 0, 2, 5, 30]);
        Some(Draw { kind, system, state, control, time, step, then })
    }

    /// The system with parameters that scale so.
    fn in_units(&self, by: f64, powers: &[i32]) -> Arc<dyn System> {
        let system = &self.subject.system;
        let mut parameters = system.parameters();
        let lengths = system.description().parameters.iter().map(|quantity| quantity.components.len());
        let mut places = parameters.iter_mut();
        for (length, power) in lengths.zip(powers) {
            places.by_ref().take(length).for_each(|x| *x *= by.powi(*power));
        }
        system.with_parameters(&parameters)
    }

    /// With which powers parameters scale where momenta, and so energies, have another unit of mass: found by trying.
    /// None if with none.
    fn powers(&mut self) -> Option<Vec<i32>> {
        let states = [self.general(), self.general()];
        let energy = |system: &dyn System, state: &[f64]| system.energy(state, 0.0, &[]);
        let count = self.subject.system.description().parameters.len();
        let of = |code: usize| {
            (0..count).map(|k| [1, 0, -1][code / 3_usize.pow(k as u32) % 3]).collect::<Vec<i32>>()
        };
        (0..3_usize.pow(count as u32)).map(of).find(|powers| {
            let other = self.in_units(2.0, powers);
            states.iter().all(|state| {
                let mut scaled = state.clone();
                self.around.linear[..self.momenta()].iter().for_each(|of| scaled[of.component] *= 2.0);
                let [one, two] = [energy(&*self.subject.system, state), energy(&*other, &scaled)];
                (two - 2.0 * one).abs() <= 1e-9 * one.abs()
            })
        })
    }

    /// Momenta with which the configuration stays where it is, as far as there are such.
    fn balance(&self, state: &mut [f64], time: f64, control: &[f64]) {
        let Frame { linear, scale, configuration, .. } = &self.around;
        let system = &*self.subject.system;
        let n = configuration.len();
        let velocity = |state: &[f64]| -> Vec<f64> {
            let motion = system.motion(state, time, control);
            configuration.iter().map(|i| motion[*i]).collect()
        };
        for _ in 0..3 {
            let here = velocity(state);
            // by the velocity's change with each momentum: Gauss–Seidel's way is enough where momenta are nearly of
            // their own axes
            let mut matrix = vec![vec![0.0; n + 1]; n];
            for k in 0..n {
                let mut there = state.to_vec();
                there[linear[k].component] += scale[linear[k].tangent];
                for (row, (there, here)) in velocity(&there).iter().zip(&here).enumerate() {
                    matrix[row][k] = there - here;
                }
            }
            for (row, here) in here.iter().enumerate() {
                matrix[row][n] = *here;
            }
            let Some(by) = eliminated(matrix) else { return };
            for (k, by) in by.iter().enumerate() {
                state[linear[k].component] -= by * scale[linear[k].tangent];
            }
        }
    }

    /// Down the energy's slope, to where forces balance.
    fn settled(&self, mut state: Vec<f64>, time: f64, control: &[f64]) -> Vec<f64> {
        let (system, around) = (&*self.subject.system, &self.around);
        let mut length = 0.3;
        for _ in 0..200 {
            let differential = system.differential(&state, time, control);
            let slope: Vec<f64> =
                around.configuration.iter().map(|i| differential[*i] * around.scale[*i]).collect();
            let size = slope.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            if !(size > 0.0 && size.is_finite()) {
                break;
            }
            let next = moved(around, &state, |k| -length * slope[k] / size);
            // where it is lower, or else nearer
            if system.energy(&next, time, control) < system.energy(&state, time, control) {
                state = next;
            } else {
                length *= 0.6;
            }
        }
        state
    }
}

/// The state with its configurations displaced by multiples of their scales.
fn moved(around: &Frame<'_>, state: &[f64], by: impl FnMut(usize) -> f64) -> Vec<f64> {
    let mut tangent = vec![0.0; around.scale.len()];
    let by = (0..around.configuration.len()).map(by);
    for (&i, by) in around.configuration.iter().zip(by) {
        tangent[i] = by * around.scale[i];
    }
    around.displace(state, RetractionKind::Exponential, &tangent)
}

/// One over the time in which the motion from a state leads to something else entirely.
fn rate(system: &dyn System, state: &[f64], time: f64, control: &[f64]) -> f64 {
    let rate = Frame::new(system, state, control, time).map_or(0.0, |around| around.rate);
    if rate.is_finite() { rate } else { 0.0 }
}

/// The solution of linear equations, by elimination; their right sides are the last column.
fn eliminated(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, pivot);
        if !(rows[k][k].abs() > 1e-300) {
            return None;
        }
        for other in (0..n).filter(|other| *other != k) {
            let (factor, row) = (rows[other][k] / rows[k][k], rows[k].clone());
            rows[other].iter_mut().zip(&row).skip(k).for_each(|(x, by)| *x -= factor * by);
        }
    }
    Some((0..n).map(|k| rows[k][n] / rows[k][k]).collect())
}

/// What became of steps.
#[derive(Default)]
struct Tally {
    tried: usize,
    accepted: usize,
    /// Refused, and so they should be: twice the digits find no solution either, or none that is good.
    refused: usize,
    /// Refused where twice the digits find a solution by one way and none, or another, by the other.
    doubtful: usize,
    /// Accepted where twice the digits find none.
    unverified: usize,
    worst: f64,
    /// How far steps were off, by powers of two from 1/16 unit on.
    spread: [usize; 12],
    /// Bounds that are more than a millionth of the state: they say little.
    wide: usize,
    wrong: Vec<String>,
    notes: Vec<String>,
}

impl Tally {
    fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.accepted += other.accepted;
        self.refused += other.refused;
        self.doubtful += other.doubtful;
        self.unverified += other.unverified;
        self.wide += other.wide;
        self.worst = self.worst.max(other.worst);
        self.spread.iter_mut().zip(other.spread).for_each(|(a, b)| *a += b);
        self.wrong.extend(other.wrong);
        self.notes.extend(other.notes);
    }

    /// A step that was accepted.
    fn accept(
        &mut self,
        trial: &mut Trial<'_>,
        next: &[f64],
        blocks: &[Vec<usize>],
        what: &dyn Fn() -> String,
    ) {
        self.accepted += 1;
        let direct = trial.directly().filter(|solved| solved.is_good);
        let mut found =
            direct.as_ref().map(|solved| units(next, &solved.next(), &trial.allowed(solved), blocks));
        if found.is_none_or(|found| !(found.of_rounding <= MOST)) {
            let continued = trial.continued().filter(|solved| solved.is_good);
            let agree = matches!((&direct, &continued), (Some(a), Some(b)) if trial.is_same(a, b));
            if !agree {
                let more = [continued, trial.as_solver().filter(|solved| solved.is_good)];
                for solved in more.into_iter().flatten() {
                    let other = units(next, &solved.next(), &trial.allowed(&solved), blocks);
                    if found.is_none_or(|found| !(found.of_rounding <= other.of_rounding)) {
                        found = Some(other);
                    }
                }
            }
        }
        let Some(Units { of_rounding, block, allowed }) = found else {
            self.unverified += 1;
            self.notes.push(format!("unverified: {}", what()));
            return;
        };
        self.worst = self.worst.max(of_rounding);
        let place = (of_rounding.max(1e-9).log2() + 4.0).clamp(0.0, 11.0) as usize;
        self.spread[place] += 1;
        self.wide += usize::from(allowed > 1e-6);
        if !(of_rounding <= MOST) {
            self.wrong
                .push(format!("{of_rounding:.2} units (of {allowed:.1e}) in block {block}: {}", what()));
        }
    }

    /// A step that was refused.
    fn refuse(&mut self, trial: &mut Trial<'_>, error: StepError, what: &dyn Fn() -> String) {
        let good = |solved: Option<Solved>| solved.filter(|solved| solved.is_good);
        match (good(trial.directly()), good(trial.continued())) {
            (Some(a), Some(b)) if trial.is_same(&a, &b) => {
                self.wrong.push(format!("refused with {error:?}: {}", what()));
            }
            (None, None) => {
                self.refused += 1;
                self.notes.push(format!("refused with {error:?}: {}", what()));
            }
            (a, b) => {
                self.doubtful += 1;
                let found = [a.is_some(), b.is_some()];
                self.notes.push(format!("doubtful {found:?}, {error:?}: {}", what()));
            }
        }
    }
}

fn tried(
    draw: &Draw,
    blocks: &[Vec<usize>],
    (map, rule): (RetractionKind, Rule),
    name: &str,
) -> Option<Tally> {
    let Draw { kind, system, state, control, time, step, then: most } = draw;
    let mut tally = Tally::default();
    let mut method = system.method(map, rule, *step)?;
    let (mut state, mut next) = (state.clone(), state.clone());
    for taken in 0..=*most {
        let time = time + taken as f64 * step;
        // the motion may have become too fast for the step, or be before the step is over
        let then = if taken == 0 { time + step } else { time };
        if (taken > 0 || then != time) && rate(&**system, &state, then, control) * step.abs() > 1.01 * LONGEST
        {
            break;
        }
        let outcome = method.advance(&state, &mut next, time, control, taken > 0);
        if taken == 0 || taken == *most || outcome.is_err() {
            tally.tried += 1;
            let at = At::new(*step, &state, time, control);
            let equation = system.equation(map, rule, &at)?;
            let mut trial = Trial::new(&*equation, &system.parameters(), &at, &[]);
            let what = || {
                format!(
                    "{name} {map:?} {rule:?} {kind:?} after {taken}: parameters {:?}, state {state:?}, control {control:?}, time {time:?}, step {step:?}",
                    system.parameters()
                )
            };
            match outcome {
                Ok(_) => tally.accept(&mut trial, &next, blocks, &what),
                Err(failure) => {
                    tally.refuse(&mut trial, failure.first(), &what);
                    break;
                }
            }
        }
        core::mem::swap(&mut state, &mut next);
    }
    Some(tally)
}

/// Tries so many states for each scheme, and tells what came of it.
fn campaign(subjects: &[Subject]) {
    let states = states();
    let mut total = Tally::default();
    let mut lines = Vec::new();
    for subject in subjects {
        let mut of_system = Tally::default();
        let mut by_kind: BTreeMap<Kind, Tally> = BTreeMap::new();
        for (m, map) in RetractionKind::ALL.into_iter().enumerate() {
            for (r, rule) in RULES.into_iter().enumerate() {
                if subject.system.method(map, rule, 1.0).is_none() {
                    continue;
                }
                let mut drawer = Drawer::new(subject, (17 * m + r) as u64);
                for k in 0..states {
                    let kind = KINDS[k % KINDS.len()];
                    let Some(draw) = drawer.draw(kind) else { continue };
                    if let Some(tally) = tried(&draw, &drawer.around.blocks(), (map, rule), &subject.name) {
                        by_kind.entry(kind).or_default().add(tally);
                    }
                }
            }
        }
        for (kind, tally) in by_kind {
            if std::env::var_os("COADJOINT_KINDS").is_some() {
                lines.push(line(&format!("  {kind:?}"), &tally));
            }
            of_system.add(tally);
        }
        lines.push(line(&subject.name, &of_system));
        total.add(of_system);
    }
    lines.push(line("all", &total));
    println!(
        "{:24} {:>7} {:>8} {:>7} {:>8} {:>7} {:>5} {:>6} {:>8}",
        "", "tried", "accepted", "refused", "doubtful", "unverif", "wrong", "wide", "worst"
    );
    println!("{}", lines.join("\n"));
    println!("units by powers of two from 1/16 on: {:?}", total.spread);
    for note in &total.notes {
        println!("{note}");
    }
    let told: String = total.wrong.iter().map(|line| format!("\n  {line}")).collect();
    assert!(total.wrong.is_empty(), "{} steps are wrong:{told}", total.wrong.len());
}

fn line(name: &str, tally: &Tally) -> String {
    let Tally { tried, accepted, refused, doubtful, unverified, worst, wide, wrong, .. } = tally;
    format!(
        "{name:24} {tried:>7} {accepted:>8} {refused:>7} {doubtful:>8} {unverified:>7} {:>5} {wide:>6} {worst:>8.2}",
        wrong.len()
    )
}

#[test]
fn systems_of_the_field() {
    use crate::{cancelling, far, released, settled, springs, zeros};

    let subjects = [cancelling::subjects(), far::subjects(), released::subjects(), settled::subjects()];
    let more = [springs::subjects(), zeros::subjects()];
    campaign(&subjects.into_iter().chain(more).flatten().collect::<Vec<_>>());
}

#[test]
fn the_catalogue() {
    let only = std::env::var("COADJOINT_SYSTEM").ok();
    let subjects: Vec<Subject> = CATALOGUE
        .entries()
        .iter()
        .filter(|entry| only.as_ref().is_none_or(|only| *only == entry.name))
        .map(|entry| Subject {
            name: entry.name.to_owned(),
            // its type is not that of ensembles
            system: entry.system(&[]).with_parameters(&entry.example.parameters),
            state: entry.example.state.clone(),
        })
        .collect();
    campaign(&subjects);
}
