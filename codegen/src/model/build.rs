//! From a resolved description to a [`System`]: names get meanings, expressions are lowered, and their problems
//! reported.

use std::cell::OnceCell;
use std::ops::Range;

use super::{
    Advected, Energy, EnergyKey, EnergySource, Event, EventSource, Factor, ForceSource, InertiaField,
    InertiaShape, Name, Part, Sources, System,
};
use crate::check::{self, Description, Factors};
use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector};
use crate::group::{Group, Product, Semidirect, consecutive, part_name};
use crate::identifiers::{plain, velocity_name};
use crate::language::{COMPONENTS, Scope, Value, by_index, lower_forces, lower_scalar};
use crate::parse::{self, Control, Unit};
use crate::quantity::{Kind, Role, ScalarType, Shape, Side};

impl<'a> System<'a> {
    /// The system that a description describes; problems in its expressions are reported, and what they concern is left
    /// out. `None` if the description is not [sound](Description::is_sound): then its expressions were looked at all
    /// the same.
    pub fn build(
        arena: &'a Arena,
        description: &Description<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        Self::built(arena, description, false, diagnostics)
    }

    /// The same, of functions that have power series.
    pub(crate) fn build_series(arena: &'a Arena, description: &Description<'_>) -> Option<Self> {
        Self::built(arena, description, true, &mut Diagnostics::new())
    }

    fn built(
        arena: &'a Arena,
        description: &Description<'_>,
        has_series: bool,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let before = diagnostics.len();
        let (momenta, velocities, coordinates) = Default::default();
        let scope = Scope::new();
        let mut builder =
            Builder { arena, description, has_series, scope, diagnostics, momenta, velocities, coordinates };
        builder.scope.functions.clone_from(&description.attribute.functions);
        description.unknown.iter().for_each(|name| builder.scope.define_unknown(name));
        let (parameters, values) = builder.parameters();
        let mut factors: Vec<Factor<'a>> =
            description.factors.iter().map(|declared| builder.factor(declared)).collect();
        let groups = description.factors.iter();
        let groups = groups.map(|declared| Semidirect { group: declared.group, spaces: Vec::new() });
        let mut group = Product { factors: groups.collect() };
        let advected = builder.advected(&mut group, &mut factors);
        let units: Vec<(String, String)> =
            description.attribute.units.iter().map(|unit| (plain(&unit.name), unit.unit.clone())).collect();
        let controls = description
            .attribute
            .controls
            .iter()
            .flat_map(|declared| builder.control(declared, &units))
            .collect();
        let time = arena.symbol("t", Stage::Step);
        builder.scope.define("t", Value::Scalar(time));

        let mut sources = Sources::default();
        let energies = builder.energies(&mut sources);
        builder.forces(&group, &mut factors, &mut sources);
        let events = builder.events(&mut sources);
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
        if description.is_sound && builder.diagnostics.len() == before {
            builder.warn_of_unused();
        }
        let system = Self {
            name: plain(&description.item.name),
            scalar: description.scalar,
            group,
            factors,
            parameters,
            constants: builder.scope.constants,
            controls,
            time,
            side: if description.attribute.right { Side::Right } else { Side::Left },
            energy,
            inertias,
            events,
            sources,
            units,
            advected,
            kick: OnceCell::new(),
            velocity: OnceCell::new(),
            casimirs: OnceCell::new(),
        };
        if description.is_sound {
            check_counts_of_units(&system, description, diagnostics);
        }
        description.is_sound.then_some(system)
    }
}

/// What the components of an inertia are called: after the axes of what it is the inertia of, where these are not `x`, `y`, `z`. An entry of a
/// matrix is between two axes, or of one.
fn labels(description: &Description<'_>, inertia: &check::Inertia, shape: Shape) -> Option<Vec<String>> {
    let block = inertia.blocks.first()?;
    let axes: Vec<&str> =
        block.iter().flat_map(|factor| description.factors[*factor].group.axes()).copied().collect();
    // several factors have several axes of each name
    if block.len() != 1 || COMPONENTS.starts_with(&axes) {
        return None;
    }
    let between = |row: &str, column: &str| match (row == column, row.len() + column.len()) {
        (_, 2) => format!("{row}{column}"),
        (true, _) => row.to_owned(),
        (false, _) => format!("{row}_{column}"),
    };
    match shape {
        Shape::Vector(n) if n == axes.len() => Some(axes.iter().map(|&axis| axis.to_owned()).collect()),
        Shape::Matrix(n, _) if n == axes.len() => {
            Some(axes.iter().flat_map(|row| axes.iter().map(|column| between(row, column))).collect())
        }
        _ => None,
    }
}

