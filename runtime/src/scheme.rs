//! Schemes: what a step makes of a retraction, as types to choose with: `system.stepper::<Midpoint<Cayley>>(h)`.
//!
//! A bare retraction is a scheme too, the [standard](crate::system::System::Standard) one of order 2; it is the one to take
//! unless another is wanted for itself. [Compositions](crate::composition) make higher orders of these.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! #[lie_poisson_system(group = SO3, methods(Midpoint))]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
//! let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
//! let momentum = body.spatial_momentum(&state);
//! let mut stepper = body.stepper::<Midpoint>(0.05)?;
//! for _ in 0..1_000 {
//!     stepper.step(&mut state)?;
//! }
//! assert!((body.spatial_momentum(&state) - momentum).norm() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The family is that of V. Vivek, D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving
//! Integrators for Mechanical Systems* (2026).

use core::marker::PhantomData;

use crate::retraction::{Exponential, RetractionKind};

/// The scheme `M` carrying the momentum in space coordinates, (6.6) and (6.9) of the paper, for systems on which nothing
/// [acts](crate::system::Isolated): the spatial momentum is constant bit for bit, and the body momentum is what belongs to it. Where
/// `invariance = right` it is the other way round: the momentum in the body is constant and carried, that in space belongs to it.
///
/// The map is that of `M` up to roundoff, a Poisson map as it is. The stepper carries the momentum for as long as the states it is
/// given are those that it led to; another state starts anew from its body momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RightLift<M = SymplecticEulerA>(PhantomData<M>);

/// Half a step with [`SymplecticEulerA`], then half a step with its adjoint [`SymplecticEulerB`]: symmetric, of order 2, and
/// symplectic as they are. A potential on the group acts at both ends of the step, outside of the equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StormerVerlet<R = Exponential>(PhantomData<R>);

/// The type that stands for a generated step.
#[doc(hidden)]
pub trait Base: 'static {
    /// Its retraction.
    const MAP: RetractionKind;
    /// The rest of it.
    const RULE: Rule;
}

/// A method, as it is written, and what its steps promise.
#[cfg(feature = "std")]
pub(crate) struct MethodRow {
    /// Its name, that of its type.
    pub name: &'static str,
    /// Its steps by their parameter.
    pub rules: Rules,
    /// Whether its steps are symplectic, for left-invariant systems Poisson maps that keep all Casimirs, where no force acts.
    pub is_symplectic: bool,
    /// Whether its members `s` and `1 − s` are one map, for left-invariant systems without forces and potentials on the
    /// group, if the retraction is a function of one matrix; of the ends, if it is odd.
    pub is_one_map: bool,
}

#[cfg(feature = "std")]
impl MethodRow {
    /// The steps with names of their own, with numerators and denominators.
    pub(crate) fn named(&self) -> &'static [(&'static str, u32, u32)] {
        match self.rules {
            Rules::Share { named, .. } => named,
            Rules::Order { .. } => &[],
        }
    }

    /// Tells whether the method or one of its steps has this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.name == name || self.named().iter().any(|named| named.0 == name)
    }
}

/// The steps of a method.
#[cfg(feature = "std")]
pub(crate) enum Rules {
    /// By the share of the step before the intermediate point; some have names of their own, those of types.
    Share {
        /// The step with the share `numerator/denominator`.
        rule: fn(u32, u32) -> Rule,
        /// The names, with numerators and denominators.
        named: &'static [(&'static str, u32, u32)],
    },
    /// By the order.
    Order {
        /// The step of an order.
        rule: fn(u32) -> Rule,
        /// The order of steps that do not say one.
        usual: u32,
    },
}

/// What tells the steps of a method from each other.
#[cfg(feature = "std")]
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parameter {
    /// The share `numerator/denominator` of the step before the intermediate point.
    Share(u32, u32),
    /// The order.
    Order(u32),
}

