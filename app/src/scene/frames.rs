//! The bodies and arrows of a scene, at each sample of a run.

use coadjoint::prelude::*;

use super::{Arrow, Body, Frame, Scene, Source, Vector};
use crate::catalogue::Entry;
use crate::catalogue::plotted::PlottedQuantity;
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
    /// The plotted numbers of the state, and of what goes with it, at each sample.
    pub(crate) states: Vec<Vec<f64>>,
}

impl<'a> Frames<'a> {
    /// Reads the samples of a run.
    pub(crate) fn new(entry: &'a Entry, samples: &[&RecordedSample]) -> Self {
        Self { entry, states: states(entry, samples) }
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
                Source::Along(_, axis) => {
                    Vector3::from(*axis) * numbers.get(quantity.rotation).copied().unwrap_or(0.0)
                }
                _ => place(quantity, numbers, source.is_lying()),
            })
        });
        let (attitude, place) = (attitude.unwrap_or_default(), place.unwrap_or_default());
        match body.mount {
            Some((other, point, carried)) if other < k => {
                let (origin, turned) = self.pose(scene, other, state);
                // what turns with the other one also moves in its axes
                let (place, attitude) =
                    if carried { (turned * place, turned * attitude) } else { (place, attitude) };
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
        let of = body.and_then(|body| scene.bodies.get(body));
        let sources = || of.into_iter().flat_map(|of| of.position.iter().chain(&of.rotation));
        let lies = sources().any(Source::is_lying);
        // what slides on a body has its momentum along the axis, and turns with it
        let along = sources().find_map(|source| match source {
            Source::Along(_, axis) => Some(Vector3::from(*axis)),
            _ => None,
        });
        let frame = if along.is_some() { Frame::Body } else { frame };
        let (vector, unit) = match vector {
            Vector::Constant(vector) => (Track::Constant(vector.to_vec()), unit),
            Vector::Quantity(name, first) => {
                self.quantity(self.states.first()?, &name)?;
                let part = |state: &[f64]| -> Option<Vec<f64>> {
                    let (quantity, numbers) = self.quantity(state, &name)?;
                    let vector = match (along, numbers.get(first..)?) {
                        (Some(axis), &[size]) => axis * size,
                        (_, numbers) => place(quantity, numbers, lies),
                    };
                    Some(vector.as_slice().to_vec())
                };
                let own = self.entry.plotted.find(&name).and_then(|quantity| quantity.units.get(first));
                let unit = if unit.is_empty() { own.cloned().unwrap_or_default() } else { unit };
                (self.path(|state| part(state).unwrap_or_else(|| vec![0.0; 3])), unit)
            }
            Vector::Control(name, direction) => {
                let (quantity, _) = self.quantity(self.states.first()?, &name)?;
                let size = |state: &[f64]| self.quantity(state, &name).map_or(f64::NAN, |(_, size)| size[0]);
                let track = self.path(|state| direction.map(|x| x * size(state)).to_vec());
                (track, quantity.units.first().cloned().unwrap_or_default())
            }
        };
        let solid = of.and_then(|of| of.shape.as_ref());
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
        let mut state = entry.plotted.numbers(&sample.numbers).into_owned();
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
                Source::Lying(_) => Vector3::z(),
                _ => -Vector3::y(),
            };
            UnitQuaternion::new(axis.normalize() * im.atan2(*re))
        }
        _ => UnitQuaternion::identity(),
    }
}

