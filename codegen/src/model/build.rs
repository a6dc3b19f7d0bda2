//! From a description to a [`System`]: names get meanings, expressions are lowered, and their problems reported.

use std::cell::OnceCell;

use proc_macro2::Ident;
use quote::format_ident;

use super::{
    Advected, Factor, ForceSource, Hamiltonian, InertiaField, InertiaShape, Parameter, Part, Role, Sources,
    StoredAs, System, suffixes,
};
use crate::check;
use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Matrix, Stage, Symbol, Vector};
use crate::group::{Group, Representation, Semidirect, Side};
use crate::identifiers::{plain, velocity_name};
use crate::language::{Scope, Value, lower_scalar, lower_vector};
use crate::parse::{Attribute, Inertia, Item};

impl<'a> System<'a> {
    /// The system that a description describes; problems in its expressions are reported. `None` if its structure, whose problems
    /// [`check::structure`] reports, has none: then the expressions were looked at all the same.
    pub fn build(
        arena: &'a Arena,
        attribute: &Attribute,
        item: &Item,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let mut scope = Scope::new();
        let mut parameters = Vec::new();
        let mut marked = Vec::new();
        for field in &item.fields {
            let value = Value::symbols(arena, &plain(&field.name), field.shape, Stage::Parameters);
            let symbols: Vec<Symbol> =
                value.scalars().iter().filter_map(|scalar| scalar.as_symbol()).collect();
            let names = symbols.iter().map(|&symbol| arena.symbol_info(symbol).name).collect();
            let (name, doc) = (field.name.clone(), field.doc.clone());
            parameters.push(Parameter { name, shape: field.shape, doc, symbols, names });
            if let Some(mark) = &field.inertia {
                marked.push((field.name.clone(), mark, value.clone()));
            }
            scope.define(plain(&field.name), value);
        }
        for unreadable in &item.unreadable {
            scope.define_unknown(plain(&unreadable.name));
        }

        let mut names = Names::default();
        let (mut factors, whole) = factors(arena, attribute, &mut scope, &mut names);
        let advected = advected(arena, attribute, &mut factors, &mut scope);
        let controls = controls(arena, attribute, &mut scope, &mut names);
        let time = arena.symbol("t", Stage::Step);
        scope.define("t", Value::Scalar(time));

        let mut lower = |what: &str, source: &Option<syn::Expr>, scope: &mut Scope<'a>| {
            source.as_ref().and_then(|source| lower_scalar(what, source, scope, arena, diagnostics))
        };
        scope.withhold(names.withheld_from_potentials());
        let potential = lower("the potential", &attribute.potential, &mut scope);
        scope.withhold(names.withheld_from_hamiltonians());
        let hamiltonian = lower("the Hamiltonian", &attribute.hamiltonian, &mut scope);
        scope.withhold(Vec::new());
        // what has no meaning, which was reported, is not shown to rustc
        let mut sources = Sources {
            potential: attribute.potential.clone().filter(|_| potential.is_some()),
            hamiltonian: attribute.hamiltonian.clone().filter(|_| hamiltonian.is_some()),
            forces: Vec::new(),
        };
        for force in &attribute.forces {
            let target = factors.iter().position(|factor: &Option<Factor<'a>>| {
                factor.as_ref().is_some_and(|factor| {
                    force.factor.as_ref().map_or(attribute.factors.len() == 1, |name| *name == factor.name)
                })
            });
            let dimension = target
                .and_then(|target| factors[target].as_ref())
                .map(|factor| factor.algebra.group.dimension());
            let value = lower_vector("this force", &force.value, dimension, &mut scope, arena, diagnostics);
            if let (Some(target), Some((value, scalar))) = (target, value)
                && let Some(factor) = &mut factors[target]
            {
                factor.force = Some(value);
                sources.forces.push(ForceSource { factor: target, value: force.value.clone(), scalar });
            }
        }
        if !whole {
            return None;
        }
        let factors: Vec<Factor<'a>> = factors.into_iter().collect::<Option<_>>()?;
        let advected = advected.into_iter().collect::<Option<_>>()?;
        let (hamiltonian, inertias) = match &attribute.hamiltonian {
            Some(_) => (Hamiltonian::General(hamiltonian.unwrap_or_else(|| arena.zero())), Vec::new()),
            None => {
                let (inertia, fields) = inertia(arena, &factors, marked)?;
                let potential = potential.unwrap_or_else(|| arena.zero());
                (Hamiltonian::Mechanical { inertia, potential }, fields)
            }
        };
        Some(Self {
            factors,
            parameters,
            constants: scope.constants,
            controls,
            time,
            side: if attribute.right { Side::Right } else { Side::Left },
            hamiltonian,
            inertias,
            sources,
            advected,
        })
    }
}

