//! Arguments that `run`, `view` and `ensemble` share: system, scheme, setup, step and duration.

use std::path::{Path, PathBuf};

use clap::Args;

use super::console::Console;
use super::program;
use crate::catalogue::{Catalogue, Entry};
use crate::error::{Error, SetupError};
use crate::setup::config::{Config, RunConfig};
use crate::setup::{Changes, Job, Method, MethodParser, Order, Retraction, Setup};

/// The arguments that choose a run, or the file that describes it.
#[derive(Clone, Debug, Args)]
pub(crate) struct ChosenRun {
    /// The system; `list` shows all
    pub(crate) system: Option<String>,
    /// A TOML file that describes the run; options take precedence
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) scheme: SchemeArguments,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// A quantity of your own, to be shown: `momentum.norm()`
    ///
    /// Expressions are those of descriptions, by the names of state, parameters, controls, the time `t` and `energy`;
    /// before them a name and a unit may stand: `'height, m = gamma.dot(&chi)'`.
    #[arg(long, value_name = "EXPRESSION")]
    pub(crate) quantity: Vec<String>,
    /// End at the first step after which this holds: `gamma_z < 0`
    #[arg(long, value_name = "CONDITION")]
    pub(crate) until: Option<String>,
}

/// The arguments that choose steps.
#[derive(Clone, Debug, Args)]
pub(crate) struct SchemeArguments {
    /// The map that the step is built on; `exp` and `cay` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// What the step makes of it, or a classical method [default: standard]
    ///
    /// Classical methods are there to compare with, by the system's vector field: they have no retraction and an order
    /// of their own, and are not fast; with most of those in stored numbers rotations drift off their group.
    #[arg(long, value_parser = MethodParser)]
    pub(crate) method: Option<Method>,
    /// 2, or 4, 6, 8, 10: symmetric compositions of steps of order 2
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
}

/// The arguments of every motion.
#[derive(Clone, Debug, Args)]
pub(crate) struct MotionArguments {
    /// A parameter, a part of the initial state, or a control to be held
    ///
    /// `weight=9.81`, `chi=0,0,0.3`, `momentum_z=5`; a control is held in place of what the system's own law chooses:
    /// `thrust=9`. Where the configuration is set, advected vectors turn along unless they are set too.
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// The step, s; negative to go back in time [default: its own]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub(crate) step: Option<f64>,
    /// How long to run, s [default: its own]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,
    /// The directory to write to; `-` writes the table to standard output
    #[arg(long, value_name = "DIR", default_value = "out", allow_hyphen_values = true)]
    pub(crate) out: PathBuf,
    /// Replace files of other runs, and of others
    #[arg(long)]
    pub(crate) force: bool,
}

/// A run that can be made.
#[derive(Clone, Debug)]
pub(crate) struct Motion<'e> {
    pub(crate) entry: &'e Entry,
    /// The changes, before they were validated.
    pub(crate) changes: Changes<'e>,
    pub(crate) setup: Setup,
    pub(crate) job: Job,
}

impl ChosenRun {
    /// The run, from the arguments and the configuration file, and what the file says of its output; the arguments take
    /// precedence.
    ///
    /// # Errors
    /// If one of them says what no run has.
    pub(crate) fn motion<'c>(
        &self,
        catalogue: &'c Catalogue,
        console: &mut Console<'_>,
    ) -> Result<(Motion<'c>, RunConfig), Error> {
        let file = self.config.as_deref();
        let config = file.map(Config::read).transpose()?.unwrap_or_default();
        let entry = self.entry(catalogue, &config)?;
        let mut changes = Changes::of(entry);
        if let Some(path) = file {
            config.apply(path, &mut changes)?;
        }
        let run = config.run;
        let scheme = SchemeArguments {
            retraction: self.scheme.retraction.or(run.retraction),
            method: self.scheme.method.or(run.method),
            order: self.scheme.order.or(run.order),
        };
        let (step, duration) = (self.motion.step.or(run.step), self.motion.duration.or(run.duration));
        let asked = MotionArguments { step, duration, ..self.motion.clone() };
        // what a file says of a scheme has its default beside a method of the command line that takes none
        check_scheme(scheme.method, self.scheme.order, self.scheme.retraction)?;
        Ok((Motion::of(changes, &scheme, Retraction::Exponential, &asked, console)?, run))
    }

    /// The system, by its argument or the file.
    fn entry<'c>(&self, catalogue: &'c Catalogue, config: &Config) -> Result<&'c Entry, SetupError> {
        let file = self.config.as_deref().unwrap_or(Path::new(""));
        let Some(name) = self.system.as_ref().or(config.system.as_ref()) else {
            let example = catalogue.entries().first().map_or("NAME", |entry| &entry.name);
            return Err(SetupError::new(format!(
                "no system: name one, as in `{0} run {example}`, or give `system = \"…\"` in a file by `--config` \
                 (`{0} list` shows all)",
                program()
            )));
        };
        let entry = catalogue.system(name)?;
        match &config.system {
            Some(described) if catalogue.system(described)?.name != entry.name => {
                let reason = format!("{} describes a run of `{described}`, not of `{name}`", file.display());
                Err(SetupError::new(reason))
            }
            _ => Ok(entry),
        }
    }
}

