//! Refusals of subroutines of contours.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both, refusal};

use crate::codes;

pub(crate) fn beside_cycle(letter: char) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "{letter} beside this cycle", "{letter} рядом с этим циклом";
        "the interpreter takes it for an axis that a lathe does not have",
        "интерпретатор принимает его за ось, которой у токарного станка нет";
        "write the distance that stays as D", "напишите остающийся припуск словом D"
    )
}

pub(crate) const ENDS_WHERE_IT_BEGINS: Refusal = routine(
    Text::pair("the contour ends where it begins", "контур кончается там, где начинается"),
    Text::pair("one move only leads to it", "к нему ведёт одно движение"),
);

pub(crate) fn within_contour(text: impl Display) -> Refusal {
    routine(
        both!("{text} within a contour", "{text} внутри контура"),
        both!(
            "the interpreter reads the contour and executes none of its codes but G0 to G3",
            "интерпретатор читает контур и из его функций исполняет только G0–G3"
        ),
    )
}

pub(crate) const CYCLE_UNDER_OTHER_MODES: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle outside G18 G90 G91.1 and G94 or G95", "цикл вне G18 G90 G91.1 и G94 или G95";
    "the interpreter starts in G17, and takes it in G18 and G90 alone",
    "интерпретатор начинает с G17, а цикл принимает только при G18 и G90";
    "write `G18 G90 G91.1` in a block before it", "напишите кадром раньше `G18 G90 G91.1`"
);

pub(crate) const DISTANCE_THAT_IS_NONE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a distance, a depth or a number of passes that is none", "неверный припуск, глубина или число проходов";
    "expected D and R from 0, I above 0, P from 1 to 1000",
    "ожидались D и R от 0, I больше 0, P от 1 до 1000";
    "correct these words", "исправьте эти слова"
);

pub(crate) const ARC_WITHOUT_END: Refusal = routine(
    Text::pair("an arc without an end", "дуга без конечной точки"),
    Text::pair("the interpreter leaves it out of the contour", "интерпретатор не берёт её в контур"),
);

pub(crate) const LEADS_TO_UNKNOWN_PLACE: Refusal = routine(
    Text::pair("where the contour leads here is not known", "неизвестно, куда здесь ведёт контур"),
    Text::pair("another frame, or above 400 km", "другая система координат или больше 400 км"),
);

pub(crate) const BEGINS_WITHOUT_G0_OR_G1: Refusal = routine(
    Text::pair("the contour does not begin with G0 or G1", "контур не начинается с G0 или G1"),
    Text::pair(
        "its first block leads to it from the start of the cycle",
        "его первый кадр ведёт к нему от начала цикла",
    ),
);

pub(crate) const ARC_WITHOUT_G3: Refusal = routine(
    Text::pair("an arc without its G3", "дуга без своей G3"),
    Text::pair(
        "in a contour the interpreter takes it for G2",
        "внутри контура интерпретатор принимает её за G2",
    ),
);

pub(crate) const ARC_WHOSE_R_NOT_CERTAIN: Refusal = routine(
    Text::pair("an arc whose R is not certain", "дуга, у которой R не даёт верного центра"),
    Text::pair(
        "its sign is not heeded, and at half a circle and below there is no centre",
        "знак не учитывается, а при полуокружности и меньше центра нет",
    ),
);

/// A subroutine of a contour that the interpreter would take otherwise, or not at all.
pub(crate) const fn routine(message: Text, label: Text) -> Refusal {
    refusal!(const codes::CONTOUR; message; label;
        "correct the subroutine of the contour, or let the CAM write the moves",
        "исправьте подпрограмму контура или выводите движения из CAM"
    )
}

/// * `number` – that of Q
pub(crate) fn without_subroutine(number: Option<f64>) -> Refusal {
    let message = match number {
        Some(number) => {
            both!("no subroutine O{number} before this block", "до этого кадра нет подпрограммы O{number}")
        }
        None => both!("a cycle without Q", "цикл без Q"),
    };
    refusal!(codes::CONTOUR; message;
        "Q is the number of the contour's subroutine", "Q — номер подпрограммы контура";
        "write the contour before the cycle, as `O100 SUB` … `O100 ENDSUB`, and its number as Q100",
        "напишите контур до цикла, как `O100 SUB` … `O100 ENDSUB`, а его номер — как Q100"
    )
}
