//! `coadjoint list`

use std::io::Write;

use clap::Args;
use coadjoint::erased;
use coadjoint::system::{Kind, Quantity};
use serde_json::{Value, json};

use super::console::OutputMode;
use super::description::DescriptionArguments;
use super::program;
use crate::catalogue::{Catalogue, Entry, casimir, unit};
use crate::error::Error;
use crate::setup::{Method, Order, Retraction, Tolerance};
use crate::simulate::{has_method, usual_method};
use crate::units::{exact, with_unit, wrapped};

/// The arguments of `list`.
#[derive(Debug, Args)]
pub(crate) struct ListArguments {
    /// All about this system [default: one line about each]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

pub(crate) fn list(
    catalogue: &Catalogue,
    arguments: &ListArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.output.on(stdout, false)?;
    if arguments.system.is_some() || arguments.described.file().is_some() {
        let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
        console.object(|| object(entry))?;
        return one(console.words(), entry);
    }
    let entries = catalogue.entries();
    console.object(|| json!({ "systems": entries.iter().map(object).collect::<Vec<_>>() }))?;
    let words = console.words();
    let width = entries.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in entries {
        let about = wrapped(entry.about, 80 - width - 2).join(&format!("\n{:width$}  ", ""));
        writeln!(words, "{}", format!("{:width$}  {about}", entry.name).trim_end())?;
    }
    writeln!(words, "\n`{} list NAME` tells all about a system", program())?;
    Ok(())
}

/// All about one system.
fn one(words: &mut dyn Write, entry: &Entry) -> Result<(), Error> {
    let title = format!("{}: {}", entry.name, entry.about);
    writeln!(words, "{}", wrapped(title.trim_end_matches(": "), 80).join("\n"))?;
    let example = &entry.example;
    let shown = |values| entry.has_example.then_some(values);
    quantities(words, "parameters", entry.description.parameters, shown(&example.parameters[..]))?;
    quantities(words, "initial state", entry.description.state, shown(&example.state[..]))?;
    quantities(words, "controls", entry.description.controls, None)?;
    if !entry.description.controls.is_empty() {
        writeln!(words, "  held over each step, chosen by the system's own law, or by `--set`")?;
    }
    writeln!(words, "\nconserved")?;
    let conserved = conserved(entry, casimir::listed(entry));
    let while_held = entry.description.autonomous && !entry.conserves_energy();
    if while_held {
        let energy = with_unit("energy while the controls are the same", entry.energy_unit);
        writeln!(words, "  {energy}")?;
    } else if conserved.is_empty() {
        writeln!(words, "  nothing")?;
    }
    for (name, unit) in conserved {
        writeln!(words, "  {}", wrapped(&with_unit(&name, unit), 76).join("\n    "))?;
    }
    writeln!(words, "\nretractions  {}", retractions(entry).join(", "))?;
    let methods = methods(entry).join(", ");
    writeln!(words, "methods      {}", wrapped(&methods, 67).join("\n             "))?;
    let events: Vec<&str> = entry.description.events.iter().map(|(name, _)| *name).collect();
    if !events.is_empty() {
        writeln!(words, "events       {}", wrapped(&events.join(", "), 67).join("\n             "))?;
    }
    writeln!(words, "step {} s, duration {} s\n", exact(entry.step), exact(entry.duration))?;
    if !entry.has_example {
        let given = "it has no example: `--set` gives its parameters and what is advected, or a file of `init`; \
                     configurations begin at the unit, momenta at zero";
        writeln!(words, "{}\n", wrapped(given, 80).join("\n"))?;
    }
    let run = match &entry.file {
        Some(file) => format!("run --description {} --set …", file.display()),
        None => format!("run {}", entry.name),
    };
    writeln!(words, "{} {run} --plot", program())?;
    Ok(())
}

/// One line for each quantity with its value in the example, as `--set` takes it, and below it what it is.
fn quantities(
    words: &mut dyn Write,
    title: &str,
    all: &[Quantity],
    values: Option<&[f64]>,
) -> Result<(), Error> {
    if !all.is_empty() {
        writeln!(words, "\n{title}")?;
    }
    for (quantity, slots) in Quantity::with_ranges(all) {
        let list = |values: &[f64]| values.iter().map(|x| exact(*x)).collect::<Vec<_>>().join(",");
        let value = values.map_or(String::new(), |values| format!("={}", list(&values[slots])));
        writeln!(words, "  {}", format!("{}{value}  {}", quantity.name, unit(quantity)).trim_end())?;
        let told = [order(quantity).as_str(), quantity.doc].join(" ");
        for line in wrapped(told.trim(), 74).into_iter().filter(|line| !line.is_empty()) {
            writeln!(words, "      {line}")?;
        }
    }
    Ok(())
}

/// The order of a quantity's numbers, `(w, x, y, z)`, where it is not obvious.
fn order(quantity: &Quantity) -> String {
    match (quantity.kind, quantity.components) {
        (Kind::Matrix(..) | Kind::SymmetricMatrix(_) | Kind::UnitComplex, _) | (_, [_] | []) => String::new(),
        (_, components) => format!("({})", components.join(", ")),
    }
}

/// Lists the invariants of its motion, with units.
fn conserved<N: From<&'static str>>(
    entry: &Entry,
    casimirs: impl Iterator<Item = (N, &'static str)>,
) -> Vec<(N, &'static str)> {
    let energy = entry.conserves_energy().then(|| ("energy".into(), entry.energy_unit));
    energy.into_iter().chain(casimirs).collect()
}

/// All methods of ours that there are of it.
fn methods(entry: &Entry) -> Vec<String> {
    let generated = Method::COMMON.into_iter().chain(Method::with_numbers());
    let generated = generated.filter(|method| has_method(entry, *method));
    let lifted = entry.has_right_lift().then_some(Method::RightLift);
    let mut names: Vec<String> = generated.chain(lifted).map(|method| method.to_string()).collect();
    let is_there = |order: &Order| {
        let usual = |&retraction: &Retraction| usual_method(entry, retraction, *order);
        Retraction::COMMON.iter().map(usual).any(|method| method == Method::HAMILTON_JACOBI)
    };
    let orders = Order::ALL.into_iter().filter(is_there).map(|order| order.number());
    names.extend(orders.map(|order| format!("{} (order {order})", Method::HAMILTON_JACOBI)));
    let system = entry.system(&entry.example.parameters);
    if erased::Adaptive::new(system, Tolerance::USUAL.value()).is_ok() {
        names.push("taylor (--tolerance)".to_owned());
    }
    names
}

/// The retractions that there are steps of it with.
fn retractions(entry: &Entry) -> Vec<&'static str> {
    Retraction::of(entry).iter().map(|retraction| retraction.name()).collect()
}

