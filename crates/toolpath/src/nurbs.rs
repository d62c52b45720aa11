//! Curves by control points: rational Bézier curves, and the NURBS that controls take as many of them at once.
//!
//! The forms are those of Piegl and Tiller, The NURBS Book (2nd edition, 1997), chapters 1, 2 and 4: equations (110) and
//! (111) of docs/equations.md.

/// No control takes more: Fanuc 3, Sinumerik 3, LinuxCNC any (its demos 2 and 3).
pub const MOST_DEGREE: usize = 5;

/// A rational Bézier curve; the first and the last control point are the ends of its motion.
///
/// With control points `P_i`, weights `w_i` and Bernstein's polynomials `B_i` of the degree,
/// `r(s) = Σ B_i(s) w_i P_i / Σ B_i(s) w_i`, 0 ≤ s ≤ 1: equation (110).
///
/// ```
/// use toolpath::Bezier;
///
/// // A quarter of a circle of radius 10 about zero from X10 to Y10, exactly.
/// let quarter = Bezier::new(&[[10.0, 10.0, 0.0]], &[1.0, 0.5f64.sqrt(), 1.0]);
/// let [x, y, _] = quarter.at(&[10.0, 0.0, 0.0], &[0.0, 10.0, 0.0], 0.3);
/// assert!(((x * x + y * y).sqrt() - 10.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier {
    degree: u8,
    inner_mm: [[f64; 3]; MOST_DEGREE - 1],
    weights: [f64; MOST_DEGREE + 1],
}

impl Bezier {
    /// Of the control points between the ends, mm, and the weights of all, the ends among them: positive, one more than the
    /// degree, which is at least 1 and at most [`MOST_DEGREE`].
    #[must_use]
    pub fn new(inner_mm: &[[f64; 3]], weights: &[f64]) -> Self {
        let mut curve = Self {
            degree: 1 + inner_mm.len() as u8,
            inner_mm: Default::default(),
            weights: [1.0; MOST_DEGREE + 1],
        };
        curve.inner_mm[..inner_mm.len()].copy_from_slice(inner_mm);
        curve.weights[..weights.len()].copy_from_slice(weights);
        curve
    }

    /// The degree of its polynomials.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree as usize
    }

    /// The control points between the ends, mm.
    #[must_use]
    pub fn inner_mm(&self) -> &[[f64; 3]] {
        &self.inner_mm[..self.degree() - 1]
    }

    /// The weights of all control points.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights[..=self.degree()]
    }

    /// How far its inner control points are from its ends at most, mm: no place of it is further from both.
    #[must_use]
    pub fn reach_mm(&self, start_mm: &[f64; 3], end_mm: &[f64; 3]) -> f64 {
        let apart =
            |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt();
        let inner = self.inner_mm().iter().map(|place| apart(place, start_mm).min(apart(place, end_mm)));
        inner.fold(apart(start_mm, end_mm), f64::max)
    }

    /// The place at s between two ends, mm: de Casteljau's algorithm on `(w P, w)`.
    #[must_use]
    pub fn at(&self, start_mm: &[f64; 3], end_mm: &[f64; 3], s: f64) -> [f64; 3] {
        let degree = self.degree();
        let mut net = self.net(start_mm, end_mm);
        for left in (1..=degree).rev() {
            for i in 0..left {
                net[i] = mixed(&net[i], &net[i + 1], s);
            }
        }
        divided(&net[0])
    }
}

/// What a NURBS cannot be made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NurbsFault {
    /// Fewer control points than the order, which is one more than the degree.
    TooFewPoints {
        /// How many there are.
        points: usize,
        /// How many it takes.
        order: usize,
    },
    /// Not as many knots as control points and order together.
    KnotCount {
        /// How many there are.
        knots: usize,
        /// How many it takes.
        expected: usize,
    },
    /// A knot lies before the one in front of it.
    KnotsDecrease {
        /// Which, from 0.
        index: usize,
    },
    /// The first or the last knots, as many as the order, are not one: the curve does not reach its end points.
    NotClamped {
        /// The last ones.
        at_end: bool,
    },
    /// More equal knots inside than the degree: the curve jumps.
    Jumps {
        /// The first of them, from 0.
        index: usize,
    },
    /// A weight that is not above zero.
    Weight {
        /// Of which control point, from 0.
        index: usize,
    },
}

