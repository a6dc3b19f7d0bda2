//! `--set name=value`: parameters, the initial state and controls, by the names of their quantities or single
//! components.

use std::sync::Arc;

use coadjoint::system::{Quantity, Role};

use super::form::{RotationForm, others, stored};
use super::names::{Name, Names, Part, count, named, numbers, velocity};
use super::rotation::normalize;
use super::transport::moved;
use super::{Setup, check};
use crate::catalogue::quantities::{Component, components};
use crate::catalogue::{Entry, Input};
use crate::error::{RunError, SetupError};
use crate::units::listed;

/// A system's example with some of its numbers changed.
#[derive(Clone, Debug)]
pub(crate) struct Changes<'e> {
    pub(crate) entry: &'e Entry,
    setup: Setup,
    /// The parameters that were given.
    given_parameters: Vec<bool>,
    /// The numbers of the state that were given.
    given: Vec<bool>,
    /// Velocities that were given, in the places of their momenta.
    velocities: Vec<Option<f64>>,
}

impl<'e> Changes<'e> {
    /// None yet.
    pub(crate) fn of(entry: &'e Entry) -> Self {
        let setup = entry.example.clone();
        let (given, velocities) = (vec![false; setup.state.len()], vec![None; setup.state.len()]);
        let given_parameters = vec![false; setup.parameters.len()];
        Self { entry, setup, given_parameters, given, velocities }
    }

    /// Makes assignments one after the other.
    ///
    /// # Errors
    /// If a name is unknown, or a value has another number of components than its quantity.
    pub(crate) fn apply(&mut self, assignments: &[String]) -> Result<(), SetupError> {
        for assignment in assignments {
            let (name, value) = assignment.split_once('=').ok_or_else(|| {
                let example = self.entry.description.state.first().map_or("name", |quantity| quantity.name);
                let reason =
                    format!("`--set {assignment}` has no `=`; write for example `--set {example}=…`");
                SetupError::new(reason)
            })?;
            let (name, value) = (name.trim(), value.trim());
            let (form, value) = match value.split_once(':') {
                Some((form, value)) => (Some(RotationForm::named(form)?), value),
                None => (None, value),
            };
            let is_angle = ["deg", "°", "rad"].iter().any(|unit| value.contains(unit));
            let numbers = numbers(assignment, value).map_err(|error| match is_angle {
                true => SetupError::new(format!("{error}: angles are numbers, in rad")),
                false => error,
            })?;
            self.assign_form(Names::ALL, name, form, &numbers)?;
        }
        Ok(())
    }

    /// Sets a quantity or one of its components.
    ///
    /// # Errors
    /// If there is none of this name, its number of components is another one, or a number is not finite.
    pub(crate) fn assign(&mut self, which: Names, name: &str, numbers: &[f64]) -> Result<(), SetupError> {
        self.assign_form(which, name, None, numbers)
    }

