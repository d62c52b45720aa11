//! Tensor products of B-splines in three variables, with bounds of their derivatives: equations (90) and (91) of
//! `docs/equations.md`.

use nalgebra::Matrix3;

use crate::{Move, Range, Vector};

/// Most functions that are not zero at a place: those of a cubic.
const ACTIVE: usize = 4;

/// The B-splines of one axis: clamped knots, degree 1 or 3 (de Boor 1978).
#[derive(Clone, Debug)]
pub(super) struct Basis {
    knots: Vec<f64>,
    degree: usize,
}

impl Basis {
    /// Hat functions with their tops at the nodes, which increase.
    pub(super) fn through(nodes: &[f64]) -> Self {
        Self::clamped(nodes, 1)
    }

    /// Cubics over so many equal intervals.
    pub(super) fn even(range: Range, intervals: usize) -> Self {
        let place = |k: usize| {
            let share = k as f64 / intervals as f64;
            range.low * (1.0 - share) + range.high * share
        };
        Self::clamped(&(0..=intervals).map(place).collect::<Vec<_>>(), 3)
    }

    fn clamped(places: &[f64], degree: usize) -> Self {
        let (first, last) = (places[0], places[places.len() - 1]);
        let mut knots = vec![first; degree];
        knots.extend_from_slice(places);
        knots.extend(std::iter::repeat_n(last, degree));
        Self { knots, degree }
    }

    /// How many functions.
    pub(super) fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Places where polynomials meet, ends included.
    pub(super) fn breaks(&self) -> &[f64] {
        &self.knots[self.degree..=self.count()]
    }

    /// Places with which as coefficients the sum is the identity (Greville).
    pub(super) fn greville(&self) -> Vec<f64> {
        let mean = |i: usize| self.knots[i + 1..=i + self.degree].iter().sum::<f64>() / self.degree as f64;
        (0..self.count()).map(mean).collect()
    }

    pub(super) fn range(&self) -> Range {
        Range { low: self.knots[0], high: self.knots[self.knots.len() - 1] }
    }

    /// Number of the first function that is not zero at `q`; that of the last interval at the upper end.
    fn first(&self, q: f64) -> usize {
        let breaks = self.breaks();
        breaks.partition_point(|&place| place <= q).saturating_sub(1).min(breaks.len() - 2)
    }

    /// Derivative of order `order` of the functions that are not zero at `q`, and the number of the first of them.
    pub(super) fn values(&self, q: f64, order: usize) -> (usize, [f64; ACTIVE]) {
        let first = self.first(q);
        let span = first + self.degree;
        let t = &self.knots;
        let mut values = [0.0; ACTIVE];
        if order > self.degree {
            return (first, values);
        }
        values[0] = 1.0;
        for degree in 1..=self.degree {
            let differentiate = degree + order > self.degree;
            let mut next = [0.0; ACTIVE];
            for (k, value) in values.iter().enumerate().take(degree) {
                // Functions span-degree+1+k of the lower degree, each half of two of the higher.
                let i = span + 1 + k - degree;
                let width = t[i + degree] - t[i];
                let (left, right) = if differentiate {
                    (-(degree as f64), degree as f64)
                } else {
                    (t[i + degree] - q, q - t[i])
                };
                next[k] += left / width * value;
                next[k + 1] += right / width * value;
            }
            values = next;
        }
        (first, values)
    }

    /// Factors that make of differences of coefficients the coefficients of the derivative, which has been taken `taken`
    /// times already.
    fn steepness(&self, taken: usize) -> Vec<f64> {
        let degree = self.degree - taken;
        let factor = |i: usize| degree as f64 / (self.knots[i + 1 + self.degree] - self.knots[i + 1 + taken]);
        (0..self.count() - taken - 1).map(factor).collect()
    }
}

/// Coefficients of three components, X fastest.
#[derive(Clone, Debug)]
struct Net {
    counts: [usize; 3],
    values: Vec<Vector>,
}

impl Net {
    fn strides(&self) -> [usize; 3] {
        [1, self.counts[0], self.counts[0] * self.counts[1]]
    }

