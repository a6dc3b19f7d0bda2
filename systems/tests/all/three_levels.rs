//! The atom of three levels against Schrödinger's equation, which is typed here once more with complex numbers.

use coadjoint::nalgebra::Complex;
use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_systems::three_level_atom::{ThreeLevelAtom, ThreeLevelAtomState};

use crate::physics::{after, motion};

type C = Complex<f64>;
type Amplitudes = Vector3<C>;
type Operator = Matrix3<C>;

fn real(x: f64) -> C {
    C::new(x, 0.0)
}

/// `H` at a time, from the page of a textbook.
fn light(atom: &ThreeLevelAtom, time: f64) -> Operator {
    let pulse = |largest: f64, at: f64| largest * (-((time - at) / atom.width).powi(2)).exp();
    let pump = pulse(atom.pump, atom.middle + atom.delay / 2.0);
    let stokes = pulse(atom.stokes, atom.middle - atom.delay / 2.0);
    matrix![
        0.0, pump, 0.0;
        pump, 2.0 * atom.detuning, stokes;
        0.0, stokes, 2.0 * atom.two_photon_detuning
    ]
    .map(|entry| real(entry / 2.0))
}

/// `i c' = H c`, by RK4 and Richardson's extrapolation.
fn schroedinger(atom: &ThreeLevelAtom, start: Amplitudes, time: f64) -> Amplitudes {
    let rate = |t: f64, c: &Amplitudes| light(atom, t) * c * C::new(0.0, -1.0);
    let integrated = |steps: u32| {
        let h = time / f64::from(steps);
        (0..steps).fold(start, |c, k| {
            let t = h * f64::from(k);
            let k1 = rate(t, &c);
            let k2 = rate(t + h / 2.0, &(c + k1 * real(h / 2.0)));
            let k3 = rate(t + h / 2.0, &(c + k2 * real(h / 2.0)));
            let k4 = rate(t + h, &(c + k3 * real(h)));
            c + (k1 + (k2 + k3) * real(2.0) + k4) * real(h / 6.0)
        })
    };
    let [coarse, fine] = [4_000, 8_000].map(integrated);
    fine + (fine - coarse) / real(15.0)
}

/// `ρ` of a pure state.
fn density(c: &Amplitudes) -> Operator {
    c * c.adjoint()
}

/// `ρ` by what the momentum is: `i tr (ρ E)` for each matrix of the basis.
fn of_momentum(state: &ThreeLevelAtomState) -> Operator {
    let [s12, a12, s13, a13, s23, a23, _, _]: [f64; 8] = state.momentum.into();
    let off = |s: f64, a: f64| C::new(-s, a) / 2.0;
    let (first, second, third) = (off(s12, a12), off(s13, a13), off(s23, a23));
    let [p, q, r] = ThreeLevelAtom::populations(state).map(real);
    matrix![p, first, second; first.conj(), q, third; second.conj(), third.conj(), r]
}

/// `U`, of which the complex numbers are stored as two rows and columns.
fn operator(state: &ThreeLevelAtomState) -> Operator {
    Operator::from_fn(|i, j| C::new(state.element[(2 * i, 2 * j)], state.element[(2 * i + 1, 2 * j)]))
}

fn detuned() -> ThreeLevelAtom {
    let (atom, _) = ThreeLevelAtom::example();
    ThreeLevelAtom { detuning: 2e7, two_photon_detuning: -5e6, stokes: 0.7 * atom.stokes, ..atom }
}

