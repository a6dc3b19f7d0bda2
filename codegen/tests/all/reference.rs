//! The page of the guide that lists the language is the one that the tables make.
//!
//! After a change of the language, `UPDATE_REFERENCE=1 cargo test -p coadjoint-codegen` writes it anew.

use coadjoint_codegen::language::reference;
use coadjoint_codegen::parse::KEYS;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../runtime/src/guide/language.md");

#[test]
fn the_page_is_up_to_date() {
    if std::env::var_os("UPDATE_REFERENCE").is_some() {
        std::fs::write(PAGE, reference()).expect("the guide is beside the generator");
    }
    let written = std::fs::read_to_string(PAGE).expect("the guide is beside the generator");
    for (ours, theirs) in reference().lines().zip(written.lines()) {
        assert_eq!(ours, theirs, "write the page anew: UPDATE_REFERENCE=1 cargo test -p coadjoint-codegen");
    }
    assert_eq!(reference().lines().count(), written.lines().count());
}

/// The documentation of the attribute is written by hand: it names every key.
#[test]
fn the_attribute_documents_every_key() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../macros/src/lib.rs");
    let documentation = std::fs::read_to_string(path).expect("the attribute is beside the generator");
    for key in KEYS {
        let written = |then: &str| documentation.contains(&format!("/// | `{}{then}", key.name));
        assert!([" = ", "(", "`"].into_iter().any(written), "{} is missing", key.name);
    }
}
