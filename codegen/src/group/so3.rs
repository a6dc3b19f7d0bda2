//! Unit quaternions: SO(3), rotations of space, and SU(2), their double cover, as spins see it.
//!
//! * Algebra: `so(3) ≅ R³` by `hat(x) y = x × y`; bracket `[x, y] = x × y`; `ad*_x m = m × x`.
//! * Storage: the unit quaternion `w, x, y, z` of the rotation from body to space; `g' = g (0, ξ)/2`.
//! * With `z = |x|²` and the Stumpff functions `c_k = c_k(z)`:
//!   `exp x = (c₀(z/4), c₁(z/4) x/2)`, `cay x = (1, x/2)/√(1 + z/4)`;
//!   `dR exp_x = 1 + c₂ x̂ + c₃ x̂²`, `dR cay_x = (1 + x̂/2)/(1 + z/4)`.
//! * The logarithmic derivatives of both satisfy `(dR τ_x)ᵀ = dR τ_{−x}`.
//!
//! On SU(2) `x` stands for the pure quaternion `x/2`, which is `−i x·σ/2`, and `q` and `−q` are different elements. Its
//! Cayley map is that of the quaternions, not of the rotation matrices: with `a = x/4`,
//! `cay x = (1 − a)⁻¹(1 + a) = (1 − |a|², 2a)/(1 + |a|²)`, and
//! `dR cay_x y = ((1 − |a|²) y + 2 a × y + 2 (a·y) a)/(1 + |a|²)²`.

use super::{
    Basis, Component, ComponentValue, EquationNames, Equations, Group, GroupNames, MatrixFunction, Moved,
    Representation, Retraction, Side, SpaceNames, Translation, families,
};
use crate::expr::{Expr, Function, Number, Vector};
use crate::quantity::Kind;

/// Groups of unit quaternions.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum UnitQuaternions {
    /// Rotations of space.
    SO3,
    /// Unit quaternions themselves.
    SU2,
}

pub use UnitQuaternions::{SO3, SU2};

/// `v + a x × v + b x × (x × v)`, that is, `(1 + a x̂ + b x̂²) v`
fn rotation_like<'a>(x: &Vector<'a>, v: &Vector<'a>, a: Expr<'a>, b: Expr<'a>) -> Vector<'a> {
    let once = x.cross(v);
    let twice = x.cross(&once);
    &(v + &once.scale(a)) + &twice.scale(b)
}

/// `1 + |x|²/4`
fn cayley_norm<'a>(x: &Vector<'a>) -> Expr<'a> {
    x.squared_norm().scale(Number::ratio(1, 4)) + 1
}

/// `2/(1 + |x|²/4)`: kept whole with its 2, as the mean momentum of a step has it in multiples by the unknown's scale,
/// and as derivatives have its square.
fn twice_cayley_factor<'a>(x: &Vector<'a>) -> Expr<'a> {
    (cayley_norm(x).recip() * 2).hold()
}

/// `1/(1 + |x|²/4)`
fn cayley_factor<'a>(x: &Vector<'a>) -> Expr<'a> {
    (twice_cayley_factor(x) / 2).hold()
}

/// `1/√(1 + |x|²/4)`
fn cayley_root<'a>(x: &Vector<'a>) -> Expr<'a> {
    cayley_factor(x) * cayley_norm(x).sqrt()
}

/// `a = x/4` and `|a|²`
fn quarter<'a>(x: &Vector<'a>) -> (Vector<'a>, Expr<'a>) {
    let a = x.scale(x.0[0].arena().number(Number::ratio(1, 4)));
    let squared = x.squared_norm().scale(Number::ratio(1, 16));
    (a, squared)
}

impl Group for UnitQuaternions {
    fn names(&self) -> &GroupNames {
        match self {
            SO3 => &ROTATIONS,
            SU2 => &SPINS,
        }
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        let EquationNames { configuration, momentum, velocity, advected, energy } = names;
        Equations {
            configuration: format!("{configuration} hat({velocity})"),
            bracket: Some(format!("{momentum} × {velocity}")),
            by_energy: advected.iter().map(|a| format!("{a} × ∂{energy}/∂{a}")).collect(),
            advected: advected.iter().map(|a| format!("{a} × {velocity}")).collect(),
        }
    }

