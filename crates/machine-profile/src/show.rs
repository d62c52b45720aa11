//! A profile for people, and its JSON Schema.

use std::fmt::Write as _;

use diagnostic::{Language, Text, both, say};
use machine_model::{Axis, EngineId};

use crate::format::Document;
use crate::profile::{AfterChange, BareLengths, FlankFrom, Outside, Profile};

/// The JSON Schema of `format = 1`.
#[must_use]
pub fn schema() -> String {
    let schema = schemars::schema_for!(Document);
    // A schema is plain data: maps with text keys, which JSON can always write.
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

/// A line in a language.
macro_rules! tell {
    ($out:expr, $language:expr, $($said:tt)+) => {
        writeln!($out, "{}", diagnostic::say!($language, $($said)+))
    };
}
pub(crate) use tell;

impl Profile {
    /// What the profile says, as text: one fact per line, units named.
    #[must_use]
    pub fn show(&self, language: Language) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut out, language);
        out
    }

    fn write(&self, out: &mut String, language: Language) -> std::fmt::Result {
        tell!(out, language, "machine      {}", "станок       {}", self.name)?;
        if let Some(control) = &self.control {
            tell!(out, language, "control      {control}", "ЧПУ          {control}")?;
        }
        match &self.lathe {
            None => tell!(out, language, "chain        {}", "цепь         {}", self.chain())?,
            Some(lathe) => {
                let spindle = &lathe.spindle;
                let [x, y, z] = [spindle.centre_mm.x, spindle.centre_mm.y, spindle.centre_mm.z];
                tell!(
                    out,
                    language,
                    "chain        {}, a lathe",
                    "цепь         {}, токарный станок",
                    lathe.chain
                )?;
                tell!(
                    out,
                    language,
                    "spindle      axis at X {x} Y {y} mm, chuck's face at Z {z} mm",
                    "шпиндель     ось на X {x} Y {y} мм, торец патрона на Z {z} мм"
                )?;
                if let Some(tail) = spindle.tailstock {
                    let [x, y] = tail.offset_mm.map(|mm| mm * 1e3);
                    tell!(
                        out,
                        language,
                        "tailstock    {} mm from the chuck, offset X {x:.1} Y {y:.1} um",
                        "задняя бабка {} мм от патрона, смещение X {x:.1} Y {y:.1} мкм",
                        tail.at_mm
                    )?;
                }
                if !lathe.bending.is_none() {
                    tell!(
                        out,
                        language,
                        "workpiece    bends by {:.3} um at most",
                        "деталь       прогиб не больше {:.3} мкм",
                        lathe.bending.largest_mm() * 1e3
                    )?;
                }
            }
        }
        if let Some(c) = &self.calibrated {
            let temperature = c.temperature_c.map(|t| format!("{t} °C"));
            let parts: Vec<String> =
                [c.date.clone(), temperature, c.instrument.clone()].into_iter().flatten().collect();
            tell!(out, language, "calibrated   {}", "калибровка   {}", parts.join(", "))?;
            if let Some(um) = c.repeatability_um {
                tell!(
                    out,
                    language,
                    "  repeats    within {um} um (standard deviation of one reading)",
                    "  повторяем. в пределах {um} мкм (стандартное отклонение одного отсчёта)"
                )?;
            }
            if let Some(um) = c.uncertainty_um {
                tell!(
                    out,
                    language,
                    "  known to   {um} um at the far corner (95 %)",
                    "  точность   {um} мкм в дальнем углу (95 %)"
                )?;
            }
        }
        let volume = self.volume();
        for (i, axis) in Axis::ALL[..3].iter().enumerate() {
            let data = &self.description.linear[i];
            let (travel, known) = (data.travel_mm, volume.0[i]);
            out.push_str(&say!(
                language,
                "axis {axis}       travel {} … {} mm, step {} mm",
                "ось {axis}        ход {} … {} мм, дискрета {} мм",
                travel.low,
                travel.high,
                self.resolution_mm[i]
            ));
            match &self.rows[i] {
                None => tell!(
                    out,
                    language,
                    ", no tables: taken as perfect",
                    ", таблиц нет: считается идеальной"
                )?,
                Some(rows) => {
                    tell!(
                        out,
                        language,
                        ", calibrated {} … {} mm, {} rows",
                        ", калибрована {} … {} мм, строк {}",
                        known.low,
                        known.high,
                        rows.rows.len()
                    )?;
                    for f in 0..6 {
                        let values = || rows.rows.iter().map(|row| row[f]);
                        let (low, high) = (
                            values().fold(f64::INFINITY, f64::min),
                            values().fold(f64::NEG_INFINITY, f64::max),
                        );
                        let symbol = format!("E{}{axis}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f]);
                        let (scale, unit) = if f < 3 {
                            (1e3, Text::pair("um", "мкм"))
                        } else {
                            (1e6, Text::pair("urad", "мкрад"))
                        };
                        if rows.given[f] {
                            tell!(
                                out,
                                language,
                                "  {symbol}        {:.2} … {:.2} {unit}",
                                "  {symbol}        {:.2} … {:.2} {unit:#}",
                                low * scale,
                                high * scale
                            )?;
                        } else {
                            tell!(
                                out,
                                language,
                                "  {symbol}        not measured: taken as 0",
                                "  {symbol}        не измерялась: принята за 0"
                            )?;
                        }
                    }
                }
            }
            if data.errors_negative.is_some() {
                tell!(
                    out,
                    language,
                    "  own tables for the negative direction",
                    "  для отрицательного направления свои таблицы"
                )?;
            }
            if data.backlash_mm != 0.0 {
                tell!(
                    out,
                    language,
                    "  backlash   {:.3} um",
                    "  люфт       {:.3} мкм",
                    data.backlash_mm * 1e3
                )?;
            }
        }
        let s = self.description.squareness;
        tell!(
            out,
            language,
            "squareness   EC0Y {:.2} urad, EB0Z {:.2} urad, EA0Z {:.2} urad",
            "перпендик.   EC0Y {:.2} мкрад, EB0Z {:.2} мкрад, EA0Z {:.2} мкрад",
            s.ec0y_rad * 1e6,
            s.eb0z_rad * 1e6,
            s.ea0z_rad * 1e6
        )?;
        for axis in self.chain().axes().filter(|axis| !axis.is_linear()) {
            let data = &self.description.rotary[axis.direction()];
            let c = data.centre_mm;
            let state = if data.is_perfect() {
                Text::pair("no errors given: taken as perfect", "погрешности не заданы: считается идеальной")
            } else {
                Text::pair("with errors", "с погрешностями")
            };
            tell!(
                out,
                language,
                "axis {axis}       centre {} {} {} mm, {state}",
                "ось {axis}        центр {} {} {} мм, {state:#}",
                c.x,
                c.y,
                c.z
            )?;
            if data.errors_negative.is_some() {
                tell!(
                    out,
                    language,
                    "  own tables for the negative direction",
                    "  для отрицательного направления свои таблицы"
                )?;
            }
            if data.backlash_rad != 0.0 {
                let urad = data.backlash_rad * 1e6;
                tell!(out, language, "  backlash   {urad:.3} urad", "  люфт       {urad:.3} мкрад")?;
            }
        }
        if let Some(traverses) = &self.traverses {
            let text: Vec<String> = traverses
                .iter()
                .map(|t| {
                    let (first, last) = (t.nodes_mm.first().copied(), t.nodes_mm.last().copied());
                    say!(
                        language,
                        "{} {} … {} mm",
                        "{} {} … {} мм",
                        Axis::ALL[t.axis],
                        first.unwrap_or(0.0),
                        last.unwrap_or(0.0)
                    )
                })
                .collect();
            tell!(out, language, "tracker      {}", "трекер       {}", text.join(", "))?;
        }
        if let Some(field) = &self.field {
            field.write(out, language)?;
        }
        let [x, y, z] = self.default_tool_mm;
        tell!(
            out,
            language,
            "tool         default {x} {y} {z} mm",
            "инструмент   по умолчанию {x} {y} {z} мм"
        )?;
        if let Some(length_mm) = self.gauge_point_mm {
            tell!(out, language, "  gauge point  {length_mm} mm", "  базовая точка {length_mm} мм")?;
        }
        for (number, [x, y, z]) in &self.tools {
            tell!(out, language, "  H{number}         {x} {y} {z} mm", "  H{number}         {x} {y} {z} мм")?;
        }
        for (name, [x, y, z]) in &self.work_offsets {
            tell!(out, language, "{name}          {x} {y} {z} mm", "{name}          {x} {y} {z} мм")?;
        }
        let c = self.correction;
        let outside = if c.outside == Outside::Refuse {
            Text::pair("refused", "отклоняется")
        } else {
            Text::pair("clamped", "берёт ближайшую точку")
        };
        let engine: EngineId = c.engine;
        tell!(
            out,
            language,
            "correction   engine {engine}, tolerance {} um, feed outside {outside}",
            "коррекция    метод {engine}, допуск {} мкм, рабочий ход вне объёма {outside:#}",
            c.tolerance_um
        )?;
        self.write_program_rules(out, language)?;
        for effect in &self.effects {
            let text: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            tell!(out, language, "effect       {} {}", "эффект       {} {}", effect.id, text.join(", "))?;
        }
        Ok(())
    }

    /// What is said of the machine's programs, where anything is.
    fn write_program_rules(&self, out: &mut String, language: Language) -> std::fmt::Result {
        let rules = &self.program;
        match rules.bare_lengths {
            Some(BareLengths::Increments) => tell!(
                out,
                language,
                "programs     Z10 is ten increments",
                "программы    Z10 — это десять дискрет"
            )?,
            Some(BareLengths::Millimetres) => {
                tell!(out, language, "programs     Z10 is Z10.", "программы    Z10 — это Z10.")?
            }
            None => {}
        }
        if rules.tool_change != [AfterChange::Unknown; 3] {
            let axis = |(name, change): (char, AfterChange)| match change {
                AfterChange::Unknown => both!("{name} anywhere", "{name} где угодно"),
                AfterChange::Stays => both!("{name} where it was", "{name} где была"),
                AfterChange::At(place_mm) => both!("{name} at {place_mm} mm", "{name} на {place_mm} мм"),
            };
            let axes: Vec<Text> = "XYZ".chars().zip(rules.tool_change).map(axis).collect();
            tell!(out, language, "tool change  {}", "смена инстр. {:#}", Text::join(&axes, ", "))?;
        }
        if let Some(mm) = rules.arc_tolerance_mm {
            tell!(
                out,
                language,
                "arcs         radii may differ by {mm} mm",
                "дуги         радиусы могут различаться на {mm} мм"
            )?;
        }
        let turning = &rules.turning;
        let said = [
            (
                Text::pair("chamfer of threads", "сбег резьбы"),
                turning.thread_chamfer_leads,
                Text::pair(" leads", " шагов"),
            ),
            (
                Text::pair("its angle", "его угол"),
                turning.thread_chamfer_deg,
                Text::pair(" degrees", " градусов"),
            ),
            (
                Text::pair("escape of roughing", "отскок при черновой"),
                turning.roughing_escape_mm,
                Text::pair(" mm", " мм"),
            ),
            (
                Text::pair("return of pecks", "отвод между врезаниями"),
                turning.groove_return_mm,
                Text::pair(" mm", " мм"),
            ),
            (
                Text::pair("finishing passes of threads", "чистовых проходов резьбы"),
                turning.thread_finishing_passes,
                Text::pair("", ""),
            ),
            (
                Text::pair("their least infeed", "их наименьшее врезание"),
                turning.thread_least_mm,
                Text::pair(" mm", " мм"),
            ),
            (
                Text::pair("their allowance", "их припуск"),
                turning.thread_allowance_mm,
                Text::pair(" mm", " мм"),
            ),
            (
                Text::pair("return in drilling", "отвод при сверлении"),
                turning.drill_return_mm,
                Text::pair(" mm", " мм"),
            ),
            (
                Text::pair("feed out of bored holes", "подача на выходе из расточки"),
                turning.bore_return_percent,
                Text::pair(" % of F", " % от F"),
            ),
        ];
        let mut said: Vec<Text> = said
            .into_iter()
            .filter_map(|(what, value, unit)| Some(both!("{what} {}{unit}", "{what:#} {}{unit:#}", value?)))
            .collect();
        if let Some(from) = turning.thread_flank_from {
            said.push(match from {
                FlankFrom::Start => {
                    Text::pair("flanks count from the start", "боковые стороны считаются от начала")
                }
                FlankFrom::FirstPass => Text::pair(
                    "flanks count from the first pass",
                    "боковые стороны считаются от первого прохода",
                ),
                FlankFrom::LastPass => Text::pair(
                    "flanks count from the last pass",
                    "боковые стороны считаются от последнего прохода",
                ),
            });
        }
        if let Some(chips) = turning.drill_chips {
            said.push(if chips {
                Text::pair("pecks break the chip", "врезания ломают стружку")
            } else {
                Text::pair("pecks go back to R", "после врезания отвод до R")
            });
        }
        if let Some(is_place) = turning.drill_r_is_place {
            said.push(if is_place {
                Text::pair("R of holes is a place", "R отверстий — координата")
            } else {
                Text::pair("R of holes is a way", "R отверстий — расстояние")
            });
        }
        if turning.nose_in_finishing {
            said.push(Text::pair(
                "G41 and G42 of contours in finishing alone",
                "G41 и G42 контуров только при чистовой",
            ));
        }
        if !said.is_empty() {
            tell!(out, language, "cycles       {}", "циклы        {:#}", Text::join(&said, ", "))?;
        }
        if !rules.harmless_m_codes.is_empty() {
            let codes: Vec<String> = rules.harmless_m_codes.iter().map(|code| format!("M{code}")).collect();
            tell!(
                out,
                language,
                "M codes      {} move neither an axis nor the frame",
                "функции M    {} не двигают ни осей, ни системы координат",
                codes.join(", ")
            )?;
        }
        if let Some(kinematics) = &self.kinematics {
            let axes = self.chain().axes().filter(|axis| !axis.is_linear());
            let centres: Vec<Text> = axes
                .map(|axis| {
                    let [x, y, z] = kinematics.centres_mm[axis.direction()];
                    both!("{} about {x} {y} {z} mm", "{} вокруг {x} {y} {z} мм", axis.letter())
                })
                .collect();
            tell!(out, language, "tip control  {}", "ведение вершины {:#}", Text::join(&centres, ", "))?;
            let rule = &kinematics.tilt_rule;
            let branch = rule.branch.map(|(axis, positive)| {
                let side = if positive {
                    Text::pair("above", "больше")
                } else {
                    Text::pair("below", "меньше")
                };
                both!("{} {side} 0", "{} {side:#} 0", toolpath::AXIS_NAMES[3 + axis])
            });
            let turns = rule.turns.map(|turns| match turns {
                toolpath::WholeTurns::Shortest => Text::pair("the shortest way", "кратчайшим путём"),
                toolpath::WholeTurns::Principal => {
                    Text::pair("between -180 and 180 degrees", "между -180 и 180 градусами")
                }
            });
            let rule: Vec<Text> = branch.into_iter().chain(turns).collect();
            if !rule.is_empty() {
                tell!(out, language, "tilted plane {}", "наклонная плоскость {:#}", Text::join(&rule, ", "))?;
            }
            if let Some(circle) = kinematics.great_circle {
                let how = if circle { "along a great circle" } else { "each rotary axis evenly" };
                writeln!(out, "vectors      {how}")?;
            }
        }
        Ok(())
    }
}
