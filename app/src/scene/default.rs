//! The scene of a system by its state alone, which the system's own completes.

use coadjoint::prelude::*;
use coadjoint::system::{Role, Side};

use super::{Arrow, Body, Frame, Scene, Source, Vector};
use crate::catalogue::Entry;
use crate::catalogue::casimir::symbols;
use crate::catalogue::plotted::PlottedQuantity;
use crate::catalogue::shape::{Shape, Solid};
use crate::error::SetupError;

/// Builds the scene of a system with these parameters.
pub(crate) fn scene(entry: &Entry, parameters: &[f64]) -> Scene {
    let mut scene = by_state(entry);
    if let (Some(inertia), Some(body)) = ((entry.body_inertia)(parameters), scene.bodies.first_mut()) {
        body.shape = Solid::of_inertia(&inertia);
    }
    let mut scene = (entry.scene)(parameters, scene);
    for body in &mut scene.bodies {
        let planar =
            body.rotation.as_ref().is_some_and(|source| !entry.plotted.is_spatial(source.quantity()));
        if planar && body.shape.is_none() && body.position.is_none() {
            let note = Some("a rod of a length that is not known".to_owned());
            let rod = Solid::new(Shape::Rod { length: 1.0, radius: 0.03 }).at(vector![0.0, 0.0, -0.5]);
            body.shape = Some(Solid { relative: true, note, ..rod });
        }
    }
    scene
}

/// Checks that the scene of a system with these parameters speaks of bodies and quantities that there are.
///
/// # Errors
/// If it does not.
pub(crate) fn check(entry: &Entry, parameters: &[f64]) -> Result<(), SetupError> {
    let scene = scene(entry, parameters);
    let wrong = |what: String| Err(SetupError::new(format!("the scene of `{}` {what}", entry.name)));
    let ends = scene.links.iter().flat_map(|link| [link.from.body, link.to.body]);
    let bodies = ends.chain(scene.arrows.iter().map(|arrow| arrow.body)).flatten().chain(scene.missing);
    // arrows start from the first body, or from space
    if let Some(body) = bodies.into_iter().find(|body| *body >= scene.bodies.len().max(1)) {
        let known = scene.bodies.iter().enumerate().map(|(k, body)| format!("{k} `{}`", body.name));
        return wrong(format!("has no body {body}: it has {}", known.collect::<Vec<_>>().join(", ")));
    }
    for (k, body) in scene.bodies.iter().enumerate() {
        if let Some((on, ..)) = body.mount.filter(|(on, ..)| *on >= k) {
            return wrong(format!("has body {k} on body {on}, which does not come before it"));
        }
        let mut sources = body.rotation.iter().chain(&body.position).map(Source::quantity);
        if let Some(name) = sources.find(|name| entry.plotted.find(name).is_none()) {
            return wrong(format!("moves body {k} by `{name}`, which is no part of the state"));
        }
    }
    Ok(())
}

/// A body for each configuration, with its momenta, and what the first body sees of space.
fn by_state(entry: &Entry) -> Scene {
    let quantities = entry.plotted.all();
    let frame = match entry.description.side {
        Side::Left => Frame::Body,
        Side::Right => Frame::Space,
    };
    let mut scene = Scene::default();
    let configurations: Vec<usize> =
        (0..quantities.len()).filter(|&k| quantities[k].role == Some(Role::Configuration)).collect();
    // the place of the one that turns before it; one coordinate is no place of a body in space: something slides
    let is_place = |k: usize| match configurations[..] {
        [first, second] => {
            let (turning, moving) = (&quantities[first], &quantities[second]);
            k == second
                && turning.rotation > 0
                && turning.components.len() == turning.rotation
                && moving.rotation == 0
                && (moving.components.len() > 1 || turning.rotation != 4)
        }
        _ => false,
    };
    let alone = configurations.len() == 1 || configurations.iter().any(|&k| is_place(k));
    for &k in &configurations {
        let quantity = &quantities[k];
        // which of several vectors is a place is not known, nor is a matrix that turns nothing
        let of_matrix = quantity.is_of_a_matrix && quantity.rotation == 0;
        if of_matrix && (configurations.len() > 2 || !quantity.name.contains('_')) {
            continue;
        }
        let mut after = quantities[k + 1..].iter().take_while(|next| next.role != Some(Role::Configuration));
        let momentum = after.find(|next| next.role == Some(Role::Momentum));
        if is_place(k) {
            scene.bodies = scene.bodies.into_iter().map(|body| body.and_moving(&quantity.name)).collect();
        } else if quantity.rotation > 0 {
            let body = Body::turning(&quantity.name).named(if alone { "body" } else { &quantity.name });
            let moves = quantity.components.len() > quantity.rotation;
            scene = scene.body(if moves { body.and_moving(&quantity.name) } else { body });
        } else if quantity.components.len() <= 3 {
            scene =
                scene.body(Body::moving(&quantity.name).named(if alone { "point" } else { &quantity.name }));
        } else {
            continue;
        }
        let body = scene.bodies.len() - 1;
        for arrow in momentum.into_iter().flat_map(|momentum| momenta(quantity, momentum, frame)) {
            let name =
                if alone { arrow.name.clone() } else { format!("{} of {}", arrow.name, quantity.name) };
            scene = scene.arrow(arrow.named(&name).on(body, Vector3::zeros()));
        }
    }
    let seen = quantities
        .iter()
        .filter(|quantity| quantity.role == Some(Role::Advected) && quantity.components.len() == 3);
    for (quantity, colour) in seen.zip(["c4", "c5"].into_iter().cycle()) {
        let on = (!scene.bodies.is_empty()).then_some(0);
        let arrow = Arrow { frame, body: on, ..Arrow::quantity(&quantity.name).colour(colour) };
        scene = scene.arrow(arrow.symbol(&symbol(&quantity.name)));
    }
    scene
}

