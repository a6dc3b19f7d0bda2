//! What is looked at within the steps of a run: times at which its state is written, and events.

use coadjoint::{Event, erased};
use serde::{Deserialize, Serialize};

use super::{Job, condition, margin, observable};
use crate::catalogue::suggest::closest;
use crate::catalogue::{Entry, Observable};
use crate::error::SetupError;

/// What is looked at within the steps of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Times at which the state is written, s; in place of steps, where there are any.
    pub at: Vec<f64>,
    /// The time between two states that are written, s; likewise.
    pub every_seconds: Option<f64>,
    /// Events, as the command line takes them.
    pub event: Vec<String>,
}

/// Times at which the state of a run is written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Times {
    /// These.
    At(Vec<f64>),
    /// Evenly spaced from 0 on, so many.
    Every(f64, u64),
}

impl Moments {
    /// Lists the times at which states are written; none where steps are.
    ///
    /// # Errors
    /// If the run has no such times.
    pub(crate) fn times(&self, job: &Job) -> Result<Option<Times>, SetupError> {
        if let Some(every) = self.every_seconds {
            if !(every.is_finite() && every > 0.0) {
                let reason = format!("`--every-seconds` must be finite and positive, got {every}");
                return Err(SetupError::new(reason));
            }
            let (count, _) = Job::steps_to(job.duration(), every)
                .map_err(|_| SetupError::new(format!("`--every-seconds {every}` are too many times")))?;
            return Ok(Some(Times::Every(every.copysign(job.step), count + 1)));
        }
        let end = job.duration();
        let ahead = |time: f64| if job.step < 0.0 { -time } else { time };
        let is_within = |time: f64| (0.0..=end * (1.0 + 4.0 * f64::EPSILON)).contains(&ahead(time));
        if let Some(other) = self.at.iter().find(|time| !is_within(**time)) {
            let end = ahead(end);
            return Err(SetupError::new(format!("`--at {other}`: the run goes from 0 to {end} s")));
        }
        if let Some(pair) = self.at.windows(2).find(|pair| ahead(pair[1]) <= ahead(pair[0])) {
            return Err(SetupError::new(format!(
                "`--at`: {} does not come behind {}: times stand in the order of the run",
                pair[1], pair[0]
            )));
        }
        Ok((!self.at.is_empty()).then(|| Times::At(self.at.clone())))
    }

    /// Tells whether times are written in place of steps.
    pub(crate) fn are_rows(&self) -> bool {
        self.every_seconds.is_some() || !self.at.is_empty()
    }

    /// Reads the events.
    ///
    /// # Errors
    /// As [`observable`], or if two have one name.
    pub(crate) fn events(&self, entry: &Entry) -> Result<Vec<WatchedEvent>, SetupError> {
        let events = self.event.iter().map(|text| WatchedEvent::parse(entry, text));
        let events = events.collect::<Result<Vec<_>, _>>()?;
        let is_second = |&k: &usize| events[..k].iter().any(|before| before.name() == events[k].name());
        match (0..events.len()).find(is_second) {
            Some(k) => Err(SetupError::new(format!("there are two events `{}`", events[k].name()))),
            None => Ok(events),
        }
    }
}

impl Times {
    /// Counts them.
    pub(crate) fn count(&self) -> u64 {
        match self {
            Self::At(times) => times.len() as u64,
            Self::Every(_, count) => *count,
        }
    }

    /// Lists them.
    pub(crate) fn iter(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        match self {
            Self::At(times) => Box::new(times.iter().copied()),
            Self::Every(every, count) => Box::new((0..*count).map(move |k| k as f64 * every)),
        }
    }
}

/// The error of a word that is no quantity, with the events of the description, of which it may be one.
fn or_an_event(entry: &Entry, body: &str, error: SetupError) -> SetupError {
    let names = || entry.description.events.iter().map(|(name, _)| *name);
    let (word, known) = (body.trim(), names().collect::<Vec<_>>().join("`, `"));
    match closest(word, names()) {
        _ if known.is_empty() || syn::parse_str::<syn::Ident>(word).is_err() => error,
        Some(meant) => SetupError::new(format!(
            "`{}` has no event `{word}`; did you mean `{meant}`? (events: `{known}`; or write an expression of its quantities)",
            entry.name
        )),
        None => SetupError::new(format!("{error}; events: `{known}`")),
    }
}

/// An event: a quantity, and which of its zeros count.
#[derive(Clone, Debug)]
pub(crate) struct WatchedEvent {
    pub(crate) quantity: Observable,
    pub(crate) event: Event,
    /// Its place among those of the description, if it is one of them.
    pub(crate) place: Option<usize>,
}

impl WatchedEvent {
    /// Reads `EXPRESSION`, `NAME = EXPRESSION`, or the name of an event of the description, each with `, rising` or `, falling` behind it.
    fn parse(entry: &Entry, text: &str) -> Result<Self, SetupError> {
        if let Some(described) = Self::described(entry, text) {
            return Ok(described);
        }
        let (body, direction) = with_direction(text);
        let quantity = observable(entry, body).map_err(|error| or_an_event(entry, body, error))?;
        Ok(Self { quantity, event: direction.unwrap_or(Event::any()), place: None })
    }

    /// The event of the description of this name.
    fn described(entry: &Entry, text: &str) -> Option<Self> {
        let (body, direction) = with_direction(text);
        let mut described = entry.description.events.iter().enumerate();
        let (place, (name, event)) = described.find(|(_, (name, _))| *name == body.trim())?;
        let of = move |system: &dyn erased::System, state: &[f64], time: f64, control: &[f64]| {
            system.event(place, state, time, control)
        };
        let quantity = Observable::new(name, String::new(), of);
        Some(Self { quantity, event: direction.unwrap_or(*event), place: Some(place) })
    }

    /// Its name.
    pub(crate) fn name(&self) -> &str {
        &self.quantity.name
    }
}

/// Takes the direction off the end of an event, if there is one.
fn with_direction(text: &str) -> (&str, Option<Event>) {
    let directions = [
        ("rising", Event::rising()),
        ("falling", Event::falling()),
        ("any", Event::any()),
        ("both", Event::any()),
    ];
    let behind = text.rsplit_once(',').and_then(|(before, word)| {
        let known = directions.iter().find(|(name, _)| *name == word.trim());
        known.map(|(_, event)| (before, Some(*event)))
    });
    behind.unwrap_or((text, None))
}

/// What ends a run.
#[derive(Clone, Debug)]
pub(crate) struct Until {
    /// Where it holds already the run ends at its start: of a condition.
    pub(crate) condition: Option<Observable>,
    /// Where it comes to hold.
    pub(crate) event: WatchedEvent,
}

impl Until {
    /// Reads a condition, or the name of an event of the description.
    ///
    /// # Errors
    /// As [`condition`].
    pub(crate) fn parse(entry: &Entry, text: &str) -> Result<Self, SetupError> {
        if let Some(event) = WatchedEvent::described(entry, text) {
            return Ok(Self { condition: None, event });
        }
        let condition = condition(entry, text)?;
        let event = WatchedEvent { quantity: margin(entry, text)?, event: Event::rising(), place: None };
        Ok(Self { condition: Some(condition), event })
    }
}
