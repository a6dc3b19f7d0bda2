//! Serde's traits for generated types.

/// `Serialize` and `Deserialize` for a struct of these public fields, as `derive` would implement them.
///
/// A macro of this crate and not of the generator, since only this crate knows whether its feature `serde` is on.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialization {
    ($name:ident, $(#[$options:meta])* struct $fields:tt) => {
        const _: () = {
            #[allow(dead_code)] // serde reads and makes the struct that it stands for
            #[derive($crate::serde::Serialize, $crate::serde::Deserialize)]
            $(#[$options])*
            struct __Fields $fields

            #[automatically_derived]
            impl $crate::serde::Serialize for $name {
                fn serialize<S: $crate::serde::Serializer>(
                    &self,
                    serializer: S,
                ) -> ::core::result::Result<S::Ok, S::Error> {
                    __Fields::serialize(self, serializer)
                }
            }

            #[automatically_derived]
            impl<'de> $crate::serde::Deserialize<'de> for $name {
                fn deserialize<D: $crate::serde::Deserializer<'de>>(
                    deserializer: D,
                ) -> ::core::result::Result<Self, D::Error> {
                    __Fields::deserialize(deserializer)
                }
            }
        };
    };
}

/// Nothing: the feature `serde` is off.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialization {
    ($($tokens:tt)*) => {};
}
