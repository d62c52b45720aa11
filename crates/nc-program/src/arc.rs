//! The circle behind an arc block, in the plane's two axes.

use std::f64::consts::{PI, TAU};

use units::math;

use crate::modal::Turn;

/// Ends nearer than this are the same point: below any input increment, above what sums of
/// increments lose.
const SAME_POINT_MM: f64 = 1e-6;
/// An arc whose ends lie on one ray from the centre, up to this angle, is a full turn.
const SAME_RAY_RAD: f64 = 1e-9;

/// By how much the radii at start and end of an arc may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tolerance {
    /// Whatever the radius, mm.
    pub(crate) absolute_mm: f64,
    /// As a share of the radius, where that is more.
    pub(crate) share: f64,
}

/// So many times the absolute tolerance is the most that a share of the radius may come to (LinuxCNC).
const MOST_TIMES: f64 = 100.0;

impl Tolerance {
    /// What is allowed at a radius, mm.
    pub(crate) fn at(self, radius_mm: f64) -> f64 {
        self.absolute_mm.max((self.share * radius_mm).min(MOST_TIMES * self.absolute_mm))
    }
}

/// Centre and signed angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub(crate) centre_mm: [f64; 2],
    /// Positive turns the first axis towards the second.
    pub(crate) sweep_rad: f64,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The start is the centre.
    NoRadius,
    /// The ends lie on different circles.
    RadiiDiffer { start_mm: f64, end_mm: f64, allowed_mm: f64 },
    /// R is shorter than half the chord.
    RadiusTooSmall { radius_mm: f64, chord_mm: f64 },
    /// R gives no centre where start and end are the same point.
    FullCircleByRadius,
}

/// The circle about a given centre.
///
/// * `start`, `end`, `centre` – mm, in the plane's first and second axis
/// * `tolerance` – largest difference of the radii at start and end that the control takes
///
/// Equal ends make a full circle.
pub(crate) fn by_centre(
    start: [f64; 2],
    end: [f64; 2],
    centre: [f64; 2],
    turn: Turn,
    tolerance: Tolerance,
) -> Result<Circle, Fault> {
    let from = [start[0] - centre[0], start[1] - centre[1]];
    let to = [end[0] - centre[0], end[1] - centre[1]];
    let (start_mm, end_mm) = (math::hypot(from[0], from[1]), math::hypot(to[0], to[1]));
    // From the centre no direction leads anywhere: how far the arc turns would be decided by the last bit. Of an arc of
    // micrometres the tolerance of the radii would take it.
    if start_mm.min(end_mm) < SAME_POINT_MM {
        return Err(Fault::NoRadius);
    }
    // The last term: what subtracting machine coordinates of metres leaves in binary.
    let allowed_mm = tolerance.at(start_mm.min(end_mm));
    if (start_mm - end_mm).abs() > allowed_mm + 1e-9 {
        return Err(Fault::RadiiDiffer { start_mm, end_mm, allowed_mm });
    }
    let same_point = (end[0] - start[0]).abs() < SAME_POINT_MM && (end[1] - start[1]).abs() < SAME_POINT_MM;
    let angle = if same_point {
        0.0
    } else {
        math::atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1])
    };
    let sweep_rad = match turn {
        _ if angle.abs() < SAME_RAY_RAD => signed(TAU, turn),
        Turn::CounterClockwise if angle < 0.0 => angle + TAU,
        Turn::Clockwise if angle > 0.0 => angle - TAU,
        _ => angle,
    };
    Ok(Circle { centre_mm: centre, sweep_rad })
}

/// The circle of a given radius: at most half a turn for R > 0, at least half a turn for R < 0.
///
/// An R that is shorter than half the chord by no more than `tolerance_mm` makes a half circle about the
/// chord's middle, as LinuxCNC does.
pub(crate) fn by_radius(
    start: [f64; 2],
    end: [f64; 2],
    radius_mm: f64,
    turn: Turn,
    tolerance_mm: f64,
) -> Result<Circle, Fault> {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let chord_mm = math::hypot(chord[0], chord[1]);
    if chord_mm < SAME_POINT_MM {
        return Err(Fault::FullCircleByRadius);
    }
    let half = chord_mm / 2.0;
    let size = radius_mm.abs();
    if size < half - tolerance_mm - 1e-9 || size < SAME_POINT_MM {
        return Err(Fault::RadiusTooSmall { radius_mm, chord_mm });
    }
    // Distance of the centre from the chord; the product keeps the digits that r² - h² would lose.
    let height = ((size - half) * (size + half)).max(0.0).sqrt();
    let minor = 2.0 * math::atan2(half, height);
    let sweep = if radius_mm < 0.0 { TAU - minor } else { minor };
    // A minor arc against the clock has its centre on the left of the chord.
    let left = (turn == Turn::CounterClockwise) == (radius_mm > 0.0);
    let away = if left { height / chord_mm } else { -height / chord_mm };
    let centre_mm =
        [(start[0] + end[0]) / 2.0 - chord[1] * away, (start[1] + end[1]) / 2.0 + chord[0] * away];
    debug_assert!(
        sweep > 0.0 && sweep <= TAU && minor <= PI + 1e-12,
        "the angle of an arc lies within a turn"
    );
    Ok(Circle { centre_mm, sweep_rad: signed(sweep, turn) })
}

