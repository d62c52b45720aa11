//! Drilling cycles of controls that say their levels by words and codes of their own, written out as plain moves; the
//! table says which ([`WrittenCycles`]).
//!
//! Okuma: `G71 Z50.` says a level, `G81 X Y Z R F M53` drills and returns to it, with M54 to R; every block behind it
//! that names X or Y drills again, until G80 or a motion code. A control keeps the level in mind, and no word of the
//! cycle's block names it: so the moves are written, each with its height. Fagor: `G98 G81 X Y Z I F`, where Z is the
//! level where the feed begins and I the bottom, returns to where the tool stood before, with G99 to Z.
//!
//! Source: Okuma OSP-P200M/P20M Programming Manual, fixed cycles: G81, G82 and G83, the return level command. With R
//! the level where the feed begins, Z the bottom, Q a peck: rapid across, rapid to R, feed to Z (G83: by Q, rapid to R
//! and back to what is drilled less a clearance), rapid to the level. Fagor CNC 8055 M Programming Manual, chapter 9,
//! G81. The numbers written have 6 decimals.

use diagnostic::Refusal;
use nc_dialect::{Action, CycleBack, Dialect, WrittenCycles};
use nc_program::modal::ReturnLevel;
use nc_syntax::{Block, ItemKind, Letters, Span, Value};
use toolpath::{CycleKind, MOST_PECKS, Plane, Retreat, Stroke, peck_depths, strokes, whole_pecks};

use crate::came::{Came, Fault};
use crate::known::{Lower, Rewriting};
use crate::refusals::called as refusal;
use crate::shorthand::{AXES, Words, actions, add, line_of, number, shown};

/// Words that a block of a cycle may have beside those of its levels.
const TAKEN: Letters = Letters::of(b"FGMNPQXY");

/// True where the block has a cycle that this dialect writes out.
pub(crate) fn needed(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.flow.written_cycles.is_some()
        && actions(block, dialect).any(|(action, _)| matches!(action, Action::Cycle(_)))
}

/// A cycle in force.
#[derive(Clone, Copy)]
struct Cycle {
    bottom: f64,
    near: f64,
    /// Depth of a peck.
    peck: Option<f64>,
    /// Where it returns to.
    back: f64,
}

/// Writes cycles out, block by block.
pub(crate) struct Writer<'d> {
    dialect: &'d Dialect,
    rule: WrittenCycles,
    out: Rewriting<'d>,
    /// G71.
    level: Option<f64>,
    cycle: Option<Cycle>,
    /// G80 ended a cycle, and no motion code was written since: the control's is not certain.
    open: bool,
}

impl<'d> Lower<'d> for Writer<'d> {
    fn came(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        let words = Words::of(came, self.dialect);
        let begins = words.actions().any(|(action, _)| matches!(action, Action::Cycle(_)));
        let moves = b"XYZ".iter().any(|letter| words.number(*letter).is_some());
        let cancels = words.actions().any(|(action, _)| *action == Action::CycleCancel);
        let codes = words.actions().any(|(action, _)| {
            matches!(
                action,
                Action::Rapid | Action::Line | Action::ArcClockwise | Action::ArcCounterClockwise
            )
        });
        let ends = cancels || (codes && self.rule.back == CycleBack::ByM);
        if begins {
            self.out.wake();
            return self.begin(came);
        }
        if ends && self.cycle.is_some() && words.skipped() {
            return Err(words.fault(refusal::END_BEHIND_BLOCK_DELETE, words.whole()));
        }
        // A code between its holes would change what its numbers mean.
        let codes_between = words.actions().next().is_some();
        if self.cycle.is_some() && !ends && (moves || codes_between) {
            return self.again(&words);
        }
        self.open = (self.open || (cancels && self.cycle.is_some())) && !codes;
        if ends {
            self.cycle = None;
        }
        if self.open && moves && words.actions().all(|(action, _)| !owns(action)) {
            return Err(words.fault(refusal::MOVE_WITHOUT_ITS_CODE, words.whole()));
        }
        if let Some((_, span)) = words.actions().find(|(action, _)| **action == Action::ReturnLevel) {
            self.out.wake();
            self.level = Some(self.level_of(&words, span)?);
        } else if words.actions().any(|(action, _)| moves_levels(action)) {
            self.level = None;
        }
        self.out.block(came);
        Ok(())
    }

    fn fresh_line(&mut self) {
        self.out.fresh_line();
    }

    fn out(&mut self) -> Option<&mut Rewriting<'d>> {
        Some(&mut self.out)
    }

    fn end(self: Box<Self>) -> (Rewriting<'d>, Result<(), Fault>) {
        (self.out, Ok(()))
    }
}

