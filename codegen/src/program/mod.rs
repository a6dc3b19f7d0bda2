//! What is computed for a system, in no language: functions of arrays and records, made of straight-line code.
//!
//! Everything is decided here but spelling: which values have names, what is stored between functions, how sums
//! associate, where a product is added in one operation. An emitter gives words to it.
//!
//! # What callers do
//!
//! Functions are no more than their statements. Whoever calls them does the rest:
//!
//! * **A step** is [solved](solver). Its parts and their shares are those of [`Program::standard`], or of any scheme that there is.
//! * **[`StepRole::Domain`]** returns margins: the solution is inside where the least of them is positive.
//! * **[`Input::Velocity`]** of a function of the system is what [`SystemRole::Velocity`] gives, where [`Interface::velocity`] is
//!   [explicit](Transform::Explicit). Else it is found by Newton's method from zero: [`SystemRole::VelocityNewton`] returns the residual, and behind
//!   it the correction, which is subtracted. A correction that leads to where something is not finite is halved. The iteration ends where no
//!   component's correction becomes smaller. [`SystemRole::MomentumNewton`] is used likewise.
//! * **A state is on its group** where the largest of two numbers is small: what [`SystemRole::Deviation`] returns, for matrices, and how far the
//!   lengths of the rotations are from 1, for every [configuration](crate::quantity::Role::Configuration) of a
//!   [`Kind`](crate::quantity::Kind) with one. The library refuses states that are off by more than 0.001.
//! * **Parameters** are finite; [inertias](Interface::inertias) that are matrices equal their transposes to 1e-6 of the largest entry, and steps take
//!   their symmetric parts; and all [pivots](SystemRole::Pivots) are positive.
//! * **A derivative's matrix** is, column by column, `explicit + through · unknown`, of the two arrays that [`DerivativeRole::WrtState`] and its like
//!   return for each column.
//! * **[Stumpff functions](stumpff)** are a statement: the target brings them.

mod interface;
mod operations;
mod roles;
pub mod solver;
mod standard;
pub mod stumpff;
mod text;

pub use interface::{Constant, Documentation, Element, Inertia, Interface, Quantity, Transform};
pub use operations::Operations;
pub use roles::{DerivativeRole, FunctionRole, Signature, StepRole, SystemRole, TaylorRole};

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
    /// Its public surface.
    pub interface: Interface,
    /// Its functions, each a module of its own.
    pub functions: Vec<Module<SystemRole>>,
    /// Its steps.
    pub steps: Vec<StepProgram>,
    /// The power series of its motion, if they are asked for.
    pub taylor: Option<TaylorProgram>,
}

/// The power series of a system's motion.
#[derive(Clone, Debug)]
pub struct TaylorProgram {
    /// The lengths of the blocks of what has a series that have a unit in common.
    pub blocks: Vec<usize>,
    /// Where the controls stand among what has a series, if they have a part in the motion.
    pub controls: Option<usize>,
    /// Where the rates stand at which the controls change, if the velocity depends on them: the last numbers of its start.
    pub rates: Option<usize>,
    /// The events whose series there are.
    pub events: Vec<usize>,
    /// Its functions.
    pub module: Module<TaylorRole>,
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
    /// Whether Newton's matrix is the Jacobian of the residual.
    pub has_true_jacobian: bool,
    /// Whether all iterations are simplified Newton steps with nearly that matrix.
    pub is_newton: bool,
    /// Whether that is one of the beginning of a step.
    pub is_chord: bool,
    /// Whether it has so many values that what rounding leaves in the solution of its equation is some units.
    pub is_long: bool,
    /// Its functions.
    pub module: Module<StepRole>,
    /// Those of its derivative, if any is asked for.
    pub derivative: Option<Module<DerivativeRole>>,
}

/// Functions that share values and records: those of one step, of its derivative, of a system.
#[derive(Clone, Debug)]
pub struct Module<R> {
    /// Their names and records.
    pub values: Values,
    /// The functions, in the order in which they are called.
    pub functions: Vec<Function<R>>,
}

/// The names of a module's values, and its records.
#[derive(Clone, Debug)]
pub struct Values {
    /// The values' names: words of letters, digits and `_`. What one function can see has different names.
    pub(crate) names: Vec<String>,
    /// What functions hand on to others.
    pub records: Vec<Record>,
}

