//! Axes that follow their commands late.

use units::math;

/// How the linear axes follow: each by a position loop of the first order with a share of its speed fed forward,
/// `y' = gain (x - y) + feed_forward x'`.
///
/// What such a loop gives is a mean of what was commanded before: of delays whose mean is `(1 - f) / k` and whose
/// variance is `(1 - f²) / k²` (gain k, feed forward f from 0 to 1). The mean alone shifts the place along the path;
/// what leaves the path is its difference between axes, and the variance where the path bends.
///
/// ```
/// use toolpath::Following;
///
/// let axes = Following { gain_1_s: [50.0; 3], feed_forward: [0.0; 3], in_position_mm: None };
/// // A circle of 20 mm at 3 m/min is cut by `v² / (2 r k²)` too small (ISO 230-4).
/// assert!((1e3 * axes.arc_mm(50.0, 20.0) - 24.95).abs() < 0.01);
/// // A corner that is taken without slowing down: `v / (e k)`.
/// assert!((1e3 * axes.corner_mm(50.0, None) - 367.88).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Of X, Y, Z, 1/s: 1 m/min per mm of lag is 16.67.
    pub gain_1_s: [f64; 3],
    /// Share of the speed, 0 to 1.
    pub feed_forward: [f64; 3],
    /// Where it stops at the end of a block, the control waits until the axes lag by no more, mm; `None`: it does not wait.
    pub in_position_mm: Option<f64>,
}

impl Following {
    /// By how much a corner is cut, mm, at most: `min(a / 2 (1 - f²) / k², v (1 - f) / k exp(f - 1))` of the slowest
    /// axis, and the way of the difference of delays. The second is the right angle taken at full speed, the worst.
    ///
    /// * `speed_mm_s` – along the path; infinite where nobody knows
    /// * `acceleration_mm_s2` – the control's largest
    #[must_use]
    pub fn corner_mm(&self, speed_mm_s: f64, acceleration_mm_s2: Option<f64>) -> f64 {
        let of_axis = |axis: usize| {
            let (gain, ahead) = (self.gain_1_s[axis], self.feed_forward[axis]);
            let at_speed = along(speed_mm_s, (1.0 - ahead) / gain * math::exp(ahead - 1.0));
            let bent = acceleration_mm_s2.map(|most| most / 2.0 * (1.0 - ahead * ahead) / (gain * gain));
            bent.map_or(at_speed, |bent| bent.min(at_speed))
        };
        most([0, 1, 2].map(of_axis)) + along(speed_mm_s, self.apart_s())
    }

    /// By how much an arc is cut beside its radius, mm, at most: `r (1 - |H(v / r)|)` of the slowest axis, `|H(w)|² =
    /// (k² + f² w²) / (k² + w²)`, and half the way of the difference of delays.
    #[must_use]
    pub fn arc_mm(&self, speed_mm_s: f64, radius_mm: f64) -> f64 {
        let turn = speed_mm_s / radius_mm;
        let of_axis = |axis: usize| {
            let (gain, ahead) = (self.gain_1_s[axis], self.feed_forward[axis]);
            let square = |number: f64| number * number;
            let kept = (square(gain) + square(ahead * turn)) / (square(gain) + square(turn));
            radius_mm * (1.0 - kept.sqrt())
        };
        let bent = if turn.is_finite() { most([0, 1, 2].map(of_axis)) } else { radius_mm };
        bent + along(speed_mm_s, self.apart_s()) / 2.0
    }

    /// By how much the delays of the axes differ, s.
    fn apart_s(&self) -> f64 {
        let delays = [0, 1, 2].map(|axis| (1.0 - self.feed_forward[axis]) / self.gain_1_s[axis]);
        most(delays) - delays.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// The way of a time, 0 at any speed for none.
fn along(speed_mm_s: f64, time_s: f64) -> f64 {
    if time_s == 0.0 { 0.0 } else { speed_mm_s * time_s }
}

fn most(values: [f64; 3]) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The loops, step by step, along a right angle at full speed and around a circle; how far they leave them, mm.
    fn simulated(axes: &Following, speed_mm_s: f64, radius_mm: f64) -> [f64; 2] {
        const STEP_S: f64 = 1e-6;
        let run = |command: &dyn Fn(f64) -> [f64; 2], off: &dyn Fn([f64; 2]) -> f64, seconds: f64| {
            let (mut at, mut before, mut worst) = (command(0.0), command(0.0), 0.0_f64);
            for step in 1..(seconds / STEP_S) as usize {
                let goal = command(step as f64 * STEP_S);
                for axis in 0..2 {
                    let ahead = axes.feed_forward[axis] * (goal[axis] - before[axis]);
                    at[axis] += STEP_S * axes.gain_1_s[axis] * (before[axis] - at[axis]) + ahead;
                }
                before = goal;
                worst = worst.max(off(at));
            }
            worst
        };
        // 0.3 s to settle, the corner, 0.1 s behind it.
        let way = |seconds: f64| speed_mm_s * (seconds - 0.3);
        let corner = run(
            &|seconds| [way(seconds).min(0.0), way(seconds).max(0.0)],
            &|[x, y]| if y <= 0.0 { y.abs() } else { x.abs().min(y) },
            0.4,
        );
        let turn = speed_mm_s / radius_mm;
        let round = |seconds: f64| {
            let (sin, cos) = math::sin_cos(turn * seconds);
            [radius_mm * cos, radius_mm * sin]
        };
        let off = |[x, y]: [f64; 2]| ((x * x + y * y).sqrt() - radius_mm).abs();
        // The first turn is no steady one, and cut less.
        [corner, run(&round, &off, 3.0 * std::f64::consts::TAU / turn)]
    }

    #[test]
    fn bounds_are_those_of_the_loops() {
        for (gain_1_s, feed_forward, tight) in [
            ([50.0; 3], [0.0; 3], true),
            ([30.0; 3], [0.8; 3], true),
            ([60.0, 45.0, 60.0], [0.0, 0.5, 0.0], false),
        ] {
            let axes = Following { gain_1_s, feed_forward, in_position_mm: None };
            let came = simulated(&axes, 40.0, 8.0);
            let said = [axes.corner_mm(40.0, None), axes.arc_mm(40.0, 8.0)];
            for (came, said) in came.into_iter().zip(said) {
                assert!(came <= said * 1.001 + 1e-6, "{came} of {said}");
                assert!(!tight || came > 0.98 * said, "{came} of {said}");
            }
        }
    }

    #[test]
    fn whole_feed_forward_leaves_no_path_at_any_speed() {
        let axes = Following { gain_1_s: [20.0; 3], feed_forward: [1.0; 3], in_position_mm: None };
        assert_eq!([axes.corner_mm(f64::INFINITY, None), axes.arc_mm(100.0, 1.0)], [0.0, 0.0]);
        let late = Following { feed_forward: [0.5; 3], ..axes };
        // Speed unknown: what the acceleration allows.
        assert_eq!(late.corner_mm(f64::INFINITY, Some(800.0)), 0.75);
        assert!(late.corner_mm(f64::INFINITY, None).is_infinite());
    }
}
