//! The picture of a run: the state, and the errors of the conserved quantities, over time.

use super::{Axis, Color, Figure, Key, Panel, Series};
use crate::catalogue::plotted::PlottedQuantity;
use crate::catalogue::quantities::by_key;
use crate::catalogue::{Entry, casimir};
use crate::record::{Curves, Envelope, Part, PartKind, parts};
use crate::units::{range, with_unit};

const TIME: &str = "time, s";

/// A curve with its name in a panel, its unit, and how many of it the recorded values' unit is.
type Named<'c> = (String, &'c str, f64, &'c Envelope);

/// Draws a panel for each part of the state, one for energy, and one for each Casimir; the elements of an array share
/// their panels.
pub(crate) fn figure(curves: &Curves, entry: &Entry, title: String) -> Figure {
    let mut state = curves.state.as_slice();
    let mut drawn = Vec::new();
    for part in parts(entry) {
        let (own, others) = state.split_at(part.names().len().min(state.len()));
        let (name, place) =
            entry.plotted.array(part.quantity).unwrap_or_else(|| (part.quantity.name.clone(), String::new()));
        drawn.push(((name, part.kind), (place, part, own)));
        state = others;
    }
    let mut panels: Vec<Panel> = by_key(drawn.into_iter())
        .iter()
        .flat_map(|((name, _), elements)| panels_of(name, elements))
        .collect();
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
    Figure::over_time(title, TIME, curves.span, Key::Each, panels).in_columns()
}

/// Writes a part of a quantity of this name in words.
fn label(part: &Part<'_>, name: &str) -> String {
    let name = PlottedQuantity::title(name);
    match (part.is_half, part.kind) {
        (true, PartKind::Vector) => format!("{name}, translation"),
        (true, _) => format!("{name}, rotation"),
        (false, _) => name,
    }
}

/// Tells the unit of curves in one panel: angles that go round many times are counted in turns.
fn unit<'p>(part: &'p Part<'_>, k: usize, curves: &[&Envelope]) -> (&'p str, f64) {
    let ends = curves.iter().map(|curve| curve.range()).flat_map(|(low, high)| [low, high]);
    let (low, high) = range(ends.filter(|end| end.is_finite()));
    match part.kind {
        PartKind::Vector => (&part.units()[k], 1.0),
        _ if high - low > 720.0 => ("turns", 1.0 / 360.0),
        _ => ("degrees", 1.0),
    }
}

