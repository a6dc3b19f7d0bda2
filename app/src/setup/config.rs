//! Runs described in a TOML file: `coadjoint init` writes one, `coadjoint run --config` reads it.

use coadjoint::system::{Quantity, Role};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::form::RotationForm;
use super::{Changes, Column, Format, Method, Names, Order, Retraction};
use crate::catalogue::{Entry, Interpolation};
use crate::error::{Error, FileError, SetupError};

/// The content of a configuration file; what is missing has its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// The system's name.
    pub(crate) system: Option<String>,
    /// How to run it.
    #[serde(default)]
    pub(crate) run: RunConfig,
    /// Parameters by their names.
    #[serde(default)]
    pub(crate) parameters: Table,
    /// Parts of the initial state by their names.
    #[serde(default)]
    pub(crate) state: Table,
    /// Controls by their names, to be held in place of what the system's own law chooses.
    #[serde(default)]
    pub(crate) controls: Table,
}

/// How to run a system.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunConfig {
    /// The map that the step is built on.
    pub(crate) retraction: Option<Retraction>,
    /// The method.
    pub(crate) method: Option<Method>,
    /// The order.
    pub(crate) order: Option<Order>,
    /// The tolerance of Taylor steps, in place of a method.
    pub(crate) tolerance: Option<f64>,
    /// The step, s.
    pub(crate) step: Option<f64>,
    /// How long to run, s.
    pub(crate) duration: Option<f64>,
    /// Write every so many steps.
    pub(crate) every: Option<u64>,
    /// Write the states at these times, s.
    #[serde(default)]
    pub(crate) at: Vec<f64>,
    /// Write the states at 0, so much later, and so on, s.
    #[serde(alias = "every-seconds")]
    pub(crate) every_seconds: Option<f64>,
    /// Look at every step, whatever is written.
    #[serde(default, alias = "watch-every-step")]
    pub(crate) watch_every_step: bool,
    /// A table of controls, found from the directory of the file.
    pub(crate) input: Option<PathBuf>,
    /// What is between its rows.
    pub(crate) interpolation: Option<Interpolation>,
    /// Quantities of one's own, as the command line takes them.
    #[serde(default)]
    pub(crate) quantity: Vec<String>,
    /// End at the moment from which on this holds.
    pub(crate) until: Option<String>,
    /// Events, as the command line takes them.
    #[serde(default)]
    pub(crate) event: Vec<String>,
    /// Further columns of the table.
    #[serde(default)]
    pub(crate) columns: Vec<Column>,
    /// The format of the trajectory.
    pub(crate) format: Option<Format>,
    /// Draw the run too.
    #[serde(default)]
    pub(crate) plot: bool,
}

/// Options of a run that say what to do with it this time: no keys.
const OPTIONS: [&str; 13] = [
    "again",
    "checkpoint",
    "config",
    "description",
    "force",
    "html",
    "json",
    "open",
    "out",
    "quiet",
    "save-every",
    "scan",
    "set",
];

/// Options of an ensemble alone.
const OPTIONS_OF_ENSEMBLES: [&str; 6] = ["block", "members", "rows", "seed", "shard", "spread"];

impl Config {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is no TOML, or says what no run has.
    pub(crate) fn read(path: &Path) -> Result<Self, Error> {
        let text = read_text(path).map_err(FileError::read(path))?;
        let mut config = Self::of(&text).map_err(|error| error.within(path.display()))?;
        let directory = path.parent().unwrap_or(Path::new(""));
        config.run.input = config.run.input.map(|input| directory.join(input));
        Ok(config)
    }

    /// Reads a text.
    ///
    /// # Errors
    /// If it is no TOML, or says what no run has.
    pub(crate) fn of(text: &str) -> Result<Self, SetupError> {
        let wrong = |error: toml::de::Error| SetupError::new(error.to_string().trim_end());
        let config: Self =
            toml::from_str(text).map_err(|error| option(text).unwrap_or_else(|| wrong(error)))?;
        let RunConfig { every, at, every_seconds, method, tolerance, input, interpolation, .. } = &config.run;
        let written = [every.is_some(), !at.is_empty(), every_seconds.is_some()];
        let reason = if written.into_iter().filter(|is| *is).count() > 1 {
            "`every`, `at` and `every_seconds` each say what is written; give one of them"
        } else if method.is_some() && tolerance.is_some() {
            "`tolerance` stands in place of `method`; give one of them"
        } else if input.is_none() && interpolation.is_some() {
            "`interpolation` says what is between the rows of `input`, which is not given"
        } else {
            return Ok(config);
        };
        Err(SetupError::new(format!("[run]: {reason}")))
    }

