//! Refusals of drilling cycles.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) const IN_DRILLING_CYCLE: Refusal = refusal!(const codes::CYCLE_WORDS;
    "in a drilling cycle", "в цикле сверления";
    "counts holes on some controls, is another depth or nothing on others",
    "на одних стойках число отверстий, на других ещё одна глубина или ничего";
    "write each hole in a block of its own, or what the control's manual says as cycles.repeats in a copy of the grammar",
    "напишите каждое отверстие отдельным кадром или укажите сказанное в руководстве стойки как cycles.repeats в копии таблицы диалекта"
);

pub(crate) const K_AND_L_BOTH_COUNT: Refusal = refusal!(const codes::CYCLE_WORDS;
    "K and L both count repetitions", "и K, и L считают повторения";
    "which one?", "какое из двух?";
    "remove one of the two", "уберите одно из двух"
);

pub(crate) const REPEATED_ZERO_TIMES: Refusal = refusal!(const codes::CYCLE_WORDS;
    "a drilling cycle repeated zero times", "цикл сверления с нулём повторений";
    "an error on this control", "на этой стойке это ошибка";
    "write the words in the block of the first hole", "напишите эти слова в кадре первого отверстия"
);

pub(crate) const K_BESIDE_I_OR_J: Refusal = refusal!(const codes::CYCLE_WORDS;
    "K beside I or J in a drilling cycle", "K рядом с I или J в цикле сверления";
    "a count of holes, or the smallest peck? controls differ",
    "число отверстий или наименьший проход? у стоек по-разному";
    "write each hole in a block of its own, with its pecks as Q",
    "напишите каждое отверстие отдельным кадром, глубину прохода словом Q"
);

pub(crate) fn too_many_repetitions(count: impl Display, most: impl Display) -> Refusal {
    refusal!(codes::CYCLE_WORDS;
        "{count} repetitions of a drilling cycle", "число повторений цикла сверления: {count}";
        "at most {most}", "не больше {most}";
        "split the block", "разделите кадр"
    )
}

pub(crate) const DRILLING_CYCLE_UNDER_G93: Refusal = refusal!(const codes::INVERSE_TIME;
    "a drilling cycle under G93", "цикл сверления при G93";
    "no control feeds a cycle by inverse time", "ни одна стойка не ведёт цикл по обратному времени";
    "program G94 before it", "запрограммируйте перед ним G94"
);

pub(crate) const ROTARY_AXIS_TURNS_IN_CYCLE: Refusal = refusal!(const codes::SIMULTANEOUS;
    "a rotary axis turns in a drilling cycle", "в цикле сверления вращается поворотная ось";
    "turns here", "вращается здесь";
    "turn the rotary axis in a block of its own before the cycle", "поверните ось отдельным кадром до цикла"
);

pub(crate) fn cycle_under_frame(name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "a drilling cycle under {name}", "цикл сверления, пока действует {name:#}";
        "what becomes of its depth, pecks and shifts is told by no manual",
        "что станет с глубиной, проходами и сдвигами, не сказано ни в одном руководстве";
        "scale or mirror the holes in the CAM", "масштабируйте или отразите отверстия в CAM"
    )
}

pub(crate) const PECK_DEPTH_ZERO: Refusal = refusal!(const codes::CYCLE_WORDS;
    "a peck of depth zero", "проход нулевой глубины";
    "Q must not be 0", "Q не может быть 0";
    "write the depth of one peck", "напишите глубину одного прохода"
);

pub(crate) fn counted_from_unknown(depth: impl Display) -> Refusal {
    refusal!(codes::CYCLE_WORDS;
        "{depth} counts from an earlier R, or was written under another of G90 and G91: controls differ in what it means now",
        "{depth} отсчитано от прежнего R или написано при другой из G90 и G91; что оно значит теперь, у стоек по-разному";
        "R and {depth} are taken from an earlier block", "R и {depth} взяты из прежнего кадра";
        "write R and {depth} again in this block", "напишите R и {depth} заново в этом кадре"
    )
}

pub(crate) const LEVEL_BELOW_R: Refusal = refusal!(const codes::CYCLE_WORDS;
    "under G98 a hole begins at a level below its R", "при G98 отверстие начато с уровня ниже своего R";
    "controls return to that level, or to R: where the tool stands behind it is not certain",
    "стойки возвращают на этот уровень или на R: где инструмент окажется, неясно";
    "write G99, or bring the tool above R before the cycle",
    "напишите G99 или выведите инструмент выше R до цикла"
);

pub(crate) fn cycle_without(missing: impl Display) -> Refusal {
    refusal!(codes::CYCLE_INCOMPLETE;
        "the drilling cycle has no {missing}", "в цикле сверления нет {missing}";
        "{missing} was expected here or in an earlier block of this cycle",
        "{missing} ожидалось здесь или в прежнем кадре этого цикла";
        "write {missing} on the block that starts the cycle",
        "напишите {missing} в кадре, который начинает цикл"
    )
}
