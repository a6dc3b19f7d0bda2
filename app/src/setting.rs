//! `--set name=value`: parameters, the initial state and controls, by the names of their quantities or single components.

use std::ops::Range;

use coadjoint::system::Quantity;

use crate::entry::{Entry, component_name};
use crate::error::Error;
use crate::simulation::Setup;
use crate::suggest::did_you_mean;

/// Makes the assignments one after the other.
///
/// # Errors
/// If a name is unknown, or a value is not made of as many numbers as its quantity has.
pub(crate) fn apply(entry: &Entry, setup: &mut Setup, assignments: &[String]) -> Result<(), Error> {
    for assignment in assignments {
        let (name, value) = assignment.split_once('=').ok_or_else(|| {
            let example = entry.description.state.first().map_or("name", |quantity| quantity.name);
            Error::Input(format!("`--set {assignment}` has no `=`; write for example `--set {example}=…`",))
        })?;
        let (name, value) = (name.trim(), value.trim());
        assign(entry, setup, Names::All, name, &numbers(name, value)?)?;
    }
    Ok(())
}

/// The assignments that lead to a setup, from whatever other one.
pub(crate) fn assignments(entry: &Entry, setup: &Setup) -> Vec<String> {
    let numbers =
        |values: &[f64]| values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(",");
    let mut assignments = Vec::new();
    let description = &entry.description;
    for (quantities, values) in
        [(description.parameters, &setup.parameters), (description.state, &setup.state)]
    {
        let all = laid_out(quantities);
        assignments
            .extend(all.map(|(quantity, slots)| format!("{}={}", quantity.name, numbers(&values[slots]))));
    }
    for (quantity, slots) in laid_out(description.controls) {
        for (component, held) in quantity.components.iter().zip(&setup.controls[slots]) {
            assignments.extend(held.map(|held| format!("{}={held:?}", component_name(quantity, component))));
        }
    }
    assignments
}

/// How far members of an ensemble may be from the setup, by names of quantities or components: one width for all components or one for each,
/// as they are or in percent — of the component, or of the largest one where the width is for all.
///
/// # Errors
/// If a name is unknown, a value is not made of one number or as many as its quantity has, or a width is negative or that of a rotation.
pub(crate) fn widths(entry: &Entry, setup: &Setup, spreads: &[String]) -> Result<Setup, Error> {
    let mut widths = Setup {
        parameters: vec![0.0; setup.parameters.len()],
        state: vec![0.0; setup.state.len()],
        controls: Vec::new(),
    };
    for spread in spreads {
        let wrong = |what: &str| Error::Input(format!("`--spread {spread}`: {what}"));
        let (name, value) =
            spread.split_once('=').ok_or_else(|| wrong("has no `=`; write for example `momentum=1%`"))?;
        let name = name.trim();
        let target = named(entry, Names::Varied, name)?;
        let of_state = target.part == Part::State;
        for (quantity, slots) in laid_out(entry.description.state) {
            let turns = rotation(quantity).map_or(0, |(count, _)| count);
            if of_state && target.slots.start < slots.start + turns && slots.start < target.slots.end {
                return Err(wrong("the components of a rotation cannot vary one by one"));
            }
        }
        let (number, percent) = match value.trim().strip_suffix('%') {
            Some(number) => (number, true),
            None => (value, false),
        };
        let mut numbers = numbers(name, number)?;
        if let Some(number) = numbers.iter().find(|number| !(number.is_finite() && **number >= 0.0)) {
            return Err(wrong(&format!("a width must be finite and not negative, got {number}")));
        }
        let values = &if of_state { &setup.state } else { &setup.parameters }[target.slots.clone()];
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let one = numbers.len() == 1;
        if one {
            numbers.resize(values.len(), numbers[0]);
        }
        if numbers.len() != values.len() {
            return Err(wrong(&format!("takes {} or one, got {}", count(values.len()), numbers.len())));
        }
        if percent {
            let of = |value: &f64| if one { largest } else { value.abs() };
            numbers.iter_mut().zip(values).for_each(|(number, value)| *number *= 0.01 * of(value));
        }
        let list = if of_state { &mut widths.state } else { &mut widths.parameters };
        list[target.slots].copy_from_slice(&numbers);
    }
    Ok(widths)
}

