//! Whether F still means the programmed speed where rotary axes turn.
//!
//! Under G93 it does: time is shared out. Under G94 and G95 controls differ in what F counts. Where linear axes that were
//! to stand have to follow a crooked rotary axis, or go another way than programmed, a block could take another time: it
//! is told by its time, or refused where nobody knows that.

use correction::{Corrected, Turned};
use diagnostic::{Diagnostic, both};
use nc_dialect::{Action, Dialect, RotaryFeed};
use nc_program::{Compensation, Context, LastFeed, Modal};
use nc_syntax::{Block, GCode};
use toolpath::{Feed, FeedRate, Kinematics, Motion, Shape};
use units::decimal::{Decimal, Spelling};

use crate::job::ROTARY_FEED;

/// By no more than this part of itself a motion may take another time.
const SAME_TIME: f64 = 0.1;

/// The codes by which a motion is told by its time, in a program whose F are speeds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ByTime {
    /// F of the whole motion, 1/min.
    pub(crate) per_minute: f64,
    inverse: GCode,
    speed: GCode,
    feed: Decimal,
}

impl ByTime {
    /// The blocks before it and behind it, where F is the speed that it was.
    pub(crate) fn lines(&self) -> [String; 2] {
        let mut feed = Vec::new();
        units::decimal::write(&mut feed, self.feed.mantissa, self.feed.decimals, Spelling::FIXED);
        [self.inverse.to_string(), format!("{} F{}", self.speed, String::from_utf8_lossy(&feed))]
    }
}

/// The least part of a motion's time for which the control can read an F.
pub(crate) fn least_share(dialect: &Dialect, feed: &Feed, usual: f64) -> f64 {
    match feed.rate {
        FeedRate::InverseTime(rate) => usual.max((rate / dialect.output.largest_inverse_feed).min(1.0)),
        _ => usual,
    }
}

/// Nothing where a motion takes the time that was programmed, else how it is told by that.
///
/// # Errors
/// VP0532: nobody knows that time, or the control has no F for it.
pub(crate) fn require_same(
    dialect: &Dialect,
    modal: &Modal,
    corrected: &Corrected,
    motion: &Motion,
    block: &Block<'_>,
    context: &Context,
) -> Result<Option<ByTime>, Vec<Diagnostic>> {
    let Motion::Feed(feed) = motion else { return Ok(None) };
    let whole = block.file_range();
    let readable = |rate: f64| {
        let shortest = corrected.pieces.iter().map(|piece| piece.share).fold(1.0, f64::min);
        let largest = dialect.output.largest_inverse_feed;
        if rate / shortest <= largest.max(rate) {
            return Ok(());
        }
        let message = both!(
            "cut into {}, the shortest piece of this motion would need F{:.0}",
            "для разделённого движения (кадров: {}) самому короткому нужно F{:.0}",
            corrected.pieces.len(),
            rate / shortest
        );
        let label =
            both!("under G93 the control reads F to {largest}", "при G93 стойка читает F до {largest}");
        Err(vec![Diagnostic::error(ROTARY_FEED, message).at(whole.clone(), label).help(both!(
            "let the CAM write fewer and longer blocks, or a wider `--tolerance`, by which it stays one",
            "выводите из CAM меньше кадров подлиннее или расширьте `--tolerance`, чтобы движение осталось одним кадром"
        ))])
    };
    if let FeedRate::InverseTime(rate) = feed.rate {
        return readable(rate).map(|()| None);
    }
    let Some(turned) = &corrected.correction.turned else { return Ok(None) };
    let counted = counted(dialect, context);
    let readings = match counted {
        Some(counts) => [counts; 2],
        None => [RotaryFeed::LinearAxes, RotaryFeed::AllAxes],
    };
    if readings.iter().all(|counts| is_same(*counts, turned, context.unit_mm)) {
        return Ok(None);
    }
    if feed.shape == Shape::Line
        && let Some(by_time) = by_time(dialect, modal, turned, block, context)
    {
        return readable(by_time.per_minute).map(|()| Some(by_time));
    }
    let message = both!(
        "while a rotary axis turns the linear axes have to go {:.4} mm instead of {:.4} mm, and F would be another speed",
        "пока вращается поворотная ось, линейным осям надо пройти {:.4} мм вместо {:.4} мм, и F стало бы другой скоростью",
        turned.commanded_mm,
        turned.programmed_mm
    );
    let label = match counted {
        Some(_) => both!("F counts their way here", "F считает здесь их путь"),
        None => both!(
            "F may count their way; what it counts is not known of this control",
            "F, возможно, считает их путь; что оно считает на этой стойке, неизвестно"
        ),
    };
    Err(vec![
        Diagnostic::error(ROTARY_FEED, message)
            .at(whole.clone(), label)
            .help(both!("program this motion with inverse time (G93), which is shared out exactly; where the control's manual says what F counts, say it as `rotary_feed` in a copy of the grammar", "запрограммируйте это движение с обратным временем (G93), оно делится точно; если руководство стойки говорит, что считает F, укажите это как `rotary_feed` в копии таблицы диалекта")),
    ])
}

