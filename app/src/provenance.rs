//! What made an output: the system, its parameters, the initial state, the scheme, the step. Every file carries it, so that it can be made again
//! from itself, and so that files of different runs are told apart.

mod embedded;
mod origin;

use std::ops::ControlFlow;

use coadjoint::system::Quantity;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

#[cfg(feature = "parquet")]
pub(crate) use self::embedded::INVARIANTS;
pub use self::embedded::embed;
pub(crate) use self::embedded::{comment, interruption, read};
pub use self::origin::Origin;
use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::setting::laid_out;
use crate::simulation::{Classical, Job, Method, Order, Retraction, Setup};

/// The name of the program in what it writes.
const PROGRAM: &str = "coadjoint";

/// What made an output. As JSON on one line it is the same in files of all formats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Always `coadjoint`.
    pub program: String,
    /// The program's version.
    pub version: String,
    /// The system's name.
    pub system: String,
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
    /// How many of them.
    pub steps: u64,
    /// Steps between two rows.
    pub every: u64,
    /// What members of an ensemble differ in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<Members>,
    /// The values of which each has a run, as the command line takes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scan: Vec<String>,
}

/// What members of an ensemble differ in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Members {
    /// How many there are.
    pub members: u64,
    /// Half-widths by name, as the command line takes them.
    pub spread: Vec<String>,
    /// The seed of the random numbers.
    pub seed: u64,
    /// What is shown of them; nothing for what is shown unless asked otherwise.
    pub quantity: Vec<String>,
}

impl Provenance {
    /// Of a run.
    pub fn of_run(entry: &Entry, setup: &Setup, job: &Job, every: u64) -> Self {
        let classical = job.method.classical();
        let description = &entry.description;
        let held = setup.controls.iter().any(Option::is_some);
        let controls = if held { by_name(description.controls, &setup.controls) } else { Map::new() };
        let names = [description.parameters, description.state, description.controls];
        let units = names.into_iter().flatten().map(|quantity| (quantity.name, entry.unit(quantity.name)));
        let units = units.filter(|(_, unit)| !unit.is_empty());
        Self {
            program: PROGRAM.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            system: entry.name.to_owned(),
            digest: format!("{:08x}", digest(entry, setup, job)),
            parameters: by_name(description.parameters, &setup.parameters),
            state: by_name(description.state, &setup.state),
            controls,
            units: units.map(|(name, unit)| (name.to_owned(), json!(unit))).collect(),
            method: job.method.to_string(),
            retraction: classical.is_none().then_some(job.retraction),
            order: classical.map_or(job.order.number(), Classical::order),
            step: job.step,
            steps: job.steps,
            every,
            ensemble: None,
            scan: Vec::new(),
        }
    }

    /// As files have it.
    pub fn origin(&self) -> Origin {
        Origin(self.fields())
    }

    /// By the names of its fields.
    pub(crate) fn fields(&self) -> Map<String, Value> {
        // its maps have texts for keys
        fields(serde_json::to_value(self).unwrap_or_default())
    }

    /// What the files of the run are called: `heavy_top-midpoint-order4-cayley` with the example's numbers, step and duration; with others
    /// followed by a checksum of them all: `heavy_top-cayley-3fa9c1`.
    pub fn stem(&self, entry: &Entry, job: &Job) -> String {
        let mut stem = entry.name.to_owned();
        let side_by_side =
            (job.method, job.retraction, job.order) == (Method::Standard, Retraction::Cayley, Order::Two);
        if self.ensemble.is_none() || !side_by_side {
            if job.method != Method::Standard {
                stem += &format!("-{}", job.method.stem());
            }
            if job.order != Order::Two {
                stem += &format!("-order{}", job.order.number());
            }
            if job.method.classical().is_none() {
                stem += &format!("-{}", job.retraction.name());
            }
        }
        if self.ensemble.is_some() {
            stem += "-ensemble";
        }
        if !self.scan.is_empty() {
            stem += "-scan";
        }
        let usual = Job { step: entry.step, steps: usual_steps(entry), ..*job };
        let every = if self.ensemble.is_some() { Members::every(usual.steps) } else { 1 };
        let usual =
            Self { ensemble: self.ensemble.clone(), ..Self::of_run(entry, &entry.example, &usual, every) };
        if self.fields() != usual.fields() || self.ensemble.as_ref().is_some_and(Members::are_chosen) {
            stem += &format!("-{:06x}", crc32fast::hash(self.origin().line().as_bytes()) & 0xff_ffff);
        }
        stem
    }

