//! What a step is made of, and how its numbers lie in a frame.

use core::ops::Range;
use std::boxed::Box;
use std::vec::Vec;

use crate::erased::jacobian::Jacobian;
use crate::retraction::RetractionKind;
use crate::scalar::simd::frame::{Framed, LANES, MACHINE_LANES, MachineLanes, Wide};
use crate::scalar::simd::march::March;
use crate::scheme::Rule;

/// The functions of a step, as [`StepFunctions`] has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepFunction {
    /// What depends on parameters and step alone.
    New,
    /// What depends on state, time and controls too.
    Begin,
    /// A first approximation of the unknown, to where results go.
    Start,
    /// The equation's residual and right side, to their places.
    Evaluate,
    /// Newton's correction, to where results go.
    Correction,
    /// The next iterate of the fixed-point iteration, to where results go.
    FixedPointUpdate,
    /// The least distance to an edge of the retraction's domain, to its place.
    Domain,
    /// The state after the step, to its place.
    Finish,
}

/// The arithmetic of a step, on frames that are laid out as its [`Layout`] says.
pub trait StepFunctions: Send + Sync + 'static {
    /// Calls a function on one frame.
    fn call(&self, function: StepFunction, frame: &mut [f64]);
    /// Calls a function on several frames, number by number side by side. In each lane the result is that of the lane alone, bit for bit.
    fn call_wide(&self, function: StepFunction, frame: &mut [[f64; LANES]]);
    /// Calls a function on fewer frames, in the same way.
    fn call_machine_lanes(&self, function: StepFunction, frame: &mut [[f64; MACHINE_LANES]]);
    /// Whether there may be machine code that takes many steps at a time, as long as they are as most are.
    fn has_march(&self) -> bool {
        false
    }
    /// That code; or the code for steps that are this one and another one, in this place among all of the system, each of half the length.
    fn march(&self, _then: Option<usize>) -> Option<March> {
        None
    }
    /// The same of [`MACHINE_LANES`] members side by side.
    fn march_machine_lanes(&self, _then: Option<usize>) -> Option<March> {
        None
    }
}

/// A step whose equation is solved.
#[derive(Clone, Copy, Debug)]
pub struct Solution<'a> {
    /// The parameters.
    pub parameters: &'a [f64],
    /// The length of the step.
    pub step_size: f64,
    /// The state at its start.
    pub state: &'a [f64],
    /// The time there.
    pub time: f64,
    /// The controls.
    pub control: &'a [f64],
    /// The solution.
    pub unknown: &'a [f64],
}

/// The derivative of a step.
pub trait StepDerivative: Send + Sync + 'static {
    /// Its matrices at a solution; no columns where the description does not ask for them.
    fn jacobian(&self, at: &Solution<'_>) -> Jacobian;
}

/// How many numbers there are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lengths {
    /// Parameters.
    pub parameters: usize,
    /// Those of the state.
    pub state: usize,
    /// Controls.
    pub control: usize,
    /// Unknowns of the equation.
    pub unknown: usize,
    /// Values that depend on parameters and step.
    pub constants: usize,
    /// Values that depend on state, time and controls too.
    pub step: usize,
    /// Values that depend on the unknown too.
    pub iterate: usize,
}

/// Where numbers stand in a frame.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The parameters.
    pub parameters: Range<usize>,
    /// The length of the step.
    pub step_size: usize,
    /// The state at its start.
    pub state: Range<usize>,
    /// The time there.
    pub time: usize,
    /// The controls.
    pub control: Range<usize>,
    /// The unknown.
    pub unknown: Range<usize>,
    /// The residual.
    pub residual: Range<usize>,
    /// The right side.
    pub right: Range<usize>,
    /// An unknown as a result.
    pub out: Range<usize>,
    /// The distance to the edge of the domain.
    pub margin: usize,
    /// The state after the step.
    pub next: Range<usize>,
    /// What functions hand on to others: values of each kind, as long as the step is as it was.
    pub constants: Range<usize>,
    /// As above.
    pub step: Range<usize>,
    /// As above.
    pub iterate: Range<usize>,
    /// Where numbers of the functions' own begin.
    pub scratch: usize,
}

