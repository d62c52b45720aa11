//! `vpost diagnose` for a lathe: measured parts in, which cause makes their radii wrong out.

use std::path::Path;

use calibration::turning::{
    Bar, Cause, CauseRow, Change, Feature, FoundCause, LatheDiagnosis, Stretch, TurnedReading, Verdict,
    lathe_causes,
};
use diagnostic::{Speaks, Text, both};
use machine_profile::{LatheParts, Profile};
use measurement_files::{Row, numbered};
use serde_json::{Value, json};

use super::Diagnose;
use crate::arguments::Shared;
use crate::calibrate::codes::{CELL, UNITS, question};
use crate::calibrate::sources;
use crate::calibrate::turning::{MOST_UM, base_of, by_effects, part_name, stood_at, vector_mm};
use crate::figures::round;
use crate::file;
use crate::message::{Failure, Messages};

mod page;

const COLUMNS: &str = "part z_mm diameter_mm d_um deviation_um angle_deg tool time_s u_um temp_c note";
const EXPECTED: Text = Text::pair(
    "expected: part,z_mm,diameter_mm,d_um, or deviation_um with angle_deg",
    "ожидалось: part,z_mm,diameter_mm,d_um или deviation_um с angle_deg",
);

/// The file of a profile.
pub(super) struct ProfileFile {
    /// As it was given.
    pub(super) name: String,
    /// Of it and its tables.
    pub(super) hash: String,
}

/// Parts that were read.
#[derive(Default)]
struct Parts {
    read: sources::Read<CauseRow>,
    also: Also,
}

/// What else rows say.
#[derive(Default)]
struct Also {
    /// The rows as the model takes them.
    commands: Vec<TurnedReading>,
    parts: Vec<String>,
    tools: Vec<String>,
}

/// `vpost diagnose PARTS.csv -m LATHE`
pub(super) fn run(
    arguments: &Diagnose,
    profile: &Profile,
    lathe: &LatheParts,
    profile_file: &ProfileFile,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    only_what_a_lathe_has(arguments)?;
    let Some(measurements) = &arguments.measurements else { return Ok(()) };
    let mut parts = Parts::default();
    parts.read(measurements, profile, &arguments.ignore_column)?;
    let seen = parts.read.rows.len();
    if let Some(path) = &arguments.holdout {
        parts.read(path, profile, &arguments.ignore_column)?;
    }
    parts.fit_each_other(lathe)?;
    parts.predict(profile, lathe, shared)?;
    let bar = lathe.bar.as_ref().map(|bar| Bar {
        length_mm: bar.diameters_mm.last().map_or(0.0, |[z, _]| *z),
        chuck_mm: lathe.spindle.centre_mm.z,
        youngs_modulus_n_mm2: bar.youngs_modulus_n_mm2,
        clamping: bar.clamping,
        steady_rests_mm: bar.steady_rests_mm.clone(),
    });
    let (rows, held) = parts.read.rows.split_at(seen);
    let found = lathe_causes(rows, held, bar.as_ref()).map_err(|error| {
        question(
            error.text(),
            both!("run `vpost profile check` on the profile", "запустите `vpost profile check` для профиля"),
        )
    })?;
    let said = Said { found: &found, rows, lathe, parts: &parts };
    let json = jobs::summary::json(&said.json());
    if let Some(path) = &arguments.json {
        file::write(path, &json)?;
    }
    if let Some(path) = &arguments.html {
        let facts =
            page::Facts { measurements, holdout: arguments.holdout.as_deref(), profile, profile_file };
        let page = page::html(&said, &facts, &String::from_utf8_lossy(&json), messages.language())?;
        file::write(path, page.as_bytes())?;
    }
    file::print(said.text().in_language(messages.language()).as_bytes())
}

/// What only mills have yet is refused by its option.
fn only_what_a_lathe_has(arguments: &Diagnose) -> Result<(), Failure> {
    let given = [
        ("--plan", arguments.plan.is_some()),
        ("--next", arguments.next.is_some()),
        ("--viewer", arguments.viewer.is_some()),
        ("--write-profile", arguments.write_profile.is_some()),
        ("--without", !arguments.without.is_empty()),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((option, _)) => Err(Failure::option(
            both!(
                "`{option}` is not there for the parts of a lathe",
                "`{option}` для деталей токарного станка нет"
            ),
            both!(
                "leave it out; `vpost calibrate turning` writes taper and barrel to a profile",
                "уберите его; конус и бочку в профиль записывает `vpost calibrate turning`"
            ),
        )),
    }
}

