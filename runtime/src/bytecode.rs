//! Steps operation by operation, from what the generator has written down of them as bytes, in other numbers than those they are compiled for.
//!
//! In twice the digits certificates hold steps against them, and since this is not the code that takes the steps, what the compiler made of
//! that is checked too. In numbers that carry their errors the solver asks what rounding leaves of a residual. To compile each step for such
//! numbers would take as long as to compile it once. The bytes mean what `codegen/src/emit/bytes.rs` says.

use crate::scalar::Scalar;

/// The functions of a step, in the order in which they are called.
#[derive(Clone, Copy)]
#[cfg_attr(
    not(feature = "std"),
    expect(dead_code, reason = "certificates take whole steps, the solver evaluates")
)]
pub(crate) enum Function {
    New,
    Begin,
    Evaluate,
    Finish,
}

/// What functions are given, by its number among the bytes.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Given {
    Parameters,
    StepSize,
    State,
    Time,
    Control,
    Unknown,
    Residual,
    Right,
    Constants,
    Step,
    /// What the bytes of no generator say.
    Nothing,
}

impl Given {
    const ALL: [Self; 10] = [
        Self::Parameters,
        Self::StepSize,
        Self::State,
        Self::Time,
        Self::Control,
        Self::Unknown,
        Self::Residual,
        Self::Right,
        Self::Constants,
        Self::Step,
    ];
}

/// Runs a function: what is `given`, by its component, goes to its places, where what is not given stays as it is; and each number that is
/// returned is shown, by the array's number and its own. Compiled once for all systems.
pub(crate) fn run<N: Scalar>(
    code: &[u8],
    places: &mut [N],
    given: &dyn Fn(Given, usize) -> Option<N>,
    returned: &mut dyn FnMut(usize, usize, N),
) {
    let mut code = Code(code);
    for _ in 0..code.count() {
        let kind = Given::ALL.get(usize::from(code.byte())).copied().unwrap_or(Given::Nothing);
        for component in 0..code.count() {
            let place = code.count();
            if let Some(value) = given(kind, component) {
                put(places, place, value);
            }
        }
    }
    for _ in 0..code.count() {
        statement(&mut code, places);
    }
    for array in 0..code.count() {
        for component in 0..code.count() {
            returned(array, component, term(&mut code, places));
        }
    }
}

/// The most Stumpff functions of one argument.
const MOST: usize = 12;

fn statement<N: Scalar>(code: &mut Code<'_>, places: &mut [N]) {
    if code.byte() == 0 {
        let place = code.count();
        let value = term(code, places);
        return put(places, place, value);
    }
    let (count, mut to) = (code.count(), [0; MOST]);
    for k in 0..count {
        let place = code.count();
        if let Some(to) = to.get_mut(k) {
            *to = place;
        }
    }
    let argument = term(code, places);
    macro_rules! family {
        ($($length:literal)*) => {
            match count {
                $($length => to.iter().zip(argument.stumpff::<$length>()).for_each(|(to, c)| put(places, *to, c)),)*
                _ => to.iter().zip(argument.stumpff::<MOST>()).for_each(|(to, c)| put(places, *to, c)),
            }
        };
    }
    family!(1 2 3 4 5 6 7 8 9 10 11)
}

/// Place 0 is for what is not used.
#[inline]
fn put<N: Scalar>(places: &mut [N], place: usize, value: N) {
    if let Some(at) = places.get_mut(place) {
        *at = value;
    }
}

