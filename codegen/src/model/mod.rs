//! A described system as plain symbolic data: what methods and emitters work from.

mod build;
mod casimirs;
mod layout;
mod legendre;
mod part;

pub(crate) use build::parts;

use std::cell::OnceCell;

pub use crate::check::{Factors, Inertia, InertiaShape};
pub use crate::identifiers::{Name, Place};
pub use crate::language::ForceForm;
pub use casimirs::Casimirs;
pub use layout::{Parts, Slot};
pub use legendre::Relation;
pub use part::Part;

use crate::expr::{Expr, Matrix, Symbol, Vector, gradient};
use crate::group::{Product, SemidirectVector, Side};
use crate::identifiers::velocity_name;
use crate::language::Constant;
pub use crate::parse::EnergyKey;
use crate::quantity::{Direction, ScalarType};

/// A mechanical system on the cotangent bundle of a product of groups, reduced where its Hamiltonian is left-invariant.
///
/// All symbols live in one arena. Symbols of parameters have stage *parameters*, those of state, time and controls
/// stage *step*.
#[derive(Clone)]
pub struct System<'a> {
    /// The user's name for it.
    pub name: String,
    /// The numbers that it is made of.
    pub scalar: ScalarType,
    /// The configuration's group, with the spaces of the advected parameters.
    pub group: Product,
    /// The factors of the group, with their symbols.
    pub factors: Vec<Factor<'a>>,
    /// The struct's fields, each element of an array by itself.
    pub parameters: Vec<Part>,
    /// Constants of the user's own code that expressions name; parameters too, after the fields.
    pub constants: Vec<Constant<'a>>,
    /// The controls, held over a step.
    pub controls: Vec<Part>,
    /// The time.
    pub time: Expr<'a>,
    /// On which side the groups act.
    pub side: Side,
    /// The energy.
    pub energy: Energy<'a>,
    /// The fields marked as inertia, which a Hamiltonian or a Lagrangian uses as it likes.
    pub inertias: Vec<InertiaField<'a>>,
    /// The quantities that may become zero.
    pub events: Vec<Event<'a>>,
    /// The user's expressions.
    pub sources: Sources,
    /// The units of the state, by the names of its fields.
    units: Vec<(String, String)>,
    /// The advected parameters as factor and place in it, in the order declared.
    advected: Vec<(usize, usize)>,
    /// The change of the momentum beside the bracket, once it has been worked out.
    kick: OnceCell<Option<Vector<'a>>>,
    /// The velocity at the state, once it has been worked out.
    velocity: OnceCell<Relation<'a>>,
    /// The Casimirs, once they have been found.
    casimirs: OnceCell<Casimirs<'a>>,
}

/// A factor of the configuration's group, with its symbols.
#[derive(Clone)]
pub struct Factor<'a> {
    /// The configuration's name.
    pub name: Name,
    /// The momentum's name.
    pub momentum_name: Name,
    /// The configuration's stored coordinates.
    pub configuration: Vector<'a>,
    /// The body momentum `μ`.
    pub momentum: Vector<'a>,
    /// Stands for the body velocity in forces and Lagrangians.
    pub velocity: Vector<'a>,
    /// The advected parameters `a`, in body coordinates.
    pub advected: Vec<Advected<'a>>,
    /// The body force on the momentum, in all that a description names.
    pub force: Option<Vector<'a>>,
}

impl<'a> Factor<'a> {
    /// The velocity's name in one word.
    pub fn velocity_name(&self) -> String {
        self.momentum_name.with(&velocity_name(&self.momentum_name.ident))
    }
}

/// An advected parameter.
#[derive(Clone)]
pub struct Advected<'a> {
    /// Its name.
    pub name: Name,
    /// Its components.
    pub value: Vector<'a>,
}

/// A quantity that may become zero.
#[derive(Clone)]
pub struct Event<'a> {
    /// Its name.
    pub name: String,
    /// The quantity, in all that a description names.
    pub value: Expr<'a>,
    /// Which of its zeros count.
    pub direction: Direction,
}

