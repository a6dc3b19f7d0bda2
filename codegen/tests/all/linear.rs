//! Linear systems of expressions, and derivatives of what is kept whole.

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector};

/// A value for each symbol, all different.
fn value(symbol: Symbol) -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15;
    for letter in format!("{symbol:?}").bytes() {
        state = (state ^ u64::from(letter)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    0.5 + (state >> 11) as f64 / (1u64 << 53) as f64
}

/// Solves for unknowns of which those of these rows and columns occur together, and puts the solution into the equations.
fn solve(n: usize, occurs: impl Fn(usize, usize) -> bool) {
    let arena = Arena::new();
    let entry = |k: usize| -> Expr<'_> {
        let (i, j) = (k / n, k % n);
        let symbol = arena.symbol(format!("m_{i}{j}"), Stage::Step);
        match (i == j, occurs(i, j)) {
            // no pivots are looked for
            (true, _) => symbol + 4,
            (false, true) => symbol,
            (false, false) => arena.zero(),
        }
    };
    let matrix = Matrix::new(n, n, (0..n * n).map(entry).collect());
    let right = Vector((0..n).map(|i| arena.symbol(format!("r_{i}"), Stage::Step)).collect());
    let solution = matrix.solve(&right);
    let residual = &matrix.times(&solution) - &right;
    for (i, residual) in residual.evaluate(&value).into_iter().enumerate() {
        assert!(residual.abs() < 1e-14, "equation {i} of {n} is off by {residual:e}");
    }
    assert!(solution.evaluate(&value).iter().all(|x| x.abs() > 1e-3), "no unknown is forgotten");
}

#[test]
fn solutions_solve_their_equations() {
    for n in 1..=6 {
        solve(n, |_, _| true);
        solve(n, |_, _| false);
        // a coupling in one direction is one
        solve(n, |i, j| i < j);
        solve(n, |i, j| i > j);
        solve(n, |i, j| i == 0 && j == n - 1);
        solve(n, |i, j| i == n - 1 && j == 0);
        // two sets of unknowns, side by side
        solve(n, |i, j| i % 2 == j % 2);
    }
}

#[test]
fn quotients_kept_whole_have_the_derivatives_of_quotients() {
    let arena = Arena::new();
    let [x, y] = ["x", "y"].map(|name| arena.symbol(name, Stage::Step));
    let symbols = Vector(vec![x, y]).symbols();
    for number in [1, 2, -3] {
        for divisor in [x * x + y * 2 + 1, x * y, x.stumpff(0) + 1] {
            let plain = divisor.recip() * number;
            let whole = plain.hold();
            for &symbol in &symbols {
                let (plain, whole) = (plain.derivative(symbol), whole.derivative(symbol));
                let difference = plain.evaluate(&value) - whole.evaluate(&value);
                assert!(difference.abs() < 1e-13, "d({number}/({divisor})) is off by {difference:e}");
            }
            let of = |quotient: Expr<'_>| (quotient * quotient * y).derivative(symbols[0]).evaluate(&value);
            assert!((of(plain) - of(whole)).abs() < 1e-12, "of a product with {number}/({divisor})");
        }
    }
    // no other quotient than the one at hand
    let whole = ((x * x + 1).recip() * 2).hold();
    let slope = whole.derivative(symbols[0]);
    assert_eq!(slope, (-x * whole * whole).hold());
}
