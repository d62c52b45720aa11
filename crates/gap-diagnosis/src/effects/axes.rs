//! Effects of an axis and its guideways, by its place.

use diagnostic::{Text, both};

use super::row::{Along, Effect, Search, Searched, Size, Why};

/// In µm, µm/m and µrad.
const SCALE_MOST: Option<(f64, Why)> = Some((
    10_000.0,
    [
        "a scale wrong by 10 mm per metre is a wrong unit",
        "погрешность масштаба 10 мм на метр — это не та единица",
    ],
));
const SQUARENESS_MOST: Option<(f64, Why)> = Some((
    20_000.0,
    ["axes that lean by 20 mm per metre are seen by eye", "наклон осей на 20 мм на метр виден на глаз"],
));
const PITCH_MOST: Option<(f64, Why)> = Some((
    200.0,
    ["no screw errs by 0.2 mm within a turn", "винтов с погрешностью 0.2 мм в пределах оборота не бывает"],
));

pub(super) static SCALE: Effect = Effect {
    name: "масштаб",
    words: |&Size { a, first, size, .. }| {
        let way =
            if first > 0.0 { Text::pair("far", "больше") } else { Text::pair("short", "меньше") };
        both!(
            "{a} travels {size:.1} µm per metre too {way}",
            "{a} проходит на {size:.1} мкм на метр {way:#} заданного"
        )
    },
    remedy: Text::pair(
        "Set the scale factor of the axis (screw pitch compensation end value), or let the correction do it; check the scale's temperature first.",
        "Задайте масштабный коэффициент оси (конечное значение компенсации шага винта) или предоставьте это коррекции; сначала проверьте температуру шкалы.",
    ),
    search: Search { along: Along::Line, usual: 500.0, most: SCALE_MOST, searched: Searched::Nothing },
};

pub(super) static SQUARENESS: Effect = Effect {
    name: "перпендикулярность",
    words: |&Size { a, b, size, per_100_mm, .. }| {
        both!(
            "{b} leans {size:.0} µrad against {a}: {per_100_mm:.1} µm per 100 mm",
            "{b} наклонена на {size:.0} мкрад относительно {a}: {per_100_mm:.1} мкм на 100 мм"
        )
    },
    remedy: Text::pair(
        "Enter the squareness in the profile, or realign the axes if it exceeds the machine's tolerance.",
        "Внесите отклонение от перпендикулярности в профиль или выверьте оси, если оно больше допуска станка.",
    ),
    search: Search { along: Along::Line, usual: 500.0, most: SQUARENESS_MOST, searched: Searched::Nothing },
};

pub(super) static POSITIONING: Effect = Effect {
    name: "позиционирование",
    words: |&Size { a, swing, .. }| {
        both!(
            "the positions of {a} err along a curve of {swing:.1} µm",
            "отклонение позиционирования {a} идёт по кривой размахом {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Measure the axis with an interferometer and enter its table.",
        "Измерьте ось интерферометром и внесите её таблицу.",
    ),
    search: Search { along: Along::Curve, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static STRAIGHTNESS: Effect = Effect {
    name: "прямолинейность",
    words: |&Size { a, b, swing, .. }| {
        both!(
            "{b} runs {swing:.1} µm out of straight along {a}",
            "отклонение от прямолинейности {b} вдоль {a}: {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Measure the axis' straightness and enter its table; check the levelling of the bed.",
        "Измерьте отклонение оси от прямолинейности и внесите её таблицу; проверьте выставку станины по уровню.",
    ),
    search: Search { along: Along::Curve, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static PITCH: Effect = Effect {
    name: "шаг винта",
    words: |&Size { a, swing, pitch_mm, .. }| {
        both!(
            "{a} errs by {swing:.1} µm once every {pitch_mm:.2} mm: one turn of its screw",
            "{a} даёт погрешность {swing:.1} мкм с периодом {pitch_mm:.2} мм: это один оборот винта"
        )
    },
    remedy: Text::pair(
        "Check the screw's end bearing and the encoder coupling; a table with steps below a quarter of the pitch corrects it.",
        "Проверьте концевую опору винта и муфту датчика; исправит таблица с шагом меньше четверти шага винта.",
    ),
    search: Search { along: Along::Curve, usual: 10.0, most: PITCH_MOST, searched: Searched::Period },
};

pub(super) static ANGULAR: Effect = Effect {
    name: "угол",
    words: |&Size { a, b, swing, .. }| {
        let turns = match (a, b) {
            ("A", "X") | ("B", "Y") | ("C", "Z") => Text::pair("rolls", "отклоняется по крену"),
            ("C", _) => Text::pair("yaws", "отклоняется по рысканию"),
            _ => Text::pair("pitches", "отклоняется по тангажу"),
        };
        both!(
            "{b} {turns} as it travels: {swing:.1} µm at the tool",
            "{b} на ходу {turns:#}: {swing:.1} мкм на инструменте"
        )
    },
    remedy: Text::pair(
        "Measure the axis' angles with level or interferometer and enter its table; check the guideways.",
        "Измерьте углы оси уровнем или интерферометром и внесите её таблицу; проверьте направляющие.",
    ),
    search: Search { along: Along::Angle, usual: 100.0, most: None, searched: Searched::Nothing },
};

pub(super) static SAG: Effect = Effect {
    name: "провисание",
    words: |&Size { a, swing, .. }| {
        both!("{a} droops by {swing:.1} µm as it reaches out", "{a} провисает на {swing:.1} мкм с вылетом")
    },
    remedy: Text::pair(
        "Use the control's droop compensation over the overhang, or check the ram's counterbalance.",
        "Включите в ЧПУ компенсацию провисания по вылету или проверьте противовес ползуна.",
    ),
    search: Search { along: Along::Droop, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static JOINT: Effect = Effect {
    name: "стык направляющих",
    words: |&Size { a, swing, centre_mm, .. }| {
        both!(
            "the rails of {a} do not meet at {centre_mm:.0} mm: a step of {swing:.1} µm",
            "направляющие {a} не сходятся на {centre_mm:.0} мм: ступенька {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Realign the rails where they join, or enter a table with a node on each side of the joint.",
        "Выверьте направляющие в месте стыка или внесите таблицу с узлом по каждую сторону стыка.",
    ),
    search: Search { along: Along::Place, usual: f64::INFINITY, most: None, searched: Searched::Centre },
};

pub(super) static LOCAL: Effect = Effect {
    name: "местный дефект",
    words: |&Size { a, swing, centre_mm, width_mm, .. }| {
        both!(
            "{a} errs by {swing:.1} µm near {centre_mm:.0} mm, over {width_mm:.0} mm",
            "{a} даёт погрешность {swing:.1} мкм около {centre_mm:.0} мм, на участке {width_mm:.0} мм"
        )
    },
    remedy: Text::pair(
        "Inspect the guideway or scale at that place for damage or dirt.",
        "Осмотрите направляющую или шкалу в этом месте: повреждение или грязь.",
    ),
    search: Search {
        along: Along::Place,
        usual: f64::INFINITY,
        most: None,
        searched: Searched::CentreAndWidth,
    },
};
