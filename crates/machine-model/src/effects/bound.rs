//! How far the displacement by one effect can leave its chord: equation (24) of `docs/equations.md`.

use super::spec::curve_order;
use super::{Conditions, EffectKind, EffectTerm};
use crate::{Command, Move, Range, Tilt, Vector};

/// Upper bounds over a range of one axis: of |f|, of |f'| per mm, of |f''| per mm², and the sum of the jumps
/// of f' inside, per mm: beyond its interval a polynomial keeps the value of the end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Growth {
    value: f64,
    slope: f64,
    curvature: f64,
    kinks: f64,
}

impl Growth {
    fn times(self, by: f64) -> Self {
        Self {
            value: self.value * by,
            slope: self.slope * by,
            curvature: self.curvature * by,
            kinks: self.kinks * by,
        }
    }

    /// Upper bound of |d²f/ds²| where the axis moves with these bounds of |dq/ds| and |d²q/ds²|; a jump of the
    /// first derivative counts twice, since it leaves the chord by a quarter where M leaves it by an eighth.
    fn second(&self, speed: f64, acceleration: f64, passes: u8) -> f64 {
        self.curvature * speed * speed
            + self.slope * acceleration
            + 2.0 * self.kinks * speed * f64::from(passes)
    }
}

/// `P_n, P_n', P_n'', P_n'''` for n = 0..=8 at `v`.
fn legendre_derivatives(v: f64) -> [[f64; 4]; 9] {
    let mut all = [[0.0; 4]; 9];
    all[0][0] = 1.0;
    all[1] = [v, 1.0, 0.0, 0.0];
    for k in 1..8 {
        let n = k as f64;
        let (before, now) = (all[k - 1], all[k]);
        let odd = 2.0 * n + 1.0;
        all[k + 1] = [
            (odd * v * now[0] - n * before[0]) / (n + 1.0),
            before[1] + odd * now[0],
            before[2] + odd * now[1],
            before[3] + odd * now[2],
        ];
    }
    all
}

impl EffectTerm {
    /// Upper bound, mm, of the distance between the displacement along a stretch and its chord.
    ///
    /// The directions are those of `stretch.state`, the same all along; so are rotary axes, tool and conditions.
    /// Every effect is then continuous in the commands and smooth but for the ends of its interval: a second
    /// derivative of at most M leaves the chord by at most M/8, a jump J of the first by at most J/4.
    /// Conditions that are not known give an infinite bound.
    #[must_use]
    pub fn chord_bound_mm(&self, stretch: &Move, conditions: &Conditions) -> f64 {
        self.second_derivative_mm(stretch, conditions).unwrap_or(f64::INFINITY) / 8.0
    }

    /// Upper bound of |d²/ds²| of the displacement, mm; `None` where a condition is not known.
    fn second_derivative_mm(&self, stretch: &Move, conditions: &Conditions) -> Option<f64> {
        let (speed, acceleration) = (stretch.speed_mm, stretch.acceleration_mm);
        let direct =
            |axis: usize, growth: Growth| growth.second(speed[axis], acceleration[axis], stretch.passes);
        let first = |index: usize| self.coefficients.get(index).copied().unwrap_or(0.0);
        let turning = |size: f64| size * Vector::from(acceleration).norm();
        Some(match self.kind {
            EffectKind::Scale(a) => 1e-6 * first(0).abs() * acceleration[a],
            EffectKind::Squareness(_, b) => 1e-6 * first(0).abs() * acceleration[b],
            EffectKind::Thermal(a) => {
                let rise = conditions.temp_c[a]? - self.geometry.reference_temp_c;
                1e-6 * ((first(0) + first(2) * rise) * rise).abs() * acceleration[a]
            }
            EffectKind::Warmup(_)
            | EffectKind::Load(_)
            | EffectKind::ServoLag(_)
            | EffectKind::ServoMismatch(..)
            | EffectKind::ProbeLobing
            | EffectKind::InstrumentDrift
            | EffectKind::SpindleTilt(_)
            | EffectKind::Step(_) => 0.0,
            // Turning points, curvature and a tracker's place are none of a program's: it is never corrected.
            EffectKind::Spike(_) | EffectKind::Contraction => 0.0,
            EffectKind::Tracker(_) => return None,
            EffectKind::Backlash(axis) | EffectKind::LostMotion { axis, .. } => {
                let reversed = f64::from(stretch.state.direction[axis].abs());
                direct(axis, self.polynomial(|k| k, stretch.range_mm[axis]).times(1e-3 * reversed))
            }
            EffectKind::Positioning(axis) | EffectKind::Straightness { axis, .. } => {
                direct(axis, self.polynomial(curve_order, stretch.range_mm[axis]).times(1e-3))
            }
            EffectKind::Pitch(axis) => direct(axis, self.waves(stretch.range_mm[axis]).times(1e-3)),
            EffectKind::Angular { about, axis } => self.turned(
                about,
                axis,
                self.polynomial(|k| k + 1, stretch.range_mm[axis]).times(1e-6),
                stretch,
            ),
            EffectKind::Sag(axis) => {
                let droop = [(0, 3), (1, 2), (2, 4)].map(|(index, power)| {
                    self.overhang(power, stretch.range_mm[axis]).times(1e-3 * first(index).abs())
                });
                let tilt = self.overhang(2, stretch.range_mm[axis]).times(1e-6 * first(3).abs());
                let about = if axis == 1 { 0 } else { 1 };
                droop.into_iter().map(|growth| direct(axis, growth)).sum::<f64>()
                    + self.turned(about, axis, tilt, stretch)
            }
            // Offsets of a rotary axis do not depend on the linear axes; tilts turn their arm, a leaning line before and
            // behind the turn.
            EffectKind::Rotary { component: 0..=2, .. } => 0.0,
            EffectKind::Rotary { axis, .. } => {
                let turns = if self.geometry.rotary_tilt[axis] == Tilt::Axis { 2.0 } else { 1.0 };
                turning(1e-6 * turns * first(0).abs())
            }
            EffectKind::Eccentricity(_) => turning(1e-6 * (first(0).abs() + first(1).abs())),
            EffectKind::Local(axis) => {
                let size = Vector::new(first(0), first(1), first(2)).norm();
                direct(axis, self.window(stretch.range_mm[axis]).times(1e-3 * size))
            }
            EffectKind::Joint(axis) => {
                let size = Vector::new(first(0), first(1), first(2)).norm();
                direct(axis, self.ramp(stretch.range_mm[axis]).times(1e-3 * size))
            }
        })
    }

