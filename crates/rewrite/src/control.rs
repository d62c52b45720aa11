//! What the control adds to the path: corners that it blends, arcs that it cuts as chords, modes that leave the path by an
//! amount of their own; and what it costs to stop.

use std::ops::Range;

use correction::{Centre, Goal, Piece, PieceKind};
use diagnostic::{Diagnostic, Text, both};
use nc_program::{LastFeed, Modal, PathControl};
use toolpath::{ArcChords, Feed, Motion, Shape};

use crate::job::{CONTROL_LEAVES, Job, Warning};
use crate::lag::{Lag, Turns, farther, speed_mm_s};
use crate::path_mode::{self, PathMode};

/// Where something is cut with the control farthest off the path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ControlPart {
    corner: Option<Corner>,
    arc: Option<Chords>,
    lag: Lag,
    /// Where stops were asked for.
    stops: Option<Stops>,
}

#[derive(Debug, Clone, PartialEq)]
struct Corner {
    by: PathControl,
    span: Range<u64>,
    line: u64,
}

/// The arc that chords leave farthest.
#[derive(Debug, Clone, PartialEq)]
struct Chords {
    off_mm: f64,
    span: Range<u64>,
    line: u64,
}

/// Blocks at whose end the control stops.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stops {
    count: u64,
    /// What they take at most, ns: whole ones, whose sum is the same in any order; `None` where nobody knows.
    ns: Option<u64>,
}

/// The control's arcs: what the profile says of them, else the dialect.
fn chords(job: &Job<'_>) -> Option<ArcChords> {
    job.interpolator.arcs.or_else(|| job.dialect.output.arc_chord_tolerance_mm.map(ArcChords::Tolerance))
}

impl ControlPart {
    /// A feed is made in this state; the corners of a hole lie in the air.
    #[inline]
    pub(crate) fn cut(&mut self, job: &Job<'_>, modal: &Modal, place: impl FnOnce() -> (Range<u64>, u64)) {
        let off_mm = job.leaves_mm(modal);
        if self.corner.as_ref().is_none_or(|known| off_mm > known.by.off_mm) {
            let (span, line) = place();
            self.corner = Some(Corner { by: PathControl { off_mm, ..modal.path_control }, span, line });
        }
    }

    /// Axes that lag make feeds at these speeds.
    #[inline]
    pub(crate) fn lag(
        &mut self,
        job: &Job<'_>,
        modal: &Modal,
        turns: Turns,
        feeds: impl IntoIterator<Item = LastFeed>,
        place: impl Fn() -> (Range<u64>, u64),
    ) {
        if let Some(following) = &job.interpolator.following {
            let feeds = feeds.into_iter();
            feeds.for_each(|feed| self.lag.corner(job, following, modal, (feed, turns), &place));
        }
    }

    /// An arc is left to the control, whose radii as it is written are apart.
    pub(crate) fn arc(
        &mut self,
        job: &Job<'_>,
        modal: &Modal,
        (feed, apart): (&Feed, Apart),
        (span, line): (&Range<u64>, u64),
    ) {
        self.lag.arc(job, modal, feed, (span, line));
        let off_mm = chords(job).map_or(0.0, |chords| apart.with_chords_mm(chords.leaves_mm(feed)));
        if off_mm > self.arc.as_ref().map_or(0.0, |known| known.off_mm) {
            self.arc = Some(Chords { off_mm, span: span.clone(), line });
        }
    }

