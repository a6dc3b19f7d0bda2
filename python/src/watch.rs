//! What goes on in Python while steps are taken: signals, progress, functions that raise.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Signals are looked for about as often.
const OFTEN: Duration = Duration::from_millis(20);

/// The first error of a function of the user's, or an interrupt: the run ends at the next step.
pub(crate) struct Watch {
    error: RefCell<Option<PyErr>>,
    progress: Option<Py<PyAny>>,
    /// How many steps are taken between two looks.
    interval: Cell<u64>,
    last: Cell<Instant>,
}

impl Watch {
    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        let (interval, last) = (Cell::new(64), Cell::new(Instant::now()));
        Self { error: RefCell::new(None), progress, interval, last }
    }

    /// Keeps the first error.
    pub(crate) fn fail(&self, error: PyErr) {
        self.error.borrow_mut().get_or_insert(error);
    }

    /// What a function of the user's returned, or what stands for it until the run ends.
    pub(crate) fn kept<T>(&self, result: PyResult<T>, otherwise: T) -> T {
        result.unwrap_or_else(|error| {
            self.fail(error);
            otherwise
        })
    }

    pub(crate) fn has_failed(&self) -> bool {
        self.error.borrow().is_some()
    }

    pub(crate) fn into_error(self) -> Option<PyErr> {
        self.error.into_inner()
    }

    /// Looks for signals, and tells how far the run is. Returns after how many steps to look again.
    pub(crate) fn look(&self, share: f64) -> u64 {
        let looked = Python::attach(|py| {
            py.check_signals()?;
            match &self.progress {
                Some(progress) => progress.call1(py, (share,)).map(|_| ()),
                None => Ok(()),
            }
        });
        self.kept(looked, ());
        let now = Instant::now();
        let since = now - self.last.replace(now);
        let interval = self.interval.get();
        self.interval.set(match since {
            _ if since < OFTEN / 2 => interval.saturating_mul(2),
            _ if since > OFTEN * 2 => (interval / 2).max(1),
            _ => interval,
        });
        self.interval.get()
    }
}
