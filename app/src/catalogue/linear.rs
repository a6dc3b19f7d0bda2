//! Small linear algebra for what happens once in a run: few lines, and little to compile.

use nalgebra::{Matrix3, Vector3};

/// The solution of `Σ x_k columns_k = right`; none if the columns are dependent.
#[cfg(feature = "program")]
pub(crate) fn solve(columns: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    // rows, each with its right side behind it
    let entry = |i: usize, k: usize| columns.get(k).map_or(right[i], |column| column[i]);
    let mut rows: Vec<Vec<f64>> = (0..n).map(|i| (0..=n).map(|k| entry(i, k)).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, pivot);
        let top = rows[k].clone();
        if top[k] == 0.0 {
            return None;
        }
        for row in &mut rows[k + 1..] {
            let factor = row[k] / top[k];
            row.iter_mut().zip(&top).for_each(|(x, y)| *x -= factor * y);
        }
    }
    let mut solution = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * solution[j]).sum();
        solution[k] = (rows[k][n] - known) / rows[k][k];
    }
    Some(solution)
}

/// The vector to which the flow of a linear system takes this one in a unit of time: the exponential of the matrix with these columns, times it.
#[cfg(feature = "program")]
pub(crate) fn flow(columns: &[Vec<f64>], mut vector: Vec<f64>) -> Vec<f64> {
    let norm = columns.iter().map(|column| column.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    // by parts in which the series ends after some twenty terms; what is larger is no flow that is asked for
    let parts = norm.ceil().clamp(1.0, 1e4);
    // what was lost in adding the changes of all parts so far
    let mut lost = vec![0.0; vector.len()];
    for _ in 0..parts as usize {
        // `Σ (A/parts)ᵏ/k!` without its first term, from the least term to the largest
        let mut change = vec![0.0; vector.len()];
        for order in (1..=24).rev() {
            let sum: Vec<f64> = vector.iter().zip(&change).map(|(x, change)| x + change).collect();
            change.fill(0.0);
            for (column, x) in columns.iter().zip(sum) {
                let factor = x / (parts * f64::from(order));
                change.iter_mut().zip(column).for_each(|(sum, y)| *sum += factor * y);
            }
        }
        for ((x, change), lost) in vector.iter_mut().zip(change).zip(&mut lost) {
            let (before, change) = (*x, change + *lost);
            *x = before + change;
            let added = *x - before;
            *lost = (before - (*x - added)) + (change - added);
        }
    }
    vector
}

/// The eigenvalues of a symmetric matrix, and a rotation whose columns are eigenvectors, by Jacobi's method.
pub(crate) fn symmetric_eigen(matrix: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let (mut diagonal, mut axes) = (*matrix, Matrix3::identity());
    // it converges quadratically: five rounds reach rounding
    for _ in 0..12 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if diagonal[(i, j)] == 0.0 {
                continue;
            }
            let slope = (diagonal[(j, j)] - diagonal[(i, i)]) / (2.0 * diagonal[(i, j)]);
            let tangent = slope.signum() / (slope.abs() + slope.hypot(1.0));
            let cos = tangent.hypot(1.0).recip();
            let sin = tangent * cos;
            let mut turn = Matrix3::identity();
            (turn[(i, i)], turn[(j, j)], turn[(i, j)], turn[(j, i)]) = (cos, cos, sin, -sin);
            diagonal = turn.transpose() * diagonal * turn;
            axes *= turn;
        }
    }
    (diagonal.diagonal(), axes)
}

#[cfg(all(test, feature = "program"))]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::setup::random::Random;

    fn matrix(n: usize, random: &mut Random) -> Vec<Vec<f64>> {
        (0..n).map(|_| (0..n).map(|_| 3.0 * random.even()).collect()).collect()
    }

    fn dynamic(columns: &[Vec<f64>]) -> DMatrix<f64> {
        let columns: Vec<_> = columns.iter().map(|column| DVector::from_vec(column.clone())).collect();
        DMatrix::from_columns(&columns)
    }

    #[test]
    fn equations_are_solved() {
        let mut random = Random::new(3, 0);
        for n in 1..9 {
            let columns = matrix(n, &mut random);
            let right: Vec<f64> = (0..n).map(|_| random.even()).collect();
            let solution = DVector::from_vec(solve(&columns, &right).expect("independent"));
            let left = dynamic(&columns) * &solution;
            let error = (left - DVector::from_vec(right)).norm();
            assert!(error < 1e-12 * (1.0 + solution.norm()), "{n}: {error}");
        }
        // the first pivot is zero
        assert_eq!(solve(&[vec![0.0, 2.0], vec![1.0, 0.0]], &[3.0, 4.0]), Some(vec![2.0, 3.0]));
        assert_eq!(solve(&[vec![1.0, 2.0], vec![2.0, 4.0]], &[1.0, 1.0]), None);
        assert_eq!(solve(&[], &[]), Some(Vec::new()));
    }

    #[test]
    fn flows_are_exponentials() {
        let mut random = Random::new(4, 0);
        for n in 1..7 {
            let columns = matrix(n, &mut random);
            let vector: Vec<f64> = (0..n).map(|_| random.even()).collect();
            // the inverse flow leads back
            let back: Vec<Vec<f64>> =
                columns.iter().map(|column| column.iter().map(|x| -x).collect()).collect();
            let there = flow(&columns, vector.clone());
            let again = flow(&back, there.clone());
            let error = again.iter().zip(&vector).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            let size = there.iter().map(|x| x.abs()).fold(1.0, f64::max);
            assert!(error < 1e-11 * size, "{n}: {error:e} of {size}");
        }
        let turn = flow(&[vec![0.0, 2.0], vec![-2.0, 0.0]], vec![1.0, 0.0]);
        let (sin, cos) = 2.0_f64.sin_cos();
        assert!((turn[0] - cos).abs() < 1e-15 && (turn[1] - sin).abs() < 1e-15, "{turn:?}");
    }

    #[test]
    fn symmetric_matrices_have_axes() {
        let mut random = Random::new(5, 0);
        for round in 0..200 {
            let any = Matrix3::from_fn(|_, _| random.even() * 10_f64.powi(round % 7 - 3));
            let symmetric = any + any.transpose();
            let (values, axes) = symmetric_eigen(&symmetric);
            let scale = symmetric.norm();
            let error = (axes * Matrix3::from_diagonal(&values) * axes.transpose() - symmetric).norm();
            assert!(error < 1e-14 * scale, "{error:e}");
            assert!((axes.transpose() * axes - Matrix3::identity()).norm() < 1e-14);
            assert!(axes.determinant() > 0.0);
        }
        let (values, axes) = symmetric_eigen(&Matrix3::from_diagonal(&Vector3::new(3.0, 1.0, 2.0)));
        assert_eq!((values, axes), (Vector3::new(3.0, 1.0, 2.0), Matrix3::identity()));
    }
}