    /// Sum of the Legendre polynomials with the coefficients, each of the order that its place has, on an interval.
    ///
    /// Between: value at the middle and, by the mean value theorem, half the interval times the bound of the
    /// next derivative; `|P_n⁽ᵏ⁾(v)| ≤ P_n⁽ᵏ⁾(1)` on the interval.
    fn polynomial(&self, order: impl Fn(usize) -> usize, range: Range) -> Growth {
        let half_mm = 0.5 * (self.shape.to_mm - self.shape.from_mm);
        let centre_mm = 0.5 * (self.shape.to_mm + self.shape.from_mm);
        let terms = || self.coefficients.iter().enumerate();
        if half_mm <= 0.0 {
            let value = legendre_derivatives(0.0);
            return Growth {
                value: terms().map(|(k, c)| c * value[order(k)][0]).sum::<f64>().abs(),
                ..Growth::default()
            };
        }
        let end = |q: f64| (q - centre_mm) / half_mm;
        let kinks: f64 = [-1.0, 1.0]
            .into_iter()
            .filter(|at| end(range.low) < *at && *at < end(range.high))
            .map(|at| {
                let there = legendre_derivatives(at);
                terms().map(|(k, c)| c * there[order(k)][1]).sum::<f64>().abs() / half_mm
            })
            .sum();
        let outside = end(range.high) <= -1.0 || 1.0 <= end(range.low);
        let (low, high) = (end(range.low).clamp(-1.0, 1.0), end(range.high).clamp(-1.0, 1.0));
        let middle = legendre_derivatives(0.5 * (low + high));
        let most = legendre_derivatives(1.0);
        let here = |nth: usize| terms().map(|(k, c)| c * middle[order(k)][nth]).sum::<f64>().abs();
        let bound = |nth: usize| terms().map(|(k, c)| c.abs() * most[order(k)][nth]).sum::<f64>();
        let reach = 0.5 * (high - low);
        let curvature = (here(2) + reach * bound(3)).min(bound(2));
        let slope = (here(1) + reach * curvature).min(bound(1));
        let value = (here(0) + reach * slope).min(bound(0));
        if outside {
            return Growth { value, ..Growth::default() };
        }
        Growth { value, slope: slope / half_mm, curvature: curvature / (half_mm * half_mm), kinks }
    }

    /// Three harmonics of the screw, each with an amplitude that may grow with the position.
    fn waves(&self, range: Range) -> Growth {
        let half_mm = 0.5 * (self.shape.to_mm - self.shape.from_mm);
        let centre_mm = 0.5 * (self.shape.to_mm + self.shape.from_mm);
        let (relative, per_mm) = if half_mm > 0.0 {
            let far = (range.low - centre_mm).abs().max((range.high - centre_mm).abs());
            ((far / half_mm).min(1.0), 1.0 / half_mm)
        } else {
            (0.0, 0.0)
        };
        let ends = [centre_mm - half_mm, centre_mm + half_mm];
        let crossed = ends.into_iter().filter(|at| range.low < *at && *at < range.high).count() as f64;
        let amplitude = |index: usize| {
            let [sin, cos] = [index, index + 1].map(|k| self.coefficients.get(k).copied().unwrap_or(0.0));
            (sin * sin + cos * cos).sqrt()
        };
        let mut sum = Growth::default();
        for harmonic in 0..3 {
            let omega = std::f64::consts::TAU * (harmonic + 1) as f64 / self.shape.pitch_mm.max(1e-9);
            let (even, growing) = (amplitude(2 * harmonic), amplitude(6 + 2 * harmonic));
            let size = even + growing * relative;
            sum.value += size;
            sum.slope += size * omega + growing * per_mm;
            sum.curvature += size * omega * omega + 2.0 * growing * per_mm * omega;
            sum.kinks += crossed * growing * per_mm;
        }
        sum
    }

