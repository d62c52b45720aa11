//! Functions of an axis' angle over which its error motions are spread: equation (100).

use machine_model::Range;
use units::math;

/// Angles nearer than this count as one, rad: 20 arc seconds, as far as a table that was stopped by hand may miss.
const SAME_RAD: f64 = 1e-4;

/// An axis turns fully where no gap between neighbouring angles is wider: three places a turn would not do for a wave.
const WIDEST_GAP_RAD: f64 = 0.5 * std::f64::consts::PI + 1e-6;

/// More groups say nothing of a machine: 18 waves a turn have a period of 20°, below which teeth and scales begin.
const MOST_GROUPS: usize = 19;

/// Functions of the angle θ in groups: 1; cos θ and sin θ; then finer and finer ones.
///
/// The first two groups are the same for all axes, since they are what a location error can look like.
///
/// ```
/// use calibration::rtest::Basis;
///
/// let turn = Basis::of(&[0.0, 1.5, 3.0, 4.5, 6.0]);
/// assert_eq!((turn.name(2, 1), turn.functions(3)), ("sin2".to_owned(), 5));
/// // A quarter turn: Legendre polynomials from the third degree on take the place of finer waves.
/// let arc = Basis::of(&[0.0, 0.5, 1.0, 1.5]);
/// assert_eq!((arc.name(2, 0), arc.functions(3)), ("p3".to_owned(), 4));
/// assert_eq!(arc.values(2, 1.5), vec![1.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Basis {
    /// The axis turns fully: a Fourier series.
    Turn,
    /// It turns over a part of a turn, rad: mean, once per turn, and Legendre polynomials from the third degree on.
    Arc(Range),
}

impl Basis {
    /// By the angles at which readings were taken, rad.
    ///
    /// # Panics
    /// Without angles.
    #[must_use]
    pub fn of(angles_rad: &[f64]) -> Self {
        let turn = std::f64::consts::TAU;
        let mut places: Vec<f64> = angles_rad.iter().map(|angle| angle.rem_euclid(turn)).collect();
        places.sort_by(f64::total_cmp);
        let over = places[0] + turn - places[places.len() - 1];
        let widest = places.windows(2).map(|w| w[1] - w[0]).fold(over, f64::max);
        if widest <= WIDEST_GAP_RAD {
            return Self::Turn;
        }
        let low = angles_rad.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angles_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::Arc(Range { low, high })
    }

    /// Values of the functions of one group at an angle.
    #[must_use]
    pub fn values(&self, group: usize, angle_rad: f64) -> Vec<f64> {
        match (self, group) {
            (_, 0) => vec![1.0],
            (Self::Turn, _) | (_, 1) => {
                let (sine, cosine) = math::sin_cos(group as f64 * angle_rad);
                vec![cosine, sine]
            }
            (Self::Arc(Range { low, high }), _) => {
                vec![legendre(group + 1, (2.0 * angle_rad - low - high) / (high - low))]
            }
        }
    }

    /// Name of a function: `mean`, `cos1`, `sin1`, `cos2` …, or `p3` ….
    #[must_use]
    pub fn name(&self, group: usize, which: usize) -> String {
        match (self, group) {
            (_, 0) => "mean".to_owned(),
            (Self::Turn, _) | (_, 1) => format!("{}{group}", ["cos", "sin"][which]),
            (Self::Arc(_), _) => format!("p{}", group + 1),
        }
    }

    /// How many functions so many groups have.
    #[must_use]
    pub fn functions(&self, groups: usize) -> usize {
        (0..groups).map(|group| self.values(group, 0.0).len()).sum()
    }

    /// Groups that may be asked for: their functions are never more than half of the distinct angles.
    pub(crate) fn most_groups(&self, angles_rad: &[f64]) -> usize {
        let half = self.distinct(angles_rad) / 2;
        (0..=MOST_GROUPS).rev().find(|groups| self.functions(*groups) <= half).unwrap_or(0)
    }

    /// How many angles differ; whole turns are no difference where the axis turns fully.
    pub(crate) fn distinct(&self, angles_rad: &[f64]) -> usize {
        let turn = std::f64::consts::TAU;
        let folded = |angle: &f64| match self {
            // Half the tolerance is added, so that 0 and a whole turn fall together.
            Self::Turn => (angle + 0.5 * SAME_RAD).rem_euclid(turn),
            Self::Arc(_) => *angle,
        };
        let mut places: Vec<f64> = angles_rad.iter().map(folded).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < SAME_RAD);
        places.len()
    }
}

/// `P_n(t)` by Bonnet's recursion.
fn legendre(degree: usize, t: f64) -> f64 {
    let (mut before, mut value) = (1.0, t);
    for n in 1..degree {
        let n = n as f64;
        (before, value) = (value, ((2.0 * n + 1.0) * t * value - n * before) / (n + 1.0));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_never_more_than_half_of_the_angles() {
        for count in 3..80 {
            let all = |span: f64| -> Vec<f64> {
                (0..count).map(|k| span * f64::from(k) / f64::from(count)).collect()
            };
            for angles in [all(std::f64::consts::TAU), all(2.0)] {
                let basis = Basis::of(&angles);
                let groups = basis.most_groups(&angles);
                assert!(basis.functions(groups) <= angles.len() / 2, "{count} {basis:?}");
                let one_more = basis.functions(groups + 1);
                assert!(groups == MOST_GROUPS || one_more > angles.len() / 2, "{count} {basis:?}");
            }
        }
        // 0 and 360 degrees are one place.
        let turn = std::f64::consts::TAU;
        let angles: Vec<f64> = (0..=12).map(|k| turn * f64::from(k) / 12.0).collect();
        assert_eq!(Basis::of(&angles), Basis::Turn);
        assert_eq!(Basis::Turn.distinct(&angles), 12);
    }

    #[test]
    fn polynomials_are_those_of_the_textbook() {
        assert!((legendre(3, 0.4) - 0.5 * (5.0 * 0.064 - 3.0 * 0.4)).abs() < 1e-15);
        assert!((legendre(4, 0.4) - 0.125 * (35.0 * 0.0256 - 30.0 * 0.16 + 3.0)).abs() < 1e-15);
    }
}
