//! `coadjoint ensemble`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::Args;
use coadjoint::ensemble::Spread;
use coadjoint::system::{Quantity, Role};
use serde_json::{Value, json};

use super::motion::{MotionArguments, SchemeArguments, check_scheme, job};
use super::run::RunArguments;
use crate::console::{Console, Telling};
use crate::ensemble::{EnsembleSpec, EnsembleSummary, Observable, Variation};
use crate::ensemble_plot::figure;
use crate::entry::{Catalogue, Entry, component_name};
use crate::error::Error;
use crate::estimate::Estimate;
use crate::interrupt;
use crate::output::path::is_stdout;
use crate::output::{Claim, Guard, file_in, table};
use crate::plot::Kind;
use crate::progress::Progress;
use crate::provenance::{Members, Provenance, embed};
use crate::report::{grouped, rate_in_words, short};
use crate::setting::{Changes, assignments, laid_out};
use crate::simulation::{Job, Retraction, Setup};
use crate::suggest::did_you_mean;
use crate::threads;

/// Momentum components that are drawn unless others are asked for.
const MOST: usize = 3;
/// Member steps that are started without being measured first.
const SHORT: f64 = 1e9;

/// Which ensemble to run.
#[derive(Debug, Args)]
pub(crate) struct EnsembleArguments {
    /// The system; `list` shows all
    pub(crate) system: String,
    /// How many members
    #[arg(long, value_name = "N", default_value_t = Members::MEMBERS, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) members: u64,
    /// How far members differ [default: momentum=1%]
    ///
    /// Evenly within plus or minus the width: `inertia=2%` of each component's own size, `momentum_z=0.01` in the component's own unit,
    /// `chi=0,0,0.1` for each component. A rotation is turned about any axis by an angle up to the width: `attitude=5deg`, `attitude=0.1rad`;
    /// advected vectors turn along. Symmetric matrices stay symmetric; an element of a group of matrices is displaced as a whole: `element=0.1`.
    #[arg(long, value_name = "NAME=WIDTH")]
    pub(crate) spread: Vec<String>,
    #[command(flatten)]
    pub(crate) scheme: SchemeArguments,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// `energy` or a component of the state [default: the momentum]
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Vec<String>,
    /// Look at the members after every N-th step [default: 300 times]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Another seed draws other members
    #[arg(long, value_name = "SEED", default_value_t = Members::SEED)]
    pub(crate) seed: u64,
    /// Start even a run of hours
    #[arg(long)]
    pub(crate) long: bool,
    #[command(flatten)]
    pub(crate) telling: Telling,
}

/// Runs an ensemble; writes the distributions as a table and as a plot.
pub(crate) fn ensemble(
    catalogue: Catalogue,
    arguments: &EnsembleArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let out = &arguments.motion.out;
    let mut console = arguments.telling.on(stdout, is_stdout(out))?;
    let entry = catalogue.system(&arguments.system)?;
    let (setup, spec) = prepared(entry, arguments, &mut console)?;
    let named = observables(entry, &arguments.quantity)?;
    spec.check_memory(entry, named.len())?;
    threads::start()?;
    if !arguments.long {
        check_length(entry, &setup, &spec)?;
    }
    let run = provenance(entry, &setup, &spec, arguments);
    let stem = run.stem(entry, &spec.job);
    let guard = Guard::new(run.origin(), arguments.motion.force);
    let paths: Vec<PathBuf> = match is_stdout(out) {
        true => vec![out.clone()],
        false => {
            let ends = std::iter::once("csv").chain(Kind::ALL.iter().map(|kind| kind.extension()));
            ends.map(|end| file_in(out, &format!("{stem}.{end}"))).collect()
        }
    };
    let claim = |path: &PathBuf| Claim { what: "the ensemble", path: path.clone(), written: true };
    for stale in guard.check_all(&paths.iter().map(claim).collect::<Vec<_>>())? {
        console.note(format!("{} was left behind by a run that was killed", stale.display()))?;
    }
    let summary = moved(entry, &setup, &spec, &named)?;

    let mut written = Vec::new();
    for (path, content) in contents(entry, &spec, &named, &summary, &guard, &paths)? {
        if content.is_interrupted && guard.is_complete(path) {
            console.note(format!("{} holds the whole ensemble, and stays", path.display()))?;
            continue;
        }
        guard.write(path, &content.bytes)?;
        written.push(path.clone());
    }
    written.retain(|path| !is_stdout(path));
    let notes = console.notes().to_vec();
    console.object(|| {
        let mut object = object(entry, &setup, &spec, &named, &summary);
        object["notes"] = notes.into();
        object["written"] = written.iter().map(|path| path.display().to_string()).collect();
        object["interrupted"] = interrupt::requested().into();
        object
    })?;
    report(entry, &summary, &spec, console.words())?;
    for path in written {
        writeln!(console.words(), "wrote {}", path.display())?;
    }
    match summary.failed.first() {
        _ if interrupt::requested() => Err(Error::Interrupted),
        Some(first) if summary.failed.len() == spec.members => {
            Err(Error::NoneLeft { count: spec.members, what: "members", first: first.to_string() })
        }
        _ => Ok(()),
    }
}