/// The names that not every expression may use.
#[derive(Default)]
struct Names {
    momenta: Vec<Ident>,
    controls: Vec<String>,
}

impl Names {
    fn withheld_from_hamiltonians(&self) -> Vec<(String, String)> {
        let controls = self.controls.iter().map(|name| {
            let message = "an energy does not depend on controls; they act through `force`";
            (name.clone(), message.to_owned())
        });
        let velocities = self.momenta.iter().map(|momentum| {
            let message = format!("an energy is a function of the momentum; write it in `{momentum}`");
            (velocity_name(momentum), message)
        });
        controls.chain(velocities).collect()
    }

    fn withheld_from_potentials(&self) -> Vec<(String, String)> {
        let momenta = self.momenta.iter().flat_map(|momentum| {
            let message = |what: &str| {
                format!("a potential does not depend on the {what}; an energy that does is written `hamiltonian = …`")
            };
            [(plain(momentum), message("momentum")), (velocity_name(momentum), message("velocity"))]
        });
        // the first word on a name counts
        momenta.chain(self.withheld_from_hamiltonians()).collect()
    }
}

/// The factors, `None` in place of those whose group is not known; and whether there are any.
fn factors<'a>(
    arena: &'a Arena,
    attribute: &Attribute,
    scope: &mut Scope<'a>,
    names: &mut Names,
) -> (Vec<Option<Factor<'a>>>, bool) {
    let mut factors = Vec::new();
    if attribute.factors.is_empty() {
        define_unknown(scope, None);
    }
    for declared in &attribute.factors {
        let Some(group) = check::group(&declared.group) else {
            define_unknown(scope, declared.name.as_ref());
            factors.push(None);
            continue;
        };
        let name = check::factor_name(declared, group);
        let momentum_name = check::momentum_name(declared);
        let symbols = |name: &Ident, suffixes: &[&str]| {
            let symbol = |suffix: &&str| arena.symbol(format!("{}_{suffix}", plain(name)), Stage::Step);
            Vector(suffixes.iter().map(symbol).collect())
        };
        let configuration = symbols(&name, group.coordinates());
        let momentum = symbols(&momentum_name, group.axes());
        scope.define(plain(&name), Value::element(group, configuration.clone()));
        scope.define(plain(&momentum_name), Value::Vector(momentum.clone()));
        let velocity_name = velocity_name(&momentum_name);
        let velocity = symbols(&format_ident!("{velocity_name}"), group.axes());
        scope.define(velocity_name, Value::Vector(velocity.clone()));
        names.momenta.push(momentum_name.clone());
        factors.push(Some(Factor {
            name,
            momentum_name,
            algebra: Semidirect { group, spaces: Vec::new() },
            configuration,
            momentum,
            velocity,
            advected: Vec::new(),
            force: None,
            kick: OnceCell::new(),
        }));
    }
    let whole = !factors.is_empty();
    (factors, whole)
}

/// Defines what a factor is called, or may be called if it has no name of its own, whose group is not known: using these names is
/// no further error.
fn define_unknown(scope: &mut Scope<'_>, factor: Option<&Ident>) {
    let momentum = match factor {
        Some(name) => {
            scope.define_unknown(plain(name));
            format!("{}_momentum", plain(name))
        }
        None => {
            for group in crate::group::catalogue() {
                scope.define_unknown(group.configuration_name());
            }
            "momentum".to_owned()
        }
    };
    scope.define_unknown(momentum.replace("momentum", "velocity"));
    scope.define_unknown(momentum);
}

