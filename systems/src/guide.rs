//! # How to read the figures, and when a structure-preserving step pays
//!
//! `coadjoint figures` draws them all, with the numbers of that run in the captions. What they show is also tested, with numbers.
//!
//! **1.1, the harmonic oscillator.** On a logarithmic scale, as in the paper, gains and losses are straight lines. Explicit Euler multiplies the energy by `1 + h²` at every step, implicit Euler divides it by as much: one
//! spirals out, the other in. The symplectic methods stay on an ellipse `q² ± h q p + p²`, close to the circle: the energy is not constant, but it
//! comes back.
//!
//! **1.2, the Kepler problem.** RK2 gains energy and angular momentum, at each passage close to the centre. Störmer–Verlet makes its largest
//! error there too, and takes it back; the angular momentum, a symmetry's, it keeps to roundoff. The ellipse turns slowly: structure does
//! not make a trajectory accurate.
//!
//! **1.3, the pendulum on its cylinder.** Without projection RK2 leaves the cylinder; with projection it does not. The paper says that projection fails
//! to respect the dynamics. That is so, and more: with projection the energy error grows three times as fast as without. The pendulum on the circle
//! as its own group needs no projection.
//!
//! **6.1 and 6.2, rigid body and heavy top.** Our steps keep the Casimirs to roundoff, and the energy error swings in bounds, as the paper says.
//! With RK4 and RKMK4 energy and Casimirs drift, as it says too. What it does not say is how small that drift is: with `h = 0.01` and after
//! half an hour, these methods of order 4 still have an energy error a hundred to ten thousand times *smaller* than that of ours of order 2. That
//! they "fail to preserve any of the geometric invariants" is true, and would be seen in the picture only after months of motion, or with larger
//! steps. The composition `Order4<Exponential>` has both.
//!
//! **6.3, the quadrotor.** The paper's steps (6.21) and (6.22), and the Störmer–Verlet steps that its text recommends. Angular momentum and attitude
//! are kept to roundoff by all, as claimed; the momentum of the paper's steps lags behind by half a kick. The paper calls it hovering flight; with the moment of
//! momentum that it starts with, the body tumbles, its thrust points everywhere, and it falls. At rest upright it hovers.
//!
//! **Work and precision.** Against the time of computation, a step of order 2 is no match for RK4 where a trajectory is wanted to many
//! digits; compositions of order 8 and 10 are. Their Casimirs are exact at every step size.
//!
//! **Large steps.** Where RK4's error grows with the fifth power of the step, and with the time, ours stay what they are. Above a tenth of a radian
//! or so for each step the exponential's energy is the better one after long times; before RK4 gives up it has lost the Casimirs altogether.
//!
//! **Identify, steer, estimate.** What the exact derivatives of steps are for, on one spacecraft: its inertia from noisy gyroscopes by Gauss and
//! Newton's method, a manoeuvre with few pulses and the least effort by direct shooting, attitude and momentum from stars by an error-state Kalman
//! filter. Steps are long, and yet Newton's iterations converge to rounding and the filter is consistent: the derivatives of the motion
//! are exact.
//!
//! # At one's own step
//!
//! `coadjoint run heavy_top --method rk4 --step 0.1` makes the same run with a classical method, for any system and step, and tells in the same table what
//! drifts: RK4 and others by their tableaux in the numbers of the state as they are stored, where rotations leave their group, and RKMK4, where they
//! do not. Beside them are the lifts of the paper, `right-lift` and `tangent-lift`, and members `family=1/4` of the family that were generated.
//!
//! # When it pays, and when not
//!
//! It pays
//!
//! * over long times: errors of energy do not add up, those of Casimirs and symmetries' momenta are roundoff;
//! * with large steps: a simulation at a fixed tick of 50 or 100 Hz of something that turns once in a few ticks;
//! * where Casimirs and constraints must hold exactly: `|Γ| = 1`, attitudes on their group, without repair;
//! * where each step must cost the same: an iteration that hardly varies, no step control, reversible to the last digit but roundoff;
//! * for the statistics of many states: volume in phase space is kept, so that nothing is drawn to places where it does not belong.
//!
//! It does not pay for one trajectory, over a moderate time, to many digits: there a good method of high order with step control that knows nothing
//! of structure is faster, three or four times by our own measurements. Nor where strong friction or control dominate: what is lost to them is more than
//! what a good method loses.
