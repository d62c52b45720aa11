//! Single passes: G90, G92, G94 of system A, G77 to G79 of B, G20, G21, G24 of C.
//!
//! Four moves from where the tool stands and back there (B-64304EN-1, "Canned cycle (G90, G92, G94)"): to the first
//! place in a rapid, the cut, out, and back in a rapid. Out is a feed behind a cut and a rapid behind a thread. R is
//! the taper: what the radius (along X: Z, of a face) at the start of the cut is more than at its end. Words hold until
//! they are written again, and each block that has one makes a pass.
//!
//! A thread ends in a chamfer of so many leads, under an angle, which parameters of the control say: it is written as a
//! thread that goes on outwards, in step with the spindle. What a control makes of a stop (feed hold) during a cycle is
//! not what it makes of one during moves.

use diagnostic::both;
use nc_dialect::{Action, TurningCycle};
use nc_syntax::{ItemKind, Span};
use units::math;

use super::emit::Moves;
use super::held::Pass;
use super::place::{Code, MILLION, Spot};
use super::writer::Writer;
use crate::came::Fault;
use crate::refusals::turning as refusal;
use crate::shorthand::{Words, shown};

/// Chamfer at the end of a thread: 45 degrees where the parameter is zero or not said.
const CHAMFER_DEG: f64 = 45.0;

