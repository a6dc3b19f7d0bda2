//! Problems found in a description, gathered so that a user sees all of them at once, each at its own tokens.

use std::fmt::Display;

use proc_macro2::{Ident, Span, TokenStream};
use quote::{ToTokens, quote};

/// Gathers problems. Phases go on after a problem as long as they can say something useful, and the generator stops
/// between phases if anything was found.
#[derive(Debug, Default)]
#[must_use = "problems that are never looked at are never reported"]
pub struct Diagnostics {
    errors: Vec<syn::Error>,
    warnings: Vec<Warning>,
}

/// Something that is no error, at the name that it is about.
#[derive(Debug)]
struct Warning {
    at: Ident,
    what: &'static str,
    message: String,
    lints: Vec<syn::Attribute>,
}

impl Diagnostics {
    /// Nothing wrong so far.
    pub fn new() -> Self {
        Self::default()
    }

    /// A problem with the construct made of `tokens`.
    pub fn push(&mut self, tokens: impl ToTokens, message: impl Display) {
        self.errors.push(syn::Error::new_spanned(tokens, message));
    }

    /// A problem at a place that is not a construct of its own.
    pub fn push_at(&mut self, span: Span, message: impl Display) {
        self.errors.push(syn::Error::new(span, message));
    }

    /// The same as [`push`](Self::push) where nothing can be made of the construct.
    pub fn fail<T>(&mut self, tokens: impl ToTokens, message: impl Display) -> Option<T> {
        self.push(tokens, message);
        None
    }

    /// A problem found by syn.
    pub fn absorb(&mut self, error: syn::Error) {
        self.errors.push(error);
    }

    /// A remark at a name. `what` is the name of a constant that says in a word or two what is the matter; `lints` are
    /// the attributes that the user set there to allow or deny lints.
    pub fn warn(&mut self, at: &Ident, what: &'static str, message: String, lints: Vec<syn::Attribute>) {
        self.warnings.push(Warning { at: at.clone(), what, message, lints });
    }

    /// The warnings, each as the name that it is about and its message.
    pub fn warnings(&self) -> impl Iterator<Item = (String, &str)> {
        self.warnings.iter().map(|warning| (warning.at.to_string(), warning.message.as_str()))
    }

    /// The warnings, each with the place that it is about.
    pub(crate) fn warned(&self) -> Vec<(Span, String)> {
        self.warnings.iter().map(|warning| (warning.at.span(), warning.message.clone())).collect()
    }

    /// Whether nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// How many problems were found.
    pub fn len(&self) -> usize {
        self.errors.len()
    }

    /// All problems as one error.
    pub fn finish(self) -> Result<(), syn::Error> {
        let combine = |mut all: syn::Error, next| {
            all.combine(next);
            all
        };
        self.errors.into_iter().reduce(combine).map_or(Ok(()), Err)
    }

    /// The problems as items; if there are none, the warnings.
    pub fn into_tokens(self) -> TokenStream {
        if self.errors.is_empty() {
            return self.warnings.iter().map(Warning::to_tokens).collect();
        }
        self.into_compile_errors().into_iter().collect()
    }

    /// The problems as invocations of `compile_error!`, each of which can stand for an item or a type.
    pub fn into_compile_errors(self) -> Vec<TokenStream> {
        self.errors.into_iter().flatten().map(|error| error.to_compile_error()).collect()
    }
}

/// A parser's result with a message of ours.
pub(crate) trait Explained {
    /// The same, with this message in the place of syn's own at the same tokens.
    fn explained(self, message: impl Display) -> Self;
}

impl<T> Explained for syn::Result<T> {
    fn explained(self, message: impl Display) -> Self {
        self.map_err(|error| syn::Error::new(error.span(), message))
    }
}

impl Warning {
    /// The use of something deprecated, at the user's tokens: the one lint of rustc that a macro can give a message.
    fn to_tokens(&self) -> TokenStream {
        let Self { at, what, message, lints } = self;
        let declared = Ident::new(what, Span::mixed_site());
        let used = Ident::new(what, declared.span().located_at(at.span()));
        quote! {
            #(#lints)*
            const _: () = {
                #[deprecated(note = #message)]
                const #declared: () = ();
                #used
            };
        }
    }
}

/// Names in quotes, as a sentence lists them: `` `a`, `b` and `c` ``.
pub fn list<N: AsRef<str>>(names: impl IntoIterator<Item = N>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|name| format!("`{}`", name.as_ref())).collect();
    match quoted.as_slice() {
        [] => "nothing".to_owned(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `1 argument`, `2 arguments`
pub fn count(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// `; did you mean …?` if one of the known names is close to what was written, otherwise `; known: …`: the end of a
/// sentence that says what is not known.
pub fn suggestion(written: &str, known: &[&str]) -> String {
    match nearest(written, known) {
        Some(name) => format!("; did you mean `{name}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; known: {}", list(known)),
    }
}

/// The known name that `written` is most likely a slip of, if any is near enough. Of equally near ones the first.
pub fn nearest<'n>(written: &str, known: &[&'n str]) -> Option<&'n str> {
    let length = written.chars().count();
    let allowed = if length < 4 { 0 } else { (length / 3).min(3) };
    let folded = written.to_lowercase();
    // names that differ in their numbers are different things
    let digits = |name: &str| name.chars().filter(char::is_ascii_digit).collect::<String>();
    known
        .iter()
        .filter(|name| digits(name) == digits(written))
        .map(|&name| (edits(&folded, &name.to_lowercase()), name))
        .filter(|&(distance, name)| distance <= allowed && distance < name.chars().count())
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// How many letters must be inserted, deleted, replaced or swapped with their neighbour to turn one word into the
/// other.
pub(crate) fn edits(from: &str, to: &str) -> usize {
    let (from, to): (Vec<char>, Vec<char>) = (from.chars().collect(), to.chars().collect());
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for i in 1..=from.len() {
        let mut row = vec![i];
        for j in 1..=to.len() {
            let replaced = last[j - 1] + usize::from(from[i - 1] != to[j - 1]);
            let mut cost = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1] {
                cost = cost.min(before[j - 2] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[to.len()]
}