/// A system as a JSON object.
fn object(entry: &Entry) -> Value {
    let of = |all: &[Quantity], values: Option<&[f64]>| {
        let quantity = |(quantity, slots): (&Quantity, std::ops::Range<usize>)| {
            json!({
                "name": quantity.name, "components": quantity.components, "unit": unit(quantity),
                "about": quantity.doc, "example": values.map(|values| &values[slots]),
            })
        };
        Quantity::with_ranges(all).map(quantity).collect::<Vec<_>>()
    };
    fn shown<'e>(entry: &Entry, values: &'e [f64]) -> Option<&'e [f64]> {
        entry.has_example.then_some(values)
    }
    let conserved = |(name, unit): (&str, &str)| json!({ "name": name, "unit": unit });
    json!({
        "name": entry.name,
        "about": entry.about,
        "parameters": of(entry.description.parameters, shown(entry, &entry.example.parameters)),
        "state": of(entry.description.state, shown(entry, &entry.example.state)),
        "controls": of(entry.description.controls, None),
        "conserved": self::conserved(entry, entry.casimirs()).into_iter().map(conserved).collect::<Vec<_>>(),
        "retractions": retractions(entry),
        "methods": methods(entry),
        "events": entry.description.events.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
        "step": entry.step,
        "duration": entry.duration,
    })
}
