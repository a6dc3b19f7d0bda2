//! The data of a page, and what they have to satisfy.

use serde::{Deserialize, Serialize};

pub use crate::scene::{Arrow, Body, End, Frame, Link, Track, Trail};

/// The value of [`Page::format`].
pub const FORMAT: &str = "coadjoint page 1";

/// At most so many runs, bodies, arrows, links, plots or series in one place: more could not be told apart.
pub const MOST_THINGS: usize = 100;
/// At most so many moments: more would make a browser slow.
pub const MOST_MOMENTS: usize = 100_000;

/// All that a page shows. Everything but `format` may be left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Page {
    /// [`FORMAT`]
    pub format: String,
    /// The heading.
    pub title: String,
    /// A description in one line.
    pub about: String,
    /// The scheme and its steps, in one line.
    pub subtitle: String,
    /// Parameters with their units, scheme, step, version.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Detail>,
    /// The moments of all runs that have none of their own, s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub time: Vec<f64>,
    /// Where it moves.
    pub space: Space,
    /// The motions. The first run is drawn solid, others as translucent ghosts over it.
    pub runs: Vec<Run>,
}

/// A named value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Detail {
    /// Its name.
    pub name: String,
    /// A number, a list of numbers, or a text.
    pub value: DetailValue,
    /// Its unit.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
}

/// A value that is shown as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number, a list of numbers, or a text")]
#[non_exhaustive]
pub enum DetailValue {
    /// A number.
    Number(f64),
    /// Several.
    Numbers(Vec<f64>),
    /// Something else.
    Text(String),
}

impl Default for DetailValue {
    fn default() -> Self {
        Self::Text(String::new())
    }
}

/// The space of a page. The third axis is up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Space {
    /// The names of the axes; an empty one is not drawn. Without them `x`, `y`, `z`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<[String; 3]>,
    /// The height of the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<f64>,
    /// The unit of lengths; without it `m`, and none if it is empty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Where the eye is at first: its direction from the x axis about the vertical, and its height over the horizontal,
    /// rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<[f64; 2]>,
}

/// One motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Run {
    /// Its name among the others.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its own moments, s, all forwards or all backwards in time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub time: Vec<f64>,
    /// The bodies.
    pub bodies: Vec<Body<Track>>,
    /// Vectors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrows: Vec<Arrow<Option<Track>>>,
    /// Rods and springs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<Link>,
    /// Curves over time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<Plot>,
    /// The most that a body turned between two moments, rad, where that is known better than from the moments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn: Option<f64>,
    /// The fastest turning of a body, rad/s, where that is known better than from the moments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
}

/// Curves over time that share a scale. Those of the same name in several runs are drawn together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Plot {
    /// Its name.
    pub name: String,
    /// Its unit.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Logarithmic ones show sizes, and are always there.
    pub scale: Scale,
    /// Whether it is shown at first.
    pub shown: bool,
    /// The curves.
    pub series: Vec<Series>,
}

/// The scale of values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Scale {
    /// As they are.
    #[default]
    Linear,
    /// Their sizes, by powers of ten.
    Log,
}

/// A curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Series {
    /// Its name among the others of its plot.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its values, one for each moment.
    pub values: Vec<f64>,
    /// `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}
