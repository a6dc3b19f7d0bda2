//! Names that last as long as the program: a system's description lends them to whoever asks, whether it was compiled or made at run time. What is
//! the same is kept once, so that to read a description again takes no more memory.

use std::collections::{HashMap, HashSet};
use std::sync::{LazyLock, Mutex, PoisonError};

use coadjoint::{Event, Quantity};

static TEXTS: LazyLock<Mutex<HashSet<&'static str>>> = LazyLock::new(Mutex::default);
static LISTS: LazyLock<Mutex<HashSet<&'static [&'static str]>>> = LazyLock::new(Mutex::default);
/// By what is shown of them.
static QUANTITIES: LazyLock<Mutex<HashMap<String, &'static [Quantity]>>> = LazyLock::new(Mutex::default);

/// By what is shown of them.
static EVENTS: LazyLock<Mutex<HashMap<String, Events>>> = LazyLock::new(Mutex::default);

/// Names of events, and which of their zeros count.
type Events = &'static [(&'static str, Event)];

/// A text.
pub(crate) fn text(text: &str) -> &'static str {
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = texts.get(text) {
        return known;
    }
    let kept: &'static str = Box::leak(text.into());
    texts.insert(kept);
    kept
}

/// Texts.
pub(crate) fn texts<'a>(all: impl IntoIterator<Item = &'a String>) -> &'static [&'static str] {
    let all: Vec<&'static str> = all.into_iter().map(|one| text(one)).collect();
    let mut lists = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lists.get(&all[..]) {
        return known;
    }
    let kept: &'static [&'static str] = all.leak();
    lists.insert(kept);
    kept
}

/// Quantities.
pub(crate) fn quantities(all: Vec<Quantity>) -> &'static [Quantity] {
    let mut quantities = QUANTITIES.lock().unwrap_or_else(PoisonError::into_inner);
    quantities.entry(format!("{all:?}")).or_insert_with(|| all.leak())
}

/// Events.
pub(crate) fn events(all: Vec<(&'static str, Event)>) -> Events {
    let mut events = EVENTS.lock().unwrap_or_else(PoisonError::into_inner);
    events.entry(format!("{all:?}")).or_insert_with(|| all.leak())
}
