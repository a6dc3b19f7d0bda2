//! The scene of a system by its state alone, which the system's own completes.

use coadjoint::__private::Map;
use coadjoint::prelude::*;
use coadjoint::system::{Quantity, Role};

use crate::casimir::symbols;
use crate::entry::Entry;
use crate::scene::{Arrow, Body, Scene, Vector};
use crate::setting::{laid_out, rotation};
use crate::shape::{Shape, Solid};
use crate::shown::rows;

/// What is seen of a system with these parameters.
pub(super) fn scene(entry: &Entry, parameters: &[f64]) -> Scene {
    let mut scene = by_state(entry);
    if let (Some(inertia), Some(body)) = ((entry.body_inertia)(parameters), scene.bodies.first_mut()) {
        body.solid = Solid::of_inertia(&inertia);
    }
    let mut scene = (entry.scene)(parameters, scene);
    for body in &mut scene.bodies {
        let planar = body.rotation.as_ref().is_some_and(|name| !is_spatial(entry, name));
        if planar && body.solid.is_none() && body.position.is_none() {
            let note = Some("a rod of a length that is not known".to_owned());
            let rod = Solid::new(Shape::Rod { length: 1.0, radius: 0.03 }).at(vector![0.0, 0.0, -0.5]);
            body.solid = Some(Solid { relative: true, note, ..rod });
        }
    }
    scene
}

/// A body for each configuration, with its momenta, and what the first body sees of space.
fn by_state(entry: &Entry) -> Scene {
    let quantities = entry.shown.plotted();
    let in_body = is_left_invariant(entry);
    let mut scene = Scene::default();
    let configurations: Vec<usize> =
        (0..quantities.len()).filter(|&k| quantities[k].role == Role::Configuration).collect();
    let kinds =
        |spatial| configurations.iter().filter(|&&k| rotation(&quantities[k]).is_some() == spatial).count();
    let alone = kinds(true) <= 1 && kinds(false) <= 1;
    for &k in &configurations {
        let quantity = &quantities[k];
        // which of several vectors is a place is not known, nor is a matrix that turns nothing
        let of_matrix = entry.shown.is_of_a_matrix(quantity) && rotation(quantity).is_none();
        if of_matrix && (configurations.len() > 2 || !quantity.name.contains('_')) {
            continue;
        }
        let mut after = quantities[k + 1..].iter().take_while(|next| next.role != Role::Configuration);
        let momentum = after.find(|next| next.role == Role::Momentum);
        let position_of_the_body = configurations.len() == 2
            && rotation(quantity).is_none()
            && matches!(scene.bodies.as_slice(), [Body { rotation: Some(_), position: None, .. }]);
        if position_of_the_body {
            scene.bodies = scene.bodies.into_iter().map(|body| body.and_moving(quantity.name)).collect();
        } else if let Some((count, _)) = rotation(quantity) {
            let body = Body::turning(quantity.name).named(if alone { "body" } else { quantity.name });
            let moves = quantity.components.len() > count;
            scene = scene.body(if moves { body.and_moving(quantity.name) } else { body });
        } else if quantity.components.len() <= 3 {
            scene =
                scene.body(Body::moving(quantity.name).named(if alone { "point" } else { quantity.name }));
        } else {
            continue;
        }
        let body = scene.bodies.len() - 1;
        for arrow in momentum.into_iter().flat_map(|momentum| momenta(quantity, momentum, in_body)) {
            let name =
                if alone { arrow.name.clone() } else { format!("{} of {}", arrow.name, quantity.name) };
            scene = scene.arrow(arrow.named(&name).on(body, Vector3::zeros()));
        }
    }
    let seen = quantities
        .iter()
        .filter(|quantity| quantity.role == Role::Advected && quantity.components.len() == 3);
    for (quantity, colour) in seen.zip(["c4", "c5"].into_iter().cycle()) {
        let on = (!scene.bodies.is_empty()).then_some(0);
        let arrow = Arrow { in_body, body: on, ..Arrow::quantity(quantity.name).colour(colour) };
        scene = scene.arrow(arrow.symbol(&symbol(quantity.name)));
    }
    scene
}

/// The arrows of a configuration's momentum: angular and linear.
fn momenta(configuration: &Quantity, momentum: &Quantity, in_body: bool) -> Vec<Arrow> {
    let angular = Arrow { in_body, ..Arrow::quantity(momentum.name).symbol("Π") };
    let linear = |first, in_body| Arrow {
        vector: Vector::Quantity(momentum.name.to_owned(), first),
        in_body,
        ..Arrow::quantity(momentum.name).symbol("p").colour("c5")
    };
    match (rotation(configuration), momentum.components.len()) {
        (Some((4, _)), 3) => vec![Arrow { name: "angular momentum".to_owned(), ..angular }],
        (Some((4, _)), 6) => vec![
            Arrow { name: "angular momentum".to_owned(), ..angular },
            Arrow { name: "linear momentum".to_owned(), unit: "kg m/s", ..linear(3, in_body) },
        ],
        (None, 1..=3) => vec![Arrow { name: "momentum".to_owned(), ..linear(0, false) }],
        _ => Vec::new(),
    }
}

