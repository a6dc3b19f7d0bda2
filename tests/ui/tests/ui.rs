//! What the compiler tells a user: descriptions that must fail, with their messages. What must pass is in `ok/`, each a test of its own.
//!
//! After a deliberate change, `TRYBUILD=overwrite cargo test -p coadjoint-ui` writes the messages anew; read
//! them as a user would before committing them.

#[test]
fn messages() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("fail/*.rs");
}
