//! `NAME.run.json`, which stands beside `NAME.csv` and the like: what made them, so that they can be made again and
//! files of different runs are told apart.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use coadjoint::system::Quantity;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::path::{followed, is_special, is_stdout, read_file};
use crate::catalogue::quantities::components;
use crate::catalogue::{Entry, Interpolation, program, unit};
use crate::error::{FileError, SetupError};
use crate::setup::{Classical, Column, Job, Method, Order, Retraction, Setup, assignments};
use crate::simulate::simulate;

/// The origin of a run's files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provenance {
    /// The program's name.
    pub program: String,
    /// The program's version.
    pub version: String,
    /// That of coadjoint.
    pub coadjoint: String,
    /// The system's name.
    pub system: String,
    /// The file that describes it, where it is not compiled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<PathBuf>,
    /// A checksum of the first steps' bits: of what the system computes, whatever it is called.
    pub digest: String,
    /// Parameters by their names: a number, or a list of the components.
    pub parameters: Map<String, Value>,
    /// The initial state by the names of its quantities.
    pub state: Map<String, Value>,
    /// Controls by their names where any are held, null where the system's own law chooses.
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    pub controls: Map<String, Value>,
    /// Units of all these, where they are no pure numbers.
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    pub units: Map<String, Value>,
    /// The method, as the command line takes it.
    pub method: String,
    /// The retraction; a classical method has none.
    pub retraction: Option<Retraction>,
    /// The order asked for, or a classical method's own.
    pub order: u32,
    /// The step, s.
    pub step: f64,
    /// The number of steps.
    pub steps: u64,
    /// How long the run is, s; where whole steps do not lead there, the last one is shorter.
    pub duration: f64,
    /// Steps between two rows.
    pub every: u64,
    /// Further columns of its table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<Column>,
    /// Whether errors are followed at every step between them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub watch: bool,
    /// The table of controls that are functions of time, and how it is interpolated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input: Option<(PathBuf, Interpolation)>,
    /// Quantities of a user's own, as the command line takes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantity: Vec<String>,
    /// The condition that ends it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// Times at which states are written in place of steps, s.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<f64>,
    /// The time between two of them, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every_seconds: Option<f64>,
    /// Events, as the command line takes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub event: Vec<String>,
    /// The differences between members of an ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<Members>,
    /// The values of which each has a run, as the command line takes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scan: Vec<String>,
    /// The assignments of its command; none for the example's numbers.
    #[serde(skip)]
    pub(crate) assignments: Vec<String>,
}

/// The differences between members of an ensemble.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Members {
    /// Their number.
    pub members: u64,
    /// Half-widths by name, as the command line takes them.
    pub spread: Vec<String>,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The quantities that are shown; empty for the momentum.
    pub quantity: Vec<String>,
}

impl Provenance {
    /// Describes a run.
    pub fn of_run(entry: &Entry, setup: &Setup, job: &Job, every: u64) -> Self {
        let classical = job.method.classical();
        let description = &entry.description;
        let held = setup.controls.iter().any(Option::is_some);
        let controls = if held { by_name(description.controls, &setup.controls) } else { Map::new() };
        let names = [description.parameters, description.state, description.controls];
        let whole = names.into_iter().flatten().map(|quantity| (quantity.name.to_owned(), unit(quantity)));
        let parts = names.into_iter().flat_map(components).filter(|part| unit(part.quantity).is_empty());
        let own = entry.observables.iter().map(|own| (own.name.clone(), &*own.unit));
        let units = whole.chain(parts.map(|part| (part.name, part.unit)));
        let units = units.chain([("energy".to_owned(), entry.energy_unit)]).chain(own);
        let units = units.filter(|(_, unit)| !unit.is_empty());
        Self {
            program: program()[0].to_owned(),
            version: program()[1].to_owned(),
            coadjoint: COADJOINT.to_owned(),
            system: entry.name.clone(),
            description: entry.file.clone(),
            digest: format!("{:08x}", digest(entry, setup, job)),
            parameters: by_name(description.parameters, &setup.parameters),
            state: by_name(description.state, &setup.state),
            controls,
            units: units.map(|(name, unit)| (name, json!(unit))).collect(),
            method: job.method.to_string(),
            retraction: classical.is_none().then_some(job.retraction),
            order: classical.map_or(job.order.number(), Classical::order),
            step: job.step,
            steps: job.total(),
            duration: job.duration(),
            every,
            input: setup.input.as_ref().map(|input| (input.file.clone(), input.interpolation)),
            columns: Vec::new(),
            watch: false,
            quantity: Vec::new(),
            until: None,
            at: Vec::new(),
            every_seconds: None,
            event: Vec::new(),
            ensemble: None,
            scan: Vec::new(),
            assignments: if *setup == entry.example { Vec::new() } else { assignments(entry, setup) },
        }
    }

