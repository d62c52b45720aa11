//! What the reader of an answer should know beside it.

use diagnostic::{Text, both};

use crate::equations::noise::{Noise, NoiseSource};
use crate::equations::observation::{Measurements, Row};
use crate::equations::set_up::Clamping;
use crate::judgement::answer::Cause;
use crate::judgement::assembly::Assembly;
use crate::judgement::structure::jerks;

impl Assembly<'_> {
    pub(crate) fn notes(&self) -> Vec<Text> {
        let mut notes = Vec::new();
        match self.noise {
            Some(Noise { source: NoiseSource::Neighbours, .. }) => notes.push(Text::pair(
                "No command was measured twice in a run: the noise is estimated from neighbouring rows, and a gap finer than their distance counts as noise.",
                "Ни одна точка не измерена в серии дважды: шум оценён по соседним строкам, и расхождение мельче их шага считается шумом.",
            )),
            Some(Noise { source: NoiseSource::Returns, .. }) => notes.push(Text::pair(
                "No command was measured twice in a run: the noise is estimated from what the same commands read in other runs, for neighbouring rows differ by far more.",
                "Ни одна точка не измерена в серии дважды: шум оценён по отсчётам тех же точек в других сериях, так как соседние строки различаются куда сильнее.",
            )),
            Some(Noise { source: NoiseSource::Forms, .. }) => notes.push(Text::pair(
                "No command was measured twice in a run: the noise is what a form of second degree leaves of each run, for rows measured one after the other differ by far more.",
                "Ни одна точка не измерена в серии дважды: шумом взято то, что в каждой серии остаётся от формы второй степени, так как соседние по времени строки различаются куда сильнее.",
            )),
            None => notes.push(Text::pair(
                "There are neither repeats nor neighbours to tell noise from gap.",
                "Нет ни повторов, ни соседних строк, чтобы отличить шум от расхождения.",
            )),
            Some(noise) if noise.is_slow() => notes.push(both!(
                "Repeats of one command scatter {:.1} times as much as neighbouring readings: something changes between the passes (temperature, machine or instrument), and the repeats' scatter is not noise alone.",
                "Повторы одной точки разбросаны в {:.1} раза сильнее соседних отсчётов: между проходами что-то меняется (температура, станок или прибор), и разброс повторов — не только шум.",
                noise.slow
            )),
            Some(_) => {}
        }
        if !self.model.caution.is_none() {
            notes.push(both!(
                "Neighbouring readings hang together (correlation {:.2} from one to the next): intervals and tests count them as {:.0} % of as many independent ones.",
                "Соседние отсчёты связаны (корреляция {:.2} от одного к следующему): интервалы и критерии считают их за {:.0} % стольких же независимых.",
                self.model.caution.lag(1),
                100.0 / self.model.caution.as_one()
            ));
        }
        notes.extend(self.setup_notes());
        let even = self.model.library.sampling.iter().zip(["X", "Y", "Z"]).filter(|(s, _)| s.hides_turns());
        let even: Vec<Text> =
            even.map(|(s, axis)| both!("{axis} {:.1} mm", "{axis} {:.1} мм", s.spacing_mm)).collect();
        if !even.is_empty() {
            notes.push(both!(
                "Even steps ({}): an error within a turn of a screw shows as a slow curve there, or not at all; uneven ones show it (ISO 230-2 asks for them).",
                "Шаги равны ({:#}): погрешность в пределах оборота винта выглядит медленной кривой или не видна вовсе; её покажут неравные (их требует ISO 230-2).",
                Text::join(&even, ", ")
            ));
        }
        if let Some(ratio) = self.noise_ratio().filter(|r| !(1.0 / 1.6..=1.6).contains(r)) {
            notes.push(both!(
                "The scatter of the rows is {ratio:.2} times what u_um says; the rows' own scatter was used.",
                "Разброс строк в {ratio:.2} раза отличается от названного в u_um; взят собственный разброс строк."
            ));
        }
        let model = self.model;
        notes.extend(jerks(self.data, &model.scalars, &model.solution.residuals_um).into_iter().map(|found| {
            both!(
                "{} moves in jerks below {:.0} mm/min: there it scatters {:.1} times as much from reading to reading as when it is faster (stick-slip, or a drive that hunts). No effect describes that and no correction removes it: see to guideways, lubrication and drive.",
                "{} ниже {:.0} мм/мин идёт рывками: там разброс от отсчёта к отсчёту в {:.1} раза больше, чем на большей скорости (скачкообразное движение или рыскающий привод). Ни один эффект этого не описывает, и никакая коррекция не уберёт: займитесь направляющими, смазкой и приводом.",
                ["X", "Y", "Z"][found.axis], found.below_mm_min, found.ratio
            )
        }));
        if let Some(refused) = &self.model.refused {
            let (kind, reason) = (refused.kind, refused.reason.words());
            notes.push(both!(
                "{kind} was considered next and not named: {reason}.",
                "Следующим рассматривался {kind} и не назван: {reason:#}."
            ));
        }
        notes
    }

    /// What the set-up holds that its reader should know.
    fn setup_notes(&self) -> Vec<Text> {
        let setup = self.setup();
        let mut notes = Vec::new();
        if self.model.clamping == Clamping::Turned {
            let apart = |about: usize| {
                let turns = setup.run_rotations_urad.iter().map(|(_, turn)| turn[about]);
                let (low, high) =
                    turns.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                high - low
            };
            notes.push(both!(
                "The runs are turned against each other by up to {:.0} urad: every run has a set-up of its own (clamping), and that is taken out of the gap.",
                "Серии повёрнуты друг относительно друга до {:.0} мкрад: у каждой своя установка (закрепление), и это вычтено из расхождения.",
                (0..3).map(apart).fold(0.0, f64::max)
            ));
        }
        for (instrument, zeros) in &setup.instruments_um {
            let axis = (0..3).max_by(|a, b| zeros[*a].0.abs().total_cmp(&zeros[*b].0.abs())).unwrap_or(0);
            let (value, u95) = zeros[axis];
            if value.abs() > u95 && value.abs() > 2.0 * self.noise_variance().sqrt() {
                let name = |i: usize| self.data.instruments.get(i).map_or("?", String::as_str);
                notes.push(both!(
                    "The instruments {} and {} disagree by {:.1} ± {u95:.1} um in {}: taken out as set-up; which of them is right these rows do not say.",
                    "Приборы {} и {} расходятся на {:.1} ± {u95:.1} мкм по {}: вычтено как установка; который из них прав, эти строки не говорят.",
                    name(0),
                    name(*instrument),
                    value.abs(),
                    ["X", "Y", "Z"][axis]
                ));
            }
        }
        notes
    }

    /// What the reader of a forecast for other commands must know: where they lie outside what was measured, and
    /// where the rivals of a cause would have it otherwise.
    pub(crate) fn forecast_notes(&self, holdout: &Measurements, causes: &[Cause]) -> Vec<Text> {
        type Value = fn(&Row) -> Option<f64>;
        let mut notes = Vec::new();
        let mut beyond: Vec<Text> = Vec::new();
        let values: [(Text, Value); 6] = [
            (Text::pair("X", "X"), |r| Some(r.command.linear_mm.x)),
            (Text::pair("Y", "Y"), |r| Some(r.command.linear_mm.y)),
            (Text::pair("Z", "Z"), |r| Some(r.command.linear_mm.z)),
            (Text::pair("the tool's length", "длина инструмента"), |r| {
                Some(r.command.tool_mm.z)
            }),
            (Text::pair("the feed", "подача"), |r| r.conditions.feed_mm_min),
            (Text::pair("the load", "нагрузка"), |r| r.conditions.load_kg),
        ];
        for (name, value) in values {
            let ends = |data: &Measurements| {
                let known = data.rows.iter().filter_map(value);
                known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
            };
            let ((low, high), (from, to)) = (ends(self.data), ends(holdout));
            // A tenth of the range beyond its ends is still the same neighbourhood.
            let slack = 0.1 * (high - low) + 1e-6;
            if from < low - slack || to > high + slack {
                beyond.push(name);
            }
        }
        if !beyond.is_empty() {
            notes.push(both!(
                "The hold-out lies outside what was measured in {}: the predicted shrinkage is an extrapolation there.",
                "Контрольные измерения выходят за измеренное ({:#}): там прогноз — экстраполяция.",
                Text::join(&beyond, ", ")
            ));
        }
        let is_wide = |c: &&Cause| c.shrink_predicted.is_some_and(|shrink| shrink.high - shrink.low > 0.2);
        if let Some(open) = causes.iter().filter(is_wide).find(|c| !c.cannot_be_told_from.is_empty()) {
            notes.push(both!(
                "Whether {} or {} is the cause decides how far the gap shrinks on the hold-out: settle that before correcting there.",
                "От того, {} причина или {}, зависит, насколько уменьшится расхождение на контрольных измерениях: выясните это, прежде чем исправлять там.",
                open.effect,
                open.cannot_be_told_from.join(", ")
            ));
        }
        notes
    }
}
