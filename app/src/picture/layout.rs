//! Where everything of a picture is: frames, axes, keys and series.

use super::axis::{Placement, Tick};
use super::clip::{Frame, clipped};
use super::font;
use super::palette::Color;
use super::scene::{Anchor, Point, Scene, Shape, Text};
use super::{Figure, Key, Panel, Series, Style};
use crate::units::{range, wrapped};

/// Sizes of letters.
const TITLE: f64 = 17.0;
const LABEL: f64 = 14.0;
const SMALL: f64 = 13.0;

/// Around the picture.
const EDGE: f64 = 16.0;
/// Between a frame and what stands beside it.
const GAP: f64 = 8.0;
/// The length of a tick, and of a minor one.
const TICK: (f64, f64) = (5.0, 3.0);
/// The distance of lines of text.
const LINE: f64 = 20.0;
/// Of a key's samples.
const SAMPLE: f64 = 26.0;

/// One panel with its axes.
struct Placed<'a> {
    panel: &'a Panel,
    horizontal: Placement,
    vertical: Placement,
    /// Whether ticks and label stand below it, and left of it.
    is_labelled: (bool, bool),
}

/// The room before and behind the frames of a row or a column.
type Margin = (f64, f64);

/// Breaks a title into lines that fit.
fn lines(title: &str, room: f64) -> Vec<String> {
    let (letters, width) = (title.chars().count(), font::width(title, TITLE));
    let share = 0.95 * room / width;
    wrapped(title, if width > room { (share * letters as f64) as usize } else { letters })
}

pub(super) fn scene(figure: &Figure) -> Scene {
    let columns = figure.columns.max(1);
    let placed = placed(figure, columns);
    let rows = placed.len().div_ceil(columns);
    let margin = |of: &dyn Fn(&Placed<'_>) -> Margin, is_in: &dyn Fn(usize) -> bool| {
        let margins = placed.iter().enumerate().filter(|(i, _)| is_in(*i)).map(|(_, placed)| of(placed));
        margins.fold((0.0, 0.0), |a: Margin, b| (a.0.max(b.0), a.1.max(b.1)))
    };
    let across: Vec<Margin> = (0..columns)
        .map(|column| margin(&|placed| placed.beside(figure.cell), &|i| i % columns == column))
        .collect();
    let down: Vec<Margin> =
        (0..rows).map(|row| margin(&|placed| placed.around(figure.key), &|i| i / columns == row)).collect();
    let (width, height) = figure.cell;
    let full = EDGE + across.iter().map(|(before, behind)| before + width + behind).sum::<f64>() + EDGE;
    let mut scene = Scene { width: full, height: 0.0, shapes: Vec::new() };
    let mut y = EDGE;
    for line in lines(&figure.title, full - 2.0 * EDGE) {
        scene.text((0.5 * full, y + TITLE), &line, TITLE, Anchor::Middle);
        y += TITLE + 4.0;
    }
    if !figure.title.is_empty() {
        y += 10.0;
    }
    if figure.key == Key::Above {
        // a panel's only series is what its axis says
        let panels = figure.panels.iter().filter(|panel| panel.has_key() || figure.panels.len() == 1);
        y = key_in_lines(&mut scene, &named(panels.flat_map(|panel| &panel.series)), y);
    }
    let mut panels = placed.iter();
    for (above, below) in down {
        y += above;
        let mut x = EDGE;
        for ((before, behind), panel) in across.iter().zip(panels.by_ref()) {
            x += before;
            let frame = Frame { left: x, right: x + width, top: y, bottom: y + height };
            panel.draw(&mut scene, &frame, figure.key);
            x += width + behind;
        }
        y += height + below;
    }
    scene.height = y + 0.5 * EDGE;
    scene
}