/// Which names can be assigned to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Names {
    /// All of them.
    All,
    /// Those of what members of an ensemble may differ in: parameters and the state.
    Varied,
    /// Those of parameters.
    Parameters,
    /// Those of the state.
    State,
    /// Those of controls.
    Controls,
}

impl Names {
    /// Whether they are those of this part, among others.
    fn include(self, part: Part) -> bool {
        match self {
            Names::All => true,
            Names::Varied => part != Part::Controls,
            Names::Parameters => part == Part::Parameters,
            Names::State => part == Part::State,
            Names::Controls => part == Part::Controls,
        }
    }

    /// What they are names of.
    fn kind(self) -> &'static str {
        match self {
            Names::All => "parameter, state quantity or control",
            Names::Varied => "parameter or state quantity",
            Names::Parameters => "parameter",
            Names::State => "state quantity",
            Names::Controls => "control",
        }
    }
}

/// What is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Parameters,
    State,
    Controls,
}

/// Sets a quantity or one of its components.
///
/// # Errors
/// If there is none of this name, its number of components is another one, or a number is not finite.
pub(crate) fn assign(
    entry: &Entry,
    setup: &mut Setup,
    which: Names,
    name: &str,
    numbers: &[f64],
) -> Result<(), Error> {
    let target = named(entry, which, name)?;
    if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
        return Err(Error::Input(format!("`{name}` must be finite, got `{number}`")));
    }
    let slots = target.slots;
    if numbers.len() != slots.len() {
        return Err(Error::Input(format!(
            "`{name}` takes {}, got {}",
            count(slots.len()),
            count(numbers.len())
        )));
    }
    match target.part {
        Part::Parameters => setup.parameters[slots].copy_from_slice(numbers),
        Part::State => setup.state[slots].copy_from_slice(numbers),
        Part::Controls => {
            setup.controls[slots]
                .iter_mut()
                .zip(numbers)
                .for_each(|(control, number)| *control = Some(*number));
        }
    }
    Ok(())
}

/// What a name stands for.
fn named(entry: &Entry, which: Names, name: &str) -> Result<Name, Error> {
    let mut names = Name::all(entry, which);
    let Some(index) = names.iter().position(|candidate| candidate.name == name) else {
        let hint = did_you_mean(name, names.iter().map(|candidate| candidate.name.as_str()));
        return Err(Error::Input(format!(
            "`{}` has no {} `{name}`{hint} {}",
            entry.name,
            which.kind(),
            known(entry, which)
        )));
    };
    Ok(names.swap_remove(index))
}

/// Normalizes rotations and validates the setup; returns notes for the user.
///
/// # Errors
/// If a rotation is zero, or no stepper can be built with the parameters.
pub(crate) fn validate(entry: &Entry, setup: &mut Setup) -> Result<Vec<String>, Error> {
    let mut notes = normalize(entry, setup)?;
    notes.extend(entry.check(setup)?);
    Ok(notes)
}

/// A name that can be set, and the numbers it stands for.
struct Name {
    name: String,
    part: Part,
    slots: Range<usize>,
}

impl Name {
    /// Whole quantities first, then their components.
    fn all(entry: &Entry, which: Names) -> Vec<Name> {
        let mut whole = Vec::new();
        let mut single = Vec::new();
        for (part, quantities) in parts(entry).into_iter().filter(|(part, _)| which.include(*part)) {
            for (quantity, slots) in laid_out(quantities) {
                if quantity.components.len() > 1 {
                    single.extend(quantity.components.iter().zip(slots.clone()).map(|(component, slot)| {
                        Name { name: component_name(quantity, component), part, slots: slot..slot + 1 }
                    }));
                }
                whole.push(Name { name: quantity.name.to_owned(), part, slots });
            }
        }
        whole.extend(single);
        whole
    }
}

