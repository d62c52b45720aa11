//! What axes that follow late add to the path: corners that are cut, arcs that come out small.

use std::ops::Range;

use diagnostic::{Diagnostic, Text, both};
use nc_program::{LastFeed, Modal};
use toolpath::{Feed, Following, Shape};

use crate::job::{CONTROL_LEAVES, Job, Warning};

/// Where the axes' lag takes the tip farthest off the path.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Lag {
    corner: Option<Lagging>,
    arc: Option<Lagging>,
}

#[derive(Debug, Clone, PartialEq)]
struct Lagging {
    /// Infinite where nobody knows how fast it is.
    off_mm: f64,
    /// At this F and slower it is within the tolerance, mm/min.
    kept_mm_min: f64,
    span: Range<u64>,
    line: u64,
}

/// Whether rotary axes turn in a feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Turns {
    Not,
    Too,
}

impl Turns {
    pub(crate) fn of(feed: &Feed) -> Self {
        if feed.start.rotary_deg == feed.end.rotary_deg { Self::Not } else { Self::Too }
    }
}

/// The speed of an F, mm/s; infinite where it says none.
pub(crate) fn speed_mm_s(feed: LastFeed) -> f64 {
    match feed {
        LastFeed::PerMinute(feed, units) => feed.to_f64() * units.mm() / 60.0,
        LastFeed::Unknown | LastFeed::Inverse => f64::INFINITY,
    }
}

impl Lag {
    /// A feed is made at the speed of an F; of rotary axes that turn meanwhile nothing is known.
    pub(crate) fn corner(
        &mut self,
        job: &Job<'_>,
        following: &Following,
        modal: &Modal,
        (feed, turns): (LastFeed, Turns),
        place: impl FnOnce() -> (Range<u64>, u64),
    ) {
        if turns == Turns::Too {
            return see(&mut self.corner, job, f64::INFINITY, |_| f64::INFINITY, place);
        }
        let waits_mm = following.in_position_mm.filter(|_| job.leaves_mm(modal) == 0.0);
        let off_mm = |speed_mm_s: f64| {
            let off_mm = following.corner_mm(speed_mm_s, job.interpolator.acceleration_mm_s2);
            waits_mm.map_or(off_mm, |waits_mm| off_mm.min(waits_mm))
        };
        see(&mut self.corner, job, speed_mm_s(feed), off_mm, place);
    }

    /// An arc is made in this state.
    pub(crate) fn arc(
        &mut self,
        job: &Job<'_>,
        modal: &Modal,
        feed: &Feed,
        (span, line): (&Range<u64>, u64),
    ) {
        let (Some(following), Shape::Arc(arc)) = (&job.interpolator.following, &feed.shape) else { return };
        let [u, v, _] = arc.plane.axes();
        let at = &feed.start.linear_mm;
        let radius_mm = units::math::hypot(at[u] - arc.centre_mm[0], at[v] - arc.centre_mm[1]);
        let off_mm = |speed_mm_s: f64| following.arc_mm(speed_mm_s, radius_mm);
        see(&mut self.arc, job, speed_mm_s(modal.last_feed), off_mm, || (span.clone(), line));
    }

    pub(crate) fn add(&mut self, later: &Self) {
        farther(&mut self.corner, &later.corner, |at| at.off_mm);
        farther(&mut self.arc, &later.arc, |at| at.off_mm);
    }

    /// At most, mm.
    pub(crate) fn off_mm(&self) -> f64 {
        self.places().map(|at| at.off_mm).fold(0.0, f64::max)
    }

    fn places(&self) -> impl Iterator<Item = &Lagging> {
        self.corner.iter().chain(&self.arc)
    }

    pub(crate) fn lines(&mut self) -> impl Iterator<Item = &mut u64> {
        self.corner.iter_mut().chain(&mut self.arc).map(|at| &mut at.line)
    }

