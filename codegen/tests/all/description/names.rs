//! Names in expressions: configurations, parts of momenta, points.

use super::breaks;

#[test]
fn configurations_in_expressions() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks("group = SO3, potential = (attitude.inverse() * Vector3::z()).x + attitude.w", body, &[]);
    breaks(
        "group = SE3, potential = pose.translation.x + (pose * Point3::origin()).coords.dot(&(pose.rotation * Vector3::y()))",
        body,
        &[],
    );
    breaks("group = SO2, potential = angle.cos_angle() * j", body, &[]);
    breaks("group = R3, potential = position.norm().ln() * t.sin()", body, &[]);
    breaks(
        "group = SO3, potential = attitude.x",
        body,
        &[("x", "an element of SO3 has no component `x`, but `w`, `i`, `j` and `k`")],
    );
    breaks(
        "group = SO2, potential = angle.cos_angle",
        body,
        &[("cos_angle", "`cos_angle` is a method: write `.cos_angle()`")],
    );
    breaks("group = SO3, potential = attitude.angle() * j + attitude.scaled_axis().x", body, &[]);
    breaks("group = SE3, potential = pose.rotation.angle().powi(2) * j", body, &[]);
    breaks(
        "group = SO3, potential = attitude.axis()",
        body,
        &[("axis", "an element of SO3 has no method `axis` here")],
    );
    breaks(
        "group = SO3, potential = (attitude * j).x",
        body,
        &[("*", "an element of SO3 cannot be multiplied by a scalar")],
    );
    breaks(
        "group = SO3, potential = attitude",
        body,
        &[("attitude", "the potential must be a scalar, but this is an element of SO3")],
    );
}

#[test]
fn parts_of_momenta() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks(
        "group = SE3, hamiltonian = angular_momentum.norm_squared() / j + linear_momentum.dot(&momentum.fixed_rows::<3>(3))",
        "struct Body { j: f64 }",
        &[],
    );
    breaks(
        "group = SE2, hamiltonian = angular_momentum.powi(2) / j + linear_momentum.y",
        "struct Body { j: f64 }",
        &[],
    );
    breaks(
        "group = SE3, force = (-j * angular_velocity, linear_momentum.cross(&linear_velocity))",
        body,
        &[],
    );
    breaks("group = SE2, force = (-j * angular_velocity, -linear_velocity)", body, &[]);
    breaks(
        "group(hull: SE3, rotor: SO2), force(hull = (hull_angular_momentum, hull_linear_velocity))",
        body,
        &[],
    );
    breaks(
        "group = SE3, force = (angular_velocity, j)",
        body,
        &[(
            "(angular_velocity, j)",
            "this force must be a vector of 6, or its parts `(angular, linear)`, a vector of 3 and a vector of 3, but this is a tuple of 2",
        )],
    );
    breaks(
        "group = SE2, force = (vector![j], vector![j, j])",
        body,
        &[(
            "(vector![j], vector![j, j])",
            "this force must be a vector of 3, or its parts `(angular, linear)`, a scalar and a vector of 2, but",
        )],
    );
    breaks(
        "group = SE3, force = (vector![j, j], vector![j, j, j, j])",
        body,
        &[("(vector![j, j], vector![j, j, j, j])", "this force must be a vector of 6, or its parts")],
    );
    breaks(
        "group = SO3, force = [momentum, momentum]",
        body,
        &[("[momentum, momentum]", "this force must be a vector of 3, but this is an array of 2")],
    );
    breaks(
        "group = SE2, force = angular_velocity",
        body,
        &[(
            "angular_velocity",
            "this force must be a vector of 3, or its parts `(angular, linear)`, a scalar and a vector of 2, but this is a scalar",
        )],
    );
}