    /// Differences of neighbours along an axis, each times its factor.
    fn differences(&self, axis: usize, factors: &[f64]) -> Self {
        let mut counts = self.counts;
        counts[axis] -= 1;
        let strides = self.strides();
        let mut values = Vec::with_capacity(counts.iter().product());
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                for i in 0..counts[0] {
                    let at = i + strides[1] * j + strides[2] * k;
                    values
                        .push((self.values[at + strides[axis]] - self.values[at]) * factors[[i, j, k][axis]]);
                }
            }
        }
        Self { counts, values }
    }

    /// Largest absolute value of each component in a box of indices, ends included.
    fn largest(&self, from: [usize; 3], to: [usize; 3]) -> Vector {
        let strides = self.strides();
        let mut most = Vector::zeros();
        for k in from[2]..=to[2] {
            for j in from[1]..=to[1] {
                let row = strides[1] * j + strides[2] * k;
                for value in &self.values[row + from[0]..=row + to[0]] {
                    most = most.sup(&value.abs());
                }
            }
        }
        most
    }
}

/// A vector field made of B-splines, `e(q) = Σ c_ijk B_i(x) B_j(y) B_k(z)`, mm.
#[derive(Clone, Debug)]
pub(super) struct TensorSpline {
    axes: [Basis; 3],
    net: Net,
    /// Coefficients of `∂e/∂q_a`.
    slopes: [Net; 3],
    /// Of `∂²e/∂q_a∂q_b`, pairs as [`PAIRS`] has them; `None` where it is zero.
    curvatures: [Option<Net>; 6],
    /// Of the jumps of `∂e/∂q_a` at the inner nodes of axis a; `None` where there are none.
    kinks: [Option<Net>; 3],
    /// Upper bound of the norm of the Jacobian, everywhere.
    gradient: f64,
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

impl TensorSpline {
    /// * `coefficients` – X fastest, as many as the bases have functions, multiplied
    pub(super) fn new(axes: [Basis; 3], coefficients: Vec<Vector>) -> Self {
        let net = Net { counts: axes.each_ref().map(Basis::count), values: coefficients };
        let slopes = [0, 1, 2].map(|a| net.differences(a, &axes[a].steepness(0)));
        let curvatures = PAIRS.map(|(a, b)| {
            let twice = usize::from(a == b);
            (axes[b].degree > twice).then(|| slopes[a].differences(b, &axes[b].steepness(twice)))
        });
        let kinks = [0, 1, 2].map(|a| {
            let inner = axes[a].degree == 1 && slopes[a].counts[a] > 1;
            inner.then(|| slopes[a].differences(a, &vec![1.0; slopes[a].counts[a] - 1]))
        });
        let mut this = Self { axes, net, slopes, curvatures, kinks, gradient: 0.0 };
        let whole = this.axes.each_ref().map(Basis::range);
        let columns = this.steepest(&whole);
        this.gradient = columns.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
        this
    }

    /// Ranges of the three axes.
    pub(super) fn ranges(&self) -> [Range; 3] {
        self.axes.each_ref().map(Basis::range)
    }

    /// A derivative of the field: of order `orders[a]` along axis a.
    fn derivative(&self, q: &Vector, orders: [usize; 3]) -> Vector {
        let [(i, x), (j, y), (k, z)] = [0, 1, 2].map(|a| self.axes[a].values(q[a], orders[a]));
        let strides = self.net.strides();
        let active = self.axes.each_ref().map(|basis| basis.degree + 1);
        let mut sum = Vector::zeros();
        for (c, z) in z[..active[2]].iter().enumerate() {
            for (b, y) in y[..active[1]].iter().enumerate() {
                let row = i + strides[1] * (j + b) + strides[2] * (k + c);
                let values = &self.net.values[row..row + active[0]];
                let along: Vector = values.iter().zip(&x).map(|(value, x)| value * *x).sum();
                sum += along * (y * z);
            }
        }
        sum
    }

    /// The field at a place inside its ranges.
    pub(super) fn value(&self, q: &Vector) -> Vector {
        self.derivative(q, [0; 3])
    }

    /// `∂e_c/∂q_a` in row c and column a; at a node of a piecewise linear axis that of the interval above it.
    pub(super) fn jacobian(&self, q: &Vector) -> Matrix3<f64> {
        let column = |a: usize| {
            let mut orders = [0; 3];
            orders[a] = 1;
            self.derivative(q, orders)
        };
        Matrix3::from_columns(&[column(0), column(1), column(2)])
    }

    /// Upper bound of the norm of the Jacobian, everywhere: `|e(p) - e(q)| ≤ gradient·|p - q|`.
    pub(super) fn gradient(&self) -> f64 {
        self.gradient
    }

    /// Numbers of the first and last coefficients of a derivative that count in a box.
    fn active(&self, ranges: &[Range; 3], orders: [usize; 3]) -> [[usize; 3]; 2] {
        let from = [0, 1, 2].map(|a| self.axes[a].first(ranges[a].low));
        let to = [0, 1, 2].map(|a| self.axes[a].first(ranges[a].high) + self.axes[a].degree - orders[a]);
        [from, to]
    }

