//! The `Geometry` implementation: local coordinates and the Poisson structure of the states.

use proc_macro2::TokenStream;
use quote::quote;

use super::Names;
use super::kernel::{Layout, function, size};
use crate::expr::{Arena, Vector};
use crate::geometry::{
    differential, displaced, force, hamiltonian_vector, tangent_symbols, with_spatial_momentum,
};
use crate::group::Retraction;
use crate::kernel;
use crate::model::{Side, System};

/// `impl Geometry for HeavyTop { … }`, and `impl Isolated` where nothing acts on the system.
pub(super) fn geometry<'a>(arena: &'a Arena, system: &System<'a>, names: &Names) -> TokenStream {
    let Names { private, system: name, state, scalar, .. } = names;
    let by = tangent_symbols(arena, system, "by");
    let count = size(by.len());
    let emitted = |name: &str, outputs: &Vector<'a>, extra: &[(&str, &Vector<'a>)], time: bool| {
        let (section, symbols) = kernel::function(arena, outputs);
        let layout = Layout::new(system, &symbols);
        let mut arrays = vec![("parameters", layout.parameters.clone()), ("state", layout.state.clone())];
        arrays.extend(extra.iter().map(|(name, vector)| {
            let symbols_of = vector.symbols();
            (*name, symbols_of.into_iter().map(|symbol| symbols.get(symbol)).collect())
        }));
        function(name, private, &section, &arrays, time.then_some(layout.time.as_str()))
    };
    let exponential =
        emitted("exponential", &displaced(system, Retraction::Exponential, &by), &[("by", &by)], false);
    let cayley = emitted("cayley", &displaced(system, Retraction::Cayley, &by), &[("by", &by)], false);
    let differential = emitted("differential", &differential(system), &[], true);
    let vector = emitted("vector", &hamiltonian_vector(arena, system, &by), &[("by", &by)], false);
    let control = Vector(system.controls.iter().flat_map(|part| part.value.0.clone()).collect());
    let force = emitted("force", &force(arena, system), &[("control", &control)], true);
    let parameters = quote! { &#private::System::to_parameters(self) };
    let components = quote! { &#private::State::to_components(state) };

    let isolated = (system.side == Side::Left && is_isolated(system)).then(|| {
        let n = system.dimension();
        let names = (0..n).map(|i| arena.symbol(format!("spatial_{i}"), crate::expr::Stage::Step));
        let spatial = Vector(names.collect());
        let body = emitted("body", &with_spatial_momentum(system, &spatial), &[("spatial", &spatial)], false);
        let momenta = system
            .factors
            .iter()
            .flat_map(|factor| factor.algebra.group.to_space(&factor.configuration, &factor.momentum).0);
        let in_space = emitted("in_space", &Vector(momenta.collect()), &[], false);
        let (n, all) = (size(n), size(system.state_symbols().len()));
        let zeros = vec![quote! { T::of(0.0) }; system.parameter_symbols().len()];
        quote! {
            #body
            #in_space

            #[automatically_derived]
            impl #private::Isolated for #name {
                type Spatial<T: #private::Scalar> = [T; #n];

                fn in_space<T: #private::Scalar>(state: &[T; #all]) -> [T; #n] {
                    in_space(&[#(#zeros),*], state)
                }

                fn in_body<T: #private::Scalar>(state: &[T; #all], spatial: &[T; #n]) -> [T; #all] {
                    body(&[#(#zeros),*], state, spatial)
                }
            }
        }
    });
    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #exponential
            #cayley
            #differential
            #vector
            #force

            #[automatically_derived]
            impl #private::Geometry for #name {
                type Tangent = [#scalar; #count];

                fn displace(&self, state: &#state, map: #private::Map, by: &[#scalar; #count]) -> #state {
                    let moved = match map {
                        #private::Map::Exponential => exponential(#parameters, #components, by),
                        #private::Map::Cayley => cayley(#parameters, #components, by),
                    };
                    #private::State::from_components(&moved)
                }

                fn differential(&self, state: &#state, time: #scalar) -> [#scalar; #count] {
                    differential(#parameters, #components, time)
                }

                fn hamiltonian_vector(&self, state: &#state, covector: &[#scalar; #count]) -> [#scalar; #count] {
                    vector(#parameters, #components, covector)
                }

                fn force(
                    &self,
                    state: &#state,
                    time: #scalar,
                    control: &<Self as #private::System>::Control,
                ) -> [#scalar; #count] {
                    force(#parameters, #components, &#private::Control::to_components(control), time)
                }
            }

            #isolated
        };
    }
}

/// Whether nothing acts on the system: its momentum is constant in space.
fn is_isolated(system: &System<'_>) -> bool {
    system.is_left_invariant() && system.factors.iter().all(|factor| factor.advected.is_empty())
}
