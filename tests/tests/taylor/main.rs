//! Taylor steps, in a binary of their own: it is compiled beside that of the rest of the library.

mod kinks;
mod taylor;
