//! Jacobians of steps at states drawn to cancel: finite, and those of differences in twice the digits.

use coadjoint::certify::Frame;
use coadjoint::erased::{At, Equation, RetractionKind, System, Trial, units};
use coadjoint::scheme::Rule;

use crate::campaign::{Draw, Drawer, KINDS, Kind, RULES, states};
use crate::{cancelling, released, settled, springs, zeros};

/// How far columns may be off, relative to what is of one unit with them.
const OFF: f64 = 1e-9;

/// The derivative at 0 of a curve, by central differences of order 8.
fn derivative(e: f64, curve: &mut dyn FnMut(f64) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
    let mut sum = Vec::new();
    for (k, weight) in (1..).zip([4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0]) {
        let at = f64::from(k) * e;
        let (after, before) = (curve(at)?, curve(-at)?);
        sum.resize(after.len(), 0.0);
        for (sum, (after, before)) in sum.iter_mut().zip(after.iter().zip(before)) {
            *sum += (after - before) * (weight / e);
        }
    }
    Some(sum)
}

/// Where a state's numbers go with each component of a tangent vector.
fn directions(system: &dyn System, state: &[f64], scale: &[f64]) -> Vec<Vec<f64>> {
    let along = |j: usize| {
        let mut curve = |by: f64| {
            let mut tangent = vec![0.0; scale.len()];
            tangent[j] = by;
            Some(system.displace(state, RetractionKind::Exponential, &tangent))
        };
        derivative(0.01 * scale[j], &mut curve).expect("states")
    };
    (0..scale.len()).map(along).collect()
}

/// The same of the numbers of the state after a step, by differences of steps in twice the digits. None where there is no step.
fn by_differences(
    equation: &dyn Equation,
    parameters: &[f64],
    at: &At<'_>,
    direction: &[f64],
    e: f64,
    is_smooth: bool,
) -> Option<Vec<f64>> {
    let step = |by: f64| {
        let parts = at.state.iter().zip(direction).map(|(x, d)| {
            let moved = x + by * d;
            (moved, (x - moved) + by * d)
        });
        let (state, rest): (Vec<f64>, Vec<f64>) = parts.unzip();
        let there = At::new(at.step, &state, at.time, at.control);
        Some(Trial::new(equation, parameters, &there, &rest).directly()?.next())
    };
    if is_smooth {
        return derivative(e, &mut |by| step(by).map(|[next, _]| next));
    }
    let ([after, more], [before, less]) = (step(e)?, step(-e)?);
    let differences = after.iter().zip(&before).zip(more.iter().zip(&less));
    Some(
        differences
            .map(|((after, before), (more, less))| ((after - before) + (more - less)) / (2.0 * e))
            .collect(),
    )
}

#[derive(Default)]
struct Tally {
    compared: usize,
    worst: f64,
    wrong: Vec<String>,
}

/// Compares a step's Jacobian with differences.
fn compare(
    tally: &mut Tally,
    draw: &Draw,
    drawer: &Drawer<'_>,
    (map, rule): (RetractionKind, Rule),
    name: &str,
) {
    let Draw { kind, system, state, control, time, step, .. } = draw;
    let system = &**system;
    let at = At::new(*step, state, *time, control);
    let Some(Ok(linearization)) = system.linearization(map, rule, &at) else { return };
    let what = || {
        format!(
            "{name} {map:?} {rule:?} {kind:?}: parameters {:?}, state {state:?}, control {control:?}, time {time:?}, step {step:?}",
            system.parameters()
        )
    };
    // where states are of other sizes than the example, differences are too
    let here = match kind {
        Kind::Far | Kind::Units => Frame::new(system, state, control, *time),
        _ => None,
    };
    let (parameters, scale) = (system.parameters(), &here.as_ref().unwrap_or(&drawer.around).scale);
    let equation = system.equation(map, rule, &at).expect("as there are derivatives");
    let mut trial = Trial::new(&*equation, &parameters, &at, &[]);
    let Some(solved) = trial.directly().filter(|solved| solved.is_good) else { return };
    // what is far off by rounding has no digits to compare
    let blocks = drawer.around.blocks();
    if units(&linearization.next, &solved.next(), &trial.allowed(&solved), &blocks).allowed > 1e-12 {
        return;
    }
    let jacobian = &linearization.jacobian.state;
    let from = directions(system, state, scale);
    let to = directions(system, &linearization.next, scale);
    let columns = from.iter().enumerate().map(|(j, direction)| {
        let size = scale[j];
        let along = |e, is_smooth| {
            let column = by_differences(&*equation, &parameters, &at, direction, e * size, is_smooth)?;
            Some(column.iter().map(|x| x * size).collect::<Vec<f64>>())
        };
        // elementary functions have the digits of one number, and what is kinked has no eighth order
        [along(1e-9, false), along(1e-3, true)]
    });
    let columns: Vec<_> = columns.collect();
    let said = |i: usize, j: usize| -> f64 {
        (0..to.len()).map(|k| to[k][i] * jacobian[(k, j)]).sum::<f64>() * scale[j]
    };
    if !jacobian.iter().all(|x| x.is_finite()) {
        tally.wrong.push(format!("not finite: {}", what()));
        return;
    }
    let mut off = 0.0_f64;
    for block in &blocks {
        let most = |numbers: &dyn Fn(usize) -> f64| {
            block.iter().fold(0.0_f64, |most, i| most.max(numbers(*i).abs()))
        };
        let size = (0..scale.len()).fold(0.0_f64, |size, j| size.max(most(&|i| said(i, j))));
        for (j, found) in columns.iter().enumerate() {
            let errors = found.iter().flatten().map(|column| most(&|i| column[i] - said(i, j)));
            off = off.max(errors.fold(f64::INFINITY, f64::min) / size.max(f64::MIN_POSITIVE));
        }
    }
    tally.compared += 1;
    tally.worst = tally.worst.max(off);
    if !(off <= OFF) {
        tally.wrong.push(format!("off by {off:e}: {}", what()));
    }
}

#[test]
fn jacobians_are_those_of_differences() {
    let subjects = [
        cancelling::subjects(),
        released::subjects(),
        settled::subjects(),
        springs::subjects(),
        zeros::subjects(),
    ];
    let mut all = Tally::default();
    for subject in subjects.iter().flatten() {
        let mut tally = Tally::default();
        for (m, map) in RetractionKind::ALL.into_iter().enumerate() {
            for (r, rule) in RULES.into_iter().enumerate() {
                let mut drawer = Drawer::new(subject, (17 * m + r) as u64);
                for k in 0..states() {
                    let Some(draw) = drawer.draw(KINDS[k % KINDS.len()]) else { continue };
                    compare(&mut tally, &draw, &drawer, (map, rule), subject.name());
                }
            }
        }
        if tally.compared > 0 {
            println!("{:12} {:6} compared, {:.1e} at most", subject.name(), tally.compared, tally.worst);
        }
        all.compared += tally.compared;
        all.wrong.extend(tally.wrong);
    }
    let told: String = all.wrong.iter().map(|line| format!("\n  {line}")).collect();
    assert!(all.wrong.is_empty(), "{} Jacobians of {} are wrong:{told}", all.wrong.len(), all.compared);
    assert!(all.compared > 1000, "{}", all.compared);
}
