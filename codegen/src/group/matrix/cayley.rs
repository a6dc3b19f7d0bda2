//! The Cayley map of a group of matrices.
//!
//! With `R = (1 − X/2)⁻¹` and `S = (1 + X/2)⁻¹` it is `cay x = 2R − 1`, and `dR cay_x y = R Y S`. Both inverses are
//! long, but their derivatives are not, `R' = ½ R X' R`: hence of `m̄ = (dR cay_x)* m`, which is `m̄_j = ⟨W, R E_j S⟩`
//! with a matrix `W` that stands for `m`,
//!
//! ```text
//! m̄'_j = ⟨W', R E_j S⟩ + ½ ⟨M, X' R E_j − E_j S X'⟩,   M = Rᵀ W Sᵀ
//! ```
//!
//! Where the group is all that keeps a form `J`, the two terms with `X'` are the same, for `σ(Z) = J Zᵀ J⁻¹` is −1 on
//! the algebra and there alone and takes products and `R` to `S` backwards; and `M` is the matrix that stands for `m̄`.

use std::sync::Arc;

use crate::expr::{DerivativeRule, Expr, Matrix, Number, Vector};
use crate::group::exact::{Rational, RationalMatrix};

use super::algebra::{Algebra, combination};
use super::constraints::InvariantForm;

/// The map, with all that it is made of.
#[derive(Debug)]
pub(super) struct Cayley {
    algebra: Algebra,
    form: Option<InvariantForm>,
    /// The matrices that stand for the coordinates of `m`, −1 under `σ`, where the group is all that keeps the form.
    covectors: Option<Vec<RationalMatrix>>,
}

impl Cayley {
    pub(super) fn new(algebra: &Algebra, form: Option<&InvariantForm>) -> Self {
        let covectors = form.and_then(|form| covectors(algebra, form));
        Self { algebra: algebra.clone(), form: form.cloned(), covectors }
    }

    /// `R = (1 − X/2)⁻¹`
    pub(super) fn resolvent<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        self.algebra.one_plus(x, Number::ratio(-1, 2)).inverse().map(Expr::hold)
    }

    /// `S = (1 + X/2)⁻¹`, from `R` by the form where there is one: `X J = −J Xᵀ`.
    fn other_resolvent<'a>(&self, x: &Vector<'a>, resolvent: &Matrix<'a>) -> Matrix<'a> {
        match &self.form {
            Some(form) if form.is_regular => form.adjoint(resolvent),
            _ => self.algebra.one_plus(x, Number::ratio(1, 2)).inverse().map(Expr::hold),
        }
    }

    /// `(dR cay_x)* m`, with its derivative.
    pub(super) fn d_right_dual<'a>(self: &Arc<Self>, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let r = self.resolvent(x);
        let s = self.other_resolvent(x, &r);
        let matrix = self.algebra.pulled_matrix(&r, m, &s);
        let mut given = vec![Vector(r.entries), Vector(s.entries)];
        if self.covectors.is_none() {
            given.push(Vector(matrix.entries.clone()).hold());
        }
        let mean = self.algebra.pairings(&matrix);
        mean.with_rule(&Vector::concat([x, m]), &Vector::concat(&given), Arc::clone(self))
    }
}

/// Of `m̄`, by `x` and `m`, one after the other, with `R`, `S`, and `M` if that is no other name of `m̄`.
impl DerivativeRule for Cayley {
    fn along<'a>(&self, mean: &Vector<'a>, given: &Vector<'a>, changes: &Vector<'a>) -> Vector<'a> {
        let n = self.algebra.size();
        let mut given = given.0.chunks(n * n).map(|entries| Matrix::new(n, n, entries.to_vec()));
        let (Some(r), Some(s)) = (given.next(), given.next()) else { return mean.map(|m| m.arena().zero()) };
        let (x, m) = changes.0.split_at(mean.len());
        let x = self.algebra.hat(&Vector(x.to_vec()));
        let by_r = x.times_matrix(&r).transpose();
        let change = match (&self.covectors, given.next()) {
            (Some(covectors), _) => self.algebra.pairings(&by_r.times_matrix(&combination(covectors, mean))),
            (None, Some(matrix)) => {
                let by_s = s.times_matrix(&x).transpose();
                let both = by_r.times_matrix(&matrix).zip(&matrix.times_matrix(&by_s), |a, b| a - b);
                self.algebra.pairings(&both).map(|change| change / 2)
            }
            (None, None) => mean.map(|m| m.arena().zero()),
        };
        if m.iter().all(|m| m.is_zero()) {
            return change;
        }
        &change + &self.algebra.pulled_back(&r, &Vector(m.to_vec()), &s)
    }
}

/// Of a form that is symmetric or antisymmetric, if the algebra is all that it lets.
fn covectors(algebra: &Algebra, form: &InvariantForm) -> Option<Vec<RationalMatrix>> {
    let (n, d) = (algebra.size(), algebra.dimension());
    let transposed = form.matrix.transpose();
    let minus = transposed.scaled(-Rational::one());
    let is_all =
        form.matrix == transposed && 2 * d == n * (n - 1) || form.matrix == minus && 2 * d == n * (n + 1);
    let project = |covector: RationalMatrix| {
        let image = form.inverse.times(&covector.transpose()).times(&form.matrix);
        let half = Rational::new(1, 2);
        covector.scaled(half).plus(&image, -half)
    };
    (form.is_regular && is_all).then(|| algebra.covectors().into_iter().map(project).collect())
}
