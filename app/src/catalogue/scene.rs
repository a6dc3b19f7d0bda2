//! Scenes: bodies, arrows, rods and springs in space.
//!
//! Each system has a scene by its state alone; its [`Example::scene`](crate::Example::scene) adds what only it knows.
//!
//! Motion in a plane is shown upright: the plane's first axis leads to the right, its second one up. So a pendulum
//! whose angle is counted from its lowest position hangs down, and swings about a horizontal axis. What floats or glides
//! [lies](Scene::lying). Bodies [hang](Scene::hang) from others, turn about an axis of them ([`mount`](Scene::mount)), or
//! [slide](Scene::slide) along one.
//!
//! ```
//! use coadjoint::prelude::*;
//! use coadjoint_app::scene::{Body, Scene};
//!
//! // as a pendulum says it in its `Example::scene`, where the body that its angle turns is there already
//! let scene = Scene::default().body(Body::turning("angle"));
//! let scene = scene.bob(0, 0.3).weight(0, 9.81, vector![0.0, 0.0, -0.3]);
//! assert_eq!((scene.bodies.len(), scene.links.len(), scene.arrows.len()), (1, 1, 1));
//! ```

use coadjoint::prelude::*;
use serde::{Deserialize, Serialize};

use super::shape::{Shape, Solid};

/// The weight of a mass of a kilogram on Earth, N.
const EARTH: f64 = 9.81;

/// Bodies, arrows and links of a system, in space.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Scene {
    /// Bodies that move, and bodies that stay where they are.
    pub bodies: Vec<Body>,
    /// Vectors.
    pub arrows: Vec<Arrow>,
    /// Rods and springs.
    pub links: Vec<Link>,
    /// The height of the ground, m.
    pub ground: Option<f64>,
    /// A body that was to be changed and is not there: a mistake, with which no page is made.
    pub missing: Option<usize>,
}

/// A body: something with a place and an attitude, each given by a source or fixed.
///
/// In a [`Scene`] sources are quantities of the state; in a [page](crate::page) they are numbers at each moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
#[must_use]
pub struct Body<S = Source> {
    /// Its name.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its attitude: quaternions `[w, x, y, z]` that lead from its axes to those of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<S>,
    /// Where its origin is; without it, in the origin of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<S>,
    /// Its shape; without it a point, or bare axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Solid>,
    /// Whether its axes are drawn; without it, those of bodies with a rotation are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<bool>,
    /// The point that leaves a trace, in body axes, or `false` for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trail: Option<Trail>,
    /// `solid`, `second`, `planet`, `ink`, or `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
    /// The body it is on, where in the axes of that one, m, and whether it turns with it.
    #[serde(skip)]
    pub mount: Option<(usize, [f64; 3], bool)>,
}

/// Where the motion of a body comes from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Source {
    /// A quantity of the state: a rotation, a position, or a rigid motion. The plane of a rotation in it stands
    /// upright.
    Quantity(String),
    /// The same in a plane that lies.
    Lying(String),
    /// A rotation in the plane, about this axis.
    About(String, [f64; 3]),
    /// One coordinate, along this axis.
    Along(String, [f64; 3]),
    /// A configuration that is a matrix, and the point that it takes there.
    Carried(String, Vec<f64>),
}

impl Source {
    /// Whether its plane lies.
    #[cfg(feature = "program")]
    pub(crate) fn is_lying(&self) -> bool {
        matches!(self, Self::Lying(_))
    }

    /// The quantity.
    pub(crate) fn quantity(&self) -> &str {
        match self {
            Self::Quantity(name) | Self::Lying(name) => name,
            Self::About(name, _) | Self::Along(name, _) | Self::Carried(name, _) => name,
        }
    }
}

/// The trace that a body leaves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected `false`, or a point [x, y, z]")]
#[non_exhaustive]
pub enum Trail {
    /// Nothing, or what the page chooses.
    Shown(bool),
    /// This point.
    Point([f64; 3]),
}