    /// Describes the origin of its files.
    pub fn origin(&self) -> FileOrigin {
        FileOrigin(self.fields()).with("command", self.command().into())
    }

    /// Writes the command that makes it, behind the program's name.
    fn command(&self) -> String {
        let kind = if self.ensemble.is_some() { "ensemble" } else { "run" };
        let mut command = format!("{kind} {} --method {}", self.system, self.method);
        let mut option = |name: &str, value: &dyn std::fmt::Display| {
            let value = value.to_string();
            // one word for a shell
            let is_plain = |letter: char| letter.is_alphanumeric() || "_-+=.,:/%".contains(letter);
            let quote = if value.chars().all(is_plain) { "" } else { "'" };
            command += &format!(" --{name} {quote}{value}{quote}");
        };
        self.description.iter().for_each(|file| option("description", &file.display()));
        if let Some(retraction) = self.retraction {
            option("retraction", &retraction.name());
            option("order", &self.order);
        }
        option("step", &self.step);
        option("duration", &self.duration);
        if let Some(Members { members, spread, seed, quantity }) = &self.ensemble {
            option("members", members);
            option("seed", seed);
            spread.iter().for_each(|spread| option("spread", spread));
            quantity.iter().for_each(|quantity| option("quantity", quantity));
        }
        if self.every != 1 {
            option("every", &self.every);
        }
        if !self.columns.is_empty() {
            option("columns", &self.columns.iter().map(|column| column.name()).collect::<Vec<_>>().join(","));
        }
        if let Some((file, interpolation)) = &self.input {
            option("input", &file.display());
            if *interpolation != Interpolation::default() {
                option(
                    "interpolation",
                    &interpolation
                        .to_possible_value()
                        .map_or(String::new(), |name| name.get_name().to_owned()),
                );
            }
        }
        self.quantity.iter().for_each(|quantity| option("quantity", quantity));
        self.until.iter().for_each(|until| option("until", until));
        if !self.at.is_empty() {
            option("at", &self.at.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        }
        self.every_seconds.iter().for_each(|every| option("every-seconds", every));
        self.event.iter().for_each(|event| option("event", event));
        self.scan.iter().for_each(|scan| option("scan", scan));
        self.assignments.iter().for_each(|assignment| option("set", assignment));
        if self.watch {
            command += " --watch-every-step";
        }
        command
    }

    /// Lists its fields by their names.
    pub(crate) fn fields(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            // its maps have texts for keys
            _ => Map::new(),
        }
    }

    /// Names the files of the run: `heavy_top-midpoint-order4-cayley` with the example's numbers, step and
    /// duration; with others followed by a checksum of them all: `heavy_top-cayley-3fa9c1`.
    pub fn stem(&self, entry: &Entry, job: &Job) -> String {
        let mut stem = entry.name.clone();
        let usual = (Method::Standard, Retraction::Exponential.or_first_of(entry), Order::Two);
        if self.ensemble.is_none() || (job.method, job.retraction, job.order) != usual {
            if job.method != Method::Standard {
                stem += &format!("-{}", job.method.stem());
            }
            if job.order != Order::Two {
                stem += &format!("-order{}", job.order.number());
            }
            if job.method.has_retraction() {
                stem += &format!("-{}", job.retraction.name());
            }
        }
        if self.ensemble.is_some() {
            stem += "-ensemble";
        }
        if !self.scan.is_empty() {
            stem += "-scan";
        }
        let (steps, rest) = Job::steps_to(entry.duration, entry.step).unwrap_or_default();
        let usual = Job { step: entry.step, steps, rest, ..*job };
        let every = if self.ensemble.is_some() { Members::every(usual.steps) } else { 1 };
        let usual =
            Self { ensemble: self.ensemble.clone(), ..Self::of_run(entry, &entry.example, &usual, every) };
        if self.fields() != usual.fields() || self.ensemble.as_ref().is_some_and(Members::are_chosen) {
            let line = json!(self.fields()).to_string();
            stem += &format!("-{:06x}", crc32fast::hash(line.as_bytes()) & 0xff_ffff);
        }
        stem
    }
}

