//! Rows of an R-test, or of a probe and a sphere.

use std::collections::BTreeMap;
use std::path::PathBuf;

use calibration::rtest::BallReading;
use diagnostic::Code;
use machine_model::{Axis, Command, RigidBody, Vector};
use machine_profile::Profile;
use measurement_files::{Row, Sheet};

use crate::arguments::Shared;
use crate::calibrate::codes::{AXES, CELL, UNITS, question};
use crate::calibrate::output::Output;
use crate::calibrate::sources;
use crate::conditions::conditions;
use crate::message::Failure;

use super::RTest;

const COLUMNS: &str = "run x_mm y_mm z_mm a_deg b_deg c_deg dx_um dy_um dz_um tool_x_mm tool_y_mm tool_z_mm dir_x dir_y dir_z \
                       dir_a dir_b dir_c u_um u_x_um u_y_um u_z_um repeat temp_c time_s load_kg feed_mm_min note";

const EXPECTED: &str = "expected: run,x_mm,y_mm,z_mm,a_deg … c_deg and dx_um,dy_um,dz_um";

const DEVIATIONS: [&str; 3] = ["dx_um", "dy_um", "dz_um"];
const UNCERTAINTIES: [&str; 3] = ["u_x_um", "u_y_um", "u_z_um"];

/// No R-test reads so far, µm; no probe finds a sphere that far from where it was commanded to, mm.
const MOST_UM: f64 = 5000.0;
const MOST_MM: f64 = 20.0;

/// Places outside the base's volume by less are rounding, mm.
const SLACK_MM: f64 = 1e-6;

/// Rows of all files, and where each stands.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) readings: Vec<BallReading>,
    /// Names of the runs, with the file where there are several.
    pub(super) runs: Vec<String>,
    sheets: Vec<Sheet>,
    /// Sheet and row of each reading.
    places: Vec<(usize, usize)>,
    temperatures_c: Vec<f64>,
    /// Where an ideal machine would have the tip, workpiece frame, mm.
    nominal_mm: Vec<Vector>,
}

impl Rows {
    pub(super) fn read(
        files: &[PathBuf],
        arguments: &RTest,
        profile: &Profile,
        output: &Output,
        shared: &Shared,
    ) -> Result<Self, Failure> {
        let mut all = Self::default();
        let said = conditions(&shared.job)?;
        let machine = profile.rigid_body_without_effects();
        let mut known = BTreeMap::new();
        for path in files {
            let sheet = sources::sheet(path, COLUMNS, EXPECTED, &arguments.target.ignore_column)?;
            columns(&sheet, arguments.sphere, profile)?;
            for (line, row) in sheet.rows().enumerate() {
                let mut name = row.text("run").into_owned();
                if name.is_empty() {
                    let message = "the row says no run".to_owned();
                    return Err(row.refuse(CELL, "run", message, "a run is one mounting of the ball").into());
                }
                if files.len() > 1 {
                    name = format!("{} {name}", sheet.name());
                }
                let run = *known.entry(name).or_insert_with_key(|name| {
                    all.runs.push(name.clone());
                    all.runs.len() - 1
                });
                let mut reading = reading(&row, run, arguments.sphere, profile, machine)?;
                let mut here = said;
                let warm = row.number("temp_c")?.or(arguments.target.temperature);
                here.temp_c = here.temp_c.map(|known| warm.or(known));
                here.time_s = row.number("time_s")?.or(here.time_s);
                here.load_kg = row.number("load_kg")?.or(here.load_kg);
                here.feed_mm_min = row.number("feed_mm_min")?.or(here.feed_mm_min);
                let by_effects_mm = output.by_effects_mm(&reading.command, &here)?;
                for (value, by) in reading.deviation_mm.iter_mut().zip(&by_effects_mm) {
                    *value = value.map(|mm| mm - by);
                }
                let there = machine.predict(&reading.command);
                all.nominal_mm.push(there.position_mm - there.error_mm);
                all.temperatures_c.extend(row.number("temp_c")?);
                all.places.push((all.sheets.len(), line));
                all.readings.push(reading);
            }
            all.sheets.push(sheet);
        }
        let stated = all.readings.iter().filter(|r| r.uncertainty_mm.is_some()).count();
        if stated > 0 && stated < all.readings.len() {
            return Err(question(
                format!("{stated} of {} rows state their uncertainty, the others do not", all.readings.len()),
                "fill the column u_um in every row, or pass it over with `--ignore-column u_um`",
            ));
        }
        if arguments.sphere {
            all.about_one_place()?;
        }
        Ok(all)
    }

