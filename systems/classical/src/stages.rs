//! The equations of a step's stages, and how they are solved.

use nalgebra::{DMatrix, DVector};
use num_rational::Ratio;

use super::Diverged;
use super::exact::Exact;
use super::tableau::Tableau;

/// More corrections than any solvable step takes.
const MAX_ITERATIONS: u32 = 40;

/// More sweeps than a fixed-point iteration takes that halves its error each time.
const MAX_SWEEPS: u32 = 60;

/// A correction this small, relative to the state, is the last: central differences leave the next one below rounding.
const LAST_CORRECTION: f64 = 1e-12;

/// The cube root of the machine epsilon, which balances truncation and rounding of central differences.
const DIFFERENCE: f64 = 6.06e-6;

/// The size, relative to the whole state, that a component is taken to have at least.
const SMALL: f64 = 1e-4;

/// Weights of a sum in `f64`, all over one divisor: whole numbers where they are fractions, so that weights that add up to one do so exactly.
/// Else each step would be off by the same rounding.
#[derive(Clone, Debug, PartialEq)]
struct Weights {
    weights: Vec<f64>,
    divisor: f64,
}

impl Weights {
    fn of<const D: u32>(row: &[Exact<D>]) -> Self {
        let fractions: Option<Vec<(i128, i128)>> = row.iter().map(Exact::as_fraction).collect();
        match fractions {
            Some(fractions) => {
                // what a fraction in lowest terms lacks of the others' denominator
                let multiple = |common: i128, below: i128| common * Ratio::new(below, common).numer();
                let divisor = fractions.iter().fold(1, |common, (_, below)| multiple(common, *below));
                let weights = fractions.iter().map(|(above, below)| (above * (divisor / below)) as f64);
                Self { weights: weights.collect(), divisor: divisor as f64 }
            }
            None => Self { weights: row.iter().map(|x| x.to_f64()).collect(), divisor: 1.0 },
        }
    }

    /// A weight by itself.
    fn get(&self, j: usize) -> f64 {
        self.weights[j] / self.divisor
    }
}

/// Writes `f(t, x)`.
pub(super) type Rate<'a> = dyn FnMut(f64, &[f64], &mut [f64]) + 'a;

/// A tableau in `f64`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    a: Vec<Weights>,
    b: Weights,
    c: Vec<f64>,
    explicit: bool,
    /// Whether the last stage is the state after the step: `a_sj = b_j`. It is then better known than what rates of stiff systems make of it.
    ends_at_stage: bool,
}

impl Table {
    pub(super) fn of<const D: u32>(tableau: &Tableau<D>) -> Self {
        Self {
            a: tableau.a().iter().map(|row| Weights::of(row)).collect(),
            b: Weights::of(tableau.b()),
            c: tableau.c().iter().map(|c| c.to_f64()).collect(),
            explicit: tableau.is_explicit(),
            ends_at_stage: tableau.a().last().is_some_and(|row| row == tableau.b()),
        }
    }
}

/// The equations `X_i = x + h Σ a_ij f(t + c_j h, X_j)` of a step, where each component has the table of its part.
pub(super) struct Equations<'a> {
    /// One for each part; all have as many stages. Time goes with the first.
    pub(super) tables: &'a [&'a Table],
    /// Which part a component is of.
    pub(super) part: &'a dyn Fn(usize) -> usize,
    /// Writes `f(t, x)`.
    pub(super) field: &'a mut Rate<'a>,
    pub(super) time: f64,
    pub(super) start: &'a [f64],
    pub(super) h: f64,
}

/// Values and slopes of all stages, one after the other.
struct Stages {
    values: Vec<f64>,
    slopes: Vec<f64>,
    iterations: u32,
}