impl<'d> Writer<'d> {
    pub(crate) const fn new(out: Rewriting<'d>, rule: WrittenCycles) -> Self {
        Self { dialect: out.dialect, rule, out, level: None, cycle: None, open: false }
    }

    fn length(&self, words: &Words<'_, '_>, letter: u8) -> Option<f64> {
        words.length(letter, self.out.known.modal().units)
    }

    /// G71 Z.
    fn level_of(&self, words: &Words<'_, '_>, span: Span) -> Result<f64, Fault> {
        let alone = words.block.words().all(|word| matches!(word.letter, b'G' | b'N' | b'Z'))
            && words.actions().count() == 1
            && self.out.known.modal().says_places()
            && !words.skipped();
        match self.length(words, b'Z').filter(|_| alone) {
            Some(level) => Ok(level),
            None => Err(words.fault(refusal::RETURN_LEVEL_NOT_CERTAIN, span)),
        }
    }

    /// A block with the code of a cycle.
    fn begin(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        let (block, words) = (&came.block, &Words::of(came, self.dialect));
        let refuse = |refusal: Refusal, span: Span| Err(words.fault(refusal, span));
        let mut kind = None;
        for (action, span) in words.actions() {
            match action {
                Action::Cycle(cycle) => kind = Some((*cycle, span)),
                Action::Absolute | Action::Plane(_) => {}
                Action::ReturnInitial | Action::ReturnR if self.rule.back == CycleBack::ByG => {}
                _ => {
                    return refuse(refusal::CYCLE_BESIDE_ANOTHER_CODE, span);
                }
            }
        }
        let Some((kind, span)) = kind else { return Ok(()) };
        let Some((here, _)) = self.out.known.codes(block) else {
            self.out.block(came);
            return Ok(());
        };
        if !here.says_places() || here.plane != Plane::Xy || words.skipped() {
            return refuse(refusal::CYCLE_THAT_CANNOT_BE_WRITTEN_OUT, span);
        }
        let back = match self.rule.back {
            CycleBack::ByM => self.back(words, span)?,
            CycleBack::ByG => self.back_by_code(words, span, here.return_level)?,
        };
        let [level, depth] = self.rule.levels;
        let (bottom, near) = match (self.length(words, depth), self.length(words, level)) {
            (Some(bottom), Some(near)) if bottom < near => (bottom, near),
            _ => {
                return refuse(refusal::cycle_without_levels(depth as char, level as char), span);
            }
        };
        let peck = match (kind, self.length(words, b'Q')) {
            (CycleKind::PeckFull, Some(peck)) if peck > 0.0 && (near - bottom) / peck <= MOST_PECKS => {
                Some(peck)
            }
            (CycleKind::PeckFull, _) => {
                return refuse(refusal::PECKS_WITHOUT_DEPTH, span);
            }
            (_, None) => None,
            (_, Some(_)) => {
                return refuse(refusal::Q_WITHOUT_PECKS, span);
            }
        };
        let back = match back {
            Back::R => near,
            Back::Level(back) if back >= near => back,
            Back::Level(_) => {
                return refuse(refusal::return_level_below(level as char), span);
            }
        };
        self.only_known(words)?;
        self.open = false;
        self.cycle = Some(Cycle { bottom, near, peck, back });
        self.out.comment(shown(block), words.from);
        let mut head = b"G0".to_vec();
        // What the codes beside the cycle set stays so behind it.
        for (_, span) in words.actions().filter(|(action, _)| !matches!(action, Action::Cycle(_))) {
            add(&mut head, block.text(span));
        }
        self.hole(words, head)
    }

    /// A block that drills again.
    fn again(&mut self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let plain = words.actions().next().is_none()
            && words.block.words().all(|word| matches!(word.letter, b'N' | b'X' | b'Y'))
            && !words.skipped();
        if !plain {
            return Err(words.fault(refusal::BLOCK_UNDER_CYCLE_NOT_CERTAIN, words.whole()));
        }
        self.out.comment(shown(words.block), words.from);
        self.hole(words, b"G0".to_vec())
    }

