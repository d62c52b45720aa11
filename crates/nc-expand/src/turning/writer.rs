//! What the writer of a lathe's cycles knows at a block.

use diagnostic::Text;
use nc_dialect::{Action, Dialect, Turning, TurningCycle};
use nc_program::modal::Modal;
use nc_syntax::{Number, Span};

use super::held::{FirstBlocks, Numbers, Pass, numbers};
use super::place::{Spot, diameters, ends_pass, plane, spot, standing};
use crate::came::{Came, Fault};
use crate::known::Rewriting;
use crate::refusals::turning as refusal;
use crate::shorthand::Words;

/// The cycle whose code stands in a block.
pub(super) fn cycle_of(words: &Words<'_, '_>) -> Option<(TurningCycle, Span)> {
    words.actions().find_map(|(action, span)| match action {
        Action::Turning(cycle) => Some((*cycle, span)),
        _ => None,
    })
}

/// Writes the program block by block.
pub(super) struct Writer<'b, 'a, 'd> {
    pub(super) dialect: &'d Dialect,
    pub(super) turning: &'d Turning,
    pub(super) blocks: &'b [Came<'a>],
    pub(super) numbers: Numbers,
    pub(super) out: &'b mut Rewriting<'d>,
    /// What the codes of the block in hand make of the one reader's state.
    pub(super) here: Modal,
    /// The single pass in force, which each block with a place repeats.
    pub(super) pass: Option<Pass>,
    /// Behind a cycle no motion code was said: which one is in force nobody knows.
    pub(super) open: bool,
    /// The program has made a single pass, whose words may still be held.
    pub(super) passed: bool,
    /// What the blocks without P and Q said, which hold for those with them.
    pub(super) first_blocks: FirstBlocks,
    /// The last F stood in a roughing block: whether it holds behind that the manual leaves open.
    pub(super) unsure_feed: bool,
}

impl<'b, 'a, 'd> Writer<'b, 'a, 'd> {
    pub(super) fn new(blocks: &'b [Came<'a>], turning: &'d Turning, out: &'b mut Rewriting<'d>) -> Self {
        Self {
            dialect: out.dialect,
            turning,
            blocks,
            numbers: numbers(blocks, out.dialect),
            pass: None,
            passed: false,
            open: false,
            here: out.known.modal().clone(),
            out,
            first_blocks: FirstBlocks::default(),
            unsure_feed: false,
        }
    }

    pub(super) fn words(&self, at: usize) -> Words<'b, 'a> {
        Words::of(&self.blocks[at], self.dialect)
    }

    /// What a block that is no cycle's says of what cycles have left.
    pub(super) fn said(&mut self, words: &Words<'_, '_>) {
        self.unsure_feed &= words.number(b'F').is_none();
        if words.motion().is_some() {
            (self.pass, self.open) = (None, false);
        } else if self.pass.is_some() && words.actions().any(|(action, _)| ends_pass(action)) {
            self.leave_open();
        }
    }

    /// Behind a cycle.
    pub(super) fn leave_open(&mut self) {
        (self.pass, self.open) = (None, true);
    }

    /// The last F; `words`: of the block in hand.
    pub(super) fn feed(&self, words: &Words<'_, '_>) -> Option<Number> {
        words.number(b'F').map(|(feed, _)| feed).or(self.out.known.modal().feed)
    }

    /// Where the tool stands, both axes.
    pub(super) fn standing(&self, words: &Words<'_, '_>, span: Span) -> Result<Spot, Fault> {
        if let [Some(x), Some(z)] = standing(self.out.known.modal()) {
            return Ok([x, z]);
        }
        Err(words.fault(refusal::START_NOT_KNOWN, span))
    }

    /// Where the words of the block in hand lead.
    pub(super) fn target(&self, words: &Words<'_, '_>) -> [Option<i64>; 2] {
        words.target(&self.here, standing(self.out.known.modal()))
    }

    /// The same where it is known.
    pub(super) fn known_target(&self, words: &Words<'_, '_>, span: Span) -> Result<Spot, Fault> {
        if let [Some(x), Some(z)] = self.target(words) {
            return Ok([x, z]);
        }
        Err(words.fault(refusal::END_NOT_KNOWN, span))
    }

    /// A length in millionths of the unit.
    pub(super) fn length(&self, words: &Words<'_, '_>, letter: u8) -> Option<i64> {
        words.millionths(&self.here, letter)
    }

    /// Millionths of an X word in one of the radius.
    pub(super) fn twice(&self) -> i64 {
        if diameters(&self.here) == Some(true) { 2 } else { 1 }
    }

    /// A place in the plane of radius and Z.
    pub(super) fn plane(&self, spot: Spot) -> [f64; 2] {
        plane(&self.here, spot)
    }

    /// The place whose words are nearest.
    pub(super) fn spot(&self, place: [f64; 2]) -> Spot {
        spot(&self.here, place)
    }

    /// Whether X is a diameter must be known for depths and tapers, which are radii.
    pub(super) fn require_diameters(&self, words: &Words<'_, '_>, span: Span) -> Result<(), Fault> {
        if diameters(&self.here).is_some() {
            return Ok(());
        }
        Err(words.fault(refusal::DIAMETER_OR_RADIUS, span))
    }
}

impl Words<'_, '_> {
    pub(super) fn parameter_fault(&self, span: Span, what: &Text, key: &str, value: &str) -> Fault {
        self.fault(refusal::parameter_of_the_control(what, key, value), span)
    }
}
