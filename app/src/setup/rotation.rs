//! Rotations among the quantities of a state: their numbers are of length 1.

use super::Setup;
use crate::catalogue::Entry;
use crate::catalogue::quantities::rotation;
use crate::error::SetupError;
use coadjoint::system::Quantity;

/// Brings unit quaternions and unit complex numbers to length 1; returns notes for the user.
///
/// # Errors
/// If a rotation is zero.
pub(super) fn normalize(entry: &Entry, setup: &mut Setup) -> Result<Vec<String>, SetupError> {
    let mut notes = Vec::new();
    for (quantity, slots) in Quantity::with_ranges(entry.description.state) {
        let Some((count, unit)) = rotation(quantity) else { continue };
        let components = &mut setup.state[slots.start..slots.start + count];
        // scaled by the largest component, so that no square overflows or vanishes
        let largest = components.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if largest == 0.0 {
            let rest = if count < quantity.components.len() { ",…" } else { "" };
            let name = quantity.name;
            let reason = format!("`{name}` is a rotation and cannot be zero; no rotation is {unit}{rest}");
            return Err(SetupError::new(reason));
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