/// A rational B-spline of a degree, as controls take it.
///
/// ```
/// use toolpath::Nurbs;
///
/// let points_mm = vec![[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0]];
/// let curve = Nurbs::uniform(2, points_mm, vec![1.0; 4]);
/// assert_eq!(curve.knots, [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]);
/// let pieces = curve.beziers().unwrap();
/// // Two parabolas that meet halfway between the inner control points.
/// assert_eq!(pieces.len(), 2);
/// assert_eq!(pieces[0].0, [1.0, 2.0, 0.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs {
    /// Of its polynomials: the order less 1.
    pub degree: usize,
    /// Control points, mm.
    pub points_mm: Vec<[f64; 3]>,
    /// One for each.
    pub weights: Vec<f64>,
    /// As many as control points, degree and 1 together, none before the one in front of it.
    pub knots: Vec<f64>,
}

impl Nurbs {
    /// With the knots 0, 1, 2, … of which the first and the last stand `degree + 1` times: LinuxCNC's.
    #[must_use]
    pub fn uniform(degree: usize, points_mm: Vec<[f64; 3]>, weights: Vec<f64>) -> Self {
        let spans = points_mm.len().saturating_sub(degree);
        let knots =
            (0..points_mm.len() + degree + 1).map(|i| i.saturating_sub(degree).min(spans) as f64).collect();
        Self { degree, points_mm, weights, knots }
    }

    /// The curve as rational Bézier curves from end to end, each with its end, mm: equation (111).
    ///
    /// The first starts at the first control point and the last ends at the last one, exactly; each starts where the one
    /// before it ends.
    ///
    /// # Errors
    /// [`NurbsFault`]. Whether the degree is one that [`Bezier`] holds, the caller knows.
    pub fn beziers(&self) -> Result<Vec<([f64; 3], Bezier)>, NurbsFault> {
        self.check()?;
        let Self { degree, points_mm, knots, .. } = self;
        let (degree, last) = (*degree, points_mm.len() - 1);
        let spans: Vec<usize> = (degree..=last).filter(|k| knots[*k] < knots[k + 1]).collect();
        let mut pieces = Vec::with_capacity(spans.len());
        for (at, k) in spans.iter().enumerate() {
            let mut weights = [0.0; MOST_DEGREE + 1];
            let mut inner_mm = [[0.0; 3]; MOST_DEGREE - 1];
            let mut end_mm = points_mm[last];
            for j in 0..=degree {
                let place = self.blossom(*k, j);
                weights[j] = place[3];
                if j == degree {
                    if at + 1 < spans.len() {
                        end_mm = divided(&place);
                    }
                } else if j > 0 {
                    inner_mm[j - 1] = divided(&place);
                }
            }
            pieces.push((end_mm, Bezier::new(&inner_mm[..degree - 1], &weights[..=degree])));
        }
        Ok(pieces)
    }

    /// The blossom of the span behind knot k at its end j times and at its start as often as is left: the Bézier control point
    /// j of the span, times its weight, and the weight.
    fn blossom(&self, k: usize, j: usize) -> [f64; 4] {
        let Self { degree, points_mm, weights, knots } = self;
        let degree = *degree;
        let mut net = [[0.0; 4]; MOST_DEGREE + 1];
        for (i, place) in net[..=degree].iter_mut().enumerate() {
            let ([x, y, z], w) = (points_mm[k - degree + i], weights[k - degree + i]);
            *place = [w * x, w * y, w * z, w];
        }
        for r in 1..=degree {
            let argument = if r <= j { knots[k + 1] } else { knots[k] };
            for i in (r..=degree).rev() {
                let (low, high) = (knots[k - degree + i], knots[k + 1 + i - r]);
                net[i] = mixed(&net[i - 1], &net[i], (argument - low) / (high - low));
            }
        }
        net[degree]
    }

    fn check(&self) -> Result<(), NurbsFault> {
        let Self { degree, points_mm, weights, knots } = self;
        let (points, order) = (points_mm.len(), degree + 1);
        if points < order {
            return Err(NurbsFault::TooFewPoints { points, order });
        }
        if knots.len() != points + order {
            return Err(NurbsFault::KnotCount { knots: knots.len(), expected: points + order });
        }
        if let Some(index) = weights.iter().position(|weight| weight.is_nan() || *weight <= 0.0) {
            return Err(NurbsFault::Weight { index });
        }
        if let Some(at) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(NurbsFault::KnotsDecrease { index: at + 1 });
        }
        for (at_end, ends) in [(false, &knots[..order]), (true, &knots[points..])] {
            if ends[0] < ends[order - 1] {
                return Err(NurbsFault::NotClamped { at_end });
            }
        }
        // Between the first knot and the last.
        match (1..points).find(|i| knots[*i] == knots[i + degree]) {
            Some(index) => Err(NurbsFault::Jumps { index }),
            None => Ok(()),
        }
    }
}

/// `(1 - s) a + s b`.
fn mixed(a: &[f64; 4], b: &[f64; 4], s: f64) -> [f64; 4] {
    std::array::from_fn(|i| (1.0 - s) * a[i] + s * b[i])
}