#[test]
fn parts_of_momenta_are_names_like_others() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks(
        "group = SE3, potential = linear_momentum.x + angular_velocity.x",
        body,
        &[
            ("linear_momentum", "a potential does not depend on the momentum"),
            ("angular_velocity", "a potential does not depend on the velocity"),
        ],
    );
    breaks(
        "group = SE3, hamiltonian = linear_velocity.x",
        "struct Body { j: f64 }",
        &[("linear_velocity", "an energy is a function of the momentum; write it in `linear_momentum`")],
    );
    breaks(
        "group = SE3, control(linear_velocity: R3)",
        body,
        &[(
            "linear_velocity",
            "`linear_velocity` is a part of the velocity of this system; choose another name",
        )],
    );
    // other groups have no such parts, and leave the names alone
    breaks("group = SO3, control(linear_velocity: R3), force = linear_velocity", body, &[]);
    breaks(
        "group = SE3, potential = pose.momentum",
        body,
        &[("momentum", "an element of SE3 has no component `momentum`, but `rotation` and `translation`")],
    );
}

#[test]
fn points() {
    let body = "struct Body { #[inertia] j: f64, arm: Vector3<f64> }";
    breaks("group = SE3, potential = pose.transform_point(&Point3::from(arm)).z", body, &[]);
    breaks(
        "group = SE3, potential = (pose * arm).z",
        body,
        &[(
            "*",
            "`*` only turns a vector, as in nalgebra; write `pose.transform_vector(&v)` if that is meant, or",
        )],
    );
    breaks(
        "group = SE3, potential = pose.transform_point(&arm).z",
        body,
        &[(
            "&arm",
            "`transform_point` of an element of SE3 does not take a vector of 3; the point is `Point3::from(v)`",
        )],
    );
    breaks(
        "group = SO3, potential = attitude.transform_vector(&Point3::from(arm)).z",
        body,
        &[(
            "&Point3::from(arm)",
            "`transform_vector` of an element of SO3 does not take a point in 3 dimensions; the vector to it is `p.coords`",
        )],
    );
    breaks(
        "group = SE2, potential = pose.transform_point(&Point3::from(arm)).x",
        body,
        &[(
            "&Point3::from(arm)",
            "`transform_point` of an element of SE2 does not take a point in 3 dimensions",
        )],
    );
    breaks(
        "group = SE3, potential = (Point3::from(arm) + Point3::origin()).x",
        body,
        &[("+", "a point in 3 dimensions cannot be added to a point in 3 dimensions")],
    );
    breaks(
        "group = SE3, potential = Point3::from(j).x + Point3::new(j, j).x + Point3::form(arm).x + Point2::from(arm).x",
        body,
        &[
            ("j", "`Point3::from` takes a vector of 3, but this is a scalar"),
            ("new", "`Point3::new` takes 3 arguments, not 2"),
            ("form", "there is no `Point3::form` here; did you mean `from`?"),
            ("arm", "`Point2::from` takes a vector of 2, but this is a vector of 3"),
        ],
    );
    breaks(
        "group = SE3, potential = Point3::from(arm).norm()",
        body,
        &[("norm", "a point in 3 dimensions has no methods")],
    );
}

/// Coordinates that tables and invariants call by a name have it in expressions.
#[test]
fn coordinates_have_their_names() {
    let body = "struct Body { #[inertia] j: f64 }";
    for energy in [
        "hamiltonian = momentum.r12.powi(2) * j + vector![momentum.r34, (momentum).r13].sum()",
        "lagrangian = velocity.norm_squared() * j + velocity.r24",
        "potential = m.r12 + m . r13, advected(m: coadjoint), force = -j * velocity * velocity.r34",
    ] {
        let energy = energy.replace("(momentum)", "momentum");
        breaks(&format!("group = SO(4), retractions(Exponential), {energy}"), body, &[]);
    }
    breaks("group = SE2(3), hamiltonian = momentum.v1 * j + momentum.x", body, &[]);
    breaks("group(a: [SL(2); 2]), hamiltonian = a_momentum[1].h1 * j", body, &[]);
    let number =
        "has no component `r12`, but `x`, `y`, `z`, `w`, `a` and `b`; a component by its number is `[0]`";
    let message = format!("a vector of 6 {number}");
    breaks("group = SO(4), hamiltonian = { let m = momentum; m.r12 * j }", body, &[("r12", &message)]);
    let message = "a vector of 9 has no components of a name; a component by its number is `[0]`";
    breaks("group = SE2(3), hamiltonian = { let m = momentum; m.v1 * j }", body, &[("v1", message)]);
}
