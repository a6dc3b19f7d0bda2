//! Steps in twice the digits, operation by operation, from what the generator has written down of them as bytes.
//!
//! To compile each step once more for such numbers would take as long as to compile it once. And since this is not the code that takes the
//! steps, what the compiler made of that is checked too. The bytes mean what `codegen/src/emit/bytecode.rs` says.

use std::vec::Vec;

use crate::double::Double;
use crate::kernel::Program;
use crate::scalar::{Batch, Scalar, zero};

/// A number of twice as many digits.
pub(crate) type Wide = Double<f64>;

/// What functions are given: parameters, step, state, time, control, unknown, residual and right side.
#[derive(Clone, Copy, Default)]
struct Given<'a>([&'a [Wide]; 8]);

/// The functions of a step, in the order in which they are called.
#[derive(Clone, Copy)]
enum Function {
    New,
    Begin,
    Evaluate,
    Finish,
}

/// A step's program with all that it has computed so far.
#[derive(Clone)]
pub(crate) struct Machine {
    program: Program,
    places: Vec<Wide>,
}

impl Machine {
    /// For these parameters and a step of this length.
    pub(crate) fn new(program: Program, parameters: &[Wide], step: Wide) -> Self {
        let mut machine = Self { program, places: Vec::new() };
        machine.call(Function::New, Given([parameters, &[step], &[], &[], &[], &[], &[], &[]]));
        machine
    }

    /// Begins a step from a state.
    pub(crate) fn begin(&mut self, state: &[Wide], time: Wide, control: &[Wide]) {
        self.call(Function::Begin, Given([&[], &[], state, &[time], control, &[], &[], &[]]));
    }

    /// The residual at a value of the unknown, and the state that this leads to from the one at which the step began.
    pub(crate) fn evaluate(&mut self, state: &[Wide], unknown: &[Wide]) -> [Vec<Wide>; 2] {
        let given = Given([&[], &[], state, &[], &[], unknown, &[], &[]]);
        let [residual, right] = self.call(Function::Evaluate, given);
        let given = Given([&[], &[], state, &[], &[], unknown, &residual, &right]);
        let [next, _] = self.call(Function::Finish, given);
        [residual, next]
    }

    /// Calls a function, which returns two arrays at most.
    fn call(&mut self, function: Function, Given(given): Given<'_>) -> [Vec<Wide>; 2] {
        let mut code = Code(self.program[function as usize]);
        for _ in 0..code.count() {
            let given = given.get(usize::from(code.byte())).copied().unwrap_or_default();
            for component in 0..code.count() {
                let place = code.count();
                self.put(place, given.get(component).copied().unwrap_or(ZERO));
            }
        }
        for _ in 0..code.count() {
            self.run(&mut code);
        }
        let mut results = [Vec::new(), Vec::new()];
        for result in results.iter_mut().take(code.count()) {
            result.extend((0..code.count()).map(|_| self.term(&mut code)));
        }
        results
    }

    /// Runs a statement.
    fn run(&mut self, code: &mut Code) {
        if code.byte() == 0 {
            let place = code.count();
            let value = self.term(code);
            self.put(place, value);
            return;
        }
        let places: Vec<usize> = (0..code.count()).map(|_| code.count()).collect();
        let argument = self.term(code);
        for (place, value) in places.iter().zip(stumpff(places.len(), argument)) {
            self.put(*place, value);
        }
    }

    /// Place 0 is for what is not used.
    fn put(&mut self, place: usize, value: Wide) {
        if self.places.len() <= place {
            self.places.resize(place + 1, ZERO);
        }
        self.places[place] = value;
    }

