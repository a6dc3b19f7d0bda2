//! The bodies and arrows of a scene, at each sample of a run.

use coadjoint::prelude::*;
use coadjoint::system::Quantity;

use super::{Arrow, Body, Frame, Scene, Source, Vector};
use crate::catalogue::plotted::PlottedQuantity;
use crate::catalogue::{ControlLaw, Entry, unit as unit_of};
use crate::record::RecordedSample;
use serde::{Deserialize, Serialize};

/// A vector at each moment, or one that is always the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a list of vectors of numbers, one for each moment, or one vector that is always the same"
)]
#[non_exhaustive]
pub enum Track {
    /// Always the same.
    Constant(Vec<f64>),
    /// One at each moment.
    Path(Vec<Vec<f64>>),
}

/// A place and an attitude.
type Pose = (Vector3<f64>, UnitQuaternion<f64>);

/// Places what a scene shows at each sample of a run.
pub(crate) struct Frames<'a> {
    entry: &'a Entry,
    /// The plotted numbers of the state at each sample.
    pub(crate) states: Vec<Vec<f64>>,
    /// The controls of the step that begins at each sample; none where they are not known.
    controls: Vec<Vec<f64>>,
}

impl<'a> Frames<'a> {
    /// Reads the samples of a run, and what acted on it from outside, where that is known.
    pub(crate) fn new(entry: &'a Entry, samples: &[&RecordedSample], law: Option<&ControlLaw>) -> Self {
        let controls = law.map(|law| {
            samples.iter().map(|sample| entry.chosen(law, (&sample.state, sample.time))).collect()
        });
        Self { entry, states: states(entry, samples), controls: controls.unwrap_or_default() }
    }

    /// Finds the components of a quantity in a state.
    fn quantity<'s>(&'s self, state: &'s [f64], name: &str) -> Option<(&'s PlottedQuantity, &'s [f64])> {
        let quantity = self.entry.plotted.find(name)?;
        Some((quantity, state.get(quantity.slots.clone())?))
    }

    /// Places a body in a state; bodies are on others that come before them.
    fn pose(&self, scene: &Scene, k: usize, state: &[f64]) -> Pose {
        let Some(body) = scene.bodies.get(k) else { return (Vector3::zeros(), UnitQuaternion::identity()) };
        let numbers = |source: &Source| self.quantity(state, source.quantity());
        let attitude = body.rotation.as_ref().and_then(|source| {
            let (quantity, numbers) = numbers(source)?;
            Some(attitude(quantity, numbers, source))
        });
        let place = body.position.as_ref().and_then(|source| {
            let (quantity, numbers) = numbers(source)?;
            Some(match source {
                Source::Carried(_, point) => carried(numbers, point),
                _ => place(quantity, numbers),
            })
        });
        let (attitude, place) = (attitude.unwrap_or_default(), place.unwrap_or_default());
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

    /// Points a control of one number along a direction.
    fn along(&self, name: &str, direction: &[f64; 3]) -> Option<(&'a Quantity, Track)> {
        let (quantity, slots) = Quantity::with_ranges(self.entry.description.controls)
            .find(|(quantity, _)| quantity.name == name)?;
        let at = |controls: &Vec<f64>| {
            let size = controls.get(slots.start)?;
            Some(direction.map(|x| rounded(x * size)).to_vec())
        };
        let path = self.controls.iter().map(at).collect::<Option<Vec<_>>>()?;
        (!path.is_empty()).then(|| (quantity, track(path)))
    }

    /// Places a body at each sample.
    pub(crate) fn body(&self, scene: &Scene, k: usize) -> Body<Track> {
        let body = scene.bodies[k].clone();
        let mounted = body.mount.is_some();
        let rotation = (body.rotation.is_some() || mounted).then(|| {
            self.path(|state| {
                let q = self.pose(scene, k, state).1;
                vec![q.w, q.i, q.j, q.k]
            })
        });
        let position = (body.position.is_some() || mounted)
            .then(|| self.path(|state| self.pose(scene, k, state).0.as_slice().to_vec()));
        let is_spatial =
            matches!(&body.rotation, Some(Source::Quantity(name)) if self.entry.plotted.is_spatial(name));
        let Body { name, shape, axes, trail, colour, .. } = body;
        Body {
            name,
            rotation,
            position,
            shape,
            axes: axes.map(|axes| axes && is_spatial),
            trail,
            colour,
            mount: None,
        }
    }

    /// Points an arrow at each sample; none where its vector is not known.
    pub(crate) fn arrow(&self, scene: &Scene, arrow: &Arrow) -> Option<Arrow<Option<Track>>> {
        let Arrow { name, symbol, unit, vector, frame, body, from, colour, .. } = arrow.clone();
        let (vector, unit) = match vector {
            Vector::Constant(vector) => (Track::Constant(vector.to_vec()), unit),
            Vector::Quantity(name, first) => {
                self.quantity(self.states.first()?, &name)?;
                let part = |state: &[f64]| -> Option<Vec<f64>> {
                    let (quantity, numbers) = self.quantity(state, &name)?;
                    Some(place(quantity, numbers.get(first..)?).as_slice().to_vec())
                };
                let own = self.entry.plotted.find(&name).and_then(|quantity| quantity.units.get(first));
                let unit = if unit.is_empty() { own.copied().unwrap_or_default().to_owned() } else { unit };
                (self.path(|state| part(state).unwrap_or_else(|| vec![0.0; 3])), unit)
            }
            Vector::Control(name, direction) => {
                let (quantity, track) = self.along(&name, &direction)?;
                (track, unit_of(quantity).to_owned())
            }
        };
        let solid = body.and_then(|body| scene.bodies.get(body)?.shape.as_ref());
        // where a body's size has no meaning, places on it have none
        let relative = solid.is_some_and(|solid| solid.relative);
        Some(Arrow {
            true_length: unit == "m" && solid.is_some() && !relative,
            name,
            symbol,
            unit,
            vector: Some(vector),
            frame: if body.is_some() { frame } else { Frame::Space },
            body,
            from: from.filter(|_| !relative),
            colour,
        })
    }
}