impl Members {
    /// The members of an ensemble that nothing was asked of.
    pub(crate) const MEMBERS: u64 = 1000;
    /// See [`MEMBERS`](Self::MEMBERS).
    pub(crate) const SEED: u64 = 1;

    /// Steps between two looks at them: 300 in all.
    pub(crate) fn every(steps: u64) -> u64 {
        (steps / 300).max(1)
    }

    /// Tells whether anything of them was asked for.
    fn are_chosen(&self) -> bool {
        let Self { members, spread, seed, quantity } = self;
        (*members, *seed) != (Self::MEMBERS, Self::SEED) || !spread.is_empty() || !quantity.is_empty()
    }
}

/// A checksum of the bits of three steps: of states, energies and Casimirs. A system with another potential has another
/// one, whatever it is called and wherever its source is.
pub(crate) fn digest(entry: &Entry, setup: &Setup, job: &Job) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let input = setup.input.iter().flat_map(|input| input.numbers());
    input.for_each(|number| hasher.update(&number.to_bits().to_le_bytes()));
    let job = Job { steps: 3, rest: 0.0, ..*job };
    // where a step cannot be taken, what was before it counts: the run itself tells of it
    let _ = simulate(entry, setup, &job, None, &|index| index + 1, &mut |sample| {
        for number in sample.state.iter().chain(sample.casimirs).chain([&sample.energy]) {
            hasher.update(&number.to_bits().to_le_bytes());
        }
        ControlFlow::Continue(())
    });
    hasher.finalize()
}

pub(crate) fn by_name(quantities: &[Quantity], values: &[impl Serialize]) -> Map<String, Value> {
    let named = Quantity::with_ranges(quantities).map(|(quantity, slots)| {
        let value = match &values[slots] {
            [scalar] => json!(scalar),
            components => json!(components),
        };
        (quantity.name.to_owned(), value)
    });
    named.collect()
}

/// The origin of files: a run of a system ([`Provenance`]), or a command. Files of one origin may replace each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileOrigin(Map<String, Value>);

impl FileOrigin {
    /// Describes a command, as it can be typed again behind the program's name: `figures 6.2`.
    pub fn of_command(command: &str) -> Self {
        let [program, version] = program();
        let origin = Self(Map::new()).with("program", program.into()).with("version", version.into());
        origin.with("coadjoint", COADJOINT.into()).with("command", command.into())
    }

    /// Adds one more thing to know of it.
    #[must_use]
    pub fn with(mut self, name: &str, value: Value) -> Self {
        self.0.insert(name.to_owned(), value);
        self
    }

    /// Lists its fields by their names.
    pub fn fields(&self) -> &Map<String, Value> {
        &self.0
    }

    /// Tells whether it is a run.
    pub(crate) fn is_run(&self) -> bool {
        self.0.contains_key("digest")
    }

    /// Reads the command.
    pub(crate) fn command(&self) -> &str {
        self.0.get("command").and_then(Value::as_str).unwrap_or_default()
    }

    /// Splits the command into words, as a shell does.
    pub(crate) fn words(&self) -> Vec<String> {
        let parts = self.command().split('\'').enumerate();
        let words = parts.flat_map(|(k, part)| match k % 2 {
            0 => part.split_whitespace().collect(),
            _ => vec![part],
        });
        words.map(str::to_owned).collect()
    }

    /// Checks that a run takes the steps here that it took when its files were made.
    ///
    /// # Errors
    /// If they have other digits.
    pub(crate) fn check_digits(&self, entry: &Entry, setup: &Setup, job: &Job) -> Result<(), SetupError> {
        let text = |name: &str| self.0.get(name).and_then(Value::as_str).unwrap_or_default();
        let version = text("coadjoint");
        if version == COADJOINT && text("digest") == format!("{:08x}", digest(entry, setup, job)) {
            return Ok(());
        }
        let name = &entry.name;
        let reason = format!(
            "the run was made with version {version} of coadjoint and steps of `{name}` whose digits differ from those \
             taken here"
        );
        Err(SetupError::new(reason))
    }

