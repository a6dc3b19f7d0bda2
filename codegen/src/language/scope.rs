//! The names that an expression may use.

use quote::ToTokens;
use syn::ext::IdentExt;

use super::value::Value;
use crate::expr::{Arena, Expr, Stage};
use crate::parse::OwnFunction;

/// The names known to an expression from outside, and the constants of the user's own that it was found to use.
#[derive(Debug, Default)]
pub struct Scope<'a> {
    /// `None` for a name whose declaration was in error: using it is no further error.
    names: Vec<(String, Option<Value<'a>>)>,
    /// The names that expressions were found to use.
    used: Vec<String>,
    /// Names that the next expression may not use, with what to say to it.
    forbidden: Vec<(String, String)>,
    /// In the order in which they were met.
    pub constants: Vec<Constant<'a>>,
    /// The functions of the user's own.
    pub functions: Vec<OwnFunction>,
}

/// A constant that only the user's code knows: `std::f64::consts::PI`, `GRAVITY`. It is a parameter like any other,
/// whose value is that of its path where the macro is used.
#[derive(Clone, Debug)]
pub struct Constant<'a> {
    /// Its symbol in the symbolic value.
    pub symbol: Expr<'a>,
    /// The path, to be evaluated in the user's own scope.
    pub tokens: syn::Expr,
    /// The symbol's name, which no other symbol of the scope has.
    pub name: String,
}

impl Constant<'_> {
    /// The path as it is usually written: with spaces between words alone.
    pub fn path(&self) -> String {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        self.tokens.to_token_stream().into_iter().fold(String::new(), |mut text, token| {
            let token = token.to_string();
            if text.ends_with(is_part) && token.starts_with(is_part) {
                text.push(' ');
            }
            text + &token
        })
    }
}

impl<'a> Scope<'a> {
    /// A scope without names.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a name. A later one hides an earlier one.
    pub fn define(&mut self, name: impl Into<String>, value: Value<'a>) {
        self.names.push((name.into(), Some(value)));
    }

    /// Adds an element to the array of a name; the first one adds the name.
    pub fn define_element(&mut self, name: &str, value: Value<'a>) {
        match self.names.iter_mut().rev().find(|(known, _)| known == name) {
            Some((_, Some(Value::Array(values)))) => values.push(value),
            _ => self.define(name, Value::Array(vec![value])),
        }
    }

    /// Adds a name whose value is not known because of an error that was reported.
    pub fn define_unknown(&mut self, name: impl Into<String>) {
        self.names.push((name.into(), None));
    }

    /// Forbids names to the expressions that follow, with messages for those that use them; the first message on a name
    /// counts.
    pub fn forbid(&mut self, names: Vec<(String, String)>) {
        self.forbidden = names;
    }

    /// The message to an expression that uses a forbidden name.
    pub(super) fn forbidden(&self, name: &str) -> Option<&str> {
        self.forbidden.iter().find(|(forbidden, _)| forbidden == name).map(|(_, message)| message.as_str())
    }

    /// Takes note that an expression uses a name.
    pub(super) fn mark_used(&mut self, name: &str) {
        if !self.is_used(name) {
            self.used.push(name.to_owned());
        }
    }

    /// Whether an expression was found to use a name.
    pub fn is_used(&self, name: &str) -> bool {
        self.used.iter().any(|used| used == name)
    }

    /// The value of a name, or `None` within if it is not known because of an error that was reported.
    pub fn get(&self, name: &str) -> Option<&Option<Value<'a>>> {
        self.names.iter().rev().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// All names, in the order in which they were defined.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(|(name, _)| name.as_str()).filter(|name| self.forbidden(name).is_none())
    }

    /// The symbol of a constant, the same one each time it is named by the same path.
    pub(super) fn constant(&mut self, path: syn::ExprPath, arena: &'a Arena) -> Expr<'a> {
        let tokens = syn::Expr::Path(path.clone());
        if let Some(known) = self.constants.iter().find(|known| known.tokens == tokens) {
            return known.symbol;
        }
        let name = self.unused_name(&path, arena);
        let symbol = arena.symbol(&name, Stage::Parameters);
        self.constants.push(Constant { symbol, tokens, name });
        symbol
    }

    /// A name for a constant's symbol: `const_` and the last segment of its path, or more of them if that is taken. In
    /// lower case, as a variable of the constant's own name would be taken for the constant where it is bound.
    fn unused_name(&self, path: &syn::ExprPath, arena: &Arena) -> String {
        let values = self.names.iter().filter_map(|(_, value)| value.as_ref());
        let symbols = values.flat_map(Value::scalars).filter_map(Expr::as_symbol);
        let mut taken: Vec<String> = symbols.map(|symbol| arena.symbol_info(symbol).name).collect();
        taken.extend(self.constants.iter().map(|known| known.name.clone()));

        let segments = path.path.segments.iter();
        let segments: Vec<String> = segments.map(|s| s.ident.unraw().to_string().to_lowercase()).collect();
        let mut name = "const".to_owned();
        for segment in segments.iter().rev() {
            name = format!("{name}_{segment}");
            if !taken.contains(&name) {
                return name;
            }
        }
        while taken.contains(&name) {
            name.push('_');
        }
        name
    }
}
