//! From a run and its system's scene to a page.

use coadjoint::prelude::*;
use coadjoint::system::{Quantity, Role};

use super::format::{
    self, Detail, DetailValue, End, Frame, Page, Plot, Run, Scale, Series, Space, Track, Trail,
};
use super::recording::{HtmlPlayer, Moments};
use super::scenery;
use crate::casimir;
use crate::entry::{ControlLaw, Entry, component_name};
use crate::scene::{Arrow, Body, Link, Scene, Vector};
use crate::setting::{laid_out, rotation};
use crate::shown::Shown;

/// What is said of a run beside its motion.
pub(crate) struct Heading<'a> {
    /// The system and its scheme.
    pub(crate) title: String,
    pub(crate) parameters: &'a [f64],
    /// s
    pub(crate) step: f64,
    pub(crate) steps: u64,
    /// What acts from outside, where that is known.
    pub(crate) law: Option<ControlLaw>,
}

/// The page of a run.
pub(super) fn page(player: &HtmlPlayer, entry: &Entry, heading: &Heading<'_>) -> Page {
    let moments = player.moments();
    let scene = scenery::scene(entry, heading.parameters);
    let states = states(entry, &moments);
    let film = Film { entry, moments: &moments, states, controls: controls(entry, heading, &moments) };
    let run = Run {
        name: heading.title.clone(),
        bodies: (0..scene.bodies.len()).map(|k| film.body(&scene, k)).collect(),
        arrows: scene.arrows.iter().filter_map(|arrow| film.arrow(&scene, arrow)).collect(),
        links: scene.links.iter().map(link).collect(),
        plots: film.plots(),
        turn: Some(rounded(moments.turn)),
        rate: Some(rounded(moments.rate)),
        ..Run::default()
    };
    Page {
        format: format::FORMAT.to_owned(),
        title: entry.name.to_owned(),
        about: entry.about.to_owned(),
        subtitle: format!("{}, {} steps", heading.title, heading.steps),
        details: details(entry, heading),
        time: moments.kept.iter().map(|moment| moment.time).collect(),
        space: Space { axes: scenery::axes(entry, &scene), ground: scene.ground, ..Space::default() },
        runs: vec![run],
    }
}

fn details(entry: &Entry, heading: &Heading<'_>) -> Vec<Detail> {
    let detail =
        |name: &str, value, unit: &str| Detail { name: name.to_owned(), value, unit: unit.to_owned() };
    let mut details = Vec::new();
    for (quantity, slots) in laid_out(entry.description.parameters) {
        let value = match heading.parameters.get(slots).unwrap_or_default() {
            [one] => DetailValue::Number(*one),
            several => DetailValue::Numbers(several.to_vec()),
        };
        details.push(detail(quantity.name, value, entry.unit(quantity.name)));
    }
    details.push(detail("scheme", DetailValue::Text(heading.title.clone()), ""));
    details.push(detail("step", DetailValue::Number(heading.step), "s"));
    details.push(detail("steps", DetailValue::Number(heading.steps as f64), ""));
    details.push(detail(
        "made by",
        DetailValue::Text(format!("coadjoint {}", env!("CARGO_PKG_VERSION"))),
        "",
    ));
    details
}

fn link(link: &Link) -> format::Link {
    let end = |(body, at): (Option<usize>, [f64; 3])| End { body, at };
    format::Link { from: end(link.from), to: end(link.to), spring: link.spring }
}

/// A place and an attitude.
type Pose = (Vector3<f64>, UnitQuaternion<f64>);

struct Film<'a> {
    entry: &'a Entry,
    moments: &'a Moments<'a>,
    /// What is shown of the state at each moment.
    states: Vec<Vec<f64>>,
    /// The controls of the step that begins at each moment; none where they are not known.
    controls: Vec<Vec<f64>>,
}

fn controls(entry: &Entry, heading: &Heading<'_>, moments: &Moments<'_>) -> Vec<Vec<f64>> {
    let Some(law) = &heading.law else { return Vec::new() };
    moments.kept.iter().map(|moment| entry.chosen(law, (&moment.state, moment.time))).collect()
}

/// What is shown of the state at each moment; quaternions go on without a jump.
fn states(entry: &Entry, moments: &Moments<'_>) -> Vec<Vec<f64>> {
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(moments.kept.len());
    for moment in &moments.kept {
        let mut state = entry.shown.numbers(&moment.state).into_owned();
        for (quantity, slots) in laid_out(entry.shown.plotted()) {
            let is_read = entry.shown.is_of_a_matrix(quantity) && rotation(quantity).is_some();
            let Some(before) = states.last().filter(|_| is_read && slots.len() == 4) else { continue };
            let product: f64 =
                before[slots.clone()].iter().zip(&state[slots.clone()]).map(|(a, b)| a * b).sum();
            if product < 0.0 {
                state[slots].iter_mut().for_each(|number| *number = -*number);
            }
        }
        states.push(state);
    }
    states
}

