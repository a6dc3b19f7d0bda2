//! A stepper written the ordinary way.