    /// In words; none where nothing lags.
    pub(crate) fn said(&self) -> impl Iterator<Item = Text> {
        let corner = self.corner.as_ref().map(|at| {
            (
                at,
                both!(
                    "at corners, what rapids leave behind apart",
                    "на углах, не считая следа холостых ходов"
                ),
            )
        });
        let arc = self.arc.as_ref().map(|at| (at, both!("on arcs", "на дугах")));
        corner.into_iter().chain(arc).map(|(Lagging { off_mm, line, .. }, place)| {
            if off_mm.is_finite() {
                both!(
                    "axes that lag add up to {:.1} um {place} (line {line})",
                    "отставание осей добавляет {place:#} до {:.1} мкм (строка {line})",
                    1e3 * off_mm
                )
            } else {
                both!(
                    "what axes that lag add {place} is not known: the speed in line {line} is not",
                    "что добавляет {place:#} отставание осей, неизвестно: скорость в строке {line} неизвестна"
                )
            }
        })
    }

    pub(crate) fn warnings(&self, job: &Job<'_>) -> impl Iterator<Item = Warning> {
        let tolerance_mm = job.options.tolerance_mm;
        let beyond = self.places().filter(move |at| at.off_mm > tolerance_mm);
        beyond.map(move |at| at.warning(1e3 * tolerance_mm))
    }
}

/// Keeps the later place where it is farther off the path.
pub(crate) fn farther<T: Clone>(known: &mut Option<T>, later: &Option<T>, off_mm: impl Fn(&T) -> f64) {
    if later.as_ref().map(&off_mm) > known.as_ref().map(&off_mm) {
        known.clone_from(later);
    }
}

/// Keeps where it is farthest off.
fn see(
    known: &mut Option<Lagging>,
    job: &Job<'_>,
    speed_mm_s: f64,
    off_mm: impl Fn(f64) -> f64,
    place: impl FnOnce() -> (Range<u64>, u64),
) {
    let most_mm = off_mm(speed_mm_s);
    if known.as_ref().is_none_or(|known| most_mm > known.off_mm) && most_mm > 0.0 {
        let (span, line) = place();
        let kept_mm_min = 60.0 * kept_mm_s(job.options.tolerance_mm, off_mm);
        *known = Some(Lagging { off_mm: most_mm, kept_mm_min, span, line });
    }
}

/// The speed up to which it is within the tolerance, mm/s: it rises with the speed.
fn kept_mm_s(tolerance_mm: f64, off_mm: impl Fn(f64) -> f64) -> f64 {
    let (mut slow, mut fast) = (0.0, 1e4);
    for _ in 0..60 {
        let between = 0.5 * (slow + fast);
        *if off_mm(between) <= tolerance_mm { &mut slow } else { &mut fast } = between;
    }
    slow
}

impl Lagging {
    fn warning(&self, tolerance_um: f64) -> Warning {
        let Self { off_mm, kept_mm_min, span, line } = self;
        let message = if off_mm.is_finite() {
            both!(
                "axes that lag leave the path by up to {:.1} um here: more than the tolerance of {tolerance_um} um",
                "отстающие оси сходят здесь с траектории до {:.1} мкм: больше допуска {tolerance_um} мкм",
                1e3 * off_mm
            )
        } else {
            both!(
                "by how much axes that lag leave the path here is not known: the tolerance of {tolerance_um} um is the machine's part",
                "насколько отстающие оси сходят здесь с траектории, неизвестно: допуск {tolerance_um} мкм — только доля станка"
            )
        };
        let label = both!("nowhere is it more", "больше — нигде");
        let help = if *kept_mm_min >= 1.0 {
            both!(
                "F{:.0} mm/min and slower keeps within it; so does more feed forward, `feed_forward` under `following`, where the control has it",
                "F{:.0} мм/мин и медленнее удержит допуск; так же — большее упреждение на стойке (`feed_forward` в `following`)",
                kept_mm_min.floor()
            )
        } else {
            both!(
                "no F is known to keep within it: rotary axes turn, or the loops are too slow",
                "F, которая удержит допуск, неизвестна: вращаются оси, или контуры слишком медленны"
            )
        };
        (Diagnostic::doubt(CONTROL_LEAVES, message).at(span.clone(), label).help(help), *line)
    }
}