/// The energy, as it was described: a function of configuration, advected parameters, time, and of momentum or
/// velocity.
#[derive(Clone)]
pub enum Energy<'a> {
    /// `½ μ·𝕀⁻¹μ + V`
    Mechanical {
        /// The inertia `𝕀` of all factors together, symmetric.
        inertia: Matrix<'a>,
        /// The potential energy `V`.
        potential: Expr<'a>,
    },
    /// The Hamiltonian `h`, of the momentum: anything smooth.
    Hamiltonian(Expr<'a>),
    /// The Lagrangian `l`, of the velocity: anything smooth with a `∂²l/∂ξ²` that has an inverse.
    Lagrangian(Expr<'a>),
}

/// The user's expressions.
#[derive(Clone, Default)]
pub struct Sources {
    /// The energies.
    pub energies: Vec<EnergySource>,
    /// The forces.
    pub forces: Vec<ForceSource>,
    /// The events.
    pub events: Vec<EventSource>,
}

/// An energy as the user wrote it.
#[derive(Clone)]
pub struct EnergySource {
    /// Its key.
    pub key: EnergyKey,
    /// The expression.
    pub value: syn::Expr,
    /// Whether it has a meaning; if not, that was reported.
    pub has_meaning: bool,
}

/// A force as the user wrote it.
#[derive(Clone)]
pub struct ForceSource {
    /// The factors that it acts on.
    pub factors: Factors,
    /// The expression.
    pub value: syn::Expr,
    /// How it is written; `None` if it has no meaning, which was reported.
    pub form: Option<ForceForm>,
}

/// An event as the user wrote it.
#[derive(Clone)]
pub struct EventSource {
    /// Its name.
    pub name: String,
    /// The expression.
    pub value: syn::Expr,
    /// Whether it has a meaning; if not, that was reported.
    pub has_meaning: bool,
}

/// A field marked `#[inertia]`, or an element of one.
#[derive(Clone)]
pub struct InertiaField<'a> {
    /// As it is described.
    pub described: Inertia,
    /// As a matrix.
    pub matrix: Matrix<'a>,
}

impl<'a> System<'a> {
    /// The dimension of the configuration.
    pub fn dimension(&self) -> usize {
        self.group.dimension()
    }

    /// The same system with another energy.
    pub fn with_energy(&self, energy: Energy<'a>) -> Self {
        let (kick, velocity, casimirs) = Default::default();
        Self { energy, kick, velocity, casimirs, ..self.clone() }
    }

    /// The same system with its Hamiltonian as a function of the momentum; an inverse inertia stands in it as it is.
    pub fn by_momentum(&self) -> Self {
        let energy = match &self.energy {
            Energy::Mechanical { inertia, potential } => {
                let inverse = inertia.inverse().map(Expr::hold);
                let momentum = self.momentum();
                inverse.times(&momentum).dot(&momentum) / 2 + *potential
            }
            _ => self.energy(),
        };
        self.with_energy(Energy::Hamiltonian(energy))
    }

    /// The fields' symbols.
    pub fn field_symbols(&self) -> Vec<Symbol> {
        self.parameters.iter().flat_map(|field| field.symbols.iter().copied()).collect()
    }

    /// The parameters' symbols in the order of the flat array: fields, then constants.
    pub fn parameter_symbols(&self) -> Vec<Symbol> {
        let constants = self.constants.iter().filter_map(|constant| constant.symbol.as_symbol());
        self.field_symbols().into_iter().chain(constants).collect()
    }

    /// The state's symbols in the order of the flat array.
    pub fn state_symbols(&self) -> Vec<Symbol> {
        self.parts().iter().flat_map(|part| part.symbols.clone()).collect()
    }

    /// The controls' symbols in the order of the flat array.
    pub fn control_symbols(&self) -> Vec<Symbol> {
        self.controls.iter().flat_map(|part| part.symbols.clone()).collect()
    }

    /// The time's symbol.
    pub fn time_symbol(&self) -> Vec<Symbol> {
        self.time.as_symbol().into_iter().collect()
    }

