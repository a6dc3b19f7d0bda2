//! The quantities that pictures show: of a configuration that is a matrix its rotation and its vectors.
//!
//! Nothing here knows a group: what its elements move is seen of some.

use std::borrow::Cow;
use std::ops::Range;

use coadjoint::erased::{self, RetractionKind};
#[cfg(test)]
use coadjoint::system::Kind;
use coadjoint::system::{Quantity, Role, Side};
use nalgebra::{DMatrix, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::observable::Observable;
use super::quantities::{component_unit, matrix_order, rotation, tangent_length};

/// The most entries of a matrix that a plot tells apart.
const ENTRIES: usize = 6;
/// Entries that differ by less are the same.
const ROUNDOFF: f64 = 1e-9;

/// The quantities of a state, and what goes with it, as pictures show them.
#[derive(Clone, Debug)]
pub(crate) struct PlottedQuantities {
    plotted: Vec<PlottedQuantity>,
    /// For what they move.
    matrices: Vec<PlottedQuantity>,
    /// How many numbers a state is, and what is shown with it.
    numbers: usize,
    side: Side,
}

/// A quantity as pictures show it: one of the state, a part of a matrix, or a control.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlottedQuantity {
    pub(crate) name: String,
    /// None of a quantity of the system's own.
    pub(crate) role: Option<Role>,
    pub(crate) components: Vec<String>,
    /// Their units.
    pub(crate) units: Vec<String>,
    /// So many of its components are those of a rotation: four in space, two in the plane, none of a vector.
    pub(crate) rotation: usize,
    /// Whether it is a matrix, or a part of one.
    pub(crate) is_of_a_matrix: bool,
    /// Its place among the [numbers](PlottedQuantities::numbers).
    pub(crate) slots: Range<usize>,
    /// Where its numbers are behind a state's: nine of a matrix's rotation in space.
    source: Vec<usize>,
    /// Where its perturbation is in a tangent vector; of a matrix that of all of it.
    tangent: Range<usize>,
}

impl PlottedQuantity {
    fn of(quantity: &Quantity, slots: Range<usize>) -> Self {
        Self {
            name: quantity.name.to_owned(),
            role: Some(quantity.role),
            components: quantity.components.iter().map(|&name| name.to_owned()).collect(),
            units: (0..quantity.components.len()).map(|k| component_unit(quantity, k).to_owned()).collect(),
            rotation: rotation(quantity).map_or(0, |(count, _)| count),
            is_of_a_matrix: false,
            slots: 0..0,
            source: slots.collect(),
            tangent: quantity.tangent(),
        }
    }

    /// Writes a name in words. A matrix that is the only configuration has its name by default: its parts go without.
    pub(crate) fn title(name: &str) -> String {
        name.strip_prefix("element_").unwrap_or(name).replace('_', " ")
    }

    /// Splits its name, if it is one of several: `wheels_momentum` and `0`, `wheel_momentum` and `x`.
    fn place(&self) -> Option<(String, &str)> {
        let is_place = |word: &&str| {
            ["x", "y", "z"].contains(word) || word.chars().all(|letter| letter.is_ascii_digit())
        };
        let place = self.name.split('_').skip(1).find(is_place).filter(|word| !word.is_empty())?;
        let rest: Vec<&str> = self.name.split('_').filter(|word| *word != place).collect();
        Some((rest.join("_"), place))
    }

    /// Tells whether another one has the same components.
    fn is_like(&self, other: &Self) -> bool {
        let of = |of: &Self| (of.role, of.rotation, of.components.clone(), of.units.clone());
        of(self) == of(other)
    }

    /// Tells whether it turns or moves in space, not only in a plane or on a line.
    fn is_spatial(&self) -> bool {
        match (self.rotation, self.components.len()) {
            (4, _) => self.role == Some(Role::Configuration),
            (2, _) => false,
            // parts of a matrix have fewer
            (_, count) => count == 3 || (self.is_of_a_matrix && count > ENTRIES),
        }
    }
}

impl PlottedQuantities {
    /// Finds what pictures show of a system, with an example of its states, and of the controls behind them.
    pub(crate) fn of(system: &dyn erased::System, example: &[f64], controls: &[Quantity]) -> Self {
        let state = system.description().state;
        let (mut plotted, mut matrices) = (Vec::new(), Vec::new());
        for ((quantity, slots), next) in
            Quantity::with_ranges(state).zip(state.iter().skip(1).chain([&state[0]]))
        {
            let own = PlottedQuantity::of(quantity, slots.clone());
            match matrix_order(quantity) {
                Some(rows) => {
                    let parts =
                        Parts::of(&elements(system, example, (quantity, &slots), rows), next.components);
                    plotted.extend(parts.shown(quantity, slots.start));
                    matrices.push(PlottedQuantity { is_of_a_matrix: true, ..own });
                }
                None => plotted.push(own),
            }
        }
        let behind = Quantity::with_ranges(controls);
        plotted.extend(behind.map(|(control, slots)| {
            PlottedQuantity::of(control, slots.start + example.len()..slots.end + example.len())
        }));
        let numbers = example.len() + controls.iter().map(|control| control.components.len()).sum::<usize>();
        let mut all = Self { plotted, matrices, numbers, side: system.description().side };
        all.arrange();
        all
    }

