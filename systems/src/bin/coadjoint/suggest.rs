//! "Did you mean …?"

use coadjoint_systems::catalogue::{CATALOGUE, Entry, find};

use crate::error::Error;

/// The candidate closest to a misspelt `name`, if any is close.
pub(crate) fn closest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `; did you mean …?` to go at the end of a message, or nothing.
pub(crate) fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    closest(name, candidates).map_or_else(String::new, |candidate| format!("; did you mean `{candidate}`?"))
}

/// The system of this name.
///
/// # Errors
/// If there is none.
pub(crate) fn system(name: &str) -> Result<&'static Entry, Error> {
    find(name).ok_or_else(|| {
        let hint = did_you_mean(name, CATALOGUE.iter().map(|entry| entry.name));
        Error::Input(format!("there is no system `{name}`{hint} (`coadjoint list` shows all)"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_system_is_recognised() {
        assert_eq!(system("Heavy-Top").expect("it is there").name, "heavy_top");
        let message = system("heavy_tip").expect_err("there is none").to_string();
        assert!(message.contains("did you mean `heavy_top`?"), "{message}");
    }

    #[test]
    fn a_misspelling_finds_its_name_and_nonsense_none() {
        let names = ["inertia", "weight", "chi_x", "chi_y"];
        assert_eq!(closest("inerta", names), Some("inertia"));
        assert_eq!(closest("Wieght", names), Some("weight"));
        assert_eq!(closest("chix", names), Some("chi_x"));
        assert_eq!(closest("temperature", names), None);
        assert_eq!(did_you_mean("wait", names), "; did you mean `weight`?");
        assert_eq!(did_you_mean("zzz", names), "");
    }
}
