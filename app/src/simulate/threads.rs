//! The threads that ensembles and scans run on.

use std::error::Error as _;

use crate::error::SetupError;

/// Starts them, unless they are there; returns their number: one for each processor, or as `RAYON_NUM_THREADS` says.
///
/// # Errors
/// If they cannot be started.
pub(crate) fn start() -> Result<usize, SetupError> {
    match rayon::ThreadPoolBuilder::new().build_global() {
        // without a source, they had been started before
        Err(error) if error.source().is_some() => {
            let asked = std::env::var("RAYON_NUM_THREADS").unwrap_or_default();
            let by = if asked.is_empty() { String::new() } else { format!(" (RAYON_NUM_THREADS={asked})") };
            Err(SetupError::new(format!("the threads cannot be started{by}: {error}")))
        }
        _ => Ok(rayon::current_num_threads()),
    }
}
