//! Groups and functions of a user's own, beside the systems that name them: `lie_group! { pub Shears = matrices { … } }`
//! and `group = Shears!`, `#[expression] fn density(h: f64) -> f64 { … }` and `density(position.z)`.
//!
//! An attribute sees its own tokens alone. So `lie_group!` makes a macro of the group's name, which knows the
//! definition, and a system on such a group is handed to that macro, which hands it back with the definition beside it.
//! A function's macro has its name too: macros and functions do not come in each other's way.
//!
//! ```text
//! #[lie_poisson_system(group = Shears!)] struct …
//!     → Shears! { (callback) ("Shears") {} {attribute} {item} }
//!     → callback! { { "Shears" => Shears = matrices { … }; } {attribute} {item} }
//! ```

use proc_macro2::{Group as Tokens, Ident, Literal, TokenStream};
use quote::{ToTokens, format_ident, quote};
use syn::parse::{ParseStream, Parser};
use syn::{ItemFn, LitStr, Token, Visibility};

use crate::check::groups;
use crate::diagnostics::{Diagnostics, Explained};
use crate::limits;
use crate::parse::{Attribute, Definition, Group, OwnFunction, calls, group, nested};

/// `pub Shears = matrices { … }`, with documentation.
struct Declaration {
    attributes: Vec<syn::Attribute>,
    visibility: Visibility,
    name: Ident,
    group: Group,
    tokens: TokenStream,
}

