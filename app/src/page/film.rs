//! From a run and its system's scene to a page.

use coadjoint::prelude::*;
use coadjoint::system::{Quantity, Role};

use super::format::{
    self, Detail, DetailValue, End, Frame, Page, Plot, Run, Scale, Series, Space, Track, Trail,
};
use super::recording::{HtmlPlayer, Moments};
use super::scenery;
use crate::entry::Entry;
use crate::run_plot::symbols;
use crate::scene::{Arrow, Body, Link, Scene, Vector};
use crate::setting::{laid_out, rotation};

/// What is said of a run beside its motion.
pub(crate) struct Heading<'a> {
    /// The system and its scheme.
    pub(crate) title: String,
    pub(crate) parameters: &'a [f64],
    /// s
    pub(crate) step: f64,
    pub(crate) steps: u64,
}

/// The page of a run.
pub(super) fn page(player: &HtmlPlayer, entry: &Entry, heading: &Heading<'_>) -> Page {
    let moments = player.moments();
    let scene = scenery::scene(entry, heading.parameters);
    let film = Film { entry, moments: &moments };
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
}

impl Film<'_> {
    /// The components of a quantity in a state.
    fn quantity<'s>(&self, state: &'s [f64], name: &str) -> Option<(&'static Quantity, &'s [f64])> {
        let quantities: &'static [Quantity] = self.entry.description.state;
        let (quantity, slots) = laid_out(quantities).find(|(quantity, _)| quantity.name == name)?;
        Some((quantity, state.get(slots)?))
    }

    /// Where a body is in a state; bodies are on others that come before them.
    fn pose(&self, scene: &Scene, k: usize, state: &[f64]) -> Pose {
        let Some(body) = scene.bodies.get(k) else { return (Vector3::zeros(), UnitQuaternion::identity()) };
        let of = |name: &Option<String>| name.as_ref().and_then(|name| self.quantity(state, name));
        let attitude = of(&body.rotation)
            .map_or(UnitQuaternion::identity(), |(quantity, numbers)| attitude(quantity, numbers, body));
        let place =
            of(&body.position).map_or(Vector3::zeros(), |(quantity, numbers)| place(quantity, numbers));
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
        let path =
            self.moments.kept.iter().map(|moment| of(&moment.state).into_iter().map(rounded).collect());
        let path: Vec<Vec<f64>> = path.collect();
        match path.as_slice() {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => Track::Constant(first.clone()),
            _ => Track::Path(path),
        }
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
        let position = (body.position.is_some() || mounted)
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
            colour: body.planet.then(|| "planet".to_owned()),
        }
    }

    fn arrow(&self, scene: &Scene, arrow: &Arrow) -> Option<format::Arrow> {
        let (vector, unit) = match &arrow.vector {
            Vector::Constant(vector) => (Track::Constant(vector.to_vec()), arrow.unit),
            Vector::Quantity(name, first) => {
                self.quantity(&self.moments.kept.first()?.state, name)?;
                let part = |state: &[f64]| -> Option<Vec<f64>> {
                    let (quantity, numbers) = self.quantity(state, name)?;
                    Some(place(quantity, numbers.get(*first..)?).as_slice().to_vec())
                };
                let unit = if arrow.unit.is_empty() { self.entry.unit(name) } else { arrow.unit };
                (self.path(|state| part(state).unwrap_or_else(|| vec![0.0; 3])), unit)
            }
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
        let mut plots = Vec::new();
        for (quantity, slots) in laid_out(self.entry.description.state) {
            let series = |names: &[String], first: usize| -> Vec<Series> {
                let one =
                    |(k, name): (usize, &String)| self.series(name, |state| state[slots.start + first + k]);
                names.iter().enumerate().map(one).collect()
            };
            let plot = |part: &str, unit: &str, series| Plot {
                name: format!("{}{part}", quantity.name),
                unit: unit.to_owned(),
                shown: quantity.role == Role::Momentum,
                series,
                ..Plot::default()
            };
            let unit = self.entry.unit(quantity.name);
            let names: Vec<String> = scenery::component_names(self.entry, quantity);
            match rotation(quantity) {
                Some((2, _)) => {
                    let part = if quantity.name.contains("angle") { "" } else { ", angle" };
                    plots.push(plot(part, "rad", vec![self.angle(slots.start)]));
                }
                Some((count, _)) => plots.push(plot(", rotation", "", series(&names[..count], 0))),
                None => plots.push(plot("", unit, series(&names, 0))),
            }
            if let Some((count, _)) = rotation(quantity).filter(|(count, _)| *count < names.len()) {
                plots.push(plot(
                    ", position",
                    if unit.is_empty() { "m" } else { unit },
                    series(&names[count..], count),
                ));
            }
        }
        plots.extend(self.errors());
        plots
    }

    fn series(&self, name: &str, of: impl Fn(&[f64]) -> f64) -> Series {
        let values = self.moments.kept.iter().map(|moment| rounded(of(&moment.state))).collect();
        Series { name: name.to_owned(), values, ..Series::default() }
    }

    /// The angle of a rotation in the plane, which goes on where it has turned all around.
    fn angle(&self, slot: usize) -> Series {
        let mut angle = 0.0;
        let angles = self.moments.kept.iter().map(|moment| {
            let now = moment.state[slot + 1].atan2(moment.state[slot]);
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
        let mut plots = vec![if self.entry.description.autonomous {
            plot("error of energy".to_owned(), unit, Scale::Log, "c6", errors(&|k| kept[k].energy))
        } else {
            let energies = kept.iter().map(|moment| rounded(moment.energy)).collect();
            plot("energy".to_owned(), unit, Scale::Linear, "c6", energies)
        }];
        for (i, (name, unit)) in self.entry.casimirs().enumerate() {
            let error = errors(&|k| kept[k].casimirs[i]);
            plots.push(plot(format!("error of {}", symbols(name)), unit, Scale::Log, "c3", error));
        }
        plots
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

/// To seven digits: no screen shows more, and they halve the page.
fn rounded(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x)
}
