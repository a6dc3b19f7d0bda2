//! Settings of a run: scheme, step, parameters, initial state, spreads and scans, by the names of a system's
//! quantities.

mod assign;
mod column;
pub(crate) mod config;
mod expression;
mod form;
mod method;
mod moments;
mod names;
pub mod random;
mod rotation;
mod scan;
mod spread;
mod transport;

use clap::ValueEnum as _;
use coadjoint::erased::{self, RetractionKind};
use coadjoint::{ParameterError, Scheme};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

pub(crate) use assign::{Changes, assignments};
pub use column::Column;
pub(crate) use expression::{condition, margin, observable, observables};
pub(crate) use method::MethodParser;
pub use method::{Classical, Method, Tolerance};
pub use moments::Moments;
pub(crate) use moments::{Times, Until, WatchedEvent};
pub(crate) use names::Names;
pub(crate) use scan::Scan;
pub use spread::{SampledRange, Variation};

use crate::catalogue::Entry;
pub use crate::catalogue::Setup;
use crate::error::SetupError;
use crate::units::exact;

/// Lists the retractions of the generator's table.
macro_rules! retractions {
    ($($(#[$_doc:meta])* $name:ident {
        is_odd: $_is_odd:literal,
        is_matrix_function: $_is_matrix_function:literal,
        spoken: $_spoken:literal,
        word: $word:tt,
        short: $short:tt,
        about: $about:tt
    })*) => {
        /// The map from the Lie algebra to the group that a step is built on.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Retraction {
            $(#[doc = $about] #[value(alias = $short)] $name,)*
        }

        impl Retraction {
            /// All of them.
            pub const ALL: [Retraction; [$($word),*].len()] = [$(Retraction::$name),*];

            /// Its name on the command line and in file names.
            pub fn name(self) -> &'static str {
                match self { $(Retraction::$name => $word,)* }
            }

            /// The library's value.
            pub(crate) fn map(self) -> RetractionKind {
                match self { $(Retraction::$name => RetractionKind::$name,)* }
            }
        }
    };
}
coadjoint_macros::retractions!(retractions);

impl Retraction {
    /// The ones with which most systems have steps.
    pub const COMMON: [Retraction; 2] = [Retraction::Exponential, Retraction::Cayley];

    /// Lists those with which there are steps of this system.
    pub fn of(entry: &Entry) -> Vec<Self> {
        let system = entry.system(&entry.example.parameters);
        let is_there = |retraction: &Self| {
            let first = Scheme::member(retraction.map(), 0, 1);
            erased::Stepper::new(system.clone(), &first, entry.step).is_ok()
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }

    /// Chooses this one, or where there are no steps with it the first one with which there are.
    pub(crate) fn or_first_of(self, entry: &Entry) -> Self {
        let known = Self::of(entry);
        if known.contains(&self) { self } else { known.first().copied().unwrap_or(self) }
    }
}

/// The order asked for: 2 for the method itself, higher ones of Hamilton–Jacobi steps, or composed of the method's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub enum Order {
    /// The method itself.
    #[default]
    #[value(name = "2")]
    Two = 2,
    /// From one equation, or composed: five steps in one.
    #[value(name = "4")]
    Four = 4,
    /// From one equation, or composed: nine steps in one.
    #[value(name = "6")]
    Six = 6,
    /// From one equation, or composed: seventeen steps in one.
    #[value(name = "8")]
    Eight = 8,
    /// From one equation, or composed: thirty-five steps in one.
    #[value(name = "10")]
    Ten = 10,
}

impl Order {
    /// All of them.
    pub const ALL: [Order; 5] = [Order::Two, Order::Four, Order::Six, Order::Eight, Order::Ten];

    /// As a number.
    pub fn number(self) -> u32 {
        self as u32
    }
}

impl TryFrom<u32> for Order {
    type Error = String;

    fn try_from(number: u32) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|order| order.number() == number);
        known.ok_or_else(|| format!("order must be 2, 4, 6, 8 or 10, got {number}"))
    }
}

impl From<Order> for u32 {
    fn from(order: Order) -> u32 {
        order.number()
    }
}

/// The scheme, the step and the number of steps of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The scheme's method.
    pub method: Method,
    /// The scheme's retraction; of no meaning to a classical method.
    pub retraction: Retraction,
    /// The scheme's order; that of the method itself where steps of it cannot be composed.
    pub order: Order,
    /// The step, s.
    pub step: f64,
    /// The number of steps of this length.
    pub steps: u64,
    /// The length of a shorter step behind them, which leads to the end of the run, s; 0 for none.
    pub rest: f64,
}

