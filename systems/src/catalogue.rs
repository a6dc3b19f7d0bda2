//! The list of systems that the program knows, each behind the same [`Entry`].

use coadjoint::erased::{self, Description, Flat};
use coadjoint::prelude::*;
use coadjoint::system::{Isolated, Quantity};
use coadjoint::{Discretized, RightLift, System};

use crate::catalogued::Catalogued;
use crate::simulation::{Retraction, Setup};

/// Every system: `module: Type`, with the name of its module, which is also its name on the command line; `as isolated` where nothing acts on
/// it; behind it in braces further examples of the same system, `name = constructor, step …, duration …, "what it is"`.
macro_rules! catalogue {
    ($($module:ident: $type:path
        $(as $isolated:ident)?
        $({ $($preset:ident = $example:path, step $step:literal, duration $duration:literal, $about:literal;)* })?,
    )*) => {
        /// All systems, in the order in which they are listed.
        pub static CATALOGUE: &[Entry] = &[$(
            Entry::of::<$type>(stringify!($module), source!($module))$(.$isolated::<$type>())?,
            $($(
                Entry {
                    about: $about,
                    step: $step,
                    duration: $duration,
                    example: || flat(&$example()),
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
        loose_quadrotor = crate::quadrotor::Quadrotor::loose, step 0.01, duration 10.0,
            "a quadrotor with the thrust of hover that turns over and flies off";
    },
    rigid_body_in_space: crate::rigid_body_in_space::RigidBodyInSpace as isolated,
    hanging_plate: crate::hanging_plate::HangingPlate,
    gyrostat: crate::gyrostat::Gyrostat as isolated,
    coupled_bodies: crate::coupled_bodies::CoupledBodies,
    kirchhoff: crate::kirchhoff::Kirchhoff,
    ellipsoidal_fluid: crate::ellipsoidal_fluid::EllipsoidalFluid as isolated,
    nuclear_spin: crate::nuclear_spin::NuclearSpin,
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
    /// The step that suits its certificates, where the motion of its example does not show how fast or slow it can be.
    pub certified_step: Option<f64>,
    /// What it is: parameters, state, controls, Casimirs.
    pub description: Description,
    /// The units of its Casimirs.
    pub casimir_units: &'static [&'static str],
    /// The example's parameters and initial state.
    pub example: fn() -> Setup,
    /// The system with these parameters.
    pub system: fn(&[f64]) -> Box<dyn erased::System>,
    /// Its own control law with these parameters. None if it has no controls.
    pub control: Option<fn(&[f64]) -> ControlLaw>,
    /// What takes its steps with the momentum carried in space, with these parameters, of this size. None if something acts on it.
    pub right_lift: Option<MethodFn>,
    /// The moment of inertia, if it is a body of mass, by its parameters.
    pub body_inertia: fn(&[f64]) -> Option<Matrix3<f64>>,
}

/// What takes steps on a retraction, with these parameters, of this size. None on retractions that not every system has steps with.
pub type MethodFn = fn(&[f64], Retraction, f64) -> Option<Box<dyn erased::Method<f64>>>;

/// Writes what is held over the step from a state at a time.
pub type ControlLaw = Box<dyn Fn(&[f64], f64, &mut [f64]) + Send + Sync>;

impl Entry {
    const fn of<S: Catalogued>(name: &'static str, source: &'static str) -> Self {
        let description = Description::of::<S>();
        Self {
            name,
            about: S::ABOUT,
            source,
            step: S::STEP,
            duration: S::DURATION,
            certified_step: S::CERTIFIED_STEP,
            description,
            casimir_units: S::CASIMIR_UNITS,
            example: || flat(&S::example()),
            system: |parameters| Box::new(system::<S>(parameters)),
            control: if description.controls.is_empty() { None } else { Some(control::<S>) },
            right_lift: None,
            body_inertia: |parameters| system::<S>(parameters).body_inertia(),
        }
    }

    /// The same of a system on which nothing acts.
    const fn isolated<S>(self) -> Self
    where
        S: Catalogued
            + Isolated
            + Discretized<SymplecticEulerA<Exponential>>
            + Discretized<SymplecticEulerA<Cayley>>,
    {
        Self { right_lift: Some(right_lift::<S>), ..self }
    }

    /// The names of the columns of a trajectory: time, every component of the state, energy.
    pub fn columns(&self) -> Vec<String> {
        let mut columns = vec!["time".to_owned()];
        for quantity in self.description.state {
            columns.extend(quantity.components.iter().map(|component| component_name(quantity, component)));
        }
        columns.push("energy".to_owned());
        columns
    }
}

/// A system and its state as flat lists; its own law chooses all controls.
fn flat<S: System<Scalar = f64>>((system, state): &(S, S::State)) -> Setup {
    Setup {
        parameters: system.to_parameters().as_ref().to_vec(),
        state: state.to_components().as_ref().to_vec(),
        controls: vec![None; S::Control::default().to_components().as_ref().len()],
    }
}

/// The numbers as an array; what is missing is as in the example.
fn filled<A: AsMut<[f64]>>(mut array: A, numbers: &[f64]) -> A {
    array.as_mut().iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
    array
}

/// The system with these parameters.
fn system<S: Catalogued>(parameters: &[f64]) -> S {
    S::from_parameters(&filled(S::example().0.to_parameters(), parameters))
}

fn control<S: Catalogued>(parameters: &[f64]) -> ControlLaw {
    let system = system::<S>(parameters);
    let example = S::example().1.to_components();
    Box::new(move |state, time, to| {
        let state = S::State::from_components(&filled(example, state));
        let control = system.control(&state, time).to_components();
        to.iter_mut().zip(control.as_ref()).for_each(|(to, number)| *to = *number);
    })
}

fn right_lift<S>(
    parameters: &[f64],
    retraction: Retraction,
    step: f64,
) -> Option<Box<dyn erased::Method<f64>>>
where
    S: Catalogued
        + Isolated
        + Discretized<SymplecticEulerA<Exponential>>
        + Discretized<SymplecticEulerA<Cayley>>,
{
    type Lifted<S, R> = <S as Discretized<RightLift<SymplecticEulerA<R>>>>::Method<f64>;
    match retraction {
        Retraction::Exponential => Some(Flat::<Lifted<S, Exponential>, false>::boxed(parameters, step)),
        Retraction::Cayley => Some(Flat::<Lifted<S, Cayley>, false>::boxed(parameters, step)),
        Retraction::SecondKind => None,
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