/// The kinds of terms. `codegen/src/emit/bytes.rs` has this module too, to the letter.
mod kind {
    pub(super) const NUMBER: u8 = 0;
    pub(super) const VALUE: u8 = 1;
    pub(super) const NEGATIVE: u8 = 2;
    pub(super) const SUM: u8 = 3;
    pub(super) const PRODUCT: u8 = 4;
    pub(super) const MUL_ADD: u8 = 5;
    pub(super) const NEG_MUL_ADD: u8 = 6;
    pub(super) const QUOTIENT: u8 = 7;
    pub(super) const POWER: u8 = 8;
    pub(super) const ATAN2: u8 = 9;
    pub(super) const SQRT: u8 = 10;
    pub(super) const EXP: u8 = 11;
    pub(super) const LN: u8 = 12;
    pub(super) const SIN: u8 = 13;
    pub(super) const COS: u8 = 14;
    pub(super) const TAN: u8 = 15;
    pub(super) const ASIN: u8 = 16;
    pub(super) const ACOS: u8 = 17;
    pub(super) const ATAN: u8 = 18;
    pub(super) const SINH: u8 = 19;
    pub(super) const COSH: u8 = 20;
    pub(super) const TANH: u8 = 21;
    pub(super) const RECIP_OR_ZERO: u8 = 22;
    pub(super) const ANGLE_OVER_SINE: u8 = 23;
    pub(super) const CHOICE: u8 = 24;
}

/// The value of a term, operation by operation as it is compiled.
fn term<N: Scalar>(code: &mut Code<'_>, places: &[N]) -> N {
    let kind = code.byte();
    match kind {
        kind::NUMBER => N::of(code.number()),
        kind::VALUE => places.get(code.count()).copied().unwrap_or(N::of(0.0)),
        kind::NEGATIVE => -term(code, places),
        kind::SUM => {
            let count = code.count();
            let mut sum = addend(code, places).1;
            for _ in 1..count {
                sum = match addend(code, places) {
                    (false, addend) => sum + addend,
                    (true, addend) => sum - addend,
                };
            }
            sum
        }
        kind::PRODUCT => {
            let count = code.count();
            let mut product = term(code, places);
            for _ in 1..count {
                product = product * term(code, places);
            }
            product
        }
        kind::MUL_ADD | kind::NEG_MUL_ADD | kind::CHOICE => {
            let (a, b) = (term(code, places), term(code, places));
            let c = term(code, places);
            match kind {
                kind::MUL_ADD => a.mul_add(b, c),
                kind::NEG_MUL_ADD => a.neg_mul_add(b, c),
                _ => a.if_negative(b, c),
            }
        }
        kind::QUOTIENT | kind::POWER | kind::ATAN2 => {
            let (x, y) = (term(code, places), term(code, places));
            match kind {
                kind::QUOTIENT => x / y,
                kind::POWER => x.powf(y),
                _ => x.atan2(y),
            }
        }
        kind::ANGLE_OVER_SINE => {
            let order = code.count();
            angle_over_sine(order, term(code, places))
        }
        _ => elementary(kind, term(code, places)),
    }
}

/// The derivative of this order of `θ / sin θ` with respect to `cos θ`; no generated code asks for a higher one than the sixth.
fn angle_over_sine<N: Scalar>(order: usize, x: N) -> N {
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

/// An addend, and whether it is subtracted; the first never is.
fn addend<N: Scalar>(code: &mut Code<'_>, places: &[N]) -> (bool, N) {
    (code.byte() == 1, term(code, places))
}

/// Functions of one number.
fn elementary<N: Scalar>(kind: u8, x: N) -> N {
    match kind {
        kind::SQRT => x.sqrt(),
        kind::EXP => x.exp(),
        kind::LN => x.ln(),
        kind::SIN => x.sin(),
        kind::COS => x.cos(),
        kind::TAN => x.tan(),
        kind::ASIN => x.asin(),
        kind::ACOS => x.acos(),
        kind::ATAN => x.atan(),
        kind::SINH => x.sinh(),
        kind::COSH => x.cosh(),
        kind::TANH => x.tanh(),
        kind::RECIP_OR_ZERO => x.recip_or_zero(),
        // the bytes of no generator
        _ => x,
    }
}

/// What is left to read of a function.
struct Code<'a>(&'a [u8]);