/// Gives the advected parameters to the factors that act on them; `None` in place of those on which none does.
fn advected<'a>(
    arena: &'a Arena,
    attribute: &Attribute,
    factors: &mut [Option<Factor<'a>>],
    scope: &mut Scope<'a>,
) -> Vec<Option<(usize, usize)>> {
    let mut places = Vec::new();
    for declared in &attribute.advected {
        let (name, wanted) = (plain(&declared.name), declared.space.to_string());
        let acting = factors.iter_mut().enumerate().find_map(|(index, factor)| {
            let factor = factor.as_mut()?;
            let meant = declared.factor.as_ref().is_none_or(|name| *name == factor.name);
            let space = representation(factor.algebra.group, &wanted).filter(|_| meant)?;
            Some((index, factor, space))
        });
        let Some((index, factor, space)) = acting else {
            scope.define_unknown(name);
            places.push(None);
            continue;
        };
        let symbol = |suffix: &&str| arena.symbol(format!("{name}_{suffix}"), Stage::Step);
        let value = Vector(space.coordinates().iter().map(symbol).collect());
        scope.define(&name, Value::Vector(value.clone()));
        places.push(Some((index, factor.advected.len())));
        factor.algebra.spaces.push(space);
        factor.advected.push(Advected { ident: declared.name.clone(), name, value });
    }
    places
}

fn controls<'a>(
    arena: &'a Arena,
    attribute: &Attribute,
    scope: &mut Scope<'a>,
    names: &mut Names,
) -> Vec<Part<'a>> {
    let mut parts = Vec::new();
    for control in &attribute.controls {
        let value = Value::symbols(arena, &plain(&control.name), control.shape, Stage::Step);
        let scalars = Vector(value.scalars());
        let components: Vec<String> =
            scalars.symbols().iter().map(|&symbol| arena.symbol_info(symbol).name).collect();
        names.controls.push(plain(&control.name));
        scope.define(plain(&control.name), value);
        parts.push(Part {
            role: Role::Control,
            name: control.name.clone(),
            stored: StoredAs::Shape(control.shape),
            suffixes: suffixes(&control.name, &components),
            symbols: scalars.symbols(),
            value: scalars,
            doc: format!("Control `{}`, held constant over a step.", plain(&control.name)),
        });
    }
    parts
}

/// The inertia of all factors together, and the fields that hold it.
fn inertia<'a>(
    arena: &'a Arena,
    factors: &[Factor<'a>],
    marked: Vec<(Ident, &Inertia, Value<'a>)>,
) -> Option<(Matrix<'a>, Vec<InertiaField<'a>>)> {
    let dimensions: Vec<usize> = factors.iter().map(|factor| factor.algebra.group.dimension()).collect();
    let offset = |factor: usize| dimensions[..factor].iter().sum::<usize>();
    let total: usize = dimensions.iter().sum();
    let mut entries = vec![arena.zero(); total * total];
    let mut fields = Vec::new();
    for (name, mark, value) in marked {
        let targets: Vec<usize> = if mark.factors.is_empty() {
            (0..factors.len()).collect()
        } else {
            let place = |name: &Ident| factors.iter().position(|factor| factor.name == *name);
            mark.factors.iter().map(place).collect::<Option<_>>()?
        };
        // rows of the field's matrix as rows of the whole
        let rows: Vec<usize> =
            targets.iter().flat_map(|&factor| offset(factor)..offset(factor) + dimensions[factor]).collect();
        let (matrix, shape) = inertia_matrix(rows.len(), &value)?;
        for (i, &row) in rows.iter().enumerate() {
            for (j, &column) in rows.iter().enumerate() {
                entries[row * total + column] = matrix.at(i, j);
            }
        }
        fields.push(InertiaField { name, shape, factors: targets, matrix });
    }
    (!fields.is_empty()).then(|| (Matrix::new(total, total, entries), fields))
}

fn representation(group: &dyn Group, name: &str) -> Option<&'static dyn Representation> {
    group.representations().iter().copied().find(|space| space.name() == name)
}

/// The inertia as a matrix; of a matrix given by the user the lower triangle counts.
fn inertia_matrix<'a>(dimension: usize, value: &Value<'a>) -> Option<(Matrix<'a>, InertiaShape)> {
    match value {
        Value::Scalar(scalar) => {
            Some((Matrix::diagonal(&Vector(vec![*scalar; dimension])), InertiaShape::Scalar))
        }
        Value::Vector(moments) if moments.len() == dimension => {
            Some((Matrix::diagonal(moments), InertiaShape::Diagonal))
        }
        Value::Matrix(matrix) if (matrix.rows, matrix.columns) == (dimension, dimension) => {
            let lower =
                |k: usize| matrix.at((k / dimension).max(k % dimension), (k / dimension).min(k % dimension));
            let entries = (0..dimension * dimension).map(lower).collect();
            Some((Matrix::new(dimension, dimension, entries), InertiaShape::Matrix))
        }
        _ => None,
    }
}
