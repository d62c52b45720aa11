//! `vpost diagnose --plan`: what to measure so that the causes can be told apart.

mod lines;
mod program;
mod proposed;

use std::fmt::Write;

use clap::ValueEnum;
use diagnostic::{Text, both};
use gap_diagnosis::{Confounding, Diagnosis, Measurements, Reading, Row, confounding};
use machine_model::effects::{Conditions, EffectGeometry, EffectKind};
use machine_model::{Command, Vector};

use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages};
use jobs::diagnose::Model;

use lines::{Line, lines};
use proposed::proposed;

/// What of a plan is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// The rows to be filled in (CSV).
    Points,
    /// The motions (NC program in the profile's dialect).
    Program,
}

/// Prints a plan for the profile's axes and volume, and says what it cannot separate.
pub(super) fn print(form: Form, model: &Model, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let plan = lines(model.profile.volume(), Vector::from(model.profile.default_tool_mm))?;
    print_lines(form, &plan, "measuring plan of vpost", shared, messages)?;
    let found = confounding(&design(&plan, &model.geometry));
    messages.note(&summary(&plan, &found, &model.geometry));
    Ok(())
}

/// Prints the measurement that a diagnosis proposes; the words of the proposal go with it.
pub(super) fn print_next(
    form: Form,
    diagnosis: &Diagnosis,
    model: &Model,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let Some(next) = &diagnosis.next_measurement else {
        return Err(Failure::option(
            both!(
                "there is no next measurement: the verdict is {}",
                "следующего измерения нет: заключение — {:#}",
                diagnosis.verdict.words()
            ),
            both!(
                "leave out `--next`; `--plan` prints a measurement of the whole machine",
                "уберите `--next`; измерение всего станка печатает `--plan`"
            ),
        ));
    };
    print_lines(form, &proposed(next, model.profile.volume())?, next.text.english(), shared, messages)?;
    messages.note(&next.text);
    Ok(())
}

fn print_lines(
    form: Form,
    plan: &[Line],
    title: &str,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let text = match form {
        Form::Points => points(plan),
        Form::Program => program::text(plan, title, &crate::settings::load(shared, messages)?)?,
    };
    file::print(text.as_bytes())
}

/// Seconds from the start to each stop, as the machine would need them; to be replaced by what the clock said. A proposal
/// goes on where the rows that were measured end.
fn times(plan: &[Line]) -> Vec<Vec<f64>> {
    let mut now = plan.first().and_then(|line| line.conditions.time_s).unwrap_or(0.0);
    let mut here: Option<Vector> = None;
    plan.iter()
        .map(|line| {
            now += line.wait_s;
            line.stops
                .iter()
                .map(|stop| {
                    let way = here.map_or(0.0, |from| (stop.at_mm - from).norm());
                    now += 60.0 * way / line.feed_mm_min + if line.flying { 0.0 } else { lines::DWELL_S };
                    here = Some(stop.at_mm);
                    now
                })
                .collect()
        })
        .collect()
}

/// The rows in the columns of a measurement file, readings and conditions to be filled in.
fn points(plan: &[Line]) -> String {
    let mut out = String::from(
        "run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,dir_x,dir_y,dir_z,feed_mm_min,tool_x_mm,tool_y_mm,tool_z_mm,load_kg,time_s,temp_c,repeat,u_um\n",
    );
    let filled = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v}"));
    for (line, times) in plan.iter().zip(times(plan)) {
        let (load_kg, temp_c) = (filled(line.conditions.load_kg), filled(line.conditions.temp_c[0]));
        for (stop, time) in line.stops.iter().zip(times) {
            let (q, t, d) = (stop.at_mm, line.tool_mm, stop.direction);
            // An axis at rest lags behind nothing: only readings on the fly have a feed.
            let feed = if line.flying { format!("{}", line.feed_mm_min) } else { String::new() };
            // Writing into a string cannot fail.
            let _ = writeln!(
                out,
                "{},{:.3},{:.3},{:.3},,,,{},{},{},{feed},{:.3},{:.3},{:.3},{load_kg},{time:.0},{temp_c},{},",
                line.run, q.x, q.y, q.z, d[0], d[1], d[2], t.x, t.y, t.z, line.repeat
            );
        }
    }
    out
}

/// The plan as measurements without readings.
pub(super) fn design(plan: &[Line], geometry: &EffectGeometry) -> Measurements {
    let mut data = Measurements {
        runs: Vec::new(),
        instruments: Vec::new(),
        rows: Vec::new(),
        geometry: geometry.clone(),
    };
    for (line, times) in plan.iter().zip(times(plan)) {
        data.runs.push(line.run.clone());
        for (stop, time) in line.stops.iter().zip(times) {
            data.rows.push(Row {
                run: data.runs.len() - 1,
                command: Command {
                    linear_mm: stop.at_mm,
                    rotary_rad: Vector::zeros(),
                    tool_mm: line.tool_mm,
                    direction: stop.direction,
                },
                conditions: Conditions {
                    time_s: Some(time),
                    feed_mm_min: line.flying.then_some(line.feed_mm_min),
                    ..Conditions::default()
                },
                predicted_mm: Vector::zeros(),
                u_um: [None; 3],
                instrument: None,
                station: None,
                artefact: None,
                reading: Reading::Displacement([Some(0.0); 3]),
                line: 0,
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

fn summary(plan: &[Line], found: &Confounding, geometry: &EffectGeometry) -> Text {
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
    let rotary: Vec<&str> = ["A", "B", "C"]
        .into_iter()
        .zip(0..)
        .filter(|(_, a)| geometry.has_rotary(*a))
        .map(|(name, _)| name)
        .collect();
    if !rotary.is_empty() {
        text.push(&both!(
            "\nexcept everything of {}: these lines keep rotary axes still; measure a target on the table at several angles as well",
            "\nкроме всего, что относится к {}: на этих линиях поворотные оси стоят; измерьте ещё цель на столе под несколькими углами",
            rotary.join(", ")
        ));
    }
    text.push(&both!(
        "\nthermal and load effects are asked for once temp_c and load_kg are filled in with more than one value",
        "\nо тепловых эффектах и нагрузке будет спрошено, когда temp_c и load_kg заполнены разными значениями"
    ));
    text
}
