//! Refusals of cycles of lathes.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both, refusal};

use crate::codes;

pub(crate) const TOO_MANY_PECKS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a hole of more than 2000 pecks", "отверстие больше чем в 2000 проходов";
    "Q counts least increments where it has no point", "Q без точки считает дискреты";
    "correct Z and Q", "исправьте Z и Q"
);

pub(crate) fn boring_feed_not_known(percent: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a boring feed that is not known, or has no point", "подача расточки неизвестна или без точки";
        "out of the hole it is {percent} per cent of F", "на выходе она {percent} % от F";
        "write F with a point in this block", "напишите в этом кадре F с точкой"
    )
}

pub(crate) fn hole_drilled_again(number: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a hole drilled {number} times", "отверстие сверлится раз: {number}";
        "K counts the holes, and on the axis there is one", "K считает отверстия, а на оси оно одно";
        "leave K out", "уберите K"
    )
}

pub(crate) const NUMBER_THAT_IS_NONE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a number that is none of a cycle's", "число, какого в цикле не бывает";
    "above 400 km", "больше 400 км";
    "correct it", "исправьте его"
);

pub(crate) const ANOTHER_CODE_BESIDE_CYCLE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "another code beside a cycle", "другая функция рядом с циклом";
    "whose are the words of this block?", "чьи слова этого кадра?";
    "write it in a block of its own", "напишите отдельным кадром"
);

pub(crate) fn beside_cycle(text: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "{text} beside a cycle", "{text} рядом с циклом";
        "it is no word of this cycle", "это не слово этого цикла";
        "write it in a block of its own before the cycle, or remove it",
        "напишите отдельным кадром до цикла или уберите"
    )
}

pub(crate) const CYCLE_BEHIND_BLOCK_DELETE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle behind block delete", "цикл в кадре с пропуском";
    "two programs in one: what follows starts from two places",
    "две программы в одной: дальнейшее начинается из двух мест";
    "write it without `/`, or let the CAM write the moves", "напишите без `/` или выводите движения из CAM"
);

pub(crate) const CYCLE_UNDER_COMPENSATION: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle under compensation of the nose", "цикл при коррекции на радиус при вершине";
    "which of its moves are compensated, controls differ",
    "на каких его ходах она действует, у стоек по-разному";
    "write G40 before it; finish the contour as blocks of its own under G41 or G42",
    "напишите перед ним G40; чистовой контур напишите отдельными кадрами при G41 или G42"
);

pub(crate) const AXIS_WORDS_WITHOUT_MOTION_CODE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "axis words without a motion code behind a cycle", "слова осей без функции движения после цикла";
    "which code is in force behind it the manual leaves open",
    "какая функция действует после него, руководство не говорит";
    "write G0 or G1 in this block", "напишите в этом кадре G0 или G1"
);

pub(crate) const START_NOT_KNOWN: Refusal = refusal!(const codes::TURNING_CYCLE;
    "where the cycle starts is not known", "неизвестно, откуда начинается цикл";
    "it starts, and ends, where the tool stands", "он начинается и кончается там, где стоит инструмент";
    "before it name X and Z in a rapid, as in `G0 X60. Z2.`",
    "назовите перед ним X и Z в быстром ходе, например `G0 X60. Z2.`"
);

pub(crate) const END_NOT_KNOWN: Refusal = refusal!(const codes::TURNING_CYCLE;
    "where the cycle leads is not known", "неизвестно, куда ведёт цикл";
    "above 400 km", "больше 400 км";
    "correct X and Z", "исправьте X и Z"
);

pub(crate) const DIAMETER_OR_RADIUS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "whether X is a diameter or a radius is not said", "не сказано, диаметр X или радиус";
    "depths and tapers are radii", "глубины и конусы задаются по радиусу";
    "write `x = \"diameter\"` (or \"radius\") under `[program]` in the profile",
    "впишите `x = \"diameter\"` (или \"radius\") в раздел `[program]` профиля"
);

