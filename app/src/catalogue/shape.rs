//! Shapes of bodies: solids of a kind and a size, as given or as a moment of inertia has them.

use coadjoint::prelude::*;
use nalgebra::SymmetricEigen;
use serde::{Deserialize, Serialize};

/// A solid about its own centre, in its own axes; lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Shape {
    /// A box with edges along the axes.
    Box {
        /// The lengths of its edges.
        size: [f64; 3],
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Its semi-axes.
        semi_axes: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A round rod along the third axis.
    Rod {
        /// From end to end.
        length: f64,
        /// Its radius.
        radius: f64,
    },
    /// A disc across the third axis.
    Disc {
        /// Its radius.
        radius: f64,
        /// Along the third axis.
        thickness: f64,
    },
    /// A spinning top along the third axis, with its tip in the centre.
    Cone {
        /// From tip to knob.
        height: f64,
        /// The largest radius.
        radius: f64,
    },
    /// Four rotors on arms along the first two axes, pulling along the third.
    Quadrotor {
        /// From the centre to a rotor's axis.
        arm: f64,
    },
}

impl Shape {
    /// All its lengths.
    pub fn lengths(&self) -> Vec<f64> {
        match *self {
            Self::Box { size: [a, b, c] } | Self::Ellipsoid { semi_axes: [a, b, c] } => vec![a, b, c],
            Self::Sphere { radius } => vec![radius],
            Self::Rod { length, radius } => vec![length, radius],
            Self::Disc { radius, thickness } => vec![radius, thickness],
            Self::Cone { height, radius } => vec![height, radius],
            Self::Quadrotor { arm } => vec![arm],
        }
    }
}

/// A shape at its place on a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[must_use]
pub struct Solid {
    /// Its name.
    #[serde(flatten)]
    pub shape: Shape,
    /// Its centre, in body axes, m.
    #[serde(default)]
    pub centre: [f64; 3],
    /// The rotation from its axes to those of the body, as a quaternion `w, x, y, z`.
    #[serde(default = "unturned")]
    pub rotation: [f64; 4],
    /// Only the ratios of its lengths have a meaning: it is drawn at a size that suits the scene.
    #[serde(default)]
    pub relative: bool,
    /// A note for the legend.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

const fn unturned() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

/// Moments that differ by less, relatively, are those of something round.
const ROUND: f64 = 0.02;
/// Thinner solids could not be seen: the least ratio of lengths that is drawn.
const THIN: f64 = 0.02;

impl Solid {
    /// At the body's origin, along its axes.
    pub fn new(shape: Shape) -> Self {
        Self { shape, centre: [0.0; 3], rotation: [1.0, 0.0, 0.0, 0.0], relative: false, note: None }
    }

    /// Centred here, in body axes, m.
    pub fn at(self, centre: Vector3<f64>) -> Self {
        Self { centre: centre.into(), ..self }
    }

    /// With its third axis along this direction in body axes.
    pub fn along(self, axis: Vector3<f64>) -> Self {
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &axis);
        // opposite directions: any half turn across
        self.turned(
            &turn
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)),
        )
    }

    /// Drawn at a size that suits the scene: only the ratios of its lengths have a meaning.
    pub fn of_any_size(self) -> Self {
        Self { relative: true, ..self }
    }

    /// A homogeneous solid with this moment of inertia about its centre of mass, of a size that is not known: a rod, a
    /// disc, a ball or an ellipsoid where it is round, otherwise a box. Of moments that no body has, the momental
    /// ellipsoid, and a note that says so. None if the moments are not positive.
    pub fn of_inertia(inertia: &Matrix3<f64>) -> Option<Self> {
        let (moments, axes) = principal(inertia)?;
        let solid = match homogeneous(&moments) {
            Some(solid) => solid,
            None => Self {
                note: Some("momental ellipsoid, as no body has these moments of inertia".to_owned()),
                ..Self::new(Shape::Ellipsoid {
                    semi_axes: moments.map(|moment| moment.sqrt().recip()).into(),
                })
            },
        };
        Some(Self { relative: true, ..solid.turned(&axes) })
    }

    /// The same with the size that a body of this mass has, kg. None if no body has these moments.
    pub fn of_mass(inertia: &Matrix3<f64>, mass: f64) -> Option<Self> {
        let (moments, axes) = principal(&(inertia / mass))?;
        homogeneous(&moments).map(|solid| solid.turned(&axes))
    }

    fn turned(self, by: &UnitQuaternion<f64>) -> Self {
        let [w, i, j, k] = self.rotation;
        let [i, j, k, w]: [f64; 4] = (by.into_inner() * Quaternion::new(w, i, j, k)).coords.into();
        Self { rotation: [w, i, j, k], ..self }
    }
}

