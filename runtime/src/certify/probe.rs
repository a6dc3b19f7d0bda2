//! A step's kernels, looked at one after the other: their Newton corrections, or the step itself in twice the digits.

use nalgebra::DVector;

use super::frame::{jacobian, larger};
use super::measure::Claimed;
use crate::erased::{At, Equation, Solved, Trial, equation};
use crate::schemes::Scheme;
use crate::system::{Generated, System};

/// A kernel that a step is made of: its own step, and its equation.
pub type KernelPart = (f64, Box<dyn Equation>);

/// Makes the equation of a step that is one generated kernel.
pub fn kernel<S, M>(system: &S, index: usize, at: &At<'_>) -> Option<KernelPart>
where
    S: Generated<M> + System<Scalar = f64>,
{
    let parameters = system.to_parameters();
    (index == 0).then(|| (at.step, equation::<S::Kernel<f64>>(parameters.as_ref(), at)))
}

/// The numbers of a state with what they leave out, and what rounding may leave of each, all kernels together.
pub(super) type End = ([Vec<f64>; 2], Vec<f64>);

/// Solves an equation in twice the digits.
pub(super) type Solver = fn(&mut Trial<'_>) -> Option<Solved>;

/// The solution that a step without memory takes.
pub(super) fn as_solver(trial: &mut Trial<'_>) -> Option<Solved> {
    trial.as_solver().filter(|solved| solved.is_good)
}

/// The solution that is found by whatever way, if there is one alone: of the solver's own rules this knows none.
pub(super) fn by_all_ways(trial: &mut Trial<'_>) -> Option<Solved> {
    let (direct, continued) = (trial.directly()?, trial.continued()?);
    (direct.is_good && trial.is_same(&direct, &continued)).then_some(direct)
}

impl Claimed<'_> {
    /// The largest difference between Newton corrections of a step's kernels and those that a Jacobian of differences
    /// makes, if there is anything to solve for.
    pub(super) fn corrections(&self, at: &At<'_>) -> Option<f64> {
        let kernels = (0..).map_while(|index| (self.kernels)(index, at));
        kernels.filter_map(|(_, equation)| compare(&*equation)).reduce(larger)
    }

    /// The state after a step, its kernels in turns. None if there are no kernels, or one's equation could not be
    /// solved.
    pub(super) fn end(&self, parameters: &[f64], at: &At<'_>, solver: Solver) -> Option<End> {
        let (mut state, mut time, mut kernels) = (at.state.to_vec(), at.time, 0);
        let (mut left, mut allowed) = (vec![0.0; state.len()], vec![0.0; state.len()]);
        while let Some((step, equation)) = (self.kernels)(kernels, &At { state: &state, time, ..*at }) {
            let at = At { step, state: &state, time, control: at.control };
            let mut trial = Trial::new(&*equation, parameters, &at, &left);
            let solved = solver(&mut trial)?;
            // of steps that are short what one may be off by is handed on as it is
            allowed.iter_mut().zip(trial.allowed(&solved)).for_each(|(sum, more)| *sum += more);
            [state, left] = solved.next();
            (time, kernels) = (time + step, kernels + 1);
        }
        // momenta are carried in space, and brought back into the body: besides what the kernels do
        if matches!(self.definition, Some(Scheme::RightLift(_))) {
            allowed.iter_mut().zip(&state).for_each(|(sum, x)| *sum += CARRIED * f64::EPSILON * x.abs());
        }
        (kernels > 0).then_some(([state, left], allowed))
    }
}

/// What a rotation there and one back may round away, in units in the last place: some sixteen operations each, half a
/// unit each.
const CARRIED: f64 = 16.0;
/// How often a point and its neighbours are brought nearer, if the residual is not finite there: it may be the edge of
/// a domain.
const NEARER: i32 = 12;

/// How often they are then brought nearer still, unless corrections agree to so many digits.
const AGAIN: usize = 4;
const ENOUGH: f64 = 1e-9;

/// The residual, where it is finite.
fn residual(equation: &dyn Equation, unknown: &[f64]) -> Option<DVector<f64>> {
    let [residual, _] = equation.correction(unknown, None);
    residual.iter().all(|x| x.is_finite()).then(|| DVector::from_vec(residual))
}

/// Where corrections are looked at from: the first approximation, or, if that says nothing, on the way to where its
/// correction leads. None if the residual is finite nowhere there.
fn origin(equation: &dyn Equation) -> Option<Vec<f64>> {
    let start = equation.start();
    residual(equation, &start)?;
    if start.iter().any(|x| *x != 0.0) {
        return Some(start);
    }
    // at rest, or where no closed form gives the velocity: nearer to the solution, if it is elsewhere
    let [_, correction] = equation.correction(&start, None);
    (0..NEARER)
        .map(|halvings| correction.iter().map(|x| -x * 0.5_f64.powi(halvings)).collect::<Vec<f64>>())
        .find(|there| residual(equation, there).is_some())
        .or(Some(start))
}

/// The difference between an equation's Newton correction and the one that a Jacobian of differences makes, at a point
/// off the solution. None if there is nothing to solve for, or no such point in whose neighbourhood the residual is
/// finite.
fn compare(equation: &dyn Equation) -> Option<f64> {
    let origin = origin(equation)?;
    let largest = origin.iter().fold(0.0, |x: f64, y| x.max(y.abs()));
    // a component that is small may be so by chance; turns, which stand beside momenta of any size, count in radians
    let floor = if largest > 0.0 { (1e-3 * largest).min(1.0) } else { 0.1 };
    let scales: Vec<f64> = origin.iter().map(|x| x.abs().max(floor)).collect();
    if scales.is_empty() {
        return None;
    }
    let mut figures = (0..NEARER)
        .map(|quarterings| compare_at(equation, &origin, &scales, 0.25_f64.powi(quarterings)))
        .skip_while(Option::is_none);
    // near an edge differences have few digits: what is wrong is so nearer by too
    let mut least = figures.next()??;
    for figure in figures.take(AGAIN).flatten() {
        if !(least > ENOUGH) {
            break;
        }
        least = if figure <= least { figure } else { least };
    }
    Some(least)
}

/// The same at a point so far off, as a part of these scales; none if the residual is not finite all around it.
fn compare_at(equation: &dyn Equation, origin: &[f64], scales: &[f64], part: f64) -> Option<f64> {
    let displaced = origin.iter().zip(scales).enumerate();
    let unknown: Vec<f64> =
        displaced.map(|(i, (x, scale))| x + 0.1 * part * scale * (1.0 + i as f64).sin()).collect();
    let here = residual(equation, &unknown)?;
    // in units in which all corrections are alike
    let jacobian = jacobian(scales.iter().map(|_| part), &mut |i, at| {
        let mut there = unknown.clone();
        there[i] += at * scales[i];
        residual(equation, &there).ok_or(())
    });
    let [_, correction] = equation.correction(&unknown, None);
    let correction = correction.iter().zip(scales).map(|(correction, scale)| correction / scale);
    let correction = DVector::from_iterator(scales.len(), correction);
    Some(match jacobian.ok()?.lu().solve(&here) {
        Some(expected) => (correction - &expected).norm() / expected.norm().max(f64::MIN_POSITIVE),
        None => f64::NAN,
    })
}
