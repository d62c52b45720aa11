//! Refusals of directions of the tool.

use diagnostic::{Refusal, refusal};

use crate::codes;

pub(crate) fn under_g43_5(letters: &str) -> Refusal {
    refusal!(codes::DIRECTION_WORDS;
        "{letters} under G43.5", "{letters} при G43.5";
        "the control takes directions as vectors here", "стойка принимает здесь направления векторами";
        "write I, J and K, or G43.4 for rotary words", "напишите I, J и K или G43.4 для слов поворотных осей"
    )
}

pub(crate) const ARC_UNDER_G43_5: Refusal = refusal!(const codes::DIRECTION_WORDS;
    "an arc under G43.5", "дуга при G43.5";
    "are I, J, K its centre or the tool's direction?", "I, J, K — её центр или направление инструмента?";
    "let the CAM write lines", "выводите из CAM прямые"
);

pub(crate) fn direction_beside(letters: &str) -> Refusal {
    refusal!(codes::DIRECTION_WORDS;
        "a direction beside {letters}", "направление рядом с {letters}";
        "two answers to where the tool points", "два ответа на вопрос, куда направлен инструмент";
        "leave one of the two", "оставьте что-то одно"
    )
}

pub(crate) const DIRECTION_WITHOUT_TIP_CONTROL: Refusal = refusal!(const codes::DIRECTION_WORDS;
    "a direction without tool centre point control", "направление без управления по вершине инструмента";
    "the control makes angles of it under TRAORI only", "углы из него стойка получает только при TRAORI";
    "write TRAORI before it, or the rotary axes themselves",
    "напишите перед ним TRAORI или сами поворотные оси"
);

pub(crate) const DIRECTION_WITHOUT_LINE: Refusal = refusal!(const codes::DIRECTION_WORDS;
    "a direction in a block that is no line", "направление в кадре, который не прямая";
    "what the tool does meanwhile is not certain", "что инструмент делает тем временем, неясно";
    "let the CAM write lines", "выводите из CAM прямые"
);

pub(crate) const DIRECTION_OF_NO_LENGTH: Refusal = refusal!(const codes::NO_DIRECTION;
    "a direction of no length", "направление нулевой длины";
    "the tool points nowhere", "инструмент никуда не направлен";
    "write the vector from the tip up the tool, as I0. J0. K1.",
    "напишите вектор от вершины вдоль инструмента, например I0. J0. K1."
);
