//! Derivatives of steps as Rust.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::code::{array, arrays, body, inlined, kept, record, size};
use super::docs;
use super::kernel::kernel_name;
use super::names::Names;
use crate::program::{DerivativeRole, Function, FunctionRole, Input, Module, RecordKind, Term};
use crate::scheme::Scheme;

/// The derivative of one scheme's step, to stand beside its kernel:
///
/// ```text
/// const _: () = {
///     impl<T: Scalar> Linearized<T, HeavyTop> for HeavyTopCayley<T> { … }
/// };
/// ```
///
/// What stands in it does not name the system, which may be called `Linearized`, too.
pub(super) fn derivative(
    names: &Names,
    scheme: Scheme,
    module: &Module<DerivativeRole>,
    lengths: &Lengths,
) -> TokenStream {
    let Names { private, system: system_name, .. } = names;
    let kernel = kernel_name(names, scheme);
    let point = record(&module.values, RecordKind::Point);
    let maps = Maps { module, lengths, private };
    let through = maps.through_type();
    let functions = module.functions.iter().map(|function| maps.method(function));
    let no_through = module.function(DerivativeRole::Through).is_none().then(|| {
        quote! {
            #[inline]
            fn through(_: &Self::Point) -> #through {
                []
            }
        }
    });
    quote! {
        type __System = #system_name;

        const _: () = {
            use #private::{Linearized, Scalar};

            #[automatically_derived]
            impl<T: Scalar> Linearized<T, __System> for #kernel<T> {
                type Point = #point;
                type Through = #through;

                #(#functions)*
                #no_through
            }
        };
    }
}

/// How long the perturbations are, whether or not a derivative is asked for by them.
pub(super) struct Lengths {
    /// Of the state.
    pub state: usize,
    /// Of the controls.
    pub controls: usize,
    /// Of the parameters.
    pub parameters: usize,
}

/// The functions of one derivative.
struct Maps<'m> {
    module: &'m Module<DerivativeRole>,
    lengths: &'m Lengths,
    private: &'m TokenStream,
}

impl Maps<'_> {
    fn method(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let operations = function.operations();
        let method = match function.role {
            DerivativeRole::Point => self.point(function),
            DerivativeRole::Tangent => self.tangent(function),
            DerivativeRole::Adjoint => self.adjoint(function),
            DerivativeRole::Through => self.through(function),
            DerivativeRole::WrtState => self.matrix(function, self.lengths.state),
            DerivativeRole::WrtControl => self.matrix(function, self.lengths.controls),
            DerivativeRole::WrtParameters => self.matrix(function, self.lengths.parameters),
        };
        let purpose = function.role.signature().purpose;
        let doc = docs::line(&format!("{purpose}: {operations}."));
        let inlined = inlined();
        quote! {
            #doc
            #inlined
            #method
        }
    }

    /// `fn point(…) -> Self::Point { … }`
    fn point(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let body = body(&self.module.values, function);
        let kept = kept(&self.module.values, RecordKind::Point);
        let [parameters, state, control, unknown] =
            [Input::Parameters, Input::State, Input::Control, Input::Unknown]
                .map(|input| size(function.length(input)));
        quote! {
            fn point(
                parameters: &[T; #parameters],
                step: T,
                state: &[T; #state],
                time: T,
                control: &[T; #control],
                unknown: &[T; #unknown],
            ) -> Self::Point {
                #body
                #kept
            }
        }
    }

    /// The lengths of the perturbations of state, controls and parameters.
    fn sizes(&self) -> [proc_macro2::Literal; 3] {
        let Lengths { state, controls, parameters } = *self.lengths;
        [state, controls, parameters].map(size)
    }

    /// The product with a perturbation.
    fn tangent(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let [state, control, parameters] = self.sizes();
        let (body, next) = (body(&self.module.values, function), arrays(&self.module.values, function));
        quote! {
            fn tangent(
                point: &Self::Point,
                state: &[T; #state],
                control: &[T; #control],
                parameters: &[T; #parameters],
            ) -> [T; #state] {
                #body
                #(#next)*
            }
        }
    }

    /// The product with a costate.
    fn adjoint(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let [state, control, parameters] = self.sizes();
        let (body, by) = (body(&self.module.values, function), arrays(&self.module.values, function));
        quote! {
            fn adjoint(
                point: &Self::Point,
                costate: &[T; #state],
            ) -> ([T; #state], [T; #control], [T; #parameters]) {
                #body
                (#(#by),*)
            }
        }
    }

    /// The derivative with respect to the unknown.
    fn through(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let ty = self.through_type();
        let (body, columns) = (body(&self.module.values, function), arrays(&self.module.values, function));
        quote! {
            fn through(point: &Self::Point) -> #ty {
                #body
                [#(#columns),*]
            }
        }
    }

    /// The columns of the derivative with respect to the unknown; none where no matrix needs them.
    fn through_type(&self) -> TokenStream {
        let columns =
            self.module.function(DerivativeRole::Through).map_or(0, |function| function.results.len());
        let (n, columns) = (size(self.lengths.state), size(columns));
        quote! { [[T; #n]; #columns] }
    }

    /// A matrix, column by column: `explicit + through · unknown`.
    fn matrix(&self, function: &Function<DerivativeRole>, columns: usize) -> TokenStream {
        let Self { module, private, .. } = *self;
        let name = format_ident!("{}", function.role.name());
        let (n, columns) = (size(self.lengths.state), size(columns));
        let (body, through) = (body(&module.values, function), self.through_type());
        let pairs = function.results.chunks(2).enumerate();
        let (explicit, products): (Vec<TokenStream>, Vec<TokenStream>) = pairs
            .map(|(j, column)| {
                let [explicit, unknown] = [0, 1].map(|k| column.get(k).map_or(&[][..], Vec::as_slice));
                let is_zero = |x: &Term| matches!(x, Term::Number(number) if number.is_zero());
                let (place, none) = (size(j), unknown.iter().all(is_zero));
                let unknown = array(&module.values, unknown);
                let add = quote! { #private::add_product(&mut columns[#place], through, &#unknown); };
                (array(&module.values, explicit), if none { TokenStream::new() } else { add })
            })
            .unzip();
        quote! {
            fn #name(point: &Self::Point, through: &#through) -> [[T; #n]; #columns] {
                #body
                let mut columns = [#(#explicit),*];
                #(#products)*
                columns
            }
        }
    }
}
