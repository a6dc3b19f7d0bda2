//! What schemes claim of their steps.

use super::definition::Walk;
use super::probe::Probe;
use crate::composition::{self, Coefficients, Composed};
use crate::erased::{Composed as ErasedComposition, Description, Scheme};
use crate::retraction::{Cayley, Exponential, Map, Retraction, SecondKind};
use crate::scheme::{
    Family, RightLift, Rule, StormerVerlet, SymplecticEulerA, SymplecticEulerB, TangentLift, without_paths,
};
use crate::system::{Generated, Geometry, Retracted};

/// Which of a system's Casimirs a step keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Kept {
    /// All of them.
    All,
    /// Those that are functions of advected parameters alone.
    Advected,
    /// None.
    None,
}

/// What a scheme claims of its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Claim {
    /// The order.
    pub order: u32,
    /// Whether the step `−h` undoes the step `h`.
    pub symmetric: bool,
    /// Whether steps keep the Poisson structure, on the cotangent bundle the symplectic form.
    pub poisson: bool,
    /// What they keep of the Casimirs.
    pub casimirs: Kept,
}

impl Claim {
    /// What the tangent lift with `s = numerator/denominator` claims.
    pub(crate) const fn tangent_lift(numerator: u32, denominator: u32) -> Self {
        let even = 2 * numerator as u64 == denominator as u64;
        Self { order: if even { 2 } else { 1 }, symmetric: even, poisson: false, casimirs: Kept::Advected }
    }

    /// What the member `s = numerator/denominator` of the family claims. Its adjoint is `1 − s` with any retraction, and every member is
    /// symplectic. That `s` and `1 − s` are one map, where momentum and advected parameters alone have a part in the motion, follows from
    /// the retraction's being a function of one matrix.
    pub(crate) const fn family(
        map: Map,
        invariant: bool,
        forced: bool,
        numerator: u32,
        denominator: u32,
    ) -> Self {
        let is_middle = 2 * numerator as u64 == denominator as u64;
        let even = is_middle || invariant && map.is_matrix_function();
        Self { order: if even { 2 } else { 1 }, symmetric: even, poisson: !forced, casimirs: Kept::All }
    }

    /// What a composition with coefficients of this order claims.
    pub(crate) const fn composed(self, order: u32) -> Self {
        let rises = self.symmetric && self.order == 2;
        Self { order: if rises { order } else { self.order }, ..self }
    }
}

/// A scheme that says what its steps claim for the system `S`, to be [certified](super::certify).
pub trait Claims<S: Geometry<Scalar = f64>> {
    /// The claims.
    const CLAIM: Claim;

    /// The scheme as users write it.
    fn name() -> String {
        without_paths(core::any::type_name::<Self>())
    }

    /// Takes the same step from its definition; `false` if there is none to compare with.
    #[doc(hidden)]
    fn walk(_walk: &mut Walk<'_>, _step: f64) -> bool {
        false
    }

