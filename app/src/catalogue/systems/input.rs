//! Inputs from tables: controls that are functions of time.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Entry, quantities};
use crate::error::SetupError;

/// Interpolates between the rows of an input's table, by scipy's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// A cubic spline whose second derivative is continuous; not-a-knot at its ends, as scipy's `CubicSpline`
    #[default]
    Cubic,
    /// Straight lines
    Linear,
    /// The row before
    Previous,
}

/// Controls as functions of time, from the rows of a table. Before the first row and after the last one they are held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// The file that it was read from.
    pub file: PathBuf,
    /// How it is interpolated.
    pub interpolation: Interpolation,
    times: Vec<f64>,
    /// The place of a control's component, and from each row on a polynomial in the time since it.
    columns: Vec<(usize, Vec<[f64; 4]>)>,
}

impl Input {
    /// Reads a table: a column `time`, and one for each component of a control, under its name.
    ///
    /// # Errors
    /// If a column has another name or stands there twice, a cell is no finite number, times do not increase, or there are no two rows.
    pub fn parse(
        entry: &Entry,
        file: PathBuf,
        text: &str,
        interpolation: Interpolation,
    ) -> Result<Self, SetupError> {
        let wrong = |reason: String| SetupError::new(reason).within(file.display());
        let mut reader = csv::ReaderBuilder::new();
        let mut reader = reader.trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        let unread = |error: csv::Error| wrong(error.to_string());
        let header = reader.headers().map_err(unread)?.clone();
        let names: Vec<String> =
            quantities::components(entry.description.controls).map(|component| component.name).collect();
        let listed = || match &names[..] {
            [] => "it has none".to_owned(),
            names => format!("it has {}", names.join(", ")),
        };
        let mut places = Vec::new();
        for name in header.iter().skip(1) {
            let place = names.iter().position(|known| known == name);
            let place = place
                .ok_or_else(|| wrong(format!("`{}` has no control `{name}`: {}", entry.name, listed())))?;
            if places.contains(&place) {
                return Err(wrong(format!("there are two columns `{name}`")));
            }
            places.push(place);
        }
        if header.get(0) != Some("time") || places.is_empty() {
            let reason = format!(
                "the first column is `time`, and each other one a control of `{}`: {}",
                entry.name,
                listed()
            );
            return Err(wrong(reason));
        }
        let (mut times, mut values) = (Vec::new(), vec![Vec::new(); places.len()]);
        for row in reader.deserialize::<Vec<f64>>() {
            let row = row.map_err(unread)?;
            if let Some(number) = row.iter().find(|number| !number.is_finite()) {
                return Err(wrong(format!("row {}: {number} is not finite", times.len() + 1)));
            }
            if times.last().is_some_and(|last| *last >= row[0]) {
                return Err(wrong(format!("row {}: times must increase", times.len() + 1)));
            }
            times.push(row[0]);
            values.iter_mut().zip(&row[1..]).for_each(|(column, value)| column.push(*value));
        }
        if times.len() < 2 {
            return Err(wrong("a table has two rows or more".to_owned()));
        }
        let pieces = values.iter().map(|values| pieces(&times, values, interpolation));
        let columns = places.into_iter().zip(pieces).collect();
        Ok(Self { file, interpolation, times, columns })
    }

    /// Writes the controls at a time; those that are no column stay.
    pub fn write(&self, time: f64, controls: &mut [f64]) {
        let row = self.times.partition_point(|start| *start <= time).saturating_sub(1);
        let since = (time - self.times[row]).max(0.0);
        for (place, pieces) in &self.columns {
            let [a, b, c, d] = pieces[row];
            controls[*place] = a + since * (b + since * (c + since * d));
        }
    }

    /// Tells whether it has a column for the control's component at this place.
    pub(crate) fn drives(&self, place: usize) -> bool {
        self.columns.iter().any(|(column, _)| *column == place)
    }

    /// Lists all numbers that it is made of.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let columns = self.columns.iter().flat_map(|(place, pieces)| {
            std::iter::once(*place as f64).chain(pieces.iter().flatten().copied())
        });
        self.times.iter().copied().chain(columns)
    }
}

