//! How a step's equation is solved, as data: the numbers that decide.
//!
//! Whoever takes steps needs a solver. This is the library's (`runtime/src/solve/step.rs` is the whole story), and one that follows it with these
//! numbers takes its steps to the last bit:
//!
//! 1. the fast path: one iteration from where earlier solutions point;
//! 2. fixed-point iterations with [`StepRole::FixedPointUpdate`](super::StepRole::FixedPointUpdate), as long as they contract;
//! 3. Newton's method with [`StepRole::Correction`](super::StepRole::Correction);
//! 4. damped corrections and continuation from [`StepRole::Start`](super::StepRole::Start), from nothing that is remembered;
//! 5. acceptance: the next state, all margins of [`StepRole::Domain`](super::StepRole::Domain) positive, and everything finite.
//!
//! Newton steps, of Lagrangians, whose update is `x` less the correction, and simplified ones, of Hamilton–Jacobi steps, have a predictor of their own,
//! the differences from the explicit start, and a few of them stand on the fast path.
//!
//! A test holds the numbers against the library's.

/// A number of the solver's, or several.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Its name in `runtime/src/solve`.
    pub name: &'static str,
    /// Its value, or values.
    pub values: &'static [f64],
    /// Its purpose.
    pub purpose: &'static str,
}

const fn constant(name: &'static str, values: &'static [f64], purpose: &'static str) -> Constant {
    Constant { name, values, purpose }
}

/// All of them. A unit is the distance from 1 to the next larger number, relative to a block of unknowns.
#[rustfmt::skip]
pub const CONSTANTS: &[Constant] = &[
    constant("WINDOW", &[16.0], "solutions that are kept"),
    constant("THROUGH", &[8.0], "the most solutions that a polynomial goes through"),
    constant("LOW", &[3.0], "of so many where controls jump"),
    constant("WEIGHTS", &[231.0 / 32.0, -20.0, 735.0 / 32.0, -637.0 / 32.0, 715.0 / 32.0],
        "weights of x[j] - x[16-j] with j = 1, 2, 3, 5, 7, which continue sixteen solutions"),
    constant("CALM", &[1353.0 / 256.0, -10.0, 1785.0 / 256.0, -91.0 / 256.0, -715.0 / 256.0],
        "those for slow motion, where a step is so long that rounding counts"),
    constant("BINOMIAL", &[8.0, -28.0, 56.0, -70.0],
        "the first half of the weights that continue eight, of simplified Newton steps"),
    constant("FEW", &[10.0], "the most simplified Newton steps on the fast path beside the first"),
    constant("LEFT", &[4.0], "what the last of several of them leaves, in units"),
    constant("FORGETS", &[0.25], "their rate becomes smaller by this factor at most each time that it is measured"),
    constant("SMALL", &[4096.0], "a prediction off by less, in units, is off by rounding"),
    constant("LOST", &[0.1], "a prediction off by more is forgotten; of simplified Newton steps one by two solutions or more"),
    constant("STRONG", &[0.25], "iterations that contract by this factor are gone on with"),
    constant("FAR", &[1e30], "a change before there is any"),
    constant("ITERATIONS", &[12.0], "the most fixed-point iterations of a step"),
    constant("HARDLY", &[0.025], "the change of a last iteration is this over the squared rate, in units"),
    constant("TOLERANCE", &[8.0, 128.0, 16.0], "but no less and no more than this; the last one is for all iterations but the first"),
    constant("NEWTON", &[2.0, 1e7], "the same of simplified Newton steps: over the rate, and no more than the second"),
    constant("QUICK", &[0.04], "the largest rate of which that is as much as the last tolerance"),
    constant("SHARP", &[256.0], "changes from here on show the rate, in units"),
    constant("INTERVALS", &[16.0, 2048.0], "steps between two measurements of the rate, at first and in the long run"),
    constant("REGULAR", &[8.0], "the most Newton corrections of a step that is easily solved"),
    constant("RESIDUAL", &[2.0, 0.0, 8.0, 16.0, 256.0, 1_048_576.0],
        "a residual is rounding below the first, in units; below the others if what a correction leaves, times the factor beside, is below one"),
    constant("PROGRESS", &[0.5], "a correction that makes the residual no smaller by this asks what rounding leaves"),
    constant("NEAR", &[0.125], "a solution nearer to the first approximation is the one that Newton's method finds from there"),
    constant("TOWARDS", &[0.25], "so is it where a correction from there leads nearer by this factor"),
    constant("DAMPED", &[40.0], "the most evaluations of a damped iteration"),
    constant("NEARLY", &[1e6], "where a residual is fewer times what rounding leaves of its terms, they are made in full"),
    constant("SHORTEST", &[1e-3], "corrections are not made shorter than by this factor"),
    constant("PARTS", &[1.0, 4.0, 16.0, 64.0], "parts of the way from the first approximation"),
    constant("EVALUATIONS", &[8.0], "evaluations of each part but the last, on average and at most"),
    constant("WANDERING", &[60.0], "evaluations of the last part"),
    constant("STRIDE", &[0.25], "how far the last part may lead, relative to the unknown"),
    constant("ON_THE_WAY", &[1e-3], "what is left of a correction where the next part may begin"),
    constant("APART", &[1e-6], "solutions that differ by more are two"),
    constant("ROUNDINGS", &[64.0], "and by more than so many times what rounding leaves"),
];

/// The values of a constant; none if there is none of this name.
pub fn values(name: &str) -> &'static [f64] {
    CONSTANTS.iter().find(|constant| constant.name == name).map_or(&[], |constant| constant.values)
}