    /// A power of the overhang.
    fn overhang(&self, power: i32, range: Range) -> Growth {
        let length_mm = self.shape.to_mm - self.shape.from_mm;
        if length_mm <= 0.0 {
            return Growth { value: 0.5f64.powi(power), ..Growth::default() };
        }
        // Nothing before the support, 1 beyond the far end.
        let at = |q: f64| (q - self.shape.from_mm) / length_mm;
        let most = at(range.high).clamp(0.0, 1.0);
        if most == 0.0 || at(range.low) >= 1.0 {
            return Growth { value: most.powi(power), ..Growth::default() };
        }
        let n = f64::from(power);
        let crossed = at(range.low) < 1.0 && 1.0 < at(range.high);
        Growth {
            value: most.powi(power),
            slope: n * most.powi(power - 1) / length_mm,
            curvature: n * (n - 1.0) * most.powi(power - 2) / (length_mm * length_mm),
            kinks: if crossed { n / length_mm } else { 0.0 },
        }
    }

    /// The window `cos²` of local damage: nothing where the stretch does not come near it.
    fn window(&self, range: Range) -> Growth {
        let half_mm = (0.5 * self.shape.width_mm).max(1e-9);
        if range.high <= self.shape.centre_mm - half_mm || self.shape.centre_mm + half_mm <= range.low {
            return Growth::default();
        }
        let per_mm = std::f64::consts::PI / half_mm;
        Growth { value: 1.0, slope: 0.5 * per_mm, curvature: 0.5 * per_mm * per_mm, kinks: 0.0 }
    }

    /// The ramp `(1 + sin)/2` of a joint: level where the stretch does not come near it.
    fn ramp(&self, range: Range) -> Growth {
        let half_mm = (0.5 * self.shape.width_mm).max(1e-9);
        if range.high <= self.shape.centre_mm - half_mm || self.shape.centre_mm + half_mm <= range.low {
            return Growth { value: 1.0, ..Growth::default() };
        }
        let per_mm = 0.5 * std::f64::consts::PI / half_mm;
        Growth { value: 1.0, slope: 0.5 * per_mm, curvature: 0.5 * per_mm * per_mm, kinks: 0.0 }
    }

    /// A rotation by a function of one axis about a direction, times its lever: product rule.
    fn turned(&self, about: usize, axis: usize, angle: Growth, stretch: &Move) -> f64 {
        let at = |linear_mm: Vector| self.geometry.lever_mm(axis, &Command { linear_mm, ..stretch.state });
        let fixed = at(Vector::zeros());
        let carried = at(Vector::repeat(1.0)) - fixed;
        let first = angle.slope * stretch.speed_mm[axis];
        let second = angle.second(stretch.speed_mm[axis], stretch.acceleration_mm[axis], stretch.passes);
        let by_component = [(about + 1) % 3, (about + 2) % 3].map(|j| {
            let range = stretch.range_mm[j];
            let ends = [range.low, range.high].map(|q| (fixed[j] + carried[j] * q).abs());
            let lever = ends[0].max(ends[1]);
            second * lever
                + 2.0 * first * carried[j] * stretch.speed_mm[j]
                + angle.value * carried[j] * stretch.acceleration_mm[j]
        });
        (by_component[0] * by_component[0] + by_component[1] * by_component[1]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::legendre;

    #[test]
    fn derivatives_of_legendre_polynomials_are_difference_quotients() {
        let h = 1e-4;
        for v in [-1.3, -1.0, -0.4, 0.0, 0.7, 1.0, 2.0] {
            let all = legendre_derivatives(v);
            let (below, above) = (legendre_derivatives(v - h), legendre_derivatives(v + h));
            for n in 0..9 {
                assert!((all[n][0] - legendre(n, v)).abs() < 1e-9 * all[n][0].abs().max(1.0));
                for k in 0..3 {
                    let quotient = (above[n][k] - below[n][k]) / (2.0 * h);
                    assert!((quotient - all[n][k + 1]).abs() < 1e-4 * quotient.abs().max(1.0), "{n} {k} {v}");
                }
            }
        }
    }
}
