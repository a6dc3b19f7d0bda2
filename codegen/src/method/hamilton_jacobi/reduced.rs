//! The step of a system whose energy does not depend on the configuration, with the exponential: on the dual of the
//! semidirect algebra alone.
//!
//! With `m = (μ, a)`, `η = (y, w)` and the retraction of the semidirect product
//!
//! ```text
//! η = ∂S/∂m̄(m̄, t),   m̄ = (dR exp_η)* m_k
//! m_{k+1} = Ad*_{exp(η)} m_k,   g_{k+1} = g_k exp(y)
//! ```
//!
//! As `m_{k+1} = B(ad*_η) m̄` with Bernoulli's series `B(x) = x/(1 − e⁻ˣ)`, the Hamilton–Jacobi equation
//! `∂S/∂t = h(m_{k+1})` is a recursion: with `S = Σ tᵏ S_k`, `k` odd, and `η` known up to `tᵏ⁻²`,
//!
//! ```text
//! k S_k = [tᵏ⁻¹] h(B(ad*_η) m̄)
//! ```
//!
//! where `⟨η₁, ad*_{η₁} z⟩ = 0` for any `z`. So what is not multiplied out is short: `S₃ = ⟨v, h'' v⟩/24` with
//! `v = ad*_{η₁} m̄`, where `h` is quadratic.

use super::{COARSE, by_velocity};
use crate::expr::{Expr, Matrix, Number, Series, Symbol, Vector, gradient};
use crate::group::{Retraction, SemidirectVector};
use crate::method::discretization::{Discretization, Values, bind};
use crate::method::names::symbols;
use crate::method::presolve::{Equation, presolve};
use crate::method::step::{Iteration, Step};
use crate::model::{Parts, System};

/// Whether a system has such steps.
pub(super) fn is_for(system: &System<'_>, retraction: Retraction) -> bool {
    retraction == Retraction::Exponential && system.is_left_invariant() && !by_velocity(system)
}

