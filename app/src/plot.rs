//! Pictures: panels with series of values, as PNG and SVG.
//!
//! All drawing goes through this module, so that nothing else depends on the library behind it.

mod envelope;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kuva::prelude::{BandPlot, Layout, LegendPosition, LinePlot, Plot, ScatterPlot};
use kuva::render::render::{Primitive, Scene, TextAnchor};

pub use self::envelope::Envelope;
use crate::error::Error;
use crate::output::AtomicFile;

/// Colours that people with any colour vision can tell apart, also by their lightness (Okabe and Ito, and two more).
const COLORS: [&str; 8] =
    ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#332288", "#777777"];

/// The part of a panel's height that a legend with two lines takes.
const LEGEND: f64 = 0.32;

/// The size of a caption's letters.
const LETTERS: u32 = 14;
/// The distance of a caption's lines.
const LINE: f64 = 20.0;
/// Left and right of a caption.
const MARGIN: f64 = 30.0;

/// Panels in rows, with a title above and a caption below.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Stands above all.
    pub title: String,
    /// Stands below all, a paragraph each; may be empty.
    pub caption: Vec<String>,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel.
    pub cell: (f64, f64),
    /// Where it is said what colours mean.
    pub key: Key,
    /// Row by row.
    pub panels: Vec<Panel>,
}

/// Where it is said what colours mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// In the first panel, as it is the same in all.
    First,
    /// Beside each panel with more than one series.
    Each,
    /// Below the panels, once for all of them.
    Below,
}

/// One panel: series in the plane of two quantities.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Stands above it; may be empty.
    pub title: String,
    /// What lies along the horizontal axis.
    pub x: Axis,
    /// What lies along the vertical axis.
    pub y: Axis,
    /// Whether both axes have the same scale, as in a plane of positions.
    pub equal: bool,
    /// The series, in the same order in every panel: the order gives the colours.
    pub series: Vec<Series>,
}

/// One axis of a panel.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The quantity, with its unit; empty where the panel below says it.
    pub label: String,
    /// How its values are spread.
    pub scale: Scale,
    /// From where to where; by the values where nothing is said.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// Of evenly spread values.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// Of magnitudes, by powers of ten.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic, range: None }
    }

    /// From `low` to `high`: values, also of a logarithmic axis.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }
}

/// How values are spread over an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten, for magnitudes; what is exactly zero lies on the lower edge.
    Logarithmic,
}

/// One series of values.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend calls it.
    pub label: String,
    /// Pairs of the two quantities.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub style: Style,
}

impl Series {
    /// A line through the points.
    pub fn line(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points, style: Style::Line }
    }
}

impl Series {
    /// What lies between two lines of as many points.
    pub fn band(lower: Vec<(f64, f64)>, upper: Vec<(f64, f64)>) -> Self {
        Self { label: String::new(), points: [lower, upper].concat(), style: Style::Band }
    }
}

impl Style {
    fn has_line(self) -> bool {
        !matches!(self, Style::Marks | Style::Band)
    }

    fn has_marks(self) -> bool {
        matches!(self, Style::Marked | Style::Marks | Style::DashedMarked)
    }

    fn is_dashed(self) -> bool {
        matches!(self, Style::DashedMarked | Style::Reference)
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line.
    Line,
    /// A line with a mark at every point.
    Marked,
    /// Marks alone.
    Marks,
    /// A dashed line with a mark at every point, for what may lie on top of another series.
    DashedMarked,
    /// What the others are compared with: a dashed black line.
    Reference,
    /// The area between two lines, the lower in the first half of the points; in the colour of the first series, and darker where several
    /// overlap.
    Band,
}

impl Figure {
    /// Panels above each other over the same time axis, which the last one labels.
    pub fn over_time(title: String, time: &str, span: (f64, f64), key: Key, panels: Vec<Panel>) -> Self {
        let (start, end) = if span.0 < span.1 { span } else { (0.0, 1.0) };
        let last = panels.len().saturating_sub(1);
        let panels = panels.into_iter().enumerate().map(|(i, panel)| {
            let label = if i == last { time } else { "" };
            Panel { x: Axis::linear(label).within(start, end), ..panel }
        });
        Self { title, caption: Vec::new(), columns: 1, cell: (900.0, 250.0), key, panels: panels.collect() }
    }