    /// The moves of a hole; `head` begins the first of them.
    fn hole(&mut self, words: &Words<'_, '_>, head: Vec<u8>) -> Result<(), Fault> {
        let Some(Cycle { bottom, near, peck, back }) = self.cycle else { return Ok(()) };
        let source = words.from;
        let mut line = head;
        for letter in AXES.into_iter().take(2) {
            if let Some(value) = self.length(words, letter) {
                number(&mut line, letter, value);
            }
        }
        if line.len() > 2 {
            self.out.line(&line, source);
        }
        let feed = words.texts(b"F");
        let clearance = self.dialect.output.peck_clearance_mm / self.out.known.modal().units.mm();
        let deep = near - bottom;
        let peck = peck.unwrap_or(deep);
        let depths = peck_depths(deep, peck, whole_pecks(deep / peck));
        let mut line = |code: &[u8], level: f64, feed: &[u8]| {
            let mut text = line_of(code, [(b'Z', level)]);
            add(&mut text, feed);
            self.out.line(&text, source);
        };
        line(b"G0", near, b"");
        for stroke in strokes(depths, Retreat::Out { clearance }) {
            match stroke {
                Stroke::In(depth) => line(b"G1", near - depth, &feed),
                Stroke::Out => line(b"G0", near, b""),
                Stroke::Again(depth) => line(b"G0", near - depth, b""),
            }
        }
        line(b"G0", back, b"");
        Ok(())
    }

    /// M53 or M54.
    fn back(&self, words: &Words<'_, '_>, span: Span) -> Result<Back, Fault> {
        let code = |wanted: i64| {
            words.block.words().any(|word| {
                word.letter == b'M' && word.number().and_then(|number| number.integer()) == Some(wanted)
            })
        };
        match (code(53), code(54), self.level) {
            (true, false, Some(level)) => Ok(Back::Level(level)),
            (false, true, _) => Ok(Back::R),
            (true, false, None) => Err(words.fault(refusal::M53_WITHOUT_LEVEL, span)),
            _ => Err(words.fault(refusal::RETURN_NOT_SAID, span)),
        }
    }

    /// G98 or G99, in this block or before it.
    fn back_by_code(&self, words: &Words<'_, '_>, span: Span, level: ReturnLevel) -> Result<Back, Fault> {
        match (level, self.out.known.modal().places()[2]) {
            (ReturnLevel::R, _) => Ok(Back::R),
            (ReturnLevel::Initial, Some(stands)) => Ok(Back::Level(stands)),
            (ReturnLevel::Initial, None) => Err(words.fault(refusal::RETURN_TO_UNKNOWN_LEVEL, span)),
            (ReturnLevel::Unsaid | ReturnLevel::Undecided { .. }, _) => {
                Err(words.fault(refusal::G98_OR_G99_NOT_SAID, span))
            }
        }
    }

    /// Refuses words whose meaning in a cycle is not certain.
    fn only_known(&self, words: &Words<'_, '_>) -> Result<(), Fault> {
        for item in &words.block.items {
            let known = match item.kind {
                ItemKind::Word { letter: b'M', value: Value::Number(number) } => {
                    self.rule.back == CycleBack::ByM && matches!(number.integer(), Some(53 | 54))
                }
                // A dwell.
                ItemKind::Word { letter: b'P' | b'K', value: Value::Number(number) } => {
                    number.decimal.mantissa == 0
                }
                ItemKind::Word { letter, value: Value::Number(_) } => {
                    TAKEN.any(Letters::of(&[letter])) || self.rule.levels.contains(&letter)
                }
                ItemKind::Comment | ItemKind::Name => true,
                _ => false,
            };
            if !known {
                return Err(words.fault(refusal::WORD_BESIDE_CYCLE_NOT_CERTAIN, item.span));
            }
        }
        Ok(())
    }
}

/// Where a cycle returns to.
#[derive(Clone, Copy)]
enum Back {
    Level(f64),
    R,
}

/// Behind it a height of before is another.
const fn moves_levels(action: &Action) -> bool {
    matches!(
        action,
        Action::Inch
            | Action::Millimetre
            | Action::WorkOffset(_)
            | Action::WorkOffsetNumbered
            | Action::WorkOffsetByH
            | Action::WriteOffset
            | Action::LocalShift
            | Action::Preset
            | Action::PresetCancel
            | Action::PresetSuspend
            | Action::PresetRestore
            | Action::ScalingOn
            | Action::ScalingOff
            | Action::MirrorOn
            | Action::MirrorOff
    )
}

/// The words of the block are this code's.
fn owns(action: &Action) -> bool {
    matches!(
        action,
        Action::ReturnLevel | Action::Dwell | Action::Pass { takes_words: true } | Action::Reference
    )
}