    /// Sets a quantity or one of its components; a rotation in a form of its own.
    ///
    /// # Errors
    /// As [`assign`](Self::assign), or if it is no rotation in space.
    pub(super) fn assign_form(
        &mut self,
        which: Names,
        name: &str,
        form: Option<RotationForm>,
        numbers: &[f64],
    ) -> Result<(), SetupError> {
        let target = match named(self.entry, which, name) {
            Err(_) if form.is_none() && array(self.entry, which, name).next().is_some() => {
                return self.assign_array(which, name, numbers);
            }
            target => target?,
        };
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(SetupError::new(format!("`{name}` must be finite, got `{number}`")));
        }
        let (slots, is_whole) = (target.slots.clone(), target.is_whole());
        let stored = match is_whole {
            true => stored(target.quantity, form, numbers),
            false => (form.is_none() && numbers.len() == slots.len()).then(|| numbers.to_vec()),
        };
        let Some(numbers) = stored else {
            let others = if is_whole { others(target.quantity) } else { String::new() };
            let got = count(numbers.len());
            return Err(SetupError::new(match form {
                Some(_) if !others.contains("euler") => format!("`{name}` is no rotation in space"),
                Some(form) => {
                    format!("`{name}={}:…` takes {}, got {got}", form.name(), count(slots.len() - 1))
                }
                None => format!("`{name}` takes {}, got {got}{others}", count(slots.len())),
            }));
        };
        match target.part {
            Part::Parameters => {
                self.given_parameters[slots.clone()].fill(true);
                self.setup.parameters[slots].copy_from_slice(&numbers);
            }
            Part::State => {
                self.given[slots.clone()].fill(true);
                self.setup.state[slots].copy_from_slice(&numbers);
            }
            Part::Velocities => {
                let velocities = self.velocities[slots].iter_mut();
                velocities.zip(numbers).for_each(|(velocity, number)| *velocity = Some(number));
            }
            Part::Controls => {
                let controls = self.setup.controls[slots].iter_mut();
                controls.zip(numbers).for_each(|(control, number)| *control = Some(number));
            }
        }
        Ok(())
    }

    /// Sets all elements of an array, one after the other.
    fn assign_array(&mut self, which: Names, name: &str, numbers: &[f64]) -> Result<(), SetupError> {
        let length = array(self.entry, which, name).map(|element| element.slots.len()).sum();
        if numbers.len() != length {
            let (takes, got) = (count(length), count(numbers.len()));
            return Err(SetupError::new(format!(
                "`{name}` takes {takes}, got {got}; its elements are `{name}_0`, …"
            )));
        }
        let mut rest = numbers;
        for element in array(self.entry, which, name) {
            let (own, others) = rest.split_at(element.slots.len());
            self.assign(which, &element.name, own)?;
            rest = others;
        }
        Ok(())
    }

    /// Says what has to be given where there is no example, and was not.
    fn missing(&self) -> Option<SetupError> {
        if self.entry.has_example {
            return None;
        }
        let description = &self.entry.description;
        let parameters =
            Quantity::with_ranges(description.parameters).zip(std::iter::repeat(&self.given_parameters));
        let state = Quantity::with_ranges(description.state).zip(std::iter::repeat(&self.given));
        let advected = state.filter(|((quantity, _), _)| quantity.role == Role::Advected);
        let missing = parameters
            .chain(advected)
            .filter(|((_, slots), given)| given[slots.clone()].contains(&false))
            .map(|((quantity, _), _)| {
                let numbers = vec!["…"; quantity.components.len()].join(",");
                format!("`--set {}={numbers}`", quantity.name)
            });
        let missing: Vec<String> = missing.collect();
        let name = &self.entry.name;
        (!missing.is_empty())
            .then(|| SetupError::new(format!("`{name}` has no example: give {}", missing.join(", "))))
    }

    /// Drives controls by a table.
    pub(crate) fn drive(&mut self, input: Input) {
        self.setup.input = Some(Arc::new(input));
    }

    /// Shows the setup so far, as it was given.
    #[cfg(test)]
    pub(crate) fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The setup that comes of it, and notes for the user: rotations are normalised, what is advected turns with
    /// configurations that were given, unless it was given too.
    ///
    /// # Errors
    /// If a rotation is zero, a control is held that a table drives, no stepper can be built with the parameters, or the energy of the
    /// state is no number.
    pub(crate) fn finish(self) -> Result<(Setup, Vec<String>), RunError> {
        self.missing().map_or(Ok(()), Err)?;
        let Self { entry, mut setup, given, velocities, .. } = self;
        let mut notes = normalize(entry, &mut setup)?;
        notes.extend(check(entry, &setup)?);
        notes.extend(undriven(entry, &setup)?);
        notes.extend(turn_along(entry, &mut setup, &given));
        move_at(entry, &mut setup, &given, &velocities)?;
        if entry.has_example {
            notes.extend(other_casimirs(entry, &setup));
        }
        let law = entry.law(&setup);
        let energy = entry.energy(&*entry.system(&setup.parameters), law.as_ref(), (&setup.state, 0.0));
        if !energy.is_finite() {
            return Err(SetupError::new(format!(
                "the energy of the initial state is {energy}: no motion of `{}` starts there",
                entry.name
            ))
            .into());
        }
        Ok((setup, notes))
    }
}

/// Lists the elements of an array of this name.
fn array(entry: &Entry, which: Names, name: &str) -> impl Iterator<Item = Name> {
    (0..).map_while(move |k| named(entry, which, &format!("{name}_{k}")).ok())
}

/// Checks that no control is held that a table drives; notes those that neither is said of.
fn undriven(entry: &Entry, setup: &Setup) -> Result<Option<String>, SetupError> {
    let Some(input) = &setup.input else { return Ok(None) };
    let file = input.file.display();
    let mut zero = Vec::new();
    for (control, held) in components(entry.description.controls).zip(&setup.controls) {
        match (input.drives(control.slot), held) {
            (true, Some(_)) => return Err(driven(&control.name, input)),
            (false, None) => zero.push(control.name),
            _ => {}
        }
    }
    Ok((!zero.is_empty()).then(|| {
        let names = zero.join("`, `");
        format!("{file} has no column for `{names}`: each is 0 unless `--set` holds it")
    }))
}

/// Says that a control is a column of a table.
pub(super) fn driven(control: &str, input: &Input) -> SetupError {
    let file = input.file.display();
    SetupError::new(format!(
        "`{control}` is a column of {file}, and cannot be set too: leave out one of them"
    ))
}