    /// Mean temperature of the rows that have one, °C.
    pub(super) fn temperature_c(&self) -> Option<f64> {
        let count = self.temperatures_c.len();
        (count > 0).then(|| self.temperatures_c.iter().sum::<f64>() / count as f64)
    }

    /// The run in which the ball's place in the workpiece moves farthest by the profile, and how far, mm.
    ///
    /// A ball in its nest stays where it is. Where it does not, a sign or a centre may be wrong, or the linear axes did not follow.
    pub(super) fn moving_ball(&self) -> Option<(&str, f64)> {
        let spread = |run: usize| {
            let own =
                || self.readings.iter().zip(&self.nominal_mm).filter(|(r, _)| r.run == run).map(|(_, at)| at);
            let low = own().fold(Vector::repeat(f64::INFINITY), |low, at| low.inf(at));
            (own().fold(Vector::repeat(f64::NEG_INFINITY), |high, at| high.sup(at)) - low).norm()
        };
        let each = self.runs.iter().enumerate().map(|(run, name)| (name.as_str(), spread(run)));
        each.filter(|(_, mm)| *mm > MOST_MM).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// A refusal at the row of a reading.
    pub(super) fn refuse(&self, reading: usize, code: Code, message: String, help: &str) -> Option<Failure> {
        let (sheet, line) = *self.places.get(reading)?;
        let row = self.sheets.get(sheet)?.row(line)?;
        Some(row.refuse_row(code, message, "this row", help).into())
    }

    /// Nominal places of a sphere, which [`reading`] has given as deviations, about their mean in each run.
    ///
    /// The tip is at one place of the workpiece, `p_nominal + e = b`: `e = b - p_nominal`, b the offset of the run.
    fn about_one_place(&mut self) -> Result<(), Failure> {
        let place = |reading: &BallReading| reading.deviation_mm.map(|mm| mm.unwrap_or_default());
        for run in 0..self.runs.len() {
            let own = || self.readings.iter().filter(|reading| reading.run == run);
            let count = own().count() as f64;
            let mean = own().map(|r| Vector::from(place(r))).sum::<Vector>() / count;
            let mut far = None;
            for (k, reading) in self.readings.iter_mut().enumerate().filter(|(_, r)| r.run == run) {
                let off = Vector::from(place(reading)) - mean;
                reading.deviation_mm = [0, 1, 2].map(|i| Some(off[i]));
                if off.norm() > MOST_MM {
                    far = far.or(Some((k, off.norm())));
                }
            }
            if let Some((k, off_mm)) = far {
                let message = format!(
                    "by the profile the tip was {off_mm:.1} mm from where run `{}` has the sphere in the mean",
                    self.runs[run]
                );
                let help = "a sphere stands at one place of the workpiece: check centre_mm, the tool vector, the signs of the angles, the run";
                return Err(self
                    .refuse(k, AXES, message, help)
                    .unwrap_or_else(|| question("the sphere moves", help)));
            }
        }
        Ok(())
    }
}

/// Refuses a file that lacks a column, or has one of the other kind.
fn columns(sheet: &Sheet, sphere: bool, profile: &Profile) -> Result<(), Failure> {
    sheet.need(&["run"], "a run is one mounting of the ball: its offset is never the machine's")?;
    sheet.need(&["x_mm", "y_mm", "z_mm"], "the commanded position of all three axes is needed")?;
    let deviation = DEVIATIONS.iter().find(|key| sheet.has(key));
    match (sphere, deviation) {
        (true, Some(key)) => {
            let message = format!("`{}` with `--sphere`", sheet.header(key));
            let help = "rows of a sphere hold where the axes stood when the probe was centred; deviations are read without --sphere";
            return Err(sheet.refuse_column(AXES, key, message, help).into());
        }
        (false, None) => {
            return Err(question(
                format!("{} has no reading", sheet.name()),
                "give dx_um,dy_um,dz_um; where a touch probe was centred on a sphere at every row, add `--sphere`",
            ));
        }
        _ => {}
    }
    let angles = ["a_deg", "b_deg", "c_deg"];
    let has = profile.has_rotary();
    if has == [false; 3] {
        return Err(Failure::usage(
            diagnostic::Diagnostic::error(AXES, format!("the chain {} has no rotary axis", profile.chain()))
                .help("give the profile of a machine with A, B or C: an R-test measures its rotary axes"),
        ));
    }
    if !(0..3).any(|axis| has[axis] && sheet.has(angles[axis])) {
        let wanted: Vec<&str> = (0..3).filter(|axis| has[*axis]).map(|axis| angles[axis]).collect();
        return Err(sheet
            .lacks(wanted[0], &format!("the angles of {} are needed: {}", profile.chain(), wanted.join(", ")))
            .into());
    }
    if UNCERTAINTIES.iter().any(|key| sheet.has(key)) {
        sheet.need(&UNCERTAINTIES, "give the uncertainty of all three components, or u_um")?;
    }
    Ok(())
}

fn reading(
    row: &Row<'_>,
    run: usize,
    sphere: bool,
    profile: &Profile,
    machine: &RigidBody,
) -> Result<BallReading, Failure> {
    let command = row.command(profile.default_tool_mm)?;
    stands_where_the_profile_knows(row, &command, profile, machine)?;
    let deviation_mm = if sphere {
        let there = machine.predict(&command);
        // Turned round: the sum with the run's offset is what the machine's error is.
        (there.error_mm - there.position_mm).map(Some).into()
    } else {
        let read = row.any_of(DEVIATIONS)?;
        for (key, um) in DEVIATIONS.iter().zip(read) {
            if um.is_some_and(|um| um.abs() > MOST_UM) {
                let message =
                    format!("a deviation of {} um is none that an R-test reads", um.unwrap_or_default());
                let help =
                    "measured minus commanded position of the tip, in um: look for another column or unit";
                return Err(row.refuse(UNITS, key, message, help).into());
            }
        }
        if read == [None; 3] {
            let message = "the row holds no reading".to_owned();
            return Err(row
                .refuse(CELL, DEVIATIONS[0], message, "fill dx_um, dy_um or dz_um, or take the row out")
                .into());
        }
        read.map(|um| um.map(|um| um * 1e-3))
    };
    let turning = [row.sign("dir_a")?, row.sign("dir_b")?, row.sign("dir_c")?];
    Ok(BallReading { run, command, turning, deviation_mm, uncertainty_mm: uncertainty(row)? })
}

/// By component, else of the row, mm.
fn uncertainty(row: &Row<'_>) -> Result<Option<[f64; 3]>, Failure> {
    let own = row.any_of(UNCERTAINTIES)?;
    let common = row.number("u_um")?;
    let all = own.map(|um| um.or(common));
    for (key, um) in UNCERTAINTIES.iter().zip(all) {
        if um.is_some_and(|um| um <= 0.0) {
            let key = if common.is_some() { "u_um" } else { key };
            let message = "an uncertainty is above zero".to_owned();
            return Err(row.refuse(CELL, key, message, "give the standard uncertainty in um").into());
        }
    }
    Ok(match all {
        [Some(x), Some(y), Some(z)] => Some([x, y, z].map(|um| um * 1e-3)),
        _ => None,
    })
}

fn stands_where_the_profile_knows(
    row: &Row<'_>,
    command: &Command,
    profile: &Profile,
    machine: &RigidBody,
) -> Result<(), Failure> {
    let has = profile.has_rotary();
    for axis in &Axis::ALL[3..] {
        let at = axis.direction();
        if command.rotary_rad[at] != 0.0 && !has[at] {
            let message = format!("the machine has no axis {axis}: its chain is {}", profile.chain());
            let help = "leave the column out, or give the profile of the machine that turns";
            return Err(row.refuse(AXES, ["a_deg", "b_deg", "c_deg"][at], message, help).into());
        }
    }
    let volume = profile.volume();
    for (axis, key) in ["x_mm", "y_mm", "z_mm"].into_iter().enumerate() {
        let (at, range) = (command.linear_mm[axis], volume.0[axis]);
        if at < range.low - SLACK_MM || at > range.high + SLACK_MM {
            let message = format!(
                "{} at {at} mm lies outside what the profile knows, {} to {} mm",
                Axis::ALL[axis],
                range.low,
                range.high
            );
            let help = "x_mm y_mm z_mm are machine coordinates; is `-m` the profile of this machine?";
            return Err(row.refuse(AXES, key, message, help).into());
        }
    }
    if let Err(error) = machine.rotary_inside(command) {
        let help = "angles are machine coordinates, degrees; `travel_deg` and the error tables of the profile say how far they go";
        return Err(row.refuse_row(AXES, error.to_string(), "this row", help).into());
    }
    Ok(())
}