/// The step of this order.
pub(super) fn step<'a>(discretization: &Discretization<'_, 'a>, order: usize) -> Step<'a> {
    let Discretization { system, names, moving, carrying, step, .. } = discretization;
    let (arena, group) = (step.arena(), &system.group);
    let kicks = names.of_advected("kick");
    let w = kicks.iter().map(|names| symbols(arena, names.clone())).collect();
    let eta = SemidirectVector { base: symbols(arena, names.unknown()), spaces: w };
    let signed = eta.scale(arena.number(system.side.sign()));
    let m = system.momentum_and_advected();
    let mean = names.keep_multiple(&group.d_right_dual(carrying.behind, &signed, &m));
    let next = group.carry_momentum(carrying.behind, &signed, &m, &mean);
    let moved = group.moved(system.side, moving.behind, &system.configuration(), &eta.base);
    names.group("increment", &moved.increment);
    names.configuration("moved", &moved.moved);
    names.squares(&eta.base);
    names.algebra("momentum_mean", &mean.base);
    names.algebra("momentum_next", &next.base);
    names.advected("mean", &mean.spaces);
    names.advected("next", &next.spaces);
    let next = Parts { configuration: moved.next, momentum: next.base, advected: next.spaces };

    let functions = functions(discretization, order.max(COARSE));
    let (first, coarse) = (&functions[..1], &functions[..COARSE / 2]);
    let near = approximate_mean(discretization, &split(discretization, &velocity(discretization, first)));
    let at = |mean: &SemidirectVector<'a>, vector: &Vector<'a>| {
        vector.substitute(&values(&flat(&m), &flat(mean))).scale(*step)
    };
    let right = at(&mean, &velocity(discretization, &functions[..order / 2]));
    let by_eta = |mean: &Vector<'a>| mean.jacobian(&flat(&eta).symbols()).map(Expr::hold);
    let [second, third] = [2, 3].map(|terms| by_eta(&flat(&series_of_mean(discretization, &eta, terms))));
    let short = group.d_right_dual(system.side.carrying(Retraction::Coarse), &signed, &m);
    let short = by_eta(&flat(&short).map(Expr::with_short_stumpff));
    let begun = |functions: &[Expr<'a>], by_y: &Matrix<'a>| {
        let start = at(&near, &velocity(discretization, functions)).hold();
        let parts = [(functions, by_y.clone()), (first, second.clone())];
        let matrix = NewtonMatrix { discretization, parts }.at(&near, &values(&flat(&eta), &start), &eta);
        let operations = Vector::concat([&start, &Vector(matrix.entries.clone())]).operations();
        (start, matrix, operations)
    };
    let (fine, rough) = (begun(coarse, &short), begun(first, &third));
    let saved = fine.2.saturating_sub(rough.2);
    // most steps take half an iteration more then, and an iteration waits for more than its operations
    let is_rough = saved > rough.2.max(right.operations() * 2 / 3);
    let (start, begun, _) = if is_rough { rough } else { fine };

    let lengths = eta.spaces.iter().map(|w| vec![w.len()]);
    let blocks = [group.blocks()].into_iter().chain(lengths);
    let mut place = 0;
    let part = |(blocks, names): (Vec<usize>, Vec<String>)| {
        let rows = place..place + names.len();
        place = rows.end;
        let [unknown, right, start] = [&flat(&eta), &right, &start].map(|whole| whole.part(rows.clone()));
        let (left, solved) = (unknown.clone(), Some(right.clone()));
        Equation { unknown, blocks, left, right, solved, start, names }
    };
    let names = [names.unknown()].into_iter().chain(kicks);
    let presolved = presolve(blocks.zip(names).map(part).collect());
    let found = presolved.found.clone();
    let mut whole = discretization.lifted(presolved, &eta.base, &next);

    let left = whole.unknown.symbols();
    if left.is_empty() {
        return whole;
    }
    let symbols = flat(&eta).symbols();
    let rows: Vec<usize> = (0..symbols.len()).filter(|&k| left.contains(&symbols[k])).collect();
    whole.iteration = Iteration::Newton(begun.reduced_to(&rows));
    let matrix =
        NewtonMatrix { discretization, parts: [(coarse, short), (first, second)] }.at(&mean, &[], &eta);
    whole.matrix = matrix.reduced_to(&rows).map(|entry| entry.substitute(&found));
    whole
}

/// Newton's matrix `1 − t S″ ∂m̄/∂η`, up to a few terms: of `S` those of the [coarse](COARSE) step, or its first. What `w`
/// moves is of the next order already: there `h″` will do, so that equations of `w` have no other `w` in them where `h` is
/// a sum of a function of `μ` and one of `a`.
struct NewtonMatrix<'s, 'a> {
    discretization: &'s Discretization<'s, 'a>,
    /// Terms of `S`, and `∂m̄/∂η`, for the columns of `y` and those of `w`.
    parts: [(&'s [Expr<'a>], Matrix<'a>); 2],
}

impl<'a> NewtonMatrix<'_, 'a> {
    /// At a mean and values of the unknowns.
    fn at(
        &self,
        mean: &SemidirectVector<'a>,
        there: &[(Symbol, Expr<'a>)],
        eta: &SemidirectVector<'a>,
    ) -> Matrix<'a> {
        let Discretization { system, step, .. } = self.discretization;
        let m = flat(&system.momentum_and_advected());
        let mean = values(&m, &flat(mean));
        let parts = self.parts.each_ref().map(|(functions, by_eta)| {
            let whole = sum(self.discretization, functions);
            let gradient = gradient(whole.multiplied_out().unwrap_or(whole), &m.symbols());
            let hessian = gradient.jacobian(&m.symbols()).map(Expr::hold);
            let by_eta = by_eta.clone().map(|entry| entry.substitute(there));
            (hessian.map(|entry| entry.substitute(&mean)), by_eta)
        });
        let symbols = flat(eta).symbols();
        let one = Matrix::identity(step.arena(), symbols.len());
        let entry = |i: usize, j: usize| {
            let (hessian, by_eta) = &parts[usize::from(j >= system.dimension())];
            (one.at(i, j) - hessian.row(i).dot(&by_eta.column(j)) * *step).hold()
        };
        Matrix::from_fn(symbols.len(), symbols.len(), entry)
    }
}

/// Symbols with their values.
fn values<'a>(symbols: &Vector<'a>, values: &Vector<'a>) -> Values<'a> {
    let mut bound = Values::new();
    bind(&mut bound, symbols, values);
    bound
}

/// All components, one after the other.
fn flat<'a>(m: &SemidirectVector<'a>) -> Vector<'a> {
    Vector::concat([&m.base].into_iter().chain(&m.spaces))
}

/// Its parts again.
fn split<'a>(discretization: &Discretization<'_, 'a>, vector: &Vector<'a>) -> SemidirectVector<'a> {
    let mut place = 0;
    let mut part = |like: &Vector<'a>| {
        place += like.len();
        vector.part(place - like.len()..place)
    };
    let SemidirectVector { base, spaces } = discretization.system.momentum_and_advected();
    SemidirectVector { base: part(&base), spaces: spaces.iter().map(part).collect() }
}

/// `S/t = Σ tᵏ⁻¹ S_k`
fn sum<'a>(discretization: &Discretization<'_, 'a>, functions: &[Expr<'a>]) -> Expr<'a> {
    let square = discretization.step * discretization.step;
    let highest_first = functions.iter().rev().copied();
    highest_first.reduce(|sum, term| term + sum * square).unwrap_or_else(|| square.arena().zero())
}

/// `∂S/∂m/t`: multiplied out where that leaves little, for it has longer chains of operations.
fn velocity<'a>(discretization: &Discretization<'_, 'a>, functions: &[Expr<'a>]) -> Vector<'a> {
    let m = flat(&discretization.system.momentum_and_advected()).symbols();
    let whole = sum(discretization, functions);
    let written = gradient(whole, &m);
    let expanded = whole.multiplied_out().map(|whole| gradient(whole, &m));
    let is_short = |other: &Vector<'a>| 2 * other.operations() < written.operations();
    expanded.filter(is_short).unwrap_or(written)
}

