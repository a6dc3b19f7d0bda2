//! The page of the guide that lists the language, made from the tables that the generator itself works with.
//!
//! After a change of the language, `UPDATE_REFERENCE=1 cargo test -p coadjoint-codegen` writes it anew.

use coadjoint_codegen::expr::{Arena, Stage, Vector};
use coadjoint_codegen::group::{Group, MatrixGroup, Retraction, catalogue, family, one_word, part_name};
use coadjoint_codegen::language::words::{
    self, ARRAY_METHODS, CONSTRUCTORS, ITERATOR_METHODS, POINTS, RANGE, STEPS,
};
use coadjoint_codegen::parse::Key;
use coadjoint_codegen::quantity::Kind;

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
    for key in Key::all() {
        let written = |then: &str| documentation.contains(&format!("/// | `{}{then}", key.name()));
        assert!([" = ", "(", "`"].into_iter().any(written), "{} is missing", key.name());
    }
}

/// What can be written in a description, in Markdown: keys, groups with the order of what they store, and all that has a meaning in an
/// expression.
fn reference() -> String {
    let sections = [keys(), groups(), matrix_groups(), arrays(), expressions(), methods(), types()];
    let page = sections.concat();
    // one line end at the end
    format!("{}\n", page.trim_end())
}

/// Names as code, with commas.
fn codes<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> String {
    let codes: Vec<String> = names.into_iter().map(|name| format!("`{}`", name.as_ref())).collect();
    codes.join(", ")
}

fn keys() -> String {
    let rows: Vec<String> =
        Key::all().map(|key| format!("| `{}` | `{}` |\n", key.name(), key.example())).collect();
    format!("# Keys\n\n| key | for example |\n|---|---|\n{}\n", rows.concat())
}

fn groups() -> String {
    let rows: Vec<String> = catalogue().iter().map(|group| group_row(*group)).collect();
    let taken = merged(components);
    let parts = merged(parts);
    let conventions = merged(|group| Some(group.names().conventions.to_owned()));
    format!(
        "# Groups\n\n\
         The order is that of `to_components`, of flat arrays and of tables: the configuration of each factor, then its momentum, then all \
         advected parameters.\n\n\
         | group | field of the state | stored as, in this order | momentum, in this order | acts on |\n|---|---|---|---|---|\n{}\n\
         {}\n{QUATERNIONS}\n\n{}\n{}\n",
        rows.concat(),
        conventions,
        parts,
        taken,
    )
}

/// Members of the families that have steps, one or more of each.
const FAMILIES: [(&str, &str); 11] = [
    ("SO(4)", "rotations of four dimensions"),
    ("SL(2)", "matrices of determinant 1"),
    ("SL(3)", "the same, of three rows"),
    ("GL(2)", "matrices that have an inverse"),
    ("SP(4)", "symplectic matrices"),
    ("SU(3)", "unitary matrices of determinant 1, a complex number as two rows and columns"),
    ("SE2(3)", "a rotation with two vectors that it turns: attitude, velocity and position"),
    ("SGal(3)", "Galilei's group: rotation, velocity, position and time"),
    ("SO(2, 1)", "Lorentz's group of the plane"),
    ("Heisenberg", "upper triangular matrices with ones on the diagonal"),
    ("Aff(1)", "scalings and translations of the line"),
];

/// The matrix of the algebra that has these coordinates, by rows, as it is written in a basis.
fn general_matrix(group: &MatrixGroup) -> String {
    let arena = Arena::new();
    let x = Vector(group.axes().iter().map(|axis| arena.symbol(*axis, Stage::Step)).collect());
    let space = group.representations()[0];
    let unit = |j: usize| Vector((0..group.size()).map(|k| arena.number(i64::from(k == j))).collect());
    let columns: Vec<_> = (0..group.size()).map(|j| space.act_infinitesimally(&x, &unit(j))).collect();
    let row = |i: usize| columns.iter().map(|column| column.0[i].to_string()).collect::<Vec<_>>().join(", ");
    format!("[{}]", (0..group.size()).map(row).collect::<Vec<_>>().join("; "))
}

