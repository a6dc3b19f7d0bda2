//! The tests of the library as users have it, in one binary: it is linked once, and what two of them need is compiled once.

mod certify;
mod compensated;
mod driven;
mod effort;
mod ensemble;
mod erased;
mod events;
mod faulty;
mod functions;
mod hamilton_jacobi;
mod inputs;
mod kinks;
mod laws;
mod map;
mod second_kind;
mod systems;
mod together;
mod unsolved;
mod within;
