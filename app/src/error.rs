//! The errors of the program and their exit codes.

use std::io;
use std::path::PathBuf;

use coadjoint::{ParameterError, RunError};
use thiserror::Error;

use crate::interrupt;
use crate::simulation::SimulationError;
use coadjoint_classical::Diverged;

/// An error of the program; its message is for the user.
#[derive(Debug, Error)]
pub enum Error {
    /// Invalid input; the message says what is valid.
    #[error("{0}")]
    Input(String),
    /// No stepper can be built with these parameters.
    #[error("{0}")]
    Parameter(#[from] ParameterError),
    /// A run could not be started or finished.
    #[error("{0}")]
    Simulation(#[from] SimulationError),
    /// The motion of a figure could not be computed to its end.
    #[error(transparent)]
    Motion(#[from] RunError),
    /// No member of an ensemble, or run of a scan, came to its end.
    #[error("all {count} {what} failed, the first one thus: {first}")]
    NoneLeft {
        /// How many there were.
        count: usize,
        /// What they are.
        what: &'static str,
        /// Why the first one failed.
        first: String,
    },
    /// A classical integrator could not go on.
    #[error("{0}")]
    Diverged(#[from] Diverged),
    /// A command of the program's own failed.
    #[error("{0}")]
    Command(Box<dyn std::error::Error + Send + Sync>),
    /// A file or directory could not be written.
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file is there already, and is not that of the same run.
    #[error("{} exists and {made}: `--force` replaces it", .path.display())]
    Taken {
        /// Which.
        path: PathBuf,
        /// What it is.
        made: String,
    },
    /// Two files of one command are the same.
    #[error("{} would be both {} and {}", .path.display(), .both[0], .both[1])]
    Collision {
        /// Which.
        path: PathBuf,
        /// What they are to the command.
        both: [&'static str; 2],
    },
    /// Another process is running with the same checkpoint.
    #[error("{} is in use by another run", .path.display())]
    InUse {
        /// Which.
        path: PathBuf,
    },
    /// A file that belongs to a checkpoint is not what was written.
    #[error("{} {what}", .path.display())]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Ctrl-C, or a signal to end, ended a run; what was computed is written.
    #[error("interrupted")]
    Interrupted,
    /// The terminal, or the program this one is piped into, is closed.
    #[error("cannot write to standard output: {0}")]
    Console(#[from] io::Error),
    /// A scheme's claims do not hold.
    #[error("wrong claims of {wrong} of the schemes for `{system}`: see the table")]
    Claim {
        /// Which system.
        system: &'static str,
        /// Of how many schemes.
        wrong: usize,
    },
    /// The generator rejects a system's description.
    #[error("the generator rejects `{system}`: {reason}")]
    Generator {
        /// Which system.
        system: &'static str,
        /// What it says.
        reason: String,
    },
}

impl Error {
    /// Of a command of the program's own.
    pub fn other(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Command(error.into())
    }

    /// The program's exit code: 2 for wrong input, 3 for a motion that cannot be computed, 4 for output that cannot
    /// be written, 128 and the signal's number for signals (130 for Ctrl-C), 1 for bugs.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input(_) | Error::Parameter(_) | Error::Read { .. } => 2,
            Error::Taken { .. } | Error::Collision { .. } | Error::InUse { .. } | Error::Damaged { .. } => 2,
            Error::Interrupted => interrupt::exit_code(),
            Error::Simulation(
                SimulationError::Member { .. }
                | SimulationError::Stepper(_)
                | SimulationError::Ensemble(_)
                | SimulationError::NotSymmetric { .. }
                | SimulationError::NotCertified { .. }
                | SimulationError::NotIsolated { .. }
                | SimulationError::NotLifted { .. },
            ) => 2,
            Error::NoneLeft { .. }
            | Error::Simulation(_)
            | Error::Motion(_)
            | Error::Diverged(_)
            | Error::Command(_) => 3,
            Error::Write { .. } | Error::Console(_) => 4,
            Error::Generator { .. } | Error::Claim { .. } => 1,
        }
    }

    /// Whether standard output was closed, as in `coadjoint list | head -1`: not an error.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Error::Console(source) if source.kind() == io::ErrorKind::BrokenPipe)
    }
}
