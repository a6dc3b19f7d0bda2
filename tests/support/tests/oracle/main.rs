//! The generic stepper, which is the oracle for steps that are generated: against definitions and reference data, and against generated ones.
//! It stands here because it takes minutes without optimisation.

mod definitions;
mod generated;
mod mechanics;