/// Principal moments, with the rotation from their axes; axes that are principal already stay as they are.
fn principal(inertia: &Matrix3<f64>) -> Option<(Vector3<f64>, UnitQuaternion<f64>)> {
    let diagonal = inertia.diagonal();
    if !(inertia.iter().all(|x| x.is_finite()) && diagonal.min() > 0.0) {
        return None;
    }
    let (moments, axes) = if *inertia == Matrix3::from_diagonal(&diagonal) {
        (diagonal, UnitQuaternion::identity())
    } else {
        let SymmetricEigen { eigenvalues, mut eigenvectors } = inertia.symmetric_eigen();
        // axes of a solid have no sense of direction; those of a rotation are right-handed
        if eigenvectors.determinant() < 0.0 {
            eigenvectors.neg_mut();
        }
        let rotation = Rotation3::from_matrix_unchecked(eigenvectors);
        (eigenvalues, UnitQuaternion::from_rotation_matrix(&rotation))
    };
    (moments.min() > 0.0).then_some((moments, axes))
}

/// The homogeneous solid of these principal moments for each unit of mass.
fn homogeneous(moments: &Vector3<f64>) -> Option<Solid> {
    // the mean squares of the coordinates
    let squares = Vector3::repeat(moments.sum() / 2.0) - moments;
    if squares.min() < -1e-9 * moments.max() {
        return None;
    }
    let squares = squares.map(|square| square.max(0.0));
    let alike = |a: f64, b: f64| (a - b).abs() <= ROUND * a.max(b);
    let axis = (0..3).find(|k| alike(moments[(k + 1) % 3], moments[(k + 2) % 3]));
    let Some(axis) = axis else {
        let edges = squares.map(|square| (12.0 * square).sqrt());
        let least = THIN * edges.max();
        return Some(Solid::new(Shape::Box { size: edges.map(|edge| edge.max(least)).into() }));
    };
    let (along, across) = (squares[axis], squares[(axis + 1) % 3]);
    // from the third axis to the one about which it is round
    let onto = [[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, -0.5, -0.5], [1.0, 0.0, 0.0, 0.0]];
    let (length, radius) = ((12.0 * along).sqrt(), 2.0 * across.sqrt());
    let round = |shape| Solid { rotation: onto[axis], ..Solid::new(shape) };
    Some(if alike(along, across) {
        Solid::new(Shape::Sphere { radius: (5.0 * along).sqrt() })
    } else if along > 12.0 * across {
        round(Shape::Rod { length, radius: radius.max(THIN * length) })
    } else if across > 12.0 * along {
        round(Shape::Disc { radius, thickness: length.max(2.0 * THIN * radius) })
    } else {
        Solid::new(Shape::Ellipsoid { semi_axes: squares.map(|square| (5.0 * square).sqrt()).into() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(moments: [f64; 3]) -> Solid {
        Solid::of_inertia(&Matrix3::from_diagonal(&moments.into())).expect("positive")
    }

    #[test]
    fn solids_have_the_moments_they_are_made_of() {
        let Shape::Box { size: [a, b, c] } = of([1.0, 2.0, 2.5]).shape else { panic!("a box") };
        let moments = [b * b + c * c, a * a + c * c, a * a + b * b].map(|x| x / 12.0);
        for (moment, expected) in moments.into_iter().zip([1.0, 2.0, 2.5]) {
            assert!((moment - expected).abs() < 1e-12, "{moment} {expected}");
        }
    }

    #[test]
    fn round_bodies_are_rods_discs_balls_and_ellipsoids() {
        let rod = of([0.001, 1.0, 1.0]);
        assert!(matches!(rod.shape, Shape::Rod { .. }), "{rod:?}");
        // the third axis is brought to the first
        let [w, x, y, z] = rod.rotation;
        let turned = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * Vector3::z();
        assert!((turned - Vector3::x()).norm() < 1e-12, "{turned}");
        let rod = of([1.0, 0.001, 1.0]);
        let [w, x, y, z] = rod.rotation;
        let turned = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * Vector3::z();
        assert!((turned - Vector3::y()).norm() < 1e-12, "{turned}");
        assert!(matches!(of([1.0, 1.0, 1.99]).shape, Shape::Disc { .. }));
        assert!(matches!(of([2.0, 2.0, 2.0]).shape, Shape::Sphere { .. }));
        assert!(matches!(of([2.0, 2.0, 1.5]).shape, Shape::Ellipsoid { .. }));
    }

    #[test]
    fn moments_of_no_body_are_drawn_as_their_ellipsoid_with_a_note() {
        let solid = of([1.0, 4.0, 100.0]);
        assert_eq!(solid.shape, Shape::Ellipsoid { semi_axes: [1.0, 0.5, 0.1] });
        assert!(solid.note.is_some_and(|note| note.contains("no body")));
        assert_eq!(Solid::of_inertia(&Matrix3::from_diagonal(&vector![1.0, -1.0, 1.0])), None);
        assert_eq!(Solid::of_inertia(&Matrix3::from_diagonal(&vector![1.0, f64::NAN, 1.0])), None);
    }

    #[test]
    fn a_full_matrix_turns_the_solid() {
        let rotation = UnitQuaternion::from_euler_angles(0.3, -0.5, 0.9);
        let matrix = rotation.to_rotation_matrix();
        let inertia = matrix * Matrix3::from_diagonal(&vector![1.0, 2.0, 2.5]) * matrix.transpose();
        let solid = Solid::of_inertia(&inertia).expect("positive");
        let Shape::Box { size } = solid.shape else { panic!("a box") };
        // the longest edge lies along the axis of the least moment
        let longest = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).expect("three");
        let [w, x, y, z] = solid.rotation;
        let turned = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * Vector3::ith(longest, 1.0);
        assert!((turned.dot(&(rotation * Vector3::x())).abs() - 1.0).abs() < 1e-9, "{turned}");
    }

    #[test]
    fn symmetric_matrices_have_axes() {
        for round in 0..200 {
            let number =
                |k: usize| (f64::from(round) * 0.7 + k as f64 * 2.3).sin() * 10_f64.powi(round % 7 - 3);
            let any = Matrix3::from_fn(|i, j| number(3 * i + j));
            let positive = any * any.transpose() + Matrix3::identity() * any.norm_squared() * 1e-3;
            let (values, axes) = principal(&positive).expect("positive definite");
            let axes = axes.to_rotation_matrix();
            let scale = positive.norm();
            let error = (axes * Matrix3::from_diagonal(&values) * axes.transpose() - positive).norm();
            assert!(error < 1e-13 * scale, "{error:e} of {scale}");
        }
        let diagonal = Vector3::new(3.0, 1.0, 2.0);
        let (values, axes) = principal(&Matrix3::from_diagonal(&diagonal)).expect("positive definite");
        assert_eq!((values, axes), (diagonal, UnitQuaternion::identity()));
    }

    #[test]
    fn with_its_mass_a_solid_has_its_size() {
        let (mass, radius) = (0.2_f64, 0.04);
        let about = mass * radius * radius / 2.0;
        let disc = Matrix3::from_diagonal(&vector![about / 2.0, about / 2.0, about]);
        let Some(Shape::Disc { radius: found, .. }) = Solid::of_mass(&disc, mass).map(|solid| solid.shape)
        else {
            panic!("a disc")
        };
        assert!((found - radius).abs() < 1e-12, "{found}");
    }
}
