//! What a profile says of programs and of the control that runs them.

use diagnostic::{Text, both};
use toolpath::{DrillPecks, DrillR, FlankFrom, TurningParameters};

use super::Lines;
use crate::profile::{AfterChange, BareLengths, Profile};

impl Profile {
    /// What is said of the machine's programs, where anything is.
    pub(super) fn write_program_rules(&self, out: &mut Lines) {
        let rules = &self.program;
        match rules.bare_lengths {
            Some(BareLengths::Increments) => {
                out.line(both!("programs     Z10 is ten increments", "программы    Z10 — это десять дискрет"))
            }
            Some(BareLengths::Millimetres) => {
                out.line(both!("programs     Z10 is Z10.", "программы    Z10 — это Z10."))
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
            out.line(both!("tool change  {}", "смена инстр. {:#}", Text::join(&axes, ", ")));
        }
        if let Some(mm) = rules.arc_tolerance_mm {
            out.line(both!(
                "arcs         radii may differ by {mm} mm",
                "дуги         радиусы могут различаться на {mm} мм"
            ));
        }
        self.write_cycles(out);
        if !rules.harmless_m_codes.is_empty() {
            let codes: Vec<String> = rules.harmless_m_codes.iter().map(|code| format!("M{code}")).collect();
            out.line(both!(
                "M codes      {} move neither an axis nor the frame",
                "функции M    {} не двигают ни осей, ни системы координат",
                codes.join(", ")
            ));
        }
        let stands = |(axis, deg): (char, Option<f64>)| deg.map(|deg| format!("{axis}{deg}"));
        let start: Vec<String> = "ABC".chars().zip(rules.rotary_start_deg).filter_map(stands).collect();
        if !start.is_empty() {
            out.line(both!("start        {}", "начало       {}", start.join(" ")));
        }
        for call in &rules.calls {
            let axes: String =
                "XYZABC".chars().zip(call.unknown).filter(|(_, is)| *is).map(|(axis, _)| axis).collect();
            let program = call.program.map_or_else(String::new, |program| format!(" P{program}"));
            let code = format!("{}{}{program}", call.letter, call.tenths / 10);
            let left = if axes.is_empty() {
                both!("moves nothing", "ничего не двигает")
            } else {
                both!("may move {axes}", "может двигать {axes}")
            };
            out.line(both!("left alone   {code} {left}", "без правки   {code} {left:#}"));
        }
    }

    /// What the control's cycles of lathes do.
    fn write_cycles(&self, out: &mut Lines) {
        let turning = &self.program.turning;
        let said: Vec<Text> = cycle_figures(turning).chain(cycle_manners(turning)).collect();
        if !said.is_empty() {
            out.line(both!("cycles       {}", "циклы        {:#}", Text::join(&said, ", ")));
        }
    }

    /// What the control computes itself.
    pub(super) fn write_kinematics(&self, out: &mut Lines) {
        if let Some(kinematics) = &self.kinematics {
            let axes = self.chain().axes().filter(|axis| !axis.is_linear());
            let centres: Vec<Text> = axes
                .map(|axis| {
                    let [x, y, z] = kinematics.centres_mm[axis.direction()];
                    both!("{} about {x} {y} {z} mm", "{} вокруг {x} {y} {z} мм", axis.letter())
                })
                .collect();
            out.line(both!("tip control  {}", "ведение вершины {:#}", Text::join(&centres, ", ")));
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
            let reference = rule.reference.map(|axis| {
                let axis = toolpath::AXIS_NAMES[3 + axis];
                both!("CYCLE800 by the angle of {axis}", "CYCLE800 по углу {axis}")
            });
            let rule: Vec<Text> = branch.into_iter().chain(turns).chain(reference).collect();
            if !rule.is_empty() {
                out.line(both!("tilted plane {}", "наклонная плоскость {:#}", Text::join(&rule, ", ")));
            }
            if let Some(circle) = kinematics.great_circle {
                let how = if circle {
                    Text::pair("along a great circle", "по дуге большого круга")
                } else {
                    Text::pair("each rotary axis evenly", "каждая поворотная ось равномерно")
                };
                out.line(both!("vectors      {how}", "векторы      {how:#}"));
            }
        }
    }
}

/// Numbers of the control's cycles of lathes.
fn cycle_figures(turning: &TurningParameters) -> impl Iterator<Item = Text> {
    let mm = || Text::pair(" mm", " мм");
    [
        (
            Text::pair("chamfer of threads", "сбег резьбы"),
            turning.thread_chamfer_leads,
            Text::pair(" leads", " ходов"),
        ),
        (
            Text::pair("its angle", "его угол"),
            turning.thread_chamfer_deg,
            Text::pair(" degrees", " градусов"),
        ),
        (Text::pair("escape of roughing", "отвод при черновой"), turning.roughing_escape_mm, mm()),
        (Text::pair("return of pecks", "отвод между врезаниями"), turning.groove_return_mm, mm()),
        (
            Text::pair("finishing passes of threads", "чистовых проходов резьбы"),
            turning.thread_finishing_passes,
            Text::pair("", ""),
        ),
        (Text::pair("their least infeed", "их наименьшее врезание"), turning.thread_least_mm, mm()),
        (Text::pair("their allowance", "их припуск"), turning.thread_allowance_mm, mm()),
        (Text::pair("return in drilling", "отвод при сверлении"), turning.drill_return_mm, mm()),
        (
            Text::pair("feed out of bored holes", "подача на выходе из расточки"),
            turning.bore_return_percent,
            Text::pair(" % of F", " % от F"),
        ),
    ]
    .into_iter()
    .filter_map(|(what, value, unit)| Some(both!("{what} {}{unit}", "{what:#} {}{unit:#}", value?)))
}

/// What the control's cycles of lathes do of several things that they could.
fn cycle_manners(turning: &TurningParameters) -> Vec<Text> {
    let mut said = Vec::new();
    if let Some(from) = turning.thread_flank_from {
        said.push(match from {
            FlankFrom::Start => {
                Text::pair("flanks count from the start", "боковые стороны считаются от начала")
            }
            FlankFrom::FirstPass => {
                Text::pair("flanks count from the first pass", "боковые стороны считаются от первого прохода")
            }
            FlankFrom::LastPass => Text::pair(
                "flanks count from the last pass",
                "боковые стороны считаются от последнего прохода",
            ),
        });
    }
    if let Some(pecks) = turning.drill_pecks {
        said.push(match pecks {
            DrillPecks::Chip => Text::pair("pecks break the chip", "врезания дробят стружку"),
            DrillPecks::Full => Text::pair("pecks go back to R", "после врезания отвод до R"),
        });
    }
    if let Some(r) = turning.drill_r {
        said.push(match r {
            DrillR::Place => Text::pair("R of holes is a place", "R отверстий — координата"),
            DrillR::Way => Text::pair("R of holes is a way", "R отверстий — расстояние"),
        });
    }
    if turning.plain_drawing {
        said.push(Text::pair("A, C and R of lines without a comma", "A, C и R прямых без запятой"));
    }
    if turning.nose_in_finishing {
        said.push(Text::pair(
            "G41 and G42 of contours in finishing alone",
            "G41 и G42 контуров только при чистовой",
        ));
    }
    said
}
