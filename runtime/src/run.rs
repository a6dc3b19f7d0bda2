//! Runs and the observers that hang on them.
