//! Advected quantities seen from a body that was moved: they are fixed in space.
//!
//! They follow the flow of [`hamiltonian_vector`](coadjoint::system::Geometry::hamiltonian_vector) with a constant
//! velocity, which is linear in them.

use coadjoint::erased::{self, RetractionKind};
use coadjoint::system::{Kind, Quantity, Role, Side};
use nalgebra::{Complex, DMatrix, DVector, Quaternion, Unit, UnitQuaternion, Vector3};

use crate::catalogue::quantities::{rotation, tangent_length};

/// Displaces a state by a tangent vector that moves nothing but configurations, and turns what is advected along.
pub(super) fn displace(system: &dyn erased::System, state: &[f64], by: &[f64]) -> Vec<f64> {
    let mut displaced = system.displace(state, RetractionKind::Exponential, by);
    carry(system, &mut displaced, by);
    displaced
}

/// Takes what is advected along with a displacement of configurations that has been made.
fn carry(system: &dyn erased::System, state: &mut [f64], by: &[f64]) {
    let quantities = system.description().state;
    let advected =
        || Quantity::with_ranges(quantities).filter(|(quantity, _)| quantity.role == Role::Advected);
    let slots: Vec<usize> = advected().flat_map(|(_, slots)| slots).collect();
    let tangents: Vec<usize> = advected().flat_map(|(quantity, _)| quantity.tangent()).collect();
    // the velocity whose flow is the displacement after a unit of time: `∂h/∂μ`
    let mut velocity = vec![0.0; tangent_length(quantities)];
    for pair in quantities.windows(2).filter(|pair| pair[0].role == Role::Configuration) {
        velocity[pair[1].tangent()].copy_from_slice(&by[pair[0].tangent()]);
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

/// The state with the configurations of another one, and with what is advected as it is seen from there. None where a
/// configuration that differs is a matrix.
pub(super) fn moved(system: &dyn erased::System, from: &[f64], to: &[f64]) -> Option<Vec<f64>> {
    let erased::Description { state: quantities, side, .. } = system.description();
    let mut state = from.to_vec();
    for (quantity, slots) in Quantity::with_ranges(quantities) {
        if quantity.role != Role::Configuration || state[slots.clone()] == to[slots.clone()] {
            continue;
        }
        let tangent = quantity.tangent();
        let mut displaced = |start: usize, by: &[f64]| {
            let mut all = vec![0.0; tangent_length(quantities)];
            all[start..start + by.len()].copy_from_slice(by);
            state = displace(system, &state, &all);
            state[slots.clone()].to_vec()
        };
        let reached =
            displaced(tangent.start, &turn(quantity.kind, side, &from[slots.clone()], &to[slots.clone()])?);
        let shift = shift(quantity, side, &reached, &to[slots.clone()]);
        displaced(tangent.end - shift.len(), &shift);
    }
    Some(state)
}

/// The rotation between two configurations, as a tangent vector; of vectors the difference.
fn turn(kind: Kind, side: Side, from: &[f64], to: &[f64]) -> Option<Vec<f64>> {
    Some(match kind {
        Kind::Scalar | Kind::Vector(_) => to.iter().zip(from).map(|(to, from)| to - from).collect(),
        Kind::UnitComplex | Kind::RigidMotion2 => {
            let turn = complex(to) * complex(from).conj();
            vec![turn.im.atan2(turn.re)]
        }
        Kind::UnitQuaternion | Kind::RigidMotion3 => {
            let turn = match side {
                Side::Left => quaternion(from).inverse() * quaternion(to),
                Side::Right => quaternion(to) * quaternion(from).inverse(),
            };
            turn.scaled_axis().as_slice().to_vec()
        }
        _ => return None,
    })
}

/// The shift of a rigid motion that is turned already.
fn shift(quantity: &Quantity, side: Side, turned: &[f64], to: &[f64]) -> Vec<f64> {
    let missing = |slot: usize| to[slot] - turned[slot];
    match (quantity.kind, side) {
        (Kind::RigidMotion2, Side::Left) => {
            let shift = complex(turned).conj() * Complex::new(missing(2), missing(3));
            vec![shift.re, shift.im]
        }
        (Kind::RigidMotion3, Side::Left) => {
            let shift = quaternion(turned).inverse() * Vector3::from([4, 5, 6].map(missing));
            shift.as_slice().to_vec()
        }
        _ => rotation(quantity).map_or(Vec::new(), |(count, _)| (count..to.len()).map(missing).collect()),
    }
}

fn complex(z: &[f64]) -> Complex<f64> {
    Complex::new(z[0], z[1])
}

fn quaternion(q: &[f64]) -> UnitQuaternion<f64> {
    Unit::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]))
}

#[cfg(test)]
mod tests {
    use coadjoint::prelude::*;

    use super::*;
    use crate::setup::random::Random;

    /// A plate on water, seen from the shore.
    #[lie_poisson_system(group = SE2, invariance = right, retractions(Cayley))]
    struct Plate {
        #[inertia]
        inertia: Vector3<f64>,
    }

    #[test]
    fn configurations_of_every_kind_are_reached() {
        let reached = |system: &dyn erased::System, from: &[f64], to: &[f64]| {
            let there = moved(system, from, to).expect("no matrix");
            let error = there.iter().zip(to).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(error < 1e-14, "{from:?}: {there:?}, {to:?}");
        };
        let plate = Plate { inertia: Vector3::repeat(1.0) };
        let (from, to) = ([1.0, 0.0, 0.5, -2.0, 0.0, 0.0, 0.0], [0.6, -0.8, 3.0, 1.0, 0.0, 0.0, 0.0]);
        reached(&plate, &from, &to);
        for (name, configuration) in [
            ("planar_pendulum", &[0.6, -0.8][..]),
            ("rigid_body_in_space", &[0.5, 0.5, -0.5, 0.5, 3.0, 1.0, -2.0]),
            ("kepler", &[0.25, 3.0, -1.0]),
        ] {
            let entry = crate::tests::catalogue().system(name).expect("it is there");
            let (from, mut to) = (&entry.example.state, entry.example.state.clone());
            to[..configuration.len()].copy_from_slice(configuration);
            reached(&*entry.system(&entry.example.parameters), from, &to);
        }
    }

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
