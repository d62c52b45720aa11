//! Contours of LinuxCNC: G70, G71, G71.1, G71.2, G72, G72.1, G72.2 with a subroutine as their contour.
//!
//! G-code reference, "G70 Lathe finishing cycle", "G71 G72 Lathe roughing cycles"; what it leaves open is told by
//! `rs274` of 2.9. Q is the number of the subroutine, X and Z where the cycle starts (else where the tool stands). G71,
//! G72: D is the distance that stays, I the depth of a pass, R the escape; .1 cuts no pockets, .2 nothing but pockets.
//! G70: P passes from D down to E off the contour. All of them are radii. The tool ends where the last move ends.
//!
//! The interpreter reads the blocks of the subroutine and executes none: of their codes it takes G0 to G3, and F, S, M
//! and T do nothing. [`crate::run`] puts those blocks behind the block of the cycle, its variables and loops worked
//! out.

use std::ops::Range;

use diagnostic::{Refusal, both};
use nc_dialect::{Action, TurningCycle};
use nc_program::modal::{ArcCentres, FeedMode};
use nc_syntax::{ItemKind, Span, Value};

use toolpath::Plane;

use super::pieces::{Misfit, Round, Segment, Stroke};
use super::place::{Code, MILLION, Spot};
use super::profile::Profile;
use super::writer::Writer;
use crate::came::Fault;
use crate::refusals::routines as refusal;
use crate::shorthand::{Words, numbers, shown};

/// Passes of G70; more are a wrong P.
const MOST_PASSES: i64 = 1000;
/// So much must the radius of an arc be above half its chord: at less the interpreter may find no centre.
const HALF_CIRCLE: f64 = 1e-9;

