//! What to measure so that the causes can be told apart.

mod line;
mod lines;
mod program;
mod proposed;
mod rotary;

use std::fmt::Write;

use clap::ValueEnum;
use diagnostic::{Text, both, notice};
use gap_diagnosis::{Confounding, Diagnosis, Measurements, Reading, Row, confounding};
use machine_model::effects::{Conditions, EffectGeometry, EffectKind};
use machine_model::{Axis, Command, Vector};

use super::Model;
use crate::message::{Failure, OPTION};
use crate::settings::Settings;

use line::Line;
use lines::lines;
use proposed::proposed;
use rotary::rotary_lines;

/// The form of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// The rows to be filled in (CSV).
    Points,
    /// The motions (NC program in the profile's dialect).
    Program,
}

/// Lines to measure along.
#[derive(Debug)]
pub struct Plan {
    lines: Vec<Line>,
    title: String,
    /// What is to be known of them.
    pub note: Text,
}

impl Plan {
    /// Lines for the profile's axes and volume; the note says what they cannot separate.
    ///
    /// # Errors
    /// The volume is too small for lines.
    pub fn whole(model: &Model) -> Result<Self, Failure> {
        let tool_mm = Vector::from(model.profile.default_tool_mm);
        let mut lines = lines(model.profile.volume(), tool_mm)?;
        let (turning, missing) = rotary_lines(&model.profile, tool_mm, lines.len());
        lines.extend(turning);
        let note = summary(&lines, &confounding(&design(&lines, &model.geometry)), &missing);
        Ok(Self { lines, title: "measuring plan of vpost".to_owned(), note })
    }

    /// The measurement that a diagnosis proposes; the words of the proposal go with it.
    ///
    /// # Errors
    /// It proposes none, or one with a rotary axis turned.
    pub fn next(diagnosis: &Diagnosis, model: &Model) -> Result<Self, Failure> {
        let Some(next) = &diagnosis.next_measurement else {
            return Err(Failure::usage(notice!(OPTION;
                "there is no next measurement: the verdict is {}",
                "следующего измерения нет: заключение — {:#}", diagnosis.verdict.words();
                "leave out `--next`; `--plan` prints a measurement of the whole machine",
                "уберите `--next`; измерение всего станка печатает `--plan`"
            )));
        };
        let lines = proposed(next, model.profile.volume())?;
        Ok(Self { lines, title: next.text.english().to_owned(), note: next.text.clone() })
    }

    /// The rows in the columns of a measurement file, readings and conditions to be filled in.
    #[must_use]
    pub fn points(&self) -> String {
        points(&self.lines)
    }

    /// The same lines as an NC program, with a stop for each reading.
    ///
    /// # Errors
    /// There is no work offset for it.
    pub fn program(&self, settings: &Settings) -> Result<String, Failure> {
        program::text(&self.lines, &self.title, settings)
    }
}

/// Seconds from the start to each stop, as the machine would need them; to be replaced by what the clock said. A proposal
/// goes on where the rows that were measured end.
fn times(plan: &[Line]) -> Vec<Vec<f64>> {
    let mut now = plan.first().and_then(|line| line.conditions.time_s).unwrap_or(0.0);
    let mut here: Option<(Vector, [f64; 3])> = None;
    plan.iter()
        .map(|line| {
            now += line.wait_s;
            line.stops
                .iter()
                .map(|stop| {
                    // A degree takes as long as a millimetre.
                    let turned = |from: [f64; 3]| Vector::from(stop.rotary_deg) - Vector::from(from);
                    let way = here.map_or(0.0, |(mm, deg)| (stop.at_mm - mm).norm().max(turned(deg).norm()));
                    now += 60.0 * way / line.feed_mm_min + if line.flying { 0.0 } else { line::DWELL_S };
                    here = Some((stop.at_mm, stop.rotary_deg));
                    now
                })
                .collect()
        })
        .collect()
}

/// The rows in the columns of a measurement file, readings and conditions to be filled in.
fn points(plan: &[Line]) -> String {
    // Machines without rotary axes need no columns for them.
    let turns = plan.iter().any(|line| line.swing.is_some());
    let mut out = format!(
        "run,x_mm,y_mm,z_mm,{}dx_um,dy_um,dz_um,dir_x,dir_y,dir_z,feed_mm_min,tool_x_mm,tool_y_mm,tool_z_mm,load_kg,time_s,temp_c,repeat,u_um\n",
        if turns { "a_deg,b_deg,c_deg," } else { "" }
    );
    let filled = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v}"));
    for (line, times) in plan.iter().zip(times(plan)) {
        let (load_kg, temp_c) = (filled(line.conditions.load_kg), filled(line.conditions.temp_c[0]));
        for (stop, time) in line.stops.iter().zip(times) {
            let (q, t, d) = (stop.at_mm, line.tool_mm, stop.direction);
            // An axis at rest lags behind nothing: only readings on the fly have a feed.
            let feed = if line.flying { format!("{}", line.feed_mm_min) } else { String::new() };
            let [a, b, c] = stop.rotary_deg;
            let angles = if turns { format!("{a},{b},{c},") } else { String::new() };
            // Writing into a string cannot fail.
            let _ = writeln!(
                out,
                "{},{:.3},{:.3},{:.3},{angles},,,{},{},{},{feed},{:.3},{:.3},{:.3},{load_kg},{time:.0},{temp_c},{},",
                line.run, q.x, q.y, q.z, d[0], d[1], d[2], t.x, t.y, t.z, line.repeat
            );
        }
    }
    out
}

