//! Names of Siemens written out as plain blocks: cycles (CYCLE81 and its like, MCALL, HOLES1, HOLES2), `X=AC()` and
//! `X=IC()`, `TURN=`, `AR=`. Corners (`RND=`, `CHF=`, `CHR=`) are left to [`crate::shorthand`].
//!
//! * A cycle drills where the axes of the plane stand, along the axis upright on it: its moves as G0 and G1, in G90, the
//!   motion code in force behind them as before (G functions outlive a cycle's call).
//! * MCALL calls its cycle behind every block that moves, until MCALL alone.
//! * HOLES1 and HOLES2 are the points of a row or a circle, each followed by the cycle of MCALL.
//! * `AC(v)` is the place v, `IC(v)` the place v away from where the axis stands; of I, J, K from the arc's start.
//! * CYCLE85 ends with a feed of its own and CYCLE86 with a spindle that stands; what holds behind them the manual does
//!   not say, so that the program must.
//! * `AR=a`: an arc of a degrees, by its end or by its centre.
//! * `TURN=n`: n full circles, then the arc that the words say, the way along the axis shared by angle.
//!
//! Source: SINUMERIK 840D Programming Guide Cycles, chapter 2; Programming Manual Fundamentals, sections on AC, IC and
//! helices. The numbers written have 6 decimals.

mod angle;
mod arguments;
mod dimensions;
mod drill;
mod hole;
mod pattern;

use nc_dialect::{Action, Called, Dialect};
use nc_program::Owner;
use nc_program::modal::{Distance, Modal};
use nc_syntax::{Block, Item, ItemKind, Span, Value};

use crate::came::{Came, Fault};
use crate::known::{Lower, Rewriting, motion};
use crate::refusals::called as refusal;
use crate::shorthand::{AXES, Corners, Words, numbers, shown};
use crate::siemens;
use arguments::Arguments;
use hole::Hole;

/// True where the block has a name that this dialect writes out.
pub(crate) fn needed(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.flow.called
        && block.items.iter().any(|item| match item.kind {
            ItemKind::BracketCommand => called(block, dialect, item).is_some(),
            ItemKind::Word { letter, value: Value::Expression } => {
                dimension(letter, block.text(item.span)).is_some()
            }
            _ => false,
        })
}

fn called(block: &Block<'_>, dialect: &Dialect, item: &Item) -> Option<Called> {
    match dialect.command(block.text(item.span))?.action {
        // Corners are shorthand of drawings, whatever they are called.
        Some(Action::Called(Called::Corner(_))) => None,
        Some(Action::Called(called)) if item.kind == ItemKind::BracketCommand => Some(called),
        _ => None,
    }
}

/// True for `X=AC(…)` and its like.
pub(crate) fn is_dimension(letter: u8, text: &[u8]) -> bool {
    dimension(letter, text).is_some()
}

/// What is in the brackets of `X=AC(…)` or `X=IC(…)`, and what it counts from.
fn dimension(letter: u8, text: &[u8]) -> Option<(&str, Distance)> {
    let (name, inside) = siemens::function_of(text).filter(|_| b"XYZIJK".contains(&letter))?;
    let inside = std::str::from_utf8(&text[inside]).ok()?.trim();
    match &name.to_ascii_uppercase()[..] {
        b"AC" => Some((inside, Distance::Absolute)),
        b"IC" => Some((inside, Distance::Incremental)),
        _ => None,
    }
}

/// Writes names out, block by block.
pub(crate) struct Writer<'d> {
    dialect: &'d Dialect,
    out: Corners<'d>,
    /// The cycle of MCALL.
    modal: Option<Hole>,
    unsaid: Unsaid,
}

/// What a cycle left in force that its manual does not say.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Unsaid {
    feed: bool,
    spindle: bool,
}

impl<'d> Lower<'d> for Writer<'d> {
    fn came(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        if self.modal.is_none() && self.unsaid == Unsaid::default() && !needed(&came.block, self.dialect) {
            return self.out.came(came);
        }
        self.out.out().wake();
        self.block(came)
    }

    fn fresh_line(&mut self) {
        self.out.fresh_line();
    }

    fn out(&mut self) -> Option<&mut Rewriting<'d>> {
        Some(self.out.out())
    }

    fn end(self: Box<Self>) -> (Rewriting<'d>, Result<(), Fault>) {
        self.out.end()
    }
}

impl<'d> Writer<'d> {
    pub(crate) const fn new(out: Rewriting<'d>) -> Self {
        Self {
            dialect: out.dialect,
            out: Corners::new(out),
            modal: None,
            unsaid: Unsaid { feed: false, spindle: false },
        }
    }

