//! The Kepler problem.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Body, Scene};
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A satellite of a body so heavy that it stays where it is.
///
/// Hamiltonian: `H = |p|²/2m − GMm/|x|`, with the position `x` from the heavy body's centre and the momentum `p`.
///
/// Motion: `ẋ = p/m`, `ṗ = −GMm x/|x|³`: for negative energies an ellipse with a focus at the centre, of the semi-major axis
/// `a = −GMm/2H` and the period `2π √(a³/GM)`.
///
/// Invariants: the energy `H`, the angular momentum `x × p`, and the eccentricity vector
/// `p × (x × p) / GMm² − x/|x|`, which points to where the satellite comes closest.
#[lie_poisson_system(
    group = R3,
    potential = -attraction * mass / position.norm(),
    methods(Midpoint),
    taylor,
    units(position = "m", momentum = "kg m/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kepler {
    /// Mass of the satellite, kg.
    #[inertia]
    #[unit("kg")]
    pub mass: f64,
    /// Constant of gravitation times the mass of the heavy body, m³/s².
    #[unit("m³/s²")]
    pub attraction: f64,
}

impl Kepler {
    /// Earth's constant of gravitation times its mass, m³/s².
    pub const EARTH: f64 = 3.986_004_418e14;
    /// Earth's mean radius, m.
    pub const EARTH_RADIUS: f64 = 6.371e6;

    /// Where it comes closest on an ellipse in the plane `z = 0`, on its way counter-clockwise.
    pub fn at_pericentre(&self, semi_major_axis: f64, eccentricity: f64) -> KeplerState {
        let distance = semi_major_axis * (1.0 - eccentricity);
        let speed = (self.attraction / semi_major_axis * (1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
        KeplerState { position: vector![distance, 0.0, 0.0], momentum: vector![0.0, self.mass * speed, 0.0] }
    }

    /// The time of one revolution, s.
    pub fn period(&self, semi_major_axis: f64) -> f64 {
        std::f64::consts::TAU * (semi_major_axis.powi(3) / self.attraction).sqrt()
    }

    /// `x × p`, kg m²/s.
    pub fn angular_momentum(state: &KeplerState) -> Vector3<f64> {
        state.position.cross(&state.momentum)
    }
}

impl Example for Kepler {
    const ABOUT: &'static str = "a satellite on an ellipse about the Earth";
    const STEP: f64 = 20.0;
    const DURATION: f64 = 200_000.0;

    /// A tonne on an ellipse about the Earth of eccentricity 0.6, from 8 000 km to 32 000 km from its centre: 7.8 hours.
    fn example() -> (Self, KeplerState) {
        let kepler = Kepler { mass: 1000.0, attraction: Self::EARTH };
        let start = kepler.at_pericentre(2e7, 0.6);
        (kepler, start)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let earth = Solid::new(Shape::Sphere { radius: Self::EARTH_RADIUS });
        by_state.named(0, "satellite").body(Body::fixed("Earth").planet().with(earth))
    }
}
