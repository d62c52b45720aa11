//! `vpost diagnose` for a lathe: measured parts in, which cause makes their radii wrong out.

use std::path::Path;

use calibration::turning::{Bar, CauseRow, Change, Feature, Stretch, TurnedReading, lathe_causes};
use diagnostic::{Speaks, Text, both, notice};
use jobs::calibrate::codes::{CELL, UNITS, question};
use jobs::calibrate::{MOST_UM, base_of, by_effects, part_name, sources, stood_at, vector_mm};
use jobs::diagnose::{File, json, summary};
use jobs::profile::Loaded;
use machine_profile::{LatheParts, Profile};
use measurement_files::{Row, numbered};

use super::options::Diagnose;
use super::report::Facts;
use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages, OPTION};

mod page;

const COLUMNS: &str = "part z_mm diameter_mm d_um deviation_um angle_deg tool time_s u_um temp_c note";
const EXPECTED: Text = Text::pair(
    "expected: part,z_mm,diameter_mm,d_um, or deviation_um with angle_deg",
    "ожидалось: part,z_mm,diameter_mm,d_um или deviation_um с angle_deg",
);

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
    whole: &Loaded,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    only_what_a_lathe_has(arguments)?;
    let profile = &whole.profile;
    let (Some(measurements), Some(lathe)) = (&arguments.measurements, &profile.lathe) else { return Ok(()) };
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
    let tailstock_mm = lathe.spindle.tailstock.map(|tailstock| tailstock.at_mm);
    let found = lathe_causes(rows, held, bar.as_ref(), tailstock_mm).map_err(|error| impossible(&error))?;
    // No key of a lathe's profile is an effect's.
    let changes = vec![Vec::new(); found.causes.len()];
    let json = json::text(&found, &changes);
    if let Some(path) = &arguments.json {
        file::write(path, json.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        let held = arguments.holdout.as_deref().map(read_again).transpose()?;
        let measured = read_again(measurements)?;
        let facts = Facts::new(whole, arguments, shared, &measured, held.as_ref())?;
        let page =
            page::Lathe { found: &found, changes: &changes, rows, parts: &parts.also.parts, facts: &facts };
        file::write(path, page.html(&json, messages.language()).as_bytes())?;
    }
    file::print(summary::text(&found, &changes).in_language(messages.language()).as_bytes())
}

fn impossible(error: &impl Speaks) -> Failure {
    let help =
        both!("run `vpost profile check` on the profile", "запустите `vpost profile check` для профиля");
    question(error.text(), help)
}

/// A file that was read, for the page.
fn read_again(path: &Path) -> Result<File, Failure> {
    let is_read_once = path.as_os_str() == "-";
    let hash = if is_read_once { String::new() } else { blake3::hash(&file::read(path)?).to_string() };
    Ok(File { name: file::name(path), hash, comments: Vec::new() })
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
        Some((option, _)) => Err(Failure::usage(notice!(OPTION;
            "`{option}` is not there for the parts of a lathe", "`{option}` для деталей токарного станка нет";
            "leave it out; `vpost calibrate turning` writes taper and barrel to a profile",
            "уберите его; конус и бочку в профиль записывает `vpost calibrate turning`"
        ))),
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
            line: row.line(),
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
        let sheet = sources::sheet((file::name(path), file::read(path)?), COLUMNS, EXPECTED, ignore)?;
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
        by_effects(&mut self.also.commands, profile, &base, &shared.job)?;
        let stretch = Stretch { low_mm: 0.0, high_mm: 1.0 };
        let predicted = base
            .predicted_mm(&Change::default(), stretch, &self.also.commands)
            .map_err(|error| impossible(&error))?;
        for (row, diameter_mm) in self.read.rows.iter_mut().zip(predicted) {
            row.gap_mm -= 0.5 * diameter_mm;
        }
        Ok(())
    }
}
