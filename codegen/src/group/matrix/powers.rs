//! Power series of a matrix that is linear in `x`.

use super::algebra::{combination, number};
use crate::expr::{Expr, Matrix, Number, Vector};
use crate::group::MatrixFunction;
use crate::group::exact::{Rational, RationalMatrix};

/// So many powers of a matrix of Frobenius norm 3/2, over their factorials, leave out less than half an ulp of a
/// double's sum.
pub(in crate::group) const TERMS: usize = 20;
/// So many are enough for Newton's matrix: what they leave out is less than a part in a thousand at the edge, and 1e-9
/// for a tenth of a turn.
const FEW_TERMS: usize = 6;
/// The highest power of `λ² + z` in a polynomial that is looked for.
const MULTIPLICITY: usize = 4;

/// A function, and the shift of its series.
type Series = (MatrixFunction, u32);

/// `A(x) = Σ xᵢ Aᵢ`, and how its power series are summed.
#[derive(Clone, Debug)]
pub(super) struct LinearMatrix {
    pub(super) matrices: Vec<RationalMatrix>,
    /// By which they are finite sums.
    annihilator: Option<Annihilator>,
    /// How many terms of them, where they are not.
    pub(super) terms: usize,
}

impl LinearMatrix {
    pub(super) fn new(matrices: Vec<RationalMatrix>, terms: usize) -> Self {
        let annihilator = Annihilator::of(&matrices);
        Self { matrices, annihilator, terms }
    }

    /// Whether its power series are finite sums.
    pub(super) fn is_closed(&self) -> bool {
        self.annihilator.is_some()
    }

    /// `A(x)`
    pub(super) fn at<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        combination(&self.matrices, x)
    }

    /// `Σ_k Aᵏ v / (k + shift)!`; of a coarse function a few terms, where these are not finite sums.
    pub(super) fn series<'a>(&self, of: Series, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.summed(&self.at(x), of, x, v)
    }

    /// `Σ_k (Aᵀ)ᵏ m / (k + shift)!`
    pub(super) fn transposed_series<'a>(&self, of: Series, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        self.summed(&self.at(x).transpose(), of, x, m)
    }

    fn summed<'a>(&self, a: &Matrix<'a>, (f, shift): Series, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        if let Some(annihilator) = &self.annihilator {
            return annihilator.sum(a, x, shift, v);
        }
        // v + A/(s+1) (v + A/(s+2) (v + …)), over s!
        let terms = if f == MatrixFunction::Coarse { FEW_TERMS } else { self.terms };
        let sum = (1..=terms as u32).rev().fold(v.clone(), |sum, k| {
            let next = a.times(&sum).map(|entry| entry.scale(Number::ratio(1, i128::from(k + shift))));
            (v + &next).hold()
        });
        sum.map(|entry| entry.scale(reciprocal_factorial(shift)))
    }

    /// `z`, where it has the eigenvalues `±√−z`, if others than zero.
    pub(super) fn argument<'a>(&self, x: &Vector<'a>) -> Option<Expr<'a>> {
        self.annihilator.as_ref()?.argument(x)
    }

    /// Whether it never has a real eigenvalue but zero.
    pub(super) fn is_elliptic(&self) -> bool {
        self.annihilator.as_ref().is_some_and(Annihilator::is_elliptic)
    }

    /// `|A(x)|²`, in Frobenius' norm.
    pub(super) fn squared_norm<'a>(&self, x: &Vector<'a>) -> Expr<'a> {
        quadratic(&self.frobenius(), x)
    }

    /// `tr AᵢᵀA_j`
    fn frobenius(&self) -> RationalMatrix {
        let d = self.matrices.len();
        RationalMatrix::from_fn(d, d, |i, j| self.matrices[i].transpose().times(&self.matrices[j]).trace())
    }

    /// Whether no number has grown too large.
    pub(super) fn is_exact(&self) -> bool {
        let quadratic = self.annihilator.as_ref().and_then(|annihilator| annihilator.quadratic.as_ref());
        quadratic.is_none_or(RationalMatrix::is_exact) && self.frobenius().is_exact()
    }
}

/// A polynomial `λᵃ (λ² + z)^q`, or `λᵃ` where there is no `z`, that annihilates a matrix linear in `x`; `z` is
/// quadratic in `x`.
#[derive(Clone, Debug)]
struct Annihilator {
    /// `a`
    power: usize,
    /// `q`
    multiplicity: usize,
    /// `z = Σ z_ij xᵢ x_j`
    quadratic: Option<RationalMatrix>,
}

