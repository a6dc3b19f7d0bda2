//! Steps of systems made of texts against those that the macro makes of the same tokens: the same in every bit. The catalogue's systems are
//! compared with their files in `systems/tests/all/dynamic.rs`.

use std::sync::Arc;

use coadjoint::Run;
use coadjoint::erased::{self, EnsembleSystem, System};
use coadjoint::prelude::*;
use coadjoint_dynamic::Model;

/// Items, and their text.
macro_rules! described {
    ($text:ident: $($tokens:tt)*) => {
        $($tokens)*
        const $text: &str = stringify!($($tokens)*);
    };
}

described! { HEAVY_TOP:
    #[lie_poisson_system(
        group = SO3,
        advected(gamma: R3),
        potential = weight * gamma.dot(&chi),
        methods(Midpoint, TangentMidpoint),
        retractions(Exponential, Cayley, SecondKind),
        derivatives,
        taylor,
    )]
    struct HeavyTop {
        #[inertia]
        inertia: Vector3<f64>,
        weight: f64,
        chi: Vector3<f64>,
    }
}

described! { BODY:
    #[lie_poisson_system(group = SO3, methods(HamiltonJacobi(4)), derivatives(state))]
    struct Body {
        #[inertia]
        inertia: Matrix3<f64>,
    }
}

described! { PENDULUM:
    #[lie_poisson_system(
        group(first: SO2, second: SO2),
        control(motor: R1),
        lagrangian = {
            let (upper, lower) = (first_velocity.x, second_velocity.x);
            let between = first.inverse() * second;
            let kinetic = mass * (upper.powi(2) + lower.powi(2) / 2.0 + upper * lower * between.cos_angle());
            kinetic + mass * GRAVITY * (2.0 * first.cos_angle() + second.cos_angle())
        },
        force(first = motor - friction * first_velocity),
        event(hangs = second.sin_angle(), rises = first_velocity.x, rising),
        derivatives,
        taylor,
    )]
    struct Pendulum {
        mass: f64,
        friction: f64,
    }
    const GRAVITY: f64 = 9.81;
}

described! { MOVED:
    #[lie_poisson_system(
        group = SO2,
        control(shift: f64, swell: f64),
        lagrangian = 0.5 * mass * (1.0 + swell * swell) * velocity.x.powi(2)
            + shift * velocity.x * angle.cos_angle() + mass * angle.cos_angle(),
        event(hangs = angle.angle()),
        taylor,
    )]
    struct Moved {
        mass: f64,
    }
}

/// What both say of a scheme after some steps: states, and reports; or why there are none.
fn same(
    typed: Arc<dyn EnsembleSystem>,
    text: &str,
    schemes: &[&str],
    (state, control): (&[f64], &[f64]),
    step: f64,
) {
    let model = Model::from_text(text).unwrap_or_else(|error| panic!("{error}"));
    // as machine code, with the feature for it, and interpreted
    let dynamic = [&model, &model.interpreted()]
        .map(|model| Arc::new(model.system(&typed.parameters())) as Arc<dyn EnsembleSystem>);
    for dynamic in &dynamic {
        assert_eq!(typed.description(), dynamic.description());
        assert_eq!(typed.parameters(), dynamic.parameters());
        assert_eq!(typed.validate(), dynamic.validate());
    }
    for scheme in schemes {
        let scheme = scheme.parse().unwrap();
        let run = |system: &Arc<dyn EnsembleSystem>| {
            let system: Arc<dyn System> = system.clone();
            let mut stepper = erased::Stepper::new(system.clone(), &scheme, step).unwrap();
            let mut state = state.to_vec();
            let report = stepper.steps(&mut state, control, 300);
            let velocity = system.with_velocity(&state, 0.5, control);
            let bits: Vec<u64> = state.iter().map(|x| x.to_bits()).collect();
            let memory: Vec<u64> = stepper.snapshot().iter().map(|x| x.to_bits()).collect();
            let jacobian = stepper.step_with_jacobian(&mut state, control);
            let shown = format!("{report:?} {velocity:?} {jacobian:?}");
            (bits, shown, memory)
        };
        // numbers are shown with all their digits
        for dynamic in &dynamic {
            assert_eq!(run(&typed), run(dynamic), "{scheme}");
        }
    }
}

