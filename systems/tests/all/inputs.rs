//! Inputs from tables keep the order of the scheme: of ours and of classical methods, of one run and of the members of an ensemble.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use coadjoint_app::Entry;
use coadjoint_app::catalogue::{Input, Interpolation, Setup};
use coadjoint_app::setup::{Classical, Job, Method, Order, Retraction};
use coadjoint_app::simulate::simulate;
use coadjoint_systems::catalogue::CATALOGUE;

/// Between two rows, s: steps end at rows, since a spline is smooth between them alone.
const ROW: f64 = 0.2;
const END: f64 = 2.0;

/// A quadrotor that is pushed and turned as a table says.
fn driven(interpolation: Interpolation) -> (&'static Entry, Setup) {
    let entry = CATALOGUE.find("quadrotor").expect("it is there");
    let mut table = "time,thrust,moment_y,moment_x\n".to_owned();
    for row in 0..=10 {
        let time = f64::from(row) * ROW;
        let (thrust, pitch, roll) =
            (12.0 + 3.0 * (1.3 * time).sin(), 0.02 * (2.0 * time).cos(), 0.01 * time.sin());
        table += &format!("{time:?},{thrust:?},{pitch:?},{roll:?}\n");
    }
    let input = Input::parse(entry, PathBuf::from("thrust.csv"), &table, interpolation).expect("a table");
    (entry, Setup { input: Some(Arc::new(input)), ..entry.example.clone() })
}

fn end(method: Method, order: Order, steps: u64, interpolation: Interpolation) -> Vec<f64> {
    let (entry, setup) = driven(interpolation);
    let step = END / steps as f64;
    let job = Job { method, retraction: Retraction::Exponential, order, step, steps, rest: 0.0 };
    let mut last = Vec::new();
    simulate(entry, &setup, &job, None, &|index| index + 1, &mut |sample| {
        last = sample.state.to_vec();
        ControlFlow::Continue(())
    })
    .expect("solvable");
    last
}

fn assert_order(method: Method, order: Order, expected: f64, steps: u64) {
    let reference = end(Method::Standard, Order::Eight, 1_600, Interpolation::Cubic);
    let errors = [1, 2, 4].map(|times| {
        let end = end(method, order, times * steps, Interpolation::Cubic);
        end.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    });
    for pair in errors.windows(2) {
        let measured = (pair[0] / pair[1]).log2();
        assert!(
            (measured - expected).abs() < 0.1,
            "{method}: order {measured} instead of {expected}: {errors:?}"
        );
    }
}

#[test]
fn a_table_keeps_the_order() {
    assert_order(Method::Standard, Order::Two, 2.0, 80);
    assert_order(Method::Standard, Order::Four, 4.0, 80);
    assert_order(Method::Standard, Order::Six, 6.0, 10);
    assert_order(Method::Classical(Classical::Rk4), Order::Two, 4.0, 80);
    assert_order(Method::Classical(Classical::Rkmk4), Order::Two, 4.0, 40);
}

#[test]
fn what_jumps_is_integrated_from_jump_to_jump() {
    // by a control that is held, as steps end at rows
    let (entry, setup) = driven(Interpolation::Previous);
    let input = setup.input.clone().expect("an input");
    let system = entry.system(&setup.parameters);
    let mut state = setup.state.clone();
    let scheme = "Order4<Exponential>".parse().expect("a scheme");
    let mut stepper = coadjoint::erased::Stepper::new(system, &scheme, 0.02).expect("valid");
    for k in 0..100 {
        let mut control = vec![0.0; setup.controls.len()];
        input.write(f64::from(k) * 0.02 + 0.001, &mut control);
        stepper.step(&mut state, &control).expect("solvable");
    }
    let driven = end(Method::Standard, Order::Four, 100, Interpolation::Previous);
    for (a, b) in driven.iter().zip(&state) {
        assert!((a - b).abs() < 1e-12, "{driven:?}, {state:?}");
    }
}