/// What F of G94 counts; `None` where no manual says.
fn counted(dialect: &Dialect, context: &Context) -> Option<RotaryFeed> {
    match context.kinematics {
        // Where the control leads the tip F is the tip's speed; what it counts while the tip stands nobody says.
        Kinematics::Tip => Some(RotaryFeed::LinearAxes),
        _ => dialect.output.rotary_feed,
    }
}

/// Minutes that a motion takes on which rotary axes turn, by an F of G94; `None` where nobody knows.
///
/// * `linear_mm`, `turned_deg` – its way, as [`Turned`] counts it
/// * `feed` – F in units of the program
pub(crate) fn minutes(
    dialect: &Dialect,
    context: &Context,
    [linear_mm, turned_deg]: [f64; 2],
    feed: f64,
) -> Option<f64> {
    let linear = linear_mm / context.unit_mm;
    let way = match dialect.output.rotary_feed.filter(|_| context.kinematics == Kinematics::Axes)? {
        RotaryFeed::LinearAxes if linear > 0.0 => linear,
        RotaryFeed::LinearAxes => turned_deg,
        RotaryFeed::AllAxes => units::math::hypot(linear, turned_deg),
    };
    (feed > 0.0 && way > 0.0).then(|| way / feed)
}

/// A motion told by the time that it takes as programmed, where that and the F in force are known.
fn by_time(
    dialect: &Dialect,
    modal: &Modal,
    turned: &Turned,
    block: &Block<'_>,
    context: &Context,
) -> Option<ByTime> {
    let LastFeed::PerMinute(feed, units) = modal.last_feed else { return None };
    let [inverse, speed] = [Action::FeedInverseTime, Action::FeedPerMinute]
        .map(|action| dialect.row_of(&action).map(|row| row.code));
    let minutes = minutes(dialect, context, [turned.programmed_mm, turned.turned_deg], feed.to_f64())?;
    let says =
        |wanted: Option<GCode>| block.words().any(|word| word.letter == b'G' && word.g_code() == wanted);
    // A block that may be skipped would leave its F behind; under cutter compensation no block may lie between.
    let stands_alone = block.switches() == 0 && modal.compensation == Compensation::Off;
    let by_time = ByTime { per_minute: 1.0 / minutes, inverse: inverse?, speed: speed?, feed };
    (stands_alone && !says(speed) && units.mm() == context.unit_mm).then_some(by_time)
}

/// True where a motion takes the same time by what F counts.
fn is_same(counts: RotaryFeed, turned: &Turned, unit_mm: f64) -> bool {
    let Turned { programmed_mm, commanded_mm, rounding_mm, turned_deg, .. } = *turned;
    let near = |a: f64, b: f64, rounding: f64| (a - b).abs() <= SAME_TIME * a + rounding;
    match counts {
        // Without a way of theirs F counts degrees, with one it does not.
        RotaryFeed::LinearAxes if programmed_mm == 0.0 => commanded_mm == 0.0,
        RotaryFeed::LinearAxes => near(programmed_mm, commanded_mm, rounding_mm) && commanded_mm > 0.0,
        RotaryFeed::AllAxes => {
            let all = |mm: f64| units::math::hypot(mm / unit_mm, turned_deg);
            near(all(programmed_mm), all(commanded_mm), rounding_mm / unit_mm)
        }
    }
}
