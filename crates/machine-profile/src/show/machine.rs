//! Chain, calibration and axes of the machine.

use diagnostic::{Text, both};
use machine_model::engines::Made;
use machine_model::{Axis, Range};

use super::Lines;
use crate::field::MeasuredField;
use crate::profile::Profile;
use crate::tables::ErrorRows;

impl Profile {
    /// Its chain; of a lathe spindle and workpiece too.
    pub(super) fn write_chain(&self, out: &mut Lines) {
        match &self.lathe {
            None => out.line(both!("chain        {}", "цепь         {}", self.chain())),
            Some(lathe) => {
                let spindle = &lathe.spindle;
                let [x, y, z] = [spindle.centre_mm.x, spindle.centre_mm.y, spindle.centre_mm.z];
                out.line(both!("chain        {}, a lathe", "цепь         {}, токарный станок", lathe.chain));
                out.line(both!(
                    "spindle      axis at X {x} Y {y} mm, chuck's face at Z {z} mm",
                    "шпиндель     ось на X {x} Y {y} мм, торец патрона на Z {z} мм"
                ));
                if let Some(tail) = spindle.tailstock {
                    let [x, y] = tail.offset_mm.map(|mm| mm * 1e3);
                    out.line(both!(
                        "tailstock    {} mm from the chuck, offset X {x:.1} Y {y:.1} um",
                        "задняя бабка {} мм от патрона, смещение X {x:.1} Y {y:.1} мкм",
                        tail.at_mm
                    ));
                }
                if !lathe.bending.is_none() {
                    out.line(both!(
                        "workpiece    bends by {:.3} um at most",
                        "деталь       прогиб не больше {:.3} мкм",
                        lathe.bending.largest_mm() * 1e3
                    ));
                }
            }
        }
    }

    /// When and how well it was measured.
    pub(super) fn write_calibration(&self, out: &mut Lines) {
        if let Some(c) = &self.calibrated {
            let temperature = c.temperature_c.map(|t| format!("{t} °C"));
            let parts: Vec<String> =
                [c.date.clone(), temperature, c.instrument.clone()].into_iter().flatten().collect();
            out.line(both!("calibrated   {}", "калибровка   {}", parts.join(", ")));
            if let Some(um) = c.repeatability_um {
                out.line(both!(
                    "  repeats    within {um} um (standard deviation of one reading)",
                    "  повторяем. в пределах {um} мкм (стандартное отклонение одного отсчёта)"
                ));
            }
            if let Some(um) = c.uncertainty_um {
                out.line(both!(
                    "  known to   {um} um at the far corner (95 %)",
                    "  точность   {um} мкм в дальнем углу (95 %)"
                ));
            }
        }
    }

    /// Its linear axes.
    pub(super) fn write_linear_axes(&self, out: &mut Lines) {
        let volume = self.volume();
        for (i, axis) in Axis::ALL[..3].iter().enumerate() {
            let data = &self.description.linear[i];
            let (travel, known) = (data.travel_mm, volume.0[i]);
            out.say(&both!(
                "axis {axis}       travel {} … {} mm, step {} mm",
                "ось {axis}        ход {} … {} мм, дискрета {} мм",
                travel.low,
                travel.high,
                self.resolution_mm[i]
            ));
            match &self.rows[i] {
                None => out.line(both!(", no tables: taken as perfect", ", таблиц нет: считается идеальной")),
                Some(rows) => {
                    out.line(both!(
                        ", calibrated {} … {} mm, {} rows",
                        ", калибрована {} … {} мм, строк {}",
                        known.low,
                        known.high,
                        rows.rows.len()
                    ));
                    write_rows(out, *axis, rows);
                }
            }
            if data.errors_negative.is_some() {
                out.line(both!(
                    "  own tables for the negative direction",
                    "  для отрицательного направления свои таблицы"
                ));
            }
            if data.backlash_mm != 0.0 {
                out.line(both!("  backlash   {:.3} um", "  люфт       {:.3} мкм", data.backlash_mm * 1e3));
            }
        }
    }

