//! The quantities of a state that pictures show: of a configuration that is a matrix its rotation and its vectors.
//!
//! Nothing here knows a group: a basis of its algebra is what small displacements of the unit matrix are.

use std::borrow::Cow;
use std::ops::Range;

use coadjoint::erased::{self, RetractionKind};
#[cfg(test)]
use coadjoint::system::Kind;
use coadjoint::system::{Quantity, Role};
use nalgebra::{DMatrix, Matrix3, Rotation3, UnitQuaternion};

use super::quantities::{matrix_order, rotation, tangent_places};

/// So many entries of a matrix can be told apart in a plot.
const ENTRIES: usize = 6;

/// The quantities of a state as pictures show them.
#[derive(Clone, Debug)]
pub(crate) struct PlottedQuantities {
    quantities: Vec<PlottedQuantity>,
    /// How many of them are plotted; behind them are the matrices, for what they move.
    plotted: usize,
    rotations: Vec<Vec<usize>>,
}

/// A quantity as pictures show it: one of the state, or a part of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlottedQuantity {
    pub(crate) name: String,
    pub(crate) role: Role,
    pub(crate) components: Vec<String>,
    /// So many of its components are those of a rotation: four in space, two in the plane, none of a vector.
    pub(crate) rotation: usize,
    /// Whether it is a matrix, or a part of one.
    pub(crate) is_of_a_matrix: bool,
    source: Source,
}

/// Where a quantity's numbers are in a state.
#[derive(Clone, Debug, PartialEq)]
enum Source {
    /// Here.
    Slots(Range<usize>),
    /// Here, by rows those of a matrix: as a quaternion, or as a unit complex number.
    Rotation(Vec<usize>),
    /// Here and there.
    Entries(Vec<usize>),
}

impl PlottedQuantity {
    fn of(quantity: &Quantity, slots: Range<usize>) -> Self {
        Self {
            name: quantity.name.to_owned(),
            role: quantity.role,
            components: quantity.components.iter().map(|&name| name.to_owned()).collect(),
            rotation: rotation(quantity).map_or(0, |(count, _)| count),
            is_of_a_matrix: false,
            source: Source::Slots(slots),
        }
    }

    /// Writes its name in words. A matrix that is the only configuration has its name by default: its parts go without.
    pub(crate) fn title(&self) -> String {
        self.name.strip_prefix("element_").unwrap_or(&self.name).replace('_', " ")
    }

    /// Joins its name and a component's, as tables have them.
    pub(crate) fn component_name(&self, component: &str) -> String {
        if component.is_empty() { self.name.clone() } else { format!("{}_{component}", self.name) }
    }

    /// Tells whether it turns or moves in space, not only in a plane or on a line.
    fn is_spatial(&self) -> bool {
        match (&self.source, self.rotation) {
            (_, 4) => self.role == Role::Configuration,
            (_, 2) => false,
            (Source::Slots(_), _) if self.is_of_a_matrix => self.components.len() > 4,
            _ => self.components.len() == 3,
        }
    }
}

impl PlottedQuantities {
    /// Finds what pictures show of a system, with an example of its states.
    pub(crate) fn of(system: &dyn erased::System, example: &[f64]) -> Self {
        let state = system.description().state;
        let (mut quantities, mut matrices, mut rotations) = (Vec::new(), Vec::new(), Vec::new());
        for ((index, (quantity, slots)), (_, tangent)) in
            Quantity::with_ranges(state).enumerate().zip(tangent_places(state))
        {
            let own = PlottedQuantity::of(quantity, slots.clone());
            let turning = match matrix_order(quantity).zip(state.get(index + 1)) {
                Some((rows, momentum)) => {
                    let basis = basis(system, example, &slots, rows, tangent);
                    let parts = Parts::of(rows, &basis, momentum.components);
                    quantities.extend(parts.shown(quantity, slots.start));
                    matrices.push(PlottedQuantity { is_of_a_matrix: true, ..own });
                    parts.turning(slots.start)
                }
                None => {
                    let turning = (slots.start..slots.start + own.rotation).collect();
                    quantities.push(own);
                    turning
                }
            };
            rotations.extend((!turning.is_empty()).then_some(turning));
        }
        let plotted = quantities.len();
        quantities.extend(matrices);
        Self { quantities, plotted, rotations }
    }

