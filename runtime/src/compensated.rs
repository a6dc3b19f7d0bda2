//! Compensated arithmetic, for very long runs.

use core::marker::PhantomData;

use crate::double::Double;
use crate::method::{Advanced, Failure, Method, Outcome};
use crate::scalar::{Batch, Components, Mask, Scalar, mapped};
use crate::system::{Discretized, System};

/// The scheme `M` in compensated arithmetic, for very long runs.
///
/// A step in double precision rounds its state, and rounds in much the same way step after step: beside the random walk of the roundings,
/// which grows like the square root of their number, invariants drift a little, about 10⁻¹⁸ a step. After 10⁷ steps the drift is ahead.
/// `Compensated<M>` takes the steps of the scheme `M` with twice as many digits and carries those that the state has no room for from
/// step to step. What is left is one rounding, of the state that is shown. A step takes about a hundred times as long.
///
/// ```
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
/// let momentum = body.spatial_momentum(&state);
/// let mut stepper = body.stepper::<Compensated<Exponential>>(0.05)?;
/// for _ in 0..10_000 {
///     stepper.step(&mut state)?;
/// }
/// assert!((body.spatial_momentum(&state) - momentum).norm() < 2e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The digits are carried for as long as the states that the stepper is given are those that it led to; another state starts anew. The
/// wrapper goes outside: `Compensated<Order4<Cayley>>`. `Order4<Compensated<Cayley>>` would carry nothing from one part of a step to the next.
///
/// Sums, products, quotients and roots have all the digits. Elementary functions in potentials and forces have those of one number, and so
/// have Stumpff functions of large arguments: a step should not turn a body by more than a third of a radian. Numbers beyond 10²⁹² are not
/// finite here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compensated<M>(PhantomData<M>);

impl<S: Discretized<M>, M> Discretized<Compensated<M>> for S {
    type Method<T: Batch> = Compensation<S, M, T>;
}

/// A method with twice as many digits, between whose steps these are carried.
pub struct Compensation<S: Discretized<M>, M, T: Batch> {
    base: S::Method<Wide<T>>,
    /// Where the last step has led to.
    state: S::StateComponents<Wide<T>>,
}

/// What the arithmetic is done with.
type Wide<T> = Double<T>;

impl<S: Discretized<M>, M, T: Batch> Clone for Compensation<S, M, T> {
    fn clone(&self) -> Self {
        Self { base: self.base.clone(), state: self.state }
    }
}

/// The same numbers with more digits.
fn widened<T: Batch, C: Components<T>, W: Components<Wide<T>>>(components: &C) -> W {
    mapped(components.as_ref(), Wide::of(0.0), Double::exactly)
}

/// The nearest numbers with fewer.
fn rounded<T: Batch, W: Components<Wide<T>>, C: Components<T>>(components: &W) -> C {
    mapped(components.as_ref(), T::of(0.0), |wide| wide.parts()[0])
}

impl<S: Discretized<M>, M, T: Batch> Compensation<S, M, T> {
    fn remember(
        &mut self,
        advanced: Advanced<Wide<T>, S::StateComponents<Wide<T>>>,
    ) -> Advanced<T, S::StateComponents<T>> {
        self.state = advanced.state;
        Advanced {
            state: rounded(&advanced.state),
            iterations: advanced.iterations,
            residual: advanced.residual.parts()[0],
        }
    }
}

impl<S: Discretized<M>, M, T: Batch> Method for Compensation<S, M, T> {
    type CallSite = ();
    type Scalar = T;
    type Parameters = <S as System>::Parameters<T>;
    type State = S::StateComponents<T>;
    type Control = S::ControlComponents<T>;

    fn new(parameters: &Self::Parameters, step: T) -> Self {
        let nothing = <S::StateComponents<Wide<T>> as Components<Wide<T>>>::splat(Wide::of(0.0));
        Self { base: Method::new(&widened(parameters), Double::exactly(step)), state: nothing }
    }

    type FastPath = ();

    fn advance_from(
        &mut self,
        _from: Option<usize>,
        state: &Self::State,
        time: T,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<T, Self::State> {
        let same = state.as_ref().iter().zip(self.state.as_ref());
        let same = same.fold(T::Mask::splat(known), |same, (x, wide)| same & x.is_same(wide.parts()[0]));
        let wide: S::StateComponents<Wide<T>> = widened(state);
        let wide = crate::scalar::blocks::select::<Wide<T>, _>(same, &self.state, &wide);
        match self.base.advance(&wide, Double::exactly(time), &widened(control), same.all()) {
            Ok(advanced) => Ok(self.remember(advanced)),
            Err(Failure { errors, advanced }) => {
                let is_lost = errors.as_ref().iter().all(Option::is_some);
                let before = self.state;
                let advanced = self.remember(advanced);
                if is_lost {
                    self.state = before;
                }
                Err(Failure { errors, advanced })
            }
        }
    }

    fn set_inputs(&mut self, inputs: Option<&mut dyn FnMut(f64) -> Self::Control>) {
        match inputs {
            Some(at) => self.base.set_inputs(Some(&mut |share| widened(&at(share)))),
            None => self.base.set_inputs(None),
        }
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut parts = |numbers: &mut [Wide<T>]| {
            for number in numbers {
                let mut parts = number.parts();
                visit(&mut parts);
                *number = Double::from_parts(parts);
            }
        };
        parts(self.state.as_mut());
        self.base.memory(&mut parts);
    }
}
