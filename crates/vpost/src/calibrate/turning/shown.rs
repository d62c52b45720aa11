//! What test pieces of a lathe say, as a page: readings on the curve through them, terms, what cannot be told apart.

use calibration::turning::{Change, Feature, FoundTerm, HeldOut, LEVEL, Term, TurnedReading};
use diagnostic::{Language, Text, both};
use machine_model::Unusable;
use maud::{Markup, html};
use report::chart::{Fitted, Points, fitted};
use report::page::{Section, figure, table_of};
use report::text::{Numbers, number, number_of_digits, shown};
use serde_json::Value;

use super::super::page::{Facts, Found};
use super::{Outcome, named, owner};
use crate::file;
use crate::turned::judged::{Form, Lead, mm, um};

/// Places of the fitted curve.
const PLACES: usize = 61;
/// A cone or barrel of less on the diameter is none, µm: below any micrometer's step.
const NOTHING_UM: f64 = 0.1;

/// What is shown.
pub(super) struct Pieces<'a> {
    pub(super) of: &'a Outcome<'a>,
    pub(super) language: Language,
    /// The hold-out got worse, so that nothing was written.
    pub(super) is_refuted: bool,
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
    pub(super) fn new(
        of: &'a Outcome<'a>,
        held: &[TurnedReading],
        language: Language,
        is_refuted: bool,
    ) -> Result<Self, Unusable> {
        let along = Placing { of };
        let (read, held) = (along.placed(of.rows)?, along.placed(held)?);
        Ok(Self { of, language, is_refuted, curve: along.curve()?, read, held })
    }

    fn say(&self, text: &Text) -> String {
        self.language.prose(text)
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
                    "Ни конуса, ни бочки сверх разброса эти образцы не показывают, Z от {low} до {high}"
                ),
            ),
            Some(form) => {
                let says = form.says();
                (
                    form.lead().word(),
                    both!(
                        "A cylinder, Z {low} to {high}, is not turned straight: {says}",
                        "Цилиндр, Z от {low} до {high}, точится не прямым: {says:#}"
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
            "С найденным в профиле диаметры отходят от кривой на {after} мкм вместо {before} мкм (среднеквадратичное)."
        );
        match self.of.holdout {
            Some(HeldOut { rows, rms_before_mm, rms_after_mm, max_after_mm }) => text.push(&both!(
                " Held-out diameters prove it: {rows} of them, {} \u{2192} {} \u{b5}m, at most {} \u{b5}m.",
                " Контрольные диаметры ({rows}): {} \u{2192} {} мкм, не больше {} мкм.",
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

    fn not_told_apart(&self) -> Vec<Text> {
        let pairs = &self.of.found.not_told_apart;
        let one = |[a, b]: &[Text; 2]| {
            let what_to_do = match (a.english(), b.english()) {
                ("growth", "wear") | ("wear", "growth") if !self.of.timed => {
                    both!(": add the column time_s", ": добавьте столбец time_s")
                }
                ("growth", "wear") | ("wear", "growth") => both!(
                    ": measure a second part with a new edge while warm, or cut the first size again when warm",
                    ": измерьте вторую деталь с новой кромкой на тёплом станке или снова проточите первый размер на тёплом"
                ),
                (_, "what else differs from part to part") => {
                    both!(": measure a further part", ": измерьте ещё одну деталь")
                }
                _ => Text::EMPTY,
            };
            both!(
                "These parts cannot tell apart {a} and {b}{what_to_do}",
                "По этим образцам не различить {a:#} и {b:#}{what_to_do:#}"
            )
        };
        pairs.iter().map(one).collect()
    }

    fn drawing(&self) -> Markup {
        let series = |series: usize, placed: &[Placed], name: Text| {
            let at = placed.iter().map(|p| (p.z_mm, p.placed_um)).collect();
            (Points { series, at }, self.say(&name))
        };
        let mut points = vec![series(0, &self.read, both!("measured", "измерено"))];
        if !self.held.is_empty() {
            points.push(series(1, &self.held, both!("held out", "контрольные")));
        }
        let drawn = Fitted {
            label: self.say(&both!("machine Z, mm; diameter, \u{b5}m", "Z станка, мм; диаметр, мкм")),
            points,
            curve: (self.curve.clone(), self.say(&both!("fitted", "подобранная кривая"))),
        };
        let described = self.say(&both!(
            "{} diameters, {} held out; they scatter by {} \u{b5}m",
            "диаметров {}, контрольных {}; разброс {} мкм",
            self.read.len(),
            self.held.len(),
            um(self.of.found.noise_mm * 1e3)
        ));
        let caption = both!(
            "Measured minus commanded diameter less what the base profile predicts, each part laid onto the curve by its own size, which is the tool's and not the profile's; growth with time is taken off. 95 % of the curve's places are known within \u{b1} {} \u{b5}m on the radius.",
            "Измеренный минус заданный диаметр за вычетом предсказания исходного профиля; каждая деталь положена на кривую по своему размеру: он от инструмента, а не от профиля; рост со временем снят. 95 % мест кривой известны в пределах \u{b1} {} мкм по радиусу.",
            um(self.of.found.field_u95_mm * 1e3)
        );
        let title = self.say(&both!("Diameters along Z", "Диаметры вдоль Z"));
        let drawing = fitted(self.language, &title, &described, &drawn);
        figure(self.language, &drawing, &self.say(&caption), Some(self.readings()))
    }

    fn readings(&self) -> Markup {
        let held = self.say(&both!("held out", "контрольный"));
        let row = |(placed, which): (&Placed, &str)| {
            vec![
                placed.part.clone(),
                mm(placed.z_mm),
                um(placed.read_um),
                um(placed.placed_um),
                um(placed.left_um),
                which.to_owned(),
            ]
        };
        let read = self.read.iter().map(|placed| (placed, ""));
        let rows: Vec<Vec<String>> =
            read.chain(self.held.iter().map(|placed| (placed, held.as_str()))).map(row).collect();
        let header = [
            both!("part", "деталь"),
            both!("Z, mm", "Z, мм"),
            both!("read, \u{b5}m", "отсчёт, мкм"),
            both!("on the curve's scale", "на шкале кривой"),
            both!("from the curve", "от кривой"),
            Text::EMPTY,
        ];
        table_of(self.language, &header, &[1, 2, 3, 4], &rows)
    }

    fn terms(&self) -> Markup {
        let found = self.of.found;
        let row = |own: &FoundTerm| {
            let (name, before, scale) = named(own.term, self.of.base);
            let said = match (own.is_significant, own.term.is_geometry()) {
                (false, _) => both!("not significant, not written", "незначимо, не записано"),
                (true, true) if self.is_refuted => both!("refuted, not written", "опровергнуто, не записано"),
                (true, true) => both!("for the profile", "в профиль"),
                (true, false) => both!("in the report only", "только в отчёте"),
            };
            vec![
                self.say(&own.term.words()),
                name.to_owned(),
                number_of_digits((before + own.value) * scale, 3),
                number_of_digits(own.u.half_width_95() * scale, 3),
                match own.u.freedom.is_finite() {
                    true => crate::number::short(own.u.freedom, 1),
                    false => "\u{221e}".to_owned(),
                },
                if own.f.is_finite() { number(own.f) } else { "\u{221e}".to_owned() },
                self.say(&said),
            ]
        };
        let rows: Vec<Vec<String>> = found.terms.iter().chain(&found.not_there).map(row).collect();
        let header = [
            both!("term", "составляющая"),
            both!("name", "имя"),
            both!("value", "значение"),
            both!("\u{b1} 95 %", "\u{b1} 95 %"),
            both!("degrees of freedom", "степеней свободы"),
            Text::same("F"),
            Text::EMPTY,
        ];
        let pairs = self.not_told_apart();
        html! {
            (table_of(self.language, &header, &[2, 3, 4, 5], &rows))
            p.muted { (self.say(&both!(
                "Values in the unit of the name, the base included. Written is what an F test at {} % shows.",
                "Значения в единице имени, вместе с исходным профилем. Записывается то, что значимо по критерию Фишера на уровне {} %.",
                number(LEVEL * 100.0)
            ))) }
            @if found.terms.len() > 1 {
                h3 { (self.say(&both!("Correlation and covariance", "Корреляция и ковариация"))) }
                (self.covariance())
            }
            h3 { (self.say(&both!("What cannot be told apart", "Что не различить"))) }
            @if pairs.is_empty() {
                p { (self.say(&both!("Nothing that was looked for.", "Ничего из того, что искалось."))) }
            } @else {
                ul { @for pair in &pairs { li { (self.say(pair)) } } }
            }
        }
    }

    /// Above the diagonal correlations, on and below it covariances in the units of the names.
    fn covariance(&self) -> Markup {
        let found = self.of.found;
        let scales: Vec<f64> = found.terms.iter().map(|own| named(own.term, self.of.base).2).collect();
        let at = |i: usize, k: usize| found.covariance[(i, k)];
        let cell = |i: usize, k: usize| {
            if k <= i {
                return format!("{:.3e}", at(i, k) * scales[i] * scales[k]).replacen('-', "\u{2212}", 1);
            }
            let both = (at(i, i) * at(k, k)).sqrt();
            if both > 0.0 { number_of_digits(at(i, k) / both, 2) } else { "\u{2014}".to_owned() }
        };
        let name = |own: &FoundTerm| own.term.words();
        let mut header = vec![Text::EMPTY];
        header.extend(found.terms.iter().map(name));
        let rows: Vec<Vec<String>> = (0..scales.len())
            .map(|i| {
                let cells = (0..scales.len()).map(|k| cell(i, k));
                std::iter::once(self.say(&name(&found.terms[i]))).chain(cells).collect()
            })
            .collect();
        let numbers: Vec<usize> = (1..header.len()).collect();
        html! {
            (table_of(self.language, &header, &numbers, &rows))
            p.muted { (self.say(&both!(
                "Above the diagonal correlations, on it and below covariances.",
                "Над диагональю — корреляции, на ней и под ней — ковариации."
            ))) }
        }
    }

    fn sizes(&self) -> Markup {
        let found = self.of.found;
        let row = |own: &calibration::turning::Offset| {
            vec![
                owner(own, self.of.parts),
                number_of_digits(own.radius_mm * 1e3, 2),
                own.u.map_or_else(|| "\u{2014}".to_owned(), |u| number_of_digits(u.half_width_95() * 1e3, 2)),
                number_of_digits(-2.0 * own.radius_mm, 4),
            ]
        };
        let rows: Vec<Vec<String>> = found.offsets.iter().map(row).collect();
        let header = [
            both!("tool or part", "инструмент или деталь"),
            both!("on the radius, \u{b5}m", "по радиусу, мкм"),
            Text::same("\u{b1} 95 %"),
            both!("wear of X to enter, mm on the diameter", "ввести износ X, мм по диаметру"),
        ];
        let scatter = match found.shared_mm {
            Some(shared_mm) => both!(
                "Parts differ by {} \u{b5}m beyond the scatter of single diameters (standard deviation).",
                "Детали отличаются на {} мкм сверх разброса отдельных диаметров (среднеквадратичное отклонение).",
                um(shared_mm * 1e3)
            ),
            None => both!(
                "The parts are too few to tell by how much they differ.",
                "Образцов слишком мало, чтобы сказать, насколько они отличаются."
            ),
        };
        html! {
            (table_of(self.language, &header, &[1, 2, 3], &rows))
            p.muted { (self.say(&both!(
                "The size of a tool is no geometry: enter it at the control, with the profile that was written in use.",
                "Размер инструмента — не геометрия: введите его на стойке, когда записанный профиль в работе."
            ))) " " (self.say(&scatter)) }
        }
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
                part: self.of.parts.parts[row.part].clone(),
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
    fn title(&self, _: Language) -> String {
        self.say(&both!("Test pieces", "Образцы токарного станка"))
    }

    fn head(&self, facts: &Facts, _: Language) -> Markup {
        let (word, wrong) = self.wrong();
        let files = facts.names();
        html! {
            p.muted { (self.say(&both!("Test pieces: {}", "Образцы: {}", shown(&files)))) }
            p { span.verdict { (self.say(&if self.is_refuted { both!("REFUTED", "ОПРОВЕРГНУТО") } else { word })) } }
            h1 { (self.say(&wrong)) }
            @if self.is_refuted {
                p { (self.say(&both!(
                    "Held-out diameters get worse by it: look for a sign, or for parts of another machine or clamping. Nothing was written.",
                    "Контрольные диаметры от этого становятся хуже: ищите ошибку в знаке или детали другого станка или установки. Ничего не записано."
                ))) }
            }
            p { (self.say(&self.gain())) }
            @if self.form().is_some_and(|form| form.lead() == Lead::Cone) {
                p { (self.say(&both!(
                    "A cone is a leaning axis: align headstock or tailstock, or let the profile correct it.",
                    "Конус — это наклон оси: выставьте переднюю или заднюю бабку либо исправляйте профилем."
                ))) }
            }
            @for pair in self.not_told_apart() { p { (self.say(&pair)) "." } }
            @match (&facts.written, self.is_refuted) {
                (_, true) => {}
                (Some(path), false) => p { (self.say(&both!("Written to {}.", "Записано в {}.", shown(&file::name(path))))) }
                (None, false) => p.muted { (self.say(&both!(
                    "No profile was written: add -o PROFILE.toml to correct by these parts.",
                    "Профиль не записан: добавьте -o PROFILE.toml, чтобы исправлять по этим образцам."
                ))) }
            }
        }
    }

    fn sections(&self, _: Language) -> Vec<Section> {
        vec![
            Section {
                id: "diameters",
                title: Text::pair("Diameters along Z", "Диаметры вдоль Z"),
                body: self.drawing(),
            },
            Section {
                id: "terms", title: Text::pair("What was found", "Что найдено"), body: self.terms()
            },
            Section {
                id: "sizes",
                title: Text::pair("Sizes of the tools", "Размеры инструментов"),
                body: self.sizes(),
            },
        ]
    }

    fn json(&self) -> Value {
        self.of.json()
    }

    fn csv(&self) -> String {
        String::new()
    }
}
