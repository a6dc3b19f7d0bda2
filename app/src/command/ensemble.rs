//! `coadjoint ensemble`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use clap::Args;
use coadjoint::ensemble::Spread;
use coadjoint::system::{Quantity, Role};

use super::run::{MotionArguments, steps};
use crate::ensemble::{EnsembleSpec, EnsembleSummary, Observable};
use crate::ensemble_plot::figure;
use crate::entry::{Catalogue, Entry, component_name};
use crate::error::Error;
use crate::interrupt;
use crate::output::{AtomicFile, make_directory};
use crate::progress::Progress;
use crate::report::grouped;
use crate::setting;
use crate::suggest::did_you_mean;

/// Samples in all, unless asked otherwise.
const SAMPLES: u64 = 300;
/// Momentum components that are drawn unless others are asked for.
const MOST: usize = 3;

/// Which ensemble to run.
#[derive(Debug, Args)]
pub(crate) struct EnsembleArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// How many members
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) members: u64,
    /// What differs between members, evenly within plus or minus the width: `momentum_z=0.01`, `inertia=2%`, `chi=0,0,0.1`
    /// [default: momentum=1%]
    #[arg(long, value_name = "NAME=WIDTH")]
    pub(crate) spread: Vec<String>,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// What to show: `energy` or a component of the state [default: the momentum]
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Vec<String>,
    /// Look at the members after every N-th step [default: 300 times in all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Another seed draws other members
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// Runs an ensemble; writes the distributions as a table and as a plot.
pub(crate) fn ensemble(
    catalogue: Catalogue,
    arguments: &EnsembleArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = catalogue.system(&arguments.system)?;
    let mut setup = entry.example.clone();
    setting::apply(entry, &mut setup, &arguments.motion.set)?;
    let mut notes = setting::validate(entry, &mut setup)?;
    let default = entry.description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    let spread = match arguments.spread.is_empty() {
        true => default.map(|quantity| format!("{}=1%", quantity.name)).collect(),
        false => arguments.spread.clone(),
    };
    let widths = setting::widths(entry, &setup, &spread)?;
    let named = observables(entry, &arguments.quantity)?;
    let step = arguments.motion.step.unwrap_or(entry.step);
    let (steps, note) = steps(step, arguments.motion.duration.unwrap_or(entry.duration))?;
    notes.extend(note);
    for note in notes {
        writeln!(console, "note: {note}")?;
    }
    console.flush()?;
    let members = usize::try_from(arguments.members)
        .map_err(|_| Error::Input(format!("{} are too many members", arguments.members)))?;
    let every = arguments.every.unwrap_or((steps / SAMPLES).max(1));
    let spec = EnsembleSpec { members, widths, seed: arguments.seed, step, steps, every };

    interrupt::listen();
    let mut progress = Progress::new(entry.name, steps);
    let mut report_progress = |index: u64| {
        progress.show(index);
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let observables: Vec<Observable> = named.iter().map(|(_, observable)| *observable).collect();
    let summary = crate::ensemble::run(entry, &setup, &spec, &observables, &mut report_progress)?;
    drop(progress);

    make_directory(&arguments.motion.out)?;
    let stem = arguments.motion.out.join(format!("{}-ensemble", entry.name));
    let table = stem.with_extension("csv");
    write_table(&table, &named, &summary)?;
    let pictures = figure(entry, &named, &summary, &spec, &spread).write(&stem)?;
    report(&summary, &spec, console)?;
    for path in std::iter::once(table).chain(pictures) {
        writeln!(console, "wrote {}", path.display())?;
    }
    if interrupt::requested() { Err(Error::Interrupted) } else { Ok(()) }
}

/// The observables asked for, with their names.
fn observables(entry: &'static Entry, asked: &[String]) -> Result<Vec<(String, Observable)>, Error> {
    let mut all = vec![("energy".to_owned(), Observable::Energy)];
    let mut momenta = Vec::new();
    for (quantity, slots) in setting::laid_out(entry.description.state) {
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
fn write_table(path: &Path, named: &[(String, Observable)], summary: &EnsembleSummary) -> Result<(), Error> {
    const COLUMNS: [&str; 10] =
        ["members", "mean", "deviation", "min", "q05", "q25", "median", "q75", "q95", "max"];
    let written = || -> std::io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        let mut writer = csv::Writer::from_writer(&mut file);
        let columns = named.iter().flat_map(|(name, _)| COLUMNS.map(|column| format!("{name}_{column}")));
        writer.write_record(std::iter::once("time".to_owned()).chain(columns))?;
        let samples = summary.spreads.first().map_or(0, Vec::len);
        for sample in 0..samples {
            let mut record = vec![summary.spreads[0][sample].time.to_string()];
            for spreads in &summary.spreads {
                let Spread { members, mean, deviation, quantiles, .. } = spreads[sample];
                record.push(members.to_string());
                record.extend([mean, deviation].iter().chain(&quantiles).map(f64::to_string));
            }
            writer.write_record(record)?;
        }
        writer.flush()?;
        drop(writer);
        file.finish()
    };
    written().map_err(|source| Error::Write { path: path.to_owned(), source })
}

fn report(summary: &EnsembleSummary, spec: &EnsembleSpec, console: &mut dyn Write) -> Result<(), Error> {
    let EnsembleSummary { failed, member_steps, width, seconds, .. } = summary;
    writeln!(
        console,
        "{} members, {} steps in {seconds:.2} s: {:.1} million member steps per second ({width} side by side, {} threads)",
        grouped(spec.members as u64),
        grouped(*member_steps),
        *member_steps as f64 / seconds / 1e6,
        rayon::current_num_threads(),
    )?;
    for failure in failed.iter().take(3) {
        writeln!(console, "{failure}: {}", failure.source)?;
    }
    if failed.len() > 3 {
        writeln!(console, "and {} others failed", grouped(failed.len() as u64 - 3))?;
    }
    Ok(())
}
