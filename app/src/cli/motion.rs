//! Arguments that `run`, `view` and `ensemble` share: system, scheme, setup, step and duration.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;

use super::console::Console;
use super::description::DescriptionArguments;
use super::program;
use crate::catalogue::{Catalogue, Entry, Input, Interpolation};
use crate::error::{Error, FileError, SetupError};
use crate::files::path::read_file;
use crate::setup::config::{Config, RunConfig};
use crate::setup::{Changes, Job, Method, MethodParser, Order, Retraction, Setup, Tolerance};
use crate::simulate::usual_method;
use crate::units::rounded;

/// The arguments that choose a run, or the file that describes it.
#[derive(Clone, Debug, Args)]
pub(crate) struct ChosenRun {
    /// The system; `list` shows all
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// A TOML file that describes the run; options take precedence
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) scheme: SchemeArguments,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// A quantity of your own, to be shown: `momentum.norm()`
    ///
    /// Expressions are written as in descriptions, by the names of state, velocities, parameters, controls, the time `t` and `energy`;
    /// before them a name and a unit may stand: `'height, m = gamma.dot(&chi)'`.
    #[arg(long, value_name = "EXPRESSION")]
    pub(crate) quantity: Vec<String>,
    /// End at the moment from which on this holds, `gamma_z < 0`, or at an event of the description, `apogee`
    #[arg(long, value_name = "CONDITION")]
    pub(crate) until: Option<String>,
    /// Tell when a quantity is zero: `'upright = gamma_z, rising'`
    ///
    /// `rising` and `falling` say in which direction it passes zero; without them every zero counts. An event of the description is told by
    /// its name alone: `--event apogee`. Moments are located to rounding within the steps, and told with the states there in a table that ends in `.events.csv`.
    #[arg(long, value_name = "EXPRESSION")]
    pub(crate) event: Vec<String>,
}

/// The arguments that choose steps.
#[derive(Clone, Debug, Args)]
pub(crate) struct SchemeArguments {
    /// The map of the step [default: exponential]
    ///
    /// `exp` and `cay` for short. Where there are no steps with the default, it is what `list NAME` names first.
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// What the step makes of it, or a classical method [default: standard, of a higher order hamilton-jacobi if it is there]
    ///
    /// Classical methods are there to compare with, by the system's vector field: they have no retraction and an order
    /// of their own, and are not fast; with most of those in stored numbers rotations drift off their group.
    #[arg(long, value_parser = MethodParser)]
    pub(crate) method: Option<Method>,
    /// 2, or 4, 6, 8, 10: from one equation, or composed of steps of order 2 [default: 2]
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
    /// Taylor steps to this tolerance: the same as `--method taylor=1e-12`
    ///
    /// They are as long as the tolerance allows, and as many as there need be between the times of `--step`: with a longer `--step` a run is
    /// faster, and shows fewer states.
    #[arg(long, value_name = "TOLERANCE", conflicts_with = "method")]
    pub(crate) tolerance: Option<f64>,
}

impl SchemeArguments {
    /// The method that is asked for.
    ///
    /// # Errors
    /// If the tolerance is none.
    pub(crate) fn method(&self) -> Result<Option<Method>, SetupError> {
        let Some(asked) = self.tolerance else { return Ok(self.method) };
        let tolerance = Tolerance::new(asked).ok_or_else(|| {
            SetupError::new(format!("a tolerance is between 0 and 1, such as 1e-12, not {asked}"))
        })?;
        Ok(Some(Method::Taylor(tolerance)))
    }
}

