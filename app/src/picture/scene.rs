//! The shapes of a picture, in units of which a letter is some thirteen high; drawn as SVG and as pixels.

use super::palette::Color;

/// A position: to the right, and down.
pub(super) type Point = (f64, f64);

/// A picture.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) width: f64,
    pub(super) height: f64,
    /// Each over those before it.
    pub(super) shapes: Vec<Shape>,
}

/// One part of it.
#[derive(Debug)]
pub(super) enum Shape {
    Line { points: Vec<Point>, color: Color, width: f64, dashed: bool },
    Area { points: Vec<Point>, color: Color, opacity: f64 },
    Marks { at: Vec<Point>, mark: Mark, color: Color },
    Text(Text),
}

/// The shape of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A filled circle.
    Dot,
    /// A ring.
    Ring,
}

/// How large marks are: a dot, and the line of a ring.
pub(super) const RADIUS: f64 = 2.8;
pub(super) const RING: (f64, f64) = (3.6, 1.5);

/// A text.
#[derive(Debug)]
pub(super) struct Text {
    /// On the line on which its letters stand.
    pub(super) at: Point,
    pub(super) text: String,
    pub(super) size: f64,
    pub(super) color: Color,
    pub(super) anchor: Anchor,
    /// Turned, to be read upwards.
    pub(super) upwards: bool,
}

/// The part of a text that is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A dash and a gap.
pub(super) const DASHES: [f32; 2] = [6.0, 4.0];