/// The whole of `lie_group!`: a macro for each group, which hands its definition to systems.
pub fn lie_group(input: TokenStream) -> TokenStream {
    let mut diagnostics = Diagnostics::new();
    if let Some((span, message)) = nested(&input) {
        diagnostics.push_at(span, message);
        return diagnostics.into_tokens();
    }
    let declarations = match declarations.parse2(input) {
        Ok(declarations) => declarations,
        Err(error) => return error.into_compile_error(),
    };
    if let Some(declaration) = declarations.get(limits::GROUPS) {
        let message = format!("define {} groups at a time at most", limits::GROUPS);
        return syn::Error::new_spanned(&declaration.name, message).into_compile_error();
    }
    for declaration in &declarations {
        // what is made of other groups of one's own is looked at where they are known
        if declaration.group.own().is_empty() {
            let _ = groups::group(&declaration.group, &[], &[], &mut diagnostics);
        }
    }
    let macros = declarations.iter().map(Declaration::macro_rules);
    let messages = diagnostics.into_tokens();
    quote! { #(#macros)* #messages }
}

/// The groups of a `lie_group!` in a text, by their names.
pub(crate) fn definitions_of(input: TokenStream) -> syn::Result<Vec<Definition>> {
    if let Some((span, message)) = nested(&input) {
        return Err(syn::Error::new(span, message));
    }
    let declarations = declarations.parse2(input)?;
    let of =
        |Declaration { name, group, .. }: Declaration| Definition { path: name.to_string(), name, group };
    Ok(declarations.into_iter().map(of).collect())
}

/// A function below `#[expression]` in a text, under the path that it is called by.
pub(crate) fn function_of(path: TokenStream, item: TokenStream) -> syn::Result<OwnFunction> {
    if let Some((span, message)) = nested(&item) {
        return Err(syn::Error::new(span, message));
    }
    let path = syn::parse2(path)?;
    (|input: ParseStream<'_>| OwnFunction::parse(path, input)).parse2(item)
}

fn declarations(input: ParseStream<'_>) -> syn::Result<Vec<Declaration>> {
    let mut all = Vec::new();
    while !input.is_empty() {
        let (attributes, visibility) = (input.call(syn::Attribute::parse_outer)?, input.parse()?);
        let example = "write `lie_group! { pub Shears = matrices { x: [0, 1; 0, 0] } }`";
        let name: Ident = input.parse().explained(format!("expected a name; {example}"))?;
        input.parse::<Token![=]>().explained(format!("expected `=`; {example}"))?;
        let (tokens, group) = definition(input)?;
        all.push(Declaration { attributes, visibility, name, group, tokens });
        if !input.is_empty() {
            input.parse::<Token![;]>().explained("expected `;` between groups")?;
        }
    }
    Ok(all)
}

/// A group with its tokens.
fn definition(input: ParseStream<'_>) -> syn::Result<(TokenStream, Group)> {
    let ahead = input.fork();
    let first = syn::ext::IdentExt::parse_any(input)?;
    let group = group(input, first)?;
    let mut tokens = TokenStream::new();
    while ahead.cursor() != input.cursor() {
        ahead.parse::<proc_macro2::TokenTree>()?.to_tokens(&mut tokens);
    }
    Ok((tokens, group))
}

impl Declaration {
    fn macro_rules(&self) -> TokenStream {
        let Self { attributes, visibility, name, tokens, .. } = self;
        // macros of other crates are found at the root alone: it has a name of its own there
        let hidden = format_ident!("__group_{}", name);
        let exported = matches!(visibility, Visibility::Public(_)).then(|| quote! { #[macro_export] });
        quote! {
            #exported
            #[doc(hidden)]
            macro_rules! #hidden {
                (($($callback:tt)*) $path:literal { $($known:tt)* } $attribute:tt $item:tt) => {
                    $($callback)*! { { $($known)* $path => #name = #tokens; } $attribute $item }
                };
            }
            #(#attributes)*
            #[allow(unused_imports)]
            #visibility use #hidden as #name;
        }
    }
}

/// The whole of `#[expression]`: the function, and a macro that hands it to systems.
pub fn expression(attribute: TokenStream, item: TokenStream) -> TokenStream {
    if let Some((span, message)) = nested(&item) {
        return syn::Error::new(span, message).into_compile_error();
    }
    let macro_rules = function_macro(attribute, item.clone()).unwrap_or_else(syn::Error::into_compile_error);
    quote! { #item #macro_rules }
}

fn function_macro(attribute: TokenStream, item: TokenStream) -> syn::Result<TokenStream> {
    if !attribute.is_empty() {
        return Err(syn::Error::new_spanned(attribute, "`#[expression]` takes nothing"));
    }
    let ItemFn { vis, sig, block, .. } =
        syn::parse2(item).explained("`#[expression]` stands above a function")?;
    if !sig.generics.params.is_empty() {
        return Err(syn::Error::new_spanned(sig.generics, "write the types of an expression's arguments"));
    }
    let (name, hidden) = (&sig.ident, format_ident!("__function_{}", sig.ident));
    // it is known in its crate
    let visibility = match vis {
        Visibility::Public(_) => quote! { pub(crate) },
        vis => quote! { #vis },
    };
    Ok(quote! {
        #[doc(hidden)]
        #[allow(unused_macros)]
        macro_rules! #hidden {
            (($($callback:tt)*) $path:literal { $($known:tt)* } $attribute:tt $item:tt) => {
                $($callback)*! { { $($known)* $path => #sig #block; } $attribute $item }
            };
        }
        #[allow(unused_imports)]
        #visibility use #hidden as #name;
    })
}

/// Asks for the first definition that a system needs and that is not known; nothing if none is missing.
pub(crate) fn request_definition(
    attribute: &Attribute,
    known: &TokenStream,
    attribute_tokens: &TokenStream,
    item: &TokenStream,
) -> Option<TokenStream> {
    let own = attribute.factors.iter().flat_map(|factor| factor.group.own());
    let inner = attribute.definitions.iter().flat_map(|definition| definition.group.own());
    let is_missing = |path: &&syn::Path| {
        let text = path.to_token_stream().to_string();
        attribute.definitions.iter().all(|definition| definition.path != text)
    };
    let group = own.chain(inner).find(is_missing).cloned();
    let path = group.or_else(|| missing_function(attribute))?;
    let text = Literal::string(&path.to_token_stream().to_string());
    let krate = attribute.krate.as_ref().map_or_else(|| quote! { ::coadjoint }, ToTokens::to_token_stream);
    Some(quote! {
        #path! { (#krate::__private::lie_poisson_system_with) #text { #known } { #attribute_tokens } { #item } }
    })
}

/// The first function that expressions call, or that one of those calls, and that is not known.
fn missing_function(attribute: &Attribute) -> Option<syn::Path> {
    let energies = attribute.energies.iter().map(|(_, value)| value);
    let events = attribute.events.iter().map(|event| &event.value);
    let values = energies.chain(attribute.forces.iter().map(|force| &force.value)).chain(events);
    let called = values.flat_map(|value| calls(value.to_token_stream()));
    let mut called = called.chain(attribute.functions.iter().flat_map(OwnFunction::calls));
    called.find(|path| attribute.functions.iter().all(|function| function.path != *path))
}

/// Definitions of groups and of functions.
pub(crate) type Definitions = (Vec<Definition>, Vec<OwnFunction>);

/// Reads what such a macro hands back: the definitions, and the tokens of these, of the attribute and of the item.
pub(crate) fn answer(input: TokenStream) -> syn::Result<(Definitions, [TokenStream; 3])> {
    let read = |input: ParseStream<'_>| {
        let part = || input.parse::<Tokens>().map(|group| group.stream());
        let (known, attribute, item) = (part()?, part()?, part()?);
        Ok((definitions.parse2(known.clone())?, [known, attribute, item]))
    };
    read.parse2(input)
}

/// `"Shears" => Shears = matrices { … }; "density" => fn density(h: f64) -> f64 { … };`, and others.
fn definitions(input: ParseStream<'_>) -> syn::Result<Definitions> {
    let (mut groups, mut functions) = (Vec::new(), Vec::new());
    while !input.is_empty() {
        let path: LitStr = input.parse()?;
        input.parse::<Token![=>]>()?;
        if input.peek(Token![fn]) || input.peek(Token![const]) {
            functions.push(OwnFunction::parse(path.parse()?, input)?);
        } else {
            let name = input.parse()?;
            input.parse::<Token![=]>()?;
            let (_, group) = definition(input)?;
            groups.push(Definition { path: path.value(), name, group });
        }
        input.parse::<Token![;]>()?;
    }
    Ok((groups, functions))
}
