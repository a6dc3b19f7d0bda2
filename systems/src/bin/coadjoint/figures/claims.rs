//! The claims of the paper and of our captions about the figures, tested with numbers.

use crate::figures::Data;
use crate::figures::bodies::{Bodies, STEPS};
use crate::figures::kepler::Orbits;
use crate::figures::methods::{
    CAYLEY, EXPONENTIAL, HAMILTON_JACOBI, ORDER_4, ORDER_6, ORDER_8, RK4, RKMK4, marked,
};
use crate::figures::oscillator::Oscillator;
use crate::figures::pendulum::Swings;
use crate::figures::quadrotor::Hover;
use crate::figures::steps::{Steps, better, growth};
use crate::figures::work::{Sampling, Work};
use coadjoint_app::picture::{Axis, Figure, Key, Panel};
use coadjoint_app::record::DriftStats;

/// Whether a quantity drifts: whether a linear trend makes up most of its range.
fn drifts(stats: &DriftStats) -> bool {
    stats.drift() > 0.7
}

/// Figure 1.1: "the explicit Euler method artificially injects energy", by `1 + h²` a step; the implicit one dissipates as much; the
/// symplectic ones keep it bounded, between the values of the ellipse `q² ± h q p + p²` that they stay on.
#[test]
fn euler_methods_of_the_oscillator() {
    let measured = Oscillator::measure().expect("solvable");
    let [explicit, implicit, a, b] = measured.orbits.each_ref().map(|orbit| orbit.energies());
    for (k, (gained, lost)) in explicit.iter().zip(&implicit).enumerate() {
        let factor = 1.01_f64.powi(k as i32);
        assert!((gained / factor - 1.0).abs() < 1e-13, "{gained}");
        assert!((lost * factor - 1.0).abs() < 1e-13, "{lost}");
    }
    for orbit in &measured.orbits[2..] {
        let sign = if orbit.method.contains('A') { -1.0 } else { 1.0 };
        for (q, p) in &orbit.points {
            let ellipse = q * q + sign * 0.1 * q * p + p * p;
            assert!((ellipse - 1.0).abs() < 1e-14, "{}: {ellipse}", orbit.method);
        }
    }
    for energy in a.iter().chain(&b) {
        assert!((1.0 / 1.05 - 1e-12..=1.0 / 0.95 + 1e-12).contains(energy), "{energy}");
    }
    // there are swings to see
    assert!(a.iter().any(|energy| *energy > 1.04) && a.iter().any(|energy| *energy < 0.96));
}

/// Figure 1.2: RK2's orbit spirals away "as energy is artificially injected"; with Störmer–Verlet energy "oscillates around its exact value"
/// and "the angular momentum is preserved exactly".
#[test]
fn kepler_orbits() {
    let Orbits { rk2, verlet } = Orbits::measure().expect("solvable");
    let energy = &rk2.energy.stats;
    assert!(drifts(energy) && energy.slope() > 1e-3 && energy.error > 0.1, "{energy:?}");
    assert!(rk2.angular_momentum.stats.error > 5e-3);
    let energy = &verlet.energy.stats;
    assert!(!drifts(energy) && energy.error < 0.03, "{energy:?}");
    // at its farthest it is back to where it was
    assert!(energy.slope().abs() * 30.0 < 1e-3, "{energy:?}");
    let error = verlet.angular_momentum.stats.error;
    assert!(error < 1e-14, "{error}");
    // its orbit turns, and stays: neither comes farther out than it began
    let farthest = |path: &[(f64, f64)]| path.iter().fold(0.0_f64, |most, (x, y)| most.max(x.hypot(*y)));
    assert!(farthest(&verlet.path) < 1.001, "{}", farthest(&verlet.path));
    assert!(farthest(&rk2.path) > 1.1, "{}", farthest(&rk2.path));
}

