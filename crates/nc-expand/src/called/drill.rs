//! The moves of a hole where the axes stand, and what a cycle leaves in force.

use diagnostic::{both, refusal};
use nc_dialect::Action;
use nc_program::Owner;

use super::hole::{Hole, Move};
use super::{Unsaid, Writer, names_axes};
use crate::came::Fault;
use crate::codes;
use crate::known::{Motion, motion};
use crate::refusals::called as refusal;
use crate::shorthand::{AXES, Words, line_of, number};

impl Writer<'_> {
    /// Feed and spindle behind a cycle that leaves them open: what the block says of them, or that it had to.
    pub(super) fn said(&mut self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let dwells = words.actions().any(|(action, _)| *action == Action::Dwell);
        self.unsaid.feed &= dwells || words.number(b'F').is_none();
        self.unsaid.spindle &= !words.block.words().any(|word| {
            let code = word.number().filter(|_| word.letter == b'M').and_then(|number| number.integer());
            matches!(code, Some(3..=5))
        });
        match self.out.known().codes(words.block) {
            Some((here, Owner::Motion | Owner::DwellP))
                if names_axes(words) && matches!(motion(&here), Motion::Line | Motion::Arc) =>
            {
                self.needs(words, Unsaid { feed: true, spindle: true })
            }
            _ => Ok(()),
        }
    }

    /// Refuses a cut that needs a feed or a spindle which a cycle left unsaid.
    pub(super) fn needs(&self, words: &Words<'_, '_>, needed: Unsaid) -> Result<(), Fault> {
        let (message, help) = if self.unsaid.feed && needed.feed {
            (
                both!("which feed holds behind CYCLE85", "какая подача действует после CYCLE85"),
                both!("write F in this block", "напишите в этом кадре F"),
            )
        } else if self.unsaid.spindle && needed.spindle {
            (
                both!("whether the spindle turns behind CYCLE86", "вращается ли шпиндель после CYCLE86"),
                both!("write M3 or M4 before this block", "напишите M3 или M4 до этого кадра"),
            )
        } else {
            return Ok(());
        };
        Err(words.fault(
            refusal!(codes::CALLED_CYCLE;
                "{message} is not known", "неизвестно, {message:#}";
                "the cycle's manual does not say", "в руководстве цикла этого нет";
                help
            ),
            words.whole(),
        ))
    }

    /// The moves of a hole where the axes stand.
    pub(super) fn drill(&mut self, words: &Words<'_, '_>, hole: &Hole) -> Result<(), Fault> {
        let (plane, hole_at) = (self.plane(), self.modal().places());
        if !self.modal().says_places() {
            return Err(words.fault(refusal::CYCLE_UNDER_G91, words.whole()));
        }
        self.needs(words, Unsaid { feed: hole.takes_feed, spindle: !hole.leaves_spindle })?;
        self.unsaid.feed |= hole.leaves_feed;
        self.unsaid.spindle |= hole.leaves_spindle;
        let axis = plane[2];
        let (source, letter) = (words.from, AXES[axis]);
        for step in &hole.moves {
            let line = match *step {
                Move::Rapid(to) => line_of(b"G0", [(letter, to)]),
                Move::Feed(to) => line_of(b"G1", [(letter, to)]),
                Move::FeedAt(to, feed) => line_of(b"G1", [(letter, to), (b'F', feed)]),
                Move::Spindle(code) => format!("M{code}").into_bytes(),
                Move::Orient(angle) => [&b"SPOS"[..], &line_of(b"", [(b'=', angle)])].concat(),
                Move::Aside(by) => {
                    let mut line = b"G0".to_vec();
                    for (axis, by) in plane.into_iter().zip(by).filter(|(_, by)| *by != 0.0) {
                        number(&mut line, AXES[axis], self.place(words, axis)? + by);
                    }
                    line
                }
                Move::Over(to) => {
                    let here = self.modal().places();
                    let moved = plane[..2].iter().filter(|axis| here[**axis] != hole_at[**axis]);
                    let back = moved.map(|axis| (AXES[*axis], hole_at[*axis].unwrap_or(f64::NAN)));
                    line_of(b"G0", back.chain([(letter, to)]))
                }
                Move::Dwell(time) => line_of(b"G4", [(if time < 0.0 { b'S' } else { b'F' }, time.abs())]),
            };
            self.out.line(&line, source)?;
        }
        Ok(())
    }

    /// Where an axis stands.
    fn place(&self, words: &Words<'_, '_>, axis: usize) -> Result<f64, Fault> {
        self.modal().places()[axis]
            .ok_or_else(|| words.fault(refusal::place_not_known(AXES[axis] as char), words.whole()))
    }

    /// The motion code that was in force before a cycle.
    pub(super) fn restore(&mut self, words: &Words<'_, '_>, before: Motion) -> Result<(), Fault> {
        match before {
            Motion::Rapid | Motion::None => Ok(()),
            Motion::Line => self.out.line(b"G1", words.from),
            Motion::Arc | Motion::Cycle => Err(words.fault(refusal::CYCLE_WHILE_ARC_IN_FORCE, words.whole())),
        }
    }
}
