//! Holes on the axis: G83 and G85.
//!
//! B-64304EN-1, "Front drilling cycle", "Front boring cycle": along X to the hole, a rapid to R, a feed to Z, dwell P
//! at the bottom, a rapid back. With Q in pecks: parameter 5101.2 (RTR) says whether each goes back to R or by the
//! return 5114 (d); down again a rapid ends d above what is drilled. Q is a depth, without a point in least increments.
//! G85 comes back to R in a feed, by parameter 5121 (0 there doubles F), and from there in a rapid. In system A R
//! counts from where the cycle starts, and the tool goes back there; in B and C R is a place or a way by parameter
//! 5102.6 (RAB), and G99 leaves the tool at R. Controls that follow Fanuc take it for a place in system A too: the
//! profile may say so, and has to where a way of R would lead off the hole. The manual's W counts from R, a word of the
//! block from where the tool stands: with W alone nobody knows.

use diagnostic::{Refusal, both};
use nc_program::modal::ReturnLevel;
use nc_syntax::{Item, ItemKind, Number, Span, Value};
use toolpath::{DrillPecks, DrillR, MOST_PECKS, Retreat, Stroke, peck_depths, strokes, whole_pecks};

use super::emit::Moves;
use super::place::{Code, MILLION, Spot};
use super::writer::Writer;
use crate::came::Fault;
use crate::output::{Style, word};
use crate::refusals::turning as refusal;
use crate::shorthand::Words;

/// A hole on the axis, Z in millionths of the unit.
#[derive(Clone, Copy, Debug)]
struct Hole {
    x: i64,
    start: i64,
    /// R: where drilling begins.
    level: i64,
    sign: i64,
    deep: i64,
}

impl Hole {
    /// The place of a depth below R.
    fn place(&self, reached: i64) -> Spot {
        [self.x, self.level + self.sign * reached]
    }
}

