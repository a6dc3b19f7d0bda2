//! The tests of systems that are described for them: by definitions, in twice the digits, and by other integrators.

mod arrays;
mod bases;
mod controlled;
mod derivatives;
mod families;
mod lagrangian;
mod numbered;
mod paper;
mod tangent_lifts;
