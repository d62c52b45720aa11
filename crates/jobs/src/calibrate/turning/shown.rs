//! What test pieces of a lathe say, as a page: readings on the curve through them, terms, what cannot be told apart.

use calibration::turning::{Change, Feature, FoundTerm, HeldOut, LEVEL, Term, TurnedReading};
use diagnostic::{Text, both};
use machine_model::Unusable;
use report::body::{Body, Table};
use report::chart::{Fitted, Points, fitted};
use report::numbers::{digits, figures, number, or_dash};
use report::page::Page;
use report::text::opening;
use serde_json::Value;

use super::super::page::{Facts, Found};
use super::found::{Outcome, named, owner};
use crate::turned::judged::{Form, Lead, mm, um};

/// Places of the fitted curve.
const PLACES: usize = 61;
/// A cone or barrel of less on the diameter is none, µm: below any micrometer's step.
const NOTHING_UM: f64 = 0.1;

/// What is shown.
pub(super) struct Pieces<'a> {
    pub(super) of: &'a Outcome<'a>,
    curve: Vec<(f64, f64)>,
    read: Vec<Placed>,
    held: Vec<Placed>,
}

/// A diameter beside the curve: its part laid on it by its own size, growth with time taken off.
struct Placed {
    part: String,
    z_mm: f64,
    /// As it was read, measured minus commanded, µm.
    read_um: f64,
    /// On the scale of the curve, µm on the diameter.
    placed_um: f64,
    /// From the curve, µm.
    left_um: f64,
}

impl<'a> Pieces<'a> {
    /// * `held` – readings that the adjustment did not see
    ///
    /// # Errors
    /// An axis' tables and its travel have no interval in common.
    pub(super) fn new(of: &'a Outcome<'a>, held: &[TurnedReading]) -> Result<Self, Unusable> {
        let along = Placing { of };
        let (read, held) = (along.placed(of.rows)?, along.placed(held)?);
        Ok(Self { of, curve: along.curve()?, read, held })
    }

    /// The cone and the barrel that were found, of the curve.
    fn form(&self) -> Option<Form> {
        let radii: Vec<(f64, f64)> = self.curve.iter().map(|(z, um)| (*z, 0.5 * um)).collect();
        // Of the curve alone: a mean is the tool's size.
        let form = Form { size_um: 0.0, ..Form::of(&radii)? };
        (form.cone_um.abs().max(2.0 * form.straightness_um) >= NOTHING_UM).then_some(form)
    }

    /// What is wrong, how bad.
    fn wrong(&self) -> (Text, Text) {
        let [low, high] = [self.of.found.stretch.low_mm, self.of.found.stretch.high_mm].map(mm);
        let written = self.of.found.terms.iter().any(|own| own.is_significant && own.term.is_geometry());
        match self.form().filter(|_| written) {
            None => (
                both!("NOTHING FOUND", "НИЧЕГО НЕ НАЙДЕНО"),
                both!(
                    "These parts show no taper and no barrel beyond what they scatter, Z {low} to {high}",
                    "Ни конуса, ни бочки сверх разброса эти образцы не показывают, Z от {low:#} до {high:#}"
                ),
            ),
            Some(form) => {
                let says = form.says();
                (
                    form.lead().word(),
                    both!(
                        "A cylinder, Z {low} to {high}, is not turned straight: {says}",
                        "Цилиндр, Z от {low:#} до {high:#}, точится не прямым: {says:#}"
                    ),
                )
            }
        }
    }

    /// What the correction will bring, by the rows that it was made of and by those that it was not.
    fn gain(&self) -> Text {
        let [before, after] = self.of.found.rms_mm.map(|mm| um(mm * 1e3));
        let mut text = both!(
            "With what was found in the profile the diameters lie {after} \u{b5}m from the curve where they lay {before} \u{b5}m (RMS).",
            "С найденным в профиле диаметры отходят от кривой на {after:#} мкм вместо {before:#} мкм (среднеквадратичное)."
        );
        match self.of.holdout {
            Some(HeldOut { rows, rms_before_mm, rms_after_mm, max_after_mm }) => text.push(&both!(
                " Held-out diameters prove it: {rows} of them, {} \u{2192} {} \u{b5}m, at most {} \u{b5}m.",
                " Контрольные диаметры ({rows}): {:#} \u{2192} {:#} мкм, не больше {:#} мкм.",
                um(rms_before_mm * 1e3),
                um(rms_after_mm * 1e3),
                um(max_after_mm * 1e3)
            )),
            None => text.push(&both!(
                " No diameters were held out: measure a further part and give it with --holdout, or these parts judge themselves.",
                " Контрольных диаметров нет: измерьте ещё одну деталь и дайте её ключом --holdout, иначе образцы судят сами себя."
            )),
        }
        text
    }

