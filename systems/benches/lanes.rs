//! What steps of one equation take in lanes: `cargo bench --features bench --bench lanes`.
//!
//! Ensembles of free bodies and of heavy tops, attitude included, with a step of 0.1 s, against RK4 by hand with members in the same registers.
//! Nanoseconds for a step of a member on one core, the least of rounds in turns, and the ratio to RK4. Both round a product and a sum once.
// a benchmark that cannot be made is to say so; instructions for registers of a width are asked for by their names
#![allow(clippy::unwrap_used, unsafe_code)]
#![cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports))]

use std::time::Instant;

use coadjoint::ensemble::Instructions;
use coadjoint::prelude::*;
use coadjoint::{Discretized, Ensemble, System};

/// How many members there are, how many steps they take in a round, and how many rounds.
const MEMBERS: usize = 256;
const STEPS: u64 = 400;
const ROUNDS: usize = 60;
const STEP: f64 = 0.1;

/// The moments of inertia, kg m², and the momenta, kg m²/s, of what is measured.
const BODIES: [([f64; 3], [f64; 3]); 2] =
    [([1.0, 2.0, 2.5], [1.0, -0.9, 1.0]), ([1.0, 10.0, 100.0], [1.0, 1.0, 1.0])];
const CHI: [f64; 3] = [0.3, 0.2, 1.0];
const GAMMA: [f64; 3] = [0.3, 0.4, 0.866_025_403_784_438_6];

/// A free rigid body.
#[lie_poisson_system(
    group = SO3,
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6), HamiltonJacobi(8))
)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = gamma.dot(&chi),
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6))
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    chi: Vector3<f64>,
}

/// The momentum of a member: each turns a little differently.
fn momentum(momentum: [f64; 3], member: usize) -> [f64; 3] {
    momentum.map(|component| component * (1.0 + 1e-4 * member as f64))
}

/// What is measured: takes so many steps of each member.
type Run<'a> = Box<dyn FnMut(u64) + 'a>;

#[cfg(target_arch = "x86_64")]
mod rk4 {
    use std::arch::x86_64::{__m256d, __m512d};
    use std::arch::x86_64::{_mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_mul_pd, _mm256_set1_pd};
    use std::arch::x86_64::{_mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_mul_pd, _mm512_set1_pd};

    use super::{CHI, STEP};

    /// Blocks of members that take a step at the same time, so that one computes while the other waits.
    pub(super) const BLOCKS: usize = 2;

    macro_rules! steps {
        ($name:ident, $feature:literal, $vector:ty, $mul:ident, $fma:ident, $fnma:ident, $splat:ident) => {
            /// Takes steps of members: of the quaternion, the momentum, and the vertical.
            #[target_feature(enable = $feature)]
            pub(super) fn $name<const TOP: bool>(
                inertia: [f64; 3],
                state: &mut [[$vector; 10]; BLOCKS],
                steps: u64,
            ) {
                let [inverse, chi] = [inertia.map(f64::recip), CHI].map(|numbers| numbers.map(|x| $splat(x)));
                let [half, sixth, third, whole] =
                    [STEP / 2.0, STEP / 6.0, STEP / 3.0, STEP].map(|x| $splat(x));
                let (zero, half_of) = ($splat(0.0), $splat(0.5));
                // `a b − c d`
                let cross = |a, b, c, d| $fnma(c, d, $mul(a, b));
                let rate = |state: &[$vector; 10]| {
                    let [a, b, c, d, x, y, z, g0, g1, g2] = *state;
                    let [u, v, w] = [$mul(x, inverse[0]), $mul(y, inverse[1]), $mul(z, inverse[2])];
                    let [p, q, r] = [u, v, w].map(|velocity| $mul(half_of, velocity));
                    let mut rate = [zero; 10];
                    rate[0] = $fnma(d, r, $fnma(c, q, $fnma(b, p, zero)));
                    rate[1] = $fma(c, r, cross(a, p, d, q));
                    rate[2] = $fma(d, p, cross(a, q, b, r));
                    rate[3] = $fma(b, q, cross(a, r, c, p));
                    rate[4] = cross(y, w, z, v);
                    rate[5] = cross(z, u, x, w);
                    rate[6] = cross(x, v, y, u);
                    if TOP {
                        rate[4] = $fma(g1, chi[2], $fnma(g2, chi[1], rate[4]));
                        rate[5] = $fma(g2, chi[0], $fnma(g0, chi[2], rate[5]));
                        rate[6] = $fma(g0, chi[1], $fnma(g1, chi[0], rate[6]));
                        rate[7] = cross(g1, w, g2, v);
                        rate[8] = cross(g2, u, g0, w);
                        rate[9] = cross(g0, v, g1, u);
                    }
                    rate
                };
                let length = if TOP { 10 } else { 7 };
                for _ in 0..steps {
                    for state in &mut *state {
                        let from = *state;
                        let mut k = rate(&from);
                        for (share, weight) in [(half, sixth), (half, third), (whole, third)] {
                            let mut moved = from;
                            for i in 0..length {
                                moved[i] = $fma(share, k[i], from[i]);
                                state[i] = $fma(weight, k[i], state[i]);
                            }
                            k = rate(&moved);
                        }
                        for i in 0..length {
                            state[i] = $fma(sixth, k[i], state[i]);
                        }
                    }
                }
            }
        };
    }
    steps!(fours, "avx2,fma", __m256d, _mm256_mul_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_set1_pd);
    steps!(eights, "avx512f", __m512d, _mm512_mul_pd, _mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_set1_pd);
}