    /// The value of a term, operation by operation as it is compiled.
    fn term(&self, code: &mut Code) -> Wide {
        let kind = code.byte();
        match kind {
            0 => Wide::exactly(code.number()),
            1 => self.places.get(code.count()).copied().unwrap_or(ZERO),
            2 => -self.term(code),
            3 => {
                let count = code.count();
                let mut sum = self.addend(code).1;
                for _ in 1..count {
                    sum = match self.addend(code) {
                        (false, addend) => sum + addend,
                        (true, addend) => sum - addend,
                    };
                }
                sum
            }
            4 => {
                let count = code.count();
                let first = self.term(code);
                (1..count).fold(first, |product, _| product * self.term(code))
            }
            5 | 6 => {
                let [a, b, addend] = [(); 3].map(|()| self.term(code));
                if kind == 5 { a.mul_add(b, addend) } else { a.neg_mul_add(b, addend) }
            }
            7..10 => {
                let [x, y] = [(); 2].map(|()| self.term(code));
                match kind {
                    7 => x / y,
                    8 => x.powf(y),
                    _ => x.atan2(y),
                }
            }
            23 => {
                let order = code.count() as u32;
                Wide::exactly(zero::angle_over_sine(self.term(code).lane(0), order))
            }
            _ => elementary(kind, self.term(code)),
        }
    }

    /// An addend, and whether it is subtracted; the first never is.
    fn addend(&self, code: &mut Code) -> (bool, Wide) {
        (code.byte() == 1, self.term(code))
    }
}

const ZERO: Wide = Wide::from_parts([0.0, 0.0]);

/// Functions of one number.
fn elementary(kind: u8, x: Wide) -> Wide {
    match kind {
        10 => x.sqrt(),
        11 => x.exp(),
        12 => x.ln(),
        13 => x.sin(),
        14 => x.cos(),
        15 => x.tan(),
        16 => x.asin(),
        17 => x.acos(),
        18 => x.atan(),
        19 => x.sinh(),
        20 => x.cosh(),
        21 => x.tanh(),
        _ => x.recip_or_zero(),
    }
}

/// So many Stumpff functions, `c₀` the first.
fn stumpff(count: usize, x: Wide) -> Vec<Wide> {
    macro_rules! family {
        ($($length:literal)*) => {
            match count {
                $($length => x.stumpff::<$length>().to_vec(),)*
                _ => x.stumpff::<12>().to_vec(),
            }
        };
    }
    family!(1 2 3 4 5 6 7 8 9 10 11)
}

/// What is left to read of a function.
struct Code(&'static [u8]);

impl Code {
    fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((byte, rest)) => {
                self.0 = rest;
                *byte
            }
            None => 0,
        }
    }

    fn count(&mut self) -> usize {
        let (mut count, mut shift) = (0, 0_u32);
        loop {
            let byte = self.byte();
            // no count is that large: the bytes are the generator's
            count |= usize::from(byte & 127).checked_shl(shift).unwrap_or_default();
            if byte < 128 {
                return count;
            }
            shift += 7;
        }
    }

    fn number(&mut self) -> f64 {
        f64::from_le_bytes([(); 8].map(|()| self.byte()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: Wide = Wide::from_parts([0.7, 1e-18]);
    const Y: Wide = Wide::from_parts([-1.3, 3e-17]);

    /// What `evaluate` makes of the unknown `(x, y)`, which it finds in places 1 and 200.
    fn evaluated(body: &[u8]) -> [Vec<Wide>; 2] {
        let unpacked: &[u8] = &[1, 5, 2, 1, 200, 1];
        let code: &'static [u8] = [unpacked, body].concat().leak();
        let mut machine = Machine::new([&[], &[], code, &[]], &[], ZERO);
        let [residual, right] =
            machine.call(Function::Evaluate, Given([&[], &[], &[], &[], &[], &[X, Y], &[], &[]]));
        [residual, right]
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
    }

    #[test]
    fn what_is_named_is_there_for_the_functions_after_it() {
        // a name for x y, and three Stumpff functions of which one is not used; two results
        let body = [2, 0, 2, 4, 2, 1, 1, 1, 200, 1, 1, 3, 3, 0, 4, 1, 2, 2, 1, 1, 2, 2, 1, 3, 1, 4];
        let [c0, _, c2] = (X * Y).stumpff();
        assert_eq!(evaluated(&body), [std::vec![X * Y], std::vec![c0, c2]]);
    }
}
