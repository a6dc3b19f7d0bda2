//! Short names of Casimirs.

use super::Entry;

/// So many letters have room in a table, and at the axis of a plot.
const ROOM: [usize; 2] = [40, 30];

/// The Casimirs with their units: those of many terms in symbols, and if these are too many as well, by their number in
/// `list`.
pub(crate) fn names(entry: &Entry) -> impl Iterator<Item = (String, &'static str)> {
    entry.casimirs().enumerate().map(|(k, (name, unit))| (numbered(whole(name), k, ROOM[0]), unit))
}

/// The Casimirs in symbols with their units; what is long by its number in `list`.
pub(crate) fn symbols_of(entry: &Entry) -> impl Iterator<Item = (String, &'static str)> {
    entry.casimirs().enumerate().map(|(k, (name, unit))| (numbered(symbols(name), k, ROOM[1]), unit))
}

/// The whole Casimirs as `list` shows them, with their units: with a number where that is their name elsewhere.
pub(crate) fn listed(entry: &Entry) -> impl Iterator<Item = (String, &'static str)> {
    entry.casimirs().enumerate().map(|(k, (name, unit))| {
        let whole = whole(name);
        (if fits(&symbols(name), ROOM[1]) { whole } else { format!("{}: {whole}", number(k)) }, unit)
    })
}

fn whole(name: &str) -> String {
    if fits(name, ROOM[0]) { name.to_owned() } else { symbols(name) }
}

fn fits(name: &str, room: usize) -> bool {
    name.chars().count() <= room
}

fn numbered(name: String, k: usize, room: usize) -> String {
    if fits(&name, room) { name } else { number(k) }
}

fn number(k: usize) -> String {
    format!("Casimir {}", k + 1)
}

/// Casimirs in the letters of the literature, which are also shorter.
pub(crate) fn symbols(name: &str) -> String {
    let name = name
        .replace("angular_momentum", "Π")
        .replace("linear_momentum", "P")
        .replace("attitude_momentum", "Π")
        .replace("rotor_momentum", "ℓ")
        .replace("momentum", "Π")
        .replace("gamma", "Γ")
        .replace("field", "B")
        .replace("impulse", "P");
    subscripts(&name).unwrap_or(name)
}

/// `Π₁₂` for `Π.r12`, where all components have one letter.
fn subscripts(name: &str) -> Option<String> {
    let mut parts = name.split('.');
    let mut written = parts.next()?.to_owned();
    let mut known = None;
    for part in parts {
        let letters = part.find(|letter: char| !letter.is_ascii_alphabetic())?;
        let (stem, rest) = part.split_at(letters);
        let end = rest.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(rest.len());
        if end == 0 || *known.get_or_insert(stem) != stem {
            return None;
        }
        let subscript = |digit: char| char::from_u32('₀' as u32 + digit.to_digit(10)?);
        written.extend(rest[..end].chars().filter_map(subscript));
        written += &rest[end..];
    }
    Some(written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_subscripts_where_they_have_one_letter() {
        assert_eq!(symbols("momentum.r12 momentum.r34 − momentum.r13²"), "Π₁₂ Π₃₄ − Π₁₃²");
        assert_eq!(symbols("momentum.h1² + momentum.e12"), "Π.h1² + Π.e12");
        assert_eq!(symbols("momentum·gamma"), "Π·Γ");
        assert_eq!(symbols("momentum.x momentum.y"), "Π.x Π.y");
    }
}
