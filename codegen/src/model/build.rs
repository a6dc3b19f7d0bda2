//! From a resolved description to a [`System`]: names get meanings, expressions are lowered, and their problems
//! reported.

use std::cell::OnceCell;
use std::ops::Range;

use super::{
    Advected, Energy, EnergyKey, EnergySource, Factor, ForceSource, InertiaField, InertiaShape, Name,
    Parameter, Part, Sources, System, suffixes,
};
use crate::check::{self, Description, Factors};
use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector};
use crate::group::{Group, Product, Semidirect, consecutive, part_name};
use crate::identifiers::{plain, velocity_name};
use crate::language::{Scope, Value, lower_force, lower_forces, lower_scalar};
use crate::parse::Control;
use crate::quantity::{Role, Shape};

impl<'a> System<'a> {
    /// The system that a description describes; problems in its expressions are reported, and what they concern is left
    /// out. `None` if the description is not [sound](Description::is_sound): then its expressions were looked at all
    /// the same.
    pub fn build(
        arena: &'a Arena,
        description: &Description<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let before = diagnostics.len();
        let mut scope = Scope::new();
        description.unknown.iter().for_each(|name| scope.define_unknown(name));
        let (parameters, values) = parameters(arena, description, &mut scope);
        let mut forbidden = Forbidden::default();
        let mut factors: Vec<Factor<'a>> = description
            .factors
            .iter()
            .map(|declared| factor(arena, declared, &mut scope, &mut forbidden))
            .collect();
        let groups = description.factors.iter();
        let groups = groups.map(|declared| Semidirect { group: declared.group, spaces: Vec::new() });
        let mut group = Product { factors: groups.collect() };
        let advected = advected(arena, description, (&mut group, &mut factors), &mut scope);
        let controls =
            description.controls.iter().flat_map(|declared| control(arena, declared, &mut scope)).collect();
        let time = arena.symbol("t", Stage::Step);
        scope.define("t", Value::Scalar(time));

        let mut sources = Sources::default();
        let energies = energies(arena, description, &forbidden, &mut sources, &mut scope, diagnostics);
        forces(arena, description, (&group, &mut factors), &mut sources, &mut scope, diagnostics);
        let inertias = inertias(description, &factors, (&parameters, &values));
        let of = |key: EnergyKey| energies.iter().find(|(known, _)| *known == key).map(|&(_, energy)| energy);
        let energy = match (of(EnergyKey::Hamiltonian), of(EnergyKey::Lagrangian)) {
            (Some(hamiltonian), _) => Energy::Hamiltonian(hamiltonian),
            (None, Some(lagrangian)) => Energy::Lagrangian(lagrangian),
            (None, None) => Energy::Mechanical {
                inertia: joint_inertia(arena, &factors, &inertias),
                potential: of(EnergyKey::Potential).unwrap_or_else(|| arena.zero()),
            },
        };
        if description.is_sound() && diagnostics.len() == before {
            warn_of_unused(description, &scope, diagnostics);
        }
        let system = Self {
            name: description.name.clone(),
            scalar: description.scalar,
            group,
            factors,
            parameters,
            constants: scope.constants,
            controls,
            time,
            side: description.side,
            energy,
            inertias,
            sources,
            units: description.units.iter().map(|unit| (plain(&unit.name), unit.unit.clone())).collect(),
            advected,
            kick: OnceCell::new(),
            velocity: OnceCell::new(),
            casimirs: OnceCell::new(),
        };
        description.is_sound().then_some(system)
    }
}

/// The fields, and their values.
fn parameters<'a>(
    arena: &'a Arena,
    description: &Description<'_>,
    scope: &mut Scope<'a>,
) -> (Vec<Parameter>, Vec<Value<'a>>) {
    let fields = description.parameters.iter().flat_map(|field| {
        let elements = Name::all(&field.name, field.length).into_iter();
        elements.map(move |name| (name, field))
    });
    let fields = fields.map(|(name, field)| {
        let shape = field.shape;
        let Named { value, symbols, names } = named(arena, &name, shape, Stage::Parameters);
        define(scope, &name, &plain(&name.ident), value.clone());
        let (unit, doc) = (field.unit.clone(), field.doc.clone());
        (Parameter { name, shape, unit, doc, symbols, names }, value)
    });
    fields.unzip()
}

