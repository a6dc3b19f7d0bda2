//! The program as a process: its files, its exit codes.

mod files;
mod scratch;
#[cfg(unix)]
mod reliability;
