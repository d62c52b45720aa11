//! Faults of instruments.

use diagnostic::{Text, both};
use machine_model::effects::TRACKER as TRACKER_FAULTS;

use super::row::{Along, Effect, Search, Searched, Size, Why};

/// What a tracker reads wrong, in Russian, and the same as an object.
pub(crate) const FAULTS: [[&str; 2]; TRACKER_FAULTS.len()] = [
    ["масштаб", "масштаб дальности"],
    ["нуль дальности", "нуль дальности"],
    ["круг азимута", "круг азимута"],
    ["круг угла места", "круг угла места"],
    ["ось качания", "ось качания трубы"],
    ["коллимация", "коллимацию"],
];

/// In µm, µm/m and µrad.
const PROBE_LOBING_MOST: Option<(f64, Why)> = Some((
    200.0,
    ["no probe has a pre-travel of 0.2 mm", "предварительного хода 0.2 мм у измерительных головок не бывает"],
));

pub(super) static PROBE_LOBING: Effect = Effect {
    name: "направление щупа",
    words: |&Size { swing, .. }| {
        both!(
            "the probe triggers {swing:.1} µm apart from direction to direction",
            "измерительная головка срабатывает в разных направлениях с разницей {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Calibrate the probe in the directions used; the machine is not the cause.",
        "Откалибруйте измерительную головку в тех направлениях, в которых меряете; станок не причина.",
    ),
    search: Search {
        along: Along::Elsewhere,
        usual: f64::INFINITY,
        most: PROBE_LOBING_MOST,
        searched: Searched::Nothing,
    },
};

pub(super) static INSTRUMENT_DRIFT: Effect = Effect {
    name: "дрейф прибора",
    words: |&Size { swing, .. }| {
        both!(
            "the instrument drifts: {swing:.1} µm while it measured",
            "прибор дрейфует: {swing:.1} мкм за время измерения"
        )
    },
    remedy: Text::pair(
        "Let the instrument settle and return to a reference point between lines; the machine is not the cause.",
        "Дайте прибору выйти на режим и между линиями возвращайтесь к опорной точке; станок не причина.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};

pub(super) static TRACKER: Effect = Effect {
    name: "трекер",
    words: |&Size { of, swing, .. }| {
        let place = TRACKER_FAULTS.iter().position(|fault| *fault == of);
        let (name, russian) = (of.replace('-', " "), place.map_or(of, |place| FAULTS[place][1]));
        Text::new(
            format!("the tracker reads its {name} wrong: {swing:.1} µm"),
            format!("трекер неверно отсчитывает {russian}: {swing:.1} мкм"),
        )
    },
    remedy: Text::pair(
        "Run the tracker's own two-face and ranging checks and compensate it; the machine is not the cause.",
        "Проведите собственные проверки трекера (два положения трубы, дальность) и его компенсацию; станок не причина.",
    ),
    search: Search { along: Along::Elsewhere, usual: f64::INFINITY, most: None, searched: Searched::Nothing },
};
