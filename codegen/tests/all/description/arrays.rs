//! Arrays of factors, parameters, controls and advected parameters.

use coadjoint_codegen::expr::Arena;

use super::{attribute, breaks, expands, item};
use crate::common::system;

const CHAIN: &str = "struct Chain { #[inertia] inertia: Vector3<f64>, k: f64 }";

#[test]
fn arrays_of_factors() {
    for sound in ["group(spins: [SO3; 4])", "group(spins: [SO3; 1])", "group(spins: [SO3; 21],)"] {
        breaks(sound, CHAIN, &[]);
    }
    breaks(
        "group(base: SE3, wheels: [SO2; 3])",
        "struct Craft { #[inertia] inertia: SMatrix<f64, 9, 9> }",
        &[],
    );
    breaks("group(a: [SL(2); 2], b: [SE2(3); 2])", "struct Pairs { #[inertia] j: f64 }", &[]);
    breaks("group(a: [matrices { x: [0, 1; -1, 0] }; 3])", "struct Turns { #[inertia] j: f64 }", &[]);
    breaks(
        "group(hulls: [SE3; 2]), hamiltonian = hulls_angular_momentum[1].x * j",
        "struct H { j: f64 }",
        &[],
    );
}

#[test]
fn lengths() {
    let length = "the length of an array is a number from 1 to 32";
    for bad in ["0", "33", "4294967295", "99999999999999999999", "N", "-1", "2.0", "1 + 1"] {
        attribute(&format!("group(spins: [SO3; {bad}])"), &[(bad, length)]);
        attribute(&format!("group = SO3, control(u: [f64; {bad}])"), &[(bad, length)]);
        item(&format!("struct S {{ #[inertia] j: f64, k: [f64; {bad}] }}"), &[(bad, length)]);
    }
    breaks("group(spins: [SO3; 32]), hamiltonian = a * spins_momentum[31].x", "struct Chain { a: f64 }", &[]);
    let bound = "the factors of a system may have dimension 96 together; up to here they have ";
    breaks("group(spins: [SE3; 17])", CHAIN, &[("spins", &format!("{bound}102"))]);
    breaks("group(a: [SO3; 16], spins: [SO3; 17])", CHAIN, &[("spins", &format!("{bound}99"))]);
    let pivots = "`j` is an array, one inertia for each of 3 factors, but there is one factor; its principal moments are a vector \
                  of 3";
    breaks("group = SO3", "struct S { #[inertia] j: [f64; 3] }", &[("[f64; 3]", pivots)]);
    let wide = "struct S { #[inertia] j: f64, k: [SMatrix<f64, 20, 20>; 26] }";
    expands("group = SO3", wide, &[("k", "fields and controls may have 10000 numbers together at most")]);
    let control = "group = R1, control(u: [SMatrix<f64, 20, 20>; 26])";
    expands(
        control,
        "struct S { #[inertia] j: f64 }",
        &[("u", "fields and controls may have 10000 numbers")],
    );
}

#[test]
fn how_arrays_are_written() {
    let written = "an array of factors is written `spins: [SO3; 4]`";
    attribute("group(spins: [SO3])", &[("]", &format!("expected `;`: {written}"))]);
    attribute("group(spins: [SO3, SO3])", &[(",", &format!("expected `;`: {written}"))]);
    attribute("group(spins: [SO3; 2; 3])", &[(";", written)]);
    attribute("group(spins: [])", &[("]", "expected a group; a factor is written `spins: [SO3; 4]`")]);
    attribute("group(spins: [[SO3; 2]; 2])", &[("[", "expected a group; a factor is written")]);
    attribute(
        "group = [SO3; 4]",
        &[("group", "an array of factors has a name; write `group(spins: [SO3; 4])`")],
    );
    attribute("group(spins: [SO5x; 4])", &[]);
    breaks("group(spins: [SO33; 4])", CHAIN, &[("SO33", "there is no group `SO33`")]);
    for nested in ["[[f64; 2]; 2]", "[[Vector3<f64>; 2]; 2]", "[String; 2]"] {
        let body = format!("struct S {{ #[inertia] j: f64, k: {nested} }}");
        item(
            &body,
            &[(nested, "`k` cannot be of this type; a parameter is `f64`, `f32`, or a vector or matrix")],
        );
        attribute(
            &format!("group = R1, control(u: {nested})"),
            &[(nested, "`u` cannot be of this type; a control is")],
        );
    }
    item(
        "struct S { #[inertia] j: f64, k: [f32; 2] }",
        &[("[f32; 2]", "this is made of `f32`, but `j` of `f64`")],
    );
    attribute("group = R1, control(u: [R3; 2], v: [Vector3<f64>; 2], w: [f64; 4])", &[]);
    breaks(
        "group = R1, control(u: [f32; 2]), force = u[0]",
        "struct S { #[inertia] j: f64 }",
        &[("f32", "this is made of `f32`, but the system of `f64`")],
    );
}

