//! Derivatives of steps by dual numbers: what derivatives in closed form are compared with.
//!
//! The generated code of a step takes any scalar, dual numbers too, and Newton's iteration on them finds the derivative of the solution with
//! the solution. Nothing of what the derivatives in closed form are made of has a part in it.

use coadjoint::__private::Kernel;
use coadjoint::__private::Scalar;
use coadjoint::composition::{Coefficients, Composed};
use coadjoint::prelude::*;
use coadjoint::scheme::{Family, TangentLift};
use coadjoint::system::{Generated, Kind, Quantity, Role};
use coadjoint::{Control, Side, State, System};
use num_dual::Dual64;

use crate::array;

/// A scheme whose steps can be taken with any numbers.
pub trait AnyStep<S: System> {
    /// The state after a step.
    fn step<T: Scalar>(
        parameters: &S::Parameters<T>,
        step: T,
        state: &S::StateComponents<T>,
        time: T,
        control: &S::ControlComponents<T>,
    ) -> S::StateComponents<T>;
}

/// Enough for Newton's iteration from the state to come to rest, its derivative too.
const ITERATIONS: usize = 25;

/// One step of generated code.
pub fn solved<T: Scalar, K: Kernel<T>>(
    parameters: &K::Parameters,
    step: T,
    state: &K::State,
    time: T,
    control: &K::Control,
) -> K::State {
    let kernel = K::new(parameters, step);
    let begun = kernel.begin(state, time, control);
    let mut unknown = kernel.start(state, &begun);
    for _ in 0..ITERATIONS {
        let evaluation = kernel.evaluate(state, &begun, &unknown);
        let correction = kernel.correction(state, &begun, &unknown, &evaluation);
        unknown = array(|i| unknown.as_ref()[i] - correction.as_ref()[i]);
    }
    kernel.finish(state, &begun, &unknown, &kernel.evaluate(state, &begun, &unknown))
}

impl<S: Generated<Self>, R, const N: u32, const D: u32> AnyStep<S> for Family<R, N, D> {
    fn step<T: Scalar>(
        parameters: &S::Parameters<T>,
        step: T,
        state: &S::StateComponents<T>,
        time: T,
        control: &S::ControlComponents<T>,
    ) -> S::StateComponents<T> {
        solved::<T, S::Kernel<T>>(parameters, step, state, time, control)
    }
}

impl<S: Generated<Self>, R, const N: u32, const D: u32> AnyStep<S> for TangentLift<R, N, D> {
    fn step<T: Scalar>(
        parameters: &S::Parameters<T>,
        step: T,
        state: &S::StateComponents<T>,
        time: T,
        control: &S::ControlComponents<T>,
    ) -> S::StateComponents<T> {
        solved::<T, S::Kernel<T>>(parameters, step, state, time, control)
    }
}

impl<S, R> AnyStep<S> for StormerVerlet<R>
where
    S: Generated<SymplecticEulerA<R>> + Generated<SymplecticEulerB<R>>,
{
    fn step<T: Scalar>(
        parameters: &S::Parameters<T>,
        step: T,
        state: &S::StateComponents<T>,
        time: T,
        control: &S::ControlComponents<T>,
    ) -> S::StateComponents<T> {
        let half = T::of(0.5) * step;
        let middle = <SymplecticEulerA<R> as AnyStep<S>>::step(parameters, half, state, time, control);
        <SymplecticEulerB<R> as AnyStep<S>>::step(parameters, half, &middle, time + half, control)
    }
}

impl<S: System, C: Coefficients, M: AnyStep<S>> AnyStep<S> for Composed<C, M> {
    fn step<T: Scalar>(
        parameters: &S::Parameters<T>,
        step: T,
        state: &S::StateComponents<T>,
        time: T,
        control: &S::ControlComponents<T>,
    ) -> S::StateComponents<T> {
        let (mut state, mut time) = (*state, time);
        for &gamma in C::GAMMA {
            let part = T::of(gamma) * step;
            state = M::step(parameters, part, &state, time, control);
            time = time + part;
        }
        state
    }
}

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A component of a change of the state, in the coordinates of tangent vectors.
    State(usize),
    /// A component of the controls.
    Control(usize),
    /// A component of the parameters.
    Parameters(usize),
}

/// A column of the derivative of a step of the scheme `M`.
pub fn column<S, M>(
    system: &S,
    step: f64,
    state: &S::State,
    time: f64,
    control: &S::Control,
    input: Input,
) -> Vec<f64>
where
    S: System<Scalar = f64>,
    M: AnyStep<S>,
{
    let (place, parameters, control) =
        (state.to_components(), system.to_parameters(), control.to_components());
    let start = perturbed(S::SIDE, S::State::QUANTITIES, place.as_ref(), input);
    let by = match input {
        Input::Parameters(index) => unit_of_parameters(S::PARAMETERS, index),
        _ => Vec::new(),
    };
    let parameters = array(|i| Dual64::new(parameters.as_ref()[i], by.get(i).copied().unwrap_or_default()));
    let control =
        array(|i| Dual64::new(control.as_ref()[i], f64::from(u8::from(input == Input::Control(i)))));
    let start = array(|i| start[i]);
    let end = M::step(&parameters, Dual64::from_re(step), &start, Dual64::from_re(time), &control);
    changed(S::SIDE, S::State::QUANTITIES, end.as_ref())
}