    fn block(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        let (block, words) = (&came.block, Words::of(came, self.dialect));
        self.said(&words)?;
        if !needed(block, self.dialect) {
            let before = self.modal().places();
            let moves = self.moves(&words);
            self.out.came(came)?;
            return self.behind(&words, moves, before);
        }
        if words.skipped() {
            return Err(words.fault(refusal::CALL_BEHIND_BLOCK_DELETE, words.whole()));
        }
        let calls: Vec<(Called, Span)> = block
            .items
            .iter()
            .filter_map(|item| Some((called(block, self.dialect, item)?, item.span)))
            .filter(|(called, _)| !matches!(called, Called::Turns | Called::ArcAngle))
            .collect();
        if calls.is_empty() {
            return self.dimensions(came);
        }
        self.alone(&words)?;
        let comment = shown(block).to_vec();
        match calls.as_slice() {
            [(Called::Modal, span)] => {
                let more = words.block.text(*span).contains(&b'(');
                if more
                    || block
                        .items
                        .iter()
                        .any(|item| item.kind == ItemKind::BracketCommand && item.span != *span)
                {
                    return Err(words.fault(refusal::MODAL_CALL_OF_UNKNOWN, *span));
                }
                self.modal = None;
                self.out.comment(&comment, words.from)?;
            }
            [(Called::Modal, _), (cycle, span)] if self.drills(*cycle) => {
                self.modal = Some(self.hole(&words, *cycle, *span)?);
                self.out.comment(&comment, words.from)?;
            }
            [(Called::HolesRow | Called::HolesCircle, span)] => {
                let call = Arguments::read(&words, *span)?;
                let Some(hole) = self.modal.clone() else {
                    return Err(words.fault(refusal::without_cycle(&call.name), call.span));
                };
                let places = if calls[0].0 == Called::HolesRow {
                    let ([u, v, _], stands) = (self.plane(), self.modal().places());
                    pattern::row(&words, &call, [stands[u], stands[v]])?
                } else {
                    pattern::circle(&words, &call)?
                };
                self.out.comment(&comment, words.from)?;
                let motion = motion(self.modal());
                for place in places {
                    let mut line = b"G0 ".to_vec();
                    self.point(&mut line, place);
                    self.out.line(&line, words.from)?;
                    self.drill(&words, &hole)?;
                }
                self.restore(&words, motion)?;
            }
            [(cycle, span)] if self.drills(*cycle) => {
                let hole = self.hole(&words, *cycle, *span)?;
                self.out.comment(&comment, words.from)?;
                let motion = motion(self.modal());
                self.drill(&words, &hole)?;
                self.restore(&words, motion)?;
            }
            [.., (_, span)] => return Err(words.fault(refusal::TWO_CALLS_IN_ONE_BLOCK, *span)),
            [] => {}
        }
        Ok(())
    }

    fn drills(&self, cycle: Called) -> bool {
        matches!(
            cycle,
            Called::Drill
                | Called::DrillDwell
                | Called::DrillPecks
                | Called::BoreFeeds
                | Called::BoreOriented
        )
    }

    fn hole(&self, words: &Words<'_, '_>, cycle: Called, span: Span) -> Result<Hole, Fault> {
        let call = Arguments::read(words, span)?;
        Hole::read(words, cycle, &call, self.modal().units.mm(), self.plane()[2])
    }

    /// Behind what is written.
    fn modal(&self) -> &Modal {
        self.out.known().modal()
    }

    /// First and second axis of the plane, and its normal.
    fn plane(&self) -> [usize; 3] {
        self.modal().plane.axes()
    }

    /// True where the block has words of a motion.
    fn moves(&self, words: &Words<'_, '_>) -> bool {
        let owner = self.out.known().codes(words.block).map(|(_, owner)| owner);
        matches!(owner, Some(Owner::Motion | Owner::DwellP)) && names_axes(words)
    }

    /// A call stands in a block of its own.
    fn alone(&self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let other = words.block.items.iter().find(|item| match item.kind {
            ItemKind::Word { letter, .. } => letter != b'N',
            ItemKind::Comment | ItemKind::Name => false,
            _ => called(words.block, words.dialect, item).is_none(),
        });
        match other {
            None => Ok(()),
            Some(item) => Err(words.fault(refusal::WORDS_BESIDE_CALL, item.span)),
        }
    }

    /// The hole behind a block that moves, while MCALL is in force.
    ///
    /// * `at` – the block of the source
    /// * `moves` – it has words of a motion
    /// * `before` – where the axes stood
    fn behind(&mut self, at: &Words<'_, '_>, moves: bool, before: [Option<f64>; 3]) -> Result<(), Fault> {
        let Some(hole) = self.modal.clone() else { return Ok(()) };
        if !moves && self.modal().places() == before {
            return Ok(());
        }
        if at.skipped() {
            return Err(at.fault(refusal::HOLE_BEHIND_BLOCK_DELETE, at.whole()));
        }
        let (motion, places) = (motion(self.modal()), self.modal().places());
        if !moves || self.plane()[..2].iter().any(|axis| places[*axis].is_none()) {
            return Err(at.fault(refusal::MCALL_NOT_KNOWN, at.whole()));
        }
        self.drill(at, &hole)?;
        self.restore(at, motion)
    }

    fn point(&self, line: &mut Vec<u8>, place: [f64; 2]) {
        let [u, v, _] = self.plane();
        numbers(line, [(AXES[u], place[0]), (AXES[v], place[1])]);
    }
}

/// The block has words that a motion takes: rotary axes move too, and a full circle names its centre alone.
fn names_axes(words: &Words<'_, '_>) -> bool {
    b"XYZABCUVWIJK".iter().any(|letter| words.number(*letter).is_some())
}
