//! `vpost calibrate turning`.

mod found;
mod shown;

use std::path::{Path, PathBuf};

use calibration::CalibrationError;
use calibration::turning::{
    Change, Feature, Stretch, TurnedReading, TurningBase, TurningCalibration, calibrate,
};
use clap::Args;
use diagnostic::{Speaks, Text, both, notice};
use machine_model::{Axis, Command, PathModel, Vector};
use machine_profile::{LatheParts, Profile};
use measurement_files::{Row, numbered};

use super::codes::{AXES, CELL, QUESTION, UNFIT, UNITS, failure};
use super::output::{Output, Target};
use super::page::Shown;
use super::sources;
use crate::conditions::conditions;
use crate::message::{Failure, OPTION};
use crate::options::JobOptions;

use super::work::Work;
use found::{Names, Outcome};
use shown::Pieces;

/// `vpost calibrate turning PARTS… -m LATHE -o PROFILE`
#[derive(Debug, Args)]
pub struct Turning {
    /// Measured test pieces (CSV): part, z_mm, diameter_mm, d_um; feature, tool, time_s, u_um where known.
    #[arg(value_name = "PARTS.csv", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// Diameters of further parts that judge the profile; one that makes them worse is not written.
    #[arg(long, value_name = "HELD.csv")]
    pub holdout: Option<PathBuf>,
    /// Write what was found as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a page for a browser: drawings, numbers.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

const COLUMNS: &str = "part feature z_mm diameter_mm d_um time_s tool u_um temp_c note";
const EXPECTED: Text =
    Text::pair("expected: part,z_mm,diameter_mm,d_um", "ожидалось: part,z_mm,diameter_mm,d_um");
/// No lathe turns so wrong, µm.
pub const MOST_UM: f64 = 2000.0;

#[derive(Default)]
struct Parts {
    read: sources::Read<TurnedReading>,
    names: Names,
}

/// From the gauge point to the tip of the tool of this name, mm: `H1`, or `T0101` whose offset is H1, an edge's name
/// behind it; else what the user can do. Any name where the profile has no tools.
///
/// # Errors
/// What the user can do.
pub fn vector_mm(profile: &Profile, tool: &str) -> Result<Vector, Text> {
    if profile.tools.is_empty() {
        return Ok(Vector::from(profile.default_tool_mm));
    }
    let rest = tool.get(1..).unwrap_or_default();
    let digits = rest.find(|c: char| !c.is_ascii_digit()).map_or(rest, |end| &rest[..end]);
    let number = match (tool.get(..1), digits.len()) {
        (Some("H" | "h"), _) => digits.parse().ok(),
        (Some("T" | "t"), 4) => digits[2..].parse().ok(),
        _ => None,
    };
    let number: u32 = number.ok_or_else(|| {
        both!(
            "name it by its length, H1, or by its call, T0101; an edge behind it: T0101-2",
            "назовите его по длине, H1, или по вызову, T0101; кромка после него: T0101-2"
        )
    })?;
    let known = profile.tools.iter().find(|(known, _)| *known == number);
    known.map(|(_, length_mm)| -Vector::from(*length_mm)).ok_or_else(|| {
        both!(
            "add its length to the profile: `lengths_mm` under `[tool]`",
            "добавьте его длину в профиль: `lengths_mm` в разделе `[tool]`"
        )
    })
}

/// The part that a row was read on.
///
/// # Errors
/// The row names none.
pub fn part_name<'s>(row: &Row<'s>) -> Result<std::borrow::Cow<'s, str>, Failure> {
    let name = row.text("part");
    if name.is_empty() {
        return Err(Failure::at_cell(row, "part")(notice!(CELL;
            "a reading of no part", "показание без образца";
            "name the clamping and finishing cut, like P1",
            "назовите установку и чистовой проход, например P1"
        )));
    }
    Ok(name)
}

/// Where the carriage stood that cut a diameter, both mm.
///
/// # Errors
/// It stands where the profile does not reach.
pub fn stood_at(
    row: &Row<'_>,
    profile: &Profile,
    tool_mm: Vector,
    z_mm: f64,
    diameter_mm: f64,
) -> Result<Command, Failure> {
    let centre_mm = profile.lathe.as_ref().map_or(0.0, |lathe| lathe.spindle.centre_mm.x);
    let linear_mm = Vector::new(centre_mm + 0.5 * diameter_mm, tool_mm.y, z_mm) - tool_mm;
    if (profile.volume().nearest(&linear_mm) - linear_mm).amax() > 1e-9 {
        return Err(Failure::at_cell(row, "z_mm")(notice!(AXES;
            "the tool stands outside the travel or the tables of the profile there",
            "инструмент стоит там вне хода или таблиц профиля";
            "z_mm is the machine's Z, diameter_mm twice the machine's X from the spindle's axis",
            "z_mm — Z станка, diameter_mm — удвоенный X станка от оси шпинделя"
        )));
    }
    Ok(Command { linear_mm, tool_mm, ..Command::default() })
}