/// What makes the files of an ensemble.
fn provenance(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    arguments: &EnsembleArguments,
) -> Provenance {
    let mut run = Provenance::of_run(entry, setup, &spec.job, spec.every);
    run.ensemble = Some(Members {
        members: arguments.members,
        spread: arguments.spread.clone(),
        seed: arguments.seed,
        quantity: arguments.quantity.clone(),
    });
    run
}

/// What goes into a file.
struct Content {
    bytes: Vec<u8>,
    /// Whether the ensemble has not come to its end.
    is_interrupted: bool,
}

/// The table, and the pictures unless there is nothing to draw.
fn contents<'p>(
    entry: &Entry,
    spec: &EnsembleSpec,
    named: &[(String, Observable)],
    summary: &EnsembleSummary,
    guard: &Guard,
    paths: &'p [PathBuf],
) -> Result<Vec<(&'p PathBuf, Content)>, Error> {
    let last = summary.spreads.first().and_then(|spreads| spreads.last());
    let taken = last.map_or(0, |spread| (spread.time / spec.job.step).round() as u64);
    let interrupted = (taken < spec.job.steps).then_some(taken);
    let run = guard.origin().interrupted_after(interrupted);
    let content = |bytes| Content { bytes, is_interrupted: interrupted.is_some() };
    let mut contents = Vec::new();
    if let Some(path) = paths.first() {
        contents.push((path, content(table(&run, &records(named, summary)))));
    }
    let is_seen = |spread: &&Spread| spread.members > 0;
    let looks = summary.spreads.first().map_or(0, |spreads| spreads.iter().filter(is_seen).count());
    // of members that failed at once there is nothing to draw
    if looks > 1 {
        let figure = figure(entry, named, summary, spec, &spec.variation.words);
        for (path, kind) in paths.iter().skip(1).zip(Kind::ALL) {
            contents.push((path, content(embed(kind.extension(), figure.picture(*kind), &run))));
        }
    }
    Ok(contents)
}

/// Makes an ensemble again, from what made a file.
pub(crate) fn again(
    catalogue: Catalogue,
    made: &Provenance,
    run: &RunArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let entry = made.entry(catalogue)?;
    let Some(Members { members, spread, seed, quantity }) = made.ensemble.clone() else { return Ok(()) };
    let Job { method, retraction, order, .. } = made.job()?;
    let ours = method.classical().is_none();
    let arguments = EnsembleArguments {
        system: entry.name.to_owned(),
        members,
        spread,
        scheme: SchemeArguments {
            method: Some(method),
            retraction: ours.then_some(retraction),
            order: ours.then_some(order),
        },
        motion: MotionArguments {
            set: assignments(entry, &made.setup(entry)?),
            step: Some(made.step),
            duration: Some(made.steps as f64 * made.step.abs()),
            out: run.chosen.motion.out.clone(),
            force: run.chosen.motion.force,
        },
        quantity,
        every: Some(made.every),
        seed,
        long: run.long,
        telling: run.telling,
    };
    ensemble(catalogue, &arguments, stdout)
}

/// The setup that members differ from, and the ensemble.
fn prepared(
    entry: &'static Entry,
    arguments: &EnsembleArguments,
    console: &mut Console<'_>,
) -> Result<(Setup, EnsembleSpec), Error> {
    let EnsembleArguments { scheme, motion, .. } = arguments;
    check_scheme(scheme.method, scheme.order, scheme.retraction)?;
    let mut changes = Changes::of(entry);
    changes.apply(&motion.set)?;
    let (setup, notes) = changes.finish()?;
    notes.into_iter().try_for_each(|note| console.note(note))?;
    let default = entry.description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    let spread: Vec<String> = match arguments.spread.is_empty() {
        true => default.map(|quantity| format!("{}=1%", quantity.name)).collect(),
        false => arguments.spread.clone(),
    };
    let variation = Variation::parse(entry, &setup, &spread)?;
    variation.notes.iter().try_for_each(|note| console.note(note.clone()))?;
    let job = job(entry, scheme, Retraction::Cayley, (motion.step, motion.duration), console)?;
    let members = usize::try_from(arguments.members)
        .map_err(|_| Error::Input(format!("{} are too many members", arguments.members)))?;
    let every = arguments.every.unwrap_or(Members::every(job.steps));
    Ok((setup, EnsembleSpec { members, variation, seed: arguments.seed, job, every }))
}