impl Writer<'_, '_, '_> {
    /// Writes the cycle, and says which block is next.
    pub(super) fn routine(&mut self, at: usize, cycle: TurningCycle, span: Span) -> Result<usize, Fault> {
        let words = self.words(at);
        let refuse = |refusal: Refusal| Err(words.fault(refusal, span));
        self.require_diameters(&words, span)?;
        for letter in *b"UW" {
            if let Some((_, span)) = words.number(letter) {
                return Err(words.fault(refusal::beside_cycle(letter as char), span));
            }
        }
        if !self.here.says_places()
            || self.here.plane != Plane::Zx
            || self.here.feed_mode == FeedMode::InverseTime
            || self.here.arc_centres == ArcCentres::Absolute
        {
            return refuse(refusal::CYCLE_UNDER_OTHER_MODES);
        }
        let named = *b"XZ";
        let both_named = named.iter().all(|letter| words.number(*letter).is_some());
        let standing = if both_named { [i64::MAX; 2] } else { self.standing(&words, span)? };
        let start = match self.target(&words) {
            [Some(x), Some(z)] => [x, z],
            _ => self.standing(&words, span)?,
        };
        let Some(blocks) = self.blocks_behind(at) else {
            let number = words.number(b'Q').map(|(number, _)| number.to_f64());
            let at = words.number(b'Q').map_or(span, |(_, span)| span);
            return Err(words.fault(refusal::without_subroutine(number), at));
        };
        let pieces = self.pieces(&words, start, blocks.clone())?;
        let own: &[u8] = if cycle == TurningCycle::FinishRoutine { b"XZQDEP" } else { b"XZQDIR" };
        let length = |letter: u8, usual: f64| {
            self.length(&words, letter).map_or(usual, |value| value as f64 / MILLION)
        };
        let passes = words.number(b'P').map_or(Some(1), |(number, _)| number.integer());
        let passes = passes.filter(|passes| (1..=MOST_PASSES).contains(passes));
        let (distance, depth, escape) = (length(b'D', 0.0), length(b'I', 1.0), length(b'R', 0.5));
        let Some(passes) = passes.filter(|_| distance >= 0.0 && depth > 0.0 && escape >= 0.0) else {
            return refuse(refusal::DISTANCE_THAT_IS_NONE);
        };
        let profile = Profile::new(&pieces);
        let strokes = match cycle {
            TurningCycle::RoughTurnRoutine(pockets) => profile.rough(false, pockets, distance, depth, escape),
            TurningCycle::RoughFaceRoutine(pockets) => profile.rough(true, pockets, distance, depth, escape),
            _ => profile.finish(distance, length(b'E', 0.0), passes as u32),
        };
        let strokes = strokes.map_err(|misfit| misfit.told(&words, span))?;
        let mut moves = self.begin(&words, standing, own)?;
        for stroke in strokes {
            let (code, to, centre) = match stroke {
                Stroke::Rapid(to) => (Code::Rapid, to, None),
                Stroke::Line(to) => (Code::Line, to, None),
                Stroke::Arc { counter: false, centre, end } => (Code::Clockwise, end, Some(centre)),
                Stroke::Arc { counter: true, centre, end } => (Code::CounterClockwise, end, Some(centre)),
            };
            let to = self.spot(to);
            let mut round = Vec::new();
            if let Some(centre) = centre {
                if to == moves.at() {
                    continue;
                }
                let here = self.plane(moves.at());
                numbers(&mut round, [(b'I', centre[0] - here[0]), (b'K', centre[1] - here[1])]);
            }
            self.go_with(&mut moves, code, to, &round);
        }
        self.unsure_feed &= words.number(b'F').is_none();
        self.end(moves);
        self.leave_open();
        for index in blocks.clone() {
            let came = &self.blocks[index];
            if came.block.acts() {
                self.out.comment(shown(&came.block), came.from);
            } else {
                self.out.block(came);
            }
        }
        Ok(blocks.end)
    }

    /// The blocks of the subroutine, which stand behind the cycle's.
    fn blocks_behind(&self, at: usize) -> Option<Range<usize>> {
        let behind = self.blocks[at + 1..].iter().take_while(|came| came.from.contour).count();
        (behind > 0).then_some(at + 1..at + 1 + behind)
    }

    /// The contour in radius and Z; the first piece leads to it from the start.
    fn pieces(
        &self,
        cycle: &Words<'_, '_>,
        start: Spot,
        blocks: Range<usize>,
    ) -> Result<Vec<Segment>, Fault> {
        let (mut spot, mut motion) = (start, None);
        let (mut at, mut pieces) = (self.plane(start), Vec::new());
        for index in blocks {
            let words = self.words(index);
            let refuse = |refusal: Refusal| Err(words.fault(refusal, words.whole()));
            words.check_routine_block()?;
            motion = words.motion().or(motion);
            let clockwise = motion == Some(Code::Clockwise);
            let arc = clockwise || motion == Some(Code::CounterClockwise);
            if !words.names_a_place() {
                if arc && b"IK".iter().any(|letter| words.number(*letter).is_some()) {
                    return refuse(refusal::ARC_WITHOUT_END);
                }
                continue;
            }
            let [Some(x), Some(z)] = words.target(&self.here, spot.map(Some)) else {
                return refuse(refusal::LEADS_TO_UNKNOWN_PLACE);
            };
            spot = [x, z];
            let to = self.plane(spot);
            if to == at {
                continue;
            }
            if motion.is_none() || (arc && pieces.is_empty()) {
                return refuse(refusal::BEGINS_WITHOUT_G0_OR_G1);
            }
            let says_itself = words.actions().any(|(action, _)| *action == Action::ArcCounterClockwise);
            if arc && !clockwise && !says_itself {
                return refuse(refusal::ARC_WITHOUT_G3);
            }
            let round = if let Some(code) = motion.filter(|_| arc) {
                let radius = words.length(b'R', self.here.units);
                let half = 0.5 * units::math::hypot(to[0] - at[0], to[1] - at[1]);
                if radius.is_some_and(|radius| radius * radius - half * half < HALF_CIRCLE || radius < 0.0) {
                    return refuse(refusal::ARC_WHOSE_R_NOT_CERTAIN);
                }
                Some(Round { centre: self.arc(&words, at, to, code)?.centre(), counter: !clockwise })
            } else {
                None
            };
            pieces.push(Segment { start: at, end: to, round });
            at = to;
        }
        if pieces.len() < 2 {
            return Err(cycle.fault(
                refusal::ENDS_WHERE_IT_BEGINS,
                cycle.number(b'Q').map_or_else(|| cycle.whole(), |(_, span)| span),
            ));
        }
        Ok(pieces)
    }
}

