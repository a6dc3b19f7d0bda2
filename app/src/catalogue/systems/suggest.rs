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

/// `; did you mean …?` to go at the end of a message, or nothing.
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    closest(name, candidates).map_or_else(String::new, |candidate| format!("; did you mean `{candidate}`?"))
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
    }
}
