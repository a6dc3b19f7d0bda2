//! The `System` implementation: parameters, checks, energy, invariants.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::code::size;
use super::functions::{call, function};
use super::names::{Names, quantity};
use super::state::{Conversion, arrays};
use crate::program::{FunctionRole as _, Input, Interface, Program, Quantity, SystemRole, Transform};
use crate::quantity::{Direction, Role};

/// `impl System for HeavyTop { … }` and the functions it calls.
pub(super) fn system(program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, .. } = names;
    let interface = &program.interface;
    let functions = [
        SystemRole::Energy,
        SystemRole::Velocity,
        SystemRole::VelocityNewton,
        SystemRole::Momentum,
        SystemRole::MomentumNewton,
        SystemRole::Casimirs,
        SystemRole::SpatialMomentum,
    ];
    let pivots = (0..interface.inertias.len()).map(SystemRole::Pivots);
    let events = (0..interface.events.len()).map(SystemRole::Event);
    let functions =
        functions.into_iter().chain(pivots).chain(events).map(|role| function(program, names, role));
    let (types, parameters) = (types(interface, names), parameters(interface, names));
    let (validate, evaluations) = (validate(interface, names), evaluations(program, names));
    let events = self::events(program, names);
    let series = program.taylor.as_ref().map(|_| {
        quote! {
            fn visit_series<V: #private::SeriesVisitor<Self>>(visitor: V) -> ::core::option::Option<V::Output> {
                ::core::option::Option::Some(visitor.visit())
            }
        }
    });
    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            use #private::Stored as __Stored;

            #(#functions)*

            #[automatically_derived]
            impl #private::System for #name {
                #types
                #parameters
                #validate
                #evaluations
                #events
                #series
            }
        };
    }
}