    /// Lists what is plotted.
    pub(crate) fn all(&self) -> &[PlottedQuantity] {
        &self.quantities[..self.plotted]
    }

    /// Pairs each quantity that is plotted with its place among the [numbers](Self::numbers).
    pub(crate) fn laid_out(&self) -> impl Iterator<Item = (&PlottedQuantity, Range<usize>)> {
        self.with_matrices().take(self.plotted)
    }

    /// The same, then the matrices.
    fn with_matrices(&self) -> impl Iterator<Item = (&PlottedQuantity, Range<usize>)> {
        self.quantities.iter().scan(0, |start, quantity| {
            let slots = *start..*start + quantity.components.len();
            *start = slots.end;
            Some((quantity, slots))
        })
    }

    /// Finds a quantity of this name, or a matrix, and its place among the [numbers](Self::numbers).
    pub(crate) fn find(&self, name: &str) -> Option<(&PlottedQuantity, Range<usize>)> {
        self.with_matrices().find(|(quantity, _)| quantity.name == name)
    }

    /// Tells whether a quantity of this name turns or moves in space.
    pub(crate) fn is_spatial(&self, name: &str) -> bool {
        self.quantities.iter().any(|quantity| quantity.name == name && quantity.is_spatial())
    }

    /// Lists where in a state the numbers of rotations are: of a quaternion, of a unit complex number or its column in
    /// a matrix, of a matrix by rows.
    pub(crate) fn rotations(&self) -> &[Vec<usize>] {
        &self.rotations
    }

    /// Reads the numbers of all quantities, and of the matrices behind them, from a state.
    pub(crate) fn numbers<'s>(&self, state: &'s [f64]) -> Cow<'s, [f64]> {
        if self.plotted == self.quantities.len() {
            // no matrices: it is shown as it is
            return Cow::Borrowed(state);
        }
        let at = |slot: &usize| state.get(*slot).copied().unwrap_or(f64::NAN);
        let mut numbers = Vec::with_capacity(state.len());
        for PlottedQuantity { source, .. } in &self.quantities {
            match source {
                Source::Slots(slots) => numbers.extend(slots.clone().map(|slot| at(&slot))),
                Source::Rotation(slots) if slots.len() == 9 => {
                    let matrix = Matrix3::from_row_iterator(slots.iter().map(at));
                    let rotation = Rotation3::from_matrix_unchecked(matrix);
                    let [i, j, k, w]: [f64; 4] =
                        UnitQuaternion::from_rotation_matrix(&rotation).coords.into();
                    numbers.extend([w, i, j, k]);
                }
                Source::Rotation(slots) | Source::Entries(slots) => numbers.extend(slots.iter().map(at)),
            }
        }
        Cow::Owned(numbers)
    }
}

/// A basis of the algebra, of whole numbers.
fn basis(
    system: &dyn erased::System,
    example: &[f64],
    slots: &Range<usize>,
    rows: usize,
    tangent: Range<usize>,
) -> Vec<DMatrix<f64>> {
    /// Its square is far below one.
    const STEP: f64 = 1e-3;

    let length = tangent_places(system.description().state).last().map_or(0, |(_, place)| place.end);
    let mut unit = example.to_vec();
    unit[slots.clone()].copy_from_slice(DMatrix::<f64>::identity(rows, rows).as_slice());
    let displaced = |k: usize, by: f64| {
        let mut along = vec![0.0; length];
        along[k] = by;
        let state = system.displace(&unit, RetractionKind::Exponential, &along);
        DMatrix::from_row_slice(rows, rows, &state[slots.clone()])
    };
    let element = |k| (displaced(k, STEP) - displaced(k, -STEP)) / (2.0 * STEP);
    tangent.map(|k| element(k).map(f64::round)).collect()
}

