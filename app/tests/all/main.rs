//! The program as a process: its files, its exit codes.

mod files;
mod program;
#[cfg(unix)]
mod reliability;
