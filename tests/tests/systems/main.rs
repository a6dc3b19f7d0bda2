//! The tests of systems that are described for them: by definitions, in twice the digits, and by other integrators.

mod arrays;
mod bases;
mod families;
mod kinematics;
mod lagrangian;
mod numbered;
mod paper;
mod reference;
