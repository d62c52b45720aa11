//! Refusals of contours.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both, refusal};

use crate::codes;

pub(crate) const Q_BEFORE_P: Refusal = contour(
    Text::pair("the block of Q stands before the block of P", "кадр Q стоит раньше кадра P"),
    Text::pair("Q ends the contour", "Q завершает контур"),
);

pub(crate) const BEGINS_WITHOUT_MOVE: Refusal = contour(
    Text::pair("the contour does not begin with a move", "контур не начинается с движения"),
    Text::pair(
        "G0 or G1 with X or Z was expected in the block of P",
        "в кадре P ожидалось G0 или G1 с X или Z",
    ),
);

pub(crate) const RAPID_WITHIN_CONTOUR: Refusal = contour(
    Text::pair("a rapid within the contour", "быстрый ход внутри контура"),
    Text::pair(
        "feeds were expected, rapids behind the last of them only",
        "ожидались рабочие ходы, быстрые — только после последнего из них",
    ),
);

pub(crate) const BEGINS_WITHOUT_G0_OR_G1: Refusal = contour(
    Text::pair("the contour does not begin with G0 or G1", "контур не начинается с G0 или G1"),
    Text::pair("the block of P must say which", "кадр P должен сказать, с какой"),
);

pub(crate) const LEADS_TO_UNKNOWN_PLACE: Refusal = contour(
    Text::pair("where the contour leads here is not known", "неизвестно, куда здесь ведёт контур"),
    Text::pair("another frame, or above 400 km", "другая система координат или больше 400 км"),
);

pub(crate) const ENDS_WHERE_IT_BEGINS: Refusal = contour(
    Text::pair("the contour ends where it begins", "контур кончается там, где начинается"),
    Text::pair("one move only leads to it", "к нему ведёт одно движение"),
);

pub(crate) fn cycle_without(name: impl Display) -> Refusal {
    contour(
        both!("a cycle without {name}", "цикл без {name}"),
        both!("P and Q name the blocks of its contour", "P и Q называют кадры его контура"),
    )
}

pub(crate) fn no_such_block(number: impl Display, name: impl Display) -> Refusal {
    contour(
        both!("no block N{number} for {name} of the cycle", "нет кадра N{number} для {name} цикла"),
        both!("this program has none", "в этой программе его нет"),
    )
}

pub(crate) fn two_such_blocks(number: impl Display, name: impl Display) -> Refusal {
    contour(
        both!("two blocks N{number} for {name} of the cycle", "два кадра N{number} для {name} цикла"),
        both!("which of the two?", "какой из двух?"),
    )
}

pub(crate) fn within_contour(code: &str) -> Refusal {
    refusal!(codes::CONTOUR;
        "{code} within a contour", "{code} внутри контура";
        "whether roughing heeds it controls differ", "учитывает ли её черновая обработка, у стоек по-разному";
        "write `contour_compensation = \"finishing\"` under `[program]` in the profile where it may hold in G70 \
                             alone: roughing then leaves its allowance at the tip as programmed",
        "впишите `contour_compensation = \"finishing\"` в раздел `[program]` профиля, если она действует только в G70: тогда черновая обработка оставляет припуск от запрограммированной вершины"
    )
}

pub(crate) fn turns_back(name: impl Display, cycle: impl Display, here: f64) -> Refusal {
    contour(
        both!(
            "the contour turns back along {name} (cycle `{cycle}`)",
            "контур возвращается назад по {name} (цикл `{cycle}`)"
        ),
        both!("by {here:.4} in this block", "на {here:.4} в этом кадре"),
    )
}

pub(crate) fn word_on_a_line(text: impl Display) -> Refusal {
    refusal!(codes::CONTOUR;
        "{text} on a line of a contour", "{text} на прямой контура";
        "a corner, by a parameter of the control (3405.4)", "сопряжение по параметру стойки (3405.4)";
        "write `drawing_words = \"plain\"` under `[program]` in the profile where A, C and R of lines are angles, chamfers and \
             roundings without a comma, or remove it",
        "впишите `drawing_words = \"plain\"` в раздел `[program]` профиля, если A, C и R прямых без запятой — углы, фаски и \
             скругления, или уберите слово"
    )
}