/// Figure 1.3: unprojected, the motion leaves the cylinder; projected, it stays, and there is an "unbounded growth of the system's energy".
#[test]
fn pendulum_with_and_without_projection() {
    let Swings { free, projected, verlet } = Swings::measure().expect("solvable");
    assert!(drifts(&free.radius.stats) && free.radius.stats.error > 5e-3, "{:?}", free.radius.stats);
    assert!(projected.radius.stats.error < 1e-15 && verlet.radius.stats.error < 1e-15);
    for swing in [&free, &projected] {
        assert!(drifts(&swing.energy.stats), "{}: {:?}", swing.method, swing.energy.stats);
    }
    assert!(projected.energy.stats.slope() > 1e-4);
    // projection makes it worse
    assert!(projected.energy.stats.error > 2.0 * free.energy.stats.error);
    assert!(!drifts(&verlet.energy.stats) && verlet.energy.stats.error < 2e-3, "{:?}", verlet.energy.stats);
}

/// Figures 6.1 and 6.2: ours preserve the Casimirs and have "excellent long-term energy behavior"; RK4 and RKMK4 "exhibit long-time drift in
/// both the Hamiltonian" and the Casimirs. The paper does not say how small that drift is: the bounds below are from both sides.
#[test]
fn bodies_over_thirty_minutes() {
    for (name, bodies, order2, energy4, casimir4) in
        [("free", Bodies::free(STEPS), 2e-6, 2e-10, 5e-9), ("top", Bodies::top(STEPS), 2e-4, 2e-8, 1e-7)]
    {
        let bodies = bodies.expect("solvable");
        let [ours @ .., rk4, rkmk4] = &bodies.runs;
        for run in ours {
            let [energy, casimirs @ ..] = &run.invariants[..] else { panic!("{name}: no invariants") };
            assert!(energy.stats.drift() < 0.2, "{name}, {}: {:?}", run.method, energy.stats);
            assert!(
                (1e-8..order2).contains(&energy.stats.error),
                "{name}, {}: {:?}",
                run.method,
                energy.stats
            );
            for casimir in casimirs {
                assert!(casimir.stats.error < 5e-13, "{name}, {}: {:?}", run.method, casimir.stats);
            }
        }
        for run in [rk4, rkmk4] {
            let [energy, casimirs @ ..] = &run.invariants[..] else { panic!("{name}: no invariants") };
            assert!(drifts(&energy.stats), "{name}, {}: {:?}", run.method, energy.stats);
            // small as it is at this step: smaller than the energy error of order 2
            assert!(
                (0.1 * energy4..energy4).contains(&energy.stats.error),
                "{name}, {}: {:?}",
                run.method,
                energy.stats
            );
            for casimir in casimirs {
                assert!(drifts(&casimir.stats), "{name}, {}: {:?}", run.method, casimir.stats);
                assert!((0.1 * casimir4..casimir4).contains(&casimir.stats.error), "{:?}", casimir.stats);
            }
        }
    }
}

/// Figure 6.3: "the method preserves angular momentum and respects the underlying manifold structure"; "one could alternatively employ higher-order
/// symplectic integrators, such as Störmer–Verlet […], to improve accuracy".
#[test]
fn quadrotor_over_thirty_minutes() {
    let hover = Hover::measure(STEPS).expect("solvable");
    for run in hover.flights.iter().map(|flight| &flight.run) {
        let [in_space, length, on_group] = [0, 1, 2].map(|i| run.invariants[i].stats.error);
        assert!(
            in_space < 1e-12 && length < 5e-13 && on_group < 1e-15,
            "{}: {in_space} {length} {on_group}",
            run.method
        );
    }
    let [verlet, _, euler, _] = &hover.flights;
    // half a kick: ½ h |F R e₃ − m g e₃|, which is at most h m g; the attitude's own error comes on top
    let kick = 0.01 * 9.81;
    assert!((0.9 * kick..1.2 * kick).contains(&euler.largest), "{}", euler.largest);
    assert!(verlet.largest < 0.1 * euler.largest, "{} {}", verlet.largest, euler.largest);
}