    /// Says how another one differs.
    pub(crate) fn difference(&self, other: &Self) -> String {
        if !self.is_run() || !other.is_run() {
            return format!("was made by `{}`", other.command());
        }
        let names: BTreeSet<&str> = self.0.keys().chain(other.0.keys()).map(String::as_str).collect();
        let differs = |name: &&str| *name != "command" && self.0.get(*name) != other.0.get(*name);
        let names: Vec<&str> = names.into_iter().filter(differs).collect();
        format!("is of a run with another {}", names.join(", "))
    }
}

/// The part of a run that a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    /// Nothing is known: it is about to be put in its place.
    Begun,
    /// The beginning, up to an interruption after this many steps.
    Interrupted(u64),
    /// That of so many members of an ensemble.
    Members(u64),
    /// All of it.
    Complete,
}

/// The content of `NAME.run.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunJson {
    #[serde(flatten)]
    pub(super) origin: FileOrigin,
    /// For each file `complete`, or how much of the run it holds.
    files: BTreeMap<String, String>,
    /// How large the error of its trajectory is, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) error_estimate: Option<String>,
    /// Where a condition ended it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) ended: Option<Value>,
}

/// The content of the place of a file's `NAME.run.json`.
#[derive(Debug)]
pub(super) enum Beside {
    Nothing,
    /// A file that this program did not write.
    Foreign,
    Ours(RunJson),
}

/// The version whose steps runs take.
const COADJOINT: &str = env!("CARGO_PKG_VERSION");

/// No description of a run is longer.
const MOST: u64 = 1 << 24;

/// The status of whole files.
const COMPLETE: &str = "complete";

impl RunJson {
    /// Begins one of no files yet.
    pub(super) fn of(origin: FileOrigin) -> Self {
        Self { origin, files: BTreeMap::new(), error_estimate: None, ended: None }
    }

    /// Reads what stands beside a file, and tells where that is.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn beside(path: &Path) -> Result<(PathBuf, Beside), FileError> {
        let place = followed(path).unwrap_or_else(|_| path.to_owned()).with_extension("run.json");
        if is_stdout(path) || is_special(path) {
            return Ok((place, Beside::Nothing));
        }
        let text = match read_file(&place, MOST) {
            Ok(text) => text,
            Err(error) if [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory].contains(&error.kind()) => {
                return Ok((place, Beside::Nothing));
            }
            Err(source) => return Err(FileError::read(&place)(source)),
        };
        Ok((place, Self::parse(&text).map_or(Beside::Foreign, Beside::Ours)))
    }

    fn parse(text: &[u8]) -> Option<Self> {
        let found: Self = serde_json::from_slice(text).ok()?;
        let is_ours = found.origin.0.contains_key("coadjoint");
        (is_ours && !found.origin.command().is_empty()).then_some(found)
    }

    /// Writes its content.
    pub(super) fn text(&self) -> String {
        format!("{:#}\n", json!(self))
    }

    /// Tells whether it speaks of a file.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.files.contains_key(&name(path))
    }

    /// Tells whether one of its files is there.
    pub(super) fn is_of_files_beside(&self, place: &Path) -> bool {
        self.files.keys().any(|name| place.with_file_name(name).exists())
    }

    /// Tells whether a file holds all of the run.
    pub(super) fn is_complete(&self, path: &Path) -> bool {
        self.files.get(&name(path)).is_some_and(|status| status == COMPLETE)
    }

    /// Sets how much of the run a file holds.
    pub(super) fn set(&mut self, path: &Path, status: Status) {
        let steps = self.origin.0.get("steps").and_then(Value::as_u64).unwrap_or(0);
        let words = match status {
            Status::Begun => "begun".to_owned(),
            Status::Interrupted(after) => format!("interrupted after {after} of {steps} steps"),
            Status::Members(done) => {
                let all = self.origin.0.get("ensemble").and_then(|of| of["members"].as_u64()).unwrap_or(0);
                format!("interrupted after {done} of {all} members")
            }
            Status::Complete => COMPLETE.to_owned(),
        };
        self.files.insert(name(path), words);
    }
}

