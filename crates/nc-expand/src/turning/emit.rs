//! Blocks out: what a cycle's block sets, then its moves.

use nc_dialect::Action;
use nc_program::modal::Modal;
use nc_syntax::{Item, ItemKind, Span, Value};

use super::place::{AXES, CODES, Code, MILLION, Spot, may_stand_beside, millionths};
use super::writer::Writer;
use crate::came::{Fault, From};
use crate::refusals::turning as refusal;
use crate::shorthand::{Words, add, number, shown};

/// The moves of one cycle on their way out.
#[derive(Debug)]
pub(super) struct Moves {
    /// Whom they stand for.
    pub(super) from: From,
    at: Spot,
    /// They are written as places, not as ways.
    places: bool,
    /// Words that go before the first move.
    before: Vec<u8>,
    /// Words that the control executes behind its motion, for the last one.
    behind: Vec<u8>,
    /// G91 of the block, which holds behind it; the moves are written as places.
    incremental: Vec<u8>,
    /// The move that was made last: its code and words, without what stands around them.
    last: Option<(Vec<u8>, From)>,
}

impl Moves {
    /// Moves from a place in a state, for a block that is written already.
    pub(super) fn new(from: From, at: Spot, state: &Modal) -> Self {
        Self {
            from,
            at,
            places: state.says_places(),
            before: Vec::new(),
            behind: Vec::new(),
            incremental: Vec::new(),
            last: None,
        }
    }

    /// Takes what the control executes behind the last move, for moves that come later.
    pub(super) fn take_behind(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.behind)
    }

    /// The same moves with words that the control executes behind the last of them.
    pub(super) fn with_behind(self, behind: Vec<u8>) -> Self {
        Self { behind, ..self }
    }

    pub(super) const fn at(&self) -> Spot {
        self.at
    }
}

impl Writer<'_, '_, '_> {
    /// Begins the moves of a block's cycle: the block as a comment; of its words `own` are the cycle's.
    pub(super) fn begin(&mut self, words: &Words<'_, '_>, at: Spot, own: &[u8]) -> Result<Moves, Fault> {
        let block = words.block;
        let (mut before, mut behind, mut incremental) = (Vec::new(), Vec::new(), Vec::new());
        let increments = words.actions().find(|(action, _)| **action == Action::Incremental);
        if let Some((_, span)) = increments {
            incremental = block.text(span).to_vec();
            if !self.out.known.modal().says_places() {
                before = self.row(&Action::Absolute);
            }
        }
        for item in &block.items {
            match item.kind {
                ItemKind::Word { letter, value: Value::Number(number) } if own.contains(&letter) => {
                    if millionths(number.decimal).is_none() {
                        return Err(words.fault(refusal::NUMBER_THAT_IS_NONE, item.span));
                    }
                }
                ItemKind::Word { letter: b'G', value: Value::Number(_) } => {
                    let taken = increments.is_some_and(|(_, span)| span == item.span);
                    if setting(words, item.span)? && !taken {
                        add(&mut before, block.text(item.span));
                    }
                }
                ItemKind::Word { letter: b'M', value: Value::Number(number) } => {
                    let row = number.integer().and_then(|m| words.dialect.m_code(u16::try_from(m).ok()?));
                    let late = row.is_some_and(|row| row.after_motion);
                    add(if late { &mut behind } else { &mut before }, block.text(item.span));
                }
                ItemKind::Word { letter: b'N' | b'F' | b'S', .. } => add(&mut before, block.text(item.span)),
                ItemKind::Comment | ItemKind::Name => {}
                _ => return Err(stray(words, item)),
            }
        }
        self.out.comment(shown(block), words.from);
        let moves = Moves::new(words.from, at, &self.here);
        Ok(Moves { before, behind, places: moves.places || increments.is_some(), incremental, ..moves })
    }

    /// A move to a place. Axes that a feed leaves where they are get no word; a rapid names both, so that both are
    /// corrected for where it ends, and what follows starts there.
    pub(super) fn go(&mut self, moves: &mut Moves, code: Code, to: Spot) {
        self.go_with(moves, code, to, b"");
    }

    /// The same with further words, which are written even where no axis moves.
    pub(super) fn go_with(&mut self, moves: &mut Moves, code: Code, to: Spot, further: &[u8]) {
        if to == moves.at && further.is_empty() {
            return;
        }
        let own = CODES.iter().find(|(_, of)| *of == code);
        let mut line = own.map_or_else(Vec::new, |(action, _)| self.row(action));
        for axis in 0..2 {
            let named = code == Code::Rapid && moves.places;
            if named || to[axis] != moves.at[axis] {
                let value = if moves.places { to[axis] } else { to[axis] - moves.at[axis] };
                // Millionths of a unit have six decimals.
                number(&mut line, AXES[axis], value as f64 / MILLION);
            }
        }
        add(&mut line, further);
        moves.at = to;
        let last = moves.last.replace((line, moves.from));
        self.line(moves, last, false);
    }

    /// Ends the moves; the tool stands where the last one ended.
    pub(super) fn end(&mut self, mut moves: Moves) {
        let last = moves.last.take().or_else(|| {
            let idle = moves.before.is_empty() && moves.behind.is_empty();
            (!idle).then(|| (Vec::new(), moves.from))
        });
        self.line(&mut moves, last, true);
        if !moves.incremental.is_empty() {
            self.out.line(&moves.incremental, moves.from);
        }
    }

    /// A block between two moves, which moves nothing.
    pub(super) fn between(&mut self, moves: &mut Moves, block: &[u8]) {
        let last = moves.last.take();
        self.line(moves, last, false);
        self.out.line(block, moves.from);
    }

    fn line(&mut self, moves: &mut Moves, line: Option<(Vec<u8>, From)>, last: bool) {
        let Some((line, from)) = line else { return };
        let behind: &[u8] = if last { &moves.behind } else { b"" };
        let mut text = std::mem::take(&mut moves.before);
        add(&mut text, &line);
        add(&mut text, behind);
        self.out.line(&text, from);
    }

    /// The dialect's code for what is done.
    fn row(&self, action: &Action) -> Vec<u8> {
        self.dialect.row_of(action).map_or_else(Vec::new, |row| row.code.to_string().into_bytes())
    }
}

/// True for a code beside a cycle that sets something, false for the cycle's own; what moves or owns words is refused.
fn setting(words: &Words<'_, '_>, span: Span) -> Result<bool, Fault> {
    let action = words.actions().find(|(_, other)| *other == span).map(|(action, _)| action);
    match action {
        Some(Action::Turning(_)) => Ok(false),
        Some(action) if may_stand_beside(action) => Ok(true),
        _ => Err(words.fault(refusal::ANOTHER_CODE_BESIDE_CYCLE, span)),
    }
}

fn stray(words: &Words<'_, '_>, item: &Item) -> Fault {
    let text = String::from_utf8_lossy(words.block.text(item.span)).into_owned();
    words.fault(refusal::beside_cycle(text), item.span)
}
