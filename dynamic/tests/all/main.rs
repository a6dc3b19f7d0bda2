//! Systems made of texts.
#![allow(clippy::unwrap_used)]

mod same;
