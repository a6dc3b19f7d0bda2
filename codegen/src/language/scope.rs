//! The names that an expression may use.

use quote::ToTokens;

use super::value::Value;
use crate::expr::{Arena, Expr, Stage};

/// The names known to an expression from outside, and the constants of the user's own that it was found to use.
#[derive(Debug, Default)]
pub struct Scope<'a> {
    /// `None` for a name whose declaration was in error: using it is no further error.
    names: Vec<(String, Option<Value<'a>>)>,
    /// In the order in which they were met.
    pub constants: Vec<Constant<'a>>,
}

/// A constant that only the user's code knows: `std::f64::consts::PI`, `GRAVITY`. It is a parameter like any other, whose
/// value is that of its path where the macro is used.
#[derive(Clone, Debug)]
pub struct Constant<'a> {
    /// What stands for it in the symbolic value.
    pub symbol: Expr<'a>,
    /// The path, to be evaluated in the user's own scope.
    pub tokens: syn::Expr,
    /// The symbol's name, which no other name of the scope equals.
    pub name: String,
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

    /// Adds a name whose value is not known because of an error that was reported.
    pub fn define_unknown(&mut self, name: impl Into<String>) {
        self.names.push((name.into(), None));
    }

    /// The value of a name, or `None` within if it is not known because of an error that was reported.
    pub fn get(&self, name: &str) -> Option<&Option<Value<'a>>> {
        self.names.iter().rev().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// All names, in the order in which they were defined.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(|(name, _)| name.as_str())
    }

    /// The symbol of a constant, the same one each time it is named by the same path.
    pub(super) fn constant(&mut self, path: &syn::ExprPath, arena: &'a Arena) -> Expr<'a> {
        let tokens = syn::Expr::Path(path.clone());
        if let Some(known) = self.constants.iter().find(|known| known.tokens == tokens) {
            return known.symbol;
        }
        let name = self.unused_name(path);
        let symbol = arena.symbol(&name, Stage::Parameters);
        self.constants.push(Constant { symbol, tokens, name });
        symbol
    }

    /// The last segment of a path, or more of them if that is taken.
    fn unused_name(&self, path: &syn::ExprPath) -> String {
        let segments: Vec<String> =
            path.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        let taken = |name: &String| {
            self.names().any(|known| known == name) || self.constants.iter().any(|known| known.name == *name)
        };
        let endings = (0..segments.len()).rev().map(|start| segments[start..].join("_"));
        let numbered = (2..).map(|number| format!("{}_{number}", segments.join("_")));
        endings
            .chain(numbered)
            .find(|name| !taken(name))
            .unwrap_or_else(|| path.to_token_stream().to_string())
    }
}