/// Draws the panels of a quantity, or of the elements of an array of this name: of many one for each component, with a
/// colour for each element.
fn panels_of(name: &str, elements: &[(String, Part<'_>, &[Envelope])]) -> Vec<Panel> {
    let Some((_, part, first)) = elements.first() else { return Vec::new() };
    let count = first.len();
    if elements.len() == 1 || elements.len() < count {
        let panels = elements.iter().flat_map(|(_, part, curves)| {
            let named = part.names().into_iter().zip(*curves).enumerate().map(|(k, (name, curve))| {
                let (unit, scale) = unit(part, k, &[curve]);
                (name.replace('_', " "), unit, scale, curve)
            });
            panels(&label(part, &part.quantity.name), named.collect())
        });
        return panels.collect();
    }
    let of_component = |k: usize| {
        let curves: Vec<&Envelope> = elements.iter().filter_map(|(_, _, curves)| curves.get(k)).collect();
        let (unit, scale) = unit(part, k, &curves);
        let places = elements.iter().map(|(place, _, _)| place.clone());
        let named = places.zip(curves).map(|(place, curve)| (place, unit, scale, curve)).collect();
        let component = if count == 1 { "" } else { part.names()[k] };
        panels(format!("{} {}", label(part, name), component.replace('_', " ")).trim_end(), named)
    };
    (0..count).flat_map(of_component).collect()
}

/// Draws panels with these curves, one for each unit.
fn panels(label: &str, curves: Vec<Named<'_>>) -> Vec<Panel> {
    let curves = curves.into_iter().enumerate().map(|(k, (name, unit, scale, curve))| {
        let mut series = series(curve, &name, Color::component(k), scale);
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
            [name] if count > 1 => with_unit(&format!("{label}: {name}"), unit),
            _ => with_unit(label, unit),
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
    use coadjoint::prelude::*;

    use super::*;
    use crate::Example;
    use crate::record::{Recorders, Sample};
    use crate::tests::catalogue;

    #[test]
    fn axes_have_the_units_of_the_description() {
        let labels = |name: &str| {
            let entry = catalogue().system(name).expect("it is there");
            let mut curves = Curves::new(entry, (0.1, 2));
            for index in 0..3 {
                let sample = Sample::of_state(&entry.example.state);
                let (time, casimirs) = (index as f64, &[0.0; 2]);
                curves.push(entry, &Sample { index, time, casimirs, ..sample }, &[]);
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

    /// Three wheels, and three spins.
    #[lie_poisson_system(
        group(wheels: [SO2; 3], spins: [SO3; 3]),
        retractions(Cayley),
        units(wheels_momentum = "kg m²/s"),
    )]
    struct Rotors {
        #[inertia(wheels)]
        wheel: f64,
        #[inertia(spins)]
        spin: Vector3<f64>,
    }

    impl Example for Rotors {
        fn example() -> (Self, RotorsState) {
            let start = RotorsState {
                wheels: [UnitComplex::identity(); 3],
                wheels_momentum: [vector![0.0], vector![1.0], vector![2.0]],
                spins: [UnitQuaternion::identity(); 3],
                spins_momentum: [Vector3::zeros(); 3],
            };
            (Self { wheel: 1.0, spin: Vector3::repeat(1.0) }, start)
        }
    }

    #[test]
    fn elements_of_an_array_share_a_panel_with_a_colour_each() {
        let entry = Rotors::entry();
        let mut recorders = Recorders::of(Some(Curves::new(&entry, (10.0, 40))), None);
        let system = entry.system(&entry.example.parameters);
        for index in 0..=40 {
            let time = 10.0 * index as f64;
            let mut state = entry.example.state.clone();
            for (wheel, rate) in [(0, 0.0), (1, 1.0), (2, 2.0)] {
                state[3 * wheel..3 * wheel + 2].copy_from_slice(&[(rate * time).cos(), (rate * time).sin()]);
            }
            recorders.push(&entry, &*system, &Sample { index, time, ..Sample::of_state(&state) });
        }
        let figure = figure(recorders.curves.as_ref().expect("asked for"), &entry, String::new());
        let panels: Vec<(&str, Vec<&str>)> = figure
            .panels
            .iter()
            .map(|panel| {
                (panel.y.label.as_str(), panel.series.iter().map(|series| series.label.as_str()).collect())
            })
            .collect();
        let names = vec!["0", "1", "2"];
        let labels = [
            "wheels, turns",
            "wheels momentum, kg m²/s",
            "spins roll, degrees",
            "spins pitch, degrees",
            "spins yaw, degrees",
            "spins momentum x",
            "spins momentum y",
            "spins momentum z",
        ];
        assert_eq!(panels[..8], labels.map(|label| (label, names.clone())));
        let wheels = &figure.panels[0].series;
        assert_eq!([0, 1, 2].map(|k| wheels[k].color), [Color::X, Color::Y, Color::Z]);
        // each as many turns as it has made, though a step has more than one
        for (k, rate) in [0.0, 1.0, 2.0].into_iter().enumerate() {
            let (time, turns) = *wheels[k].points.last().expect("points");
            assert!((turns - rate * time / std::f64::consts::TAU).abs() < 1e-9, "{k}: {turns} at {time}");
        }
        assert!(figure.columns > 1 && figure.panels.len().div_ceil(figure.columns) <= 5);
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
