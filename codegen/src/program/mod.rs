//! What is computed for a system, in no language: functions of arrays and records, made of straight-line code.
//!
//! Everything is decided here but spelling: which values have names, what is stored between functions, how sums associate, where a product
//! is added in one operation. An emitter gives words to it, an interpreter numbers.

mod interface;
mod interpreter;
mod operations;
mod text;

pub use interface::{Documentation, Element, Inertia, Interface, Quantity};
pub use interpreter::{CallError, Given, Returned};
pub use operations::Operations;

/// Functions of one number.
pub use crate::expr::Function as Elementary;
use crate::expr::Number;
use crate::scheme::Scheme;

/// A value with a name, within one [`Module`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(pub(crate) usize);

impl Value {
    /// Its number within the module, from 0 on.
    pub fn number(self) -> usize {
        self.0
    }
}

/// All that is computed for a system.
#[derive(Clone, Debug)]
pub struct Program {
    /// What is to be seen of it from outside.
    pub interface: Interface,
    /// Its functions, each a module of its own.
    pub functions: Vec<Module>,
    /// Its steps.
    pub steps: Vec<StepProgram>,
}

/// The step of one scheme.
#[derive(Clone, Debug)]
pub struct StepProgram {
    /// The scheme.
    pub scheme: Scheme,
    /// Other schemes that are the same map.
    pub aliases: Vec<Scheme>,
    /// The lengths of the blocks of unknowns that have a unit in common.
    pub blocks: Vec<usize>,
    /// Which components of the next state are bounded if the unknown is.
    pub bounded: Vec<bool>,
    /// Its functions.
    pub module: Module,
    /// Those of its derivative, if any is asked for.
    pub derivative: Option<Module>,
}

/// Functions that share values and records: those of one step, of its derivative, of a system.
#[derive(Clone, Debug, Default)]
pub struct Module {
    /// What the values are called: words of letters, digits and `_`. What one function can see has different names.
    pub(crate) names: Vec<String>,
    /// What functions hand on to others.
    pub records: Vec<Record>,
    /// The functions, in the order in which they are called.
    pub functions: Vec<Function>,
}

/// Values that one function computes and others need.
#[derive(Clone, Debug)]
pub struct Record {
    /// What it is made of.
    pub kind: RecordKind,
    /// Its fields.
    pub fields: Vec<Value>,
}

/// What the fields of a [`Record`] depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RecordKind {
    /// Parameters and step size.
    Constants,
    /// The state, the time and the controls too.
    Step,
    /// The unknown of a step's equation too.
    Iterate,
    /// The point at which a step is differentiated.
    Point,
}

/// A function: its arguments in order, what it computes from them, and what it returns.
#[derive(Clone, Debug)]
pub struct Function {
    /// What it is for.
    pub role: Role,
    /// What it is given.
    pub arguments: Vec<Argument>,
    /// What is computed, in order.
    pub statements: Vec<Statement>,
    /// The record that it returns, if it returns one.
    pub record: Option<RecordKind>,
    /// The arrays that it returns.
    pub results: Vec<Vec<Term>>,
}