/// How the parameters that steps are made of change where one that the user gives does: of a symmetric matrix it is the symmetric part.
fn unit_of_parameters(quantities: &[Quantity], index: usize) -> Vec<f64> {
    let mut unit = vec![0.0; quantities.iter().map(|quantity| quantity.components.len()).sum()];
    let mut from = 0;
    for quantity in quantities {
        let all = from..from + quantity.components.len();
        from = all.end;
        if !all.contains(&index) {
            continue;
        }
        let of = index - all.start;
        let mirrored = match quantity.kind {
            Kind::SymmetricMatrix(n) => of % n * n + of / n,
            _ => of,
        };
        unit[index] += 0.5;
        unit[all.start + mirrored] += 0.5;
    }
    unit
}

/// A state's components, changed where a component of its change is what changes.
fn perturbed(side: Side, quantities: &[Quantity], place: &[f64], input: Input) -> Vec<Dual64> {
    let mut start: Vec<Dual64> = place.iter().map(|&x| Dual64::from_re(x)).collect();
    let (mut stored, mut trivialized) = (0, 0);
    for quantity in quantities {
        let (n, dimension) = (quantity.components.len(), dimension(quantity));
        if let Input::State(index) = input
            && (trivialized..trivialized + dimension).contains(&index)
        {
            let mut unit = vec![0.0; dimension];
            unit[index - trivialized] = 1.0;
            let change = tangent(side, quantity, &place[stored..stored + n], &unit);
            start[stored..stored + n].iter_mut().zip(change).for_each(|(x, change)| x.eps = change);
        }
        stored += n;
        trivialized += dimension;
    }
    start
}

/// The change of a state, in the coordinates of tangent vectors.
fn changed(side: Side, quantities: &[Quantity], end: &[Dual64]) -> Vec<f64> {
    let (re, eps): (Vec<f64>, Vec<f64>) = end.iter().map(|x| (x.re, x.eps)).unzip();
    let mut column = Vec::new();
    let mut stored = 0;
    for quantity in quantities {
        let all = stored..stored + quantity.components.len();
        column.extend(trivial(side, quantity, &re[all.clone()], &eps[all.clone()]));
        stored = all.end;
    }
    column
}

/// How many numbers a change of a part of the state is.
pub fn dimension(quantity: &Quantity) -> usize {
    match (quantity.role, quantity.components) {
        (Role::Configuration, ["re", "im"]) => 1,
        (Role::Configuration, ["re", "im", ..] | ["w", "x", "y", "z"]) => 3,
        (Role::Configuration, ["w", ..] | [_, _, _, _, _, _, _]) => 6,
        (_, components) => components.len(),
    }
}

fn quaternion(parts: &[f64]) -> Quaternion<f64> {
    Quaternion::new(parts[0], parts[1], parts[2], parts[3])
}

/// The change of the stored components of `g` where this becomes `g exp(δ)`, or `exp(δ) g`.
fn tangent(side: Side, quantity: &Quantity, g: &[f64], change: &[f64]) -> Vec<f64> {
    if quantity.role != Role::Configuration || g.len() == change.len() {
        return change.to_vec();
    }
    let turned = |q: &[f64], angle: &[f64]| {
        let angle = Quaternion::new(0.0, angle[0], angle[1], angle[2]);
        let q = match side {
            Side::Left => quaternion(q) * angle * 0.5,
            Side::Right => angle * quaternion(q) * 0.5,
        };
        vec![q.w, q.i, q.j, q.k]
    };
    match g.len() {
        2 => vec![-g[1] * change[0], g[0] * change[0]],
        4 if change.len() == 3 && quantity.components[0] == "re" => {
            let (turn, x, y) = (change[0], change[1], change[2]);
            let shift = match side {
                Side::Left => [g[0] * x - g[1] * y, g[1] * x + g[0] * y],
                Side::Right => [x - turn * g[3], y + turn * g[2]],
            };
            vec![-g[1] * turn, g[0] * turn, shift[0], shift[1]]
        }
        4 => turned(g, change),
        _ => {
            let [turn, along, place] = [&change[..3], &change[3..], &g[4..]].map(Vector3::from_column_slice);
            let shift = match side {
                Side::Left => UnitQuaternion::new_unchecked(quaternion(&g[..4])) * along,
                Side::Right => along + turn.cross(&place),
            };
            let mut all = turned(&g[..4], &change[..3]);
            all.extend(shift.iter());
            all
        }
    }
}

/// The other way round, at a `g` that may be off the group by rounding.
fn trivial(side: Side, quantity: &Quantity, g: &[f64], change: &[f64]) -> Vec<f64> {
    if quantity.role != Role::Configuration || g.len() == dimension(quantity) {
        return change.to_vec();
    }
    let turn = |q: &[f64], change: &[f64]| {
        let (back, change) = (quaternion(q).conjugate(), quaternion(change) * 2.0);
        let turn = match side {
            Side::Left => back * change,
            Side::Right => change * back,
        };
        vec![turn.i, turn.j, turn.k]
    };
    match g.len() {
        2 => vec![g[0] * change[1] - g[1] * change[0]],
        4 if quantity.components[0] == "re" => {
            let (turn, x, y) = (g[0] * change[1] - g[1] * change[0], change[2], change[3]);
            match side {
                Side::Left => vec![turn, g[0] * x + g[1] * y, g[0] * y - g[1] * x],
                Side::Right => vec![turn, x + turn * g[3], y - turn * g[2]],
            }
        }
        4 => turn(g, change),
        _ => {
            let mut all = turn(&g[..4], &change[..4]);
            let [turn, along, place] = [&all[..], &change[4..], &g[4..]].map(Vector3::from_column_slice);
            let shift = match side {
                Side::Left => UnitQuaternion::new_unchecked(quaternion(&g[..4])).inverse() * along,
                Side::Right => along - turn.cross(&place),
            };
            all.extend(shift.iter());
            all
        }
    }
}
