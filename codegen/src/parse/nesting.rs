//! A bound on how deeply tokens may nest.
//!
//! syn and the lowering descend recursively. Without a bound, absurd input would overflow the compiler's stack, which no
//! error message survives.

use proc_macro2::{Spacing, Span, TokenStream, TokenTree};

/// How deeply anything may nest: brackets, signs before an operand, and what extends to the end of a statement. Compiled
/// without optimisation, syn takes up to 50 kB of stack for a level.
const DEPTH: usize = 32;

/// How many tokens there may be, as a sum nests its terms to the left.
const TOKENS: usize = 20_000;

/// The first token that goes beyond a bound, with a message.
pub(super) fn excess(tokens: &TokenStream) -> Option<(Span, String)> {
    let mut open = vec![(tokens.clone().into_iter(), Level::default())];
    let mut count = 0;
    while let Some((tokens, level)) = open.last_mut() {
        let Some(token) = tokens.next() else {
            open.pop();
            continue;
        };
        count += 1;
        let too_deep = !level.admits(&token) || open.len() > DEPTH;
        if too_deep {
            let message = format!("this is nested more than {DEPTH} deep; split the expression with `let`");
            return Some((token.span(), message));
        }
        if count > TOKENS {
            return Some((token.span(), format!("a description may have {TOKENS} tokens at most")));
        }
        if let TokenTree::Group(group) = token {
            open.push((group.stream().into_iter(), Level::default()));
        }
    }
    None
}

/// What nests without brackets, between one pair of brackets.
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
}

impl Level {
    /// Takes note of a token. False if it nests too deeply.
    fn admits(&mut self, token: &TokenTree) -> bool {
        let mut arrow = false;
        match token {
            TokenTree::Punct(punct) => {
                match punct.as_char() {
                    ';' => *self = Self::default(),
                    ',' => (self.signs, self.openings) = (0, 0),
                    '<' => self.angles += 1,
                    '>' if self.arrow => self.openings += 1,
                    '>' => self.angles = self.angles.saturating_sub(1),
                    '=' | '|' => self.openings += 1,
                    _ => self.signs += 1,
                }
                arrow = matches!(punct.as_char(), '-' | '=') && punct.spacing() == Spacing::Joint;
            }
            TokenTree::Ident(ident) => match ident.to_string().as_str() {
                "return" | "break" | "yield" | "become" | "else" | "move" | "let" | "in" => {
                    self.openings += 1
                }
                "mut" | "const" | "static" | "raw" | "dyn" | "impl" => {}
                _ => self.signs = 0,
            },
            TokenTree::Group(_) | TokenTree::Literal(_) => self.signs = 0,
        }
        self.arrow = arrow;
        self.signs.max(self.openings).max(self.angles) <= DEPTH
    }
}