pub(crate) const CYCLE_WITHOUT_PLACE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle without a place", "цикл без конечной точки";
    "in G-code system A this code is a single pass, with X and Z",
    "в системе A эта функция — один проход, с X и Z";
    "write X and Z; where the control has system B or C, write it as `g_code_system` under `[program]` in the profile",
    "напишите X и Z; если у стойки система B или C, назовите её ключом `g_code_system` раздела `[program]` профиля"
);

pub(crate) const TAPER_MAY_BE_IN_FORCE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a taper that may still be in force", "конус, который может ещё действовать";
    "R of the pass before holds until another is written",
    "R прошлого прохода действует, пока не написано другое";
    "write R in this block, R0 for none", "напишите R в этом кадре, R0 — без конуса"
);

pub(crate) const BLOCK_WITHOUT_PLACE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a block without a place while a single pass is in force",
    "кадр без конечной точки, пока действует однопроходный цикл";
    "whether the control repeats the pass here is not certain", "повторит ли стойка здесь проход, неясно";
    "end the passes with G0 or G1 before it", "закончите проходы функцией G0 или G1 перед ним"
);

pub(crate) const PASS_WITH_ONE_PLACE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a single pass with one place only", "однопроходный цикл только с одной координатой";
    "X and Z were expected, until each has been named once",
    "ожидались X и Z, пока каждая не названа хотя бы раз";
    "write X and Z of the end of the cut", "напишите X и Z конца резания"
);

pub(crate) const THREAD_WHOSE_LEAD_NOT_CERTAIN: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a thread whose lead is not certain", "резьба, ход которой неясен";
    "its chamfer is so many leads long", "её сбег длиной в столько-то ходов";
    "write F with a point in this block", "напишите в этом кадре F с точкой"
);

pub(crate) fn thread_shorter_than_chamfer(length: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a thread shorter than its chamfer", "резьба короче своего сбега";
        "its chamfer is {length} long", "длина сбега {length}";
        "correct `thread_chamfer_leads` in the profile, or start further out",
        "исправьте `thread_chamfer_leads` в профиле или начните дальше от детали"
    )
}

pub(crate) const CYCLE_WITHOUT_X_OR_Z: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle without a place", "цикл без конечной точки";
    "neither X and Z nor a return", "ни X и Z, ни отвода";
    "write X and Z, or R alone in its first block", "напишите X и Z или одно R в его первом кадре"
);

pub(crate) fn relief_at_bottom(number: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a relief of {number} at the bottom", "отвод {number} на дне";
        "what the control does at the first groove, where there is no room, is not certain",
        "что сделает стойка на первой канавке, где места нет, неясно";
        "leave R out of this block", "уберите R из этого кадра"
    )
}

pub(crate) const DEPTH_OR_PECKS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle without a depth, or of more than 10000 pecks",
    "цикл без глубины или больше чем в 10000 проходов";
    "P and Q count least increments where they have no point", "P и Q без точки считают дискреты";
    "correct X, Z, P and Q", "исправьте X, Z, P и Q"
);

pub(crate) const NUMBER_OF_CUTS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a number of cuts that is none", "неверное число проходов";
    "R counts the cuts here", "R здесь считает проходы";
    "write a whole number, like R3", "напишите целое число, например R3"
);

pub(crate) const CYCLE_WITHOUT_CONTOUR: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a cycle without P and Q", "цикл без P и Q";
    "neither a contour nor a setting", "ни контура, ни установки";
    "write P and Q of its contour, or U, W and R of its first block",
    "напишите P и Q его контура или U, W и R его первого кадра"
);

pub(crate) const RELIEF_OR_CUTS_NOT_SAID: Refusal = refusal!(const codes::TURNING_CYCLE;
    "the relief or the number of cuts is not said, or there are less than two",
    "не сказан припуск или число проходов, или их меньше двух";
    "parameters of the control would say them", "их задали бы параметры стойки";
    "write U, W and R in a block of this cycle before it: relief along X (radius) and Z, and number of cuts",
    "напишите перед ним U, W и R в кадре этого цикла: припуск вдоль X (по радиусу) и Z и число проходов"
);

