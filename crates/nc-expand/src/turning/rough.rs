//! Contours: G70 to G73 (systems A and B), G72 to G75 (C).
//!
//! B-64304EN-1, "Multiple repetitive cycle". G71, with A where the tool stands, A' the end of the block of P and B that
//! of Q: the tool goes to C, which lies off A by the finishing allowances, and from there down in depths of cut; each
//! pass runs along Z to the contour that lies off the programmed one by the allowances, leaves it by the escape at 45
//! degrees, and goes back in a rapid. Behind the last whole depth that contour is cut as a whole, and the tool goes
//! back to A. Infeeds are rapids or feeds as the block of P is. G72 is the same with the axes changed. Type I: the
//! block of P names the axis of the infeed only, and the contour turns back along neither axis. G73 cuts the contour so
//! many times, the first one off by the relief, the last one by the allowances.
//!
//! Roughing heeds F and S of its own block, not those of the contour. G70 makes the contour's blocks as they stand,
//! with F and S of their own, and goes back in a rapid to where it began.

use diagnostic::both;
use nc_dialect::TurningCycle;
use nc_program::Compensation;
use nc_syntax::{ItemKind, Span};

use super::contour::{Axis, Contour, Way};
use super::emit::Moves;
use super::place::{Code, MILLION, Point, Spot};
use super::writer::{Writer, cycle_of};
use crate::came::{Fault, Held};
use crate::refusals::{contours, turning as refusal};
use crate::shorthand::{Words, shown};

/// Passes of one cycle; more are a wrong depth.
pub(super) const MOST_PASSES: i64 = 10_000;
/// Cuts of G73.
const MOST_CUTS: i64 = 999;

/// Depths nearer than this are one, mm or inches: a millionth is the step of written places.
pub(super) const SAME: f64 = 1e-6;

/// How the passes of G71 and G72 lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passes {
    /// The axis of the infeed.
    pub(super) down: Axis,
    /// Its sign.
    pub(super) sign: f64,
    /// The sign of the way along the other axis.
    pub(super) forwards: f64,
    /// Units of radius or Z.
    pub(super) depth: f64,
    pub(super) escape: f64,
    /// Off the contour, and where the passes start.
    pub(super) allowance: Spot,
    pub(super) corner: Spot,
}

