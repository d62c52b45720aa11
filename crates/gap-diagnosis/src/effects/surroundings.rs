//! Effects of warmth, load, tools, time and rotary axes.

use diagnostic::{Text, both};

use super::row::{Along, Effect, Search, Searched, Size};

pub(super) static THERMAL: Effect = Effect {
    name: "тепловое расширение",
    words: |&Size { a, swing, .. }| {
        both!(
            "{a} grows with its temperature: {swing:.1} µm over what was measured",
            "{a} удлиняется от нагрева: {swing:.1} мкм на измеренном участке"
        )
    },
    remedy: Text::pair(
        "Measure at reference temperature, or compensate with the axis' own temperature and this coefficient.",
        "Измеряйте при нормальной температуре или компенсируйте по собственной температуре оси с этим коэффициентом.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static WARMUP: Effect = Effect {
    name: "прогрев",
    words: |&Size { a, size, tau_min, .. }| {
        both!(
            "{a} creeps by {size:.1} µm with a time constant of {tau_min:.0} min",
            "{a} при прогреве уходит на {size:.1} мкм с постоянной времени {tau_min:.0} мин"
        )
    },
    remedy: Text::pair(
        "Warm the machine up before measuring and cutting, for at least three time constants.",
        "Прогревайте станок перед измерением и обработкой не меньше трёх постоянных времени.",
    ),
    search: Search {
        along: Along::Elsewhere,
        usual: f64::INFINITY,
        most: None,
        searched: Searched::TimeConstants,
    },
};

pub(super) static LOAD: Effect = Effect {
    name: "прогиб от нагрузки",
    words: |&Size { a, swing, .. }| {
        both!(
            "the load bends the machine along {a} by {swing:.1} µm",
            "нагрузка прогибает станок вдоль {a} на {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Enter the load with the effect, or compensate the counterbalance; keep the load near the calibrated one.",
        "Внесите нагрузку вместе с эффектом или отрегулируйте противовес; держите нагрузку близкой к той, что была при калибровке.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static STEP: Effect = Effect {
    name: "скачок",
    words: |&Size { a, size, moment, .. }| {
        both!(
            "something moved by {size:.1} µm along {a} {moment}",
            "что-то сдвинулось на {size:.1} мкм вдоль {a} {moment:#}"
        )
    },
    remedy: Text::pair(
        "Ask what happened at that time (collision, clamping, restart) and measure again.",
        "Выясните, что произошло в это время (столкновение, закрепление, перезапуск), и измерьте снова.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Moment },
};

pub(super) static SPINDLE_TILT: Effect = Effect {
    name: "наклон шпинделя",
    words: |&Size { a, size, per_100_mm, .. }| {
        both!(
            "the spindle leans {size:.0} µrad towards {a}: {per_100_mm:.1} µm per 100 mm of tool",
            "шпиндель наклонён на {size:.0} мкрад в сторону {a}: {per_100_mm:.1} мкм на 100 мм инструмента"
        )
    },
    remedy: Text::pair(
        "Tram the spindle, or correct each tool by its length: the axes are not the cause.",
        "Выверьте шпиндель или корректируйте каждый инструмент по его длине: оси не причина.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static ROTARY: Effect = Effect {
    name: "положение оси",
    words: |&Size { of, swing, .. }| {
        let axis = &of[of.len() - 1..];
        both!(
            "the rotary axis {axis} does not stand where the model has it: {swing:.1} µm",
            "поворотная ось {axis} стоит не там, где в модели: {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Calibrate the location of the rotary axis and enter it in the profile.",
        "Откалибруйте положение поворотной оси и внесите его в профиль.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static ECCENTRICITY: Effect = Effect {
    name: "эксцентриситет",
    words: |&Size { a, swing, .. }| {
        both!("{a} errs once per turn by {swing:.1} µm", "{a} даёт погрешность раз за оборот: {swing:.1} мкм")
    },
    remedy: Text::pair(
        "Check the mounting of the rotary encoder or table: the error comes once per turn.",
        "Проверьте установку углового датчика или стола: погрешность повторяется раз за оборот.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};
