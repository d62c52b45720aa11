//! Effects of drives: reversal and feed.

use diagnostic::{Text, both};

use super::row::{Along, Effect, Search, Searched, Size, Why};

/// Of a play, µm.
const PLAY: Option<(f64, Why)> =
    Some((500.0, ["a play of a millimetre is felt by hand", "люфт в миллиметр чувствуется рукой"]));
/// Of a lag, ms.
const LAG: Option<(f64, Why)> =
    Some((1000.0, ["no servo runs a second behind", "следящий привод не отстаёт на секунду"]));

pub(super) static BACKLASH: Effect = Effect {
    name: "люфт",
    words: |&Size { a, first, twice, .. }| {
        if first < 0.0 {
            both!(
                "{a} reverses with {twice:.1} µm too much, not too little: over-compensated, or the sensor sits on the motor's side",
                "{a} при реверсе проходит на {twice:.1} мкм больше, а не меньше: люфт перекомпенсирован или датчик стоит со стороны двигателя"
            )
        } else {
            both!(
                "{a} loses {twice:.1} µm of travel when it reverses",
                "{a} теряет при реверсе {twice:.1} мкм хода"
            )
        }
    },
    remedy: Text::pair(
        "Set the control's backlash compensation to twice the half width, or have screw, nut and bearing preload checked.",
        "Задайте в ЧПУ компенсацию люфта, равную удвоенной полуширине, или дайте проверить натяг винта, гайки и подшипников.",
    ),
    search: Search { along: Along::Reversal, usual: f64::INFINITY, most: PLAY, searched: Searched::Nothing },
};

pub(super) static LOST_MOTION: Effect = Effect {
    name: "мёртвый ход",
    words: |&Size { a, b, twice, .. }| {
        both!(
            "{b} steps {twice:.1} µm along {a} when it reverses",
            "{b} при реверсе смещается на {twice:.1} мкм вдоль {a}"
        )
    },
    remedy: Text::pair(
        "Check gibs and guideway preload: the carriage steps sideways when it reverses.",
        "Проверьте клинья и натяг направляющих: при реверсе каретку уводит вбок.",
    ),
    search: Search { along: Along::Reversal, usual: f64::INFINITY, most: PLAY, searched: Searched::Nothing },
};

pub(super) static SERVO_LAG: Effect = Effect {
    name: "отставание привода",
    words: |&Size { a, size, .. }| {
        both!("{a} runs {size:.2} ms behind its command", "{a} отстаёт от задания на {size:.2} мс")
    },
    remedy: Text::pair(
        "Switch feed-forward on or measure at low feed: the error is made by the speed, not by the place.",
        "Включите упреждение по скорости или измеряйте на малой подаче: погрешность создаёт скорость, а не место.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: LAG, searched: Searched::Nothing },
};

pub(super) static SERVO_MISMATCH: Effect = Effect {
    name: "разница приводов",
    words: |&Size { a, b, size, .. }| {
        both!("{a} and {b} run {size:.2} ms apart", "{a} и {b} расходятся на {size:.2} мс")
    },
    remedy: Text::pair(
        "Match the position loop gains of the two axes.",
        "Согласуйте добротности контуров положения двух осей.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: LAG, searched: Searched::Nothing },
};

pub(super) static SPIKE: Effect = Effect {
    name: "выброс при реверсе",
    words: |&Size { a, size, way_mm, .. }| {
        both!(
            "{a} sticks where it turns: {size:.1} µm, gone after {way_mm:.1} mm of way",
            "{a} залипает в точке реверса: {size:.1} мкм, проходит через {way_mm:.1} мм пути"
        )
    },
    remedy: Text::pair(
        "Set the control's friction (quadrant) compensation for this axis; check lubrication and gibs.",
        "Задайте в ЧПУ компенсацию трения (квадрантных выбросов) для этой оси; проверьте смазку и клинья.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Way },
};

pub(super) static CONTRACTION: Effect = Effect {
    name: "сжатие окружностей",
    words: |&Size { swing, .. }| {
        both!(
            "circles shrink with the square of the feed: {swing:.1} µm over what was measured",
            "окружности сжимаются с квадратом подачи: {swing:.1} мкм в измеренных пределах"
        )
    },
    remedy: Text::pair(
        "Raise the position loop gain or use acceleration feed-forward; until then finish round parts at the slower feed.",
        "Поднимите добротность контура положения или включите упреждение по ускорению; до тех пор обрабатывайте круглые детали начисто на меньшей подаче.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};