impl Writer<'_, '_, '_> {
    /// A block with the code of a pass.
    pub(super) fn first_pass(&mut self, at: usize, cycle: TurningCycle, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        if !words.names_a_place() {
            let holds_a_place = self.passed || taper_word(&words, cycle).is_some();
            if !holds_a_place && cycle == TurningCycle::TurnPass {
                self.idle_pass(at);
                return Ok(());
            }
            return Err(words.fault(refusal::CYCLE_WITHOUT_PLACE, span));
        }
        self.require_diameters(&words, span)?;
        let start = self.standing(&words, span)?;
        let held = self.pass;
        let tapered = held.is_some_and(|pass| pass.taper != 0);
        if tapered && taper_word(&words, cycle).is_none() {
            return Err(words.fault(refusal::TAPER_MAY_BE_IN_FORCE, span));
        }
        let to = held.map_or([None; 2], |pass| if pass.cycle == cycle { pass.to } else { [None; 2] });
        self.pass = Some(Pass { cycle, start, to, taper: 0 });
        self.repeated(at)
    }

    /// G90 of system A among the codes at a program's head, where people are used to it as the code of places.
    ///
    /// It has no place and none is held from a pass before it, so nothing moves; and what a control might make of it
    /// all the same would come back to where the tool stands. It is left out, and which motion is in force behind it
    /// nobody knows.
    fn idle_pass(&mut self, at: usize) {
        let words = self.words(at);
        self.unsure_feed &= words.number(b'F').is_none();
        self.leave_open();
        let block = words.block;
        let is_pass = |span: Span| {
            words.actions().any(|(action, other)| other == span && matches!(action, Action::Turning(_)))
        };
        let kept =
            block.items.iter().filter(|item| !matches!(item.kind, ItemKind::Comment) && !is_pass(item.span));
        let kept: Vec<&[u8]> = kept.map(|item| block.text(item.span)).collect();
        self.out.comment(shown(block), words.from);
        if !kept.is_empty() {
            self.out.line_of(&kept.join(&b' '), &self.blocks[at]);
        }
    }

    /// True where a block repeats the pass in force, or cannot stand behind one.
    pub(super) fn repeats(&self, words: &Words<'_, '_>) -> bool {
        let row = |m: i64| self.dialect.m_code(u16::try_from(m).ok()?);
        let ends = words.number(b'M').and_then(|(number, _)| row(number.integer()?));
        let own = |action: &Action| {
            matches!(
                action,
                Action::Rapid
                    | Action::Line
                    | Action::ArcClockwise
                    | Action::ArcCounterClockwise
                    | Action::Thread
                    | Action::Dwell
                    | Action::Reference
                    | Action::MachineCoordinates
            )
        };
        self.pass.is_some()
            && words.block.acts()
            && !ends.is_some_and(|row| row.ends_program)
            && !words.actions().any(|(action, _)| own(action))
    }

    /// A pass with the words of a block.
    pub(super) fn repeated(&mut self, at: usize) -> Result<(), Fault> {
        let words = self.words(at);
        let span = words.whole();
        let Some(mut pass) = self.pass else { return Ok(()) };
        let taper = taper_word(&words, pass.cycle);
        if words.skipped() || (!words.names_a_place() && taper.is_none()) {
            return Err(words.fault(refusal::BLOCK_WITHOUT_PLACE, span));
        }
        let target = words.target(&self.here, pass.start.map(Some));
        let letters = [(b'X', b'U'), (b'Z', b'W')];
        for (axis, (own, increment)) in letters.into_iter().enumerate() {
            if words.number(own).is_some() || words.number(increment).is_some() {
                pass.to[axis] = target[axis];
            }
        }
        if let Some(letter) = taper {
            pass.taper = self.length(&words, letter).unwrap_or_default();
        }
        let [Some(x), Some(z)] = pass.to else {
            return Err(words.fault(refusal::PASS_WITH_ONE_PLACE, span));
        };
        (self.pass, self.passed) = (Some(pass), true);
        let own: &[u8] = match pass.cycle {
            TurningCycle::FacePass => b"XZUWRK",
            TurningCycle::ThreadPass => b"XZUWRIQE",
            _ => b"XZUWRI",
        };
        let mut moves = self.begin(&words, pass.start, own)?;
        self.unsure_feed &= words.number(b'F').is_none();
        let to = [x, z];
        if pass.cycle == TurningCycle::ThreadPass {
            self.thread_pass(&mut moves, &words, &pass, to)?;
        } else {
            // Along Z the cut starts at the radius, along X at the Z, of the taper.
            let (across, along) = if pass.cycle == TurningCycle::FacePass { (1, 0) } else { (0, 1) };
            let mut first = pass.start;
            first[across] = to[across] + self.taper(&pass);
            let mut out = to;
            out[along] = to[along];
            out[across] = pass.start[across];
            self.go(&mut moves, Code::Rapid, first);
            self.go(&mut moves, Code::Line, to);
            self.go(&mut moves, Code::Line, out);
            self.go(&mut moves, Code::Rapid, pass.start);
        }
        self.end(moves);
        Ok(())
    }

    /// R as the words of its axis count.
    fn taper(&self, pass: &Pass) -> i64 {
        if pass.cycle == TurningCycle::FacePass { pass.taper } else { self.twice() * pass.taper }
    }

    fn thread_pass(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        pass: &Pass,
        to: Spot,
    ) -> Result<(), Fault> {
        let first = [to[0] + self.taper(pass), pass.start[1]];
        let further = words.texts(b"QE");
        self.go(moves, Code::Rapid, first);
        self.chamfered_thread(moves, words, to, pass.start[0], &further)?;
        self.go(moves, Code::Rapid, [pass.start[0], to[1]]);
        self.go(moves, Code::Rapid, pass.start);
        Ok(())
    }

    /// A thread from where the tool stands to a place, its chamfer outwards to `clear` where parameters say one.
    pub(super) fn chamfered_thread(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        to: Spot,
        clear: i64,
        further: &[u8],
    ) -> Result<(), Fault> {
        let Some(leads) = self.turning.cycles.thread_chamfer_leads else {
            return Err(words.parameter_fault(
                words.whole(),
                &both!("the chamfer at the end of a thread", "сбег резьбы"),
                "thread_chamfer_leads",
                "0.0",
            ));
        };
        self.chamfered(moves, words, to, clear, further, leads)
    }

    /// The same with a chamfer of so many leads.
    pub(super) fn chamfered(
        &mut self,
        moves: &mut Moves,
        words: &Words<'_, '_>,
        to: Spot,
        clear: i64,
        further: &[u8],
        leads: f64,
    ) -> Result<(), Fault> {
        let exact = |lead: nc_syntax::Number| {
            lead.has_point || self.dialect.numbers.point_free == nc_dialect::PointFree::Unit
        };
        let lead = self.feed(words).filter(|lead| exact(*lead));
        let start = moves.at();
        let length = match (leads > 0.0, lead, words.number(b'E')) {
            (false, ..) => 0.0,
            (true, Some(lead), None) => leads * lead.to_f64(),
            (true, ..) => {
                return Err(words.fault(refusal::THREAD_WHOSE_LEAD_NOT_CERTAIN, words.whole()));
            }
        };
        let ([r0, z0], [r1, z1]) = (self.plane(start), self.plane(to));
        let whole = (z1 - z0).abs();
        if length == 0.0 || whole == 0.0 {
            self.go_with(moves, Code::Thread, to, further);
            return Ok(());
        }
        let deg = self.turning.cycles.thread_chamfer_deg.filter(|deg| *deg > 0.0).unwrap_or(CHAMFER_DEG);
        let outwards = math::tan(deg.to_radians()) * length;
        let clear_mm = self.plane([clear, 0])[0];
        let share = 1.0 - length / whole;
        let begins = [r0 + share * (r1 - r0), z0 + share * (z1 - z0)];
        if share < 0.0 {
            return Err(words.fault(refusal::thread_shorter_than_chamfer(length), words.whole()));
        }
        // Where the cycle starts nothing stands along the thread: every pass comes back there in a rapid. A chamfer
        // that gets there before its end goes on along it.
        let room = (clear_mm - begins[0]).abs();
        let made = if outwards > room { room / outwards } else { 1.0 };
        let ends = [
            begins[0] + made * outwards * (clear_mm - begins[0]).signum(),
            begins[1] + made * (z1 - begins[1]),
        ];
        let (begins, mut ends) = (self.spot(begins), self.spot(ends));
        if outwards > room {
            ends[0] = clear;
        } else {
            ends[1] = to[1];
        }
        self.go_with(moves, Code::Thread, begins, further);
        self.go(moves, Code::Thread, ends);
        Ok(())
    }

    /// Words of a number with six decimals.
    pub(super) fn millionths_of(&self, mm: f64) -> i64 {
        units::decimal::round(mm / self.here.units.mm() * MILLION)
    }
}

/// R, or the letter of the series 10 and 11.
fn taper_word(words: &Words<'_, '_>, cycle: TurningCycle) -> Option<u8> {
    let other = if cycle == TurningCycle::FacePass { b'K' } else { b'I' };
    [b'R', other].into_iter().find(|letter| words.number(*letter).is_some())
}
