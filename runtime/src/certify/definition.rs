//! The family's step from its definition, for any system, by fixed-point iteration.
//!
//! Of the generated code it takes what [`Geometry`](crate::system::Geometry) has, and none of a step's closed forms: the exponential's
//! logarithmic derivative is the power series of the Poisson structure's `ad*`, Cayley's is measured on the displacements. Coordinates of
//! the second kind are exponentials along the axes, one after the other: of displacements, and of `ad*`.

use nalgebra::{DMatrix, DVector};

use super::frame::{Degenerate, Frame, axis, series};
use super::neighbourhood::is_defined;
use crate::retraction::RetractionKind;
use crate::scheme::Rule;
use crate::schemes::Scheme;

/// A state on its way through steps taken from their definition.
pub(super) struct ReferenceStep<'a> {
    frame: &'a Frame<'a>,
    pub(super) state: Vec<f64>,
    time: f64,
    control: &'a [f64],
    /// Whether a step could not be taken.
    pub(super) lost: bool,
}

/// The part of a step before the intermediate point, with `τ̄(x) = τ(−x)⁻¹`, or behind it, with `τ`.
#[derive(Clone, Copy, PartialEq)]
enum Half {
    Before,
    Behind,
}

/// What a move by `τ(x)` makes of `m = (μ, a)`.
struct Carried {
    /// `(dR τ_x)* m`
    mean: DVector<f64>,
    /// `Ad*_{τ(x)} m`
    next: DVector<f64>,
}

/// More iterations than any step takes that a fixed-point iteration solves in reasonable time.
const ITERATIONS: usize = 200;

impl<'a> ReferenceStep<'a> {
    pub(super) fn new(frame: &'a Frame<'a>, state: &[f64], time: f64, control: &'a [f64]) -> Self {
        Self { frame, state: state.to_vec(), time, control, lost: false }
    }

    /// Takes a step with a scheme; `false` if there is no definition to take it from.
    pub(super) fn step(&mut self, scheme: &Scheme, invariant: bool, step: f64) -> bool {
        scheme.parts(invariant, step).into_iter().all(|(map, rule, step)| match rule {
            Rule::Family(numerator, denominator) if is_defined(map) => {
                self.family(map, f64::from(numerator) / f64::from(denominator), step);
                true
            }
            _ => false,
        })
    }

    /// Takes a step with the member `s` of the [family](crate::scheme::Family).
    fn family(&mut self, map: RetractionKind, s: f64, step: f64) {
        match self.solve(map, s, step) {
            Ok(state) => self.state = state,
            Err(Degenerate) => self.lost = true,
        }
        self.time += step;
    }

