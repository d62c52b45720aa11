//! Curves by control points: written as lines, each a chord that is corrected as a line is.

use machine_model::{Command, Move, Vector};
use smallvec::SmallVec;
use toolpath::{Bezier, Feed, Position, Shape};

use crate::corrected::{Corrected, Correction};
use crate::corrector::Corrector;
use crate::error::CorrectionError;
use crate::grid::{Block, Stated};

/// What of the tolerance a chord may lie beside its curve by. The rest is for the machine's bow along the chord, which is short;
/// what rounding makes of its ends is allowed besides.
const OF_TOLERANCE: f64 = 0.75;

impl Corrector<'_> {
    /// True where the machine is without errors: there a curve stays as it was posted. It is asked for all blocks of a curve,
    /// of which some are written before the curve is known.
    pub fn is_without_errors(&mut self, block: &Block, rotary_deg: [f64; 3]) -> bool {
        if block.kinematics != self.kinematics && self.switch(block.kinematics).is_err() {
            return false;
        }
        self.heed(block, rotary_deg);
        if self.model.depends_on_direction()
            || self
                .everywhere
                .as_ref()
                .is_some_and(|(_, _, known)| known.as_ref().is_some_and(|e| e.gradient > 0.0))
        {
            return false;
        }
        // An error that leaves no chord anywhere is affine, and one that is zero in all corners besides is zero.
        let (range_mm, state) = (self.model.volume().0, self.state(block, rotary_deg));
        let none_at = |corner: usize| {
            let mm =
                |axis: usize| if corner >> axis & 1 == 0 { range_mm[axis].low } else { range_mm[axis].high };
            let there = Command { linear_mm: Vector::new(mm(0), mm(1), mm(2)), ..state };
            self.model.error_mm(&there) == Vector::zeros()
        };
        let across = Move {
            range_mm,
            speed_mm: range_mm.map(|range| range.high - range.low),
            acceleration_mm: [0.0; 3],
            passes: 1,
            state,
            turn: None,
        };
        (0..8).all(none_at) && self.model.chord_bound_mm(&across) == 0.0
    }

    /// A part of a curve by control points: (P12) of docs/path-promise.md.
    ///
    /// A chord and what it stands for are nowhere further apart than (112) says, and the line that is written is proven to lead
    /// the tool along the chord within what is left of the tolerance.
    pub(crate) fn curve(
        &mut self,
        feed: &Feed,
        curve: &Bezier,
        block: &Block,
    ) -> Result<Corrected, CorrectionError> {
        let within_mm = OF_TOLERANCE * (self.options.tolerance_mm - block.reserved_mm);
        let tolerance_um = self.options.tolerance_mm * 1e3;
        let beyond = move |beside_mm: f64| {
            let distance_um = beside_mm * 1e3;
            let is_beyond = beside_mm > within_mm;
            if is_beyond {
                Err(CorrectionError::NotWithinTolerance { distance_um, tolerance_um })
            } else {
                Ok(())
            }
        };
        if within_mm <= 0.0 {
            beyond(f64::INFINITY)?;
        }
        let (start_mm, end_mm) = (&feed.start.linear_mm, &feed.end.linear_mm);
        if self.is_without_errors(block, feed.end.rotary_deg) {
            let state = self.state(block, feed.end.rotary_deg);
            curve.chords(start_mm, end_mm, within_mm, &mut |chord| {
                beyond(chord.beside_mm)?;
                // Refused where the volume ends, as a line is.
                self.solve(&state, chord.end_mm.into()).map(|_| ())
            })?;
            self.standing = end_mm.map(Some);
            self.last = None;
            return Ok(Corrected { pieces: SmallVec::new(), correction: Correction::default() });
        }
        let mut own = Block { stated: Stated::default(), ..block.clone() };
        if let Some(axis) = self.guessed_own(block) {
            // Where on its way it is, only the end of the block says.
            return Err(CorrectionError::Unnamed {
                axis,
                distance_um: curve.reach_mm(start_mm, end_mm) * 1e3,
            });
        }
        for axis in 0..3 {
            own.named[axis] |= block.stated.axes[axis];
        }
        let mut all = Corrected { pieces: SmallVec::new(), correction: Correction::default() };
        let mut from = feed.start;
        curve.chords(start_mm, end_mm, within_mm, &mut |chord| {
            beyond(chord.beside_mm)?;
            own.reserved_mm = block.reserved_mm + chord.beside_mm;
            let end = Position { linear_mm: chord.end_mm, ..feed.end };
            let line = Feed { start: from, end, shape: Shape::Line, ..*feed };
            let written = self.feed(&line, &own)?;
            all.pieces.extend(written.pieces);
            all.correction.take_in(&written.correction, chord.beside_mm);
            from = end;
            Ok::<(), CorrectionError>(())
        })?;
        if all.pieces.is_empty() {
            // Too little to move an axis a step: its own words would be another curve.
            all.pieces.push(self.standstill(block)?);
        }
        Ok(all)
    }
}

impl Correction {
    /// Takes in that of a part of the motion, which stands for what lies beside it by so many mm.
    fn take_in(&mut self, part: &Self, beside_mm: f64) {
        self.largest_mm = self.largest_mm.max(part.largest_mm);
        self.before_mm = self.before_mm.max(part.before_mm + beside_mm);
        self.after_mm = self.after_mm.max(part.after_mm + beside_mm);
        self.clamped |= part.clamped;
        self.approach |= part.approach;
        self.unknown_side_mm = self.unknown_side_mm.max(part.unknown_side_mm);
    }
}
