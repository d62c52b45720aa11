//! Refusals of directions of the tool.

use diagnostic::{Refusal, Text, both};

use crate::codes;

pub(crate) fn under_g43_5(letters: &str) -> Refusal {
    Refusal {
        code: codes::DIRECTION_WORDS,
        message: both!("{letters} under G43.5", "{letters} при G43.5"),
        label: both!(
            "the control takes directions as vectors here",
            "стойка принимает здесь направления векторами"
        ),
        help: both!(
            "write I, J and K, or G43.4 for rotary words",
            "напишите I, J и K или G43.4 для слов поворотных осей"
        ),
    }
}

pub(crate) const ARC_UNDER_G43_5: Refusal = Refusal {
    code: codes::DIRECTION_WORDS,
    message: Text::pair("an arc under G43.5", "дуга при G43.5"),
    label: Text::pair(
        "are I, J, K its centre or the tool's direction?",
        "I, J, K — её центр или направление инструмента?",
    ),
    help: Text::pair("let the CAM write lines", "выводите из CAM прямые"),
};

pub(crate) fn direction_beside(letters: &str) -> Refusal {
    Refusal {
        code: codes::DIRECTION_WORDS,
        message: both!("a direction beside {letters}", "направление рядом с {letters}"),
        label: both!(
            "two answers to where the tool points",
            "два ответа на вопрос, куда направлен инструмент"
        ),
        help: both!("leave one of the two", "оставьте что-то одно"),
    }
}

pub(crate) const DIRECTION_WITHOUT_TIP_CONTROL: Refusal = Refusal {
    code: codes::DIRECTION_WORDS,
    message: Text::pair(
        "a direction without tool centre point control",
        "направление без управления по вершине инструмента",
    ),
    label: Text::pair(
        "the control makes angles of it under TRAORI only",
        "углы из него стойка получает только при TRAORI",
    ),
    help: Text::pair(
        "write TRAORI before it, or the rotary axes themselves",
        "напишите перед ним TRAORI или сами поворотные оси",
    ),
};

pub(crate) const DIRECTION_WITHOUT_LINE: Refusal = Refusal {
    code: codes::DIRECTION_WORDS,
    message: Text::pair("a direction in a block that is no line", "направление в кадре, который не прямая"),
    label: Text::pair(
        "what the tool does meanwhile is not certain",
        "что инструмент делает тем временем, неясно",
    ),
    help: Text::pair("let the CAM write lines", "выводите из CAM прямые"),
};

pub(crate) const DIRECTION_OF_NO_LENGTH: Refusal = Refusal {
    code: codes::NO_DIRECTION,
    message: Text::pair("a direction of no length", "направление нулевой длины"),
    label: Text::pair("the tool points nowhere", "инструмент никуда не направлен"),
    help: Text::pair(
        "write the vector from the tip up the tool, as I0. J0. K1.",
        "напишите вектор от вершины вдоль инструмента, например I0. J0. K1.",
    ),
};