/// The panels with their axes; those that share an axis have the same.
fn placed(figure: &Figure, columns: usize) -> Vec<Placed<'_>> {
    let mut placed: Vec<Placed<'_>> = figure.panels.iter().map(|panel| panel.placed(figure.cell)).collect();
    let (horizontal, vertical): (Vec<_>, Vec<_>) =
        placed.iter().map(|placed| (placed.horizontal.ends, placed.vertical.ends)).unzip();
    let ends = |(low, high): (f64, f64)| [low, high];
    let count = placed.len();
    for (i, panel) in placed.iter_mut().enumerate() {
        if figure.shared.0 {
            let column = (0..count).filter(|k| k % columns == i % columns);
            panel.horizontal = panel.horizontal.over(range(column.flat_map(|k| ends(horizontal[k]))));
            panel.is_labelled.0 = i + columns >= count;
        }
        if figure.shared.1 {
            let row = (0..count).filter(|k| k / columns == i / columns);
            panel.vertical = panel.vertical.over(range(row.flat_map(|k| ends(vertical[k]))));
            panel.is_labelled.1 = i % columns == 0;
        }
    }
    placed
}

impl Panel {
    fn placed(&self, (width, height): (f64, f64)) -> Placed<'_> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let mut horizontal =
            Placement::new(&self.x, points().map(|point| point.0), self.equal || self.has_marks());
        let mut vertical = Placement::new(&self.y, points().map(|point| point.1), true);
        if self.equal {
            let [across, down] = [&horizontal, &vertical].map(|axis| axis.ends.1 - axis.ends.0);
            let unit = (across / width).max(down / height);
            let about = |axis: &Placement, length: f64| {
                let middle = 0.5 * (axis.ends.0 + axis.ends.1);
                axis.over((middle - 0.5 * length, middle + 0.5 * length))
            };
            horizontal = about(&horizontal, unit * width);
            vertical = about(&vertical, unit * height);
        }
        Placed { panel: self, horizontal, vertical, is_labelled: (true, true) }
    }

    fn has_key(&self) -> bool {
        self.series.iter().filter(|series| !series.label.is_empty()).count() > 1
    }

    fn has_marks(&self) -> bool {
        self.series.iter().any(|series| series.style.mark().is_some())
    }
}

