//! A bound on how deeply tokens may nest.
//!
//! syn and the lowering descend recursively. Without a bound, absurd input would overflow the compiler's stack, which
//! no error message survives.

use proc_macro2::{Spacing, Span, TokenStream, TokenTree};

use crate::limits::{LINKS, NESTING, TOKEN_LENGTH, TOKENS};

/// The first token that goes beyond a bound, with a message.
pub(crate) fn excess(tokens: &TokenStream) -> Option<(Span, String)> {
    let mut open = vec![(tokens.clone().into_iter(), Level::default())];
    let mut count = 0;
    while let Some((tokens, level)) = open.last_mut() {
        let Some(token) = tokens.next() else {
            let links = level.deepest.max(level.links());
            open.pop();
            if let Some((_, outer)) = open.last_mut() {
                outer.inner = outer.inner.max(links);
            }
            continue;
        };
        count += 1;
        level.note(&token);
        let (nesting, links) = (level.nesting(), level.links());
        let problem = if nesting.max(open.len()) > NESTING {
            format!("this is nested more than {NESTING} deep; split the expression with `let`")
        } else if links > LINKS {
            format!("this chain has more than {LINKS} operators and methods; split it with `let`")
        } else if is_long(&token) {
            format!("a name or number may have {TOKEN_LENGTH} characters at most")
        } else if count > TOKENS {
            format!("a description may have {TOKENS} tokens at most")
        } else {
            if let TokenTree::Group(group) = token {
                open.push((group.stream().into_iter(), Level::default()));
            }
            continue;
        };
        return Some((token.span(), problem));
    }
    None
}

/// Whether a token that is not a text is too long.
fn is_long(token: &TokenTree) -> bool {
    match token {
        TokenTree::Ident(ident) => ident.to_string().len() > TOKEN_LENGTH,
        TokenTree::Literal(literal) => {
            let text = literal.to_string();
            text.len() > TOKEN_LENGTH && text.starts_with(|first: char| first.is_ascii_digit())
        }
        TokenTree::Group(_) | TokenTree::Punct(_) => false,
    }
}

/// Nesting without brackets, between one pair of brackets.
#[derive(Default)]
struct Level {
    /// Signs in a row, as in `- - -x` or `& & &T`.
    signs: usize,
    /// Openings of this statement that only its end closes, as in `a = b = c` or `|x| |y| x`.
    openings: usize,
    /// Angle brackets.
    angles: usize,
    /// Whether the last token was `-` or `=` and belongs together with the next.
    arrow: bool,
    /// Operators between the terms of this statement: their tree leans to the left.
    terms: usize,
    /// Operators, methods and calls in the longest term of this statement, and in the current one.
    longest: usize,
    factors: usize,
    /// The longest chain in brackets within this statement.
    inner: usize,
    /// The longest chain of all statements before.
    deepest: usize,
    /// Whether the last token was a name, so that brackets belong to it.
    name: bool,
}

impl Level {
    /// Takes note of a token.
    fn note(&mut self, token: &TokenTree) {
        let mut arrow = false;
        match token {
            TokenTree::Punct(punct) => {
                self.note_mark(punct.as_char());
                arrow = matches!(punct.as_char(), '-' | '=') && punct.spacing() == Spacing::Joint;
            }
            TokenTree::Ident(ident) => match ident.to_string().as_str() {
                "return" | "break" | "yield" | "become" | "else" | "move" | "let" | "in" => {
                    self.openings += 1
                }
                "mut" | "const" | "static" | "raw" | "dyn" | "impl" => {}
                "as" => {
                    self.factors += 1;
                    self.signs = 0;
                }
                _ => self.signs = 0,
            },
            TokenTree::Group(_) => {
                self.factors += usize::from(!self.name);
                self.signs = 0;
            }
            TokenTree::Literal(_) => self.signs = 0,
        }
        self.longest = self.longest.max(self.factors);
        self.arrow = arrow;
        self.name = matches!(token, TokenTree::Ident(_));
    }

    fn note_mark(&mut self, mark: char) {
        match mark {
            '.' | '?' | '*' | '/' | '%' => self.factors += 1,
            '+' | '-' | '&' | '|' | '^' | '<' | '>' => {
                self.terms += 1;
                self.factors = 0;
            }
            // each attribute is for itself
            '#' => self.factors = 0,
            _ => {}
        }
        match mark {
            ';' => *self = Self { deepest: self.deepest.max(self.links()), ..Self::default() },
            ',' => {
                let deepest = self.deepest.max(self.links());
                *self = Self { angles: self.angles, deepest, ..Self::default() };
            }
            '<' => self.angles += 1,
            '>' if self.arrow => self.openings += 1,
            '>' => self.angles = self.angles.saturating_sub(1),
            '=' | '|' => self.openings += 1,
            _ => self.signs += 1,
        }
    }

    /// How deep the next operand lies within the statement.
    fn nesting(&self) -> usize {
        self.signs.max(self.openings).max(self.angles)
    }

    /// How long the chain is that the statement is so far, and those within.
    fn links(&self) -> usize {
        self.terms + self.longest + self.inner
    }
}
