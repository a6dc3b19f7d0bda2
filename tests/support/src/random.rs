//! Random numbers that are the same on every run.

use coadjoint::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// A stream of random numbers (splitmix64), a function of its seed.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of that seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly distributed between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// One of several.
    ///
    /// # Panics
    /// If there is none.
    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.bits() % choices.len() as u64) as usize]
    }

    /// A vector with components between −1 and 1.
    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-1.0, 1.0))
    }

    /// A vector of length 1.
    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let vector = self.vector();
            if (0.1..1.0).contains(&vector.norm()) {
                return vector.normalize();
            }
        }
    }

    /// A matrix with entries between −1 and 1.
    pub fn matrix(&mut self) -> Matrix3<f64> {
        Matrix3::from_fn(|_, _| self.between(-1.0, 1.0))
    }

    /// A rotation.
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        let (scalar, vector) = (self.between(-1.0, 1.0), self.direction());
        UnitQuaternion::new_normalize(Quaternion::from_parts(scalar, vector))
    }

    /// Principal moments of inertia.
    pub fn moments(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(0.5, 3.0))
    }

    /// A symmetric positive definite matrix, none of whose axes is a coordinate axis.
    pub fn inertia(&mut self) -> Matrix3<f64> {
        let axes = self.rotation().to_rotation_matrix().into_inner();
        let inertia = axes * Matrix3::from_diagonal(&self.moments()) * axes.transpose();
        (inertia + inertia.transpose()) * 0.5
    }
}
