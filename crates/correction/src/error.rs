//! Why a motion cannot be corrected.

use diagnostic::Speaks;
use machine_model::SolveError;

/// Why a motion cannot be corrected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CorrectionError {
    /// The model has no answer.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The motion would have to be split and must not be.
    #[error("{} and this motion must stay one block", off(*distance_um))]
    MustNotSplit {
        /// What one block would miss by, µm; infinite where there is none, as of an arc whose corrected ends no arc joins.
        distance_um: f64,
    },
    /// A hole that would be written as more moves than anybody drills.
    #[error("a hole of {pecks:.0} pecks, which would have to be written as moves")]
    TooManyPecks {
        /// Its depth by Q.
        pecks: f64,
    },
    /// Lost motion in a turned frame, where every word moves several axes, this way and that by its rounding.
    #[error(
        "in this rotated frame an axis with lost motion would go back and forth: {distance_um:.2} um off, the tolerance is {tolerance_um} um"
    )]
    TurnedFrame {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
    /// What lies across an axis changes when it turns, and that is too much to be hidden.
    #[error(
        "where an axis turns its lost motion moves the tool sideways: {distance_um:.2} um off however it is commanded, the tolerance is {tolerance_um} um"
    )]
    Sideways {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
    /// An axis that must not get a word would have to have one.
    #[error(
        "the tool would be {distance_um:.2} um off without a further word for {}, which the program has not named",
        toolpath::AXIS_NAMES[*axis]
    )]
    Unnamed {
        /// X, Y or Z by index.
        axis: usize,
        /// How far it is from where it should be, µm.
        distance_um: f64,
    },
    /// The model has bounds for rotary axes that stand only.
    #[error("the path cannot be proven while a rotary axis turns at feed rate")]
    NoBoundsForTurns,
    /// The rotary words of a piece cannot say its direction finely enough.
    #[error(
        "a split needs rotary words that turn the tool by {slip_urad:.1} urad away from its direction; {allowed_urad:.1} urad are allowed"
    )]
    Direction {
        /// By how much, µrad.
        slip_urad: f64,
        /// What was asked for, µrad.
        allowed_urad: f64,
    },
    /// The tool cannot be pointed where it shall finely enough.
    #[error(
        "the tool would point {leans_urad:.1} urad away from its direction; {allowed_urad:.1} urad are allowed"
    )]
    Leans {
        /// By how much, µrad.
        leans_urad: f64,
        /// What was asked for, µrad.
        allowed_urad: f64,
    },
    /// In a tilted plane the control knows the rotary angles by itself.
    #[error("the tool's direction cannot be corrected in a tilted plane")]
    DirectionInPlane,
    /// Splitting does not help: a jump of the model, or the shortest piece allowed.
    #[error(
        "the path would be {distance_um:.2} um off however short its pieces; the tolerance is {tolerance_um} um"
    )]
    NotWithinTolerance {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
}

impl CorrectionError {
    /// How far the path would be off, mm, where that is all that is wrong. What lost motion moves sideways is not: behind it the
    /// axes stand elsewhere than is reckoned with, and what comes then is off by more.
    pub(crate) fn off_mm(&self) -> Option<f64> {
        match self {
            Self::MustNotSplit { distance_um }
            | Self::Unnamed { distance_um, .. }
            | Self::NotWithinTolerance { distance_um, .. } => Some(1e-3 * distance_um),
            _ => None,
        }
    }
}

/// How far off one block would be, in words.
fn off(distance_um: f64) -> String {
    if distance_um.is_finite() {
        format!("the path would be {distance_um:.2} um off")
    } else {
        "no single arc leads from the corrected start to the corrected end".to_owned()
    }
}

impl Speaks for CorrectionError {
    fn russian(&self) -> String {
        match *self {
            Self::Solve(error) => error.russian(),
            Self::MustNotSplit { distance_um } if distance_um.is_finite() => {
                format!("путь отошёл бы на {distance_um:.2} мкм, а это движение делить нельзя")
            }
            Self::MustNotSplit { .. } => {
                "от исправленного начала к исправленному концу не ведёт ни одна дуга, а это движение делить нельзя"
                    .to_owned()
            }
            Self::TooManyPecks { pecks } => {
                format!("отверстие, где проходов {pecks:.0}, а записать его пришлось бы движениями")
            }
            Self::TurnedFrame { distance_um, tolerance_um } => format!(
                "в этой повёрнутой системе координат ось с люфтом ходила бы взад и вперёд: отклонение {distance_um:.2} мкм, допуск {tolerance_um} мкм"
            ),
            Self::Sideways { distance_um, tolerance_um } => format!(
                "при реверсе оси мёртвый ход сдвигает инструмент вбок: при любой команде остаётся {distance_um:.2} мкм, допуск {tolerance_um} мкм"
            ),
            Self::Unnamed { axis, distance_um } => format!(
                "инструмент отошёл бы на {distance_um:.2} мкм без слова {}, а программа эту ось не назвала",
                toolpath::AXIS_NAMES[axis]
            ),
            Self::NoBoundsForTurns => {
                "путь не доказать, пока поворотная ось вращается на рабочей подаче".to_owned()
            }
            Self::Direction { slip_urad, allowed_urad } => format!(
                "для деления нужны слова поворотных осей, которые отвернут инструмент от направления на {slip_urad:.1} мкрад; допускается {allowed_urad:.1} мкрад"
            ),
            Self::Leans { leans_urad, allowed_urad } => format!(
                "инструмент отклонился бы от направления на {leans_urad:.1} мкрад; допускается {allowed_urad:.1} мкрад"
            ),
            Self::DirectionInPlane => {
                "в наклонной плоскости направление инструмента не исправить".to_owned()
            }
            Self::NotWithinTolerance { distance_um, tolerance_um } => format!(
                "путь отошёл бы на {distance_um:.2} мкм при сколь угодно мелком делении; допуск {tolerance_um} мкм"
            ),
        }
    }
}
