//! Each cause in a sentence that a metrologist would say, and what not to do about it.

use diagnostic::{Text, both};
use machine_model::Vector;
use machine_model::effects::{EffectKind, Shape};

use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;

/// What a tracker reads wrong, in Russian, in the order of [`machine_model::effects::TRACKER`].
const TRACKER: [&str; machine_model::effects::TRACKER.len()] = [
    "масштаб дальности",
    "нуль дальности",
    "круг азимута",
    "круг угла места",
    "ось качания трубы",
    "коллимацию",
];

/// What stands in the place of a remedy where the causes do not explain the gap, or unseen rows refute them.
pub(crate) const DO_NOT_ACT: Text = Text::pair(
    "Do not act on this: what is left of the gap has no name yet, or rows that were not fitted contradict it, or other explanations would be made worse by it.",
    "Ничего по этому не делайте: у остатка расхождения ещё нет названия, или строки вне подгонки этому противоречат, или при других объяснениях станет хуже.",
);

/// Why nothing is written of causes that leave a part of the gap open.
pub(crate) const NO_NAME_YET: Text = Text::pair(
    "No correction is made of the causes: what is left of the gap has no name yet, and no rows that were not fitted confirm them.",
    "По причинам ничего не исправляется: у остатка расхождения ещё нет названия, и строки вне подгонки их не подтверждают.",
);

/// Why nothing is written of a play below zero.
pub(crate) const TURNED: Text = Text::pair(
    "No correction is made of the causes: a play below zero is mostly a slip of the file. Is the direction of approach (dir_x, dir_y, dir_z) the wrong way round, or the sign of the readings (measured minus commanded)?",
    "По причинам ничего не исправляется: отрицательный люфт — чаще всего ошибка файла. Не обратное ли направление подхода (dir_x, dir_y, dir_z) и не обратный ли знак показаний (измеренное минус заданное)?",
);

/// What stands there for play of the wrong sign.
pub(crate) const NO_PLAY: Text = Text::pair(
    "This is no play: the reversal is over-compensated (lower the control's backlash value), or the sensor sits on the motor's side of it.",
    "Это не люфт: реверс перекомпенсирован (уменьшите значение люфта в ЧПУ) или датчик стоит со стороны двигателя.",
);

