//! Units: of parameters on their fields, of state and controls under a key.

use super::breaks;
use crate::common::{compare, tokens, told};
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::parse::{Attribute, Item};

const BODY: &str = "struct Body { #[inertia] #[unit(\"kg m²\")] inertia: Vector3<f64>, weight: f64 }";

#[test]
fn units_are_kept_as_they_are_written() {
    let attribute = "group(attitude: SO3, spins: [SO2; 2]), control(moment: R3), force(attitude = moment), \
                     units(attitude_momentum = \"N m s\", spins_momentum = \"N m s\", moment = \" N m \")";
    let item = "struct Body { #[inertia(attitude)] #[unit(\"kg m²\")] inertia: Vector3<f64>, \
                #[unit(\"kg m²\")] #[inertia(spins)] wheels: [f64; 2] }";
    let program = coadjoint_codegen::program(tokens(attribute), tokens(item)).expect("no problems");
    let units = |quantities: &[coadjoint_codegen::program::Quantity]| {
        quantities.iter().map(|quantity| quantity.unit.clone().unwrap_or_default()).collect::<Vec<_>>()
    };
    assert_eq!(units(&program.interface.parameters), ["kg m²"; 3]);
    assert_eq!(units(&program.interface.state), ["", "N m s", "", "N m s", "", "N m s"]);
    assert_eq!(units(&program.interface.controls), ["N m"]);
}

#[test]
fn units_of_what_is_not_there_are_problems() {
    let rest = "group = SO3, advected(gamma: R3), potential = weight * gamma.z";
    breaks(&format!("{rest}, units(momentum = \"N m s\", gamma = \"1\")"), BODY, &[]);
    breaks(
        &format!("{rest}, units(momentun = \"N m s\", weight = \"N\", time = \"s\")"),
        BODY,
        &[
            ("momentun", "neither the state nor the controls have `momentun`; did you mean `momentum`?$"),
            ("weight", "the unit of a parameter stands on its field: `#[unit(\"N\")]`$"),
            ("time", "neither the state nor the controls have `time`"),
        ],
    );
}

#[test]
fn as_many_units_as_do_not_fit_are_problems() {
    let rest = "group = SE3, control(push: R3)";
    let body = "struct Body { #[inertia] inertia: Vector6<f64>, #[unit(\"m, s\")] lever: Vector3<f64> }";
    breaks(
        &format!(
            "{rest}, force = (push.cross(&lever), push), \
             units(pose = \"1, 1, 1, 1, m, m, m\", momentum = \"N m s, N m, m, s\", push = \"N, N, N, N\")"
        ),
        body,
        &[
            ("lever", "`lever` has 3 components, and here are 2 units: give one, or one for each$"),
            ("push", "`push` has 3 components, and here are 4 units"),
            ("momentum", "`momentum` has 6 components, and here are 4 units"),
        ],
    );
}

#[test]
fn units_that_cannot_be_read_are_problems() {
    let mut diagnostics = Diagnostics::new();
    let attribute = "units(momentum: \"N\", gamma = 1, attitude = \" \", momentum = \"a\", momentum = \"b\")";
    Attribute::parse(tokens(attribute), &coadjoint_codegen::method::known(), &mut diagnostics);
    let expected = "expected a name, `=` and a unit in quotes; write `units(momentum = \"N m s\")`$";
    let twice = ("momentum", "`momentum` is named twice in `units`$");
    compare(attribute, &told(diagnostics), &[(":", expected), ("1", expected), ("\" \"", expected), twice]);

    let mut diagnostics = Diagnostics::new();
    let item = "struct Body { #[unit] a: f64, #[unit(3)] b: f64, #[unit(\"\")] c: f64, #[unit(\"m\")] #[unit(\"s\")] d: f64 }";
    let declaration = Item::parse(tokens(item), &mut diagnostics).expect("a struct").declaration;
    assert!(declaration.fields.iter().all(|field| field.attrs.is_empty()));
    let expected = "a unit is written as a text: `#[unit(\"kg m²\")]`$";
    compare(
        item,
        &told(diagnostics),
        &[
            ("#[unit]", expected),
            ("#[unit(3)]", expected),
            ("#[unit(\"\")]", expected),
            ("#[unit(\"s\")]", "`#[unit]` is given twice; once is enough$"),
        ],
    );
}
