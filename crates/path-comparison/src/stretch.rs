//! A short piece of a path, and what of it lies near a place.

use nalgebra::SVector;

/// The tip as the workpiece sees it, mm; A, B, C in radians times [`LEVER_MM`] and zeros, or where directions are compared
/// that of the tool times [`POINTING_LEVER_MM`] and A, B, C in radians times [`TURN_LEVER_MM`].
pub(crate) type Place = SVector<f64, 9>;

/// X, Y, Z of a place.
pub(crate) fn first_three(place: &Place) -> [f64; 3] {
    [place[0], place[1], place[2]]
}

/// Where directions are compared, a whole turn and another branch of the inverse kinematics are seen by this, mm a radian,
/// and what a direction is corrected by is not.
pub(crate) const TURN_LEVER_MM: f64 = 0.01;

/// Where directions are compared they count so many mm a radian for what reaches what. Little, since tip and direction
/// share one limit there: at 5 mm a lean of 100 µrad lets a corner of the tip's path be cut by less than a tenth of a
/// micrometre more than 1.9 µm, by which the tip may be off. The direction itself is judged by its own limit.
pub(crate) const POINTING_LEVER_MM: f64 = 5.0;

/// A turn counts as a way of so many mm a radian, besides what it moves the tip by: a step of 0.001° is seen, what angles are
/// rounded by where a motion is split is not.
pub const LEVER_MM: f64 = 50.0;

/// A part of a stretch, in 0..=1 of its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The farthest that all of it was once reached from: what was made up to there is made.
    front: f64,
}

impl Span {
    /// The first place alone.
    pub(crate) const START: Self = Self::new(0.0, 0.0);

    pub(crate) const fn new(low: f64, high: f64) -> Self {
        Self { low, high, front: low }
    }

    /// What of it does not lie before `low`.
    pub(crate) fn from(self, low: f64) -> Option<Self> {
        let low = self.low.max(low);
        (low <= self.high).then_some(Self::new(low, self.high))
    }

    /// What of it lies before what was reached last by no more than `back`: being late on a path is no deviation from it.
    pub(crate) fn behind(self, last: &Self, back: f64) -> Option<Self> {
        let low = self.low.max(last.front - back);
        (low <= self.high).then_some(Self { low, high: self.high, front: last.front.max(low) })
    }

    pub(crate) fn is_at_start(&self) -> bool {
        self.low <= 0.0
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.high >= 1.0
    }
}

/// `from + s along + 4 s (1 - s) bow`, 0 ≤ s ≤ 1: a chord, and how far its middle lies beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    from: Place,
    along: Place,
    /// Zero for a line.
    bow: Option<Place>,
    square: f64,
}

impl Stretch {
    pub(crate) fn new(from: Place, to: Place, bow: Option<Place>) -> Self {
        let along = to - from;
        Self { from, along, bow, square: along.norm_squared() }
    }

    pub(crate) fn at(&self, s: f64) -> Place {
        let chord = self.from + self.along * s;
        match &self.bow {
            None => chord,
            Some(bow) => chord + bow * (4.0 * s * (1.0 - s)),
        }
    }

    /// X, Y, Z of places along it, both ends among them: so many that chords between them leave it by a hundredth of a
    /// micrometre.
    pub(crate) fn places(&self) -> impl Iterator<Item = [f64; 3]> {
        const CHORD_MM: f64 = 1e-5;
        const MOST: f64 = 64.0;
        // A parabola's chord lies off it by the bow over the square of the pieces.
        let pieces = self.bow.map_or(1.0, |bow| (bow.norm() / CHORD_MM).sqrt().ceil().clamp(1.0, MOST));
        (0..=pieces as u32).map(move |k| {
            let place = self.at(f64::from(k) / pieces);
            [place[0], place[1], place[2]]
        })
    }

    pub(crate) fn length_mm(&self) -> f64 {
        self.square.sqrt()
    }

