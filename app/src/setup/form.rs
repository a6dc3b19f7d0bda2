//! Rotations and symmetric matrices in the forms in which people have them.

use clap::ValueEnum as _;
use coadjoint::system::{Kind, Quantity};
use nalgebra::{UnitQuaternion, Vector3};

use crate::catalogue::quantities::rotation;
use crate::error::SetupError;

/// A way to write a rotation of space in three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum RotationForm {
    /// Roll, pitch and yaw, rad: turns about x, then y, then z, each in the axes of space.
    Euler,
    /// The axis times the angle, rad.
    Rotvec,
    /// Modified Rodrigues parameters: the axis times the tangent of a quarter of the angle.
    Mrp,
}

impl RotationForm {
    /// Finds the form of this name.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn named(name: &str) -> Result<Self, SetupError> {
        let name = name.trim();
        Self::from_str(name, false).map_err(|_| {
            SetupError::new(format!("there is no form `{name}` of a rotation: `euler`, `rotvec` or `mrp`"))
        })
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Rotvec => "rotvec",
            Self::Mrp => "mrp",
        }
    }

    fn read(self, [x, y, z]: [f64; 3]) -> UnitQuaternion<f64> {
        let vector = Vector3::new(x, y, z);
        match self {
            Self::Euler => UnitQuaternion::from_euler_angles(x, y, z),
            Self::Rotvec => UnitQuaternion::from_scaled_axis(vector),
            Self::Mrp => {
                let (real, imaginary) = (1.0 - vector.norm_squared(), 2.0 * vector);
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::from_parts(real, imaginary))
            }
        }
    }

    /// Writes a rotation: as a vector by its angle up to π.
    pub(super) fn write(self, quaternion: &[f64]) -> [f64; 3] {
        let &[w, x, y, z] = quaternion else { return [f64::NAN; 3] };
        let rotation = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        match self {
            Self::Euler => rotation.euler_angles().into(),
            Self::Rotvec => rotation.scaled_axis().into(),
            // of the two signs of a quaternion the one with the smaller parameters
            Self::Mrp => (rotation.imag() * rotation.w.signum() / (1.0 + rotation.w.abs())).into(),
        }
    }
}

/// The numbers of a whole quantity as they are stored, from other forms: a rotation of space in this form, one of the
/// plane by its angle, a symmetric matrix by its upper triangle or its diagonal. None if they are in no such form.
pub(super) fn stored(quantity: &Quantity, form: Option<RotationForm>, numbers: &[f64]) -> Option<Vec<f64>> {
    let length = quantity.components.len();
    match (form, quantity.kind, rotation(quantity)) {
        (Some(form), _, Some((4, _))) if numbers.len() + 1 == length => {
            let (first, rest) = numbers.split_first_chunk::<3>()?;
            let turned = form.read(*first);
            Some([&[turned.w, turned.i, turned.j, turned.k], rest].concat())
        }
        (None, _, Some((2, _))) if numbers.len() + 1 == length => {
            let (angle, rest) = numbers.split_first()?;
            let (sin, cos) = angle.sin_cos();
            Some([&[cos, sin], rest].concat())
        }
        (None, Kind::SymmetricMatrix(n), _) if numbers.len() == n => {
            let entry = |k: usize| if k / n == k % n { numbers[k / n] } else { 0.0 };
            Some((0..n * n).map(entry).collect())
        }
        (None, Kind::SymmetricMatrix(n), _) if numbers.len() == n * (n + 1) / 2 => {
            let entry = |k: usize| {
                let (row, column) = (k / n, k % n);
                let (row, column) = (row.min(column), row.max(column));
                // before the row are `n + (n − 1) + …` numbers
                numbers[row * (2 * n - row + 1) / 2 + column - row]
            };
            Some((0..n * n).map(entry).collect())
        }
        (None, ..) if numbers.len() == length => Some(numbers.to_vec()),
        _ => None,
    }
}

/// What else a whole quantity takes beside its numbers, in words.
pub(super) fn others(quantity: &Quantity) -> String {
    match (quantity.kind, rotation(quantity)) {
        (_, Some((4, _))) => {
            format!("; in other forms `{0}=euler:…`, `{0}=rotvec:…`, `{0}=mrp:…`", quantity.name)
        }
        (_, Some((_, _))) => "; an angle in rad stands for the first two".to_owned(),
        (Kind::SymmetricMatrix(n), _) if n > 1 => {
            let triangle = if n == 3 { ": xx, xy, xz, yy, yz, zz" } else { "" };
            let count = n * (n + 1) / 2;
            format!("; {count} are its upper triangle, row by row{triangle}; {n} its diagonal")
        }
        _ => String::new(),
    }
}