    fn drawing(&self, out: &mut Body) {
        let series = |series: usize, placed: &[Placed], name: Text| {
            let at = placed.iter().map(|p| (p.z_mm, p.placed_um)).collect();
            (Points { series, at }, name)
        };
        let mut points = vec![series(0, &self.read, both!("measured", "измерено"))];
        if !self.held.is_empty() {
            points.push(series(1, &self.held, both!("held out", "контрольные")));
        }
        let drawn = Fitted {
            label: both!("machine Z, mm; diameter, \u{b5}m", "Z станка, мм; диаметр, мкм"),
            points,
            curve: (self.curve.clone(), both!("fitted", "подобранная кривая")),
        };
        let (read, held, noise) = (self.read.len(), self.held.len(), um(self.of.found.noise_mm * 1e3));
        let described = both!(
            "{read} diameters, {held} held out; they scatter by {noise} \u{b5}m",
            "диаметров {read}, контрольных {held}; разброс {noise:#} мкм"
        );
        let caption = both!(
            "Measured minus commanded diameter less what the base profile predicts, each part laid onto the curve by its own size, which is the tool's and not the profile's; growth with time is taken off. 95 % of the curve's places are known within \u{b1} {} \u{b5}m on the radius.",
            "Измеренный минус заданный диаметр за вычетом предсказания исходного профиля; каждая деталь положена на кривую по своему размеру: он от инструмента, а не от профиля; рост со временем снят. 95 % мест кривой известны в пределах \u{b1} {:#} мкм по радиусу.",
            um(self.of.found.field_u95_mm * 1e3)
        );
        let read = self.read.iter().map(|placed| (placed, Text::EMPTY));
        let held = self.held.iter().map(|placed| (placed, both!("held out", "контрольный")));
        let readings = Table::of(read.chain(held))
            .words(both!("part", "деталь"), |(placed, _)| Text::same(&placed.part))
            .numbers(both!("Z, mm", "Z, мм"), |(placed, _)| mm(placed.z_mm))
            .numbers(both!("read, \u{b5}m", "отсчёт, мкм"), |(placed, _)| um(placed.read_um))
            .numbers(both!("on the curve's scale", "на шкале кривой"), |(placed, _)| {
                um(placed.placed_um)
            })
            .numbers(both!("from the curve", "от кривой"), |(placed, _)| um(placed.left_um))
            .words(Text::EMPTY, |(_, which)| which.clone());
        let title = both!("Diameters along Z", "Диаметры вдоль Z");
        out.figure_of(&fitted(out.language(), &title, &described, &drawn), &caption, &readings);
    }

    fn terms(&self, out: &mut Body) {
        let found = self.of.found;
        let said = |own: &FoundTerm| match (own.is_significant, own.term.is_geometry()) {
            (false, _) => both!("not significant, not written", "незначимо, не записано"),
            (true, true) if self.of.is_refuted => both!("refuted, not written", "опровергнуто, не записано"),
            (true, true) => both!("for the profile", "в профиль"),
            (true, false) => both!("in the report only", "только в отчёте"),
        };
        let finite = |value: f64, said: Text| if value.is_finite() { said } else { Text::same("\u{221e}") };
        let rows = found.terms.iter().chain(&found.not_there).map(|own| (own, named(own.term, self.of.base)));
        let table = Table::of(rows)
            .words(both!("term", "составляющая"), |(own, _)| own.term.words())
            .words(both!("name", "имя"), |(_, (name, ..))| Text::same(*name))
            .numbers(both!("value", "значение"), |(own, (_, before, scale))| {
                digits((before + own.value) * scale, 3)
            })
            .numbers(Text::same("\u{b1} 95 %"), |(own, (.., scale))| digits(own.u.half_width_95() * scale, 3))
            .numbers(both!("degrees of freedom", "степеней свободы"), |(own, _)| {
                finite(own.u.freedom, figures(crate::figures::short(own.u.freedom, 1)))
            })
            .numbers(Text::same("F"), |(own, _)| finite(own.f, number(own.f)))
            .words(Text::EMPTY, |(own, _)| said(own));
        out.table(&table);
        out.muted(&both!(
            "Values in the unit of the name, the base included. Written is what an F test at {} % shows.",
            "Значения в единице имени, вместе с исходным профилем. Записывается то, что значимо по критерию Фишера на уровне {:#} %.",
            number(LEVEL * 100.0)
        ));
        if found.terms.len() > 1 {
            out.heading(&both!("Correlation and covariance", "Корреляция и ковариация"));
            self.covariance(out);
        }
        out.heading(&both!("What cannot be told apart", "Что не различить"));
        let open: Vec<Text> = self.of.not_told_apart().iter().map(opening).collect();
        if open.is_empty() {
            out.p(&both!("Nothing that was looked for.", "Ничего из того, что искалось."));
        } else {
            out.list(&open);
        }
    }

