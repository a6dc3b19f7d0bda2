//! A described system as plain symbolic data: what methods and emitters work from.

use proc_macro2::Ident;
use quote::{ToTokens, format_ident};

use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector, gradient};
use crate::group::{Group, Named, Representation, Semidirect};
use crate::language::{Constant, Scope, Value, lower_scalar};
use crate::parse::{Attribute, Item};

/// A mechanical system on the dual of a semidirect algebra, `h = ½ μ·𝕀⁻¹μ + V(a)`.
///
/// All symbols live in one arena. Symbols of parameters have stage *parameters*, those of the state stage *step*.
pub struct System<'a> {
    /// The group and the spaces of the advected parameters.
    pub algebra: Semidirect,
    /// The struct's fields.
    pub parameters: Vec<Parameter>,
    /// Constants of the user's own code that expressions name; parameters too, after the fields.
    pub constants: Vec<Constant<'a>>,
    /// The inertia `𝕀`, symmetric; `velocity = 𝕀⁻¹ momentum`.
    pub inertia: Matrix<'a>,
    /// The field it comes from.
    pub inertia_field: InertiaField,
    /// The configuration's stored coordinates.
    pub configuration: Vector<'a>,
    /// The body momentum `μ`.
    pub momentum: Vector<'a>,
    /// The advected parameters `a`, in body coordinates, with their names.
    pub advected: Vec<(String, Vector<'a>)>,
    /// Their names at the user's tokens.
    pub advected_idents: Vec<Ident>,
    /// The potential energy `V(a)`, in parameters and advected parameters.
    pub potential: Expr<'a>,
    /// The potential as the user wrote it.
    pub potential_source: Option<syn::Expr>,
}

/// A field of the struct.
pub struct Parameter {
    /// Its name.
    pub name: Ident,
    /// The first line of its documentation.
    pub doc: String,
    /// Its components' symbols.
    pub symbols: Vec<Symbol>,
    /// The components' full names.
    names: Vec<String>,
}

impl Parameter {
    /// What the components' names add to the field's.
    pub fn suffixes(&self) -> Vec<String> {
        let prefix = format!("{}_", plain(&self.name));
        self.names.iter().map(|name| name.strip_prefix(&prefix).unwrap_or_default().to_owned()).collect()
    }
}

/// The field marked `#[inertia]`.
pub struct InertiaField {
    /// Its name.
    pub name: Ident,
    /// How it is given.
    pub shape: InertiaShape,
}

/// How an inertia is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InertiaShape {
    /// One number: isotropic.
    Scalar,
    /// Principal moments.
    Diagonal,
    /// A symmetric matrix.
    Matrix,
}

/// A part of the state: one field of the state struct.
pub struct Part<'a> {
    /// Its name.
    pub name: Ident,
    /// Within nalgebra, generic over the scalar.
    pub type_name: &'static str,
    /// What the components' names add to its own.
    pub suffixes: Vec<&'static str>,
    /// Its components' symbols.
    pub symbols: Vec<Symbol>,
    /// Its components.
    pub value: Vector<'a>,
    /// The first line of its documentation.
    pub doc: String,
}