impl Film<'_> {
    /// The components of a quantity in a state.
    fn quantity<'s>(&self, state: &'s [f64], name: &str) -> Option<(&'static Quantity, &'s [f64])> {
        let (quantity, slots) =
            laid_out(self.entry.shown.all()).find(|(quantity, _)| quantity.name == name)?;
        Some((quantity, state.get(slots)?))
    }

    /// Where a body is in a state; bodies are on others that come before them.
    fn pose(&self, scene: &Scene, k: usize, state: &[f64]) -> Pose {
        let Some(body) = scene.bodies.get(k) else { return (Vector3::zeros(), UnitQuaternion::identity()) };
        let of = |name: &Option<String>| name.as_ref().and_then(|name| self.quantity(state, name));
        let attitude = of(&body.rotation)
            .map_or(UnitQuaternion::identity(), |(quantity, numbers)| attitude(quantity, numbers, body));
        let place = match &body.carried {
            Some((matrix, point)) => self.quantity(state, matrix).map(|(_, matrix)| carried(matrix, point)),
            None => of(&body.position).map(|(quantity, numbers)| place(quantity, numbers)),
        };
        let place = place.unwrap_or_default();
        match body.mount {
            Some((other, point, carried)) if other < k => {
                let (origin, turned) = self.pose(scene, other, state);
                let attitude = if carried { turned * attitude } else { attitude };
                (origin + turned * Vector3::from(point) + place, attitude)
            }
            _ => (place, attitude),
        }
    }

    fn path(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Track {
        let path: Vec<Vec<f64>> =
            self.states.iter().map(|state| of(state).into_iter().map(rounded).collect()).collect();
        track(path)
    }

    /// A control of one number along a direction.
    fn along(&self, name: &str, direction: &[f64; 3]) -> Option<Track> {
        let (_, slots) =
            laid_out(self.entry.description.controls).find(|(quantity, _)| quantity.name == name)?;
        let at = |controls: &Vec<f64>| {
            let size = controls.get(slots.start)?;
            Some(direction.map(|x| rounded(x * size)).to_vec())
        };
        let path = self.controls.iter().map(at).collect::<Option<Vec<_>>>()?;
        (!path.is_empty()).then(|| track(path))
    }

    fn body(&self, scene: &Scene, k: usize) -> format::Body {
        let body = &scene.bodies[k];
        let mounted = body.mount.is_some();
        let rotation = (body.rotation.is_some() || mounted).then(|| {
            self.path(|state| {
                let q = self.pose(scene, k, state).1;
                vec![q.w, q.i, q.j, q.k]
            })
        });
        let position = (body.position.is_some() || body.carried.is_some() || mounted)
            .then(|| self.path(|state| self.pose(scene, k, state).0.as_slice().to_vec()));
        let spatial = body.axis.is_none()
            && body.rotation.as_ref().is_some_and(|name| scenery::is_spatial(self.entry, name));
        format::Body {
            name: body.name.clone(),
            rotation,
            position,
            shape: body.solid.clone(),
            axes: Some(body.axes && spatial),
            trail: (!body.trace).then_some(Trail::Shown(false)),
            colour: match (body.planet, &body.carried) {
                (true, _) => Some("planet".to_owned()),
                (false, Some(_)) => Some("ink".to_owned()),
                (false, None) => None,
            },
        }
    }

    fn arrow(&self, scene: &Scene, arrow: &Arrow) -> Option<format::Arrow> {
        let (vector, unit) = match &arrow.vector {
            Vector::Constant(vector) => (Track::Constant(vector.to_vec()), arrow.unit),
            Vector::Quantity(name, first) => {
                self.quantity(self.states.first()?, name)?;
                let part = |state: &[f64]| -> Option<Vec<f64>> {
                    let (quantity, numbers) = self.quantity(state, name)?;
                    Some(place(quantity, numbers.get(*first..)?).as_slice().to_vec())
                };
                let unit = if arrow.unit.is_empty() { self.entry.unit(name) } else { arrow.unit };
                (self.path(|state| part(state).unwrap_or_else(|| vec![0.0; 3])), unit)
            }
            Vector::Control(name, direction) => (self.along(name, direction)?, self.entry.unit(name)),
        };
        let solid = arrow.body.and_then(|body| scene.bodies.get(body)?.solid.as_ref());
        // where a body's size has no meaning, places on it have none
        let relative = solid.is_some_and(|solid| solid.relative);
        Some(format::Arrow {
            name: arrow.name.clone(),
            symbol: (!arrow.symbol.is_empty()).then(|| arrow.symbol.clone()),
            unit: unit.to_owned(),
            vector: Some(vector),
            frame: if arrow.in_body && arrow.body.is_some() { Frame::Body } else { Frame::Space },
            body: arrow.body,
            from: (!relative && arrow.from != [0.0; 3]).then_some(arrow.from),
            true_length: unit == "m" && solid.is_some() && !relative,
            colour: Some(arrow.colour.to_owned()),
        })
    }

    /// What can be plotted: each quantity, and the errors of what is conserved.
    fn plots(&self) -> Vec<Plot> {
        let quantities = laid_out(self.entry.shown.plotted());
        let mut plots: Vec<Plot> =
            quantities.flat_map(|(quantity, slots)| self.plots_of(quantity, slots.start)).collect();
        plots.extend(self.errors());
        plots
    }

    /// The plots of a quantity whose numbers begin here.
    fn plots_of(&self, quantity: &'static Quantity, start: usize) -> Vec<Plot> {
        let names: Vec<String> = scenery::component_names(self.entry, quantity);
        let series = |places: &[usize]| -> Vec<Series> {
            places.iter().map(|&k| self.series(&names[k], |state| state[start + k])).collect()
        };
        let title = match self.entry.shown.is_of_a_matrix(quantity) {
            true => Shown::name(quantity),
            false => quantity.name.to_owned(),
        };
        let plot = |part: &str, unit: &str, series| Plot {
            name: if part.is_empty() || part == title { title.clone() } else { format!("{title}, {part}") },
            unit: unit.to_owned(),
            shown: quantity.role == Role::Momentum,
            series,
            ..Plot::default()
        };
        let all: Vec<usize> = (0..names.len()).collect();
        let unit = self.entry.unit(quantity.name);
        match rotation(quantity) {
            Some((2, _)) if names.len() == 2 => {
                let part = if quantity.name.contains("angle") { "" } else { "angle" };
                vec![plot(part, "rad", vec![self.angle(start)])]
            }
            Some((count, _)) => {
                let turning = match count {
                    2 => plot("angle", "rad", vec![self.angle(start)]),
                    _ => plot("rotation", "", series(&all[..count])),
                };
                let unit = if unit.is_empty() { "m" } else { unit };
                let moving = (count < all.len()).then(|| plot("position", unit, series(&all[count..])));
                std::iter::once(turning).chain(moving).collect()
            }
            None => {
                let parts = self.by_unit(quantity);
                let one = |(unit, places): &(&str, Vec<usize>)| {
                    let part = if parts.len() == 1 { String::new() } else { common(&names, places) };
                    plot(&part, unit, series(places))
                };
                parts.iter().map(one).collect()
            }
        }
    }

    /// Units, and the components that have them.
    fn by_unit(&self, quantity: &'static Quantity) -> Vec<(&'static str, Vec<usize>)> {
        let mut parts: Vec<(&str, Vec<usize>)> = Vec::new();
        for (k, component) in quantity.components.iter().enumerate() {
            let unit = self.entry.unit(&component_name(quantity, component));
            match parts.iter_mut().find(|(known, _)| *known == unit) {
                Some((_, places)) => places.push(k),
                None => parts.push((unit, vec![k])),
            }
        }
        parts
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
        let kept = &self.moments.kept;
        let plot = |name: String, unit: &str, scale, colour: &str, values: Vec<f64>| Plot {
            name,
            unit: unit.to_owned(),
            scale,
            shown: false,
            series: vec![Series { values, colour: Some(colour.to_owned()), ..Series::default() }],
        };
        let errors = |of: &dyn Fn(usize) -> f64| (0..kept.len()).map(|k| rounded(of(k) - of(0))).collect();
        let unit = self.entry.unit("energy");
        let mut plots = vec![if self.entry.conserves_energy() {
            plot("error of energy".to_owned(), unit, Scale::Log, "c6", errors(&|k| kept[k].energy))
        } else {
            let energies = kept.iter().map(|moment| rounded(moment.energy)).collect();
            plot("energy".to_owned(), unit, Scale::Linear, "c6", energies)
        }];
        for (i, (name, unit)) in casimir::symbols_of(self.entry).enumerate() {
            let error = errors(&|k| kept[k].casimirs[i]);
            plots.push(plot(format!("error of {name}"), unit, Scale::Log, "c3", error));
        }
        plots
    }
}

