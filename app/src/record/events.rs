//! Events of a run.

use coadjoint::Crossing;
use serde::{Deserialize, Serialize};

/// An event that has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedEvent {
    /// Its name.
    pub name: String,
    /// How zero was met: `rising`, `falling` or `touch`.
    pub crossing: String,
    /// When, s.
    pub time: f64,
    /// The numbers of a table's row there.
    pub row: Vec<f64>,
}

impl RecordedEvent {
    /// Names how zero was met.
    pub(crate) fn word(crossing: Crossing) -> String {
        match crossing {
            Crossing::Rising => "rising",
            Crossing::Falling => "falling",
            Crossing::Touch => "touch",
        }
        .to_owned()
    }
}