    /// Shows the kernels that the step is made of.
    #[doc(hidden)]
    fn kernels(_probe: &mut Probe<'_>, _step: f64) {}
}

macro_rules! retraction {
    ($($name:ident),*) => {
        $(impl<S> Claims<S> for $name
        where
            S: Geometry<Scalar = f64> + Retracted<$name>,
            <S as Retracted<$name>>::Scheme: Claims<S>,
        {
            const CLAIM: Claim = <<S as Retracted<$name>>::Scheme as Claims<S>>::CLAIM;

            fn walk(walk: &mut Walk<'_>, step: f64) -> bool {
                <<S as Retracted<$name>>::Scheme as Claims<S>>::walk(walk, step)
            }

            fn kernels(probe: &mut Probe<'_>, step: f64) {
                <<S as Retracted<$name>>::Scheme as Claims<S>>::kernels(probe, step);
            }
        })*
    };
}
retraction!(Exponential, Cayley, SecondKind);

impl<S, R, const N: u32, const D: u32> Claims<S> for Family<R, N, D>
where
    S: Geometry<Scalar = f64> + Generated<Self>,
    R: Retraction,
{
    const CLAIM: Claim = Claim::family(R::MAP, S::INVARIANT, S::FORCED, N, D);

    fn name() -> String {
        match (N, D) {
            (0, 1) => on::<R>("SymplecticEulerA"),
            (1, 2) => on::<R>("Midpoint"),
            (1, 1) => on::<R>("SymplecticEulerB"),
            _ => format!("Family<{}, {N}, {D}>", without_paths(core::any::type_name::<R>())),
        }
    }

    fn walk(walk: &mut Walk<'_>, step: f64) -> bool {
        walk.family(R::MAP, f64::from(N) / f64::from(D), step);
        true
    }

    fn kernels(probe: &mut Probe<'_>, step: f64) {
        probe.kernel::<S, Self>(step);
    }
}

impl<S, R> Claims<S> for StormerVerlet<R>
where
    S: Geometry<Scalar = f64>,
    SymplecticEulerA<R>: Claims<S>,
    SymplecticEulerB<R>: Claims<S>,
{
    // half of the first member, then half of its adjoint
    const CLAIM: Claim = Claim { order: 2, symmetric: true, ..SymplecticEulerA::<R>::CLAIM };

    fn name() -> String {
        on::<R>("StormerVerlet")
    }

    fn walk(walk: &mut Walk<'_>, step: f64) -> bool {
        SymplecticEulerA::<R>::walk(walk, 0.5 * step) && SymplecticEulerB::<R>::walk(walk, 0.5 * step)
    }

    fn kernels(probe: &mut Probe<'_>, step: f64) {
        SymplecticEulerA::<R>::kernels(probe, 0.5 * step);
        SymplecticEulerB::<R>::kernels(probe, 0.5 * step);
    }
}

impl<S, R, const N: u32, const D: u32> Claims<S> for TangentLift<R, N, D>
where
    S: Geometry<Scalar = f64> + Generated<Self>,
{
    const CLAIM: Claim = Claim::tangent_lift(N, D);

    fn name() -> String {
        match (N, D) {
            (0, 1) => on::<R>("TangentLift"),
            (1, 2) => on::<R>("TangentMidpoint"),
            _ => format!("TangentLift<{}, {N}, {D}>", without_paths(core::any::type_name::<R>())),
        }
    }

    fn kernels(probe: &mut Probe<'_>, step: f64) {
        probe.kernel::<S, Self>(step);
    }
}

impl<S: Geometry<Scalar = f64>, M: Claims<S>> Claims<S> for RightLift<M> {
    const CLAIM: Claim = M::CLAIM;

    fn name() -> String {
        format!("RightLift<{}>", M::name())
    }

    fn walk(walk: &mut Walk<'_>, step: f64) -> bool {
        M::walk(walk, step)
    }

    fn kernels(probe: &mut Probe<'_>, step: f64) {
        M::kernels(probe, step);
        probe.carries();
    }
}

impl<S: Geometry<Scalar = f64>, C: Coefficients, M: Claims<S>> Claims<S> for Composed<C, M> {
    const CLAIM: Claim = M::CLAIM.composed(C::ORDER);

    fn name() -> String {
        composition::name(core::any::type_name::<C>(), &M::name())
    }

    fn walk(walk: &mut Walk<'_>, step: f64) -> bool {
        C::GAMMA.iter().all(|gamma| M::walk(walk, gamma * step))
    }

    fn kernels(probe: &mut Probe<'_>, step: f64) {
        for gamma in C::GAMMA {
            M::kernels(probe, gamma * step);
        }
    }
}

/// A scheme on the retraction `R`. The compiler's own name leaves out what is the default.
fn on<R>(scheme: &str) -> String {
    format!("{scheme}<{}>", without_paths(core::any::type_name::<R>()))
}

impl Scheme {
    /// What it claims of its steps of a system.
    pub fn claim(&self, description: &Description) -> Claim {
        let family = |map, numerator, denominator| {
            Claim::family(map, description.invariant, description.forced, numerator, denominator)
        };
        match self.resolved(description.invariant) {
            Self::Step(map, Rule::Member(numerator, denominator)) => family(map, numerator, denominator),
            Self::Step(_, Rule::TangentLift(numerator, denominator)) => {
                Claim::tangent_lift(numerator, denominator)
            }
            Self::Composed(ErasedComposition { order, base, .. }) => base.claim(description).composed(order),
            Self::StormerVerlet(map) | Self::Standard(map) => {
                Claim { order: 2, symmetric: true, ..family(map, 0, 1) }
            }
        }
    }
}
