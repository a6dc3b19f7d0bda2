//! Rotations among the quantities of a state: their numbers are of length 1.

use coadjoint::system::Quantity;

use super::names::laid_out;
use crate::entry::Entry;
use crate::error::Error;
use crate::simulation::Setup;

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

/// Brings unit quaternions and unit complex numbers to length 1; returns notes for the user.
///
/// # Errors
/// If a rotation is zero.
pub(super) fn normalize(entry: &Entry, setup: &mut Setup) -> Result<Vec<String>, Error> {
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