impl Parts {
    fn read(
        &mut self,
        path: &Path,
        profile: &Profile,
        ignore: &[String],
        work: &Work<'_>,
    ) -> Result<(), Failure> {
        let sheet = sources::sheet(work.read(path)?, COLUMNS, EXPECTED, ignore)?;
        sheet.need(&["part", "z_mm", "diameter_mm", "d_um"], EXPECTED)?;
        let names = &mut self.names;
        self.read.add(sheet, |row| names.reading(row, profile))
    }
}

impl Names {
    fn reading(&mut self, row: &Row<'_>, profile: &Profile) -> Result<TurnedReading, Failure> {
        let feature = match row.text("feature").to_lowercase().as_str() {
            "" | "diameter" | "диаметр" => Feature::Diameter,
            "face" | "торец" => Feature::Face,
            other => {
                return Err(Failure::at_cell(row, "feature")(notice!(CELL;
                    "`{other}` is no feature of a test piece", "`{other}` — не элемент образца";
                    "write diameter or face", "напишите diameter или face"
                )));
            }
        };
        let name = part_name(row)?;
        let (part, tool) = (numbered(&mut self.parts, &name), row.text("tool"));
        let tool_mm = vector_mm(profile, &tool).map_err(|help| {
            row.refuse(
                CELL,
                "tool",
                both!(
                    "which tool of the profile is `{tool}`? It says where the carriage stood",
                    "какой это инструмент профиля — `{tool}`? По нему видно, где стояла каретка"
                ),
                help,
            )
        })?;
        let tool = (!tool.is_empty()).then(|| numbered(&mut self.tools, &tool));
        let (z_mm, diameter_mm) = (row.needed("z_mm")?, row.needed("diameter_mm")?);
        let d_um = row.needed("d_um")?;
        if d_um.abs() > MOST_UM {
            return Err(Failure::at_cell(row, "d_um")(notice!(UNITS;
                "a deviation of {d_um} um is no error of a lathe",
                "отклонение {d_um} мкм — не погрешность токарного станка";
                "d_um is measured minus commanded, in um: look for another column or unit",
                "d_um — измеренное минус заданное, в мкм: ищите другой столбец или единицу"
            )));
        }
        if diameter_mm <= 0.0 && feature == Feature::Diameter {
            return Err(Failure::at_cell(row, "diameter_mm")(notice!(CELL;
                "a diameter is above 0", "диаметр больше 0";
                "give the commanded diameter", "дайте заданный диаметр"
            )));
        }
        let command = stood_at(row, profile, tool_mm, z_mm, diameter_mm)?;
        let uncertainty_mm = sources::uncertainty_mm(row, "u_um")?;
        Ok(TurnedReading {
            part,
            tool,
            feature,
            command,
            deviation_mm: d_um * 1e-3,
            by_effects_mm: 0.0,
            uncertainty_mm,
            time_s: row.number("time_s")?,
        })
    }
}

