//! Each cause in a sentence that a metrologist would say, and what not to do about it.

use diagnostic::{Text, both};
use machine_model::Vector;
use machine_model::effects::EffectKind;

use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;

const AXES: [&str; 3] = ["X", "Y", "Z"];

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
        let axis = |a: usize| AXES[a];
        let size = first.abs();
        match kind {
            EffectKind::Scale(a) => {
                let way = if first > 0.0 {
                    Text::pair("far", "больше")
                } else {
                    Text::pair("short", "меньше")
                };
                both!(
                    "{} travels {size:.1} µm per metre too {way}",
                    "{} проходит на {size:.1} мкм на метр {way:#} заданного",
                    axis(a)
                )
            }
            EffectKind::Squareness(a, b) => both!(
                "{} leans {:.0} µrad against {}: {:.1} µm per 100 mm",
                "{} наклонена на {:.0} мкрад относительно {}: {:.1} мкм на 100 мм",
                axis(b),
                size,
                axis(a),
                0.1 * size
            ),
            EffectKind::Backlash(a) if first < 0.0 => both!(
                "{} reverses with {:.1} µm too much, not too little: over-compensated, or the sensor sits on the motor's side",
                "{} при реверсе проходит на {:.1} мкм больше, а не меньше: люфт перекомпенсирован или датчик стоит со стороны двигателя",
                axis(a),
                2.0 * size
            ),
            EffectKind::Backlash(a) => both!(
                "{} loses {:.1} µm of travel when it reverses",
                "{} теряет при реверсе {:.1} мкм хода",
                axis(a),
                2.0 * first
            ),
            EffectKind::LostMotion { direction, axis: a } => both!(
                "{} steps {:.1} µm along {} when it reverses",
                "{} при реверсе смещается на {:.1} мкм вдоль {}",
                axis(a),
                2.0 * size,
                axis(direction)
            ),
            EffectKind::Thermal(a) => both!(
                "{} grows with its temperature: {swing:.1} µm over what was measured",
                "{} удлиняется от нагрева: {swing:.1} мкм на измеренном участке",
                axis(a)
            ),
            EffectKind::Warmup(a) => both!(
                "{} creeps by {:.1} µm with a time constant of {:.0} min",
                "{} при прогреве уходит на {:.1} мкм с постоянной времени {:.0} мин",
                axis(a),
                size,
                shape.tau_s / 60.0
            ),
            EffectKind::Positioning(a) => both!(
                "the positions of {} err along a curve of {swing:.1} µm",
                "отклонение позиционирования {} идёт по кривой размахом {swing:.1} мкм",
                axis(a)
            ),
            EffectKind::Straightness { direction, axis: a } => both!(
                "{} runs {swing:.1} µm out of straight along {}",
                "отклонение от прямолинейности {} вдоль {}: {swing:.1} мкм",
                axis(a),
                axis(direction)
            ),
            EffectKind::Pitch(a) => both!(
                "{} errs by {swing:.1} µm once every {:.2} mm: one turn of its screw",
                "{} даёт погрешность {swing:.1} мкм с периодом {:.2} мм: это один оборот винта",
                axis(a),
                shape.pitch_mm
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
                    "{} {turns} as it travels: {swing:.1} µm at the tool",
                    "{} на ходу {turns:#}: {swing:.1} мкм на инструменте",
                    axis(a)
                )
            }
            EffectKind::Sag(a) => both!(
                "{} droops by {swing:.1} µm as it reaches out",
                "{} провисает на {swing:.1} мкм с вылетом",
                axis(a)
            ),
            EffectKind::Load(a) => both!(
                "the load bends the machine along {} by {swing:.1} µm",
                "нагрузка прогибает станок вдоль {} на {swing:.1} мкм",
                axis(a)
            ),
            EffectKind::ServoLag(a) => both!(
                "{} runs {size:.2} ms behind its command",
                "{} отстаёт от задания на {size:.2} мс",
                axis(a)
            ),
            EffectKind::ServoMismatch(a, b) => both!(
                "{} and {} run {size:.2} ms apart",
                "{} и {} расходятся на {size:.2} мс",
                axis(a),
                axis(b)
            ),
            EffectKind::Rotary { axis: a, .. } => both!(
                "the rotary axis {} does not stand where the model has it: {swing:.1} µm",
                "поворотная ось {} стоит не там, где в модели: {swing:.1} мкм",
                ["A", "B", "C"][a]
            ),
            EffectKind::Eccentricity(a) => both!(
                "{} errs once per turn by {swing:.1} µm",
                "{} даёт погрешность раз за оборот: {swing:.1} мкм",
                ["A", "B", "C"][a]
            ),
            EffectKind::ProbeLobing => both!(
                "the probe triggers {swing:.1} µm apart from direction to direction",
                "измерительная головка срабатывает в разных направлениях с разницей {swing:.1} мкм"
            ),
            EffectKind::InstrumentDrift => both!(
                "the instrument drifts: {swing:.1} µm while it measured",
                "прибор дрейфует: {swing:.1} мкм за время измерения"
            ),
            EffectKind::Step(a) => both!(
                "something moved by {:.1} µm along {} at {:.0} s",
                "что-то сдвинулось на {:.1} мкм вдоль {} в момент {:.0} с",
                size,
                axis(a),
                shape.time_s
            ),
            EffectKind::Joint(a) => both!(
                "the rails of {} do not meet at {:.0} mm: a step of {swing:.1} µm",
                "направляющие {} не сходятся на {:.0} мм: ступенька {swing:.1} мкм",
                axis(a),
                shape.centre_mm
            ),
            EffectKind::Spike(a) => both!(
                "{} sticks where it turns: {:.1} µm, gone after {:.1} mm of way",
                "{} залипает в точке реверса: {:.1} мкм, проходит через {:.1} мм пути",
                axis(a),
                size,
                2.3 * shape.width_mm
            ),
            EffectKind::Contraction => both!(
                "circles shrink with the square of the feed: {swing:.1} µm over what was measured",
                "окружности сжимаются с квадратом подачи: {swing:.1} мкм в измеренных пределах"
            ),
            EffectKind::SpindleTilt(a) => both!(
                "the spindle leans {:.0} µrad towards {}: {:.1} µm per 100 mm of tool",
                "шпиндель наклонён на {:.0} мкрад в сторону {}: {:.1} мкм на 100 мм инструмента",
                size,
                axis(a),
                0.1 * size
            ),
            EffectKind::Tracker(fault) => {
                let name = machine_model::effects::TRACKER[fault];
                let (name, russian) = (name.replace('-', " "), TRACKER[fault]);
                Text::new(
                    format!("the tracker reads its {name} wrong: {swing:.1} µm"),
                    format!("трекер неверно отсчитывает {russian}: {swing:.1} мкм"),
                )
            }
            EffectKind::Local(a) => both!(
                "{} errs by {swing:.1} µm near {:.0} mm, over {:.0} mm",
                "{} даёт погрешность {swing:.1} мкм около {:.0} мм, на участке {:.0} мм",
                axis(a),
                shape.centre_mm,
                shape.width_mm
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
