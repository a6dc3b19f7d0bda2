//! What the values of a step are called in generated code.

use crate::expr::{Arena, Expr, Number, Stage, Vector};
use crate::group::{Retraction, SemidirectVector};
use crate::model::{Factor, System};

/// The names of a step's values, and the scale of its unknown, which some are called by. Functions that name something
/// return it.
#[derive(Clone)]
pub(super) struct ValueNames<'s, 'a> {
    system: &'s System<'a>,
    /// For each factor the number `k` for which its unknown is `η/k`.
    scales: Vec<i128>,
}

/// The name of a value of which the unknown is this part.
fn unknown(scale: i128) -> &'static str {
    match scale {
        1 => "eta",
        2 => "half_eta",
        _ => "quarter_eta",
    }
}

/// The prefix of a value that is a multiple by the unknown's scale.
fn multiple(scale: i128) -> &'static str {
    match scale {
        1 => "",
        2 => "twice_",
        _ => "four_times_",
    }
}

impl<'s, 'a> ValueNames<'s, 'a> {
    pub(super) fn new(system: &'s System<'a>, retraction: Retraction) -> Self {
        Self { system, scales: system.group.unknown_scales(retraction) }
    }

    /// For each factor `k` to this power.
    fn multiples(&self, power: i32) -> Vec<Expr<'a>> {
        let number = |&scale: &i128| self.system.time.arena().number(Number::ratio(scale, 1).powi(power));
        self.scales.iter().map(number).collect()
    }

    /// Times the unknown's scale: `y` from the unknown.
    pub(super) fn times_scale(&self, x: &Vector<'a>) -> Vector<'a> {
        self.system.group.multiplied(x, &self.multiples(1))
    }

    /// By the unknown's scale.
    pub(super) fn per_scale(&self, y: &Vector<'a>) -> Vector<'a> {
        self.system.group.multiplied(y, &self.multiples(-1))
    }

    /// The same values, kept whole as multiples by the unknown's scale: what is made of the unknown and multiplied by
    /// it again has that factor.
    pub(super) fn keep_multiple(&self, element: &SemidirectVector<'a>) -> SemidirectVector<'a> {
        let group = &self.system.group;
        group.all_multiplied(&group.all_multiplied(element, &self.multiples(1)).hold(), &self.multiples(-1))
    }

    /// The prefix that tells a factor's values from those of the others, where there are others.
    fn prefix(&self, factor: &Factor<'a>) -> String {
        match self.system.factors.len() {
            1 => String::new(),
            _ => format!("{}_", factor.name.plain()),
        }
    }

    /// A name for each factor and suffix.
    fn each<'n>(
        &self,
        name: impl Fn(&Factor<'a>, i128) -> String,
        suffixes: impl Fn(usize) -> &'n [&'n str],
    ) -> Vec<String> {
        let factors = self.system.factors.iter().zip(&self.scales).enumerate();
        let names = factors.flat_map(|(place, (factor, &scale))| {
            let name = name(factor, scale);
            suffixes(place).iter().map(move |suffix| format!("{name}_{suffix}")).collect::<Vec<_>>()
        });
        names.collect()
    }

    /// A name for each component of an element of the algebra or of its dual.
    fn axes(&self, name: impl Fn(&Factor<'a>, i128) -> String) -> Vec<String> {
        self.each(name, |factor| self.system.group.factors[factor].group.axes())
    }

    /// A name for each component of an element of the group.
    fn coordinates(&self, name: impl Fn(&Factor<'a>) -> String) -> Vec<String> {
        self.each(|factor, _| name(factor), |factor| self.system.group.factors[factor].group.coordinates())
    }

    /// The names of the components of `η`, or of the part of it that is the unknown.
    pub(super) fn unknown(&self) -> Vec<String> {
        self.axes(|factor, scale| format!("{}{}", self.prefix(factor), unknown(scale)))
    }

    /// The names of the components of an element of the algebra or of its dual.
    pub(super) fn components(&self, what: &str) -> Vec<String> {
        self.axes(|factor, _| format!("{}{what}", self.prefix(factor)))
    }

    /// An element of the algebra or of its dual.
    pub(super) fn algebra(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        named(value, self.components(what))
    }

    /// An element of the algebra or of its dual that is a multiple by the unknown's scale.
    pub(super) fn multiple_of(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        named(value, self.axes(|factor, scale| format!("{}{}{what}", self.prefix(factor), multiple(scale))))
    }

    /// An element of the group.
    pub(super) fn group(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        named(value, self.coordinates(|factor| format!("{}{what}", self.prefix(factor))))
    }

    /// Names what becomes of the configuration.
    pub(super) fn configuration(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        named(value, self.coordinates(|factor| format!("{}_{what}", factor.name.plain())))
    }

    /// The unknown's square, for each factor by itself.
    pub(super) fn squares(&self, unknown_part: &Vector<'a>) {
        let factors = self.system.factors.iter().zip(self.system.group.places());
        for ((factor, place), &scale) in factors.zip(&self.scales) {
            let part = place.algebra(unknown_part);
            part.dot(&part).named(format!("{}{}_squared", self.prefix(factor), unknown(scale)));
        }
    }

    /// The names of what belongs to the components of the advected parameters, of each by itself.
    pub(super) fn of_advected(&self, what: &str) -> Vec<Vec<String>> {
        let spaces = self.system.group.factors.iter().flat_map(|factor| &factor.spaces);
        let names = self.system.advected().zip(spaces).map(|(advected, space)| {
            let name = format!("{}_{what}", advected.name.plain());
            space.coordinates().iter().map(|suffix| format!("{name}_{suffix}")).collect()
        });
        names.collect()
    }

    /// Names what becomes of the advected parameters, or belongs to them.
    pub(super) fn advected(&self, what: &str, values: &[Vector<'a>]) {
        for (value, names) in values.iter().zip(self.of_advected(what)) {
            named(value, names);
        }
    }
}

/// Symbols with these names, of stage *iteration*.
pub(super) fn symbols(arena: &Arena, names: Vec<String>) -> Vector<'_> {
    Vector(names.into_iter().map(|name| arena.symbol(name, Stage::Iteration)).collect())
}

fn named<'a>(value: &Vector<'a>, names: Vec<String>) -> Vector<'a> {
    Vector(
        value.iter().zip(names).map(|(component, name): (Expr<'a>, String)| component.named(name)).collect(),
    )
}