impl<'a> System<'a> {
    /// The system that a checked description describes. Where the potential has no meaning, which is reported, the system without
    /// it: whatever can be emitted spares the user complaints about what is missing.
    pub fn build(
        arena: &'a Arena,
        attribute: &Attribute,
        item: &Item,
        group: &'static dyn Group,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let mut scope = Scope::new();
        let mut parameters = Vec::new();
        let mut inertia = None;
        for field in &item.fields {
            let value = Value::symbols(arena, &plain(&field.name), field.shape, Stage::Parameters);
            let scalars = value.scalars();
            let symbols: Vec<Symbol> = scalars.iter().filter_map(|scalar| scalar.as_symbol()).collect();
            let names = symbols.iter().map(|&symbol| arena.symbol_info(symbol).name).collect();
            parameters.push(Parameter { name: field.name.clone(), doc: field.doc.clone(), symbols, names });
            if field.inertia.is_some() {
                inertia = inertia_matrix(group.dimension(), &value)
                    .map(|(matrix, shape)| (matrix, InertiaField { name: field.name.clone(), shape }));
            }
            scope.define(plain(&field.name), value);
        }
        for unreadable in &item.unreadable {
            scope.define_unknown(plain(&unreadable.name));
        }
        let (inertia, inertia_field) = inertia?;

        let symbols = |name: &str, suffixes: &[&str]| {
            Vector(
                suffixes.iter().map(|suffix| arena.symbol(format!("{name}_{suffix}"), Stage::Step)).collect(),
            )
        };
        let configuration = symbols(group.configuration_name(), group.coordinates());
        let momentum = symbols("momentum", group.axes());
        let mut advected = Vec::new();
        let mut spaces = Vec::new();
        let mut advected_idents = Vec::new();
        for declared in &attribute.advected {
            let Some(space) = representation(group, &declared.space.to_string()) else {
                scope.define_unknown(plain(&declared.name));
                continue;
            };
            let value = symbols(&plain(&declared.name), space.coordinates());
            scope.define(plain(&declared.name), Value::Vector(value.clone()));
            advected.push((plain(&declared.name), value));
            advected_idents.push(declared.name.clone());
            spaces.push(space);
        }
        let before = diagnostics.len();
        let potential = attribute
            .potential
            .as_ref()
            .and_then(|source| lower_scalar("the potential", source, &mut scope, arena, diagnostics));
        let sound = diagnostics.len() == before;
        Some(Self {
            algebra: Semidirect { group, spaces },
            parameters,
            constants: scope.constants,
            inertia,
            inertia_field,
            configuration,
            momentum,
            advected,
            advected_idents,
            potential: potential.unwrap_or_else(|| arena.zero()),
            potential_source: attribute.potential.clone().filter(|_| sound),
        })
    }

    /// The parameters' symbols in the order of the flat array: fields, then constants.
    pub fn parameter_symbols(&self) -> Vec<Symbol> {
        let fields = self.parameters.iter().flat_map(|field| field.symbols.iter().copied());
        fields.chain(self.constants.iter().filter_map(|constant| constant.symbol.as_symbol())).collect()
    }

    /// The state's symbols in the order of the flat array.
    pub fn state_symbols(&self) -> Vec<Symbol> {
        self.parts().iter().flat_map(|part| part.symbols.clone()).collect()
    }

    /// The parts of the state, in order.
    pub fn parts(&self) -> Vec<Part<'a>> {
        let group = self.algebra.group;
        let part =
            |name: Ident, type_name, suffixes: &[&'static str], value: &Vector<'a>, doc: String| Part {
                name,
                type_name,
                suffixes: suffixes.to_vec(),
                symbols: value.symbols(),
                value: value.clone(),
                doc,
            };
        let mut parts = vec![
            part(
                format_ident!("{}", group.configuration_name()),
                group.configuration_type(),
                group.coordinates(),
                &self.configuration,
                "From body to space coordinates.".to_owned(),
            ),
            part(
                format_ident!("momentum"),
                group.momentum_type(),
                group.axes(),
                &self.momentum,
                "Momentum, in body coordinates.".to_owned(),
            ),
        ];
        parts.extend(self.advected_parts());
        parts
    }