    /// Above the diagonal correlations, on and below it covariances in the units of the names.
    fn covariance(&self, out: &mut Body) {
        let found = self.of.found;
        let scales: Vec<f64> = found.terms.iter().map(|own| named(own.term, self.of.base).2).collect();
        let at = |i: usize, k: usize| found.covariance[(i, k)];
        let cell = |i: usize, k: usize| {
            if k <= i {
                let value = format!("{:.3e}", at(i, k) * scales[i] * scales[k]);
                return figures(value.replacen('-', "\u{2212}", 1));
            }
            let both = (at(i, i) * at(k, k)).sqrt();
            or_dash((both > 0.0).then(|| at(i, k) / both), |correlation| digits(correlation, 2))
        };
        let mut table = Table::of(0..scales.len()).words(Text::EMPTY, |i| found.terms[*i].term.words());
        for (k, own) in found.terms.iter().enumerate() {
            table = table.numbers(own.term.words(), |i| cell(*i, k));
        }
        out.table(&table);
        out.muted(&both!(
            "Above the diagonal correlations, on it and below covariances.",
            "Над диагональю — корреляции, на ней и под ней — ковариации."
        ));
    }

    fn sizes(&self, out: &mut Body) {
        let found = self.of.found;
        let table = Table::of(&found.offsets)
            .words(both!("tool or part", "инструмент или деталь"), |own| {
                Text::same(owner(own, self.of.names))
            })
            .numbers(both!("on the radius, \u{b5}m", "по радиусу, мкм"), |own| {
                digits(own.radius_mm * 1e3, 2)
            })
            .numbers(Text::same("\u{b1} 95 %"), |own| {
                or_dash(own.u.map(|u| u.half_width_95() * 1e3), |half| digits(half, 2))
            })
            .numbers(
                both!("wear of X to enter, mm on the diameter", "ввести износ X, мм по диаметру"),
                |own| digits(-2.0 * own.radius_mm, 4),
            );
        out.table(&table);
        let scatter = match found.shared_mm {
            Some(shared_mm) => both!(
                "Parts differ by {} \u{b5}m beyond the scatter of single diameters (standard deviation).",
                "Детали отличаются на {:#} мкм сверх разброса отдельных диаметров (среднеквадратичное отклонение).",
                um(shared_mm * 1e3)
            ),
            None => both!(
                "The parts are too few to tell by how much they differ.",
                "Образцов слишком мало, чтобы сказать, насколько они отличаются."
            ),
        };
        out.muted(&both!(
            "The size of a tool is no geometry: enter it at the control, with the profile that was written in use. {scatter}",
            "Размер инструмента — не геометрия: введите его на стойке, когда записанный профиль в работе. {scatter:#}"
        ));
    }
}

/// Readings on the scale of what was found.
struct Placing<'a> {
    of: &'a Outcome<'a>,
}