fn name(path: &Path) -> String {
    let place = followed(path).unwrap_or_else(|_| path.to_owned());
    place.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads what made a file, or what a `NAME.run.json` says, and whether the file's run was interrupted.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn read(path: &Path) -> Result<Option<(FileOrigin, bool)>, FileError> {
    if path.to_string_lossy().ends_with(".run.json") {
        let text = read_file(path, MOST).map_err(FileError::read(path))?;
        return Ok(RunJson::parse(&text).map(|found| (found.origin, false)));
    }
    std::fs::metadata(path).map_err(FileError::read(path))?;
    Ok(match RunJson::beside(path)?.1 {
        Beside::Ours(found) if found.has(path) => {
            let interrupted = !found.is_complete(path);
            Some((found.origin, interrupted))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    fn provenance() -> FileOrigin {
        let entry = catalogue().system("heavy_top").expect("it is there");
        let (retraction, order) = (Retraction::Cayley, Order::Four);
        let job = Job { method: Method::MIDPOINT, retraction, order, step: 0.1 + 0.2, steps: 9, rest: 0.0 };
        let mut setup = entry.example.clone();
        setup.parameters[3] = 9.806_650_000_000_001;
        setup.state[4] = -0.0;
        Provenance::of_run(entry, &setup, &job, 3).origin()
    }

    #[test]
    fn what_is_put_in_is_found() {
        let origin = provenance();
        let command = origin.command();
        assert!(
            command.starts_with(
                "run heavy_top --method midpoint --retraction cayley --order 4 --step 0.30000000000000004"
            ) && command.contains("--every 3 --set inertia=1.0,10.0,100.0 --set weight=9.806650000000001"),
            "{command}"
        );
        assert!(command.contains("--set momentum=-0.0,1.0,1.0"), "{command}");
        let quoted = FileOrigin::of_command("ensemble top --spread 'weight=1 N' --seed 1");
        assert_eq!(quoted.words(), ["ensemble", "top", "--spread", "weight=1 N", "--seed", "1"]);
        assert_eq!(origin.words().join(" "), command);
        let entry = catalogue().system("heavy_top").expect("it is there");
        let job = Job {
            method: Method::MIDPOINT,
            retraction: Retraction::Cayley,
            order: Order::Four,
            step: 0.1 + 0.2,
            steps: 9,
            rest: 0.0,
        };
        assert!(origin.check_digits(entry, &entry.example, &job).is_err());
        let run = origin.clone();
        let mut json = RunJson::of(origin);
        let (whole, cut) = (Path::new("out/a.csv"), Path::new("out/a.svg"));
        json.set(whole, Status::Complete);
        json.set(cut, Status::Interrupted(4));
        let read = RunJson::parse(json.text().as_bytes()).expect("its own text");
        assert_eq!(read, json);
        assert_eq!(read.origin, run);
        assert!(read.is_complete(whole) && read.has(cut) && !read.is_complete(cut));
        assert!(json.text().contains("\"a.svg\": \"interrupted after 4 of 9 steps\""), "{}", json.text());
    }

    #[test]
    fn what_a_command_made_says_so() {
        let origin = FileOrigin::of_command("figures 6.2").with("note", "<b>".into());
        assert_eq!((origin.command(), origin.is_run()), ("figures 6.2", false));
        let read = RunJson::parse(RunJson::of(origin.clone()).text().as_bytes()).expect("its own text");
        assert_eq!(read.origin, origin);
        let run = provenance();
        assert_eq!(run.difference(&origin), "was made by `figures 6.2`");
        assert_eq!(run.difference(&run.clone().with("steps", 10.into())), "is of a run with another steps");
    }

    #[test]
    fn files_of_others_say_nothing() {
        let text = RunJson::of(provenance()).text();
        let stranger = text.replace("\"coadjoint\": \"", "\"another\": \"");
        assert_ne!(text, stranger);
        for content in
            ["", "{}", "{\"program\": \"coadjoint\", \"files\": {}}", &stranger, &text[..text.len() / 2]]
        {
            assert_eq!(RunJson::parse(content.as_bytes()), None, "{content}");
        }
    }
}
