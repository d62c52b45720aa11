//! Contours with pockets: type II of G71 and G72.
//!
//! B-64304EN-1, "Stock removal in turning", type II: the block of P names both axes, the contour goes on along Z (X of
//! G72) all the way and may turn back along the other axis. In which order a control cuts pockets, and how it comes out
//! of each pass, differs; what all of them leave is the contour off by the allowance. So passes are laid here by rules
//! of our own, of which none cuts into that contour, goes deeper than one depth of cut below what is cut already, or
//! crosses in a rapid what still stands:
//!
//! * Levels lie whole depths below the start. What lies deeper than a level are stretches of the contour, and those of
//!   a deeper level lie within them: a tree, which is cut pocket by pocket, each level before the ones below it.
//! * The first stretch of a level is reached along the contour from the pass above, down the flank which the finishing
//!   tool goes down too; a further one along the contour from the ridge before it, over which the tool goes in the slot
//!   of the pass above.
//! * A pass ends where the contour comes up to it, and is left by the escape at 45 degrees.
//! * Behind all of them the contour is cut as a whole, as in type I.
//!
//! W shifts one wall of a pocket into the other, so with pockets it has to be zero; U must lead away from the
//! workpiece.

use super::contour::{Axis, Contour, Way};
use super::emit::Moves;
use super::place::{Code, Point};
use super::rough::{MOST_PASSES, Passes, SAME};
use super::writer::Writer;
use crate::came::Fault;
use crate::output::{Style, word};
use crate::refusals::contours as refusal;
use crate::shorthand::Words;

/// A piece of the contour that turns back along neither axis.
#[derive(Clone, Copy, Debug)]
struct Part {
    way: Way,
    code: Code,
}

/// A place on the contour: in which part, and where.
#[derive(Clone, Copy, Debug)]
struct Place {
    part: usize,
    point: Point,
}

/// What lies deeper than a level, from where the contour goes below it to where it comes up again.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: Place,
    to: Place,
}

/// A contour off by its allowance, from the corner where its passes start.
struct Chain<'p> {
    parts: Vec<Part>,
    corner: Point,
    passes: &'p Passes,
}

/// Passes on their way out.
struct Cut<'w, 'b, 'a, 'd, 'p> {
    writer: &'w mut Writer<'b, 'a, 'd>,
    moves: &'w mut Moves,
    chain: &'p Chain<'p>,
}

impl Chain<'_> {
    fn down(&self) -> Axis {
        self.passes.down
    }

    fn along(&self) -> Axis {
        1 - self.passes.down
    }

    /// How deep a point lies below the start.
    fn depth(&self, point: Point) -> f64 {
        (point[self.down()] - self.corner[self.down()]) * self.passes.sign
    }

    /// The point of a depth at a place along the contour.
    fn point(&self, along: f64, depth: f64) -> Point {
        let mut point = self.corner;
        point[self.along()] = along;
        point[self.down()] += depth * self.passes.sign;
        point
    }

    fn level(&self, k: i64) -> f64 {
        self.passes.depth * k as f64
    }

    fn end(&self) -> Place {
        let part = self.parts.len() - 1;
        Place { part, point: self.parts[part].way.to }
    }

    /// The stretches of a level between two places, in order.
    fn stretches(&self, between: Stretch, level: f64) -> Vec<Stretch> {
        let Stretch { from, to } = between;
        let is_deeper = |point: Point| self.depth(point) > level + SAME;
        let mut found = Vec::new();
        let mut open = is_deeper(from.point).then_some(from);
        for part in from.part..=to.part {
            let end = if part == to.part { to.point } else { self.parts[part].way.to };
            if is_deeper(end) == open.is_some() {
                continue;
            }
            let value = self.point(0.0, level)[self.down()];
            let way = self.parts[part].way;
            let crossing = way.crossing(self.down(), value);
            // An end that lies on the level but for the last digit is where it crosses.
            let apart = |point: &Point| (self.depth(*point) - level).abs();
            let nearer = if apart(&way.from) < apart(&end) { way.from } else { end };
            let here = Place { part, point: crossing.unwrap_or(nearer) };
            open = match open {
                None => Some(here),
                Some(from) => {
                    found.push(Stretch { from, to: here });
                    None
                }
            };
        }
        found.extend(open.map(|from| Stretch { from, to }));
        found
    }

    /// The highest place of the contour between two others: ends of parts, since none turns back within itself.
    fn ridge(&self, from: Place, to: Place) -> Place {
        let ends = (from.part..to.part).map(|part| Place { part, point: self.parts[part].way.to });
        ends.min_by(|a, b| self.depth(a.point).total_cmp(&self.depth(b.point))).unwrap_or(to)
    }

    /// How far a pass may come back before it leaves its own slot.
    fn off(&self, stretch: Stretch) -> f64 {
        let length = (stretch.to.point[self.along()] - stretch.from.point[self.along()]).abs();
        self.passes.escape.min(0.5 * length)
    }
}

