//! Code as a list of operations on the numbers of a frame, each of which is gone through for several frames side by side.

use coadjoint::__private::Scalar;

/// What is done with operands `a`, `b`, `c`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// `a`
    Copy,
    /// `−a`
    Negative,
    /// `a + b`
    Add,
    /// `a − b`
    Subtract,
    /// `a b`
    Multiply,
    /// `a / b`
    Divide,
    /// `a b + c`
    MulAdd,
    /// `−a b + c`
    NegMulAdd,
    /// `√a`
    Sqrt,
    /// `a^b`
    Power,
    /// The angle of the point `(b, a)`.
    Atan2,
    /// The lesser of both.
    Least,
    /// `b` where `a` is below zero, `c` elsewhere.
    Choice,
    /// `1/a`, or 0.
    RecipOrZero,
    /// The derivative of order `b`, a number, of `θ / sin θ` by `cos θ`.
    AngleOverSine,
    /// A function of one number.
    Elementary(Elementary),
    /// Stumpff functions of `a`, to the places in list `b`, of which each has its number.
    Stumpff,
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Elementary {
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
}

impl Elementary {
    fn of(self, x: f64) -> f64 {
        match self {
            Self::Exp => Scalar::exp(x),
            Self::Ln => Scalar::ln(x),
            Self::Sin => Scalar::sin(x),
            Self::Cos => Scalar::cos(x),
            Self::Tan => Scalar::tan(x),
            Self::Asin => Scalar::asin(x),
            Self::Acos => Scalar::acos(x),
            Self::Atan => Scalar::atan(x),
            Self::Sinh => Scalar::sinh(x),
            Self::Cosh => Scalar::cosh(x),
            Self::Tanh => Scalar::tanh(x),
        }
    }
}

/// An operation, and the places of its result and its operands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) operation: Operation,
    pub(crate) to: u32,
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) c: u32,
}

/// A function.
#[derive(Clone, Debug, Default)]
pub(crate) struct Code {
    pub(crate) lines: Vec<Line>,
    /// Where Stumpff functions go, from `c₀` on.
    pub(crate) families: Vec<Vec<Option<u32>>>,
}

/// The most Stumpff functions of one argument.
const MOST: usize = 12;

impl Code {
    /// Runs it on frames side by side.
    #[inline(always)]
    pub(crate) fn run<const L: usize>(&self, frame: &mut [[f64; L]]) {
        macro_rules! each {
            ($line:ident, $($x:ident = $operand:ident),+ => $value:expr) => {{
                $(let $x = frame[$line.$operand as usize];)+
                let to = &mut frame[$line.to as usize];
                for lane in 0..L {
                    $(let $x = $x[lane];)+
                    to[lane] = $value;
                }
            }};
        }
        for line in &self.lines {
            match line.operation {
                Operation::Copy => frame[line.to as usize] = frame[line.a as usize],
                Operation::Negative => each!(line, x = a => -x),
                Operation::Add => each!(line, x = a, y = b => x + y),
                Operation::Subtract => each!(line, x = a, y = b => x - y),
                Operation::Multiply => each!(line, x = a, y = b => x * y),
                Operation::Divide => each!(line, x = a, y = b => x / y),
                Operation::MulAdd => each!(line, x = a, y = b, z = c => Scalar::mul_add(x, y, z)),
                Operation::NegMulAdd => each!(line, x = a, y = b, z = c => Scalar::neg_mul_add(x, y, z)),
                Operation::Sqrt => each!(line, x = a => Scalar::sqrt(x)),
                Operation::Power => each!(line, x = a, y = b => Scalar::powf(x, y)),
                Operation::Atan2 => each!(line, x = a, y = b => Scalar::atan2(x, y)),
                Operation::Least => each!(line, x = a, y = b => Scalar::min(x, y)),
                Operation::Choice => each!(line, x = a, y = b, z = c => Scalar::if_negative(x, y, z)),
                Operation::RecipOrZero => each!(line, x = a => Scalar::recip_or_zero(x)),
                Operation::AngleOverSine => each!(line, x = a => angle_over_sine(line.b, x)),
                Operation::Elementary(function) => each!(line, x = a => function.of(x)),
                Operation::Stumpff => self.stumpff(line, frame),
            }
        }
    }

    #[inline]
    fn stumpff<const L: usize>(&self, line: &Line, frame: &mut [[f64; L]]) {
        let (family, z) = (&self.families[line.b as usize], frame[line.a as usize]);
        macro_rules! of_length {
            ($($length:literal)*) => {
                match family.len() {
                    $($length => write(family, z, frame, Scalar::stumpff::<$length>),)*
                    _ => write(family, z, frame, Scalar::stumpff::<MOST>),
                }
            };
        }
        of_length!(1 2 3 4 5 6 7 8 9 10 11)
    }
}

/// Writes the functions that are used of each lane's argument.
fn write<const L: usize, const N: usize>(
    family: &[Option<u32>],
    z: [f64; L],
    frame: &mut [[f64; L]],
    stumpff: impl Fn(f64) -> [f64; N],
) {
    for (lane, z) in z.into_iter().enumerate() {
        let values = stumpff(z);
        for (to, value) in family.iter().zip(values) {
            if let Some(to) = to {
                frame[*to as usize][lane] = value;
            }
        }
    }
}

fn angle_over_sine(order: u32, x: f64) -> f64 {
    match order {
        0 => x.angle_over_sine::<0>(),
        1 => x.angle_over_sine::<1>(),
        2 => x.angle_over_sine::<2>(),
        3 => x.angle_over_sine::<3>(),
        4 => x.angle_over_sine::<4>(),
        5 => x.angle_over_sine::<5>(),
        _ => x.angle_over_sine::<6>(),
    }
}
