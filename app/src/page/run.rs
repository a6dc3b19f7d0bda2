//! The page of a run: its system's scene at each sample, curves, and what made it.

use coadjoint::system::{Quantity, Role};

use super::format::{Detail, DetailValue, FORMAT, Page, Plot, Run, Scale, Series, Space};
use crate::catalogue::plotted::PlottedQuantity;
use crate::catalogue::quantities::by_key;
use crate::catalogue::{Entry, casimir, program, unit};
use crate::record::{PageRecorder, PageSamples, RecordedSample};
use crate::scene::{self, Frames, rounded};

/// The heading of a run's page.
pub(crate) struct PageHeading<'a> {
    /// The system and its scheme.
    pub(crate) title: String,
    pub(crate) parameters: &'a [f64],
    /// s
    pub(crate) step: f64,
    pub(crate) steps: u64,
}

/// Builds the page of a run.
pub(crate) fn page(recorder: &PageRecorder, entry: &Entry, heading: &PageHeading<'_>) -> Page {
    let samples = recorder.samples();
    let scene = scene::scene(entry, heading.parameters);
    let frames = Frames::new(entry, &samples.kept);
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
        let plotted = &self.entry.plotted;
        let quantities = plotted.all().iter().map(|quantity| {
            let (name, place) =
                plotted.array(quantity).unwrap_or_else(|| (quantity.name.clone(), String::new()));
            (name, (place, quantity))
        });
        let groups = by_key(quantities);
        let plots = groups.iter().flat_map(|(name, elements)| self.plots_of_array(name, elements));
        plots.chain(self.errors()).collect()
    }

    /// Draws a quantity, or the elements of an array of this name: of many a plot for each component.
    fn plots_of_array(&self, name: &str, elements: &[(String, &PlottedQuantity)]) -> Vec<Plot> {
        if let [(_, quantity)] = elements {
            return self.plots_of(quantity, name);
        }
        let of_elements: Vec<Vec<Plot>> =
            elements.iter().map(|(_, quantity)| self.plots_of(quantity, name)).collect();
        let mut plots = Vec::new();
        for (k, plot) in of_elements.first().into_iter().flatten().enumerate() {
            let count = plot.series.len();
            if elements.len() < count {
                plots.extend(elements.iter().zip(&of_elements).map(|((place, _), of)| Plot {
                    name: format!("{}, {place}", of[k].name),
                    ..of[k].clone()
                }));
                continue;
            }
            plots.extend((0..count).map(|component| {
                let series = elements.iter().zip(&of_elements).map(|((place, _), of)| Series {
                    name: place.clone(),
                    ..of[k].series[component].clone()
                });
                let name = format!("{} {}", plot.name, plot.series[component].name);
                Plot { name: name.trim_end().to_owned(), series: series.collect(), ..plot.clone() }
            }));
        }
        plots
    }

    /// Draws a quantity by this name.
    fn plots_of(&self, quantity: &PlottedQuantity, name: &str) -> Vec<Plot> {
        let start = quantity.slots.start;
        let names: Vec<String> = match &quantity.components[..] {
            [_] => vec![String::new()],
            names => names.iter().map(|name| name.replace('_', " ")).collect(),
        };
        let series = |places: &[usize]| -> Vec<Series> {
            places.iter().map(|&k| self.series(&names[k], |state| state[start + k])).collect()
        };
        let title = if quantity.is_of_a_matrix { PlottedQuantity::title(name) } else { name.to_owned() };
        let plot = |part: &str, unit: &str, series| Plot {
            name: if part.is_empty() || part == title { title.clone() } else { format!("{title}, {part}") },
            unit: unit.to_owned(),
            shown: matches!(quantity.role, None | Some(Role::Momentum)),
            series,
            ..Plot::default()
        };
        let all: Vec<usize> = (0..names.len()).collect();
        match quantity.rotation {
            2 if names.len() == 2 => {
                let part = if quantity.name.contains("angle") { "" } else { "angle" };
                vec![plot(part, "rad", vec![self.angle(quantity)])]
            }
            count @ 1.. => {
                let turning = match count {
                    2 => plot("angle", "rad", vec![self.angle(quantity)]),
                    _ => plot("rotation", "", series(&all[..count])),
                };
                let moving = (count < all.len())
                    .then(|| plot("position", &quantity.units[count], series(&all[count..])));
                std::iter::once(turning).chain(moving).collect()
            }
            0 => {
                let parts = by_key(quantity.units.iter().map(String::as_str).zip(0..));
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
    fn angle(&self, quantity: &PlottedQuantity) -> Series {
        let rotating = self.entry.plotted.all().iter().filter(|other| other.rotation > 0);
        let order = rotating.take_while(|other| *other != quantity).count();
        let angle = |sample: &&RecordedSample| sample.angles.get(order).map_or(f64::NAN, |x| rounded(*x));
        Series { values: self.samples.kept.iter().map(angle).collect(), ..Series::default() }
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
            let mut recorder = PageRecorder::new(0);
            recorder.push(&Sample { casimirs: &[0.0; 2], ..Sample::of_state(&entry.example.state) }, &[]);
            let (title, parameters) = (String::new(), &entry.example.parameters[..]);
            let heading = PageHeading { title, parameters, step: 0.1, steps: 0 };
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
