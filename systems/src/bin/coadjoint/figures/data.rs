//! The numbers that a figure is drawn from, as its CSV has them. Captions are computed from nothing else.

use coadjoint_app::files::table;
use coadjoint_app::picture::Figure;

/// All series of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Data(Vec<Column>);

/// One series, and where it is drawn.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    /// Counted from 1.
    panel: usize,
    horizontal: String,
    vertical: String,
    name: String,
    points: Vec<(f64, f64)>,
}

/// The points of one series.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve<'a>(&'a [(f64, f64)]);

impl Data {
    /// What is drawn.
    pub(crate) fn of(figure: &Figure) -> Self {
        let panels = figure.panels.iter().zip(1..);
        let columns = panels.flat_map(|(panel, number)| {
            panel.series.iter().map(move |series| Column {
                panel: number,
                horizontal: panel.x.label.clone(),
                vertical: panel.y.label.clone(),
                name: series.label.clone(),
                points: series.points.clone(),
            })
        });
        Self(columns.collect())
    }

    /// A line for each point. The ends of bands and bars come one after the other: all lower ones, then all upper ones.
    pub(crate) fn csv(&self) -> Vec<u8> {
        let header = ["panel", "horizontal", "vertical", "series", "x", "y"].map(str::to_owned).to_vec();
        let records = self.0.iter().flat_map(|Column { panel, horizontal, vertical, name, points }| {
            let texts = [panel.to_string(), horizontal.clone(), vertical.clone(), name.clone()];
            // the numbers read back as they are
            points.iter().map(move |(x, y)| [&texts[..], &[format!("{x:?}"), format!("{y:?}")]].concat())
        });
        table(&std::iter::once(header).chain(records).collect::<Vec<_>>())
    }

    /// The points of a series in a panel, which is counted from 1; none if it has no such series.
    pub(crate) fn curve(&self, panel: usize, name: &str) -> Curve<'_> {
        let column = self.0.iter().find(|column| column.panel == panel && column.name == name);
        Curve(column.map_or(&[], |column| &column.points))
    }
}

impl<'a> Curve<'a> {
    pub(crate) fn points(self) -> &'a [(f64, f64)] {
        self.0
    }

    /// The values of y.
    pub(crate) fn values(self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + 'a {
        self.0.iter().map(|point| point.1)
    }

    /// Their largest magnitude.
    pub(crate) fn largest(self) -> f64 {
        self.values().map(f64::abs).fold(0.0, f64::max)
    }

    /// The least of them and the greatest.
    pub(crate) fn range(self) -> (f64, f64) {
        self.values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)))
    }

    /// The last of them.
    pub(crate) fn last(self) -> f64 {
        self.values().next_back().unwrap_or(f64::NAN)
    }

    /// The largest magnitudes in the first fifth of the points, and in the last.
    pub(crate) fn ends(self) -> (f64, f64) {
        let fifth = self.0.len().div_ceil(5);
        let (first, last) = (&self.0[..fifth], &self.0[self.0.len() - fifth..]);
        (Curve(first).largest(), Curve(last).largest())
    }

    /// Whether it is much larger at the end than it was in the beginning.
    pub(crate) fn grows(self) -> bool {
        let (first, last) = self.ends();
        last > 2.0 * first
    }

    /// The two halves of a band or of bars: the lower ends, and the upper ones.
    pub(crate) fn halves(self) -> (Curve<'a>, Curve<'a>) {
        let (lower, upper) = self.0.split_at(self.0.len() / 2);
        (Curve(lower), Curve(upper))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    impl Data {
        /// As a CSV has it.
        pub(crate) fn from_csv(text: &str) -> Self {
            let mut columns: Vec<Column> = Vec::new();
            for record in csv::Reader::from_reader(text.as_bytes()).into_records() {
                let record: Vec<String> = record.expect("a record").iter().map(str::to_owned).collect();
                let [panel, horizontal, vertical, name, x, y] = record.try_into().expect("six fields");
                let point = (x.parse().expect("x"), y.parse().expect("y"));
                let panel = panel.parse().expect("a number");
                match columns.last_mut().filter(|last| last.panel == panel && last.name == name) {
                    Some(column) => column.points.push(point),
                    None => columns.push(Column { panel, horizontal, vertical, name, points: vec![point] }),
                }
            }
            Self(columns)
        }

        /// Panels, names and how many points.
        pub(crate) fn columns(&self) -> impl Iterator<Item = (usize, &str, usize)> {
            self.0.iter().map(|column| (column.panel, column.name.as_str(), column.points.len()))
        }
    }

    #[test]
    fn curves_say_what_they_do() {
        let points: Vec<(f64, f64)> = [1.0, -2.0, 3.0, -4.0, 3.5].into_iter().map(|y| (0.0, y)).collect();
        let curve = Curve(&points);
        assert_eq!((curve.largest(), curve.range(), curve.last()), (4.0, (-4.0, 3.5), 3.5));
        assert_eq!((curve.ends(), curve.grows()), ((1.0, 3.5), true));
        assert_eq!((curve.halves().0.points().len(), curve.halves().1.points().len()), (2, 3));
        let none = Curve(&[]);
        assert!(none.last().is_nan() && none.largest() == 0.0 && !none.grows());
    }
}
