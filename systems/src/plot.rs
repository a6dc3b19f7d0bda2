//! Pictures of quantities over time: panels above each other, as PNG and SVG.
//!
//! All drawing goes through this module, so that nothing else depends on the library behind it.

mod envelope;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot};

pub use self::envelope::Envelope;
use crate::error::Error;
use crate::output::WholeFile;

/// Colours that people with any colour vision can tell apart, also by their lightness (Okabe and Ito).
const COLORS: [&str; 6] = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00"];

/// The part of a panel's height that a legend with two lines takes.
const LEGEND: f64 = 0.32;

/// Panels above each other over one time axis.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Stands above all.
    pub title: String,
    /// What time is called, with its unit.
    pub time: String,
    /// From when to when.
    pub span: (f64, f64),
    /// Which panels say what their colours mean.
    pub key: Key,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// Where it is said what colours mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// In the first panel, as it is the same in all.
    First,
    /// Beside each panel with more than one course.
    Each,
}

/// One panel: the same quantity from several runs.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The quantity, with its unit.
    pub label: String,
    /// How its values are spread over the axis.
    pub scale: Scale,
    /// Its courses, in the same order in every panel: the order gives the colours.
    pub series: Vec<Series>,
}

/// How values are spread over an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten, for magnitudes; what is exactly zero lies on the lower edge.
    Logarithmic,
}

/// One course of values over time.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend calls it.
    pub label: String,
    /// Time and value.
    pub points: Vec<(f64, f64)>,
}

impl Figure {
    /// Writes `<stem>.png` and `<stem>.svg`, and tells where.
    ///
    /// # Errors
    /// If the picture cannot be drawn or written.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2], Error> {
        let scene = self.draw().render();
        let png = stem.with_extension("png");
        // two pixels per unit: sharp in print and on dense screens
        let pixels = kuva::RasterBackend::new()
            .with_scale(2.0)
            .render_scene(&scene)
            .map_err(|reason| Error::Draw { path: png.clone(), reason })?;
        save(&png, &pixels)?;
        let svg = stem.with_extension("svg");
        save(&svg, kuva::backend::svg::SvgBackend::default().render_scene(&scene).as_bytes())?;
        Ok([png, svg])
    }

    fn draw(&self) -> kuva::prelude::Figure {
        let last = self.panels.len().saturating_sub(1);
        let (start, end) = if self.span.0 < self.span.1 { self.span } else { (0.0, 1.0) };
        let (plots, layouts): (Vec<_>, Vec<_>) = self
            .panels
            .iter()
            .enumerate()
            .map(|(i, panel)| {
                let (plots, layout) = panel.draw(self.key, i == 0);
                let layout =
                    layout.with_x_axis_min(start).with_x_axis_max(end).with_x_tick_step(step(end - start));
                (plots, if i == last { layout.with_x_label(&self.time) } else { layout })
            })
            .unzip();
        kuva::prelude::Figure::new(self.panels.len().max(1), 1)
            .with_title(&self.title)
            .with_title_size(18)
            .with_plots(plots)
            .with_layouts(layouts)
            .with_cell_size(900.0, 250.0)
            .with_shared_x_all()
    }
}

/// A round distance of ticks, about six of them along an axis.
fn step(length: f64) -> f64 {
    let rough = length / 6.0;
    let decade = 10.0_f64.powf(rough.log10().floor());
    let digit = [1.0, 2.0, 3.0, 5.0].into_iter().find(|digit| digit * decade >= rough * 0.999);
    digit.unwrap_or(10.0) * decade
}

