//! The potential is read twice: symbolically, for the mathematics, and by rustc, as a method. Both must mean the same.

use coadjoint::System;
use coadjoint::nalgebra::{Matrix2, Matrix3, RowVector3, Vector2, Vector3};
use coadjoint::prelude::{UnitQuaternion, matrix, vector};

use super::Random;

const GRAVITY: f64 = 9.81;

struct Planet;

impl Planet {
    const RADIUS: f64 = 6.4;
}

mod units {
    pub(super) const LENGTH: f64 = 0.3;

    pub(super) mod other {
        pub(in super::super) const LENGTH: f64 = 0.7;
    }
}

macro_rules! potentials {
    (
        [$a:ident, $b:ident, $chi:ident, $m:ident, $p:ident, $q:ident, $r:ident, $gamma:ident, $beta:ident]
        $($name:ident: $potential:expr;)*
    ) => {
        $(mod $name {
            use super::*;

            #[coadjoint::lie_poisson_system(
                group = SO3,
                advected($gamma: R3, $beta: R3),
                potential = $potential,
                retractions(Cayley),
            )]
            #[allow(deprecated)]
            pub(super) struct Tested {
                #[inertia]
                inertia: f64,
                $a: f64,
                $b: f64,
                $chi: Vector3<f64>,
                $m: Matrix3<f64>,
                $p: Vector2<f64>,
                $q: Matrix2<f64>,
                $r: RowVector3<f64>,
            }

            #[test]
            fn means_the_same_to_both_readers() {
                let mut random = Random::new(31);
                for _ in 0..200 {
                    let system = Tested {
                        inertia: random.between(0.5, 2.0),
                        $a: random.between(0.1, 2.0),
                        $b: random.between(0.1, 2.0),
                        $chi: random.vector(),
                        $m: random.matrix(),
                        $p: random.vector().xy(),
                        $q: random.matrix().fixed_view::<2, 2>(0, 0).into_owned(),
                        $r: random.vector().transpose(),
                    };
                    let state = TestedState {
                        attitude: UnitQuaternion::identity(),
                        momentum: random.vector(),
                        $gamma: random.vector(),
                        $beta: random.vector(),
                    };
                    let potential = system.potential(&state);
                    let kinetic = state.momentum.norm_squared() / (2.0 * system.inertia);
                    let defect = (system.energy(&state) - kinetic - potential).abs();
                    assert!(
                        defect <= 1e-14 * (1.0 + kinetic + potential.abs()),
                        "off by {defect:e}: {potential:e}"
                    );
                }
            }
        })*
    };
}

// names of a potential must come from where the potential is written, as with any macro
potentials! {
    [a, b, chi, m, p, q, r, gamma, beta]
    product: a * gamma.dot(&chi);
    whole: 2.0 * gamma.x;
    constant: GRAVITY * gamma.z;
    constant_of_a_type: Planet::RADIUS * gamma.z + Planet::RADIUS;
    constant_of_std: (gamma.x * std::f64::consts::PI).sin() + core::f64::consts::E;
    constants_of_one_name: units::LENGTH * gamma.z + units::other::LENGTH * beta.z;
    components: gamma.x * beta.y - gamma[1] * beta[0] + m[(0, 2)] * m.m31 + p.x * p[1] + q[(1, 0)];
    columns_first: m[1] * gamma.x + m[3] * gamma.y;
    triple: a * chi.dot(&gamma.cross(&beta));
    cross_of_references: (&gamma).cross(&beta).norm_squared();
    norms: gamma.norm() + beta.norm_squared() + (gamma - beta).magnitude() + m.norm_squared();
    unit: chi.dot(&gamma.normalize());
    matrices: gamma.dot(&(m * beta)) + (m * m.transpose()).trace() + m.determinant() * a;
    quadratic: 0.5 * (m.transpose() * gamma).dot(&(m * gamma));
    transposed: m.tr_mul(&gamma).dot(&beta) + (gamma.transpose() * m * beta)[0];
    row: (r * gamma)[(0, 0)] + r.x;
    small: (q * p).dot(&p) + q.determinant() * gamma.x;
    built: Vector3::new(a, b, 1.0).dot(&gamma) + vector![a, 2.0 * b, gamma.x].dot(&beta);
    built_matrix: (matrix![a, 1.0, 0.0; 0.0, b, 1.0; gamma.x, 0.0, a] * beta).dot(&gamma);
    unit_vectors: Vector3::x().dot(&gamma) + Vector3::z().cross(&beta).dot(&chi)
        + (Matrix3::identity() * gamma).sum();
    diagonal: (Matrix3::from_diagonal(&chi) * gamma).dot(&beta) + m.diagonal().dot(&chi);
    outer: (gamma * beta.transpose() * chi).dot(&chi);
    by_component: gamma.component_mul(&beta).sum() + chi.component_mul(&gamma).dot(&chi);
    scaled: gamma.scale(a).dot(&chi.unscale(b)) + (gamma * a / b).x + (-beta).y;
    powers: gamma.x.powi(3) + a.powi(-2) * gamma.y.powi(2) + a.powf(1.5) * b.powf(gamma.z);
    roots: (1.0 + gamma.norm_squared()).sqrt() + a.sqrt().recip() * gamma.x;
    circular: (a * gamma.x).sin() * (b * gamma.y).cos() + (gamma.z * 0.5).tan();
    inverse_circular: (gamma.x * 0.9).asin() + (gamma.y * 0.9).acos() + (a * gamma.z).atan()
        + gamma.x.atan2(a + gamma.y.powi(2));
    hyperbolic: gamma.x.sinh() + gamma.y.cosh() + (a * gamma.z).tanh();
    exponential: (-a * gamma.norm_squared()).exp() + (1.0 + gamma.x.powi(2)).ln();
    both_at_once: {
        let (s, c) = (a * gamma.x).sin_cos();
        s * beta.x + c * beta.y
    };
    block: {
        let tilt = gamma.dot(&chi);
        let lifted = tilt + 1.0;
        let tilt = lifted * lifted;
        let scale: f64 = 0.5;
        tilt * { let inner = scale * tilt; inner + a }
    };
    functions: f64::sin(gamma.x) + Vector3::dot(&gamma, &chi) + f64::hypot(a, gamma.x);
    fused: a.mul_add(gamma.x, b) + gamma.x.hypot(beta.y);
    integers: f64::from(3) * gamma.x + gamma.y.powi(2 + 1);
    literals: 1e-3 * gamma.x + 0.1 * gamma.y + 1_000.5 * gamma.z / 3.0 - 2f64 * beta.x;
    signs: -(gamma.x - -beta.x) - (-(a - b)) * -gamma.y;
    references: { let g = &gamma; let c = &chi; (*g).dot(c) + (*g - *c).norm_squared() };
    nothing_advected: a * b + chi.norm_squared();
    quotient: gamma.x / (1.0 + beta.norm_squared()) / a - chi.z / b;
    nested: ((a * gamma.x).sin() + (b * beta.y).cos()).exp().sqrt().ln() * (1.0 + gamma.x.cos().powi(2)).ln();
}
