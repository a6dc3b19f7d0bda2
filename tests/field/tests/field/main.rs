//! Motions on which steps were once given up, or silently wrong, although their equations have plain solutions: where
//! terms cancel, where nothing moves any more, where a conserved momentum is zero, and where a force is smooth though
//! its parts are not. One file for each kind, two of ends that others report or compute, `reported.rs` and
//! `applied.rs`, and one of many steps near the speed of light, `fast.rs`.
//!
//! Right values are closed formulas, conservation laws, or, where there is a number with eight digits, integrations by
//! Dormand and Prince's method of order 8 with a relative tolerance of 1e-13, of equations of motion that were written
//! down by hand.

mod applied;
mod campaign;
mod cancelling;
mod far;
mod fast;
mod jacobians;
mod large;
mod released;
mod reported;
mod runs;
mod settled;
mod springs;
mod zeros;