    /// Parameters, initial state and controls of the run.
    ///
    /// # Errors
    /// If they are not those of this system.
    pub(crate) fn setup(&self, entry: &Entry) -> Result<Setup, Error> {
        let Setup { parameters, state, controls } = &entry.example;
        let description = &entry.description;
        // numbers that have no name are as in the example
        let list = |quantities: &[Quantity], from: &Map<String, Value>, example: &[f64]| {
            let mut numbers = listed(quantities, from)?.into_iter().collect::<Option<Vec<f64>>>()?;
            numbers.extend_from_slice(example.get(numbers.len()..)?);
            Some(numbers)
        };
        let held = match self.controls.is_empty() {
            true => Some(vec![None; controls.len()]),
            false => listed(description.controls, &self.controls),
        };
        let setup = || {
            Some(Setup {
                parameters: list(description.parameters, &self.parameters, parameters)?,
                state: list(description.state, &self.state, state)?,
                controls: held.filter(|held| held.len() == controls.len())?,
            })
        };
        setup().ok_or_else(|| {
            Error::Input(format!(
                "`{}` has other parameters, states or controls here than where this was made",
                entry.name
            ))
        })
    }

    /// The scheme, the step and the number of steps.
    ///
    /// # Errors
    /// If there is no such method or order.
    pub(crate) fn job(&self) -> Result<Job, Error> {
        let method: Method = self.method.parse().map_err(Error::Input)?;
        let order = Order::ALL.into_iter().find(|order| order.number() == self.order);
        let order = if method.classical().is_some() { Some(Order::Two) } else { order };
        Ok(Job {
            method,
            retraction: self.retraction.unwrap_or(Retraction::Exponential),
            order: order.ok_or_else(|| Error::Input(format!("there is no order {}", self.order)))?,
            step: self.step,
            steps: self.steps,
        })
    }

    /// The system's entry, which must compute what it computed when this was made.
    ///
    /// # Errors
    /// If there is no such system, or its steps have other digits.
    pub(crate) fn entry(&self, catalogue: Catalogue) -> Result<&'static Entry, Error> {
        let entry = catalogue.system(&self.system)?;
        let digest = digest(entry, &self.setup(entry)?, &self.job()?);
        if self.version != env!("CARGO_PKG_VERSION") || self.digest != format!("{digest:08x}") {
            return Err(Error::Input(format!(
                "the run was made with version {} of the program and steps of `{}` whose digits differ from those taken here",
                self.version, self.system
            )));
        }
        Ok(entry)
    }
}

impl Members {
    /// Of an ensemble that nothing was asked of.
    pub(crate) const MEMBERS: u64 = 1000;
    /// See [`MEMBERS`](Self::MEMBERS).
    pub(crate) const SEED: u64 = 1;

    /// Steps between two looks at them: 300 in all.
    pub(crate) fn every(steps: u64) -> u64 {
        (steps / 300).max(1)
    }

    /// Whether anything of them was asked for.
    fn are_chosen(&self) -> bool {
        let Self { members, spread, seed, quantity } = self;
        (*members, *seed) != (Self::MEMBERS, Self::SEED) || !spread.is_empty() || !quantity.is_empty()
    }
}

/// The number of steps of the system's example.
fn usual_steps(entry: &Entry) -> u64 {
    (entry.duration / entry.step.abs()).round() as u64
}

/// A checksum of the bits of three steps: of states, energies and Casimirs. A system with another potential has another one, whatever it is
/// called and wherever its source is.
pub(crate) fn digest(entry: &Entry, setup: &Setup, job: &Job) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let job = Job { steps: 3, ..*job };
    // where a step cannot be taken, what was before it counts: the run itself tells of it
    let _ = entry.simulate(setup, &job, None, &|index| index + 1, &mut |sample| {
        for number in sample.state.iter().chain(sample.casimirs).chain([&sample.energy]) {
            hasher.update(&number.to_bits().to_le_bytes());
        }
        ControlFlow::Continue(())
    });
    hasher.finalize()
}

/// The fields of what is an object.
fn fields(object: Value) -> Map<String, Value> {
    match object {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

pub(crate) fn by_name(quantities: &[Quantity], values: &[impl Serialize]) -> Map<String, Value> {
    let named = laid_out(quantities).map(|(quantity, slots)| {
        let value = match &values[slots] {
            [scalar] => json!(scalar),
            components => json!(components),
        };
        (quantity.name.to_owned(), value)
    });
    named.collect()
}

/// The numbers of all quantities in their order, None for null; None in all if one is missing, or is no number.
fn listed(quantities: &[Quantity], from: &Map<String, Value>) -> Option<Vec<Option<f64>>> {
    let number = |value: &Value| match value {
        Value::Null => Some(None),
        value => value.as_f64().map(Some),
    };
    let mut list = Vec::new();
    for (quantity, slots) in laid_out(quantities) {
        match from.get(quantity.name)? {
            Value::Array(values) if values.len() == slots.len() => {
                list.extend(values.iter().map(number).collect::<Option<Vec<_>>>()?);
            }
            value if slots.len() == 1 => list.push(number(value)?),
            _ => return None,
        }
    }
    Some(list)
}