#[test]
fn an_atom_moves_as_schroedinger_says() {
    let atom = detuned();
    let start = [C::new(0.6, 0.0), C::new(0.0, 0.48), C::new(-0.64, 0.0)];
    let time = 2e-6;
    let exact = schroedinger(&atom, start.into(), time);
    let (expected, from) = (density(&exact), ThreeLevelAtom::in_state(start));
    assert!((of_momentum(&from) - density(&start.into())).norm() < 1e-15);
    let error = |end: &ThreeLevelAtomState| {
        let moved = operator(end) * density(&start.into()) * operator(end).adjoint();
        [(of_momentum(end) - expected).norm(), (moved - expected).norm()]
    };
    // with the phase by which U is of determinant 1
    let end = after::<_, Order6<Exponential>>(&atom, &from, time, 1_500);
    let trace = atom.detuning + atom.two_photon_detuning;
    let phase = C::new(0.0, -trace * time / 3.0).exp();
    let turned = operator(&end) * Amplitudes::from(start) * phase;
    assert!((turned - exact).norm() < 1e-9, "{turned} {exact}");
    assert!(error(&end).iter().all(|error| *error < 1e-9), "{:?}", error(&end));
    let [coarse, fine] =
        [1_500, 3_000].map(|steps| error(&after::<_, Exponential>(&atom, &from, time, steps)));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}: {coarse} {fine}");
    }
}

/// Light that does not change, in resonance: the atom comes and goes between the first level and the third, by `(2PS/Ω²)² sin⁴ (Ωt/4)` with
/// `Ω² = P² + S²`.
#[test]
fn constant_light_makes_the_atom_come_and_go() {
    let (pump, stokes) = (3e7, 4e7);
    let (atom, start) = ThreeLevelAtom::example();
    let atom = ThreeLevelAtom { pump, stokes, width: 1e3, ..atom };
    let both = f64::hypot(pump, stokes);
    for time in [3e-8, 1e-7, 2e-7] {
        let end = after::<_, Order6<Exponential>>(&atom, &start, time, 100);
        let expected = (2.0 * pump * stokes / (both * both)).powi(2) * (both * time / 4.0).sin().powi(4);
        let [_, second, third] = ThreeLevelAtom::populations(&end);
        assert!((third - expected).abs() < 1e-10, "{third} {expected}");
        let expected = (pump / both * (both * time / 2.0).sin()).powi(2);
        assert!((second - expected).abs() < 1e-10, "{second} {expected}");
    }
}

#[test]
fn the_dark_state_takes_the_atom_over() {
    let (atom, start) = ThreeLevelAtom::example();
    let steps = (ThreeLevelAtom::DURATION / ThreeLevelAtom::STEP).round() as u64;
    let highest = |states: &[ThreeLevelAtomState]| {
        states.iter().map(|state| ThreeLevelAtom::populations(state)[1]).fold(0.0, f64::max)
    };
    let states = motion::<_, Exponential>(&atom, &start, ThreeLevelAtom::STEP, steps);
    let arrived = ThreeLevelAtom::populations(states.last().expect("a motion"))[2];
    assert!(arrived > 1.0 - 1e-5, "{arrived}");
    assert!(highest(&states) < 0.02, "{}", highest(&states));
    // weak light changes too fast for it
    let weak = ThreeLevelAtom { pump: atom.pump / 16.0, stokes: atom.stokes / 16.0, ..atom.clone() };
    let states = motion::<_, Exponential>(&weak, &start, ThreeLevelAtom::STEP, steps);
    assert!(ThreeLevelAtom::populations(states.last().expect("a motion"))[2] < 0.99);
    // in the order that one would think of, the second level has most of it in between
    let other = ThreeLevelAtom { delay: -atom.delay, ..atom };
    let states = motion::<_, Exponential>(&other, &start, ThreeLevelAtom::STEP, steps);
    assert!(highest(&states) > 0.5, "{}", highest(&states));
}

#[test]
fn the_casimirs_are_traces_of_powers_of_the_density() {
    let states = motion::<_, Exponential>(&detuned(), &ThreeLevelAtom::example().1, 4e-9, 500);
    let powers = |state: &ThreeLevelAtomState| {
        let density = of_momentum(state);
        [
            (density * density).trace().re,
            (density * density * density).trace().re,
            operator(state).determinant().re,
        ]
    };
    for state in &states {
        let [square, cube, determinant] = powers(state);
        assert!((square - 1.0).abs() < 1e-12 && (cube - 1.0).abs() < 1e-12, "{square} {cube}");
        assert!((determinant - 1.0).abs() < 1e-12, "{determinant}");
    }
}