    /// Blocks of a motion of so many mm, at whose ends the control is asked to stop.
    #[inline]
    pub(crate) fn stop(
        &mut self,
        job: &Job<'_>,
        modal: &Modal,
        blocks: usize,
        length_mm: impl FnOnce() -> f64,
    ) {
        if job.path_mode != PathMode::Exact {
            return;
        }
        let mm_s = Some(speed_mm_s(modal.last_feed)).filter(|mm_s| mm_s.is_finite());
        let more_s = mm_s.zip(job.interpolator.acceleration_mm_s2).map(|(mm_s, acceleration)| {
            let each_mm = length_mm() / blocks as f64;
            // From rest to rest, less what it takes at full speed.
            let more_s = if each_mm < mm_s * mm_s / acceleration {
                2.0 * (each_mm / acceleration).sqrt() - each_mm / mm_s
            } else {
                mm_s / acceleration
            };
            blocks as f64 * more_s
        });
        let ns = more_s.map(|seconds| (seconds * 1e9).round() as u64);
        self.add_stops(Stops { count: blocks as u64, ns });
    }

    pub(crate) fn add(&mut self, later: &Self) {
        farther(&mut self.corner, &later.corner, |at| at.by.off_mm);
        farther(&mut self.arc, &later.arc, |at| at.off_mm);
        self.lag.add(&later.lag);
        later.stops.into_iter().for_each(|more| self.add_stops(more));
    }

    fn add_stops(&mut self, more: Stops) {
        let Stops { count, ns } = self.stops.unwrap_or(Stops { count: 0, ns: Some(0) });
        let ns = ns.zip(more.ns).map(|(ns, more)| ns + more);
        self.stops = Some(Stops { count: count + more.count, ns });
    }

    /// By how much the control leaves the path at most, mm: at corners, on arcs and by lag together; infinite where nobody
    /// says, `None` where nothing is cut.
    #[must_use]
    pub fn off_mm(&self) -> Option<f64> {
        let corner_mm = self.corner.as_ref()?.by.off_mm;
        Some(corner_mm + self.arc.as_ref().map_or(0.0, |arc| arc.off_mm) + self.lag.off_mm())
    }

    /// Ends of blocks at which the control was made to stop, and what that takes at most, s; `None` there: nobody knows.
    #[must_use]
    pub fn stops(&self) -> Option<(u64, Option<f64>)> {
        self.stops.map(|stops| (stops.count, stops.ns.map(|ns| ns as f64 / 1e9)))
    }

    /// The lines of its places.
    pub(crate) fn lines(&mut self) -> impl Iterator<Item = &mut u64> {
        let corner = self.corner.iter_mut().flat_map(|cut| cut.by.line.iter_mut().chain([&mut cut.line]));
        corner.chain(self.arc.iter_mut().map(|arc| &mut arc.line)).chain(self.lag.lines())
    }

    /// What it adds to the path, in words, and what its stops cost; none where it adds nothing.
    pub fn said(&self) -> impl Iterator<Item = Text> {
        let corner =
            self.corner.as_ref().filter(|cut| cut.by.off_mm > 0.0).map(|Corner { by, line, .. }| {
                if by.off_mm.is_finite() {
                    both!(
                        "the control adds up to {:.1} um at corners (line {line})",
                        "стойка добавляет на углах до {:.1} мкм (строка {line})",
                        1e3 * by.off_mm
                    )
                } else {
                    both!(
                        "what the control adds at corners is not known",
                        "что добавляет на углах стойка, неизвестно"
                    )
                }
            });
        let arc = self.arc.as_ref().map(|Chords { off_mm, line, .. }| {
            both!(
                "the control adds up to {:.1} um on arcs, which it cuts as chords (line {line})",
                "стойка добавляет на дугах, которые режет хордами, до {:.1} мкм (строка {line})",
                1e3 * off_mm
            )
        });
        let stops = self.stops().map(|(count, seconds)| match seconds {
            Some(seconds) => both!(
                "stops at the ends of {count} blocks take up to {seconds:.1} s more",
                "остановы в концах кадров ({count}) займут до {seconds:.1} с"
            ),
            None => both!(
                "what stops at the ends of {count} blocks take is not known: `acceleration_mm_s2` under `control` says it",
                "сколько займут остановы в концах кадров ({count}), неизвестно: нужно `acceleration_mm_s2` в `control`"
            ),
        });
        corner.into_iter().chain(arc).chain(self.lag.said()).chain(stops)
    }

