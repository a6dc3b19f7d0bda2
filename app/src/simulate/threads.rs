//! The threads that ensembles and scans run on.

use std::error::Error as _;

use crate::error::SetupError;

/// Starts them, unless they are there; returns their number: one for each processor, or as `RAYON_NUM_THREADS` says.
///
/// # Errors
/// If they cannot be started.
pub(crate) fn start() -> Result<usize, SetupError> {
    let asked = std::env::var("RAYON_NUM_THREADS").unwrap_or_default();
    check(&asked)?;
    match rayon::ThreadPoolBuilder::new().build_global() {
        // without a source, they had been started before
        Err(error) if error.source().is_some() => Err(refused(&asked, &error.to_string())),
        _ => Ok(rayon::current_num_threads()),
    }
}

/// No computer has use for more; starting them would take seconds, and then fail.
const MOST: usize = 4096;

/// Checks how many are asked for. What is no number asks for none, as rayon takes it.
fn check(asked: &str) -> Result<(), SetupError> {
    // more digits than a number of threads has
    let is_many = |asked: &str| asked.parse().map_or(asked.len() > 19, |asked: usize| asked > MOST);
    match !asked.is_empty() && asked.bytes().all(|byte| byte.is_ascii_digit()) && is_many(asked) {
        true => Err(refused(asked, &format!("at most {MOST} can be asked for"))),
        false => Ok(()),
    }
}

fn refused(asked: &str, reason: &str) -> SetupError {
    let by = if asked.is_empty() { String::new() } else { format!(" (RAYON_NUM_THREADS={asked})") };
    SetupError::new(format!("the threads cannot be started{by}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_threads_than_any_computer_has_are_refused() {
        for asked in ["", "0", "1", "64", "4096", "many", "-1", "4e9"] {
            assert!(check(asked).is_ok(), "{asked}");
        }
        for asked in ["4097", "100000000", "99999999999999999999"] {
            let message = check(asked).expect_err(asked).to_string();
            let expected = format!(
                "threads cannot be started (RAYON_NUM_THREADS={asked}): at most 4096 can be asked for"
            );
            assert!(message.contains(&expected), "{message}");
        }
    }
}