/// The associated types and constants.
fn types(interface: &Interface, names: &Names) -> TokenStream {
    let Names { private, system: name, state, control, scalar, .. } = names;
    let text = name.unraw().to_string();
    let Interface { casimirs, is_autonomous, is_left_invariant, is_forced, .. } = interface;
    let [parameters, state_size, control_size, casimir_count, dimension] = [
        interface.parameter_length(),
        interface.state_length(),
        interface.control_length(),
        casimirs.len(),
        interface.dimension,
    ]
    .map(size);
    let control = match interface.controls.is_empty() {
        true => quote! { #private::NoControl<#scalar> },
        false => quote! { #control },
    };
    let standard = match is_left_invariant {
        true => quote! { #private::Family<R, 0, 1> },
        false => quote! { #private::StormerVerlet<R> },
    };
    let quantities = interface.parameters.iter().map(|field| quantity(names, field));
    let side = format_ident!("{}", format!("{:?}", interface.side));
    let piecewise =
        interface.is_piecewise.then(|| quote! { const PIECEWISE: ::core::primitive::bool = true; });
    quote! {
        type Scalar = #scalar;
        type State = #state;
        type StateComponents<T: #private::Scalar> = [T; #state_size];
        type Parameters<T: #private::Scalar> = [T; #parameters];
        type Control = #control;
        type ControlComponents<T: #private::Scalar> = [T; #control_size];
        type Casimirs = [#scalar; #casimir_count];
        type Momentum = #private::nalgebra::SVector<#scalar, #dimension>;
        type Standard<R> = #standard;

        const NAME: &'static ::core::primitive::str = #text;
        const PARAMETERS: &'static [#private::Quantity] = &[#(#quantities),*];
        const CASIMIRS: &'static [&'static ::core::primitive::str] = &[#(#casimirs),*];
        const AUTONOMOUS: ::core::primitive::bool = #is_autonomous;
        const INVARIANT: ::core::primitive::bool = #is_left_invariant;
        const FORCED: ::core::primitive::bool = #is_forced;
        #piecewise
        const SIDE: #private::Side = #private::Side::#side;
    }
}

/// The parameters as a flat array and back.
fn parameters(interface: &Interface, names: &Names) -> TokenStream {
    let Names { scalar, constants, .. } = names;
    let Conversion { take, elements, give } = arrays(&interface.parameters, names);
    let unused = vec![quote! { _ }; interface.constants.len()];
    let size = size(interface.parameter_length());
    quote! {
        fn to_parameters(&self) -> [#scalar; #size] {
            #(#take)*
            [#(#elements,)* #(#constants,)*]
        }

        fn from_parameters(parameters: &[#scalar; #size]) -> Self {
            let [#(#elements,)* #(#unused,)*] = *parameters;
            Self { #(#give),* }
        }
    }
}

/// Finite parameters, symmetric and positive definite inertias.
fn validate(interface: &Interface, names: &Names) -> TokenStream {
    let private = &names.private;
    let finite = interface.parameters.iter().map(|field| {
        let (place, text, size) = (names.place(field), &field.name, size(field.components.len()));
        quote! { #private::require_finite(#text, &__Stored::<_, #size>::to_array(&self.#place))?; }
    });
    let definite = interface.inertias.iter().enumerate().map(|(place, inertia)| {
        let text = &inertia.name;
        let field = interface.parameters.iter().find(|field| field.name == *text);
        let stored = field.map(|field| names.place(field));
        let rows = size(inertia.rows);
        let symmetric = inertia.is_matrix.then(|| {
            quote! {
                #private::require_symmetric(
                    #text,
                    &__Stored::<_, { #rows * #rows }>::to_array(&self.#stored),
                    #rows,
                )?;
            }
        });
        let pivots = format_ident!("{}", SystemRole::Pivots(place).name());
        quote! {
            #symmetric
            #private::require_positive_definite(#text, &#pivots(&self.to_parameters()))?;
        }
    });
    quote! {
        fn validate(&self) -> ::core::result::Result<(), #private::ParameterError> {
            #(#finite)*
            #(#definite)*
            ::core::result::Result::Ok(())
        }
    }
}

/// Evaluations at a state.
fn evaluations(program: &Program, names: &Names) -> TokenStream {
    let Names { private, state, scalar, .. } = names;
    let interface = &program.interface;
    let (casimirs, dimension) = (size(interface.casimirs.len()), size(interface.dimension));
    let momentum = quote! { #private::nalgebra::SVector<#scalar, #dimension> };
    let energy = call(program, names, SystemRole::Energy, &[]);
    let conserved = call(program, names, SystemRole::Casimirs, &[]);
    let spatial_momentum = call(program, names, SystemRole::SpatialMomentum, &[]);
    let legendre = legendre(program, names);
    quote! {
        fn energy_at(&self, state: &#state, time: #scalar, control: &Self::Control) -> #scalar {
            let [energy] = #energy;
            energy
        }

        #legendre

        fn casimirs(&self, state: &#state) -> [#scalar; #casimirs] {
            #conserved
        }

        fn spatial_momentum(&self, state: &#state) -> #momentum {
            __Stored::from_array(#spatial_momentum)
        }
    }
}

/// The events: their names and directions, and what is zero at them.
fn events(program: &Program, names: &Names) -> Option<TokenStream> {
    let Names { private, coadjoint, .. } = names;
    let all = &program.interface.events;
    let described = all.iter().map(|(name, direction)| {
        let kind = match direction {
            Direction::Rising => quote! { rising },
            Direction::Falling => quote! { falling },
            Direction::Both => quote! { any },
        };
        quote! { (#name, #coadjoint::Event::#kind()) }
    });
    let values = (0..all.len()).map(|place| {
        let (value, place) = (call(program, names, SystemRole::Event(place), &[]), size(place));
        quote! { #place => #value, }
    });
    (!all.is_empty()).then(|| {
        quote! {
            const EVENTS: &'static [(&'static ::core::primitive::str, #coadjoint::Event)] = &[#(#described),*];

            fn event_at(
                &self,
                event: ::core::primitive::usize,
                state: &Self::State,
                time: Self::Scalar,
                control: &Self::Control,
            ) -> Self::Scalar {
                let [value] = match event {
                    #(#values)*
                    _ => [#private::Scalar::of(::core::primitive::f64::NAN)],
                };
                value
            }
        }
    })
}

/// Velocity and momentum by each other: a closed form, or Newton's iteration from rest.
fn legendre(program: &Program, names: &Names) -> TokenStream {
    let Names { private, scalar, coadjoint, .. } = names;
    let dimension = size(program.interface.dimension);
    let given = (Input::Velocity, quote! { &__Stored::<_, #dimension>::to_array(velocity) });
    let velocity_of_momentum = match program.interface.velocity {
        Transform::Explicit => call(program, names, SystemRole::Velocity, &[]),
        Transform::Newton | Transform::Singular => {
            let iterate = (Input::Velocity, quote! { velocity });
            let newton = call(program, names, SystemRole::VelocityNewton, &[iterate]);
            quote! { #private::newton([0.0; #dimension], |velocity| #newton) }
        }
    };
    let momentum_of_velocity = match program.interface.momentum {
        Transform::Explicit => call(program, names, SystemRole::Momentum, &[given]),
        Transform::Singular => quote! { [#scalar::NAN; #dimension] },
        Transform::Newton => {
            let iterate = quote! {
                &#private::State::to_components(
                    &#private::System::with_momentum(self, state, &__Stored::from_array(*momentum)),
                )
            };
            let others = [given, (Input::State, iterate)];
            let newton = call(program, names, SystemRole::MomentumNewton, &others);
            quote! { #private::newton([0.0; #dimension], |momentum| #newton) }
        }
    };
    let momenta = momenta(&program.interface, names);
    quote! {
        fn velocity_at(
            &self,
            state: &Self::State,
            time: Self::Scalar,
            control: &Self::Control,
        ) -> Self::Momentum {
            __Stored::from_array(#velocity_of_momentum)
        }

        fn momentum_of(
            &self,
            velocity: &Self::Momentum,
            state: &Self::State,
            time: Self::Scalar,
            control: &Self::Control,
        ) -> ::core::result::Result<Self::Momentum, #coadjoint::LegendreError> {
            #private::finite(#momentum_of_velocity).map(__Stored::from_array)
        }

        fn velocity_of(
            &self,
            momentum: &Self::Momentum,
            state: &Self::State,
            time: Self::Scalar,
            control: &Self::Control,
        ) -> ::core::result::Result<Self::Momentum, #coadjoint::LegendreError> {
            let state = &#private::System::with_momentum(self, state, momentum);
            #private::finite(#velocity_of_momentum).map(__Stored::from_array)
        }

        #momenta
    }
}

/// The momenta of all factors, taken from a state and put into it.
fn momenta(interface: &Interface, names: &Names) -> TokenStream {
    let private = &names.private;
    let is_momentum = |part: &Quantity| vec![part.role == Role::Momentum; part.components.len()];
    let is_momentum: Vec<bool> = interface.state.iter().flat_map(is_momentum).collect();
    let element = |letter: char, n: usize| Ident::new(&format!("{letter}{n}"), Span::mixed_site());
    let all: Vec<Ident> = (0..is_momentum.len()).map(|n| element('x', n)).collect();
    let momenta: Vec<&Ident> =
        all.iter().zip(&is_momentum).filter(|&(_, &is)| is).map(|(element, _)| element).collect();
    quote! {
        fn momentum(&self, state: &Self::State) -> Self::Momentum {
            let [#(#all),*] = #private::State::to_components(state);
            __Stored::from_array([#(#momenta),*])
        }

        fn with_momentum(&self, state: &Self::State, momentum: &Self::Momentum) -> Self::State {
            let [#(#all),*] = #private::State::to_components(state);
            let [#(#momenta),*] = __Stored::to_array(momentum);
            #private::State::from_components(&[#(#all),*])
        }
    }
}