/// A quantity has one unit, one for each component, or as many as go evenly into these.
fn check_counts_of_units(system: &System<'_>, description: &Description<'_>, diagnostics: &mut Diagnostics) {
    let parts = system.parts();
    let parts = system.parameters.iter().chain(&system.controls).chain(&parts);
    for Part { name, suffixes, unit, .. } in parts.filter(|part| part.name.is_first()) {
        let (count, units) = (suffixes.len(), unit.iter().flat_map(|unit| unit.split(',')).count().max(1));
        if count % units != 0 {
            let is_it = |unit: &&Unit| plain(&unit.name) == plain(&name.ident);
            let written =
                description.attribute.units.iter().find(is_it).map_or(&name.ident, |unit| &unit.name);
            let message = format!(
                "`{written}` has {count} components, and here are {units} units: give one, or one for each"
            );
            diagnostics.push(written, message);
        }
    }
}

/// Defines what has this name, or an element of what has it. Elements come one after the other.
fn define<'a>(scope: &mut Scope<'a>, name: &Name, whole: &str, value: Value<'a>) {
    match name.place {
        None => scope.define(whole, value),
        Some(_) => scope.define_element(whole, value),
    }
}

/// A system in the making.
struct Builder<'s, 'a> {
    arena: &'a Arena,
    description: &'s Description<'s>,
    /// Whether forces are to have power series.
    has_series: bool,
    /// The names that expressions may use.
    scope: Scope<'a>,
    diagnostics: &'s mut Diagnostics,
    /// The names of momenta and of their parts.
    momenta: Vec<String>,
    /// Those of velocities, with the momenta in which an energy is to be written instead.
    velocities: Vec<(String, String)>,
    /// Vectors as they are written, with the names of their coordinates.
    coordinates: Vec<(String, &'static [&'static str])>,
}

