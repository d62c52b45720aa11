//! The blocks between P and Q as a way in the plane of radius and Z.

use std::ops::RangeInclusive;

use diagnostic::{Text, both};
use nc_dialect::{Action, TurningCycle};
use nc_syntax::{ItemKind, Span, Value};
use units::math;

use super::drawing::{self, Drawing};
use super::place::{Code, Point, Spot, may_stand_beside};
use super::writer::{Writer, cycle_of};
use crate::came::{Came, Fault, Held};
use crate::refusals::contours as refusal;
use crate::shorthand::Words;

/// Ends and centres of programs are rounded: so far may a contour turn back, mm or inches.
const TURNS_BACK: f64 = 1e-3;
/// Angles nearer to an end of an arc than this are that end, rad.
const AT_AN_END_RAD: f64 = 1e-9;

/// Index in the plane: radius (X), or Z.
pub(super) type Axis = usize;

/// One block of a contour.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) code: Code,
    pub(super) to: Spot,
    /// Words of the centre or radius, as they were written.
    pub(super) round: Vec<u8>,
    pub(super) way: Way,
    /// Index of its block among those of the contour.
    pub(super) block: usize,
}

/// A piece's geometry, radius and Z in units of the program.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub(super) from: Point,
    pub(super) to: Point,
    pub(super) arc: Option<Arc>,
}

/// Centre and signed angle from start to end, positive from Z towards X (G3).
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    centre: Point,
    sweep_rad: f64,
}

/// What lies between P and Q.
#[derive(Debug)]
pub(super) struct Contour {
    /// Block of P.
    pub(super) first: usize,
    /// Block of Q.
    pub(super) last: usize,
    /// Its blocks, their drawings written out.
    pub(super) blocks: Vec<Held>,
    /// A: where the tool stands.
    pub(super) start: Spot,
    /// The way from A to A'.
    pub(super) entry: Piece,
    /// From A' to B.
    pub(super) pieces: Vec<Piece>,
    /// Rapids behind B, which lead off the workpiece.
    pub(super) retract: Vec<Piece>,
    /// The first block names both axes.
    pub(super) names_both: bool,
    /// F stands in one of its blocks.
    pub(super) says_feed: bool,
    /// The first G41 or G42 in its blocks: which of them.
    pub(super) compensated: Option<usize>,
}

impl Contour {
    /// B: where it ends.
    pub(super) fn end(&self) -> Point {
        self.pieces.last().map_or(self.entry.way.to, |piece| piece.way.to)
    }
}

impl Arc {
    pub(super) const fn centre(&self) -> Point {
        self.centre
    }
}

impl Way {
    fn angle(&self, centre: Point, point: Point) -> f64 {
        math::atan2(point[0] - centre[0], point[1] - centre[1])
    }

    /// The point of an arc at `share` of its sweep; of a line, of its length.
    fn at(&self, share: f64) -> Point {
        match self.arc {
            None => [0, 1].map(|k| self.from[k] + share * (self.to[k] - self.from[k])),
            Some(Arc { centre, sweep_rad }) => {
                let [from, to] =
                    [self.from, self.to].map(|p| math::hypot(p[0] - centre[0], p[1] - centre[1]));
                let radius = from + share * (to - from);
                let (sin, cos) = math::sin_cos(self.angle(centre, self.from) + share * sweep_rad);
                [centre[0] + radius * sin, centre[1] + radius * cos]
            }
        }
    }

    /// Ends, and the places between them where an axis turns.
    pub(super) fn extremes(&self) -> Vec<Point> {
        let mut points = vec![self.from];
        if let Some(Arc { centre, sweep_rad }) = self.arc {
            let start = self.angle(centre, self.from);
            let quarter = std::f64::consts::FRAC_PI_2;
            let mut shares: Vec<f64> = (-8..=8)
                .map(|k| (f64::from(k) * quarter - start) / sweep_rad)
                .filter(|share| *share > AT_AN_END_RAD && *share < 1.0 - AT_AN_END_RAD)
                .collect();
            shares.sort_by(f64::total_cmp);
            points.extend(shares.into_iter().map(|share| self.at(share)));
        }
        points.push(self.to);
        points
    }

