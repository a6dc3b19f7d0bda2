//! Descriptions in the text of a file, as a program finds them that has no compiler: structs below their attributes, and beside them the groups,
//! functions and constants of the user's own that the compiler would find.
//!
//! Items are told apart by their tokens: all else in the file may be anything, and nesting is no matter.

use std::collections::BTreeMap;

use proc_macro2::{Delimiter, Ident, Spacing, Span, TokenStream, TokenTree};
use quote::ToTokens;

use crate::lie_group::{self, Definitions};
use crate::parse::nested;

/// What a file has of descriptions.
#[derive(Debug, Default)]
pub struct Source {
    described: Vec<Described>,
    groups: Vec<TokenStream>,
    /// Functions with the paths that they are called by.
    functions: Vec<(TokenStream, TokenStream)>,
    /// Values, by paths as they are spelt.
    constants: BTreeMap<String, TokenStream>,
    /// What names in modules stand for, both as paths are spelt; `*` for all names of a module.
    imports: Vec<(String, String)>,
    has_derivatives: bool,
}

/// A struct below its attribute.
#[derive(Clone, Debug)]
pub struct Described {
    /// Its name.
    pub name: Ident,
    /// The arguments of the attribute.
    pub attribute: TokenStream,
    /// The struct, without that attribute.
    pub item: TokenStream,
    /// What is wrong with how the attribute stands there.
    problem: Option<syn::Error>,
}

/// How deep modules may be in each other.
const MODULES: usize = 8;

impl Source {
    /// Finds what there is.
    pub fn find(tokens: TokenStream) -> Self {
        let mut source = Self::default();
        source.items(tokens, &TokenStream::new(), 0);
        source
    }

    /// Asks for the derivatives of steps, whether or not a description does.
    #[must_use]
    pub fn with_derivatives(self, has_derivatives: bool) -> Self {
        Self { has_derivatives, ..self }
    }

    pub(crate) fn has_derivatives(&self) -> bool {
        self.has_derivatives
    }

    /// The descriptions, in the order in which they stand there.
    pub fn described(&self) -> &[Described] {
        &self.described
    }

    /// The description of this name; without a name, the only one.
    ///
    /// # Errors
    /// If there is none, or there are several to choose from, or its attribute is none that a compiler would take.
    pub fn description(&self, name: Option<&str>) -> syn::Result<&Described> {
        let described = self.named(name)?;
        described.problem.clone().map_or(Ok(described), Err)
    }

    fn named(&self, name: Option<&str>) -> syn::Result<&Described> {
        let names = || crate::diagnostics::list(self.described.iter().map(|one| one.name.to_string()));
        let error = |span, message: String| Err(syn::Error::new(span, message));
        match (name, &self.described[..]) {
            (_, []) => error(
                Span::call_site(),
                "no struct is described: write `#[lie_poisson_system(…)]` above one".to_owned(),
            ),
            (None, [only]) => Ok(only),
            (None, [_, second, ..]) => {
                error(second.name.span(), format!("several structs are described; choose one of {}", names()))
            }
            (Some(name), all) => match all.iter().find(|one| one.name == name) {
                Some(one) => Ok(one),
                None => error(all[0].name.span(), format!("no `{name}` is described; known: {}", names())),
            },
        }
    }

    /// The groups and functions that stand beside it.
    pub(crate) fn definitions(&self) -> syn::Result<Definitions> {
        let mut problems: Option<syn::Error> = None;
        let mut note = |error| match &mut problems {
            Some(all) => all.combine(error),
            None => problems = Some(error),
        };
        let mut all = Definitions::default();
        for tokens in &self.groups {
            match lie_group::definitions_of(tokens.clone()) {
                Ok(groups) => all.0.extend(groups),
                Err(error) => note(error),
            }
        }
        for (path, function) in &self.functions {
            match lie_group::function_of(path.clone(), function.clone()) {
                Ok(function) => all.1.push(function),
                Err(error) => note(error),
            }
        }
        problems.map_or(Ok(all), Err)
    }

