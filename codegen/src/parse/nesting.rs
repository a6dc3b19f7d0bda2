//! A bound on how deeply tokens may nest.
//!
//! syn and the lowering descend recursively. Without a bound, absurd input would overflow the compiler's stack, which no
//! error message survives.

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};

/// How many brackets may be open at once.
const BRACKETS: usize = 64;

/// How many prefixes (`-`, `&`, `return`, `|x|`, …) one statement may hold, each of which may nest what follows it.
const PREFIXES: usize = 256;

/// How many tokens there may be, as a sum nests its terms to the left.
const TOKENS: usize = 20_000;

/// The first token that goes beyond a bound, with a message.
pub(super) fn excess(tokens: &TokenStream) -> Option<(Span, String)> {
    let mut open = vec![(tokens.clone().into_iter(), Prefixes::default())];
    let mut count = 0;
    while let Some((level, prefixes)) = open.last_mut() {
        let Some(token) = level.next() else {
            open.pop();
            continue;
        };
        count += 1;
        prefixes.see(&token);
        let span = token.span();
        if count > TOKENS {
            return Some((span, format!("a description may have {TOKENS} tokens at most")));
        }
        if prefixes.count > PREFIXES {
            return Some((
                span,
                format!("more than {PREFIXES} prefixes in one expression; split it with `let`"),
            ));
        }
        if let TokenTree::Group(group) = token {
            if open.len() > BRACKETS {
                return Some((
                    span,
                    format!("more than {BRACKETS} nested brackets; split the expression with `let`"),
                ));
            }
            open.push((group.stream().into_iter(), Prefixes::default()));
        }
    }
    None
}

/// Counts the tokens of one statement that may be followed by an operand of their own.
struct Prefixes {
    count: usize,
    operand_expected: bool,
}

impl Default for Prefixes {
    fn default() -> Self {
        Self { count: 0, operand_expected: true }
    }
}

impl Prefixes {
    fn see(&mut self, token: &TokenTree) {
        match token {
            TokenTree::Punct(punct) if matches!(punct.as_char(), ';' | ',') => *self = Self::default(),
            TokenTree::Punct(punct) => {
                // `=` and `|` are followed by an operand wherever they stand, other signs only where one is expected
                let nests = self.operand_expected || matches!(punct.as_char(), '=' | '|');
                self.count += usize::from(nests);
                self.operand_expected = true;
            }
            TokenTree::Ident(ident) => {
                let keyword = matches!(
                    ident.to_string().as_str(),
                    "return"
                        | "break"
                        | "yield"
                        | "else"
                        | "move"
                        | "mut"
                        | "let"
                        | "in"
                        | "become"
                        | "static"
                        | "raw"
                );
                self.count += usize::from(keyword);
                self.operand_expected = keyword;
            }
            TokenTree::Group(group) => self.operand_expected = group.delimiter() == Delimiter::None,
            TokenTree::Literal(_) => self.operand_expected = false,
        }
    }
}
