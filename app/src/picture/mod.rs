//! Pictures: panels with series of values, as SVG and PNG.
//!
//! Layout, letters and drawing are our own: little code, and little to compile for those who use it.

mod axis;
mod clip;
mod ensemble;
mod font;
mod layout;
mod number;
mod palette;
#[cfg(feature = "png")]
mod png;
mod run;
mod scene;
mod svg;

pub use self::axis::{Axis, Scale};
pub(crate) use self::ensemble::figure as ensemble_figure;
pub use self::number::{power_of_ten, short, two_digits, with_minus};
pub use self::palette::Color;
pub(crate) use self::run::figure as run_figure;
pub use self::run::series;
pub use self::scene::Mark;

/// Panels in rows, with a title above.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Stands above all.
    pub title: String,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel's frame.
    pub cell: (f64, f64),
    /// Where it is said what colours mean.
    pub key: Key,
    /// Whether panels below each other share the horizontal axis, and those beside each other the vertical one.
    pub shared: (bool, bool),
    /// Row by row.
    pub panels: Vec<Panel>,
}

/// Where it is said what colours mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Above the panels, once for all of them.
    Above,
    /// Above each panel with more than one named series.
    Each,
}

/// One panel: series in the plane of two quantities.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Stands above it; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Whether both axes have the same scale, as in a plane of positions.
    pub equal: bool,
    /// The series, each drawn over those before it.
    pub series: Vec<Series>,
}

/// One series of values.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the key; without one it is not in the key.
    pub label: String,
    /// Pairs of the two quantities.
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub color: Color,
    /// How it is drawn.
    pub style: Style,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
    /// A line with a mark at every point.
    Marked(Mark),
    /// A dashed line with a mark at every point.
    DashedMarked(Mark),
    /// Marks alone.
    Marks(Mark),
    /// The area between two lines, the lower in the first half of the points, of this opacity.
    Band(f64),
    /// Bars from lower ends to upper ones, the lower in the first half of the points.
    Bars,
}

impl Style {
    /// The same with a dashed line, if it has one.
    #[must_use]
    pub fn dashed(self) -> Self {
        match self {
            Style::Line => Style::Dashed,
            Style::Marked(mark) => Style::DashedMarked(mark),
            other => other,
        }
    }

    /// Whether its line is dashed, if it has one.
    fn line(self) -> Option<bool> {
        match self {
            Style::Line | Style::Marked(_) => Some(false),
            Style::Dashed | Style::DashedMarked(_) => Some(true),
            _ => None,
        }
    }

    fn mark(self) -> Option<Mark> {
        match self {
            Style::Marked(mark) | Style::DashedMarked(mark) | Style::Marks(mark) => Some(mark),
            _ => None,
        }
    }
}

impl Series {
    /// Drawn in this way.
    pub fn new(label: impl Into<String>, color: Color, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points, color, style }
    }

    /// A line through the points.
    pub fn line(label: impl Into<String>, color: Color, points: Vec<(f64, f64)>) -> Self {
        Self::new(label, color, Style::Line, points)
    }

    /// Draws a reference: a dashed line in the colour of the axes.
    pub fn reference(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(label, Color::Ink, Style::Dashed, points)
    }

    /// The area between two lines of equally many points.
    pub fn band(
        label: impl Into<String>,
        color: Color,
        opacity: f64,
        lower: Vec<(f64, f64)>,
        upper: Vec<(f64, f64)>,
    ) -> Self {
        Self::new(label, color, Style::Band(opacity), [lower, upper].concat())
    }

    /// Bars from lower ends to as many upper ones.
    pub fn bars(
        label: impl Into<String>,
        color: Color,
        lower: Vec<(f64, f64)>,
        upper: Vec<(f64, f64)>,
    ) -> Self {
        Self::new(label, color, Style::Bars, [lower, upper].concat())
    }
}

impl Panel {
    /// A panel without a title.
    pub fn new(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: String::new(), x, y, equal: false, series }
    }

    /// With a title above it.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }
}

/// A kind of files with pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// Pixels.
    #[cfg(feature = "png")]
    Png,
    /// Lines and letters, for any size and for dark pages.
    Svg,
}

impl Kind {
    /// Those that are written.
    pub const ALL: &'static [Kind] = &[
        #[cfg(feature = "png")]
        Kind::Png,
        Kind::Svg,
    ];

    /// The extension of such files.
    pub fn extension(self) -> &'static str {
        match self {
            #[cfg(feature = "png")]
            Kind::Png => "png",
            Kind::Svg => "svg",
        }
    }
}

impl Figure {
    /// Panels above each other over the same time axis, which the last one labels.
    pub fn over_time(title: String, time: &str, span: (f64, f64), key: Key, panels: Vec<Panel>) -> Self {
        let (start, end) = if span.0 < span.1 { span } else { (0.0, 1.0) };
        let panels =
            panels.into_iter().map(|panel| Panel { x: Axis::linear(time).within(start, end), ..panel });
        Self { title, columns: 1, cell: (760.0, 170.0), key, shared: (true, false), panels: panels.collect() }
    }

    /// The same with as many columns as its panels need to fit on a page.
    pub(crate) fn in_columns(self) -> Self {
        let columns = self.panels.len().div_ceil(5).max(if self.panels.len() > 3 { 2 } else { 1 });
        let width = [760.0, 470.0, 380.0][columns.min(3) - 1];
        Self { columns, cell: (width, self.cell.1), ..self }
    }

    /// The picture as the content of a file.
    pub fn picture(&self, kind: Kind) -> Vec<u8> {
        match kind {
            #[cfg(feature = "png")]
            Kind::Png => png::png(&layout::scene(self)),
            Kind::Svg => self.svg().into_bytes(),
        }
    }

    /// The picture as SVG, for dark pages too.
    pub fn svg(&self) -> String {
        svg::svg(&layout::scene(self), &self.title)
    }
}

#[cfg(test)]
mod tests;