/// `ad*_η m`, by a number.
fn turned<'a>(
    discretization: &Discretization<'_, 'a>,
    eta: &SemidirectVector<'a>,
    m: &SemidirectVector<'a>,
    by: i128,
) -> SemidirectVector<'a> {
    let Discretization { system, step, .. } = discretization;
    let eta = eta.scale(step.arena().number(system.side.sign()));
    system.group.coadjoint(&eta, m).scale(step.arena().number(Number::ratio(1, by)))
}

/// `m̄ − m_k = ½ ad*_η (m_k + ⅓ ad*_η (m_k + …))`, so many terms.
fn series_of_mean<'a>(
    discretization: &Discretization<'_, 'a>,
    eta: &SemidirectVector<'a>,
    terms: i128,
) -> SemidirectVector<'a> {
    let m = discretization.system.momentum_and_advected();
    let last = turned(discretization, eta, &m, terms + 1);
    (2..=terms).rev().fold(last, |inner, by| turned(discretization, eta, &m.plus(&inner), by))
}

/// `m̄` up to `t³`, from `η₁`.
fn approximate_mean<'a>(
    discretization: &Discretization<'_, 'a>,
    first: &SemidirectVector<'a>,
) -> SemidirectVector<'a> {
    let m = discretization.system.momentum_and_advected();
    let half_way = m.plus(&turned(discretization, &first.scale(discretization.step).hold(), &m, 2)).hold();
    let there = values(&flat(&m), &flat(&half_way));
    let eta = flat(first).substitute(&there).scale(discretization.step).hold();
    let eta = split(discretization, &eta);
    let third = m.plus(&turned(discretization, &eta, &m, 3)).hold();
    m.plus(&turned(discretization, &eta, &third, 2)).hold()
}

/// `S_1`, `S_3`, … below this order.
fn functions<'a>(discretization: &Discretization<'_, 'a>, order: usize) -> Vec<Expr<'a>> {
    let system = discretization.system;
    let arena = discretization.step.arena();
    let h = system.by_momentum().energy();
    let m = system.momentum_and_advected();
    let symbols = flat(&m);
    let zero = m.scale(arena.zero());
    let bernoulli = bernoulli(order);
    let mut functions = vec![h];
    // `η_1`, `η_3`, …
    let mut etas: Vec<SemidirectVector<'a>> = Vec::new();
    // the parts of `(ad*_η)ⁿ m̄`
    let mut powers = vec![vec![m.clone()]];
    let mut series = Series::new(arena);
    push(&mut series, &symbols, &symbols);
    for k in (3..order).step_by(2) {
        let last = gradient(functions[functions.len() - 1], &symbols.symbols());
        etas.push(split(discretization, &last).hold());
        for weight in k - 2..k {
            let mut moved = zero.clone();
            powers.resize_with(weight + 1, Vec::new);
            for n in 1..=weight {
                let mut power = zero.clone();
                for (eta, j) in etas.iter().zip((1..=weight).step_by(2)) {
                    if let Some(last) = powers[n - 1].get(weight - j) {
                        power = power.plus(&system.group.coadjoint(eta, last));
                    }
                }
                let power = power.hold();
                moved = moved.plus(&power.scale(arena.number(bernoulli[n])));
                powers[n].resize(weight, zero.clone());
                powers[n].push(power);
            }
            let is_top = weight == k - 1;
            push(&mut series, &symbols, &if is_top { flat(&zero) } else { flat(&moved.hold()) });
            if is_top {
                // by `η_1` alone, and of that all but what its own bracket makes
                let part = series.part(h, weight).first().copied().unwrap_or_else(|| arena.zero());
                let mut rest = arena.zero();
                for (eta, j) in etas.iter().zip((1..=weight).step_by(2)).skip(1) {
                    for n in 1..=weight {
                        if let Some(last) = powers[n - 1].get(weight - j) {
                            let turned = system.group.coadjoint(&etas[0], last);
                            rest = rest - flat(eta).dot(&flat(&turned)).scale(bernoulli[n]);
                        }
                    }
                }
                functions.push((part + rest).scale(Number::ratio(1, k as i128)).hold());
                series.truncate(weight);
                push(&mut series, &symbols, &flat(&moved.hold()));
            }
        }
    }
    functions
}

fn push<'a>(series: &mut Series<'a>, symbols: &Vector<'a>, parts: &Vector<'a>) {
    for (symbol, part) in symbols.iter().zip(parts.iter()) {
        series.push(symbol, if part.is_zero() { Vec::new() } else { vec![part] });
    }
}

/// The coefficients of `x/(1 − e⁻ˣ)`.
fn bernoulli(count: usize) -> Vec<Number> {
    let mut coefficients = vec![Number::ONE];
    for n in 1..count {
        let mut factor = Number::ONE;
        let mut sum = Number::ZERO;
        for k in 1..=n {
            factor = factor * Number::ratio(-1, k as i128 + 1);
            sum = sum + factor * coefficients[n - k];
        }
        coefficients.push(-sum);
    }
    coefficients
}