/// The place of `(w P, w)`.
fn divided([x, y, z, w]: &[f64; 4]) -> [f64; 3] {
    [x / w, y / w, z / w]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cox and de Boor's recursion as it is written, which shares nothing with the blossom.
    fn basis(i: usize, degree: usize, u: f64, knots: &[f64]) -> f64 {
        if degree == 0 {
            // The last span holds its end too.
            let last = u == knots[knots.len() - 1] && knots[i] < u && knots[i + 1] == u;
            return if (knots[i] <= u && u < knots[i + 1]) || last { 1.0 } else { 0.0 };
        }
        let share =
            |numerator: f64, denominator: f64| if denominator > 0.0 { numerator / denominator } else { 0.0 };
        share(u - knots[i], knots[i + degree] - knots[i]) * basis(i, degree - 1, u, knots)
            + share(knots[i + degree + 1] - u, knots[i + degree + 1] - knots[i + 1])
                * basis(i + 1, degree - 1, u, knots)
    }

    fn by_definition(curve: &Nurbs, u: f64) -> [f64; 3] {
        let mut sum = [0.0; 4];
        for (i, (point, weight)) in curve.points_mm.iter().zip(&curve.weights).enumerate() {
            let share = basis(i, curve.degree, u, &curve.knots) * weight;
            (0..3).for_each(|k| sum[k] += share * point[k]);
            sum[3] += share;
        }
        divided(&sum)
    }

    #[test]
    fn bezier_pieces_are_the_curve_by_its_definition() {
        let points = |n: usize| -> Vec<[f64; 3]> {
            (0..n).map(|i| [i as f64, ((i * i * 7) % 11) as f64, ((i * 5) % 3) as f64]).collect()
        };
        let weights = |n: usize| -> Vec<f64> { (0..n).map(|i| 0.4 + ((i * 3) % 5) as f64).collect() };
        for degree in 1..=MOST_DEGREE {
            for n in degree + 1..degree + 6 {
                let mut curve = Nurbs::uniform(degree, points(n), weights(n));
                // Uneven, and one knot as often as may be.
                for uneven in [false, true] {
                    if uneven {
                        curve.knots.iter_mut().for_each(|u| *u = *u * *u + 0.3 * *u);
                        let last = curve.knots.len() - degree - 1;
                        (last..curve.knots.len()).for_each(|i| curve.knots[i] = 60.0);
                        if n == degree + 5 {
                            let u = curve.knots[degree + 1];
                            (1..=degree.min(4)).for_each(|i| curve.knots[degree + i] = u);
                        }
                    }
                    let mut breaks = curve.knots.clone();
                    breaks.dedup();
                    let pieces = curve.beziers().unwrap();
                    assert_eq!(pieces.len(), breaks.len() - 1);
                    let mut start = &curve.points_mm[0];
                    for ((end, piece), span) in pieces.iter().zip(breaks.windows(2)) {
                        for s in [0.0, 0.125, 0.4, 0.77, 1.0] {
                            let wanted = by_definition(&curve, span[0] + (span[1] - span[0]) * s);
                            let found = piece.at(start, end, s);
                            (0..3).for_each(|k| {
                                assert!((wanted[k] - found[k]).abs() < 1e-11, "{wanted:?} {found:?}")
                            });
                        }
                        start = end;
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_named() {
        let good = Nurbs::uniform(2, vec![[0.0; 3]; 4], vec![1.0; 4]);
        let with = |change: fn(&mut Nurbs)| {
            let mut curve = good.clone();
            change(&mut curve);
            curve.beziers().map(|_| ()).unwrap_err()
        };
        assert!(good.beziers().is_ok());
        assert_eq!(with(|c| c.points_mm.truncate(2)), NurbsFault::TooFewPoints { points: 2, order: 3 });
        assert_eq!(with(|c| c.knots.truncate(6)), NurbsFault::KnotCount { knots: 6, expected: 7 });
        assert_eq!(with(|c| c.knots[3] = -1.0), NurbsFault::KnotsDecrease { index: 3 });
        assert_eq!(with(|c| c.knots[0] = -1.0), NurbsFault::NotClamped { at_end: false });
        assert_eq!(with(|c| c.knots[6] = 3.0), NurbsFault::NotClamped { at_end: true });
        assert_eq!(with(|c| c.weights[3] = 0.0), NurbsFault::Weight { index: 3 });
        assert_eq!(with(|c| c.weights[1] = f64::NAN), NurbsFault::Weight { index: 1 });
        let mut jumps = Nurbs::uniform(1, vec![[0.0; 3]; 4], vec![1.0; 4]);
        jumps.knots = vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
        assert_eq!(jumps.beziers().map(|_| ()), Err(NurbsFault::Jumps { index: 2 }));
    }
}