impl Also {
    fn one(&mut self, row: &Row<'_>, profile: &Profile) -> Result<CauseRow, Failure> {
        let name = part_name(row)?;
        let tool = row.text("tool");
        let tool_mm = vector_mm(profile, &tool).map_err(|help| {
            let message =
                both!("which tool of the profile is `{tool}`?", "какой это инструмент профиля — `{tool}`?");
            row.refuse(CELL, "tool", message, help)
        })?;
        let (diameter_um, radius_um) = (row.number("d_um")?, row.number("deviation_um")?);
        let angle_deg = row.number("angle_deg")?;
        // On the radius.
        let (read_um, column) = match (diameter_um, radius_um, angle_deg) {
            (Some(um), None, None) => (0.5 * um, "d_um"),
            (None, Some(um), Some(_)) => (um, "deviation_um"),
            _ => {
                let message = both!(
                    "a row holds a diameter, or a radius at an angle",
                    "в строке — диаметр или радиус под углом"
                );
                let help = both!(
                    "fill d_um alone, or deviation_um and angle_deg (about the spindle's axis)",
                    "заполните либо d_um, либо deviation_um и angle_deg (вокруг оси шпинделя)"
                );
                return Err(row.refuse(CELL, "d_um", message, help).into());
            }
        };
        if read_um.abs() > MOST_UM {
            let message = both!(
                "a deviation of {read_um} um is no error of a lathe",
                "отклонение {read_um} мкм — не погрешность токарного станка"
            );
            let help = both!(
                "it is measured minus commanded, in um: look for another column or unit",
                "это измеренное минус заданное, в мкм: ищите другой столбец или единицу"
            );
            return Err(row.refuse(UNITS, column, message, help).into());
        }
        let (z_mm, diameter_mm) = (row.needed("z_mm")?, row.needed("diameter_mm")?);
        let uncertainty_mm =
            row.number("u_um")?.map(|um| um * 1e-3 * if column == "d_um" { 0.5 } else { 1.0 });
        if diameter_mm <= 0.0 || uncertainty_mm.is_some_and(|u| u <= 0.0) {
            let message =
                both!("a diameter and an uncertainty are above 0", "диаметр и неопределённость больше 0");
            let help = both!("give the commanded diameter in mm", "дайте заданный диаметр в мм");
            return Err(row.refuse(CELL, "diameter_mm", message, help).into());
        }
        let command = stood_at(row, profile, tool_mm, z_mm, diameter_mm)?;
        let part = numbered(&mut self.parts, &name);
        let tool = (!tool.is_empty()).then(|| numbered(&mut self.tools, &tool));
        let time_s = row.number("time_s")?;
        self.commands.push(TurnedReading {
            part,
            tool,
            feature: Feature::Diameter,
            command,
            deviation_mm: 0.0,
            by_effects_mm: 0.0,
            uncertainty_mm: None,
            time_s,
        });
        Ok(CauseRow {
            part,
            tool,
            z_mm,
            diameter_mm,
            gap_mm: read_um * 1e-3,
            time_s,
            angle_rad: angle_deg.map(f64::to_radians),
            uncertainty_mm,
        })
    }
}

impl Parts {
    fn read(&mut self, path: &Path, profile: &Profile, ignore: &[String]) -> Result<(), Failure> {
        let sheet = sources::sheet(path, COLUMNS, EXPECTED, ignore)?;
        sheet.need(&["part", "z_mm", "diameter_mm"], EXPECTED)?;
        let also = &mut self.also;
        self.read.add(sheet, |row| also.one(row, profile))
    }

    /// Refuses rows that one noise does not describe, and what the model does not take off.
    fn fit_each_other(&self, lathe: &LatheParts) -> Result<(), Failure> {
        let of = |what: &dyn Fn(&CauseRow) -> bool| self.read.rows.iter().filter(|row| what(row)).count();
        let stated = of(&|row| row.uncertainty_mm.is_some());
        let angled = of(&|row| row.angle_rad.is_some());
        let is_some = |count: usize| count > 0 && count < self.read.rows.len();
        if is_some(stated) || (is_some(angled) && stated == 0) {
            return Err(question(
                both!(
                    "rows of several kinds, and not all state their uncertainty",
                    "строки разного рода, и не у всех указана неопределённость"
                ),
                both!(
                    "fill the column u_um in every row, or diagnose diameters and radii one after the other",
                    "заполните столбец u_um во всех строках или проводите диагностику диаметров и радиусов по отдельности"
                ),
            ));
        }
        if angled > 0 && !lathe.spindle.synchronous.is_none() {
            return Err(question(
                both!(
                    "the profile's error motion of the spindle is not taken off radii at an angle",
                    "погрешность вращения шпинделя из профиля из радиусов под углом не вычитается"
                ),
                both!(
                    "take the harmonics (EXS_cos_um and so on) out of the profile for this",
                    "для этого уберите из профиля гармоники (EXS_cos_um и другие)"
                ),
            ));
        }
        Ok(())
    }