impl Way {
    /// The way in pieces that turn back along neither axis.
    fn steady(&self) -> Vec<Self> {
        let points = self.extremes();
        points.windows(2).map(|ends| self.between(ends[0], ends[1])).collect()
    }
}

impl Cut<'_, '_, '_, '_, '_> {
    fn go(&mut self, code: Code, to: Point) {
        let spot = self.writer.spot(to);
        self.writer.go(self.moves, code, spot);
    }

    /// Along one part to a point of it.
    fn to(&mut self, part: Part, to: Point) {
        let (spot, at) = (self.writer.spot(to), self.moves.at());
        let Some(arc) = part.way.arc.filter(|_| spot != at) else {
            return self.writer.go(self.moves, part.code, spot);
        };
        let (here, centre) = (self.writer.plane(at), arc.centre());
        let mut round = Vec::new();
        let _ = word(&mut round, b'I', centre[0] - here[0], Style::Decimals(6));
        round.push(b' ');
        let _ = word(&mut round, b'K', centre[1] - here[1], Style::Decimals(6));
        self.writer.go_with(self.moves, part.code, spot, &round);
    }

    /// Along the contour from one of its places, where the tool stands, to another.
    fn follow(&mut self, from: Place, to: Place) {
        for part in from.part..to.part {
            let whole = self.chain.parts[part];
            self.to(whole, whole.way.to);
        }
        self.to(self.chain.parts[to.part], to.point);
    }

    /// Straight up to a depth, and there to a place along the contour.
    fn over(&mut self, along: f64, depth: f64) {
        let here = self.writer.plane(self.moves.at())[self.chain.along()];
        self.go(Code::Rapid, self.chain.point(here, depth));
        self.go(Code::Rapid, self.chain.point(along, depth));
    }

    /// The pass of level `k` along a stretch at whose beginning the tool stands, and all below it.
    fn stretch(&mut self, k: i64, stretch: Stretch) {
        let chain = self.chain;
        let (level, off) = (chain.level(k), chain.off(stretch));
        let along = chain.along();
        let forwards = chain.passes.forwards;
        let (first, last) = (stretch.from.point[along], stretch.to.point[along]);
        self.go(Code::Line, chain.point(last, level));
        self.go(Code::Rapid, chain.point(last - forwards * off, level - off));
        let below = chain.stretches(stretch, chain.level(k + 1));
        let Some(next) = below.first() else { return };
        // Beside the way to the contour nothing stands, beside a flank the workpiece.
        let beside = if stretch.from.part == 0 { first } else { first + forwards * off };
        self.go(Code::Rapid, chain.point(beside, level - off));
        let code = chain.parts[stretch.from.part].code;
        let straight = stretch.from.part == 0 && next.from.part == 0 && next.from.point[along] == first;
        if !straight {
            self.go(if code == Code::Rapid { Code::Rapid } else { Code::Line }, stretch.from.point);
        }
        self.follow(stretch.from, next.from);
        self.stretch(k + 1, *next);
        for pair in below.windows(2) {
            let ridge = chain.ridge(pair[0].to, pair[1].from);
            self.over(ridge.point[along], level - off);
            self.go(Code::Line, ridge.point);
            self.follow_from_ridge(ridge, pair[1].from);
            self.stretch(k + 1, pair[1]);
        }
    }

    /// From the end of a part.
    fn follow_from_ridge(&mut self, ridge: Place, to: Place) {
        self.follow(Place { part: ridge.part + 1, ..ridge }, to);
    }
}

