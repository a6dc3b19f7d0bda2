//! What machine code calls: functions of numbers that processors have no instruction for, the library's.

use coadjoint::__private::Scalar;
use coadjoint_codegen::program::Elementary;
use cranelift_codegen::ir::{AbiParam, Signature, Type, types};
use cranelift_codegen::isa::CallConv;

/// A function that is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Outside {
    /// Of one number, by its place in the table.
    Of(usize),
    Power,
    Atan2,
    /// Of how many there are, the argument, and where they go.
    Stumpff,
}

type Plain = extern "C" fn(f64) -> f64;

macro_rules! plain {
    ($($name:literal: $x:ident => $value:expr),* $(,)?) => {
        /// Functions of one number.
        const PLAIN: &[(&str, Plain)] = &[$(($name, {
            extern "C" fn function($x: f64) -> f64 {
                $value
            }
            function
        })),*];
    };
}

plain! {
    "exp": x => Scalar::exp(x),
    "ln": x => Scalar::ln(x),
    "sin": x => Scalar::sin(x),
    "cos": x => Scalar::cos(x),
    "tan": x => Scalar::tan(x),
    "asin": x => Scalar::asin(x),
    "acos": x => Scalar::acos(x),
    "atan": x => Scalar::atan(x),
    "sinh": x => Scalar::sinh(x),
    "cosh": x => Scalar::cosh(x),
    "tanh": x => Scalar::tanh(x),
    "recip_or_zero": x => Scalar::recip_or_zero(x),
    "angle_over_sine_0": x => x.angle_over_sine::<0>(),
    "angle_over_sine_1": x => x.angle_over_sine::<1>(),
    "angle_over_sine_2": x => x.angle_over_sine::<2>(),
    "angle_over_sine_3": x => x.angle_over_sine::<3>(),
    "angle_over_sine_4": x => x.angle_over_sine::<4>(),
    "angle_over_sine_5": x => x.angle_over_sine::<5>(),
    "angle_over_sine_6": x => x.angle_over_sine::<6>(),
}

extern "C" fn power(x: f64, y: f64) -> f64 {
    Scalar::powf(x, y)
}

extern "C" fn atan2(y: f64, x: f64) -> f64 {
    Scalar::atan2(y, x)
}

macro_rules! stumpff {
    ($($count:literal)*) => {
        /// # Safety
        /// There is room for so many.
        unsafe extern "C" fn stumpff(count: usize, z: f64, to: *mut f64) {
            match count {
                // SAFETY: as the caller promises
                $($count => unsafe { to.cast::<[f64; $count]>().write(Scalar::stumpff::<$count>(z)) },)*
                _ => {}
            }
        }
    };
}
stumpff!(1 2 3 4 5 6 7 8 9 10 11 12);

/// The function of one number that is called for this one.
pub(super) fn elementary(function: Elementary) -> Outside {
    use Elementary as Of;
    Outside::Of(match function {
        Of::Exp => 0,
        Of::Ln => 1,
        Of::Sin => 2,
        Of::Cos => 3,
        Of::Tan => 4,
        Of::Asin => 5,
        Of::Acos => 6,
        Of::Atan => 7,
        Of::Sinh => 8,
        Of::Cosh => 9,
        Of::Tanh => 10,
        Of::RecipOrZero => 11,
        Of::AngleOverSine(order) => 12 + order as usize,
        // the one is an instruction, the others a statement: there is no function
        Of::Sqrt | Of::Stumpff(_) => usize::MAX,
    })
}

impl Outside {
    /// All of them.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..PLAIN.len()).map(Self::Of).chain([Self::Power, Self::Atan2, Self::Stumpff])
    }

    /// Its name, and where it is, if there is such a function.
    pub(super) fn symbol(self) -> Option<(&'static str, *const u8)> {
        Some(match self {
            Self::Of(place) => {
                let (name, function) = PLAIN.get(place)?;
                (*name, *function as *const u8)
            }
            Self::Power => ("power", power as *const u8),
            Self::Atan2 => ("atan2", atan2 as *const u8),
            Self::Stumpff => ("stumpff", stumpff as *const u8),
        })
    }

    /// What it is given and returns.
    pub(super) fn signature(self, convention: CallConv, pointer: Type) -> Signature {
        let mut signature = Signature::new(convention);
        let number = AbiParam::new(types::F64);
        match self {
            Self::Of(_) => signature.params.push(number),
            Self::Power | Self::Atan2 => signature.params.extend([number; 2]),
            Self::Stumpff => {
                signature.params.extend([AbiParam::new(pointer), number, AbiParam::new(pointer)]);
                return signature;
            }
        }
        signature.returns.push(number);
        signature
    }
}
