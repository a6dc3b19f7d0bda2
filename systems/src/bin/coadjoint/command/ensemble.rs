//! `coadjoint ensemble`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use coadjoint::ensemble::Spread;
use coadjoint::system::{Quantity, Role};

use super::run::steps;
use crate::cli::EnsembleArguments;
use crate::error::Error;
use crate::interrupt;
use crate::output::{WholeFile, make_directory};
use crate::plot::{Axis, Figure, Key, Panel, Series};
use crate::progress::Progress;
use crate::report::grouped;
use crate::setting;
use crate::suggest::did_you_mean;
use coadjoint_systems::catalogue::{Entry, component_name};
use coadjoint_systems::crowd::{Course, Crowd, Shown};

/// Looks in all, unless asked otherwise.
const LOOKS: u64 = 300;
/// Momentum components that are drawn unless others are asked for.
const MOST: usize = 3;

/// Runs an ensemble; writes how it spreads as a table and as a picture.
pub(crate) fn ensemble(arguments: &EnsembleArguments, console: &mut dyn Write) -> Result<(), Error> {
    let entry = crate::suggest::system(&arguments.system)?;
    let mut setup = (entry.example)();
    setting::apply(entry, &mut setup, &arguments.motion.set)?;
    let mut notes = setting::settle(entry, &mut setup)?;
    let default = entry.description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    let spread = match arguments.spread.is_empty() {
        true => default.map(|quantity| format!("{}=1%", quantity.name)).collect(),
        false => arguments.spread.clone(),
    };
    let widths = setting::widths(entry, &setup, &spread)?;
    let shown = shown(entry, &arguments.quantity)?;
    let step = arguments.motion.step.unwrap_or(entry.step);
    let (steps, note) = steps(step, arguments.motion.duration.unwrap_or(entry.duration))?;
    notes.extend(note);
    for note in notes {
        writeln!(console, "note: {note}")?;
    }
    console.flush()?;
    let members = usize::try_from(arguments.members)
        .map_err(|_| Error::Input(format!("{} are too many members", arguments.members)))?;
    let every = arguments.every.unwrap_or((steps / LOOKS).max(1));
    let crowd = Crowd { members, widths, seed: arguments.seed, step, steps, every };

    interrupt::listen();
    let mut progress = Progress::new(entry.name, steps);
    let mut watch = |index: u64| {
        progress.show(index);
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let places: Vec<Shown> = shown.iter().map(|(_, shown)| *shown).collect();
    let course = coadjoint_systems::crowd::run(entry, &setup, &crowd, &places, &mut watch)?;
    drop(progress);

    make_directory(&arguments.motion.out)?;
    let stem = arguments.motion.out.join(format!("{}-ensemble", entry.name));
    let table = stem.with_extension("csv");
    write_table(&table, &shown, &course)?;
    let pictures = figure(entry, &shown, &course, &crowd, &spread).write(&stem)?;
    tell(&course, &crowd, console)?;
    for path in std::iter::once(table).chain(pictures) {
        writeln!(console, "wrote {}", path.display())?;
    }
    if interrupt::requested() { Err(Error::Interrupted) } else { Ok(()) }
}

/// What is shown, with names.
fn shown(entry: &'static Entry, asked: &[String]) -> Result<Vec<(String, Shown)>, Error> {
    let mut all = vec![("energy".to_owned(), Shown::Energy)];
    let mut momenta = Vec::new();
    for (quantity, slots) in setting::laid_out(entry.description.state) {
        let Quantity { role, components, .. } = quantity;
        for (component, slot) in components.iter().zip(slots) {
            let named = (component_name(quantity, component), Shown::State(slot));
            if *role == Role::Momentum && momenta.len() < MOST {
                momenta.push(named.clone());
            }
            all.push(named);
        }
    }
    if asked.is_empty() {
        return Ok(momenta);
    }
    let find = |name: &String| {
        all.iter().find(|(known, _)| known == name).cloned().ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|(known, _)| known.as_str()).collect();
            let hint = did_you_mean(name, names.iter().copied());
            Error::Input(format!("`{}` shows no `{name}`{hint} ({})", entry.name, names.join(", ")))
        })
    };
    asked.iter().map(find).collect()
}

/// Time and, for each quantity, how many members, mean, deviation and quantiles.
fn write_table(path: &Path, shown: &[(String, Shown)], course: &Course) -> Result<(), Error> {
    const COLUMNS: [&str; 10] =
        ["members", "mean", "deviation", "min", "q05", "q25", "median", "q75", "q95", "max"];
    let written = || -> std::io::Result<()> {
        let mut file = WholeFile::create(path)?;
        let mut writer = csv::Writer::from_writer(&mut file);
        let columns = shown.iter().flat_map(|(name, _)| COLUMNS.map(|column| format!("{name}_{column}")));
        writer.write_record(std::iter::once("time".to_owned()).chain(columns))?;
        let looks = course.spreads.first().map_or(0, Vec::len);
        for look in 0..looks {
            let mut record = vec![course.spreads[0][look].time.to_string()];
            for spreads in &course.spreads {
                let Spread { members, mean, deviation, quantiles, .. } = spreads[look];
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

/// A panel for each quantity: the median in bands that hold more and more members.
fn figure(
    entry: &Entry,
    shown: &[(String, Shown)],
    course: &Course,
    crowd: &Crowd,
    spread: &[String],
) -> Figure {
    let panel = |((name, _), spreads): (&(String, Shown), &Vec<Spread>)| {
        let edge = |k: usize| {
            let points = spreads.iter().filter(|spread| spread.members > 0);
            points.map(|spread| (spread.time, spread.quantiles[k])).collect::<Vec<_>>()
        };
        let bands = [(0, 6), (1, 5), (2, 4)].map(|(low, high)| Series::band(edge(low), edge(high)));
        let series = bands.into_iter().chain([Series::line("median", edge(3))]).collect();
        Panel::new(Axis::linear(""), Axis::linear(name), series)
    };
    let panels: Vec<Panel> = shown.iter().zip(&course.spreads).map(panel).collect();
    let times = |of: fn(f64, f64) -> f64| {
        let times = course.spreads.iter().flatten().map(|spread| spread.time);
        times.reduce(of).unwrap_or(0.0)
    };
    let title = format!("{} of {}", grouped(crowd.members as u64), entry.name);
    let mut figure =
        Figure::over_time(title, "time / s", (times(f64::min), times(f64::max)), Key::Below, panels);
    let mut caption = format!(
        "Members differ by {}, evenly to either side. Line: the median; bands, from dark to light: a half, nine tenths, all of the members.",
        spread.join(", ")
    );
    if !course.failed.is_empty() {
        caption +=
            &format!(" {} failed on the way and count no longer.", grouped(course.failed.len() as u64));
    }
    figure.caption = vec![caption];
    figure
}

fn tell(course: &Course, crowd: &Crowd, console: &mut dyn Write) -> Result<(), Error> {
    let Course { failed, member_steps, width, seconds, .. } = course;
    writeln!(
        console,
        "{} members, {} steps in {seconds:.2} s: {:.1} million member steps per second ({width} side by side, {} threads)",
        grouped(crowd.members as u64),
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
