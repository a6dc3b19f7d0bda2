//! Columns of a table beside the numbers of the state.

use clap::ValueEnum as _;
use coadjoint::erased;
use coadjoint::system::{Quantity, Role};
use serde::{Deserialize, Serialize};

use super::form::RotationForm;
use super::names::velocity;
use crate::catalogue::Entry;
use crate::catalogue::quantities::{component_name, rotation};
use crate::error::SetupError;

/// Further columns of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Column {
    /// Velocities, in the axes of their momenta: of a body its angular velocity, rad/s.
    Velocity,
    /// Attitudes as roll, pitch and yaw, rad: turns about x, y and z of space, in this order.
    Euler,
    /// Attitudes as the axis times the angle, rad.
    Rotvec,
    /// Attitudes as modified Rodrigues parameters.
    Mrp,
    /// Rotations in the plane as an angle between −π and π, rad.
    Angle,
}

impl Column {
    /// Its name on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn form(self) -> Option<(RotationForm, [&'static str; 3])> {
        Some(match self {
            Self::Euler => (RotationForm::Euler, ["roll", "pitch", "yaw"]),
            Self::Rotvec => (RotationForm::Rotvec, ["rotvec_x", "rotvec_y", "rotvec_z"]),
            Self::Mrp => (RotationForm::Mrp, ["mrp_x", "mrp_y", "mrp_z"]),
            Self::Velocity | Self::Angle => return None,
        })
    }

    /// Lists the quantities of the state that it shows, with their places.
    fn quantities(self, entry: &Entry) -> impl Iterator<Item = (&'static Quantity, usize)> {
        let is_shown = move |quantity: &Quantity| match self {
            Self::Velocity => quantity.role == Role::Momentum,
            Self::Angle => matches!(rotation(quantity), Some((2, _))),
            _ => matches!(rotation(quantity), Some((4, _))),
        };
        let all = Quantity::with_ranges(entry.description.state);
        all.filter(move |(quantity, _)| is_shown(quantity)).map(|(quantity, slots)| (quantity, slots.start))
    }

    /// Names its columns.
    ///
    /// # Errors
    /// If the system has none such.
    pub(crate) fn names(self, entry: &Entry) -> Result<Vec<String>, SetupError> {
        let names = |(quantity, _): (&Quantity, usize)| -> Vec<String> {
            let of = |part: &str| format!("{}_{part}", quantity.name);
            match self.form() {
                Some((_, parts)) => parts.map(of).to_vec(),
                None if self == Self::Angle => vec![of("rad")],
                None => quantity.components.iter().map(|c| velocity(&component_name(quantity, c))).collect(),
            }
        };
        let names: Vec<String> = self.quantities(entry).flat_map(names).collect();
        if names.is_empty() {
            let what = if self == Self::Angle { "rotation in the plane" } else { "rotation in space" };
            return Err(SetupError::new(format!(
                "`--columns {}`: `{}` has no {what}",
                self.name(),
                entry.name
            )));
        }
        Ok(names)
    }

    /// Adds its numbers at a time and with a control.
    pub(crate) fn push(
        self,
        (entry, system): (&Entry, &dyn erased::System),
        (state, time, control): (&[f64], f64, &[f64]),
        row: &mut Vec<f64>,
    ) {
        let rates =
            if self == Self::Velocity { system.differential(state, time, control) } else { Vec::new() };
        for (quantity, start) in self.quantities(entry) {
            match self.form() {
                Some((form, _)) => row.extend(form.write(&state[start..start + 4])),
                None if self == Self::Angle => row.push(state[start + 1].atan2(state[start])),
                None => row.extend(&rates[quantity.tangent()]),
            }
        }
    }
}
