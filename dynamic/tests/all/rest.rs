//! Steps of higher order that begin at rest.

use std::sync::Arc;

use coadjoint::erased;
use coadjoint_dynamic::Model;

/// A mass that falls through air.
const FALLING: &str = "
    #[lie_poisson_system(
        group = R3,
        potential = mass * g * position.z,
        force = -drag * velocity.norm() * velocity,
        methods(HamiltonJacobi(4)),
    )]
    struct Falling { #[inertia] mass: f64, g: f64, drag: f64 }";

/// A body that a motor turns through air.
const TURNING: &str = "
    #[lie_poisson_system(
        group = SO3,
        force = vector![0.0, 0.0, torque] - drag * velocity.norm() * velocity,
        methods(HamiltonJacobi(4)),
    )]
    struct Turning { #[inertia] inertia: Vector3<f64>, torque: f64, drag: f64 }";

/// Speed and way of what is accelerated from rest to a final speed, after a time.
fn exact(acceleration: f64, last: f64, time: f64) -> [f64; 2] {
    let x = acceleration * time / last;
    [last * x.tanh(), last * last / acceleration * x.cosh().ln()]
}

/// Drag has no second derivative by the velocity at rest, and needs none: rest is where a step begins, not where it is.
#[test]
fn drag_sets_in_from_rest() {
    let end = |text: &str, parameters: &[f64], start: &[f64], steps: u64| {
        let system = Arc::new(Model::from_text(text).unwrap().system(parameters));
        let scheme = "HamiltonJacobi<Exponential, 4>".parse().unwrap();
        let mut stepper = erased::Stepper::new(system, &scheme, 2.0 / steps as f64).unwrap();
        let mut state = start.to_vec();
        stepper.steps(&mut state, &[], steps).unwrap();
        state
    };
    let [speed, way] = exact(9.81, (9.81_f64 / 0.3).sqrt(), 2.0);
    let off = |steps: u64| {
        let state = end(FALLING, &[1.0, 9.81, 0.3], &[0.0; 6], steps);
        ((state[2] + way) / way).abs().max(((state[5] + speed) / speed).abs())
    };
    let (coarse, fine) = (off(20), off(40));
    assert!(fine < 1e-6 && (coarse / fine).log2() > 3.5, "{coarse:e}, {fine:e}");

    let moment = 2.5;
    let [rate, _] = exact(0.7 / moment, (0.7_f64 / 0.3).sqrt(), 2.0);
    let off = |steps: u64| {
        let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let state = end(TURNING, &[1.0, 2.0, moment, 0.7, 0.3], &start, steps);
        (state[6] / (moment * rate) - 1.0).abs()
    };
    let (coarse, fine) = (off(10), off(20));
    assert!(fine < 1e-6 && (coarse / fine).log2() > 3.5, "{coarse:e}, {fine:e}");
}

/// Forces that are written with directions, whose whole is smooth at zero or has a limit there.
#[test]
fn directions_are_nothing_at_zero_where_the_whole_is() {
    let forces = [
        // saturated
        "-k * position.norm().min(1.0) * position.normalize()",
        "-k * position.norm().min(k) * position.normalize()",
        "-k * velocity.norm().clamp(0.0, 1.0) * velocity.normalize()",
        "-position * k.min(1.0 / position.norm())",
        // a tether that is slack
        "-k * (position.norm() - 1.0).max(0.0) * position.normalize()",
        "-k * (position.norm() - k).max(0.0) * position.normalize()",
    ]
    .map(|force| format!("force = {force}"));
    let potentials = [
        "k * position.norm().max(0.0).powi(2)",
        "k * position.norm().min(k).powi(2)",
        "k * (position.norm() - 1.0).max(0.0).powi(2)",
    ]
    .map(|potential| format!("potential = {potential}"));
    for force in forces.into_iter().chain(potentials) {
        let text = format!(
            "#[lie_poisson_system(group = R3, {force}, methods(Midpoint), derivatives(state))]
             struct Held {{ #[inertia] mass: f64, k: f64 }}"
        );
        let system = Arc::new(Model::from_text(&text).unwrap().system(&[2.0, 3.0]));
        for scheme in ["Exponential", "Midpoint<Exponential>"] {
            let mut stepper = erased::Stepper::new(system.clone(), &scheme.parse().unwrap(), 0.1).unwrap();
            let mut state = [0.0; 6];
            stepper.step(&mut state, &[]).unwrap_or_else(|error| panic!("{force}, {scheme}: {error}"));
            assert_eq!(state, [0.0; 6], "{force}, {scheme}");
            // and near zero it is what it is at zero
            let (mut here, mut there) = ([0.0; 6], [1e-9; 6]);
            let (at, _) =
                stepper.step_with_jacobian(&mut here, &[]).unwrap_or_else(|error| panic!("{force}: {error}"));
            let (near, _) = stepper.step_with_jacobian(&mut there, &[]).unwrap();
            let pairs = at.state.iter().zip(near.state.iter());
            assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-6), "{force}, {scheme}");
        }
    }
}

/// Forces and energies whose parts are nothing together at zero, though each is divided there.
#[test]
fn what_cancels_at_zero_is_followed() {
    let of_position = [
        // with a length at rest, or a size, that is zero
        ("potential = k * (position.norm() - none).powi(2)", true),
        ("force = -none * position.normalize() - k * position", true),
        ("force = -none * position_velocity.normalize()", true),
        ("potential = k * position.dot(&position.normalize()).powi(2)", true),
        ("potential = k * (1.0 + position.norm()) * (-position.norm()).exp()", true),
        ("potential = k * position.norm_squared().powi(2).sqrt()", true),
        ("potential = k * (position.norm() - position.norm().sin())", true),
        ("force = -k * position.norm() * position_velocity - position", true),
        ("force = -k * position_velocity.x.hypot(position_velocity.y) * position_velocity", true),
        ("force = -position_velocity.norm().powf(1.5) * position_velocity", true),
        ("force = { let v = position_velocity.x; vector![-k * v.abs().powf(0.7) * v, 0.0, 0.0] }", true),
        ("force = { let p = position_momentum.x; vector![-k * p.abs().powf(0.75) * p, 0.0, 0.0] }", true),
        ("potential = k * position.x.powi(4).sqrt()", true),
        ("force = -k * (1.0 - (-position.norm()).exp()) * position.normalize()", true),
        ("potential = position.norm().powf(k)", true),
        ("potential = position.x.abs().powf(k)", true),
        ("potential = position.x.abs().powf(k - 1.0) * position.x.abs()", true),
        ("force = -position_velocity.norm().powf(k - 2.0) * position_velocity", true),
        // of these the derivative has a limit that is not known here
        ("force = -k * (1.0 + position.norm()).ln() * position.normalize()", false),
        ("potential = k * position.norm() * (1.0 - (-position.norm()).exp())", false),
    ];
    let of_attitude = [
        ("force = -k * attitude.scaled_axis().normalize() * attitude.angle()", true),
        ("force = -k * attitude.angle() * attitude_velocity - attitude.scaled_axis()", true),
        ("potential = k * (attitude.angle() - none).powi(2)", false),
    ];
    for (group, inertia, form, is_smooth) in of_position
        .map(|(form, is_smooth)| ("position: R3", "mass: f64", form, is_smooth))
        .into_iter()
        .chain(of_attitude.map(|(form, is_smooth)| ("attitude: SO3", "mass: Vector3<f64>", form, is_smooth)))
    {
        let text = format!(
            "#[lie_poisson_system(group({group}), {form}, methods(Midpoint), derivatives(state))]
             struct Held {{ #[inertia] {inertia}, k: f64, none: f64 }}"
        );
        let is_body = group.starts_with("attitude");
        let parameters: &[f64] = if is_body { &[1.0, 2.0, 3.0, 2.0, 0.0] } else { &[2.0, 2.0, 0.0] };
        let system = Arc::new(Model::from_text(&text).unwrap().system(parameters));
        let rest = if is_body { vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] } else { vec![0.0; 6] };
        let mut stepper =
            erased::Stepper::new(system.clone(), &"Midpoint<Exponential>".parse().unwrap(), 0.1).unwrap();
        let mut state = rest.clone();
        stepper.step(&mut state, &[]).unwrap_or_else(|error| panic!("{form}: {error}"));
        assert_eq!(state, rest, "{form}");
        let mut near = rest.clone();
        let along = [0.3, -0.7, 0.2, 0.5, 0.4, -0.6];
        near.iter_mut().rev().zip(along).for_each(|(x, by)| *x += 1e-9 * by);
        let (there, _) = stepper.step_with_jacobian(&mut near, &[]).unwrap();
        match (stepper.step_with_jacobian(&mut state, &[]), is_smooth) {
            (Ok((here, _)), true) => {
                let off = here
                    .state
                    .iter()
                    .zip(there.state.iter())
                    .fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
                assert!(off < 1e-6, "{form}: {off:e}");
            }
            (Err(_), false) => {}
            (result, _) => panic!("{form}: {:?}", result.err()),
        }
    }
}

/// Terms of higher order of a step are made of derivatives that some energies do not have at zero: there the step has the order that it has without
/// them. It is where controllers and dampers end.
#[test]
fn steps_of_higher_order_come_to_rest() {
    let forms = [
        (
            "attitude: SO3",
            "force = { let e = attitude.scaled_axis(); -k * (1.0 + e.norm().tanh()) * e - attitude_velocity }",
        ),
        ("attitude: SO3", "potential = k * attitude.angle().powi(3), force = -attitude_velocity"),
        (
            "position: R3",
            "potential = k * position.norm_squared(), force = -(1.0 + position_velocity.norm().powf(0.7)) * position_velocity",
        ),
        (
            "position: R3",
            "potential = k * position.norm_squared(), force = -(1.0 + position_velocity.norm().powf(n)) * position_velocity",
        ),
        (
            "position: R1",
            "potential = k * position.x.powi(2), force = { let v = position_velocity.x; vector![-v - v.abs().powf(n) * v] }",
        ),
        ("position: R3", "potential = k * position.norm().powf(n + 1.3), force = -position_velocity"),
    ];
    for (group, form) in forms {
        let (inertia, is_body) = if group.contains("SO3") { ("Vector3<f64>", true) } else { ("f64", false) };
        // of bodies the terms of order 6 take long to derive
        let schemes = &["HamiltonJacobi<Exponential, 4>", "HamiltonJacobi<Exponential, 6>"]
            [..if is_body { 1 } else { 2 }];
        let methods = if is_body {
            "methods(HamiltonJacobi(4))"
        } else {
            "methods(HamiltonJacobi(4), HamiltonJacobi(6))"
        };
        let text = format!(
            "#[lie_poisson_system(group({group}), {form}, {methods}, retractions(Exponential))]
             struct Held {{ #[inertia] mass: {inertia}, k: f64, n: f64 }}"
        );
        let parameters: &[f64] = if is_body { &[1.0, 2.0, 3.0, 2.0, 0.7] } else { &[2.0, 2.0, 0.7] };
        let system = Arc::new(
            Model::from_text(&text).unwrap_or_else(|error| panic!("{form}: {error}")).system(parameters),
        );
        let rest = match group {
            "position: R1" => vec![0.0; 2],
            "position: R3" => vec![0.0; 6],
            _ => vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        let off = |state: &[f64]| state.iter().zip(&rest).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
        for scheme in schemes {
            let stepper = |h: f64| erased::Stepper::new(system.clone(), &scheme.parse().unwrap(), h).unwrap();
            let mut state = rest.clone();
            stepper(0.1).step(&mut state, &[]).unwrap_or_else(|error| panic!("{form}, {scheme}: {error}"));
            assert_eq!(state, rest, "{form}, {scheme}");
            // through all sizes that there are, and on
            let mut start = rest.clone();
            let at = if is_body { 4 } else { 0 };
            start[at..].iter_mut().zip([0.4, 0.3, -0.1, 0.1, -0.2, 0.3]).for_each(|(x, by)| *x += by);
            let mut state = start.clone();
            stepper(0.5)
                .steps(&mut state, &[], 6_000)
                .unwrap_or_else(|error| panic!("{form}, {scheme}: {error}"));
            assert!(off(&state) < 1e-3, "{form}, {scheme}: {state:?}");
            // while it moves it is of its order; on a line it comes to rest at each turn
            if rest.len() == 2 {
                continue;
            }
            let end = |steps: u64| {
                let mut state = start.clone();
                stepper(1.0 / steps as f64).steps(&mut state, &[], steps).unwrap();
                state
            };
            let [coarse, middle, fine] = [10, 20, 40].map(end);
            let apart =
                |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            let slope = (apart(&coarse, &middle) / apart(&middle, &fine)).log2();
            assert!(slope > 3.8, "{form}, {scheme}: {slope}");
        }
    }
}

/// Forces that saturate, near to zero and far out: nothing cancels, and nothing overflows.
#[test]
fn forces_saturate_at_every_distance() {
    let steps = |force: &str, keys: &str| {
        let text = format!(
            "#[lie_poisson_system(group = R3, force = {force}, {keys})]
             struct Held {{ #[inertia] mass: f64, width: f64 }}"
        );
        Arc::new(
            Model::from_text(&text).unwrap_or_else(|error| panic!("{force}: {error}")).system(&[1.0, 0.01]),
        )
    };
    let saturation = |x: f64| if x > 20.0 { 1.0 } else { x.tanh() };
    type Size = fn(f64) -> f64;
    let forces: [(&str, Size, f64); 3] = [
        ("-(position.norm() / width).tanh() * position.normalize()", saturation, 0.01),
        ("{ let r = position.norm(); -(r.tanh() / r) * position }", saturation, 1.0),
        ("-(1.0 - (-position.norm()).exp()) * position.normalize()", |x| -(-x).exp_m1(), 1.0),
    ];
    for (force, size, width) in forces {
        let plain = steps(force, "methods(HamiltonJacobi(4)), retractions(Exponential), derivatives(state)");
        let series = steps(force, "taylor");
        for r in [1e-300, 1e-30, 1e-17, 1e-9, 1e-3, 0.3, 5.0, 7.2, 19.9, 20.1, 400.0, 720.0, 1e6] {
            let near = [0.6 * r, 0.0, 0.8 * r, 0.0, 0.0, 0.0];
            let (h, expected) = (1e-6, size(r / width));
            // of a second derivative there is none at zero
            let has_exponential = force.contains("exp");
            for scheme in ["Exponential", "HamiltonJacobi<Exponential, 4>"] {
                if has_exponential && r < 1e-9 && scheme != "Exponential" {
                    continue;
                }
                let mut stepper = erased::Stepper::new(plain.clone(), &scheme.parse().unwrap(), h).unwrap();
                let mut state = near;
                let (jacobian, _) = stepper
                    .step_with_jacobian(&mut state, &[])
                    .unwrap_or_else(|error| panic!("{force}, {scheme}, {r:e}: {error}"));
                let off = (state[5] / h / (-0.8 * expected) - 1.0).abs();
                // what is smaller than rounding of 1 is lost in the force, and nothing in its derivative
                let is_lost = has_exponential && r < 1e-3;
                assert!(off < 1e-8 || is_lost, "{force}, {scheme}, {r:e}: {off:e}");
                // across the radius
                let off = (jacobian.state[(4, 1)] / h / (-expected / r) - 1.0).abs();
                assert!(off < 1e-7, "{force}, {scheme}, {r:e}, the derivative: {off:e}");
            }
            if r > 1e-12 {
                let mut steps = erased::Adaptive::new(series.clone(), 1e-12).unwrap();
                let mut state = near.to_vec();
                coadjoint::Run::new(&mut steps, &mut state).to(h).unwrap();
                let off = (state[5] / h / (-0.8 * expected) - 1.0).abs();
                assert!(off < 1e-3, "{force}, {r:e}, Taylor: {off:e}");
            }
        }
    }
}

/// A contact after Hertz: nothing where there is none, and so are all derivatives, whatever the exponent is.
#[test]
fn what_does_not_touch_feels_nothing() {
    let contacts = [
        ("k * position.x.max(0.0).powf(2.5)", "HamiltonJacobi(6)"),
        ("k * (position.x.max(0.0) / length).powf(2.5)", "HamiltonJacobi(6)"),
        ("k * position.x.max(0.0).powf(n)", "HamiltonJacobi(4)"),
    ];
    for (potential, method) in contacts {
        let text = format!(
            "#[lie_poisson_system(group = R1, potential = {potential}, methods({method}), retractions(Exponential), derivatives)]
             struct Contact {{ #[inertia] mass: f64, k: f64, length: f64, n: f64 }}"
        );
        let model = Model::from_text(&text).unwrap_or_else(|error| panic!("{potential}: {error}"));
        let system = Arc::new(model.system(&[2.0, 30.0, 1.0, 2.5]));
        let scheme = format!("HamiltonJacobi<Exponential, {}>", if method.contains('6') { 6 } else { 4 });
        for scheme in [&scheme, "Exponential"] {
            let mut stepper = erased::Stepper::new(system.clone(), &scheme.parse().unwrap(), 0.1).unwrap();
            let mut state = [-0.3, 0.5];
            let (jacobian, _) = stepper
                .step_with_jacobian(&mut state, &[])
                .unwrap_or_else(|error| panic!("{potential}, {scheme}: {error}"));
            assert!((state[0] + 0.275).abs() < 1e-15 && state[1] == 0.5, "{potential}, {scheme}: {state:?}");
            let by_parameters = jacobian.parameters.columns(1, 3);
            assert!(
                by_parameters.iter().all(|entry| *entry == 0.0),
                "{potential}, {scheme}: {by_parameters}"
            );
            assert!((jacobian.state[(0, 1)] - 0.05).abs() < 1e-15, "{potential}, {scheme}");
        }
        // it bounces, and keeps its energy
        let mut stepper = erased::Stepper::new(system.clone(), &scheme.parse().unwrap(), 0.01).unwrap();
        let mut state = [-0.3, 0.5];
        stepper.steps(&mut state, &[], 600).unwrap();
        let energy = state[1] * state[1] / 4.0 + 30.0 * state[0].max(0.0).powf(2.5);
        assert!(state[1] < 0.0 && (energy / 0.0625 - 1.0).abs() < 1e-3, "{potential}: {state:?}");
    }
}