/// A value with symbols of its own.
struct Named<'a> {
    value: Value<'a>,
    symbols: Vec<Symbol>,
    /// The symbols' names.
    names: Vec<String>,
}

/// A value of new symbols.
fn named<'a>(arena: &'a Arena, name: &Name, shape: Shape, stage: Stage) -> Named<'a> {
    let value = Value::symbols(arena, &name.plain(), shape, stage);
    let symbols: Vec<Symbol> = value.scalars().iter().filter_map(|scalar| scalar.as_symbol()).collect();
    let names = symbols.iter().map(|&symbol| arena.symbol_info(symbol).name).collect();
    Named { value, symbols, names }
}

/// Defines what has this name, or an element of what has it. Elements come one after the other.
fn define<'a>(scope: &mut Scope<'a>, name: &Name, whole: &str, value: Value<'a>) {
    match name.place {
        None => scope.define(whole, value),
        Some(_) => scope.define_element(whole, value),
    }
}

/// The names that not every expression may use.
#[derive(Default)]
struct Forbidden {
    momenta: Vec<String>,
    /// With the momenta in which an energy is to be written instead.
    velocities: Vec<(String, String)>,
}

impl Forbidden {
    /// The names that an energy may not use, with what to write instead.
    fn to(&self, key: EnergyKey) -> Vec<(String, String)> {
        let pairs = self.velocities.iter();
        match key {
            EnergyKey::Hamiltonian => pairs
                .map(|(velocity, momentum)| {
                    let message =
                        format!("an energy is a function of the momentum; write it in `{momentum}`");
                    (velocity.clone(), message)
                })
                .collect(),
            EnergyKey::Lagrangian => pairs
                .map(|(velocity, momentum)| {
                    let message =
                        format!("a Lagrangian is a function of the velocity; write it in `{velocity}`");
                    (momentum.clone(), message)
                })
                .collect(),
            EnergyKey::Potential => {
                let message = |what: &str, key: &str| {
                    format!(
                        "a potential does not depend on the {what}; an energy that does is written `{key}`"
                    )
                };
                let momenta = self.momenta.iter();
                let momenta = momenta.map(|name| (name.clone(), message("momentum", "hamiltonian = …")));
                let velocities = pairs.map(|(name, _)| (name.clone(), message("velocity", "lagrangian = …")));
                momenta.chain(velocities).collect()
            }
        }
    }
}

/// A factor, with its configuration, momentum and velocity in scope, and with the parts of the latter.
fn factor<'a>(
    arena: &'a Arena,
    declared: &check::Factor,
    scope: &mut Scope<'a>,
    forbidden: &mut Forbidden,
) -> Factor<'a> {
    let check::Factor { name, momentum_name, group } = declared;
    let symbols = |whole: &str, suffixes: &[&str]| {
        let name = name.with(whole);
        let symbol = |suffix: &&str| arena.symbol(format!("{name}_{suffix}"), Stage::Step);
        Vector(suffixes.iter().map(symbol).collect())
    };
    let whole = plain(&name.ident);
    let configuration = symbols(&whole, group.coordinates());
    define(scope, name, &whole, Value::element(*group, configuration.clone()));
    let (momentum_text, velocity_text) = (plain(&momentum_name.ident), velocity_name(&momentum_name.ident));
    let momentum = symbols(&momentum_text, group.axes());
    let velocity = symbols(&velocity_text, group.axes());
    for part in parts(*group, &momentum_name.ident) {
        let value = |whole: &Vector<'a>| Value::of_part(&whole.0[part.rows.clone()]);
        define(scope, name, &part.momentum, value(&momentum));
        define(scope, name, &part.velocity, value(&velocity));
        forbidden.velocities.push((part.velocity, part.momentum.clone()));
        forbidden.momenta.push(part.momentum);
    }
    define(scope, name, &momentum_text, Value::Vector(momentum.clone()));
    define(scope, name, &velocity_text, Value::Vector(velocity.clone()));
    forbidden.velocities.push((velocity_text, momentum_text.clone()));
    forbidden.momenta.push(momentum_text);
    Factor {
        name: name.clone(),
        momentum_name: momentum_name.clone(),
        configuration,
        momentum,
        velocity,
        advected: Vec::new(),
        force: None,
    }
}