    /// Writes `<stem>.png` and `<stem>.svg`, and tells where.
    ///
    /// # Errors
    /// If the picture cannot be drawn or written.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2], Error> {
        let with = |extension: &str| {
            // what stands behind a point in the stem is no extension: `figure-1.1`
            let mut name = stem.as_os_str().to_owned();
            name.push(format!(".{extension}"));
            PathBuf::from(name)
        };
        let png = with("png");
        save(&png, &self.png().map_err(|reason| Error::Draw { path: png.clone(), reason })?)?;
        let svg = with("svg");
        save(&svg, self.svg().as_bytes())?;
        Ok([png, svg])
    }

    /// The picture as PNG, with two pixels per unit: sharp in print and on dense screens.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        kuva::RasterBackend::new().with_scale(2.0).render_scene(&self.scene())
    }

    /// The picture as SVG.
    pub fn svg(&self) -> String {
        kuva::backend::svg::SvgBackend::default().render_scene(&self.scene())
    }

    fn scene(&self) -> Scene {
        let mut scene = self.draw().render();
        let width = scene.width - 2.0 * MARGIN;
        let mut y = scene.height;
        if self.key == Key::Below {
            y = self.draw_key(&mut scene, width, y) + 0.5 * LINE;
        }
        // letters are half as wide as high, a little more to be safe
        let letters = (width / (f64::from(LETTERS) * 0.54)) as usize;
        for paragraph in &self.caption {
            for line in wrapped(paragraph, letters) {
                y += LINE;
                scene.elements.push(text(MARGIN, y, line));
            }
            y += 0.4 * LINE;
        }
        if y > scene.height {
            scene.height = y + 0.6 * LINE;
        }
        scene
    }

    /// Every label once with how its series look, in lines below `y`; the answer is where the last line is.
    fn draw_key(&self, scene: &mut Scene, width: f64, mut y: f64) -> f64 {
        /// Of the sample line, and between it and the label.
        const SAMPLE: (f64, f64) = (34.0, 8.0);
        y += LINE;
        let mut x = MARGIN;
        let mut named: Vec<&str> = Vec::new();
        for (series, color) in self.panels.iter().flat_map(Panel::colored) {
            let Series { label, style, .. } = series;
            if label.is_empty() || named.contains(&label.as_str()) {
                continue;
            }
            named.push(label);
            let length = label.chars().count() as f64 * f64::from(LETTERS) * 0.6 + SAMPLE.0 + SAMPLE.1 + 28.0;
            if x > MARGIN && x + length > MARGIN + width {
                (x, y) = (MARGIN, y + LINE);
            }
            let middle = y - 0.35 * f64::from(LETTERS);
            if style.has_line() {
                scene.elements.push(Primitive::Line {
                    x1: x,
                    y1: middle,
                    x2: x + SAMPLE.0,
                    y2: middle,
                    stroke: color.into(),
                    stroke_width: 2.0,
                    stroke_dasharray: style.is_dashed().then(|| "6,4".to_owned()),
                });
            }
            if style.has_marks() {
                scene.elements.push(Primitive::Circle {
                    cx: x + 0.5 * SAMPLE.0,
                    cy: middle,
                    r: 3.5,
                    fill: color.into(),
                    fill_opacity: None,
                    stroke: None,
                    stroke_width: None,
                });
            }
            scene.elements.push(text(x + SAMPLE.0 + SAMPLE.1, y, label.clone()));
            x += length;
        }
        y
    }

    fn draw(&self) -> kuva::prelude::Figure {
        let columns = self.columns.max(1);
        let (plots, layouts): (Vec<_>, Vec<_>) = self
            .panels
            .iter()
            .enumerate()
            .map(|(i, panel)| panel.draw(self.key, i == 0, columns == 1))
            .unzip();
        kuva::prelude::Figure::new(self.panels.len().max(1).div_ceil(columns), columns)
            .with_title(&self.title)
            .with_title_size(18)
            .with_plots(plots)
            .with_layouts(layouts)
            .with_cell_size(self.cell.0, self.cell.1)
    }
}