impl<'a> Builder<'_, 'a> {
    /// The fields, and their values.
    fn parameters(&mut self) -> (Vec<Part>, Vec<Value<'a>>) {
        let description = self.description;
        let fields = description.item.fields.iter().flat_map(|field| {
            let elements = Name::all(&field.name, field.length).into_iter();
            elements.map(move |name| (name, field))
        });
        let fields = fields.map(|(name, field)| {
            let inertia = description.inertias.iter().find(|inertia| inertia.name == name);
            let (part, value) = self.part(name, Role::Parameter, field.shape);
            let kind = match field.shape {
                Shape::Matrix(n, _) if inertia.is_some() => Kind::Symmetric(n),
                _ => part.kind,
            };
            let labels = inertia.and_then(|inertia| labels(description, inertia, field.shape));
            let suffixes = labels.unwrap_or(part.suffixes);
            (Part { kind, suffixes, unit: field.unit.clone(), doc: field.doc.clone(), ..part }, value)
        });
        fields.unzip()
    }

    /// A control, or each of an array.
    fn control(&mut self, control: &Control, units: &[(String, String)]) -> Vec<Part> {
        let whole = plain(&control.name);
        let unit = units.iter().find(|(of, _)| *of == whole).map(|(_, unit)| unit.clone());
        let elements = Name::all(&control.name, control.length).into_iter().map(|name| {
            let (part, _) = self.part(name, Role::Control, control.shape);
            let doc = format!("Control `{whole}`, held constant over a step.");
            Part { unit: unit.clone(), doc, ..part }
        });
        elements.collect()
    }

    /// A parameter or a control, made of new symbols and in scope, and its value.
    fn part(&mut self, name: Name, role: Role, shape: Shape) -> (Part, Value<'a>) {
        let arena = self.arena;
        let stage = if role == Role::Parameter { Stage::Parameters } else { Stage::Step };
        let value = Value::symbols(arena, &name.plain(), shape, stage);
        define(&mut self.scope, &name, &plain(&name.ident), value.clone());
        let (symbols, prefix) = (Vector(value.scalars()).symbols(), format!("{}_", name.plain()));
        let suffix = |&symbol: &Symbol| {
            arena.symbol_info(symbol).name.strip_prefix(&prefix).unwrap_or_default().to_owned()
        };
        let suffixes = symbols.iter().map(suffix).collect();
        let (kind, unit, doc) = (shape.into(), None, String::new());
        (Part { role, name, kind, suffixes, symbols, unit, doc }, value)
    }

    /// Symbols for a part of the state, named after it.
    fn symbols(&self, name: &str, suffixes: &[&str]) -> Vector<'a> {
        let symbol = |suffix: &&str| self.arena.symbol(format!("{name}_{suffix}"), Stage::Step);
        Vector(suffixes.iter().map(symbol).collect())
    }

    /// A factor, with its configuration, momentum and velocity in scope, and with the parts of the latter.
    fn factor(&mut self, declared: &check::Factor) -> Factor<'a> {
        let check::Factor { name, momentum_name, group } = declared;
        let whole = plain(&name.ident);
        let configuration = self.symbols(&name.with(&whole), group.coordinates());
        define(&mut self.scope, name, &whole, Value::element(*group, configuration.clone()));
        let names = NamedPart {
            momentum: plain(&momentum_name.ident),
            velocity: velocity_name(&momentum_name.ident),
            rows: 0..group.dimension(),
        };
        let [momentum, velocity] =
            [&names.momentum, &names.velocity].map(|whole| self.symbols(&name.with(whole), group.axes()));
        for part in parts(*group, &momentum_name.ident) {
            let value = |whole: &Vector<'a>| Value::of_part(&whole.0[part.rows.clone()]);
            let values = [value(&momentum), value(&velocity)];
            self.define_motion(name, part, values);
        }
        for whole in [&names.momentum, &names.velocity] {
            self.coordinates.push((name.in_brackets(whole), group.axes()));
        }
        self.define_motion(name, names, [&momentum, &velocity].map(|whole| Value::Vector(whole.clone())));
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

    /// A momentum and the velocity, or parts of them: of them not every expression may use both.
    fn define_motion(&mut self, of: &Name, names: NamedPart, [momentum, velocity]: [Value<'a>; 2]) {
        define(&mut self.scope, of, &names.momentum, momentum);
        define(&mut self.scope, of, &names.velocity, velocity);
        self.velocities.push((names.velocity, names.momentum.clone()));
        self.momenta.push(names.momentum);
    }

    /// Gives the advected parameters to the factors that act on them.
    fn advected(&mut self, group: &mut Product, factors: &mut [Factor<'a>]) -> Vec<(usize, usize)> {
        let places = self.description.advected.iter().map(|declared| {
            let value = self.symbols(&declared.name.plain(), declared.space.coordinates());
            let whole = plain(&declared.name.ident);
            define(&mut self.scope, &declared.name, &whole, Value::Vector(value.clone()));
            self.coordinates.push((declared.name.in_brackets(&whole), declared.space.coordinates()));
            group.factors[declared.factor].spaces.push(declared.space);
            let factor = &mut factors[declared.factor];
            factor.advected.push(Advected { name: declared.name.clone(), value });
            (declared.factor, factor.advected.len() - 1)
        });
        places.collect()
    }

    /// The names that an energy may not use, with what to say to it.
    fn forbidden(&self, key: EnergyKey) -> Vec<(String, String)> {
        let pairs = self.velocities.iter().cloned();
        match key {
            EnergyKey::Hamiltonian => {
                let message =
                    |name: &str| format!("an energy is a function of the momentum; write it in `{name}`");
                pairs.map(|(velocity, momentum)| (velocity, message(&momentum))).collect()
            }
            EnergyKey::Lagrangian => {
                let message =
                    |name: &str| format!("a Lagrangian is a function of the velocity; write it in `{name}`");
                pairs.map(|(velocity, momentum)| (momentum, message(&velocity))).collect()
            }
            EnergyKey::Potential => {
                let message = |what: &str, key: &str| {
                    format!(
                        "a potential does not depend on the {what}; an energy that does is written `{key}`"
                    )
                };
                let momenta = self.momenta.iter();
                let momenta = momenta.map(|name| (name.clone(), message("momentum", "hamiltonian = …")));
                let velocities = pairs.map(|(name, _)| (name, message("velocity", "lagrangian = …")));
                momenta.chain(velocities).collect()
            }
        }
    }

    /// Lowers the user's energies; zero for one that has no meaning.
    fn energies(&mut self, sources: &mut Sources) -> Vec<(EnergyKey, Expr<'a>)> {
        let is_single = self.description.scalar == ScalarType::F32;
        let lower = |key: EnergyKey| {
            let source = by_index(self.description.attribute.energy(key)?, &self.coordinates);
            self.scope.forbid(self.forbidden(key));
            let value = lower_scalar(key.row().what, &source, &mut self.scope, self.arena, self.diagnostics);
            self.scope.forbid(Vec::new());
            sources.energies.push(EnergySource { key, value: source, has_meaning: value.is_some() });
            let at_zero = |value: Expr<'a>| value.with_lengths(is_single).with_limits();
            Some((key, value.map_or_else(|| self.arena.zero(), at_zero)))
        };
        EnergyKey::ALL.into_iter().filter_map(lower).collect()
    }

    /// The forces, each on its factor.
    fn forces(&mut self, group: &Product, factors: &mut [Factor<'a>], sources: &mut Sources) {
        let (arena, scope) = (self.arena, &mut self.scope);
        let is_single = self.description.scalar == ScalarType::F32;
        let has_series = self.has_series;
        let at_zero =
            |component: Expr<'a>| component.with_lengths(is_single).with_limits_of_force(has_series);
        for force in &self.description.forces {
            let first = force.factors.as_ref().map(|factors| factors.indices().start);
            let length = match &force.factors {
                Some(Factors::All(all)) => Some(all.len()),
                Some(Factors::One(_)) | None => None,
            };
            let on = (first.map(|factor| group.factors[factor].group), length);
            let source = by_index(force.value, &self.coordinates);
            let (values, form) = lower_forces(&source, on, scope, arena, self.diagnostics).unzip();
            let Some(acted) = &force.factors else { continue };
            sources.forces.push(ForceSource { factors: acted.clone(), value: source, form });
            let mut values = values.unwrap_or_default().into_iter();
            for factor in &mut factors[acted.indices()] {
                // of a force in error, whatever it is
                let value = values.next().map(|value| value.map(at_zero));
                factor.force = Some(value.unwrap_or_else(|| Vector::zeros(arena, factor.momentum.len())));
            }
        }
    }

    /// The events; zero for one that has no meaning.
    fn events(&mut self, sources: &mut Sources) -> Vec<Event<'a>> {
        let (arena, description) = (self.arena, self.description);
        let lower = |declared: &parse::Event| {
            let (name, value) = (plain(&declared.name), by_index(&declared.value, &self.coordinates));
            let lowered = lower_scalar("an event", &value, &mut self.scope, arena, self.diagnostics);
            sources.events.push(EventSource { name: name.clone(), value, has_meaning: lowered.is_some() });
            let value = lowered.map_or_else(|| arena.zero(), Expr::with_limits);
            Event { name, value, direction: declared.direction }
        };
        description.attribute.events.iter().map(lower).collect()
    }

    /// Warns of fields and controls that nothing depends on.
    fn warn_of_unused(&mut self) {
        let Self { description, scope, diagnostics, .. } = self;
        let of_velocity = description.attribute.energy(EnergyKey::Lagrangian).is_some();
        let whole = if of_velocity { "Lagrangian" } else { "Hamiltonian" };
        let general = of_velocity || description.attribute.energy(EnergyKey::Hamiltonian).is_some();
        for (index, field) in description.item.fields.iter().enumerate() {
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
            let lints = description.item.lints.iter().chain(&field.lints).cloned().collect();
            diagnostics.warn(&field.name, "PARAMETER_WITHOUT_EFFECT", message, lints);
        }
        for control in &description.attribute.controls {
            if !scope.is_used(&plain(&control.name)) {
                let message = format!("the control `{}` is in no energy and no force", control.name);
                diagnostics.warn(
                    &control.name,
                    "CONTROL_WITHOUT_EFFECT",
                    message,
                    description.item.lints.to_vec(),
                );
            }
        }
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

/// The fields marked as inertia, as matrices.
fn inertias<'a>(
    description: &Description<'_>,
    factors: &[Factor<'a>],
    (parameters, values): (&[Part], &[Value<'a>]),
) -> Vec<InertiaField<'a>> {
    let fields = description.inertias.iter().filter_map(|inertia| {
        let place = parameters.iter().position(|parameter| parameter.name == inertia.name)?;
        let block = inertia.blocks.first();
        let of_block = |block: &Vec<usize>| block.iter().map(|&factor| factors[factor].momentum.len()).sum();
        let matrix = inertia_matrix(inertia.shape, &values[place], block.map_or(1, of_block));
        Some(InertiaField { described: inertia.clone(), matrix })
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
            Matrix::from_fn(n, n, |i, j| scalars[i.max(j) * n + i.min(j)])
        }
    }
}

/// The inertia of all factors together.
fn joint_inertia<'a>(arena: &'a Arena, factors: &[Factor<'a>], fields: &[InertiaField<'a>]) -> Matrix<'a> {
    let places = consecutive(factors.iter().map(|factor| factor.momentum.len()));
    let total = places.last().map_or(0, |last| last.end);
    let mut entries = vec![arena.zero(); total * total];
    let blocks =
        fields.iter().flat_map(|field| field.described.blocks.iter().map(move |block| (field, block)));
    for (field, block) in blocks {
        // rows of the field's matrix as rows of the whole
        let rows: Vec<usize> = block.iter().flat_map(|&factor| places[factor].clone()).collect();
        for (i, &row) in rows.iter().enumerate() {
            for (j, &column) in rows.iter().enumerate() {
                entries[row * total + column] = field.matrix.at(i, j);
            }
        }
    }
    Matrix::new(total, total, entries)
}