    /// `m⁻ = Ad*_{τ̄(sη)} m`, `ḡ = g τ̄(sη)`, `m⁺ = m⁻ + t (F − ∂h/∂g)`, `m̄ = (1−s) (dR τ_{(1−s)η})* m⁺ + s (dR τ̄_{sη})* m` and
    /// `η = t ∂h/∂m`, over and over.
    fn solve(&self, map: RetractionKind, s: f64, step: f64) -> Result<Vec<f64>, Degenerate> {
        let Self { frame, state, control, .. } = self;
        let time = self.time + s * step;
        let m = frame.linear_part(state);
        let system = frame.system;
        let mut eta = frame.linear_of(&system.differential(state, time, control)) * step;
        let mut mean = state.clone();
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let (early, late) = (&eta * s, &eta * (1.0 - s));
            let before = self.carried(map, Half::Before, &early, &m)?;
            let g_bar = self.moved(state, map, Half::Before, &early);

            // of the energy and the forces at the last approximation of the intermediate point
            let there = frame.with_linear_part(&g_bar, &frame.linear_part(&mean));
            let mut kick = frame.linear_of(&system.force(&there, time, control));
            let gradient = frame.configuration_of(&system.differential(&there, time, control));
            let mut of_momenta = kick.rows_mut(0, gradient.len());
            of_momenta -= gradient;
            let m_plus = before.next + kick * step;

            let behind = self.carried(map, Half::Behind, &late, &m_plus)?;
            mean = frame.with_linear_part(&g_bar, &(behind.mean * (1.0 - s) + before.mean * s));
            let next = frame.linear_of(&system.differential(&mean, time, control)) * step;
            let change =
                frame.distance(&mean, &there).max((&next - &eta).amax() / next.amax().max(f64::MIN_POSITIVE));
            if !change.is_finite() {
                return Err(Degenerate);
            }
            // down to roundoff, where it gets no smaller
            if change == 0.0 || (change < 1e-13 && change >= 0.5 * last) {
                let g_next = self.moved(&g_bar, map, Half::Behind, &late);
                return Ok(frame.with_linear_part(&g_next, &behind.next));
            }
            (eta, last) = (next, change);
        }
        Err(Degenerate)
    }

    /// The state with its configurations moved.
    fn moved(&self, state: &[f64], map: RetractionKind, half: Half, eta: &DVector<f64>) -> Vec<f64> {
        let n = self.frame.configuration.len();
        if map.is_matrix_function() {
            return self.frame.moved(state, map, &eta.rows(0, n).into_owned());
        }
        let axes = self.axes(half).into_iter().filter(|axis| *axis < n);
        axes.fold(state.to_vec(), |state, axis| {
            self.frame.moved(&state, RetractionKind::Exponential, &part(eta, axis, n))
        })
    }

    /// What becomes of momenta and advected parameters where configurations are moved so.
    fn carried(
        &self,
        map: RetractionKind,
        half: Half,
        eta: &DVector<f64>,
        m: &DVector<f64>,
    ) -> Result<Carried, Degenerate> {
        if map.is_matrix_function() {
            let ad = self.frame.coadjoint(&self.state, eta);
            let mean = self.right_dual(map, eta, &ad, m)?;
            return Ok(Carried { next: m + ad * &mean, mean });
        }
        let (mut mean, mut next) = (m.clone(), m.clone());
        for axis in self.axes(half) {
            mean[axis] = next[axis];
            let ad = self.frame.coadjoint(&self.state, &part(eta, axis, eta.len()));
            next += &ad * series(&ad, &next)?;
        }
        Ok(Carried { mean, next })
    }

    /// The axes of the algebra, those of advected parameters at the end, in the order in which they act; in the opposite one before the
    /// intermediate point. Where displacements are by `τ(δ) g`, what stands last in `τ` acts first.
    fn axes(&self, half: Half) -> Vec<usize> {
        let (frame, n) = (self.frame, self.frame.configuration.len());
        let turn = frame.element(|_| 0.5);
        let there = frame.moved(&self.state, RetractionKind::SecondKind, &turn);
        let off = |axes: &mut dyn Iterator<Item = usize>| {
            let one_by_one = axes.fold(self.state.clone(), |state, axis| {
                frame.moved(&state, RetractionKind::Exponential, &part(&turn, axis, n))
            });
            frame.distance(&there, &one_by_one)
        };
        let is_last_first = off(&mut (0..n).rev()) < off(&mut (0..n));
        let axes = 0..frame.linear.len();
        if is_last_first == (half == Half::Behind) { axes.rev().collect() } else { axes.collect() }
    }

    /// `(dR τ_η)* m`, where `ad` is the matrix of `ad*_η`, for functions of one matrix.
    fn right_dual(
        &self,
        map: RetractionKind,
        eta: &DVector<f64>,
        ad: &DMatrix<f64>,
        m: &DVector<f64>,
    ) -> Result<DVector<f64>, Degenerate> {
        if eta.amax() == 0.0 {
            return Ok(m.clone());
        }
        match map {
            RetractionKind::Exponential => series(ad, m),
            // `dR cay_X Y = (1 − X/2)⁻¹ Y (1 + X/2)⁻¹`: on the group as the displacements say, and with advected parameters, where
            // `X = (x, w)` and `Y = (y, u)`, inverted `((dR cay_x)⁻¹ y, (1 − ρ_x/2)(u + ½ ρ_y w))`
            RetractionKind::Cayley => {
                let (n, all) = (self.frame.configuration.len(), m.len());
                let back = -eta.rows(0, n).into_owned();
                let group = self.frame.logarithmic_derivative(&self.state, map, &back)?;
                let group = group.try_inverse().ok_or(Degenerate)?;
                let spaces = all - n;
                let bracket = ad.transpose();
                let damped = DMatrix::identity(spaces, spaces) - bracket.view((n, n), (spaces, spaces)) * 0.5;
                // `−ρ_y w`
                let carried = bracket.view((n, 0), (spaces, n));
                let mut inverse = DMatrix::zeros(all, all);
                inverse.view_mut((0, 0), (n, n)).copy_from(&group);
                inverse.view_mut((n, 0), (spaces, n)).copy_from(&(&damped * carried * -0.5));
                inverse.view_mut((n, n), (spaces, spaces)).copy_from(&damped);
                inverse.transpose().lu().solve(m).ok_or(Degenerate)
            }
            _ => Err(Degenerate),
        }
    }
}

/// The first `length` components of a vector, of which one alone is kept.
fn part(of: &DVector<f64>, i: usize, length: usize) -> DVector<f64> {
    axis(length, i, of[i])
}
