//! Names at the lines themselves, where they cover little.

use super::Series;
use super::clip::{Frame, clipped};
use super::font;
use super::scene::{Anchor, Point, Scene, Shape, Text};

/// A box around a text.
#[derive(Clone, Copy)]
struct Area {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Area {
    fn holds(&self, (x, y): Point) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    fn meets(&self, other: &Area) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// Writes each series' name in its colour beside one of its points: where the fewest others are near.
pub(super) fn place(scene: &mut Scene, frame: &Frame, lines: &[(&Series, Vec<Point>)], size: f64) {
    let dense: Vec<Vec<Point>> = lines.iter().map(|(_, points)| dense(points, frame)).collect();
    let mut taken: Vec<Area> = Vec::new();
    for (i, (series, _)) in lines.iter().enumerate() {
        if series.label.is_empty() {
            continue;
        }
        let width = font::width(&series.label, size);
        let cost = |area: &Area, point: Point| {
            let covered: f64 = dense
                .iter()
                .enumerate()
                .map(|(k, points)| {
                    let weight = if k == i { 1.0 } else { 2.0 };
                    weight * points.iter().filter(|point| area.holds(**point)).count() as f64
                })
                .sum();
            // others that are nearer than its own line mislead
            let near = Area {
                left: point.0 - 16.0,
                right: point.0 + 16.0,
                top: point.1 - 16.0,
                bottom: point.1 + 16.0,
            };
            let misleading = dense.iter().enumerate().filter(|(k, _)| *k != i);
            let misleading: usize =
                misleading.map(|(_, points)| points.iter().filter(|point| near.holds(**point)).count()).sum();
            let overlaps = taken.iter().filter(|other| area.meets(other)).count() as f64;
            let outside = area.left < frame.left + 3.0
                || area.right > frame.right() - 3.0
                || area.top < frame.top + 3.0
                || area.bottom > frame.bottom() - 3.0;
            covered + 0.5 * misleading as f64 + 100.0 * overlaps + if outside { 1e4 } else { 0.0 }
        };
        let mut best: Option<(f64, Area)> = None;
        for &point in dense.get(i).into_iter().flatten() {
            for area in around(point, width, size) {
                let cost = cost(&area, point);
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, area));
                }
            }
        }
        let Some((_, area)) = best else { continue };
        taken.push(area);
        scene.shapes.push(Shape::Text(Text {
            at: (area.left, area.bottom - 0.3 * size),
            text: series.label.clone(),
            size,
            color: series.color,
            anchor: Anchor::Start,
            upwards: false,
            halo: true,
        }));
    }
}

/// Boxes right of a point, left of it, and to both sides above and below.
fn around((x, y): Point, width: f64, size: f64) -> [Area; 6] {
    let (apart, half) = (8.0, 0.65 * size);
    let area = |left: f64, middle: f64| Area {
        left,
        right: left + width,
        top: middle - half,
        bottom: middle + half,
    };
    let (above, below) = (y - half - 3.0, y + half + 3.0);
    [
        area(x + apart, y),
        area(x - apart - width, y),
        area(x + apart, above),
        area(x - apart - width, above),
        area(x + apart, below),
        area(x - apart - width, below),
    ]
}

/// Points along a line, some units apart.
fn dense(points: &[Point], frame: &Frame) -> Vec<Point> {
    const APART: f64 = 5.0;
    let mut dense = Vec::new();
    for piece in clipped(points, frame) {
        for pair in piece.windows(2) {
            let &[(x, y), (to_x, to_y)] = pair else { continue };
            let parts = ((to_x - x).hypot(to_y - y) / APART).ceil().max(1.0);
            for k in 0..parts as usize {
                let part = k as f64 / parts;
                dense.push((x + part * (to_x - x), y + part * (to_y - y)));
            }
        }
    }
    dense
}