impl Writer<'_, '_, '_> {
    /// G71, G72, G73: the block that sets, or the one that cuts; says which block is next.
    pub(super) fn rough(&mut self, at: usize, cycle: TurningCycle, span: Span) -> Result<usize, Fault> {
        let words = self.words(at);
        self.require_diameters(&words, span)?;
        if words.number(b'P').is_none() && words.number(b'Q').is_none() {
            self.set(&words, cycle, span)?;
            return Ok(at + 1);
        }
        let start = self.standing(&words, span)?;
        let contour = self.contour(at, start)?;
        let between = at + 1..contour.first;
        if contour.first < at || between.into_iter().any(|index| self.words(index).block.acts()) {
            return Err(words.fault(contours::CONTOUR_ELSEWHERE, span));
        }
        if let Some(block) = contour.compensated.filter(|_| !self.is_finished(&contour)) {
            let came = contour.blocks[block].came();
            let block = Words::of(&came, self.dialect);
            return Err(block.fault(contours::COMPENSATION_WITHOUT_FINISHING, block.whole()));
        }
        let last_feed = self.out.known.modal().feed;
        let own: &[u8] = if cycle == TurningCycle::RoughPattern { b"PQUWDIK" } else { b"PQUWD" };
        let mut moves = self.begin(&words, start, own)?;
        let allowance = self.allowance(&words);
        if cycle == TurningCycle::RoughPattern {
            self.pattern(&mut moves, &words, span, &contour, allowance)?;
        } else {
            self.passes(&mut moves, &words, cycle, span, &contour, allowance)?;
        }
        let feed = words.number(b'F').map(|(number, _)| number);
        self.end(moves);
        if let Some(feed) = feed {
            self.unsure_feed = last_feed.is_none_or(|known| known.to_f64() != feed.to_f64());
        }
        self.leave_open();
        for held in &contour.blocks {
            let came = held.came();
            self.out.comment(shown(&came.block), came.from);
        }
        Ok(contour.last + 1)
    }

    /// True where a block behind the contour finishes it.
    fn is_finished(&self, contour: &Contour) -> bool {
        (contour.last + 1..self.blocks.len()).any(|index| {
            let words = self.words(index);
            let is_finish = cycle_of(&words).is_some_and(|(cycle, _)| cycle == TurningCycle::Finish);
            is_finish && self.numbered(index, b'P').is_ok_and(|first| first == contour.first)
        })
    }

    /// The block without P and Q. Words that only the block that cuts has say that its contour was left out.
    fn set(&mut self, words: &Words<'_, '_>, cycle: TurningCycle, span: Span) -> Result<(), Fault> {
        let others: &[u8] = match cycle {
            TurningCycle::RoughPattern => b"IKD",
            _ if axis_of(cycle) == 0 => b"WIKD",
            _ => b"UIKD",
        };
        if let Some((letter, (_, at))) =
            others.iter().find_map(|letter| Some((*letter as char, words.number(*letter)?)))
        {
            return Err(words.fault(contours::cycle_without_p_and_q(letter), at));
        }
        let length = |letter: u8| self.length(words, letter);
        let mut set = self.first_blocks;
        match cycle {
            TurningCycle::RoughPattern => {
                if let (Some(x), Some(z)) = (length(b'U'), length(b'W')) {
                    set.relief = Some([x, z]);
                }
                if let Some((number, span)) = words.number(b'R') {
                    set.cuts = number.integer();
                    if set.cuts.is_none() {
                        return Err(words.fault(refusal::NUMBER_OF_CUTS, span));
                    }
                }
            }
            _ => {
                let axis = axis_of(cycle);
                let depth = if axis == 0 { b'U' } else { b'W' };
                set.depth[axis] = length(depth).or(set.depth[axis]);
                set.escape[axis] = length(b'R').or(set.escape[axis]);
            }
        }
        let said = b"URW".iter().any(|letter| words.number(*letter).is_some());
        if !said {
            return Err(words.fault(refusal::CYCLE_WITHOUT_CONTOUR, span));
        }
        let moves = self.begin(words, [0; 2], b"UWR")?;
        self.end(moves);
        self.first_blocks = set;
        Ok(())
    }

    /// U and W as X and Z words count.
    fn allowance(&self, words: &Words<'_, '_>) -> Spot {
        [b'U', b'W'].map(|letter| self.length(words, letter).unwrap_or_default())
    }

    /// G73.
    fn pattern(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        span: Span,
        contour: &Contour,
        allowance: Spot,
    ) -> Result<(), Fault> {
        let one_block = words.number(b'D').is_some();
        let (relief, cuts) = if one_block {
            let length = |letter: u8| self.length(words, letter).unwrap_or_default();
            let cuts = words.number(b'D').and_then(|(number, _)| number.integer());
            (Some([length(b'I'), length(b'K')]), cuts)
        } else {
            (self.first_blocks.relief, self.first_blocks.cuts)
        };
        let (Some(relief), Some(cuts)) = (relief, cuts.filter(|cuts| (2..=MOST_CUTS).contains(cuts))) else {
            return Err(words.fault(refusal::RELIEF_OR_CUTS_NOT_SAID, span));
        };
        // The relief along X is a radius, X words may be diameters.
        let twice = self.twice();
        let relief = [twice * relief[0], relief[1]];
        for cut in 0..cuts {
            let share = |whole: i64| {
                units::decimal::round(whole as f64 * (cuts - 1 - cut) as f64 / (cuts - 1) as f64)
            };
            let off = [allowance[0] + share(relief[0]), allowance[1] + share(relief[1])];
            self.go(moves, Code::Rapid, sum(contour.start, off));
            self.along(moves, contour, off);
        }
        self.go(moves, Code::Rapid, contour.start);
        Ok(())
    }

    /// G71, G72.
    fn passes(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        cycle: TurningCycle,
        span: Span,
        contour: &Contour,
        allowance: Spot,
    ) -> Result<(), Fault> {
        let down: Axis = axis_of(cycle);
        let along: Axis = 1 - down;
        let (depth, escape) = self.depths(words, span, down)?;
        let [a, a1, b] = [self.plane(contour.start), contour.entry.way.to, contour.end()];
        let sign = (a1[down] - a[down]).signum();
        let forwards = (b[along] - a1[along]).signum();
        let aside = a1[along] != a[along];
        if a1[down] == a[down] || b[along] == a1[along] || (aside && !contour.names_both) {
            let came = contour.blocks[0].came();
            let block = Words::of(&came, self.dialect);
            let name = ["X", "Z"][down];
            return Err(block.fault(contours::begins_without_infeed(name), block.whole()));
        }
        self.require_monotone(words, contour, along, forwards)?;
        let back = self.require_monotone(words, contour, down, -sign);
        // Named for both axes and yet without pockets, which the ways show, it is cut as one of type I.
        if contour.names_both && (aside || back.is_err()) {
            // Where the contour begins behind the start, its passes do too.
            let behind = (a1[along] - a[along]) * forwards < 0.0;
            let mut corner = sum(contour.start, allowance);
            corner[along] = if behind { contour.entry.to[along] + allowance[along] } else { corner[along] };
            let passes = Passes { down, sign, forwards, depth, escape, allowance, corner };
            self.go(moves, Code::Rapid, sum(contour.start, allowance));
            self.go(moves, Code::Rapid, corner);
            self.pockets(moves, words, contour, &passes)?;
            self.along(moves, contour, allowance);
            // It may end in a pocket: straight out of that first.
            let mut out = moves.at();
            out[down] = contour.start[down];
            self.go(moves, Code::Rapid, out);
            self.go(moves, Code::Rapid, contour.start);
            return Ok(());
        }
        back?;
        let off = self.plane(allowance);
        let ways: Vec<Way> = contour.pieces.iter().map(|piece| piece.way.shifted(off)).collect();
        let deepest = a1[down] + off[down];
        let corner = sum(contour.start, allowance);
        let from_corner = self.plane(corner);
        let count = ((deepest - from_corner[down]) * sign / depth - 1e-9).ceil() as i64 - 1;
        if count > MOST_PASSES {
            return Err(too_many(words, span));
        }
        self.go(moves, Code::Rapid, corner);
        for pass in 1..=count {
            let level = from_corner[down] + sign * depth * pass as f64;
            let stop = ends_at(&ways, down, level, sign).map_or(b[along] + off[along], |at| at[along]);
            if (stop - from_corner[along]) * forwards <= 0.0 {
                continue;
            }
            let back = escape.min((stop - from_corner[along]).abs());
            let place = |at: f64, level: f64| if down == 0 { [level, at] } else { [at, level] };
            let ends = [
                (contour.entry.code, place(from_corner[along], level)),
                (Code::Line, place(stop, level)),
                (Code::Rapid, place(stop - forwards * back, level - sign * escape)),
                (Code::Rapid, place(from_corner[along], level - sign * escape)),
            ];
            for (code, end) in ends {
                let spot = self.spot(end);
                self.go(moves, code, spot);
            }
        }
        self.along(moves, contour, allowance);
        self.go(moves, Code::Rapid, contour.start);
        Ok(())
    }

    /// Depth of cut and escape in units of radius or Z.
    fn depths(&self, words: &Words<'_, '_>, span: Span, down: Axis) -> Result<(f64, f64), Fault> {
        let depth = words.depth(&self.here, b'D').or(self.first_blocks.depth[down]);
        let Some(depth) = depth.filter(|depth| *depth != 0) else {
            let letter = ["U", "W"][down];
            return Err(words.fault(refusal::depth_of_cut_not_said(letter), span));
        };
        // The series 10 and 11, with D, leave the escape to the parameter.
        let said = self.first_blocks.escape[down].filter(|_| words.number(b'D').is_none());
        let parameter = self.turning.cycles.roughing_escape_mm.map(|mm| self.millionths_of(mm));
        let Some(escape) = said.or(parameter) else {
            return Err(words.parameter_fault(
                span,
                &both!(
                    "by how much roughing leaves the contour",
                    "на сколько отводится резец при черновой обработке"
                ),
                "roughing_escape_mm",
                "0.5",
            ));
        };
        Ok((depth.abs() as f64 / MILLION, escape.abs() as f64 / MILLION))
    }

    /// The contour as a whole, off by `by`.
    fn along(&mut self, moves: &mut Moves, contour: &Contour, by: Spot) {
        let whom = moves.from;
        for piece in std::iter::once(&contour.entry).chain(&contour.pieces).chain(&contour.retract) {
            moves.from = contour.blocks[piece.block].came().from;
            self.go_with(moves, piece.code, sum(piece.to, by), &piece.round);
        }
        moves.from = whom;
    }

    /// G70.
    pub(super) fn finish(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let start = self.standing(&words, span)?;
        let contour = self.contour(at, start)?;
        let next = (at + 1..self.blocks.len()).find(|index| self.words(*index).block.acts());
        if (contour.first..=contour.last).contains(&at) || next == Some(contour.first) {
            return Err(words.fault(contours::BEHIND_ITS_FINISHING, span));
        }
        let stale = |held: &&Held| !held.from.exact && held.from.assigned != words.from.assigned;
        if let Some(held) = contour.blocks.iter().find(stale) {
            let came = held.came();
            let block = Words::of(&came, self.dialect);
            return Err(block.fault(contours::VALUES_ASSIGNED_ANEW, block.whole()));
        }
        if !contour.says_feed && words.number(b'F').is_none() && self.unsure_feed {
            return Err(words.fault(refusal::FINISHING_WITHOUT_F, span));
        }
        let mut moves = self.begin(&words, start, b"PQUW")?;
        // The cycle's block is done when the tool is back.
        let behind = moves.take_behind();
        self.unsure_feed &= words.number(b'F').is_none();
        self.end(moves);
        for held in &contour.blocks {
            let came = held.came();
            let block = Words::of(&came, self.dialect);
            self.unsure_feed &= block.number(b'F').is_none();
            self.copy_without_number(&block);
        }
        let last = self.words(contour.last);
        if self.out.known.modal().compensation != Compensation::Off {
            return Err(last.fault(contours::COMPENSATION_STAYS, last.whole()));
        }
        let end = self.standing(&last, span)?;
        let mut back = Moves::new(words.from, end, self.out.known.modal()).with_behind(behind);
        self.go(&mut back, Code::Rapid, start);
        self.end(back);
        self.leave_open();
        Ok(())
    }

    /// A block of the contour, which its N named elsewhere.
    fn copy_without_number(&mut self, words: &Words<'_, '_>) {
        let block = words.block;
        let number = block.items.iter().find(|item| matches!(item.kind, ItemKind::Word { letter: b'N', .. }));
        let rest = match number {
            None => block.bytes.to_vec(),
            Some(item) => [
                &block.bytes[..item.span.start as usize],
                block.bytes[item.span.end as usize..].trim_ascii_start(),
            ]
            .concat(),
        };
        self.out.fresh_line();
        self.out.write(&rest, words.from);
    }
}

/// Where a pass on a level ends: the first way that comes up to it ends it, also where it only touches it.
fn ends_at(ways: &[Way], down: Axis, level: f64, sign: f64) -> Option<Point> {
    let apart = |point: Point| (point[down] - level) * sign;
    let way = ways.iter().find(|way| apart(way.to) <= SAME)?;
    let nearer = if apart(way.from).abs() < apart(way.to).abs() { way.from } else { way.to };
    Some(way.crossing(down, level).unwrap_or(nearer))
}

pub(super) fn too_many(words: &Words<'_, '_>, span: Span) -> Fault {
    words.fault(refusal::TOO_MANY_PASSES, span)
}

/// The axis of the infeed: X of G71, Z of G72.
fn axis_of(cycle: TurningCycle) -> Axis {
    if cycle == TurningCycle::RoughFace { 1 } else { 0 }
}

fn sum(spot: Spot, by: Spot) -> Spot {
    [spot[0] + by[0], spot[1] + by[1]]
}