#[test]
fn heavy_top() {
    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
    let state = [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    let schemes = [
        "Cayley",
        "Exponential",
        "SecondKind",
        "Midpoint<Cayley>",
        "SymplecticEulerB<Exponential>",
        "TangentMidpoint<Cayley>",
        "Order4<Cayley>",
    ];
    same(Arc::new(top), HEAVY_TOP, &schemes, (&state, &[]), 0.01);
}

#[test]
fn a_body_with_steps_of_order_4() {
    let inertia = matrix![1.0, 0.1, 0.0; 0.1, 2.0, 0.2; 0.0, 0.2, 2.5];
    let state = [1.0, 0.0, 0.0, 0.0, 1.0, -0.5, 0.2];
    let schemes = ["HamiltonJacobi<Exponential, 4>", "HamiltonJacobi<Cayley, 4>", "Exponential"];
    same(Arc::new(Body { inertia }), BODY, &schemes, (&state, &[]), 0.05);
    // turned too far for one step, and a mass that no body has
    same(Arc::new(Body { inertia: 1e-3 * inertia }), BODY, &["Exponential"], (&state, &[]), 5.0);
    let wrong = Body { inertia: -inertia };
    let model = Model::from_text(BODY).unwrap();
    let typed: &dyn System = &wrong;
    let dynamic: &dyn System = &model.system(&typed.parameters());
    assert!(typed.validate().is_err());
    assert_eq!(typed.validate(), dynamic.validate());
}

#[test]
fn a_lagrangian_that_is_driven() {
    let state = [1.0, 0.0, 0.3, 0.96_f64.cos(), 0.96_f64.sin(), -0.4];
    let schemes = ["Exponential", "StormerVerlet<Exponential>"];
    let pendulum = Arc::new(Pendulum { mass: 0.7, friction: 0.2 });
    same(pendulum.clone(), PENDULUM, &schemes, (&state, &[1.5]), 0.01);
    // what is not finite is refused alike
    same(pendulum, PENDULUM, &schemes, (&state, &[f64::NAN]), 0.01);
}

/// Taylor steps to some tolerances, with what lies within them.
fn same_series(typed: Arc<dyn EnsembleSystem>, text: &str, (state, control): (&[f64], &[f64])) {
    let model = Model::from_text(text).unwrap_or_else(|error| panic!("{error}"));
    let dynamic: Arc<dyn EnsembleSystem> = Arc::new(model.system(&typed.parameters()));
    for tolerance in [1e-4, 1e-12] {
        let ways = [&typed, &dynamic].map(|system| {
            let mut trajectory = erased::Adaptive::new(system.clone(), tolerance).unwrap();
            let mut state = state.to_vec();
            let mut way = vec![trajectory.order() as f64];
            for _ in 0..50 {
                way.push(trajectory.step_with(&mut state, control).unwrap());
                way.extend(&state);
                way.extend(trajectory.at(0.3).unwrap());
            }
            way.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        });
        assert_eq!(ways[0], ways[1], "{tolerance}");
    }
    // to a time, in a run
    let ends = [&typed, &dynamic].map(|system| {
        let mut trajectory = erased::Adaptive::new(system.clone(), 1e-13).unwrap();
        let mut state = state.to_vec();
        Run::new(&mut trajectory, &mut state).with_control(control.to_vec()).to(5.0).unwrap();
        assert_eq!(trajectory.time(), 5.0);
        state
    });
    assert_eq!(ends[0], ends[1]);
}

/// Taylor steps with an input that is a function of time, and the events on the way.
#[test]
fn taylor_steps_that_are_driven() {
    let model = Model::from_text(PENDULUM).unwrap();
    let systems: [Arc<dyn System>; 2] =
        [Arc::new(Pendulum { mass: 0.7, friction: 0.2 }), Arc::new(model.system(&[0.7, 0.2]))];
    let start = [1.0, 0.0, 0.3, 0.96_f64.cos(), 0.96_f64.sin(), -0.4];
    let ways = systems.map(|system| {
        let mut trajectory = erased::Adaptive::new(system, 1e-10).unwrap();
        let (mut state, mut passes, mut rises) = (start.to_vec(), Vec::new(), Vec::new());
        Run::new(&mut trajectory, &mut state)
            .driven_by(|t| vec![(3.0 * t).sin()])
            .on("hangs", |event| passes.push(event.time()))
            .on("rises", |event| rises.push(event.time()))
            .to(6.0)
            .unwrap();
        assert!(passes.len() > 3 && rises.len() > 1, "{passes:?} {rises:?}");
        (state, passes, rises)
    });
    assert_eq!(ways[0], ways[1]);

    // where the momentum depends on what drives it
    let systems: [Arc<dyn System>; 2] =
        [Arc::new(Moved { mass: 0.7 }), Arc::new(Model::from_text(MOVED).unwrap().system(&[0.7]))];
    let ways = systems.map(|system| {
        let mut trajectory = erased::Adaptive::new(system, 1e-10).unwrap();
        let (mut state, mut passes) = (vec![0.96, 0.28, -0.4], Vec::new());
        let run = Run::new(&mut trajectory, &mut state).on("hangs", |event| passes.push(event.time()));
        run.driven_by(|t| vec![(3.0 * t).sin(), 0.2 * t]).to(6.0).unwrap();
        assert!(passes.len() > 1, "{passes:?}");
        (state, passes)
    });
    assert_eq!(ways[0], ways[1]);
    same_series(Arc::new(Moved { mass: 0.7 }), MOVED, (&[0.96, 0.28, -0.4], &[0.5, 0.3]));
}

#[test]
fn taylor_steps() {
    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let state = [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    same_series(Arc::new(top), HEAVY_TOP, (&state, &[]));
    let state = [1.0, 0.0, 0.3, 0.96_f64.cos(), 0.96_f64.sin(), -0.4];
    same_series(Arc::new(Pendulum { mass: 0.7, friction: 0.2 }), PENDULUM, (&state, &[1.5]));
    // what is not asked for is not there
    let body: Arc<dyn System> = Arc::new(Model::from_text(BODY).unwrap().system(&[1.0; 9]));
    assert!(erased::Adaptive::new(body, 1e-9).unwrap_err().to_string().contains("taylor"));
}

#[test]
fn derivatives_of_one_step() {
    let pendulum = Arc::new(Model::from_text(PENDULUM).unwrap().system(&[0.7, 0.2]));
    let state = [1.0, 0.0, 0.3, 0.96_f64.cos(), 0.96_f64.sin(), -0.4];
    let mut stepper = erased::Stepper::new(pendulum, &"Order4<Cayley>".parse().unwrap(), 0.01).unwrap();
    let (jacobian, _) = stepper.step_with_jacobian(&mut state.clone(), &[1.5]).unwrap();
    assert_eq!(
        [jacobian.state.shape(), jacobian.control.shape(), jacobian.parameters.shape()],
        [(4, 4), (4, 1), (4, 2)]
    );
    // a motor's impulse is the momentum that it gives, but for what friction and gravity take in the time of one step
    assert!((jacobian.control[(1, 0)] - 0.01).abs() < 1e-4, "{}", jacobian.control);
    assert!(jacobian.parameters[(1, 0)].abs() > 1e-3);
    // of what the description does not ask for there are none
    let body = Model::from_text(&PENDULUM.replace("derivatives,", "")).unwrap();
    let body = Arc::new(body.system(&[0.7, 0.2]));
    let mut stepper = erased::Stepper::new(body, &"Cayley".parse().unwrap(), 0.01).unwrap();
    let error = stepper.step_with_jacobian(&mut state.clone(), &[1.5]).unwrap_err();
    assert!(error.to_string().contains("derivatives"), "{error}");
}

#[test]
fn members_of_an_ensemble_move_as_one_alone_does() {
    let model = Model::from_text(HEAVY_TOP).unwrap();
    let parameters = [1.0, 10.0, 100.0, 1.0, 0.0, 0.0, 1.0];
    let top = model.system(&parameters);
    let state = |k: usize| vec![1.0, 0.0, 0.0, 0.0, 1.0, 1.0 + 0.1 * k as f64, 1.0, 0.0, 0.0, 1.0];
    for scheme in ["Cayley", "Exponential", "Order4<Cayley>"] {
        let scheme = scheme.parse().unwrap();
        let members = (0..13).map(|k| (parameters.to_vec(), state(k)));
        let mut ensemble = erased::Ensemble::new(&top, &scheme, members, 0.01).unwrap();
        assert_eq!(ensemble.run(200), 13 * 200);
        for (member, system, moved) in ensemble.members() {
            let own = system.with_parameters(&parameters);
            let mut stepper = erased::Stepper::new(own, &scheme, 0.01).unwrap();
            let mut alone = state(member);
            stepper.steps(&mut alone, &[], 200).unwrap();
            // a lane may take an iteration more than it would alone
            let off = moved.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{scheme}, {member}: {off:e}");
        }
    }
}

#[test]
fn derivatives_that_are_not_asked_for_are_not_there() {
    let state = [1.0, 0.0, 0.0, 0.0, 1.0, -0.5, 0.2];
    let typed = Body { inertia: Matrix3::from_diagonal(&vector![1.0, 2.0, 2.5]) };
    let model = Model::from_text(BODY).unwrap();
    let dynamic: Arc<dyn System> = Arc::new(model.system(&(&typed as &dyn System).parameters()));
    for system in [Arc::new(typed), dynamic] {
        let mut stepper =
            erased::Stepper::new(system, &"Order4<Exponential>".parse().unwrap(), 0.05).unwrap();
        let (jacobian, _) = stepper.step_with_jacobian(&mut state.to_vec(), &[]).unwrap();
        assert_eq!([jacobian.state.shape(), jacobian.parameters.shape()], [(6, 6), (6, 0)]);
        let gradient = stepper.gradient(0.0, &[state], |_| vec![], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]).unwrap();
        assert_eq!([gradient.state.len(), gradient.parameters.len()], [6, 0]);
    }
    // an adjoint is no matrix
    let adjoint = "#[lie_poisson_system(group = SO3, derivatives(adjoint))] struct Body { #[inertia] inertia: Vector3<f64> }";
    let system = Arc::new(Model::from_text(adjoint).unwrap().system(&[1.0, 2.0, 2.5]));
    let mut stepper = erased::Stepper::new(system, &"Exponential".parse().unwrap(), 0.05).unwrap();
    let errors = [
        stepper.step_with_jacobian(&mut state.to_vec(), &[]).unwrap_err(),
        stepper.gradient(0.0, &[state], |_| vec![], &[0.0; 6]).unwrap_err(),
    ];
    for error in errors {
        assert!(
            error.to_string().contains("`derivatives(state)` in its description asks for them"),
            "{error}"
        );
    }
}
