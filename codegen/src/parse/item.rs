//! The annotated struct.

use proc_macro2::{Span, TokenStream};
use syn::punctuated::Punctuated;
use syn::{Fields, Ident, ItemStruct, LitStr, Meta, Token, Type, Visibility};

use super::factor::FactorName;
use super::nesting;
use super::shape;
use crate::diagnostics::Diagnostics;
use crate::quantity::{ScalarType, Shape};

/// Marks the field that holds the inertia.
const INERTIA: &str = "inertia";
/// Says a field's unit.
const UNIT: &str = "unit";

/// The struct that holds a system's parameters.
#[derive(Debug)]
pub struct Item {
    /// The struct as it is to be emitted: without our helper attributes.
    pub declaration: ItemStruct,
    /// Its name.
    pub name: Ident,
    /// Who may see it.
    pub visibility: Visibility,
    /// Its doc comment, line by line.
    pub docs: Vec<String>,
    /// Its attributes that set the levels of lints.
    pub lints: Vec<syn::Attribute>,
    /// The fields that could be read, in the order written.
    pub fields: Vec<Field>,
    /// The fields that could not, which is reported: expressions may name them all the same.
    pub unreadable: Vec<Unreadable>,
    /// Whether there were no problems.
    pub sound: bool,
}

/// A parameter.
#[derive(Debug)]
pub struct Field {
    /// Its name.
    pub name: Ident,
    /// Whether it is a scalar, a vector or a matrix.
    pub shape: Shape,
    /// How many there are of it, where it is an array.
    pub length: Option<usize>,
    /// Of what numbers.
    pub scalar: ScalarType,
    /// Whether, and how, it is marked `#[inertia]`.
    pub inertia: Option<Inertia>,
    /// Its unit, as `#[unit("kg m²")]` says it.
    pub unit: Option<String>,
    /// The first line of its doc comment, empty if it has none.
    pub doc: String,
    /// Its type as written.
    pub ty: Type,
    /// Its attributes that set the levels of lints.
    pub lints: Vec<syn::Attribute>,
}

/// The mark `#[inertia]`, or `#[inertia(attitude, position)]` with the factors it is for.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// Where it is.
    pub span: Span,
    /// The factors it names; none stands for all.
    pub factors: Vec<FactorName>,
}

/// A field of a type that no description can hold.
#[derive(Debug)]
pub struct Unreadable {
    /// Its name.
    pub name: Ident,
    /// Whether, and how, it is marked `#[inertia]`.
    pub inertia: Option<Inertia>,
}

impl Item {
    /// Reads the annotated item. `None` if there is nothing in it to go on with.
    pub fn parse(tokens: TokenStream, diagnostics: &mut Diagnostics) -> Option<Self> {
        let before = diagnostics.len();
        let mut declaration = declaration(tokens, diagnostics)?;
        let generics = &declaration.generics;
        if !generics.params.is_empty() {
            let message = "a system cannot be generic; write the types of its parameters, such as `f64`";
            diagnostics.push(generics, message);
        }
        // conditional fields would have to be conditional in all that is generated
        let attributes = declaration.fields.iter().flat_map(|field| &field.attrs);
        for attribute in attributes.filter(|attribute| is(attribute, "cfg")) {
            diagnostics.push(attribute, "the parameters of a system cannot depend on `cfg`");
        }
        let named = match &mut declaration.fields {
            Fields::Named(fields) => &mut fields.named,
            Fields::Unit => &mut Punctuated::new(),
            Fields::Unnamed(fields) => {
                let message = "the parameters of a system need names; write `struct Name { name: Type, … }`";
                return diagnostics.fail(&*fields, message);
            }
        };
        let (mut fields, mut unreadable) = (Vec::new(), Vec::new());
        for field in named {
            let (inertia, unit) = (take_inertia(field, diagnostics), take_unit(field, diagnostics));
            let Some(name) = field.ident.clone() else { continue };
            let element = shape::element(&field.ty).and_then(|(element, length)| {
                let known = shape::of_type(element).map(|(shape, scalar)| (shape, length, scalar));
                let message = || format!("`{name}` cannot be of this type; {SUPPORTED}");
                known.ok_or_else(|| syn::Error::new_spanned(&field.ty, message()))
            });
            match element {
                Ok((shape, length, scalar)) => {
                    let doc =
                        docs(&field.attrs).into_iter().find(|line| !line.is_empty()).unwrap_or_default();
                    let (ty, lints) = (field.ty.clone(), lints(&field.attrs));
                    if fields.iter().any(|known: &Field| known.name == name) {
                        diagnostics.push(&name, format!("`{name}` is the name of a field before"));
                        continue;
                    }
                    fields.push(Field { name, shape, length, scalar, inertia, unit, doc, ty, lints });
                }
                Err(error) => {
                    diagnostics.absorb(error);
                    unreadable.push(Unreadable { name, inertia });
                }
            }
        }
        one_scalar_type(&fields, diagnostics);
        // a generic struct cannot be worked with, but its fields were worth looking at
        declaration.generics.params.is_empty().then(|| Self {
            name: declaration.ident.clone(),
            visibility: declaration.vis.clone(),
            docs: docs(&declaration.attrs),
            lints: lints(&declaration.attrs),
            declaration,
            fields,
            unreadable,
            sound: diagnostics.len() == before,
        })
    }
}

