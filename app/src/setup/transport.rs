//! Advected quantities seen from a body that was moved: they are fixed in space.
//!
//! Nothing here knows a group: states are displaced by [`displace`](coadjoint::system::Geometry::displace), and
//! advected parameters follow the flow of [`hamiltonian_vector`](coadjoint::system::Geometry::hamiltonian_vector) with
//! a constant velocity, which is linear in them.

use std::ops::Range;

use coadjoint::erased::{self, RetractionKind};
use coadjoint::system::{Quantity, Role};
use nalgebra::{Complex, DMatrix, DVector, Quaternion, UnitQuaternion};

use crate::catalogue::quantities::{rotation, tangent_places};

/// A quantity of the state: where its numbers are, and where those of its tangent vectors.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) quantity: &'static Quantity,
    pub(super) slots: Range<usize>,
    pub(super) tangent: Range<usize>,
}

/// All quantities of a state.
pub(super) fn places(state: &'static [Quantity]) -> Vec<Place> {
    let of_tangents = tangent_places(state).map(|(_, tangent)| tangent);
    Quantity::with_ranges(state)
        .zip(of_tangents)
        .map(|((quantity, slots), tangent)| Place { quantity, slots, tangent })
        .collect()
}

fn is(role: Role) -> impl Fn(&&Place) -> bool {
    move |place| place.quantity.role == role
}

/// The length of tangent vectors.
fn length(places: &[Place]) -> usize {
    places.last().map_or(0, |place| place.tangent.end)
}

/// Displaces a state by a tangent vector that moves nothing but configurations, and turns what is advected along.
pub(super) fn displace(system: &dyn erased::System, state: &[f64], by: &[f64]) -> Vec<f64> {
    let mut displaced = system.displace(state, RetractionKind::Exponential, by);
    carry(system, &mut displaced, by);
    displaced
}

/// Takes what is advected along with a displacement of configurations that has been made.
fn carry(system: &dyn erased::System, state: &mut [f64], by: &[f64]) {
    let places = places(system.description().state);
    let advected: Vec<&Place> = places.iter().filter(is(Role::Advected)).collect();
    let of = |ranges: fn(&Place) -> Range<usize>| advected.iter().flat_map(move |place| ranges(place));
    let (slots, tangents): (Vec<usize>, Vec<usize>) =
        (of(|place| place.slots.clone()).collect(), of(|place| place.tangent.clone()).collect());
    // the velocity whose flow is the displacement after a unit of time: `∂h/∂μ`
    let mut velocity = vec![0.0; length(&places)];
    for pair in places.windows(2) {
        if pair[0].quantity.role == Role::Configuration {
            velocity[pair[1].tangent.clone()].copy_from_slice(&by[pair[0].tangent.clone()]);
        }
    }
    let column = |&slot: &usize| {
        let mut unit = state.to_vec();
        slots.iter().for_each(|&slot| unit[slot] = 0.0);
        unit[slot] = 1.0;
        let rate = system.hamiltonian_vector(&unit, &velocity);
        DVector::from_iterator(tangents.len(), tangents.iter().map(|&tangent| rate[tangent]))
    };
    let columns: Vec<DVector<f64>> = slots.iter().map(column).collect();
    if columns.iter().all(|column| column.iter().all(|rate| *rate == 0.0)) {
        return;
    }
    let before = DVector::from_iterator(slots.len(), slots.iter().map(|&slot| state[slot]));
    let after = expm_multiply(&DMatrix::from_columns(&columns), before);
    // adding zero leaves no −0
    slots.iter().zip(&after).for_each(|(&slot, number)| state[slot] = number + 0.0);
}

/// Multiplies a vector by the exponential of a matrix: follows the flow of a linear system for a unit of time.
fn expm_multiply(matrix: &DMatrix<f64>, mut vector: DVector<f64>) -> DVector<f64> {
    let norm = matrix.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    // by parts in which the series ends after some twenty terms; what is larger is no flow that is asked for
    let parts = norm.ceil().clamp(1.0, 1e4);
    // what was lost in adding the changes of all parts so far
    let mut lost = DVector::zeros(vector.len());
    for _ in 0..parts as usize {
        // `Σ (A/parts)ᵏ/k!` without its first term, from the least term to the largest
        let mut change = DVector::zeros(vector.len());
        for order in (1..=24).rev() {
            change = matrix * (&vector + &change) / (parts * f64::from(order));
        }
        change += &lost;
        let next = &vector + &change;
        let added = &next - &vector;
        lost = (&vector - (&next - &added)) + (change - added);
        vector = next;
    }
    vector
}

/// The state with the configurations of another one, and with what is advected as it is seen from there. None where no
/// displacement from the one to the other is found.
pub(super) fn moved(system: &dyn erased::System, from: &[f64], to: &[f64]) -> Option<Vec<f64>> {
    let places = places(system.description().state);
    let mut state = from.to_vec();
    for place in places.iter().filter(is(Role::Configuration)) {
        if state[place.slots.clone()] != to[place.slots.clone()] {
            state = ways(place, &state, to).into_iter().find_map(|turn| {
                let turned = displace_at(system, &state, place, &turn, length(&places));
                let reached = shifted(system, place, &turned, to, length(&places));
                is_there(&reached[place.slots.clone()], &to[place.slots.clone()]).then_some(reached)
            })?;
        }
    }
    Some(state)
}

