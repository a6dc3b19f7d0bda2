//! Straight-line code as Rust.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{ToTokens, format_ident, quote};

use super::docs;
use crate::expr::Number;
use crate::program::{
    Argument, Elementary, Function, FunctionRole, Input, RecordKind, Statement, Term, Value, Values,
};

/// An array's length, without a suffix.
pub(super) fn size(length: usize) -> Literal {
    Literal::usize_unsuffixed(length)
}

/// For what a step is made of. It is always inlined, so that it is compiled for the processor that its caller is
/// compiled for; but not where it is compiled for debugging, which would take half as long again.
pub(super) fn inlined() -> TokenStream {
    quote! { #[cfg_attr(not(debug_assertions), inline(always))] }
}

/// Words that generated functions use for themselves, and the language's.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "state", "step", "unknown", "evaluation", "point", "costate", "through", "columns", "parameters", "time", "control", "by", "spatial", "velocity", "right", "coefficients", "sums", "order", "end",
    "operands",
    "self", "super", "crate", "as", "async", "await", "break", "const", "continue", "dyn", "else", "enum", "extern", "false", "fn", "for", "if",
    "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "static", "struct", "trait", "true", "type", "unsafe",
    "use", "where", "while", "yield", "abstract", "become", "box", "do", "final", "gen", "macro", "override", "priv", "try", "typeof", "unsized",
    "virtual",
];

/// A value's identifier, of the kernel's own making. Reserved words get an underscore more, and so does what would then
/// be called alike.
fn ident(module: &Values, value: Value) -> Ident {
    let name = module.name(value);
    let is_reserved = RESERVED.contains(&name.trim_end_matches('_'));
    let name = if is_reserved { format!("{name}_") } else { name.to_owned() };
    Ident::new(&name, Span::mixed_site())
}

/// A free function of arrays and, where it is given, the time:
/// `fn name<T: Scalar>(parameters: &[T; P], state: &[T; S], time: T) -> [T; N] { … }`
pub(super) fn free_function<R>(
    name: &str,
    private: &TokenStream,
    module: &Values,
    function: &Function<R>,
) -> TokenStream {
    let name = format_ident!("{name}");
    let count = size(function.results.iter().map(Vec::len).sum());
    let arguments = arguments(function);
    let body = body(module, function);
    let results = arrays(module, function);
    quote! {
        #[inline]
        fn #name<T: #private::Scalar>(#(#arguments),*) -> [T; #count] {
            #body
            #(#results)*
        }
    }
}