    /// Upper bounds of `|∂e/∂q_a|` in a box, by component.
    fn steepest(&self, ranges: &[Range; 3]) -> [Vector; 3] {
        [0, 1, 2].map(|a| {
            let mut orders = [0; 3];
            orders[a] = 1;
            let [from, to] = self.active(ranges, orders);
            self.slopes[a].largest(from, to)
        })
    }

    /// Upper bound, mm, of how far the field leaves its chord on a stretch whose box lies in the ranges.
    ///
    /// Equation (91): B-splines are positive and sum to 1, so no derivative exceeds the largest of its coefficients.
    pub(super) fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let whole = self.ranges();
        let ranges = [0, 1, 2].map(|a| Range {
            low: stretch.range_mm[a].low.max(whole[a].low),
            high: stretch.range_mm[a].high.min(whole[a].high),
        });
        let (speed, acceleration) = (&stretch.speed_mm, &stretch.acceleration_mm);
        let slopes = self.steepest(&ranges);
        let first: Vector = (0..3).map(|a| slopes[a] * speed[a]).sum();
        let mut second: Vector = (0..3).map(|a| slopes[a] * acceleration[a]).sum();
        for ((a, b), net) in PAIRS.into_iter().zip(&self.curvatures) {
            if let Some(net) = net
                && speed[a] * speed[b] > 0.0
            {
                let mut orders = [0; 3];
                orders[a] += 1;
                orders[b] += 1;
                let [from, to] = self.active(&ranges, orders);
                let twice = if a == b { 1.0 } else { 2.0 };
                second += net.largest(from, to) * (twice * speed[a] * speed[b]);
            }
        }
        let mut bent = second / 8.0;
        for a in 0..3 {
            bent += self.bent_by_kinks_mm(a, &ranges, stretch);
        }
        // What changes by no more than `first` leaves its chord by no more than half of that.
        bent.norm().min(0.5 * first.norm())
    }

