//! Blocks of curves by control points: all of them stay as they were posted, or lines stand in the place of the last.

use correction::Correction;
use diagnostic::Diagnostic;
use nc_dialect::Action;
use nc_emit::{WordEdit, WordEdits};
use nc_program::Context;
use nc_syntax::{Block, Item, ItemKind, Letters, Word};
use smallvec::SmallVec;
use toolpath::Motion;

use crate::notices::refusal;
use crate::pass::Pass;
use crate::words::{Original, Stands};

/// Letters of control points, knots, weights and the order.
const OWN: [u8; 10] = *b"XYZIJKPLQR";

impl Pass<'_> {
    /// A block that says a part of a curve: what it says is taken out of it where the curve is written as lines.
    pub(crate) fn curve_said(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        letters: Letters,
    ) -> Result<(), Vec<Diagnostic>> {
        let from = self.out.len();
        if self.stays_a_curve(context, letters) {
            self.pass(block, context, &[])?;
        } else if self.says_more(block) {
            let words = without(letters);
            // In the place of the code stands the one of the lines that follow.
            let dialect = self.job.dialect;
            let codes = block.words().filter_map(|word| dialect.code(word.g_code()?));
            let motion = codes
                .map(|row| &row.action)
                .any(|action| matches!(action, Action::Curve(_)))
                .then_some(self.codes.line());
            self.state
                .emitter
                .rewrite(block, &[nc_emit::Piece { motion, words }], &mut self.out)
                .map_err(|diagnostic| vec![diagnostic])?;
        }
        let written = self.out.len() > from;
        self.note(block, context, &[], &[], 1, written);
        Ok(())
    }

    /// True where a block says more than its part of a curve.
    fn says_more(&self, block: &Block<'_>) -> bool {
        let dialect = self.job.dialect;
        let own = |item: &Item| match item.kind {
            ItemKind::Word { letter: b'G', value } => {
                let word = Word { letter: b'G', value, span: item.span };
                let row = word.g_code().and_then(|code| dialect.code(code));
                row.is_some_and(|row| matches!(row.action, Action::Curve(_)))
            }
            ItemKind::Word { letter, .. } => OWN.contains(&letter),
            _ => false,
        };
        !block.items.iter().all(own)
    }

    /// The block with which a curve is whole.
    pub(crate) fn curve_cut(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        letters: Letters,
        motions: &[Motion],
    ) -> Result<(), Vec<Diagnostic>> {
        let stays = self.stays_a_curve(context, letters);
        let mut info = self.info(context, letters);
        let (mut pieces, mut corrections) = (Vec::new(), SmallVec::<[Correction; 4]>::new());
        for motion in motions {
            let corrected = self
                .state
                .corrector
                .correct(motion, &info)
                .map_err(|error| refusal(&error, motion, block, context))?;
            corrections.push(corrected.correction);
            if !stays {
                // A part of the first degree is a line, and its block a curve's all the same.
                let mut editing = self.editing(context, letters, motion);
                editing.original = Original::Curve;
                for piece in &corrected.pieces {
                    let edited = editing.edit(piece, Stands::at(pieces.len()));
                    pieces.push(edited);
                }
            }
            // The part before has said where they are.
            for axis in 0..3 {
                info.named[axis] |= info.stated.axes[axis];
            }
        }
        if pieces.is_empty() {
            // Too little to move an axis a step.
            pieces.push(nc_emit::Piece { motion: Some(self.codes.line()), words: without(letters) });
        }
        let from = self.out.len();
        if stays {
            self.pass(block, context, motions)?;
        } else {
            self.state
                .emitter
                .rewrite(block, &pieces, &mut self.out)
                .map_err(|diagnostic| vec![diagnostic])?;
        }
        let written = self.out.len() > from;
        self.note(block, context, motions, &corrections, pieces.len().max(1), written);
        Ok(())
    }

    /// True where the machine is without errors.
    fn stays_a_curve(&mut self, context: &Context, letters: Letters) -> bool {
        let info = self.info(context, letters);
        let rotary_deg = self.state.interpreter.modal().axes.partial().rotary_deg;
        self.state.corrector.is_without_errors(&info, rotary_deg)
    }
}

/// The block without what it says of a curve.
fn without(letters: Letters) -> WordEdits {
    let removed = OWN.into_iter().filter(|letter| letters.contains(*letter));
    removed.map(|letter| (letter, WordEdit::Remove)).collect()
}
