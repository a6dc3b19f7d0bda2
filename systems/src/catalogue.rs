//! The list of systems that the program knows, each behind the same [`Entry`].

use coadjoint::certify::Report;
use coadjoint::prelude::*;
use coadjoint::system::Quantity;

use crate::catalogued::Catalogued;
use crate::error::Error;
use crate::simulation::{self, Job, Method, Retraction, Setup, Watch, Whereabouts};
use crate::suggest::did_you_mean;
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
    pub simulate: fn(&Setup, &Job, Option<&Whereabouts>, &mut Watch<'_>) -> Result<RunReport, Error>,
    /// Measures what a scheme of order 2 or 1 claims.
    pub certify: fn(&Setup, Method, Retraction) -> Result<Report, Error>,
    /// Measures the time that a step takes, ns.
    pub time_per_step: fn(&Setup, &Job) -> Result<Option<f64>, Error>,
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
///
/// # Errors
/// If there is none.
pub fn find(name: &str) -> Result<&'static Entry, Error> {
    let plain = |name: &str| name.to_lowercase().replace(['_', '-', ' '], "");
    CATALOGUE.iter().find(|entry| plain(entry.name) == plain(name)).ok_or_else(|| {
        let hint = did_you_mean(name, CATALOGUE.iter().map(|entry| entry.name));
        Error::Input(format!("there is no system `{name}`{hint} (`coadjoint list` shows all)"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_complete_and_consistent() {
        for entry in CATALOGUE {
            assert!(!entry.about.is_empty() && !entry.about.ends_with('.'), "{}", entry.name);
            assert!(entry.step > 0.0 && entry.duration > entry.step, "{}", entry.name);
            assert_eq!(entry.casimirs.len(), entry.casimir_units.len(), "{}", entry.name);
            let setup = (entry.example)();
            let count =
                |quantities: &[Quantity]| quantities.iter().map(|q| q.components.len()).sum::<usize>();
            // constants of the description follow the parameters
            assert!(setup.parameters.len() >= count(entry.parameters), "{}", entry.name);
            assert_eq!(setup.state.len(), count(entry.state), "{}", entry.name);
            assert_eq!(entry.columns().len(), setup.state.len() + 2, "{}", entry.name);
            (entry.check)(&setup).expect("an example with valid parameters");
        }
    }

    #[test]
    fn names_are_found_however_they_are_written() {
        for name in ["heavy_top", "heavy-top", "HeavyTop", "heavytop"] {
            assert_eq!(find(name).expect("it is there").name, "heavy_top");
        }
        let message = find("heavy_tip").expect_err("there is none").to_string();
        assert!(message.contains("did you mean `heavy_top`?"), "{message}");
    }
}
