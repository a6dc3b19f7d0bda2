//! The list of systems that the program knows.

use std::sync::LazyLock;

use coadjoint_app::{Catalogue, Entry, Example};

/// Every system: `module: Type`, with the name of its module, which is also its name on the command line; `as isolated` where nothing acts on
/// it; behind it in braces further examples of the same system, `name = constructor, step …, duration …, "what it is"`.
macro_rules! catalogue {
    ($($module:ident: $type:path
        $(as $isolated:ident)?
        $({ $($preset:ident = $example:path, step $step:literal, duration $duration:literal, $about:literal;)* })?,
    )*) => {
        /// All systems, in the order in which they are listed.
        pub fn entries() -> Vec<Entry> {
            let mut entries = Vec::new();
            $(
                let entry = <$type>::entry().with_source(include_str!(concat!(stringify!($module), ".rs")));
                $(let entry = $isolated::<$type>(entry);)?
                entries.push(entry.clone());
                $($(
                    let preset = stringify!($preset);
                    entries.push(entry.clone().preset(preset, $about, &$example(), ($step, $duration)));
                )*)?
            )*
            entries
        }
    };
}

catalogue! {
    harmonic_oscillator: crate::harmonic_oscillator::HarmonicOscillator,
    kepler: crate::kepler::Kepler,
    two_bodies: crate::two_bodies::TwoBodies,
    planar_pendulum: crate::planar_pendulum::PlanarPendulum,
    double_pendulum: crate::double_pendulum::DoublePendulum,
    driven_pendulum: crate::driven_pendulum::DrivenPendulum,
    spherical_pendulum: crate::spherical_pendulum::SphericalPendulum,
    free_rigid_body: crate::free_rigid_body::FreeRigidBody as isolated,
    full_rigid_body: crate::full_rigid_body::FullRigidBody as isolated,
    heavy_top: crate::heavy_top::HeavyTop {
        lagrange_top = crate::heavy_top::HeavyTop::lagrange_top, step 0.001, duration 10.0,
            "a heavy top that is round: a toy gyroscope";
        kovalevskaya_top = crate::heavy_top::HeavyTop::kovalevskaya_top, step 0.01, duration 60.0,
            "a heavy top with I1 = I2 = 2 I3 and its centre of mass across";
    },
    heavy_top_on_se3: crate::heavy_top_on_se3::HeavyTopOnSE3 as isolated,
    magnetic_top: crate::magnetic_top::MagneticTop,
    quadrotor: crate::quadrotor::Quadrotor {
        hovering_quadrotor = crate::quadrotor::Quadrotor::hovering, step 0.01, duration 10.0,
            "a quadrotor in hover: thrust m g, moment 0";
    },
    rigid_body_in_space: crate::rigid_body_in_space::RigidBodyInSpace as isolated,
    hanging_plate: crate::hanging_plate::HangingPlate,
    gyrostat: crate::gyrostat::Gyrostat as isolated,
    satellite_with_wheels: crate::satellite_with_wheels::SatelliteWithWheels,
    coupled_bodies: crate::coupled_bodies::CoupledBodies,
    kirchhoff: crate::kirchhoff::Kirchhoff,
    ellipsoidal_fluid: crate::ellipsoidal_fluid::EllipsoidalFluid as isolated,
    nuclear_spin: crate::nuclear_spin::NuclearSpin,
    spin_chain: crate::spin_chain::SpinChain,
    four_dimensional_body: crate::four_dimensional_body::FourDimensionalBody,
    affine_body: crate::affine_body::AffineBody,
    navigation: crate::navigation::Navigation,
    three_level_atom: crate::three_level_atom::ThreeLevelAtom,
}

/// All systems.
pub static CATALOGUE: LazyLock<Catalogue> = LazyLock::new(|| Catalogue::new(entries()));

/// An entry of a system on which nothing acts.
fn isolated<S>(entry: Entry) -> Entry
where
    S: Example
        + coadjoint::system::Isolated
        + coadjoint::Discretized<coadjoint::SymplecticEulerA<coadjoint::Exponential>>
        + coadjoint::Discretized<coadjoint::SymplecticEulerA<coadjoint::Cayley>>,
{
    entry.with_right_lift::<S>()
}