impl Placed<'_> {
    fn ticks(&self, (width, height): (f64, f64)) -> [Vec<Tick>; 2] {
        [self.horizontal.ticks(width / 50.0), self.vertical.ticks(height / 28.0)]
    }

    /// Left and right of the frame.
    fn beside(&self, cell: (f64, f64)) -> Margin {
        let [_, ticks] = self.ticks(cell);
        let widest = ticks.iter().filter_map(|tick| tick.label.as_deref());
        let widest = widest.map(|label| font::width(label, SMALL)).fold(0.0, f64::max);
        let label = if self.panel.y.label.is_empty() { 0.0 } else { LABEL + GAP };
        let before = if self.is_labelled.1 { label + widest + GAP } else { 0.0 };
        (before, 24.0)
    }

    /// Above and below the frame.
    fn around(&self, key: Key) -> Margin {
        let is_headed = !self.panel.title.is_empty() || (key == Key::Each && self.panel.has_key());
        let label = if self.panel.x.label.is_empty() { 0.0 } else { LINE };
        let after = if self.is_labelled.0 { GAP + SMALL + label } else { 0.0 };
        (if is_headed { LINE + 6.0 } else { 14.0 }, after + 6.0)
    }

    fn draw(&self, scene: &mut Scene, frame: &Frame, key: Key) {
        let [across, up] = self.ticks((frame.width(), frame.height()));
        self.draw_grid(scene, frame, &across, &up);
        let place = |&(x, y): &Point| {
            (
                frame.left + frame.width() * self.horizontal.place(x),
                frame.top + frame.height() * (1.0 - self.vertical.place(y)),
            )
        };
        for series in &self.panel.series {
            let points: Vec<Point> = series.points.iter().map(place).collect();
            draw_series(scene, frame, series, (&points, &points));
        }
        let corners = [
            (frame.left, frame.top),
            (frame.right, frame.top),
            (frame.right, frame.bottom),
            (frame.left, frame.bottom),
            (frame.left, frame.top),
        ];
        scene.line(corners.to_vec(), Color::Ink, 1.0);
        self.draw_axes(scene, frame, &across, &up);
        if !self.panel.title.is_empty() {
            scene.text((frame.left, frame.top - GAP), &self.panel.title, LABEL, Anchor::Start);
        }
        if key == Key::Each && self.panel.has_key() {
            key_right(scene, &self.panel.series, frame);
        }
    }

    fn draw_grid(&self, scene: &mut Scene, frame: &Frame, across: &[Tick], up: &[Tick]) {
        for tick in across.iter().filter(|tick| tick.label.is_some()) {
            let x = frame.left + frame.width() * tick.at;
            scene.line(vec![(x, frame.top), (x, frame.bottom)], Color::Grid, 1.0);
        }
        for tick in up.iter().filter(|tick| tick.label.is_some()) {
            let y = frame.bottom - frame.height() * tick.at;
            scene.line(vec![(frame.left, y), (frame.right, y)], Color::Grid, 1.0);
        }
    }

    fn draw_axes(&self, scene: &mut Scene, frame: &Frame, across: &[Tick], up: &[Tick]) {
        let length = |tick: &Tick| if tick.label.is_some() { TICK.0 } else { TICK.1 };
        for tick in across {
            let x = frame.left + frame.width() * tick.at;
            scene.line(vec![(x, frame.bottom), (x, frame.bottom - length(tick))], Color::Ink, 1.0);
            if let (true, Some(label)) = (self.is_labelled.0, &tick.label) {
                scene.text((x, frame.bottom + GAP + 0.75 * SMALL), label, SMALL, Anchor::Middle);
            }
        }
        let mut widest = 0.0_f64;
        for tick in up {
            let y = frame.bottom - frame.height() * tick.at;
            scene.line(vec![(frame.left, y), (frame.left + length(tick), y)], Color::Ink, 1.0);
            if let (true, Some(label)) = (self.is_labelled.1, &tick.label) {
                scene.text((frame.left - GAP, y + 0.35 * SMALL), label, SMALL, Anchor::End);
                widest = widest.max(font::width(label, SMALL));
            }
        }
        let Panel { x, y, .. } = self.panel;
        if self.is_labelled.0 && !x.label.is_empty() {
            let at = (frame.left + 0.5 * frame.width(), frame.bottom + GAP + SMALL + LINE - 3.0);
            scene.text(at, &x.label, LABEL, Anchor::Middle);
        }
        if self.is_labelled.1 && !y.label.is_empty() {
            let at = (frame.left - widest - 2.0 * GAP, frame.top + 0.5 * frame.height());
            // a long one would reach over the panels above and below
            let size = LABEL * (frame.height() / font::width(&y.label, LABEL)).min(1.0);
            scene
                .shapes
                .push(Shape::Text(Text { upwards: true, ..text(at, &y.label, size, Anchor::Middle) }));
        }
    }
}

/// Draws a series through these points, with its marks at those.
fn draw_series(scene: &mut Scene, frame: &Frame, series: &Series, (points, marks): (&[Point], &[Point])) {
    let color = series.color;
    match series.style {
        Style::Band(opacity) => {
            let (lower, upper) = points.split_at(points.len() / 2);
            let around =
                lower.iter().chain(upper.iter().rev()).filter(|(x, y)| x.is_finite() && y.is_finite());
            let points = around.map(|point| frame.nearest(*point)).collect();
            scene.shapes.push(Shape::Area { points, color, opacity });
        }
        Style::Bars => {
            let (lower, upper) = points.split_at(points.len() / 2);
            for (&(x, low), &(_, high)) in lower.iter().zip(upper) {
                for (from, to) in [
                    ((x, low), (x, high)),
                    ((x - 5.0, low), (x + 5.0, low)),
                    ((x - 5.0, high), (x + 5.0, high)),
                ] {
                    for piece in clipped(&[from, to], frame) {
                        scene.line(piece, color, 1.5);
                    }
                }
            }
        }
        _ => {
            if let Some(dashed) = series.style.line() {
                for points in clipped(points, frame) {
                    scene.shapes.push(Shape::Line { points, color, width: 1.6, dashed });
                }
            }
            if let Some(mark) = series.style.mark() {
                let at = marks.iter().copied().filter(|point| frame.holds(*point)).collect();
                scene.shapes.push(Shape::Marks { at, mark, color });
            }
        }
    }
}