/// Makes the types of a table of methods.
macro_rules! methods {
    (
        share { $($(#[doc = $share_doc:tt])* $share:ident {
            word: $_share_word:literal,
            about: $_share_about:literal,
            is_symplectic: $share_is_symplectic:literal,
            is_one_map: $is_one_map:literal,
            named: { $($(#[doc = $member_doc:tt])? $member:ident($n:literal, $d:literal) { $($_member:tt)* })* }
        })* }
        order { $($(#[doc = $order_doc:tt])* $order:ident {
            word: $_order_word:literal,
            about: $_order_about:literal,
            is_symplectic: $order_is_symplectic:literal,
            orders: [$($of:literal),*],
            usual: $usual:literal
        })* }
    ) => {
        /// A generated step as a value, but for its retraction.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Rule {
            $(
                #[doc = concat!("The member `s = numerator/denominator` of [`", stringify!($share), "`], in lowest terms.")]
                $share(u32, u32),
            )*
            $(
                #[doc = concat!("The [`", stringify!($order), "`] step of this order.")]
                $order(u32),
            )*
        }

        impl Rule {
            /// What its method is, and its parameter.
            #[cfg(feature = "std")]
            pub(crate) const fn row(self) -> (&'static MethodRow, Parameter) {
                match self {
                    $(Self::$share(numerator, denominator) => {
                        const ROW: &MethodRow = &MethodRow {
                            name: stringify!($share),
                            rules: Rules::Share {
                                rule: Rule::$share,
                                named: &[$((stringify!($member), $n, $d)),*],
                            },
                            is_symplectic: $share_is_symplectic,
                            is_one_map: $is_one_map,
                        };
                        (ROW, Parameter::Share(numerator, denominator))
                    })*
                    $(Self::$order(order) => {
                        const ROW: &MethodRow = &MethodRow {
                            name: stringify!($order),
                            rules: Rules::Order { rule: Rule::$order, usual: $usual },
                            is_symplectic: $order_is_symplectic,
                            is_one_map: false,
                        };
                        (ROW, Parameter::Order(order))
                    })*
                }
            }

            /// The methods.
            #[cfg(feature = "std")]
            pub(crate) const METHODS: [&MethodRow; [$(stringify!($share),)* $(stringify!($order)),*].len()] =
                [$(Self::$share(0, 1).row().0,)* $(Self::$order($usual).row().0),*];

            /// The steps that a description may ask for by name, and those of each order.
            #[doc(hidden)]
            pub const NAMED: &[Rule] = &[$($(Self::$share($n, $d),)*)* $($(Self::$order($of),)*)*];
        }

        /// Types that stand for steps.
        pub(crate) mod markers {
            use core::marker::PhantomData;

            use super::{Base, Rule};
            use crate::retraction::{Exponential, Retraction, RetractionKind};

            $(
                $(#[doc = $share_doc])*
                #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
                pub struct $share<R = Exponential, const N: u32 = 0, const D: u32 = 1>(PhantomData<R>);

                impl<R: Retraction + 'static, const N: u32, const D: u32> Base for $share<R, N, D> {
                    const MAP: RetractionKind = R::MAP;
                    const RULE: Rule = Rule::$share(N, D);
                }

                methods!(@ $share $($(#[doc = $member_doc])? $member($n, $d))*);
            )*
            $(
                $(#[doc = $order_doc])*
                #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
                pub struct $order<R = Exponential, const P: u32 = $usual>(PhantomData<R>);

                impl<R: Retraction + 'static, const P: u32> Base for $order<R, P> {
                    const MAP: RetractionKind = R::MAP;
                    const RULE: Rule = Rule::$order(P);
                }
            )*
        }
    };
    (@ $share:ident #[doc = $doc:tt] $member:ident($n:literal, $d:literal) $($rest:tt)*) => {
        #[doc = $doc]
        pub type $member<R = Exponential> = $share<R, $n, $d>;
        methods!(@ $share $($rest)*);
    };
    // the method's own type is this member, unless it says another
    (@ $share:ident $member:ident($n:literal, $d:literal) $($rest:tt)*) => {
        methods!(@ $share $($rest)*);
    };
    (@ $share:ident) => {};
}
coadjoint_macros::methods!(methods);

pub use markers::*;
