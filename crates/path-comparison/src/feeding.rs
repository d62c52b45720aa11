//! A feed motion with what is reached of it.

use smallvec::SmallVec;

use crate::others::Course;
use crate::process::Process;
use crate::step::Pointing;
use crate::stretch::{POINTING_LEVER_MM, Place, Span, Stretch, TURN_LEVER_MM};
use crate::way::Way;

/// Which places of a motion's stretches are reached: from a stretch on, those of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Left {
    /// It lies in the window of what was asked for.
    pub(crate) asked: bool,
    pub(crate) first: usize,
    pub(crate) spans: SmallVec<[Option<Span>; 2]>,
}

impl Left {
    /// Of a stretch.
    pub(crate) fn at(&self, stretch: usize) -> Option<Span> {
        self.spans.get(stretch.checked_sub(self.first)?).copied().flatten()
    }

    /// Some place is.
    pub(crate) fn is_reached(&self) -> bool {
        self.spans.iter().any(Option::is_some)
    }

    /// The next stretch; those in front of the first that is reached are left out.
    pub(crate) fn push(&mut self, stretch: usize, span: Option<Span>) {
        if self.spans.is_empty() {
            if span.is_none() {
                return;
            }
            self.first = stretch;
        }
        // Between two stretches that are asked for none is reached.
        while self.first + self.spans.len() < stretch {
            self.spans.push(None);
        }
        self.spans.push(span);
    }

    /// Those that are reached, by stretch.
    pub(crate) fn reached(&self) -> impl DoubleEndedIterator<Item = (usize, Span)> + '_ {
        self.spans.iter().enumerate().filter_map(|(k, span)| Some((self.first + k, (*span)?)))
    }
}

/// How far a place is off a motion's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Off {
    /// The tip, mm.
    pub(crate) tip_mm: f64,
    /// The tool's direction, rad.
    pub(crate) leans_rad: f64,
    /// How far that may be there, rad.
    pub(crate) leans_at_most_rad: f64,
    /// The farthest rotary axis from its angle, rad, at the best of the places where tip and direction hold; infinite where
    /// there is none.
    pub(crate) aside_rad: f64,
}

impl Off {
    /// No place.
    const FAR: Self = Self {
        tip_mm: f64::INFINITY,
        leans_rad: f64::INFINITY,
        leans_at_most_rad: 1.0,
        aside_rad: f64::INFINITY,
    };

    /// The direction's share of its limit.
    fn leans(&self) -> f64 {
        self.leans_rad / self.leans_at_most_rad
    }

    /// The larger share of tip and direction.
    fn share(&self, limit_mm: f64) -> f64 {
        (self.tip_mm / limit_mm).max(self.leans())
    }
}

/// A feed motion.
pub(crate) struct Feeding {
    pub(crate) stretches: SmallVec<[Stretch; 2]>,
    /// What is reached of it while the other program stands where it does.
    pub(crate) left: Left,
    pub(crate) line: u64,
    pub(crate) process: Process,
    /// What it takes, under G93, where it leads farther than the limit.
    pub(crate) minutes: Option<f64>,
    pub(crate) limit_mm: f64,
    /// How far it leads from where it starts at most, mm: less than its length for a circle.
    pub(crate) reach_mm: f64,
    /// Its start, or its end, lies in the air above the hole that it drills.
    pub(crate) airy: [bool; 2],
    /// `None` for a positioning move of micrometres.
    pub(crate) way: Option<Way>,
    /// Largest distance from its own path, mm: of a programmed motion run uncorrected.
    pub(crate) off_mm: f64,
    /// Largest distance of what was made of it, mm, and the line that makes it.
    pub(crate) made_off_mm: f64,
    pub(crate) made_line: Option<u64>,
    /// Where the tool was brought for it, where that is to be remembered.
    pub(crate) made: Vec<[f64; 3]>,
    /// The errors along it, where they are asked for.
    pub(crate) course: Option<Box<Course>>,
    /// How far the tip and the direction may be off, where directions are compared.
    pub(crate) pointing: Option<(f64, Pointing)>,
    /// Of each stretch: how far the direction may be off there, rad.
    pub(crate) leans_at_most_rad: SmallVec<[f64; 2]>,
    /// Largest angle of the tool from the ideal direction at its own angles, rad.
    pub(crate) leans_rad: f64,
    /// The largest of what was made of it, rad.
    pub(crate) made_leans_rad: f64,
}

impl Feeding {
    /// So far from it is what a line makes of it.
    pub(crate) fn note_made(&mut self, off_mm: f64, line: u64) {
        if self.made_line.is_none() || off_mm > self.made_off_mm {
            self.made_line = Some(line);
        }
        self.made_off_mm = self.made_off_mm.max(off_mm);
    }

    pub(crate) fn start(&self) -> Place {
        self.stretches[0].at(0.0)
    }

    pub(crate) fn end(&self) -> Place {
        self.stretches[self.stretches.len() - 1].at(1.0)
    }

