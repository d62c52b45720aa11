//! Refusals of threads.

use std::fmt::Display;

use diagnostic::{Refusal, refusal};

use crate::codes;

pub(crate) const THREAD_WITH_TAPERED_ENDS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread with tapered ends", "резьба с коническими концами";
    "each end is a thread of another lead", "каждый конец — резьба с другим ходом";
    "leave L and E out, or let the CAM write the passes", "уберите L и E или выводите проходы из CAM"
);

pub(crate) fn tip_angle(tip_deg: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a tip of {tip_deg} degrees", "угол вершины {tip_deg} градусов";
        "0 to 120 were expected", "ожидалось от 0 до 120";
        "correct A", "исправьте A"
    )
}

pub(crate) const FIRST_BLOCK_WITHOUT_SETTINGS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "the first block of a thread without P, Q or R", "первый кадр резьбы без P, Q или R";
    "what it leaves out parameters of the control say", "опущенное задают параметры стойки";
    "write all of them, as in `G76 P020000 Q100 R0.05`", "напишите их все, например `G76 P020000 Q100 R0.05`"
);

pub(crate) const THREAD_WITHOUT_ITS_WORDS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread without P, Z, I, J or K", "резьба без P, Z, I, J или K";
    "lead, end, crest, first infeed and height were expected",
    "ожидались ход, конец, вершина профиля, первое врезание и высота";
    "write all of them, as in `G76 P1.5 Z-20 I-2 J0.6 K1.84`",
    "напишите их все, например `G76 P1.5 Z-20 I-2 J0.6 K1.84`"
);

pub(crate) const NUMBER_OF_SPRING_PASSES: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a number of spring passes that is none", "неверное число зачистных проходов";
    "H counts passes", "H считает проходы";
    "write a whole number", "напишите целое число"
);

pub(crate) const PASSES_NOT_CERTAIN: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread of several passes that is not certain", "многопроходная резьба, о которой не всё известно";
    "expected G90, Z below the start, J above 0 and no more than K, I other than 0, R from 1, Q from 0 to 80",
    "ожидались G90, Z ниже начала, J больше 0 и не больше K, I не 0, R от 1, Q от 0 до 80";
    "correct these words, or let the CAM write the passes", "исправьте эти слова или выводите проходы из CAM"
);

pub(crate) const TOO_MANY_PASSES: Refusal = refusal!(const codes::TURNING_CYCLE;
    "more than 1000 passes", "больше 1000 проходов";
    "the first infeed is too small", "первое врезание слишком мало";
    "correct J and R", "исправьте J и R"
);

pub(crate) const WITHOUT_FIRST_BLOCK: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread of several passes without its first block", "многопроходная резьба без первого кадра";
    "finishing passes, chamfer, angle and infeeds are parameters of the control then",
    "чистовые проходы, сбег, угол и врезания — тогда параметры стойки";
    "write the first block, as in `G76 P020000 Q100 R0.05`",
    "напишите первый кадр, например `G76 P020000 Q100 R0.05`"
);

pub(crate) const END_NOT_KNOWN: Refusal = refusal!(const codes::TURNING_CYCLE;
    "where the thread ends is not known", "неизвестно, где кончается резьба";
    "X and Z were expected", "ожидались X и Z";
    "write X and Z", "напишите X и Z"
);

pub(crate) const THREAD_WITHOUT_LEAD: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread without its lead", "резьба без хода";
    "F was expected", "ожидалось F";
    "write F, the lead, in this block", "напишите F — ход резьбы — в этом кадре"
);

pub(crate) const STARTS_WITHIN_ITS_HEIGHT: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread that starts within its own height", "резьба начинается внутри собственной высоты";
    "between start and root there is less than the height", "между началом и впадиной меньше, чем высота";
    "start it further out, or correct X, Z, R and P", "начните дальше от детали или исправьте X, Z, R и P"
);

pub(crate) const TOO_MANY_INFEEDS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "more than 1000 passes", "больше 1000 проходов";
    "the infeeds are too small", "врезания слишком малы";
    "correct Q of both blocks", "исправьте Q обоих кадров"
);

pub(crate) fn thread_without_height([height, infeed]: [char; 2]) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a thread without its height or its first infeed", "резьба без высоты или без первого врезания";
        "{height} and {infeed} above zero were expected", "ожидались {height} и {infeed} больше нуля";
        "write the height of the thread and the first infeed, both of the radius",
        "напишите высоту резьбы и первое врезание, оба по радиусу"
    )
}
