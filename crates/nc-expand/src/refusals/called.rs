//! Refusals of cycles called by name.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both, refusal};

use crate::codes;

pub(crate) fn in_brackets(written: impl Display, name: &str) -> Refusal {
    refusal!(codes::CALLED_CYCLE;
        "`{written}` in the brackets of {name}", "`{written}` в скобках {name}";
        "plain numbers were expected", "ожидались простые числа";
        "write the numbers in the place of expressions and texts", "напишите числа вместо выражений и текстов"
    )
}

pub(crate) fn with_as_argument(
    name: &str,
    value: impl Display,
    number: impl Display,
    place: impl Display,
) -> Refusal {
    refusal!(codes::CALLED_CYCLE;
        "{name} with {value} as argument {number}", "{name} с {value} в аргументе {number}";
        "chooses how the control reads the others", "решает, как стойка прочтёт остальные";
        "write {name} with its first {place} arguments, which posts do with extended cycles off, or the holes as G0 and G1",
        "напишите {name} с первыми аргументами ({place}), как постпроцессоры без расширенных циклов, или отверстия кадрами G0 и G1"
    )
}

pub(crate) const CYCLE_UNDER_G91: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle under G91", "цикл при G91";
    "its moves are places", "его ходы заданы координатами";
    "write G90 before it", "напишите перед ним G90"
);

pub(crate) fn place_not_known(letter: char) -> Refusal {
    refusal!(codes::CALLED_CYCLE;
        "where {letter} stands is not known", "неизвестно, где стоит {letter}";
        "the cycle moves by increments from there", "цикл отходит оттуда на приращения";
        "name it before the cycle, in G90", "назовите её до цикла, при G90"
    )
}

pub(crate) const CYCLE_WHILE_ARC_IN_FORCE: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle while an arc is in force", "цикл, пока действует дуга";
    "the words behind it would be an arc's again", "слова после него снова относились бы к дуге";
    "write G0 before the cycle", "напишите G0 до цикла"
);

pub(crate) fn without_depth(name: &str) -> Refusal {
    hole(
        both!("{name} without a depth", "{name} без глубины"),
        both!("argument 4 or 5 was expected", "ожидался аргумент 4 или 5"),
    )
}

pub(crate) fn with_two_depths(name: &str) -> Refusal {
    hole(
        both!("{name} with two depths", "{name} с двумя глубинами"),
        both!("arguments 4 and 5 contradict each other", "аргументы 4 и 5 противоречат друг другу"),
    )
}

pub(crate) fn planes_out_of_order(name: &str) -> Refusal {
    hole(
        both!("{name} whose planes are out of order", "{name}: плоскости стоят не по порядку"),
        both!(
            "retraction plane, reference plane with its safety distance and depth were expected in this order",
            "ожидались по порядку плоскость отвода, базовая плоскость с безопасным расстоянием и глубина"
        ),
    )
}

pub(crate) fn with_feed(name: &str, feed: impl Display, place: impl Display) -> Refusal {
    hole(
        both!("{name} with a feed of {feed}", "{name} с подачей {feed}"),
        both!("argument {place}: above zero was expected", "аргумент {place}: ожидалось больше нуля"),
    )
}

pub(crate) fn with_spindle_direction(name: &str, other: impl Display) -> Refusal {
    hole(
        both!("{name} with a spindle direction of {other}", "{name} с направлением шпинделя {other}"),
        both!("argument 7: 3 or 4 was expected", "аргумент 7: ожидалось 3 или 4"),
    )
}

pub(crate) const CYCLE83_WITH_SHRINKING_PECKS: Refusal = hole(
    Text::pair(
        "CYCLE83 with pecks that shrink by a factor, or a first peck that leads out",
        "CYCLE83, где проходы убывают в несколько раз или первый проход выводит наружу",
    ),
    Text::pair(
        "arguments 6, 7 and 8: a first depth inside the hole, and what each next peck is shorter by",
        "аргументы 6, 7 и 8: первая глубина внутри отверстия и на сколько короче каждый следующий проход",
    ),
);

pub(crate) const CYCLE83_WITH_FEED_FACTOR: Refusal = hole(
    Text::pair("CYCLE83 with a feed factor", "CYCLE83 с коэффициентом подачи"),
    Text::pair("argument 11: the feed of the first peck alone", "аргумент 11: подача только первого прохода"),
);

pub(crate) const CYCLE83_ALONG_ANOTHER_AXIS: Refusal = hole(
    Text::pair("CYCLE83 along another axis", "CYCLE83 вдоль другой оси"),
    Text::pair(
        "argument 13: the axis upright on the plane was expected",
        "аргумент 13: ожидалась ось, перпендикулярная плоскости",
    ),
);

pub(crate) const CYCLE83_OF_UNKNOWN_KIND: Refusal = hole(
    Text::pair("CYCLE83 of an unknown kind", "CYCLE83 неизвестного вида"),
    Text::pair(
        "argument 12: 0 breaks chips, 1 removes them",
        "аргумент 12: 0 — дробление стружки, 1 — её вывод",
    ),
);