/// Sets momenta to those of the velocities that were given; the others keep theirs.
fn move_at(
    entry: &Entry,
    setup: &mut Setup,
    given: &[bool],
    velocities: &[Option<f64>],
) -> Result<(), SetupError> {
    if velocities.iter().all(Option::is_none) {
        return Ok(());
    }
    let momenta = || {
        let all = Quantity::with_ranges(entry.description.state);
        all.filter(|(quantity, _)| quantity.role == Role::Momentum)
    };
    if let Some((momentum, _)) = momenta().find(|(_, slots)| given[slots.clone()].contains(&true)) {
        let (momentum, other) = (momentum.name, velocity(momentum.name));
        let reason = format!("`{momentum}` and a velocity are given: give `{other}`, or momenta alone");
        return Err(SetupError::new(reason));
    }
    let system = entry.system(&setup.parameters);
    let control = entry.law(setup).map(|law| entry.chosen(&law, (&setup.state, 0.0))).unwrap_or_default();
    let usual = system.differential(&setup.state, 0.0, &control);
    for (quantity, slots) in momenta() {
        for (slot, usual) in slots.zip(&usual[quantity.tangent()]) {
            setup.state[slot] = velocities[slot].unwrap_or(*usual);
        }
    }
    let moving = system.with_velocity(&setup.state, 0.0, &control);
    setup.state = moving.map_err(|error| SetupError::new(error.to_string()))?;
    Ok(())
}

/// Turns what is advected and was not given along with configurations that were.
fn turn_along(entry: &Entry, setup: &mut Setup, given: &[bool]) -> Vec<String> {
    let mut notes = Vec::new();
    let quantities = || Quantity::with_ranges(entry.description.state);
    let is_given = |slots: &std::ops::Range<usize>| given[slots.clone()].contains(&true);
    let turned: Vec<&str> = quantities()
        .filter(|(quantity, slots)| {
            let is_other = setup.state[slots.clone()] != entry.example.state[slots.clone()];
            quantity.role == Role::Configuration && is_given(slots) && is_other
        })
        .map(|(quantity, _)| quantity.name)
        .collect();
    let left: Vec<_> = quantities()
        .filter(|(quantity, slots)| quantity.role == Role::Advected && !is_given(slots))
        .collect();
    if turned.is_empty() || left.is_empty() {
        return notes;
    }
    let system = entry.system(&setup.parameters);
    let there = moved(&*system, &entry.example.state, &setup.state);
    let with = turned.join("`, `");
    for (quantity, slots) in left {
        let name = quantity.name;
        match &there {
            None => notes.push(format!(
                "`{name}` stays {}, seen from `{with}`: set it too if it is fixed in space",
                listed(&setup.state[slots])
            )),
            Some(there) if there[slots.clone()] != setup.state[slots.clone()] => {
                setup.state[slots.clone()].copy_from_slice(&there[slots.clone()]);
                notes.push(format!(
                    "`{name}` is fixed in space and turns with `{with}`: it is {}",
                    listed(&there[slots])
                ));
            }
            Some(_) => {}
        }
    }
    notes
}

/// Notes Casimirs of advected parameters alone that have other values than in the example.
fn other_casimirs(entry: &Entry, setup: &Setup) -> Vec<String> {
    let system = entry.system(&setup.parameters);
    let values = |state: &[f64]| system.casimirs(state);
    let mut other_momentum = setup.state.clone();
    for (quantity, slots) in Quantity::with_ranges(entry.description.state) {
        if quantity.role == Role::Momentum {
            other_momentum[slots].iter_mut().enumerate().for_each(|(i, x)| *x += 1.0 + 0.25 * i as f64);
        }
    }
    let (now, moving, usual) = (values(&setup.state), values(&other_momentum), values(&entry.example.state));
    let cases = entry.casimirs().zip(now).zip(moving).zip(usual);
    cases
        .filter(|(((_, now), moving), usual)| now == moving && (now - usual).abs() > 1e-9 * usual.abs())
        .map(|((((name, unit), now), _), usual)| {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!("`{name}` is {}{unit}, in the example {}{unit}", listed(&[now]), listed(&[usual]))
        })
        .collect()
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
        let all = Quantity::with_ranges(quantities);
        assignments
            .extend(all.map(|(quantity, slots)| format!("{}={}", quantity.name, numbers(&values[slots]))));
    }
    let held = |(control, held): (Component, &Option<f64>)| Some(format!("{}={:?}", control.name, (*held)?));
    assignments.extend(components(description.controls).zip(&setup.controls).filter_map(held));
    assignments
}
