//! Clips lines to a frame.

use super::scene::Point;

/// A rectangle that series are drawn in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

/// Points this far outside are on the edge.
const ROUNDOFF: f64 = 1e-6;

impl Frame {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn holds(&self, (x, y): Point) -> bool {
        is_between(x, self.left, self.right) && is_between(y, self.top, self.bottom)
    }

    /// The point itself, or the one on the edge that is nearest.
    pub(super) fn nearest(&self, (x, y): Point) -> Point {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }

    /// From where to where the segment is within, as parts of it.
    fn part(&self, from: Point, to: Point) -> Option<(f64, f64)> {
        let (mut start, mut end) = (0.0_f64, 1.0_f64);
        let sides =
            [(from.0, to.0 - from.0, self.left, self.right), (from.1, to.1 - from.1, self.top, self.bottom)];
        for (at, change, low, high) in sides {
            if change == 0.0 {
                if !is_between(at, low, high) {
                    return None;
                }
                continue;
            }
            let (first, second) = ((low - at) / change, (high - at) / change);
            start = start.max(first.min(second));
            end = end.min(first.max(second));
        }
        (start <= end).then_some((start, end))
    }
}

fn is_between(at: f64, low: f64, high: f64) -> bool {
    (low - ROUNDOFF..=high + ROUNDOFF).contains(&at)
}

/// The pieces of a line that are within a frame; it is broken where it is not finite.
pub(super) fn clipped(points: &[Point], frame: &Frame) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    let mut goes_on = false;
    for pair in points.windows(2) {
        let &[from, to] = pair else { continue };
        let is_finite = [from.0, from.1, to.0, to.1].iter().all(|x| x.is_finite());
        let Some((start, end)) = frame.part(from, to).filter(|_| is_finite) else {
            goes_on = false;
            continue;
        };
        let at = |part: f64| (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
        match pieces.last_mut().filter(|_| goes_on && start == 0.0) {
            Some(piece) => piece.push(at(end)),
            None => pieces.push(vec![at(start), at(end)]),
        }
        goes_on = true;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 0.0, right: 10.0, top: 0.0, bottom: 10.0 };

    #[test]
    fn lines_end_at_the_edge() {
        assert_eq!(clipped(&[(2.0, 2.0), (8.0, 3.0)], &FRAME), [[(2.0, 2.0), (8.0, 3.0)]]);
        // out above, and back
        let peak = clipped(&[(0.0, 5.0), (5.0, -5.0), (10.0, 5.0)], &FRAME);
        assert_eq!(peak, [[(0.0, 5.0), (2.5, 0.0)], [(7.5, 0.0), (10.0, 5.0)]]);
        assert!(clipped(&[(-5.0, -1.0), (15.0, -1.0)], &FRAME).is_empty());
        // a line along the edge is seen
        assert_eq!(clipped(&[(0.0, 10.0), (10.0, 10.0)], &FRAME).len(), 1);
    }

    #[test]
    fn lines_are_broken_where_they_are_not_finite() {
        let points = [(1.0, 1.0), (2.0, 2.0), (3.0, f64::NAN), (4.0, 4.0), (5.0, 5.0), (6.0, f64::INFINITY)];
        assert_eq!(clipped(&points, &FRAME), [[(1.0, 1.0), (2.0, 2.0)], [(4.0, 4.0), (5.0, 5.0)]]);
    }
}