/// The arguments of a function as it declares them.
pub(super) fn arguments<R>(function: &Function<R>) -> Vec<TokenStream> {
    let argument = |Argument { input, values }: &Argument| {
        let (name, n) = (argument_name(*input), size(values.len()));
        Some(match input {
            Input::Record(RecordKind::Constants) => quote! { &self },
            Input::Record(RecordKind::Step) => quote! { step: &Self::Step },
            Input::Record(RecordKind::Point) => quote! { point: &Self::Point },
            // one argument has the three of them
            Input::Residual | Input::Right => return None,
            Input::Record(RecordKind::Iterate) => {
                let n = size(function.length(Input::Unknown));
                quote! { evaluation: &Evaluation<[T; #n], Self::Iterate> }
            }
            Input::Time | Input::StepSize | Input::Order => quote! { #name: T },
            _ => quote! { #name: &[T; #n] },
        })
    };
    function.arguments.iter().filter_map(argument).collect()
}

/// A function as a method with this signature and these results.
pub(super) fn method<R: FunctionRole>(
    module: &Values,
    function: &Function<R>,
    signature: &TokenStream,
    result: &TokenStream,
) -> TokenStream {
    let doc = docs::line(&format!("{}: {}.", function.role.signature().purpose, function.operations()));
    let (inlined, body) = (inlined(), body(module, function));
    quote! {
        #doc
        #inlined
        #signature {
            #body
            #result
        }
    }
}

/// The name of an argument.
fn argument_name(input: Input) -> Ident {
    let name = match input {
        Input::Parameters | Input::ParameterPerturbation => "parameters",
        Input::StepSize | Input::Record(RecordKind::Step) => "step",
        Input::State | Input::StatePerturbation => "state",
        Input::Time => "time",
        Input::Control | Input::ControlPerturbation => "control",
        Input::Unknown => "unknown",
        Input::Residual | Input::Right | Input::Record(RecordKind::Iterate) => "evaluation",
        Input::Record(RecordKind::Constants) => "self",
        Input::Record(RecordKind::Point) => "point",
        Input::Costate => "costate",
        Input::Tangent => "by",
        Input::Conserved => "conserved",
        Input::Velocity => "velocity",
        Input::Coefficients => "coefficients",
        Input::Sums => "sums",
        Input::Order => "order",
        Input::End => "end",
    };
    Ident::new(name, Span::call_site())
}

/// What a function needs of its arguments, and what it computes.
fn body<R>(module: &Values, function: &Function<R>) -> TokenStream {
    let unpacked = function.arguments.iter().map(|argument| unpacked(module, argument));
    if function.statements.len() > MANY {
        let statements = function.statements.chunks(TOGETHER).map(|lines| declared_together(module, lines));
        return quote! { #(#unpacked)* #(#statements)* };
    }
    let statements = function.statements.iter().map(|line| statement(module, line, &quote! { let }));
    quote! { #(#unpacked)* #(#statements)* }
}

/// More statements than a function may have for each to declare its variable: every `let` is a scope within the one
/// before, and rustc goes into scopes by recursion when it writes debug information. Ten thousand are too many for its
/// stack.
const MANY: usize = 1_500;
/// So many are then declared by one `let`.
const TOGETHER: usize = 250;

/// `let (x, y, …,); x = …; y = …; …`
fn declared_together(module: &Values, lines: &[Statement]) -> TokenStream {
    let names = lines.iter().filter_map(|line| match line {
        Statement::Let { value, .. } => Some(ident(module, *value)),
        Statement::Stumpff { .. } => None,
    });
    let statements = lines.iter().map(|line| statement(module, line, &TokenStream::new()));
    quote! { let (#(#names,)*); #(#statements)* }
}

/// `let [_, momentum_x, ..] = *state;`, `let [weight_half_h, ..] = self.0;`, `let h = step;` with the names that are
/// used.
fn unpacked(module: &Values, argument: &Argument) -> TokenStream {
    let Argument { input, values } = argument;
    let Some(last) = values.iter().rposition(Option::is_some) else { return quote! {} };
    let name = argument_name(*input);
    let used: Vec<Ident> = values.iter().flatten().map(|&value| ident(module, value)).collect();
    let from = match input {
        Input::StepSize | Input::Time | Input::Order => return quote! { #(let #used = #name;)* },
        Input::Residual => quote! { evaluation.residual },
        Input::Right => quote! { evaluation.right },
        Input::Record(RecordKind::Iterate) => quote! { evaluation.iterate },
        Input::Record(RecordKind::Constants) => quote! { self.0 },
        _ => quote! { *#name },
    };
    let patterns = values[..=last].iter().map(|value| pattern(module, *value));
    // there may be more sums than are used
    let rest = (last + 1 < values.len() || *input == Input::Sums).then(|| quote! { , .. });
    quote! { let [#(#patterns),* #rest] = #from; }
}

/// A name for a value, if it is used.
fn pattern(module: &Values, value: Option<Value>) -> TokenStream {
    value.map_or_else(|| quote! { _ }, |value| ident(module, value).into_token_stream())
}

/// The type of a record: an array of as many numbers.
pub(super) fn record(module: &Values, kind: RecordKind) -> TokenStream {
    let length = size(module.fields(kind).len());
    quote! { [T; #length] }
}

/// The array of a record's fields.
pub(super) fn kept(module: &Values, kind: RecordKind) -> TokenStream {
    let fields = module.fields(kind).iter().map(|&field| ident(module, field));
    quote! { [#(#fields),*] }
}

/// The arrays that a function returns.
pub(super) fn arrays<R>(module: &Values, function: &Function<R>) -> Vec<TokenStream> {
    function.results.iter().map(|results| array(module, results)).collect()
}

/// `[x, y, …]`
pub(super) fn array(module: &Values, results: &[Term]) -> TokenStream {
    let results = results.iter().map(|result| term(module, result));
    quote! { [#(#results),*] }
}

/// One line; what it computes alone is declared where it is not yet.
fn statement(module: &Values, statement: &Statement, declared: &TokenStream) -> TokenStream {
    match statement {
        Statement::Let { value, term: value_of } => {
            let (name, value) = (ident(module, *value), term(module, value_of));
            quote! { #declared #name = #value; }
        }
        Statement::Stumpff { values, argument } => {
            let names = values.iter().map(|value| pattern(module, *value));
            let argument = term(module, argument);
            quote! { let [#(#names),*] = T::stumpff(#argument); }
        }
    }
}

/// How tightly an operator binds.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Unary,
}

/// A term as an expression.
pub(super) fn term(module: &Values, value: &Term) -> TokenStream {
    bound(module, value, Binding::Sum)
}

/// The term, in parentheses if what is around binds more tightly.
fn bound(module: &Values, value: &Term, around: Binding) -> TokenStream {
    let within = |term: &Term, around| bound(module, term, around);
    let (tokens, binding) = match value {
        Term::Number(number) => (constant(*number), Binding::Unary),
        Term::Value(value) => (ident(module, *value).into_token_stream(), Binding::Unary),
        Term::Negative(x) => {
            let x = within(x, Binding::Unary);
            (quote! { -#x }, Binding::Product)
        }
        Term::Sum(addends) => (sum(module, addends), Binding::Sum),
        Term::Product(factors) => (product(module, factors), Binding::Product),
        Term::MulAdd { negative, a, b, addend } => {
            let (a, b, addend) = (within(a, Binding::Unary), within(b, Binding::Sum), term(module, addend));
            let method = if *negative { format_ident!("neg_mul_add") } else { format_ident!("mul_add") };
            (quote! { #a.#method(#b, #addend) }, Binding::Unary)
        }
        Term::Quotient(x, y) => {
            let (x, y) = (within(x, Binding::Product), within(y, Binding::Unary));
            (quote! { #x / #y }, Binding::Product)
        }
        Term::Function(Elementary::AngleOverSine(k), x) => {
            let (k, x) = (Literal::u32_unsuffixed(*k), within(x, Binding::Sum));
            (quote! { T::angle_over_sine::<#k>(#x) }, Binding::Unary)
        }
        Term::Function(function, x) => {
            let (name, x) = (format_ident!("{}", function.name()), within(x, Binding::Sum));
            (quote! { T::#name(#x) }, Binding::Unary)
        }
        Term::Power(x, y) => {
            let (x, y) = (term(module, x), term(module, y));
            (quote! { T::powf(#x, #y) }, Binding::Unary)
        }
        Term::Atan2(y, x) => {
            let (y, x) = (term(module, y), term(module, x));
            (quote! { T::atan2(#y, #x) }, Binding::Unary)
        }
        Term::Choice(operands) => {
            let operands = operands.iter().map(|operand| term(module, operand));
            (quote! { T::if_negative(#(#operands),*) }, Binding::Unary)
        }
    };
    if binding < around {
        quote! { (#tokens) }
    } else {
        tokens
    }
}

/// `a + b − …`
fn sum(module: &Values, addends: &[(bool, Term)]) -> TokenStream {
    // the grouping of a sum within a sum is meant
    let addend = |(negative, addend): &(bool, Term)| (*negative, bound(module, addend, Binding::Product));
    addends.iter().map(addend).fold(TokenStream::new(), |sum, (negative, addend)| {
        match (sum.is_empty(), negative) {
            (true, false) => addend,
            (true, true) => quote! { -#addend },
            (false, false) => quote! { #sum + #addend },
            (false, true) => quote! { #sum - #addend },
        }
    })
}

/// `a * b * …`
fn product(module: &Values, factors: &[Term]) -> TokenStream {
    let factors = factors.iter().map(|factor| bound(module, factor, Binding::Unary));
    factors.reduce(|product, factor| quote! { #product * #factor }).unwrap_or_default()
}

/// `T::of(0.5)`; fractions that are not doubles are left to the compiler to round.
fn constant(number: Number) -> TokenStream {
    if number == Number::FOUR_PI_SQUARED {
        return quote! { T::of(::core::f64::consts::TAU * ::core::f64::consts::TAU) };
    }
    let value = number.to_f64();
    let float = |x: f64| {
        let literal = Literal::f64_unsuffixed(x.abs());
        if x < 0.0 {
            quote! { -#literal }
        } else {
            quote! { #literal }
        }
    };
    match number.wide_fraction() {
        Some([numerator, denominator]) => {
            let (numerator, denominator) = (float(numerator), float(denominator));
            quote! { T::of(#numerator / #denominator) }
        }
        None if value.is_finite() => {
            let value = float(value);
            quote! { T::of(#value) }
        }
        None => quote! { T::of(::core::primitive::f64::NAN) },
    }
}
