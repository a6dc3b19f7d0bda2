//! The user's expressions as methods: rustc checks their types, and tools find their way in them.

use std::ops::Range;

use proc_macro2::{Group, Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};

use super::code::size;
use super::docs;
use super::names::Names;
use super::state::kind_type;
use crate::identifiers::{plain, velocity_name};
use crate::model::{EnergySource, EventSource, Factors, ForceForm, ForceSource, Name, System, parts};
use crate::parse::EnergyRow;
use crate::program::Interface;
use crate::quantity::Kind;

/// `impl HeavyTop { pub fn potential(&self, state: &HeavyTopState) -> f64 { … } }`
pub(super) fn expressions(system: &System<'_>, interface: &Interface, names: &Names) -> TokenStream {
    let energy = |source: &EnergySource| {
        let EnergySource { key, value, has_meaning } = source;
        let EnergyRow { name, doc, has_velocity, .. } = key.row();
        let (result, has_meaning) = (names.scalar.clone(), *has_meaning);
        let controls = wholes(system.controls.iter().map(|part| &part.name));
        let has_controls =
            controls.iter().any(|name| mentioned(value.to_token_stream(), &name.to_string()).is_some());
        let energy = Method { doc, name, value, result, has_meaning, has_velocity, has_controls };
        method(system, interface, names, energy)
    };
    let mut methods: Vec<TokenStream> = system.sources.energies.iter().map(energy).collect();
    let event = |source: &EventSource| {
        let EventSource { name, value, has_meaning } = source;
        let (doc, name) = (format!("What is zero at the event `{name}`."), format!("event_{name}"));
        let (result, has_meaning) = (names.scalar.clone(), *has_meaning);
        let (has_velocity, has_controls) = (true, true);
        let event = Method { doc: &doc, name: &name, value, result, has_meaning, has_velocity, has_controls };
        method(system, interface, names, event)
    };
    methods.extend(system.sources.forces.iter().map(|force| force_method(system, interface, names, force)));
    methods.extend(system.sources.events.iter().map(event));
    if methods.is_empty() {
        return quote! {};
    }
    let name = &names.system;
    quote! { impl #name { #(#methods)* } }
}

/// The force on a factor, or those on an array of them.
fn force_method(
    system: &System<'_>,
    interface: &Interface,
    names: &Names,
    force: &ForceSource,
) -> TokenStream {
    let start = force.factors.indices().start;
    let factor = &system.factors[start];
    let one = force_type(system, start, force.form, names);
    let (name, doc, result) = match &force.factors {
        Factors::One(_) if system.factors.len() == 1 => {
            ("force".to_owned(), "The body force on the momentum, as described.".to_owned(), one)
        }
        Factors::One(_) => {
            let doc = format!("The body force on the momentum of `{}`, as described.", factor.name.written());
            (format!("force_{}", factor.name.plain()), doc, one)
        }
        Factors::All(all) => {
            let (whole, length) = (plain(&factor.name.ident), size(all.len()));
            let doc = format!("The body forces on the momenta of `{whole}`, as described.");
            (format!("force_{whole}"), doc, quote! { [#one; #length] })
        }
    };
    let (has_velocity, has_controls) = (true, true);
    let (value, has_meaning) = (&force.value, force.form.is_some());
    let force = Method { doc: &doc, name: &name, value, result, has_meaning, has_velocity, has_controls };
    method(system, interface, names, force)
}

/// The type of a force on a factor as it is written.
fn force_type(system: &System<'_>, factor: usize, form: Option<ForceForm>, names: &Names) -> TokenStream {
    let group = system.group.factors[factor].group;
    match form {
        Some(ForceForm::Scalar) => names.scalar.clone(),
        Some(ForceForm::Parts) => {
            let parts = group.blocks().into_iter().map(|length| {
                let kind = if length == 1 { Kind::Scalar } else { Kind::Vector(length) };
                kind_type(kind, names)
            });
            quote! { (#(#parts),*) }
        }
        Some(ForceForm::Vector) | None => kind_type(Kind::Vector(group.dimension()), names),
    }
}

/// One of the methods.
struct Method<'m> {
    doc: &'m str,
    name: &'m str,
    /// The expression.
    value: &'m syn::Expr,
    /// Its type.
    result: TokenStream,
    /// Whether it has a meaning; one that has none was reported and is not shown to rustc, but what calls the method
    /// finds it.
    has_meaning: bool,
    /// Whether it may use velocities.
    has_velocity: bool,
    /// Whether it is given the controls, if there are any.
    has_controls: bool,
}

/// One expression as a method of the state, the controls if it has them, and the time if it uses it.
fn method(system: &System<'_>, interface: &Interface, names: &Names, method: Method<'_>) -> TokenStream {
    let Method { doc, name, value: expression, result, has_meaning, has_velocity, has_controls } = method;
    let Names { private, scalar, visibility, state: state_type, control: control_type, .. } = names;
    // names of the method's own, which no name of the user's can be
    let own = |name: &str| Ident::new(name, Span::mixed_site());
    let (state, control, velocity) = (own("state"), own("control"), own("velocity"));
    let name = format_ident!("{name}");
    let doc = docs::line(doc);

    let controlled = has_controls && !system.controls.is_empty();
    let control_argument = controlled.then(|| quote! { #control: &#control_type, });
    // the momentum, if a part of it is named
    let momentum_parts = momentum_parts(system, expression);
    let named = quote! { #momentum_parts #expression };
    let parts = system.parts();
    let state_parts = fields(quote! { #state_type }, &state, parts.iter().map(|part| &part.name), &named);
    let controls = system.controls.iter().map(|part| &part.name).filter(|_| controlled);
    let controls = fields(quote! { #control_type }, &control, controls, &named);
    let parameters = system.parameters.iter().map(|field| &field.name);
    let parameters = fields(quote! { Self }, &Ident::new("self", Span::call_site()), parameters, &named);

    let velocities =
        if has_velocity { velocities(system, expression, &velocity) } else { TokenStream::new() };
    let moves = !velocities.is_empty();
    let named = mentioned(expression.to_token_stream(), "t");
    let time = named.or_else(|| (moves && interface.is_velocity_timed).then(|| format_ident!("t")));
    let (time, time_argument) = match time {
        Some(t) => (quote! { #t }, quote! { #t: #scalar, }),
        None => (quote! { 0.0 }, TokenStream::new()),
    };
    let velocity = moves.then(|| {
        let control = match controlled {
            true => quote! { #control },
            false => quote! { &::core::default::Default::default() },
        };
        quote! { let #velocity = #private::System::velocity_at(self, #state, #time, #control); }
    });
    // as a statement, so that syn puts parentheses around a block in front of an operator
    let value = syn::Stmt::Expr(expression.clone(), None);
    let tables = mentioned(expression.to_token_stream(), "spline")
        .map(|_| quote! { #[allow(unused_imports)] use #private::Spline as _; });
    let limits = mentioned(expression.to_token_stream(), "clamp")
        .map(|_| quote! { #[allow(unused_imports)] use #private::Clamp as _; });
    let value = if has_meaning {
        clamped(quote! { #value })
    } else {
        quote! { loop {} }
    };
    quote! {
        #doc
        #[allow(dead_code, unused_variables, unused_parens, unused_braces, clippy::all)]
        #visibility fn #name(&self, #state: &#state_type, #control_argument #time_argument) -> #result {
            // the elementary functions of floats, where there is no std
            #[allow(unused_imports)]
            use #private::nalgebra::{ComplexField as _, RealField as _};
            #tables
            #limits
            #velocity
            #velocities
            #state_parts
            #momentum_parts
            #controls
            #parameters
            #value
        }
    }
}

/// An expression with the runtime's `__clamp` for `x.clamp(…)` and `f64::clamp(x, …)`, which panics where limits cross.
fn clamped(tokens: TokenStream) -> TokenStream {
    let mut before: [Option<TokenTree>; 3] = Default::default();
    let renamed = tokens.into_iter().map(|token| {
        let is = |token: &Option<TokenTree>, texts: &[&str]| {
            token.as_ref().is_some_and(|token| texts.contains(&token.to_string().as_str()))
        };
        let is_numbers = is(&before[2], &["."])
            || is(&before[2], &[":"]) && is(&before[1], &[":"]) && is(&before[0], &["f64", "f32"]);
        let token = match token {
            TokenTree::Ident(name) if name == "clamp" && is_numbers => {
                Ident::new("__clamp", name.span()).into()
            }
            TokenTree::Group(group) => {
                let mut inner = Group::new(group.delimiter(), clamped(group.stream()));
                inner.set_span(group.span());
                inner.into()
            }
            token => token,
        };
        before.rotate_left(1);
        before[2] = Some(token.clone());
        token
    });
    renamed.collect()
}

/// Variables for the fields of a struct, of an array one, that are named.
fn fields<'n>(
    of: TokenStream,
    whole: &Ident,
    names: impl Iterator<Item = &'n Name>,
    named: &TokenStream,
) -> Option<TokenStream> {
    let variables =
        wholes(names).into_iter().filter_map(|field| mentioned(named.clone(), &field.to_string()));
    let variables: Vec<Ident> = variables.collect();
    (!variables.is_empty()).then(|| quote! { let #of { #(#variables,)* .. } = *#whole; })
}

/// The names of fields, of an array once.
fn wholes<'n>(names: impl Iterator<Item = &'n Name>) -> Vec<&'n Ident> {
    names.filter(|name| name.is_first()).map(|name| &name.ident).collect()
}

/// The factors that have names of their own, and those of each array together.
fn declared<'s, 'a>(system: &'s System<'a>) -> impl Iterator<Item = Range<usize>> + use<'s, 'a> {
    let first = system.factors.iter().enumerate().filter(|(_, factor)| factor.name.is_first());
    first.map(|(start, factor)| start..start + factor.name.place.map_or(1, |place| place.length))
}

/// Variables for the velocities, and for their parts, that an expression names; `all` is the variable of all of them.
fn velocities(system: &System<'_>, expression: &syn::Expr, all: &Ident) -> TokenStream {
    let places = system.group.places();
    let of = |factors: Range<usize>| {
        let first = &system.factors[factors.start];
        let momentum = &first.momentum_name.ident;
        let parts = parts(system.group.factors[factors.start].group, momentum);
        let mut rows: Vec<_> =
            parts.into_iter().map(|part| (part.velocity, part.rows.len() == 1, part.rows)).collect();
        rows.push((velocity_name(momentum), false, 0..first.momentum.len()));
        let whole = |factor: usize| (quote! { #all }, places[factor].algebra.start);
        variables(system, expression, factors, rows, &whole)
    };
    declared(system).map(of).collect()
}

/// Variables for the parts of momenta that an expression names.
fn momentum_parts(system: &System<'_>, expression: &syn::Expr) -> TokenStream {
    let of = |factors: Range<usize>| {
        let momentum = &system.factors[factors.start].momentum_name.ident;
        let parts = parts(system.group.factors[factors.start].group, momentum);
        let rows = parts.into_iter().map(|part| (part.momentum, part.rows.len() == 1, part.rows)).collect();
        let whole = |factor: usize| match system.factors[factor].name.place {
            None => (quote! { #momentum }, 0),
            Some(place) => {
                let index = size(place.index);
                (quote! { #momentum[#index] }, 0)
            }
        };
        variables(system, expression, factors, rows, &whole)
    };
    declared(system).map(of).collect()
}

/// Variables for rows of a vector that each factor has, as far as an expression names them: `let angular_momentum = …;`,
/// of an array of factors an array. With each name stands whether it is a number; `whole` is a factor's vector, and where
/// it begins.
fn variables(
    system: &System<'_>,
    expression: &syn::Expr,
    factors: Range<usize>,
    rows: Vec<(String, bool, Range<usize>)>,
    whole: &dyn Fn(usize) -> (TokenStream, usize),
) -> TokenStream {
    let is_array = system.factors[factors.start].name.place.is_some();
    let variable = |(name, is_number, rows): (String, bool, Range<usize>)| {
        let name = mentioned(expression.to_token_stream(), &name)?;
        let values = factors.clone().map(|factor| {
            let (whole, start) = whole(factor);
            rows_of(&whole, start + rows.start..start + rows.end, is_number)
        });
        let value = if is_array {
            quote! { [#(#values),*] }
        } else {
            values.collect()
        };
        Some(quote! { let #name = #value; })
    };
    rows.into_iter().filter_map(variable).collect()
}

/// Some rows of a vector, or the one number that they are.
fn rows_of(whole: &TokenStream, rows: Range<usize>, is_number: bool) -> TokenStream {
    let (first, count) = (size(rows.start), size(rows.len()));
    if is_number {
        quote! { #whole[#first] }
    } else {
        quote! { #whole.fixed_rows::<#count>(#first).into_owned() }
    }
}

/// A name where it occurs first: a variable that is to be seen there has its hygiene.
fn mentioned(tokens: TokenStream, name: &str) -> Option<Ident> {
    tokens.into_iter().find_map(|token| match token {
        TokenTree::Ident(ident) if ident == name => Some(ident),
        TokenTree::Group(group) => mentioned(group.stream(), name),
        _ => None,
    })
}
