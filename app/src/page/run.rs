//! The page of a run: its system's scene at each sample, curves, and what made it.

use coadjoint::system::{Quantity, Role};

use super::format::{Detail, DetailValue, FORMAT, Page, Plot, Run, Scale, Series, Space};
use crate::catalogue::plotted::PlottedQuantity;
use crate::catalogue::quantities::by_key;
use crate::catalogue::{ControlLaw, Entry, casimir, program, unit};
use crate::record::{PageRecorder, PageSamples};
use crate::scene::{self, Frames, rounded};

/// The heading of a run's page.
pub(crate) struct PageHeading<'a> {
    /// The system and its scheme.
    pub(crate) title: String,
    pub(crate) parameters: &'a [f64],
    /// s
    pub(crate) step: f64,
    pub(crate) steps: u64,
    /// The control law, where it is known.
    pub(crate) law: Option<ControlLaw>,
}

/// Builds the page of a run.
pub(crate) fn page(recorder: &PageRecorder, entry: &Entry, heading: &PageHeading<'_>) -> Page {
    let samples = recorder.samples();
    let scene = scene::scene(entry, heading.parameters);
    let frames = Frames::new(entry, &samples.kept, heading.law.as_ref());
    let plots = Plots { entry, samples: &samples, states: &frames.states };
    let run = Run {
        name: heading.title.clone(),
        bodies: (0..scene.bodies.len()).map(|k| frames.body(&scene, k)).collect(),
        arrows: scene.arrows.iter().filter_map(|arrow| frames.arrow(&scene, arrow)).collect(),
        links: scene.links.clone(),
        plots: plots.all(),
        turn: Some(rounded(samples.turn)),
        rate: Some(rounded(samples.rate)),
        ..Run::default()
    };
    Page {
        format: FORMAT.to_owned(),
        title: entry.name.clone(),
        about: entry.about.to_owned(),
        subtitle: format!("{}, {} steps", heading.title, heading.steps),
        details: details(entry, heading),
        time: samples.kept.iter().map(|sample| sample.time).collect(),
        space: Space { axes: scene::axes(entry, &scene), ground: scene.ground, ..Space::default() },
        runs: vec![run],
    }
}

fn details(entry: &Entry, heading: &PageHeading<'_>) -> Vec<Detail> {
    let detail =
        |name: &str, value, unit: &str| Detail { name: name.to_owned(), value, unit: unit.to_owned() };
    let mut details = Vec::new();
    for (quantity, slots) in Quantity::with_ranges(entry.description.parameters) {
        let value = match heading.parameters.get(slots).unwrap_or_default() {
            [one] => DetailValue::Number(*one),
            several => DetailValue::Numbers(several.to_vec()),
        };
        details.push(detail(quantity.name, value, unit(quantity)));
    }
    let made = DetailValue::Text(program().join(" "));
    details.extend([
        detail("scheme", DetailValue::Text(heading.title.clone()), ""),
        detail("step", DetailValue::Number(heading.step), "s"),
        detail("steps", DetailValue::Number(heading.steps as f64), ""),
        detail("made by", made, ""),
    ]);
    details
}

/// Draws curves of the samples.
struct Plots<'a> {
    entry: &'a Entry,
    samples: &'a PageSamples<'a>,
    /// The plotted numbers of the state at each sample.
    states: &'a [Vec<f64>],
}

