//! `coadjoint show`: the generated code, as the macro emits it, formatted; or as a header for C.

use std::io::Write;

use clap::{Args, ValueEnum};
use coadjoint::composition::{Coefficients as _, KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint_codegen::emit::StepExpansion;
use coadjoint_codegen::emit::c99::{self, Options, Steps};
use coadjoint_codegen::quantity::ScalarType;
use coadjoint_codegen::scheme::Scheme;
use coadjoint_codegen::source::Source;
use proc_macro2::{Group, Literal, TokenStream, TokenTree};

use super::description::DescriptionArguments;
use crate::catalogue::{Catalogue, Entry};
use crate::error::{Error, SetupError};
use crate::setup::{Method, MethodParser, Order, Retraction};
use crate::simulate;

/// The arguments of `show`.
#[derive(Debug, Args)]
pub(crate) struct ShowArguments {
    /// The system; `list` shows all
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// Only the step built on this map; `exp` and `cay` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// The code of the steps' derivatives, too
    #[arg(long)]
    pub(crate) derivatives: bool,
    /// Rust as the macro emits it, or one header that brings its solver
    #[arg(long, value_enum, default_value_t)]
    pub(crate) language: Language,
    /// Of a header: what the step makes of the map, where it was generated [default: as `run` takes it]
    #[arg(long, value_parser = MethodParser)]
    pub(crate) method: Option<Method>,
    /// Of a header: 2, or 4, 6, 8, 10 [default: 2]
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
    /// Of a header: numbers of 32 bits
    #[arg(long)]
    pub(crate) float: bool,
    /// Of a header: a solver in few lines, for machines with little memory
    #[arg(long)]
    pub(crate) compact: bool,
}

/// What code is shown in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Language {
    /// As the macro emits it
    #[default]
    Rust,
    /// A C99 header, for C++ too
    C,
    /// The same with functions for GPUs that take steps of many members; for HIP too
    Cuda,
}

pub(crate) fn show(
    catalogue: &Catalogue,
    arguments: &ShowArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
    if entry.source.is_empty() {
        let message = format!(
            "`{}` has no source: give its entry one, `.with_source(include_str!(\"main.rs\"))`",
            entry.name
        );
        return Err(SetupError::new(message).into());
    }
    let rejected =
        |error: syn::Error| Error::Generator { system: entry.name.clone(), reason: error.to_string() };
    let ShowArguments { retraction, derivatives, language, method, order, float, compact, .. } = *arguments;
    let code = match language {
        Language::Rust if method.is_some() || order.is_some() || float || compact => {
            let message = "`--method`, `--order`, `--float` and `--compact` are for headers: `--language c`";
            return Err(SetupError::new(message.to_owned()).into());
        }
        Language::Rust => generated(entry, retraction, derivatives).map_err(rejected)?,
        Language::C | Language::Cuda => {
            let (source, name) = described(entry, derivatives).map_err(rejected)?;
            let derived = coadjoint_codegen::derived(&source, name.as_deref()).map_err(rejected)?;
            let options = Options {
                steps: steps(entry, arguments)?,
                scalar: float.then_some(ScalarType::F32),
                compact,
                kernels: language == Language::Cuda,
                constants: derived.constants,
            };
            let header = c99::header(&derived.program, &options);
            header.map_err(|error| SetupError::new(format!("`{}`: {error}", entry.name)))?
        }
    };
    write!(console, "{code}")?;
    Ok(())
}

/// The steps of a header; none where the usual ones are meant.
fn steps(entry: &Entry, arguments: &ShowArguments) -> Result<Vec<Steps>, SetupError> {
    let ShowArguments { retraction, method, order, .. } = *arguments;
    if retraction.is_none() && method.is_none() && order.is_none() {
        return Ok(Vec::new());
    }
    let retractions = retraction.map_or_else(|| Retraction::of(entry), |retraction| vec![retraction]);
    let of = |retraction: Retraction| {
        let method = match (method, order) {
            (Some(method), _) => method,
            // as `run` takes it
            (None, Some(order)) => simulate::usual_method(entry, retraction, order),
            (None, None) => Method::default(),
        };
        let order = order.unwrap_or_default();
        let gamma = match order {
            _ if method.is_of_order() => &[],
            Order::Two => &[][..],
            Order::Four => Suzuki4::GAMMA,
            Order::Six => KahanLi6::GAMMA,
            Order::Eight => KahanLi8::GAMMA,
            Order::Ten => SofroniouSpaletta10::GAMMA,
        };
        // that it can be composed
        let whole = simulate::scheme(method, retraction, order)?;
        let base = if gamma.is_empty() { whole } else { simulate::scheme(method, retraction, Order::Two)? };
        Ok(Steps { scheme: base.to_string(), gamma: gamma.to_vec() })
    };
    retractions.into_iter().map(of).collect()
}

/// The code generated from an entry's source, for one retraction or all, with its derivatives or without.
fn generated(entry: &Entry, retraction: Option<Retraction>, derivatives: bool) -> syn::Result<String> {
    let (source, name) = described(entry, derivatives)?;
    let tokens = expand(&source, name.as_deref(), retraction)?;
    Ok(prettyplease::unparse(&syn::parse2(without_bytes(tokens))?))
}