    /// The nearest s, not limited to 0..=1, and the squares of the distance there and of the speed.
    fn nearest(&self, place: &Place) -> (f64, f64, f64) {
        if self.square <= 0.0 {
            return (0.0, (place - self.from).norm_squared(), 0.0);
        }
        let mut s = (place - self.from).dot(&self.along) / self.square;
        let Some(bow) = &self.bow else {
            return (s, (self.from + self.along * s - place).norm_squared(), self.square);
        };
        // The foot on the chord is off by the bow's slope; one step of Newton's method leaves its square.
        let mut speed = self.along;
        for _ in 0..2 {
            s = s.clamp(-1.0, 2.0);
            speed = self.along + bow * (4.0 - 8.0 * s);
            let square = speed.norm_squared();
            if square <= 0.0 {
                break;
            }
            s += (place - self.at(s)).dot(&speed) / square;
        }
        let s = s.clamp(-1.0, 2.0);
        (s, (self.at(s) - place).norm_squared(), speed.norm_squared())
    }

    /// Distance from a place, mm.
    pub(crate) fn distance_mm(&self, place: &Place) -> f64 {
        self.distance_within_mm(place, Span::new(0.0, 1.0))
    }

    /// Distance of a place from a part of the stretch, mm.
    pub(crate) fn distance_within_mm(&self, place: &Place, span: Span) -> f64 {
        let s = self.nearest(place).0.clamp(span.low, span.high);
        (self.at(s) - place).norm()
    }

    /// How far a place lies beside the stretch and what lies before and behind it, mm.
    pub(crate) fn beside_mm(&self, place: &Place) -> f64 {
        self.nearest(place).1.sqrt()
    }

    /// Where the place lies along the stretch, limited to 0..=1.
    pub(crate) fn foot(&self, place: &Place) -> f64 {
        self.nearest(place).0.clamp(0.0, 1.0)
    }

    /// The part that lies within `limit_mm` of a place.
    pub(crate) fn free(&self, place: &Place, limit_mm: f64) -> Option<Span> {
        let (s, distance2, speed2) = self.nearest(place);
        let rest = limit_mm * limit_mm - distance2;
        if rest < 0.0 {
            return None;
        }
        if speed2 <= 0.0 {
            return Some(Span::new(0.0, 1.0));
        }
        let half = (rest / speed2).sqrt();
        let (low, high) = ((s - half).max(0.0), (s + half).min(1.0));
        (low <= high).then_some(Span::new(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f64, y: f64) -> Place {
        Place::from_row_slice(&[x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    #[test]
    fn near_a_line_and_near_an_arc() {
        let line = Stretch::new(place(0.0, 0.0), place(10.0, 0.0), None);
        let free = line.free(&place(4.0, 3.0), 5.0).unwrap();
        assert!((free.low, free.high) == (0.0, 0.8), "{free:?}");
        assert_eq!(line.free(&place(4.0, 3.0), 2.9), None);
        assert_eq!(line.free(&place(-1.0, 0.0), 1.0), Some(Span::START));
        // A tenth of a radian at 5 mm.
        let at = |angle: f64| place(5.0 * units::math::cos(angle), 5.0 * units::math::sin(angle));
        let bow = at(0.05) - 0.5 * (at(0.0) + at(0.1));
        let arc = Stretch::new(at(0.0), at(0.1), Some(bow));
        for k in 0..=10 {
            let angle = 0.01 * f64::from(k);
            assert!(arc.distance_mm(&(at(angle) * 1.0002)) - 0.001 < 1e-6);
            let free = arc.free(&(at(angle) * 1.0002), 0.002).unwrap();
            let half = 3f64.sqrt() * 0.001 / 5.0 / 0.1;
            assert!((free.high - (0.1 * f64::from(k) + half).min(1.0)).abs() < 1e-4, "{k} {free:?}");
        }
    }
}