/// The arrows of a configuration's momentum: angular and linear.
fn momenta(configuration: &PlottedQuantity, momentum: &PlottedQuantity, frame: Frame) -> Vec<Arrow> {
    let angular = Arrow { frame, ..Arrow::quantity(&momentum.name).symbol("Π") };
    let linear = |first, frame| Arrow {
        vector: Vector::Quantity(momentum.name.clone(), first),
        frame,
        ..Arrow::quantity(&momentum.name).symbol("p").colour("c5")
    };
    match (configuration.rotation, momentum.components.len()) {
        (4, 3) => vec![Arrow { name: "angular momentum".to_owned(), ..angular }],
        (4, 6) => vec![
            Arrow { name: "angular momentum".to_owned(), ..angular },
            Arrow { name: "linear momentum".to_owned(), ..linear(3, frame) },
        ],
        (0, 1..=3) => vec![Arrow { name: "momentum".to_owned(), ..linear(0, Frame::Space) }],
        _ => Vec::new(),
    }
}

fn symbol(name: &str) -> String {
    let symbol = symbols(name);
    if symbol == name { String::new() } else { symbol }
}

/// Names the axes, where the motion is in a plane or on a line.
pub(crate) fn axes(entry: &Entry, scene: &Scene) -> Option<[String; 3]> {
    let sources = || scene.bodies.iter().flat_map(|body| body.rotation.iter().chain(&body.position));
    let is_upright =
        |source: &Source| matches!(source, Source::Quantity(name) if !entry.plotted.is_spatial(name));
    let axes = match sources().next()? {
        _ if sources().all(is_upright) => ["x", "", "y"],
        _ if sources().all(Source::is_lying) => ["x", "y", ""],
        _ => return None,
    };
    Some(axes.map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use coadjoint::prelude::*;

    use super::*;
    use crate::catalogue::Example;
    use crate::tests::catalogue;

    /// A bead in a tube of a body.
    #[lie_poisson_system(group(attitude: SO3, bead: R1))]
    struct Bead {
        #[inertia(attitude)]
        inertia: Vector3<f64>,
        #[inertia(bead)]
        mass: f64,
    }

    impl Example for Bead {
        const ABOUT: &'static str = "a bead in a tube";

        fn example() -> (Self, BeadState) {
            (Bead { inertia: vector![1.0, 2.0, 2.5], mass: 1.0 }, BeadState::default())
        }
    }

    /// One body is a body; of several each has the name of its factor.
    #[test]
    fn bodies_have_names() {
        let names =
            |entry: &Entry| by_state(entry).bodies.into_iter().map(|body| body.name).collect::<Vec<_>>();
        assert_eq!(names(&Bead::entry()), ["attitude", "bead"]);
        assert_eq!(names(catalogue().system("heavy_top").expect("it is there")), ["body"]);
        let arrows: Vec<_> = by_state(&Bead::entry()).arrows.into_iter().map(|arrow| arrow.name).collect();
        assert_eq!(arrows, ["angular momentum of attitude", "momentum of bead"]);
    }

    #[test]
    fn a_scene_that_speaks_of_what_is_not_there_is_refused() {
        let top = catalogue().system("heavy_top").expect("it is there");
        let checked = |scene: fn(&[f64], Scene) -> Scene| {
            let mut entry = top.clone();
            entry.scene = std::sync::Arc::new(scene);
            check(&entry, &top.example.parameters).map_err(|error| error.to_string())
        };
        assert_eq!(checked(|_, by_state| by_state.bob(0, 1.0).weight(0, 1.0, Vector3::zeros())), Ok(()));
        assert_eq!(
            checked(|_, by_state| by_state.body(Body::moving("gamma")).hang(1, 0, Vector3::x())),
            Ok(())
        );
        for (scene, reason) in [
            (
                (|_, by_state| by_state.solid(1, None)) as fn(&[f64], Scene) -> Scene,
                "has no body 1: it has 0 `body`",
            ),
            (|_, by_state| by_state.rod(Vector3::x(), 2, Vector3::x()), "has no body 2"),
            (|_, by_state| by_state.weight(3, 1.0, Vector3::x()), "has no body 3"),
            (
                |_, by_state| by_state.hang(0, 0, Vector3::x()),
                "has body 0 on body 0, which does not come before it",
            ),
            (
                |_, by_state| by_state.body(Body::moving("tip")),
                "moves body 1 by `tip`, which is no part of the state",
            ),
        ] {
            let error = checked(scene).expect_err(reason);
            assert!(error.starts_with("the scene of `heavy_top` ") && error.contains(reason), "{error}");
        }
    }
}