impl Writer<'_, '_, '_> {
    /// G71 and G72 along a contour with pockets, from the corner off the start; ends there.
    pub(super) fn pockets(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        contour: &Contour,
        passes: &Passes,
    ) -> Result<(), Fault> {
        let along = 1 - passes.down;
        let off = self.plane(passes.allowance);
        self.require_allowance(words, contour, passes, off)?;
        let corner = self.plane(passes.corner);
        let entry = Way { from: corner, to: contour.entry.way.shifted(off).to, arc: None };
        let mut parts = vec![Part { way: entry, code: contour.entry.code }];
        for piece in &contour.pieces {
            let way = piece.way.shifted(off);
            parts.extend(way.steady().into_iter().map(|way| Part { way, code: piece.code }));
        }
        let chain = Chain { parts, corner, passes };
        let whole = Stretch { from: Place { part: 0, point: corner }, to: chain.end() };
        let stretches = chain.stretches(whole, chain.level(1));
        for pair in stretches.windows(2) {
            let ridge = chain.ridge(pair[0].to, pair[1].from);
            if chain.depth(ridge.point) < -SAME {
                let piece = contour.pieces.iter().find(|piece| {
                    (piece.way.to[along] - off[along] - ridge.point[along]) * passes.forwards >= -SAME
                });
                let block = self.words(piece.map_or(contour.first, |piece| piece.block));
                return Err(
                    block.fault(refusal::rises_beyond_start(-chain.depth(ridge.point)), block.whole())
                );
            }
        }
        let deepest = chain.parts.iter().map(|part| chain.depth(part.way.to)).fold(0.0, f64::max);
        let valleys = 1 + chain.parts.len() as i64;
        if (deepest / passes.depth) as i64 > MOST_PASSES / valleys {
            return Err(super::rough::too_many(words, words.whole()));
        }
        let mut cut = Cut { writer: self, moves, chain: &chain };
        let mut before: Option<Stretch> = None;
        for stretch in stretches {
            match before {
                None => cut.follow(whole.from, stretch.from),
                Some(before) => {
                    let ridge = chain.ridge(before.to, stretch.from);
                    cut.over(ridge.point[along], 0.0);
                    cut.go(Code::Line, ridge.point);
                    cut.follow_from_ridge(ridge, stretch.from);
                }
            }
            cut.stretch(1, stretch);
            before = Some(stretch);
        }
        cut.over(corner[along], 0.0);
        Ok(())
    }

    /// Refuses an allowance that leads into the workpiece.
    fn require_allowance(
        &self,
        words: &Words<'_, '_>,
        contour: &Contour,
        passes: &Passes,
        off: Point,
    ) -> Result<(), Fault> {
        let along = 1 - passes.down;
        let names = [b'U', b'W'];
        let turns_back = self.require_monotone(words, contour, passes.down, -passes.sign).is_err();
        if off[along] != 0.0 && turns_back {
            let span = words.number(names[along]).map_or_else(|| words.whole(), |(_, span)| span);
            let name = names[along] as char;
            return Err(words.fault(refusal::allowance_with_pockets(name), span));
        }
        if off[passes.down] * passes.sign > 0.0 {
            let name = names[passes.down] as char;
            let span = words.number(names[passes.down]).map_or_else(|| words.whole(), |(_, span)| span);
            return Err(words.fault(refusal::allowance_into_workpiece(name), span));
        }
        Ok(())
    }
}
