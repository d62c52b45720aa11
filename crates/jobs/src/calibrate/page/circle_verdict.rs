//! What the circles of a plane say first.

use calibration::circular_test::{Cause, CircularTest, Pattern};
use diagnostic::{Text, both};
use report::numbers::digits;

use super::bars::{cause_name, um};

/// Gaps wider than this are told: the circle was not closed, degrees.
pub(super) const CLOSED_DEG: f64 = 15.0;

/// What the circles of a plane say first.
pub(super) enum Verdict<'t> {
    /// They are no whole circles: sizes of causes count what was read.
    Open { degrees: f64 },
    /// More than any cause makes is explained by none.
    Unexplained,
    /// The largest cause.
    Named(&'t Pattern),
}

impl<'t> Verdict<'t> {
    pub(super) fn of(test: &'t CircularTest) -> Self {
        let gap_deg = test.traces.iter().map(|t| t.gap_rad.to_degrees()).fold(0.0, f64::max);
        if gap_deg > CLOSED_DEG {
            return Self::Open { degrees: 360.0 - gap_deg };
        }
        match test.patterns.first() {
            Some(p) if p.range_mm > p.half_width_95_mm && p.range_mm > test.left_mm => Self::Named(p),
            _ => Self::Unexplained,
        }
    }

    pub(super) fn word(&self) -> Text {
        match self {
            Self::Open { .. } => both!("PARTIAL CIRCLE", "НЕПОЛНАЯ ОКРУЖНОСТЬ"),
            Self::Unexplained => both!("NO CAUSE", "НЕТ ПРИЧИНЫ"),
            Self::Named(p) => match p.cause {
                Cause::Squareness => both!("SQUARENESS", "ПЕРПЕНДИКУЛЯРНОСТЬ"),
                Cause::Mismatch => both!("SCALE MISMATCH", "РАЗНЫЙ МАСШТАБ"),
                Cause::Backlash(_) => both!("BACKLASH", "ЛЮФТ"),
            },
        }
    }

    /// Behind the size of the deviation.
    pub(super) fn goes_on(&self, plane: usize) -> Text {
        match self {
            Self::Open { degrees } => {
                both!(" over the {} degrees that were read", " на измеренных {:#}°", digits(*degrees, 0))
            }
            Self::Unexplained => {
                both!("; no cause explains most of it", "; большей части не объясняет ни одна причина")
            }
            Self::Named(p) => {
                let (cause, size, half) =
                    (cause_name(p.cause, plane), um(p.range_mm), um(p.half_width_95_mm));
                both!(
                    "; the largest cause, {cause}, makes {size} \u{b5}m (\u{b1} {half}, 95\u{a0}%)",
                    "; главная причина, {cause:#}, даёт {size:#} мкм (\u{b1} {half:#}, 95\u{a0}%)"
                )
            }
        }
    }

    /// What to do.
    pub(super) fn remedy(&self) -> Text {
        match self {
            Self::Open { .. } => Text::pair(
                "Read whole circles before judging by the sizes of the causes: part of a circle lies about a circle of its own.",
                "Прежде чем судить по величине причин, снимите полные окружности: часть окружности ложится на свою собственную.",
            ),
            Self::Unexplained => Text::pair(
                "Read circles both ways round with the direction of every reading, and look at straightness, pitch of the screws and servo: a bar that sees none of squareness, scale and backlash sees one of those, or its own noise.",
                "Снимите окружности в обе стороны с направлением каждого отсчёта и проверьте прямолинейность, шаг винтов и приводы: если измеритель не видит ни перпендикулярности, ни масштаба, ни люфта, он видит одно из этого или собственный шум.",
            ),
            Self::Named(p) => match p.cause {
                Cause::Squareness => Text::pair(
                    "Align the axes, or correct by a profile: a squareness stays what it is until something is moved.",
                    "Выверьте оси или исправляйте по профилю: отклонение от перпендикулярности не меняется, пока ничего не сдвинуто.",
                ),
                Cause::Mismatch => Text::pair(
                    "A bar does not say which of the two axes is too long: measure the positioning of both with an interferometer before correcting.",
                    "Которая из двух осей длиннее, измеритель не говорит: прежде чем исправлять, измерьте позиционирование обеих интерферометром.",
                ),
                Cause::Backlash(_) => Text::pair(
                    "Look at nut, bearings and the control's own backlash value first; what repeats of it a profile corrects.",
                    "Сначала проверьте гайку, подшипники и значение люфта в самом ЧПУ; то, что повторяется, исправит профиль.",
                ),
            },
        }
    }
}