impl<'e> Motion<'e> {
    /// Builds the run that the arguments describe; notes if the steps do not add up to the duration, and all that
    /// should be known of the setup.
    ///
    /// # Errors
    /// If there is no such run.
    pub(crate) fn of(
        mut changes: Changes<'e>,
        scheme: &SchemeArguments,
        usual: Retraction,
        asked: &MotionArguments,
        console: &mut Console<'_>,
    ) -> Result<Self, Error> {
        let entry = changes.entry;
        changes.apply(&asked.set)?;
        let step = asked.step.unwrap_or(entry.step);
        let (steps, note) = steps(step, asked.duration.unwrap_or(entry.duration))?;
        let method = scheme.method.unwrap_or(Method::Standard);
        let retraction = scheme.retraction.unwrap_or_else(|| default_retraction(entry, usual));
        let job = Job { method, retraction, order: scheme.order.unwrap_or(Order::Two), step, steps };
        let (setup, notes) = changes.clone().finish()?;
        note.into_iter().chain(notes).try_for_each(|note| console.note(note))?;
        Ok(Self { entry, changes, setup, job })
    }
}

/// This retraction, or where there are no steps with it the first one with which there are.
fn default_retraction(entry: &Entry, usual: Retraction) -> Retraction {
    let known = Retraction::of(entry);
    if known.contains(&usual) { usual } else { known.first().copied().unwrap_or(usual) }
}

/// Checks that what was asked for beside a method means anything to it.
pub(crate) fn check_scheme(
    method: Option<Method>,
    order: Option<Order>,
    retraction: Option<Retraction>,
) -> Result<(), SetupError> {
    let Some((method, classical)) = method.and_then(|method| Some((method, method.classical()?))) else {
        return Ok(());
    };
    if order.is_some() {
        let own = classical.order();
        let reason = format!("`--order` composes steps of ours; method {method} has its own order, {own}");
        return Err(SetupError::new(reason));
    }
    if retraction.is_some() {
        let reason = format!("`--retraction` is for methods of ours; method {method} has none");
        return Err(SetupError::new(reason));
    }
    Ok(())
}

/// Counts the steps to take, with a note if they do not add up to the duration asked for.
fn steps(step: f64, duration: f64) -> Result<(u64, Option<String>), SetupError> {
    /// Beyond this, step numbers are no longer exact in f64, and no run would finish.
    const MOST: f64 = 9e15;

    if !(step.is_finite() && step != 0.0) {
        return Err(SetupError::new(format!("`--step` must be finite and not zero, got {step}")));
    }
    let wrong = |reason: String| Err(SetupError::new(reason));
    if !(duration.is_finite() && duration >= 0.0) {
        return wrong(format!(
            "`--duration` must be finite and not negative, got {duration} (a negative `--step` goes back in time)"
        ));
    }
    let exact = duration / step.abs();
    if exact > MOST {
        return wrong(format!("{duration} s in steps of {step} s are {exact:.1e} steps: too many"));
    }
    let steps = exact.round();
    let note = ((exact - steps).abs() > 1e-6).then(|| {
        let end = steps * step;
        format!("{duration} s are not a whole number of steps of {step} s: the run ends at {end} s")
    });
    Ok((steps as u64, note))
}