fn text(x: f64, y: f64, content: String) -> Primitive {
    Primitive::Text {
        x,
        y,
        content,
        size: LETTERS,
        anchor: TextAnchor::Start,
        rotate: None,
        bold: false,
        color: None,
    }
}

/// A text in lines of at most this many letters, broken at spaces.
fn wrapped(text: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A round distance of ticks, about six of them along an axis.
fn step(length: f64) -> f64 {
    let rough = length / 6.0;
    let decade = 10.0_f64.powf(rough.log10().floor());
    let digit = [1.0, 2.0, 3.0, 5.0].into_iter().find(|digit| digit * decade >= rough * 0.999);
    digit.unwrap_or(10.0) * decade
}

impl Panel {
    /// An empty panel without a title.
    pub fn new(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: String::new(), x, y, equal: false, series }
    }

    /// With a title above it.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// The series with their colours; references are black.
    fn colored(&self) -> impl Iterator<Item = (&Series, &'static str)> {
        let mut colors = COLORS.iter().cycle();
        self.series.iter().map(move |series| {
            let color = match series.style {
                Style::Reference => "#000000",
                Style::Band => COLORS[0],
                _ => colors.next().copied().unwrap_or("#000000"),
            };
            (series, color)
        })
    }

    fn draw(&self, key: Key, is_first: bool, stacked: bool) -> (Vec<Plot>, Layout) {
        let with_legend = match key {
            Key::First => is_first,
            Key::Each => self.series.len() > 1,
            Key::Below => false,
        };
        let values = |of: fn(&(f64, f64)) -> f64| {
            self.series.iter().flat_map(|series| &series.points).map(of).collect::<Vec<f64>>()
        };
        let horizontal = Placement::new(&self.x, &values(|point| point.0), 0.0);
        // a legend inside gets some room
        let room = if key == Key::First && with_legend { LEGEND } else { 0.0 };
        let vertical = Placement::new(&self.y, &values(|point| point.1), room);
        let mut plots: Vec<Plot> = Vec::new();
        for (series, color) in self.colored() {
            let points: Vec<(f64, f64)> =
                series.points.iter().map(|&(x, y)| (horizontal.place(x), vertical.place(y))).collect();
            if series.style == Style::Band {
                let (lower, upper) = points.split_at(points.len() / 2);
                let all = |points: &[(f64, f64)], of: fn(&(f64, f64)) -> f64| {
                    points.iter().map(of).collect::<Vec<_>>()
                };
                let band = BandPlot::new(all(lower, |p| p.0), all(lower, |p| p.1), all(upper, |p| p.1));
                plots.push(band.with_color(color).with_opacity(0.22).into());
            }
            if series.style.has_line() {
                let line = LinePlot::new().with_data(points.clone()).with_color(color).with_stroke_width(1.5);
                let line = if series.style.is_dashed() { line.with_dashed() } else { line };
                plots.push(if with_legend { line.with_legend(&series.label).into() } else { line.into() });
            }
            if series.style.has_marks() {
                let marks = ScatterPlot::new().with_data(points).with_color(color).with_size(3.0);
                plots.push(marks.into());
            }
        }
        let widest = self.series.iter().map(|series| series.label.chars().count()).max().unwrap_or(0);
        let mut layout = Layout::auto_from_plots(&plots)
            .with_x_label(&self.x.label)
            .with_y_label(&self.y.label)
            .with_label_size(16)
            .with_tick_size(14)
            .with_body_size(14)
            .with_title_size(15);
        if !self.title.is_empty() {
            layout = layout.with_title(&self.title);
        }
        if self.equal {
            layout = layout.with_equal_aspect();
        }
        if key != Key::Below {
            layout = layout
                .with_legend_position(if key == Key::First {
                    LegendPosition::InsideTopRight
                } else {
                    LegendPosition::OutsideRightTop
                })
                .with_legend_width(widest as f64 * 8.5 + 45.0);
        }
        if stacked {
            // the same for all panels, or their time axes would not lie below each other
            layout = layout.with_force_margins(90.0, if key == Key::Each { 100.0 } else { 30.0 });
        }
        if let Some((low, high, step)) = horizontal.ticks() {
            layout = layout.with_x_axis_min(low).with_x_axis_max(high).with_x_tick_step(step);
        }
        if let Some((low, high, step)) = vertical.ticks() {
            layout = layout.with_y_axis_min(low).with_y_axis_max(high).with_y_tick_step(step);
        }
        let layout =
            layout.with_x_tick_format(horizontal.tick_format()).with_y_tick_format(vertical.tick_format());
        (plots, layout)
    }
}