#[test]
fn elements_are_named_by_their_numbers() {
    let number = "one of an array of factors is named by its number, `spins[0]`";
    for bad in ["x", "-1", "0.5", "99999999999999999999"] {
        attribute(&format!("group(spins: [SO3; 2]), force(spins[{bad}] = k)"), &[(bad, number)]);
    }
    attribute("group(spins: [SO3; 2]), force(spins[] = k)", &[("]", number)]);
    attribute("group(spins: [SO3; 2]), force(spins[0, 1] = k)", &[(",", number)]);
    let beyond = "`spins` has 2 factors, 0 to 1";
    let array = "group(spins: [SO3; 2], one: SO3), hamiltonian = k";
    let body = "struct S { k: f64, v: Vector3<f64> }";
    breaks(&format!("{array}, force(spins[2] = k * v)"), body, &[("2", beyond)]);
    breaks(
        &format!("{array}, force(one[0] = k * v)"),
        body,
        &[("0", "`one` is one factor, not an array of them")],
    );
    breaks(
        &format!("{array}, force(spin[0] = k * v)"),
        body,
        &[("spin", "there is no factor `spin` to act on; did you mean `spins`?")],
    );
    breaks(&format!("{array} * gamma.x, advected(gamma: spins[2]::R3)"), body, &[("2", beyond)]);
    breaks(
        "group(spins: [SO3; 2])",
        "struct S { #[inertia(spins[0])] i: f64, #[inertia(spins[2])] j: f64 }",
        &[("2", beyond), ("S", "`spins[1]` has no inertia; mark one field with `#[inertia(spins[1])]`")],
    );
}

#[test]
fn inertias() {
    let array = "group(spins: [SO3; 3], one: R3)";
    for sound in [
        "#[inertia] j: f64",
        "#[inertia(spins)] i: [Vector3<f64>; 3], #[inertia(one)] j: f64",
        "#[inertia(spins)] i: [f64; 3], #[inertia(one)] j: f64",
        "#[inertia(spins)] i: [Matrix3<f64>; 3], #[inertia(one)] j: Vector3<f64>",
        "#[inertia(spins)] i: Vector3<f64>, #[inertia(one)] j: f64",
        "#[inertia(spins)] i: SMatrix<f64, 9, 9>, #[inertia(one)] j: f64",
        "#[inertia] i: [Vector3<f64>; 4]",
        "#[inertia(spins[0], one)] i: [Vector3<f64>; 2], #[inertia(spins[2], spins[1])] j: Vector3<f64>",
    ] {
        breaks(array, &format!("struct S {{ {sound} }}"), &[]);
    }
    breaks(
        array,
        "struct S { #[inertia(spins)] i: [Vector3<f64>; 4], #[inertia(one)] j: f64 }",
        &[("[Vector3<f64>; 4]", "`i` is an array of 4, but it is the inertia of 3 factors, one of each")],
    );
    breaks(
        array,
        "struct S { #[inertia(spins)] i: [Vector4<f64>; 3], #[inertia(one)] j: f64 }",
        &[(
            "[Vector4<f64>; 3]",
            "`SO3` has dimension 3, so its inertia is a vector of 3 (principal moments), a 3×3 matrix or a scalar",
        )],
    );
    breaks(
        array,
        "struct S { #[inertia(one)] j: f64 }",
        &[("S", "`spins` has no inertia; mark one field with `#[inertia(spins)]`")],
    );
    breaks(
        array,
        "struct S { #[inertia(one)] j: f64, #[inertia(spins[0], spins[2])] k: f64 }",
        &[("S", "`spins[1]` has no inertia")],
    );
    breaks(
        array,
        "struct S { #[inertia] j: f64, #[inertia(spins)] k: f64 }",
        &[("inertia", "`spins` has several inertias, `j` and `k`")],
    );
    breaks(
        array,
        "struct S { #[inertia] j: f64, #[inertia(spins[1])] k: f64 }",
        &[("inertia", "`spins[1]` has several inertias, `j` and `k`")],
    );
    breaks(
        array,
        "struct S { #[inertia(spins, spins[1])] j: f64, #[inertia(one)] k: f64 }",
        &[("spins[1]", "`spins[1]` is named twice; keep one of them")],
    );
    breaks(
        "group(spins: [SO3; 3]), hamiltonian = i[0].m11",
        "struct S { #[inertia] i: [Matrix2x3<f64>; 2] }",
        &[("[Matrix2x3<f64>; 2]", "an inertia is a scalar, a vector or a square matrix")],
    );
}

