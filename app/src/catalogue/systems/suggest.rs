//! "Did you mean …?"

/// The candidate closest to a misspelt `name`, if any is close.
pub fn closest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Nothing that is longer is a misspelling.
    const LONGEST: usize = 200;

    if name.len() > LONGEST {
        return None;
    }
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `; did you mean …?` to go at the end of a message, or nothing: names that end in this one, or else the closest.
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<&str> = candidates.into_iter().collect();
    let is_longer = |known: &&str| known.strip_suffix(name).is_some_and(|before| before.ends_with('_'));
    let mut meant: Vec<&str> = all.iter().copied().filter(is_longer).take(4).collect();
    if meant.is_empty() {
        meant.extend(closest(name, all));
    }
    if meant.is_empty() { String::new() } else { format!("; did you mean `{}`?", meant.join("` or `")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelling_finds_its_name_and_nonsense_none() {
        let names = ["inertia", "weight", "chi_x", "chi_y"];
        assert_eq!(closest("inerta", names), Some("inertia"));
        assert_eq!(closest("Wieght", names), Some("weight"));
        assert_eq!(closest("chix", names), Some("chi_x"));
        assert_eq!(closest("temperature", names), None);
        assert_eq!(closest(&"inertia".repeat(100_000), names), None);
        assert_eq!(did_you_mean("wait", names), "; did you mean `weight`?");
        assert_eq!(did_you_mean("zzz", names), "");
        assert_eq!(did_you_mean("y", ["chi_x", "chi_y", "psi_y"]), "; did you mean `chi_y` or `psi_y`?");
    }
}