/// A vector, drawn as an arrow. Those of one unit share a scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
#[must_use]
pub struct Arrow<V = Vector> {
    /// Its name.
    #[serde(default)]
    pub name: String,
    /// Its letter, beside its tip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbol: Option<String>,
    /// Its unit; of a quantity of the state the system's own.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Its components.
    pub vector: V,
    /// Whose axes its components are in. What moves in those of a body is also shown as the body sees it.
    #[serde(default)]
    pub frame: Frame,
    /// The body that it starts from, counted from 0; without it, space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// Where it starts, in that body's axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<[f64; 3]>,
    /// Drawn as long as it is, being a length.
    #[serde(default)]
    pub true_length: bool,
    /// `ink`, or `c0` to `c6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}

/// The axes in which an arrow's components are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Frame {
    /// Those of space.
    #[default]
    Space,
    /// Those of the body that it starts from.
    Body,
}

/// The components of an arrow.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Vector {
    /// Always the same.
    Constant([f64; 3]),
    /// Three components of a quantity of the state, from this one on.
    Quantity(String, usize),
    /// A control of one number, in this direction.
    Control(String, [f64; 3]),
}

/// A rod or a spring.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Link {
    /// One end.
    pub from: End,
    /// The other.
    pub to: End,
    /// Whether it is a spring.
    pub spring: bool,
}

/// A point of a body or of space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct End {
    /// The body, counted from 0; without it, space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// Where in its axes, m.
    pub at: [f64; 3],
}

impl Body {
    /// Stays where the origin is, unless it is on another body.
    pub fn fixed(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            rotation: None,
            position: None,
            shape: None,
            axes: Some(false),
            trail: Some(Trail::Shown(false)),
            colour: None,
            mount: None,
        }
    }

    /// Turns by this quantity: a rotation, or the rotation of a rigid motion. A rotation in space shows its axes.
    pub fn turning(quantity: &str) -> Self {
        let rotation = Some(Source::Quantity(quantity.to_owned()));
        Self { rotation, axes: Some(true), trail: None, ..Self::fixed(quantity) }
    }

    /// Follows a point that this configuration, a matrix, takes to another place. Of more than three coordinates the
    /// first three are seen.
    pub fn carried(matrix: &str, point: &[f64]) -> Self {
        let position = Some(Source::Carried(matrix.to_owned(), point.to_vec()));
        Self { position, colour: Some("ink".to_owned()), ..Self::fixed(matrix) }
    }

    /// Moves by this quantity: a position, or the position of a rigid motion. Of a matrix whose first rows and columns
    /// are a rotation, `element`, `element_rotation` turns, and its further columns move, by the names of their
    /// coordinates: `element_p`.
    pub fn moving(quantity: &str) -> Self {
        let position = Some(Source::Quantity(quantity.to_owned()));
        Self { position, trail: None, ..Self::fixed(quantity) }
    }

    /// Moves by this quantity, too.
    pub fn and_moving(self, quantity: &str) -> Self {
        Self { position: Some(Source::Quantity(quantity.to_owned())), ..self }
    }

    /// Has another name.
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// Has this shape.
    pub fn with(self, solid: impl Into<Option<Solid>>) -> Self {
        Self { shape: solid.into(), ..self }
    }

    /// Looks like a celestial body.
    pub fn planet(self) -> Self {
        Self { colour: Some("planet".to_owned()), ..self }
    }
}

impl Arrow {
    /// Points the same way in space at all times, from a body's origin.
    pub fn constant(name: &str, vector: Vector3<f64>, unit: &str) -> Self {
        Self {
            name: name.to_owned(),
            symbol: None,
            unit: unit.to_owned(),
            vector: Vector::Constant(vector.into()),
            frame: Frame::Space,
            body: Some(0),
            from: None,
            true_length: false,
            colour: Some("c6".to_owned()),
        }
    }