    pub(crate) fn length_mm(&self) -> f64 {
        self.stretches.iter().map(Stretch::length_mm).sum()
    }

    /// Minutes, under G93, and the way that they are shared by, mm: where rotary axes turn, the linear axes may have farther
    /// to go than the tool.
    pub(crate) fn timed(&self) -> (f64, f64) {
        let way_mm =
            || self.length_mm().max(self.way.as_ref().map_or(0.0, Way::length_mm)).max(self.limit_mm);
        self.minutes.map_or((0.0, 0.0), |minutes| (minutes, way_mm()))
    }

    /// So short that rounding decides whether it leads anywhere.
    pub(crate) fn is_short(&self) -> bool {
        /// Rounding at either end, and the limit.
        const LIMITS: f64 = 3.0;
        self.reach_mm <= LIMITS * self.limit_mm
    }

    /// Its end is reached.
    pub(crate) fn is_done(&self) -> bool {
        self.left.at(self.stretches.len() - 1).is_some_and(|span| span.is_at_end())
    }

    /// How far its end is from the last place that is reached, mm; `None` where none is.
    pub(crate) fn left_mm(&self) -> Option<f64> {
        self.left_mm_of(&self.left)
    }

    /// The same where so much is reached.
    pub(crate) fn left_mm_of(&self, left: &Left) -> Option<f64> {
        let (last, span) = left.reached().next_back()?;
        Some((self.end() - self.stretches[last].at(span.high)).norm())
    }

    /// How far a place is off where tip and direction hold best: being late by less than the tip may be off is no deviation
    /// of a direction either, nor of the axes.
    pub(crate) fn off(&self, place: &Place, limit_mm: f64) -> Off {
        /// So many places are looked at on either side of the nearest.
        const LOOKS: i32 = 24;
        /// So many times what is looked at for the best loses a third.
        const THIRDS: u32 = 40;
        /// Shares of the limits that differ by less are rounding.
        const ALIKE: f64 = 1e-6;
        let (mut best, mut least, mut aside_rad) = (Off::FAR, Off::FAR, f64::INFINITY);
        for (stretch, leans_at_most_rad) in self.stretches.iter().zip(&self.leans_at_most_rad) {
            let foot = stretch.foot(place);
            let away_mm = (place - stretch.at(foot)).fixed_rows::<6>(0).norm();
            if away_mm > 4.0 * self.limit_mm && best.tip_mm.is_finite() {
                continue;
            }
            let reach = 2.0 * self.limit_mm / stretch.length_mm().max(self.limit_mm);
            let off = |s: f64| {
                let off = place - stretch.at(s);
                Off {
                    tip_mm: off.fixed_rows::<3>(0).norm(),
                    leans_rad: off.fixed_rows::<3>(3).norm() / POINTING_LEVER_MM,
                    leans_at_most_rad: *leans_at_most_rad,
                    aside_rad: off.fixed_rows::<3>(6).amax() / TURN_LEVER_MM,
                }
            };
            let inside = |s: f64| s.clamp(0.0, 1.0);
            // The larger share has one least value on a stretch.
            let (mut low, mut high) = (inside(foot - reach), inside(foot + reach));
            for _ in 0..THIRDS {
                let third = (high - low) / 3.0;
                let [first, second] = [low + third, high - third].map(|s| off(s).share(limit_mm));
                if first <= second { high -= third } else { low += third }
            }
            let evenly = (-LOOKS..=LOOKS).map(|k| inside(foot + reach * f64::from(k) / f64::from(LOOKS)));
            for own in evenly.chain([0.5 * (low + high)]).map(off) {
                if own.tip_mm <= limit_mm {
                    if own.leans() < least.leans() {
                        least = own;
                    }
                    if own.leans() <= 1.0 {
                        aside_rad = aside_rad.min(own.aside_rad);
                    }
                }
                let [share, so_far] = [own, best].map(|off| off.share(limit_mm));
                // Of places that are as good the nearest.
                if share < so_far - ALIKE || (share < so_far + ALIKE && own.tip_mm < best.tip_mm) {
                    best = own;
                }
            }
        }
        let Off { leans_rad, leans_at_most_rad, .. } =
            if least.leans() <= best.leans() { least } else { best };
        Off { tip_mm: best.tip_mm, leans_rad, leans_at_most_rad, aside_rad }
    }

    /// Distance of a place, mm, and how far along the motion the nearest lies, 0 to 1.
    pub(crate) fn nearest(&self, place: &Place) -> (f64, f64) {
        let mut nearest = (f64::INFINITY, 0.0);
        for (k, stretch) in self.stretches.iter().enumerate() {
            let distance_mm = stretch.distance_mm(place);
            if distance_mm < nearest.0 {
                nearest = (distance_mm, (k as f64 + stretch.foot(place)) / self.stretches.len() as f64);
            }
        }
        nearest
    }
}