impl Assembly<'_> {
    /// The part at a place of the model in words, with its size where it was measured.
    pub(crate) fn words(&self, place: usize) -> Text {
        let kind = self.model.library.kind(self.model.parts[place]);
        let own = self.own(place);
        let first = own.first().map_or(0.0, |(_, value)| *value);
        let swing = self.swing_um(&own);
        let shape = own.iter().find_map(|(t, _)| match t {
            Term::Effect { shape, .. } => Some(*shape),
            _ => None,
        });
        let shape = shape.unwrap_or_default();
        let Shape { tau_s, pitch_mm, time_s, centre_mm, width_mm, .. } = shape;
        let size = first.abs();
        let (per_100_mm, twice, tau_min, way_mm) = (0.1 * size, 2.0 * size, tau_s / 60.0, 2.3 * width_mm);
        // `X` of one axis, `XY` of two, `EYX` of what shows along Y as X moves.
        let id = kind.to_string();
        let of = id.split_once('.').map_or("", |(_, of)| of.trim_start_matches('E'));
        let (a, b) = of.split_at_checked(1).unwrap_or_default();
        match kind {
            EffectKind::Scale(_) => {
                let way = if first > 0.0 {
                    Text::pair("far", "больше")
                } else {
                    Text::pair("short", "меньше")
                };
                both!(
                    "{a} travels {size:.1} µm per metre too {way}",
                    "{a} проходит на {size:.1} мкм на метр {way:#} заданного"
                )
            }
            EffectKind::Squareness(..) => both!(
                "{b} leans {size:.0} µrad against {a}: {per_100_mm:.1} µm per 100 mm",
                "{b} наклонена на {size:.0} мкрад относительно {a}: {per_100_mm:.1} мкм на 100 мм"
            ),
            EffectKind::Backlash(_) if first < 0.0 => both!(
                "{a} reverses with {twice:.1} µm too much, not too little: over-compensated, or the sensor sits on the motor's side",
                "{a} при реверсе проходит на {twice:.1} мкм больше, а не меньше: люфт перекомпенсирован или датчик стоит со стороны двигателя"
            ),
            EffectKind::Backlash(_) => both!(
                "{a} loses {twice:.1} µm of travel when it reverses",
                "{a} теряет при реверсе {twice:.1} мкм хода"
            ),
            EffectKind::LostMotion { .. } => both!(
                "{b} steps {twice:.1} µm along {a} when it reverses",
                "{b} при реверсе смещается на {twice:.1} мкм вдоль {a}"
            ),
            EffectKind::Thermal(_) => both!(
                "{a} grows with its temperature: {swing:.1} µm over what was measured",
                "{a} удлиняется от нагрева: {swing:.1} мкм на измеренном участке"
            ),
            EffectKind::Warmup(_) => both!(
                "{a} creeps by {size:.1} µm with a time constant of {tau_min:.0} min",
                "{a} при прогреве уходит на {size:.1} мкм с постоянной времени {tau_min:.0} мин"
            ),
            EffectKind::Positioning(_) => both!(
                "the positions of {a} err along a curve of {swing:.1} µm",
                "отклонение позиционирования {a} идёт по кривой размахом {swing:.1} мкм"
            ),
            EffectKind::Straightness { .. } => both!(
                "{b} runs {swing:.1} µm out of straight along {a}",
                "отклонение от прямолинейности {b} вдоль {a}: {swing:.1} мкм"
            ),
            EffectKind::Pitch(_) => both!(
                "{a} errs by {swing:.1} µm once every {pitch_mm:.2} mm: one turn of its screw",
                "{a} даёт погрешность {swing:.1} мкм с периодом {pitch_mm:.2} мм: это один оборот винта"
            ),
            EffectKind::Angular { about, axis: a } => {
                let turns = if about == a {
                    Text::pair("rolls", "отклоняется по крену")
                } else if about == 2 {
                    Text::pair("yaws", "отклоняется по рысканию")
                } else {
                    Text::pair("pitches", "отклоняется по тангажу")
                };
                both!(
                    "{b} {turns} as it travels: {swing:.1} µm at the tool",
                    "{b} на ходу {turns:#}: {swing:.1} мкм на инструменте"
                )
            }
            EffectKind::Sag(_) => both!(
                "{a} droops by {swing:.1} µm as it reaches out",
                "{a} провисает на {swing:.1} мкм с вылетом"
            ),
            EffectKind::Load(_) => both!(
                "the load bends the machine along {a} by {swing:.1} µm",
                "нагрузка прогибает станок вдоль {a} на {swing:.1} мкм"
            ),
            EffectKind::ServoLag(_) => {
                both!("{a} runs {size:.2} ms behind its command", "{a} отстаёт от задания на {size:.2} мс")
            }
            EffectKind::ServoMismatch(..) => {
                both!("{a} and {b} run {size:.2} ms apart", "{a} и {b} расходятся на {size:.2} мс")
            }
            EffectKind::Rotary { axis, .. } => {
                let rotary = ["A", "B", "C"][axis];
                both!(
                    "the rotary axis {rotary} does not stand where the model has it: {swing:.1} µm",
                    "поворотная ось {rotary} стоит не там, где в модели: {swing:.1} мкм"
                )
            }
            EffectKind::Eccentricity(_) => both!(
                "{a} errs once per turn by {swing:.1} µm",
                "{a} даёт погрешность раз за оборот: {swing:.1} мкм"
            ),
            EffectKind::ProbeLobing => both!(
                "the probe triggers {swing:.1} µm apart from direction to direction",
                "измерительная головка срабатывает в разных направлениях с разницей {swing:.1} мкм"
            ),
            EffectKind::InstrumentDrift => both!(
                "the instrument drifts: {swing:.1} µm while it measured",
                "прибор дрейфует: {swing:.1} мкм за время измерения"
            ),
            EffectKind::Step(_) => both!(
                "something moved by {size:.1} µm along {a} at {time_s:.0} s",
                "что-то сдвинулось на {size:.1} мкм вдоль {a} в момент {time_s:.0} с"
            ),
            EffectKind::Joint(_) => both!(
                "the rails of {a} do not meet at {centre_mm:.0} mm: a step of {swing:.1} µm",
                "направляющие {a} не сходятся на {centre_mm:.0} мм: ступенька {swing:.1} мкм"
            ),
            EffectKind::Spike(_) => both!(
                "{a} sticks where it turns: {size:.1} µm, gone after {way_mm:.1} mm of way",
                "{a} залипает в точке реверса: {size:.1} мкм, проходит через {way_mm:.1} мм пути"
            ),
            EffectKind::Contraction => both!(
                "circles shrink with the square of the feed: {swing:.1} µm over what was measured",
                "окружности сжимаются с квадратом подачи: {swing:.1} мкм в измеренных пределах"
            ),
            EffectKind::SpindleTilt(_) => both!(
                "the spindle leans {size:.0} µrad towards {a}: {per_100_mm:.1} µm per 100 mm of tool",
                "шпиндель наклонён на {size:.0} мкрад в сторону {a}: {per_100_mm:.1} мкм на 100 мм инструмента"
            ),
            EffectKind::Tracker(fault) => {
                let name = machine_model::effects::TRACKER[fault];
                let (name, russian) = (name.replace('-', " "), TRACKER[fault]);
                Text::new(
                    format!("the tracker reads its {name} wrong: {swing:.1} µm"),
                    format!("трекер неверно отсчитывает {russian}: {swing:.1} мкм"),
                )
            }
            EffectKind::Local(_) => both!(
                "{a} errs by {swing:.1} µm near {centre_mm:.0} mm, over {width_mm:.0} mm",
                "{a} даёт погрешность {swing:.1} мкм около {centre_mm:.0} мм, на участке {width_mm:.0} мм"
            ),
        }
    }

    /// From the least to the most that some terms displace the rows, along the direction where that is largest, µm.
    fn swing_um(&self, terms: &[(Term, f64)]) -> f64 {
        let (mut low, mut high) = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        for moved in crate::equations::align::displacements(self.data, terms) {
            (low, high) = (low.inf(&moved), high.sup(&moved));
        }
        (high - low).max().max(0.0)
    }
}
