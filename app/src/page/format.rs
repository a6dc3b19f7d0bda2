//! The data of a page, and what they have to satisfy.

use serde::{Deserialize, Serialize};

use crate::shape::Solid;

/// What [`Page::format`] must be.
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
    /// What moves, in one line.
    pub about: String,
    /// What was done, in one line.
    pub subtitle: String,
    /// What made it: parameters with their units, scheme, step, version.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Detail>,
    /// The moments of all runs that have none of their own, s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub time: Vec<f64>,
    /// Where it moves.
    pub space: Space,
    /// What moves. The first run is drawn solid, others as translucent ghosts over it.
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
    /// Where the eye is at first: its direction from the x axis about the vertical, and its height over the horizontal, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<[f64; 2]>,
}

/// One motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Run {
    /// What tells it from the others.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its own moments, s, all forwards or all backwards in time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub time: Vec<f64>,
    /// What moves.
    pub bodies: Vec<Body>,
    /// Vectors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrows: Vec<Arrow>,
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

/// A vector at each moment, or one that is always the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a list of vectors of numbers, one for each moment, or one vector that is always the same"
)]
#[non_exhaustive]
pub enum Track {
    /// Always the same.
    Constant(Vec<f64>),
    /// One at each moment.
    Path(Vec<Vec<f64>>),
}

/// A body; without a rotation, a point or a fixed thing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Body {
    /// Its name.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its attitude: quaternions `[w, x, y, z]` that lead from its axes to those of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Track>,
    /// Where its origin is; without it, in the origin of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<Track>,
    /// What it looks like.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Solid>,
    /// Whether its axes are drawn; without it, those of bodies with a rotation are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<bool>,
    /// The point that leaves a trace, in body axes, or `false` for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trail: Option<Trail>,
    /// `solid`, `second`, `planet`, `ink`, or `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}

/// What leaves a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected `false`, or a point [x, y, z]")]
#[non_exhaustive]
pub enum Trail {
    /// Nothing, or what the page chooses.
    Shown(bool),
    /// This point.
    Point([f64; 3]),
}

/// A vector that is drawn as an arrow. Those of one unit share a scale.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Arrow {
    /// What it is.
    pub name: String,
    /// Its letter, beside its tip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbol: Option<String>,
    /// Its unit.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Its components.
    pub vector: Option<Track>,
    /// Whose axes its components are in. What moves in those of a body is also shown as the body sees it.
    pub frame: Frame,
    /// The body that it starts from, counted from 0; without it, space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// Where it starts, in that body's axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<[f64; 3]>,
    /// Drawn as long as it is, being a length.
    pub true_length: bool,
    /// `ink`, or `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}

/// The axes in which an arrow's components are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Frame {
    /// Those of space.
    #[default]
    Space,
    /// Those of the body that it starts from.
    Body,
}

/// A rod or a spring.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Link {
    /// One end.
    pub from: End,
    /// The other.
    pub to: End,
    /// Whether it is a spring.
    pub spring: bool,
}

/// A point of a body or of space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct End {
    /// Which body, counted from 0; without it, space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// Where in its axes.
    pub at: [f64; 3],
}

/// Curves over time that share a scale. Those of the same name in several runs are drawn together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Plot {
    /// What is plotted.
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

/// How values are plotted.
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
    /// What tells it from the others of its plot.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its values, one for each moment.
    pub values: Vec<f64>,
    /// `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}
