//! Where a linear axis stood: how finely a curve along it was looked at.

use crate::equations::noise::median;
use crate::equations::observation::Measurements;

/// So many places at uneven distances show a wave even where they lie further apart than half its period.
pub(crate) const ENOUGH_PLACES: usize = 24;
/// So many even places a period show a wave as itself: of fewer, a screw of twice the turns or more reads alike.
pub(crate) const FINE: f64 = 3.0;
/// A step that differs from the typical one by more than this share is uneven.
pub(crate) const UNEVEN: f64 = 0.15;

/// The places of one linear axis in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sampling {
    /// Smallest and largest command, mm.
    pub range_mm: (f64, f64),
    /// Number of different places.
    pub places: usize,
    /// Distance of neighbouring places, mm: the mean of the steps between them, each counted by its length.
    ///
    /// Even places give their step. Places in pairs (a few tenths apart, as where the way back stops beside the way
    /// there) give the step from pair to pair: what lies within a pair says nothing about what is between pairs.
    pub spacing_mm: f64,
    /// Number of places that a curve can tell apart: those that the range holds at `spacing_mm`.
    pub effective: f64,
    /// A bump narrower than this falls between the places measured, mm: two and a half typical steps.
    pub narrowest_mm: f64,
    /// An angle is read through many levers at every place ([`Measurements::is_crossed`]).
    pub crossed: bool,
    /// A third of the steps or more differ from the spacing.
    uneven: bool,
}

impl Sampling {
    /// Of a linear axis (0 X, 1 Y, 2 Z).
    pub(crate) fn new(data: &Measurements, axis: usize) -> Self {
        let range_mm = data.range_mm(axis);
        let places = data.places_mm(axis);
        let mut steps: Vec<f64> = places.windows(2).map(|w| w[1] - w[0]).collect();
        let length_mm = range_mm.1 - range_mm.0;
        let square: f64 = steps.iter().map(|step| step * step).sum();
        let spacing_mm = if length_mm > 0.0 { square / length_mm } else { 0.0 };
        let effective = if spacing_mm > 0.0 { length_mm / spacing_mm + 1.0 } else { 1.0 };
        let odd = |step: &&f64| (*step / spacing_mm - 1.0).abs() > UNEVEN;
        let uneven = 3 * steps.iter().filter(odd).count() >= places.len();
        let narrowest_mm = 2.5 * median(&mut steps).unwrap_or(0.0);
        let crossed = data.is_crossed(axis);
        Self { range_mm, places: places.len(), spacing_mm, effective, narrowest_mm, crossed, uneven }
    }

    /// True where an error within a turn of a usual screw, 5 mm and more, passes for a slow curve, or for nothing.
    pub(crate) fn hides_turns(&self) -> bool {
        /// Places of a line, not of some lines beside each other.
        const LINE: usize = 6;
        const USUAL_MM: f64 = 5.0;
        self.places >= LINE && !self.uneven && self.spacing_mm > USUAL_MM
    }

    /// True where a wave of this period is sampled at so few places per period that it could be any curve, or one of
    /// another period: two, of even ones [`FINE`].
    ///
    /// Many places at uneven distances show a wave even where they lie further apart; even ones never do.
    pub(crate) fn is_coarse(&self, period_mm: f64) -> bool {
        let of_period = if self.uneven { 2.0 } else { FINE };
        of_period * self.spacing_mm > period_mm && (self.places <= ENOUGH_PLACES || !self.uneven)
    }
}