fn symbol(name: &str) -> String {
    let symbol = symbols(name);
    if symbol == name { String::new() } else { symbol }
}

/// Whether velocities, momenta and advected vectors are those of the body: whether a small displacement multiplies the first rotation from the right.
fn is_left_invariant(entry: &Entry) -> bool {
    let start = laid_out(entry.description.state).find(|(quantity, _)| is_rotation_in_space(quantity));
    let (Some((_, slots)), Some(before)) = (start, displacement_before(entry)) else { return true };
    let attitude = UnitQuaternion::from_euler_angles(0.4, 0.8, 1.2);
    let mut state = entry.example.state.clone();
    let [i, j, k, w]: [f64; 4] = attitude.coords.into();
    state[slots.start..slots.start + 4].copy_from_slice(&[w, i, j, k]);
    let numbers = entry.description.state.iter().map(|quantity| quantity.components.len()).sum::<usize>();
    let mut by = vec![0.0; numbers];
    let angle = 0.1;
    by[before] = angle;
    let displaced = entry.system(&entry.example.parameters).displace(&state, Map::Exponential, &by);
    let [w, i, j, k] = [0, 1, 2, 3].map(|n| displaced[slots.start + n]);
    let displaced = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
    let turn = UnitQuaternion::new(Vector3::x() * angle);
    displaced.angle_to(&(attitude * turn)) < displaced.angle_to(&(turn * attitude))
}

/// Where in a displacement that of the first rotation in space begins.
fn displacement_before(entry: &Entry) -> Option<usize> {
    let mut before = 0;
    for quantity in entry.description.state {
        if is_rotation_in_space(quantity) {
            return Some(before);
        }
        // a rotation has more components than directions
        before += quantity.components.len() - usize::from(rotation(quantity).is_some());
    }
    None
}

fn is_rotation_in_space(quantity: &Quantity) -> bool {
    quantity.role == Role::Configuration && rotation(quantity).is_some_and(|(count, _)| count == 4)
}

/// Whether a quantity turns or moves in space, not only in a plane or on a line.
pub(super) fn is_spatial(entry: &Entry, name: &str) -> bool {
    entry.shown.all().iter().any(|quantity| {
        quantity.name == name
            && (is_rotation_in_space(quantity)
                || rows(quantity).is_some_and(|rows| rows > 2)
                || rotation(quantity).is_none() && quantity.components.len() == 3)
    })
}

/// The names of the axes, where the motion is in an upright plane or on a line.
pub(super) fn axes(entry: &Entry, scene: &Scene) -> Option<[String; 3]> {
    let of = |body: &'_ Body| {
        let carried = body.carried.as_ref().map(|(matrix, _)| matrix.clone());
        body.rotation.iter().chain(&body.position).cloned().chain(carried).collect::<Vec<String>>()
    };
    let mut quantities = scene.bodies.iter().flat_map(of).peekable();
    quantities.peek()?;
    let plane = quantities.all(|name| !is_spatial(entry, &name))
        && scene.bodies.iter().all(|body| body.axis.is_none());
    plane.then(|| ["x", "", "y"].map(str::to_owned))
}

/// The names of a quantity's components; of the momentum of a rigid motion those of its two parts.
pub(super) fn component_names(entry: &Entry, quantity: &Quantity) -> Vec<String> {
    let own = || quantity.components.iter().map(|&name| name.to_owned()).collect();
    if quantity.components.len() == 1 {
        return vec![String::new()];
    }
    if quantity.role != Role::Momentum {
        return own();
    }
    let before = entry.description.state.iter().take_while(|other| other.name != quantity.name);
    let configuration = before.filter(|other| other.role == Role::Configuration).last();
    let rigid =
        configuration.and_then(|other| rotation(other).filter(|(count, _)| *count < other.components.len()));
    let names: &[&str] = match (rigid, quantity.components.len()) {
        (Some((4, _)), 6) => &["angular x", "angular y", "angular z", "linear x", "linear y", "linear z"],
        (Some((2, _)), 3) => &["angular", "linear x", "linear y"],
        _ => return own(),
    };
    names.iter().map(|&name| name.to_owned()).collect()
}
