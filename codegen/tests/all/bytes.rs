//! Reads a step's functions as bytes, and runs them in doubles: as `codegen/src/emit/bytes.rs` says what they mean.

use coadjoint_codegen::expr::Function;

use crate::evaluate::Value;

/// What the functions have computed, one after the other, by its place.
#[derive(Default)]
pub(crate) struct Machine(Vec<f64>);

impl Machine {
    /// The arrays that a function returns, which is given parameters, step, state, time, control, unknown, residual and right side. The records of
    /// constants and of a step are where the functions before it have left them.
    pub(crate) fn call(&mut self, code: &[u8], given: [&[f64]; 8]) -> Vec<Vec<f64>> {
        let mut code = Code(code);
        for _ in 0..code.count() {
            let kind = code.byte();
            let places = code.places();
            let Some(given) = given.get(usize::from(kind)) else {
                assert!(
                    places.iter().all(|&place| place == 0 || !self.0[place].is_nan()),
                    "a record, {kind}"
                );
                continue;
            };
            assert_eq!(places.len(), given.len(), "the length of what is given, {kind}");
            places.into_iter().zip(*given).for_each(|(place, &value)| self.put(place, value));
        }
        for _ in 0..code.count() {
            match code.byte() {
                0 => {
                    let place = code.count();
                    let value = self.term(&mut code);
                    self.put(place, value);
                }
                1 => {
                    let places = code.places();
                    let argument = self.term(&mut code);
                    for (k, place) in (0..).zip(places) {
                        self.put(place, argument.apply(Function::Stumpff(k)));
                    }
                }
                kind => panic!("no statement {kind}"),
            }
        }
        let array = |code: &mut Code<'_>| (0..code.count()).map(|_| self.term(code)).collect();
        let results = (0..code.count()).map(|_| array(&mut code)).collect();
        assert!(code.0.is_empty(), "{} bytes are left", code.0.len());
        results
    }

    fn put(&mut self, place: usize, value: f64) {
        self.0.resize(self.0.len().max(place + 1), f64::NAN);
        self.0[place] = value;
    }

    fn term(&self, code: &mut Code<'_>) -> f64 {
        let kind = code.byte();
        let next = |code: &mut Code<'_>| self.term(code);
        match kind {
            0 => code.number(),
            1 => self.0[code.count()],
            2 => -next(code),
            3 => {
                let addend = |code: &mut Code<'_>| match code.byte() {
                    0 => next(code),
                    1 => -next(code),
                    sign => panic!("no sign {sign}"),
                };
                (0..code.count()).map(|_| addend(code)).sum()
            }
            4 => (0..code.count()).map(|_| next(code)).product(),
            5 => next(code) * next(code) + next(code),
            6 => -(next(code) * next(code)) + next(code),
            7 => next(code) / next(code),
            8 => next(code).powf(next(code)),
            9 => next(code).atan2(next(code)),
            22 => next(code).apply(Function::RecipOrZero),
            23 => {
                let order = u32::try_from(code.count()).expect("a small number");
                next(code).apply(Function::AngleOverSine(order))
            }
            24 => next(code).choose(&next(code), &next(code)),
            kind => {
                let elementary = [
                    f64::sqrt,
                    f64::exp,
                    f64::ln,
                    f64::sin,
                    f64::cos,
                    f64::tan,
                    f64::asin,
                    f64::acos,
                    f64::atan,
                    f64::sinh,
                    f64::cosh,
                    f64::tanh,
                ];
                elementary[usize::from(kind) - 10](next(code))
            }
        }
    }
}

/// What is still to be read.
struct Code<'a>(&'a [u8]);

impl Code<'_> {
    fn byte(&mut self) -> u8 {
        let (&byte, rest) = self.0.split_first().expect("a byte");
        self.0 = rest;
        byte
    }

    fn count(&mut self) -> usize {
        let byte = self.byte();
        let low = usize::from(byte % 128);
        if byte < 128 { low } else { low + 128 * self.count() }
    }

    fn places(&mut self) -> Vec<usize> {
        (0..self.count()).map(|_| self.count()).collect()
    }

    fn number(&mut self) -> f64 {
        f64::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }
}

/// The library runs what the generator writes: both have the numbers of operations to the letter.
#[test]
fn operations_have_the_numbers_that_the_library_knows() {
    let kinds = |path: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let text = std::fs::read_to_string(path).expect("a source");
        let (_, module) = text.split_once("\nmod kind {\n").expect("the kinds of terms");
        module.split_once("\n}\n").expect("its end").0.to_owned()
    };
    assert_eq!(kinds("src/emit/bytes.rs"), kinds("../runtime/src/bytecode.rs"));
}