/// The quantities of each part.
fn parts(entry: &Entry) -> [(Part, &'static [Quantity]); 3] {
    let description = &entry.description;
    [
        (Part::Parameters, description.parameters),
        (Part::State, description.state),
        (Part::Controls, description.controls),
    ]
}

/// Each quantity with its place in the flat list.
pub(crate) fn laid_out(quantities: &[Quantity]) -> impl Iterator<Item = (&Quantity, Range<usize>)> {
    quantities.iter().scan(0, |start, quantity| {
        let slots = *start..*start + quantity.components.len();
        *start = slots.end;
        Some((quantity, slots))
    })
}

/// The names of whole quantities: `(parameters: inertia, weight, chi; state: attitude, momentum, gamma)`.
fn known(entry: &Entry, which: Names) -> String {
    // most systems have no controls
    let shown = |part: &Part, quantities: &[Quantity]| match part {
        Part::Controls => which.include(*part) && !quantities.is_empty(),
        _ => true,
    };
    let parts = parts(entry).into_iter().filter(|(part, quantities)| shown(part, quantities));
    let known = parts.map(|(part, quantities)| {
        let title = match part {
            Part::Parameters => "parameters",
            Part::State => "state",
            Part::Controls => "controls",
        };
        format!("{title}: {}", quantities.iter().map(|q| q.name).collect::<Vec<_>>().join(", "))
    });
    format!("({})", known.collect::<Vec<_>>().join("; "))
}

fn numbers(name: &str, value: &str) -> Result<Vec<f64>, Error> {
    value
        .split(',')
        .map(|text| {
            let text = text.trim();
            text.parse::<f64>()
                .map_err(|_| Error::Input(format!("`{text}` is not a number (in `{name}={value}`)")))
        })
        .collect()
}

fn count(numbers: usize) -> String {
    if numbers == 1 { "one number".to_owned() } else { format!("{numbers} numbers separated by commas") }
}

/// The components of rotations, which are of length 1: in space and in the plane. Those of rigid motions begin with them.
const ROTATIONS: [(&[&str], &str); 2] = [(&["w", "x", "y", "z"], "1,0,0,0"), (&["re", "im"], "1,0")];
/// What follows them in rigid motions.
const TRANSLATIONS: [&[&str]; 3] = [&[], &["px", "py"], &["px", "py", "pz"]];

/// How many of a quantity's components are those of a rotation, with what is no rotation; none of a vector.
pub(crate) fn rotation(quantity: &Quantity) -> Option<(usize, &'static str)> {
    ROTATIONS.iter().find_map(|(names, unit)| {
        let rest = quantity.components.strip_prefix(*names)?;
        TRANSLATIONS.contains(&rest).then_some((names.len(), *unit))
    })
}

/// Brings unit quaternions and unit complex numbers to length 1.
fn normalize(entry: &Entry, setup: &mut Setup) -> Result<Vec<String>, Error> {
    let mut notes = Vec::new();
    for (quantity, slots) in laid_out(entry.description.state) {
        let Some((count, unit)) = rotation(quantity) else { continue };
        let components = &mut setup.state[slots.start..slots.start + count];
        // scaled by the largest component, so that no square overflows or vanishes
        let largest = components.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if largest == 0.0 {
            let rest = if count < quantity.components.len() { ",…" } else { "" };
            return Err(Error::Input(format!(
                "`{}` is a rotation and cannot be zero; no rotation is {unit}{rest}",
                quantity.name
            )));
        }
        let length = largest * components.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt();
        if (length - 1.0).abs() > 4.0 * f64::EPSILON {
            for component in components.iter_mut() {
                *component = *component / largest / (length / largest);
            }
            notes.push(format!("`{}` had length {length} and was normalised", quantity.name));
        }
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::catalogue;

    fn set(assignments: &[&str]) -> Result<(Setup, Vec<String>), String> {
        set_in("heavy_top", assignments)
    }

    fn set_in(system: &str, assignments: &[&str]) -> Result<(Setup, Vec<String>), String> {
        let entry = catalogue().find(system).expect("it is there");
        let mut setup = entry.example.clone();
        let assignments: Vec<String> = assignments.iter().map(|&a| a.to_owned()).collect();
        let notes = apply(entry, &mut setup, &assignments).and_then(|()| validate(entry, &mut setup));
        notes.map(|notes| (setup, notes)).map_err(|error| error.to_string())
    }

    #[test]
    fn quantities_components_and_scalars_are_set() {
        let (setup, notes) =
            set(&["inertia=2, 3,4", "chi_y=-0.5", "weight=1e1", "momentum=1,2,3", "gamma_x=7"])
                .expect("valid");
        assert_eq!(setup.parameters, [2.0, 3.0, 4.0, 10.0, 0.0, -0.5, 1.0]);
        assert_eq!(setup.state, [1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 7.0, 0.0, 1.0]);
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn an_attitude_is_normalised() {
        let (setup, notes) = set(&["attitude=0,3,0,4", "inertia=1,1,1"]).expect("valid");
        assert_eq!(setup.state[..4], [0.0, 0.6, 0.0, 0.8]);
        assert_eq!(notes, ["`attitude` had length 5 and was normalised"]);
        // also where squares would overflow or vanish
        for scale in ["1e200", "1e-200"] {
            let (setup, _) = set(&[&format!("attitude=0,0,0,{scale}")]).expect("valid");
            assert_eq!(setup.state[..4], [0.0, 0.0, 0.0, 1.0]);
        }
        assert!(set(&["attitude=0,0,0,0"]).expect_err("no rotation").contains("cannot be zero"));
    }

    #[test]
    fn rotations_in_the_plane_and_in_rigid_motions_are_normalised() {
        let (setup, notes) = set_in("planar_pendulum", &["angle=3,4"]).expect("valid");
        assert_eq!(setup.state, [0.6, 0.8, 0.0]);
        assert_eq!(notes, ["`angle` had length 5 and was normalised"]);
        let message = set_in("planar_pendulum", &["angle=0,0"]).expect_err("no rotation");
        assert!(message.contains("no rotation is 1,0"), "{message}");

        let (setup, notes) = set_in("rigid_body_in_space", &["pose=0,0,2,0,5,6,7"]).expect("valid");
        assert_eq!(setup.state[..7], [0.0, 0.0, 1.0, 0.0, 5.0, 6.0, 7.0]);
        assert_eq!(notes, ["`pose` had length 2 and was normalised"]);
        assert!(set_in("rigid_body_in_space", &["pose=0,0,0,0,1,2,3"]).is_err());
        // the first components of a momentum are none
        let (setup, notes) = set_in("kepler", &["momentum=1,2,3"]).expect("valid");
        assert_eq!((&setup.state[3..], notes.len()), (&[1.0, 2.0, 3.0][..], 0));
    }

    #[test]
    fn mistakes_are_explained() {
        for (assignment, expected) in [
            ("wieght=1", "did you mean `weight`?"),
            ("weight", "has no `=`"),
            ("chi=1,2", "takes 3 numbers separated by commas, got 2"),
            ("weight=1,2", "takes one number, got 2"),
            ("chi=1,two,3", "`two` is not a number"),
            ("chi=1,,3", "`` is not a number"),
            ("momentum=1,NaN,3", "must be finite, got `NaN`"),
            ("weight=inf", "must be finite"),
            ("inertia=1,-2,3", "not positive definite"),
        ] {
            let message = set(&[assignment]).expect_err(assignment);
            assert!(message.contains(expected), "{assignment}: {message}");
        }
    }

    #[test]
    fn an_inertia_that_no_body_has_is_noted() {
        let (_, notes) = set(&["inertia=1,10,100"]).expect("valid all the same");
        assert!(notes[0].contains("the largest exceeds the sum of the others"), "{notes:?}");
    }
}