/// Groups that are derived from a basis.
fn matrix_groups() -> String {
    let row = |(name, about): (&str, &str)| {
        let group = family(&one_word(name))?;
        let retractions = Retraction::defaults().filter(|&retraction| group.has(retraction));
        Some(format!(
            "| `{name}` | {about} | {} × {1} | {2} | {3} |\n",
            group.size(),
            group.size(),
            group.axes().join(", "),
            codes(retractions.map(Retraction::name)),
        ))
    };
    let rows: Vec<String> = FAMILIES.into_iter().filter_map(row).collect();
    let known = FAMILIES.into_iter().filter_map(|(name, _)| Some((name, family(&one_word(name))?)));
    let bases = known.map(|(name, group)| format!("* `{name}`: `{}`\n", general_matrix(group)));
    format!(
        "# Groups of matrices\n\n\
         A basis of the Lie algebra is all that a group needs, in whole numbers and with a name for each coordinate:\n\n\
         ```text\n\
         group = matrices {{ h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }}\n\
         ```\n\n\
         Structure constants, both retractions with their derivatives, Casimirs and the projection onto the group are derived from it exactly. What \
         is no basis of a Lie algebra is an error at its matrix. There are up to 16 coordinates, and matrices of up to 12 rows. Some have names:\n\n\
         | group | what it is | matrices | coordinates | retractions |\n|---|---|---|---|---|\n{}\n\
         Their bases are these: the matrix of the algebra with these coordinates, by rows. Other sizes go on in the same way; in `SU(n)` a complex \
         number `a + ib` is the block `[a, -b; b, a]`, and in three dimensions `x`, `y`, `z` turn about the axes as those of `SO3` do.\n\n{}\n\
         Groups are made of others, of those with names too. Each part has a name, which the coordinates and the parts of the momentum begin with:\n\n\
         | written | is |\n|---|---|\n\
         | `product(vehicle: SE3, rotor: SO2)` | the direct product, one momentum for all; blocks of one matrix |\n\
         | `semidirect(attitude: SO3, velocity: R3, position: R3)` | the group with vectors that it moves: `(g, v)(h, w) = (g h, v + g w)` |\n\
         | `tangent(SO3)` | positions and velocities, `TG`: the matrices `[[X, Y], [0, X]]` |\n\
         | `Areas!`, `groups::Areas!` | one that [`lie_group!`](crate::lie_group) defines |\n\n\
         * The field of the state is `element`, an `SMatrix`; a factor has the name that it is given. In expressions it is that matrix: \
         `element[(0, 1)]`, `element.transpose()`, `element * v`. The momentum is an `SVector` of coordinates with respect to the dual basis.\n\
         * The group acts on columns of as many numbers as the matrices have rows: `advected(v: R2)`. An advected parameter belongs to what is dual \
         to its space, as a momentum does: it is `ρ(g)ᵀ v` for a constant `v`, with the matrix `ρ(g)` by which `g` acts. A point that stands still in \
         space, `g⁻¹ v`, is one of `dual(R2)`. For rotations these are the same.\n\
         * Every group, of the catalogue too, acts on its algebra, `advected(a: adjoint)`, on the dual of that, `coadjoint`, and on the dual of \
         each of its spaces, `dual(R2)`; on the first two with the exponential alone. A space of your own has a matrix for each coordinate: `advected(q: matrices {{ h: [2], e: [0], f: [0] }})`.\n\
         * The exponential is a finite sum where the matrices, or those of each ideal, are annihilated by `λᵃ (λ² + z)^q`. Otherwise its series is \
         summed within `|ad_x|² + |X|² ≤ 9/4`, for up to 10 coordinates; where there is another retraction that is done only if `retractions(…)` \
         asks for it. The Cayley map is there where it stays on the group.\n\n",
        rows.concat(),
        bases.collect::<String>(),
    )
}

/// Arrays, and what is said of each element.
fn arrays() -> String {
    format!(
        "# Arrays\n\n\
         Equal factors may be an array, `group(spins: [SO3; 4])`, of up to 32, as long as the dimensions of all factors add up to 96 at most. It is a row of factors with one name: the state has the fields `spins` and \
         `spins_momentum`, which are arrays.\n\n\
         | of an array | written |\n|---|---|\n\
         | one factor, after its declaration | `force(spins[0] = …)`, `#[inertia(spins[0])]`, `advected(gamma: spins[0]::R3)` |\n\
         | all of them | `force(spins = …)` with an array, `#[inertia(spins)]`, `advected(gammas: spins::R3)` for an array with one each |\n\
         | fields and controls | `lengths: [f64; 4]`, `control(torques: [R3; 4])` |\n\
         | inertias | `#[inertia] inertia: [Vector3<f64>; 4]`, or one `Vector3<f64>` for all |\n\
         | in expressions | `spins_momentum[0]`, `spins_velocity[1]`, `[a, b]` |\n\
         | in flat arrays, in tables, on the command line | `spins_0`, `spins_momentum_0`, `spins_1`, …: each factor with its momentum |\n\n\
         What is said of all elements is lowered for each:\n\n\
         ```text\n\
         (0..3).map(|i| spins_momentum[i].dot(&spins_momentum[i + 1])).sum::<f64>()\n\
         spins_momentum.iter().zip(&lengths).map(|(spin, length)| length * spin.x).sum::<f64>()\n\
         ```\n\n\
         * Methods of arrays: {}.\n\
         * Methods of iterators, and of ranges such as `0..3`: {}.\n\
         * Indices are integers that are known when the description is read: `i`, `i + 1`, `(i + 1) % 4`.\n\
         * A range goes through {RANGE} integers at most.\n\
         * A sum of nothing is an error. Within another iteration it is zero, of the type that it names.\n\n",
        codes(ARRAY_METHODS),
        codes(ITERATOR_METHODS),
    )
}

