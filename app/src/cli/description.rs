//! `--description`: a system that is described in a file, with no compiler.

#[cfg(feature = "description")]
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::program;
#[cfg(feature = "description")]
use crate::catalogue::snake_case;
use crate::catalogue::{Catalogue, Entry};
use crate::error::{Error, SetupError};

/// Where a system is described that is not among those of the program.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct DescriptionArguments {
    /// A file that describes the system: a struct below `#[lie_poisson_system(…)]`, as for the compiler
    ///
    /// It has no example: parameters and what is advected are given by `--set`, or in a file that `init` writes.
    ///
    /// No compiler is needed: the equations are derived now, and steps take about ten times as long as compiled ones; built with the feature `jit`, one
    /// and a half times.
    #[cfg(feature = "description")]
    #[arg(long, value_name = "FILE")]
    pub(crate) description: Option<PathBuf>,
}

impl DescriptionArguments {
    /// The file.
    pub(crate) fn file(&self) -> Option<&PathBuf> {
        #[cfg(feature = "description")]
        return self.description.as_ref();
        #[cfg(not(feature = "description"))]
        None
    }

    /// The systems of the program and before them the one that is described, which of several is the one of this name.
    ///
    /// # Errors
    /// If the file cannot be read, or no system can be made of it.
    pub(crate) fn catalogue(&self, catalogue: &Catalogue, system: Option<&str>) -> Result<Catalogue, Error> {
        match self.file() {
            Some(file) => Ok(catalogue.with(described(file, system)?)),
            None => Ok(catalogue.clone()),
        }
    }

    /// The system of this name; without one, the one that is described.
    ///
    /// # Errors
    /// If there is none.
    pub(crate) fn system<'c>(
        &self,
        catalogue: &'c Catalogue,
        name: Option<&str>,
    ) -> Result<&'c Entry, SetupError> {
        match (name, self.file(), catalogue.entries().first()) {
            (Some(name), ..) => catalogue.system(name),
            (None, Some(_), Some(described)) => Ok(described),
            (None, ..) => {
                Err(SetupError::new(format!("no system: name one (`{} list` shows all)", program())))
            }
        }
    }
}

/// Makes a system from its description, of several the one of this name.
#[cfg(feature = "description")]
pub(super) fn described(file: &Path, system: Option<&str>) -> Result<Entry, Error> {
    use coadjoint_dynamic::{DescriptionError, Model};
    use std::sync::Arc;

    use crate::error::FileError;
    use crate::files::path::read_file;

    /// The longest text that is read, in bytes.
    const MOST: u64 = 1 << 20;

    let read = || String::from_utf8(read_file(file, MOST)?).map_err(std::io::Error::other);
    let text = read().map_err(FileError::read(file))?;
    let name = file.display().to_string();
    // it is told as an error anyway
    let wrong = |error: DescriptionError| {
        let shown = error.to_string();
        SetupError::new(shown.strip_prefix("error: ").unwrap_or(&shown))
    };
    let names = coadjoint_dynamic::names(&text, &name).map_err(wrong)?;
    let plain = |name: &str| name.to_lowercase().replace(['_', '-', ' '], "");
    let chosen = system.and_then(|system| names.iter().find(|name| plain(name) == plain(system)));
    if let (Some(system), None, [_, ..]) = (system, chosen, &names[..]) {
        let names = names.iter().map(|name| snake_case(name)).collect::<Vec<_>>().join(", ");
        return Err(SetupError::new(format!("{name} describes {names}, and no `{system}`")).into());
    }
    let model = Model::from_file(&text, &name, chosen.map(String::as_str)).map_err(wrong)?;
    for warning in model.shown_warnings() {
        // if standard error is closed, the run is not
        let _ = writeln!(std::io::stderr(), "{warning}");
    }
    let (description, about) = (model.description(), model.about().to_owned().leak());
    let mut entry = Entry::made(description, Arc::new(move |parameters| Arc::new(model.system(parameters))));
    // once in a program
    (entry.about, entry.source, entry.file) = (about, text.leak(), Some(file.to_owned()));
    Ok(entry)
}

#[cfg(not(feature = "description"))]
pub(super) fn described(_: &Path, _: Option<&str>) -> Result<Entry, Error> {
    Err(SetupError::new("this program was built without the feature `description`").into())
}

/// A description to begin with.
#[cfg(feature = "description")]
pub(crate) const TEMPLATE: &str = "\
// A system for `coadjoint run --description <this file>`, and for the compiler as well.
// `cargo doc` of the crate `coadjoint` has all that may stand here: its guide, page `language`.

/// A rigid body that turns about a fixed point under gravity.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3), // the vertical, seen from the body
    potential = weight * gamma.dot(&chi),
    methods(Midpoint),
    units(momentum = \"kg m²/s\"),
)]
struct MyTop {
    /// Principal moments of inertia about the fixed point.
    #[inertia]
    #[unit(\"kg m²\")]
    inertia: Vector3<f64>,
    /// Mass times gravitational acceleration.
    #[unit(\"N\")]
    weight: f64,
    /// From the fixed point to the centre of mass, in body axes.
    #[unit(\"m\")]
    chi: Vector3<f64>,
}
";
