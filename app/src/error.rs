//! Errors of the program; each message is for the user.

use std::error::Error as _;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use coadjoint::certify::CertifyError;
use coadjoint::ensemble::EnsembleError;
use coadjoint::erased::StepperError;
use coadjoint::{ParameterError, StepError};
use coadjoint_classical::Diverged;
use thiserror::Error;

/// An error of the program.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// Input that describes no run.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A run that could not be started or finished.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Ctrl-C or a signal to end; what was computed is written.
    #[error("interrupted")]
    Interrupted,
    /// A command line that is no command, or that asks for help: what there is to say has been printed, and this is the
    /// exit code.
    #[error("see the usage")]
    Usage(u8),
    /// The terminal, or the program this one is piped into, is closed.
    #[error("cannot write to standard output: {0}")]
    Console(#[from] io::Error),
    /// A scheme's claims do not hold.
    #[error("wrong claims of {wrong} of the schemes for `{system}`: see the table")]
    Claim {
        /// The system.
        system: String,
        /// The number of schemes with wrong claims.
        wrong: usize,
    },
    /// The generator rejects a system's description.
    #[error("the generator rejects `{system}`: {reason}")]
    Generator {
        /// The system.
        system: String,
        /// The generator's message.
        reason: String,
    },
    /// A command of the program's own failed.
    #[error("{0}")]
    Command(Box<dyn std::error::Error + Send + Sync>),
}

/// A setting that no run can have: says which it is, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct SetupError(String);

/// A file that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be read.
    #[error("cannot read {}: {}", .0.display(), .1)]
    Read(PathBuf, io::Error),
    /// It cannot be written.
    #[error("cannot write {}: {}", .0.display(), .1)]
    Write(PathBuf, io::Error),
    /// It exists, and another run or another program made it, as said here.
    #[error("{} exists and {}: `--force` replaces it", .0.display(), .1)]
    Taken(PathBuf, String),
    /// Two files of one command would be the same, which are these to it.
    #[error("{} {}", .0.display(), shared(.1))]
    Shared(PathBuf, [&'static str; 2]),
    /// Another process uses it.
    #[error("{} is in use by another run", .0.display())]
    InUse(PathBuf),
    /// Its content cannot be used, as said here.
    #[error("{} {}", .0.display(), .1)]
    Damaged(PathBuf, String),
}

/// A run that could not be started or finished.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RunError {
    /// There are no such steps.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// No stepper can be built with these parameters, this scheme or this step, or an earlier run had another one.
    #[error(transparent)]
    Stepper(#[from] StepperError),
    /// An ensemble cannot be built.
    #[error("{}: {}", .0, .0.source().map(ToString::to_string).unwrap_or_default())]
    Ensemble(#[from] EnsembleError),
    /// A member of an ensemble has no stepper.
    #[error("member {member}: {source}")]
    Member {
        /// The member, from 0.
        member: usize,
        /// The cause.
        source: Box<RunError>,
    },
    /// The motion could not be computed to its end.
    #[error(transparent)]
    Motion(#[from] coadjoint::RunError),
    /// A step that was taken by itself could not be taken.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A step turns the system farther than the retraction reaches.
    #[error(
        "step {}, from time {}, could not be taken: it turns by about {turn:.1} rad, and the exponential map reaches 2π; a step below \
         {step:.1e} s turns by less than π",
        .source.step, .source.time
    )]
    TooFar {
        /// The step that could not be taken.
        source: coadjoint::RunError,
        /// The angle, rad.
        turn: f64,
        /// The step with which the angle is π, s.
        step: f64,
    },
    /// A step could not be taken of a system that is written piece by piece.
    #[error(
        "{source}. Where a force jumps, as `signum` does, a step that ends near the jump may have no solution, however short it is: write it \
         smooth, `(k * v).tanh()` for `v.signum()`, or take Taylor steps, `--tolerance`"
    )]
    Piecewise {
        /// The step that could not be taken.
        source: coadjoint::RunError,
    },
    /// A certificate could not be measured.
    #[error(transparent)]
    Certificate(#[from] CertifyError),
    /// A classical integrator could not go on.
    #[error(transparent)]
    Diverged(#[from] Diverged),
    /// No member of an ensemble, or run of a scan, came to its end.
    #[error("all {count} {what} failed, the first one thus: {first}")]
    NoneLeft {
        /// Their number.
        count: usize,
        /// `members` or `runs`.
        what: &'static str,
        /// The first one's error.
        first: String,
    },
}

impl Error {
    /// Wraps an error of a command of the program's own.
    pub fn other(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Command(error.into())
    }

    /// Tells whether standard output was closed, as in `coadjoint list | head -1`: not an error.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Error::Console(source) if source.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// Makes an error of the program of what a run could not do.
macro_rules! of_runs {
    ($($source:ty),*) => {
        $(impl From<$source> for Error {
            fn from(error: $source) -> Self {
                Self::Run(error.into())
            }
        })*
    };
}

of_runs!(ParameterError, StepperError, StepError, EnsembleError, coadjoint::RunError, Diverged);

impl From<ParameterError> for RunError {
    fn from(error: ParameterError) -> Self {
        Self::Stepper(error.into())
    }
}

impl SetupError {
    /// Says what is wrong with a setting.
    pub fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }

    /// Says where the setting stands.
    #[must_use]
    pub(crate) fn within(self, place: impl fmt::Display) -> Self {
        Self(format!("{place}: {}", self.0))
    }
}

impl FileError {
    /// A file that cannot be read.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Read(path.to_owned(), source)
    }

    /// A file that cannot be written.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Write(path.to_owned(), source)
    }

    /// A file with a content that cannot be used.
    pub(crate) fn damaged(path: &Path, what: &str) -> Self {
        Self::Damaged(path.to_owned(), what.to_owned())
    }
}

/// Says what is wrong with a file that is these two to a command.
fn shared([one, other]: &[&'static str; 2]) -> String {
    if one == other { "is named twice".to_owned() } else { format!("would be both {one} and {other}") }
}
