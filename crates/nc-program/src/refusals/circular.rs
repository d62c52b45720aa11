//! Refusals of circular arcs.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both};

use crate::codes;

pub(crate) fn arc_under_frame(name: &Text) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("an arc under {name}", "дуга, пока действует {name:#}"),
        label: both!(
            "the frame makes it an ellipse or turns it out of its plane",
            "система координат делает из неё эллипс или поворачивает её из плоскости"
        ),
        help: both!(
            "let the CAM write the arc as lines, or scale all axes alike",
            "выводите дугу из CAM прямыми или масштабируйте все оси одинаково"
        ),
    }
}

pub(crate) fn r_and_centre_in_one_arc(letters: &str) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!("R and a centre in one arc", "в одной дуге и R, и центр"),
        label: both!("which one?", "какое из двух?"),
        help: both!("remove R or {letters}", "уберите R или {letters}"),
    }
}

pub(crate) fn arc_of_turns(turns: impl Display, most: impl Display) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!("an arc of {turns} turns", "дуга в несколько оборотов: {turns}"),
        label: both!("1 to {most} were expected", "ожидалось от 1 до {most}"),
        help: both!(
            "write P1, or no P, for an arc of at most one turn",
            "для дуги не больше оборота напишите P1 или ничего"
        ),
    }
}

pub(crate) const P_BESIDE_ARC: Refusal = Refusal {
    code: codes::ARC_WORDS,
    message: Text::pair("P beside an arc", "P рядом с дугой"),
    label: Text::pair(
        "turns on some controls, nothing on others",
        "на одних стойках обороты, на других ничего",
    ),
    help: Text::pair("write one block for each turn", "напишите на каждый оборот свой кадр"),
};

pub(crate) fn centre_of_another_plane(letter: char, [one, two]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!(
            "{letter} on an arc whose plane has {one} and {two}",
            "{letter} у дуги, в плоскости которой {one} и {two}"
        ),
        label: both!("not in this plane", "не в этой плоскости"),
        help: both!(
            "select the arc's plane with G17, G18 or G19, or remove the word",
            "выберите плоскость дуги функцией G17, G18 или G19 или уберите слово"
        ),
    }
}

pub(crate) fn half_an_absolute_centre([one, two]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!(
            "half a centre under absolute arc centres",
            "половина центра при абсолютных центрах дуг"
        ),
        label: both!("{one} and {two} were expected", "ожидались {one} и {two}"),
        help: both!(
            "write both {one} and {two}, or G91.1 for centres from the start",
            "напишите и {one}, и {two} или включите G91.1: центр от начала дуги"
        ),
    }
}

pub(crate) fn arc_without_centre([one, two]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::ARC_WITHOUT_CENTRE,
        message: both!("arc without centre", "дуга без центра"),
        label: both!(
            "neither {one}/{two} nor R in this block, and neither is modal",
            "в этом кадре нет ни {one}/{two}, ни R, а модально ни одно из них не действует"
        ),
        help: both!(
            "post the program again so that each arc block has its {one} and {two} (some posts drop unchanged ones), or add R",
            "выведите программу заново, чтобы в каждом кадре дуги были {one} и {two} (некоторые постпроцессоры опускают повторные), или добавьте R"
        ),
    }
}

pub(crate) fn end_in_the_centre([one, two]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!(
            "an arc that starts or ends in its centre",
            "дуга начинается или кончается в своём центре"
        ),
        label: both!("no direction leads from there", "оттуда нет направления"),
        help: both!(
            "write the distance from the start to the centre as {one} and {two}, or a line",
            "напишите расстояние от начала до центра словами {one} и {two} или прямую"
        ),
    }
}

pub(crate) fn radii_differ(
    [start, end, allowed]: [String; 3],
    unit: &Text,
    [one, two]: [char; 2],
    mode: &Text,
) -> Refusal {
    Refusal {
        code: codes::RADII_DIFFER,
        message: both!(
            "the ends of the arc lie at different distances from its centre",
            "концы дуги лежат на разных расстояниях от её центра"
        ),
        label: both!(
            "radius {start} at the start, {end} {unit} at the end, {allowed} allowed",
            "радиус в начале {start}, в конце {end} {unit:#}, допускается {allowed}"
        ),
        help: both!(
            "correct the end or the centre ({one} and {two} are read as {mode}); where the control takes more, say so with `arc_tolerance_mm` under `[program]` in the profile",
            "исправьте конец или центр ({one} и {two} прочитаны как {mode:#}); если стойка допускает больше, скажите это ключом `arc_tolerance_mm` в разделе `[program]` профиля"
        ),
    }
}

pub(crate) fn radius_too_small(
    [radius, chord]: [String; 2],
    unit: &Text,
    [one, two]: [char; 2],
    least: impl Display,
) -> Refusal {
    Refusal {
        code: codes::RADIUS_TOO_SMALL,
        message: both!("arc radius is smaller than half the chord", "радиус дуги меньше половины хорды"),
        label: both!(
            "R{radius} {unit}, chord is {chord} {unit}",
            "R{radius} {unit:#}, а хорда {chord} {unit:#}"
        ),
        help: both!(
            "use {one}/{two} centre form, or R of at least {least}",
            "задайте центр словами {one}/{two} или R не меньше {least}"
        ),
    }
}

pub(crate) fn full_circle_by_r([one, two]: [char; 2]) -> Refusal {
    Refusal {
        code: codes::ARC_WORDS,
        message: both!("a full circle by R", "полная окружность через R"),
        label: both!(
            "start and end are the same point: R has no centre",
            "начало и конец в одной точке: по R центра не найти"
        ),
        help: both!("use {one}/{two} centre form", "задайте центр словами {one}/{two}"),
    }
}

pub(crate) const ROTARY_AXIS_TURNS_ALONG_ARC: Refusal = Refusal {
    code: codes::SIMULTANEOUS,
    message: Text::pair("a rotary axis turns along an arc", "вдоль дуги вращается поворотная ось"),
    label: Text::pair(
        "seen from the workpiece this is no arc, and no arc corrects it",
        "для детали это не дуга, и дугой её не исправить",
    ),
    help: Text::pair(
        "let the CAM write lines, or turn the rotary axis in a block of its own",
        "выводите из CAM прямые или поверните ось отдельным кадром",
    ),
};
