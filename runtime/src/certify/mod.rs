//! Certificates: what a scheme claims of its steps, measured on a system of yours.
//!
//! A generated step is correct or it is not; that it looks right on a plot says little. [`certify`] takes a system and sample states,
//! and measures what the [scheme](crate::scheme) claims there: the order, the Poisson structure, the Casimirs, that the step back undoes
//! the step, that it is the step its definition says, and that it is a map: what a stepper remembers of earlier steps makes no
//! difference. Each certificate has the figure measured and its bound, and fails if the claim is wrong.
//!
//! ```
//! use coadjoint::certify;
//! use coadjoint::prelude::*;
//!
//! #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
//! struct Top {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//!     weight: f64,
//!     chi: Vector3<f64>,
//! }
//!
//! let top = Top { inertia: vector![1.0, 2.0, 2.5], weight: 1.0, chi: vector![0.1, 0.2, 1.0] };
//! let state = TopState {
//!     attitude: UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
//!     momentum: vector![0.4, -0.8, 1.5],
//!     gamma: vector![0.6, 0.0, 0.8],
//! };
//! let report = certify::<Cayley, _>(&top, &[state])?;
//! assert!(report.passed(), "{report}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | certificate | figure | holds if |
//! |---|---|---|
//! | order | slope of a step's error by its length, where that is far above rounding and nearest to 0 | claimed order, less 0.15 or a twentieth of it |
//! | series | what a Hamilton–Jacobi step uses of its series' reach: the root of what two half as long ones change of it, as a part of their way | ≤ 0.35 |
//! | consistency | the step's derivative by its size, less the motion | ≤ 1e-9 |
//! | Poisson map | `D P Dᵀ − P'`, `D` the step's derivative | ≤ 1e-9 |
//! | Casimirs | drift over a thousand steps (a hundred where a force acts) | ≤ 1e-11 |
//! | energy drift | drift by linear fit, as a part of the error's range, over a thousand steps, or four, sixteen or sixty-four thousand, or as many shorter ones | ≤ ½ |
//! | energy order | slope of the energy's error, with the shortest steps that show one | claimed order less ½ |
//! | reversibility | distance from the start after a step and one back, and after twenty and twenty back, by what a distance on the way back grows | ≤ 1e-13, times √n for n steps in one |
//! | Newton correction | difference from the one with a differenced Jacobian | ≤ 1e-6, but for Hamilton–Jacobi steps |
//! | definition | distance from a step that knows no closed form | ≤ 1e-10 |
//! | warm steps | distance of steps along 2,500, by one stepper, from those of equations solved in twice the digits | ≤ 8 |
//! | restarts | the same from new states | ≤ 8 |
//! | control jumps | the same with controls that jump, by a part in 10⁹, in 10³, and by all that they are | ≤ 8 |
//! | long steps | the same with steps two, four and eight times as long, unless the motion becomes too fast for them | ≤ 8 |
//! | zeros | the same of first steps, with each momentum and advected parameter zero in turn, and with no momentum | ≤ 8 |
//! | energy differential | difference from differences of the energy | ≤ 1e-9 |
//! | antisymmetry, Jacobi identity | of the Poisson structure | ≤ 1e-14, 1e-8 |
//! | exponential, inverse | displacements against their definition; `τ(−ξ) τ(ξ) = e` | ≤ 1e-10, 1e-13 |
//!
//! All are relative to the size of the states, and the worst sample counts. A figure without a bound is one that the scheme does not
//! claim. The energy's drift is no proof: what drifts only for a while may pass, as a slow oscillation must.
//!
//! Of warm steps the last places count, in each quantity, turns and positions apart: in units of what rounding may leave of all operations of the
//! step, by running error analysis, however their terms cancel. Of the solver's own rules of when to stop these units know nothing. A step that one
//! stepper does not solve and a new one does, or that a new one does not solve and twice the digits do, is infinitely far off. Steps that are
//! differenced by states or step are of new steppers: they are on no trajectory.
//!
//! Samples should be in general position: certificates see what the motion there can show. Of a system that is written [piece by
//! piece](crate::System::PIECEWISE) they are to be away from kinks: its order is that of the shortest stretch that shows one, of its energy's error nothing
//! is claimed, and a step over a jump that has no solution is not measured. Steps and differences are a small part of a
//! radian, or of the time in which the velocity changes; a faster time of its own, as a stiff spring or a drive has it, wants a
//! [step](Certification::step) that resolves it.
//!
//! What [Taylor steps](crate::taylor) claim, [`certify_taylor`] measures.
//!
//! What belongs to the group, and not to a scheme, [`group_laws`] measures more closely, and [`assert_group_laws!`](crate::assert_group_laws) is the
//! test of a group by itself.