    /// The stored coordinates of the configuration.
    pub fn configuration(&self) -> Vector<'a> {
        Vector::concat(self.factors.iter().map(|factor| &factor.configuration))
    }

    /// The momentum.
    pub fn momentum(&self) -> Vector<'a> {
        Vector::concat(self.factors.iter().map(|factor| &factor.momentum))
    }

    /// The advected parameters, in the order of the group's spaces.
    pub fn advected(&self) -> impl Iterator<Item = &Advected<'a>> {
        self.factors.iter().flat_map(|factor| &factor.advected)
    }

    /// Their components.
    pub fn advected_values(&self) -> Vec<Vector<'a>> {
        self.advected().map(|advected| advected.value.clone()).collect()
    }

    /// `(μ, a)`, an element of the dual of the semidirect algebra.
    pub fn momentum_and_advected(&self) -> SemidirectVector<'a> {
        SemidirectVector { base: self.momentum(), spaces: self.advected_values() }
    }

    /// The Hamiltonian, with the [velocity](Self::velocity) in what of it is written in that: by Legendre's transform
    /// (4.6) of a Lagrangian `⟨∂l/∂ξ, ξ⟩ − l`. With `𝕀 = L D Lᵀ` the kinetic energy is `½ Σ yᵢ²/dᵢ`, `y = L⁻¹ μ`: a sum
    /// of squares, without cancellation.
    pub fn energy(&self) -> Expr<'a> {
        let (inertia, potential) = match &self.energy {
            Energy::Hamiltonian(energy) => return *energy,
            Energy::Lagrangian(lagrangian) => {
                let velocity = self.velocity_symbols();
                let energy = gradient(*lagrangian, &velocity.symbols()).dot(&velocity) - *lagrangian;
                return self.at_velocity(&Vector(vec![energy])).0[0];
            }
            Energy::Mechanical { inertia, potential } => (inertia, *potential),
        };
        let (l, d) = inertia.ldl();
        let y = l.substituted(&self.momentum());
        let squares = y.iter().zip(d.iter()).map(|(y, d)| y * y / d);
        squares.fold(potential.arena().zero(), |sum, square| sum + square) / 2 + potential
    }

    /// A function with the energy's derivatives by configuration, advected parameters and time: the potential, all of a
    /// Hamiltonian, or `−l`, for where the momentum is kept `∂h/∂g = −∂l/∂g` (4.8).
    pub fn potential(&self) -> Expr<'a> {
        match &self.energy {
            Energy::Mechanical { potential, .. } => *potential,
            Energy::Hamiltonian(energy) => *energy,
            Energy::Lagrangian(lagrangian) => -*lagrangian,
        }
    }

    /// Whether the energy depends on the configuration of a factor itself, not on its advected parameters alone.
    pub fn depends_on_configuration(&self, factor: &Factor<'a>) -> bool {
        self.potential().depends_on(&factor.configuration.symbols())
    }

    /// Whether anything but the bracket changes the momentum of a factor.
    pub fn is_kicked(&self, factor: &Factor<'a>) -> bool {
        factor.force.is_some() || self.depends_on_configuration(factor)
    }

    /// The body force on the momentum, if there is any.
    pub fn force(&self) -> Option<Vector<'a>> {
        self.is_forced().then(|| {
            let zeros = |factor: &Factor<'a>| Vector::zeros(self.time.arena(), factor.momentum.len());
            let force = |factor: &Factor<'a>| factor.force.clone().unwrap_or_else(|| zeros(factor));
            Vector::concat(&self.factors.iter().map(force).collect::<Vec<_>>())
        })
    }

    /// `−T*L_g ∂h/∂g + F`, what changes the momentum beside the bracket, if anything does.
    pub fn kick(&self) -> Option<&Vector<'a>> {
        let work_out = || {
            let configuration = self.configuration();
            let potential = self.potential().depends_on(&configuration.symbols()).then(|| {
                let df = gradient(self.potential(), &configuration.symbols());
                -&self.group.trivialized_gradient(self.side, &configuration, &df)
            });
            match (potential, self.force()) {
                (Some(potential), Some(force)) => Some(&potential + &force),
                (potential, force) => potential.or(force),
            }
        };
        self.kick.get_or_init(work_out).as_ref()
    }

    /// Whether a force acts.
    pub fn is_forced(&self) -> bool {
        self.factors.iter().any(|factor| factor.force.is_some())
    }

    /// Whether energy or forces choose by what changes along a motion.
    pub fn is_piecewise(&self) -> bool {
        let forces = self.factors.iter().filter_map(|factor| factor.force.clone());
        let all = Vector::concat(&forces.chain([Vector(vec![self.potential()])]).collect::<Vec<_>>());
        let changing = [self.state_symbols(), self.velocity_symbols().symbols(), self.time_symbol()];
        all.chooses_by(&changing.concat())
    }

    /// Whether the energy is an invariant of the motion as long as the controls are the same: no force acts and the
    /// time has no part in it.
    pub fn is_autonomous(&self) -> bool {
        !self.is_forced() && !self.potential().depends_on(&self.time_symbol())
    }

    /// Whether the system is left-invariant: nothing but momentum, advected parameters and controls, which are constant
    /// during a step, has a part in its motion.
    pub fn is_left_invariant(&self) -> bool {
        self.is_autonomous() && !self.potential().depends_on(&self.configuration().symbols())
    }
}