pub(crate) fn too_many_pecks(most: impl Display) -> Refusal {
    hole(
        both!("CYCLE83 of more than {most} pecks", "CYCLE83 больше чем в {most} проходов"),
        both!("arguments 6 to 8", "аргументы 6–8"),
    )
}

pub(crate) const MODAL_CALL_OF_UNKNOWN: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a call that stays of something unknown", "модальный вызов чего-то неизвестного";
    "a cycle from CYCLE81 to CYCLE83, CYCLE85 or CYCLE86 was expected behind MCALL",
    "после MCALL ожидался цикл от CYCLE81 до CYCLE83, CYCLE85 или CYCLE86";
    "let the CAM write the holes as G0 and G1", "выводите из CAM отверстия кадрами G0 и G1"
);

pub(crate) fn without_cycle(name: &str) -> Refusal {
    hole(
        both!("{name} without a cycle", "{name} без цикла"),
        both!("MCALL and a cycle were expected before it", "перед ней ожидались MCALL и цикл"),
    )
}

pub(crate) const TWO_CALLS_IN_ONE_BLOCK: Refusal = refusal!(const codes::CALLED_CYCLE;
    "two calls in one block", "два вызова в одном кадре";
    "in which order?", "в каком порядке?";
    "write them in two blocks", "напишите их двумя кадрами"
);

pub(crate) const WORDS_BESIDE_CALL: Refusal = refusal!(const codes::CALLED_CYCLE;
    "something beside the call of a cycle", "что-то рядом с вызовом цикла";
    "before or behind the cycle?", "до цикла или после?";
    "write it in a block of its own", "напишите отдельным кадром"
);

pub(crate) const MCALL_NOT_KNOWN: Refusal = refusal!(const codes::CALLED_CYCLE;
    "what MCALL drills here is not known", "неизвестно, что здесь сверлит MCALL";
    "the frame, the tool or machine coordinates in a block under MCALL",
    "в кадре при MCALL меняются система координат, инструмент или стоят координаты станка";
    "end the call with MCALL alone before it", "закончите вызов до него: MCALL отдельным кадром"
);

pub(crate) const HOLES1_FROM_UNKNOWN_PLACE: Refusal = hole(
    Text::pair("HOLES1 from a place that is not known", "HOLES1 из неизвестного положения"),
    Text::pair(
        "it begins at the nearer end: name both axes of the plane before it",
        "он начинается с ближнего конца: назовите до него обе оси плоскости",
    ),
);

pub(crate) const HOLES1_ENDS_EQUALLY_NEAR: Refusal = hole(
    Text::pair("HOLES1 whose ends are equally near", "HOLES1, концы которого одинаково близки"),
    Text::pair("it begins at the nearer one", "он начинается с ближнего"),
);

pub(crate) fn number_of_holes(name: &str, count: impl Display) -> Refusal {
    hole(
        both!("{name} of {count} holes", "{name}: отверстий {count}"),
        both!("a whole number from 1 was expected", "ожидалось целое число от 1"),
    )
}

pub(crate) const END_BEHIND_BLOCK_DELETE: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle that ends behind block delete", "цикл, который заканчивается в кадре с пропуском";
    "what follows drills or not, by a switch", "дальше сверлят или нет, решает переключатель";
    "remove the `/`, or the block", "уберите `/` или кадр"
);

pub(crate) const MOVE_WITHOUT_ITS_CODE: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a move behind a cycle without its code", "ход после цикла без своей функции";
    "a rapid or a feed?", "быстрый или рабочий?";
    "write G0 or G1 in this block", "напишите в этом кадре G0 или G1"
);

pub(crate) const RETURN_LEVEL_NOT_CERTAIN: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a return level that is not certain", "неоднозначная плоскость отвода";
    "G71 and Z alone were expected, in G90", "ожидались одни G71 и Z, при G90";
    "write G71 with Z in a block of its own, G90 in force", "напишите G71 и Z отдельным кадром при G90"
);

pub(crate) const BLOCK_UNDER_CYCLE_NOT_CERTAIN: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a block under a cycle that is not certain", "неоднозначный кадр при действующем цикле";
    "X and Y alone were expected", "ожидались одни X и Y";
    "write the cycle anew, with all of its words", "напишите цикл заново, со всеми его словами"
);

pub(crate) const M53_WITHOUT_LEVEL: Refusal = refusal!(const codes::CALLED_CYCLE;
    "M53 without a level", "M53 без уровня";
    "no G71 stands before it", "перед ним нет G71";
    "write G71 with the level before the cycle", "напишите перед циклом G71 с уровнем"
);

pub(crate) const RETURN_NOT_SAID: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle that does not say where it returns", "цикл не говорит, куда отводится";
    "M53 (the level of G71) or M54 (R) was expected in this block",
    "в этом кадре ожидалось M53 (уровень из G71) или M54 (R)";
    "write G71 with the level before the cycle and M53 beside it",
    "напишите перед циклом G71 с уровнем, а рядом с ним M53"
);

