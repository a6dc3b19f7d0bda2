//! Straight-line code as Rust.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

use super::{Names, StepExpansion, docs};
use crate::expr::{Function, Number};
use crate::kernel::{Kernel, Section, Statement, SymbolNames, Term};
use crate::method::{Member, Rule, Scheme};
use crate::model::System;

/// Where the values of a kernel's arrays have their names from.
pub struct Layout {
    /// The parameters, in order.
    pub parameters: Vec<String>,
    /// The state's components, in order.
    pub state: Vec<String>,
    /// The time.
    pub time: String,
    /// The controls' components, in order.
    pub control: Vec<String>,
}

impl Layout {
    /// The layout of a system's arrays, by the names of its symbols in some code.
    pub(super) fn new(system: &System<'_>, names: &SymbolNames) -> Self {
        let all = |symbols: Vec<crate::expr::Symbol>| symbols.into_iter().map(|s| names.get(s)).collect();
        Self {
            parameters: all(system.parameter_symbols()),
            state: all(system.state_symbols()),
            time: all(system.time_symbol()).concat(),
            control: all(system.control_symbols()),
        }
    }
}

/// An array's length, without a suffix.
pub(super) fn size(length: usize) -> Literal {
    Literal::usize_unsuffixed(length)
}

/// A name of the kernel's own making.
pub(super) fn local(name: &str) -> Ident {
    Ident::new(name, Span::mixed_site())
}

/// What the struct with a kernel's constants is called.
pub(super) fn kernel_name(names: &Names, scheme: Scheme) -> Ident {
    // at the place of the macro, not of the user's name, whose style is then not ours to answer for
    format_ident!("{}{}", names.system.to_string().trim_start_matches("r#"), scheme.name())
}