    /// Adds a quantity of the system's own behind all others.
    pub(crate) fn push(&mut self, own: &Observable) {
        self.plotted.push(PlottedQuantity {
            name: own.name.clone(),
            role: None,
            components: vec![String::new()],
            units: vec![own.unit.clone()],
            rotation: 0,
            is_of_a_matrix: false,
            slots: 0..0,
            source: vec![self.numbers],
            tangent: 0..0,
        });
        self.numbers += 1;
        self.arrange();
    }

    /// Gives each quantity its place.
    fn arrange(&mut self) {
        let mut end = 0;
        for quantity in self.plotted.iter_mut().chain(&mut self.matrices) {
            quantity.slots = end..end + quantity.components.len();
            end = quantity.slots.end;
        }
    }

    /// Lists what is plotted.
    pub(crate) fn all(&self) -> &[PlottedQuantity] {
        &self.plotted
    }

    /// Finds what a quantity is one of several of, as an element of an array, by a common name, and which of them it is.
    pub(crate) fn array(&self, quantity: &PlottedQuantity) -> Option<(String, String)> {
        let (stem, place) = quantity.place()?;
        let is_beside = |other: &&PlottedQuantity| {
            other.is_like(quantity) && other.place().is_some_and(|(other, _)| other == stem)
        };
        (self.all().iter().filter(is_beside).count() > 1).then(|| (stem, place.to_owned()))
    }

    /// Finds a quantity of this name, or a matrix.
    pub(crate) fn find(&self, name: &str) -> Option<&PlottedQuantity> {
        self.plotted.iter().chain(&self.matrices).find(|quantity| quantity.name == name)
    }

    /// Tells whether a quantity of this name turns or moves in space.
    pub(crate) fn is_spatial(&self, name: &str) -> bool {
        self.find(name).is_some_and(PlottedQuantity::is_spatial)
    }

    /// Computes the angular velocity of each rotation in body axes, of one in the plane the first component, rad/s.
    pub(crate) fn rates(
        &self,
        system: &dyn erased::System,
        (state, time, control): (&[f64], f64, &[f64]),
    ) -> Vec<[f64; 3]> {
        let mut rotating = self.all().iter().filter(|quantity| quantity.rotation > 0).peekable();
        if rotating.peek().is_none() {
            return Vec::new();
        }
        let motion = system.motion(state, time, control);
        let stored = match self.matrices.is_empty() {
            true => Vec::new(),
            false => system.vector_field(state, time, control),
        };
        let at = |numbers: &[f64], slot: usize| numbers.get(slot).copied().unwrap_or(f64::NAN);
        let rate = |quantity: &PlottedQuantity| {
            let source = &quantity.source;
            let matrix = |of: &[f64]| Matrix3::from_row_iterator(source.iter().map(|&slot| at(of, slot)));
            match (quantity.is_of_a_matrix, quantity.rotation) {
                (true, 2) => {
                    let [cosine, sine] = [source[0], source[1]];
                    let turning =
                        at(state, cosine) * at(&stored, sine) - at(state, sine) * at(&stored, cosine);
                    [turning, 0.0, 0.0]
                }
                (true, _) => {
                    let hat = matrix(state).tr_mul(&matrix(&stored));
                    [hat[(2, 1)], hat[(0, 2)], hat[(1, 0)]]
                }
                (false, 2) => [at(&motion, quantity.tangent.start), 0.0, 0.0],
                (false, _) => {
                    let rate = Vector3::from_fn(|k, _| at(&motion, quantity.tangent.start + k));
                    let [w, i, j, k] = [0, 1, 2, 3].map(|k| at(state, source[k]));
                    let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
                    let is_of_space = self.side == Side::Right;
                    if is_of_space { attitude.inverse() * rate } else { rate }.into()
                }
            }
        };
        rotating.map(rate).collect()
    }

