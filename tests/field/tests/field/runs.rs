//! Many runs, of which each should go well: what went wrong is told of all of them at once.

use core::fmt::Display;

use coadjoint::{Discretized, Run, RunError, System};

/// How many failures are told in words.
const TOLD: usize = 6;

/// Counts the runs of a test, and keeps what went wrong in them.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    taken: usize,
    wrong: Vec<String>,
}

impl Runs {
    /// Notes how a run ended: what it came to, if it came to its end.
    pub(crate) fn end<T>(&mut self, what: impl Display, end: Result<T, impl Display>) -> Option<T> {
        self.taken += 1;
        end.map_err(|error| self.wrong.push(format!("{what}: {error}"))).ok()
    }

    /// Notes a number that is not within `bound` of what it should be.
    pub(crate) fn close(&mut self, what: impl Display, is: f64, should: f64, bound: f64) {
        let off = (is - should).abs();
        // not-a-number is close to nothing
        if !(off <= bound) {
            self.wrong.push(format!("{what}: {is:.12e} for {should:.12e}, off by {off:.1e} > {bound:.1e}"));
        }
    }

    /// Notes numbers of which one is not.
    pub(crate) fn all_close(&mut self, what: impl Display, is: &[f64], should: &[f64], bound: f64) {
        assert_eq!(is.len(), should.len());
        for (k, (is, should)) in is.iter().zip(should).enumerate() {
            self.close(format_args!("{what}, {k}"), *is, *should, bound);
        }
    }

    /// Panics if anything went wrong.
    #[track_caller]
    pub(crate) fn assert(self) {
        let Self { taken, wrong } = self;
        let told = wrong.iter().take(TOLD).map(|line| format!("\n  {line}")).collect::<String>();
        assert!(wrong.is_empty(), "{} things are wrong in {taken} runs, such as{told}", wrong.len());
    }
}

/// Takes so many steps without controls: the state that they lead to.
pub(crate) fn walk<M, S: Discretized<M>>(
    system: &S,
    start: &S::State,
    step: S::Scalar,
    count: u64,
) -> Result<S::State, RunError> {
    let mut state = start.clone();
    let mut stepper = system.stepper::<M>(step).expect("a stepper");
    stepper.steps_with(&mut state, &S::Control::default(), count)?;
    Ok(state)
}

/// Takes so many steps with the controls of a law.
pub(crate) fn steer<M, S: System<Scalar = f64> + Discretized<M>>(
    system: &S,
    start: &S::State,
    (step, count): (f64, u64),
    law: impl FnMut(&S::State, f64) -> S::Control,
) -> Result<S::State, RunError> {
    let mut state = start.clone();
    let mut stepper = system.stepper::<M>(step).expect("a stepper");
    Run::new(&mut stepper, &mut state).controlled_by(law).steps(count)?;
    Ok(state)
}

/// The name of a scheme, without paths.
pub(crate) fn scheme<M>() -> String {
    let name = core::any::type_name::<M>();
    name.split_inclusive(['<', ',']).map(|part| part.rsplit("::").next().unwrap_or(part)).collect()
}