mod definition;
mod frame;
mod laws;
mod measure;
mod neighbourhood;
mod probe;
mod report;
mod series;
mod taylor;
mod warm;

use thiserror::Error;

#[doc(hidden)]
pub use frame::{Frame, Linear};
pub use laws::group_laws;
#[doc(hidden)]
pub use laws::group_laws_of;
#[doc(hidden)]
pub use measure::Claimed;
#[doc(hidden)]
pub use probe::{KernelPart, kernel};
pub use report::{Bound, Certificate, Report, Verdict};
#[doc(hidden)]
pub use series::REACH;
pub use taylor::certify_taylor;

use crate::erased::{self, At, Flat, NotGenerated};
use crate::error::{ParameterError, StepError};
use crate::schemes::{Scheme, SchemeType};
use crate::system::{Control, Discretized, Geometry, State};
use measure::Subject;

/// Certifies the steps that the scheme `M` takes of a system, at sample states; with all controls zero and from the time 0. For other
/// ones there is [`Certification`].
///
/// # Errors
/// If the parameters are not valid, there is no state, or a step cannot be taken.
pub fn certify<M, S>(system: &S, states: &[S::State]) -> Result<Report, CertifyError>
where
    S: Geometry<Scalar = f64> + Discretized<M> + erased::System,
    M: SchemeType,
{
    Certification::new(system).states(states).run::<M>()
}

/// What is certified: a system at sample states.
///
/// ```
/// use coadjoint::certify::Certification;
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3, control(moment: R3), force = moment, methods(Midpoint))]
/// struct Craft {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let craft = Craft { inertia: vector![1.0, 2.0, 2.5] };
/// let state = CraftState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
/// let report = Certification::new(&craft)
///     .states(&[state])
///     .controls(&[CraftControl { moment: vector![0.3, 0.1, -0.2] }])
///     .time(2.0)
///     .step(0.05)
///     .run::<Midpoint>()?;
/// assert!(report.passed(), "{report}");
/// println!("{report}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Certification<'a, S: Geometry<Scalar = f64>> {
    system: &'a S,
    subject: Subject<'a>,
}

impl<'a, S: Geometry<Scalar = f64>> Certification<'a, S> {
    /// Of this system.
    pub fn new(system: &'a S) -> Self {
        let (states, controls) = (Vec::new(), Vec::new());
        Self { system, subject: Subject { system, states, controls, time: 0.0, step: None } }
    }

    /// At these states too.
    #[must_use]
    pub fn states(mut self, states: &[S::State]) -> Self {
        self.subject.states.extend(states.iter().map(|state| state.to_components().as_ref().to_vec()));
        self
    }

    /// With these controls, one after the other and over again for the states; else all are zero.
    #[must_use]
    pub fn controls(mut self, controls: &[S::Control]) -> Self {
        let numbers = controls.iter().map(|control| control.to_components().as_ref().to_vec());
        self.subject.controls.extend(numbers);
        self
    }

    /// With steps that start at this time.
    #[must_use]
    pub fn time(mut self, time: f64) -> Self {
        self.subject.time = time;
        self
    }

