//! A plate on an elastic band.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A plate that hangs on an elastic band, tied off its centre, and moves in a vertical plane: it swings, bounces and turns at once.
///
/// Hamiltonian: `H = L²/2I + |p|²/2m + mg y + ½k (|x + Rc| − l)²`, with the position `(x, y)` of the centre of mass from where the band is held,
/// the angular momentum `L` about the centre of mass and the linear momentum `p` in the axes of the plate, and the point `c` of the plate where
/// the band is tied.
///
/// Motion: with the velocities `ω = L/I` and `v = p/m`, `Ṙ = R ωJ`, `ẋ = R v`, and with the pull `f` of band and weight in the axes of the
/// plate, `ṗ = −ω Jp + f`, `L̇ = c × f_band`; `J` turns by a right angle.
///
/// Invariant: the energy `H`. The band pulls and pushes: it is an elastic rod that does not bend.
#[lie_poisson_system(
    group = SE2,
    potential = {
        let tied = pose.transform_point(&Point2::from(eye));
        let stretch = tied.coords.norm() - length;
        weight * pose.translation.y + 0.5 * stiffness * stretch.powi(2)
    },
    methods(Midpoint),
    units(pose = "1, 1, m, m", momentum = "kg m²/s, kg m/s, kg m/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HangingPlate {
    /// Moment of inertia about the centre of mass, kg m², and the mass in both directions, kg.
    #[inertia]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    #[unit("N")]
    pub weight: f64,
    /// From the centre of mass to where the band is tied, in the axes of the plate, m.
    #[unit("m")]
    pub eye: Vector2<f64>,
    /// Stiffness of the band, N/m.
    #[unit("N/m")]
    pub stiffness: f64,
    /// Length of the band when it does not pull, m.
    #[unit("m")]
    pub length: f64,
}

impl HangingPlate {
    /// A rectangular plate on Earth, tied at a corner: mass, kg, width and height, m.
    pub fn rectangle(mass: f64, width: f64, height: f64) -> Self {
        Self {
            inertia: vector![mass * (width * width + height * height) / 12.0, mass, mass],
            weight: mass * 9.81,
            eye: vector![width, height] / 2.0,
            stiffness: 40.0,
            length: 0.3,
        }
    }

    /// At rest with its centre of mass here, m, turned by this angle, rad.
    pub fn at_rest(position: Vector2<f64>, angle: f64) -> HangingPlateState {
        HangingPlateState { pose: Isometry2::new(position, angle), momentum: Vector3::zeros() }
    }
}

impl Example for HangingPlate {
    const ABOUT: &'static str =
        "a plate on an elastic band that swings, bounces and turns in a vertical plane";
    const STEP: f64 = 0.002;
    const DURATION: f64 = 20.0;

    /// A plate of 200 g, 20 cm wide and 10 cm high, let go beside the place where it would hang.
    fn example() -> (Self, HangingPlateState) {
        (Self::rectangle(0.2, 0.2, 0.1), Self::at_rest(vector![0.1, -0.45], 1.7))
    }

    /// A plate that is tied at a corner.
    fn scene(&self, by_state: Scene) -> Scene {
        let size = [2.0 * self.eye.x.abs(), 0.01, 2.0 * self.eye.y.abs()];
        let eye = vector![self.eye.x, 0.0, self.eye.y];
        by_state
            .named(0, "plate")
            .solid(0, Solid::new(Shape::Box { size }))
            .spring(Vector3::zeros(), 0, eye)
            .weight(0, self.weight, Vector3::zeros())
    }
}
