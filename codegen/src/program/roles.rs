//! What functions are for: their names, what they are given, what they return.

use std::fmt::Debug;

use super::{Input, RecordKind};
use crate::scheme::Retraction;

/// Tells the functions of a module apart.
pub trait FunctionRole: Copy + Debug + PartialEq + 'static {
    /// The function's signature.
    fn signature(self) -> Signature;

    /// The function's name.
    fn name(self) -> String {
        self.signature().name.to_owned()
    }
}

/// The signature of a function, by its role.
#[derive(Clone, Copy, Debug)]
pub struct Signature {
    /// The function's name.
    pub name: &'static str,
    /// Its arguments in this order, as far as its module has them.
    pub inputs: &'static [Input],
    /// The names of the arrays that it returns; where none has a name, the function's own name stands for them.
    pub results: &'static [&'static str],
    /// Its purpose, in a few words.
    pub purpose: &'static str,
}

/// The functions of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepRole {
    /// Computes what depends on parameters and step size alone, a record of [constants](RecordKind::Constants).
    New,
    /// Computes what depends on the state too, a [step](RecordKind::Step)'s record.
    Begin,
    /// A first approximation of the unknown.
    Start,
    /// The residual `left − right` of the equation, its right side, and an [iterate](RecordKind::Iterate)'s record.
    Evaluate,
    /// The solution `d` of `(∂residual/∂x) d = residual`.
    Correction,
    /// The solution `x` of `left(x) = right`, or of that equation without denominators. There where the left side is
    /// linear with constant coefficients.
    FixedPointUpdate,
    /// The distances to the edges of the retraction's domain, positive within. There where it has an edge.
    Domain,
    /// The next state.
    Finish,
}

/// The functions of a step's derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DerivativeRole {
    /// The coefficients of the linear maps, a [point](RecordKind::Point)'s record.
    Point,
    /// The perturbation of the next state from those of state, controls and parameters.
    Tangent,
    /// The transpose, in three arrays.
    Adjoint,
    /// The columns of the derivative of the next state with respect to the unknown, an array each.
    Through,
    /// For each component of the state, the derivatives with respect to it of the next state with the unknown as it is,
    /// and of the unknown; two arrays each.
    WrtState,
    /// The same with respect to the controls.
    WrtControl,
    /// The same with respect to the parameters.
    WrtParameters,
}

/// The functions of power series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TaylorRole {
    /// Once a step, a [step](RecordKind::Step)'s record, and the coefficients of order 0: of what has a series, and of
    /// its changes.
    Leading,
    /// Once an order, the coefficients: of the changes, and of both operands of all products.
    Next,
    /// The changes where what has a series has come to.
    Rate,
    /// The next state.
    Finish,
}

/// The functions of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SystemRole {
    /// The energy.
    Energy,
    /// The velocity that belongs to the momentum.
    Velocity,
    /// What vanishes at the velocity that belongs to the momentum, and Newton's correction of a velocity. There where
    /// it has no closed form.
    VelocityNewton,
    /// The momentum that belongs to a velocity.
    Momentum,
    /// What vanishes at the momentum that belongs to a velocity, and Newton's correction of the state's momentum. There
    /// where it has no closed form.
    MomentumNewton,
    /// The Casimirs.
    Casimirs,
    /// The momentum in space coordinates.
    SpatialMomentum,
    /// How far matrices are off their groups.
    Deviation,
    /// The pivots of the factorization `L D Lᵀ` of an inertia, by its place among them.
    Pivots(usize),
    /// The state displaced by a tangent vector along a retraction.
    Displacement(Retraction),
    /// The differential of the energy.
    Differential,
    /// The Hamiltonian vector of a covector.
    HamiltonianVector,
    /// The forces as a tangent vector.
    Force,
    /// The momentum that is constant, on the other side of the configuration. There where nothing acts on the system.
    Conserved,
    /// The state whose constant momentum is given. There where nothing acts on the system.
    WithConserved,
    /// What is zero at an event, by its place among them.
    Event(usize),
}

const CONSTANTS: Input = Input::Record(RecordKind::Constants);
const STEP: Input = Input::Record(RecordKind::Step);
const ITERATE: Input = Input::Record(RecordKind::Iterate);
const POINT: Input = Input::Record(RecordKind::Point);

use Input::{
    Coefficients, Conserved, Control, ControlPerturbation, Costate, End, Order, ParameterPerturbation,
    Parameters, Residual, Right, State, StatePerturbation, StepSize, Sums, Tangent, Time, Unknown, Velocity,
};

/// The inputs of a function of the solution.
const SOLVED: &[Input] = &[CONSTANTS, State, STEP, Unknown, Residual, ITERATE];

const fn row(
    name: &'static str,
    inputs: &'static [Input],
    results: &'static [&'static str],
    purpose: &'static str,
) -> Signature {
    Signature { name, inputs, results, purpose }
}

