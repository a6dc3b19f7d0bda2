//! Modules for systems that are compiled ahead.