/// The parts of the elements of a group of matrices that turn, and those that move.
#[derive(Debug, PartialEq)]
struct Parts {
    rows: usize,
    /// The first so many rows and columns are a rotation, in space or in the plane; zero if none is.
    turns: usize,
    /// The columns behind that are vectors that it turns, by their names.
    vectors: Vec<(String, usize)>,
    /// Where else entries move.
    others: Vec<(usize, usize)>,
}

impl Parts {
    fn of(rows: usize, basis: &[DMatrix<f64>], coordinates: &[&str]) -> Self {
        let moving = moving(rows, basis);
        let turns = [3, 2].into_iter().find(|&k| is_rotation(basis, &moving, k)).unwrap_or(0);
        let of_column = |column: usize| {
            let coordinate = |(element, name): (&DMatrix<f64>, &&str)| {
                let moves = element.rows(0, turns).column(column).iter().any(|entry| *entry != 0.0);
                moves.then(|| name.trim_end_matches(|letter: char| letter.is_ascii_digit()).to_owned())
            };
            basis.iter().zip(coordinates).filter_map(coordinate).collect::<Vec<String>>()
        };
        let columns: Vec<usize> =
            (turns..rows).filter(|&column| (0..turns).any(|row| moving[(row, column)])).collect();
        let mut vectors: Vec<(String, usize)> = Vec::new();
        for column in columns {
            let names = of_column(column);
            let own = names.first().filter(|first| {
                !first.is_empty()
                    && names.iter().all(|name| name == *first)
                    && vectors.iter().all(|(name, _)| name != *first)
            });
            vectors.push((own.cloned().unwrap_or_else(|| format!("column_{}", column + 1)), column));
        }
        let behind = |(row, column): &(usize, usize)| *row >= turns && moving[(*row, *column)];
        let all = (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column)));
        Self { rows, turns, vectors, others: all.filter(behind).collect() }
    }

    /// Where the numbers of the rotation are, of a matrix from this slot on: in the plane those of its first column,
    /// cosine and sine.
    fn turning(&self, start: usize) -> Vec<usize> {
        let columns = if self.turns == 2 { 1 } else { self.turns };
        let row = |row: usize| (0..columns).map(move |column| start + row * self.rows + column);
        (0..self.turns).flat_map(row).collect()
    }

    /// Lists its quantities, of a matrix from this slot on.
    fn shown(&self, matrix: &Quantity, start: usize) -> Vec<PlottedQuantity> {
        let quantity = |part: &str, components: Vec<String>, source: Source| PlottedQuantity {
            name: if part.is_empty() { matrix.name.to_owned() } else { format!("{}_{part}", matrix.name) },
            role: matrix.role,
            rotation: if matches!(source, Source::Rotation(_)) { components.len() } else { 0 },
            components,
            is_of_a_matrix: true,
            source,
        };
        let named = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let mut shown = Vec::new();
        if self.turns > 0 {
            let components = named(if self.turns == 3 { &["w", "x", "y", "z"] } else { &["re", "im"] });
            shown.push(quantity("rotation", components, Source::Rotation(self.turning(start))));
        }
        for (name, column) in &self.vectors {
            let entries = (0..self.turns).map(|row| start + row * self.rows + column).collect();
            shown.push(quantity(name, named(&["x", "y", "z"][..self.turns]), Source::Entries(entries)));
        }
        if (1..=ENTRIES).contains(&self.others.len()) {
            let names = self.others.iter().map(|(row, column)| format!("{}{}", row + 1, column + 1));
            let entries = self.others.iter().map(|(row, column)| start + row * self.rows + column);
            shown.push(quantity("", names.collect(), Source::Entries(entries.collect())));
        }
        shown
    }
}

