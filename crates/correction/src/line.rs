//! Following a curve with lines.

use machine_model::Vector;

use crate::corrector::{CorrectionError, Corrector, Follow};
use crate::curve::Curve;
use crate::deviation::{Pair, Verdict};
use crate::grid::AxisWord;
use crate::{Centre, Piece, PieceKind};

/// A piece shorter than this many output steps cannot be split further to any use.
const SHORTEST_STEPS: f64 = 4.0;

impl Corrector<'_> {
    /// Commands lines from where the axes stand to the end of `part`, as few as hold the tolerance.
    pub(crate) fn follow_line(
        &mut self,
        follow: &mut Follow<'_, '_>,
        part: &Curve,
    ) -> Result<(), CorrectionError> {
        let nominal_end = part.at(1.0);
        let wanted = self.solve(&follow.machine, nominal_end)?;
        let before = self.standing;
        let from: Vector = before.map(|v| v.unwrap_or(f64::NAN)).into();
        let own_end = follow.own_end(part, &from);
        let axes = self.go(follow.block, &own_end, &wanted, follow.alone);
        let to: Vector = self.standing.map(|v| v.unwrap_or(f64::NAN)).into();
        let commanded = Curve::Line(from, to);
        let pair = Pair { wanted: part, commanded: &commanded, in_step: follow.in_step };
        let limit = self.limit_mm(follow.block);
        match pair.verdict(&follow.machine, limit) {
            Verdict::Within(bound) => {
                follow.finish(
                    Piece { kind: PieceKind::Line, axes, share: follow.share(part) },
                    bound,
                    (wanted - nominal_end).norm(),
                );
                self.note_end(&follow.machine, nominal_end, wanted);
                Ok(())
            }
            Verdict::Beyond { distance_mm, .. } => {
                let step = (0..3).map(|i| follow.block.step_mm(i)).fold(0.0, f64::max);
                let length = part.length_mm();
                if !follow.may_split {
                    return Err(CorrectionError::MustNotSplit { distance_um: distance_mm * 1e3 });
                }
                if length < SHORTEST_STEPS * step || length < 2.0 * self.options.minimum_segment_mm {
                    return Err(CorrectionError::NotWithinTolerance {
                        distance_um: distance_mm * 1e3,
                        tolerance_um: self.options.tolerance_mm * 1e3,
                    });
                }
                self.standing = before;
                follow.alone = false;
                let shortest = (self.options.minimum_segment_mm / length).clamp(0.05, 0.5);
                let s = pair.worst_place(&follow.machine).clamp(shortest, 1.0 - shortest);
                self.follow_line(follow, &part.part(0.0, s))?;
                self.follow_line(follow, &part.part(s, 1.0))
            }
        }
    }
}

impl Follow<'_, '_> {
    /// Adds a piece that was proven, unless it is the block as it stands or moves nothing.
    pub(crate) fn finish(&mut self, piece: Piece, bound_mm: f64, correction_mm: f64) {
        let figures = &mut self.corrected.correction;
        figures.after_mm = figures.after_mm.max(bound_mm);
        figures.largest_mm = figures.largest_mm.max(correction_mm);
        let still = piece.axes.iter().all(|word| *word == AxisWord::Omit);
        let same_centre = match piece.kind {
            PieceKind::Arc { centre: Centre::Offsets(words), .. } => {
                words.iter().all(|word| matches!(word, AxisWord::Keep | AxisWord::Omit))
            }
            PieceKind::Arc { centre: Centre::Radius(word), .. } => word == AxisWord::Keep,
            _ => true,
        };
        let untouched = self.alone
            && same_centre
            && piece.axes.iter().all(|word| matches!(word, AxisWord::Keep | AxisWord::Omit));
        if untouched || (still && !matches!(piece.kind, PieceKind::Arc { .. })) {
            return;
        }
        self.corrected.pieces.push(piece);
    }
}
