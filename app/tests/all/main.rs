//! The program as people meet it: a real one, of two systems, its output, its files, its exit codes.
#![cfg(feature = "program")]

mod ensembles;
mod program;
mod terminal;
