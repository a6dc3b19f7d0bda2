//! How long a run will take and how much it will write: whoever asks for hours or gigabytes should know.

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::error::Error;
use crate::output::Format;
use crate::report::{bytes_in_words, grouped, seconds_in_words};
use crate::simulation::{Job, Setup};

/// Runs of less are not measured first.
const SHORT: u64 = 1_000_000;
/// What is started without asking.
const MOST_SECONDS: f64 = 3600.0;
const MOST_BYTES: f64 = 2e9;
/// What one more `--every` should write.
const FEW_BYTES: f64 = 1e8;

/// What a run will take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    pub(crate) seconds: f64,
    pub(crate) bytes: f64,
}

/// Measures the first steps of a run, as it is recorded. None of a run that is short, or fails before anything can be said: its own error
/// says more.
pub(crate) fn of_run(
    entry: &Entry,
    setup: &Setup,
    job: &Job,
    every: u64,
    format: Option<Format>,
) -> Option<Estimate> {
    /// Enough to tell hours from minutes.
    const STEPS: u64 = 20_000;
    const LONGEST: Duration = Duration::from_millis(300);

    if job.steps < SHORT {
        return None;
    }
    let (mut conservation, mut text, mut rows, mut last) = (None, String::new(), 0_u32, 0);
    let start = Instant::now();
    let few = Job { steps: STEPS, ..*job };
    entry
        .simulate(setup, &few, None, &|index| index + 1, &mut |sample| {
            conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
            if sample.index.is_multiple_of(every) && format.is_some() {
                rows += 1;
                // writing to a string does not fail
                let _ = sample.state.iter().try_for_each(|x| write!(text, "{x:?},"));
                let _ = writeln!(text, "{:?},{:?}", sample.time, sample.energy);
            }
            last = sample.index;
            let is_enough = sample.index.is_multiple_of(100) && start.elapsed() > LONGEST;
            if is_enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .ok()?;
    let seconds = start.elapsed().as_secs_f64() / last.max(1) as f64 * job.steps as f64;
    let a_row = match format {
        None => 0.0,
        Some(Format::Parquet) => 8.0 * entry.columns().len() as f64,
        Some(_) => text.len() as f64 / f64::from(rows.max(1)),
    };
    Some(Estimate { seconds, bytes: a_row * (job.steps / every) as f64 })
}

impl Estimate {
    /// Whether it may start without having been asked for by `--long`.
    ///
    /// # Errors
    /// If not; the message says what it takes, and how it could take less.
    pub(crate) fn check(&self, steps: u64, every: u64) -> Result<(), Error> {
        if self.seconds <= MOST_SECONDS && self.bytes <= MOST_BYTES {
            return Ok(());
        }
        let mut message = format!("{} steps take about {}", grouped(steps), seconds_in_words(self.seconds));
        if self.bytes > MOST_BYTES {
            let less = 10_u64.saturating_pow((self.bytes / FEW_BYTES).log10().ceil().max(0.0) as u32);
            message += &format!(
                " and write about {}; `--every {}` writes a part of it",
                bytes_in_words(self.bytes),
                every.saturating_mul(less)
            );
        }
        message += "; `--long` starts all the same";
        Err(Error::Input(message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Method, Order, Retraction};
    use crate::test_systems::catalogue;

    fn job(steps: u64) -> Job {
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        Job { method, retraction, order, step: 0.01, steps }
    }

    #[test]
    fn what_takes_long_or_much_is_not_started() {
        let top = catalogue().find("heavy_top").expect("it is there");
        let estimate = |steps, every, format| of_run(top, &top.example, &job(steps), every, format);
        assert_eq!(estimate(1000, 1, Some(Format::Csv)), None);
        let much = estimate(100_000_000, 1, Some(Format::Csv)).expect("measured");
        // twelve columns of some eighteen digits
        assert!((1e10..4e10).contains(&much.bytes), "{much:?}");
        let message = much.check(100_000_000, 1).expect_err("gigabytes").to_string();
        assert!(message.contains("100 000 000 steps take about") && message.contains("GB"), "{message}");
        assert!(
            message.contains("`--every 1000` writes a part") && message.contains("`--long`"),
            "{message}"
        );
        let thinned = estimate(100_000_000, 100_000, Some(Format::Csv)).expect("measured");
        assert!(thinned.bytes < 1e6, "{thinned:?}");
        assert_eq!(estimate(100_000_000, 1, None).expect("measured").bytes, 0.0);
        // proportional to the steps
        let ages = estimate(1_000_000_000_000_000, u64::MAX, None).expect("measured");
        let message = ages.check(100_000_000_000_000, 1).expect_err("years").to_string();
        assert!(!message.contains("GB") && message.contains("years"), "{message}");
    }

    #[test]
    fn what_is_short_and_small_is_started() {
        assert!(Estimate { seconds: 3599.0, bytes: 1.9e9 }.check(1, 1).is_ok());
        assert!(Estimate { seconds: 3601.0, bytes: 0.0 }.check(1, 1).is_err());
        assert!(Estimate { seconds: 0.0, bytes: 2.1e9 }.check(1, 1).is_err());
    }
}