    /// With this step, in place of one that follows from the motion at the states.
    #[must_use]
    pub fn step(mut self, step: f64) -> Self {
        self.subject.step = Some(step);
        self
    }

    /// Measures what the scheme `M` promises.
    ///
    /// # Errors
    /// If the parameters are not valid, there is no state, or a step cannot be taken.
    pub fn run<M>(&self) -> Result<Report, CertifyError>
    where
        S: Discretized<M> + erased::System,
        M: SchemeType,
    {
        certified(self.system, &M::scheme(), &self.subject, &self.method::<M>())
    }

    /// Measures steps under the claims of whatever scheme.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    #[doc(hidden)]
    pub fn run_as(&self, claimed: &Claimed<'_>) -> Result<Report, CertifyError> {
        measure::certificates(&self.subject, claimed)
    }

    /// Makes what takes the steps of the scheme `M`.
    #[doc(hidden)]
    pub fn method<M>(&self) -> impl Fn(f64) -> Result<Box<dyn erased::Method<f64>>, NotGenerated> + use<S, M>
    where
        S: Discretized<M> + 'static,
        M: 'static,
    {
        let parameters: Vec<f64> = self.system.to_parameters().as_ref().to_vec();
        move |step| Ok(Flat::<S::Method<f64>, false>::boxed(&parameters, step))
    }
}

/// Certifies the steps that a scheme takes of a system whose type is erased, at sample states, each with a control, from this time on; with this
/// step, or with one that follows from the motion at the states. At the time the equations of motion have to be smooth.
///
/// # Errors
/// As [`Certification::run`], or if the scheme's steps were not generated.
pub fn certify_erased(
    system: &dyn erased::System,
    scheme: &Scheme,
    states: &[Vec<f64>],
    controls: &[Vec<f64>],
    time: f64,
    step: Option<f64>,
) -> Result<Report, CertifyError> {
    let subject = Subject { system, states: states.to_vec(), controls: controls.to_vec(), time, step };
    certified(system, scheme, &subject, &|step| erased::method(scheme, system, step))
}

/// Certifies what takes the steps of a scheme.
fn certified(
    system: &dyn erased::System,
    scheme: &Scheme,
    subject: &Subject<'_>,
    method: &dyn Fn(f64) -> Result<Box<dyn erased::Method<f64>>, NotGenerated>,
) -> Result<Report, CertifyError> {
    let description = system.description();
    let kernels = |index: usize, at: &At<'_>| {
        let (map, rule, step) = *scheme.parts(description.invariant, at.step).get(index)?;
        Some((step, system.equation(map, rule, &At { step, ..*at })?))
    };
    let claimed = Claimed {
        name: scheme.to_string(),
        properties: scheme.properties(&description),
        definition: Some(scheme.clone()),
        method,
        kernels: &kernels,
    };
    measure::certificates(subject, &claimed)
}

/// Why there is no report.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The parameters, or the step asked for, are not valid.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A step that the scheme is made of was not generated.
    #[error(transparent)]
    NotGenerated(#[from] NotGenerated),
    /// There is nothing to measure at.
    #[error("there is no state to certify the steps at")]
    NoStates,
    /// A step that a certificate needs could not be taken.
    #[error("certificate `{certificate}`, state {state}: {source}")]
    Step {
        /// Its name.
        certificate: String,
        /// Which of the states, from 0.
        state: usize,
        /// What went wrong.
        source: StepError,
    },
    /// The displacements at a state do not make local coordinates there, or the state is not finite.
    #[error("certificate `{certificate}`, state {state}: no local coordinates there")]
    Degenerate {
        /// Its name.
        certificate: String,
        /// Which of the states, from 0.
        state: usize,
    },
    /// The Poisson structure is none of configurations, momenta and advected parameters.
    #[error("the states of `{system}` are not made of configurations, momenta and advected parameters")]
    Structure {
        /// The system's name.
        system: &'static str,
    },
}