impl FunctionRole for StepRole {
    #[rustfmt::skip]
    fn signature(self) -> Signature {
        match self {
            Self::New => row("new", &[Parameters, StepSize], &[], "Once, when the stepper is built"),
            Self::Begin => row("begin", &[CONSTANTS, State, Time, Control], &[], "Once a step"),
            Self::Start => row("start", &[CONSTANTS, State, STEP], &["unknown"], "A first approximation of the unknown"),
            Self::Evaluate => row("evaluate", &[CONSTANTS, State, STEP, Unknown], &["residual", "right"],
                "Once an iteration: the residual and the right side of the equation"),
            Self::Correction => row("correction", SOLVED, &["correction"], "Once an iteration: the Newton correction"),
            Self::FixedPointUpdate => row("fixed_point_update", &[CONSTANTS, State, STEP, Unknown, Right, ITERATE],
                &["unknown"], "Once an iteration: the next iterate of the fixed-point iteration"),
            Self::Domain => row("domain", SOLVED, &["margin"], "Positive within the retraction's domain"),
            Self::Finish => row("finish", SOLVED, &["next"], "Once a step: the next state"),
        }
    }
}

impl FunctionRole for DerivativeRole {
    #[rustfmt::skip]
    fn signature(self) -> Signature {
        match self {
            Self::Point => row("point", &[Parameters, StepSize, State, Time, Control, Unknown], &[],
                "What the derivative is made of"),
            Self::Tangent => row("tangent", &[POINT, StatePerturbation, ControlPerturbation, ParameterPerturbation], &[],
                "The perturbation of the next state"),
            Self::Adjoint => row("adjoint", &[POINT, Costate], &["wrt_state", "wrt_control", "wrt_parameters"],
                "The transpose"),
            Self::Through => row("through", &[POINT], &[], "The derivative with respect to the unknown"),
            Self::WrtState => row("wrt_state", &[POINT], &[], "The derivative with respect to state"),
            Self::WrtControl => row("wrt_control", &[POINT], &[], "The derivative with respect to control"),
            Self::WrtParameters => row("wrt_parameters", &[POINT], &[], "The derivative with respect to parameters"),
        }
    }
}

impl FunctionRole for TaylorRole {
    #[rustfmt::skip]
    fn signature(self) -> Signature {
        match self {
            Self::Leading => row("leading", &[Parameters, State, Time, Control, Velocity], &["start", "change"],
                "Once a step: the coefficients of order 0"),
            Self::Next => row("next", &[STEP, Coefficients, Sums, Order], &["change", "left", "right"],
                "Once an order: the coefficients of the changes, and of what is multiplied"),
            Self::Rate => row("rate", &[STEP, End], &["rate"], "At each place looked at: the changes there"),
            Self::Finish => row("finish", &[STEP, End], &["next"], "Once a step: the next state"),
        }
    }
}

impl FunctionRole for SystemRole {
    #[rustfmt::skip]
    fn signature(self) -> Signature {
        match self {
            Self::Energy => row("energy", &[Parameters, State, Time, Control, Velocity], &[], "The energy"),
            Self::Velocity => row("velocity", &[Parameters, State, Time, Control], &[], "The velocity of the momentum"),
            Self::VelocityNewton => row("velocity_newton", &[Parameters, State, Time, Velocity, Control], &[],
                "What vanishes at the velocity of the momentum, and Newton's correction"),
            Self::Momentum => row("momentum", &[Parameters, State, Time, Velocity, Control], &[],
                "The momentum of the velocity"),
            Self::MomentumNewton => row("momentum_newton", &[Parameters, State, Time, Velocity, Control], &[],
                "What vanishes at the momentum of the velocity, and Newton's correction"),
            Self::Casimirs => row("casimirs", &[Parameters, State, Time], &[], "The Casimirs"),
            Self::SpatialMomentum => row("spatial_momentum", &[Parameters, State, Time], &[],
                "The momentum in space coordinates"),
            Self::Deviation => row("deviation", &[State], &[], "How far matrices are off their groups"),
            Self::Pivots(_) => row("pivots", &[Parameters], &[], "Positive, all of them, where the inertia is definite"),
            Self::Displacement(_) => row("displacement", &[Parameters, State, Tangent], &[], "The displaced state"),
            Self::Differential => row("differential", &[Parameters, State, Time, Control, Velocity], &[],
                "The differential of the energy"),
            Self::HamiltonianVector => row("hamiltonian_vector", &[Parameters, State, Tangent], &[],
                "The Hamiltonian vector of a covector"),
            Self::Force => row("force", &[Parameters, State, Control, Time, Velocity], &[], "The forces"),
            Self::Conserved => row("conserved", &[Parameters, State], &[], "The constant momentum"),
            Self::WithConserved => row("with_conserved", &[Parameters, State, Conserved], &[],
                "The state with this constant momentum"),
            Self::Event(_) => row("event", &[Parameters, State, Time, Control, Velocity], &[], "What is zero at an event"),
        }
    }

    fn name(self) -> String {
        let name = self.signature().name;
        if let Self::Pivots(place) | Self::Event(place) = self {
            return format!("{name}_{place}");
        }
        if let Self::Displacement(retraction) = self {
            return format!("{}_{name}", retraction.row().snake_name);
        }
        name.to_owned()
    }
}
