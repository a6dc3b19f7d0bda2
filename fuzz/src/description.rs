//! Descriptions in Rust source text: items marked with the attribute.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A description as the attribute macro gets it.
pub struct Description {
    /// What stands within the attribute's parentheses.
    pub attribute: TokenStream,
    /// The item, without the attribute.
    pub item: TokenStream,
}

/// All descriptions in a source text, at its outermost level; none if its brackets do not match.
pub fn descriptions(source: &str) -> Vec<Description> {
    let Ok(tokens) = source.parse::<TokenStream>() else { return Vec::new() };
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut found = Vec::new();
    let mut start = 0;
    for end in 0..tokens.len() {
        if ends_an_item(&tokens[end]) {
            found.extend(description(&tokens[start..=end]));
            start = end + 1;
        }
    }
    found.extend(description(&tokens[start..]));
    found
}

/// Whether a token is the last one of an item.
fn ends_an_item(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(punct) => punct.as_char() == ';',
        _ => false,
    }
}

/// The description that an item is, if it is marked as one.
fn description(item: &[TokenTree]) -> Option<Description> {
    let place = item.windows(2).position(|pair| is_hash(&pair[0]) && arguments(&pair[1]).is_some())?;
    let attribute = arguments(&item[place + 1])?;
    let rest = item[..place].iter().chain(&item[place + 2..]).cloned().collect();
    Some(Description { attribute, item: rest })
}

fn is_hash(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == '#')
}

/// The arguments of the attribute in brackets, if it is the one that marks a description.
fn arguments(token: &TokenTree) -> Option<TokenStream> {
    let TokenTree::Group(brackets) = token else { return None };
    let mut inner = brackets.stream().into_iter();
    match (inner.next()?, inner.next()) {
        (TokenTree::Ident(name), Some(TokenTree::Group(arguments))) if name == "lie_poisson_system" => {
            Some(arguments.stream())
        }
        (TokenTree::Ident(name), None) if name == "lie_poisson_system" => Some(TokenStream::new()),
        _ => None,
    }
}
