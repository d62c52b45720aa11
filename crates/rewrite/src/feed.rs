//! Whether F still means the programmed speed where rotary axes turn.
//!
//! Under G93 it does: time is shared out. Under G94 and G95 controls differ in what F counts. Where linear axes that were
//! to stand have to follow a crooked rotary axis, or go another way than programmed, a block could take another time.

use correction::Turned;
use diagnostic::{Diagnostic, both};
use nc_program::Context;
use nc_syntax::Block;
use nc_syntax::dialect::{Dialect, RotaryFeed};
use toolpath::{Feed, FeedRate, Motion};

use crate::job::ROTARY_FEED;

/// By no more than this part of itself a motion may take another time.
const SAME_TIME: f64 = 0.1;

/// Refuses a motion that would take another time than programmed, or nobody knows.
pub(crate) fn require_same(
    dialect: &Dialect,
    turned: &Turned,
    motion: &Motion,
    block: &Block<'_>,
    context: &Context,
) -> Result<(), Vec<Diagnostic>> {
    if matches!(motion, Motion::Feed(Feed { rate: FeedRate::InverseTime(_), .. })) {
        return Ok(());
    }
    let readings = match dialect.output.rotary_feed {
        Some(counts) => [counts; 2],
        None => [RotaryFeed::LinearAxes, RotaryFeed::AllAxes],
    };
    if readings.iter().all(|counts| is_same(*counts, turned, context.unit_mm)) {
        return Ok(());
    }
    let whole = block.file_range();
    let message = both!(
        "while a rotary axis turns the linear axes have to go {:.4} mm instead of {:.4} mm, and F would be another speed",
        "пока вращается поворотная ось, линейным осям надо пройти {:.4} мм вместо {:.4} мм, и F стало бы другой скоростью",
        turned.commanded_mm,
        turned.programmed_mm
    );
    let label = match dialect.output.rotary_feed {
        Some(_) => both!("F counts their way here", "F считает здесь их путь"),
        None => both!(
            "F may count their way; what it counts is not known of this control",
            "F, возможно, считает их путь; что оно считает на этой стойке, неизвестно"
        ),
    };
    Err(vec![
        Diagnostic::error(ROTARY_FEED, message)
            .at(whole, label)
            .help(both!("program this motion with inverse time (G93), which is shared out exactly; where the control's manual says what F counts, say it as `rotary_feed` in a copy of the grammar", "запрограммируйте это движение с обратным временем (G93), оно делится точно; если руководство стойки говорит, что считает F, укажите это как `rotary_feed` в копии таблицы диалекта")),
    ])
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
