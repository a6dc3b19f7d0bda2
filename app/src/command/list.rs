//! `coadjoint list`

use std::io::Write;

use coadjoint::system::Quantity;

use crate::entry::Catalogue;
use crate::error::Error;
use crate::setting::laid_out;

pub(crate) fn list(catalogue: Catalogue, console: &mut dyn Write) -> Result<(), Error> {
    for (i, entry) in catalogue.entries().iter().enumerate() {
        if i > 0 {
            writeln!(console)?;
        }
        writeln!(console, "{}: {}", entry.name, entry.about)?;
        let setup = entry.example.clone();
        quantities(console, "parameters", entry.description.parameters, &setup.parameters)?;
        quantities(console, "initial state", entry.description.state, &setup.state)?;
        for (i, control) in entry.description.controls.iter().enumerate() {
            let title = if i == 0 { "controls" } else { "" };
            writeln!(
                console,
                "  {title:14} {:24} held over each step: by the system's own law, or by `--set`",
                control.name
            )?;
        }
        let energy = entry.description.autonomous.then_some("energy");
        let conserved: Vec<&str> =
            energy.into_iter().chain(entry.description.casimirs.iter().copied()).collect();
        let conserved = if conserved.is_empty() { "nothing".to_owned() } else { conserved.join(", ") };
        writeln!(console, "  conserved      {conserved}")?;
    }
    Ok(())
}

/// One line for each quantity with its value in the example, as `--set` takes it.
fn quantities(console: &mut dyn Write, title: &str, all: &[Quantity], values: &[f64]) -> Result<(), Error> {
    for (i, (quantity, slots)) in laid_out(all).enumerate() {
        let title = if i == 0 { title } else { "" };
        // adding zero leaves no −0
        let value = values[slots].iter().map(|x| (x + 0.0).to_string()).collect::<Vec<_>>().join(",");
        let assignment = format!("{}={value}", quantity.name);
        let mut line = format!("  {title:14} {assignment:24}");
        if assignment.chars().count() > 44 && !quantity.doc.is_empty() {
            // the documentation stands below what is too long
            writeln!(console, "{}", line.trim_end())?;
            line = format!("  {:14} {:24}", "", "");
        }
        writeln!(console, "{}", format!("{line} {}", quantity.doc).trim_end())?;
    }
    Ok(())
}
