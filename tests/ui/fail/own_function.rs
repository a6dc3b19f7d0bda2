use coadjoint::prelude::*;

fn height(gamma: &Vector3<f64>) -> f64 {
    gamma.z
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * height(&gamma))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

mod shapes {
    use coadjoint::prelude::*;

    #[expression]
    pub fn lever(arm: f64, angle: f64) -> f64 {
        arm * angle.sine()
    }

    #[expression]
    pub fn twice(x: f64) -> f64 {
        2.0 * lever(x)
    }

    #[expression]
    pub fn endless(x: f64) -> f64 {
        x * endless(x)
    }

    #[expression]
    pub fn sees(x: f64) -> f64 {
        x * weight
    }
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * shapes::lever(gamma.z, gamma))]
pub struct Wrong {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * (shapes::twice(gamma.x) + shapes::endless(gamma.y) + shapes::sees(gamma.z)),
)]
pub struct Others {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

#[expression]
fn of_any<T>(x: T) -> T {
    x
}

#[expression]
struct None;

fn main() {}
