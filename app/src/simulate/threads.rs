//! The threads that ensembles and scans run on.

use std::error::Error as _;
use std::sync::OnceLock;

use crate::error::SetupError;

static STARTED: OnceLock<Result<usize, String>> = OnceLock::new();

/// Starts them, unless they are there; returns their number: one for each processor, or as
/// `RAYON_NUM_THREADS` says.
///
/// # Errors
/// If they cannot be started.
pub(crate) fn start() -> Result<usize, SetupError> {
    let started = STARTED.get_or_init(|| match rayon::ThreadPoolBuilder::new().build_global() {
        // without a source, they had been started before
        Err(error) if error.source().is_some() => Err(error.to_string()),
        _ => Ok(rayon::current_num_threads()),
    });
    let asked =
        || std::env::var("RAYON_NUM_THREADS").map_or(String::new(), |n| format!(" (RAYON_NUM_THREADS={n})"));
    started.clone().map_err(|reason| {
        let reason = format!("the threads cannot be started{}: {reason}", asked());
        SetupError::new("RAYON_NUM_THREADS", asked(), reason)
    })
}