/// What a function computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Of a step: what depends on parameters and step size alone, a record of [constants](RecordKind::Constants).
    New,
    /// Of a step: what depends on the state too, a [step](RecordKind::Step)'s record.
    Begin,
    /// Of a step: a first approximation of the unknown.
    Start,
    /// Of a step: the residual `left − right` of its equation, its right side, and an [iterate](RecordKind::Iterate)'s record.
    Evaluate,
    /// Of a step: the solution `d` of `(∂residual/∂x) d = residual`.
    Correction,
    /// Of a step: the next iterate of the fixed-point iteration: the solution `x` of `left(x) = right`, or of that equation without
    /// denominators. There where the left side is linear with constant coefficients.
    FixedPointUpdate,
    /// Of a step: the distances to the edges of the retraction's domain, positive within. There where it has an edge.
    Domain,
    /// Of a step: the next state.
    Finish,
    /// Of a derivative: what the linear maps are made of, a [point](RecordKind::Point)'s record.
    Point,
    /// Of a derivative: the perturbation of the next state from those of state, controls and parameters.
    Tangent,
    /// Of a derivative: the transpose, in three arrays.
    Adjoint,
    /// Of a derivative: the columns of the derivative of the next state with respect to the unknown, an array each.
    Through,
    /// Of a derivative: for each component of the state, the derivatives with respect to it of the next state with the unknown as it is,
    /// and of the unknown; two arrays each.
    WrtState,
    /// The same with respect to the controls.
    WrtControl,
    /// The same with respect to the parameters.
    WrtParameters,
    /// Of a system: the energy.
    Energy,
    /// Of a system: the velocity that belongs to the momentum.
    Velocity,
    /// Of a system: what vanishes at the velocity that belongs to the momentum, and Newton's correction of a velocity. There where it has no
    /// closed form.
    VelocityNewton,
    /// Of a system: the momentum that belongs to a velocity.
    Momentum,
    /// Of a system: what vanishes at the momentum that belongs to a velocity, and Newton's correction of the state's momentum. There where
    /// it has no closed form.
    MomentumNewton,
    /// Of a system: the Casimirs.
    Casimirs,
    /// Of a system: the momentum in space coordinates.
    SpatialMomentum,
    /// Of a state: how far matrices are off their groups.
    Deviation,
    /// Of a system: the pivots of the factorization `L D Lᵀ` of an inertia, by its place among them.
    Pivots(usize),
    /// Of a system: the state displaced by a tangent vector along the exponential map.
    ExponentialDisplacement,
    /// Of a system: the state displaced by a tangent vector along the Cayley map.
    CayleyDisplacement,
    /// Of a system: the state displaced by a tangent vector in coordinates of the second kind.
    SecondKindDisplacement,
    /// Of a system: the differential of the energy.
    Differential,
    /// Of a system: the Hamiltonian vector of a covector.
    HamiltonianVector,
    /// Of a system: the forces as a tangent vector.
    Force,
    /// Of a system that nothing acts on: the momentum that is constant, on the other side of the configuration.
    Conserved,
    /// Of a system that nothing acts on: the state whose constant momentum is given.
    WithConserved,
}

/// One argument of a function.
#[derive(Clone, Debug)]
pub struct Argument {
    /// What is given.
    pub input: Input,
    /// Its components, or its fields; those that the function uses.
    pub values: Vec<Option<Value>>,
}

/// What a function can be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Input {
    /// The parameters.
    Parameters,
    /// The step size, a scalar.
    StepSize,
    /// The state.
    State,
    /// The time, a scalar.
    Time,
    /// The controls.
    Control,
    /// The unknown of a step's equation.
    Unknown,
    /// The residual of the equation.
    Residual,
    /// The right side of the equation.
    Right,
    /// What another function has computed.
    Record(RecordKind),
    /// The perturbation of the state.
    StatePerturbation,
    /// The perturbation of the controls.
    ControlPerturbation,
    /// The perturbation of the parameters.
    ParameterPerturbation,
    /// The derivative of a function of the next state.
    Costate,
    /// A tangent vector or a covector at a state.
    Tangent,
    /// A momentum that is constant where nothing acts.
    Conserved,
    /// A velocity.
    Velocity,
}

/// One line of code.
#[derive(Clone, Debug)]
pub enum Statement {
    /// A value gets its name.
    Let {
        /// The value.
        value: Value,
        /// What it is.
        term: Term,
    },
    /// Stumpff functions `c_0, c_1, …` of one argument; `None` for those not used.
    Stumpff {
        /// The values.
        values: Vec<Option<Value>>,
        /// `z`
        argument: Term,
    },
}

/// A value, as a tree of operations.
#[derive(Clone, Debug)]
pub enum Term {
    /// A constant.
    Number(Number),
    /// A named value.
    Value(Value),
    /// `−x`
    Negative(Box<Term>),
    /// Addends, from left to right, `true` for those subtracted; the first is not.
    Sum(Vec<(bool, Term)>),
    /// Factors, from left to right.
    Product(Vec<Term>),
    /// `addend + a b`, or `addend − a b`: one operation where processors have it.
    MulAdd {
        /// Whether the product is subtracted.
        negative: bool,
        /// `a`
        a: Box<Term>,
        /// `b`
        b: Box<Term>,
        /// `addend`
        addend: Box<Term>,
    },
    /// `x / y`
    Quotient(Box<Term>, Box<Term>),
    /// `function(x)`
    Function(Elementary, Box<Term>),
    /// `x^y`
    Power(Box<Term>, Box<Term>),
    /// The angle of the point `(second, first)`.
    Atan2(Box<Term>, Box<Term>),
}