/// A part of a momentum, and of the velocity, that has a name.
pub(crate) struct NamedPart {
    /// The momentum's part of this name.
    pub(crate) momentum: String,
    /// The velocity's part of this name.
    pub(crate) velocity: String,
    /// Where it is in them.
    pub(crate) rows: Range<usize>,
}

/// The named parts of a momentum of this name, or of an array of them.
pub(crate) fn parts(group: &dyn Group, momentum: &proc_macro2::Ident) -> Vec<NamedPart> {
    let parts = group.names().parts.iter().zip(consecutive(group.blocks())).map(|(part, rows)| {
        let named = |whole: &str| part_name(whole, part);
        NamedPart { momentum: named(&plain(momentum)), velocity: named(&velocity_name(momentum)), rows }
    });
    parts.collect()
}

/// Gives the advected parameters to the factors that act on them.
fn advected<'a>(
    arena: &'a Arena,
    description: &Description<'_>,
    (group, factors): (&mut Product, &mut [Factor<'a>]),
    scope: &mut Scope<'a>,
) -> Vec<(usize, usize)> {
    let places = description.advected.iter().map(|declared| {
        let name = declared.name.plain();
        let symbol = |suffix: &&str| arena.symbol(format!("{name}_{suffix}"), Stage::Step);
        let value = Vector(declared.space.coordinates().iter().map(symbol).collect());
        define(scope, &declared.name, &plain(&declared.name.ident), Value::Vector(value.clone()));
        group.factors[declared.factor].spaces.push(declared.space);
        let factor = &mut factors[declared.factor];
        factor.advected.push(Advected { name: declared.name.clone(), value });
        (declared.factor, factor.advected.len() - 1)
    });
    places.collect()
}

/// A control, or each of an array.
fn control<'a>(arena: &'a Arena, control: &Control, scope: &mut Scope<'a>) -> Vec<Part<'a>> {
    let whole = plain(&control.name);
    let elements = Name::all(&control.name, control.length).into_iter().map(|name| {
        let Named { value, symbols, names } = named(arena, &name, control.shape, Stage::Step);
        define(scope, &name, &whole, value.clone());
        Part {
            role: Role::Control,
            kind: control.shape.into(),
            suffixes: suffixes(&name, &names),
            symbols,
            value: Vector(value.scalars()),
            doc: format!("Control `{whole}`, held constant over a step."),
            name,
        }
    });
    elements.collect()
}

/// Lowers the user's energies; zero for one that has no meaning.
fn energies<'a>(
    arena: &'a Arena,
    description: &Description<'_>,
    forbidden: &Forbidden,
    sources: &mut Sources,
    scope: &mut Scope<'a>,
    diagnostics: &mut Diagnostics,
) -> Vec<(EnergyKey, Expr<'a>)> {
    let lower = |key: EnergyKey| {
        let source = description.energy(key)?;
        scope.forbid(forbidden.to(key));
        let value = lower_scalar(key.row().what, source, scope, arena, diagnostics);
        scope.forbid(Vec::new());
        sources.energies.push(EnergySource { key, value: source.clone(), has_meaning: value.is_some() });
        Some((key, value.map_or_else(|| arena.zero(), Expr::with_limits)))
    };
    EnergyKey::ALL.into_iter().filter_map(lower).collect()
}

