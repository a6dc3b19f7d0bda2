//! `--spread name=width`: how members of an ensemble differ from one another.

use coadjoint::system::{Kind, Quantity};

use super::Setup;
use super::names::{Name, Names, Part, count, named, numbers};
use super::random::Random;
use super::transport::displace;
use crate::catalogue::Entry;
use crate::catalogue::quantities::{Component, components, matrix_order, rotation, tangent_length};
use crate::error::SetupError;

/// How members of an ensemble differ: each number evenly within its width about the setup's, each rotation by a turn of
/// up to its width, each matrix of a group by an element as near to the unit matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    parameters: Vec<f64>,
    state: Vec<f64>,
    /// Parameters that are drawn once for two places: the second takes what the first has.
    mirrored: Vec<(usize, usize)>,
    turns: Vec<RotationSpread>,
    /// The spread in words: `inertia ±1 % of each component`.
    pub words: Vec<String>,
    /// Notes for people.
    pub notes: Vec<String>,
}

/// How far a rotation is turned, or another element of a group is displaced: a vector of the algebra evenly distributed
/// in a ball.
#[derive(Clone, Debug, PartialEq)]
struct RotationSpread {
    quantity: &'static Quantity,
    /// In radians, or a pure number.
    width: f64,
    /// In which it is told: degrees, radians, or none.
    unit: &'static str,
}

/// A width as it is written.
enum Width {
    /// Of each component's own size.
    Percent(Vec<f64>),
    /// In the quantity's unit.
    Absolute(Vec<f64>),
    /// In radians or as a pure number, and the unit in which it was given.
    Turn(f64, &'static str),
}

/// The range of a number over all members.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledRange {
    /// The number's name, or that of a rotation.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// The least and the greatest; of a rotation, of the angles by which it was turned.
    pub range: (f64, f64),
}

impl Variation {
    /// Reads `inertia=1%`, `chi=0,0,0.1`, `momentum_z=0.01 kg m²/s`, `attitude=5deg`.
    ///
    /// # Errors
    /// If a name is unknown, or a width none that its quantity can have.
    pub fn parse(entry: &Entry, setup: &Setup, spreads: &[String]) -> Result<Self, SetupError> {
        let mut all = Self {
            parameters: vec![0.0; setup.parameters.len()],
            state: vec![0.0; setup.state.len()],
            mirrored: mirrored(entry, setup),
            turns: Vec::new(),
            words: Vec::new(),
            notes: Vec::new(),
        };
        for spread in spreads {
            let wrong = |what: &str| SetupError::new(format!("`--spread {spread}`: {what}"));
            let (name, value) =
                spread.split_once('=').ok_or_else(|| wrong("has no `=`; write for example `momentum=1%`"))?;
            let target = named(entry, Names::VARIED, name.trim())?;
            let width = width(entry, &target, value.trim())
                .map_err(|error| error.within(format!("`--spread {spread}`")))?;
            all.words.push(in_words(&target, &width));
            match width {
                Width::Turn(width, unit) => {
                    all.turns.retain(|turn| turn.quantity.name != target.quantity.name);
                    all.turns.push(RotationSpread { quantity: target.quantity, width, unit });
                }
                Width::Percent(percent) => {
                    let values = if target.part == Part::State { &setup.state } else { &setup.parameters };
                    let values = &values[target.slots.clone()];
                    let widths: Vec<f64> = values
                        .iter()
                        .zip(&percent)
                        .map(|(value, percent)| 0.01 * percent * value.abs())
                        .collect();
                    // that no percent spread nothing is what was asked for
                    if percent.iter().any(|percent| *percent > 0.0)
                        && widths.iter().all(|width| *width == 0.0)
                    {
                        all.notes
                            .push(format!("`--spread {spread}` spreads nothing: `{}` is zero", target.name));
                    }
                    all.set(&target, &widths);
                }
                Width::Absolute(widths) => all.set(&target, &widths),
            }
        }
        Ok(all)
    }

    fn set(&mut self, target: &Name, widths: &[f64]) {
        if target.part == Part::State {
            self.state[target.slots.clone()].copy_from_slice(widths);
            return;
        }
        self.parameters[target.slots.clone()].copy_from_slice(widths);
        // one entry stands for its mirror image too
        for &(first, second) in &self.mirrored {
            match (target.slots.contains(&first), target.slots.contains(&second)) {
                (true, false) => self.parameters[second] = self.parameters[first],
                (false, true) => self.parameters[first] = self.parameters[second],
                _ => {}
            }
        }
    }

    /// The setup of one member: the same numbers for the same seed and member, however many there are.
    pub fn member(&self, entry: &Entry, setup: &Setup, seed: u64, member: usize) -> Setup {
        self.drawn(entry, setup, seed, member).0
    }