/// Reads what is plotted of the state at each sample; quaternions go on without a jump.
fn states(entry: &Entry, samples: &[&RecordedSample]) -> Vec<Vec<f64>> {
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(samples.len());
    for sample in samples {
        let mut state = entry.plotted.numbers(&sample.state).into_owned();
        for quantity in entry.plotted.all() {
            let slots = quantity.slots.clone();
            let is_read = quantity.is_of_a_matrix && quantity.rotation == 4 && slots.len() == 4;
            let Some(before) = states.last().filter(|_| is_read) else { continue };
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

/// Keeps one vector, where they are all the same.
fn track(path: Vec<Vec<f64>>) -> Track {
    match path.as_slice() {
        [first, rest @ ..] if rest.iter().all(|other| other == first) => Track::Constant(first.clone()),
        _ => Track::Path(path),
    }
}

/// Reads the attitude from a rotation in space or in the plane.
fn attitude(quantity: &PlottedQuantity, numbers: &[f64], source: &Source) -> UnitQuaternion<f64> {
    match (quantity.rotation, numbers) {
        (4, [w, i, j, k, ..]) => UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k)),
        (2, [re, im, ..]) => {
            // upright: from the first axis, to the right, to the third, up
            let axis = match source {
                Source::About(_, axis) => Vector3::from(*axis),
                _ => -Vector3::y(),
            };
            UnitQuaternion::new(axis.normalize() * im.atan2(*re))
        }
        _ => UnitQuaternion::identity(),
    }
}

/// Reads the place from a position or a rigid motion; one in the plane is upright.
fn place(quantity: &PlottedQuantity, numbers: &[f64]) -> Vector3<f64> {
    upright(numbers.get(quantity.rotation..).unwrap_or_default())
}

/// Moves a point by a matrix, by rows: what is seen are its first three coordinates; in the plane it is upright.
fn carried(matrix: &[f64], point: &[f64]) -> Vector3<f64> {
    let coordinate = |row: &[f64]| row.iter().zip(point).map(|(entry, x)| entry * x).sum::<f64>();
    upright(&matrix.chunks(point.len().max(1)).map(coordinate).collect::<Vec<f64>>())
}

fn upright(coordinates: &[f64]) -> Vector3<f64> {
    match coordinates {
        [x, y, z, ..] => vector![*x, *y, *z],
        [x, y] => vector![*x, 0.0, *y],
        [x] => vector![*x, 0.0, 0.0],
        [] => Vector3::zeros(),
    }
}

/// Rounds to seven digits: no screen shows more, and they halve the page.
pub(crate) fn rounded(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Samples;
    use crate::setup::{Job, Method, Order, Retraction};
    use crate::simulate::simulate;
    use crate::tests::catalogue;

    /// A motor is drawn as strong as it pulls in the step that begins at each sample; of what is not known nothing is
    /// drawn.
    #[test]
    fn controls_are_drawn() {
        let entry = catalogue().system("planar_pendulum").expect("it is there");
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        let job = Job { method, retraction, order, step: 0.1, steps: 5, rest: 0.0 };
        let mut samples = Samples::default();
        let simulated = simulate(entry, &entry.example, &job, None, &|index| index + 1, &mut |sample| {
            samples.push(sample);
            std::ops::ControlFlow::Continue(())
        });
        simulated.expect("it can be computed");
        let samples: Vec<&RecordedSample> = samples.0.iter().collect();
        let drawn = |law: Option<ControlLaw>, name| {
            let frames = Frames::new(entry, &samples, law.as_ref());
            frames.arrow(&Scene::default(), &Arrow::control(name, vector![0.0, 2.0, 0.0]))
        };
        let held: ControlLaw = Box::new(|_, _, to| to[0] = -0.25);
        let arrow = drawn(Some(held), "torque").expect("a control");
        assert_eq!(arrow.vector, Some(Track::Constant(vec![0.0, -0.5, 0.0])));
        let braking: ControlLaw = Box::new(|state, time, to| to[0] = time - state[2]);
        let arrow = drawn(Some(braking), "torque").expect("a control");
        let Some(Track::Path(path)) = arrow.vector else { panic!("another one at each sample") };
        assert_eq!((path.len(), path[0][1]), (6, -2.0 * rounded(entry.example.state[2])));
        assert!(path[5][1] != path[0][1]);
        assert_eq!(drawn(None, "torque"), None);
        let other: ControlLaw = Box::new(|_, _, _| ());
        assert_eq!(drawn(Some(other), "thrust"), None);
    }
}