#[test]
fn forces() {
    let array = "group(spins: [SO3; 2], wheels: [SO2; 3]), hamiltonian = k";
    let body = "struct S { k: f64, v: Vector3<f64>, w: [f64; 3] }";
    for sound in [
        "force(spins[0] = k * v)",
        "force(spins[0] = k * v, spins[1] = -v)",
        "force(spins = [v, k * v], wheels = w)",
        "force(wheels = wheels_velocity.map(|w| -k * w.x))",
        "force(spins = spins_momentum.map(|m| -k * m))",
        "control(u: [f64; 3], m: [R3; 2]), force(wheels = u, spins = m)",
    ] {
        breaks(&format!("{array}, {sound}"), body, &[]);
    }
    let each = "these forces must be an array of 3, one for each factor, each a scalar or a vector of 1, but this is";
    for (bad, found) in [
        ("k", "a scalar"),
        ("[k, k]", "an array of 2"),
        ("[v, v, v]", "an array of 3"),
        ("w.iter()", "an iterator"),
    ] {
        breaks(&format!("{array}, force(wheels = {bad})"), body, &[(bad, &format!("{each} {found}"))]);
    }
    let again = "a force acts on this already; add one to the other";
    breaks(&format!("{array}, force(spins[0] = v, spins = [v, v])"), body, &[("spins", again)]);
    breaks(&format!("{array}, force(spins = [v, v], spins[1] = v)"), body, &[("spins[1]", again)]);
    attribute("force(spins[1] = v, spins[1] = v)", &[("spins[1]", "`spins[1]` is named twice in `force`")]);
    breaks(
        &format!("{array}, force = v"),
        body,
        &[("v", "on what does this force act? Write `force(spins = …)`")],
    );
    breaks("group(spins: [SO3; 2]), hamiltonian = k, force = [v, v]", body, &[]);
}

#[test]
fn advected_parameters() {
    let array = "group(spins: [SO3; 2], base: SE3), hamiltonian = k * gamma";
    let body = "struct S { k: f64 }";
    breaks(&format!("{array}.x, advected(gamma: spins[1]::R3)"), body, &[]);
    breaks(&format!("{array}[1].x, advected(gamma: spins::R3)"), body, &[]);
    breaks(&format!("{array}[1].x, advected(gamma: spins::adjoint)"), body, &[]);
    breaks(
        &format!("{array}.x, advected(gamma: R3)"),
        body,
        &[(
            "R3",
            "which factor acts on `gamma`, spins or base? Write `gamma: spins[0]::R3` for one of them, `gamma: spins::R3` for an array with one each",
        )],
    );
    breaks(
        "group(spins: [SO3; 2]), hamiltonian = k * gamma.x, advected(gamma: R3)",
        body,
        &[("R3", "which of `spins` acts on `gamma`? Write `gamma: spins[0]::R3` for one of them")],
    );
    breaks(
        &format!("{array}.x, advected(gamma: spins::R4)"),
        body,
        &[("R4", "`SO3` does not act on a space `R4`; known: `R3`")],
    );
    breaks(
        &format!("{array}[2].x, advected(gamma: spins::R3)"),
        body,
        &[("2", "this index is out of range: an array of 2 has 0 to 1")],
    );
    breaks(
        &format!("{array}[0].x, retractions(Cayley), advected(gamma: spins::adjoint)"),
        body,
        &[("adjoint", "there are no steps with `Cayley` that move this space")],
    );
}

