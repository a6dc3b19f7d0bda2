//! Tangent vectors of left- and right-invariant systems: one kind of coordinates for displacements, motions and derivatives of steps.

use std::sync::Arc;

use coadjoint::erased::{RetractionKind, Stepper, System};
use coadjoint::nalgebra::{DMatrix, DVector};
use coadjoint_dynamic::Model;

/// A description with the side in the place of `SIDE`, its parameters, controls, and a state at rest at the identity.
struct Example {
    text: &'static str,
    parameters: &'static [f64],
    control: &'static [f64],
    start: &'static [f64],
}

const EXAMPLES: [Example; 4] = [
    Example {
        text: "
            #[lie_poisson_system(
                group = SO3, SIDE, advected(field: R3), control(moment: R3),
                potential = weight * (attitude * chi).z + field.dot(&chi), force = moment - 0.1 * velocity, derivatives,
            )]
            struct Body { #[inertia] inertia: Vector3<f64>, weight: f64, chi: Vector3<f64> }",
        parameters: &[1.0, 2.0, 2.5, 0.7, 0.3, -0.2, 0.9],
        control: &[0.1, 0.2, -0.3],
        start: &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.5, 0.8],
    },
    Example {
        text: "
            #[lie_poisson_system(
                group = SE2, SIDE,
                potential = 0.5 * stiffness * pose.translation.x.powi(2) + weight * pose.translation.y, derivatives,
            )]
            struct Plate { #[inertia] inertia: Vector3<f64>, stiffness: f64, weight: f64 }",
        parameters: &[1.0, 2.0, 2.5, 0.7, 0.3],
        control: &[],
        start: &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    },
    Example {
        text: "
            #[lie_poisson_system(
                group = SE3, SIDE, potential = 0.5 * stiffness * pose.translation.vector.norm_squared(), derivatives,
            )]
            struct Buoy { #[inertia] inertia: Vector6<f64>, stiffness: f64 }",
        parameters: &[1.0, 2.0, 2.5, 3.0, 4.0, 5.0, 0.7],
        control: &[],
        start: &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    },
    Example {
        text: "
            #[lie_poisson_system(
                group = SL(2), SIDE, hamiltonian = 0.5 * momentum.dot(&momentum.component_div(&inertia)), derivatives,
            )]
            struct Areas { inertia: Vector3<f64> }",
        parameters: &[1.0, 2.0, 2.5],
        control: &[],
        start: &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    },
];

/// The derivative at 0, by differences of order 6.
fn slope(of: impl Fn(f64) -> Vec<f64>) -> DVector<f64> {
    let difference = |k: f64| {
        let [up, down] = [2e-3 * k, -2e-3 * k].map(|share| DVector::from_vec(of(share)));
        (up - down) / (4e-3 * k)
    };
    (difference(1.0) * 15.0 - difference(2.0) * 6.0 + difference(3.0)) / 10.0
}

/// The state displaced along one direction.
fn along(system: &dyn System, state: &[f64], direction: usize, by: f64) -> Vec<f64> {
    let mut tangent = vec![0.0; dimension(system)];
    tangent[direction] = by;
    system.displace(state, RetractionKind::Exponential, &tangent)
}

fn dimension(system: &dyn System) -> usize {
    system.description().state.iter().map(|quantity| quantity.tangent.1).max().unwrap()
}

/// How stored numbers change by tangent vectors.
fn tangent_map(system: &dyn System, state: &[f64]) -> DMatrix<f64> {
    let columns = (0..dimension(system)).map(|i| slope(|by| along(system, state, i, by)));
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

fn is_close(what: &str, found: &DVector<f64>, expected: &DVector<f64>) {
    let error = (found - expected).amax();
    assert!(error < 1e-10 * expected.amax().max(1.0), "{what}: {error:.1e}, {found}{expected}");
}

#[test]
fn displacements_motions_and_derivatives_are_in_the_same_coordinates() {
    const STEPS: usize = 8;
    for (Example { text, parameters, control, start }, side) in
        EXAMPLES.iter().flat_map(|example| ["left", "right"].map(|side| (example, side)))
    {
        let model = Model::from_text(&text.replace("SIDE", &format!("invariance = {side}"))).unwrap();
        let bound = |parameters: &[f64]| -> Arc<dyn System> { Arc::new(model.system(parameters)) };
        let of_size = |system: &Arc<dyn System>, step: f64| {
            Stepper::new(system.clone(), &"Exponential".parse().unwrap(), step).unwrap()
        };
        let stepper = |system: &Arc<dyn System>| of_size(system, 0.05);
        let run = |system: &Arc<dyn System>, mut state: Vec<f64>, steps: usize| {
            stepper(system).steps(&mut state, control, steps as u64).unwrap();
            state
        };
        let system = bound(parameters);
        let n = dimension(&*system);
        let what = |of: &str| format!("{} on the {side}, {of}", system.description().name);
        let somewhere: Vec<f64> = (0..n).map(|i| 0.7 - 0.4 * (i as f64 * 1.3).cos()).collect();
        let start = system.displace(start, RetractionKind::Exponential, &somewhere);

        // the motion, to which short steps come close
        let motion = DVector::from_vec(system.motion(&start, 0.0, control));
        let expected = slope(|step| {
            let mut state = start.clone();
            of_size(&system, step).step(&mut state, control).unwrap();
            state
        });
        is_close(&what("motion"), &(tangent_map(&*system, &start) * motion), &expected);

        // a step
        let mut next = start.clone();
        let (jacobian, _) = stepper(&system).step_with_jacobian(&mut next, control).unwrap();
        let carried = tangent_map(&*system, &next) * &jacobian.state;
        for i in 0..n {
            let expected = slope(|by| run(&system, along(&*system, &start, i, by), 1));
            is_close(&what("step"), &carried.column(i).into_owned(), &expected);
        }

        // some steps, backwards from a function of all stored numbers of their end
        let mut state = start.clone();
        let mut own = stepper(&system);
        let steps: Vec<_> =
            (0..STEPS).map(|_| own.step_with_jacobian(&mut state, control).unwrap().0).collect();
        let weights = DVector::from_fn(state.len(), |i, _| (1.0 + i as f64).sin());
        let mut costate = tangent_map(&*system, &state).tr_mul(&weights);
        let mut by_parameters = DVector::zeros(parameters.len());
        for step in steps.iter().rev() {
            by_parameters += step.parameters.tr_mul(&costate);
            costate = step.state.tr_mul(&costate);
        }
        let loss = |state: Vec<f64>| weights.dot(&DVector::from_vec(state));
        let by_state =
            slope(|by| (0..n).map(|i| loss(run(&system, along(&*system, &start, i, by), STEPS))).collect());
        is_close(&what("gradient by the state"), &costate, &by_state);
        let expected = slope(|by| {
            let changed = |i: usize| {
                let mut changed = parameters.to_vec();
                changed[i] += by;
                changed
            };
            (0..parameters.len()).map(|i| loss(run(&bound(&changed(i)), start.clone(), STEPS))).collect()
        });
        is_close(&what("gradient by the parameters"), &by_parameters, &expected);
    }
}
