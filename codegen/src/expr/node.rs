//! Nodes of expressions.

use std::rc::Rc;

use super::number::Number;

/// A node's place in its arena. Ids grow with creation, so their order depends on the input alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(pub(crate) u32);

/// A symbol's place in its arena.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(pub(crate) u32);

/// The earliest stage at which a value is known. Later stages may use earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// When the stepper is built.
    Parameters,
    /// When the state is known.
    Step,
    /// When Newton's unknown is known.
    Iteration,
    /// When the perturbations are known that a derivative is applied to.
    Perturbation,
}

/// An elementary function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Function {
    /// `√x`
    Sqrt,
    /// `eˣ`
    Exp,
    /// The natural logarithm.
    Ln,
    /// The sine.
    Sin,
    /// The cosine.
    Cos,
    /// The tangent.
    Tan,
    /// The arc sine.
    Asin,
    /// The arc cosine.
    Acos,
    /// The arc tangent.
    Atan,
    /// The hyperbolic sine.
    Sinh,
    /// The hyperbolic cosine.
    Cosh,
    /// The hyperbolic tangent.
    Tanh,
    /// `c_k(z) = Σ_j (−z)^j / (k + 2j)!`
    Stumpff(u32),
    /// `1/x`, and 0 where `x` is 0 or so near that the square of `1/x` is infinite: where it stands, the limit of the
    /// whole is zero.
    RecipOrZero,
    /// The derivative, so many times, of `θ / sin θ` with respect to `cos θ`, for θ from 0 to below π: of
    /// `acos(c) / √(1 − c²)`.
    AngleOverSine(u32),
}

/// A sum's constant and its terms with their coefficients, sorted by id; at least one term.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Sum {
    /// The constant addend.
    pub constant: Number,
    /// Terms with their coefficients, none of them zero.
    pub terms: Rc<[(Id, Number)]>,
}

/// One node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant.
    Number(Number),
    /// A symbol.
    Symbol(Symbol),
    /// A sum.
    Sum(Sum),
    /// Factors with their exponents, sorted by id.
    Product(Rc<[(Id, i32)]>),
    /// A function of one argument.
    Function(Function, Id),
    /// `base^exponent` for an exponent that is not an integer.
    Power(Id, Id),
    /// `atan2(y, x)`
    Atan2(Id, Id),
    /// `[x, y, z]`: `y` where `x < 0`, `z` elsewhere. What is not taken need not be a number.
    Choice([Id; 3]),
    /// A value kept whole: the same number, but not merged into the sums and products around it.
    Held(Id),
}

impl Node {
    /// The node's operands.
    pub fn operands(&self) -> impl Iterator<Item = Id> + '_ {
        (0..).map_while(|k| self.operand(k))
    }

    /// One of the nodes that it is made of, if there are so many.
    pub(super) fn operand(&self, k: usize) -> Option<Id> {
        match self {
            Self::Number(_) | Self::Symbol(_) => None,
            Self::Sum(sum) => sum.terms.get(k).map(|&(id, _)| id),
            Self::Product(factors) => factors.get(k).map(|&(id, _)| id),
            Self::Function(_, x) | Self::Held(x) => (k == 0).then_some(*x),
            Self::Power(x, y) | Self::Atan2(x, y) => [*x, *y].get(k).copied(),
            Self::Choice(operands) => operands.get(k).copied(),
        }
    }

    /// Whether its own constants are neither infinite nor not a number.
    pub(super) fn is_finite(&self) -> bool {
        match self {
            Self::Number(number) => number.is_finite(),
            Self::Sum(sum) => sum.constant.is_finite() && sum.terms.iter().all(|(_, c)| c.is_finite()),
            _ => true,
        }
    }
}

/// A symbol's name and stage.
#[derive(Clone, Debug)]
pub struct SymbolInfo {
    /// Its name in text and, if that is free, in code.
    pub name: String,
    /// When its value is known.
    pub stage: Stage,
}

impl Sum {
    /// `c · x` and nothing else.
    pub fn is_scaled_term(&self) -> bool {
        self.terms.len() == 1 && self.constant.is_zero()
    }

    /// What to pull out of the sum where it is a factor: the common magnitude of its coefficients if they have one,
    /// and the sign of the first term.
    pub fn content(&self) -> Number {
        let first = self.terms[0].1;
        let magnitude = first.abs();
        let common = self.terms.iter().all(|(_, c)| c.abs() == magnitude)
            && (self.constant.is_zero() || self.constant.abs() == magnitude);
        match (common, first.is_negative()) {
            (true, _) => first,
            (false, true) => Number::MINUS_ONE,
            (false, false) => Number::ONE,
        }
    }
}

impl Function {
    /// The value at `argument` where it is an exactly known rational.
    pub(super) fn exact(self, argument: Number) -> Option<Number> {
        if let Function::Sqrt = self {
            return argument.exact_sqrt();
        }
        if let Function::RecipOrZero = self {
            return Some(if argument.is_zero() { Number::ZERO } else { argument.powi(-1) });
        }
        if argument.is_zero() {
            match self {
                Self::Sin | Self::Tan | Self::Asin | Self::Atan | Self::Sinh | Self::Tanh => {
                    Some(Number::ZERO)
                }
                Self::Exp | Self::Cos | Self::Cosh => Some(Number::ONE),
                Self::Stumpff(k) => {
                    Some(Number::ratio(1, (1..=i128::from(k)).try_fold(1i128, |f, i| f.checked_mul(i))?))
                }
                Self::Sqrt | Self::Ln | Self::Acos | Self::RecipOrZero | Self::AngleOverSine(_) => None,
            }
        } else if argument.is_one() {
            match self {
                Self::Ln | Self::Acos => Some(Number::ZERO),
                Self::AngleOverSine(0) => Some(Number::ONE),
                _ => None,
            }
        } else {
            None
        }
    }

    /// Its name in text and, but for families of functions, in code.
    pub fn name(self) -> String {
        match self {
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sinh => "sinh",
            Self::Cosh => "cosh",
            Self::Tanh => "tanh",
            Self::Stumpff(k) => return format!("c{k}"),
            Self::RecipOrZero => "recip_or_zero",
            Self::AngleOverSine(k) => return format!("angle_over_sine_{k}"),
        }
        .to_owned()
    }

    /// Whether `f(−x) = −f(x)`, and `f(x)/x` has no zero in its denominator at 0.
    pub(super) fn is_odd(self) -> bool {
        matches!(self, Self::Sin | Self::Tan | Self::Asin | Self::Atan | Self::Sinh | Self::Tanh)
    }
}
