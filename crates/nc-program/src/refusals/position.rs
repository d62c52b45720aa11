//! Refusals of where the axes stand.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn work_offset_rewritten(name: impl Display) -> Refusal {
    refusal!(codes::FRAME;
        "G10 wrote work offset {name} while it was in force",
        "G10 записала смещение нуля {name}, пока оно действовало";
        "in force at once or not? controls differ", "действует ли сразу? у стоек по-разному";
        "write {name} again after the G10 block", "напишите {name} снова после кадра G10"
    )
}

pub(crate) const NO_WORK_OFFSET_IN_FORCE: Refusal = refusal!(const codes::WORK_OFFSET;
    "no work offset is in force", "не действует ни одно смещение нуля";
    "coordinates of which zero?", "координаты от какого нуля?";
    "program G54 before the first motion and give it with `--work-offset G54=X,Y,Z`",
    "запрограммируйте G54 до первого движения и задайте его ключом `--work-offset G54=X,Y,Z`"
);

pub(crate) fn cannot_be_resolved(letters: &str) -> Refusal {
    refusal!(codes::SECONDARY_AXIS;
        "{letters} cannot be resolved", "{letters}: как это понимать, неизвестно";
        "an increment on some controls, an axis on others",
        "на одних стойках приращение, на других отдельная ось";
        "program X, Y, Z instead (with G91 for increments)",
        "пишите вместо этого X, Y, Z (для приращений при G91)"
    )
}

pub(crate) fn no_such_axis(name: impl Display, rotary_names: &Text) -> Refusal {
    refusal!(codes::NO_SUCH_AXIS;
        "the machine has no axis {name}", "на станке нет оси {name}";
        "rotary axes of the profile's chain: {rotary_names}",
        "поворотные оси в цепи профиля: {rotary_names:#}";
        "name {name} in `chain` of the profile, or remove the word",
        "назовите {name} в `chain` профиля или уберите слово"
    )
}
