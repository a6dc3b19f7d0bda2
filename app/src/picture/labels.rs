//! Names at the lines themselves, where they cover little; a thin line leads to those that are not close.

use super::Series;
use super::clip::{Frame, ROUNDOFF, clipped};
use super::font;
use super::scene::{Anchor, Point, Scene, Shape, Text};

/// A name with the point that it belongs to.
struct Candidate {
    area: Frame,
    point: Point,
}

impl Candidate {
    /// From the point to the text.
    fn leader(&self) -> [Point; 2] {
        [self.point, self.area.nearest(self.point)]
    }

    fn distance(&self) -> f64 {
        let [(x, y), (to_x, to_y)] = self.leader();
        (to_x - x).hypot(to_y - y)
    }
}

/// Text this far from its point needs a line that leads to it.
const CLOSE: f64 = 13.0;

/// Writes each series' name in its colour near one of its points: where the fewest others are.
pub(super) fn place(scene: &mut Scene, frame: &Frame, lines: &[(&Series, Vec<Point>)], size: f64) {
    let dense: Vec<Vec<Point>> = lines.iter().map(|(_, points)| dense(points, frame)).collect();
    let mut taken: Vec<Frame> = Vec::new();
    for (i, (series, points)) in lines.iter().enumerate() {
        if series.label.is_empty() {
            continue;
        }
        let width = font::width(&series.label, size);
        let mut best: Option<(f64, Candidate)> = None;
        for point in points.iter().copied().filter(|point| frame.grown(ROUNDOFF).holds(*point)) {
            for area in around(point, width, size) {
                let candidate = Candidate { area, point };
                let cost = cost(&candidate, i, &dense, &taken, frame);
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, candidate));
                }
            }
        }
        let Some((_, candidate)) = best else { continue };
        taken.push(candidate.area.grown(2.0));
        if candidate.distance() > CLOSE {
            let points = candidate.leader().to_vec();
            scene.shapes.push(Shape::Line { points, color: series.color, width: 0.8, dashed: false });
        }
        scene.shapes.push(Shape::Text(Text {
            at: (candidate.area.left, candidate.area.bottom - 0.3 * size),
            text: series.label.clone(),
            size,
            color: series.color,
            anchor: Anchor::Start,
            upwards: false,
            halo: true,
        }));
    }
}

/// How bad a place is: what it covers, what is so near that it could be meant, how far it is, and what its leader
/// crosses.
fn cost(candidate: &Candidate, own: usize, dense: &[Vec<Point>], taken: &[Frame], frame: &Frame) -> f64 {
    let Candidate { area, .. } = candidate;
    let inner = frame.grown(-3.0);
    if !inner.holds((area.left, area.top)) || !inner.holds((area.right, area.bottom)) {
        return f64::INFINITY;
    }
    let near = area.grown(12.0);
    let count =
        |points: &[Point], area: &Frame| points.iter().filter(|point| area.holds(**point)).count() as f64;
    let covered: f64 = dense.iter().map(|points| 3.0 * count(points, area)).sum();
    let others = dense.iter().enumerate().filter(|(k, _)| *k != own);
    let misleading: f64 = others.map(|(_, points)| count(points, &near)).sum();
    let overlaps = taken.iter().filter(|other| area.meets(other)).count() as f64;
    let distance = candidate.distance();
    let [(x, y), (to_x, to_y)] = candidate.leader();
    let crossed: f64 = (2..=(distance / 5.0) as usize)
        .map(|k| {
            let part = k as f64 * 5.0 / distance;
            let (x, y) = (x + part * (to_x - x), y + part * (to_y - y));
            let here = Frame { left: x, right: x, top: y, bottom: y }.grown(3.0);
            let others = dense.iter().enumerate().filter(|(k, _)| *k != own);
            others.map(|(_, points)| count(points, &here)).sum::<f64>()
        })
        .sum();
    covered + misleading + 2.0 * crossed + 200.0 * overlaps + 0.15 * distance
}

/// Boxes around a point, near and far, in eight directions.
fn around((x, y): Point, width: f64, size: f64) -> impl Iterator<Item = Frame> {
    let half = 0.65 * size;
    [8.0, 30.0, 60.0, 95.0].into_iter().flat_map(move |apart| {
        let area = move |left: f64, middle: f64| Frame {
            left,
            right: left + width,
            top: middle - half,
            bottom: middle + half,
        };
        let (right, left) = (x + apart, x - apart - width);
        let (above, below) = (y - half - 0.7 * apart, y + half + 0.7 * apart);
        [
            area(right, y),
            area(left, y),
            area(right, above),
            area(left, above),
            area(right, below),
            area(left, below),
            area(x - 0.5 * width, above),
            area(x - 0.5 * width, below),
        ]
    })
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