/// Which entries of the group's elements are not those of the unit matrix: those of products of its basis.
fn moving(rows: usize, basis: &[DMatrix<f64>]) -> DMatrix<bool> {
    let at = |i, j| basis.iter().any(|element: &DMatrix<f64>| element[(i, j)] != 0.0);
    let mut moving = DMatrix::from_fn(rows, rows, at);
    // Warshall's algorithm
    for k in 0..rows {
        let before = moving.clone();
        moving = DMatrix::from_fn(rows, rows, |i, j| before[(i, j)] || before[(i, k)] && before[(k, j)]);
    }
    moving
}

/// Whether the first so many rows and columns of all elements are any rotation, and nothing else turns with them.
fn is_rotation(basis: &[DMatrix<f64>], moving: &DMatrix<bool>, k: usize) -> bool {
    let rows = moving.nrows();
    let block = |element: &DMatrix<f64>| element.view((0, 0), (k.min(rows), k.min(rows))).into_owned();
    let blocks: Vec<DMatrix<f64>> =
        basis.iter().map(block).filter(|block| block.iter().any(|entry| *entry != 0.0)).collect();
    k <= rows
        && blocks.len() == k * (k - 1) / 2
        && blocks.iter().all(|block| *block == -block.transpose())
        && (0..k).all(|i| (0..i).all(|j| blocks.iter().any(|block| block[(i, j)] != 0.0)))
        && (k..rows).all(|row| (0..k).all(|column| !moving[(row, column)]))
}

#[cfg(test)]
mod tests {
    use coadjoint::prelude::*;

    use super::*;
    use crate::Example;
    use crate::setup::Variation;

