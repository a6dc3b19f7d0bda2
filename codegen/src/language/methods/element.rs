//! Methods of configurations, as nalgebra's rotations and isometries have them.

use super::super::value::{Element, Value};
use super::{Call, Method, method};
use crate::diagnostics::list;
use crate::expr::Vector;
use crate::group::is_same;

pub(super) static METHODS: &[Method] = &[
    method("inverse", &[], |call| Some(inverse(call)?.into_value())),
    method("transform_point", &["&p"], |call| transformed(call, receiver(call)?)),
    method("inverse_transform_point", &["&p"], |call| transformed(call, inverse(call)?)),
    method("transform_vector", &["&v"], |call| transformed(call, receiver(call)?)),
    method("inverse_transform_vector", &["&v"], |call| transformed(call, inverse(call)?)),
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

/// The image of the argument, a point or a vector as the method wants it.
fn transformed<'a>(call: &mut Call<'_, 'a>, element: Element<'a>) -> Option<Value<'a>> {
    let (value, expr) = &call.arguments[0];
    let of_points = call.method.to_string().ends_with("point");
    let image = match value {
        Value::Vector(vector) if !of_points => {
            element.group.act(&element.coordinates, vector).map(Value::Vector)
        }
        Value::Point(point) if of_points => element.moved(point).map(Value::Point),
        _ => None,
    };
    image.or_else(|| {
        let hint = match (value, of_points) {
            (Value::Vector(vector), true) => format!("; the point is `Point{}::from(v)`", vector.len()),
            (Value::Point(_), false) => "; the vector to it is `p.coords`".to_owned(),
            _ => String::new(),
        };
        let (method, acting, found) = (call.method, call.receiver.describe(), value.describe());
        call.fail(expr, format!("`{method}` of {acting} does not take {found}{hint}"))
    })
}

impl<'a> Element<'a> {
    fn into_value(self) -> Value<'a> {
        Value::element(self.group, self.coordinates)
    }

    /// The translation, of a rigid motion.
    fn translation(&self) -> Option<Vector<'a>> {
        match self.component("translation", false) {
            Some(Value::Vector(translation)) => Some(translation),
            _ => None,
        }
    }

    /// Whether points are moved otherwise than vectors.
    pub(in crate::language) fn moves_points(&self) -> bool {
        self.translation().is_some()
    }

    /// Where the group takes a point, if it acts on such points.
    fn moved(&self, point: &Vector<'a>) -> Option<Vector<'a>> {
        let turned = self.group.act(&self.coordinates, point)?;
        Some(self.translation().map_or(turned.clone(), |translation| &turned + &translation))
    }

    /// `g p` or `g h`, and `g v` where it is all that the group does to a vector
    pub(in crate::language) fn times(&self, right: &Value<'a>) -> Option<Value<'a>> {
        match right {
            Value::Vector(vector) if !self.moves_points() => {
                self.group.act(&self.coordinates, vector).map(Value::Vector)
            }
            Value::Point(point) => self.moved(point).map(Value::Point),
            Value::Element(other) if is_same(other.group, self.group) => {
                let coordinates = self.group.compose(&self.coordinates, &other.coordinates);
                Some(Self { group: self.group, coordinates }.into_value())
            }
            _ => None,
        }
    }

    /// A field, or what a method without arguments returns.
    pub(in crate::language) fn component(&self, name: &str, called: bool) -> Option<Value<'a>> {
        let mut components = self.group.names().components.iter();
        let component = components.find(|component| component.name == name && component.called == called)?;
        Some(Value::of_component((component.of)(&self.coordinates)))
    }

    /// Says that there is no such field, and which there are.
    pub(in crate::language) fn no_component(&self, name: &str) -> String {
        let group = self.group.name();
        let components = || self.group.names().components.iter();
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