    /// The value of a path.
    ///
    /// # Errors
    /// If it is not one of the numbers that stand beside the description, or of the standard library's constants.
    pub(crate) fn constant(&self, path: &syn::Expr) -> syn::Result<f64> {
        self.value(path, MODULES)
    }

    fn value(&self, expression: &syn::Expr, depth: usize) -> syn::Result<f64> {
        use syn::{BinOp, Expr, Lit, UnOp};
        let unknown = |message: String| syn::Error::new_spanned(expression, message);
        match expression {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Float(number) if ["", "f64"].contains(&number.suffix()) => number.base10_parse(),
                Lit::Int(number) if ["", "f64"].contains(&number.suffix()) => number.base10_parse(),
                _ => Err(unknown("expected a number".to_owned())),
            },
            Expr::Paren(inner) => self.value(&inner.expr, depth),
            Expr::Group(inner) => self.value(&inner.expr, depth),
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => Ok(-self.value(&unary.expr, depth)?),
            Expr::Binary(binary) => {
                let [x, y] = [self.value(&binary.left, depth)?, self.value(&binary.right, depth)?];
                match binary.op {
                    BinOp::Add(_) => Ok(x + y),
                    BinOp::Sub(_) => Ok(x - y),
                    BinOp::Mul(_) => Ok(x * y),
                    BinOp::Div(_) => Ok(x / y),
                    _ => Err(unknown("a constant is made of `+`, `-`, `*` and `/`".to_owned())),
                }
            }
            Expr::Path(path) => {
                let texts = self.meant(&spelt(path));
                if let Some(value) = texts.iter().find_map(|text| standard(text)) {
                    return Ok(value);
                }
                let written = path.to_token_stream().to_string().replace(' ', "");
                let Some(tokens) = texts.iter().find_map(|text| self.constants.get(text)) else {
                    let name = written.rsplit("::").next().unwrap_or_default();
                    return Err(unknown(format!(
                        "`{written}` is known to a compiler alone: write `const {name}: f64 = …;` beside the struct, or make it a field"
                    )));
                };
                let Some(depth) = depth.checked_sub(1) else {
                    return Err(unknown(format!("`{written}` is defined by too many others")));
                };
                if let Some((span, message)) = nested(tokens) {
                    return Err(syn::Error::new(span, message));
                }
                self.value(&syn::parse2(tokens.clone())?, depth)
            }
            _ => {
                Err(unknown("a constant is a number, or made of numbers by `+`, `-`, `*` and `/`".to_owned()))
            }
        }
    }

    /// The paths that a path may stand for: itself, and what imports make of its first words.
    fn meant(&self, path: &str) -> Vec<String> {
        let mut all = vec![path.to_owned()];
        for (name, of) in &self.imports {
            let rest = match name.strip_suffix('*') {
                Some(module) => path.strip_prefix(module).map(|rest| format!(" :: {rest}")),
                None => path.strip_prefix(name.as_str()).map(str::to_owned),
            };
            if let Some(rest) = rest.filter(|rest| rest.is_empty() || rest.starts_with(" :: ")) {
                all.push(format!("{of}{rest}"));
            }
        }
        all
    }

    /// Takes note of what an import brings into a module.
    fn import(&mut self, tree: &syn::UseTree, of: &str, module: &str) {
        use syn::UseTree;
        let join = |path: &str, name: &str| match path {
            "" => name.to_owned(),
            path => format!("{path} :: {name}"),
        };
        let mut bring = |name: String, of: String| self.imports.push((join(module, &name), of));
        match tree {
            UseTree::Path(path) => {
                let inner = join(of, &path.ident.to_string());
                self.import(&path.tree, inner.strip_prefix("crate :: ").unwrap_or(&inner), module);
            }
            UseTree::Name(name) if name.ident == "self" => {
                let last = of.rsplit(" :: ").next().unwrap_or_default();
                bring(last.to_owned(), of.to_owned());
            }
            UseTree::Name(name) => bring(name.ident.to_string(), join(of, &name.ident.to_string())),
            UseTree::Rename(name) => bring(name.rename.to_string(), join(of, &name.ident.to_string())),
            UseTree::Glob(_) => bring("*".to_owned(), of.to_owned()),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, of, module)),
        }
    }

    /// Goes through the items of a module, whose path begins all paths to them.
    fn items(&mut self, tokens: TokenStream, module: &TokenStream, depth: usize) {
        let mut tokens = tokens.into_iter().peekable();
        while tokens.peek().is_some() {
            let mut item: Vec<TokenTree> = Vec::new();
            let mut is_declaration = false;
            for token in tokens.by_ref() {
                if let TokenTree::Ident(word) = &token {
                    let starts = ["use", "const", "static", "type", "extern"];
                    let first = item.iter().all(|token| !is_keyword(token));
                    is_declaration |= first && starts.iter().any(|start| word == start);
                    // but not what begins with a function's qualifiers
                    is_declaration &= word != "fn";
                }
                let ends = match &token {
                    TokenTree::Punct(mark) => mark.as_char() == ';',
                    TokenTree::Group(group) => group.delimiter() == Delimiter::Brace && !is_declaration,
                    _ => false,
                };
                item.push(token);
                if ends {
                    break;
                }
            }
            self.item(item, module, depth);
        }
    }

    /// Takes note of one item.
    fn item(&mut self, item: Vec<TokenTree>, module: &TokenStream, depth: usize) {
        let (attributes, rest) = attributes(item);
        let path = |name: &Ident| match module.is_empty() {
            true => name.to_token_stream(),
            false => quote::quote! { #module::#name },
        };
        if matches!(rest.iter().find(|token| is_keyword(token)), Some(TokenTree::Ident(word)) if word == "use")
        {
            let tokens: TokenStream = rest.into_iter().collect();
            if nested(&tokens).is_none()
                && let Ok(import) = syn::parse2::<syn::ItemUse>(tokens)
            {
                self.import(&import.tree, "", &module.to_string());
            }
            return;
        }
        let Some((keyword, name)) = rest.iter().zip(rest.iter().skip(1)).find_map(|pair| match pair {
            (TokenTree::Ident(keyword), TokenTree::Ident(name)) if is_keyword(pair.0) => {
                Some((keyword.to_string(), name.clone()))
            }
            _ => None,
        }) else {
            if let [TokenTree::Ident(word), TokenTree::Punct(mark), TokenTree::Group(group), ..] = &rest[..]
                && word == "lie_group"
                && mark.as_char() == '!'
                && module.is_empty()
            {
                self.groups.push(group.stream());
            }
            return;
        };
        match (keyword.as_str(), rest.last()) {
            ("struct", _) => {
                let (ours, others): (Vec<_>, Vec<_>) =
                    attributes.into_iter().partition(|attribute| attribute.is("lie_poisson_system"));
                let Some((first, again)) = ours.split_first() else { return };
                let (attribute, rest_of_it) = first.arguments();
                let twice = again.first().map(|attribute| {
                    let tokens: TokenStream = attribute.tokens.iter().cloned().collect();
                    let message = "a struct is described once: this attribute is the second";
                    syn::Error::new_spanned(tokens, message)
                });
                let more = (!rest_of_it.is_empty()).then(|| {
                    let message = "the attribute ends before this: a bracket stands where it should not";
                    syn::Error::new_spanned(rest_of_it, message)
                });
                let item = others.into_iter().flat_map(|attribute| attribute.tokens).chain(rest).collect();
                self.described.push(Described { name, attribute, item, problem: more.or(twice) });
            }
            ("fn", _) if attributes.iter().any(|attribute| attribute.is("expression")) => {
                self.functions.push((path(&name), rest.into_iter().collect()));
            }
            ("const", _) => {
                let is_value = |token: &TokenTree| matches!(token, TokenTree::Punct(mark) if mark.as_char() == '=' && mark.spacing() == Spacing::Alone);
                if let Some(start) = rest.iter().position(is_value) {
                    let value = rest[start + 1..rest.len() - 1].iter().cloned().collect();
                    self.constants.insert(path(&name).to_string(), value);
                }
            }
            ("mod", Some(TokenTree::Group(group))) if depth < MODULES => {
                self.items(group.stream(), &path(&name), depth + 1);
            }
            _ => {}
        }
    }
}

