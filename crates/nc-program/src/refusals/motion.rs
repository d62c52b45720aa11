//! Refusals of motions.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn move_under_transform(code: &str, name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "{code} under {name}", "{code}, пока действует {name:#}";
        "controls forbid it, or differ in what it does", "стойки это запрещают или делают по-разному";
        "cancel the rotation, scaling or mirror before it",
        "отмените перед этим поворот, масштабирование или зеркальное отображение"
    )
}

pub(crate) const DWELL_BESIDE_ARC_OR_CYCLE: Refusal = refusal!(const codes::WORDS_OF_TWO;
    "a dwell beside an arc or a cycle", "выдержка рядом с дугой или циклом";
    "whose is P?", "чьё это P?";
    "write the dwell in a block of its own", "напишите выдержку отдельным кадром"
);

pub(crate) const Q_WITHOUT_HOLE: Refusal = refusal!(const codes::CYCLE_WORDS;
    "Q without a hole", "Q без отверстия";
    "does it hold for the next one? controls differ", "действует ли оно для следующего? у стоек по-разному";
    "write Q in a block that drills", "напишите Q в кадре, который сверлит"
);

pub(crate) fn without_motion_code(letters: &str) -> Refusal {
    refusal!(codes::NO_MOTION_CODE;
        "{letters} without a motion code", "{letters} без функции движения";
        "no G0, G1, G2, G3 or cycle is in force", "не действует ни G0, ни G1, ни G2, ни G3, ни цикл";
        "write the motion code in this block", "напишите функцию движения в этом кадре"
    )
}

pub(crate) fn motion_code_behind_block_delete(line: impl Display) -> Refusal {
    refusal!(codes::BLOCK_DELETE;
        "the motion code in force depends on the block delete switch",
        "какая функция движения действует, зависит от переключателя пропуска кадров";
        "line {line} changes the motion code and may be skipped",
        "строка {line} меняет функцию движения и может быть пропущена";
        "write the motion code in this block", "напишите функцию движения в этом кадре"
    )
}

pub(crate) const INVERSE_TIME_NOT_ABOVE_ZERO: Refusal = refusal!(const codes::INVERSE_TIME;
    "inverse time must be above zero", "обратное время должно быть больше нуля";
    "1/F minutes", "1/F минут";
    "write F as one over the minutes of this motion",
    "напишите F как единицу, делённую на минуты этого движения"
);

pub(crate) const G93_WITHOUT_F: Refusal = refusal!(const codes::INVERSE_TIME;
    "a feed motion under G93 without F", "рабочий ход при G93 без F";
    "F was expected in this block", "в этом кадре ожидалось F";
    "G93 needs F on each feed block; or program G94",
    "при G93 нужно F в каждом рабочем кадре; или запрограммируйте G94"
);

pub(crate) const FEED_BEHIND_G93_WITHOUT_F: Refusal = refusal!(const codes::INVERSE_TIME;
    "a feed behind G93 without F", "рабочий ход после G93 без F";
    "the last F was an inverse time", "последнее F было обратным временем";
    "write F in this block, or beside the code that ends G93",
    "напишите F в этом кадре или рядом с функцией, которая отменяет G93"
);

pub(crate) const DWELL_AND_MOTION_IN_ONE_BLOCK: Refusal = refusal!(const codes::WORDS_OF_TWO;
    "a dwell and a motion in one block", "выдержка и движение в одном кадре";
    "time or coordinate?", "время или координата?";
    "write the dwell in a block of its own", "напишите выдержку отдельным кадром"
);

pub(crate) const DWELL_BESIDE_MOTION: Refusal = refusal!(const codes::WORDS_OF_TWO;
    "a dwell and a motion in one block", "выдержка и движение в одном кадре";
    "no time: this control takes it from elsewhere, and these are a motion's words",
    "не время: эта стойка берёт его из другого слова, а это слова движения";
    "write the dwell in a block of its own, and its time as the control takes it",
    "напишите выдержку отдельным кадром, а её время так, как берёт стойка"
);

pub(crate) const MACHINE_COORDINATES_WITH_ARC_OR_CYCLE: Refusal = refusal!(const codes::COMBINATION;
    "machine coordinates with an arc or a cycle", "координаты станка вместе с дугой или циклом";
    "moves straight on every control", "на любой стойке идёт по прямой";
    "write G0 in this block", "напишите в этом кадре G0"
);

pub(crate) const MACHINE_COORDINATES_WITH_TOOL_LENGTH: Refusal = refusal!(const codes::TOOL_LENGTH;
    "machine coordinates while a tool length is in force",
    "координаты станка при действующей коррекции на длину";
    "the place of the tip, or of the spindle?", "положение вершины или шпинделя?";
    "write D0 in this block, or before it", "напишите D0 в этом кадре или перед ним"
);

pub(crate) const REFERENCE_OR_PROBE_IN_CYCLE: Refusal = refusal!(const codes::COMBINATION;
    "a reference return or probe move while a drilling cycle is in force",
    "выход в исходное положение или движение щупа во время цикла сверления";
    "a cycle is running here", "здесь действует цикл";
    "cancel the cycle with G80 first", "сначала отмените цикл функцией G80"
);

pub(crate) fn both_take_axis_words(owner: impl Display, code: &str) -> Refusal {
    refusal!(codes::WORDS_OF_TWO;
        "{owner} and {code} both take the axis words of this block",
        "слова осей этого кадра принимают и {owner}, и {code}";
        "whose are they?", "чьи они?";
        "write the two codes in two blocks", "напишите эти две функции двумя кадрами"
    )
}

pub(crate) fn turn_under_compensation(letters: &str) -> Refusal {
    refusal!(codes::SIMULTANEOUS;
        "{letters} turn at feed rate under cutter compensation",
        "{letters} вращается на рабочей подаче при коррекции на радиус";
        "what the control offsets is no path in space while a rotary axis turns",
        "пока вращается поворотная ось, то, что стойка смещает на радиус, — не путь в пространстве";
        "cancel the compensation with G40 before this block; let the CAM write the tool's centre",
        "отмените коррекцию функцией G40 до этого кадра; выводите из CAM путь центра инструмента"
    )
}
