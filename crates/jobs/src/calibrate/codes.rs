//! Numbers of the messages of `calibrate`.

use calibration::CalibrationError;
use diagnostic::{Code, Speaks, Text, notice};

use machine_model::{Description, RigidBody};

use crate::message::Failure;

pub use measurement_files::codes::{AXES, CELL, OPEN, QUESTION, RUNS};

/// Numbers in another unit than they claim.
pub const UNITS: Code = Code(1102);
/// Measurements that cannot carry a correction.
pub const UNFIT: Code = Code(1103);
/// A reading that does not belong to the others.
pub const OUTLIER: Code = Code(1107);
/// Warning: runs or targets are missing.
pub const MISSING: Code = Code(1108);
/// Warning: the uncertainty is more than half of what it corrects.
pub const DOUBTFUL: Code = Code(1109);
/// Warning: something the profile should say is not known.
pub const UNSAID: Code = Code(1110);
/// Readings that contradict one another, the base, or every machine of this kind.
pub const CONTRADICTED: Code = Code(1113);

/// What to say of measurements that give no profile, and what to do.
pub(crate) fn failure(file: &str, bytes: &[u8], error: &CalibrationError) -> Failure {
    let said = match error {
        CalibrationError::Axes(_) => notice!(AXES; error.text();
            "compare axes, signs and order of the columns with what the message says; frames are right-handed",
            "сравните оси, знаки и порядок столбцов с тем, что сказано в сообщении; системы координат правые"
        ),
        CalibrationError::Units(_) => notice!(UNITS; error.text();
            "the column's name says its unit: convert the numbers or rename the column",
            "единица названа в имени столбца: пересчитайте числа или переименуйте столбец"
        ),
        CalibrationError::Runs(_) => notice!(RUNS; error.text();
            "every run must pass every target; leave an incomplete run out",
            "каждый проход проходит все цели; неполный исключите"
        ),
        CalibrationError::TooFew(_) => {
            notice!(OPEN; error.text(); "measure more points", "измерьте больше точек")
        }
        CalibrationError::Outlier { .. } => {
            notice!(OUTLIER; error.text(); "measure it again, or take the row out", "измерьте снова или уберите строку")
        }
        CalibrationError::Contradicted(_) => notice!(CONTRADICTED; error.text();
            "measure again what the message names, or leave it out",
            "измерьте названное в сообщении снова или исключите"
        ),
        CalibrationError::Unobservable(_) => notice!(OPEN; error.text();
            "measure where they differ: another tool length, other positions of the other axes",
            "измеряйте там, где они различаются: с другим вылетом инструмента, с другими положениями остальных осей"
        ),
    };
    if file.is_empty() {
        return Failure::unfit(said);
    }
    Failure::refused(file, bytes, vec![said])
}

/// The machine that a base describes.
pub(crate) fn body(description: &Description) -> Result<RigidBody, Failure> {
    RigidBody::new(description.clone()).map_err(|error| {
        Failure::usage(notice!(QUESTION; error.text();
            "run `vpost profile check` on the base", "запустите `vpost profile check` для исходного профиля"
        ))
    })
}

/// A question that stays open.
#[must_use]
pub fn question(message: Text, help: Text) -> Failure {
    Failure::asks(QUESTION, message, help)
}