    /// Sets the parameters and the initial state that the file gives.
    ///
    /// # Errors
    /// If a name is unknown, or a value has another number of components than its quantity.
    pub(crate) fn apply(&self, path: &Path, changes: &mut Changes<'_>) -> Result<(), SetupError> {
        let tables = [
            (Names::PARAMETERS, "parameters", &self.parameters),
            (Names::STATE, "state", &self.state),
            (Names::CONTROLS, "controls", &self.controls),
        ];
        for (which, section, table) in tables {
            for (name, value) in table {
                formed(name, value)
                    .and_then(|(form, numbers)| changes.assign_form(which, name, form, &numbers))
                    .map_err(|error| error.within(format!("{}: [{section}]", path.display())))?;
            }
        }
        Ok(())
    }
}

/// Says of a key that is an option of the command line alone where it belongs.
fn option(text: &str) -> Option<SetupError> {
    let file: Table = text.parse().ok()?;
    let keys = [Some(&file), file.get("run").and_then(Value::as_table)];
    let is_one_of = |options: &[&str]| {
        let mut keys = keys.iter().flatten().flat_map(|table| table.keys());
        keys.find(|key| options.contains(&key.replace('_', "-").as_str()))
    };
    let reason = match (is_one_of(&OPTIONS), is_one_of(&OPTIONS_OF_ENSEMBLES)) {
        (Some(set), _) if set == "set" => {
            "what `--set` sets stands below [parameters], [state] and [controls]".to_owned()
        }
        (Some(key), _) => {
            format!("`{key}` is no key: it is said each time, by `--{}`", key.replace('_', "-"))
        }
        (None, Some(key)) => {
            format!("`{key}` is no key: a file describes one run; `ensemble` takes `--{key}`")
        }
        (None, None) => return None,
    };
    Some(SetupError::new(reason))
}

/// Reads a text of at most a megabyte: what is given for a text by mistake may have no end.
fn read_text(path: &Path) -> io::Result<String> {
    const MOST: u64 = 1 << 20;
    let mut text = String::new();
    File::open(path)?.take(MOST + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MOST {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, "it is longer than a megabyte"));
    }
    Ok(text)
}

/// Whole numbers up to here are those of f64.
const EXACT: u64 = 1 << 53;

/// Numbers, or a rotation in one of its forms: `{ euler = [0.1, 0.2, 0.3] }`.
fn formed(name: &str, value: &Value) -> Result<(Option<RotationForm>, Vec<f64>), SetupError> {
    let form = value.as_table().filter(|table| table.len() == 1).and_then(|table| table.iter().next());
    match form {
        Some((form, value)) => Ok((Some(RotationForm::named(form)?), numbers(name, value)?)),
        None => Ok((None, numbers(name, value)?)),
    }
}

/// A number, or a list of numbers.
fn numbers(name: &str, value: &Value) -> Result<Vec<f64>, SetupError> {
    let wrong = |reason: String| Err(SetupError::new(reason));
    let number = |value: &Value| match value {
        Value::Float(number) => Ok(*number),
        Value::Integer(number) if number.unsigned_abs() <= EXACT => Ok(*number as f64),
        Value::Integer(number) => wrong(format!(
            "`{name}`: {number} is a whole number that would be rounded; write it with a point, as `{number}.0`"
        )),
        Value::String(text) => wrong(format!("`{name}` takes numbers, got string `{text:?}`")),
        other => wrong(format!("`{name}` takes numbers, got {}", other.type_str())),
    };
    match value {
        Value::Array(values) => values.iter().map(number).collect(),
        value => Ok(vec![number(value)?]),
    }
}

/// The file that describes a system's example, each quantity with what it means.
pub(crate) fn example(entry: &Entry) -> String {
    let mut text = String::new();
    // writing to a string does not fail
    let _ = write_example(&mut text, entry);
    text
}