/// The kernel of one system and scheme:
///
/// ```text
/// pub struct HeavyTopCayley<T> { …constants }
/// impl Generated<Family<Cayley, 0, 1>> for HeavyTop { type Kernel<T: Scalar> = HeavyTopCayley<T>; }
///
/// const _: () = {
///     pub struct Step<T> { … }
///     pub struct Iterate<T> { … }
///     impl<T: Scalar> Kernel<T> for HeavyTopCayley<T> { … }
/// };
/// ```
///
/// The inner block does not name the system, which may be called `Step` or `Kernel`, too.
pub(super) fn kernel(
    names: &Names,
    scheme: Scheme,
    aliases: &[Scheme],
    kernel: &Kernel,
    layout: &Layout,
) -> TokenStream {
    let Names { system, private, .. } = names;
    let name = kernel_name(names, scheme);
    let markers = std::iter::once(scheme).chain(aliases.iter().copied()).map(|scheme| marker(names, scheme));
    let controls = size(layout.control.len());
    let count = kernel.unknown.len();
    let (parameters, state, unknown) = (size(layout.parameters.len()), size(layout.state.len()), size(count));

    let constants =
        fields(&name, "What depends on the parameters and the step `h` alone.", &kernel.constants);
    let step_name = format_ident!("Step");
    let step = fields(&step_name, "What depends on the state too.", &kernel.step);
    let iterate_name = format_ident!("Iterate");
    let iterate =
        fields(&iterate_name, "What depends on the unknown too and is needed again.", &kernel.iterate);

    let inputs = Inputs { kernel, layout, name: &name };
    let body = |section: &Section, result: TokenStream| {
        let unpack = inputs.unpack(section);
        let statements = section.statements.iter().map(statement);
        quote! { #unpack #(#statements)* #result }
    };
    let array = |results: &[Term]| {
        let results = results.iter().map(term);
        quote! { [#(#results),*] }
    };

    let new = body(&kernel.new, keep(&name, &kernel.constants));
    let begin = body(&kernel.begin, keep(&step_name, &kernel.step));
    let start = body(&kernel.start, array(&kernel.start.results));
    let (residual, right) = kernel.evaluate.results.split_at(count);
    let (residual, right) = (array(residual), array(right));
    let kept = keep(&iterate_name, &kernel.iterate);
    let evaluate =
        body(&kernel.evaluate, quote! { Evaluation { residual: #residual, right: #right, iterate: #kept } });
    let correction = body(&kernel.correction, array(&kernel.correction.results));
    let sweep = if kernel.sweep.results.is_empty() {
        quote! { const SWEEPS: ::core::primitive::bool = false; }
    } else {
        let doc = docs::line(&format!("The solution of `left(x) = right`: {}.", kernel.sweep.operations()));
        let next = array(&kernel.sweep.results);
        let sweep = body(&kernel.sweep, quote! { ::core::option::Option::Some(#next) });
        quote! {
            #doc
            #[inline(always)]
            fn sweep(
                &self,
                state: &[T; #state],
                step: &Step<T>,
                right: &[T; #unknown],
            ) -> ::core::option::Option<[T; #unknown]> {
                #sweep
            }
        }
    };
    let finish = body(&kernel.finish, array(&kernel.finish.results));

    let [new_doc, begin_doc, start_doc, evaluate_doc, correction_doc, finish_doc] = [
        ("Once, when the stepper is built", &kernel.new),
        ("Once a step", &kernel.begin),
        ("A first approximation of the unknown", &kernel.start),
        ("Once an iteration: the residual and the right side of the equation", &kernel.evaluate),
        ("Once an iteration: the Newton correction", &kernel.correction),
        ("Once a step: the next state", &kernel.finish),
    ]
    .map(|(what, section)| docs::line(&format!("{what}: {}.", section.operations())));
    let margins = kernel.domain.results.iter().map(term);
    let domain = margins.reduce(|a, b| quote! { T::min(#a, #b) }).map(|margin| {
        let domain = body(&kernel.domain, quote! { ::core::option::Option::Some(#margin) });
        quote! {
            /// Positive within the retraction's domain.
            #[inline(always)]
            fn domain(
                &self,
                state: &[T; #state],
                step: &Step<T>,
                unknown: &[T; #unknown],
                evaluation: &Evaluation<[T; #unknown], Iterate<T>>,
            ) -> ::core::option::Option<T> {
                #domain
            }
        }
    });
    let bounded = kernel.bounded.iter().enumerate().filter(|&(_, &bounded)| bounded);
    let bounded: Vec<Literal> = bounded.map(|(component, _)| Literal::usize_unsuffixed(component)).collect();
    let bounded = (!bounded.is_empty()).then(|| {
        quote! {
            /// Rotations stay of unit length.
            #[inline(always)]
            fn is_bounded(component: usize) -> bool {
                ::core::matches!(component, #(#bounded)|*)
            }
        }
    });

    let blocks = kernel.blocks.iter().map(|&length| Literal::usize_unsuffixed(length));

    quote! {
            #constants

            #(#[automatically_derived]
            impl #private::Generated<#markers> for #system {
                type Kernel<T: #private::Scalar> = #name<T>;
            })*

            const _: () = {
            use #private::{Evaluation, Kernel, Scalar};

            #step
            #iterate

            #[automatically_derived]
            impl<T: Scalar> Kernel<T> for #name<T> {
                type Parameters = [T; #parameters];
                type State = [T; #state];
                type Control = [T; #controls];
                type Unknown = [T; #unknown];
                type Step = Step<T>;
                type Iterate = Iterate<T>;

                const BLOCKS: &'static [::core::primitive::usize] = &[#(#blocks),*];

                #new_doc
                fn new(parameters: &[T; #parameters], step: T) -> Self {
                    #new
                }

                #begin_doc
                #[inline(always)]
                fn begin(&self, state: &[T; #state], time: T, control: &[T; #controls]) -> Step<T> {
                    #begin
                }

                #start_doc
                fn start(&self, state: &[T; #state], step: &Step<T>) -> [T; #unknown] {
                    #start
                }

                #evaluate_doc
                #[inline(always)]
                fn evaluate(
                    &self,
                    state: &[T; #state],
                    step: &Step<T>,
                    unknown: &[T; #unknown],
                ) -> Evaluation<[T; #unknown], Iterate<T>> {
                    #evaluate
                }

                #correction_doc
                #[inline(always)]
                fn correction(
                    &self,
                    state: &[T; #state],
                    step: &Step<T>,
                    unknown: &[T; #unknown],
                    evaluation: &Evaluation<[T; #unknown], Iterate<T>>,
                ) -> [T; #unknown] {
                    #correction
                }

                #sweep

                #domain

                #finish_doc
                #[inline(always)]
                fn finish(
                    &self,
                    state: &[T; #state],
                    step: &Step<T>,
                    unknown: &[T; #unknown],
                    evaluation: &Evaluation<[T; #unknown], Iterate<T>>,
                ) -> [T; #state] {
                    #finish
                }

                #bounded
            }

            };
    }
}

/// The type that stands for a scheme: `Family<Cayley, 0, 1>`.
pub(super) fn marker(names: &Names, scheme: Scheme) -> TokenStream {
    let Names { private, coadjoint, .. } = names;
    let retraction = format_ident!("{}", scheme.retraction.name());
    match scheme.rule {
        Rule::Family(member) => {
            let (n, d) = (member.numerator, member.denominator);
            let (n, d) = (Literal::u32_unsuffixed(n), Literal::u32_unsuffixed(d));
            quote! { #private::Family<#coadjoint::#retraction, #n, #d> }
        }
        Rule::TangentLift => quote! { #private::TangentLift<#coadjoint::#retraction> },
    }
}

/// `impl Schemes for HeavyTop { … }`: shows a visitor the type of the step that is asked for. `impl Retracted<Cayley> for HeavyTop { … }` for each
/// retraction that there is.
pub(super) fn schemes(names: &Names, steps: &[StepExpansion]) -> TokenStream {
    let Names { system, private, coadjoint, .. } = names;
    let mut retractions: Vec<_> = steps.iter().map(|step| step.scheme.retraction.name()).collect();
    retractions.dedup();
    let retracted = retractions.into_iter().map(|retraction| {
        let retraction = format_ident!("{retraction}");
        quote! {
            #[automatically_derived]
            impl #private::Retracted<#coadjoint::#retraction> for #system {
                type Scheme = <Self as #private::System>::Standard<#coadjoint::#retraction>;
            }
        }
    });
    let arms = steps.iter().map(|StepExpansion { scheme, aliases, .. }| {
        let map = format_ident!("{}", scheme.retraction.name());
        let rules = std::iter::once(scheme).chain(aliases).map(|scheme| match scheme.rule {
            Rule::Family(Member { numerator, denominator }) => {
                let (n, d) = (Literal::u32_unsuffixed(numerator), Literal::u32_unsuffixed(denominator));
                quote! { #private::Rule::Member(#n, #d) }
            }
            Rule::TangentLift => quote! { #private::Rule::TangentLift },
        });
        let marker = marker(names, *scheme);
        quote! { (#private::Map::#map, #(#rules)|*) => #private::Visitor::visit::<#marker>(visitor) }
    });
    let schemes = quote! {
        #(#retracted)*

        #[automatically_derived]
        impl #private::Schemes for #system {
            #[inline]
            fn visit<V: #private::Visitor<Self>>(
                map: #private::Map,
                rule: #private::Rule,
                visitor: V,
            ) -> ::core::option::Option<V::Output> {
                ::core::option::Option::Some(match (map, rule) {
                    #(#arms,)*
                    _ => return ::core::option::Option::None,
                })
            }
        }
    };
    block(&schemes)
}

/// What belongs to one scheme, in a block of its own.
pub(super) fn block(content: &TokenStream) -> TokenStream {
    quote! {
        #[allow(unreachable_pub, unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #content
        };
    }
}

/// A free function of arrays and, where its name is given, the time:
/// `fn name<T: Scalar>(parameters: &[T; P], state: &[T; S], time: T) -> [T; N] { … }`
pub(super) fn function(
    name: &str,
    private: &TokenStream,
    section: &Section,
    arrays: &[(&str, Vec<String>)],
    time: Option<&str>,
) -> TokenStream {
    let name = format_ident!("{name}");
    let count = size(section.results.len());
    let arguments = arrays.iter().map(|(array, names)| {
        let (array, n) = (format_ident!("{array}"), size(names.len()));
        quote! { #array: &[T; #n] }
    });
    let unpack = arrays.iter().map(|(array, names)| unpack_array(array, names, section));
    let unpack_time = time.map(|name| unpack_time(name, section));
    let time = time.map(|_| quote! { , time: T });
    let statements = section.statements.iter().map(statement);
    let results = section.results.iter().map(term);
    quote! {
        #[inline]
        fn #name<T: #private::Scalar>(#(#arguments),* #time) -> [T; #count] {
            #(#unpack)*
            #unpack_time
            #(#statements)*
            [#(#results),*]
        }
    }
}

/// A struct of named scalars.
pub(super) fn fields(name: &Ident, doc: &str, fields: &[String]) -> TokenStream {
    let doc = docs::line(doc);
    if fields.is_empty() {
        return quote! {
            #doc
            #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
            pub struct #name<T>(::core::marker::PhantomData<T>);
        };
    }
    let fields = fields.iter().map(|field| local(field));
    quote! {
        #doc
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
        pub struct #name<T> { #(#fields: T),* }
    }
}

/// A struct of [`fields`] with the values that are called so.
pub(super) fn keep(name: &Ident, values: &[String]) -> TokenStream {
    let values = values.iter().map(|value| local(value));
    match values.len() {
        0 => quote! { #name(::core::marker::PhantomData) },
        _ => quote! { #name { #(#values),* } },
    }
}

/// `let Step { s0, s1, .. } = *step;` with those that a section uses.
pub(super) fn unpack_fields(
    pattern: &TokenStream,
    names: &[String],
    section: &Section,
    from: &TokenStream,
) -> TokenStream {
    let used: Vec<Ident> =
        names.iter().filter(|name| section.inputs.contains(name)).map(|name| local(name)).collect();
    match used.len() {
        0 => quote! {},
        all if all == names.len() => quote! { let #pattern { #(#used),* } = #from; },
        _ => quote! { let #pattern { #(#used),*, .. } = #from; },
    }
}

/// What the functions of one kernel can take their inputs from.
struct Inputs<'k> {
    kernel: &'k Kernel,
    layout: &'k Layout,
    name: &'k Ident,
}

impl Inputs<'_> {
    /// `let` patterns that give a section the values it uses.
    fn unpack(&self, section: &Section) -> TokenStream {
        let Self { kernel, layout, name } = self;
        let fields = |pattern: TokenStream, names: &[String], from: TokenStream| {
            unpack_fields(&pattern, names, section, &from)
        };
        let is = |other: &Section| std::ptr::eq(section, other);
        if is(&kernel.new) {
            let step = self.kernel.h.as_ref().map(|h| {
                let h = local(h);
                quote! { let #h = step; }
            });
            let parameters = unpack_array("parameters", &layout.parameters, section);
            return quote! { #parameters #step };
        }
        let constants = fields(quote! { #name }, &kernel.constants, quote! { *self });
        let state = unpack_array("state", &layout.state, section);
        if is(&kernel.begin) {
            let time = unpack_time(&layout.time, section);
            let control = unpack_array("control", &layout.control, section);
            return quote! { #constants #state #time #control };
        }
        let step = fields(quote! { Step }, &kernel.step, quote! { *step });
        if is(&kernel.start) {
            return quote! { #constants #state #step };
        }
        if is(&kernel.sweep) {
            let right = unpack_array("right", &kernel.right, section);
            return quote! { #constants #state #step #right };
        }
        let unknown = unpack_array("unknown", &kernel.unknown, section);
        if is(&kernel.evaluate) {
            return quote! { #constants #state #step #unknown };
        }
        let residual = unpack_array_from(quote! { evaluation.residual }, &kernel.residual, section);
        let iterate = fields(quote! { Iterate }, &kernel.iterate, quote! { evaluation.iterate });
        quote! { #constants #state #step #unknown #residual #iterate }
    }
}

/// `let t = time;`
pub(super) fn unpack_time(name: &str, section: &Section) -> TokenStream {
    if !section.inputs.iter().any(|input| input == name) {
        return quote! {};
    }
    let name = local(name);
    quote! { let #name = time; }
}

pub(super) fn unpack_array(array: &str, names: &[String], section: &Section) -> TokenStream {
    let array = format_ident!("{array}");
    unpack_array_from(quote! { *#array }, names, section)
}

/// `let [_, momentum_x, ..] = *state;` with the names that are used.
fn unpack_array_from(array: TokenStream, names: &[String], section: &Section) -> TokenStream {
    let used = |name: &&String| section.inputs.contains(*name);
    let Some(last) = names.iter().rposition(|name| used(&name)) else { return quote! {} };
    let patterns = names[..=last].iter().map(|name| {
        if used(&name) {
            let name = local(name);
            quote! { #name }
        } else {
            quote! { _ }
        }
    });
    let rest = (last + 1 < names.len()).then(|| quote! { , .. });
    quote! { let [#(#patterns),* #rest] = #array; }
}

pub(super) fn statement(statement: &Statement) -> TokenStream {
    match statement {
        Statement::Let { name, value } => {
            let (name, value) = (local(name), term(value));
            quote! { let #name = #value; }
        }
        Statement::Stumpff { names, argument } => {
            let names = names.iter().map(|name| match name {
                Some(name) => {
                    let name = local(name);
                    quote! { #name }
                }
                None => quote! { _ },
            });
            let argument = term(argument);
            quote! { let [#(#names),*] = T::stumpff(#argument); }
        }
    }
}

/// How tightly an operator binds.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Unary,
}

pub(super) fn term(value: &Term) -> TokenStream {
    bound(value, Binding::Sum)
}

/// The term, in parentheses if what is around binds more tightly. What a product is added to is told, by `plus` or `minus`: processors have an
/// instruction for both together.
fn bound(value: &Term, around: Binding) -> TokenStream {
    let (tokens, binding) = match value {
        Term::Number(number) => (constant(*number), Binding::Unary),
        Term::Name(name) => {
            let name = local(name);
            (quote! { #name }, Binding::Unary)
        }
        Term::Negative(x) => {
            let x = bound(x, Binding::Unary);
            (quote! { -#x }, Binding::Product)
        }
        Term::Sum(addends) => {
            // the grouping of a sum within a sum is meant
            let first =
                addends.first().map_or_else(Default::default, |(_, first)| bound(first, Binding::Product));
            let is_name = matches!(addends.first(), Some((_, Term::Name(_) | Term::Number(_))));
            let start = (first, if is_name { Binding::Unary } else { Binding::Product });
            addends.iter().skip(1).fold(start, |(sum, binding), (negative, addend)| match addend {
                Term::Product(factors) => {
                    let (last, others) = match factors.split_last() {
                        Some((last, others)) => (bound(last, Binding::Sum), product(others)),
                        None => Default::default(),
                    };
                    let sum = parenthesized(sum, binding, Binding::Unary);
                    let method = if *negative { format_ident!("minus") } else { format_ident!("plus") };
                    (quote! { #sum.#method(#others, #last) }, Binding::Unary)
                }
                _ => {
                    let addend = bound(addend, Binding::Product);
                    let operator = if *negative {
                        quote! { - }
                    } else {
                        quote! { + }
                    };
                    (quote! { #sum #operator #addend }, Binding::Sum)
                }
            })
        }
        Term::Product(factors) => (product(factors), Binding::Product),
        Term::Quotient(x, y) => {
            let (x, y) = (bound(x, Binding::Product), bound(y, Binding::Unary));
            (quote! { #x / #y }, Binding::Product)
        }
        Term::Function(function, x) => {
            let name = format_ident!("{}", function.name());
            let x = bound(x, Binding::Sum);
            debug_assert!(!matches!(function, Function::Stumpff(_)));
            (quote! { T::#name(#x) }, Binding::Unary)
        }
        Term::Power(x, y) => {
            let (x, y) = (term(x), term(y));
            (quote! { T::powf(#x, #y) }, Binding::Unary)
        }
        Term::Atan2(y, x) => {
            let (y, x) = (term(y), term(x));
            (quote! { T::atan2(#y, #x) }, Binding::Unary)
        }
    };
    parenthesized(tokens, binding, around)
}

fn parenthesized(tokens: TokenStream, binding: Binding, around: Binding) -> TokenStream {
    if binding < around {
        quote! { (#tokens) }
    } else {
        tokens
    }
}

/// `a * b * …`
fn product(factors: &[Term]) -> TokenStream {
    let factors = factors.iter().map(|factor| bound(factor, Binding::Unary));
    factors.reduce(|product, factor| quote! { #product * #factor }).unwrap_or_default()
}

/// `T::of(0.5)`; fractions that are not doubles are left to the compiler to round.
fn constant(number: Number) -> TokenStream {
    let value = number.to_f64();
    let float = |x: f64| {
        let literal = Literal::f64_unsuffixed(x.abs());
        if x < 0.0 {
            quote! { -#literal }
        } else {
            quote! { #literal }
        }
    };
    match number.fraction() {
        Some((numerator, denominator)) if denominator & (denominator - 1) != 0 => {
            let (numerator, denominator) = (float(numerator as f64), float(denominator as f64));
            quote! { T::of(#numerator / #denominator) }
        }
        _ if value.is_finite() => {
            let value = float(value);
            quote! { T::of(#value) }
        }
        _ => quote! { T::of(::core::primitive::f64::NAN) },
    }
}