/// The forces, each on its factor.
fn forces<'a>(
    arena: &'a Arena,
    description: &Description<'_>,
    (group, factors): (&Product, &mut [Factor<'a>]),
    sources: &mut Sources,
    scope: &mut Scope<'a>,
    diagnostics: &mut Diagnostics,
) {
    for force in &description.forces {
        let group = |factor: usize| group.factors[factor].group;
        let (values, form) = match &force.factors {
            Some(Factors::All(all)) => {
                lower_forces(force.value, (group(all.start), all.len()), scope, arena, diagnostics).unzip()
            }
            one => {
                let group = one.as_ref().map(|one| group(one.indices().start));
                let value = lower_force(force.value, group, scope, arena, diagnostics);
                value.map(|(value, form)| (vec![value], form)).unzip()
            }
        };
        let Some(acted) = &force.factors else { continue };
        sources.forces.push(ForceSource { factors: acted.clone(), value: force.value.clone(), form });
        let mut values = values.unwrap_or_default().into_iter();
        for factor in &mut factors[acted.indices()] {
            // of a force in error, whatever it is
            let value = values.next().map(|value| value.map(Expr::with_limits));
            factor.force = Some(value.unwrap_or_else(|| Vector::zeros(arena, factor.momentum.len())));
        }
    }
}

/// The fields marked as inertia, as matrices.
fn inertias<'a>(
    description: &Description<'_>,
    factors: &[Factor<'a>],
    (parameters, values): (&[Parameter], &[Value<'a>]),
) -> Vec<InertiaField<'a>> {
    let fields = description.inertias.iter().filter_map(|inertia| {
        let place = parameters.iter().position(|parameter| parameter.name == inertia.name)?;
        let block = inertia.blocks.first();
        let of_block = |block: &Vec<usize>| block.iter().map(|&factor| factors[factor].momentum.len()).sum();
        Some(InertiaField {
            name: inertia.name.clone(),
            shape: inertia.shape,
            blocks: inertia.blocks.clone(),
            matrix: inertia_matrix(inertia.shape, &values[place], block.map_or(1, of_block)),
        })
    });
    fields.collect()
}

/// The inertia as a matrix; of a matrix given by the user the lower triangle counts, and a scalar stands for one of
/// `rows` rows.
fn inertia_matrix<'a>(shape: InertiaShape, value: &Value<'a>, rows: usize) -> Matrix<'a> {
    let scalars = value.scalars();
    match shape {
        InertiaShape::Scalar => Matrix::diagonal(&Vector(vec![scalars[0]; rows])),
        InertiaShape::Diagonal => Matrix::diagonal(&Vector(scalars)),
        InertiaShape::Matrix => {
            let n = scalars.len().isqrt();
            let lower = |k: usize| scalars[(k / n).max(k % n) * n + (k / n).min(k % n)];
            Matrix::new(n, n, (0..n * n).map(lower).collect())
        }
    }
}

/// The inertia of all factors together.
fn joint_inertia<'a>(arena: &'a Arena, factors: &[Factor<'a>], fields: &[InertiaField<'a>]) -> Matrix<'a> {
    let dimensions: Vec<usize> = factors.iter().map(|factor| factor.momentum.len()).collect();
    let offset = |factor: usize| dimensions[..factor].iter().sum::<usize>();
    let total: usize = dimensions.iter().sum();
    let mut entries = vec![arena.zero(); total * total];
    let blocks = fields.iter().flat_map(|field| field.blocks.iter().map(move |block| (field, block)));
    for (field, block) in blocks {
        // rows of the field's matrix as rows of the whole
        let rows: Vec<usize> =
            block.iter().flat_map(|&factor| offset(factor)..offset(factor) + dimensions[factor]).collect();
        for (i, &row) in rows.iter().enumerate() {
            for (j, &column) in rows.iter().enumerate() {
                entries[row * total + column] = field.matrix.at(i, j);
            }
        }
    }
    Matrix::new(total, total, entries)
}

/// Warns of fields and controls that nothing depends on.
fn warn_of_unused(description: &Description<'_>, scope: &Scope<'_>, diagnostics: &mut Diagnostics) {
    let of_velocity = description.energy(EnergyKey::Lagrangian).is_some();
    let whole = if of_velocity { "Lagrangian" } else { "Hamiltonian" };
    let general = of_velocity || description.energy(EnergyKey::Hamiltonian).is_some();
    for (index, field) in description.parameters.iter().enumerate() {
        let is_inertia = description.inertias.iter().any(|inertia| inertia.field == index);
        if scope.is_used(&plain(&field.name)) || is_inertia && !general {
            continue;
        }
        let message = match is_inertia {
            true => {
                format!("the inertia `{}` is not in the {whole}, which is the whole energy", field.name)
            }
            false => format!("the parameter `{}` is in no energy and no force", field.name),
        };
        let lints = description.lints.iter().chain(&field.lints).cloned().collect();
        diagnostics.warn(&field.name, "PARAMETER_WITHOUT_EFFECT", message, lints);
    }
    for control in description.controls {
        if !scope.is_used(&plain(&control.name)) {
            let message = format!("the control `{}` is in no energy and no force", control.name);
            diagnostics.warn(&control.name, "CONTROL_WITHOUT_EFFECT", message, description.lints.to_vec());
        }
    }
}