impl Code<'_> {
    #[inline]
    fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((byte, rest)) => {
                self.0 = rest;
                *byte
            }
            None => 0,
        }
    }

    #[inline]
    fn count(&mut self) -> usize {
        let (mut count, mut shift) = (0, 0_u32);
        loop {
            let byte = self.byte();
            // no count is that large: the bytes are the generator's
            count |= usize::from(byte & 127).checked_shl(shift).unwrap_or_default();
            if byte < 128 {
                return count;
            }
            shift = shift.saturating_add(7);
        }
    }

    fn number(&mut self) -> f64 {
        f64::from_le_bytes([(); 8].map(|()| self.byte()))
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::double::Double;

    type Wide = Double<f64>;

    const X: Wide = Wide::from_parts([0.7, 1e-18]);
    const Y: Wide = Wide::from_parts([-1.3, 3e-17]);

    /// What `evaluate` makes of the unknown `(x, y)`, which it finds in places 1 and 200.
    fn evaluated(body: &[u8]) -> [Vec<Wide>; 2] {
        let unpacked: &[u8] = &[1, 5, 2, 1, 200, 1];
        let code: &'static [u8] = [unpacked, body].concat().leak();
        let mut results = [Vec::new(), Vec::new()];
        let given = |given, component: usize| (given == Given::Unknown).then_some([X, Y][component]);
        run(code, &mut [Wide::of(0.0); 201], &given, &mut |array, _, value| results[array].push(value));
        results
    }

    #[test]
    fn operations_are_those_of_the_numbers() {
        let (x, y): (&[u8], &[u8]) = (&[1, 1], &[1, 200, 1]);
        let operation = |kind: u8, operands: &[&[u8]]| {
            // no statements, one result of one term
            let body = [&[0, 1, 1, kind], &operands.concat()[..]].concat();
            let [result, none] = evaluated(&body);
            assert!(result.len() == 1 && none.is_empty());
            result[0]
        };
        assert_eq!(operation(2, &[x]), -X);
        assert_eq!(operation(3, &[&[3, 0], x, &[1], y, &[0], y]), (X - Y) + Y);
        assert_eq!(operation(4, &[&[3], x, y, y]), X * Y * Y);
        assert_eq!(operation(5, &[x, y, y]), X.mul_add(Y, Y));
        assert_eq!(operation(6, &[x, y, y]), X.neg_mul_add(Y, Y));
        assert_eq!(operation(7, &[x, y]), X / Y);
        assert_eq!(operation(8, &[x, y]), X.powf(Y));
        assert_eq!(operation(9, &[x, y]), X.atan2(Y));
        assert_eq!(operation(0, &[&0.1_f64.to_le_bytes()]), Wide::exactly(0.1));
        let functions: [fn(Wide) -> Wide; 13] = [
            Wide::sqrt,
            Wide::exp,
            Wide::ln,
            Wide::sin,
            Wide::cos,
            Wide::tan,
            Wide::asin,
            Wide::acos,
            Wide::atan,
            Wide::sinh,
            Wide::cosh,
            Wide::tanh,
            Wide::recip_or_zero,
        ];
        for (kind, function) in (10..).zip(functions) {
            assert_eq!(operation(kind, &[x]), function(X));
        }
        assert_eq!(operation(23, &[&[2], x]), X.angle_over_sine::<2>());
        assert_eq!((operation(24, &[y, y, x]), operation(24, &[x, y, x])), (Y, X));
    }

    #[test]
    fn what_is_named_is_there_for_the_functions_after_it() {
        // a name for x y, and three Stumpff functions of which one is not used; two results
        let body = [2, 0, 2, 4, 2, 1, 1, 1, 200, 1, 1, 3, 3, 0, 4, 1, 2, 2, 1, 1, 2, 2, 1, 3, 1, 4];
        let [c0, _, c2] = (X * Y).stumpff();
        assert_eq!(evaluated(&body), [std::vec![X * Y], std::vec![c0, c2]]);
    }
}