    /// The first place where `axis` has `value`, where the way gets there.
    pub(super) fn crossing(&self, axis: Axis, value: f64) -> Option<Point> {
        let (from, to) = (self.from[axis] - value, self.to[axis] - value);
        let shares: Vec<f64> = match self.arc {
            None if from == to => {
                if from != 0.0 {
                    return None;
                }
                vec![0.0]
            }
            None => vec![from / (from - to)],
            Some(Arc { centre, sweep_rad }) => {
                let radius = math::hypot(self.from[0] - centre[0], self.from[1] - centre[1]);
                let ratio = (value - centre[axis]) / radius;
                if ratio.abs() > 1.0 {
                    return None;
                }
                let turn = std::f64::consts::TAU;
                let start = self.angle(centre, self.from);
                // The radius is the sine of the angle, Z its cosine.
                let angles = if axis == 0 {
                    [math::asin(ratio), std::f64::consts::PI - math::asin(ratio)]
                } else {
                    [math::acos(ratio), -math::acos(ratio)]
                };
                let around = [-2.0, -1.0, 0.0, 1.0, 2.0];
                let mut shares: Vec<f64> = angles
                    .into_iter()
                    .flat_map(|angle| around.map(|k| (angle + k * turn - start) / sweep_rad))
                    .collect();
                shares.sort_by(f64::total_cmp);
                shares
            }
        };
        let share =
            shares.into_iter().find(|share| (-AT_AN_END_RAD..=1.0 + AT_AN_END_RAD).contains(share))?;
        let mut point = self.at(share.clamp(0.0, 1.0));
        point[axis] = value;
        Some(point)
    }

    /// The part of the way between two of its points.
    pub(super) fn between(&self, from: Point, to: Point) -> Self {
        let arc = self.arc.map(|arc| {
            let turn = std::f64::consts::TAU;
            let by = self.angle(arc.centre, to) - self.angle(arc.centre, from);
            let sweep_rad = if arc.sweep_rad > 0.0 { by.rem_euclid(turn) } else { -((-by).rem_euclid(turn)) };
            Arc { sweep_rad, ..arc }
        });
        Self { from, to, arc }
    }

    pub(super) fn shifted(&self, by: Point) -> Self {
        let shift = |p: Point| [p[0] + by[0], p[1] + by[1]];
        let arc = self.arc.map(|arc| Arc { centre: shift(arc.centre), ..arc });
        Self { from: shift(self.from), to: shift(self.to), arc }
    }
}