    /// How far the kinks at the nodes of an axis bend the field off its chord: `J s (1 - s)`, at most a quarter of the jump.
    fn bent_by_kinks_mm(&self, axis: usize, ranges: &[Range; 3], stretch: &Move) -> Vector {
        let Some(net) = &self.kinks[axis] else { return Vector::zeros() };
        let range = ranges[axis];
        let length = range.high - range.low;
        let speed = stretch.speed_mm[axis];
        let even = stretch.acceleration_mm[axis] == 0.0 && (length - speed).abs() <= 1e-9 * speed;
        let breaks = self.axes[axis].breaks();
        let [mut from, mut to] = self.active(ranges, [0; 3]);
        let mut bent = Vector::zeros();
        let inside = breaks.iter().enumerate().skip(1).take(breaks.len() - 2);
        for (node, place) in inside.filter(|(_, place)| range.low < **place && **place < range.high) {
            let share = (place - range.low) / length;
            let weight = if even && stretch.passes == 1 { share * (1.0 - share) } else { 0.25 };
            (from[axis], to[axis]) = (node - 1, node - 1);
            bent += net.largest(from, to) * (speed * f64::from(stretch.passes) * weight);
        }
        bent
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Command;
    use rand::{RngExt as _, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn random(rng: &mut ChaCha8Rng, cubic: bool) -> TensorSpline {
        let axes = [0, 1, 2].map(|_| {
            if cubic {
                Basis::even(Range { low: -40.0, high: 60.0 }, rng.random_range(1..6))
            } else {
                let mut nodes = vec![-40.0];
                while nodes[nodes.len() - 1] < 30.0 {
                    nodes.push(nodes[nodes.len() - 1] + rng.random_range(5.0..30.0));
                }
                nodes.push(60.0);
                Basis::through(&nodes)
            }
        });
        // As smooth as machines are: a few long waves, and what noise leaves.
        let waves: Vec<(Vector, Vector)> = (0..3)
            .map(|_| {
                let wave = Vector::from_fn(|_, _| rng.random_range(-0.03..0.03));
                (wave, Vector::from_fn(|_, _| rng.random_range(-0.03..0.03)))
            })
            .collect();
        let places = axes.each_ref().map(Basis::greville);
        let mut coefficients = Vec::new();
        for z in &places[2] {
            for y in &places[1] {
                for x in &places[0] {
                    let place = Vector::new(*x, *y, *z);
                    let rest = Vector::from_fn(|_, _| rng.random_range(-1e-4..1e-4));
                    let sum = waves.iter().map(|(wave, size)| size * units::math::sin(wave.dot(&place)));
                    coefficients.push(sum.sum::<Vector>() + rest);
                }
            }
        }
        TensorSpline::new(axes, coefficients)
    }

    /// Against differences of the value, and the value against the coefficients of the identity.
    #[test]
    fn derivatives_are_those_of_the_value() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for cubic in [true, false] {
            let spline = random(&mut rng, cubic);
            for _ in 0..200 {
                let q = Vector::from_fn(|_, _| rng.random_range(-39.9..59.9));
                let jacobian = spline.jacobian(&q);
                for a in 0..3 {
                    let mut step = Vector::zeros();
                    step[a] = 1e-5;
                    let slope = (spline.value(&(q + step)) - spline.value(&(q - step))) / 2e-5;
                    assert!((slope - jacobian.column(a)).norm() < 1e-7, "{slope} {jacobian}");
                }
            }
        }
        let axis = Basis::even(Range { low: 2.0, high: 9.0 }, 3);
        let places = axis.greville();
        for q in [2.0, 3.7, 6.0, 9.0] {
            let (first, values) = axis.values(q, 0);
            let sum: f64 = values.iter().zip(&places[first..]).map(|(v, place)| v * place).sum();
            assert!((sum - q).abs() < 1e-12, "{q}: {sum}");
        }
    }

    #[test]
    fn nodes_are_met_exactly() {
        let spline = random(&mut ChaCha8Rng::seed_from_u64(2), false);
        let counts = spline.net.counts;
        for (at, value) in spline.net.values.iter().enumerate() {
            let index = [at % counts[0], at / counts[0] % counts[1], at / counts[0] / counts[1]];
            let q = Vector::from_fn(|a, _| spline.axes[a].breaks()[index[a]]);
            assert_eq!(spline.value(&q), *value);
        }
    }

    /// Lines and arcs anywhere, sampled densely, never leave their chord by more than the bound; and it is not idle.
    #[test]
    fn no_stretch_leaves_its_chord_by_more_than_the_bound() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for cubic in [true, false] {
            let mut ratios = Vec::new();
            for _ in 0..400 {
                let spline = random(&mut rng, cubic);
                let reach = [1.0, 5.0, 25.0][rng.random_range(0..3)];
                let arc = rng.random_bool(0.5);
                let middle = Vector::from_fn(|_, _| rng.random_range(-40.0 + reach..60.0 - reach));
                let [u, v] = [0, 1].map(|_| Vector::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize());
                let sweep = rng.random_range(0.1..1.5);
                let at = |s: f64| {
                    if arc {
                        let (sin, cos) = units::math::sin_cos(sweep * s);
                        middle + (u * cos + v * sin) * (0.5 * reach)
                    } else {
                        middle + u * (reach * (s - 0.5))
                    }
                };
                const SAMPLES: u32 = 300;
                let places: Vec<Vector> =
                    (0..=SAMPLES).map(|k| at(f64::from(k) / f64::from(SAMPLES))).collect();
                let range_mm = [0, 1, 2].map(|a| {
                    let values = || places.iter().map(|place| place[a]);
                    Range {
                        low: values().fold(f64::INFINITY, f64::min),
                        high: values().fold(f64::NEG_INFINITY, f64::max),
                    }
                });
                let speed = if arc { (u.abs() + v.abs()) * (0.5 * reach * sweep) } else { u.abs() * reach };
                let acceleration = if arc { speed * sweep } else { Vector::zeros() };
                let stretch = Move {
                    range_mm,
                    speed_mm: speed.into(),
                    acceleration_mm: acceleration.into(),
                    passes: if arc { 2 } else { 1 },
                    state: Command::default(),
                    turn: None,
                };
                let bound = spline.chord_bound_mm(&stretch);
                let ends = [spline.value(&places[0]), spline.value(&places[SAMPLES as usize])];
                let mut largest = 0.0_f64;
                for (k, place) in places.iter().enumerate() {
                    let s = k as f64 / f64::from(SAMPLES);
                    let chord = ends[0] * (1.0 - s) + ends[1] * s;
                    largest = largest.max((spline.value(place) - chord).norm());
                }
                assert!(largest <= bound * (1.0 + 1e-9) + 1e-12, "{largest} exceeds {bound}");
                if !arc {
                    ratios.push(bound / largest);
                }
            }
            ratios.sort_by(f64::total_cmp);
            println!("cubic {cubic}: bound over sampled {:.2} in the median", ratios[ratios.len() / 2]);
            // Nine derivatives are added as if they had one sign; which they have, a stretch does not say.
            assert!(ratios[ratios.len() / 2] < 10.0, "{}", ratios[ratios.len() / 2]);
        }
    }
}