    /// Draws a member, and the angles by which rotations were turned, rad.
    fn drawn(&self, entry: &Entry, setup: &Setup, seed: u64, member: usize) -> (Setup, Vec<f64>) {
        let mut random = Random::new(seed, member as u64);
        let mut drawn = setup.clone();
        // numbers that do not vary are drawn too, so that those of the others do not depend on them
        let numbers = drawn.parameters.iter_mut().zip(&self.parameters);
        for (value, width) in numbers.chain(drawn.state.iter_mut().zip(&self.state)) {
            *value += width * random.even();
        }
        for &(first, second) in &self.mirrored {
            drawn.parameters[second] = drawn.parameters[first];
        }
        if self.turns.is_empty() {
            return (drawn, Vec::new());
        }
        let system = entry.system(&drawn.parameters);
        let mut angles = Vec::new();
        for turn in &self.turns {
            let (by, angle) = turn.draw(entry, &mut random);
            drawn.state = displace(&*system, &drawn.state, &by);
            angles.push(angle);
        }
        (drawn, angles)
    }

    /// Begins the ranges of all that varies.
    pub(crate) fn ranges<'v>(&'v self, entry: &'v Entry, setup: &'v Setup) -> Ranges<'v> {
        let mut slots = Vec::new();
        let parts = [
            (entry.description.parameters, &self.parameters, false),
            (entry.description.state, &self.state, true),
        ];
        for (quantities, widths, of_state) in parts {
            for Component { name, unit, slot, .. } in components(quantities) {
                // what mirrors another number is the same
                let is_second = !of_state && self.mirrored.iter().any(|(_, second)| *second == slot);
                if widths[slot] > 0.0 && !is_second {
                    slots.push((of_state, slot, SampledRange { name, unit, range: NOTHING }));
                }
            }
        }
        let angles = self.turns.iter().map(|turn| SampledRange {
            name: turn.quantity.name.to_owned(),
            unit: turn.unit,
            range: NOTHING,
        });
        Ranges { entry, setup, variation: self, slots, angles: angles.collect() }
    }
}

/// The range of no members.
const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// Draws members, and keeps the ranges of what was drawn.
pub(crate) struct Ranges<'v> {
    entry: &'v Entry,
    setup: &'v Setup,
    variation: &'v Variation,
    slots: Vec<(bool, usize, SampledRange)>,
    angles: Vec<SampledRange>,
}

impl Ranges<'_> {
    /// The setup of a member; adds what was drawn to a list, a number for each range.
    pub(crate) fn member(&mut self, seed: u64, member: usize, list: &mut Vec<f64>) -> Setup {
        let (drawn, angles) = self.variation.drawn(self.entry, self.setup, seed, member);
        let mut widen = |range: &mut (f64, f64), value: f64| {
            *range = (range.0.min(value), range.1.max(value));
            list.push(value);
        };
        for (of_state, slot, SampledRange { range, .. }) in &mut self.slots {
            widen(range, if *of_state { drawn.state[*slot] } else { drawn.parameters[*slot] });
        }
        for (SampledRange { unit, range, .. }, angle) in self.angles.iter_mut().zip(angles) {
            widen(range, if *unit == "°" { angle.to_degrees() } else { angle });
        }
        drawn
    }

    /// Lists the ranges.
    pub(crate) fn finish(self) -> Vec<SampledRange> {
        self.slots.into_iter().map(|(_, _, drawn)| drawn).chain(self.angles).collect()
    }
}

impl RotationSpread {
    /// A tangent vector, and the angle.
    fn draw(&self, entry: &Entry, random: &mut Random) -> (Vec<f64>, f64) {
        let tangent = self.quantity.tangent();
        // of a rigid motion the rotation alone
        let dimension = match rotation(self.quantity) {
            Some((4, _)) => 3,
            Some(_) => 1,
            None => tangent.len(),
        };
        let (vector, length) = loop {
            let vector: Vec<f64> = (0..dimension).map(|_| random.even()).collect();
            let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length <= 1.0 {
                break (vector, length);
            }
        };
        let mut by = vec![0.0; tangent_length(entry.description.state)];
        by[tangent.start..].iter_mut().zip(vector).for_each(|(by, x)| *by = self.width * x);
        (by, self.width * length)
    }
}