/// Where values lie along an axis. Powers of ten are placed here, because the library's own logarithmic axis ends at 1e-10.
struct Placement {
    scale: Scale,
    /// The ends, as they are placed; none if they are left to the library.
    ends: Option<(f64, f64)>,
}

impl Placement {
    /// With at least this part of the axis free above the largest value, if it is logarithmic.
    fn new(axis: &Axis, values: &[f64], headroom: f64) -> Self {
        let ends = match (axis.scale, axis.range) {
            (Scale::Linear, range) => range,
            (Scale::Logarithmic, Some((low, high))) => Some((low.log10(), high.log10())),
            (Scale::Logarithmic, None) => Some(Self::decades(values, headroom)),
        };
        Self { scale: axis.scale, ends }
    }

    /// Whole powers of ten around the magnitudes.
    fn decades(values: &[f64], headroom: f64) -> (f64, f64) {
        let positive = || values.iter().map(|x| x.abs()).filter(|x| *x > 0.0 && x.is_finite());
        let largest = positive().fold(f64::MIN_POSITIVE, f64::max);
        let smallest = positive().fold(largest, f64::min);
        // nothing but zeros: the place where roundoff would be
        let (low, top) =
            if positive().next().is_none() { (-17.0, -16.0) } else { (smallest.log10(), largest.log10()) };
        let low = low.floor();
        let high = ((top - headroom * low) / (1.0 - headroom)).ceil();
        (low, high.max(low + 1.0))
    }

    fn place(&self, value: f64) -> f64 {
        match (self.scale, self.ends) {
            (Scale::Linear, None) => value,
            // what lies beyond the axis would be drawn over its neighbours
            (Scale::Linear, Some((low, high))) => value.clamp(low, high),
            // the logarithm of zero is −∞, which `max` brings to the edge
            (Scale::Logarithmic, ends) => {
                let (low, high) = ends.unwrap_or((-17.0, -16.0));
                value.abs().log10().max(low).min(high)
            }
        }
    }

    /// The ends of the axis and the distance of its ticks.
    fn ticks(&self) -> Option<(f64, f64, f64)> {
        let (low, high) = self.ends?;
        Some(match self.scale {
            Scale::Linear => (low, high, step(high - low)),
            // within a decade by powers of two
            Scale::Logarithmic if self.is_narrow() => (low, high, 2_f64.log10()),
            Scale::Logarithmic => (low, high, ((high - low) / 5.0).ceil()),
        })
    }

    /// Whether it is a logarithmic axis with no two powers of ten on it.
    fn is_narrow(&self) -> bool {
        self.scale == Scale::Logarithmic && self.ends.is_some_and(|(low, high)| high - low < 1.0)
    }

    fn tick_format(&self) -> kuva::TickFormat {
        let format = match self.scale {
            Scale::Linear => short,
            Scale::Logarithmic if self.is_narrow() => |exponent: f64| short(10_f64.powf(exponent)),
            Scale::Logarithmic => power_of_ten,
        };
        kuva::TickFormat::Custom(Arc::new(format))
    }
}

/// `0.25`, but `2·10⁷`: large and small numbers by their power of ten.
fn short(value: f64) -> String {
    // ticks are round up to roundoff
    let round = format!("{value:.9e}");
    let (digits, exponent) = round.split_once('e').unwrap_or((&round, "0"));
    let digits =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value == 0.0 {
        "0".to_owned()
    } else if (-3..5).contains(&exponent) {
        let places = digits.trim_start_matches('-').len().saturating_sub(2) as i32 - exponent;
        format!("{value:.*}", places.max(0) as usize)
    } else {
        format!("{digits}·{}", power_of_ten(f64::from(exponent)))
    }
}