impl Equations<'_> {
    /// The state after the step, and the iterations it took.
    pub(super) fn solve(mut self) -> Result<(Vec<f64>, u32), Diverged> {
        let solved = if self.tables.iter().all(|table| table.explicit) {
            Some(self.explicit())
        } else {
            self.fixed_point()
        };
        let stages = match solved {
            Some(stages) => stages,
            None => self.newton()?,
        };
        let end = self.end(&stages);
        if end.iter().all(|x| x.is_finite()) {
            Ok((end, stages.iterations))
        } else {
            Err(Diverged::NotFinite)
        }
    }

    fn count(&self) -> usize {
        self.tables[0].c.len()
    }

    /// All stages at the start of the step.
    fn at_start(&self) -> Stages {
        let values = self.start.repeat(self.count());
        Stages { slopes: vec![0.0; values.len()], values, iterations: 0 }
    }

    /// `f` at a stage.
    fn slope(&mut self, i: usize, stages: &mut Stages) {
        let n = self.start.len();
        let time = self.time + self.tables[0].c[i] * self.h;
        let place = i * n..(i + 1) * n;
        (self.field)(time, &stages.values[place.clone()], &mut stages.slopes[place]);
    }

    /// `x + h Σ w_j k_j` in one component.
    fn sum(&self, row: &Weights, slopes: &[f64], component: usize) -> f64 {
        let slopes = slopes.iter().skip(component).step_by(self.start.len());
        let sum: f64 = row.weights.iter().zip(slopes).map(|(weight, slope)| weight * slope).sum();
        self.start[component] + sum * (self.h / row.divisor)
    }

    /// Puts a stage where the slopes say; the answer is the square of how far it was from there.
    fn put(&self, i: usize, stages: &mut Stages) -> f64 {
        let n = self.start.len();
        let mut change = 0.0;
        for component in 0..n {
            let table = self.tables[(self.part)(component)];
            let value = self.sum(&table.a[i], &stages.slopes, component);
            change += (value - stages.values[i * n + component]).powi(2);
            stages.values[i * n + component] = value;
        }
        change
    }

    fn end(&mut self, stages: &Stages) -> Vec<f64> {
        let n = self.start.len();
        let last = (self.count() - 1) * n;
        let component = |component: usize| {
            let table = self.tables[(self.part)(component)];
            if table.ends_at_stage {
                stages.values[last + component]
            } else {
                self.sum(&table.b, &stages.slopes, component)
            }
        };
        (0..n).map(component).collect()
    }

    /// One stage after the other.
    fn explicit(&mut self) -> Stages {
        let mut stages = self.at_start();
        for i in 0..self.count() {
            self.put(i, &mut stages);
            self.slope(i, &mut stages);
        }
        stages
    }

    /// Sweeps over the stages, until they are at rest; none where that does not contract. Stages that follow one from the other, in any order,
    /// are at rest after as many sweeps as there are.
    fn fixed_point(&mut self) -> Option<Stages> {
        let count = self.count();
        let mut stages = self.at_start();
        (0..count).for_each(|i| self.slope(i, &mut stages));
        let mut last = f64::NAN;
        for sweep in 1..=MAX_SWEEPS {
            let mut square = 0.0;
            for i in 0..count {
                square += self.put(i, &mut stages);
                self.slope(i, &mut stages);
            }
            let (change, scale) = (square.sqrt(), norm(&stages.values) + norm(self.start));
            stages.iterations = sweep;
            let contracts = change <= 0.5 * last;
            // down to roundoff, where it gets no smaller
            if change == 0.0 || (change <= LAST_CORRECTION * scale && !contracts && sweep > 1) {
                return Some(stages);
            }
            if !contracts && sweep > 2 * count as u32 {
                return None;
            }
            last = change;
        }
        None
    }

    /// Newton's iteration from the start of the step.
    fn newton(&mut self) -> Result<Stages, Diverged> {
        let mut stages = self.at_start();
        let mut last = f64::NAN;
        for iterations in 0..MAX_ITERATIONS {
            let (matrix, residual) = self.linearized(&mut stages);
            let failed = |iterations, correction| Diverged::NoConvergence { iterations, correction };
            if iterations == 0 && !residual.iter().all(|x| x.is_finite()) {
                return Err(Diverged::NotFinite);
            }
            let Some(correction) = matrix.lu().solve(&residual) else {
                return Err(failed(iterations, last));
            };
            stages.values.iter_mut().zip(correction.iter()).for_each(|(x, by)| *x += by);
            if !stages.values.iter().all(|x| x.is_finite()) {
                return Err(failed(iterations + 1, last));
            }
            let (size, scale) = (correction.norm(), norm(&stages.values) + norm(self.start));
            if size <= LAST_CORRECTION * scale {
                (0..self.count()).for_each(|i| self.slope(i, &mut stages));
                stages.iterations = iterations + 1;
                return Ok(stages);
            }
            last = size / scale;
        }
        Err(Diverged::NoConvergence { iterations: MAX_ITERATIONS, correction: last })
    }

    /// The matrix `1 − h a_ij ∂f/∂x(X_j)`, and what the stages lack of their equations.
    fn linearized(&mut self, stages: &mut Stages) -> (DMatrix<f64>, DVector<f64>) {
        let (n, count) = (self.start.len(), self.count());
        let mut matrix = DMatrix::identity(count * n, count * n);
        for j in 0..count {
            let time = self.time + self.tables[0].c[j] * self.h;
            let jacobian = jacobian(&mut *self.field, time, &stages.values[j * n..(j + 1) * n]);
            for (i, row) in (0..count).flat_map(|i| (0..n).map(move |row| (i, row))) {
                let weight = self.h * self.tables[(self.part)(row)].a[i].get(j);
                for column in 0..n {
                    matrix[(i * n + row, j * n + column)] -= weight * jacobian[(row, column)];
                }
            }
            self.slope(j, stages);
        }
        let residual = (0..count * n).map(|k| {
            let table = self.tables[(self.part)(k % n)];
            self.sum(&table.a[k / n], &stages.slopes, k % n) - stages.values[k]
        });
        let residual = DVector::from_iterator(count * n, residual);
        (matrix, residual)
    }
}

fn norm(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The matrix `∂f/∂x` by central differences.
///
/// A component is moved in proportion to its own size, unless that would be lost beside the others.
pub(super) fn jacobian(field: &mut Rate<'_>, time: f64, x: &[f64]) -> DMatrix<f64> {
    let (n, norm) = (x.len(), norm(x));
    let mut jacobian = DMatrix::zeros(n, n);
    let (mut moved, mut above, mut below) = (x.to_vec(), vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        let own = x[j].abs().max(SMALL * norm);
        let offset = DIFFERENCE * if own > 0.0 { own } else { 1.0 };
        moved[j] = x[j] + offset;
        let high = moved[j];
        field(time, &moved, &mut above);
        moved[j] = x[j] - offset;
        // of the points as they were rounded
        let distance = high - moved[j];
        field(time, &moved, &mut below);
        moved[j] = x[j];
        for i in 0..n {
            jacobian[(i, j)] = (above[i] - below[i]) / distance;
        }
    }
    jacobian
}