/// The polynomials from row to row; after the last one a constant.
fn pieces(times: &[f64], values: &[f64], interpolation: Interpolation) -> Vec<[f64; 4]> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let slopes: Vec<f64> =
        values.windows(2).zip(&steps).map(|(pair, step)| (pair[1] - pair[0]) / step).collect();
    let tangents = match interpolation {
        Interpolation::Cubic => tangents(&steps, &slopes),
        Interpolation::Linear | Interpolation::Previous => Vec::new(),
    };
    let piece = |k: usize| match (interpolation, slopes.get(k)) {
        (Interpolation::Linear, Some(slope)) => [values[k], *slope, 0.0, 0.0],
        (Interpolation::Cubic, Some(slope)) => {
            // Hermite's cubic with these tangents
            let bend = (tangents[k] + tangents[k + 1] - 2.0 * slope) / steps[k];
            [values[k], tangents[k], (slope - tangents[k]) / steps[k] - bend, bend / steps[k]]
        }
        _ => [values[k], 0.0, 0.0, 0.0],
    };
    (0..values.len()).map(piece).collect()
}

/// The derivatives at the rows with which the second ones are continuous, and the third ones at the second row and the last but one.
fn tangents(h: &[f64], slopes: &[f64]) -> Vec<f64> {
    let last = h.len();
    match *slopes {
        [slope] => return vec![slope; 2],
        // one parabola
        [first, second] => {
            let middle = (h[1] * first + h[0] * second) / (h[0] + h[1]);
            return vec![2.0 * first - middle, middle, 2.0 * second - middle];
        }
        _ => {}
    }
    // below, on and above the diagonal, and the right side
    let end = |near: f64, far: f64, first: f64, second: f64| {
        ((near + 2.0 * (near + far)) * far * first + near * near * second) / (near + far)
    };
    let mut rows = vec![[0.0, h[1], h[0] + h[1], end(h[0], h[1], slopes[0], slopes[1])]];
    rows.extend((1..last).map(|k| {
        let right = 3.0 * (h[k] * slopes[k - 1] + h[k - 1] * slopes[k]);
        [h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1], right]
    }));
    let (near, far) = (h[last - 1], h[last - 2]);
    rows.push([near + far, far, 0.0, end(near, far, slopes[last - 1], slopes[last - 2])]);
    for k in 1..rows.len() {
        let [_, diagonal, above, right] = rows[k - 1];
        let factor = rows[k][0] / diagonal;
        rows[k][1] -= factor * above;
        rows[k][3] -= factor * right;
    }
    let mut tangents = vec![0.0; rows.len()];
    for (k, [_, diagonal, above, right]) in rows.iter().enumerate().rev() {
        let next = tangents.get(k + 1).copied().unwrap_or(0.0);
        tangents[k] = (right - above * next) / diagonal;
    }
    tangents
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    fn parsed(text: &str, interpolation: Interpolation) -> Result<Input, String> {
        let pendulum = catalogue().find("planar_pendulum").expect("it is there");
        let file = PathBuf::from("torque.csv");
        Input::parse(pendulum, file, text, interpolation).map_err(|error| error.to_string())
    }

    fn at(input: &Input, time: f64) -> f64 {
        let mut control = [f64::NAN];
        input.write(time, &mut control);
        control[0]
    }

    const TIMES: [f64; 6] = [0.0, 0.5, 0.8, 2.0, 2.1, 3.5];

    fn table(value: impl Fn(f64) -> f64, rows: usize) -> String {
        let rows = TIMES[..rows].iter().map(|time| format!("{time:?}, {:?}\n", value(*time)));
        format!("time, torque_x\n{}", rows.collect::<String>())
    }

    #[test]
    fn a_polynomial_is_reproduced_by_as_many_rows_as_it_needs() {
        let polynomials: [fn(f64) -> f64; 3] =
            [|t| 1.5 - 0.25 * t, |t| 1.0 - t + 3.0 * t * t, |t| 0.5 - 2.0 * t + t * t - 0.7 * t * t * t];
        for (degree, value) in (1..).zip(polynomials) {
            for rows in degree + 1..=6 {
                let input = parsed(&table(value, rows), Interpolation::Cubic).expect("a table");
                for k in 0..=100 {
                    let time = f64::from(k) / 100.0 * TIMES[rows - 1];
                    let error = at(&input, time) - value(time);
                    assert!(error.abs() < 1e-13, "degree {degree}, {rows} rows, {time}: {error}");
                }
            }
        }
    }

    #[test]
    fn a_spline_has_two_continuous_derivatives_and_is_held_outside() {
        let values = [1.0, -0.5, 2.0, 0.3, 0.4, -1.0];
        let slopes = |row: usize, since: f64| {
            let steps: Vec<f64> = TIMES.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!((0.0..=steps[row]).contains(&since));
            let [a, b, c, d] = pieces(&TIMES, &values, Interpolation::Cubic)[row];
            [
                a + since * (b + since * (c + since * d)),
                b + since * (2.0 * c + since * 3.0 * d),
                2.0 * c + since * 6.0 * d,
                6.0 * d,
            ]
        };
        for row in 1..5 {
            let (before, after) = (slopes(row - 1, TIMES[row] - TIMES[row - 1]), slopes(row, 0.0));
            let continuous = if row == 1 || row == 4 { 4 } else { 3 };
            for k in 0..continuous {
                let size = before[k].abs().max(1.0);
                assert!((before[k] - after[k]).abs() < 1e-12 * size, "row {row}: {before:?}, {after:?}");
            }
            // it is a spline, not one polynomial
            assert!(continuous == 4 || (before[3] - after[3]).abs() > 1.0);
        }
        let text = format!(
            "# recorded\ntime,torque_x\n{}",
            TIMES.iter().zip(values).map(|(t, y)| format!("{t},{y}\n")).collect::<String>()
        );
        for interpolation in [Interpolation::Cubic, Interpolation::Linear, Interpolation::Previous] {
            let input = parsed(&text, interpolation).expect("a table");
            assert_eq!(TIMES.map(|time| at(&input, time)), values);
            assert_eq!([-7.0, 3.5, 99.0].map(|time| at(&input, time)), [1.0, -1.0, -1.0]);
        }
        let linear = parsed(&text, Interpolation::Linear).expect("a table");
        assert!((at(&linear, 0.65) - 0.75).abs() < 1e-15 && (at(&linear, 2.8) + 0.3).abs() < 1e-15);
        let previous = parsed(&text, Interpolation::Previous).expect("a table");
        assert_eq!([0.49, 0.5, 1.99].map(|time| at(&previous, time)), [1.0, -0.5, 2.0]);
    }

    #[test]
    fn what_is_no_table_of_inputs_is_refused() {
        let refused = |text: &str| parsed(text, Interpolation::Cubic).expect_err(text);
        for (text, reason) in [
            ("time,thrust\n0,1\n1,2\n", "`planar_pendulum` has no control `thrust`: it has torque_x"),
            ("torque_x,time\n0,1\n1,2\n", "`planar_pendulum` has no control `time`"),
            ("time\n0\n1\n", "the first column is `time`, and each other one a control"),
            ("time,torque_x,torque_x\n0,1,1\n1,2,2\n", "there are two columns `torque_x`"),
            ("time,torque_x\n0,1\n", "a table has two rows or more"),
            ("", "the first column is `time`"),
            ("time,torque_x\n0,1\n1,2\n1,3\n", "row 3: times must increase"),
            ("time,torque_x\n0,1\nnan,2\n", "row 2: NaN is not finite"),
            ("time,torque_x\n0,1\n1,inf\n", "row 2: inf is not finite"),
            ("time,torque_x\n0,1\n1,much\n", "invalid float literal"),
            ("time,torque_x\n0,1\n1\n", "found record with 1 fields"),
        ] {
            let message = refused(text);
            assert!(message.starts_with("torque.csv: ") && message.contains(reason), "{text:?}: {message}");
        }
    }
}