/// The entries of square matrices that are symmetric in the setup, as inertias are, each with its mirror image.
fn mirrored(entry: &Entry, setup: &Setup) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (quantity, slots) in Quantity::with_ranges(entry.description.parameters) {
        let n = match quantity.kind {
            Kind::SymmetricMatrix(n) => n,
            Kind::Matrix(rows, columns) if rows == columns => rows,
            _ => continue,
        };
        let of_quantity = |i: usize, j: usize| (slots.start + i * n + j, slots.start + j * n + i);
        let own = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).map(|(i, j)| of_quantity(i, j));
        let own: Vec<_> = own.collect();
        let is_mirrored =
            |&(first, second): &(usize, usize)| setup.parameters[first] == setup.parameters[second];
        if matches!(quantity.kind, Kind::SymmetricMatrix(_)) || own.iter().all(is_mirrored) {
            pairs.extend(own);
        }
    }
    pairs
}

/// Reads a width.
fn width(entry: &Entry, target: &Name, value: &str) -> Result<Width, SetupError> {
    let name = &target.name;
    let wrong = |what: String| Err(SetupError::new(what));
    let (text, unit) = split_unit(value);
    let mut numbers = numbers(&format!("{name}={value}"), text)?;
    if let Some(number) = numbers.iter().find(|number| !(number.is_finite() && **number >= 0.0)) {
        return wrong(format!("a width must be finite and not negative, got {number}"));
    }
    let turns = rotation(target.quantity).filter(|_| target.part == Part::State);
    if let Some((stored, _)) = turns {
        let whole = Quantity::with_ranges(entry.description.state)
            .find(|(quantity, _)| quantity.name == target.quantity.name);
        let start = whole.map_or(0, |(_, slots)| slots.start);
        if target.is_whole() {
            let form = format!("a rotation spreads by an angle: write `{name}=5deg` or `{name}=0.1rad`");
            return match (unit, &numbers[..]) {
                ("deg" | "°", [width]) => Ok(Width::Turn(width.to_radians(), "°")),
                ("rad", [width]) => Ok(Width::Turn(*width, "rad")),
                _ => wrong(form),
            };
        }
        if target.slots.start < start + stored {
            let whole = target.quantity.name;
            return wrong(format!(
                "the components of a rotation cannot vary one by one; write `{whole}=5deg` or `{whole}=0.1rad`"
            ));
        }
    }
    if matrix_order(target.quantity).is_some() {
        let whole = target.quantity.name;
        return match (target.is_whole(), unit, &numbers[..]) {
            (true, "", [width]) => Ok(Width::Turn(*width, "")),
            _ => wrong(format!(
                "an element of a group of matrices is displaced as a whole, by a number: write `{whole}=0.1`"
            )),
        };
    }
    let (requested, one) = (target.slots.len(), numbers.len() == 1);
    if one {
        numbers.resize(requested, numbers[0]);
    }
    if numbers.len() != requested {
        return wrong(format!("takes {} or one, got {}", count(requested), numbers.len()));
    }
    match (unit, target.unit) {
        ("%", _) => Ok(Width::Percent(numbers)),
        ("", _) => Ok(Width::Absolute(numbers)),
        (unit, own) if unit == own => Ok(Width::Absolute(numbers)),
        (unit, "") => wrong(format!("`{unit}` is no unit of `{name}`, which is a pure number")),
        (unit, own) => wrong(format!("`{unit}` is not the unit of `{name}`, which is {own}")),
    }
}

/// The numbers of a value, and what stands behind the last of them.
fn split_unit(value: &str) -> (&str, &str) {
    let last = value.rfind(',').map_or(0, |comma| comma + 1);
    let ends = (last..=value.len()).rev().filter(|&end| value.is_char_boundary(end));
    let end = ends.into_iter().find(|&end| value[last..end].trim().parse::<f64>().is_ok());
    let (numbers, unit) = value.split_at(end.unwrap_or(value.len()));
    (numbers, unit.trim())
}

/// `inertia ±1 % of each component`
fn in_words(Name { name, unit, .. }: &Name, width: &Width) -> String {
    let own = |numbers: &[f64]| match numbers {
        [first, rest @ ..] if rest.iter().all(|number| number == first) => first.to_string(),
        numbers => {
            let list: Vec<String> = numbers.iter().map(f64::to_string).collect();
            format!("({})", list.join(", "))
        }
    };
    match width {
        Width::Turn(width, "°") => format!("{name} turned by up to {}°", rounded(width.to_degrees())),
        Width::Turn(width, "") => format!("{name} displaced by up to {width}"),
        Width::Turn(width, unit) => format!("{name} turned by up to {width} {unit}"),
        Width::Percent(percent) if percent.len() == 1 => format!("{name} ±{} %", own(percent)),
        Width::Percent(percent) => format!("{name} ±{} % of each component", own(percent)),
        Width::Absolute(widths) => format!("{name} ±{} {unit}", own(widths)).trim_end().to_owned(),
    }
}

/// Degrees as they were written, but for the roundoff of having been radians.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}