    /// The parts of the state that are advected parameters.
    pub fn advected_parts(&self) -> Vec<Part<'a>> {
        self.advected_idents
            .iter()
            .zip(&self.algebra.spaces)
            .zip(&self.advected)
            .map(|((name, space), (_, value))| Part {
                name: name.clone(),
                type_name: space.type_name(),
                suffixes: space.coordinates().to_vec(),
                symbols: value.symbols(),
                value: value.clone(),
                doc: format!(
                    "Advected parameter `{}`, fixed in space, seen in body coordinates.",
                    plain(name)
                ),
            })
            .collect()
    }

    /// `𝕀⁻¹ m` by the factorization `𝕀 = L D Lᵀ`
    pub fn velocity(&self, m: &Vector<'a>) -> Vector<'a> {
        let n = m.len();
        let (l, d) = self.inertia.ldl();
        let mut x = m.0.clone();
        for i in 0..n {
            for k in 0..i {
                x[i] = x[i] - l.at(i, k) * x[k];
            }
        }
        for i in (0..n).rev() {
            x[i] = x[i] / d.0[i];
            for k in i + 1..n {
                x[i] = x[i] - l.at(k, i) * x[k];
            }
        }
        Vector(x)
    }

    /// The Hamiltonian. With `𝕀 = L D Lᵀ` the kinetic energy is `½ Σ yᵢ²/dᵢ`, `y = L⁻¹ μ`: a sum of squares, without
    /// cancellation.
    pub fn energy(&self) -> Expr<'a> {
        let (l, d) = self.inertia.ldl();
        let mut y = self.momentum.0.clone();
        let mut kinetic = self.potential.arena().zero();
        for i in 0..y.len() {
            for k in 0..i {
                y[i] = y[i] - l.at(i, k) * y[k];
            }
            kinetic = kinetic + y[i] * y[i] / d.0[i];
        }
        kinetic / 2 + self.potential
    }

    /// `∂V/∂a` for each advected parameter.
    pub fn potential_gradients(&self) -> Vec<Vector<'a>> {
        self.advected.iter().map(|(_, a)| gradient(self.potential, &a.symbols())).collect()
    }

    /// The advected parameters without their names.
    pub fn advected_values(&self) -> Vec<Vector<'a>> {
        self.advected.iter().map(|(_, value)| value.clone()).collect()
    }

    /// The Casimirs of the bracket, with their names.
    pub fn casimirs(&self) -> Vec<(String, Expr<'a>)> {
        let momentum = Named { name: "momentum", value: &self.momentum };
        let advected: Vec<Named<'_, 'a>> =
            self.advected.iter().map(|(name, value)| Named { name, value }).collect();
        self.algebra.group.casimirs(Some(&momentum), &advected)
    }

    /// A formula's text with the paths of the user's constants in the place of the symbols that stand for them.
    fn in_users_words(&self, formula: &str) -> String {
        self.constants.iter().fold(formula.to_owned(), |text, constant| {
            let path = constant.tokens.to_token_stream().to_string().replace(' ', "");
            text.replace(&constant.name, &path)
        })
    }

    /// The equations of motion as text.
    pub fn equations(&self) -> Vec<String> {
        let group = self.algebra.group;
        let velocity = "velocity = inertia⁻¹ momentum".to_owned();
        let mut lines = vec![velocity];
        let advected: Vec<&str> = self.advected.iter().map(|(name, _)| name.as_str()).collect();
        let equations = group.equations(&crate::group::EquationNames {
            configuration: group.configuration_name(),
            momentum: "momentum",
            velocity: "velocity",
            advected: &advected,
        });
        lines.push(equations.configuration);
        lines.push(format!("momentum' = {}", equations.momentum.join(" + ")));
        lines.extend(equations.advected);
        for ((_, a), gradient) in self.advected.iter().zip(self.potential_gradients()) {
            for (symbol, component) in a.symbols().into_iter().zip(gradient.iter()) {
                let symbol = component.arena().symbol_info(symbol).name;
                lines.push(format!("∂V/∂{symbol} = {}", self.in_users_words(&component.to_string())));
            }
        }
        lines
    }
}

/// An identifier's text without the mark of a raw one.
fn plain(ident: &Ident) -> String {
    let text = ident.to_string();
    text.strip_prefix("r#").unwrap_or(&text).to_owned()
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
