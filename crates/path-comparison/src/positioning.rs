//! A positioning move, and when two of them are alike.

use machine_model::Vector;
use toolpath::Partial;

use crate::process::Process;
use crate::stretch::{Place, first_three};

/// What makes a positioning move.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Rapid,
    OfCycle,
    Uncorrected,
}

/// A move whose end counts and whose way is the control's: G0, a reference return, a turn of rotary axes.
pub(crate) struct Positioning {
    /// Where the axes were, as far as known.
    pub(crate) start: Partial,
    /// Where they end.
    pub(crate) end: Partial,
    /// Where it starts and ends on the path that is compared, as far as known.
    pub(crate) places: [Option<Place>; 2],
    /// The directions in which X, Y and Z move the tool where it ends, of what is made.
    pub(crate) axes: [Vector; 3],
    /// The machine's error there, mm.
    pub(crate) error_mm: f64,
    /// How far aside the tool may end for axes that lie in their play, mm.
    pub(crate) aside_mm: f64,
    /// How far the tool goes there, by the most, when every axis turns, mm.
    pub(crate) turns_mm: f64,
    /// G0, which is corrected, unlike the others.
    pub(crate) rapid: bool,
    /// Made by a cycle.
    pub(crate) of_cycle: bool,
    /// How far a rotary axis may stand aside, degrees.
    pub(crate) aside_deg: f64,
    pub(crate) line: u64,
    pub(crate) process: Process,
    pub(crate) limit_mm: f64,
}

impl Positioning {
    /// It moves the tool by so little that it makes no difference whether it is made, and how.
    pub(crate) fn is_small(&self) -> bool {
        /// Rounding at either end, and the limit there.
        const LIMITS: f64 = 8.0;
        match self.places {
            [Some(from), Some(to)] => (to - from).norm() <= LIMITS * self.limit_mm,
            // As far as known it stays where it is.
            _ => self.start == self.end,
        }
    }

    /// How far each linear axis is from where it would bring the tool to the end of another, mm: with rotary axes aside
    /// it follows them. `None` where one of the ends is not known.
    fn off_mm(&self, wanted: &Self) -> Option<[f64; 3]> {
        let ([_, Some(to)], [_, Some(end)]) = (wanted.places, self.places) else { return None };
        let off = Vector::from(first_three(&(end - to)));
        Some(self.axes.map(|axis| axis.dot(&off)))
    }
}

/// Ends of a positioning move that are alike: where an axis goes, the tool ends there; one that stays may.
pub(crate) fn ends_alike(wanted: &Positioning, made: &Positioning) -> bool {
    /// Nothing is cut there.
    const LIMITS: f64 = 4.0;
    /// Where an axis was left by its last correction the machine was off by no more, mm; or by twice what it is off here.
    const LEFT_MM: f64 = 1.0;
    /// Angles of directions that are vectors have last digits of their own, degrees.
    const SAME_DEG: f64 = 1e-5;
    for (wanted_deg, made_deg) in wanted.end.rotary_deg.iter().zip(made.end.rotary_deg) {
        let aside_deg = (wanted_deg - made_deg).abs();
        if aside_deg.is_nan() || aside_deg > wanted.aside_deg.max(SAME_DEG) {
            return false;
        }
    }
    if wanted.rapid != made.rapid {
        return false;
    }
    // A control does not correct the moves of a cycle: they are off by the machine's errors, there and where it began.
    let of_cycle_mm = if made.of_cycle { 2.0 * made.error_mm } else { 0.0 };
    // Written as moves they stand as the next feed will want them, from whichever side they come.
    let turns_mm = if wanted.of_cycle { made.turns_mm } else { made.aside_mm };
    let off_mm = made.off_mm(wanted).filter(|_| wanted.rapid);
    let near_mm = LIMITS * wanted.limit_mm + turns_mm + of_cycle_mm;
    (0..3).all(|axis| {
        let [(w_from, w_to), (from, to)] =
            [wanted, made].map(|p| (p.start.linear_mm[axis], p.end.linear_mm[axis]));
        let (Some(w_to), Some(to)) = (w_to, to) else { return true };
        let by_as_much =
            w_from.zip(from).is_some_and(|(w_from, from)| ((w_to - w_from) - (to - from)).abs() <= near_mm);
        // An axis that stands is where its last correction left it.
        let stands = by_as_much
            && w_from.is_some_and(|w_from| (w_to - w_from).abs() <= near_mm)
            && (w_to - to).abs() <= LEFT_MM.max(2.0 * made.error_mm);
        stands
            || match off_mm {
                Some(off_mm) => off_mm[axis].abs() <= near_mm,
                // Uncorrected: what the block moves ends as written or goes as far as written.
                None => by_as_much || (w_to - to).abs() <= near_mm,
            }
    })
}