impl Writer<'_, '_, '_> {
    /// G83.
    pub(super) fn drill(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let start = self.standing(&words, span)?;
        let hole = self.hole(&words, span, start)?;
        let peck = words.depth(&self.here, b'Q').map_or(hole.deep, i64::abs);
        let peck = if (1..hole.deep).contains(&peck) { peck } else { hole.deep };
        let retreat =
            if peck < hole.deep { self.peck_rules(&words, span)? } else { Retreat::Back { by: 0.0 } };
        let pecks = hole.deep as f64 / peck as f64;
        if pecks > MOST_PECKS {
            return Err(words.fault(refusal::TOO_MANY_PECKS, span));
        }
        let mut moves = self.begin(&words, start, b"XZUWRQPK")?;
        self.go(&mut moves, Code::Rapid, [hole.x, hole.start]);
        self.go(&mut moves, Code::Rapid, hole.place(0));
        let depths = peck_depths(hole.deep as f64, peck as f64, whole_pecks(pecks));
        self.strokes(&mut moves, depths, retreat, |depth| hole.place(depth));
        if let Some(dwell) = self.dwell(&words) {
            self.between(&mut moves, &dwell);
        }
        self.go(&mut moves, Code::Rapid, hole.place(0));
        self.leave(moves, &words, hole);
        Ok(())
    }

    /// G85.
    pub(super) fn bore(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let start = self.standing(&words, span)?;
        let hole = self.hole(&words, span, start)?;
        let Some(percent) = self.turning.cycles.bore_return_percent else {
            return Err(words.parameter_fault(
                span,
                &both!("at which feed G85 leaves its hole", "подача, с которой G85 выходит из отверстия"),
                "bore_return_percent",
                "200",
            ));
        };
        let feed = self.feed(&words).filter(|_| !self.unsure_feed || words.number(b'F').is_some());
        let of_feed = |percent: f64| feed.and_then(|feed| feed_word(feed.to_f64() * percent / 100.0, feed));
        let (Some(back), Some(out)) = (of_feed(100.0), of_feed(percent)) else {
            return Err(words.fault(refusal::boring_feed_not_known(percent), span));
        };
        let mut moves = self.begin(&words, start, b"XZUWRPK")?;
        self.go(&mut moves, Code::Rapid, [hole.x, hole.start]);
        self.go(&mut moves, Code::Rapid, hole.place(0));
        self.go(&mut moves, Code::Line, hole.place(hole.deep));
        if let Some(dwell) = self.dwell(&words) {
            self.between(&mut moves, &dwell);
        }
        self.go_with(&mut moves, Code::Line, hole.place(0), &out);
        // Behind the hole F holds as it was.
        self.between(&mut moves, &back);
        self.leave(moves, &words, hole);
        Ok(())
    }

    /// Back to the start, or from R where G99 leaves the tool there.
    fn leave(&mut self, mut moves: Moves, words: &Words<'_, '_>, hole: Hole) {
        if self.here.return_level != ReturnLevel::R {
            self.go(&mut moves, Code::Rapid, [hole.x, hole.start]);
        }
        self.unsure_feed &= words.number(b'F').is_none();
        self.end(moves);
        self.leave_open();
    }

    /// Where the hole lies, what cannot be one refused.
    fn hole(&self, words: &Words<'_, '_>, span: Span, start: Spot) -> Result<Hole, Fault> {
        let refuse = |refusal: Refusal| Err(words.fault(refusal, span));
        if let Some((number, span)) = words.number(b'K').filter(|(number, _)| number.integer() != Some(1)) {
            return Err(words.fault(refusal::hole_drilled_again(number.to_f64()), span));
        }
        let [x, target] = self.known_target(words, span)?;
        if x != 0 {
            return refuse(refusal::HOLE_OFF_THE_AXIS);
        }
        let Some(r) = self.length(words, b'R') else {
            return refuse(refusal::HOLE_WITHOUT_DEPTH_OR_R);
        };
        if words.number(b'W').is_some() && r != 0 {
            return refuse(refusal::DEPTH_FROM_UNKNOWN_PLACE);
        }
        let sign_to =
            |level: i64| (if self.here.says_places() { target - level } else { target - start[1] }).signum();
        let level =
            if self.r_is_place(words, span, sign_to(start[1]) * r.signum())? { r } else { start[1] + r };
        // Under G91 Z counts from R.
        let bottom = if self.here.says_places() { target } else { target - start[1] + level };
        let sign = (bottom - level).signum();
        if sign == 0 || sign != sign_to(start[1]) {
            return refuse(refusal::r_not_above_bottom(start[1] as f64 / MILLION, level as f64 / MILLION));
        }
        Ok(Hole { x, start: start[1], level, sign, deep: (bottom - level) * sign })
    }

    /// True where R is a place, false where it is a way from the start; `onwards`: that way leads towards the bottom
    /// (1), or off it (-1).
    fn r_is_place(&self, words: &Words<'_, '_>, span: Span, onwards: i64) -> Result<bool, Fault> {
        if !self.here.says_places() {
            return Ok(false);
        }
        match self.turning.cycles.drill_r {
            Some(r) => Ok(r == DrillR::Place),
            // System A knows U and W, and no G91.
            None if self.turning.increments && onwards >= 0 => Ok(false),
            None => Err(words.parameter_fault(
                span,
                &both!(
                    "whether R of a hole is a place or a way",
                    "что такое R отверстия, координата или расстояние,"
                ),
                "drill_r",
                "\"place\"",
            )),
        }
    }

    /// The moves of pecks down to these depths; `place` is that of a depth, all in millionths of the unit.
    pub(super) fn strokes(
        &mut self,
        moves: &mut Moves,
        depths: impl Iterator<Item = f64>,
        retreat: Retreat,
        place: impl Fn(i64) -> Spot,
    ) {
        for stroke in strokes(depths, retreat) {
            let (code, depth) = match stroke {
                Stroke::In(depth) => (Code::Line, depth),
                Stroke::Out => (Code::Rapid, 0.0),
                Stroke::Again(depth) => (Code::Rapid, depth),
            };
            self.go(moves, code, place(depth as i64));
        }
    }

    /// How the control comes back between pecks, millionths of the unit.
    fn peck_rules(&self, words: &Words<'_, '_>, span: Span) -> Result<Retreat, Fault> {
        let cycles = &self.turning.cycles;
        let Some(style) = cycles.drill_pecks else {
            return Err(words.parameter_fault(
                span,
                &both!("how far a peck goes back", "на сколько отводится сверло между проходами"),
                "drill_pecks",
                "\"full\"",
            ));
        };
        let Some(back) = cycles.drill_return_mm else {
            return Err(words.parameter_fault(
                span,
                &both!(
                    "by how much pecks go back, or stay off what is drilled",
                    "на сколько отводится сверло и сколько не доходит до просверленного"
                ),
                "drill_return_mm",
                "0.5",
            ));
        };
        let back = self.millionths_of(back) as f64;
        Ok(match style {
            DrillPecks::Full => Retreat::Out { clearance: back },
            DrillPecks::Chip => Retreat::Back { by: back },
        })
    }

    /// The dwell at the bottom, as a block.
    fn dwell(&self, words: &Words<'_, '_>) -> Option<Vec<u8>> {
        let is_p = |item: &&Item| matches!(item.kind, ItemKind::Word { letter: b'P', value: Value::Number(number) } if number.to_f64() != 0.0);
        let item = words.block.items.iter().find(is_p)?;
        Some([b"G4 ", words.block.text(item.span)].concat())
    }
}

/// F as a word, with its point or without; `None` where it would count in increments that are none.
fn feed_word(value: f64, like: Number) -> Option<Vec<u8>> {
    let has_point = like.has_point;
    let style = if has_point { Style::Decimals(6) } else { Style::Whole };
    let mut text = Vec::new();
    word(&mut text, b'F', value, style)?;
    (value > 0.0 && (has_point || value.fract() == 0.0)).then_some(text)
}