/// `vpost calibrate turning`
pub(super) fn run(arguments: &Turning, work: &Work<'_>) -> Result<(), Failure> {
    let unknown = || {
        Failure::usage(notice!(QUESTION;
            "which lathe? its profile is not known", "какой токарный станок? его профиль неизвестен";
            "add `-m LATHE.toml`", "добавьте `-m LATHE.toml`"
        ))
    };
    work.options.machine.as_ref().ok_or_else(unknown)?;
    let mut output = Output::start(&arguments.target, work, crate::profile::load)?;
    let profile = output.base.clone().ok_or_else(unknown)?;
    let Some(lathe) = profile.lathe.clone() else {
        return Err(Failure::usage(notice!(OPTION;
            "test pieces are turned on a lathe, and {} has no spindle in its chain",
            "образцы точат на токарном станке, а в цепи {} нет шпинделя", profile.chain();
            "give the profile of the lathe, with a chain like \"[w S b Z X t]\"",
            "дайте профиль токарного станка с цепью вроде \"[w S b Z X t]\""
        )));
    };
    let base = base_of(&profile, &lathe);
    let ignore = &arguments.target.ignore_column;
    let mut parts = Parts::default();
    for path in &arguments.files {
        parts.read(path, &profile, ignore, work)?;
    }
    let trained = parts.read.rows.len();
    if let Some(path) = &arguments.holdout {
        parts.read(path, &profile, ignore, work)?;
    }
    by_effects(&mut parts.read.rows, &profile, &base, work.options)?;
    let (rows, held) = parts.read.rows.split_at(trained);
    let stated = rows.iter().filter(|row| row.uncertainty_mm.is_some()).count();
    sources::all_state_or_none(stated, rows.len())?;
    let found =
        calibrate(rows, &base, &parts.names.parts).map_err(|error| parts.read.refused("d_um", &error))?;
    let holdout = (!held.is_empty()).then(|| found.held_out(held, &base)).transpose();
    let holdout = holdout.map_err(|error| parts.read.refused("d_um", &error))?;
    let timed = rows.iter().all(|row| row.feature != Feature::Diameter || row.time_s.is_some());
    let refuted = holdout.filter(|judged| judged.rms_after_mm > judged.rms_before_mm + 1e-9);
    let is_refuted = refuted.is_some();
    let outcome =
        Outcome { found: &found, holdout, is_refuted, base: &base, names: &parts.names, rows, timed };
    work.print(&outcome.report());
    work.show(arguments.json.as_ref(), || crate::summary::json(&outcome.json()));
    let page = |target: &Target, uncertainty_mm: Option<f64>| {
        let page = Pieces::new(&outcome, held)
            .map_err(|error| failure("", &[], &CalibrationError::Axes(error.text())))?;
        let shown = Shown { html: arguments.html.clone(), ..Shown::default() };
        let mut files = arguments.files.clone();
        files.extend(arguments.holdout.clone());
        shown.write(&page, &files, target, work, parts.read.temperature_c(), uncertainty_mm)
    };
    if let Some(judged) = refuted {
        page(&Target { output: None, ..arguments.target.clone() }, None)?;
        return Err(Failure::unfit(notice!(UNFIT;
            "{} held-out diameters get worse: {:.2} um RMS before, {:.2} um after",
            "контрольных диаметров {}, и они становятся хуже: {:.2} мкм до, {:.2} мкм после (среднеквадратичное)",
            judged.rows, judged.rms_before_mm * 1e3, judged.rms_after_mm * 1e3;
            "look for a sign, or for parts of another machine or clamping; nothing was written",
            "ищите ошибку в знаке или образцы другого станка или установки; ничего не записано"
        )));
    }
    write(&mut output, &found, &base);
    let uncertainty_mm = output.with_base_mm(found.field_u95_mm, work);
    let known_mm = [Some(found.noise_mm), Some(uncertainty_mm)];
    output.write(&arguments.target, work, parts.read.temperature_c(), known_mm)?;
    page(&arguments.target, Some(uncertainty_mm))
}

/// The lathe as its profile knows it.
#[must_use]
pub fn base_of(profile: &Profile, lathe: &LatheParts) -> TurningBase {
    TurningBase {
        description: profile.description.clone(),
        interpolation: profile.interpolation,
        spindle: lathe.spindle.clone(),
        bending: lathe.bending.clone(),
        tip: lathe.tip,
        stations: lathe.stations.clone(),
    }
}

/// What the profile's effects do of each reading: the whole lathe less its tables and spindle.
///
/// # Errors
/// Conditions that the effects need.
pub fn by_effects(
    rows: &mut [TurnedReading],
    profile: &Profile,
    base: &TurningBase,
    options: &JobOptions,
) -> Result<(), Failure> {
    if profile.effects.is_empty() {
        return Ok(());
    }
    let whole = profile.lathe(&conditions(options)?).map_err(|error| crate::conditions::failure(&error))?;
    let stretch = Stretch { low_mm: 0.0, high_mm: 1.0 };
    let bare = base.predicted_mm(&Change::default(), stretch, rows).map_err(|error| {
        Failure::usage(notice!(QUESTION; error.text();
            "run `vpost profile check` on it", "запустите для него `vpost profile check`"
        ))
    })?;
    let Some(whole) = whole else { return Ok(()) };
    for (row, bare) in rows.iter_mut().zip(bare) {
        let error_mm = whole.error_mm(&row.command);
        row.by_effects_mm = match row.feature {
            Feature::Diameter => 2.0 * error_mm.x - bare,
            Feature::Face => error_mm.z - bare,
        };
    }
    Ok(())
}

fn write(output: &mut Output, found: &TurningCalibration, base: &TurningBase) {
    let change = &found.change;
    if change.axis != 0.0 {
        match base.spindle.tailstock {
            Some(tailstock) => {
                let [x, y] = tailstock.offset_mm;
                let offset_um = [(x + change.axis) * 1e3, y * 1e3];
                output.text.set_range(&["tailstock", "offset_um"], offset_um, 4);
            }
            None => {
                let urad = (base.spindle.tilt_rad[1] + change.axis) * 1e6;
                output.text.set_number(&["spindle", "EB0S_urad"], urad, 4);
            }
        }
    }
    if change.eb0z_rad != 0.0 {
        let urad = (base.description.squareness.eb0z_rad + change.eb0z_rad) * 1e6;
        output.text.set_number(&["squareness", "EB0Z_urad"], urad, 4);
    }
    if let Some(tables) = base.z_tables(change, found.stretch) {
        let both_ways = [Some(&tables.errors), tables.negative.as_ref()];
        output.tables(Axis::Z, &tables.positions_mm, tables.given, both_ways);
    }
}
