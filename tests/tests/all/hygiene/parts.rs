//! Parts of perturbations have constants of their own, whatever the fields are called.

use coadjoint::derivative::{IndexRange, WrtParameters, block};
use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    advected(point: R3),
    potential = (through + 2.0 * Through + columns) * point.x,
    derivatives,
)]
#[allow(non_snake_case)]
struct Alike {
    #[inertia]
    inertia: Vector3<f64>,
    through: f64,
    Through: f64,
    columns: f64,
}

#[test]
fn names_that_differ_by_their_cases_do() {
    const LOWER: IndexRange<3, 1> = AlikeIndices::THROUGH;
    const UPPER: IndexRange<4, 1> = AlikeIndices::THROUGH_;
    let alike = Alike { inertia: vector![1.0, 2.0, 3.0], through: 0.3, Through: 0.5, columns: 0.7 };
    let mut state =
        AlikeState { attitude: super::rotation(), momentum: vector![1.0, 2.0, 3.0], point: Vector3::z() };
    let mut stepper = alike.stepper::<Cayley>(0.1).expect("valid");
    let step = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtParameters);
    let by = step.expect("solvable").0;
    let [lower, upper, columns] = [
        block(&by, AlikeIndices::MOMENTUM, LOWER),
        block(&by, AlikeIndices::MOMENTUM, UPPER),
        block(&by, AlikeIndices::MOMENTUM, AlikeIndices::COLUMNS),
    ];
    assert!(lower.norm() > 1e-2);
    assert!((upper - 2.0 * lower).norm() < 1e-14 && (columns - lower).norm() < 1e-14, "{by}");
}