    /// Shows a vector of the state, in space; of a quantity with more components the first three.
    pub fn quantity(quantity: &str) -> Self {
        let vector = Vector::Quantity(quantity.to_owned(), 0);
        let constant = Arrow::constant(&quantity.replace('_', " "), Vector3::zeros(), "");
        Self { vector, ..constant }.colour("c3")
    }

    /// Shows a control of one number, in a direction: a thrust, the force of a motor.
    pub fn control(control: &str, direction: Vector3<f64>) -> Self {
        Self { vector: Vector::Control(control.to_owned(), direction.into()), ..Self::quantity(control) }
    }

    /// Has its components in the axes of the body that it starts from.
    pub fn in_body(self) -> Self {
        Self { frame: Frame::Body, ..self }
    }

    /// Starts from this body, at a point in its axes, m.
    pub fn on(self, body: usize, point: Vector3<f64>) -> Self {
        Self { body: Some(body), from: (point != Vector3::zeros()).then(|| point.into()), ..self }
    }

    /// Has this letter at its tip.
    pub fn symbol(self, symbol: &str) -> Self {
        Self { symbol: (!symbol.is_empty()).then(|| symbol.to_owned()), ..self }
    }

    /// Has another name.
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// Shows the three components of the quantity from this one on.
    pub fn from_component(mut self, first: usize) -> Self {
        if let Vector::Quantity(_, from) = &mut self.vector {
            *from = first;
        }
        self
    }

    /// Has this colour: `c3` to `c6` or `ink`.
    pub fn colour(self, colour: &str) -> Self {
        Self { colour: Some(colour.to_owned()), ..self }
    }
}

impl Link {
    fn new(from: (Option<usize>, Vector3<f64>), to: (usize, Vector3<f64>), spring: bool) -> Self {
        let end = |body, at: Vector3<f64>| End { body, at: at.into() };
        Self { from: end(from.0, from.1), to: end(Some(to.0), to.1), spring }
    }
}