pub(crate) fn rises_beyond_start(value: f64) -> Refusal {
    contour(
        both!(
            "the contour rises beyond the start of its cycle",
            "контур поднимается выше начала своего цикла"
        ),
        both!(
            "the tool would go across it in a rapid, {value:.4} too low",
            "инструмент прошёл бы его на быстром ходу слишком низко, на {value:.4}"
        ),
    )
}

pub(crate) fn allowance_with_pockets(name: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "an allowance {name} on a contour with pockets", "припуск {name} на контуре с карманами";
        "it moves one wall of each pocket into the finished contour",
        "он сдвигает одну из стенок кармана внутрь готового контура";
        "write {name}0 in this block", "напишите {name}0 в этом кадре"
    )
}

pub(crate) fn allowance_into_workpiece(name: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "an allowance {name} that leads into the workpiece", "припуск {name} направлен в деталь";
        "roughing would cut below the finished contour", "черновая обработка зарезала бы готовый контур";
        "change its sign", "смените его знак"
    )
}

/// A contour that cannot be cut as it stands.
pub(crate) const fn contour(message: Text, label: Text) -> Refusal {
    refusal!(const codes::CONTOUR; message; label;
        "write the contour between N of P and N of Q, or let the CAM write the moves",
        "напишите контур между кадрами N из P и N из Q или выводите движения из CAM"
    )
}

pub(crate) const CONTOUR_ELSEWHERE: Refusal = contour(
    Text::pair("the contour does not stand behind its cycle", "контур стоит не после своего цикла"),
    Text::pair(
        "where the program goes on behind the cycle is certain only there",
        "только там ясно, откуда программа продолжится после цикла",
    ),
);

pub(crate) const COMPENSATION_WITHOUT_FINISHING: Refusal = contour(
    Text::pair(
        "compensation of the nose in a contour that no G70 finishes",
        "коррекция на радиус при вершине в контуре, который не обрабатывает ни одна G70",
    ),
    Text::pair(
        "it would hold nowhere: roughing leaves it out here",
        "она нигде бы не действовала: черновая обработка здесь её не учитывает",
    ),
);

pub(crate) fn cycle_without_p_and_q(letter: impl Display) -> Refusal {
    contour(
        both!("a cycle without P and Q", "цикл без P и Q"),
        both!(
            "{letter} is of the block that cuts: which contour?",
            "{letter} относится к кадру, который режет: какой контур?"
        ),
    )
}

pub(crate) fn begins_without_infeed(name: impl Display) -> Refusal {
    contour(
        both!("the contour does not begin with the infeed", "контур не начинается с врезания"),
        both!(
            "a move along {name} was expected in the block of P, and a way along the other axis behind it",
            "в кадре P ожидался ход вдоль {name}, а дальше — путь вдоль другой оси"
        ),
    )
}

pub(crate) const BEHIND_ITS_FINISHING: Refusal = contour(
    Text::pair("the contour stands behind its finishing", "контур стоит после своей чистовой обработки"),
    Text::pair(
        "whether the control makes it once more is not certain",
        "пройдёт ли стойка его ещё раз, неясно",
    ),
);

pub(crate) const VALUES_ASSIGNED_ANEW: Refusal = contour(
    Text::pair("a contour with values that are assigned anew", "контур, значения которого присвоены заново"),
    Text::pair(
        "finishing reads it once more, with the values of then: here it stands with those of before",
        "чистовая обработка прочтёт его ещё раз, с новыми значениями; здесь стоят прежние",
    ),
);

pub(crate) const COMPENSATION_STAYS: Refusal = contour(
    Text::pair("compensation is in force behind the contour", "после контура действует коррекция"),
    Text::pair(
        "the way back to the start of the cycle would be compensated",
        "она действовала бы на возврате к началу цикла",
    ),
);