    /// Reads the numbers of all quantities, and of the matrices behind them, from a state and what goes with it.
    pub(crate) fn numbers<'s>(&self, state: &'s [f64]) -> Cow<'s, [f64]> {
        if self.matrices.is_empty() {
            // it is shown as it is
            return Cow::Borrowed(state);
        }
        let at = |slot: &usize| state.get(*slot).copied().unwrap_or(f64::NAN);
        let mut numbers = Vec::with_capacity(state.len());
        for PlottedQuantity { source, components, .. } in self.plotted.iter().chain(&self.matrices) {
            if source.len() == components.len() {
                numbers.extend(source.iter().map(at));
                continue;
            }
            let matrix = Matrix3::from_row_iterator(source.iter().map(at));
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
            let [i, j, k, w]: [f64; 4] = rotation.coords.into();
            numbers.extend([w, i, j, k]);
        }
        Cow::Owned(numbers)
    }
}

/// Displaces the unit matrix along each coordinate, and along all.
fn elements(
    system: &dyn erased::System,
    example: &[f64],
    (quantity, slots): (&Quantity, &Range<usize>),
    rows: usize,
) -> (Vec<DMatrix<f64>>, DMatrix<f64>) {
    let tangent = quantity.tangent();
    let mut unit = example.to_vec();
    unit[slots.clone()].copy_from_slice(DMatrix::<f64>::identity(rows, rows).as_slice());
    let displaced = |from: &[f64], along: &dyn Fn(usize) -> f64| {
        let mut by = vec![0.0; tangent_length(system.description().state)];
        tangent.clone().for_each(|k| by[k] = along(k));
        system.displace(from, RetractionKind::Exponential, &by)
    };
    let matrix = |state: &[f64]| DMatrix::from_row_slice(rows, rows, &state[slots.clone()]);
    let along = tangent.clone().map(|k| matrix(&displaced(&unit, &|other| f64::from(u8::from(other == k)))));
    // what no two displacements in turn move, nothing moves
    let all = displaced(&displaced(&unit, &|k| (k as f64).cos()), &|k| (k as f64).sin());
    (along.collect(), matrix(&all))
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
    /// Finds them in elements along each coordinate, and along all.
    fn of((along, all): &(Vec<DMatrix<f64>>, DMatrix<f64>), coordinates: &[&str]) -> Self {
        let rows = all.nrows();
        let moves = |element: &DMatrix<f64>, row: usize, column: usize| {
            (element[(row, column)] - f64::from(u8::from(row == column))).abs() > ROUNDOFF
        };
        let is_rotation = |&k: &usize| {
            let block = all.view((0, 0), (k.min(rows), k.min(rows)));
            k <= rows
                && (0..k).all(|column| (0..rows).all(|row| moves(all, row, column) == (row < k)))
                && (block.tr_mul(&block) - DMatrix::identity(k, k)).amax() < ROUNDOFF
        };
        let turns = [3, 2].into_iter().find(is_rotation).unwrap_or(0);
        let turned =
            |element: &DMatrix<f64>, column: usize| (0..turns).any(|row| moves(element, row, column));
        let mut vectors: Vec<(String, usize)> = Vec::new();
        for column in (turns..rows).filter(|&column| turned(all, column)) {
            let own = along.iter().zip(coordinates).filter(|(element, _)| turned(element, column));
            let stems: Vec<&str> =
                own.map(|(_, name)| name.trim_end_matches(|letter: char| letter.is_ascii_digit())).collect();
            let stem = stems.first().filter(|first| {
                !first.is_empty()
                    && stems.iter().all(|stem| stem == *first)
                    && vectors.iter().all(|(name, _)| name != *first)
            });
            let name = stem.map_or_else(|| format!("column_{}", column + 1), |&stem| stem.to_owned());
            vectors.push((name, column));
        }
        let behind = (turns..rows).flat_map(|row| (0..rows).map(move |column| (row, column)));
        let others = behind.filter(|&(row, column)| moves(all, row, column)).collect();
        Self { rows, turns, vectors, others }
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
        let quantity = |part: &str, components: &[&str], source: Vec<usize>| PlottedQuantity {
            name: if part.is_empty() { matrix.name.to_owned() } else { format!("{}_{part}", matrix.name) },
            role: Some(matrix.role),
            components: components.iter().map(|&name| name.to_owned()).collect(),
            units: source.iter().map(|slot| component_unit(matrix, slot - start).to_owned()).collect(),
            rotation: 0,
            is_of_a_matrix: true,
            slots: 0..0,
            source,
            tangent: matrix.tangent(),
        };
        let slot = |row: usize, column: usize| start + row * self.rows + column;
        let mut shown = Vec::new();
        if self.turns > 0 {
            let components: &[&str] = if self.turns == 3 { &["w", "x", "y", "z"] } else { &["re", "im"] };
            let (rotation, units) = (components.len(), vec![String::new(); components.len()]);
            let turning = quantity("rotation", components, self.turning(start));
            shown.push(PlottedQuantity { rotation, units, ..turning });
        }
        for (name, column) in &self.vectors {
            let entries = (0..self.turns).map(|row| slot(row, *column)).collect();
            shown.push(quantity(name, &["x", "y", "z"][..self.turns], entries));
        }
        if (1..=ENTRIES).contains(&self.others.len()) {
            let names = self.others.iter().map(|(row, column)| format!("{}{}", row + 1, column + 1));
            let entries = self.others.iter().map(|&(row, column)| slot(row, column)).collect();
            let components = names.collect();
            shown.push(PlottedQuantity { components, ..quantity("", &[], entries) });
        }
        shown
    }
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
        units(element = "1, 1, m", momentum = "kg m²/s, kg m/s, kg m/s"),
    )]
    struct Sled {
        #[inertia]
        inertia: Vector3<f64>,
    }

    impl Example for Sled {
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
        assert_eq!((numbers.len(), entry.plotted.matrices.len()), (16, 1));
        let (system, state) = (entry.system(&entry.example.parameters), &entry.example.state);
        // momentum over inertia
        let [[rate, ..]] = entry.plotted.rates(&*system, (state, 0.0, &[]))[..] else {
            panic!("one rotation")
        };
        assert!((rate - 0.1).abs() < 1e-12, "{rate}");
        let units: Vec<Vec<&str>> = entry
            .plotted
            .all()
            .iter()
            .map(|quantity| quantity.units.iter().map(String::as_str).collect())
            .collect();
        assert_eq!(units, [vec![""; 2], vec!["m"; 2], vec!["kg m²/s", "kg m/s", "kg m/s"]]);
        // a state without matrices is shown as it is
        let top = crate::tests::catalogue().system("heavy_top").expect("it is there");
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

    /// Elements of the group with this basis of its algebra: along each coordinate, and along all.
    fn elements_of(basis: &[DMatrix<f64>]) -> (Vec<DMatrix<f64>>, DMatrix<f64>) {
        let sum = |of: fn(f64) -> f64| -> DMatrix<f64> {
            basis.iter().zip(1..).map(|(element, k)| element * of(f64::from(k))).sum()
        };
        let exp = |element: &DMatrix<f64>| {
            let one = DMatrix::identity(element.nrows(), element.nrows());
            (1..40).rev().fold(one.clone(), |series, k| &one + element * series / f64::from(k))
        };
        (basis.iter().map(exp).collect(), exp(&sum(f64::cos)) * exp(&sum(f64::sin)))
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
        let parts = Parts::of(&elements_of(&basis), &["x", "y", "z", "v1", "v2", "v3", "p1", "p2", "p3"]);
        assert_eq!((parts.turns, parts.others.len()), (3, 0));
        assert_eq!(parts.vectors, [("v".to_owned(), 3), ("p".to_owned(), 4)]);
        assert_eq!(parts.turning(2), [2, 3, 4, 7, 8, 9, 12, 13, 14]);
        // with a time, as in Galilei's group
        let basis: Vec<DMatrix<f64>> = basis.into_iter().chain([unit(5, &[(3, 4, 1.0)])]).collect();
        let names = ["x", "y", "z", "v1", "v2", "v3", "p1", "p2", "p3", "t"];
        assert_eq!(Parts::of(&elements_of(&basis), &names).others, [(3, 4)]);
    }

    #[test]
    fn what_is_no_rotation_is_shown_by_its_entries_or_not_at_all() {
        let all: Vec<DMatrix<f64>> = (0..4).map(|k| unit(2, &[(k / 2, k % 2, 1.0)])).collect();
        let parts = Parts::of(&elements_of(&all), &["e11", "e12", "e21", "e22"]);
        assert_eq!((parts.turns, parts.others.len()), (0, 4));
        // a boost is none, though the plane turns
        let lorentz = vec![
            unit(3, &[(1, 0, 1.0), (0, 1, -1.0)]),
            unit(3, &[(0, 2, 1.0), (2, 0, 1.0)]),
            unit(3, &[(1, 2, 1.0), (2, 1, 1.0)]),
        ];
        let parts = Parts::of(&elements_of(&lorentz), &["rotation", "boost_x", "boost_y"]);
        assert_eq!((parts.turns, parts.others.len()), (0, 9));
        let (role, kind) = (Role::Configuration, Kind::Matrix(0, 0));
        let matrix =
            Quantity { name: "element", role, kind, components: &[], tangent: (0, 0), unit: None, doc: "" };
        assert!(parts.shown(&matrix, 0).is_empty());
        // the first column of a rotation in the plane has its cosine and its sine
        let plane = [unit(2, &[(1, 0, 1.0), (0, 1, -1.0)])];
        assert_eq!(Parts::of(&elements_of(&plane), &["angle"]).turning(0), [0, 2]);
    }
}