/// The plan as measurements without readings.
fn design(plan: &[Line], geometry: &EffectGeometry) -> Measurements {
    let mut data = Measurements {
        runs: Vec::new(),
        instruments: Vec::new(),
        rows: Vec::new(),
        geometry: geometry.clone(),
    };
    for (line, times) in plan.iter().zip(times(plan)) {
        data.runs.push(line.run.clone());
        for (stop, time) in line.stops.iter().zip(times) {
            let command = Command {
                linear_mm: stop.at_mm,
                rotary_rad: Vector::from(stop.rotary_deg.map(f64::to_radians)),
                tool_mm: line.tool_mm,
                direction: stop.direction,
                ..Default::default()
            };
            let unread = Reading::Displacement([Some(0.0); 3]);
            data.rows.push(Row {
                conditions: Conditions {
                    time_s: Some(time),
                    feed_mm_min: line.flying.then_some(line.feed_mm_min),
                    ..Conditions::default()
                },
                ..Row::new(data.runs.len() - 1, command, unread)
            });
        }
    }
    data
}

/// Why two effects look alike on any lines, where they do.
fn reason(a: EffectKind, b: EffectKind) -> Text {
    use EffectKind as K;
    match (a, b) {
        (K::Sag(_), K::Straightness { .. }) | (K::Straightness { .. }, K::Sag(_)) => Text::pair(
            "a droop with the overhang is a bow of that axis",
            "прогиб с вылетом — то же, что изгиб этой оси",
        ),
        (K::Warmup(_), K::Step(_)) | (K::Step(_), K::Warmup(_)) => Text::pair(
            "a quick warm-up is a step at its start",
            "быстрый прогрев — то же, что скачок в его начале",
        ),
        (K::Step(_) | K::Warmup(_), K::InstrumentDrift) | (K::InstrumentDrift, K::Step(_) | K::Warmup(_)) => {
            Text::pair(
                "a slow change is machine or instrument: watch a fixed target to tell them apart",
                "медленный уход — станка или прибора: чтобы различить, следите за неподвижной целью",
            )
        }
        _ => Text::pair(
            "on these lines they move the tool alike",
            "на этих линиях они двигают инструмент одинаково",
        ),
    }
}

fn summary(plan: &[Line], found: &Confounding, missing: &[Axis]) -> Text {
    let rows: usize = plan.iter().map(|l| l.stops.len()).sum();
    let hours = times(plan).last().and_then(|t| t.last().copied()).unwrap_or(0.0) / 3600.0;
    let mut text = both!(
        "{rows} rows in {} lines, about {hours:.1} hours; {} effects are told apart",
        "строк {rows}, линий {}, около {hours:.1} ч; различимых эффектов {}",
        plan.len(),
        found.effects.len() - found.hidden.len()
    );
    for (a, b, value) in found.pairs(Confounding::ALIKE) {
        text.push(&both!(
            "\nexcept {a} from {b} ({value:.3}): {}",
            "\nкроме {a} и {b} ({value:.3}): {:#}",
            reason(a, b)
        ));
    }
    for kind in &found.hidden {
        text.push(&both!(
            "\nexcept {kind}, which these lines do not show",
            "\nкроме {kind}: этих линий для него мало"
        ));
    }
    let rotary: Vec<String> = missing.iter().map(Axis::to_string).collect();
    if !rotary.is_empty() {
        text.push(&both!(
            "\nexcept everything of {}: X, Y and Z have not the travel to follow a target while it turns; measure one at several angles",
            "\nкроме всего, что относится к {}: осям X, Y и Z не хватает хода, чтобы следовать за целью при повороте; измерьте её под несколькими углами",
            rotary.join(", ")
        ));
    }
    text.push(&both!(
        "\nthermal and load effects are asked for once temp_c and load_kg are filled in with more than one value",
        "\nо тепловых эффектах и нагрузке будет спрошено, когда temp_c и load_kg заполнены разными значениями"
    ));
    text
}
