//! The keys of the attribute: how each is called and written.

/// A key of the attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// The Lie group of the configuration, or several as named factors.
    Group,
    /// The parameters that the group acts on.
    Advected,
    /// An energy.
    Energy(EnergyKey),
    /// The controls, held over a step.
    Control,
    /// The forces on the momentum.
    Force,
    /// The events: quantities that may become zero.
    Event,
    /// On which side the group acts.
    Invariance,
    /// The methods to generate steps by, beside those that are always there.
    Methods,
    /// The retractions to generate steps with, where not with the default ones.
    Retractions,
    /// Which derivatives of the steps are generated.
    Derivatives,
    /// The power series of the motion, for Taylor steps.
    Taylor,
    /// The units of state and controls.
    Units,
    /// What numbers the system is made of, where no field tells.
    Scalar,
    /// Where the runtime crate is found.
    Crate,
}

/// The key of an energy. Another expression is another variant, with its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyKey {
    /// The potential energy.
    Potential,
    /// The Hamiltonian, in place of inertia and potential.
    Hamiltonian,
    /// The Lagrangian, in place of inertia and potential.
    Lagrangian,
}

/// The row of an energy's key.
pub struct EnergyRow {
    /// The key, and the name of the method that computes it.
    pub name: &'static str,
    /// As it is written, for messages.
    pub example: &'static str,
    /// Its name in messages.
    pub what: &'static str,
    /// The documentation of the method that computes it.
    pub doc: &'static str,
    /// Whether it is a function of velocities.
    pub has_velocity: bool,
}

impl EnergyKey {
    /// All of them, in the order in which they are read.
    pub const ALL: [Self; 3] = [Self::Potential, Self::Hamiltonian, Self::Lagrangian];

    /// Its row.
    pub fn row(self) -> EnergyRow {
        match self {
            Self::Potential => EnergyRow {
                name: "potential",
                example: "potential = weight * gamma.dot(&chi)",
                what: "the potential",
                doc: "The potential energy, as described.",
                has_velocity: false,
            },
            Self::Hamiltonian => EnergyRow {
                name: "hamiltonian",
                example: "hamiltonian = momentum.norm_squared() / (2.0 * mass)",
                what: "the Hamiltonian",
                doc: "The Hamiltonian, as described.",
                has_velocity: false,
            },
            Self::Lagrangian => EnergyRow {
                name: "lagrangian",
                example: "lagrangian = mass * velocity.norm_squared() / 2.0",
                what: "the Lagrangian",
                doc: "The Lagrangian, as described, at the velocity that belongs to the momentum.",
                has_velocity: true,
            },
        }
    }
}

impl Key {
    /// All keys, in the order in which messages list them.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        let rest = [
            Self::Control,
            Self::Force,
            Self::Event,
            Self::Invariance,
            Self::Methods,
            Self::Retractions,
            Self::Derivatives,
            Self::Taylor,
            Self::Units,
            Self::Scalar,
        ];
        let energies = EnergyKey::ALL.into_iter().map(Self::Energy);
        [Self::Group, Self::Advected].into_iter().chain(energies).chain(rest).chain([Self::Crate])
    }

    /// The word before `=` or `(`, and an example, for messages.
    fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::Group => ("group", "group = SO3"),
            Self::Advected => ("advected", "advected(gamma: R3)"),
            Self::Energy(key) => (key.row().name, key.row().example),
            Self::Control => ("control", "control(moment: R3, thrust: f64)"),
            Self::Force => ("force", "force = moment - friction * momentum"),
            Self::Event => ("event", "event(apogee = position.dot(&momentum), falling)"),
            Self::Invariance => ("invariance", "invariance = right"),
            Self::Methods => ("methods", "methods(Midpoint)"),
            Self::Retractions => ("retractions", "retractions(Cayley)"),
            Self::Derivatives => ("derivatives", "derivatives(state)"),
            Self::Taylor => ("taylor", "taylor"),
            Self::Units => ("units", "units(momentum = \"N m s\")"),
            Self::Scalar => ("scalar", "scalar = f32"),
            Self::Crate => ("crate", "crate = path::to::coadjoint"),
        }
    }

    /// The word before `=` or `(`.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// An example, for messages.
    pub fn example(self) -> &'static str {
        self.row().1
    }
}
