//! `coadjoint ensemble`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::Args;
use coadjoint::ensemble::Spread;
use coadjoint::system::Role;
use serde_json::{Value, json};

use super::console::{Console, OutputMode};
use super::description::DescriptionArguments;
use super::interrupt;
use super::motion::{Motion, MotionArguments, SchemeArguments, check_scheme};
use crate::catalogue::quantities::components;
use crate::catalogue::{Catalogue, Entry, Observable};
use crate::error::{Error, RunError, SetupError};
use crate::files::{
    FileOrigin, Members, NewFile, OverwriteGuard, PlannedFile, Provenance, Status, file_in, is_stdout, table,
};
use crate::picture::{Kind, ensemble_figure};
use crate::setup::{Changes, Job, Setup, observable, observables};
use crate::simulate::ensemble::{self, EnsembleSpec, EnsembleSummary, Variation};
use crate::simulate::threads;
use crate::units::{grouped, short};

/// Momentum components that are drawn unless others are asked for.
const MOST: usize = 3;

/// The arguments of `ensemble`.
#[derive(Debug, Args)]
pub(crate) struct EnsembleArguments {
    /// The system; `list` shows all
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// How many members
    #[arg(long, value_name = "N", default_value_t = Members::MEMBERS, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) members: u64,
    /// How far members differ [default: momentum=1%]
    ///
    /// Evenly within plus or minus the width: `inertia=2%` of each component's own size, `momentum_z=0.01` in the
    /// component's own unit, `chi=0,0,0.1` for each component. A rotation is turned about any axis by an angle up to
    /// the width: `attitude=5deg`, `attitude=0.1rad`; advected vectors turn along. Symmetric matrices stay symmetric;
    /// an element of a group of matrices is displaced as a whole: `element=0.1`.
    #[arg(long, value_name = "NAME=WIDTH")]
    pub(crate) spread: Vec<String>,
    #[command(flatten)]
    pub(crate) scheme: SchemeArguments,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// A quantity to show: `energy`, `gamma.norm()` [default: the momentum]
    ///
    /// Expressions are written as in descriptions, by the names of state, velocities, parameters, controls and the time `t`; before them
    /// a name and a unit may stand: `'height, m = gamma.dot(&chi)'`.
    #[arg(long, value_name = "EXPRESSION")]
    pub(crate) quantity: Vec<String>,
    /// Look at the members after every N-th step [default: 300 times]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Another seed draws other members
    #[arg(long, value_name = "SEED", default_value_t = Members::SEED)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// Runs an ensemble; writes the distributions as a table and as a plot.
pub(crate) fn ensemble(
    catalogue: &Catalogue,
    arguments: &EnsembleArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.output.on(stdout, is_stdout(&arguments.motion.out))?;
    described(catalogue, arguments, None, &mut console)
}

/// Makes the ensemble that the arguments describe; again, if it made files of this origin.
pub(crate) fn described(
    catalogue: &Catalogue,
    arguments: &EnsembleArguments,
    again: Option<&FileOrigin>,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let EnsembleArguments { scheme, motion, members, spread, seed, quantity, .. } = arguments;
    let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
    check_scheme(scheme.method()?, scheme.order, scheme.retraction)?;
    let described = Motion::of(Changes::of(entry), scheme, true, motion, console)?;
    again.map_or(Ok(()), |made| made.check_digits(entry, &described.setup, &described.job))?;
    let every = arguments.every.unwrap_or(Members::every(described.job.steps));
    let (spread, quantity) = (spread.clone(), quantity.clone());
    let asked = Members { members: *members, spread, seed: *seed, quantity };
    execute(&described, asked, every, motion, console)
}

/// Makes an ensemble about a run, and reports it.
fn execute(
    motion: &Motion<'_>,
    asked: Members,
    every: u64,
    to: &MotionArguments,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let Motion { entry, setup, job, .. } = motion;
    let spec = spec(motion, &asked, every)?;
    // before files are looked at
    spec.check_room()?;
    spec.variation.notes.iter().try_for_each(|note| console.note(note.clone()))?;
    let named = shown(entry, &asked.quantity)?;
    threads::start()?;
    let run = Provenance { ensemble: Some(asked), ..Provenance::of_run(entry, setup, job, every) };
    let stem = run.stem(entry, job);
    let guard = OverwriteGuard::new(run.origin(), to.force);
    let paths: Vec<PathBuf> = match is_stdout(&to.out) {
        true => vec![to.out.clone()],
        false => {
            let ends = std::iter::once("csv").chain(Kind::ALL.iter().map(|kind| kind.extension()));
            ends.map(|end| file_in(&to.out, &format!("{stem}.{end}"))).collect()
        }
    };
    let planned = |path: &PathBuf| PlannedFile { what: "the ensemble", path: path.clone(), written: true };
    guard.check_all(&paths.iter().map(planned).collect::<Vec<_>>())?;
    interrupt::listen();
    let mut progress = console.progress(&entry.name, job.steps, "step");
    let mut go_on = |index: u64| {
        progress.show(index);
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let summary = ensemble::run(entry, setup, &spec, &named, &mut go_on)?;
    drop(progress);
    let (contents, status) = contents(entry, &spec, &named, &summary, &paths)?;
    let written = guard.put(contents, status)?;
    for path in &written.kept {
        console.note(format!("{} holds the whole ensemble, and stays", path.display()))?;
    }
    console.summary(&written.files, || {
        let mut object = object(entry, setup, &spec, &named, &summary);
        object["interrupted"] = interrupt::requested().into();
        object
    })?;
    report(entry, &summary, &spec, console.words())?;
    console.wrote(&written.files)?;
    match summary.failed.first() {
        _ if interrupt::requested() => Err(Error::Interrupted),
        Some(first) if summary.failed.len() == spec.members => {
            Err(RunError::NoneLeft { count: spec.members, what: "members", first: first.to_string() }.into())
        }
        _ => Ok(()),
    }
}

/// Reads how members differ.
fn spec(motion: &Motion<'_>, asked: &Members, every: u64) -> Result<EnsembleSpec, SetupError> {
    let Motion { entry, setup, job, .. } = motion;
    let momenta = entry.description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    let spread: Vec<String> = match asked.spread.is_empty() {
        true => momenta.map(|quantity| format!("{}=1%", quantity.name)).collect(),
        false => asked.spread.clone(),
    };
    let variation = Variation::parse(entry, setup, &spread)?;
    let members = usize::try_from(asked.members).unwrap_or(usize::MAX);
    Ok(EnsembleSpec { members, variation, seed: asked.seed, job: *job, every })
}

/// Writes the table, and the pictures unless there is nothing to draw, not yet in their places.
fn contents(
    entry: &Entry,
    spec: &EnsembleSpec,
    named: &[Observable],
    summary: &EnsembleSummary,
    paths: &[PathBuf],
) -> Result<(Vec<(PathBuf, NewFile)>, Status), Error> {
    let last = summary.spreads.first().and_then(|spreads| spreads.last());
    let taken = last.map_or(0, |spread| (spread.time / spec.job.step).round() as u64);
    let status = if taken < spec.job.steps { Status::Interrupted(taken) } else { Status::Complete };
    let mut contents = Vec::new();
    if let Some(path) = paths.first() {
        contents.push((path.clone(), NewFile::with(path, &table(&records(named, summary)))?));
    }
    let is_seen = |spread: &&Spread| spread.members > 0;
    let looks = summary.spreads.first().map_or(0, |spreads| spreads.iter().filter(is_seen).count());
    // of members that failed at once there is nothing to draw
    if looks > 1 {
        let figure = ensemble_figure(entry, named, summary, spec, &spec.variation.words);
        for (path, kind) in paths.iter().skip(1).zip(Kind::ALL) {
            contents.push((path.clone(), NewFile::with(path, &figure.picture(*kind))?));
        }
    }
    Ok((contents, status))
}

/// Reads the quantities asked for.
fn shown(entry: &Entry, asked: &[String]) -> Result<Vec<Observable>, SetupError> {
    if !asked.is_empty() {
        return observables(entry, asked);
    }
    let momenta = components(entry.description.state)
        .filter(|component| component.quantity.role == Role::Momentum)
        .take(MOST)
        .map(|component| observable(entry, &component.name));
    momenta.chain(entry.observables.iter().cloned().map(Ok)).collect()
}

/// Time and, for each quantity, how many members, mean, deviation and quantiles.
fn records(named: &[Observable], summary: &EnsembleSummary) -> Vec<Vec<String>> {
    const COLUMNS: [&str; 10] =
        ["members", "mean", "deviation", "min", "q05", "q25", "median", "q75", "q95", "max"];
    let columns = named.iter().flat_map(|own| COLUMNS.map(|column| format!("{}_{column}", own.name)));
    let header: Vec<String> = std::iter::once("time".to_owned()).chain(columns).collect();
    let samples = summary.spreads.first().map_or(0, Vec::len);
    let record = |sample: usize| {
        let mut record = vec![summary.spreads[0][sample].time.to_string()];
        for spreads in &summary.spreads {
            let Spread { members, mean, deviation, quantiles, .. } = spreads[sample];
            record.push(members.to_string());
            record.extend([mean, deviation].iter().chain(&quantiles).map(f64::to_string));
        }
        record
    };
    std::iter::once(header).chain((0..samples).map(record)).collect()
}

/// Failed members that are told by name.
const TOLD: usize = 3;

fn report(
    entry: &Entry,
    summary: &EnsembleSummary,
    spec: &EnsembleSpec,
    words: &mut dyn Write,
) -> Result<(), Error> {
    let EnsembleSummary { drawn, failed, member_steps, width, seconds, .. } = summary;
    let Job { method, retraction, .. } = spec.job;
    let retraction = if method.has_retraction() { retraction.name() } else { "" };
    writeln!(words, "scheme: {method} {retraction}, order {}", spec.job.order_of_step(entry))?;
    for (i, drawn) in drawn.iter().enumerate() {
        let title = if i == 0 { "drawn: " } else { "       " };
        let (least, greatest) = drawn.range;
        let range = format!("from {} to {} {}", short(least), short(greatest), drawn.unit);
        writeln!(words, "{title}{}", format!("{:16} {range}", drawn.name).trim_end())?;
    }
    writeln!(
        words,
        "{} members, {} steps in {seconds:.2} s: {} member steps/s\n({width} side by side, {} threads)",
        grouped(spec.members as u64),
        grouped(*member_steps),
        grouped((*member_steps as f64 / seconds) as u64),
        rayon::current_num_threads(),
    )?;
    for failure in failed.iter().take(TOLD) {
        writeln!(words, "{failure}")?;
    }
    if failed.len() > TOLD {
        writeln!(words, "and {} others failed", grouped((failed.len() - TOLD) as u64))?;
    }
    Ok(())
}

/// All of it as a JSON object, with the distributions at the end.
fn object(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    named: &[Observable],
    summary: &EnsembleSummary,
) -> Value {
    let mut object = Value::Object(Provenance::of_run(entry, setup, &spec.job, spec.every).fields());
    object["members"] = json!(spec.members);
    object["seed"] = json!(spec.seed);
    object["spread"] = json!(spec.variation.words);
    for drawn in &summary.drawn {
        object["drawn"][&drawn.name] =
            json!({ "min": drawn.range.0, "max": drawn.range.1, "unit": drawn.unit });
    }
    for (Observable { name, .. }, last) in
        named.iter().zip(summary.spreads.iter().map(|spreads| spreads.last()))
    {
        object["end"][name] = last.map_or(Value::Null, |last| {
            json!({
                "time": last.time, "members": last.members, "mean": last.mean, "deviation": last.deviation,
                "quantiles": last.quantiles,
            })
        });
    }
    object["failed"] = json!(summary.failed.len());
    object["member_steps"] = json!(summary.member_steps);
    object["seconds"] = json!(summary.seconds);
    object["side_by_side"] = json!(summary.width);
    object["threads"] = json!(rayon::current_num_threads());
    object
}