    /// Takes off what the profile says of each row.
    fn predict(&mut self, profile: &Profile, lathe: &LatheParts, shared: &Shared) -> Result<(), Failure> {
        let base = base_of(profile, lathe);
        by_effects(&mut self.also.commands, profile, &base, shared)?;
        let stretch = Stretch { low_mm: 0.0, high_mm: 1.0 };
        let predicted =
            base.predicted_mm(&Change::default(), stretch, &self.also.commands).map_err(|error| {
                question(
                    error.text(),
                    both!("run `vpost profile check` on it", "запустите для него `vpost profile check`"),
                )
            })?;
        for (row, diameter_mm) in self.read.rows.iter_mut().zip(predicted) {
            row.gap_mm -= 0.5 * diameter_mm;
        }
        Ok(())
    }
}

/// What is said.
struct Said<'a> {
    found: &'a LatheDiagnosis,
    rows: &'a [CauseRow],
    lathe: &'a LatheParts,
    parts: &'a Parts,
}

impl Said<'_> {
    fn text(&self) -> Text {
        let found = self.found;
        let mut out = words(found.verdict);
        out.push(&Text::same("\n"));
        let mut line = |text: Text| {
            out.push(&text);
            out.push(&Text::same("\n"));
        };
        let (rms, noise, rows) = (found.rms_mm * 1e3, found.noise_mm * 1e3, self.rows.len());
        line(both!(
            "gap     {rms:.2} um RMS on the radius beyond sizes and clampings, noise {noise:.2} um ({rows} rows)",
            "невязка {rms:.2} мкм (среднеквадратичное, по радиусу, без размеров и установок), шум {noise:.2} мкм (строк {rows})"
        ));
        line(both!("        {}", "        {:#}", meaning(found.verdict)));
        if let Some(row) = found.outlier.and_then(|row| self.parts.read.row(row)) {
            let message = both!(
                "it does not belong to its part's others",
                "оно не вяжется с остальными показаниями той же детали"
            );
            let help = both!("measure it again, or take the row out", "измерьте снова или уберите строку");
            let (part, z) = (row.text("part"), row.text("z_mm"));
            line(both!(
                "        part {part}, Z {z}: {message}; {help}",
                "        деталь {part}, Z {z}: {message:#}; {help:#}"
            ));
        }
        for own in &found.causes {
            let numbers: Vec<String> =
                own.numbers.iter().map(|n| format!("{} {:.2} ± {:.2}", n.name, n.value, n.u95)).collect();
            let id = own.cause.id();
            let numbers = numbers.join(", ");
            line(both!("\ncause   {id}  {numbers}", "\nпричина {id}  {numbers}"));
            line(both!("        {}", "        {:#}", sentence(own)));
            let [before, after] = own.rms_mm.map(|mm| mm * 1e3);
            line(both!(
                "        RMS {before:.2} -> {after:.2} um",
                "        среднеквадратичное {before:.2} -> {after:.2} мкм"
            ));
            if !own.rivals.is_empty() {
                let rivals = own.rivals.join(", ");
                line(both!("        cannot be told from {rivals}", "        не отличить от: {rivals}"));
            }
            line(both!("        {}", "        {:#}", self.remedy(own)));
        }
        if let Some(unseen) = found.unseen {
            let (rows, [before, after]) = (unseen.rows, unseen.rms_mm.map(|mm| mm * 1e3));
            line(both!(
                "\nunseen parts: {before:.2} -> {after:.2} um RMS ({rows} rows, each part at its own size)",
                "\nконтрольные детали: {before:.2} -> {after:.2} мкм (строк {rows}, каждая деталь при своём размере)"
            ));
        }
        if let Some((text, _)) = self.next() {
            line(both!("\nmeasure next: {text}", "\nизмерить дальше: {text:#}"));
        }
        out
    }

    fn json(&self) -> Value {
        let found = self.found;
        let um = |mm: f64| round(mm * 1e3, 6);
        let cause = |own: &FoundCause| {
            let numbers = own
                .numbers
                .iter()
                .map(|n| json!({ "name": n.name, "value": round(n.value, 6), "u95": round(n.u95, 6) }));
            json!({
                "effect": own.cause.id(),
                "parameters": numbers.collect::<Vec<_>>(),
                "p": own.p,
                "cannot_be_told_from": own.rivals,
                "sentence": sentence(own).english(),
                "rms_before_um": um(own.rms_mm[0]),
                "rms_after_um": um(own.rms_mm[1]),
            })
        };
        json!({
            "schema": "vpost.diagnosis/1",
            "machine": "lathe",
            "verdict": found.verdict.name(),
            "gap": { "rows": self.rows.len(), "rms_um": um(found.rms_mm), "noise_um": um(found.noise_mm) },
            "asked": found.asked.iter().map(|cause| cause.id()).collect::<Vec<_>>(),
            "causes": found.causes.iter().map(cause).collect::<Vec<_>>(),
            "leftover": { "lack_of_fit_p": found.leftover_p },
            "outlier_row": found.outlier.map(|row| row + 1),
            "holdout": found.unseen.map(|unseen| json!({
                "rows": unseen.rows,
                "rms_before_um": um(unseen.rms_mm[0]),
                "rms_after_um": um(unseen.rms_mm[1]),
            })),
            "next_measurement": self.next().map(|(text, separates)| json!({ "text": text.english(), "separates": separates })),
        })
    }

    /// What to do about a cause.
    fn remedy(&self, own: &FoundCause) -> Text {
        match own.cause {
            Cause::Taper => match self.lathe.spindle.tailstock {
                Some(tailstock) => {
                    let offset_um = own.numbers[0].value * 1e-3 * tailstock.at_mm;
                    both!(
                        "Set the tailstock over, or add {offset_um:.2} to X of `offset_um` under [tailstock].",
                        "Выставьте заднюю бабку либо прибавьте {offset_um:.2} к X в `offset_um` раздела [tailstock]."
                    )
                }
                None => both!(
                    "Align the headstock, or add {:.2} to `EB0S_urad` under [spindle].",
                    "Выставьте переднюю бабку либо прибавьте {:.2} к `EB0S_urad` в разделе [spindle].",
                    own.numbers[1].value
                ),
            },
            Cause::Bending => both!(
                "Add it to `radial_force_n` under [workpiece], or cut with less depth, a sharper edge, a steady rest.",
                "Прибавьте её к `radial_force_n` в разделе [workpiece] либо точите с меньшей глубиной, острой кромкой, с люнетом."
            ),
            Cause::Runout => both!(
                "Look at the spindle's bearings: no correction of X and Z takes roundness away.",
                "Проверьте подшипники шпинделя: коррекцией X и Z некруглость не снять."
            ),
            Cause::Growth => both!(
                "Warm the spindle up before finishing, or correct the offset of X as it grows.",
                "Прогревайте шпиндель перед чистовой обработкой либо правьте коррекцию X по мере роста."
            ),
            Cause::Wear => both!(
                "Take it off the wear offset of X from part to part (twice of it on the diameter), or change the edge earlier.",
                "Вычитайте её из износа X от детали к детали (по диаметру вдвое больше) либо раньше меняйте кромку."
            ),
            Cause::Straightness => both!(
                "`vpost calibrate turning` writes it as EXZ.",
                "`vpost calibrate turning` записывает её как EXZ."
            ),
            Cause::Scale => both!("Measure the positioning of X.", "Измерьте позиционирование X."),
            Cause::Jaws => both!(
                "Clamp with less force, or with soft jaws turned to the diameter.",
                "Зажимайте слабее или в сырых кулачках, расточенных под диаметр."
            ),
        }
    }

    /// What would settle what is open.
    fn next(&self) -> Option<(Text, Vec<&str>)> {
        let open = self.found.causes.iter().find(|own| !own.rivals.is_empty())?;
        let has = |name: &str| open.rivals.iter().any(|rival| rival.contains(name));
        let text = match open.cause {
            Cause::Taper if has("tool.wear") || has("spindle.growth") => both!(
                "finish one part in the other direction along Z: what comes while it is cut turns round, a taper does not",
                "обточите одну деталь в обратном направлении по Z: то, что набегает за проход, перевернётся, конус — нет"
            ),
            Cause::Taper | Cause::Straightness | Cause::Bending => both!(
                "a part of half the diameter, held the same: bending grows sixteenfold, geometry stays",
                "деталь половинного диаметра в той же установке: прогиб вырастет в шестнадцать раз, геометрия останется"
            ),
            Cause::Growth | Cause::Wear | Cause::Scale => both!(
                "with time_s filled in, one part with a new edge while warm, and the first diameter again",
                "с заполненным time_s одну деталь новой кромкой на тёплом станке и снова первый диаметр"
            ),
            Cause::Jaws | Cause::Runout => {
                both!(
                    "a part between centres, at twelve angles or more",
                    "деталь в центрах, не меньше чем под двенадцатью углами"
                )
            }
        };
        let separates = std::iter::once(open.cause.id()).chain(open.rivals.iter().map(String::as_str));
        Some((text, separates.collect()))
    }
}