/// RK4, attitude included.
#[cfg(target_arch = "x86_64")]
fn rk4<const TOP: bool>(body: usize, instructions: Instructions) -> Run<'static> {
    use std::arch::x86_64::{__m256d, __m512d};
    let (inertia, momentum) = BODIES[body];
    let start = |member: usize| {
        let [x, y, z] = self::momentum(momentum, member);
        let [g0, g1, g2] = GAMMA;
        [1.0, 0.0, 0.0, 0.0, x, y, z, g0, g1, g2]
    };
    macro_rules! run {
        ($steps:ident, $vector:ty, $lanes:literal) => {{
            let block = |first: usize| -> [$vector; 10] {
                let lanes: [[f64; 10]; $lanes] = std::array::from_fn(|lane| start(first + lane));
                // SAFETY: as many numbers as there are in a register
                std::array::from_fn(|i| unsafe { std::mem::transmute(lanes.map(|lane| lane[i])) })
            };
            let firsts = (0..MEMBERS).step_by(rk4::BLOCKS * $lanes);
            let mut blocks: Vec<[[$vector; 10]; rk4::BLOCKS]> =
                firsts.map(|first| std::array::from_fn(|k| block(first + k * $lanes))).collect();
            Box::new(move |steps| {
                for state in &mut blocks {
                    // SAFETY: the processor has these instructions
                    unsafe { rk4::$steps::<TOP>(inertia, state, steps) };
                }
                // SAFETY: numbers in a register
                let end: [f64; $lanes] = unsafe { std::mem::transmute(blocks[0][0][4]) };
                assert!(end[0].is_finite());
            })
        }};
    }
    match instructions {
        Instructions::Avx512 => run!(eights, __m512d, 8),
        _ => run!(fours, __m256d, 4),
    }
}

/// An ensemble of ours.
fn ours<S, M>(
    system: &S,
    start: impl Fn([f64; 3]) -> S::State,
    body: usize,
    instructions: Instructions,
) -> Run<'static>
where
    S: Discretized<M> + System<Scalar = f64> + 'static,
    M: 'static,
{
    let states = (0..MEMBERS).map(|member| start(momentum(BODIES[body].1, member)));
    let systems = std::iter::repeat(system);
    let mut ensemble = Ensemble::<S, M>::with_instructions(systems, states, STEP, instructions).unwrap();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    Box::new(move |steps| {
        one.install(|| ensemble.run(steps));
        assert!(ensemble.failed().is_empty());
    })
}

#[cfg(not(target_arch = "x86_64"))]
fn main() {
    println!("for x86-64 alone");
}

#[cfg(target_arch = "x86_64")]
fn main() {
    for instructions in
        Instructions::available().filter(|instructions| *instructions != Instructions::Portable)
    {
        for (body, (moments, _)) in BODIES.iter().enumerate() {
            let inertia = (*moments).into();
            let free = |momentum: [f64; 3]| BodyState {
                attitude: UnitQuaternion::identity(),
                momentum: momentum.into(),
            };
            let heavy = |momentum: [f64; 3]| TopState {
                attitude: UnitQuaternion::identity(),
                momentum: momentum.into(),
                gamma: GAMMA.into(),
            };
            macro_rules! of {
                ($system:expr, $start:ident, $order:literal) => {{
                    let name = concat!("order ", $order);
                    type Scheme = Fused<HamiltonJacobi<Exponential, $order>>;
                    (name, ours::<_, Scheme>(&$system, $start, body, instructions))
                }};
            }
            let (plain, top) = (Body { inertia }, Top { inertia, chi: CHI.into() });
            let free: Vec<(&str, Run<'_>)> = vec![
                ("RK4", rk4::<false>(body, instructions)),
                of!(plain, free, 4),
                of!(plain, free, 6),
                of!(plain, free, 8),
            ];
            let heavy =
                vec![("RK4", rk4::<true>(body, instructions)), of!(top, heavy, 4), of!(top, heavy, 6)];
            for (name, mut runs) in [("free body", free), ("heavy top", heavy)] {
                let mut best = vec![f64::INFINITY; runs.len()];
                for _ in 0..ROUNDS {
                    for ((_, run), best) in runs.iter_mut().zip(&mut best) {
                        let clock = Instant::now();
                        run(STEPS);
                        *best =
                            best.min(clock.elapsed().as_secs_f64() * 1e9 / (STEPS * MEMBERS as u64) as f64);
                    }
                }
                let cells: Vec<_> = runs
                    .iter()
                    .zip(&best)
                    .map(|((name, _), time)| format!("{name} {time:.2} ({:.2})", time / best[0]))
                    .collect();
                println!("{name}, {moments:?}, {instructions:?}: {}", cells.join(", "));
            }
        }
    }
}