    /// What the tolerance does not cover.
    pub(crate) fn warnings(&self, job: &Job<'_>) -> impl Iterator<Item = Warning> {
        let tolerance_mm = job.options.tolerance_mm;
        let corner = self.corner.as_ref().filter(|cut| cut.by.off_mm > tolerance_mm);
        let arc = self.arc.as_ref().filter(|arc| arc.off_mm > tolerance_mm);
        let warnings = [corner.map(|corner| corner.warning(job)), arc.map(|arc| arc.warning(job))];
        warnings.into_iter().flatten().chain(self.lag.warnings(job))
    }
}

impl Corner {
    fn warning(&self, job: &Job<'_>) -> Warning {
        let Self { by, span, line } = self;
        let tolerance_um = 1e3 * job.options.tolerance_mm;
        let message = if by.off_mm.is_finite() {
            both!(
                "the control itself may leave the path by up to {:.1} um at corners: more than the tolerance of {tolerance_um} um",
                "сама стойка может сойти с траектории на углах до {:.1} мкм: больше допуска {tolerance_um} мкм",
                1e3 * by.off_mm
            )
        } else {
            both!(
                "by how much the control itself leaves the path at corners is not known: the tolerance of {tolerance_um} um is the machine's part",
                "насколько сама стойка сходит с траектории на углах, неизвестно: допуск {tolerance_um} мкм — только доля станка"
            )
        };
        let label = match by.line {
            Some(line) => both!(
                "the first motion that is cut so; line {line} says how",
                "первое такое рабочее движение; режим задан в строке {line}"
            ),
            None => both!(
                "the first motion that is cut so: as the control starts",
                "первое такое рабочее движение: в том режиме, с каким стойка начинает"
            ),
        };
        let name = &job.dialect.name;
        let settled = both!(
            "say in the profile what it does, `control = {{ dialect = \"{name}\", blending = {{ mode = \"tolerance\", tolerance_mm = 0.005 }} }}` or `{{ mode = \"exact-stop\" }}`",
            "скажите в профиле, что она делает: `control = {{ dialect = \"{name}\", blending = {{ mode = \"tolerance\", tolerance_mm = 0.005 }} }}` или `{{ mode = \"exact-stop\" }}`"
        );
        let help = match path_mode::exact(job.dialect) {
            Some(code) => both!(
                "`--path-control exact` writes {code} before it, or {settled}",
                "`--path-control exact` напишет перед ним {code}, или {settled:#}"
            ),
            None => settled,
        };
        (Diagnostic::doubt(CONTROL_LEAVES, message).at(span.clone(), label).help(help), *line)
    }
}

impl Chords {
    fn warning(&self, job: &Job<'_>) -> Warning {
        let Self { off_mm, span, line } = self;
        let tolerance_um = 1e3 * job.options.tolerance_mm;
        let message = both!(
            "the control itself leaves this arc by {:.1} um, since it cuts chords: more than the tolerance of {tolerance_um} um",
            "сама стойка сходит с этой дуги на {:.1} мкм, так как режет хордами: больше допуска {tolerance_um} мкм",
            1e3 * off_mm
        );
        let label = both!("no arc is left farther", "дальше она не сходит ни с одной дуги");
        let name = &job.dialect.name;
        let help = both!(
            "set finer chords at the control (`resolution` of Klipper, `$12` of Grbl), and say so in the profile: `control = {{ dialect = \"{name}\", arcs = {{ tolerance_mm = 0.0005 }} }}`, or `arcs = {{ chord_mm = 0.1 }}`",
            "задайте на стойке хорды мельче (`resolution` в Klipper, `$12` в Grbl) и скажите это в профиле: `control = {{ dialect = \"{name}\", arcs = {{ tolerance_mm = 0.0005 }} }}` или `arcs = {{ chord_mm = 0.1 }}`"
        );
        (Diagnostic::doubt(CONTROL_LEAVES, message).at(span.clone(), label).help(help), *line)
    }
}

