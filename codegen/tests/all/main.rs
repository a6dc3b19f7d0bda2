//! The tests of the generator from outside, in one binary: it is linked once.

mod description;
mod linear;
mod meaning;
mod modules;
mod problems;
mod program;
mod reference;
mod soup;
mod steps;
