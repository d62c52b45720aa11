//! A profile for people, and its JSON Schema.

use std::fmt::Write as _;

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

impl Profile {
    /// What the profile says, as text: one fact per line, units named.
    #[must_use]
    pub fn show(&self) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut out);
        out
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "machine      {}", self.name)?;
        if let Some(control) = &self.control {
            writeln!(out, "control      {control}")?;
        }
        match &self.lathe {
            None => writeln!(out, "chain        {}", self.chain())?,
            Some(lathe) => {
                let spindle = &lathe.spindle;
                let [x, y, z] = [spindle.centre_mm.x, spindle.centre_mm.y, spindle.centre_mm.z];
                writeln!(out, "chain        {}, a lathe", lathe.chain)?;
                writeln!(out, "spindle      axis at X {x} Y {y} mm, chuck's face at Z {z} mm")?;
                if let Some(tail) = spindle.tailstock {
                    let [x, y] = tail.offset_mm.map(|mm| mm * 1e3);
                    writeln!(
                        out,
                        "tailstock    {} mm from the chuck, offset X {x:.1} Y {y:.1} um",
                        tail.at_mm
                    )?;
                }
                if !lathe.bending.is_none() {
                    writeln!(
                        out,
                        "workpiece    bends by {:.3} um at most",
                        lathe.bending.largest_mm() * 1e3
                    )?;
                }
            }
        }
        if let Some(c) = &self.calibrated {
            let temperature = c.temperature_c.map(|t| format!("{t} °C"));
            let parts: Vec<String> =
                [c.date.clone(), temperature, c.instrument.clone()].into_iter().flatten().collect();
            writeln!(out, "calibrated   {}", parts.join(", "))?;
            if let Some(um) = c.repeatability_um {
                writeln!(out, "  repeats    within {um} um (standard deviation of one reading)")?;
            }
            if let Some(um) = c.uncertainty_um {
                writeln!(out, "  known to   {um} um at the far corner (95 %)")?;
            }
        }
        let volume = self.volume();
        for (i, axis) in Axis::ALL[..3].iter().enumerate() {
            let data = &self.description.linear[i];
            let (travel, known) = (data.travel_mm, volume.0[i]);
            write!(
                out,
                "axis {axis}       travel {} … {} mm, step {} mm",
                travel.low, travel.high, self.resolution_mm[i]
            )?;
            match &self.rows[i] {
                None => writeln!(out, ", no tables: taken as perfect")?,
                Some(rows) => {
                    writeln!(
                        out,
                        ", calibrated {} … {} mm, {} rows",
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
                        let (scale, unit) = if f < 3 { (1e3, "um") } else { (1e6, "urad") };
                        if rows.given[f] {
                            writeln!(
                                out,
                                "  {symbol}        {:.2} … {:.2} {unit}",
                                low * scale,
                                high * scale
                            )?;
                        } else {
                            writeln!(out, "  {symbol}        not measured: taken as 0")?;
                        }
                    }
                }
            }
            if data.errors_negative.is_some() {
                writeln!(out, "  own tables for the negative direction")?;
            }
            if data.backlash_mm != 0.0 {
                writeln!(out, "  backlash   {:.3} um", data.backlash_mm * 1e3)?;
            }
        }
        let s = self.description.squareness;
        writeln!(
            out,
            "squareness   EC0Y {:.2} urad, EB0Z {:.2} urad, EA0Z {:.2} urad",
            s.ec0y_rad * 1e6,
            s.eb0z_rad * 1e6,
            s.ea0z_rad * 1e6
        )?;
        for axis in self.chain().axes().filter(|axis| !axis.is_linear()) {
            let data = &self.description.rotary[axis.direction()];
            let c = data.centre_mm;
            let state = if data.is_perfect() { "no errors given: taken as perfect" } else { "with errors" };
            writeln!(out, "axis {axis}       centre {} {} {} mm, {state}", c.x, c.y, c.z)?;
        }
        if let Some(traverses) = &self.traverses {
            let text: Vec<String> = traverses
                .iter()
                .map(|t| {
                    let (first, last) = (t.nodes_mm.first().copied(), t.nodes_mm.last().copied());
                    format!("{} {} … {} mm", Axis::ALL[t.axis], first.unwrap_or(0.0), last.unwrap_or(0.0))
                })
                .collect();
            writeln!(out, "tracker      {}", text.join(", "))?;
        }
        if let Some(field) = &self.field {
            field.write(out)?;
        }
        let [x, y, z] = self.default_tool_mm;
        writeln!(out, "tool         default {x} {y} {z} mm")?;
        if let Some(length_mm) = self.gauge_point_mm {
            writeln!(out, "  gauge point  {length_mm} mm")?;
        }
        for (number, [x, y, z]) in &self.tools {
            writeln!(out, "  H{number}         {x} {y} {z} mm")?;
        }
        for (name, [x, y, z]) in &self.work_offsets {
            writeln!(out, "{name}          {x} {y} {z} mm")?;
        }
        let c = self.correction;
        let outside = if c.outside == Outside::Refuse { "refused" } else { "clamped" };
        let engine: EngineId = c.engine;
        writeln!(
            out,
            "correction   engine {engine}, tolerance {} um, feed outside {outside}",
            c.tolerance_um
        )?;
        self.write_program_rules(out)?;
        for effect in &self.effects {
            let text: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            writeln!(out, "effect       {} {}", effect.id, text.join(", "))?;
        }
        Ok(())
    }

    /// What is said of the machine's programs, where anything is.
    fn write_program_rules(&self, out: &mut String) -> std::fmt::Result {
        let rules = &self.program;
        match rules.bare_lengths {
            Some(BareLengths::Increments) => writeln!(out, "programs     Z10 is ten increments")?,
            Some(BareLengths::Millimetres) => writeln!(out, "programs     Z10 is Z10.")?,
            None => {}
        }
        if rules.tool_change != [AfterChange::Unknown; 3] {
            let axis = |(name, change): (char, AfterChange)| match change {
                AfterChange::Unknown => format!("{name} anywhere"),
                AfterChange::Stays => format!("{name} where it was"),
                AfterChange::At(place_mm) => format!("{name} at {place_mm} mm"),
            };
            let axes: Vec<String> = "XYZ".chars().zip(rules.tool_change).map(axis).collect();
            writeln!(out, "tool change  {}", axes.join(", "))?;
        }
        if let Some(mm) = rules.arc_tolerance_mm {
            writeln!(out, "arcs         radii may differ by {mm} mm")?;
        }
        let turning = &rules.turning;
        let said = [
            ("chamfer of threads", turning.thread_chamfer_leads, " leads"),
            ("its angle", turning.thread_chamfer_deg, " degrees"),
            ("escape of roughing", turning.roughing_escape_mm, " mm"),
            ("return of pecks", turning.groove_return_mm, " mm"),
            ("finishing passes of threads", turning.thread_finishing_passes, ""),
            ("their least infeed", turning.thread_least_mm, " mm"),
            ("their allowance", turning.thread_allowance_mm, " mm"),
            ("return in drilling", turning.drill_return_mm, " mm"),
        ];
        let mut said: Vec<String> = said
            .into_iter()
            .filter_map(|(what, value, unit)| Some(format!("{what} {}{unit}", value?)))
            .collect();
        if let Some(from) = turning.thread_flank_from {
            said.push(match from {
                FlankFrom::Start => "flanks count from the start".to_owned(),
                FlankFrom::FirstPass => "flanks count from the first pass".to_owned(),
                FlankFrom::LastPass => "flanks count from the last pass".to_owned(),
            });
        }
        if let Some(chips) = turning.drill_chips {
            said.push(if chips { "pecks break the chip" } else { "pecks go back to R" }.to_owned());
        }
        if turning.nose_in_finishing {
            said.push("G41 and G42 of contours in finishing alone".to_owned());
        }
        if !said.is_empty() {
            writeln!(out, "cycles       {}", said.join(", "))?;
        }
        if !rules.harmless_m_codes.is_empty() {
            let codes: Vec<String> = rules.harmless_m_codes.iter().map(|code| format!("M{code}")).collect();
            writeln!(out, "M codes      {} move neither an axis nor the frame", codes.join(", "))?;
        }
        if let Some(kinematics) = &self.kinematics {
            let axes = self.chain().axes().filter(|axis| !axis.is_linear());
            let centres: Vec<String> = axes
                .map(|axis| {
                    let [x, y, z] = kinematics.centres_mm[axis.direction()];
                    format!("{} about {x} {y} {z} mm", axis.letter())
                })
                .collect();
            writeln!(out, "tip control  {}", centres.join(", "))?;
            let rule = &kinematics.tilt_rule;
            let branch = rule.branch.map(|(axis, positive)| {
                format!("{} {} 0", toolpath::AXIS_NAMES[3 + axis], if positive { "above" } else { "below" })
            });
            let turns = rule.turns.map(|turns| match turns {
                toolpath::WholeTurns::Shortest => "the shortest way".to_owned(),
                toolpath::WholeTurns::Principal => "between -180 and 180 degrees".to_owned(),
            });
            let rule: Vec<String> = branch.into_iter().chain(turns).collect();
            if !rule.is_empty() {
                writeln!(out, "tilted plane {}", rule.join(", "))?;
            }
            if let Some(circle) = kinematics.great_circle {
                let how = if circle { "along a great circle" } else { "each rotary axis evenly" };
                writeln!(out, "vectors      {how}")?;
            }
        }
        Ok(())
    }
}