/// Values that one function computes and others need.
#[derive(Clone, Debug)]
pub struct Record {
    /// What it is made of.
    pub kind: RecordKind,
    /// Its fields.
    pub fields: Vec<Value>,
}

/// The quantities that the fields of a [`Record`] depend on.
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
pub struct Function<R> {
    /// Its role.
    pub role: R,
    /// Its arguments.
    pub arguments: Vec<Argument>,
    /// The statements, in order.
    pub statements: Vec<Statement>,
    /// The record that it returns, if it returns one.
    pub record: Option<RecordKind>,
    /// The arrays that it returns.
    pub results: Vec<Vec<Term>>,
}

/// One argument of a function.
#[derive(Clone, Debug)]
pub struct Argument {
    /// The input.
    pub input: Input,
    /// Its components, or its fields; those that the function uses.
    pub values: Vec<Option<Value>>,
}

/// An input of a function.
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
    /// The coefficients of a power series of one order.
    Coefficients,
    /// Sums of products of coefficients of lower orders.
    Sums,
    /// The order, a scalar.
    Order,
    /// What has a power series, at the end of a step.
    End,
}

/// One line of code.
#[derive(Clone, Debug)]
pub enum Statement {
    /// A value gets its name.
    Let {
        /// The value.
        value: Value,
        /// Its value.
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
    /// The second where the first is below zero, the third elsewhere.
    Choice([Box<Term>; 3]),
}

impl Program {
    /// The function of a role, with the module that it stands in, if there is one.
    pub fn function(&self, role: SystemRole) -> Option<(&Module<SystemRole>, &Function<SystemRole>)> {
        self.functions.iter().find_map(|module| Some((module, module.function(role)?)))
    }
}

impl Values {
    /// The name of a value.
    pub fn name(&self, value: Value) -> &str {
        &self.names[value.0]
    }

    /// How many places values can have, by their [numbers](Value::number), and one that is nobody's.
    pub fn places(&self) -> usize {
        self.names.len() + 1
    }

    /// The fields of a record.
    pub fn fields(&self, kind: RecordKind) -> &[Value] {
        self.records.iter().find(|record| record.kind == kind).map_or(&[], |record| &record.fields)
    }
}

impl<R: FunctionRole> Module<R> {
    /// The function of a role, if there is one.
    pub fn function(&self, role: R) -> Option<&Function<R>> {
        self.functions.iter().find(|function| function.role == role)
    }

    /// How many operations the function of a role takes; none if there is no such function.
    pub fn operations(&self, role: R) -> Operations {
        self.function(role).map(Function::operations).unwrap_or_default()
    }
}

impl<R> Function<R> {
    /// How many components an argument has; none if it is no argument.
    pub fn length(&self, input: Input) -> usize {
        self.arguments.iter().find(|argument| argument.input == input).map_or(0, |given| given.values.len())
    }

    /// Drops from the arguments what the function makes no use of. Fields that a record returns are used.
    pub(crate) fn keep_used_arguments(&mut self, records: &[Record]) {
        let mut used = std::collections::BTreeSet::new();
        let terms = self.statements.iter().map(|statement| match statement {
            Statement::Let { term, .. } | Statement::Stumpff { argument: term, .. } => term,
        });
        let terms = terms.chain(self.results.iter().flatten());
        terms.for_each(|term| term.values(&mut |value| _ = used.insert(value)));
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
            Self::Choice(operands) => Self::Choice(operands.map(within)),
        }
    }

    /// The operands, in order.
    pub(crate) fn operands(&self) -> Vec<&Self> {
        match self {
            Self::Number(_) | Self::Value(_) => Vec::new(),
            Self::Negative(x) | Self::Function(_, x) => vec![x],
            Self::Sum(addends) => addends.iter().map(|(_, addend)| addend).collect(),
            Self::Product(factors) => factors.iter().collect(),
            Self::MulAdd { a, b, addend, .. } => vec![a, b, addend],
            Self::Quotient(x, y) | Self::Power(x, y) | Self::Atan2(x, y) => vec![x, y],
            Self::Choice(operands) => operands.iter().map(|operand| &**operand).collect(),
        }
    }

    /// Shows each value that the term names.
    pub fn values(&self, show: &mut impl FnMut(Value)) {
        if let Self::Value(value) = self {
            show(*value);
        }
        self.operands().into_iter().for_each(|operand| operand.values(show));
    }
}