/// `10⁻¹²` for −12.
pub fn power_of_ten(exponent: f64) -> String {
    let digits = format!("{exponent:.0}").chars().map(superscript).collect::<String>();
    format!("10{digits}")
}

fn superscript(digit: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match digit.to_digit(10) {
        Some(value) => DIGITS[value as usize],
        None => '⁻',
    }
}

fn save(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let write = || {
        let mut file = AtomicFile::create(path)?;
        file.write_all(bytes)?;
        file.finish()
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_powers_of_ten() {
        assert_eq!(power_of_ten(-12.0), "10⁻¹²");
        assert_eq!(power_of_ten(0.0), "10⁰");
        assert_eq!(power_of_ten(305.0), "10³⁰⁵");
    }

    #[test]
    fn ticks_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (0.1 + 0.2, "0.3"),
            (-10.0, "-10"),
            (2_000.0, "2000"),
            (0.005, "0.005"),
            (1.25, "1.25"),
            (-2e7, "-2·10⁷"),
            (2.5e-4, "2.5·10⁻⁴"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn captions_are_broken_at_spaces() {
        assert_eq!(wrapped("one two three four", 9), ["one two", "three", "four"]);
        assert_eq!(wrapped("  unbreakable  word ", 4), ["unbreakable", "word"]);
        assert_eq!(wrapped("", 4), [""; 0]);
    }

    #[test]
    fn errors_below_1e_10_keep_their_place_and_zero_lies_on_the_edge() {
        let axis = Axis::logarithmic("error");
        let placement = Placement::new(&axis, &[0.0, 3e-15, -2e-3], 0.0);
        assert_eq!(placement.ends, Some((-15.0, -2.0)));
        assert!((placement.place(3e-15) - -14.522_878_745_280_337).abs() < 1e-12);
        assert_eq!(placement.place(0.0), -15.0);
        assert_eq!(Placement::new(&axis, &[0.0, 0.0], 0.0).ends, Some((-17.0, -16.0)));
        assert_eq!(Placement::new(&axis.within(1e-3, 1e2), &[1e7], 0.0).place(1e7), 2.0);
    }

    #[test]
    fn an_axis_within_a_decade_has_powers_of_two() {
        let placement = Placement::new(&Axis::logarithmic("H").within(0.5, 2.0), &[0.6, 1.7], 0.0);
        let (low, high, step) = placement.ticks().expect("given");
        let at: Vec<String> = [low, low + step, high].iter().map(|tick| short(10_f64.powf(*tick))).collect();
        assert_eq!(at, ["0.5", "1", "2"]);
        assert!(placement.is_narrow());
        assert!(!Placement::new(&Axis::logarithmic("H").within(0.5, 20.0), &[], 0.0).is_narrow());
    }

    #[test]
    fn a_legend_gets_its_room() {
        let placement = Placement::new(&Axis::logarithmic("error"), &[1e-6, 0.9e-3], 0.3);
        assert_eq!(placement.ends, Some((-6.0, -1.0)));
        assert!((-1.0 - placement.place(0.9e-3)) / 5.0 >= 0.3);
    }

    #[test]
    fn figures_without_any_variation_can_be_drawn() {
        for values in [&[][..], &[0.0], &[0.0, 0.0], &[1e-3, 1e-3]] {
            for style in [Style::Line, Style::Marked, Style::Marks, Style::DashedMarked, Style::Reference] {
                for key in [Key::First, Key::Each, Key::Below] {
                    let points = values.iter().enumerate().map(|(i, &y)| (i as f64, y)).collect();
                    let series = vec![Series { label: "a".to_owned(), points, style }];
                    let panel = Panel::new(Axis::linear("x"), Axis::logarithmic("error"), series);
                    let span = (0.0, values.len() as f64);
                    let stacked =
                        Figure::over_time("t".to_owned(), "time, s", span, key, vec![panel.clone()]);
                    let beside = Figure {
                        caption: vec!["c".to_owned()],
                        columns: 2,
                        panels: vec![Panel { equal: true, ..panel.clone() }, panel],
                        ..stacked.clone()
                    };
                    for figure in [stacked, beside] {
                        let svg = figure.svg();
                        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{values:?} {style:?} {key:?}");
                    }
                }
            }
        }
    }
}
