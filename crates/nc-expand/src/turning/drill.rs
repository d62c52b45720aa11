//! A hole on the axis: G83 of system A.
//!
//! B-64304EN-1, "Front drilling cycle": along X to the hole, a rapid to R, which counts from where the cycle starts, a feed to
//! Z, dwell P at the bottom, a rapid back to the start. With Q in pecks: parameter 5101.2 (RTR) says whether each goes back
//! to R or by the return 5114 (d); down again a rapid ends d above what is drilled. Q is a depth, without a point in least
//! increments. Systems B and C are refused by their tables: whether R is a place or a way there is a parameter (5102.6).

use diagnostic::{Text, both};
use nc_syntax::dialect::DrillPecks;
use nc_syntax::{Item, ItemKind, Span, Value};

use super::emit::Code;
use super::state::Motion;
use super::{Fault, Spot, Writer};
use crate::shorthand::Words;

/// Pecks of one hole; more are a wrong step.
const MOST: i64 = 2_000;

impl Writer<'_, '_> {
    pub(super) fn drill(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let start = self.standing(&words, span)?;
        let refuse = |what: Text, label: Text, help: Text| Err(words.cycle_fault(span, what, label, help));
        if let Some((number, span)) = words.number(b'K').filter(|(number, _)| number.integer() != Some(1)) {
            return Err(words.cycle_fault(
                span,
                both!("a hole drilled {} times", "отверстие сверлится раз: {}", number.to_f64()),
                both!(
                    "K counts the holes, and on the axis there is one",
                    "K считает отверстия, а на оси оно одно"
                ),
                both!("leave K out", "уберите K"),
            ));
        }
        let [Some(x), Some(bottom)] = self.state.target(&words) else {
            return refuse(
                both!("where the cycle leads is not known", "неизвестно, куда ведёт цикл"),
                both!("above 400 km", "больше 400 км"),
                both!("correct X and Z", "исправьте X и Z"),
            );
        };
        if x != 0 {
            return refuse(
                both!("a hole off the axis", "отверстие не на оси"),
                both!(
                    "beside the axis of a workpiece that turns nothing is drilled",
                    "вне оси вращающейся детали не сверлят"
                ),
                both!(
                    "write X0; correct the turning apart from what is drilled with a driven tool",
                    "напишите X0; исправляйте точение отдельно от сверления приводным инструментом"
                ),
            );
        }
        if bottom == start[1] || words.number(b'R').is_none() {
            return refuse(
                both!("a hole without a depth, or without R", "отверстие без глубины или без R"),
                both!(
                    "R is the way from the start to where drilling begins",
                    "R — путь от начала до места, где начинается сверление"
                ),
                both!(
                    "write Z and R, as in `G83 Z-30. R-3. F0.1`",
                    "напишите Z и R, например `G83 Z-30. R-3. F0.1`"
                ),
            );
        }
        let sign = (bottom - start[1]).signum();
        let approach = self.state.length(&words, b'R').unwrap_or_default();
        let deep = (bottom - start[1] - approach) * sign;
        if approach * sign < 0 || deep <= 0 {
            return refuse(
                both!("R does not lie between the start and the bottom", "R не лежит между началом и дном"),
                both!("it counts from the start, with its sign", "отсчитывается от начала, со знаком"),
                both!("R-3. goes 3 mm along -Z", "R-3. — это 3 мм вдоль -Z"),
            );
        }
        let peck = self.state.depth(&words, b'Q').map_or(deep, i64::abs);
        let (style, back) =
            if peck > 0 && peck < deep { self.peck_rules(&words, span)? } else { (DrillPecks::Full, 0) };
        let peck = if peck == 0 { deep } else { peck };
        if deep / peck > MOST {
            return refuse(
                both!("a hole of more than 2000 pecks", "отверстие больше чем в 2000 проходов"),
                both!("Q counts least increments where it has no point", "Q без точки считает дискреты"),
                both!("correct Z and Q", "исправьте Z и Q"),
            );
        }
        let mut moves = self.begin(&words, start, b"XZUWRQPK")?;
        let level = start[1] + approach;
        let place = |reached: i64| -> Spot { [x, level + sign * reached] };
        self.go(&mut moves, Code::Rapid, [x, start[1]]);
        self.go(&mut moves, Code::Rapid, place(0));
        let mut reached = 0;
        while reached < deep {
            if reached > 0 {
                let up = (reached - back).max(0);
                if style == DrillPecks::Full {
                    self.go(&mut moves, Code::Rapid, place(0));
                }
                self.go(&mut moves, Code::Rapid, place(up));
            }
            reached = (reached + peck).min(deep);
            self.go(&mut moves, Code::Line, place(reached));
        }
        if let Some(dwell) = self.dwell(&words) {
            self.between(&mut moves, &dwell);
        }
        self.go(&mut moves, Code::Rapid, place(0));
        self.go(&mut moves, Code::Rapid, [x, start[1]]);
        if let Some((feed, _)) = words.number(b'F') {
            (self.state.feed, self.unsure_feed) = (Some(feed), false);
        }
        self.end(moves);
        self.state.motion = Motion::Unknown;
        Ok(())
    }

    /// How the control pecks, and by how much it stays off what is drilled, millionths of the unit.
    fn peck_rules(&self, words: &Words<'_, '_>, span: Span) -> Result<(DrillPecks, i64), Fault> {
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
        Ok((style, self.millionths_of(back)))
    }

    /// The dwell at the bottom, as a block.
    fn dwell(&self, words: &Words<'_, '_>) -> Option<Vec<u8>> {
        let is_p = |item: &&Item| matches!(item.kind, ItemKind::Word { letter: b'P', value: Value::Number(number) } if number.to_f64() != 0.0);
        let item = words.block.items.iter().find(is_p)?;
        Some([b"G4 ", words.block.text(item.span)].concat())
    }
}
