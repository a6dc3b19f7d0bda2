//! Derivatives of steps as Rust.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::code::{arguments, array, arrays, kept, method, record, size};
use super::kernel::kernel_name;
use super::names::Names;
use crate::program::{DerivativeRole, Function, FunctionRole, Interface, Module, RecordKind, Term};
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
    interface: &Interface,
) -> TokenStream {
    let Names { private, system: system_name, .. } = names;
    let kernel = kernel_name(names, scheme);
    let point = record(&module.values, RecordKind::Point);
    let maps = Maps { module, interface, private };
    let through = maps.through_type();
    let functions = module.functions.iter().map(|function| maps.method(function));
    let matrices = [DerivativeRole::WrtState, DerivativeRole::WrtControl, DerivativeRole::WrtParameters];
    let matrices = matrices.map(|role| module.function(role).is_some());
    let matrices = matrices.contains(&true).then(|| {
        quote! { const MATRICES: [::core::primitive::bool; 3] = [#(#matrices),*]; }
    });
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
                #matrices

                #(#functions)*
                #no_through
            }
        };
    }
}

/// The functions of one derivative.
struct Maps<'m> {
    module: &'m Module<DerivativeRole>,
    /// Tells how long perturbations are, whether or not a derivative is asked for by them.
    interface: &'m Interface,
    private: &'m TokenStream,
}

impl Maps<'_> {
    fn method(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let values = &self.module.values;
        let arrays = || arrays(values, function);
        let result = match function.role {
            DerivativeRole::Point => kept(values, RecordKind::Point),
            DerivativeRole::Tangent => arrays().into_iter().collect(),
            DerivativeRole::Adjoint => {
                let by = arrays();
                quote! { (#(#by),*) }
            }
            DerivativeRole::Through => {
                let columns = arrays();
                quote! { [#(#columns),*] }
            }
            DerivativeRole::WrtState | DerivativeRole::WrtControl | DerivativeRole::WrtParameters => {
                self.columns(function)
            }
        };
        method(values, function, &self.signature(function), &result)
    }

    fn signature(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let [state, control, parameters] = [
            self.interface.state_perturbation(),
            self.interface.control_length(),
            self.interface.field_length(),
        ]
        .map(size);
        let (given, through) = (arguments(function), self.through_type());
        let matrix = |columns: &Literal| {
            let name = format_ident!("{}", function.role.name());
            quote! { fn #name(#(#given,)* through: &#through) -> [[T; #state]; #columns] }
        };
        match function.role {
            DerivativeRole::Point => quote! { fn point(#(#given,)*) -> Self::Point },
            DerivativeRole::Tangent => quote! { fn tangent(#(#given,)*) -> [T; #state] },
            DerivativeRole::Adjoint => {
                quote! { fn adjoint(#(#given,)*) -> ([T; #state], [T; #control], [T; #parameters]) }
            }
            DerivativeRole::Through => quote! { fn through(#(#given),*) -> #through },
            DerivativeRole::WrtState => matrix(&state),
            DerivativeRole::WrtControl => matrix(&control),
            DerivativeRole::WrtParameters => matrix(&parameters),
        }
    }

    /// The columns of the derivative with respect to the unknown; none where no matrix needs them.
    fn through_type(&self) -> TokenStream {
        let columns =
            self.module.function(DerivativeRole::Through).map_or(0, |function| function.results.len());
        let (n, columns) = (size(self.interface.state_perturbation()), size(columns));
        quote! { [[T; #n]; #columns] }
    }

    /// A matrix, column by column: `explicit + through · unknown`.
    fn columns(&self, function: &Function<DerivativeRole>) -> TokenStream {
        let Self { module, private, .. } = *self;
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
            let mut columns = [#(#explicit),*];
            #(#products)*
            columns
        }
    }
}