/// Displaces one configuration by the first components of a tangent vector.
fn displace_at(
    system: &dyn erased::System,
    state: &[f64],
    place: &Place,
    by: &[f64],
    length: usize,
) -> Vec<f64> {
    let mut tangent = vec![0.0; length];
    tangent[place.tangent.start..place.tangent.start + by.len()].copy_from_slice(by);
    displace(system, state, &tangent)
}

fn is_there(reached: &[f64], wanted: &[f64]) -> bool {
    let is_near = |(x, y): (&f64, &f64)| (x - y).abs() <= 1e-12 * (1.0 + y.abs());
    reached.iter().zip(wanted).all(is_near)
}

/// The turns that may lead from one configuration to another, as the rotation's part of a tangent vector: about axes of
/// the body or of space, the short way or the long one. Of a vector the difference.
fn ways(place: &Place, from: &[f64], to: &[f64]) -> Vec<Vec<f64>> {
    let (from, to) = (&from[place.slots.clone()], &to[place.slots.clone()]);
    match rotation(place.quantity) {
        None => vec![to.iter().zip(from).map(|(to, from)| to - from).collect()],
        Some((2, _)) => {
            let [from, to] = [from, to].map(|z| Complex::new(z[0], z[1]));
            let turn = to * from.conj();
            vec![vec![turn.im.atan2(turn.re)]]
        }
        Some(_) => {
            let [from, to] = [from, to].map(|q| Quaternion::new(q[0], q[1], q[2], q[3]));
            [from.conjugate() * to, to * from.conjugate()]
                .into_iter()
                .flat_map(|turn| {
                    let turn = UnitQuaternion::from_quaternion(turn);
                    let short = turn.scaled_axis();
                    let full = turn.axis().map_or(short, |axis| axis.scale(std::f64::consts::TAU));
                    [short, short - full]
                })
                .map(|turn| turn.as_slice().to_vec())
                .collect()
        }
    }
}

/// A rigid motion that is turned already, shifted to where it should be: what a shift does is linear in it.
fn shifted(
    system: &dyn erased::System,
    place: &Place,
    turned: &[f64],
    to: &[f64],
    length: usize,
) -> Vec<f64> {
    let turns = rotation(place.quantity).map_or(place.slots.len(), |(count, _)| count);
    let shifts = place.slots.start + turns..place.slots.end;
    let n = shifts.len();
    let by = |shift: &[f64]| {
        let mut all = vec![0.0; place.tangent.len()];
        let start = place.tangent.len() - n;
        all[start..].copy_from_slice(shift);
        displace_at(system, turned, place, &all, length)
    };
    let missing = DVector::from_iterator(n, shifts.clone().map(|slot| to[slot] - turned[slot]));
    if n == 0 || missing.iter().all(|x| *x == 0.0) {
        return turned.to_vec();
    }
    let column = |k: usize| {
        let there = by(DVector::from_fn(n, |i, _| f64::from(u8::from(i == k))).as_slice());
        DVector::from_iterator(n, shifts.clone().map(|slot| there[slot] - turned[slot]))
    };
    let columns: Vec<DVector<f64>> = (0..n).map(column).collect();
    match DMatrix::from_columns(&columns).lu().solve(&missing) {
        Some(shift) => by(shift.as_slice()),
        None => turned.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::random::Random;

    fn matrix(n: usize, random: &mut Random) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |_, _| 3.0 * random.even())
    }

    #[test]
    fn equations_are_solved() {
        let mut random = Random::new(3, 0);
        for n in 1..9 {
            let columns = matrix(n, &mut random);
            let right = DVector::from_fn(n, |_, _| random.even());
            let solution = columns.clone().lu().solve(&right).expect("independent");
            let error = (columns * &solution - right).norm();
            assert!(error < 1e-12 * (1.0 + solution.norm()), "{n}: {error}");
        }
        // dependent columns have no solution
        assert_eq!(
            DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]).lu().solve(&DVector::repeat(2, 1.0)),
            None
        );
    }

    /// Advected quantities follow a flow: the inverse one leads back.
    #[test]
    fn flows_are_exponentials() {
        let mut random = Random::new(4, 0);
        for n in 1..7 {
            let columns = matrix(n, &mut random);
            let vector = DVector::from_fn(n, |_, _| random.even());
            let there = expm_multiply(&columns, vector.clone());
            let error = (expm_multiply(&-columns, there.clone()) - vector).amax();
            let size = there.amax().max(1.0);
            assert!(error < 1e-11 * size, "{n}: {error:e} of {size}");
        }
        let plane = DMatrix::from_row_slice(2, 2, &[0.0, -2.0, 2.0, 0.0]);
        let turn = expm_multiply(&plane, DVector::from_vec(vec![1.0, 0.0]));
        let (sin, cos) = 2.0_f64.sin_cos();
        assert!((turn[0] - cos).abs() < 1e-15 && (turn[1] - sin).abs() < 1e-15, "{turn:?}");
    }
}