/// One vector, where they are all the same.
fn track(path: Vec<Vec<f64>>) -> Track {
    match path.as_slice() {
        [first, rest @ ..] if rest.iter().all(|other| other == first) => Track::Constant(first.clone()),
        _ => Track::Path(path),
    }
}

/// The attitude by a rotation in space or in the plane.
fn attitude(quantity: &Quantity, numbers: &[f64], body: &Body) -> UnitQuaternion<f64> {
    match (rotation(quantity), numbers) {
        (Some((4, _)), [w, i, j, k, ..]) => UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k)),
        (Some((2, _)), [re, im, ..]) => {
            // upright: from the first axis, to the right, to the third, up
            let axis = body.axis.map_or(-Vector3::y(), Vector3::from);
            UnitQuaternion::new(axis.normalize() * im.atan2(*re))
        }
        _ => UnitQuaternion::identity(),
    }
}

/// The place by a position or a rigid motion; one in the plane is upright.
fn place(quantity: &Quantity, numbers: &[f64]) -> Vector3<f64> {
    let count = rotation(quantity).map_or(0, |(count, _)| count);
    match numbers.get(count..).unwrap_or_default() {
        [x, y, z, ..] => vector![*x, *y, *z],
        [x, y] => vector![*x, 0.0, *y],
        [x] => vector![*x, 0.0, 0.0],
        [] => Vector3::zeros(),
    }
}