/// Measures a few members over a few steps: hours have to be asked for.
fn check_length(entry: &Entry, setup: &Setup, spec: &EnsembleSpec) -> Result<(), Error> {
    let all = spec.members as f64 * spec.job.steps as f64;
    if all < SHORT {
        return Ok(());
    }
    let job = Job { steps: spec.job.steps.min(100), ..spec.job };
    let few = EnsembleSpec { members: spec.members.min(1024), job, every: u64::MAX, ..spec.clone() };
    let unwatched = &mut |_: u64| ControlFlow::Continue(());
    // what fails here fails again, and is told then
    let Ok(measured) = crate::ensemble::run(entry, setup, &few, &[], unwatched) else { return Ok(()) };
    let seconds = measured.seconds / measured.member_steps.max(1) as f64 * all;
    Estimate { seconds, bytes: 0.0 }.check((all.min(u64::MAX as f64)) as u64, 1)
}

/// Runs it with its progress; Ctrl-C ends it.
fn moved(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    named: &[(String, Observable)],
) -> Result<EnsembleSummary, Error> {
    interrupt::listen();
    let mut progress = Progress::new(entry.name, spec.job.steps);
    let mut report_progress = |index: u64| {
        progress.show(index);
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let observables: Vec<Observable> = named.iter().map(|(_, observable)| *observable).collect();
    Ok(crate::ensemble::run(entry, setup, spec, &observables, &mut report_progress)?)
}

/// The observables asked for, with their names.
fn observables(entry: &'static Entry, asked: &[String]) -> Result<Vec<(String, Observable)>, Error> {
    let mut all = vec![("energy".to_owned(), Observable::Energy)];
    let mut momenta = Vec::new();
    for (quantity, slots) in laid_out(entry.description.state) {
        let Quantity { role, components, .. } = quantity;
        for (component, slot) in components.iter().zip(slots) {
            let observable = (component_name(quantity, component), Observable::State(slot));
            if *role == Role::Momentum && momenta.len() < MOST {
                momenta.push(observable.clone());
            }
            all.push(observable);
        }
    }
    if asked.is_empty() {
        return Ok(momenta);
    }
    let find = |name: &String| {
        all.iter().find(|(known, _)| known == name).cloned().ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|(known, _)| known.as_str()).collect();
            let hint = did_you_mean(name, names.iter().copied());
            Error::Input(format!("`{}` has no quantity `{name}`{hint} ({})", entry.name, names.join(", ")))
        })
    };
    asked.iter().map(find).collect()
}

/// Time and, for each quantity, how many members, mean, deviation and quantiles.
fn records(named: &[(String, Observable)], summary: &EnsembleSummary) -> Vec<Vec<String>> {
    const COLUMNS: [&str; 10] =
        ["members", "mean", "deviation", "min", "q05", "q25", "median", "q75", "q95", "max"];
    let columns = named.iter().flat_map(|(name, _)| COLUMNS.map(|column| format!("{name}_{column}")));
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

/// The members that failed, at most so many of them by name.
const TOLD: usize = 3;

fn report(
    entry: &Entry,
    summary: &EnsembleSummary,
    spec: &EnsembleSpec,
    words: &mut dyn Write,
) -> Result<(), Error> {
    let EnsembleSummary { drawn, failed, member_steps, width, seconds, .. } = summary;
    let Job { method, retraction, .. } = spec.job;
    let retraction = if method.classical().is_some() { "" } else { retraction.name() };
    writeln!(words, "scheme: {method} {retraction}, order {}", entry.order(&spec.job))?;
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
        rate_in_words(*member_steps as f64 / seconds),
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
    named: &[(String, Observable)],
    summary: &EnsembleSummary,
) -> Value {
    let mut object = json!({});
    for (name, value) in Provenance::of_run(entry, setup, &spec.job, spec.every).fields() {
        object[name] = value;
    }
    object["steps"] = json!(spec.job.steps);
    object["members"] = json!(spec.members);
    object["seed"] = json!(spec.seed);
    object["spread"] = json!(spec.variation.words);
    for drawn in &summary.drawn {
        object["drawn"][&drawn.name] =
            json!({ "min": drawn.range.0, "max": drawn.range.1, "unit": drawn.unit });
    }
    for ((name, _), last) in named.iter().zip(summary.spreads.iter().map(|spreads| spreads.last())) {
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
