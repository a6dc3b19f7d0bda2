//! Factors as they are named after their declaration.

use std::fmt;

use proc_macro2::{Ident, TokenStream};
use quote::ToTokens;
use syn::parse::{Parse, ParseStream};
use syn::{LitInt, bracketed, token};

use crate::diagnostics::Explained;

/// A factor by its name, or one of an array: `attitude`, `spins[0]`.
#[derive(Clone, Debug)]
pub struct FactorName {
    /// The name, of the whole array.
    pub ident: Ident,
    /// Which one of an array.
    pub index: Option<Index>,
}

/// A number in brackets.
#[derive(Clone, Debug)]
pub struct Index {
    /// The brackets.
    pub brackets: token::Bracket,
    /// As it is written.
    pub literal: LitInt,
    /// The number.
    pub value: usize,
}

impl Parse for FactorName {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let ident: Ident = input.parse()?;
        if !input.peek(token::Bracket) {
            return Ok(Self { ident, index: None });
        }
        let message = format!("one of an array of factors is named by its number, `{ident}[0]`");
        let content;
        let brackets = bracketed!(content in input);
        let literal: LitInt = content.parse().explained(&message)?;
        let value = literal.base10_parse().explained(&message)?;
        if !content.is_empty() || !literal.suffix().is_empty() {
            return Err(content.error("")).explained(message);
        }
        Ok(Self { ident, index: Some(Index { brackets, literal, value }) })
    }
}

impl PartialEq for FactorName {
    fn eq(&self, other: &Self) -> bool {
        let index = |name: &Self| name.index.as_ref().map(|index| index.value);
        self.ident == other.ident && index(self) == index(other)
    }
}

impl fmt::Display for FactorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.index {
            None => write!(f, "{}", self.ident),
            Some(index) => write!(f, "{}[{}]", self.ident, index.value),
        }
    }
}

impl ToTokens for FactorName {
    fn to_tokens(&self, tokens: &mut TokenStream) {
        self.ident.to_tokens(tokens);
        if let Some(index) = &self.index {
            index.brackets.surround(tokens, |tokens| index.literal.to_tokens(tokens));
        }
    }
}
