//! What deviations of which only the sizes are known can come to together.

use machine_model::Vector;

use crate::farthest;

/// What each deviation alone contributes at every control point, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// By deviation, then by control point.
    pub contributions_mm: Vec<Vec<Vector>>,
}

impl Field {
    /// Each deviation multiplied by a factor: exact to first order.
    #[must_use]
    pub fn scaled(&self, factors: &[f64]) -> Self {
        let each = self.contributions_mm.iter().zip(factors);
        Self { contributions_mm: each.map(|(own, by)| own.iter().map(|d| d * *by).collect()).collect() }
    }

    /// Number of control points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.contributions_mm.first().map_or(0, Vec::len)
    }

    /// Largest contribution of each deviation, mm.
    #[must_use]
    pub fn largest_mm(&self) -> Vec<f64> {
        self.contributions_mm.iter().map(|own| own.iter().map(Vector::norm).fold(0.0, f64::max)).collect()
    }

    /// The contributions at one point.
    fn at(&self, point: usize) -> Vec<Vector> {
        self.contributions_mm.iter().map(|own| own[point]).collect()
    }
}

/// The largest of a figure over the control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// The figure, mm.
    pub mm: f64,
    /// The control point.
    pub at: usize,
    /// Signs of the deviations that make it, +1 or -1.
    pub signs: Vec<f64>,
}

/// Worst case: the largest `|Σ s_i d_i(p)|` over all signs and all control points, equations (53), (54).
///
/// No point is passed over unless a bound of its figure, `√Σ_axis (Σ_i |d_i,axis|)²`, is below what was found.
#[must_use]
pub fn worst_case(field: &Field) -> Extreme {
    let bound = |point: usize| {
        let each = field.contributions_mm.iter().map(|own| own[point].abs());
        each.sum::<Vector>().norm()
    };
    let mut by_bound: Vec<(f64, usize)> = (0..field.points()).map(|point| (bound(point), point)).collect();
    by_bound.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut worst = Extreme { mm: 0.0, at: 0, signs: vec![1.0; field.contributions_mm.len()] };
    for (bound, at) in by_bound {
        if bound <= worst.mm {
            break;
        }
        let found = farthest(&field.at(at));
        if found.length > worst.mm {
            worst = Extreme { mm: found.length, at, signs: found.signs };
        }
    }
    worst
}

/// Statistical figure: the largest `√Σ_i |d_i(p)|²` over the control points, mm, and where: equation (55).
#[must_use]
pub fn root_sum_of_squares(field: &Field) -> (f64, usize) {
    let squares =
        |point: usize| field.contributions_mm.iter().map(|own| own[point].norm_squared()).sum::<f64>();
    let most = (0..field.points()).map(|point| (squares(point), point));
    let (sum, at) = most.reduce(|a, b| if b.0 > a.0 { b } else { a }).unwrap_or_default();
    (sum.sqrt(), at)
}

/// Sets of signs in which each deviation is as often + as -, and each pair as often alike as not: rows of a
/// Hadamard matrix (Sylvester 1867), the smallest power of two above `count`.
///
/// Over these machines the mean of `|Σ s_i d_i|²` is `Σ |d_i|²`, exactly, so the whole model can be asked for
/// the statistical figure without chance.
#[must_use]
pub fn balanced_signs(count: usize) -> Vec<Vec<f64>> {
    let rows = (count + 1).next_power_of_two();
    let sign =
        |row: usize, column: usize| if (row & column).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
    (0..rows).map(|row| (1..=count).map(|column| sign(row, column)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> Field {
        // Three deviations at four points, nothing special about the numbers.
        let at = |a: f64, b: f64| {
            [0.0, 1.0, 2.0, 3.0].map(|p| Vector::new(a + p, b * p - 1.0, a * b + 0.3 * p * p)).to_vec()
        };
        Field { contributions_mm: vec![at(1.0, -2.0), at(-0.5, 0.7), at(2.0, 0.1)] }
    }

    #[test]
    fn the_worst_point_is_found_though_points_are_passed_over() {
        let field = field();
        let worst = worst_case(&field);
        let all = (0..4).map(|point| farthest(&field.at(point)).length);
        assert_eq!(worst.mm, all.fold(0.0, f64::max));
        let sum: Vector = field.at(worst.at).iter().zip(&worst.signs).map(|(d, s)| d * *s).sum();
        assert!((sum.norm() - worst.mm).abs() < 1e-14);
        assert!((worst_case(&field.scaled(&[2.0; 3])).mm - 2.0 * worst.mm).abs() < 1e-14);
        // At the first point the bound says 2.83 and the figure is 2; at the second both are 2.1.
        let field = Field {
            contributions_mm: vec![
                vec![Vector::new(1.0, 1.0, 0.0), Vector::new(2.1, 0.0, 0.0)],
                vec![Vector::new(1.0, -1.0, 0.0), Vector::zeros()],
            ],
        };
        assert_eq!((worst_case(&field).mm, worst_case(&field).at), (2.1, 1));
    }

    #[test]
    fn balanced_signs_have_the_mean_square_that_chance_has() {
        let field = field();
        let (rss, at) = root_sum_of_squares(&field);
        for count in [1, 2, 3, 7, 8, 21] {
            let rows = balanced_signs(count);
            assert!(rows.len() > count && rows.len() <= 2 * count.max(1) + 2);
            for i in 0..count {
                for j in 0..=i {
                    let product: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
                    assert_eq!(product, if i == j { rows.len() as f64 } else { 0.0 });
                }
                assert_eq!(rows.iter().map(|row| row[i]).sum::<f64>(), 0.0);
            }
        }
        let rows = balanced_signs(3);
        let square =
            |row: &Vec<f64>| field.at(at).iter().zip(row).map(|(d, s)| d * *s).sum::<Vector>().norm_squared();
        let mean = rows.iter().map(square).sum::<f64>() / rows.len() as f64;
        assert!((mean.sqrt() - rss).abs() < 1e-14);
    }
}