fn signed(sweep_rad: f64, turn: Turn) -> f64 {
    match turn {
        Turn::Clockwise => -sweep_rad,
        Turn::CounterClockwise => sweep_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Turn::{Clockwise, CounterClockwise};
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    const EXACT: Tolerance = Tolerance { absolute_mm: 0.001, share: 0.0 };

    /// LinuxCNC as its interpreter answers: up to 0.0279 mm, from there to 0.1 % of the radius, and never above 2.79 mm.
    #[test]
    fn radii_may_differ_by_a_share_of_the_radius() {
        let tolerance = Tolerance { absolute_mm: 0.0279, share: 0.001 };
        let takes = |radius: f64, end: f64| {
            by_centre([radius, 0.0], [0.0, -end], [0.0, 0.0], Clockwise, tolerance).is_ok()
        };
        for (radius, good, bad) in [
            (10.0, 10.0279, 10.029),
            (100.0, 100.09, 100.11),
            (1000.0, 1000.9, 1001.1),
            (5000.0, 5002.7, 5003.0),
        ] {
            assert!(takes(radius, good) && !takes(radius, bad), "{radius}");
        }
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9, "{a} is not {b}");
    }

    #[test]
    fn quarter_and_three_quarters() {
        let by = |turn| by_centre([10.0, 0.0], [0.0, 10.0], [0.0, 0.0], turn, EXACT).unwrap().sweep_rad;
        near(by(CounterClockwise), FRAC_PI_2);
        near(by(Clockwise), -3.0 * FRAC_PI_2);
    }

    #[test]
    fn equal_ends_are_a_full_circle() {
        let full = |turn| by_centre([10.0, 0.0], [10.0, 1e-9], [0.0, 0.0], turn, EXACT).unwrap().sweep_rad;
        near(full(CounterClockwise), TAU);
        near(full(Clockwise), -TAU);
    }

    #[test]
    fn radii_may_differ_by_the_tolerance() {
        let by = |end| {
            by_centre(
                [10.0, 0.0],
                [0.0, end],
                [0.0, 0.0],
                Clockwise,
                Tolerance { absolute_mm: 0.01, share: 0.0 },
            )
        };
        assert!(by(10.01).is_ok());
        assert_eq!(by(10.5), Err(Fault::RadiiDiffer { start_mm: 10.0, end_mm: 10.5, allowed_mm: 0.01 }));
        assert_eq!(by_centre([1.0, 1.0], [1.0, 1.0], [1.0, 1.0], Clockwise, EXACT), Err(Fault::NoRadius));
    }

    #[test]
    fn radius_picks_the_minor_or_the_major_arc() {
        let by = |radius, turn| by_radius([10.0, 0.0], [0.0, 10.0], radius, turn, 0.001).unwrap();
        let minor = by(10.0, CounterClockwise);
        near(minor.centre_mm[0], 0.0);
        near(minor.sweep_rad, FRAC_PI_2);
        let major = by(-10.0, CounterClockwise);
        near(major.centre_mm[0], 10.0);
        near(major.centre_mm[1], 10.0);
        near(major.sweep_rad, 3.0 * FRAC_PI_2);
        near(by(10.0, Clockwise).centre_mm[0], 10.0);
        near(by(-10.0, Clockwise).centre_mm[0], 0.0);
    }

    #[test]
    fn radius_against_half_the_chord() {
        let by = |radius| by_radius([0.0, 0.0], [10.0, 0.0], radius, Clockwise, 0.001);
        assert_eq!(by(4.9995).unwrap(), Circle { centre_mm: [5.0, 0.0], sweep_rad: -PI });
        assert_eq!(by(4.9), Err(Fault::RadiusTooSmall { radius_mm: 4.9, chord_mm: 10.0 }));
        assert_eq!(by_radius([1.0; 2], [1.0; 2], 5.0, Clockwise, 0.001), Err(Fault::FullCircleByRadius));
    }

    proptest! {
        /// Both forms of one arc agree, and turning by the sweep about the centre leads from start to end.
        #[test]
        fn turning_by_the_sweep_leads_to_the_end(x in -500.0..500.0f64, y in -500.0..500.0f64, r in 0.1..300.0f64,
                                                 from in 0.0..TAU, sweep in 0.01..6.2f64, clockwise: bool) {
            let turn = if clockwise { Clockwise } else { CounterClockwise };
            let at = |angle: f64| [x + r * math::cos(angle), y + r * math::sin(angle)];
            let signed = if clockwise { -sweep } else { sweep };
            let (start, end) = (at(from), at(from + signed));
            let circle = by_centre(start, end, [x, y], turn, EXACT).unwrap();
            prop_assert!((circle.sweep_rad - signed).abs() < 1e-9);
            let radius = if sweep > PI { -r } else { r };
            let circle = by_radius(start, end, radius, turn, 0.001).unwrap();
            // Near half a turn the centre hangs on the square root of a difference.
            let slack = if (sweep - PI).abs() < 0.01 { 1e-2 } else { 1e-6 };
            prop_assert!(math::hypot(circle.centre_mm[0] - x, circle.centre_mm[1] - y) < slack);
            let (sin, cos) = math::sin_cos(circle.sweep_rad);
            let arm = [start[0] - circle.centre_mm[0], start[1] - circle.centre_mm[1]];
            let reached = [circle.centre_mm[0] + arm[0] * cos - arm[1] * sin,
                           circle.centre_mm[1] + arm[0] * sin + arm[1] * cos];
            prop_assert!(math::hypot(reached[0] - end[0], reached[1] - end[1]) < 1e-6);
        }
    }
}
