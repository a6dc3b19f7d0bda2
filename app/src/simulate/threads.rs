//! The threads that ensembles and scans run on.

use std::error::Error as _;

use crate::error::SetupError;

/// Starts them, unless they are there; returns their number: one for each processor, or as `RAYON_NUM_THREADS` says.
///
/// # Errors
/// If they cannot be started.
pub(crate) fn start() -> Result<usize, SetupError> {
    /// No computer has use for more; starting them would take seconds, and then fail.
    const MOST: usize = 4096;
    let asked = std::env::var("RAYON_NUM_THREADS").unwrap_or_default();
    let refused = |reason: &str| {
        let by = if asked.is_empty() { String::new() } else { format!(" (RAYON_NUM_THREADS={asked})") };
        Err(SetupError::new(format!("the threads cannot be started{by}: {reason}")))
    };
    if asked.parse().is_ok_and(|asked: usize| asked > MOST) {
        return refused(&format!("at most {MOST} can be asked for"));
    }
    match rayon::ThreadPoolBuilder::new().build_global() {
        // without a source, they had been started before
        Err(error) if error.source().is_some() => refused(&error.to_string()),
        _ => Ok(rayon::current_num_threads()),
    }
}