/// A verdict as people read it: the words that the diagnosis of a mill has for it.
const fn words(verdict: Verdict) -> Text {
    use gap_diagnosis::Verdict as Of;
    match verdict {
        Verdict::NoGap => Of::NoGap,
        Verdict::Named => Of::Named,
        Verdict::Ambiguous => Of::Ambiguous,
        Verdict::Partial => Of::Partial,
        Verdict::Unknown => Of::Unknown,
        Verdict::NoiseModelSuspect => Of::NoiseModelSuspect,
        Verdict::Underpowered => Of::Underpowered,
    }
    .words()
}

/// A verdict in a sentence.
fn meaning(verdict: Verdict) -> Text {
    match verdict {
        Verdict::NoGap => both!("nothing but noise is left", "кроме шума ничего нет"),
        Verdict::Named => both!(
            "every cause that is told can be nothing else in the list",
            "ни одну из названных причин не принять за другую из списка"
        ),
        Verdict::Ambiguous => {
            both!(
                "a cause may be another: do not repair by it yet",
                "причина может быть и другой: чинить по ней рано"
            )
        }
        Verdict::Partial => {
            both!(
                "something is left that no cause explains",
                "остаётся то, чего ни одна причина не объясняет"
            )
        }
        Verdict::Unknown => both!(
            "something is there that no cause of the list explains, or unseen parts refute what was found",
            "есть то, чего ни одна причина из списка не объясняет, или контрольные детали опровергают найденное"
        ),
        Verdict::NoiseModelSuspect => {
            both!(
                "a reading is none: look at it first",
                "одно из показаний неверно: сначала разберитесь с ним"
            )
        }
        Verdict::Underpowered => both!(
            "too few readings or parts: twelve rows of two parts at least, several places along Z",
            "мало показаний или деталей: не меньше двенадцати строк двух деталей, несколько мест вдоль Z"
        ),
    }
}

