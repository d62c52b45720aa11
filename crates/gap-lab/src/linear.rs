//! Projections in a space of many measured numbers.

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Root mean square of all entries.
pub(crate) fn rms(v: &[f64]) -> f64 {
    if v.is_empty() { 0.0 } else { (dot(v, v) / v.len() as f64).sqrt() }
}

/// An orthonormal set of vectors, grown one column at a time by modified Gram–Schmidt.
#[derive(Clone, Default)]
pub(crate) struct Basis {
    vectors: Vec<Vec<f64>>,
}

impl Basis {
    /// Adds the part of `column` that is new; a column that is (nearly) a combination of the others adds nothing.
    pub(crate) fn add(&mut self, mut column: Vec<f64>) {
        let before = dot(&column, &column).sqrt();
        if before == 0.0 {
            return;
        }
        // Twice is enough: the second pass removes what rounding left of the first.
        self.remove(&mut column);
        self.remove(&mut column);
        let length = dot(&column, &column).sqrt();
        if length > 1e-7 * before {
            column.iter_mut().for_each(|v| *v /= length);
            self.vectors.push(column);
        }
    }

    /// Subtracts from `v` what the set can express.
    pub(crate) fn remove(&self, v: &mut [f64]) {
        for vector in &self.vectors {
            let along = dot(vector, v);
            v.iter_mut().zip(vector).for_each(|(x, u)| *x -= along * u);
        }
    }

    /// Share of the length of `v` that lies in the set: the multiple correlation, 0 … 1.
    pub(crate) fn correlation(&self, v: &[f64]) -> f64 {
        let whole = dot(v, v);
        if whole == 0.0 {
            return 0.0;
        }
        let inside: f64 = self.vectors.iter().map(|u| dot(u, v)).map(|c| c * c).sum();
        (inside / whole).min(1.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_is_the_cosine_to_the_plane() {
        let mut basis = Basis::default();
        basis.add(vec![1.0, 0.0, 0.0]);
        basis.add(vec![1.0, 1.0, 0.0]);
        basis.add(vec![2.0, 3.0, 0.0]);
        assert_eq!(basis.vectors.len(), 2);
        assert!((basis.correlation(&[3.0, 0.0, 4.0]) - 0.6).abs() < 1e-12);
        let mut v = vec![3.0, 5.0, 4.0];
        basis.remove(&mut v);
        assert!(v[0].abs() < 1e-12 && v[1].abs() < 1e-12 && (v[2] - 4.0).abs() < 1e-12);
    }
}
