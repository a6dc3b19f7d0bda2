//! Straight-line code as C.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::names::{places, value};
use crate::program::{
    Argument, Elementary, Function, Input, Interface, RecordKind, Statement, Term, Value, Values,
};
use crate::quantity::ScalarType;

/// How operations are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arithmetic {
    /// With operators, on numbers.
    Plain,
    /// With calls, on numbers that carry bounds of their errors.
    Bounded,
}

/// What code is written with.
#[derive(Clone, Copy)]
pub(super) struct Spelling<'s> {
    /// The system's prefix, without an underscore at the end.
    pub(super) prefix: &'s str,
    pub(super) scalar: ScalarType,
    pub(super) interface: &'s Interface,
    /// How many Stumpff functions are computed together wherever there are any, if these are always as many: code that is there once.
    pub(super) family: Option<usize>,
    /// The values of the constants.
    pub(super) constants: &'s [f64],
}

/// How tightly an operator binds.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Unary,
}

impl Spelling<'_> {
    /// A number of the scalar type.
    pub(super) fn number(&self, x: f64) -> String {
        match (self.scalar, x.is_finite()) {
            (ScalarType::F64, true) => format!("{x:?}"),
            (ScalarType::F32, true) => format!("{:?}f", x as f32),
            (ScalarType::F64, false) => "NAN".to_owned(),
            (ScalarType::F32, false) => "(float)NAN".to_owned(),
        }
    }

    /// A function of the standard library.
    pub(super) fn math(&self, name: &str) -> String {
        match self.scalar {
            ScalarType::F64 => name.to_owned(),
            ScalarType::F32 => format!("{name}f"),
        }
    }

    /// Corrections up to here may be rounding where they make a residual no smaller, if that is not looked at.
    pub(super) fn stall(&self) -> f64 {
        if self.scalar == ScalarType::F64 { 1e-6 } else { 1e-3 }
    }

    /// The type of a value.
    fn type_of(&self, arithmetic: Arithmetic) -> String {
        match arithmetic {
            Arithmetic::Plain => format!("{}_real", self.prefix),
            Arithmetic::Bounded => format!("{}_bounded", self.prefix),
        }
    }

    /// What a function takes from its arguments, and computes: declarations of all values that it needs for the results.
    pub(super) fn body<R>(
        &self,
        module: &Values,
        function: &Function<R>,
        arithmetic: Arithmetic,
        results: &[&[Term]],
    ) -> String {
        let needed = needed(module, function, arithmetic, results);
        let mut code = String::new();
        let declared = self.type_of(arithmetic);
        for argument in &function.arguments {
            for (source, place) in self.sources(module, argument).into_iter().zip(&argument.values) {
                let Some(place) = place.filter(|place| needed.contains(place)) else { continue };
                let source = match (arithmetic, argument.input) {
                    (Arithmetic::Plain, _) => source,
                    (Arithmetic::Bounded, Input::Unknown) => format!("{}_nearest({source})", self.prefix),
                    (Arithmetic::Bounded, _) => format!("{}_exactly({source})", self.prefix),
                };
                _ = writeln!(code, "    const {declared} {} = {source};", value(module, place));
            }
        }
        for statement in &function.statements {
            match statement {
                Statement::Let { value: place, term } if needed.contains(place) => {
                    let term = self.term(module, term, arithmetic);
                    _ = writeln!(code, "    const {declared} {} = {term};", value(module, *place));
                }
                Statement::Stumpff { values, argument }
                    if values.iter().flatten().any(|value| needed.contains(value)) =>
                {
                    let used = values.iter().flatten().copied().filter(|value| needed.contains(value));
                    let first = used.map(|place| value(module, place)).next().unwrap_or_default();
                    let (family, n) = (format!("family_of_{first}"), self.family.unwrap_or(values.len()));
                    let function = match arithmetic {
                        Arithmetic::Plain => format!("{}_stumpff_{n}", self.prefix),
                        Arithmetic::Bounded => format!("{}_bounded_stumpff_{n}", self.prefix),
                    };
                    let argument = self.term(module, argument, arithmetic);
                    _ = writeln!(code, "    const {function}_family {family} = {function}({argument});");
                    for (k, place) in values.iter().enumerate() {
                        let Some(place) = place.filter(|place| needed.contains(place)) else { continue };
                        _ = writeln!(
                            code,
                            "    const {declared} {} = {family}.c[{k}];",
                            value(module, place)
                        );
                    }
                }
                _ => {}
            }
        }
        code
    }

    /// Where the components of an argument stand.
    pub(super) fn sources(&self, module: &Values, argument: &Argument) -> Vec<String> {
        let interface = self.interface;
        let n = argument.values.len();
        let flat = |name: &str| (0..n).map(|k| format!("{name}[{k}]")).collect();
        let of =
            |name: &str, all: Vec<String>| all.into_iter().map(|place| format!("{name}->{place}")).collect();
        let record = |name: &str, kind| {
            module.fields(kind).iter().map(|field| format!("{name}{}", value(module, *field))).collect()
        };
        match argument.input {
            Input::Parameters => {
                let mut all: Vec<String> = of("parameters", places(&interface.parameters));
                all.extend(self.constants.iter().map(|value| self.number(*value)));
                all
            }
            Input::State => of("state", places(&interface.state)),
            Input::Control => of("control", places(&interface.controls)),
            Input::StepSize => vec!["step_size".to_owned()],
            Input::Time => vec!["time".to_owned()],
            Input::Unknown => flat("unknown"),
            Input::Residual => flat("evaluation->residual"),
            Input::Right => flat("evaluation->right"),
            Input::Record(RecordKind::Constants) => record("equation->constants->", RecordKind::Constants),
            Input::Record(RecordKind::Step) => record("equation->begun.", RecordKind::Step),
            Input::Record(RecordKind::Iterate) => record("evaluation->", RecordKind::Iterate),
            Input::Record(RecordKind::Point) => record("point->", RecordKind::Point),
            Input::Velocity => flat("velocity"),
            Input::Conserved => flat("conserved"),
            Input::Tangent => flat("by"),
            Input::StatePerturbation
            | Input::ControlPerturbation
            | Input::ParameterPerturbation
            | Input::Costate => flat("by"),
            // power series are in no header
            Input::Coefficients | Input::Sums | Input::Order | Input::End => Vec::new(),
        }
    }

    /// A term as an expression.
    pub(super) fn term(&self, module: &Values, term: &Term, arithmetic: Arithmetic) -> String {
        match arithmetic {
            Arithmetic::Plain => self.bound(module, term, Binding::Sum),
            Arithmetic::Bounded => self.called(module, term),
        }
    }

    /// The term with operators, in parentheses if what is around binds more tightly.
    fn bound(&self, module: &Values, term: &Term, around: Binding) -> String {
        let within = |term: &Term, around| self.bound(module, term, around);
        let open = |term: &Term| self.bound(module, term, Binding::Sum);
        let prefix = self.prefix;
        let (text, binding) = match term {
            Term::Number(number) => {
                let x = number.as_emitted();
                (self.number(x), if x < 0.0 { Binding::Product } else { Binding::Unary })
            }
            Term::Value(place) => (value(module, *place), Binding::Unary),
            Term::Negative(x) => (format!("-{}", within(x, Binding::Unary)), Binding::Product),
            Term::Sum(addends) => {
                let mut text = String::new();
                for (place, (negative, addend)) in addends.iter().enumerate() {
                    // the grouping of a sum within a sum is meant
                    let addend = within(addend, Binding::Product);
                    text += match (place, negative) {
                        (0, false) => "",
                        (0, true) => "-",
                        (_, false) => " + ",
                        (_, true) => " - ",
                    };
                    // `- -x` is no decrement
                    text +=
                        &if *negative && addend.starts_with('-') { format!("({addend})") } else { addend };
                }
                (text, Binding::Sum)
            }
            Term::Product(factors) => {
                let factors: Vec<String> =
                    factors.iter().map(|factor| within(factor, Binding::Unary)).collect();
                (factors.join(" * "), Binding::Product)
            }
            // two roundings, unless the compiler contracts them
            Term::MulAdd { negative, a, b, addend } => {
                let sign = if *negative { '-' } else { '+' };
                let addend = within(addend, Binding::Product);
                (
                    format!("{addend} {sign} {} * {}", within(a, Binding::Unary), within(b, Binding::Unary)),
                    Binding::Sum,
                )
            }
            Term::Quotient(x, y) => {
                (format!("{} / {}", within(x, Binding::Product), within(y, Binding::Unary)), Binding::Product)
            }
            Term::Function(function, x) => {
                (format!("{}({})", self.function(*function), open(x)), Binding::Unary)
            }
            Term::Power(x, y) => (format!("{}({}, {})", self.math("pow"), open(x), open(y)), Binding::Unary),
            Term::Atan2(y, x) => {
                (format!("{}({}, {})", self.math("atan2"), open(y), open(x)), Binding::Unary)
            }
            Term::Choice([x, y, z]) => {
                (format!("{prefix}_choose({}, {}, {})", open(x), open(y), open(z)), Binding::Unary)
            }
        };
        if binding < around { format!("({text})") } else { text }
    }

    /// The name of a function of one number.
    fn function(&self, function: Elementary) -> String {
        match function {
            Elementary::Ln => self.math("log"),
            Elementary::RecipOrZero => format!("{}_recip_or_zero", self.prefix),
            Elementary::AngleOverSine(order) => format!("{}_angle_over_sine_{order}", self.prefix),
            other => self.math(&other.name()),
        }
    }

    /// The term with calls.
    fn called(&self, module: &Values, term: &Term) -> String {
        let of = |term: &Term| self.called(module, term);
        let call = |name: &str, operands: &[String]| {
            format!("{}_bounded_{name}({})", self.prefix, operands.join(", "))
        };
        match term {
            Term::Number(number) => format!("{}_exactly({})", self.prefix, self.number(number.as_emitted())),
            Term::Value(place) => value(module, *place),
            Term::Negative(x) => call("negative", &[of(x)]),
            Term::Sum(addends) => {
                let mut addends = addends.iter();
                let first = addends.next().map_or_else(String::new, |(_, first)| of(first));
                addends.fold(first, |sum, (negative, addend)| {
                    call(if *negative { "sub" } else { "add" }, &[sum, of(addend)])
                })
            }
            Term::Product(factors) => factors
                .iter()
                .map(of)
                .reduce(|product, factor| call("mul", &[product, factor]))
                .unwrap_or_default(),
            Term::MulAdd { negative, a, b, addend } => {
                let product = call("mul", &[of(a), of(b)]);
                call(if *negative { "sub" } else { "add" }, &[of(addend), product])
            }
            Term::Quotient(x, y) => call("div", &[of(x), of(y)]),
            Term::Function(Elementary::AngleOverSine(order), x) => {
                call(&format!("angle_over_sine_{order}"), &[of(x)])
            }
            Term::Function(function, x) => call(&function.name(), &[of(x)]),
            Term::Power(x, y) => call("powf", &[of(x), of(y)]),
            Term::Atan2(y, x) => call("atan2", &[of(y), of(x)]),
            Term::Choice([x, y, z]) => call("choose", &[of(x), of(y), of(z)]),
        }
    }
}

