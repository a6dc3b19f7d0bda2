//! What of a system is seen in space, and where: bodies, arrows, rods.
//!
//! Each system has a scene by its state alone; its [`Example::scene`](crate::Example::scene) adds what only it knows.
//!
//! Motion in a plane is shown upright: the plane's first axis leads to the right, its second one up. So a pendulum whose angle is counted from
//! its lowest position hangs down, and swings about a horizontal axis.
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

use crate::shape::{Shape, Solid};

/// The weight of a mass of a kilogram on Earth, N.
const EARTH: f64 = 9.81;

/// What of a system is seen in space.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// What moves, and what stays where it is.
    pub bodies: Vec<Body>,
    /// Vectors.
    pub arrows: Vec<Arrow>,
    /// Rods and springs.
    pub links: Vec<Link>,
    /// The height of the ground, m.
    pub ground: Option<f64>,
}

/// A body: something with a place and an attitude, both by a quantity of the state or fixed.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Body {
    /// Its name.
    pub name: String,
    /// The quantity that turns it: a rotation in space or in the plane, or a rigid motion.
    pub rotation: Option<String>,
    /// The quantity that moves it: a position, or a rigid motion.
    pub position: Option<String>,
    /// The configuration that is a matrix and moves it, and the point that it takes to where this is.
    pub carried: Option<(String, Vec<f64>)>,
    /// On which other body it is, where in the axes of that one, m, and whether it turns with it.
    pub mount: Option<(usize, [f64; 3], bool)>,
    /// The axis of a rotation in the plane; none is that of a plane that stands upright.
    pub axis: Option<[f64; 3]>,
    /// What it looks like; none is a point, or bare axes.
    pub solid: Option<Solid>,
    /// Whether its axes are shown.
    pub axes: bool,
    /// Whether it leaves a trace.
    pub trace: bool,
    /// Whether it is a celestial body, by its colour.
    pub planet: bool,
}

/// A vector, drawn as an arrow. Arrows of one unit have one scale.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Arrow {
    /// What it is.
    pub name: String,
    /// Its letter, beside its tip; empty for its name.
    pub symbol: String,
    /// Its unit; of quantities of the state the system's own.
    pub unit: &'static str,
    /// Its components.
    pub vector: Vector,
    /// Whether these are in the axes of the body that it starts from; otherwise they are in space.
    pub in_body: bool,
    /// The body that it starts from; none starts from the origin of space.
    pub body: Option<usize>,
    /// Where in the body's axes, m.
    pub from: [f64; 3],
    /// Its colour: `c3` to `c6` or `ink`.
    pub colour: &'static str,
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

/// A rod or a spring between two points, each in the axes of a body or, without one, in space, m.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Link {
    /// From here
    pub from: (Option<usize>, [f64; 3]),
    /// to here.
    pub to: (Option<usize>, [f64; 3]),
    /// Whether it is a spring.
    pub spring: bool,
}

impl Body {
    /// What stays where the origin is, unless it is on another body.
    pub fn fixed(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// What this quantity turns: a rotation, or the rotation of a rigid motion. A rotation in space shows its axes.
    pub fn turning(quantity: &str) -> Self {
        let (rotation, axes, trace) = (Some(quantity.to_owned()), true, true);
        Self { rotation, axes, trace, ..Self::fixed(quantity) }
    }

    /// A point that this configuration, a matrix, takes to another place. Of more than three coordinates the first three are seen.
    pub fn carried(matrix: &str, point: &[f64]) -> Self {
        Self { carried: Some((matrix.to_owned(), point.to_vec())), ..Self::fixed(matrix) }
    }

    /// What this quantity moves: a position, or the position of a rigid motion. Of a matrix whose first rows and columns are a rotation, `element`,
    /// `element_rotation` turns, and its further columns move, by the names of their coordinates: `element_p`.
    pub fn moving(quantity: &str) -> Self {
        Self { position: Some(quantity.to_owned()), trace: true, ..Self::fixed(quantity) }
    }

    /// Moved by this quantity, too.
    #[must_use]
    pub fn and_moving(self, quantity: &str) -> Self {
        Self { position: Some(quantity.to_owned()), ..self }
    }

    /// Under another name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// Looking like this.
    #[must_use]
    pub fn with(self, solid: impl Into<Option<Solid>>) -> Self {
        Self { solid: solid.into(), ..self }
    }

    /// As a celestial body looks.
    #[must_use]
    pub fn planet(self) -> Self {
        Self { planet: true, ..self }
    }
}

impl Arrow {
    /// A vector in space, always the same, that starts from a body's origin.
    pub fn constant(name: &str, vector: Vector3<f64>, unit: &'static str) -> Self {
        Self {
            name: name.to_owned(),
            symbol: String::new(),
            unit,
            vector: Vector::Constant(vector.into()),
            in_body: false,
            body: Some(0),
            from: [0.0; 3],
            colour: "c6",
        }
    }

    /// A vector of the state, in space; of a quantity with more components the first three.
    pub fn quantity(quantity: &str) -> Self {
        let vector = Vector::Quantity(quantity.to_owned(), 0);
        Self { vector, colour: "c3", ..Self::constant(&quantity.replace('_', " "), Vector3::zeros(), "") }
    }