/// By how much the radius of an arc is larger at its end than at its start, and by how much it is smaller, mm, at most
/// over its pieces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Apart {
    wider_mm: f64,
    narrower_mm: f64,
}

impl Apart {
    fn of(more_mm: f64) -> Self {
        Self { wider_mm: more_mm.max(0.0), narrower_mm: (-more_mm).max(0.0) }
    }

    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            wider_mm: self.wider_mm.max(other.wider_mm),
            narrower_mm: self.narrower_mm.max(other.narrower_mm),
        }
    }

    pub(crate) fn mm(self) -> f64 {
        self.wider_mm.max(self.narrower_mm)
    }

    /// How far chords that lie so far beside the arc of its first radius leave it, mm: they lie within, and so farther from
    /// an arc that widens, nearer to one that narrows.
    fn with_chords_mm(self, beside_mm: f64) -> f64 {
        (beside_mm + self.wider_mm).max(self.narrower_mm)
    }
}

/// By how much the radii of an arc differ between its start and its end.
pub(crate) fn radii_apart(motion: &Motion) -> Option<Apart> {
    let Motion::Feed(Feed { start, end, shape: Shape::Arc(arc), .. }) = motion else { return None };
    let [u, v, _] = arc.plane.axes();
    let radius_mm =
        |place: &[f64; 3]| units::math::hypot(place[u] - arc.centre_mm[0], place[v] - arc.centre_mm[1]);
    Some(Apart::of(radius_mm(&end.linear_mm) - radius_mm(&start.linear_mm)))
}

/// By how much the radii of an arc at its start and its end differ as it is written: a control that cuts chords keeps the
/// first of them, and makes it up with the last chord. Not at all where no piece is an arc with a centre.
///
/// * `start_mm` – where the axes stand, axis commands
pub(crate) fn radii_apart_by_words(
    pieces: &[Piece],
    start_mm: [Option<f64>; 3],
    info: &correction::Block,
    motion: &Motion,
) -> Apart {
    let Motion::Feed(feed @ Feed { shape: Shape::Arc(arc), .. }) = motion else { return Apart::default() };
    if pieces.is_empty() || info.arc_centres_absolute {
        return radii_apart(motion).unwrap_or_default();
    }
    let [first, second, _] = arc.plane.axes();
    let mut at = info.frame.to_program(start_mm.map(Option::unwrap_or_default));
    let stated_mm = info.frame.to_program(feed.end.linear_mm);
    let to = |goal: Goal, axis: usize, stated_mm: f64, stays_mm: f64| match goal {
        Goal::Steps(steps) => steps as f64 * info.unit_mm * 0.1_f64.powi(info.decimals[axis].into()),
        Goal::AsStated => stated_mm,
        Goal::Stays => stays_mm,
    };
    let mut apart = Apart::default();
    for piece in pieces {
        let end = [0, 1, 2].map(|axis| match piece.axes[axis] {
            Goal::Steps(_) if info.incremental[axis] => at[axis] + to(piece.axes[axis], axis, 0.0, 0.0),
            goal => to(goal, axis, stated_mm[axis], at[axis]),
        });
        if let PieceKind::Arc { centre: Centre::Offsets(centre), .. } = piece.kind {
            let offset = [(0, first), (1, second)]
                .map(|(k, axis)| to(centre[k], axis, arc.centre_mm[k] - feed.start.linear_mm[axis], 0.0));
            let back = [at[first] + offset[0] - end[first], at[second] + offset[1] - end[second]];
            let radii = [offset, back].map(|[a, b]| units::math::hypot(a, b));
            apart = apart.max(Apart::of(radii[1] - radii[0]));
        }
        at = end;
    }
    apart
}

/// Of two places, mm.
pub(crate) fn distance_mm(start: &[f64; 3], end: &[f64; 3]) -> f64 {
    let square = |axis: usize| (end[axis] - start[axis]) * (end[axis] - start[axis]);
    (square(0) + square(1) + square(2)).sqrt()
}