impl Writer<'_, '_, '_> {
    /// Reads the contour between the blocks that P and Q of the cycle in a block name, from where the tool stands.
    pub(super) fn contour(&mut self, cycle: usize, start: Spot) -> Result<Contour, Fault> {
        let words = &self.words(cycle);
        let first = self.numbered(cycle, b'P')?;
        let last = self.numbered(cycle, b'Q')?;
        if last < first {
            let span = words.number(b'Q').map_or_else(|| words.whole(), |(_, span)| span);
            return Err(words.fault(refusal::Q_BEFORE_P, span));
        }
        let blocks = self.drawn(words, first..=last)?;
        let mut ahead = self.out.known.clone();
        ahead.written(&words.codes(may_stand_beside), words.from);
        // A code of the blocks before does not reach into the contour.
        let mut motion = None;
        let (mut at, mut pieces) = (start, Vec::new());
        let (mut names_both, mut says_feed, mut compensated) = (false, false, None);
        let mut retract: Vec<Piece> = Vec::new();
        for (index, held) in blocks.iter().enumerate() {
            let came = held.came();
            let block = Words::of(&came, self.dialect);
            self.check_contour_block(&block)?;
            says_feed |= block.number(b'F').is_some();
            let distance = |action: &Action| matches!(action, Action::Absolute | Action::Incremental);
            ahead.written(&block.codes(distance), block.from);
            motion = block.motion().or(motion);
            let compensates = block.actions().any(|(action, _)| matches!(action, Action::Compensation(_)));
            compensated = compensated.or(compensates.then_some(index));
            if !block.names_a_place() {
                if index == 0 {
                    return Err(block.fault(refusal::BEGINS_WITHOUT_MOVE, block.whole()));
                }
                continue;
            }
            let code = match motion {
                Some(Code::Rapid) => Code::Rapid,
                _ if !retract.is_empty() => {
                    let rapid = blocks[retract[0].block].came();
                    let rapid = Words::of(&rapid, self.dialect);
                    return Err(rapid.fault(refusal::RAPID_WITHIN_CONTOUR, rapid.whole()));
                }
                Some(Code::Line) => Code::Line,
                Some(arc @ (Code::Clockwise | Code::CounterClockwise)) if !pieces.is_empty() => arc,
                _ => return Err(block.fault(refusal::BEGINS_WITHOUT_G0_OR_G1, block.whole())),
            };
            let of_an_arc = matches!(code, Code::Clockwise | Code::CounterClockwise);
            if let Some((_, span)) =
                b"IKR".iter().find_map(|letter| block.number(*letter).filter(|_| !of_an_arc))
            {
                return Err(corner_fault(&block, span));
            }
            let [Some(x), Some(z)] = block.target(ahead.modal(), at.map(Some)) else {
                return Err(block.fault(refusal::LEADS_TO_UNKNOWN_PLACE, block.whole()));
            };
            if index == 0 {
                let named = |letters: [u8; 2]| letters.iter().any(|letter| block.number(*letter).is_some());
                names_both = named(*b"XU") && named(*b"ZW");
            }
            let to = [x, z];
            let (from_plane, to_plane) = (self.plane(at), self.plane(to));
            let (arc, round) = match code {
                Code::Clockwise | Code::CounterClockwise => {
                    let arc = self.arc(&block, from_plane, to_plane, code)?;
                    (Some(arc), block.texts(b"IKR"))
                }
                _ => (None, Vec::new()),
            };
            let list = if code == Code::Rapid && !pieces.is_empty() { &mut retract } else { &mut pieces };
            let way = Way { from: from_plane, to: to_plane, arc };
            list.push(Piece { code, to, round, way, block: index });
            at = to;
        }
        let entry = pieces.remove(0);
        if pieces.is_empty() {
            let span = words.number(b'Q').map_or_else(|| words.whole(), |(_, span)| span);
            return Err(words.fault(refusal::ENDS_WHERE_IT_BEGINS, span));
        }
        Ok(Contour { first, last, blocks, start, entry, pieces, retract, names_both, says_feed, compensated })
    }

    /// The blocks of a contour with their drawings written out, from where the tool stands.
    fn drawn(&self, words: &Words<'_, '_>, range: RangeInclusive<usize>) -> Result<Vec<Held>, Fault> {
        let blocks = &self.blocks[range];
        let may_draw = |came: &Came<'_>| drawing::may_draw(&came.block, self.turning);
        if !self.dialect.flow.corner_words || !blocks.iter().any(may_draw) {
            return Ok(blocks.iter().map(Held::of).collect());
        }
        let mut out = self.out.ahead();
        out.known.written(&words.codes(may_stand_beside), words.from);
        let fault = Drawing::new(blocks, &mut out, true).contour().err();
        let out = out.end(fault)?;
        let mut drawn = Vec::new();
        out.each_block(self.dialect, |came| {
            // Its first line, as it was drawn, is no part of it.
            if !drawn.is_empty() || !Words::of(came, self.dialect).idle() {
                drawn.push(Held::of(came));
            }
        });
        Ok(drawn)
    }

    /// The block whose N is the number of P or Q of the cycle in a block: the only one of the source.
    pub(super) fn numbered(&self, cycle: usize, letter: u8) -> Result<usize, Fault> {
        let (words, name) = (&self.words(cycle), letter as char);
        let Some((number, span)) = words.number(letter) else {
            return Err(words.fault(refusal::cycle_without(name), words.whole()));
        };
        let found = number.integer().and_then(|number| self.numbers.get(&number));
        let (found, one_place) = found.map_or((&[][..], true), |(found, one_place)| (&found[..], *one_place));
        let finishes = cycle_of(words).is_some_and(|(cycle, _)| cycle == TurningCycle::Finish);
        // Of a block that is reached more than once roughing means the next time, finishing the last one.
        let nearest = if finishes {
            found[..found.partition_point(|index| *index < cycle)].last().or(found.first())
        } else {
            found.get(found.partition_point(|index| *index <= cycle)).or(found.last())
        };
        match (nearest.filter(|_| one_place), found.first()) {
            (Some(nearest), _) => Ok(*nearest),
            (None, None) => Err(words.fault(refusal::no_such_block(number.to_f64(), name), span)),
            (None, Some(_)) => Err(words.fault(refusal::two_such_blocks(number.to_f64(), name), span)),
        }
    }

    /// Refuses what no control takes, or takes differently, between P and Q.
    fn check_contour_block(&self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let in_finishing = self.turning.cycles.nose_in_finishing;
        let refuse = |span: Span, label: Text| {
            let text = String::from_utf8_lossy(words.block.text(span)).into_owned();
            Err(words.fault(
                refusal::contour(both!("{text} within a contour", "{text} внутри контура"), label),
                span,
            ))
        };
        for item in &words.block.items {
            match item.kind {
                ItemKind::Comment | ItemKind::Name => {}
                ItemKind::Word { letter: b'G', value: Value::Number(_) } => {
                    let action =
                        words.actions().find(|(_, span)| *span == item.span).map(|(action, _)| action);
                    let fits = matches!(
                        action,
                        Some(
                            Action::Rapid
                                | Action::Line
                                | Action::ArcClockwise
                                | Action::ArcCounterClockwise
                                | Action::FeedPerMinute
                                | Action::FeedPerRevolution
                                | Action::Absolute
                                | Action::Incremental
                                | Action::CompensationOff
                                | Action::Pass { takes_words: false }
                        )
                    );
                    if matches!(action, Some(Action::Compensation(_))) {
                        if in_finishing {
                            continue;
                        }
                        return Err(words.fault(
                            refusal::within_contour(&String::from_utf8_lossy(words.block.text(item.span))),
                            item.span,
                        ));
                    }
                    if !fits {
                        return refuse(
                            item.span,
                            both!("lines and arcs were expected", "ожидались прямые и дуги"),
                        );
                    }
                }
                ItemKind::Word {
                    letter: b'X' | b'Z' | b'U' | b'W' | b'I' | b'K' | b'R',
                    value: Value::Number(_),
                }
                | ItemKind::Word { letter: b'N' | b'F' | b'S' | b'E', value: Value::Number(_) } => {}
                ItemKind::Word { letter: b'A' | b'C', value: Value::Number(_) }
                    if words.dialect.flow.corner_words =>
                {
                    return Err(corner_fault(words, item.span));
                }
                ItemKind::Skip => {
                    return refuse(
                        item.span,
                        both!(
                            "behind block delete there are two contours",
                            "в кадре с пропуском контуров два"
                        ),
                    );
                }
                _ => {
                    return refuse(
                        item.span,
                        both!(
                            "controls differ in whether roughing heeds it",
                            "учитывает ли её черновая обработка, у стоек по-разному"
                        ),
                    );
                }
            }
        }
        Ok(())
    }

    /// Centre and sweep of an arc by I and K, or by R.
    pub(super) fn arc(
        &self,
        words: &Words<'_, '_>,
        from: Point,
        to: Point,
        code: Code,
    ) -> Result<Arc, Fault> {
        let refuse = |label: Text| {
            Err(words.fault(
                refusal::contour(both!("an arc that cannot be", "невозможная дуга"), label),
                words.whole(),
            ))
        };
        let value = |letter: u8| words.length(letter, self.here.units);
        let centre = match (value(b'R'), value(b'I'), value(b'K')) {
            (Some(radius), None, None) => {
                let chord = [to[0] - from[0], to[1] - from[1]];
                let length = math::hypot(chord[0], chord[1]);
                let square = radius * radius - 0.25 * length * length;
                if length == 0.0 || square < -TURNS_BACK * radius.abs() {
                    return refuse(both!(
                        "its radius is smaller than half of its chord",
                        "её радиус меньше половины хорды"
                    ));
                }
                // Left of the way lies the centre of G3 with a positive radius.
                let left = if (code == Code::Clockwise) == (radius < 0.0) { 1.0 } else { -1.0 };
                let height = left * math_sqrt(square) / length;
                [0.5 * (from[0] + to[0]) + height * chord[1], 0.5 * (from[1] + to[1]) - height * chord[0]]
            }
            (None, i, k) if i.is_some() || k.is_some() => {
                [from[0] + i.unwrap_or_default(), from[1] + k.unwrap_or_default()]
            }
            (Some(_), ..) => return refuse(both!("R beside I or K", "R рядом с I или K")),
            _ => return refuse(both!("R, or I and K, were expected", "ожидалось R или I и K")),
        };
        let angle = |p: Point| math::atan2(p[0] - centre[0], p[1] - centre[1]);
        let whole = std::f64::consts::TAU;
        let sweep = (angle(to) - angle(from)).rem_euclid(whole);
        let sweep_rad = if code == Code::Clockwise {
            if sweep == 0.0 { -whole } else { sweep - whole }
        } else if sweep == 0.0 {
            whole
        } else {
            sweep
        };
        Ok(Arc { centre, sweep_rad })
    }

    /// Refuses a contour that turns back along an axis; `forwards`: the signs of its way.
    pub(super) fn require_monotone(
        &self,
        words: &Words<'_, '_>,
        contour: &Contour,
        axis: Axis,
        forwards: f64,
    ) -> Result<(), Fault> {
        let mut furthest = contour.entry.way.to[axis] * forwards;
        for piece in &contour.pieces {
            for point in piece.way.extremes() {
                let here = point[axis] * forwards;
                if here < furthest - TURNS_BACK {
                    let came = contour.blocks[piece.block].came();
                    let block = Words::of(&came, self.dialect);
                    let name = ["X", "Z"][axis];
                    let cycle = String::from_utf8_lossy(words.block.bytes.trim_ascii()).into_owned();
                    return Err(block.fault(refusal::turns_back(name, cycle, furthest - here), block.whole()));
                }
                furthest = furthest.max(here);
            }
        }
        Ok(())
    }
}

/// A corner of a drawing, or a slip: roughing that passed over it would cut into a rounded corner.
fn corner_fault(words: &Words<'_, '_>, span: Span) -> Fault {
    let text = String::from_utf8_lossy(words.block.text(span)).into_owned();
    words.fault(refusal::word_on_a_line(text), span)
}

fn math_sqrt(square: f64) -> f64 {
    square.max(0.0).sqrt()
}
