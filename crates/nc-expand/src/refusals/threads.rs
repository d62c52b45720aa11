//! Refusals of threads.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both};

use crate::codes;

pub(crate) const THREAD_WITH_TAPERED_ENDS: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("a thread with tapered ends", "резьба с коническими концами"),
    label: Text::pair("each end is a thread of another lead", "каждый конец — резьба с другим ходом"),
    help: Text::pair(
        "leave L and E out, or let the CAM write the passes",
        "уберите L и E или выводите проходы из CAM",
    ),
};

pub(crate) fn tip_angle(tip_deg: impl Display) -> Refusal {
    Refusal {
        code: codes::TURNING_CYCLE,
        message: both!("a tip of {tip_deg} degrees", "угол вершины {tip_deg} градусов"),
        label: both!("0 to 120 were expected", "ожидалось от 0 до 120"),
        help: both!("correct A", "исправьте A"),
    }
}

pub(crate) const FIRST_BLOCK_WITHOUT_SETTINGS: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("the first block of a thread without P, Q or R", "первый кадр резьбы без P, Q или R"),
    label: Text::pair(
        "what it leaves out parameters of the control say",
        "опущенное задают параметры стойки",
    ),
    help: Text::pair(
        "write all of them, as in `G76 P020000 Q100 R0.05`",
        "напишите их все, например `G76 P020000 Q100 R0.05`",
    ),
};

pub(crate) const THREAD_WITHOUT_ITS_WORDS: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("a thread without P, Z, I, J or K", "резьба без P, Z, I, J или K"),
    label: Text::pair(
        "lead, end, crest, first infeed and height were expected",
        "ожидались ход, конец, вершина профиля, первое врезание и высота",
    ),
    help: Text::pair(
        "write all of them, as in `G76 P1.5 Z-20 I-2 J0.6 K1.84`",
        "напишите их все, например `G76 P1.5 Z-20 I-2 J0.6 K1.84`",
    ),
};

pub(crate) const NUMBER_OF_SPRING_PASSES: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("a number of spring passes that is none", "неверное число зачистных проходов"),
    label: Text::pair("H counts passes", "H считает проходы"),
    help: Text::pair("write a whole number", "напишите целое число"),
};

pub(crate) const PASSES_NOT_CERTAIN: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair(
        "a thread of several passes that is not certain",
        "многопроходная резьба, о которой не всё известно",
    ),
    label: Text::pair(
        "expected G90, Z below the start, J above 0 and no more than K, I other than 0, R from 1, Q from 0 to 80",
        "ожидались G90, Z ниже начала, J больше 0 и не больше K, I не 0, R от 1, Q от 0 до 80",
    ),
    help: Text::pair(
        "correct these words, or let the CAM write the passes",
        "исправьте эти слова или выводите проходы из CAM",
    ),
};

pub(crate) const TOO_MANY_PASSES: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("more than 1000 passes", "больше 1000 проходов"),
    label: Text::pair("the first infeed is too small", "первое врезание слишком мало"),
    help: Text::pair("correct J and R", "исправьте J и R"),
};

pub(crate) const WITHOUT_FIRST_BLOCK: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair(
        "a thread of several passes without its first block",
        "многопроходная резьба без первого кадра",
    ),
    label: Text::pair(
        "finishing passes, chamfer, angle and infeeds are parameters of the control then",
        "чистовые проходы, сбег, угол и врезания — тогда параметры стойки",
    ),
    help: Text::pair(
        "write the first block, as in `G76 P020000 Q100 R0.05`",
        "напишите первый кадр, например `G76 P020000 Q100 R0.05`",
    ),
};

pub(crate) const END_NOT_KNOWN: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("where the thread ends is not known", "неизвестно, где кончается резьба"),
    label: Text::pair("X and Z were expected", "ожидались X и Z"),
    help: Text::pair("write X and Z", "напишите X и Z"),
};

pub(crate) const THREAD_WITHOUT_LEAD: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("a thread without its lead", "резьба без хода"),
    label: Text::pair("F was expected", "ожидалось F"),
    help: Text::pair("write F, the lead, in this block", "напишите F — ход резьбы — в этом кадре"),
};

pub(crate) const STARTS_WITHIN_ITS_HEIGHT: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair(
        "a thread that starts within its own height",
        "резьба начинается внутри собственной высоты",
    ),
    label: Text::pair(
        "between start and root there is less than the height",
        "между началом и впадиной меньше, чем высота",
    ),
    help: Text::pair(
        "start it further out, or correct X, Z, R and P",
        "начните дальше от детали или исправьте X, Z, R и P",
    ),
};

pub(crate) const TOO_MANY_INFEEDS: Refusal = Refusal {
    code: codes::TURNING_CYCLE,
    message: Text::pair("more than 1000 passes", "больше 1000 проходов"),
    label: Text::pair("the infeeds are too small", "врезания слишком малы"),
    help: Text::pair("correct Q of both blocks", "исправьте Q обоих кадров"),
};

pub(crate) fn thread_without_height([height, infeed]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::TURNING_CYCLE,
        message: both!(
            "a thread without its height or its first infeed",
            "резьба без высоты или без первого врезания"
        ),
        label: both!(
            "{height} and {infeed} above zero were expected",
            "ожидались {height} и {infeed} больше нуля"
        ),
        help: both!(
            "write the height of the thread and the first infeed, both of the radius",
            "напишите высоту резьбы и первое врезание, оба по радиусу"
        ),
    }
}