impl Panel {
    fn draw(&self, key: Key, is_first: bool) -> (Vec<Plot>, Layout) {
        let inside = key == Key::First;
        let with_legend = if inside { is_first } else { self.series.len() > 1 };
        // a legend inside gets some room
        let axis = Axis::new(self, if inside && with_legend { LEGEND } else { 0.0 });
        let plots: Vec<Plot> = self
            .series
            .iter()
            .zip(COLORS.iter().cycle())
            .map(|(series, color)| {
                let points: Vec<(f64, f64)> =
                    series.points.iter().map(|&(t, y)| (t, axis.place(y))).collect();
                let line = LinePlot::new().with_data(points).with_color(*color).with_stroke_width(1.5);
                if with_legend { line.with_legend(&series.label).into() } else { line.into() }
            })
            .collect();
        let widest = self.series.iter().map(|series| series.label.chars().count()).max().unwrap_or(0);
        let mut layout = Layout::auto_from_plots(&plots)
            .with_y_label(&self.label)
            .with_label_size(16)
            .with_tick_size(14)
            .with_body_size(14)
            .with_legend_position(if inside {
                LegendPosition::InsideTopRight
            } else {
                LegendPosition::OutsideRightTop
            })
            .with_legend_width(widest as f64 * 8.5 + 45.0)
            // the same for all panels, or their time axes would not lie below each other
            .with_force_margins(90.0, if inside { 30.0 } else { 100.0 });
        if self.scale == Scale::Linear {
            layout = layout.with_y_tick_format(kuva::TickFormat::Custom(Arc::new(short)));
        } else {
            layout = layout
                .with_y_axis_min(axis.low)
                .with_y_axis_max(axis.high)
                .with_y_tick_step(((axis.high - axis.low) / 5.0).ceil())
                .with_y_tick_format(kuva::TickFormat::Custom(Arc::new(power_of_ten)));
        }
        (plots, layout)
    }
}

/// Where values lie on a panel's vertical axis. Powers of ten are placed here, because the library's own logarithmic
/// axis ends at 1e-10.
struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
}

impl Axis {
    /// With at least this part of the axis free above the largest value, if it is logarithmic.
    fn new(panel: &Panel, headroom: f64) -> Self {
        let magnitudes = || panel.series.iter().flat_map(|series| &series.points).map(|point| point.1.abs());
        let positive = || magnitudes().filter(|y| *y > 0.0 && y.is_finite());
        let largest = positive().fold(f64::MIN_POSITIVE, f64::max);
        let smallest = positive().fold(largest, f64::min);
        // nothing but zeros: the place where roundoff would be
        let (low, top) =
            if positive().next().is_none() { (-17.0, -16.0) } else { (smallest.log10(), largest.log10()) };
        let low = low.floor();
        let high = ((top - headroom * low) / (1.0 - headroom)).ceil();
        Self { scale: panel.scale, low, high: high.max(low + 1.0) }
    }

    fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            // the logarithm of zero is −∞, which `max` brings to the edge
            Scale::Logarithmic => value.abs().log10().max(self.low),
        }
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
fn power_of_ten(exponent: f64) -> String {
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
        let mut file = WholeFile::create(path)?;
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

    fn panel(values: &[f64]) -> Panel {
        let points = values.iter().enumerate().map(|(i, &y)| (i as f64, y)).collect();
        Panel {
            label: "error".to_owned(),
            scale: Scale::Logarithmic,
            series: vec![Series { label: "a".to_owned(), points }],
        }
    }

    #[test]
    fn errors_below_1e_10_keep_their_place_and_zero_lies_on_the_edge() {
        let axis = Axis::new(&panel(&[0.0, 3e-15, -2e-3]), 0.0);
        assert_eq!((axis.low, axis.high), (-15.0, -2.0));
        assert!((axis.place(3e-15) - -14.522_878_745_280_337).abs() < 1e-12);
        assert_eq!(axis.place(0.0), -15.0);
        let nothing = Axis::new(&panel(&[0.0, 0.0]), 0.0);
        assert_eq!((nothing.low, nothing.high), (-17.0, -16.0));
    }

    #[test]
    fn a_legend_gets_its_room() {
        let axis = Axis::new(&panel(&[1e-6, 0.9e-3]), 0.3);
        assert_eq!((axis.low, axis.high), (-6.0, -1.0));
        assert!((axis.high - axis.place(0.9e-3)) / (axis.high - axis.low) >= 0.3);
    }

    #[test]
    fn figures_without_any_variation_can_be_drawn() {
        for values in [&[][..], &[0.0], &[0.0, 0.0], &[1e-3, 1e-3]] {
            let figure = Figure {
                title: "t".to_owned(),
                time: "time, s".to_owned(),
                span: (0.0, values.len() as f64),
                key: Key::Each,
                panels: vec![panel(values)],
            };
            let svg = kuva::backend::svg::SvgBackend::default().render_scene(&figure.draw().render());
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{values:?}");
        }
    }
}
