//! What there is in place of machine code without the feature `jit`: nothing, so that all is interpreted.

use std::sync::Arc;

use coadjoint::erased::dynamic::{Layout, March, StepFunction};
use coadjoint_codegen::program::Program;

/// A step's functions, none of which is compiled.
pub(crate) struct Machine;

impl Machine {
    pub(crate) fn new(_: Arc<Program>, _: usize, _: Layout) -> Self {
        Self
    }

    /// Calls a function on a frame, if there is code for it.
    pub(crate) fn call(&self, _: StepFunction, _: &mut [f64]) -> bool {
        false
    }

    /// The same on frames side by side.
    pub(crate) fn call_wide<const L: usize>(&self, _: StepFunction, _: &mut [[f64; L]]) -> bool {
        false
    }

    /// Whether there may be what takes many steps at a time.
    pub(crate) fn has_march(&self) -> bool {
        false
    }

    /// What takes many steps at a time.
    pub(crate) fn march(&self, _: Option<usize>, _: usize) -> Option<March> {
        None
    }
}
