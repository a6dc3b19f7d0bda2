//! Groups: several factors, bases and families.

use super::{attribute, breaks, expands};

#[test]
fn bases_of_groups() {
    let body = "struct Body { #[inertia] j: f64 }";
    for sound in [
        "group = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }, advected(v: R2), potential = v.x",
        "group(a: SL(2), b: matrices { x: [0, 1; -1, 0] }), potential = a[(0, 0)] + b.trace()",
        "group = SE2(3)",
        "group = SP(4)",
        "group = SU(3)",
        "group = product(turn: SO3, shear: SL(2)), advected(v: R5)",
        "group = semidirect(turn: SO3, velocity: R3, position: R3)",
        "group = semidirect(turn: SL(2), v: R2, w: dual(R2)), advected(m: coadjoint)",
        "group = tangent(product(a: SE(2), b: R(2),)), advected(m: adjoint)",
        "group = SL(2), advected(q: matrices { h1: [2, 0, 0; 0, 0, 0; 0, 0, -2], e12: [0, 1, 0; 0, 0, 2; 0, 0, 0], e21: [0, 0, 0; 2, 0, 0; 0, 1, 0] })",
        "group = SU2, advected(g: matrices { x: [0, 0, 0; 0, 0, -1; 0, 1, 0], y: [0, 0, 1; 0, 0, 0; -1, 0, 0], z: [0, -1, 0; 1, 0, 0; 0, 0, 0] })",
        "group = product(a: SU2, b: SO2), retractions(Exponential)",
    ] {
        breaks(sound, body, &[]);
    }
    breaks(
        "group = matrices { a: [1, 0; 0, 1], b: [0, 1; 0, 0], c: [2, 1; 0, 2] }",
        body,
        &[("c", "`c` is a combination of the matrices before it")],
    );
    breaks(
        "group = matrices { a: [0, 1, 0; 0, 0, 0; 0, 0, 0], b: [0, 0, 0; 0, 0, 1; 0, 0, 0] }",
        body,
        &[("a", "the commutator [a, b] = a b − b a is no combination of the basis")],
    );
    breaks(
        "group = SU2, advected(g: matrices { x: [0, 0, 0; 0, 0, -2; 0, 2, 0], y: [0, 0, 2; 0, 0, 0; -2, 0, 0], z: [0, -2, 0; 2, 0, 0; 0, 0, 0] })",
        body,
        &[("x", "`x` and `y` do not commute as the axes of SU2 do")],
    );
    breaks(
        "group = matrices { a: [0, 1; 0, 0], b: [1, 0] }",
        body,
        &[("b", "the matrices of a basis are square and of one size, 2 × 2 here; `b` is 1 × 2")],
    );
    breaks("group = SL(4)", body, &[("SL", "there are no steps on SL4: its Cayley map leaves the group")]);
    breaks(
        "group = SL(2), retractions(SecondKind)",
        body,
        &[("SL", "there are no steps on SL2 with `SecondKind`")],
    );
    breaks(
        "group = SL(2), advected(v: R3)",
        body,
        &[("R3", "`SL2` does not act on a space `R3`; known: `R2`")],
    );
    // neither large numbers nor many of them are more than an error
    breaks("group = SL(6)", body, &[("SL", "there is no group `SL6`")]);
    let dense = (0..6_i64).map(|i| {
        let row = |r: i64| {
            (0..6_i64)
                .map(|c| {
                    ((i + 2) * (r + 3).pow(2) * (c + 5).pow(3) * 7_919 % 2_000_003 * 1_009 + c * 31 + i)
                        .to_string()
                })
                .collect::<Vec<_>>()
                .join(", ")
        };
        format!("a{i}: [{}]", (0..6).map(row).collect::<Vec<_>>().join("; "))
    });
    let dense = format!("group = matrices {{ {} }}", dense.collect::<Vec<_>>().join(", "));
    breaks(
        &dense,
        body,
        &[("matrices", "a basis has up to 16 matrices of 1 to 12 rows, of small whole numbers")],
    );
    let few =
        "there is no group `SO40`; of `SO(n)` there are `SO(2)`, `SO(3)`, `SO(4)`, `SO(5)` and `SO(6)`$";
    breaks("group = SO(40)", body, &[("SO", few)]);
    // few coordinates and many rows, and none at all
    breaks("group = SU(4)", body, &[("SU", "there is no group `SU4`; of `SU(n)`")]);
    breaks("group = SO(1)", body, &[("SO", "there is no group `SO1`; of `SO(n)`")]);
    breaks(
        "group = SP(3)",
        body,
        &[("SP", "there is no group `SP3`; of `SP(2n)` there are `SP(2)` and `SP(4)`$")],
    );
    breaks(
        "group = SO4, advected(p: adjont)",
        body,
        &[("adjont", "`SO4` does not act on a space `adjont`; did you mean `adjoint`?$")],
    );
    let known = "there is no group `Banana`; known: `R1`, `R2`, `R3`, `R4`, `R5`, `R6`, `SO2`, `SO3`, `SE2`, `SE3` and `SU2`; \
        families: `SO(n)`, `SL(n)`, `GL(n)`, `SP(2n)`";
    breaks("group = Banana", body, &[("Banana", known)]);
    for (written, word, near) in [("O(3)", "O", "SO(3)"), ("sl(2)", "sl", "SL(2)")] {
        let name = written.replace(['(', ')'], "");
        let message = format!(
            "there is no group `{name}`; did you mean `{near}`?; known: `R1`, `R2`, `R3`, `R4`, `R5`"
        );
        breaks(&format!("group = {written}"), body, &[(word, &message)]);
    }
    // known by a name that is none here: how to write it, which is a description
    for (written, word, instead) in [
        (
            "U(2)",
            "U",
            "a phase beside `SU(2)` covers it: `group(element: SU(2), phase: SO2)`; of its own matrices",
        ),
        (
            "U3",
            "U3",
            "a phase beside `SU(3)` covers it: `group(element: SU(3), phase: SO2)`; of its own matrices",
        ),
        ("U(1)", "U", "turns in a plane are `SO2`$"),
        ("S1", "S1", "turns in a plane are `SO2`$"),
        ("S2", "S2", "a sphere is none, and `SO3` turns it: the guide's page `spheres` shows how$"),
        ("S3", "S3", "unit quaternions are `SU2`$"),
        ("Spin(3)", "Spin", "unit quaternions are `SU2`$"),
        ("T(2)", "T", "one angle for each dimension is `group(angles: [SO2; 2])`$"),
    ] {
        let name = written.replace(['(', ')'], "");
        let message = format!("there is no group `{name}`; {instead}");
        breaks(&format!("group = {written}"), body, &[(word, &message)]);
    }
    let phased = "struct Body { #[inertia(element)] j: Vector3<f64>, #[inertia(phase)] k: f64 }";
    breaks("group(element: SU(2), phase: SO2)", phased, &[]);
    breaks("group(angles: [SO2; 2])", "struct Body { #[inertia(angles)] j: f64 }", &[]);
    // of no family, and of a size that none has
    for name in ["S4", "U9"] {
        let message = format!("there is no group `{name}`; known: `R1`");
        breaks(&format!("group = {name}"), body, &[(name, &message)]);
    }
}