impl Plots<'_> {
    /// Draws each quantity, and the errors of what is conserved.
    fn all(&self) -> Vec<Plot> {
        let quantities = self.entry.plotted.all();
        let mut plots: Vec<Plot> = quantities.iter().flat_map(|quantity| self.plots_of(quantity)).collect();
        plots.extend(self.errors());
        plots
    }

    /// Draws a quantity.
    fn plots_of(&self, quantity: &PlottedQuantity) -> Vec<Plot> {
        let start = quantity.slots.start;
        let names: Vec<String> = match &quantity.components[..] {
            [_] => vec![String::new()],
            names => names.iter().map(|name| name.replace('_', " ")).collect(),
        };
        let series = |places: &[usize]| -> Vec<Series> {
            places.iter().map(|&k| self.series(&names[k], |state| state[start + k])).collect()
        };
        let title = if quantity.is_of_a_matrix { quantity.title() } else { quantity.name.clone() };
        let plot = |part: &str, unit: &str, series| Plot {
            name: if part.is_empty() || part == title { title.clone() } else { format!("{title}, {part}") },
            unit: unit.to_owned(),
            shown: quantity.role == Role::Momentum,
            series,
            ..Plot::default()
        };
        let all: Vec<usize> = (0..names.len()).collect();
        match quantity.rotation {
            2 if names.len() == 2 => {
                let part = if quantity.name.contains("angle") { "" } else { "angle" };
                vec![plot(part, "rad", vec![self.angle(start)])]
            }
            count @ 1.. => {
                let turning = match count {
                    2 => plot("angle", "rad", vec![self.angle(start)]),
                    _ => plot("rotation", "", series(&all[..count])),
                };
                let moving = (count < all.len())
                    .then(|| plot("position", quantity.units[count], series(&all[count..])));
                std::iter::once(turning).chain(moving).collect()
            }
            0 => {
                let parts = by_key(quantity.units.iter().copied().zip(0..));
                let one = |(unit, places): &(&str, Vec<usize>)| {
                    let part = if parts.len() == 1 { String::new() } else { common(&names, places) };
                    plot(&part, unit, series(places))
                };
                parts.iter().map(one).collect()
            }
        }
    }

    fn series(&self, name: &str, of: impl Fn(&[f64]) -> f64) -> Series {
        let values = self.states.iter().map(|state| rounded(of(state))).collect();
        Series { name: name.to_owned(), values, ..Series::default() }
    }

    /// The angle of a rotation in the plane, which goes on where it has turned all around.
    fn angle(&self, slot: usize) -> Series {
        let mut angle = 0.0;
        let angles = self.states.iter().map(|state| {
            let now = state[slot + 1].atan2(state[slot]);
            let turn = std::f64::consts::TAU;
            angle = now + turn * ((angle - now) / turn).round();
            rounded(angle)
        });
        Series { values: angles.collect(), ..Series::default() }
    }

    fn errors(&self) -> Vec<Plot> {
        let kept = &self.samples.kept;
        let plot = |name: String, unit: &str, scale, colour: &str, values: Vec<f64>| Plot {
            name,
            unit: unit.to_owned(),
            scale,
            shown: false,
            series: vec![Series { values, colour: Some(colour.to_owned()), ..Series::default() }],
        };
        let errors = |of: &dyn Fn(usize) -> f64| (0..kept.len()).map(|k| rounded(of(k) - of(0))).collect();
        let unit = self.entry.energy_unit;
        let mut plots = vec![if self.entry.conserves_energy() {
            plot("error of energy".to_owned(), unit, Scale::Log, "c6", errors(&|k| kept[k].energy))
        } else {
            let energies = kept.iter().map(|sample| rounded(sample.energy)).collect();
            plot("energy".to_owned(), unit, Scale::Linear, "c6", energies)
        }];
        for (i, (name, unit)) in casimir::symbols_of(self.entry).enumerate() {
            let error = errors(&|k| kept[k].casimirs[i]);
            plots.push(plot(format!("error of {name}"), unit, Scale::Log, "c3", error));
        }
        plots
    }
}

/// Finds the common beginning of some components' names, or joins them: `v` of `v1` and `v2`.
fn common(names: &[String], places: &[usize]) -> String {
    let names: Vec<&str> = places.iter().filter_map(|&k| names.get(k).map(String::as_str)).collect();
    let begin = |name: &str| {
        let letters = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        letters.split(' ').next().unwrap_or(letters).to_owned()
    };
    let first = names.first().map(|name| begin(name)).unwrap_or_default();
    if names.iter().all(|name| begin(name) == first) { first } else { names.join(" ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Sample;
    use crate::tests::catalogue;

    #[test]
    fn plots_arrows_and_parameters_have_the_units_of_the_description() {
        let shown = |name: &str| {
            let entry = catalogue().system(name).expect("it is there");
            let mut recorder = PageRecorder::new(entry, 0);
            let (index, state) = (0, &entry.example.state);
            recorder.push(&Sample {
                index,
                time: 0.0,
                state,
                energy: 1.0,
                casimirs: &[0.0; 2],
                snapshot: &Vec::new,
            });
            let (title, parameters) = (String::new(), &entry.example.parameters[..]);
            let heading = PageHeading { title, parameters, step: 0.1, steps: 0, law: None };
            let Page { details, runs, .. } = page(&recorder, entry, &heading);
            let Run { plots, arrows, .. } = runs.into_iter().next().expect("one run");
            let details = details.into_iter().map(|detail| detail.unit).take(3);
            let plots = plots.into_iter().map(|plot| plot.unit);
            let arrows = arrows.into_iter().map(|arrow| arrow.unit);
            [details.collect::<Vec<_>>(), plots.collect(), arrows.collect()]
        };
        let [details, plots, arrows] = shown("heavy_top");
        assert_eq!(details, ["kg m²", "N", "m"]);
        assert_eq!(plots, ["", "kg m²/s", "", "J", "", "kg m²/s"]);
        assert_eq!(arrows, ["kg m²/s", ""]);
        let [_, plots, arrows] = shown("rigid_body_in_space");
        assert_eq!(plots[..4], ["", "m", "kg m²/s", "kg m/s"]);
        assert_eq!(arrows, ["kg m²/s", "kg m/s"]);
    }
}
