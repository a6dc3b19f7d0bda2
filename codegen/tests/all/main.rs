//! The tests of the generator from outside, in one binary: it is linked once.

mod bounds;
mod description;
mod fuzz;
mod linear;
mod meaning;
mod modules;
mod problems;
mod program;
mod reference;
mod steps;