pub(crate) const RETURN_TO_UNKNOWN_LEVEL: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle that returns to nobody knows where", "цикл отводится неизвестно куда";
    "no word says where Z stands", "ни одно слово не говорит, где стоит Z";
    "write the level with Z before the cycle", "напишите уровень словом Z до цикла"
);

pub(crate) const G98_OR_G99_NOT_SAID: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle that does not say where it returns", "цикл не говорит, куда отводится";
    "G98 or G99 was expected", "ожидалась G98 или G99";
    "write G98 or G99 in this block", "напишите G98 или G99 в этом кадре"
);

pub(crate) const WORD_BESIDE_CYCLE_NOT_CERTAIN: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a word beside a cycle that is not certain", "неоднозначное слово рядом с циклом";
    "before the hole or behind it, and in which unit?", "до отверстия или после, и в каких единицах?";
    "write it in a block of its own, a dwell as moves and G4",
    "напишите его отдельным кадром, выдержку — ходами и G4"
);

/// A called cycle whose arguments leave its holes open.
pub(crate) const fn hole(message: Text, label: Text) -> Refusal {
    refusal!(const codes::CALLED_CYCLE; message; label;
        "write the holes as G0 and G1", "напишите отверстия кадрами G0 и G1"
    )
}

pub(crate) const CALL_BEHIND_BLOCK_DELETE: Refusal = skipped(Text::pair(
    "a cycle or an increment behind block delete",
    "цикл или приращение в кадре с пропуском",
));

pub(crate) const HOLE_BEHIND_BLOCK_DELETE: Refusal =
    skipped(Text::pair("a hole behind block delete", "отверстие в кадре с пропуском"));

/// What is done or not, by a switch.
const fn skipped(message: Text) -> Refusal {
    refusal!(const codes::BLOCK_DELETE; message;
        "two programs in one", "две программы в одной";
        "remove the `/`, or the block", "уберите `/` или кадр"
    )
}

pub(crate) const CYCLE_BESIDE_ANOTHER_CODE: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle beside another code", "цикл рядом с другой функцией";
    "which comes first?", "что из них первое?";
    "write them in two blocks", "напишите их двумя кадрами"
);

pub(crate) const CYCLE_THAT_CANNOT_BE_WRITTEN_OUT: Refusal = refusal!(const codes::CALLED_CYCLE;
    "a cycle that cannot be written out", "цикл, который нельзя расписать";
    "G90 and G17 were expected, and no block delete", "ожидались G90 и G17 без пропуска кадра";
    "write it in G90 and G17, or let the CAM write the moves",
    "напишите его при G90 и G17 или выводите из CAM ходы"
);

pub(crate) fn cycle_without_levels(depth: char, level: char) -> Refusal {
    refusal!(codes::CALLED_CYCLE;
        "a cycle without its levels", "цикл без своих уровней";
        "{depth} below {level} was expected in this block", "в этом кадре ожидалось {depth} ниже {level}";
        "write {depth} and {level} beside the cycle", "напишите рядом с циклом {depth} и {level}"
    )
}

pub(crate) const PECKS_WITHOUT_DEPTH: Refusal = refusal!(const codes::CALLED_CYCLE;
    "pecks without their depth", "проходы без своей глубины";
    "Q above zero was expected", "ожидалось Q больше нуля";
    "write the depth of a peck as Q", "напишите глубину прохода словом Q"
);

pub(crate) const Q_WITHOUT_PECKS: Refusal = refusal!(const codes::CALLED_CYCLE;
    "Q beside a cycle without pecks", "Q рядом с циклом без проходов";
    "what does it say?", "что оно значит?";
    "write G83, or remove Q", "напишите G83 или уберите Q"
);

pub(crate) fn return_level_below(letter: char) -> Refusal {
    refusal!(codes::CALLED_CYCLE;
        "a return level below {letter}", "плоскость отвода ниже {letter}";
        "the tool would not return", "инструмент не отошёл бы";
        "write a return level above {letter}, or go there before the cycle",
        "напишите плоскость отвода выше {letter} или отойдите туда до цикла"
    )
}

/// Turns of a helix that cannot be written out.
pub(crate) const fn turns(label: Text) -> Refusal {
    refusal!(const codes::CALLED_CYCLE;
        "turns that cannot be written out", "обороты, которые нельзя расписать";
        label;
        "let the CAM write each turn", "выводите из CAM каждый оборот"
    )
}

/// An arc by its angle that cannot be written out.
pub(crate) const fn arc_by_angle(label: Text) -> Refusal {
    refusal!(const codes::CALLED_CYCLE;
        "an arc by its angle that cannot be written out", "дуга по углу, которую нельзя расписать";
        label;
        "write the arc with I, J, K", "напишите дугу словами I, J, K"
    )
}
