//! SO(2), the circle: rotations of the plane.
//!
//! * Algebra: `so(2) ≅ R` by `hat(x) = x J`, `J = (0 −1; 1 0)`; bracket and `ad*` zero.
//! * Storage: the unit complex number `re, im`, cosine and sine of the angle; `g' = ξ i g`.
//! * `exp x = cos x + i sin x`, in the Stumpff functions of `x²`; `cay x = (1 + i x/2)² / (1 + x²/4)`.
//!   `dR exp = 1`, `dR cay_x = 1/(1 + x²/4)`.

use super::{
    Component, ComponentValue, EquationNames, Equations, Group, GroupNames, MatrixFunction, Representation,
    SpaceNames, Translation,
};
use crate::expr::{Expr, Number, Vector};
use crate::quantity::Kind;

/// Rotations of the plane.
pub struct SO2;

/// `1/(1 + x²/4)`
fn shared(x: Expr<'_>) -> Expr<'_> {
    ((x * x).scale(Number::ratio(1, 4)) + 1).recip()
}

/// `a v + b J v`
fn complex<'a>(a: Expr<'a>, b: Expr<'a>, v: &Vector<'a>) -> Vector<'a> {
    let (x, y) = (v.0[0], v.0[1]);
    Vector(vec![a * x - b * y, b * x + a * y])
}

impl Group for SO2 {
    fn names(&self) -> &GroupNames {
        &NAMES
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        let EquationNames { configuration, velocity, advected, energy, .. } = names;
        Equations {
            configuration: format!("{configuration} i {velocity}"),
            bracket: None,
            by_energy: advected.iter().map(|a| format!("{a} × ∂{energy}/∂{a}")).collect(),
            advected: advected.iter().map(|a| format!("−{velocity} J {a}")).collect(),
        }
    }

    fn bracket<'a>(&self, x: &Vector<'a>, _: &Vector<'a>) -> Vector<'a> {
        Vector::zeros(x.0[0].arena(), 1)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        let x = x.0[0];
        let squared = x * x;
        match f {
            MatrixFunction::Cayley => {
                let shared = shared(x);
                Vector(vec![shared.scale(2) - 1, x * shared])
            }
            _ => Vector(vec![squared.stumpff(0), x * squared.stumpff(1)]),
        }
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Cayley => m.scale(shared(x.0[0])),
            _ => m.clone(),
        }
    }

    fn closed_domain<'a>(&self, _: MatrixFunction, _: &Vector<'a>) -> Vec<Expr<'a>> {
        Vec::new()
    }

    /// The complex product.
    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        complex(g.0[0], g.0[1], h)
    }

    /// The conjugate.
    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        Vector(vec![g.0[0], -g.0[1]])
    }

    /// One Newton step of `|g|² = 1`: exact to rounding when `|g|` is off by rounding.
    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let correction = (g.dot(g) - 1) / 2;
        g - &g.scale(correction)
    }

    fn to_space<'a>(&self, _: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        m.clone()
    }

    fn representations(&self) -> &[&'static dyn Representation] {
        &[&Plane(1)]
    }
}

/// A complex number, and the one component of a vector.
const NAMES: GroupNames = GroupNames {
    name: "SO2",
    conventions: "angle: unit complex number, counted from the x towards the y axis; one angular momentum",
    configuration: "angle",
    kind: Kind::UnitComplex,
    coordinates: &["re", "im"],
    unit_coordinates: 2,
    axes: &["x"],
    blocks: &[],
    parts: &[],
    components: COMPONENTS,
};

/// The fields of a complex number, and nalgebra's methods for the angle, which is above −π and at most π, its cosine
/// and sine.
const COMPONENTS: &[Component] = &[
    Component { name: "re", called: false, of: |g| ComponentValue::Scalar(g.0[0]) },
    Component { name: "im", called: false, of: |g| ComponentValue::Scalar(g.0[1]) },
    Component { name: "angle", called: true, of: |g| ComponentValue::Scalar(g.0[1].atan2(g.0[0])) },
    Component { name: "cos_angle", called: true, of: |g| ComponentValue::Scalar(g.0[0]) },
    Component { name: "sin_angle", called: true, of: |g| ComponentValue::Scalar(g.0[1]) },
];

/// The plane with the rotations acting on it, `ρ_x v = x J v`; under a group of so many dimensions whose first is the
/// rotation.
pub(super) struct Plane(pub(super) usize);

impl Representation for Plane {
    fn names(&self) -> SpaceNames {
        SpaceNames { name: "R2", coordinates: &["x", "y"], algebra_dimension: self.0 }
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        complex(x.0[0].arena().zero(), x.0[0], v)
    }

    /// `φ₁(xJ) = c₁ + c₂ x J` in the Stumpff functions of `x²`
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        let x = x.0[0];
        let squared = x * x;
        match f {
            MatrixFunction::Cayley => Translation::halves(w),
            _ => Translation::before(complex(squared.stumpff(1), x * squared.stumpff(2), w)),
        }
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        Some(complex(g.0[0], g.0[1], v))
    }

    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let g = SO2.closed_form(f, &Vector(vec![x.0[0]]));
        complex(g.0[0], g.0[1], v)
    }
}