    /// A sled on ice, with the matrices of its group.
    #[lie_poisson_system(
        group = matrices {
            turn: [0, -1, 0; 1, 0, 0; 0, 0, 0],
            p1: [0, 0, 1; 0, 0, 0; 0, 0, 0],
            p2: [0, 0, 0; 0, 0, 1; 0, 0, 0]
        },
        retractions(Cayley),
    )]
    struct Sled {
        #[inertia]
        inertia: Vector3<f64>,
    }

    impl Example for Sled {
        const UNITS: &'static [(&'static str, &'static str)] = &[("element_p", "m")];

        fn example() -> (Self, SledState) {
            let element = matrix![0.0, -1.0, 3.0; 1.0, 0.0, 5.0; 0.0, 0.0, 1.0];
            (
                Self { inertia: vector![1.0, 2.0, 3.0] },
                SledState { element, momentum: vector![0.1, 0.2, 0.3] },
            )
        }
    }

    #[test]
    fn a_matrix_is_shown_as_its_rotation_and_its_vector() {
        let entry = Sled::entry();
        let names: Vec<&str> = entry.plotted.all().iter().map(|quantity| quantity.name.as_str()).collect();
        assert_eq!(names, ["element_rotation", "element_p", "momentum"]);
        let numbers = entry.plotted.numbers(&entry.example.state);
        assert_eq!(numbers[..7], [0.0, 1.0, 3.0, 5.0, 0.1, 0.2, 0.3]);
        // behind them the matrix
        assert_eq!((numbers.len(), entry.plotted.quantities.len()), (16, 4));
        assert_eq!(entry.plotted.rotations(), [[0, 3]]);
        assert_eq!(entry.unknown_units(), [""; 0]);
        // a state without matrices is shown as it is
        let top = crate::test_systems::catalogue().system("heavy_top").expect("it is there");
        let names: Vec<&str> = top.plotted.all().iter().map(|quantity| quantity.name.as_str()).collect();
        assert_eq!(names, ["attitude", "momentum", "gamma"]);
        assert_eq!(top.plotted.numbers(&top.example.state), top.example.state);
    }

    #[test]
    fn members_of_an_ensemble_stay_on_their_group() {
        let entry = Sled::entry();
        let setup = &entry.example;
        let parse = |spread: &str| Variation::parse(&entry, setup, &[spread.to_owned()]);
        let variation = parse("element=0.2").expect("a width");
        assert_eq!(variation.words, ["element displaced by up to 0.2"]);
        for member in 0..5 {
            let state = variation.member(&entry, setup, 7, member).state;
            let element = Matrix3::from_row_slice(&state[..9]);
            let turned = element.fixed_view::<2, 2>(0, 0);
            assert!((turned.transpose() * turned - Matrix2::identity()).norm() < 1e-14, "{element}");
            assert_eq!(state[6..9], [0.0, 0.0, 1.0]);
            assert!((element - Matrix3::from_row_slice(&setup.state[..9])).norm() > 1e-3, "{element}");
        }
        for spread in ["element=5%", "element=5deg", "element_11=0.1", "element=0.1,0.2"] {
            let error = parse(spread).expect_err("no width of an element").to_string();
            assert!(error.contains("write `element=0.1`"), "{error}");
        }
    }

    fn unit(rows: usize, entries: &[(usize, usize, f64)]) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(rows, rows);
        entries.iter().for_each(|&(i, j, value)| matrix[(i, j)] = value);
        matrix
    }

    /// Rotations about the axes, in matrices of so many rows.
    fn rotations(rows: usize) -> Vec<DMatrix<f64>> {
        [(2, 1), (0, 2), (1, 0)].map(|(i, j)| unit(rows, &[(i, j, 1.0), (j, i, -1.0)])).to_vec()
    }

    #[test]
    fn a_rigid_motion_with_a_velocity_is_a_rotation_and_two_vectors() {
        let vectors = [3, 4].map(|column| (0..3).map(move |row| unit(5, &[(row, column, 1.0)])));
        let basis: Vec<DMatrix<f64>> =
            rotations(5).into_iter().chain(vectors.into_iter().flatten()).collect();
        let parts = Parts::of(5, &basis, &["x", "y", "z", "v1", "v2", "v3", "p1", "p2", "p3"]);
        assert_eq!((parts.turns, parts.others.len()), (3, 0));
        assert_eq!(parts.vectors, [("v".to_owned(), 3), ("p".to_owned(), 4)]);
        assert_eq!(parts.turning(2), [2, 3, 4, 7, 8, 9, 12, 13, 14]);
        // with a time, as in Galilei's group
        let basis: Vec<DMatrix<f64>> = basis.into_iter().chain([unit(5, &[(3, 4, 1.0)])]).collect();
        let names = ["x", "y", "z", "v1", "v2", "v3", "p1", "p2", "p3", "t"];
        assert_eq!(Parts::of(5, &basis, &names).others, [(3, 4)]);
    }

    #[test]
    fn what_is_no_rotation_is_shown_by_its_entries_or_not_at_all() {
        let all: Vec<DMatrix<f64>> = (0..4).map(|k| unit(2, &[(k / 2, k % 2, 1.0)])).collect();
        let parts = Parts::of(2, &all, &["e11", "e12", "e21", "e22"]);
        assert_eq!((parts.turns, parts.others.len()), (0, 4));
        // a boost is none, though the plane turns
        let lorentz = vec![
            unit(3, &[(1, 0, 1.0), (0, 1, -1.0)]),
            unit(3, &[(0, 2, 1.0), (2, 0, 1.0)]),
            unit(3, &[(1, 2, 1.0), (2, 1, 1.0)]),
        ];
        let parts = Parts::of(3, &lorentz, &["rotation", "boost_x", "boost_y"]);
        assert_eq!((parts.turns, parts.others.len()), (0, 9));
        let (role, kind) = (Role::Configuration, Kind::Matrix(0, 0));
        let matrix =
            Quantity { name: "element", role, kind, components: &[], tangent: (0, 0), unit: None, doc: "" };
        assert!(parts.shown(&matrix, 0).is_empty());
        // the first column of a rotation in the plane has its cosine and its sine
        let plane = [unit(2, &[(1, 0, 1.0), (0, 1, -1.0)])];
        assert_eq!(Parts::of(2, &plane, &["angle"]).turning(0), [0, 2]);
    }
}
