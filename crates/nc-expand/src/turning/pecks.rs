//! Pecks: G74 along Z, G75 along X (systems A and B), G76 and G77 of C.
//!
//! B-64304EN-1, "End face peck drilling cycle", "Outer diameter / internal diameter drilling cycle". From where the
//! tool stands it goes down in steps (G74: Q, G75: P), back by the return (R of the first block) behind each but the
//! last, and from the bottom in a rapid to where it began; then along by the other step, until it has been at the place
//! of X and Z; then back to the start. P and Q are radius or Z, without a point least increments. R of the second
//! block, the relief at the bottom, is refused: at the first groove there is no room for it, and what a control does
//! there the manual leaves open.

use diagnostic::both;
use nc_dialect::TurningCycle;
use nc_syntax::Span;
use toolpath::{Retreat, peck_depths, whole_pecks};

use super::place::{Code, Spot};
use super::writer::Writer;
use crate::came::Fault;
use crate::refusals::turning as refusal;

/// Pecks of one cycle at all its places; more are a wrong step.
const MOST: i64 = 10_000;

impl Writer<'_, '_, '_> {
    pub(super) fn pecks(&mut self, at: usize, cycle: TurningCycle, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        self.require_diameters(&words, span)?;
        // The axis of the pecks: Z of G74, X of G75.
        let down = if cycle == TurningCycle::PeckFace { 1 } else { 0 };
        let along = 1 - down;
        if !words.names_a_place() {
            let Some(back) = self.length(&words, b'R') else {
                return Err(words.fault(refusal::CYCLE_WITHOUT_X_OR_Z, span));
            };
            let moves = self.begin(&words, [0; 2], b"R")?;
            self.end(moves);
            self.first_blocks.peck_return[down] = Some(back.abs());
            return Ok(());
        }
        let start = self.standing(&words, span)?;
        if let Some((number, span)) = words.number(b'R').filter(|(number, _)| number.to_f64() != 0.0) {
            return Err(words.fault(refusal::relief_at_bottom(number.to_f64()), span));
        }
        let to = self.known_target(&words, span)?;
        let whole = [to[0] - start[0], to[1] - start[1]];
        let twice = [self.twice(), 1];
        let letters = [b'P', b'Q'];
        let step = |axis: usize| {
            let said = words.depth(&self.here, letters[axis]).map(|step| twice[axis] * step.abs());
            said.filter(|step| *step > 0).unwrap_or_else(|| whole[axis].abs())
        };
        let (peck, across) = (step(down), step(along));
        if whole[along] != 0 && words.number(letters[along]).is_none() {
            return Err(words.fault(refusal::groove_without_step(along), span));
        }
        let (pecks, places) = (1 + whole[down].abs() / peck.max(1), 1 + whole[along].abs() / across.max(1));
        if whole[down] == 0 || pecks.saturating_mul(places) > MOST {
            return Err(words.fault(refusal::DEPTH_OR_PECKS, span));
        }
        let needs_return = whole[down].abs() > peck;
        let said = self.first_blocks.peck_return[down].map(|back| back * twice[down]);
        let parameter = self.turning.cycles.groove_return_mm;
        let back = match said.or_else(|| parameter.map(|mm| self.millionths_of(mm) * twice[down])) {
            Some(back) => back,
            None if !needs_return => 0,
            None => {
                return Err(words.parameter_fault(
                    span,
                    &both!("by how much pecks go back", "на сколько отводится инструмент между проходами"),
                    "groove_return_mm",
                    "0.5",
                ));
            }
        };
        let mut moves = self.begin(&words, start, b"XZUWPQRIKD")?;
        let place = |at_along: i64, at_down: i64| -> Spot {
            let mut spot = start;
            spot[along] += at_along * whole[along].signum();
            spot[down] += at_down * whole[down].signum();
            spot
        };
        let mut sideways = 0;
        loop {
            self.go(&mut moves, Code::Rapid, place(sideways, 0));
            let deep = whole[down].abs() as f64;
            let depths = peck_depths(deep, peck as f64, whole_pecks(deep / peck as f64));
            self.strokes(&mut moves, depths, Retreat::Back { by: back as f64 }, |depth| {
                place(sideways, depth)
            });
            self.go(&mut moves, Code::Rapid, place(sideways, 0));
            if sideways >= whole[along].abs() {
                break;
            }
            sideways = (sideways + across).min(whole[along].abs());
        }
        self.go(&mut moves, Code::Rapid, start);
        self.unsure_feed &= words.number(b'F').is_none();
        self.end(moves);
        self.leave_open();
        Ok(())
    }
}
