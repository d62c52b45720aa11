//! Symmetric positive definite systems by plain loops: the order of every sum is written here, so that the last bits are
//! the same on every processor.

/// Numbers added side by side.
const LANES: usize = 8;

/// Sum of products.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = left.remainder().iter().zip(right.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in left.zip(right) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f64>() + rest
}

/// A square matrix by rows.
#[derive(Clone, Debug)]
pub(super) struct Square {
    pub(super) size: usize,
    pub(super) values: Vec<f64>,
}

impl Square {
    pub(super) fn zeros(size: usize) -> Self {
        Self { size, values: vec![0.0; size * size] }
    }

    pub(super) fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.size..(i + 1) * self.size]
    }

    pub(super) fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.size..(i + 1) * self.size]
    }

    /// Of a symmetric matrix.
    pub(super) fn times(&self, v: &[f64]) -> Vec<f64> {
        (0..self.size).map(|i| dot(self.row(i), v)).collect()
    }

    /// Makes of a symmetric positive definite matrix the lower factor of Cholesky; `None` where it is not definite.
    pub(super) fn into_cholesky(mut self) -> Option<Cholesky> {
        let n = self.size;
        for i in 0..n {
            let (above, from) = self.values.split_at_mut(i * n);
            let own = &mut from[..n];
            for j in 0..i {
                let other = &above[j * n..j * n + j + 1];
                own[j] = (own[j] - dot(&own[..j], &other[..j])) / other[j];
            }
            let left = own[i] - dot(&own[..i], &own[..i]);
            if left.is_nan() || left <= 0.0 {
                return None;
            }
            own[i] = left.sqrt();
            own[i + 1..].fill(0.0);
        }
        Some(Cholesky(self))
    }
}

/// `A = L Lᵀ`.
pub(super) struct Cholesky(Square);

impl Cholesky {
    /// `ln det A`
    pub(super) fn log_determinant(&self) -> f64 {
        (0..self.0.size).map(|i| 2.0 * units::math::ln(self.0.row(i)[i])).sum()
    }

    /// `A⁻¹ b`
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.0.size;
        let mut x = b.to_vec();
        for i in 0..n {
            x[i] = (x[i] - dot(&self.0.row(i)[..i], &x[..i])) / self.0.row(i)[i];
        }
        for i in (0..n).rev() {
            x[i] /= self.0.row(i)[i];
            let by = x[i];
            for (x, l) in x[..i].iter_mut().zip(&self.0.row(i)[..i]) {
                *x -= by * l;
            }
        }
        x
    }

    /// `A⁻¹`
    pub(super) fn inverse(&self) -> Square {
        let n = self.0.size;
        // Row j of `columns` is column j of L⁻¹, which begins at j.
        let mut columns = Square::zeros(n);
        for j in 0..n {
            let column = columns.row_mut(j);
            column[j] = 1.0 / self.0.row(j)[j];
            for i in j + 1..n {
                let l = self.0.row(i);
                column[i] = -dot(&l[j..i], &column[j..i]) / l[i];
            }
        }
        let mut inverse = Square::zeros(n);
        for i in 0..n {
            for j in 0..=i {
                let value = dot(&columns.row(i)[i..], &columns.row(j)[i..]);
                inverse.values[i * n + j] = value;
                inverse.values[j * n + i] = value;
            }
        }
        inverse
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_is_a_solution() {
        let n = 19;
        let mut a = Square::zeros(n);
        for i in 0..n {
            for j in 0..n {
                a.values[i * n + j] =
                    1.0 / (1.0 + (i as f64 - j as f64).abs()) + if i == j { 2.0 } else { 0.0 };
            }
        }
        let b: Vec<f64> = (0..n).map(|i| (i * i % 7) as f64 - 3.0).collect();
        let factor = a.clone().into_cholesky().unwrap();
        let back = a.times(&factor.solve(&b));
        assert!(back.iter().zip(&b).all(|(back, b)| (back - b).abs() < 1e-12));
        let inverse = factor.inverse();
        for i in 0..n {
            let unit = a.times(inverse.row(i));
            assert!(unit.iter().enumerate().all(|(j, v)| (v - f64::from(u8::from(i == j))).abs() < 1e-12));
        }
        assert!(Square::zeros(2).into_cholesky().is_none());
    }
}
