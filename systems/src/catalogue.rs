//! The list of systems that the program knows, each behind the same [`Entry`].

use coadjoint::certify::Report;
use coadjoint::prelude::*;
use coadjoint::system::Quantity;

use crate::catalogued::Catalogued;
use crate::crowd::{self, Course, Crowd, Glance, Shown};
use crate::simulation::{self, Job, Method, Retraction, Setup, SimulationError, Watch, Whereabouts};
use coadjoint::RunReport;

/// Every system: `module: Type`, with the name of its module, which is also its name on the command line; behind it in braces
/// further examples of the same system, `name = constructor, step …, duration …, "what it is"`.
macro_rules! catalogue {
    ($($module:ident: $type:path
        $({ $($preset:ident = $example:path, step $step:literal, duration $duration:literal, $about:literal;)* })?,
    )*) => {
        /// All systems, in the order in which they are listed.
        pub static CATALOGUE: &[Entry] = &[$(
            Entry::of::<$type>(stringify!($module), source!($module)),
            $($(
                Entry {
                    about: $about,
                    step: $step,
                    duration: $duration,
                    example: || simulation::flat(&$example()),
                    ..Entry::of::<$type>(stringify!($preset), source!($module))
                },
            )*)?
        )*];
    };
}

macro_rules! source {
    ($module:ident) => {
        include_str!(concat!(stringify!($module), ".rs"))
    };
}

catalogue! {
    harmonic_oscillator: crate::harmonic_oscillator::HarmonicOscillator,
    kepler: crate::kepler::Kepler,
    planar_pendulum: crate::planar_pendulum::PlanarPendulum,
    driven_pendulum: crate::driven_pendulum::DrivenPendulum,
    spherical_pendulum: crate::spherical_pendulum::SphericalPendulum,
    free_rigid_body: crate::free_rigid_body::FreeRigidBody,
    full_rigid_body: crate::full_rigid_body::FullRigidBody,
    heavy_top: crate::heavy_top::HeavyTop {
        lagrange_top = crate::heavy_top::HeavyTop::lagrange_top, step 0.001, duration 10.0,
            "a heavy top that is round: a toy gyroscope";
        kovalevskaya_top = crate::heavy_top::HeavyTop::kovalevskaya_top, step 0.01, duration 60.0,
            "a heavy top with I1 = I2 = 2 I3 and its centre of mass across";
    },
    magnetic_top: crate::magnetic_top::MagneticTop,
    quadrotor: crate::quadrotor::Quadrotor {
        loose_quadrotor = crate::quadrotor::Quadrotor::loose, step 0.01, duration 10.0,
            "a quadrotor with the thrust of hover that turns over and flies off";
    },
    rigid_body_in_space: crate::rigid_body_in_space::RigidBodyInSpace,
    gyrostat: crate::gyrostat::Gyrostat,
    coupled_bodies: crate::coupled_bodies::CoupledBodies,
    kirchhoff: crate::kirchhoff::Kirchhoff,
}

/// One system of the catalogue, its type erased: parameters and states are flat lists of numbers.
#[derive(Debug)]
pub struct Entry {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// The text of its file, from which the generated code can be shown.
    pub source: &'static str,
    /// The step it is run with unless another is asked for.
    pub step: f64,
    /// The duration it is run for unless another is asked for.
    pub duration: f64,
    /// Its parameters.
    pub parameters: &'static [Quantity],
    /// Its controls, which its own law chooses.
    pub controls: &'static [Quantity],
    /// What its state consists of.
    pub state: &'static [Quantity],
    /// Whether energy is an invariant of its motion.
    pub autonomous: bool,
    /// What its standard scheme of order 2 is.
    pub standard: fn() -> Method,
    /// The names of its Casimirs.
    pub casimirs: &'static [&'static str],
    /// Their units.
    pub casimir_units: &'static [&'static str],
    /// The example's parameters and initial state.
    pub example: fn() -> Setup,
    /// Checks parameters; a note says what is odd about valid ones.
    pub check: fn(&Setup) -> Result<Option<String>, ParameterError>,
    /// Makes a run, or goes on with one.
    pub simulate:
        fn(&Setup, &Job, Option<&Whereabouts>, &mut Watch<'_>) -> Result<RunReport, SimulationError>,
    /// Runs an ensemble.
    pub ensemble: fn(&Setup, &Crowd, &[Shown], &mut Glance<'_>) -> Result<Course, SimulationError>,
    /// Measures what a scheme of order 2 or 1 claims.
    pub certify: fn(&Setup, Method, Retraction) -> Result<Report, SimulationError>,
    /// Measures the time that a step takes, ns.
    pub time_per_step: fn(&Setup, &Job) -> Result<Option<f64>, SimulationError>,
}

impl Entry {
    const fn of<S: Catalogued + 'static>(name: &'static str, source: &'static str) -> Self {
        Self {
            name,
            about: S::ABOUT,
            source,
            step: S::STEP,
            duration: S::DURATION,
            parameters: S::PARAMETERS,
            state: <S::State as State>::QUANTITIES,
            controls: <S::Control as Control>::QUANTITIES,
            autonomous: S::AUTONOMOUS,
            standard: simulation::standard::<S>,
            casimirs: S::CASIMIRS,
            casimir_units: S::CASIMIR_UNITS,
            example: simulation::example::<S>,
            check: simulation::check::<S>,
            simulate: simulation::simulate::<S>,
            ensemble: crowd::run::<S>,
            certify: simulation::certify::<S>,
            time_per_step: simulation::time_per_step::<S>,
        }
    }

    /// The names of the columns of a trajectory: time, every component of the state, energy.
    pub fn columns(&self) -> Vec<String> {
        let mut columns = vec!["time".to_owned()];
        for quantity in self.state {
            columns.extend(quantity.components.iter().map(|component| component_name(quantity, component)));
        }
        columns.push("energy".to_owned());
        columns
    }
}

/// `chi_x` for a component, `weight` for a scalar.
pub fn component_name(quantity: &Quantity, component: &str) -> String {
    if component.is_empty() { quantity.name.to_owned() } else { format!("{}_{component}", quantity.name) }
}

/// The system of this name; `heavy-top` and `HeavyTop` find `heavy_top` too.
pub fn find(name: &str) -> Option<&'static Entry> {
    let plain = |name: &str| name.to_lowercase().replace(['_', '-', ' '], "");
    CATALOGUE.iter().find(|entry| plain(entry.name) == plain(name))
}
