//! Generated steppers against the generic one, which takes the same steps from definitions alone.

use coadjoint::Discretized;
use coadjoint::nalgebra::{SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint_support::for_each_system_and_retraction;
use coadjoint_support::random::Random;
use coadjoint_support::systems::Sample;
use coadjoint_systems::classical::generic::{
    GenericStepper, Hamiltonian, MatrixRetraction, SO3, SO3Semidirect,
};

/// Kinetic plus potential energy with the gradients worked out by hand. Of no system's own type: the generic stepper is compiled once for each
/// group.
struct ByHand {
    inverse: Matrix3<f64>,
    potential: Box<OfVectors<f64>>,
    by_advected: Box<OfVectors<Vec<Vector3<f64>>>>,
}

/// A function of the advected vectors.
type OfVectors<X> = dyn Fn(&[Vector3<f64>]) -> X;

impl ByHand {
    fn new<S: Sample>(system: S) -> Self {
        let inverse = system.inertia_matrix().try_inverse().expect("an inertia has an inverse");
        let again = system.clone();
        Self {
            inverse,
            potential: Box::new(move |advected| system.potential_energy(advected)),
            by_advected: Box::new(move |advected| again.potential_gradient(advected)),
        }
    }
}

impl<const D: usize> Hamiltonian<D> for ByHand {
    fn energy(&self, mu: &SVector<f64, D>) -> f64 {
        let momentum = mu.fixed_rows::<3>(0);
        momentum.dot(&(self.inverse * momentum)) / 2.0 + (self.potential)(&advected(mu))
    }

    fn gradient(&self, mu: &SVector<f64, D>) -> SVector<f64, D> {
        let velocity = self.inverse * mu.fixed_rows::<3>(0);
        let by_advected = (self.by_advected)(&advected(mu));
        let parts = std::iter::once(velocity).chain(by_advected).flat_map(|v| [v.x, v.y, v.z]);
        SVector::from_iterator(parts)
    }
}

fn advected<const D: usize>(mu: &SVector<f64, D>) -> Vec<Vector3<f64>> {
    (1..D / 3).map(|k| mu.fixed_rows::<3>(3 * k).into_owned()).collect()
}

/// The attitude's matrix and the rest of the state after a generic step on `G`, whose matrices hold the rotation in front.
fn generic_step<G, M, const N: usize, const D: usize>(
    group: G,
    retraction: M,
    system: ByHand,
    h: f64,
    components: &[f64],
) -> (Matrix3<f64>, Vec<f64>)
where
    G: coadjoint_systems::classical::generic::MatrixGroup<N, D>,
    M: MatrixRetraction<G, N, D>,
{
    let q = &components[..4];
    let attitude = UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]));
    let mut g = SMatrix::<f64, N, N>::identity();
    g.fixed_view_mut::<3, 3>(0, 0).copy_from(attitude.to_rotation_matrix().matrix());
    let mut mu = SVector::<f64, D>::from_column_slice(&components[4..]);
    let mut stepper = GenericStepper::new(group, retraction, system, h).expect("a stepper");
    stepper.step(&mut g, &mut mu).expect("a generic step");
    (g.fixed_view::<3, 3>(0, 0).into_owned(), mu.as_slice().to_vec())
}

/// Which group a number of advected vectors makes.
fn dispatched<M>(system: ByHand, retraction: M, h: f64, components: &[f64]) -> (Matrix3<f64>, Vec<f64>)
where
    M: MatrixRetraction<SO3, 3, 3>
        + MatrixRetraction<SO3Semidirect<1>, 4, 6>
        + MatrixRetraction<SO3Semidirect<2>, 5, 9>
        + MatrixRetraction<SO3Semidirect<3>, 6, 12>,
{
    match components.len() {
        7 => generic_step(SO3, retraction, system, h, components),
        10 => generic_step(SO3Semidirect::<1>, retraction, system, h, components),
        13 => generic_step(SO3Semidirect::<2>, retraction, system, h, components),
        16 => generic_step(SO3Semidirect::<3>, retraction, system, h, components),
        n => panic!("a state of {n} components"),
    }
}

/// One step from random states of random systems, forward and back in time.
#[test]
fn generated_and_generic_steps_agree() {
    fn check<S, M>(what: &str)
    where
        S: Sample + Discretized<M>,
        M: Default
            + MatrixRetraction<SO3, 3, 3>
            + MatrixRetraction<SO3Semidirect<1>, 4, 6>
            + MatrixRetraction<SO3Semidirect<2>, 5, 9>
            + MatrixRetraction<SO3Semidirect<3>, 6, 12>,
    {
        let mut random = Random::new(21);
        let mut worst: f64 = 0.0;
        for _ in 0..200 {
            let (system, mut state) = S::sample(&mut random);
            let h = random.between(0.001, 0.4) * random.one_of(&[1.0, -1.0]);
            let before = state.to_components();
            let (attitude, mu) = dispatched(ByHand::new(system.clone()), M::default(), h, before.as_ref());

            system.stepper::<M>(h).expect("a stepper").step(&mut state).expect("a step");
            let after = state.to_components();
            let after = after.as_ref();
            let q = UnitQuaternion::new_unchecked(Quaternion::new(after[0], after[1], after[2], after[3]));
            let turned = (q.to_rotation_matrix().matrix() - attitude).amax();
            let largest = before.as_ref()[4..].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            let moved = after[4..].iter().zip(&mu).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
            worst = worst.max(turned).max(moved / largest);
        }
        println!("{what}: {worst:.1e}");
        assert!(worst < 5e-15, "{what}: generated and generic step differ by {worst:e}");
    }
    for_each_system_and_retraction!(check);
}
