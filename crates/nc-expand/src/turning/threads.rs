//! Threads in several passes: G76 (systems A and B), G78 of C.
//!
//! B-64304EN-1, "Multiple threading cycle". The first block says in P six digits: finishing passes, chamfer in tenths
//! of the lead, angle of the tool's tip; in Q the least infeed; in R the finishing allowance. The second one: X and Z
//! of the thread's root at its end, R the taper (what the radius at the start is more), P the height, Q the first
//! infeed, F the lead. The n-th pass lies the first infeed times the root of n deep, and at least the least infeed
//! below the one before, down to the finishing allowance above the root; then the finishing passes, at the root.
//!
//! In one block (the format of series 10 and 11, and Haas's) K is the height, D the first infeed, I the taper, A the
//! angle; the rest parameters say.
//!
//! With a tip of zero degrees the tool feeds straight in. Of other angles one edge cuts: each pass starts further along
//! Z, by its depth times the tangent of half the angle. From where that counts the manual shows in a figure and says in
//! no sentence; the profile has to say it ([`FlankFrom`]).

use diagnostic::{Refusal, Text, both};
use nc_syntax::Span;
use toolpath::FlankFrom;
use units::math;

use super::held::ThreadSettings;
use super::place::{Code, Spot};
use super::writer::Writer;
use crate::came::Fault;
use crate::refusals::threads as refusal;
use crate::shorthand::Words;

/// Passes of one thread; more are a wrong infeed.
const MOST_PASSES: usize = 1000;

