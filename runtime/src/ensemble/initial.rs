//! Random states to start from.

use core::fmt;

use crate::retraction::Map;
use crate::scalar::Scalar;
use crate::system::Geometry;

/// Random states about a given one, to start an ensemble from: an iterator without end.
///
/// A state is displaced in the local coordinates of its group. Each component of a configuration's is the angle of a turn about an axis of
/// the body, or a way along it; turns are small rotations `g exp(δ)`, so that no state is off its group. To momenta and advected parameters
/// their components are added. How far they go is said for each component, in the order of the state's fields: three numbers for an attitude,
/// whatever it is stored as.
///
/// ```
/// use coadjoint::Ensemble;
/// use coadjoint::ensemble::InitialStates;
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
/// let states = InitialStates::normal(&top, upright, deviations, 7).map(|mut state| {
///     // the vertical, as it is seen from there
///     state.gamma = state.attitude.inverse() * Vector3::z();
///     state
/// });
/// let mut ensemble = Ensemble::<_, Cayley>::new(std::iter::repeat(&top), states.take(100), 0.01)?;
/// ensemble.run(1_000);
/// let lowest = ensemble.states().map(|state| state.gamma.z).fold(1.0, f64::min);
/// assert!(lowest < 0.9999 && lowest > 0.9, "{lowest}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// An advected parameter is a coordinate of its own, as the momentum is. One that is fixed in space has to be turned with the attitude, as
/// above.
///
/// A state is a function of the seed and its number alone: the same seed gives the same states, however many are drawn and by whom. (Normal
/// ones are made with the platform's logarithm and cosine, whose last digits may differ.) Numbers that are not finite are refused by the
/// [`Ensemble`](crate::Ensemble).
pub struct InitialStates<'a, S: Geometry> {
    system: &'a S,
    about: S::State,
    reach: S::Tangent,
    shape: Shape,
    seed: u64,
    next: usize,
}

/// How a component is distributed.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Normal,
    Uniform,
}

impl<'a, S: Geometry> InitialStates<'a, S> {
    /// Normally distributed, with these standard deviations.
    pub fn normal(system: &'a S, about: S::State, deviations: S::Tangent, seed: u64) -> Self {
        Self { system, about, reach: deviations, shape: Shape::Normal, seed, next: 0 }
    }

    /// Evenly distributed, at most so far to either side.
    pub fn uniform(system: &'a S, about: S::State, widths: S::Tangent, seed: u64) -> Self {
        Self { system, about, reach: widths, shape: Shape::Uniform, seed, next: 0 }
    }

    /// The state with this number, from 0, wherever the iterator is.
    pub fn member(&self, member: usize) -> S::State {
        let mut random = Random::new(self.seed, member as u64);
        let mut by = self.reach;
        for component in by.as_mut() {
            let number = match self.shape {
                Shape::Normal => random.normal(),
                Shape::Uniform => 2.0 * random.uniform() - 1.0,
            };
            *component = *component * S::Scalar::of(number);
        }
        self.system.displace(&self.about, Map::Exponential, &by)
    }
}

impl<S: Geometry> Iterator for InitialStates<'_, S> {
    type Item = S::State;

    fn next(&mut self) -> Option<S::State> {
        let state = self.member(self.next);
        self.next += 1;
        Some(state)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (usize::MAX, None)
    }
}

impl<S: Geometry> Clone for InitialStates<'_, S> {
    fn clone(&self) -> Self {
        Self { about: self.about.clone(), ..*self }
    }
}

impl<S: Geometry> fmt::Debug for InitialStates<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InitialStates")
            .field("about", &self.about)
            .field("shape", &self.shape)
            .field("seed", &self.seed)
            .field("next", &self.next)
            .finish_non_exhaustive()
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
