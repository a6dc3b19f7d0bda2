//! The tests of the app from outside, in one program.
#![allow(
    clippy::tests_outside_test_module,
    clippy::expect_used,
    clippy::panic,
    reason = "all of it is tests"
)]

mod page;