/// The errors of ours fall with their orders down to roundoff, and the Casimir is roundoff whatever the step.
#[test]
fn work_and_precision() {
    let sampling = Sampling { most: 1 << 12, reference: 1 << 11, seconds: 0.0 };
    let work = Work::measure(&sampling).expect("solvable");
    let error = |name: &str, steps: u64| {
        let method = work.methods.iter().find(|method| method.name == name).expect(name);
        method.costs.iter().find(|cost| cost.steps == steps).expect(name).trajectory
    };
    for (name, order, steps) in [
        (EXPONENTIAL, 2.0, 1024),
        (CAYLEY, 2.0, 1024),
        (ORDER_4, 4.0, 512),
        (ORDER_6, 6.0, 256),
        (ORDER_8, 8.0, 128),
        (HAMILTON_JACOBI, 6.0, 256),
        (RK4, 4.0, 512),
        (RKMK4, 4.0, 512),
    ] {
        let measured = (error(name, steps) / error(name, 2 * steps)).log2();
        assert!((measured - order).abs() < 0.35, "{name}: {measured}");
    }
    for method in &work.methods {
        let ours = ![RK4, RKMK4].contains(&method.name);
        for cost in &method.costs {
            assert_eq!(
                ours || cost.steps > 2000,
                cost.casimir < 1e-12 || cost.steps > 2000,
                "{} {cost:?}",
                method.name
            );
        }
    }
}

/// At large steps ours keep the Casimir to roundoff and the energy in bounds; RK4's errors grow with the fifth power of the step and with
/// the time.
#[test]
fn large_steps_for_long_times() {
    let long = Steps::measure(2_000.0).expect("no run fails this");
    for method in &long.methods[..4] {
        assert!(method.trials.len() > 12, "{} breaks early", method.name);
        for trial in &method.trials {
            assert!(trial.casimir.error < 1e-12, "{} {trial:?}", method.name);
            if trial.step < 0.5 {
                assert!(trial.energy.drift() < 0.3, "{} {trial:?}", method.name);
            }
        }
    }
    let data = Data::of(&long.figure());
    for method in &long.methods[4..] {
        let growth = growth(data.curve(1, method.name));
        assert!((growth - 5.0).abs() < 0.5, "{}: {growth}", method.name);
        for trial in method.trials.iter().filter(|trial| trial.step < 0.1) {
            // the motion is not regular, nor is the drift
            assert!(trial.energy.drift() > 0.4 && trial.casimir.error > 1e-9, "{} {trial:?}", method.name);
        }
    }
    let rk4 = data.curve(1, RK4);
    let better = |method| better(data.curve(1, method), rk4);
    let crossing = better(EXPONENTIAL).first().expect("somewhere").0;
    assert!((0.05..0.3).contains(&crossing), "{crossing}");
    for method in [ORDER_4, HAMILTON_JACOBI] {
        assert_eq!(better(method).len(), 1, "{method}");
        assert!(better(method)[0].0 < 0.05, "{method}");
    }
}

/// Ranges of steps are where one is better, and nowhere else.
#[test]
fn better_steps_are_ranges() {
    let figure = |ours: [f64; 5], theirs: [f64; 5]| {
        let points = |errors: [f64; 5]| (1..).map(f64::from).zip(errors).collect();
        let series = vec![marked(CAYLEY, points(ours)), marked(RK4, points(theirs))];
        let axis = || Axis::linear("");
        Figure::over_time(String::new(), "", (0.0, 1.0), Key::Above, vec![Panel::new(axis(), axis(), series)])
    };
    let ranges = |ours, theirs| {
        let data = Data::of(&figure(ours, theirs));
        better(data.curve(1, CAYLEY), data.curve(1, RK4))
    };
    assert_eq!(ranges([0.1; 5], [0.2, 0.11, 0.09, 0.11, 0.2]), [(1.0, 2.0), (4.0, 5.0)]);
    assert!(ranges([0.1; 5], [0.09; 5]).is_empty());
    // where both exceed the energy nothing is said
    assert_eq!(ranges([0.1, 0.1, 0.1, 2.0, 2.0], [0.2, 0.05, 0.2, 3.0, 3.0]), [(1.0, 1.0), (3.0, 3.0)]);
}
