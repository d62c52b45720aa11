//! The moves of a hole where the axes stand, and what a cycle leaves in force.

use diagnostic::both;
use nc_program::Owner;
use nc_syntax::dialect::Action;

use super::hole::{Hole, Move};
use super::{Writer, names_axes};
use crate::codes;
use crate::known::{Motion, motion};
use crate::lowering::Fault;
use crate::shorthand::{AXES, Words, number};

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
                self.needs(words, true, true)
            }
            _ => Ok(()),
        }
    }

    /// Refuses a cut at a feed or with a spindle that a cycle left open.
    pub(super) fn needs(&self, words: &Words<'_, '_>, feed: bool, spindle: bool) -> Result<(), Fault> {
        let (message, help) = if self.unsaid.feed && feed {
            (
                both!("which feed holds behind CYCLE85", "какая подача действует после CYCLE85"),
                both!("write F in this block", "напишите в этом кадре F"),
            )
        } else if self.unsaid.spindle && spindle {
            (
                both!("whether the spindle turns behind CYCLE86", "вращается ли шпиндель после CYCLE86"),
                both!("write M3 or M4 before this block", "напишите M3 или M4 до этого кадра"),
            )
        } else {
            return Ok(());
        };
        Err(words.fault(
            codes::CALLED_CYCLE,
            words.whole(),
            both!("{message} is not known", "неизвестно, {message:#}"),
            both!("the cycle's manual does not say", "в руководстве цикла этого нет"),
            help,
        ))
    }

    /// The moves of a hole where the axes stand.
    pub(super) fn drill(&mut self, words: &Words<'_, '_>, hole: &Hole) -> Result<(), Fault> {
        let (plane, hole_at) = (self.plane(), self.modal().places());
        if !self.modal().says_places() {
            return Err(words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("a cycle under G91", "цикл при G91"),
                both!("its moves are places", "его ходы заданы координатами"),
                both!("write G90 before it", "напишите перед ним G90"),
            ));
        }
        self.needs(words, hole.takes_feed, !hole.leaves_spindle)?;
        self.unsaid.feed |= hole.leaves_feed;
        self.unsaid.spindle |= hole.leaves_spindle;
        let axis = plane[2];
        let (source, letter) = (words.from, AXES[axis]);
        for step in &hole.moves {
            let mut line = Vec::new();
            match *step {
                Move::Rapid(to) => {
                    line.extend_from_slice(b"G0 ");
                    number(&mut line, letter, to);
                }
                Move::Feed(to) => {
                    line.extend_from_slice(b"G1 ");
                    number(&mut line, letter, to);
                }
                Move::FeedAt(to, feed) => {
                    line.extend_from_slice(b"G1 ");
                    number(&mut line, letter, to);
                    line.push(b' ');
                    number(&mut line, b'F', feed);
                }
                Move::Spindle(code) => line.extend_from_slice(format!("M{code}").as_bytes()),
                Move::Orient(angle) => {
                    number(&mut line, b'=', angle);
                    line.splice(0..0, *b"SPOS");
                }
                Move::Aside(by) => {
                    line.extend_from_slice(b"G0");
                    for (axis, by) in plane.into_iter().zip(by).filter(|(_, by)| *by != 0.0) {
                        let at = self.place(words, axis)? + by;
                        line.push(b' ');
                        number(&mut line, AXES[axis], at);
                    }
                }
                Move::Over(to) => {
                    line.extend_from_slice(b"G0");
                    let here = self.modal().places();
                    for axis in plane[..2].iter().filter(|axis| here[**axis] != hole_at[**axis]) {
                        line.push(b' ');
                        number(&mut line, AXES[*axis], hole_at[*axis].unwrap_or(f64::NAN));
                    }
                    line.push(b' ');
                    number(&mut line, letter, to);
                }
                Move::Dwell(time) => {
                    line.extend_from_slice(b"G4 ");
                    number(&mut line, if time < 0.0 { b'S' } else { b'F' }, time.abs());
                }
            }
            self.out.line(&line, source)?;
        }
        Ok(())
    }

    /// Where an axis stands.
    fn place(&self, words: &Words<'_, '_>, axis: usize) -> Result<f64, Fault> {
        self.modal().places()[axis].ok_or_else(|| {
            words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("where {} stands is not known", "неизвестно, где стоит {}", AXES[axis] as char),
                both!("the cycle moves by increments from there", "цикл отходит оттуда на приращения"),
                both!("name it before the cycle, in G90", "назовите её до цикла, при G90"),
            )
        })
    }

    /// The motion code that was in force before a cycle.
    pub(super) fn restore(&mut self, words: &Words<'_, '_>, before: Motion) -> Result<(), Fault> {
        match before {
            Motion::Rapid | Motion::None => Ok(()),
            Motion::Line => self.out.line(b"G1", words.from),
            Motion::Arc | Motion::Cycle => Err(words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("a cycle while an arc is in force", "цикл, пока действует дуга"),
                both!(
                    "the words behind it would be an arc's again",
                    "слова после него снова относились бы к дуге"
                ),
                both!("write G0 before the cycle", "напишите G0 до цикла"),
            )),
        }
    }
}
