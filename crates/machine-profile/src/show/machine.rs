//! Chain, calibration and axes of the machine.

use std::fmt::Write as _;

use diagnostic::{Language, Text, say};
use machine_model::Axis;

use super::tell;
use crate::profile::Profile;
use crate::tables::ErrorRows;

impl Profile {
    /// Its chain; of a lathe spindle and workpiece too.
    pub(super) fn write_chain(&self, out: &mut String, language: Language) -> std::fmt::Result {
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
        Ok(())
    }

    /// When and how well it was measured.
    pub(super) fn write_calibration(&self, out: &mut String, language: Language) -> std::fmt::Result {
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
        Ok(())
    }

    /// Its linear axes.
    pub(super) fn write_linear_axes(&self, out: &mut String, language: Language) -> std::fmt::Result {
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
                    write_rows(out, language, *axis, rows)?;
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
        Ok(())
    }

    /// Its rotary axes.
    pub(super) fn write_rotary_axes(&self, out: &mut String, language: Language) -> std::fmt::Result {
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
            let plus = self.plus_turns(axis);
            tell!(out, language, "  {plus}", "  {plus:#}")?;
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
        Ok(())
    }

    /// Its traverses of a tracker.
    pub(super) fn write_traverses(&self, out: &mut String, language: Language) -> std::fmt::Result {
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
        Ok(())
    }
}

/// The span of each error function of an axis.
fn write_rows(out: &mut String, language: Language, axis: Axis, rows: &ErrorRows) -> std::fmt::Result {
    for f in 0..6 {
        let values = || rows.rows.iter().map(|row| row[f]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let symbol = format!("E{}{axis}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f]);
        let (scale, unit) =
            if f < 3 { (1e3, Text::pair("um", "мкм")) } else { (1e6, Text::pair("urad", "мкрад")) };
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
    Ok(())
}