/// What the names of some components begin with, or all of them: `v` of `v1` and `v2`.
fn common(names: &[String], places: &[usize]) -> String {
    let names: Vec<&str> = places.iter().filter_map(|&k| names.get(k).map(String::as_str)).collect();
    let begin = |name: &str| {
        let letters = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        letters.split(' ').next().unwrap_or(letters).to_owned()
    };
    let first = names.first().map(|name| begin(name)).unwrap_or_default();
    if names.iter().all(|name| begin(name) == first) { first } else { names.join(" ") }
}

/// Where a matrix, by rows, takes a point: what is seen of that are its first three coordinates; in the plane it is upright.
fn carried(matrix: &[f64], point: &[f64]) -> Vector3<f64> {
    let coordinate = |row: &[f64]| row.iter().zip(point).map(|(entry, x)| entry * x).sum::<f64>();
    let there: Vec<f64> = matrix.chunks(point.len().max(1)).map(coordinate).collect();
    match there[..] {
        [x, y, z, ..] => vector![x, y, z],
        [x, y] => vector![x, 0.0, y],
        [x] => vector![x, 0.0, 0.0],
        [] => Vector3::zeros(),
    }
}

/// To seven digits: no screen shows more, and they halve the page.
fn rounded(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::simulation::{Job, Method, Order, Retraction};
    use crate::test_systems::catalogue;

    /// A motor is drawn as strong as it pulls in the step that begins at each moment; of what is not known nothing is drawn.
    #[test]
    fn controls_are_drawn() {
        let entry = catalogue().system("planar_pendulum").expect("it is there");
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        let job = Job { method, retraction, order, step: 0.1, steps: 5 };
        let mut player = HtmlPlayer::new(entry, &job);
        let simulated = entry.simulate(&entry.example, &job, None, &|index| index + 1, &mut |sample| {
            player.push(sample);
            ControlFlow::Continue(())
        });
        simulated.expect("it can be computed");
        let moments = player.moments();
        let drawn = |law, name| {
            let (title, parameters) = (String::new(), &entry.example.parameters[..]);
            let heading = Heading { title, parameters, step: 0.1, steps: 5, law };
            let states = states(entry, &moments);
            let film =
                Film { entry, moments: &moments, states, controls: controls(entry, &heading, &moments) };
            film.arrow(&Scene::default(), &Arrow::control(name, vector![0.0, 2.0, 0.0]))
        };
        let held: ControlLaw = Box::new(|_, _, to| to[0] = -0.25);
        let arrow = drawn(Some(held), "torque").expect("a control");
        assert_eq!(arrow.vector, Some(Track::Constant(vec![0.0, -0.5, 0.0])));
        let braking: ControlLaw = Box::new(|state, time, to| to[0] = time - state[2]);
        let arrow = drawn(Some(braking), "torque").expect("a control");
        let Some(Track::Path(path)) = arrow.vector else { panic!("another one at each moment") };
        assert_eq!((path.len(), path[0][1]), (6, -2.0 * rounded(entry.example.state[2])));
        assert!(path[5][1] != path[0][1]);
        assert_eq!(drawn(None, "torque"), None);
        let other: ControlLaw = Box::new(|_, _, _| ());
        assert_eq!(drawn(Some(other), "thrust"), None);
    }
}
