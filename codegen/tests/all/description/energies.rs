//! Energies, inertias, forces and controls.

use super::{attribute, breaks, expands};

#[test]
fn energies_without_a_legendre_transform() {
    let bare = "struct Body { j: f64 }";
    let singular = "the second derivative of this by the velocity is singular";
    let sum = "(velocity.x + velocity.y + velocity.z).exp() * j";
    for degenerate in ["j * velocity.x.powi(2)", "j * velocity.y", sum] {
        expands(&format!("group = SO3, lagrangian = {degenerate}"), bare, &[(degenerate, singular)]);
    }
    // whatever the parameters are, and the attitude
    let armed = "struct Body { j: f64, arm: Vector3<f64> }";
    for degenerate in [
        "j * velocity.cross(&arm).norm_squared()",
        "j * (attitude * velocity.cross(&arm)).norm_squared() + attitude.w",
        "arm.norm_squared() * velocity.norm_squared() - velocity.dot(&arm).powi(2)",
        "(velocity.x * j.cos() + velocity.y * j.sin()).powi(2) + velocity.z.powi(2)",
        "-(1.0 - velocity.cross(&arm).norm_squared()).sqrt()",
    ] {
        expands(&format!("group = SO3, lagrangian = {degenerate}"), armed, &[(degenerate, singular)]);
    }
    // but not at some values of them alone
    for regular in [
        "j * velocity.cross(&arm).norm_squared() + velocity.dot(&arm).powi(2)",
        "arm.x * velocity.x.powi(2) + 2.0 * arm.y * velocity.x * velocity.y + arm.z * velocity.y.powi(2) + j * velocity.z.powi(2)",
        "-(j - velocity.norm_squared() - velocity.dot(&arm).powi(2)).sqrt()",
    ] {
        expands(&format!("group = SO3, lagrangian = {regular}"), armed, &[]);
    }
    // one problem, one error
    let vector = "velocity * j";
    expands(
        &format!("group = SO3, lagrangian = {vector}"),
        bare,
        &[(vector, "the Lagrangian must be a scalar, but this is a vector of 3")],
    );
    // no velocity has a momentum here, but only a tangent lift needs one
    let linear = "group = SO3, hamiltonian = j * momentum.z";
    expands(linear, bare, &[]);
    let singular = "the second derivative of this by the momentum is singular";
    expands(&format!("{linear}, methods(TangentLift)"), bare, &[("j * momentum.z", singular)]);
    let flat = "j * momentum.cross(&arm).norm_squared()";
    expands(&format!("group = SO3, hamiltonian = {flat}, methods(TangentLift)"), armed, &[(flat, singular)]);
    expands("group = SO3, hamiltonian = j * momentum.norm_squared(), methods(TangentLift(1, 4))", bare, &[]);
}