/// Whether a word says what kind of item it begins.
fn is_keyword(token: &TokenTree) -> bool {
    let words = ["struct", "fn", "const", "mod", "impl", "enum", "trait", "use", "static", "type", "union"];
    matches!(token, TokenTree::Ident(word) if words.iter().any(|known| word == known))
}

/// An attribute of an item.
struct OfItem {
    tokens: Vec<TokenTree>,
    inner: TokenStream,
}

impl OfItem {
    /// Whether it is of this name, whatever path leads there.
    fn is(&self, name: &str) -> bool {
        let words = self.inner.clone().into_iter();
        let path = words.take_while(|token| !matches!(token, TokenTree::Group(_)));
        path.last().is_some_and(|last| last.to_string() == name)
    }

    /// What stands in its parentheses, and what stands behind them, where nothing should.
    fn arguments(&self) -> (TokenStream, TokenStream) {
        let mut tokens = self.inner.clone().into_iter();
        let group = tokens.find_map(|token| match token {
            TokenTree::Group(group) => Some(group.stream()),
            _ => None,
        });
        (group.unwrap_or_default(), tokens.collect())
    }
}

/// Takes the attributes off an item.
fn attributes(item: Vec<TokenTree>) -> (Vec<OfItem>, Vec<TokenTree>) {
    let (mut attributes, mut tokens) = (Vec::new(), item.into_iter().peekable());
    let is = |token: Option<&TokenTree>, mark: char| matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark);
    while is(tokens.peek(), '#') {
        let mut own: Vec<TokenTree> = tokens.by_ref().take(1).collect();
        let is_of_file = is(tokens.peek(), '!');
        if is_of_file {
            own.extend(tokens.next());
        }
        match tokens.next() {
            Some(TokenTree::Group(group)) => {
                let inner = group.stream();
                own.push(TokenTree::Group(group));
                if !is_of_file {
                    attributes.push(OfItem { tokens: own, inner });
                }
            }
            Some(other) => return (attributes, std::iter::once(other).chain(tokens).collect()),
            None => break,
        }
    }
    (attributes, tokens.collect())
}