impl Words<'_, '_> {
    /// Refuses what the interpreter reads in a contour and does not do.
    fn check_routine_block(&self) -> Result<(), Fault> {
        for item in &self.block.items {
            let fits = match item.kind {
                ItemKind::Comment | ItemKind::Name => true,
                ItemKind::Word { letter: b'G', value: Value::Number(_) } => {
                    let action =
                        self.actions().find(|(_, span)| *span == item.span).map(|(action, _)| action);
                    let motions =
                        [Action::Rapid, Action::Line, Action::ArcClockwise, Action::ArcCounterClockwise];
                    action.is_some_and(|action| motions.contains(action))
                }
                // Feed and speed are read and not executed: roughing and finishing go on with those of before.
                ItemKind::Word { letter, value: Value::Number(_) } => b"XZIKRNFS".contains(&letter),
                _ => false,
            };
            if !fits {
                let text = String::from_utf8_lossy(self.block.text(item.span)).into_owned();
                return Err(self.fault(refusal::within_contour(text), item.span));
            }
        }
        Ok(())
    }
}

impl Misfit {
    fn told(self, words: &Words<'_, '_>, span: Span) -> Fault {
        let (message, label) = match self {
            Self::NotMonotone => (
                both!(
                    "the contour turns back along the axis of the passes",
                    "контур возвращается назад вдоль оси проходов"
                ),
                both!(
                    "G71 takes one that never turns back along Z, G72 along X, and arcs of a quarter turn at most",
                    "G71 принимает контур, не возвращающийся по Z, G72 — по X, и дуги не больше четверти оборота"
                ),
            ),
            Self::WrongSide => (
                both!("the cycle starts on the side of the workpiece", "цикл начинается со стороны детали"),
                both!(
                    "the first block of the contour leads from the start down to it: X of G71, Z of G72",
                    "первый кадр контура ведёт к нему от начала вглубь: по X для G71, по Z для G72"
                ),
            ),
            Self::Distance => (
                both!(
                    "the contour cannot be moved off by this distance",
                    "контур нельзя сместить на этот припуск"
                ),
                both!("an arc or a groove of it is narrower", "его дуга или канавка уже"),
            ),
            Self::Straight => (
                both!(
                    "two lines that go straight on, and a distance to stay",
                    "две прямые, продолжающие друг друга, и ненулевой припуск"
                ),
                both!(
                    "the interpreter finds no corner between them",
                    "интерпретатор не находит между ними угла"
                ),
            ),
            Self::Endless => (
                both!(
                    "passes that come to no end, or more than 20000 of them",
                    "проходы без конца или их больше 20000"
                ),
                both!(
                    "the contour has no place at some depth, or the depth is too small",
                    "на какой-то глубине у контура нет точки, или глубина слишком мала"
                ),
            ),
            Self::Level => (
                both!(
                    "a pass lies as deep as a place of the contour, but for the last digits of both",
                    "проход лежит на глубине точки контура с точностью до последних знаков"
                ),
                both!(
                    "whether the interpreter cuts there hangs on its rounding: take I or D a thousandth larger",
                    "режет ли там интерпретатор, зависит от его округления: увеличьте I или D на тысячную"
                ),
            ),
            Self::Apart => (
                both!(
                    "the contour has a place that the passes do not reach",
                    "в контуре есть место, куда проходы не приводят"
                ),
                both!(
                    "the interpreter stops here with an error",
                    "интерпретатор здесь останавливается с ошибкой"
                ),
            ),
        };
        words.fault(refusal::routine(message, label), span)
    }
}