pub(crate) fn depth_of_cut_not_said(letter: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "a depth of cut that nobody says", "глубина прохода, которой никто не назвал";
        "a parameter of the control would", "её задал бы параметр стойки";
        "write {letter} and R in a block of this cycle before it, or D in this one",
        "напишите перед ним {letter} и R в кадре этого цикла или D в этом"
    )
}

pub(crate) const FINISHING_WITHOUT_F: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a finishing without F", "чистовая обработка без F";
    "the last F stood in a roughing block, which does not hold here",
    "последнее F стояло в черновом кадре и здесь не действует";
    "write F in this block, or in the contour", "напишите F в этом кадре или в контуре"
);

pub(crate) const TOO_MANY_PASSES: Refusal = refusal!(const codes::TURNING_CYCLE;
    "more than 10000 passes", "больше 10000 проходов";
    "the depth of cut is too small", "глубина прохода слишком мала";
    "correct the depth of cut: a length without a point may count least increments",
    "исправьте глубину прохода: размер без точки может считать дискреты"
);

pub(crate) const HOLE_OFF_THE_AXIS: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a hole off the axis", "отверстие не на оси";
    "beside the axis of a workpiece that turns nothing is drilled", "вне оси вращающейся детали не сверлят";
    "write X0; correct the turning apart from what is drilled with a driven tool",
    "напишите X0; исправляйте точение отдельно от сверления приводным инструментом"
);

pub(crate) const HOLE_WITHOUT_DEPTH_OR_R: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a hole without a depth, or without R", "отверстие без глубины или без R";
    "R says where drilling begins", "R говорит, где начинается сверление";
    "write Z and R, as in `G83 Z-30. R-3. F0.1`", "напишите Z и R, например `G83 Z-30. R-3. F0.1`"
);

pub(crate) const DEPTH_FROM_UNKNOWN_PLACE: Refusal = refusal!(const codes::TURNING_CYCLE;
    "a hole whose depth W counts from an unknown place",
    "отверстие, глубина W которого отсчитывается неизвестно откуда";
    "from R by the manual, from the start as every other W does",
    "по руководству от R, а как любое W — от начала цикла";
    "write the bottom as a place, with Z", "напишите дно координатой Z"
);

pub(crate) fn r_not_above_bottom(start: impl Display, level: impl Display) -> Refusal {
    refusal!(codes::TURNING_CYCLE;
        "R does not lie above the bottom", "R лежит не над дном отверстия";
        "from Z {start} it would lead to {level}", "от Z {start} он привёл бы к {level}";
        "in system A it counts from the start, with its sign: R-3. goes 3 mm along -Z",
        "в системе A отсчитывается от начала, со знаком: R-3. — это 3 мм вдоль -Z"
    )
}

pub(crate) fn parameter_of_the_control(what: &Text, key: &str, value: &str) -> Refusal {
    refusal!(codes::CYCLE_PARAMETER;
        "{what} is a parameter of the control, and nobody says it",
        "{what:#} — параметр стойки, и его никто не назвал";
        "it decides how the cycle moves", "от него зависят движения цикла";
        "write `{key} = {value}` with the control's value under `[program]` in the profile",
        "впишите `{key} = {value}` со значением стойки в раздел `[program]` профиля"
    )
}

/// `along`: 0 for X, 1 for Z.
pub(crate) fn groove_without_step(along: usize) -> Refusal {
    Refusal {
        code: codes::TURNING_CYCLE,
        message: both!("a groove wider than the tool without its step", "канавка шире резца без шага"),
        label: both!("how far from one place to the next?", "на сколько смещаться?"),
        help: if along == 0 {
            both!("write P, the step along X (radius)", "напишите P — шаг вдоль X (по радиусу)")
        } else {
            both!("write Q, the step along Z", "напишите Q — шаг вдоль Z")
        },
    }
}