/// A path in one spelling.
fn spelt(path: &syn::ExprPath) -> String {
    let text = path.path.to_token_stream().to_string();
    text.strip_prefix("self :: ").or(text.strip_prefix("crate :: ")).unwrap_or(&text).to_owned()
}

/// The constants of the standard library.
fn standard(path: &str) -> Option<f64> {
    use std::f64::consts;
    let path = path.replace(' ', "");
    let path = path.trim_start_matches("::");
    let path = path.strip_prefix("std::").or(path.strip_prefix("core::")).unwrap_or(path);
    Some(match path.strip_prefix("f64::")? {
        "consts::E" => consts::E,
        "consts::FRAC_1_PI" => consts::FRAC_1_PI,
        "consts::FRAC_1_SQRT_2" => consts::FRAC_1_SQRT_2,
        "consts::FRAC_2_PI" => consts::FRAC_2_PI,
        "consts::FRAC_2_SQRT_PI" => consts::FRAC_2_SQRT_PI,
        "consts::FRAC_PI_2" => consts::FRAC_PI_2,
        "consts::FRAC_PI_3" => consts::FRAC_PI_3,
        "consts::FRAC_PI_4" => consts::FRAC_PI_4,
        "consts::FRAC_PI_6" => consts::FRAC_PI_6,
        "consts::FRAC_PI_8" => consts::FRAC_PI_8,
        "consts::LN_2" => consts::LN_2,
        "consts::LN_10" => consts::LN_10,
        "consts::LOG2_10" => consts::LOG2_10,
        "consts::LOG2_E" => consts::LOG2_E,
        "consts::LOG10_2" => consts::LOG10_2,
        "consts::LOG10_E" => consts::LOG10_E,
        "consts::PI" => consts::PI,
        "consts::SQRT_2" => consts::SQRT_2,
        "consts::TAU" => consts::TAU,
        "EPSILON" => f64::EPSILON,
        "MAX" => f64::MAX,
        "MIN" => f64::MIN,
        "MIN_POSITIVE" => f64::MIN_POSITIVE,
        _ => return None,
    })
}