fn write_example(text: &mut String, entry: &Entry) -> std::fmt::Result {
    let setup = entry.example.clone();
    let Entry { name, about, step, duration, .. } = entry;
    let rest = match &entry.file {
        Some(file) => {
            format!("Add `--description {}` to that, and numbers below where there are dots.", file.display())
        }
        None => "What is left out has the value of the system's example.".to_owned(),
    };
    writeln!(
        text,
        "# {name}: {about}.
# Run it with `coadjoint run --config <this file>`; options given there take precedence.
# {rest}

system = \"{name}\"

[run]
{:28} # the map that the step is built on: {}
method = \"standard\"          # standard, euler-a, euler-b, midpoint, verlet, …; rk4, …: `coadjoint run --help` lists all
order = 2                    # 2; 4, 6, 8 and 10 are composed of its steps, or those of \"hamilton-jacobi\"
{:28} # s; negative to go back in time
{:28} # s
every = 1                    # write the state after every so many steps
# at = [0.1, 0.25]           # or at these times, s, or every_seconds = 0.1
event = []                   # tell when a quantity is zero: \"upright = gamma_z, rising\"
# until = \"energy < 0.5\"     # end at the moment from which on this holds, or at an event of the description
quantity = []                # of your own, in tables, plots and pages: \"tilt, rad = gamma_z.acos()\"
columns = []                 # and beside it any of \"velocity\", \"euler\", \"rotvec\", \"mrp\", \"angle\"
format = \"csv\"               # csv, json or parquet
plot = false                 # draw the run too
# tolerance = 1e-12          # Taylor steps to this tolerance, in place of a method
# watch_every_step = true    # look at every step, whatever is written
# input = \"controls.csv\"     # a table of controls, beside this file; interpolation = \"cubic\", \"linear\" or \"previous\"",
        format!("retraction = \"{}\"", Retraction::Exponential.or_first_of(entry).name()),
        Retraction::of(entry).iter().map(|retraction| retraction.name()).collect::<Vec<_>>().join(" or "),
        format!("step = {step:?}"),
        format!("duration = {duration:?}"),
    )?;
    let controls = vec![0.0; setup.controls.len()];
    for (section, quantities, values) in [
        ("controls", entry.description.controls, &controls),
        ("parameters", entry.description.parameters, &setup.parameters),
        ("state", entry.description.state, &setup.state),
    ] {
        // each control is a remark: unless it is set, the system's own law chooses it
        let is_control = section == "controls";
        match is_control {
            _ if quantities.is_empty() => {}
            true => {
                writeln!(text, "\n# [controls] # to be held in place of what the system's own law chooses")?
            }
            false => writeln!(text, "\n[{section}]")?,
        }
        for (quantity, slots) in Quantity::with_ranges(quantities) {
            let (name, components) = (quantity.name, quantity.components);
            // a run asks for what has no value by itself
            let is_asked = !entry.has_example && matches!(quantity.role, Role::Parameter | Role::Advected);
            let is_remark = is_control || is_asked;
            if !quantity.doc.is_empty() && !is_control {
                writeln!(text, "# {}", quantity.doc)?;
            }
            let number = |x: &f64| if is_asked { "…".to_owned() } else { format!("{:?}", x + 0.0) };
            let list: Vec<String> = values[slots].iter().map(number).collect();
            let (list, names) = (list.join(", "), components.join(", "));
            match (is_remark, components == [""]) {
                (true, true) => writeln!(text, "# {name} = {list}")?,
                (true, false) => writeln!(text, "# {name} = [{list}] # {names}")?,
                (false, true) => writeln!(text, "{name} = {list}")?,
                (false, false) => writeln!(text, "{:28} # {names}", format!("{name} = [{list}]"))?,
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    #[test]
    fn the_example_says_what_the_system_says() {
        for entry in catalogue().entries() {
            let text = example(entry);
            let config: Config = toml::from_str(&text).expect(&text);
            assert_eq!(config.system.as_ref(), Some(&entry.name));
            assert_eq!((config.run.step, config.run.duration), (Some(entry.step), Some(entry.duration)));
            assert_eq!(config.run.method, Some(Method::Standard));
            let path = Path::new("example.toml");
            assert_eq!(config.run.order, Some(Order::Two));
            // from other numbers back to the example's
            let expected = entry.example.clone();
            let count =
                entry.description.parameters.iter().map(|quantity| quantity.components.len()).sum::<usize>();
            let mut other = entry.clone();
            let example = &mut other.example;
            example.parameters.iter_mut().take(count).chain(&mut example.state).for_each(|x| *x = 7.25);
            let mut changes = Changes::of(&other);
            config.apply(path, &mut changes).expect("its own names");
            assert_eq!(changes.setup(), &expected, "{}", entry.name);
            // the controls, which it only mentions
            let asked = text.replace("# [controls] #", "[controls] #");
            let mut lines = asked.lines().skip_while(|line| !line.starts_with("[controls]")).peekable();
            let section: Vec<&str> = lines
                .by_ref()
                .take_while(|line| !line.is_empty())
                .map(|line| line.trim_start_matches("# "))
                .collect();
            let config: Config = toml::from_str(&section.join("\n")).expect(&asked);
            config.apply(path, &mut changes).expect("its own names");
            assert!(changes.setup().controls.iter().all(|control| *control == Some(0.0)), "{}", entry.name);
        }
    }

    #[test]
    fn columns_have_the_names_of_the_command_line() {
        let columns = |text: &str| {
            let config: Result<Config, _> = toml::from_str(&format!("[run]\ncolumns = {text}"));
            config.map(|config| config.run.columns).map_err(|error| error.to_string())
        };
        use clap::ValueEnum as _;
        let names: Vec<String> = Column::value_variants().iter().map(|column| column.name()).collect();
        assert_eq!(columns(&format!("{names:?}")), Ok(Column::value_variants().to_vec()));
        let example = example(catalogue().find("heavy_top").expect("it is there"));
        let told = example.lines().find(|line| line.starts_with("columns = []")).expect("it is told");
        assert!(names.iter().all(|name| told.contains(&format!("\"{name}\""))), "{told}");
        assert!(columns("[\"speed\"]").expect_err("unknown").contains("unknown variant `speed`"));
    }

    #[test]
    fn options_of_the_command_line_are_told_where_they_belong() {
        let told = |text: &str| Config::of(text).map(drop).expect_err(text).to_string();
        for (text, reason) in [
            ("[run]\nscan = \"weight=1,2\"", "`scan` is no key: it is said each time, by `--scan`"),
            ("out = \"there\"", "`out` is no key: it is said each time, by `--out`"),
            ("[run]\nsave_every = 3", "`save_every` is no key: it is said each time, by `--save-every`"),
            (
                "[run]\nset = \"weight=1\"",
                "what `--set` sets stands below [parameters], [state] and [controls]",
            ),
            (
                "[run]\nmembers = 10",
                "`members` is no key: a file describes one run; `ensemble` takes `--members`",
            ),
            ("[run]\ntolerance = 1e-9\nmethod = \"rk4\"", "[run]: `tolerance` stands in place of `method`"),
            (
                "[run]\ninterpolation = \"linear\"",
                "[run]: `interpolation` says what is between the rows of `input`",
            ),
            ("[run]\nstpe = 1", "unknown field `stpe`"),
        ] {
            assert!(told(text).contains(reason), "{text}: {}", told(text));
        }
        let config =
            Config::of("[run]\nevery-seconds = 0.5\nwatch-every-step = true").expect("as options are");
        assert_eq!((config.run.every_seconds, config.run.watch_every_step), (Some(0.5), true));
    }

    #[test]
    fn whole_numbers_are_not_rounded() {
        let top = catalogue().find("heavy_top").expect("it is there");
        let weight = |text: &str| {
            let config: Config = toml::from_str(&format!("[parameters]\nweight = {text}")).expect(text);
            let mut changes = Changes::of(top);
            let applied = config.apply(Path::new("a.toml"), &mut changes).map_err(|error| error.to_string());
            applied.map(|()| changes.setup().parameters[3])
        };
        assert_eq!(weight("9007199254740992"), Ok(9_007_199_254_740_992.0));
        let message = weight("9007199254740993").expect_err("rounded");
        assert!(
            message
                .contains("[parameters]: `weight`: 9007199254740993 is a whole number that would be rounded"),
            "{message}"
        );
        assert!(weight("-9007199254740993").is_err());
    }
}
