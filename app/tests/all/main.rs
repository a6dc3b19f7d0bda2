//! The tests of the app from outside, in one program: as people meet it, a real one of two systems, its output, its files, its exit codes.
#![cfg(feature = "program")]
#![allow(
    clippy::tests_outside_test_module,
    clippy::expect_used,
    clippy::panic,
    reason = "all of it is tests"
)]

#[cfg(unix)]
mod drawn;
mod ensembles;
mod files;
#[cfg(target_os = "linux")]
mod injected;
mod layers;
mod page;
mod program;
mod quantities;
#[cfg(unix)]
mod reliability;
#[cfg(feature = "description")]
mod series;
mod shards;
mod terminal;