    fn unknown_scale(&self, retraction: Retraction) -> i128 {
        match (self, retraction) {
            (SO3, Retraction::Cayley) => 2,
            (SU2, Retraction::Cayley) => 4,
            _ => 1,
        }
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        x.cross(y)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        let (w, half) = match (self, f) {
            (_, MatrixFunction::Exponential | MatrixFunction::Coarse) => {
                let quarter = x.squared_norm().scale(Number::ratio(1, 4));
                (quarter.stumpff(0), quarter.stumpff(1) / 2)
            }
            (SO3, MatrixFunction::Cayley) => {
                let w = cayley_root(x);
                (w, w / 2)
            }
            (SU2, MatrixFunction::Cayley) => {
                let (a, squared) = quarter(x);
                let shared = (squared + 1).recip();
                let w = shared.scale(2) - 1;
                return Vector([vec![w], a.scale(shared.scale(2)).0].concat());
            }
        };
        let mut quaternion = vec![w];
        quaternion.extend(x.scale(half).iter());
        Vector(quaternion)
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let z = x.squared_norm();
        match (self, f) {
            // the transpose has `−a` in the place of `a`
            (SU2, MatrixFunction::Cayley) => {
                let (a, squared) = quarter(x);
                let two = squared.arena().number(2);
                let shared = (squared + 1).recip();
                let rotated = &m.scale(-squared + 1) - &a.cross(m).scale(two);
                (&rotated + &a.scale(a.dot(m).scale(2))).scale(shared * shared)
            }
            (SO3, MatrixFunction::Cayley) => {
                let half = z.arena().number(Number::ratio(1, 2));
                (m - &x.cross(m).scale(half)).scale(twice_cayley_factor(x) / 2)
            }
            _ => rotation_like(x, m, -z.stumpff(2), z.stumpff(3)),
        }
    }

    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        match f {
            MatrixFunction::Cayley => Vec::new(),
            // dR exp is singular where |x| = 2π
            _ => vec![x.0[0].arena().number(Number::FOUR_PI_SQUARED) - x.squared_norm()],
        }
    }

    /// The quaternion product.
    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        let (w, v) = (g.0[0], Vector(g.0[1..].to_vec()));
        let (s, u) = (h.0[0], Vector(h.0[1..].to_vec()));
        let mut product = vec![w * s - v.dot(&u)];
        product.extend((&(&u.scale(w) + &v.scale(s)) + &v.cross(&u)).iter());
        Vector(product)
    }

    /// The conjugate quaternion.
    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let mut conjugate = vec![g.0[0]];
        conjugate.extend(g.0[1..].iter().map(|&component| -component));
        Vector(conjugate)
    }

    /// One Newton step of `|q|² = 1`: exact to rounding when `|q|` is off by rounding.
    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let correction = (g.squared_norm() - 1) / 2;
        g - &g.scale(correction)
    }

    /// For Cayley on SO(3) the product with `(1, x/2)`, whose length `√(1 + z/4)` comes off together with what rounding did to
    /// the product's: the root need not be waited for, nor for the product, whose length is that of `g` up to rounding.
    fn moved<'a>(&self, side: Side, retraction: Retraction, g: &Vector<'a>, x: &Vector<'a>) -> Moved<'a> {
        if *self == SU2 {
            let increment = self.retract(retraction, x).hold();
            let moved = side.compose(self, g, &increment).hold();
            return Moved { next: self.normalize(&moved), increment, moved };
        }
        let one = x.0[0].arena().one();
        let (increment, inverse_length) = if retraction == Retraction::Cayley {
            let half = x.scale(one / 2);
            (Vector([vec![one], half.0].concat()), cayley_root(x))
        } else {
            (self.retract(retraction, x), one)
        };
        let increment = increment.hold();
        let moved = side.compose(self, g, &increment).hold();
        // one Newton step, as in `normalize`, for `g`
        let correction = one.scale(Number::ratio(3, 2)) - g.squared_norm().scale(Number::ratio(1, 2)).hold();
        let next = moved.scale((inverse_length * correction.hold()).hold());
        Moved { increment, moved, next }
    }

    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        turned(g, m)
    }

    /// None of SU(2): the Cayley map of the quaternions rotates space otherwise than that of the rotation matrices does.
    fn representations(&self) -> &[&'static dyn Representation] {
        match self {
            SO3 => &[&Space(3)],
            SU2 => &[],
        }
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        (v.len() == 3).then(|| turned(g, v))
    }

    /// Of SU(2) as `x/2` multiplies quaternions from the left: the axes of the family of this name are others, and of
    /// another length.
    fn basis(&self) -> Option<Basis> {
        match self {
            SO3 => families::basis(self.name()),
            SU2 => Basis::of_action(self.axes(), self.coordinates().len(), |x, q| {
                let mut pure = vec![x.0[0].arena().zero()];
                pure.extend(x.iter().map(|component| component / 2));
                self.compose(&Vector(pure), q)
            }),
        }
    }
}