/// Types of fields, for messages.
const SUPPORTED: &str = "a parameter is `f64`, `f32`, or a vector or matrix of them: `Vector1<f64>` to `Vector6<f64>`, \
                         `SVector<f64, N>`, `Matrix1<f64>` to `Matrix6<f64>` or `SMatrix<f64, R, C>`; or an array of these, such as `[f64; 3]`";

/// The struct without our helper attributes, for emission where no [`Item`] could be made of it, so that a mistake
/// brings no complaints about unknown attributes with it. `None` if it is no struct.
pub fn without_helpers(tokens: TokenStream) -> Option<ItemStruct> {
    if nesting::excess(&tokens).is_some() {
        return None;
    }
    let mut item = syn::parse2::<ItemStruct>(tokens).ok()?;
    item.fields
        .iter_mut()
        .for_each(|field| field.attrs.retain(|attribute| !is(attribute, INERTIA) && !is(attribute, UNIT)));
    Some(item)
}

fn declaration(tokens: TokenStream, diagnostics: &mut Diagnostics) -> Option<ItemStruct> {
    if let Some((span, message)) = nesting::excess(&tokens) {
        diagnostics.push_at(span, message);
        return None;
    }
    match syn::parse2::<ItemStruct>(tokens.clone()) {
        Ok(item) => Some(item),
        Err(error) => {
            match syn::parse2::<syn::Item>(tokens) {
                // not a struct, but an item
                Ok(syn::Item::Struct(_)) | Err(_) => diagnostics.absorb(error),
                Ok(other) => {
                    let message =
                        "`#[lie_poisson_system]` describes a struct that holds the parameters of the system";
                    diagnostics.push(other, message);
                }
            }
            None
        }
    }
}

fn is(attribute: &syn::Attribute, helper: &str) -> bool {
    attribute.path().is_ident(helper)
}

/// Removes one of our attributes from a field, which may be there once.
fn take(field: &mut syn::Field, helper: &str, diagnostics: &mut Diagnostics) -> Option<syn::Attribute> {
    let (ours, others): (Vec<_>, _) = field.attrs.drain(..).partition(|attribute| is(attribute, helper));
    field.attrs = others;
    if let [_, again, ..] = ours.as_slice() {
        diagnostics.push(again, format!("`#[{helper}]` is given twice; once is enough"));
    }
    ours.into_iter().next()
}

/// Removes `#[unit("kg m²")]` from a field, and returns the unit.
fn take_unit(field: &mut syn::Field, diagnostics: &mut Diagnostics) -> Option<String> {
    let attribute = take(field, UNIT, diagnostics)?;
    let text = attribute.meta.require_list().and_then(|list| list.parse_args::<LitStr>());
    match text.map(|text| text.value().trim().to_owned()) {
        Ok(unit) if !unit.is_empty() => Some(unit),
        _ => diagnostics.fail(attribute, "a unit is written as a text: `#[unit(\"kg m²\")]`"),
    }
}

/// Removes `#[inertia]` from a field and says where it was, and for which factors.
fn take_inertia(field: &mut syn::Field, diagnostics: &mut Diagnostics) -> Option<Inertia> {
    let mark = take(field, INERTIA, diagnostics)?;
    let factors = match &mark.meta {
        Meta::Path(_) => Vec::new(),
        Meta::List(list) => {
            let names = Punctuated::<FactorName, Token![,]>::parse_terminated;
            match list.parse_args_with(names) {
                Ok(names) if !names.is_empty() => names.into_iter().collect(),
                _ => {
                    let message = "`#[inertia(…)]` names the factors that it is the inertia of, as in `#[inertia(attitude)]`";
                    diagnostics.push(&mark, message);
                    Vec::new()
                }
            }
        }
        Meta::NameValue(_) => {
            diagnostics
                .push(&mark, "write `#[inertia]`, or `#[inertia(attitude)]` with the name of a factor");
            Vec::new()
        }
    };
    Some(Inertia { span: mark.path().get_ident()?.span(), factors })
}

fn one_scalar_type(fields: &[Field], diagnostics: &mut Diagnostics) {
    let Some((first, rest)) = fields.split_first() else { return };
    for field in rest.iter().filter(|field| field.scalar != first.scalar) {
        let (here, there) = (shape::scalar_name(field.scalar), shape::scalar_name(first.scalar));
        let message = format!(
            "this is made of `{here}`, but `{}` of `{there}`; use one of them for all parameters",
            first.name
        );
        diagnostics.push(&field.ty, message);
    }
}

/// The attributes that set the levels of lints.
fn lints(attributes: &[syn::Attribute]) -> Vec<syn::Attribute> {
    let levels = ["allow", "warn", "deny", "forbid"];
    let sets = |attribute: &&syn::Attribute| levels.iter().any(|level| attribute.path().is_ident(level));
    attributes.iter().filter(sets).cloned().collect()
}

/// The lines of a doc comment, without the space after `///`.
fn docs(attributes: &[syn::Attribute]) -> Vec<String> {
    let text = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    });
    let clean = |line: &str| line.strip_prefix(' ').unwrap_or(line).trim_end().to_owned();
    text.flat_map(|text| text.split('\n').map(clean).collect::<Vec<_>>()).collect()
}
