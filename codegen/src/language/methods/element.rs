//! Methods of configurations, as nalgebra's rotations and isometries have them.

use super::super::value::{Element, Value};
use super::{Call, Method};
use crate::diagnostics::list;
use crate::expr::Vector;

const fn method(
    name: &'static str,
    arguments: usize,
    apply: for<'a> fn(&mut Call<'_, 'a>) -> Option<Value<'a>>,
) -> Method {
    Method { name, arguments, apply }
}

pub(super) static METHODS: &[Method] = &[
    method("inverse", 0, |call| Some(inverse(call)?.into_value())),
    method("transform_vector", 1, |call| {
        let element = receiver(call)?;
        transformed(call, &element)
    }),
    method("inverse_transform_vector", 1, |call| {
        let element = inverse(call)?;
        transformed(call, &element)
    }),
];

fn receiver<'a>(call: &Call<'_, 'a>) -> Option<Element<'a>> {
    match call.receiver {
        Value::Element(element) => Some(element.clone()),
        _ => None,
    }
}

fn inverse<'a>(call: &Call<'_, 'a>) -> Option<Element<'a>> {
    let Element { group, coordinates } = receiver(call)?;
    Some(Element { group, coordinates: group.inverse(&coordinates) })
}

fn transformed<'a>(call: &mut Call<'_, 'a>, element: &Element<'a>) -> Option<Value<'a>> {
    let (value, expr) = &call.arguments[0];
    match value {
        Value::Vector(vector) if element.turned(vector).is_some() => {
            element.turned(vector).map(Value::Vector)
        }
        other => {
            let message = format!("{} does not transform {}", call.receiver.describe(), other.describe());
            call.fail(expr, message)
        }
    }
}

impl<'a> Element<'a> {
    fn into_value(self) -> Value<'a> {
        Value::element(self.group, self.coordinates)
    }

    /// The vector as the group acts on it, if it acts on such vectors.
    fn turned(&self, vector: &Vector<'a>) -> Option<Vector<'a>> {
        let mut spaces = self.group.representations().iter();
        let space = spaces.find(|space| space.coordinates().len() == vector.len())?;
        Some(space.act(&self.coordinates, vector))
    }

    /// `g v` or `g h`
    pub(in crate::language) fn times(&self, right: &Value<'a>) -> Option<Value<'a>> {
        match right {
            Value::Vector(vector) => self.turned(vector).map(Value::Vector),
            Value::Element(other) if other.group.name() == self.group.name() => {
                let coordinates = self.group.compose(&self.coordinates, &other.coordinates);
                Some(Self { group: self.group, coordinates }.into_value())
            }
            _ => None,
        }
    }

    /// A field, or what a method without arguments returns.
    pub(in crate::language) fn component(&self, name: &str, called: bool) -> Option<Value<'a>> {
        let mut components = self.group.components().iter();
        let component = components.find(|component| component.name == name && component.called == called)?;
        Some(Value::of_component((component.of)(&self.coordinates)))
    }

    /// Says that there is no such field, and which there are.
    pub(in crate::language) fn no_component(&self, name: &str) -> String {
        let group = self.group.name();
        let components = || self.group.components().iter();
        if components().any(|component| component.called && component.name == name) {
            return format!("`{name}` is a method: write `.{name}()`");
        }
        let fields: Vec<&str> =
            components().filter(|component| !component.called).map(|component| component.name).collect();
        if fields.is_empty() {
            return format!("an element of {group} has no components");
        }
        format!("an element of {group} has no component `{name}`, but {}", list(fields))
    }
}