impl Annihilator {
    /// Of `Σ xᵢ Eᵢ`; none if there is none of this kind. With `m` eigenvalues `±√−z`, `tr X² = −m z`.
    fn of(matrices: &[RationalMatrix]) -> Option<Self> {
        /// Points at which a polynomial that is not zero is not zero either: as good as any.
        const POINTS: [[i128; 5]; 2] = [[3, -7, 11, 2, -5], [-1, 4, 9, -13, 6]];
        let n = matrices[0].rows;
        let at = |point: &[i128; 5]| {
            let component = |i: usize| Rational::from(point[i % 5] + 17 * (i / 5) as i128);
            RationalMatrix::combination(matrices, &(0..matrices.len()).map(component).collect::<Vec<_>>())
        };
        // what annihilates a vector like any other annihilates all of them
        let vector = RationalMatrix::from_fn(n, 1, |i, _| {
            Rational::from([2, -3, 5, 7, -11][i % 5] + 13 * (i / 5) as i128)
        });
        let points = POINTS.map(|point| at(&point));
        let powers = points.each_ref().map(|x| {
            let mut powers = vec![vector.clone()];
            (0..n).for_each(|k| powers.push(x.times(&powers[k])));
            powers
        });
        if let Some(power) = (1..=n).find(|&a| powers.iter().all(|powers| powers[a].is_zero())) {
            return Some(Self { power, multiplicity: 0, quadratic: None });
        }
        let traces = points.each_ref().map(|x| x.times(x).trace());
        let is_annihilated = |&(a, m, q): &(usize, usize, usize)| {
            points.iter().zip(&traces).zip(&powers).all(|((x, trace), powers)| {
                let z = -*trace / Rational::from(m as i128);
                let factor = |v: &RationalMatrix| x.times(&x.times(v)).plus(v, z);
                (0..q).fold(powers[a].clone(), |v, _| factor(&v)).is_zero()
            })
        };
        let kinds = (1..=MULTIPLICITY).flat_map(|q| (0..n).map(move |a| (q, a)));
        let mut kinds = kinds.flat_map(|(q, a)| (1..=n).map(move |m| (a, m, q)));
        let (power, m, multiplicity) = kinds.find(is_annihilated)?;
        let d = matrices.len();
        let quadratic = RationalMatrix::from_fn(d, d, |i, j| {
            -matrices[i].times(&matrices[j]).trace() / Rational::from(m as i128)
        });
        Some(Self { power, multiplicity, quadratic: Some(quadratic) })
    }

    /// `z`, if there is one.
    fn argument<'a>(&self, x: &Vector<'a>) -> Option<Expr<'a>> {
        Some(quadratic(self.quadratic.as_ref()?, x))
    }

    /// `Σ_k Aᵏ v / (k + shift)!` for a matrix `A` that it annihilates.
    fn sum<'a>(&self, a: &Matrix<'a>, x: &Vector<'a>, shift: u32, v: &Vector<'a>) -> Vector<'a> {
        let mut power = v.clone();
        let mut sum = Vector::zeros(x.0[0].arena(), v.len());
        for k in 0..self.power {
            sum = &sum + &power.map(|entry| entry.scale(reciprocal_factorial(k as u32 + shift)));
            power = a.times(&power);
        }
        let Some(z) = self.argument(x) else { return sum };
        // A^{k+2j} = Aᵏ (N − z)ʲ with N = A² + z, of which the q-th power is zero on Aᵏ: Taylor's series of the Stumpff
        // function
        for k in [self.power as u32 + shift, self.power as u32 + shift + 1] {
            let next = a.times(&power);
            let mut term = power;
            for i in 0..self.multiplicity {
                if i > 0 {
                    term = &a.times(&a.times(&term)) + &term.scale(z);
                }
                sum = &sum + &term.scale(taylor(z, k, i));
            }
            power = next;
        }
        sum
    }

    /// Whether `z` is never negative.
    fn is_elliptic(&self) -> bool {
        self.quadratic.as_ref().is_none_or(RationalMatrix::is_positive_semidefinite)
    }
}

/// `(−1)ⁱ c_k⁽ⁱ⁾(z) / i!`, by `2 c_k′ = k c_{k+2} − c_{k+1}`.
fn taylor(z: Expr<'_>, k: u32, i: usize) -> Expr<'_> {
    if i == 0 {
        return z.stumpff(k);
    }
    let (first, second) = (taylor(z, k + 1, i - 1), taylor(z, k + 2, i - 1));
    (first - second.scale(i64::from(k))).scale(Number::ratio(1, 2 * i as i128))
}

/// `1/k!`
fn reciprocal_factorial(k: u32) -> Number {
    Number::ratio(1, (1..=i128::from(k)).product())
}

/// `Σ q_ij xᵢ x_j`
fn quadratic<'a>(form: &RationalMatrix, x: &Vector<'a>) -> Expr<'a> {
    let terms = (0..x.len()).flat_map(|i| (0..x.len()).map(move |j| (i, j)));
    let terms = terms.map(|(i, j)| (x.0[i] * x.0[j]).scale(number(form.at(i, j))));
    terms.fold(x.0[0].arena().zero(), |sum, term| sum + term)
}