impl Placing<'_> {
    /// What the change makes of a diameter, without the base, µm.
    fn changed_um(&self, rows: &[TurnedReading]) -> Result<Vec<f64>, Unusable> {
        let found = self.of.found;
        let after = self.of.base.predicted_mm(&found.change, found.stretch, rows)?;
        let before = self.of.base.predicted_mm(&Change::default(), found.stretch, rows)?;
        Ok(after.iter().zip(before).map(|(after, before)| (after - before) * 1e3).collect())
    }

    /// The curve at evenly placed Z, its mean zero.
    fn curve(&self) -> Result<Vec<(f64, f64)>, Unusable> {
        let Some(any) = self.of.rows.iter().find(|row| row.feature == Feature::Diameter) else {
            return Ok(Vec::new());
        };
        let stretch = self.of.found.stretch;
        let step_mm = (stretch.high_mm - stretch.low_mm) / (PLACES - 1) as f64;
        let rows: Vec<TurnedReading> = (0..PLACES)
            .map(|k| {
                let mut row = any.clone();
                row.command.linear_mm.z = stretch.low_mm + step_mm * k as f64;
                row
            })
            .collect();
        let values = self.changed_um(&rows)?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let z_mm = |row: &TurnedReading| row.command.linear_mm.z + row.command.tool_mm.z;
        Ok(rows.iter().zip(&values).map(|(row, um)| (z_mm(row), um - mean)).collect())
    }

    /// Diameters of parts with two and more, each laid onto the curve.
    fn placed(&self, rows: &[TurnedReading]) -> Result<Vec<Placed>, Unusable> {
        let rows: Vec<TurnedReading> =
            rows.iter().filter(|row| row.feature == Feature::Diameter).cloned().collect();
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let found = self.of.found;
        let curve = self.curve()?;
        let growth = found.terms.iter().find(|own| own.term == Term::Growth).map_or(0.0, |own| own.value);
        let base = self.of.base.predicted_mm(&Change::default(), found.stretch, &rows)?;
        let own = |k: usize| {
            let grown_mm = 2.0 * growth * rows[k].time_s.unwrap_or(0.0) / 3600.0;
            (rows[k].deviation_mm - base[k] - grown_mm) * 1e3
        };
        let z_mm = |row: &TurnedReading| row.command.linear_mm.z + row.command.tool_mm.z;
        let fitted_um = |row: &TurnedReading| between(&curve, z_mm(row));
        let left: Vec<f64> = (0..rows.len()).map(|k| own(k) - fitted_um(&rows[k])).collect();
        let mut out = Vec::new();
        for (k, row) in rows.iter().enumerate() {
            let same = |other: &TurnedReading| (other.part, other.tool) == (row.part, row.tool);
            let of_part: Vec<f64> =
                rows.iter().zip(&left).filter(|(other, _)| same(other)).map(|(_, left)| *left).collect();
            if of_part.len() < 2 {
                continue;
            }
            let left_um = left[k] - of_part.iter().sum::<f64>() / of_part.len() as f64;
            out.push(Placed {
                part: self.of.names.parts[row.part].clone(),
                z_mm: z_mm(row),
                read_um: row.deviation_mm * 1e3,
                placed_um: fitted_um(row) + left_um,
                left_um,
            });
        }
        Ok(out)
    }
}

/// Of places with values, between them a straight line, beyond them the end's value.
fn between(curve: &[(f64, f64)], z_mm: f64) -> f64 {
    let behind = curve.partition_point(|(z, _)| *z < z_mm);
    match (behind.checked_sub(1).and_then(|k| curve.get(k)), curve.get(behind)) {
        (Some((z0, v0)), Some((z1, v1))) => v0 + (v1 - v0) * (z_mm - z0) / (z1 - z0),
        (Some((_, value)), None) | (None, Some((_, value))) => *value,
        (None, None) => 0.0,
    }
}

impl Found for Pieces<'_> {
    fn title(&self) -> Text {
        both!("Test pieces", "Образцы токарного станка")
    }

    fn head(&self, out: &mut Body, facts: &Facts) {
        let (word, wrong) = self.wrong();
        out.muted(&both!("Test pieces: {}", "Образцы: {}", facts.names()));
        out.verdict(&if self.of.is_refuted { both!("REFUTED", "ОПРОВЕРГНУТО") } else { word }, &wrong);
        if self.of.is_refuted {
            out.p(&both!(
                "Held-out diameters get worse by it: look for a sign, or for parts of another machine or clamping. Nothing was written.",
                "Контрольные диаметры от этого становятся хуже: ищите ошибку в знаке или детали другого станка или установки. Ничего не записано."
            ));
        }
        out.p(&self.gain());
        if self.form().is_some_and(|form| form.lead() == Lead::Cone) {
            out.p(&both!(
                "A cone is a leaning axis: align headstock or tailstock, or let the profile correct it.",
                "Конус — это наклон оси: выставьте переднюю или заднюю бабку либо исправляйте профилем."
            ));
        }
        for open in self.of.not_told_apart().iter().map(opening) {
            out.p(&both!("{open}.", "{open:#}."));
        }
        if !self.of.is_refuted {
            facts.say_written(out);
        }
    }

    fn sections(&self, page: &mut Page) {
        self.drawing(page.section("diameters", both!("Diameters along Z", "Диаметры вдоль Z")));
        self.terms(page.section("terms", both!("What was found", "Что найдено")));
        self.sizes(page.section("sizes", both!("Sizes of the tools", "Размеры инструментов")));
    }

    fn json(&self) -> Value {
        self.of.json()
    }

    fn csv(&self) -> String {
        String::new()
    }
}