/// The values that results are made of, and, of all that a function returns, its record.
fn needed<R>(
    module: &Values,
    function: &Function<R>,
    arithmetic: Arithmetic,
    results: &[&[Term]],
) -> BTreeSet<Value> {
    let mut needed = BTreeSet::new();
    results
        .iter()
        .flat_map(|array| array.iter())
        .for_each(|term| term.values(&mut |value| _ = needed.insert(value)));
    if let (Arithmetic::Plain, Some(kind)) = (arithmetic, function.record) {
        needed.extend(module.fields(kind));
    }
    for statement in function.statements.iter().rev() {
        match statement {
            Statement::Let { value, term } if needed.contains(value) => {
                term.values(&mut |value| _ = needed.insert(value));
            }
            Statement::Stumpff { values, argument }
                if values.iter().flatten().any(|value| needed.contains(value)) =>
            {
                argument.values(&mut |value| _ = needed.insert(value));
            }
            _ => {}
        }
    }
    needed
}

/// Whether a function uses anything of an argument.
pub(super) fn uses<R>(function: &Function<R>, input: Input) -> bool {
    function
        .arguments
        .iter()
        .any(|argument| argument.input == input && argument.values.iter().any(Option::is_some))
}

/// The special functions of some code: how many Stumpff functions are computed together, and which derivatives of `θ / sin θ`.
#[derive(Debug, Default)]
pub(super) struct Special {
    pub(super) families: BTreeSet<usize>,
    pub(super) angles: BTreeSet<u32>,
    pub(super) functions: BTreeSet<String>,
}

impl Special {
    /// Notes what a function calls.
    pub(super) fn note<R>(&mut self, function: &Function<R>) {
        for statement in &function.statements {
            match statement {
                Statement::Let { term, .. } => self.term(term),
                Statement::Stumpff { values, argument } => {
                    self.families.insert(values.len());
                    self.term(argument);
                }
            }
        }
        function.results.iter().flatten().for_each(|term| self.term(term));
    }

    fn term(&mut self, term: &Term) {
        match term {
            Term::Function(Elementary::AngleOverSine(order), _) => _ = self.angles.insert(*order),
            Term::Function(function, _) => _ = self.functions.insert(function.name()),
            Term::Power(..) => _ = self.functions.insert("powf".to_owned()),
            Term::Atan2(..) => _ = self.functions.insert("atan2".to_owned()),
            Term::Choice(_) => _ = self.functions.insert("choose".to_owned()),
            _ => {}
        }
        term.operands().into_iter().for_each(|operand| self.term(operand));
    }
}
