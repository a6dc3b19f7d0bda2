//! From what the user wrote to what it means: names are looked up once, here, and every rule that a description breaks
//! is reported.

mod advected;
pub(crate) mod groups;
mod inertia;
mod resolver;
mod rules;

use std::ops::Range;

use proc_macro2::Ident;
use quote::format_ident;
use syn::ext::IdentExt;

use crate::diagnostics::Diagnostics;
use crate::group::{Group, Representation};
use crate::identifiers::Name;
use crate::parse::{self, Attribute, Item};
use crate::quantity::ScalarType;

/// A description, resolved: parts refer to each other by index.
///
/// What is in error, which was reported, is left out, and [`is_sound`](Self::is_sound) says so; the expressions are
/// there all the same, for the sake of problems in them.
pub struct Description<'d> {
    /// What the attribute says.
    pub attribute: &'d Attribute,
    /// The struct.
    pub item: &'d Item,
    /// What numbers it is made of.
    pub scalar: ScalarType,
    /// The factors of the configuration's group.
    pub factors: Vec<Factor>,
    /// The advected parameters, in the order declared.
    pub advected: Vec<Advected<'d>>,
    /// The fields marked `#[inertia]`.
    pub inertias: Vec<Inertia>,
    /// The forces on momenta.
    pub forces: Vec<Force<'d>>,
    /// Names whose declarations are in error: using them is no further error.
    pub unknown: Vec<String>,
    /// Whether the description has a meaning, but for problems in its expressions.
    pub is_sound: bool,
}

/// A factor of the configuration's group; each element of an array is one.
pub struct Factor {
    /// The configuration's name.
    pub name: Name,
    /// The momentum's name: `momentum` where there is only one group, `attitude_momentum` for a factor `attitude`.
    pub momentum_name: Name,
    /// The group.
    pub group: &'static dyn Group,
}

/// An advected parameter.
pub struct Advected<'d> {
    /// Its name.
    pub name: Name,
    /// As it is declared.
    pub written: &'d parse::Advected,
    /// The factor that acts on it.
    pub factor: usize,
    /// The space it lives in.
    pub space: &'static dyn Representation,
}

/// A field marked `#[inertia]`.
#[derive(Clone)]
pub struct Inertia {
    /// The field.
    pub field: usize,
    /// Its name: the field, or an element of it.
    pub name: Name,
    /// How it is given.
    pub shape: InertiaShape,
    /// The factors that it is the joint inertia of; several such groups of factors where each has this same inertia.
    /// Empty beside a Hamiltonian or a Lagrangian.
    pub blocks: Vec<Vec<usize>>,
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

/// A force.
pub struct Force<'d> {
    /// The factors that it acts on; `None` if there are none of the name.
    pub factors: Option<Factors>,
    /// Its value.
    pub value: &'d syn::Expr,
}

/// A factor, or all of an array.
#[derive(Clone, Debug)]
pub enum Factors {
    /// One factor.
    One(usize),
    /// An array of them.
    All(Range<usize>),
}

impl Factors {
    /// Which they are.
    pub fn indices(&self) -> Range<usize> {
        match self {
            Self::One(factor) => *factor..factor + 1,
            Self::All(factors) => factors.clone(),
        }
    }
}

/// Resolves a description, and reports every rule that it breaks.
pub fn resolve<'d>(
    attribute: &'d Attribute,
    item: &'d Item,
    diagnostics: &mut Diagnostics,
) -> Description<'d> {
    let before = diagnostics.len();
    let resolver = resolver::Resolver::new(attribute, item, diagnostics);
    resolver.check_energy(diagnostics);
    let inertias = resolver.inertias(diagnostics);
    let advected = resolver.advected(diagnostics);
    resolver.check_retractions(&advected, diagnostics);
    resolver.names_are_free(&advected, diagnostics);
    resolver.names_are_distinct(diagnostics);
    let forces = resolver.forces(diagnostics);
    let scalar = resolver.scalar(diagnostics);
    resolver.check_units(&advected, diagnostics);
    let unknown = resolver.unknown_names(&advected);
    let is_sound = attribute.is_sound && item.sound && diagnostics.len() == before;
    let factors = resolver.factors;
    Description { attribute, item, scalar, factors, advected, inertias, forces, unknown, is_sound }
}

/// The name of a factor's momentum.
fn momentum_name(factor: Option<&Ident>) -> Ident {
    match factor {
        Some(name) => format_ident!("{}_momentum", name.unraw(), span = name.span()),
        None => format_ident!("momentum"),
    }
}