/// A cause in a sentence.
fn sentence(own: &FoundCause) -> Text {
    let value = own.numbers.first().map_or(0.0, |number| number.value);
    match own.cause {
        Cause::Taper => both!(
            "the axis of the part leans against Z: {:.1} um on the diameter over 100 mm",
            "ось детали наклонена к Z: {:.1} мкм по диаметру на 100 мм",
            value * 0.2
        ),
        Cause::Bending => both!(
            "the part gives way to {value:.0} N more than the profile says",
            "деталь отжимается силой, на {value:.0} Н большей, чем в профиле"
        ),
        Cause::Runout => both!(
            "the spindle's axis moves the same way every turn: {value:.2} um at two waves a turn",
            "ось шпинделя движется одинаково каждый оборот: {value:.2} мкм при двух волнах на оборот"
        ),
        Cause::Growth => both!(
            "the radius changes by {value:.1} um from the first reading to the last, with the time",
            "радиус меняется со временем на {value:.1} мкм от первого показания к последнему"
        ),
        Cause::Wear => both!(
            "the radius changes by {value:.2} um from part to part of one edge",
            "радиус меняется на {value:.2} мкм от детали к детали одной кромки"
        ),
        Cause::Straightness => both!(
            "the carriage runs in a bow along Z: {value:.1} um in the middle against the ends, on the radius",
            "каретка идёт вдоль Z по дуге: {value:.1} мкм в середине относительно концов, по радиусу"
        ),
        Cause::Scale => both!(
            "the error goes with the diameter: {value:.0} um per metre of X",
            "погрешность идёт за диаметром: {value:.0} мкм на метр X"
        ),
        Cause::Jaws => both!(
            "three waves a turn of {value:.2} um, as three jaws press them",
            "три волны на оборот по {value:.2} мкм, как их выжимают три кулачка"
        ),
    }
}