impl Layout {
    /// The layout of frames with so many numbers.
    pub fn new(lengths: &Lengths) -> Self {
        let mut end = 0;
        let mut take = |length: usize| {
            let start = end;
            end += length;
            start..end
        };
        let one = |range: Range<usize>| range.start;
        Self {
            parameters: take(lengths.parameters),
            step_size: one(take(1)),
            state: take(lengths.state),
            time: one(take(1)),
            control: take(lengths.control),
            unknown: take(lengths.unknown),
            residual: take(lengths.unknown),
            right: take(lengths.unknown),
            out: take(lengths.unknown),
            margin: one(take(1)),
            next: take(lengths.state),
            constants: take(lengths.constants),
            step: take(lengths.step),
            iterate: take(lengths.iterate),
            scratch: end,
        }
    }
}

/// A step of one or several schemes that are the same map.
pub struct Step {
    /// The schemes.
    pub schemes: Vec<(RetractionKind, Rule)>,
    /// Where its numbers are.
    pub layout: Layout,
    /// The lengths of the blocks of unknowns.
    pub blocks: Vec<usize>,
    /// Whether the retraction's domain has an edge.
    pub has_domain: bool,
    /// Whether Newton's matrix is the Jacobian of the residual.
    pub has_true_jacobian: bool,
    /// Whether all iterations are simplified Newton steps with nearly that matrix.
    pub is_newton: bool,
    /// Whether that is one of the beginning of a step.
    pub is_chord: bool,
    /// Whether it is long, so that what rounding leaves in its solutions is some units.
    pub is_long: bool,
    /// Its functions as bytes, for certificates and for what rounding leaves.
    pub program: [Vec<u8>; 4],
    /// How many places the values of these have.
    pub places: usize,
    /// A frame before anything is computed.
    pub frame: Vec<f64>,
    /// Its arithmetic.
    pub functions: Box<dyn StepFunctions>,
    /// Its derivative, if the description asks for one.
    pub derivative: Option<Box<dyn StepDerivative>>,
}

impl core::fmt::Debug for Step {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Step").field("schemes", &self.schemes).finish_non_exhaustive()
    }
}

/// Numbers that functions can be called on.
pub(crate) trait Called: Framed {
    /// Calls a function.
    fn call(functions: &dyn StepFunctions, function: StepFunction, frame: &mut [Self::Row]);
    /// Whether there may be machine code that takes many steps at a time.
    fn has_march(_functions: &dyn StepFunctions) -> bool {
        false
    }
    /// That code; with another step, if one is given.
    fn march(_functions: &dyn StepFunctions, _then: Option<usize>) -> Option<March> {
        None
    }
}

impl Called for f64 {
    fn call(functions: &dyn StepFunctions, function: StepFunction, frame: &mut [f64]) {
        functions.call(function, frame);
    }

    fn has_march(functions: &dyn StepFunctions) -> bool {
        functions.has_march()
    }

    fn march(functions: &dyn StepFunctions, then: Option<usize>) -> Option<March> {
        functions.march(then)
    }
}

impl Called for MachineLanes {
    fn call(functions: &dyn StepFunctions, function: StepFunction, frame: &mut [[f64; MACHINE_LANES]]) {
        functions.call_machine_lanes(function, frame);
    }

    fn has_march(functions: &dyn StepFunctions) -> bool {
        functions.has_march()
    }

    fn march(functions: &dyn StepFunctions, then: Option<usize>) -> Option<March> {
        functions.march_machine_lanes(then)
    }
}

impl Called for Wide {
    fn call(functions: &dyn StepFunctions, function: StepFunction, frame: &mut [[f64; LANES]]) {
        functions.call_wide(function, frame);
    }
}
