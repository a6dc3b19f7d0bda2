//! The picture of a run: the state, and the errors of the conserved quantities, over time.

use super::{Axis, Color, Figure, Key, Panel, Series};
use crate::catalogue::quantities::by_key;
use crate::catalogue::{Entry, casimir};
use crate::record::{Curves, Envelope, Part, PartKind, parts};
use crate::units::with_unit;

const TIME: &str = "time, s";

/// Draws a panel for each part of the state, one for energy, and one for each Casimir.
pub(crate) fn figure(curves: &Curves, entry: &Entry, title: String) -> Figure {
    let mut panels = Vec::new();
    let mut state = curves.state.as_slice();
    for part in parts(entry) {
        let (own, others) = state.split_at(part.names().len().min(state.len()));
        panels.extend(state_panels(&part, own));
        state = others;
    }
    let mut add = |axis: Axis, series| panels.push(Panel::new(Axis::linear(TIME), axis, series));
    let energy = entry.energy_unit;
    if entry.conserves_energy() {
        let line = Series::line("", Color::X, curves.energy.upper());
        add(Axis::logarithmic(with_unit("energy error", energy)), vec![line]);
    } else {
        add(Axis::linear(with_unit("energy", energy)), series(&curves.energy, "", Color::X, 1.0));
    }
    for ((name, unit), envelope) in casimir::symbols_of(entry).zip(&curves.casimirs) {
        let label = with_unit(&format!("{name} error"), unit);
        add(Axis::logarithmic(label), vec![Series::line("", Color::X, envelope.upper())]);
    }
    Figure::over_time(title, TIME, curves.span, Key::Each, panels)
}

/// Writes the quantity in words.
fn label(part: &Part<'_>) -> String {
    let name = part.quantity.title();
    match (part.is_half, part.kind) {
        (true, PartKind::Vector) => format!("{name}, translation"),
        (true, _) => format!("{name}, rotation"),
        (false, _) => name,
    }
}

/// Tells the unit of a curve, and how many of it the recorded values' unit is: angles that go round many times are
/// counted in turns.
fn unit(part: &Part<'_>, k: usize, curve: &Envelope) -> (&'static str, f64) {
    let (low, high) = curve.range();
    match part.kind {
        PartKind::Vector => (part.units()[k], 1.0),
        _ if high - low > 720.0 => ("turns", 1.0 / 360.0),
        _ => ("degrees", 1.0),
    }
}

/// Draws panels with these curves, one for each unit.
fn state_panels(part: &Part<'_>, curves: &[Envelope]) -> Vec<Panel> {
    let curves = part.names().into_iter().zip(curves).enumerate().map(|(k, (name, curve))| {
        let (unit, scale) = unit(part, k, curve);
        let mut series = series(curve, &name.replace('_', " "), Color::component(k), scale);
        if k >= Color::COMPONENTS {
            // its colour is taken
            series.iter_mut().for_each(|series| series.style = series.style.dashed());
        }
        (unit, series)
    });
    let panels = by_key(curves);
    // alone, a curve needs a name only if others of its quantity are elsewhere
    let count = panels.len();
    let panel = |(unit, series): (&str, Vec<Vec<Series>>)| {
        let series = series.concat();
        let names: Vec<&str> =
            series.iter().map(|series| series.label.as_str()).filter(|label| !label.is_empty()).collect();
        let label = match names[..] {
            [name] if count > 1 => with_unit(&format!("{}: {name}", label(part)), unit),
            _ => with_unit(&label(part), unit),
        };
        Panel::new(Axis::linear(TIME), Axis::linear(label), series)
    };
    panels.into_iter().map(panel).collect()
}

/// Draws what a run did, in one colour: a line, and a light area with its edges where it goes up and down too fast for
/// a line.
pub fn series(curve: &Envelope, label: &str, color: Color, unit: f64) -> Vec<Series> {
    let scaled =
        |points: Vec<(f64, f64)>| points.into_iter().map(|(time, y)| (time, unit * y)).collect::<Vec<_>>();
    if !curve.is_fast() {
        return vec![Series::line(label, color, scaled(curve.both()))];
    }
    let (lower, upper) = curve.smoothed();
    let (lower, upper) = (scaled(lower), scaled(upper));
    vec![
        Series::band("", color, 0.2, lower.clone(), upper.clone()),
        Series::line("", color, lower),
        Series::line(label, color, upper),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Sample;
    use crate::tests::catalogue;

    #[test]
    fn axes_have_the_units_of_the_description() {
        let labels = |name: &str| {
            let entry = catalogue().system(name).expect("it is there");
            let mut curves = Curves::new(entry, (0.1, 2));
            for index in 0..3 {
                let (time, state) = (index as f64, &entry.example.state);
                curves.push(
                    entry,
                    &Sample { index, time, state, energy: 1.0, casimirs: &[0.0; 2], snapshot: &Vec::new },
                );
            }
            let panels = figure(&curves, entry, String::new()).panels;
            panels.into_iter().map(|panel| panel.y.label).collect::<Vec<String>>()
        };
        let top = ["attitude, degrees", "momentum, kg m²/s", "gamma", "energy error, J"];
        assert_eq!(labels("heavy_top")[..4], top);
        assert_eq!(labels("heavy_top")[4..], ["|Γ|² error", "Π·Γ error, kg m²/s"]);
        let body =
            ["pose, rotation, degrees", "pose, translation, m", "momentum, kg m²/s", "momentum, kg m/s"];
        assert_eq!(labels("rigid_body_in_space")[..4], body);
    }

    #[test]
    fn extremes_survive_in_order() {
        let mut envelope = Envelope::new(100_000, 50);
        let value = |i: u64| if i == 77_777 { 9.0 } else { (i as f64 * 0.37).sin() };
        for i in 0..100_000 {
            envelope.push(i, i as f64, value(i));
        }
        let [band, lower, upper] = &series(&envelope, "x", Color::X, 1.0)[..] else {
            panic!("a band and its edges")
        };
        assert_eq!((lower.points.len(), upper.points.len(), band.points.len()), (50, 50, 100));
        for line in [lower, upper] {
            assert!(line.points.is_sorted_by(|a, b| a.0 < b.0));
        }
        assert!(upper.points.contains(&(77_777.0, 9.0)));
        assert!(lower.points.iter().all(|point| point.1 < -0.99));
        assert_eq!(envelope.upper().len(), 50);
        assert!(envelope.upper().iter().all(|point| point.1 > 0.99));
    }

    #[test]
    fn short_series_stay_as_they_are() {
        let mut envelope = Envelope::new(3, 50);
        for i in 0..3 {
            envelope.push(i, i as f64, -(i as f64));
        }
        let [line] = &series(&envelope, "x", Color::X, 10.0)[..] else { panic!("a line") };
        assert_eq!(line.points, [(0.0, 0.0), (1.0, -10.0), (2.0, -20.0)]);
    }
}