/// What is asked for is never made before it is known to be small.
#[test]
fn groups_of_absurd_sizes() {
    let body = "struct Body { #[inertia] j: f64 }";
    for family in ["SO", "SE", "SE2", "SGal", "GL", "SL", "SP", "SU"] {
        for n in ["0", "7", "100000", "4294967295"] {
            let message = format!("there is no group `{family}{n}`");
            breaks(&format!("group = {family}({n})"), body, &[(family, &message)]);
        }
        let name = format!("{family}18446744073709551615");
        breaks(&format!("group = {name}"), body, &[(&name, &format!("there is no group `{name}`"))]);
    }
    for (name, size) in [("Aff", 2), ("Heisenberg", 3)] {
        let message = format!("there is no group `{name}{size}`");
        breaks(&format!("group = {name}({size})"), body, &[(name, &message)]);
    }
    expands("group = SO21(1)", body, &[("SO21", "there is no group `SO21(1)`")]);
    breaks("group = SO(2, 1)", "struct Body { #[inertia] j: Vector3<f64> }", &[]);
    for written in ["SO(21)", "SO(3, 1)", "SO(0, 3)", "SE(23)", "SE(2, 3)", "GL(1, 2)"] {
        let message = format!("there is no group `{written}`");
        expands(&format!("group = {written}"), body, &[(&written[..2], &message)]);
    }
    for name in ["SO", "GL", "Aff"] {
        breaks(&format!("group = {name}"), body, &[(name, &format!("there is no group `{name}`"))]);
    }
    let row = (0..70).map(|k| (k % 7).to_string()).collect::<Vec<_>>().join(", ");
    let large = format!("group = matrices {{ a: [{}] }}", vec![row; 70].join("; "));
    breaks(&large, body, &[("matrices", "a basis has up to 16 matrices of 1 to 12 rows")]);
    // and neither are groups made of many
    let many = |of: &str| (0..300).map(|i| format!("part{i}: {of}")).collect::<Vec<_>>().join(", ");
    let too_large = "this group is too large: a basis has up to 16 matrices";
    breaks(&format!("group = product({})", many("SU(3)")), body, &[("product", too_large)]);
    breaks(&format!("group = semidirect(a: SO3, {})", many("R3")), body, &[("semidirect", too_large)]);
    let vectors =
        "group = semidirect(a: SO3, p: R3, q: R3, r: R3, s: R3), hamiltonian = momentum.norm_squared()";
    breaks(vectors, "struct Body {}", &[]);
    breaks("group = tangent(tangent(SE3))", body, &[("tangent", too_large)]);
    let bound = "the factors of a system may have dimension 96 together; up to here they have 104";
    breaks(&format!("group({})", many("SU(3)")), body, &[("part12", bound)]);
    let sizes = "there is no group `R7`; of `R(n)` there are `R1`, `R2`, `R3`, `R4`, `R5` and `R6`";
    breaks("group = R(7)", body, &[("R", sizes)]);
    let halves = "expected a whole number, as in `[1, 0; 0, -1]`; of halves write the double, and scale the coordinate";
    attribute("group = matrices { x: [0, 0.5; -0.5, 0] }", &[("0.5", halves)]);
    let row = vec!["0"; 13].join(", ");
    let matrix = vec![row; 13].join("; ");
    let wide = format!("group = Aff(1), advected(q: matrices {{ scale: [{matrix}], shift: [{matrix}] }})");
    breaks(&wide, body, &[("matrices", "a basis has up to 16 matrices of 1 to 12 rows")]);
}