#[test]
fn names() {
    let array = "group(spins: [SO3; 2])";
    for (name, element) in [("spins_1", "spins[1]"), ("spins_momentum_0", "spins_momentum[0]")] {
        let body = format!("struct S {{ #[inertia] j: f64, {name}: f64 }}");
        let message = format!("`{name}` is what tables call `{element}`; choose another name");
        breaks(array, &body, &[(name, &message)]);
    }
    breaks(array, "struct S { #[inertia] j: f64, spins_2: f64 }", &[]);
    breaks(
        "group(l_1: R1)",
        "struct S { #[inertia] j: f64, l: [f64; 2] }",
        &[("l_1", "`l_1` is what tables call `l[1]`")],
    );
    breaks(
        array,
        "struct S { #[inertia] j: f64, spins: f64 }",
        &[("spins", "`spins` is also a field of `S`")],
    );
    breaks(
        array,
        "struct S { #[inertia] j: f64, spins_velocity: [f64; 2] }",
        &[("spins_velocity", "`spins_velocity` is the velocity of this system")],
    );
    attribute("group(a: [SO3; 2], a: R3)", &[("a", "`a` is named twice in `group`")]);
    // neither a name that tables have nor a whole array is a number
    breaks(
        "group(spins: [SO3; 2]), hamiltonian = k * spins_momentum_0.x",
        "struct S { k: f64 }",
        &[("spins_momentum_0", "there is no `spins_momentum_0` here")],
    );
    breaks(
        "group(spins: [SO3; 2]), potential = k * spins_momentum[0].x",
        "struct S { #[inertia] k: f64 }",
        &[("spins_momentum", "a potential does not depend on the momentum")],
    );
    breaks(
        "group(spins: [SO3; 2]), hamiltonian = k * u[0] * spins_momentum[1].x, control(u: [f64; 2])",
        "struct S { k: f64 }",
        &[],
    );
}

/// An array is no more than a row of factors: in the same order, with the same formulas.
#[test]
fn arrays_are_rows_of_factors() {
    let arena = Arena::new();
    let array = (
        "group(a: [SO3; 2], b: R1), advected(v: a::R3), potential = k * v[0].dot(&v[1]) * b.x",
        "struct C { #[inertia(a)] i: [Vector3<f64>; 2], #[inertia(b)] j: f64, k: f64 }",
    );
    let named = (
        "group(a_0: SO3, a_1: SO3, b: R1), advected(v_0: a_0::R3, v_1: a_1::R3), potential = k * v_0.dot(&v_1) * b.x",
        "struct C { #[inertia(a_0)] i_0: Vector3<f64>, #[inertia(a_1)] i_1: Vector3<f64>, #[inertia(b)] j: f64, k: f64 }",
    );
    let [array, named] = [array, named].map(|description| system(&arena, description));
    let parts = |system: &coadjoint_codegen::model::System<'_>| -> Vec<(String, Vec<String>)> {
        let called = |name: &coadjoint_codegen::model::Name| match name.place {
            Some(place) => format!("{}_{}", name.ident, place.index),
            None => name.ident.to_string(),
        };
        // the momentum of `a_0` is called after it
        let momentum = |name: String| {
            name.replace("a_0_momentum", "a_momentum_0").replace("a_1_momentum", "a_momentum_1")
        };
        let parts = system.parts();
        parts.iter().map(|part| (momentum(called(&part.name)), part.suffixes.clone())).collect()
    };
    assert_eq!(parts(&array), parts(&named));
    let names: Vec<String> = parts(&array).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["a_0", "a_momentum_0", "a_1", "a_momentum_1", "b", "b_momentum", "v_0", "v_1"]);
    let text = |lines: Vec<String>| {
        lines
            .join("\n")
            .replace("a_0_momentum", "a_momentum_0")
            .replace("a_1_momentum", "a_momentum_1")
            .replace("a_0_velocity", "a_velocity_0")
            .replace("a_1_velocity", "a_velocity_1")
    };
    assert_eq!(text(array.equations()), text(named.equations()));
    assert_eq!(array.equations().len(), 17);
    let casimirs = |system: &coadjoint_codegen::model::System<'_>| -> Vec<String> {
        system.casimirs().found.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(casimirs(&array), ["|v_0|²", "a_momentum_0·v_0", "|v_1|²", "a_momentum_1·v_1"]);
    assert_eq!(array.parameters.len(), named.parameters.len());
}