impl Job {
    /// Counts the steps that lead to a time, and tells how much is left behind them, s.
    ///
    /// # Errors
    /// If there is no such run: the message says why.
    pub fn steps_to(duration: f64, step: f64) -> Result<(u64, f64), SetupError> {
        /// Beyond this, step numbers are no longer exact in f64, and no run would finish.
        const MOST: f64 = 9e15;

        if !(step.is_finite() && step != 0.0) {
            return Err(SetupError::new(format!("`--step` must be finite and not zero, got {step}")));
        }
        if !(duration.is_finite() && duration >= 0.0) {
            return Err(SetupError::new(format!(
                "`--duration` must be finite and not negative, got {duration} (a negative `--step` goes back in time)"
            )));
        }
        let exact = duration / step.abs();
        if exact > MOST {
            let reason = format!("{duration} s in steps of {step} s are {exact:.1e} steps: too many");
            return Err(SetupError::new(reason));
        }
        // what is no more than the rounding of the quotient is nothing
        if (exact - exact.round()).abs() <= (4.0 * f64::EPSILON * (exact + 1.0)).min(0.25) {
            return Ok((exact.round() as u64, 0.0));
        }
        Ok((exact as u64, duration - exact.floor() * step.abs()))
    }

    /// Counts all steps, with the shorter one at the end.
    pub fn total(&self) -> u64 {
        self.steps + u64::from(self.rest != 0.0)
    }

    /// Tells how long the run is, s.
    pub fn duration(&self) -> f64 {
        self.steps as f64 * self.step.abs() + self.rest
    }

    /// A time of the run: its end where it is that but for rounding.
    pub(crate) fn within(&self, time: f64) -> f64 {
        let end = self.duration();
        let is_end = (time.abs() - end).abs() <= 4.0 * f64::EPSILON * end;
        if is_end { end.copysign(time) } else { time }
    }

    /// Tells whether members of an ensemble are stepped side by side, in the processor's registers: with the standard
    /// step, and what is composed of it.
    pub fn is_side_by_side(&self) -> bool {
        self.method == Method::Standard && Retraction::COMMON.contains(&self.retraction)
    }

    /// Tells the order of its step.
    pub fn order_of_step(&self, entry: &Entry) -> u32 {
        match self.method {
            Method::Classical(classical) => classical.order(),
            Method::Taylor(tolerance) => {
                let system = entry.system(&entry.example.parameters);
                erased::Adaptive::new(system, tolerance.value()).map_or(0, |steps| steps.order() as u32)
            }
            Method::RightLift => 2,
            method if method.is_symmetric() => self.order.number(),
            method => {
                let scheme = method.base(self.retraction.map(), self.order);
                scheme.map_or(1, |scheme| scheme.properties(&entry.description).order)
            }
        }
    }

    /// Writes system and scheme: `heavy_top, midpoint, cayley, order 4, h = 0.01 s`.
    pub fn title(&self, entry: &Entry) -> String {
        let mut parts = vec![entry.name.clone()];
        if self.method != Method::Standard {
            parts.push(self.method.to_string());
        }
        if self.method.has_retraction() {
            parts.push(self.retraction.name().to_owned());
        }
        if self.order != Order::Two {
            parts.push(format!("order {}", self.order.number()));
        }
        parts.push(format!("h = {} s", exact(self.step)));
        parts.join(", ")
    }
}

/// A format of trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// A header naming each column, then a line per sample.
    Csv,
    /// One object: system, parameters, columns, rows, invariants.
    Json,
    /// Columns of doubles, for tables of many millions of rows; in programs that are built with the feature `parquet`.
    Parquet,
}

impl Format {
    /// Names the extension of such files.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Parquet => "parquet",
        }
    }

    /// Checks that this program writes it.
    pub(crate) fn checked(self) -> Result<Self, SetupError> {
        match self {
            Format::Parquet if !cfg!(feature = "parquet") => {
                Err(SetupError::new("this program was built without `--features parquet`"))
            }
            _ => Ok(self),
        }
    }

    /// Finds the format of files with this extension.
    pub(crate) fn of_extension(extension: &str) -> Option<Self> {
        Self::from_str(extension, false).ok()
    }
}

/// Finds the standard scheme of order 2 of a system with a retraction: `euler-a` or `verlet`.
pub fn standard(entry: &Entry, retraction: Retraction) -> Method {
    match Scheme::Standard(retraction.map()).resolved(entry.description.invariant) {
        Scheme::StormerVerlet(_) => Method::Verlet,
        _ => Method::EULER_A,
    }
}

/// Checks parameters; returns a note where valid ones are unphysical, unless they are the example's.
///
/// # Errors
/// If no stepper can be built with them.
pub fn check(entry: &Entry, setup: &Setup) -> Result<Option<String>, ParameterError> {
    entry.system(&setup.parameters).validate()?;
    let inertia = (entry.body_inertia)(&setup.parameters);
    let is_own = inertia == (entry.body_inertia)(&entry.example.parameters);
    Ok(inertia.filter(|_| !is_own).and_then(|inertia| triangle_note(&inertia)))
}

/// The moments of a body of mass satisfy the triangle inequality: each is at most the sum of the other two.
fn triangle_note(inertia: &Matrix3<f64>) -> Option<String> {
    let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [small, middle, large] = moments;
    (large > (small + middle) * (1.0 + 1e-12)).then(|| {
        format!(
            "no body of mass has principal moments of inertia {small}, {middle}, {large}: \
             the largest exceeds the sum of the others"
        )
    })
}

#[cfg(test)]
mod tests;
