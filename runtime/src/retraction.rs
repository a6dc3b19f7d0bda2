//! The retractions `τ: g → G` a step can be built on, as types to choose with:
//! `system.stepper::<Cayley>(h)`.
//!
//! All satisfy `τ(0) = e` and `τ'(0) = id`. [`Exponential`] and [`Cayley`] are functions of one matrix: `τ(−ξ) = τ(ξ)⁻¹`, and
//! `τ(Ad_g ξ) = g τ(ξ) g⁻¹`. [`SecondKind`] has neither property, nor have steps what follows from them.
//!
//! Which there are, and what is said of them, is a table of the generator's.

/// A retraction of the catalogue.
pub trait Retraction {
    /// It, as a value.
    const MAP: RetractionKind;
}

/// Makes the types of a table of retractions.
macro_rules! retractions {
    ($($(#[doc = $doc:tt])* $name:ident {
        is_matrix_function: $is_matrix_function:literal,
        spoken: $spoken:literal,
        word: $word:literal,
        short: $short:literal,
        about: $about:literal
    })*) => {
        /// A retraction as a value.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RetractionKind {
            $(#[doc = concat!("[`", stringify!($name), "`](", stringify!($name), ")")] $name,)*
        }

        impl RetractionKind {
            /// All of them.
            pub const ALL: [RetractionKind; [$($word),*].len()] = [$(RetractionKind::$name),*];

            /// Whether it is a function of one matrix: then it is odd, `τ(−ξ) = τ(ξ)⁻¹`, and `Ad`-equivariant, `τ(Ad_g ξ) = g τ(ξ) g⁻¹`. Other
            /// maps are neither, but on commutative groups.
            pub const fn is_matrix_function(self) -> bool {
                match self { $(Self::$name => $is_matrix_function,)* }
            }

            /// Its name, that of its type.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name),)* }
            }

            /// Its name in sentences.
            #[cfg(feature = "std")]
            pub(crate) const fn spoken(self) -> &'static str {
                match self { $(Self::$name => $spoken,)* }
            }
        }

        /// Types that stand for retractions.
        pub(crate) mod markers {
            $(
                $(#[doc = $doc])*
                #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
                pub struct $name;

                impl super::Retraction for $name {
                    const MAP: super::RetractionKind = super::RetractionKind::$name;
                }

                #[cfg(feature = "std")]
                impl crate::SchemeType for $name {
                    fn scheme() -> crate::Scheme {
                        crate::Scheme::Standard(super::RetractionKind::$name)
                    }
                }
            )*
        }
    };
}
coadjoint_macros::retractions!(retractions);

pub use markers::*;