/// Series with a name, each name once.
fn named<'a>(series: impl Iterator<Item = &'a Series>) -> Vec<&'a Series> {
    let mut named: Vec<&Series> = Vec::new();
    for series in series.filter(|series| !series.label.is_empty()) {
        if named.iter().all(|known| known.label != series.label) {
            named.push(series);
        }
    }
    named
}

/// Every name once with how its series look, in lines from `y` on; the answer is where the last one ends.
fn key_in_lines(scene: &mut Scene, named: &[&Series], mut y: f64) -> f64 {
    const APART: f64 = 22.0;
    let length = |series: &Series| SAMPLE + GAP + font::width(&series.label, SMALL) + APART;
    let room = scene.width - 2.0 * EDGE;
    let mut rest = named;
    while !rest.is_empty() {
        let mut total = 0.0;
        let fits = rest.iter().take_while(|series| {
            total += length(series);
            total - APART <= room
        });
        let (line, others) = rest.split_at(fits.count().max(1));
        let total = line.iter().map(|series| length(series)).sum::<f64>() - APART;
        let mut x = 0.5 * (scene.width - total);
        for series in line {
            // bands lie upon wider ones, and are darker for it
            let wider = named.iter().take_while(|other| !std::ptr::eq(**other, *series));
            let wider =
                wider.filter(|other| series.is_band() && other.is_band() && other.color == series.color);
            for series in wider.chain([series]) {
                sample(scene, series, (x, y + 0.65 * SMALL), SAMPLE);
            }
            scene.text((x + SAMPLE + GAP, y + SMALL), &series.label, SMALL, Anchor::Start);
            x += length(series);
        }
        y += LINE;
        rest = others;
    }
    y
}

/// In one line, to the right above a frame.
fn key_right(scene: &mut Scene, series: &[Series], frame: &Frame) {
    let mut x = frame.right;
    let named = named(series.iter());
    // many have shorter samples
    let letters: f64 = named.iter().map(|series| font::width(&series.label, SMALL)).sum();
    let room = (frame.width() - letters) / (named.len() as f64 * (SAMPLE + 3.0 * GAP));
    let part = room.clamp(0.2, 1.0);
    for series in named.into_iter().rev() {
        scene.text((x, frame.top - GAP), &series.label, SMALL, Anchor::End);
        x -= font::width(&series.label, SMALL) + part * (GAP + SAMPLE);
        sample(scene, series, (x, frame.top - GAP - 0.35 * SMALL), part * SAMPLE);
        x -= part * 2.0 * GAP;
    }
}

/// Shows how a series looks.
fn sample(scene: &mut Scene, series: &Series, (x, y): Point, long: f64) {
    let at = |part: f64, down: f64| (x + part * long, y + down);
    let (points, marks) = match series.style {
        Style::Band(_) => (vec![at(0.0, -5.0), at(1.0, -5.0), at(0.0, 5.0), at(1.0, 5.0)], Vec::new()),
        Style::Bars => (vec![at(0.5, 6.0), at(0.5, -6.0)], Vec::new()),
        _ => (vec![at(0.0, 0.0), at(1.0, 0.0)], vec![at(0.5, 0.0)]),
    };
    let everywhere = Frame { left: f64::MIN, right: f64::MAX, top: f64::MIN, bottom: f64::MAX };
    draw_series(scene, &everywhere, series, (&points, &marks));
}

impl Series {
    fn is_band(&self) -> bool {
        matches!(self.style, Style::Band(_))
    }
}

fn text(at: Point, text: &str, size: f64, anchor: Anchor) -> Text {
    Text { at, text: text.to_owned(), size, color: Color::Ink, anchor, upwards: false }
}

impl Scene {
    fn text(&mut self, at: Point, content: &str, size: f64, anchor: Anchor) {
        self.shapes.push(Shape::Text(text(at, content, size, anchor)));
    }

    fn line(&mut self, points: Vec<Point>, color: Color, width: f64) {
        self.shapes.push(Shape::Line { points, color, width, dashed: false });
    }
}
