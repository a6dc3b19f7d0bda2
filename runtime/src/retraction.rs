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

/// A retraction, as the table has it.
struct Row {
    name: &'static str,
    #[cfg(feature = "std")]
    spoken: &'static str,
    is_odd: bool,
    is_matrix_function: bool,
}

impl RetractionKind {
    /// All of them.
    pub const ALL: [Self; EVERY.len()] = EVERY;

    /// Its name, that of its type.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Its name in sentences.
    #[cfg(feature = "std")]
    pub(crate) const fn spoken(self) -> &'static str {
        self.row().spoken
    }

    /// Whether `τ(−ξ) = τ(ξ)⁻¹`.
    pub const fn is_odd(self) -> bool {
        self.row().is_odd
    }

    /// Whether it is a function of one matrix: then it is odd, `τ(−ξ) = τ(ξ)⁻¹`, and `Ad`-equivariant, `τ(Ad_g ξ) = g τ(ξ) g⁻¹`. Other
    /// maps are not equivariant, but on commutative groups.
    pub const fn is_matrix_function(self) -> bool {
        self.row().is_matrix_function
    }
}

/// Makes the types of the table.
macro_rules! retractions {
    ($($(#[doc = $doc:tt])* $name:ident {
        is_odd: $is_odd:literal,
        is_matrix_function: $is_matrix_function:literal,
        spoken: $spoken:literal,
        word: $word:literal,
        short: $_short:literal,
        about: $_about:literal
    })*) => {
        /// A retraction as a value.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RetractionKind {
            $(#[doc = concat!("[`", stringify!($name), "`](", stringify!($name), ")")] $name,)*
        }

        const EVERY: [RetractionKind; [$($word),*].len()] = [$(RetractionKind::$name),*];

        impl RetractionKind {
            const fn row(self) -> &'static Row {
                match self {
                    $(Self::$name => &Row {
                        name: stringify!($name),
                        #[cfg(feature = "std")]
                        spoken: $spoken,
                        is_odd: $is_odd,
                        is_matrix_function: $is_matrix_function,
                    },)*
                }
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