/// Reads the place from a position or a rigid motion; one in the plane is upright, unless it lies.
fn place(quantity: &PlottedQuantity, numbers: &[f64], lies: bool) -> Vector3<f64> {
    match numbers.get(quantity.rotation..).unwrap_or_default() {
        &[x, y] if lies => vector![x, y, 0.0],
        coordinates => upright(coordinates),
    }
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
    use crate::Example;
    use crate::tests::catalogue;

    /// A linkage: an arm, a rod on a hinge at its end, and a bead that slides on the rod.
    #[lie_poisson_system(
        group(arm: SO2, rod: SO2, bead: R1, ship: SE2),
        hamiltonian = (arm_momentum.norm_squared() + rod_momentum.norm_squared() + bead_momentum.norm_squared()
            + ship_momentum.norm_squared()) / (2.0 * unit),
        retractions(Cayley),
    )]
    struct Linkage {
        unit: f64,
    }

    impl Example for Linkage {
        fn example() -> (Self, LinkageState) {
            let start = LinkageState {
                arm: UnitComplex::new(0.3),
                arm_momentum: vector![0.0],
                rod: UnitComplex::new(-0.8),
                rod_momentum: vector![0.0],
                bead: vector![0.25],
                bead_momentum: vector![2.0],
                ship: Isometry2::new(vector![3.0, 4.0], 0.5),
                ship_momentum: Vector3::zeros(),
            };
            (Self { unit: 1.0 }, start)
        }
    }

    #[test]
    fn planes_lie_and_bodies_are_hinged_and_slide_on_others() {
        let entry = Linkage::entry();
        let (end, tip) = (vector![0.5, 0.0, 0.1], vector![0.0, 0.0, -0.4]);
        let scene = super::super::scene(&entry, &[1.0]).lying(0).mount(1, 0, end, Vector3::x());
        let scene = scene.slide(2, 1, tip, Vector3::z()).lying(3);
        let numbers = entry.example.state.clone();
        let (casimirs, angles) = Default::default();
        let sample = RecordedSample { index: 0, time: 0.0, numbers, energy: 0.0, casimirs, angles };
        let frames = Frames::new(&entry, &[&sample]);
        let pose = |k| frames.pose(&scene, k, &frames.states[0]);
        let arm = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
        let rod = arm * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -0.8);
        let expected = [
            (Vector3::zeros(), arm),
            (arm * end, rod),
            (arm * end + rod * (tip + Vector3::z() * 0.25), rod),
            (vector![3.0, 4.0, 0.0], UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5)),
        ];
        for (k, (place, attitude)) in expected.into_iter().enumerate() {
            let found = pose(k);
            assert!((found.0 - place).norm() < 1e-15 && found.1.angle_to(&attitude) < 1e-7, "{k}: {found:?}");
        }
        // the bead's momentum is along the rod
        let momentum = scene.arrows.iter().find(|arrow| arrow.body == Some(2)).expect("an arrow");
        let arrow = frames.arrow(&scene, momentum).expect("known");
        assert_eq!((arrow.frame, arrow.vector), (Frame::Body, Some(Track::Constant(vec![0.0, 0.0, 2.0]))));
        assert_eq!(super::super::axes(&entry, &scene), None);
    }

    /// A motor is drawn as strong as it pulls in the step that begins at each sample; of what is not known nothing is
    /// drawn.
    #[test]
    fn controls_are_drawn() {
        let entry = catalogue().system("planar_pendulum").expect("it is there");
        let sample = |time: f64, torque: f64| {
            let numbers = [&entry.example.state[..], &[torque]].concat();
            let (casimirs, angles) = Default::default();
            RecordedSample { index: 0, time, numbers, energy: 0.0, casimirs, angles }
        };
        let drawn = |entry: &Entry, torques: [f64; 2], name| {
            let samples = [sample(0.0, torques[0]), sample(0.1, torques[1])];
            let frames = Frames::new(entry, &samples.iter().collect::<Vec<_>>());
            frames.arrow(&Scene::default(), &Arrow::control(name, vector![0.0, 2.0, 0.0]))
        };
        let arrow = drawn(entry, [-0.25; 2], "torque").expect("a control");
        assert_eq!(arrow.vector, Some(Track::Constant(vec![0.0, -0.5, 0.0])));
        let arrow = drawn(entry, [-0.25, 1.5], "torque").expect("a control");
        assert_eq!(arrow.vector, Some(Track::Path(vec![vec![0.0, -0.5, 0.0], vec![0.0, 3.0, 0.0]])));
        assert_eq!(drawn(&entry.clone().without_controls(), [-0.25; 2], "torque"), None);
        assert_eq!(drawn(entry, [-0.25; 2], "thrust"), None);
    }
}