    /// A control of one number, in a direction: a thrust, the force of a motor.
    pub fn control(control: &str, direction: Vector3<f64>) -> Self {
        Self { vector: Vector::Control(control.to_owned(), direction.into()), ..Self::quantity(control) }
    }

    /// In the axes of the body that it starts from.
    #[must_use]
    pub fn in_body(self) -> Self {
        Self { in_body: true, ..self }
    }

    /// Starting from this body, at a point in its axes, m.
    #[must_use]
    pub fn on(self, body: usize, point: Vector3<f64>) -> Self {
        Self { body: Some(body), from: point.into(), ..self }
    }

    /// With this letter at its tip.
    #[must_use]
    pub fn symbol(self, symbol: &str) -> Self {
        Self { symbol: symbol.to_owned(), ..self }
    }

    /// Under another name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// The three components of the quantity from this one on.
    #[must_use]
    pub fn from_component(mut self, first: usize) -> Self {
        if let Vector::Quantity(_, from) = &mut self.vector {
            *from = first;
        }
        self
    }

    /// In this colour: `c3` to `c6` or `ink`.
    #[must_use]
    pub fn colour(self, colour: &'static str) -> Self {
        Self { colour, ..self }
    }
}

impl Scene {
    /// With one more body, the next in order from 0.
    #[must_use]
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }

    /// With one more arrow.
    #[must_use]
    pub fn arrow(mut self, arrow: Arrow) -> Self {
        self.arrows.push(arrow);
        self
    }

    /// With a rod from a point of space to one of a body, m.
    #[must_use]
    pub fn rod(mut self, from: Vector3<f64>, body: usize, to: Vector3<f64>) -> Self {
        self.links.push(Link { from: (None, from.into()), to: (Some(body), to.into()), spring: false });
        self
    }

    /// With what these edges between points look like where a configuration that is a matrix takes the points.
    #[must_use]
    pub fn frame(mut self, matrix: &str, points: &[Vec<f64>], edges: &[(usize, usize)]) -> Self {
        let first = self.bodies.len();
        self.bodies.extend(points.iter().map(|point| Body::carried(matrix, point)));
        let end = |point: usize| (Some(first + point), [0.0; 3]);
        self.links.extend(edges.iter().map(|&(from, to)| Link {
            from: end(from),
            to: end(to),
            spring: false,
        }));
        self
    }

    /// With a spring from a point of space to one of a body, m.
    #[must_use]
    pub fn spring(mut self, from: Vector3<f64>, body: usize, to: Vector3<f64>) -> Self {
        self.links.push(Link { from: (None, from.into()), to: (Some(body), to.into()), spring: true });
        self
    }

    /// With a body under another name.
    #[must_use]
    pub fn named(self, body: usize, name: &str) -> Self {
        self.changed(body, |body| body.named(name))
    }

    /// With a body that hangs from another one, at a point in the axes of that one, m: its own attitude is that in space.
    #[must_use]
    pub fn hang(self, body: usize, from: usize, point: Vector3<f64>) -> Self {
        self.changed(body, |body| Body { mount: Some((from, point.into(), false)), ..body })
    }

    /// With a body that turns about an axis of another one, relative to it.
    #[must_use]
    pub fn mount(self, body: usize, on: usize, axis: Vector3<f64>) -> Self {
        let (mount, axis) = (Some((on, [0.0; 3], true)), Some(axis.into()));
        self.changed(body, |body| Body { mount, axis, trace: false, ..body })
    }

    /// With a body whose axes are not shown.
    #[must_use]
    pub fn without_axes(self, body: usize) -> Self {
        self.changed(body, |body| Body { axes: false, ..body })
    }

    fn changed(mut self, body: usize, change: impl FnOnce(Body) -> Body) -> Self {
        if let Some(body) = self.bodies.get_mut(body) {
            *body = change(std::mem::take(body));
        }
        self
    }

    /// With the ground at this height, m.
    #[must_use]
    pub fn ground(self, height: f64) -> Self {
        Self { ground: Some(height), ..self }
    }

    /// With another look of a body.
    #[must_use]
    pub fn solid(self, body: usize, solid: impl Into<Option<Solid>>) -> Self {
        self.changed(body, |body| body.with(solid))
    }

    /// With a body that is a bob at the end of a rod of this length, m, below the body's origin.
    #[must_use]
    pub fn bob(self, body: usize, length: f64) -> Self {
        let end = vector![0.0, 0.0, -length];
        let mut scene = self.solid(body, Solid::new(Shape::Sphere { radius: 0.08 * length }).at(end));
        scene.links.push(Link { from: (Some(body), [0.0; 3]), to: (Some(body), end.into()), spring: false });
        scene
    }

    /// With the weight of a body, N, at a point in its axes, m.
    #[must_use]
    pub fn weight(self, body: usize, weight: f64, point: Vector3<f64>) -> Self {
        self.arrow(Arrow::constant("weight", vector![0.0, 0.0, -weight], "N").symbol("mg").on(body, point))
    }

    /// With a body that turns about its origin under its weight, N: the lever to its centre of mass, m, and the solid that this weight on Earth and
    /// this moment of inertia about the origin, kg m², belong to.
    #[must_use]
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