impl Writer<'_, '_, '_> {
    pub(super) fn thread(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        self.require_diameters(&words, span)?;
        if !words.names_a_place() {
            return self.set_thread(at, span);
        }
        let start = self.standing(&words, span)?;
        let refuse = |refusal: Refusal| Err(words.fault(refusal, span));
        let in_one_block = words.number(b'K').is_some();
        let settings = if in_one_block {
            self.settings_of_control(&words, span)?
        } else if let Some(settings) = self.first_blocks.thread {
            settings
        } else {
            return refuse(refusal::WITHOUT_FIRST_BLOCK);
        };
        let [Some(x), Some(z)] = self.target(&words) else {
            return refuse(refusal::END_NOT_KNOWN);
        };
        let (height, first) = if in_one_block {
            (self.length(&words, b'K'), words.depth(&self.here, b'D'))
        } else {
            (words.depth(&self.here, b'P'), words.depth(&self.here, b'Q'))
        };
        let (Some(height), Some(first)) = (height.filter(|h| *h > 0), first.filter(|q| *q > 0)) else {
            let letters = if in_one_block { ['K', 'D'] } else { ['P', 'Q'] };
            return refuse(refusal::thread_without_height(letters));
        };
        if words.number(b'F').is_none() {
            return refuse(refusal::THREAD_WITHOUT_LEAD);
        }
        let taper = self.length(&words, if in_one_block { b'I' } else { b'R' }).unwrap_or_default();
        let twice = self.twice();
        // Outside threads start above their root.
        let outwards = (start[0] - (x + twice * taper)).signum();
        if outwards == 0 || (start[0] - x) * outwards < twice * height || start[1] == z {
            return refuse(refusal::STARTS_WITHIN_ITS_HEIGHT);
        }
        let depths = depths(height, first, &settings);
        let Some(depths) = depths else {
            return refuse(refusal::TOO_MANY_INFEEDS);
        };
        let flank = self.flank(&words, span, &settings, &depths)?;
        let own: &[u8] = if in_one_block { b"XZUWIKDA" } else { b"XZUWPQR" };
        let mut moves = self.begin(&words, start, own)?;
        self.unsure_feed = false;
        for depth in depths {
            let above = outwards * twice * (height - depth);
            let from: Spot = [x + twice * taper + above, start[1] + (z - start[1]).signum() * flank(depth)];
            self.go(&mut moves, Code::Rapid, from);
            self.chamfered(&mut moves, &words, [x + above, z], start[0], b"", settings.chamfer_leads)?;
            self.go(&mut moves, Code::Rapid, [start[0], z]);
            self.go(&mut moves, Code::Rapid, start);
        }
        self.end(moves);
        self.leave_open();
        Ok(())
    }

    /// How far along the thread a pass of some depth starts, millionths.
    fn flank(
        &self,
        words: &Words<'_, '_>,
        span: Span,
        settings: &ThreadSettings,
        depths: &[i64],
    ) -> Result<impl Fn(i64) -> i64 + use<>, Fault> {
        let zero = if settings.tip_deg == 0.0 {
            0
        } else {
            match self.turning.cycles.thread_flank_from {
                Some(FlankFrom::Start) => 0,
                Some(FlankFrom::FirstPass) => depths.first().copied().unwrap_or_default(),
                Some(FlankFrom::LastPass) => depths.last().copied().unwrap_or_default(),
                None => {
                    return Err(words.parameter_fault(
                        span,
                        &both!(
                            "from where the start of each pass moves along the flank",
                            "как начало каждого прохода смещается вдоль боковой стороны"
                        ),
                        "thread_flank_from",
                        "\"first-pass\"",
                    ));
                }
            }
        };
        let slope = math::tan(0.5 * settings.tip_deg.to_radians());
        Ok(move |depth: i64| units::decimal::round((depth - zero) as f64 * slope))
    }

    /// What parameters of the control say of a thread in one block.
    fn settings_of_control(&self, words: &Words<'_, '_>, span: Span) -> Result<ThreadSettings, Fault> {
        let cycles = &self.turning.cycles;
        let said = |value: Option<f64>, what: Text, key: &str, like: &str| {
            value.ok_or_else(|| words.parameter_fault(span, &what, key, like))
        };
        let passes = said(
            cycles.thread_finishing_passes,
            both!("how many finishing passes", "число чистовых проходов"),
            "thread_finishing_passes",
            "1",
        )?;
        let least = said(
            cycles.thread_least_mm,
            both!("the least infeed", "наименьшее врезание"),
            "thread_least_mm",
            "0.05",
        )?;
        let allowance = said(
            cycles.thread_allowance_mm,
            both!("the finishing allowance", "чистовой припуск"),
            "thread_allowance_mm",
            "0",
        )?;
        let chamfer = said(
            cycles.thread_chamfer_leads,
            both!("the chamfer at the end", "сбег в конце"),
            "thread_chamfer_leads",
            "1",
        )?;
        let tip_deg = words.number(b'A').map_or(0.0, |(number, _)| number.to_f64());
        if !(0.0..=120.0).contains(&tip_deg) {
            return Err(words.fault(refusal::tip_angle(tip_deg), span));
        }
        Ok(ThreadSettings {
            finishing_passes: passes as i64,
            chamfer_leads: chamfer,
            tip_deg,
            least: self.millionths_of(least),
            allowance: self.millionths_of(allowance),
        })
    }

    /// The first block.
    fn set_thread(&mut self, at: usize, span: Span) -> Result<(), Fault> {
        let words = self.words(at);
        let digits = words.number(b'P').and_then(|(number, _)| number.integer());
        let least = words.depth(&self.here, b'Q');
        let allowance = self.length(&words, b'R');
        let (Some(digits), Some(least), Some(allowance)) =
            (digits.filter(|p| (0..1_000_000).contains(p)), least, allowance)
        else {
            return Err(words.fault(refusal::FIRST_BLOCK_WITHOUT_SETTINGS, span));
        };
        let moves = self.begin(&words, [0; 2], b"PQR")?;
        self.end(moves);
        self.first_blocks.thread = Some(ThreadSettings {
            finishing_passes: (digits / 10_000).max(1),
            chamfer_leads: (digits / 100 % 100) as f64 * 0.1,
            tip_deg: (digits % 100) as f64,
            least: least.abs(),
            allowance: allowance.abs(),
        });
        Ok(())
    }
}

/// How deep each pass lies, millionths; `None` where there are too many.
fn depths(height: i64, first: i64, settings: &ThreadSettings) -> Option<Vec<i64>> {
    let rough = height - settings.allowance;
    let (mut depths, mut depth) = (Vec::new(), 0);
    while depth < rough {
        let count = depths.len() as f64 + 1.0;
        let next = units::decimal::round(first as f64 * count.sqrt());
        depth = next.max(depth + settings.least).max(depth + 1).min(rough);
        depths.push(depth);
        if depths.len() > MOST_PASSES {
            return None;
        }
    }
    depths.extend((0..settings.finishing_passes).map(|_| height));
    Some(depths)
}
