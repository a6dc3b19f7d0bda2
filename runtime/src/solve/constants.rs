//! The solver's numbers.
//!
//! A *unit* is the distance from 1 to the next larger number, relative to the norm of a block of unknowns.
//!
//! Each has been made four times as large and as small: at least one of the two changes lines of the table of `tests/tests/library/effort.rs`.
//! Three do not: [`NEAR`] saves time and nothing else, and no step is near [`APART`] and [`ROUNDINGS`].

/// How many solutions a polynomial goes through, at most. More magnify rounding more than an iteration takes off: of nine it counts 220 fold.
pub(super) const THROUGH: usize = 8;
/// Of so many where controls jump.
pub(super) const LOW: usize = 3;
/// A prediction that is off by less than this, in units, is off by rounding.
pub(super) const SMALL: f64 = 4096.0;
/// A prediction that is off by more than this, relative to the unknown, is forgotten; of Newton's method one by two solutions or more.
pub(super) const LOST: f64 = 0.1;

/// Fixed-point iterations are made where they contract at least by this factor: there the equation has one solution near.
pub(super) const STRONG: f64 = 0.25;
/// A change, or a residual, before there is any. Finite, for sums of two numbers know no infinity.
pub(super) const FAR: f64 = 1e30;
/// The most of them in a step. More take longer than Newton's corrections.
pub(super) const ITERATIONS: u32 = 12;
/// The change of a last iteration is `c / rate²`, for `rate² × change` is what its error, `rate × change`, moves the state by: with this `c`, a
/// fortieth of a unit.
pub(super) const HARDLY: f64 = 0.025;
/// But it is no less and no more than this, in units. Less would be rounding; where it is more, what is evaluated
/// before the last iteration is not what belongs to the solution. The last one is for all iterations but the first,
/// which contract by more than the angle of a step in some planes.
pub(super) const TOLERANCE: [f64; 3] = [8.0, 128.0, 16.0];
/// The most simplified Newton steps on the fast path beside the first.
pub(super) const FEW: u32 = 10;
/// What the last of several simplified Newton steps leaves, if it contracts as it shows to, in units.
pub(super) const LEFT: f64 = 4.0;
/// The rate of contraction of simplified Newton steps becomes smaller by this factor at most each time that it is measured: it differs from one
/// direction to another.
pub(super) const FORGETS: f64 = 0.25;
/// The change of a last simplified Newton step is `c / rate`: it leaves `c` units, for the state is made of what it leads to. But it
/// is no more than the second number, in units: with the matrix of an iterate a part of its square is left, too, and that of 1e7 units is a
/// fiftieth of one.
pub(super) const NEWTON: [f64; 2] = [2.0, 1e7];
/// The largest rate of contraction of which `c / rate²` is as much as the last of these.
pub(super) const QUICK: f64 = 0.04;
/// Changes from here on show the rate of contraction, in units. Of Newton's method, which leaves a part of the change's
/// square, that part is no less than one over this.
pub(super) const SHARP: f64 = 256.0;
/// Steps between two measurements of the rate: at first, and in the long run.
pub(super) const INTERVALS: [u16; 2] = [16, 2048];

/// Newton's corrections of a step that is easily solved, at most.
pub(super) const REGULAR: u32 = 8;
/// A residual is taken for rounding when it is below the first, in units of the right side; below the others if what a correction leaves, the
/// factor beside times its square, is below one.
pub(super) const RESIDUAL: [[f64; 2]; 3] = [[2.0, 0.0], [8.0, 16.0], [256.0, 1_048_576.0]];
/// A correction makes the residual smaller by this factor at least, or rounding is asked for.
pub(super) const PROGRESS: f64 = 0.5;
/// Where a solution is nearer than this to the first approximation, relative to itself, it is the one that Newton's method finds from there.
pub(super) const NEAR: f64 = 0.125;
/// So is it where the first correction from there leads nearer to it by this factor.
pub(super) const TOWARDS: f64 = 0.25;

/// Evaluations of a damped iteration, at most.
pub(super) const DAMPED: u32 = 40;
/// Where a residual is fewer times than this what rounding leaves of its terms, corrections are made in full.
pub(super) const NEARLY: f64 = 1e6;
/// A correction is not made shorter than by this factor.
pub(super) const SHORTEST: f64 = 1e-3;
/// In how many parts a step is continued from its first approximation, if it takes more; one is Newton's method as it is.
pub(super) const PARTS: [u32; 4] = [1, 4, 16, 64];
/// Evaluations of each part but the last, on average and at most.
pub(super) const EVALUATIONS: u32 = 8;
/// Evaluations of the last part, or of the whole: as many as Newton's method may need that wanders before it converges.
pub(super) const WANDERING: u32 = 60;
/// How far the last part of a path leads, or the whole one where it has one part, relative to the unknown, at most.
pub(super) const STRIDE: f64 = 0.25;
/// What is left of a correction relative to the unknown where the next part may begin.
pub(super) const ON_THE_WAY: f64 = 1e-3;
/// Solutions that differ by more than this, relative to their size, and by more than so many times what rounding leaves of them, are two. Others
/// differ by much more: no step is near these.
pub(super) const APART: f64 = 1e-6;
pub(super) const ROUNDINGS: f64 = 64.0;
