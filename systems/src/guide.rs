//! # How to read the figures, and when a structure-preserving step pays
//!
//! `coadjoint figures` draws them all, with the numbers of that run in the captions. What they show is also tested, with numbers.
//!
//! **1.1, the harmonic oscillator.** Explicit Euler multiplies the energy by `1 + h²` at every step, implicit Euler divides it by as much. One
//! spirals out, the other in. On a logarithmic scale, as in the paper, both are straight lines. The symplectic methods stay on an ellipse
//! `q² ± h q p + p²`, close to the circle. Their energy is not constant, but it comes back.
//!
//! **1.2, the Kepler problem.** RK2 gains energy and angular momentum, at each passage close to the centre. Störmer–Verlet makes its largest
//! error there too, and takes it back. It keeps the angular momentum to roundoff, since that belongs to a symmetry. Its ellipse turns slowly:
//! structure does not make a trajectory accurate.
//!
//! **1.3, the pendulum on its cylinder.** Without projection RK2 leaves the cylinder; with projection it does not. The paper says that
//! projection fails to respect the dynamics. The figure says more: with projection the energy error grows three times as fast as without. The
//! pendulum on the circle as its own group needs no projection.
//!
//! **6.1 and 6.2, rigid body and heavy top.** Our steps keep the Casimirs to roundoff, and their energy errors stay bounded, as the paper says.
//! With RK4 and RKMK4 energy and Casimirs drift, as it says too. What it does not say is how small that drift is. With `h = 0.01`, after half
//! an hour, these methods of order 4 still have a smaller energy error than ours of order 2, by a factor of a hundred to ten thousand. The
//! paper says that they "fail to preserve any of the geometric invariants". That is true, but a picture shows it only after months of motion,
//! or with larger steps. The composition `Order4<Exponential>` has both.
//!
//! **6.3, the quadrotor.** The figure has the paper's steps (6.21) and (6.22), and the Störmer–Verlet steps that its text recommends. All keep
//! angular momentum and attitude to roundoff, as claimed. The momentum of the paper's steps lags behind by half a kick. The paper calls it
//! hovering flight. With the moment of momentum that it starts with, the body tumbles, its thrust points everywhere, and it falls. At rest
//! upright it hovers.
//!
//! **Work and precision.** For a trajectory to many digits, a step of order 2 is no match for RK4 in computing time. Compositions of order 8
//! and 10 are, and a Hamilton–Jacobi step of order 6 costs a quarter of them at 10⁻⁸. Their Casimirs are exact at every step size.
//!
//! **Large steps.** RK4's error grows with the fifth power of the step, and with time. Ours does not grow with time. Above a tenth of a radian
//! or so per step, the exponential's energy is the better one after long times. Before RK4 gives up, it has lost the Casimirs altogether.
//!
//! **Identify, steer, estimate.** These use the exact derivatives of steps, on one spacecraft. The first finds its inertia from noisy
//! gyroscopes by the Gauss–Newton method. The second finds a manoeuvre with few pulses and the least effort by direct shooting. The third
//! finds attitude and momentum from stars with an error-state Kalman filter. Steps are long, and yet Newton's iterations converge to rounding
//! and the filter is consistent, because the derivatives are exact.
//!
//! # At your own step
//!
//! `coadjoint run heavy_top --method rk4 --step 0.1` makes the same run with a classical method, for any system and step. The same table says
//! what drifts. RK4 and others work by their tableaux on the numbers of the state as they are stored, so rotations leave their group. RKMK4
//! stays on it. There are also the lifts of the paper, `right-lift` and `tangent-lift`, and members `family=1/4` of the family that were
//! generated.
//!
//! # When it pays, and when not
//!
//! It pays
//!
//! * over long times: errors of energy do not add up, those of Casimirs and symmetries' momenta are roundoff;
//! * with large steps: a simulation at a fixed tick of 50 or 100 Hz of something that turns once in a few ticks;
//! * where Casimirs and constraints must hold exactly: `|Γ| = 1`, attitudes on their group, without repair;
//! * where each step must cost the same: an iteration that hardly varies, no step control, reversible up to roundoff;
//! * for the statistics of many states: volume in phase space is kept, so states do not gather where they do not belong.
//!
//! Steps of order 2 do not pay for one trajectory to many digits: for that there are Hamilton–Jacobi and Taylor steps. By our own measurements a
//! good method of order 8 with step control, which knows nothing of structure, takes twice as long as these on a free body, and a fifth less on a
//! heavy top. Nor does it pay where strong friction or control dominate: they change more than a good method loses.