/// A quaternion from body to space coordinates.
const ROTATIONS: GroupNames = GroupNames {
    name: "SO3",
    conventions: "attitude: unit quaternion from body to space coordinates; momentum and velocity: body coordinates",
    configuration: "attitude",
    kind: Kind::UnitQuaternion,
    coordinates: &["w", "x", "y", "z"],
    unit_coordinates: 4,
    axes: &["x", "y", "z"],
    blocks: &[],
    parts: &[],
    components: COMPONENTS,
};

const SPINS: GroupNames = GroupNames {
    name: "SU2",
    conventions: "spin: unit quaternion, not identified with its negative; momentum and velocity: body coordinates",
    configuration: "spin",
    ..ROTATIONS
};

/// The components of a quaternion `(w, u)`, and nalgebra's methods for the rotation's angle `θ` from 0 to π, and for `θ`
/// times its axis.
const COMPONENTS: &[Component] = &[
    Component { name: "w", called: false, of: |g| ComponentValue::Scalar(g.0[0]) },
    Component { name: "i", called: false, of: |g| ComponentValue::Scalar(g.0[1]) },
    Component { name: "j", called: false, of: |g| ComponentValue::Scalar(g.0[2]) },
    Component { name: "k", called: false, of: |g| ComponentValue::Scalar(g.0[3]) },
    Component {
        name: "angle",
        called: true,
        of: |g| ComponentValue::Scalar(g.part(1..4).squared_norm().sqrt() * angle_by_vector(g)),
    },
    Component {
        name: "scaled_axis",
        called: true,
        of: |g| {
            let sign = g.0[0] / g.0[0].powi(2).sqrt();
            ComponentValue::Vector(g.part(1..4).scale(sign * angle_by_vector(g)))
        },
    },
];

/// `θ/|u| = 2 a(|w|)`, with `a = φ / sin φ` as a function of `cos φ` at the angle `φ = θ/2`. It is smooth where there is
/// no rotation, and the same for both quaternions of one.
fn angle_by_vector<'a>(g: &Vector<'a>) -> Expr<'a> {
    g.0[0].powi(2).sqrt().apply(Function::AngleOverSine(0)) * 2
}

/// `R v = v + 2w u × v + 2 u × (u × v)` for the quaternion `(w, u)`.
fn turned<'a>(g: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
    let (w, u) = (g.0[0], Vector(g.0[1..].to_vec()));
    let twice = u.cross(v).scale(w.arena().number(2));
    &(v + &twice.scale(w)) + &u.cross(&twice)
}

/// R³ with the rotations acting on it, `ρ_x v = x × v`; under a group of so many dimensions whose first three are the
/// rotation.
pub(super) struct Space(pub(super) usize);

impl Representation for Space {
    fn names(&self) -> SpaceNames {
        SpaceNames { name: "R3", coordinates: &["x", "y", "z"], algebra_dimension: self.0 }
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        x.cross(v)
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        Some(turned(&g.part(0..4), v))
    }

    /// `φ₁(x̂) = 1 + c₂ x̂ + c₃ x̂²`; the vectors are the algebra of the rotations itself, so that with the exponential
    /// SE(3) is the tangent group of SO(3). With the motions it is no tangent group.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        let x = x.part(0..3);
        let z = x.squared_norm();
        match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let before = Translation::before(rotation_like(&x, w, z.stumpff(2), z.stumpff(3)));
                Translation { is_tangent_group: self.0 == 3, ..before }
            }
            MatrixFunction::Cayley => Translation::halves(w),
        }
    }

    /// `exp x = 1 + c₁ x̂ + c₂ x̂²`, `cay x = 1 + (x̂ + x̂²/2)/(1 + z/4)`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let x = x.part(0..3);
        let z = x.squared_norm();
        match f {
            MatrixFunction::Cayley => {
                let factor = cayley_factor(&x);
                rotation_like(&x, v, factor, factor / 2)
            }
            _ => rotation_like(&x, v, z.stumpff(1), z.stumpff(2)),
        }
    }
}