/// The text of an entry, which asks for derivatives where they are wanted: the catalogue's ask for none. And which of its structs is the
/// system: the one of its name, or the first.
fn described(entry: &Entry, derivatives: bool) -> syn::Result<(Source, Option<String>)> {
    let source = Source::find(entry.source.parse()?).with_derivatives(derivatives);
    let names = || source.described().iter().map(|one| one.name.to_string());
    let name = names().find(|name| name == entry.description.name).or_else(|| names().next());
    Ok((source, name))
}

/// With `b"..."` in the place of what nobody can read: programs as bytes, which say what the functions beside them say.
fn without_bytes(tokens: TokenStream) -> TokenStream {
    let shown = |tree: TokenTree| match tree {
        TokenTree::Group(group) => {
            TokenTree::Group(Group::new(group.delimiter(), without_bytes(group.stream())))
        }
        TokenTree::Literal(literal) if literal.to_string().starts_with("b\"") => {
            TokenTree::Literal(Literal::byte_string(b"..."))
        }
        tree => tree,
    };
    tokens.into_iter().map(shown).collect()
}

/// Expands the struct as the macro does, with the steps that were asked for.
fn expand(source: &Source, name: Option<&str>, retraction: Option<Retraction>) -> syn::Result<TokenStream> {
    let mut expansion = coadjoint_codegen::expand_in(source, name)?;
    if let Some(retraction) = retraction {
        let is_wanted = |scheme: &Scheme| scheme.retraction.name() == retraction.map().name();
        expansion.steps.retain(|StepExpansion { program, .. }| {
            is_wanted(&program.scheme) || program.aliases.iter().any(is_wanted)
        });
        // it names all steps
        expansion.schemes = TokenStream::new();
    }
    Ok(expansion.into_tokens())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    #[test]
    fn the_attribute_is_taken_off_the_struct() {
        let text = "use a::b; struct Other; #[doc = \"x\"] #[m::lie_poisson_system(group = SO3)] struct Body { a: f64 }";
        let found = |text: &str, name| {
            let source = Source::find(text.parse().expect("tokens"));
            source.description(Some(name)).map(|found| (found.attribute.to_string(), found.item.clone()))
        };
        let (attribute, item) = found(text, "Body").expect("there is one");
        assert_eq!(attribute, "group = SO3");
        let item: syn::ItemStruct = syn::parse2(item).expect("a struct");
        assert_eq!(item.ident, "Body");
        assert_eq!(item.attrs.len(), 1);
        assert!(found("struct Other;", "Body").is_err());
    }

    #[test]
    fn a_struct_is_found_by_its_name() {
        let text = "#[lie_poisson_system(group = SO3)] struct First { a: f64 } #[lie_poisson_system(group = SO2)] struct Second { a: f64 }";
        let mut entry = catalogue().find("heavy_top").expect("it is there").clone();
        entry.source = text;
        let attribute = |entry: &Entry| {
            let (source, name) = described(entry, false).expect("tokens");
            source.description(name.as_deref()).expect("it is there").attribute.to_string()
        };
        // the first one, where none has the name
        assert_eq!(attribute(&entry), "group = SO3");
        entry.description.name = "Second";
        assert_eq!(attribute(&entry), "group = SO2");
    }

    #[test]
    fn every_system_can_be_shown() {
        for entry in catalogue().entries() {
            for retraction in [None, Some(Retraction::Exponential), Some(Retraction::Cayley)] {
                let code = generated(entry, retraction, false).expect("its own generator takes it");
                assert!(code.contains("struct") && !code.contains("Linearized<"), "{}", entry.name);
            }
            let code = generated(entry, Some(Retraction::Cayley), true).expect("its own generator takes it");
            assert!(code.contains("impl<T: Scalar> Linearized<T"), "{}", entry.name);
            assert!(code.contains("b\"...\"") && !code.contains("\\x"), "{}", entry.name);
        }
    }

    #[test]
    fn headers_are_what_is_asked_for() {
        let shown = |system: &str, more: &[&str]| {
            let words = [&["show", system, "--language", "c"][..], more].concat();
            let parsed = crate::cli::parsed(words.into_iter().map(str::to_owned).collect());
            let Ok(crate::cli::Command::Show(arguments)) = parsed else { panic!("{more:?}") };
            let mut shown = Vec::new();
            show(catalogue(), &arguments, &mut shown).map(|()| String::from_utf8(shown).expect("text"))
        };
        for entry in catalogue().entries() {
            let code = shown(&entry.name, &[]).expect("a header");
            assert!(code.contains("static inline") && code.contains("typedef double"), "{}", entry.name);
            let code = shown(&entry.name, &["--retraction", "cay", "--order", "4", "--float", "--compact"]);
            let code = code.expect("a header");
            // of one solve where `run` takes that
            let usual = simulate::usual_method(entry, Retraction::Cayley, Order::Four);
            assert_eq!(code.contains("gamma[5]"), usual == Method::Standard, "{}", entry.name);
            assert!(code.contains("typedef float"), "{}", entry.name);
            let error =
                shown(&entry.name, &["--method", "family=1/7"]).expect_err("it is not there").to_string();
            assert!(error.contains("there is no step `Family<") && error.contains(", 1, 7>`"), "{error}");
        }
    }
}
