//! Threads of LinuxCNC in several passes: G76.
//!
//! G-code reference, "G76 Threading Cycle", and what `rs274` of 2.9 makes of it: with I the crest's distance from the
//! drive line (where the tool stands; below zero outside), J the first infeed, K the height, R the degression, Q the
//! angle of the infeed and H the spring passes, all along X as X words count, pass n lies
//! |I| + J·n^(1/R) from the drive line until |I| + K is reached, which is cut 1 + H times; it starts, and ends, nearer to the
//! chuck by (depth below the crest)·tan Q, its end as much short of Z as the last pass is shifted more. Before and
//! behind a pass the tool stands off the drive line by what is still to be cut. The tool ends on the drive line at Z.
//! Tapers at the ends (L, E) are refused: their parts have other leads, and each would have to be a thread of its own.

use diagnostic::Refusal;
use nc_syntax::Span;
use units::math;

use super::place::{Code, MILLION, Spot};
use super::writer::Writer;
use crate::came::Fault;
use crate::refusals::threads as refusal;

/// Passes of one thread; more are a wrong infeed.
const MOST_PASSES: u32 = 1000;

impl Writer<'_, '_, '_> {
    pub(super) fn compound_thread(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let refuse = |refusal: Refusal| Err(words.fault(refusal, span));
        let start = self.standing(&words, span)?;
        for letter in *b"LE" {
            if let Some((number, span)) = words.number(letter)
                && number.to_f64() != 0.0
            {
                return Err(words.fault(refusal::THREAD_WITH_TAPERED_ENDS, span));
            }
        }
        let length = |letter: u8| self.length(&words, letter).map(|value| value as f64);
        let plain = |letter: u8| words.number(letter).map(|(number, _)| number.to_f64());
        let (Some((_, lead)), Some(end), Some(crest), Some(first), Some(height)) =
            (words.number(b'P'), self.length(&words, b'Z'), length(b'I'), length(b'J'), length(b'K'))
        else {
            return refuse(refusal::THREAD_WITHOUT_ITS_WORDS);
        };
        let degression = plain(b'R').unwrap_or(1.0);
        let angle = plain(b'Q').unwrap_or_default();
        let springs = words.number(b'H').map_or(Some(0), |(number, _)| number.integer());
        let Some(springs) = springs.filter(|springs| (0..=i64::from(MOST_PASSES)).contains(springs)) else {
            return refuse(refusal::NUMBER_OF_SPRING_PASSES);
        };
        let fits = first > 0.0 && height >= first && crest != 0.0 && degression >= 1.0;
        if !fits || !self.here.says_places() || end >= start[1] || !(0.0..=80.0).contains(&angle) {
            return refuse(refusal::PASSES_NOT_CERTAIN);
        }
        let outside = if crest < 0.0 { 1.0 } else { -1.0 };
        let (crest, whole) = (crest.abs(), crest.abs() + height);
        let slope = math::tan(angle.to_radians()) * self.plane([1, 0])[0] * MILLION;
        let shift = |depth: f64| (depth - crest) * slope;
        let mut depths = Vec::new();
        for pass in 1..=MOST_PASSES {
            let share = math::powf(f64::from(pass), 1.0 / degression);
            // In the program's own unit, as the interpreter reckons: whether a pass as deep as the thread, but for the
            // last digit, is one more or the last one hangs on it.
            if crest / MILLION + first / MILLION * share >= height / MILLION + crest / MILLION {
                break;
            }
            depths.push(crest + first * share);
        }
        if depths.len() == MOST_PASSES as usize {
            return refuse(refusal::TOO_MANY_PASSES);
        }
        depths.extend((0..=springs).map(|_| whole));
        let mut further = b"K".to_vec();
        further.extend_from_slice(&words.block.text(lead)[1..]);
        let mut moves = self.begin(&words, start, b"PZIJKRQHLE")?;
        let round = units::decimal::round;
        for depth in depths {
            let clear = start[0] + round(outside * (whole - depth));
            let cut = start[0] - round(outside * depth);
            let from = start[1] - round(shift(depth));
            let to: Spot = [cut, end + round(shift(whole) - shift(depth))];
            self.go(&mut moves, Code::Rapid, [clear, from]);
            self.go(&mut moves, Code::Rapid, [cut, from]);
            self.go_with(&mut moves, Code::Thread, to, &further);
            self.go(&mut moves, Code::Rapid, [clear, to[1]]);
        }
        self.go(&mut moves, Code::Rapid, [start[0], end]);
        self.end(moves);
        self.leave_open();
        Ok(())
    }
}