/// A line for each text, with the groups that it is true of.
fn merged(text: impl Fn(&dyn Group) -> Option<String>) -> String {
    let mut lines: Vec<(String, Vec<&str>)> = Vec::new();
    for group in catalogue() {
        let Some(text) = text(*group) else { continue };
        match lines.iter_mut().find(|(known, _)| *known == text) {
            Some((_, groups)) => groups.push(group.name()),
            None => lines.push((text, vec![group.name()])),
        }
    }
    lines.into_iter().map(|(text, groups)| format!("* {}: {text}.\n", codes(groups))).collect()
}

/// The two orders of a quaternion, side by side.
const QUATERNIONS: &str = "**A quaternion has two orders.** `to_components`, and all arrays and tables of this crate, begin with the real part: \
    `w, x, y, z`. What serde writes is nalgebra's own order, with the real part at the end: `x, y, z, w`; an isometry has `rotation` and \
    `translation` by name. The components of a vector space are written as they are, and those of a matrix by columns; in \
    `to_components` a matrix goes by rows.";

fn group_row(group: &dyn Group) -> String {
    let spaces = group.representations().iter().map(|space| space.name());
    format!(
        "| `{}` | `{}` | `{}`: {} | `{}`: {} | {} |\n",
        group.name(),
        group.names().configuration,
        stored(group.names().kind),
        group.coordinates().join(", "),
        stored(Kind::Vector(group.dimension())),
        group.axes().join(", "),
        codes(spaces),
    )
}

/// The type that a quantity of the catalogue is stored as.
fn stored(kind: Kind) -> String {
    match kind {
        Kind::Vector(n) => format!("Vector{n}"),
        Kind::UnitComplex => "UnitComplex".to_owned(),
        Kind::UnitQuaternion => "UnitQuaternion".to_owned(),
        Kind::RigidMotion2 => "Isometry2".to_owned(),
        Kind::RigidMotion3 => "Isometry3".to_owned(),
        other => panic!("{other:?} is not in the catalogue"),
    }
}

/// The parts of a momentum that have names.
fn parts(group: &dyn Group) -> Option<String> {
    let [first, second] = group.names().parts else { return None };
    let name = |quantity: &str| [first, second].map(|part| part_name(quantity, part));
    Some(format!(
        "the momentum has the parts {}, the velocity {}, of a factor `hull` {} and so on; a part of one component is a number. A force may be \
         a pair of parts, `({first}, {second})`",
        codes(name("momentum")),
        codes(name("velocity")),
        codes(name("hull_momentum")),
    ))
}

/// What an expression can take from a configuration.
fn components(group: &dyn Group) -> Option<String> {
    let written = |called: bool| {
        let all = group.names().components.iter().filter(move |component| component.called == called);
        all.map(
            move |component| if called { format!("{}()", component.name) } else { component.name.to_owned() },
        )
    };
    let all: Vec<String> = written(false).chain(written(true)).collect();
    (!all.is_empty()).then(|| format!("an element has {}", codes(all)))
}