impl Scene {
    /// Adds a body, the next in order from 0.
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }

    /// Adds an arrow.
    pub fn arrow(mut self, arrow: Arrow) -> Self {
        self.arrows.push(arrow);
        self
    }

    /// Adds a rod from a point of space to one of a body, m.
    pub fn rod(mut self, from: Vector3<f64>, body: usize, to: Vector3<f64>) -> Self {
        self.links.push(Link::new((None, from), (body, to), false));
        self
    }

    /// Adds points that a configuration, a matrix, takes elsewhere, and edges between them.
    pub fn frame(mut self, matrix: &str, points: &[Vec<f64>], edges: &[(usize, usize)]) -> Self {
        let first = self.bodies.len();
        self.bodies.extend(points.iter().map(|point| Body::carried(matrix, point)));
        let link = |&(from, to): &(usize, usize)| {
            Link::new((Some(first + from), Vector3::zeros()), (first + to, Vector3::zeros()), false)
        };
        self.links.extend(edges.iter().map(link));
        self
    }

    /// Adds a spring from a point of space to one of a body, m.
    pub fn spring(mut self, from: Vector3<f64>, body: usize, to: Vector3<f64>) -> Self {
        self.links.push(Link::new((None, from), (body, to), true));
        self
    }

    /// Renames a body.
    pub fn named(self, body: usize, name: &str) -> Self {
        self.changed(body, |body| body.named(name))
    }

    /// Hangs a body from another one, at a point in the axes of that one, m: its own attitude is that in space.
    pub fn hang(self, body: usize, from: usize, point: Vector3<f64>) -> Self {
        self.changed(body, |body| Body { mount: Some((from, point.into(), false)), ..body })
    }

    /// Mounts a body on a hinge at a point of another one, m: it turns about this axis of that one, relative to it; one that
    /// moves does so from this point on in the axes of that one. In that one's origin, as a wheel, it leaves no trace.
    pub fn mount(self, body: usize, on: usize, point: Vector3<f64>, axis: Vector3<f64>) -> Self {
        self.changed(body, |body| Body {
            mount: Some((on, point.into(), true)),
            trail: if point == Vector3::zeros() { Some(Trail::Shown(false)) } else { body.trail },
            ..body
        })
        .about(body, axis)
    }

    /// Lets a body of one coordinate slide along an axis of another one, from a point of that one on, m.
    pub fn slide(self, body: usize, on: usize, point: Vector3<f64>, axis: Vector3<f64>) -> Self {
        let along = |source: Source| Source::Along(source.quantity().to_owned(), axis.into());
        self.changed(body, |body| Body {
            mount: Some((on, point.into(), true)),
            position: body.position.map(along),
            ..body
        })
    }

    /// Lays down the plane in which a body moves, with its arrows: a ship, a puck. Its first axis leads to the right, its
    /// second one away, and it turns about the vertical.
    pub fn lying(self, body: usize) -> Self {
        let lying = |source: Source| Source::Lying(source.quantity().to_owned());
        self.changed(body, |body| Body {
            rotation: body.rotation.map(lying),
            position: body.position.map(lying),
            ..body
        })
    }

    /// Turns a body, whose rotation is in the plane, about this axis.
    pub fn about(self, body: usize, axis: Vector3<f64>) -> Self {
        let about = |source: Source| Source::About(source.quantity().to_owned(), axis.into());
        self.changed(body, |body| Body { rotation: body.rotation.map(about), ..body })
    }

    /// Hides the axes of a body.
    pub fn without_axes(self, body: usize) -> Self {
        self.changed(body, |body| Body { axes: Some(false), ..body })
    }

    fn changed(mut self, body: usize, change: impl FnOnce(Body) -> Body) -> Self {
        match self.bodies.get_mut(body) {
            Some(body) => *body = change(body.clone()),
            None => self.missing = Some(body),
        }
        self
    }

    /// Sets the height of the ground, m.
    pub fn ground(self, height: f64) -> Self {
        Self { ground: Some(height), ..self }
    }

    /// Gives a body another shape.
    pub fn solid(self, body: usize, solid: impl Into<Option<Solid>>) -> Self {
        self.changed(body, |body| body.with(solid))
    }

    /// Makes a body a bob at the end of a rod of this length, m, below the body's origin.
    pub fn bob(self, body: usize, length: f64) -> Self {
        let end = vector![0.0, 0.0, -length];
        let mut scene = self.solid(body, Solid::new(Shape::Sphere { radius: 0.08 * length }).at(end));
        scene.links.push(Link::new((Some(body), Vector3::zeros()), (body, end), false));
        scene
    }

    /// Adds the weight of a body, N, at a point in its axes, m.
    pub fn weight(self, body: usize, weight: f64, point: Vector3<f64>) -> Self {
        self.arrow(Arrow::constant("weight", vector![0.0, 0.0, -weight], "N").symbol("mg").on(body, point))
    }

    /// Makes a body a top under its weight, N: with the lever to its centre of mass, m, and the solid that this weight
    /// on Earth and this moment of inertia about the origin, kg m², belong to.
    pub fn top(self, body: usize, inertia: &Matrix3<f64>, weight: f64, lever: Vector3<f64>) -> Self {
        let mass = weight / EARTH;
        let about_centre = inertia
            - (Matrix3::from_diagonal_element(lever.norm_squared()) - lever * lever.transpose()) * mass;
        let scene = match Solid::of_mass(&about_centre, mass) {
            Some(solid) => self.solid(body, solid.at(lever)).rod(Vector3::zeros(), body, lever),
            None => self.solid(body, Solid::of_inertia(inertia)),
        };
        let arrow = Arrow::constant("lever", lever, "m").symbol("χ").colour("ink").in_body();
        scene.arrow(arrow.on(body, Vector3::zeros())).weight(body, weight, lever)
    }
}
