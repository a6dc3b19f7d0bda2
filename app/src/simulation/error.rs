//! What goes wrong with runs.

use std::error::Error as _;

use coadjoint::RunError;
use coadjoint::certify::CertifyError;
use coadjoint::ensemble::EnsembleError;
use coadjoint::erased::StepperError;
use thiserror::Error;

use super::Method;

/// An error of a simulation.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// No stepper can be built with these parameters, this scheme or this step, or it is not the one that an earlier run was made with.
    #[error(transparent)]
    Stepper(#[from] StepperError),
    /// The motion could not be computed to its end.
    #[error(transparent)]
    Motion(#[from] RunError),
    /// A certificate could not be measured.
    #[error(transparent)]
    Certificate(#[from] CertifyError),
    /// An ensemble cannot be built.
    #[error("{}: {}", .0, .0.source().map(ToString::to_string).unwrap_or_default())]
    Ensemble(#[from] EnsembleError),
    /// A member of an ensemble has no stepper.
    #[error("member {member}: {source}")]
    Member {
        /// Which, from 0.
        member: usize,
        /// What is wrong with it.
        source: Box<SimulationError>,
    },
    /// A step turns the system farther than the retraction reaches.
    #[error(
        "step {}, from time {}, could not be taken: it turns by about {turn:.1} rad, and the exponential map reaches 2π; a step below \
         {step:.1e} s turns by less than π, and the Cayley map takes every angle",
        .source.step, .source.time
    )]
    TooFar {
        /// The step that could not be taken.
        source: RunError,
        /// The angle, rad.
        turn: f64,
        /// With this step it is π, s.
        step: f64,
    },
    /// Steps of higher order are composed of symmetric ones.
    #[error(
        "order {order} is composed of symmetric steps, which method {method} does not make for every system; take one of {symmetric}"
    )]
    NotSymmetric {
        /// The order asked for.
        order: u32,
        /// The method asked for.
        method: Method,
        /// Those whose steps are symmetric.
        symmetric: String,
    },
    /// The method is no scheme whose claims could be measured.
    #[error("method {method} {}", not_certified(*.method))]
    NotCertified {
        /// The method asked for.
        method: Method,
    },
    /// The momentum in space is constant only where nothing acts.
    #[error(
        "`{system}` has no steps with the method right-lift, which carries the momentum in space: something acts on it"
    )]
    NotIsolated {
        /// The system.
        system: &'static str,
    },
    /// The program has right lifts with the retractions alone that there are of every system.
    #[error(
        "there are no steps of the method right-lift with the retraction {retraction}; take one of exponential, cayley"
    )]
    NotLifted {
        /// The retraction asked for.
        retraction: &'static str,
    },
}

/// Why there are no certificates of a method.
fn not_certified(method: Method) -> &'static str {
    match method {
        Method::RightLift => "takes the steps of euler-a: certify these",
        _ => "claims nothing that a certificate could measure",
    }
}