    /// Its rotary axes.
    pub(super) fn write_rotary_axes(&self, out: &mut Lines) {
        for axis in self.chain().axes().filter(|axis| !axis.is_linear()) {
            let data = &self.description.rotary[axis.direction()];
            let c = data.centre_mm;
            let state = if data.is_perfect() {
                Text::pair("no errors given: taken as perfect", "погрешности не заданы: считается идеальной")
            } else {
                Text::pair("with errors", "с погрешностями")
            };
            out.line(both!(
                "axis {axis}       centre {} {} {} mm, {state}",
                "ось {axis}        центр {} {} {} мм, {state:#}",
                c.x,
                c.y,
                c.z
            ));
            let plus = self.plus_turns(axis);
            out.line(both!("  {plus}", "  {plus:#}"));
            if data.errors_negative.is_some() {
                out.line(both!(
                    "  own tables for the negative direction",
                    "  для отрицательного направления свои таблицы"
                ));
            }
            if data.backlash_rad != 0.0 {
                let urad = data.backlash_rad * 1e6;
                out.line(both!("  backlash   {urad:.3} urad", "  люфт       {urad:.3} мкрад"));
            }
        }
    }

    /// Its traverses of a tracker.
    pub(super) fn write_traverses(&self, out: &mut Lines) {
        if let Some(traverses) = &self.traverses {
            let text: Vec<Text> = traverses
                .iter()
                .map(|t| {
                    let [first, last] =
                        [t.nodes_mm.first(), t.nodes_mm.last()].map(|q| q.copied().unwrap_or(0.0));
                    both!("{} {first} … {last} mm", "{} {first} … {last} мм", Axis::ALL[t.axis])
                })
                .collect();
            out.line(both!("tracker      {}", "трекер       {:#}", Text::join(&text, ", ")));
        }
    }
}

impl MeasuredField {
    /// How its vectors are met, and where.
    pub(super) fn write(&self, out: &mut Lines) {
        let [low, high] = self.uncertainty_um;
        let how = match self.field.made() {
            Made::Lattice([x, y, z]) => {
                both!(
                    "a lattice of {x} x {y} x {z}, met exactly",
                    "решётка {x} x {y} x {z}, воспроизводится точно"
                )
            }
            Made::Smooth { residuals, .. } => {
                let noise = if low == high {
                    both!("{low} um", "{low} мкм")
                } else {
                    both!("{low} … {high} um", "{low} … {high} мкм")
                };
                both!(
                    "smoothed, noise {noise}, residuals {:.2} of what it says",
                    "сглажено, шум {noise:#}, остатки {:.2} от него",
                    residuals.sqrt()
                )
            }
        };
        out.line(both!(
            "field        {}: {} vectors, {how}",
            "поле         {}: векторов {}, {how:#}",
            self.file,
            self.vectors
        ));
        let volume = machine_model::Engine::volume(&self.field);
        let range =
            |(r, name): (&Range, &str)| both!("{name} {} … {} mm", "{name} {} … {} мм", r.low, r.high);
        let ranges: Vec<Text> = volume.0.iter().zip(["X", "Y", "Z"]).map(range).collect();
        let cut = if self.field.is_cut() {
            Text::pair(", without corners that no vector is near", ", без углов, где рядом нет векторов")
        } else {
            Text::EMPTY
        };
        out.line(both!("  volume     {}{cut}", "  объём      {:#}{cut:#}", Text::join(&ranges, ", ")));
        let tool = self.field.tool_mm();
        out.line(both!(
            "  tool       {} {} {} mm, and no other",
            "  инструмент {} {} {} мм, и никакой другой",
            tool.x,
            tool.y,
            tool.z
        ));
        let (shift, turn) = (self.frame[0] * 1e3, self.frame[1] * 1e6);
        out.line(both!("  as a whole shifted by {:.2} {:.2} {:.2} um, turned by {:.1} {:.1} {:.1} urad: of the machine or of the set-up", "  в целом сдвинуто на {:.2} {:.2} {:.2} мкм, повёрнуто на {:.1} {:.1} {:.1} мкрад: станок это или установка", shift.x, shift.y, shift.z, turn.x, turn.y, turn.z))
    }
}

/// The span of each error function of an axis.
fn write_rows(out: &mut Lines, axis: Axis, rows: &ErrorRows) {
    for f in 0..6 {
        let values = || rows.rows.iter().map(|row| row[f]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let symbol = format!("E{}{axis}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f]);
        let (scale, unit) =
            if f < 3 { (1e3, Text::pair("um", "мкм")) } else { (1e6, Text::pair("urad", "мкрад")) };
        if rows.given[f] {
            out.line(both!(
                "  {symbol}        {:.2} … {:.2} {unit}",
                "  {symbol}        {:.2} … {:.2} {unit:#}",
                low * scale,
                high * scale
            ));
        } else {
            out.line(both!(
                "  {symbol}        not measured: taken as 0",
                "  {symbol}        не измерялась: принята за 0"
            ));
        }
    }
}