fn expressions() -> String {
    format!(
        "# Expressions\n\n\
         * Names: fields, factors, momenta, velocities (in forces), advected parameters, controls, the time `t`, and constants of \
         your own, `GRAVITY` or `std::f64::consts::PI`.\n\
         * `+ - * /`, signs, parentheses, references, blocks with `let`, `integer as f64`, `f64::from(integer)`; of integers `%` and `as i32` too.\n\
         * Components: `v.x`, `v[0]`, `m.m12`, `m[(0, 1)]`; a matrix is indexed by rows and columns, with one index by columns. Momenta, velocities and \
         advected parameters know their coordinates by name too: `momentum.r12`, `spins_momentum[0].h`.\n\
         * `g * v` and `g * h` for an element `g` of a group; of rigid motions `g * p` for a point `p`, while a vector is turned by \
         `transform_vector`.\n\
         * Constructors: `vector![x, y]`, `matrix![a, b; c, d]`, and of the types of nalgebra {}.\n\
         * Functions of your own, `density(position.z)` or `air::density(position.z)`, with [`#[expression]`](crate::expression) above them.\n\
         * Tables: `thrust.spline(from, to, x)` of an array of numbers, [a curve](crate::Spline) through its values, the natural cubic spline. Beyond `from` and `to` it \
         goes on along the straight lines at its ends, without a note; `x.clamp(from, to)` in place of `x` holds the values there. A step \
         fails that needs it where `to` is `from`, which is an error where both are numbers.\n\
         * Points: {} of `Point2` and `Point3`; `p - q` is a vector, `p + v` a point, `p.coords` the vector to it.\n\
         * Parts of vectors and matrices: `fixed_rows::<R>(i)`, `fixed_columns::<C>(j)`, `fixed_view::<R, C>(i, j)`.\n\
         * `try_inverse()` of a matrix of up to four rows, taken with `.unwrap()` or `.expect(\"…\")`: by cofactors, over the determinant. A step \
         that meets a singular matrix fails as one whose state is not finite; the method that is emitted for your text panics as `unwrap` \
         says.\n\
         * `angle()` of `SO2` is above −π and at most π, that of `SO3` and `SU2` from 0 to π, and `scaled_axis()` is the axis times it: an \
         energy of these jumps at half a turn, unless its derivative is the same on both sides. Where a half turn has lost its axis, a step \
         fails.\n\
         * Zero is a state like others: `v.norm() * v`, `x.norm().powi(3)` and the square of an angle have their derivatives there. Where there \
         is none, as of `v.norm()` alone at rest, a Jacobian is an error, and a step that needs it fails.\n\
         * `if … else …`, `else if` too, between values of one kind; conditions are comparisons of numbers, with `&&`, `||` and `!`. A kink, as \
         of `abs`, `min`, `max` and `clamp`, has the derivative of the branch that is taken there: of `x.abs()` that is 1 at zero. Both branches are \
         computed, and one is taken: what is no number in the other does no harm, nor does its derivative. A derivative that does not come from the \
         branch, as where `if x == 0.0 {{ 1.0 }} else {{ x.sin() / x }}` is 1, is not found. [Kinks and jumps](crate::guide::forces#kinks-and-jumps) cost order.\n\
         * Where the limits of a `clamp` cross, as in `x.clamp(-limit, limit)` with a negative `limit`, it is the upper one, in a step as in the method that is emitted for your text. In a \
         function of your own, which is Rust's too, it panics: there `x.max(lower).min(upper)` does not.\n\
         * A comparison with what is not a number counts as one that holds for `<=` and `>=`; `min` and `max` take the receiver then.\n\
         * What jumps at whole numbers is refused: {}, and remainders of numbers.\n\n",
        codes(CONSTRUCTORS),
        codes(POINTS),
        codes(STEPS),
    )
}

fn methods() -> String {
    let rows = words::methods().map(|(what, methods)| format!("| {what} | {} |\n", codes(methods)));
    format!(
        "# Methods\n\n\
         Each means what it means in Rust and nalgebra, and may be written as a function: `f64::sin(x)`, `Vector3::dot(&v, &w)`. `clone()`, and of \
         vectors and matrices `into_owned()` and `clone_owned()`, change nothing.\n\n\
         | of | methods |\n|---|---|\n{}\n",
        rows.concat()
    )
}

fn types() -> String {
    "# Types\n\n\
     * Of a field: `f64` or `f32`, one of them for all; `Vector1` to `Vector6`, `RowVector1` to `RowVector6`, `Matrix1` to `Matrix6`, \
     `Matrix2x3` and so on, `SVector<f64, N>`, `SMatrix<f64, R, C>` with up to 32 rows and columns.\n\
     * Of a control: the same, or `R1` to `R6` for a vector.\n\
     * Of either: an array of up to 32 of these, `[f64; 3]`.\n\
     * Of an advected parameter: a space that a factor acts on, `gamma: R3`, or `gamma: attitude::R3` where several do.\n"
        .to_owned()
}
