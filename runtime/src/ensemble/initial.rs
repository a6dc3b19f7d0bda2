//! Random states to start from.

use crate::retraction::RetractionKind;
use crate::scalar::Scalar;
use crate::system::Geometry;

/// Draws states about a given one, normally distributed.
///
/// The state of a number, from 0: `(0..100).map(normal(…))` starts an ensemble of a hundred members.
///
/// A state is displaced in the local coordinates of its group. Each component of a configuration's is the angle of a turn about an axis of
/// the body, or a way along it, and of one in space where `invariance = right`; turns are small rotations `g exp(δ)` or `exp(δ) g`, so that no
/// state is off its group. To momenta and advected parameters their components are added. `deviations` says how far they go for each component,
/// in the order of the state's fields: three numbers for an attitude, whatever it is stored as.
///
/// ```
/// use coadjoint::Ensemble;
/// use coadjoint::ensemble::normal;
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.z)]
/// struct Top {
///     #[inertia]
///     inertia: Vector3<f64>,
///     weight: f64,
/// }
///
/// let top = Top { inertia: vector![2.0, 2.0, 1.0], weight: 0.3 };
/// let upright =
///     TopState { attitude: UnitQuaternion::identity(), momentum: vector![0.0, 0.0, 4.0], gamma: Vector3::z() };
/// // leaning by about a hundredth of a radian; the momentum known to 0.05
/// let deviations = [0.01, 0.01, 0.0, 0.05, 0.05, 0.05, 0.0, 0.0, 0.0];
/// let states = (0..100).map(normal(&top, upright, deviations, 7)).map(|mut state| {
///     // the vertical, as it is seen from there
///     state.gamma = state.attitude.inverse() * Vector3::z();
///     state
/// });
/// let mut ensemble = Ensemble::<_, Cayley>::new(std::iter::repeat(&top), states, 0.01)?;
/// ensemble.run(1_000);
/// let lowest = ensemble.states().map(|state| state.gamma.z).fold(1.0, f64::min);
/// assert!(lowest < 0.9999 && lowest > 0.9, "{lowest}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// An advected parameter is a coordinate of its own, as the momentum is. One that is fixed in space has to be turned with the attitude, as
/// above.
///
/// A state is a function of the seed and its number alone: the same seed gives the same states, however many are drawn and by whom. (They
/// are made with the platform's logarithm and cosine, whose last digits may differ.) Numbers that are not finite are refused by the
/// [`Ensemble`](crate::Ensemble).
pub fn normal<S: Geometry>(
    system: &S,
    about: S::State,
    deviations: S::Tangent,
    seed: u64,
) -> impl Fn(usize) -> S::State {
    drawn(system, about, deviations, seed, Random::normal)
}

/// Draws states about a given one, evenly distributed, at most so far to either side; otherwise as [`normal`].
pub fn uniform<S: Geometry>(
    system: &S,
    about: S::State,
    widths: S::Tangent,
    seed: u64,
) -> impl Fn(usize) -> S::State {
    drawn(system, about, widths, seed, |random| 2.0 * random.uniform() - 1.0)
}

fn drawn<S: Geometry>(
    system: &S,
    about: S::State,
    reach: S::Tangent,
    seed: u64,
    number: fn(&mut Random) -> f64,
) -> impl Fn(usize) -> S::State {
    move |member| {
        let (mut random, mut by) = (Random::new(seed, member as u64), reach);
        for component in by.as_mut() {
            *component = *component * S::Scalar::of(number(&mut random));
        }
        system.displace(&about, RetractionKind::Exponential, &by)
    }
}

/// A stream of random numbers: splitmix64, started from a hash of seed and member.
struct Random(u64);

impl Random {
    fn new(seed: u64, member: u64) -> Self {
        Self(splitmix64(splitmix64(seed).wrapping_add(member)))
    }

    /// Evenly distributed between 0 and 1, never either of them.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        ((splitmix64(self.0) >> 12) as f64 + 0.5) * 2_f64.powi(-52)
    }

    /// Normally distributed with deviation 1, by Box and Muller's transformation.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (core::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A number all of whose bits depend on all bits of the given one; no two give the same.
fn splitmix64(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