/// The arguments of every motion.
#[derive(Clone, Debug, Args)]
pub(crate) struct MotionArguments {
    /// A parameter, a part of the initial state, or a control to be held
    ///
    /// `weight=9.81`, `chi=0,0,0.3`, `momentum_z=5`, or in place of a momentum its velocity: `velocity_z=5`. A control
    /// is held in place of what the system's own law chooses: `thrust=9`. Where the configuration is set, advected
    /// vectors turn along unless they are set too.
    ///
    /// An attitude, which leads from body axes to those of space, is its quaternion `w,x,y,z`, or `attitude=euler:r,p,y`
    /// (roll, pitch and yaw, rad: about x, then y, then z of space), `rotvec:x,y,z` (axis times angle, rad), `mrp:x,y,z`
    /// (modified Rodrigues parameters). A rotation in the plane is cosine and sine, or its angle in rad. A symmetric matrix
    /// is all of its numbers, its upper triangle row by row, as URDF has an inertia (xx, xy, xz, yy, yz, zz), or its
    /// diagonal.
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// The step, s; negative to go back in time [default: its own]
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    pub(crate) step: Option<f64>,
    /// How long to run, s [default: its own]
    ///
    /// Where steps do not add up to it, the last one is shorter; an ensemble ends after the step that is nearest.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub(crate) duration: Option<f64>,
    /// A table of controls that are functions of time
    ///
    /// A column `time`, s, and one for each component of a control, under its name. A step asks it where it needs it, so
    /// that orders stay, but for that of Hamilton–Jacobi steps, which is 2 then. Outside of its rows controls are held; a
    /// control without a column is as `--set` says, or zero.
    #[arg(long, value_name = "FILE")]
    pub(crate) input: Option<PathBuf>,
    /// What is between the rows of the table [default: cubic]
    #[arg(long, value_enum, requires = "input")]
    pub(crate) interpolation: Option<Interpolation>,
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
        let RunConfig { retraction, method, order, tolerance, .. } = run;
        let described = SchemeArguments { retraction, method, order, tolerance };
        let scheme = SchemeArguments {
            retraction: self.scheme.retraction.or(retraction),
            method: self.scheme.method()?.or(described.method()?),
            order: self.scheme.order.or(order),
            tolerance: None,
        };
        let (step, duration) = (self.motion.step.or(run.step), self.motion.duration.or(run.duration));
        let input = self.motion.input.clone().or_else(|| run.input.clone());
        let interpolation = self.motion.interpolation.or(run.interpolation);
        let asked = MotionArguments { step, duration, input, interpolation, ..self.motion.clone() };
        // what a file says of a scheme has its default beside a method of the command line that takes none
        check_scheme(scheme.method, self.scheme.order, self.scheme.retraction)?;
        Ok((Motion::of(changes, &scheme, false, &asked, console)?, run))
    }

    /// The system, by its argument or the file.
    fn entry<'c>(&self, catalogue: &'c Catalogue, config: &Config) -> Result<&'c Entry, SetupError> {
        let file = self.config.as_deref().unwrap_or(Path::new(""));
        let name = self.system.as_ref().or(config.system.as_ref());
        if name.is_none() && self.described.file().is_some() {
            return self.described.system(catalogue, None);
        }
        let Some(name) = name else {
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
    /// should be known of the setup. Of an ensemble all steps are of one length.
    ///
    /// # Errors
    /// If there is no such run.
    pub(crate) fn of(
        mut changes: Changes<'e>,
        scheme: &SchemeArguments,
        is_ensemble: bool,
        asked: &MotionArguments,
        console: &mut Console<'_>,
    ) -> Result<Self, Error> {
        let entry = changes.entry;
        changes.apply(&asked.set)?;
        let step = asked.step.unwrap_or(entry.step);
        let duration = asked.duration.unwrap_or(entry.duration);
        let (mut steps, mut rest) = Job::steps_to(duration, step)?;
        let mut note = None;
        if rest != 0.0 {
            let end = if is_ensemble {
                steps += u64::from(rest >= 0.5 * step.abs());
                rest = 0.0;
                format!("the run ends at {} s", steps as f64 * step)
            } else {
                format!("the last step is {} s", rounded(rest))
            };
            note = Some(format!("{duration} s are not a whole number of steps of {step} s: {end}"));
        }
        let retraction = scheme.retraction.unwrap_or_else(|| Retraction::Exponential.or_first_of(entry));
        let order = scheme.order.unwrap_or(Order::Two);
        // members go side by side where their steps are composed, and compositions keep their order where an input drives them
        let is_composed = is_ensemble || asked.input.is_some();
        let usual = if is_composed { Method::Standard } else { usual_method(entry, retraction, order) };
        let method = scheme.method()?.unwrap_or(usual);
        let job = Job { method, retraction, order, step, steps, rest };
        if let Some(file) = &asked.input {
            let text = text(file).map_err(FileError::read(file))?;
            let input = Input::parse(entry, file.clone(), &text, asked.interpolation.unwrap_or_default())?;
            changes.drive(input);
        }
        let (setup, notes) = changes.clone().finish()?;
        let held = (method.is_of_order() && asked.input.is_some()).then(|| {
            format!(
                "a step of method {method} holds the input's value at its middle, and is of order 2 then: `--order {}` alone \
                 composes steps that keep the order",
                order.number()
            )
        });
        note.into_iter().chain(held).chain(notes).try_for_each(|note| console.note(note))?;
        Ok(Self { entry, changes, setup, job })
    }
}

/// Reads a table of at most 256 MB.
fn text(file: &Path) -> io::Result<String> {
    String::from_utf8(read_file(file, 1 << 28)?).map_err(io::Error::other)
}

/// Checks that what was asked for beside a method means anything to it.
pub(crate) fn check_scheme(
    method: Option<Method>,
    order: Option<Order>,
    retraction: Option<Retraction>,
) -> Result<(), SetupError> {
    let Some(method) = method.filter(|method| !method.has_retraction()) else {
        return Ok(());
    };
    if order.is_some() {
        let own = match method.classical() {
            Some(classical) => format!("its own order, {}", classical.order()),
            None => "the order that its tolerance needs".to_owned(),
        };
        let reason = format!("`--order` composes steps of ours; method {method} has {own}");
        return Err(SetupError::new(reason));
    }
    if retraction.is_some() {
        let reason = format!("`--retraction` is for methods of ours; method {method} has none");
        return Err(SetupError::new(reason));
    }
    Ok(())
}