impl Program {
    /// The function of a role, with the module that it stands in, if there is one.
    pub fn function(&self, role: Role) -> Option<(&Module, &Function)> {
        self.functions.iter().find_map(|module| Some((module, module.function(role)?)))
    }
}

impl Module {
    /// What a value is called.
    pub fn name(&self, value: Value) -> &str {
        &self.names[value.0]
    }

    /// How many places values can have, by their [numbers](Value::number), and one that is nobody's.
    pub fn places(&self) -> usize {
        self.names.len() + 1
    }

    /// The function of a role, if there is one.
    pub fn function(&self, role: Role) -> Option<&Function> {
        self.functions.iter().find(|function| function.role == role)
    }

    /// The fields of a record.
    pub fn fields(&self, kind: RecordKind) -> &[Value] {
        self.records.iter().find(|record| record.kind == kind).map_or(&[], |record| &record.fields)
    }

    /// How many operations the function of a role takes; none if there is no such function.
    pub fn operations(&self, role: Role) -> Operations {
        self.function(role).map(Function::operations).unwrap_or_default()
    }
}

impl Function {
    /// How many components an argument has; none if it is no argument.
    pub fn length(&self, input: Input) -> usize {
        self.arguments.iter().find(|argument| argument.input == input).map_or(0, |given| given.values.len())
    }
}

impl Function {
    /// Drops from the arguments what the function makes no use of. Fields that a record returns are used.
    pub(crate) fn keep_used_arguments(&mut self, records: &[Record]) {
        let mut used = std::collections::BTreeSet::new();
        for statement in &self.statements {
            match statement {
                Statement::Let { term, .. } | Statement::Stumpff { argument: term, .. } => {
                    term.values(&mut |value| _ = used.insert(value));
                }
            }
        }
        self.results.iter().flatten().for_each(|term| term.values(&mut |value| _ = used.insert(value)));
        let returned = records.iter().find(|record| Some(record.kind) == self.record);
        used.extend(returned.iter().flat_map(|record| &record.fields));
        for argument in &mut self.arguments {
            for value in &mut argument.values {
                *value = value.filter(|value| used.contains(value));
            }
        }
    }
}

impl Term {
    /// The term with the images of its operands.
    pub(crate) fn map(self, mut image: impl FnMut(Self) -> Self) -> Self {
        let mut within = |term: Box<Self>| Box::new(image(*term));
        match self {
            Self::Number(_) | Self::Value(_) => self,
            Self::Negative(x) => Self::Negative(within(x)),
            Self::Sum(addends) => {
                Self::Sum(addends.into_iter().map(|(negative, x)| (negative, image(x))).collect())
            }
            Self::Product(factors) => Self::Product(factors.into_iter().map(image).collect()),
            Self::MulAdd { negative, a, b, addend } => {
                Self::MulAdd { negative, a: within(a), b: within(b), addend: within(addend) }
            }
            Self::Quotient(x, y) => Self::Quotient(within(x), within(y)),
            Self::Function(function, x) => Self::Function(function, within(x)),
            Self::Power(x, y) => Self::Power(within(x), within(y)),
            Self::Atan2(y, x) => Self::Atan2(within(y), within(x)),
        }
    }

    /// Shows each value that the term names.
    pub fn values(&self, show: &mut impl FnMut(Value)) {
        match self {
            Self::Number(_) => {}
            Self::Value(value) => show(*value),
            Self::Negative(x) | Self::Function(_, x) => x.values(show),
            Self::Sum(addends) => addends.iter().for_each(|(_, addend)| addend.values(show)),
            Self::Product(factors) => factors.iter().for_each(|factor| factor.values(show)),
            Self::MulAdd { a, b, addend, .. } => [a, b, addend].iter().for_each(|part| part.values(show)),
            Self::Quotient(x, y) | Self::Power(x, y) | Self::Atan2(x, y) => {
                x.values(show);
                y.values(show);
            }
        }
    }
}
