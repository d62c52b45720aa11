//! Refusals of circular arcs.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn arc_under_frame(name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "an arc under {name}", "дуга, пока действует {name:#}";
        "the frame makes it an ellipse or turns it out of its plane",
        "система координат делает из неё эллипс или поворачивает её из плоскости";
        "let the CAM write the arc as lines, or scale all axes alike",
        "выводите дугу из CAM прямыми или масштабируйте все оси одинаково"
    )
}

pub(crate) fn r_and_centre_in_one_arc(letters: &str) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "R and a centre in one arc", "в одной дуге и R, и центр";
        "which one?", "какое из двух?";
        "remove R or {letters}", "уберите R или {letters}"
    )
}

pub(crate) fn arc_of_turns(turns: impl Display, most: impl Display) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "an arc of {turns} turns", "дуга в несколько оборотов: {turns}";
        "1 to {most} were expected", "ожидалось от 1 до {most}";
        "write P1, or no P, for an arc of at most one turn",
        "для дуги не больше оборота напишите P1 или ничего"
    )
}

pub(crate) const P_BESIDE_ARC: Refusal = refusal!(const codes::ARC_WORDS;
    "P beside an arc", "P рядом с дугой";
    "turns on some controls, nothing on others", "на одних стойках обороты, на других ничего";
    "write one block for each turn", "напишите на каждый оборот свой кадр"
);

pub(crate) fn centre_of_another_plane(letter: char, [one, two]: [char; 2]) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "{letter} on an arc whose plane has {one} and {two}",
        "{letter} у дуги, в плоскости которой {one} и {two}";
        "not in this plane", "не в этой плоскости";
        "select the arc's plane with G17, G18 or G19, or remove the word",
        "выберите плоскость дуги функцией G17, G18 или G19 или уберите слово"
    )
}

pub(crate) fn half_an_absolute_centre([one, two]: [char; 2]) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "half a centre under absolute arc centres", "половина центра при абсолютных центрах дуг";
        "{one} and {two} were expected", "ожидались {one} и {two}";
        "write both {one} and {two}, or G91.1 for centres from the start",
        "напишите и {one}, и {two} или включите G91.1: центр от начала дуги"
    )
}

pub(crate) fn arc_without_centre([one, two]: [char; 2]) -> Refusal {
    refusal!(codes::ARC_WITHOUT_CENTRE;
        "arc without centre", "дуга без центра";
        "neither {one}/{two} nor R in this block, and neither is modal",
        "в этом кадре нет ни {one}/{two}, ни R, а модально ни одно из них не действует";
        "post the program again so that each arc block has its {one} and {two} (some posts drop unchanged ones), or add R",
        "выведите программу заново, чтобы в каждом кадре дуги были {one} и {two} (некоторые постпроцессоры опускают повторные), или добавьте R"
    )
}

pub(crate) fn end_in_the_centre([one, two]: [char; 2]) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "an arc that starts or ends in its centre", "дуга начинается или кончается в своём центре";
        "no direction leads from there", "оттуда нет направления";
        "write the distance from the start to the centre as {one} and {two}, or a line",
        "напишите расстояние от начала до центра словами {one} и {two} или прямую"
    )
}

pub(crate) fn radii_differ(
    [start, end, allowed]: [String; 3],
    unit: &Text,
    [one, two]: [char; 2],
    mode: &Text,
) -> Refusal {
    refusal!(codes::RADII_DIFFER;
        "the ends of the arc lie at different distances from its centre",
        "концы дуги лежат на разных расстояниях от её центра";
        "radius {start} at the start, {end} {unit} at the end, {allowed} allowed",
        "радиус в начале {start}, в конце {end} {unit:#}, допускается {allowed}";
        "correct the end or the centre ({one} and {two} are read as {mode}); where the control takes more, say so with `arc_tolerance_mm` under `[program]` in the profile",
        "исправьте конец или центр ({one} и {two} прочитаны как {mode:#}); если стойка допускает больше, скажите это ключом `arc_tolerance_mm` в разделе `[program]` профиля"
    )
}

pub(crate) fn radius_too_small(
    [radius, chord]: [String; 2],
    unit: &Text,
    [one, two]: [char; 2],
    least: impl Display,
) -> Refusal {
    refusal!(codes::RADIUS_TOO_SMALL;
        "arc radius is smaller than half the chord", "радиус дуги меньше половины хорды";
        "R{radius} {unit}, chord is {chord} {unit}", "R{radius} {unit:#}, а хорда {chord} {unit:#}";
        "use {one}/{two} centre form, or R of at least {least}",
        "задайте центр словами {one}/{two} или R не меньше {least}"
    )
}

pub(crate) fn full_circle_by_r([one, two]: [char; 2]) -> Refusal {
    refusal!(codes::ARC_WORDS;
        "a full circle by R", "полная окружность через R";
        "start and end are the same point: R has no centre",
        "начало и конец в одной точке: по R центра не найти";
        "use {one}/{two} centre form", "задайте центр словами {one}/{two}"
    )
}

pub(crate) const ROTARY_AXIS_TURNS_ALONG_ARC: Refusal = refusal!(const codes::SIMULTANEOUS;
    "a rotary axis turns along an arc", "вдоль дуги вращается поворотная ось";
    "seen from the workpiece this is no arc, and no arc corrects it",
    "для детали это не дуга, и дугой её не исправить";
    "let the CAM write lines, or turn the rotary axis in a block of its own",
    "выводите из CAM прямые или поверните ось отдельным кадром"
);