#[test]
fn factors() {
    let pair = "struct Pair { #[inertia(first)] j: Vector3<f64>, #[inertia(second)] m: f64 }";
    breaks("group(first: SO3, second: R3)", pair, &[]);
    breaks("group(first: SO3, second: R(3))", pair, &[]);
    breaks("group(first: SO3, second: r#turn(2))", pair, &[("r#turn", "there is no group `turn2`")]);
    breaks("group(first: SO3, second: R3)", "struct Pair { #[inertia] j: SMatrix<f64, 6, 6> }", &[]);
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia(first)] j: f64, #[inertia(frist)] k: f64 }",
        &[
            ("frist", "there is no factor `frist` of the group; did you mean `first`?"),
            ("Pair", "`second` has no inertia; mark one field with `#[inertia(second)]`"),
        ],
    );
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia] j: f64, #[inertia(second)] k: f64 }",
        &[("inertia", "`second` has several inertias, `j` and `k`")],
    );
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia] j: Vector3<f64> }",
        &[("Vector3<f64>", "`SO3` and `R3` together have dimension 6, so its inertia is a vector of 6")],
    );
    breaks(
        "group(first: SO3, second: SO3), advected(gamma: R3)",
        pair,
        &[("R3", "which factor acts on `gamma`, first or second? Write `gamma: first::R3`")],
    );
    breaks("group(first: SO3, second: SO3), advected(gamma: second::R3)", pair, &[]);
    breaks(
        "group(first: SO3, second: SO3), advected(gamma: third::R3)",
        pair,
        &[("third", "there is no factor `third`")],
    );
    breaks(
        "group(first: SO3, second: R3), advected(first: R3)",
        pair,
        &[("first", "`first` is also a factor of the group")],
    );
    attribute("group(a: SO3, a: R3)", &[("a", "`a` is named twice in `group`")]);
}
