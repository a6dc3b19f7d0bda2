//! What things are called in C.

use std::fmt::Write as _;

use crate::program::{Quantity, Value, Values};

/// Words that generated functions use for themselves.
const OWN: &[&str] = &[
    "equation",
    "unknown",
    "evaluation",
    "parameters",
    "step_size",
    "state",
    "time",
    "control",
    "next",
    "result",
    "point",
    "velocity",
    "conserved",
    "momentum_given",
    "constants",
    "residual",
    "right",
    "bound",
    "i",
    "none",
];

/// Words of C, of C++ and of GPUs' dialects, and names of the standard library's that code here calls, or that are macros.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "float", "for", "goto", "if", "inline",
    "int", "long", "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch", "typedef", "union", "unsigned", "void",
    "volatile", "while", "asm", "typeof", "alignas", "alignof", "and", "and_eq", "bitand", "bitor", "bool", "catch", "char8_t", "char16_t", "char32_t",
    "class", "compl", "concept", "consteval", "constexpr", "constinit", "const_cast", "co_await", "co_return", "co_yield", "decltype", "delete",
    "dynamic_cast", "explicit", "export", "false", "friend", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or",
    "or_eq", "private", "protected", "public", "reinterpret_cast", "requires", "static_assert", "static_cast", "template", "this", "thread_local",
    "throw", "true", "try", "typeid", "typename", "using", "virtual", "wchar_t", "xor", "xor_eq",
    "threadIdx", "blockIdx", "blockDim", "gridDim", "warpSize", "linux", "unix", "NULL", "NAN", "INFINITY", "HUGE_VAL", "HUGE_VALF", "HUGE_VALL", "DOMAIN",
    "SING", "OVERFLOW", "UNDERFLOW", "PLOSS", "TLOSS", "EDOM", "ERANGE", "errno", "assert", "fabs", "sqrt", "exp", "log", "sin", "cos", "tan", "asin",
    "acos", "atan", "sinh", "cosh", "tanh", "pow", "atan2", "hypot", "isnan", "isinf", "isfinite", "isnormal", "signbit", "fpclassify", "isgreater",
    "isgreaterequal", "isless", "islessequal", "islessgreater", "isunordered", "math_errhandling", "signgam",
];

/// An identifier: letters that C has not are their numbers. Words that are taken get an underscore more, and so does what would then be called
/// alike; names that are the implementation's get a letter before.
pub(super) fn ident(name: &str) -> String {
    let mut ascii = String::new();
    for letter in name.chars() {
        match letter.is_ascii_alphanumeric() || letter == '_' {
            true => ascii.push(letter),
            false => _ = write!(ascii, "u{:x}_", u32::from(letter)),
        }
    }
    let bare = ascii.trim_end_matches('_');
    let is_macro = ["M_", "FP_", "HUGE_", "MATH_"].iter().any(|start| bare.starts_with(start));
    if is_macro || RESERVED.contains(&bare) || OWN.contains(&bare) {
        ascii.push('_');
    }
    let is_reserved =
        ascii.strip_prefix('_').is_some_and(|rest| rest.starts_with(|c: char| c == '_' || c.is_uppercase()));
    if is_reserved { format!("x{ascii}") } else { ascii }
}

/// A value's identifier.
pub(super) fn value(module: &Values, value: Value) -> String {
    ident(module.name(value))
}

/// `heavy_top` for `HeavyTop`, `heavy_top_on_se3` for `HeavyTopOnSE3`.
pub(super) fn snake_case(name: &str) -> String {
    let (mut snake, mut before) = (String::new(), '_');
    for letter in name.chars() {
        if letter.is_uppercase() && !before.is_uppercase() && before != '_' {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
        before = letter;
    }
    ident(&snake)
}

/// Where each component of some quantities stands in their struct: `attitude[0]`, `spins[1][2]`.
pub(super) fn places(quantities: &[Quantity]) -> Vec<String> {
    let of = |quantity: &Quantity| {
        let mut field = ident(quantity.field());
        if let Some(element) = &quantity.element {
            field += &format!("[{}]", element.index);
        }
        match quantity.components.len() {
            1 => vec![field],
            n => (0..n).map(|k| format!("{field}[{k}]")).collect(),
        }
    };
    quantities.iter().flat_map(of).collect()
}