#[test]
fn energies_forces_and_controls() {
    let body = "struct Body { #[inertia] j: f64 }";
    let bare = "struct Body { j: f64 }";
    breaks("group = SO3, hamiltonian = momentum.norm_squared() / j", bare, &[]);
    breaks(
        "group = SO3, hamiltonian = momentum.x, potential = j",
        body,
        &[("momentum.x", "the Hamiltonian is the whole energy")],
    );
    breaks(
        "group = SO3, potential = j * momentum.x + velocity.y + u, control(u: f64)",
        body,
        &[
            ("momentum", "a potential does not depend on the momentum; an energy that does is written"),
            ("velocity", "a potential does not depend on the velocity"),
        ],
    );
    breaks("group = SO3, potential = j * u * (attitude * Vector3::z()).z, control(u: f64)", body, &[]);
    breaks("group = SO3, hamiltonian = (momentum - u).norm_squared() / j, control(u: R3)", bare, &[]);
    breaks(
        "group = SO3, lagrangian = (velocity - u).norm_squared() * j, control(u: R3), methods(TangentLift(1, 4))",
        bare,
        &[],
    );
    breaks(
        "group = SO3, hamiltonian = velocity.x",
        bare,
        &[("velocity", "an energy is a function of the momentum; write it in `momentum`")],
    );
    breaks("group = SO3, control(u: R3, w: f64), force = u - j * velocity + w * momentum", body, &[]);
    breaks(
        "group = SO3, force = j",
        body,
        &[("j", "this force must be a vector of 3, but this is a scalar")],
    );
    breaks("group = SO2, force = j * angle.sin_angle()", body, &[]);
    breaks(
        "group(a: SO3, b: R3), force = a_momentum, force(c = b)",
        "struct Broken { #[inertia] j: f64 }",
        &[("a_momentum", "on what does this force act? Write `force(a = …)`")],
    );
    breaks("group(a: SO3, b: R3), force(c = b)", body, &[("c", "there is no factor `c` to act on")]);
    // what the key says goes before what fields and controls are made of
    breaks("group = SO3, scalar = f32, hamiltonian = u, control(u: f32)", "struct Body;", &[]);
    breaks("group = SO3, hamiltonian = u, control(u: f32)", "struct Body;", &[]);
    breaks(
        "group = SO3, scalar = f32, control(u: f64)",
        "struct Body { #[inertia] j: f64 }",
        &[
            ("f64", "this is made of `f64`, but the system of `f32`"),
            ("f64", "this is made of `f64`, but the system of `f32`"),
        ],
    );
    attribute("scalar = f16", &[("f16", "a system is made of `f64` or `f32`")]);
    breaks(
        "group = SO3, control(u: f32)",
        body,
        &[("f32", "this is made of `f32`, but the system of `f64`")],
    );
    breaks(
        "group = SO3, control(j: f64)",
        body,
        &[("j", "`j` is also a field of `Body`; a control needs a name of its own")],
    );
    breaks("group = SO3, hamiltonian = momentum.x, methods(TangentLift(1, 4))", bare, &[]);
    breaks("group = SO3, lagrangian = velocity.norm_squared() * j", bare, &[]);
    breaks(
        "group = SO3, lagrangian = velocity.x, potential = j, hamiltonian = momentum.x",
        bare,
        &[
            ("momentum.x", "the Hamiltonian is the whole energy"),
            ("velocity.x", "the Lagrangian is kinetic less potential energy"),
            ("velocity.x", "the Lagrangian says what the Hamiltonian is; give one of"),
        ],
    );
    breaks(
        "group = SE3, lagrangian = j * linear_velocity.x + angular_momentum.y + u, control(u: f64)",
        bare,
        &[("angular_momentum", "a Lagrangian is a function of the velocity; write it in `angular_velocity`")],
    );
    attribute("control(u: String)", &[("String", "`u` cannot be of this type; a control is a number")]);
    attribute(
        "methods(Midpiont)",
        &[("Midpiont", "there is no method `Midpiont`; did you mean `Midpoint`?")],
    );
    attribute(
        "methods(Cayley)",
        &[("Cayley", "`Cayley` is a retraction, not a method: the standard steps with it are generated")],
    );
    attribute(
        "methods(Family(3, 2))",
        &[("Family", "the parameter s of a method is a fraction between 0 and 1")],
    );
    attribute("invariance = up", &[("up", "a system is `left`- or `right`-invariant")]);
}

#[test]
fn inertias_beside_a_hamiltonian() {
    breaks(
        "group = SO3, hamiltonian = momentum.dot(&(j.try_inverse().unwrap() * momentum)) / 2.0",
        "struct Body { #[inertia] j: Matrix3<f64> }",
        &[],
    );
    // some factors only, and several for one
    breaks(
        "group(a: SO3, b: R3), hamiltonian = a_momentum.dot(&a_momentum.component_div(&(j + k))) + b_momentum.norm()",
        "struct Body { #[inertia(a)] j: Vector3<f64>, #[inertia(a)] k: Vector3<f64> }",
        &[],
    );
    breaks(
        "group = SO3, hamiltonian = momentum.x * j.m11",
        "struct Body { #[inertia] j: Matrix2x3<f64> }",
        &[(
            "Matrix2x3<f64>",
            "an inertia is a scalar, a vector or a square matrix, but this is a 2×3 matrix",
        )],
    );
    // of the angular part alone
    breaks(
        "group = SE3, hamiltonian = (j.try_inverse().unwrap() * angular_momentum).dot(&angular_momentum) + linear_momentum.norm()",
        "struct Body { #[inertia] j: Matrix3<f64> }",
        &[],
    );
}

#[test]
fn equal_factors_share_an_inertia() {
    let pair = |ty: &str| format!("struct Pair {{ #[inertia] j: {ty} }}");
    let equal = "group(a: SO3, b: SO3)";
    for ty in ["f64", "Vector3<f64>", "Matrix3<f64>", "Vector6<f64>", "Matrix6<f64>"] {
        breaks(equal, &pair(ty), &[]);
    }
    breaks(
        equal,
        &pair("Vector2<f64>"),
        &[(
            "Vector2<f64>",
            "`SO3` and `SO3` together have dimension 6, so its inertia is a vector of 6 (a diagonal), a 6×6 matrix or a \
            scalar, but this is a vector of 2; where all have the same inertia, a vector of 3 or a 3×3 matrix will do",
        )],
    );
    // of equal dimension, but not the same thing
    breaks(
        "group(a: SO3, b: R3)",
        &pair("Vector3<f64>"),
        &[(
            "Vector3<f64>",
            "`SO3` and `R3` together have dimension 6, so its inertia is a vector of 6 (a diagonal), a 6×6 matrix or a \
            scalar, but this is a vector of 3$",
        )],
    );
    breaks(
        "group(a: SO3, b: R1, c: SO3)",
        "struct Three { #[inertia(a, c)] j: Vector3<f64>, #[inertia(b)] m: f64 }",
        &[],
    );
}
