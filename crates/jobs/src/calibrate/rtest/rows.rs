//! Rows of an R-test, or of a probe and a sphere.

use std::path::PathBuf;

use calibration::rtest::BallReading;
use diagnostic::{Diagnostic, Speaks, Text, both, notice};
use machine_model::{Axis, Command, RigidBody, Vector};
use machine_profile::Profile;
use measurement_files::{Row, Sheet, numbered};

use super::super::work::Work;
use crate::calibrate::codes::{AXES, CELL, QUESTION, UNITS};
use crate::calibrate::options::{RTest, RTestMethod};
use crate::calibrate::output::Output;
use crate::calibrate::sources;
use crate::conditions::conditions;
use crate::message::Failure;

const COLUMNS: &str = "run x_mm y_mm z_mm a_deg b_deg c_deg dx_um dy_um dz_um tool_x_mm tool_y_mm tool_z_mm dir_x dir_y dir_z \
                       dir_a dir_b dir_c u_um u_x_um u_y_um u_z_um repeat temp_c time_s load_kg feed_mm_min note";

const EXPECTED: Text = Text::pair(
    "expected: run,x_mm,y_mm,z_mm,a_deg … c_deg and dx_um,dy_um,dz_um",
    "ожидалось: run,x_mm,y_mm,z_mm,a_deg … c_deg и dx_um,dy_um,dz_um",
);

const DEVIATIONS: [&str; 3] = ["dx_um", "dy_um", "dz_um"];
const UNCERTAINTIES: [&str; 3] = ["u_x_um", "u_y_um", "u_z_um"];

/// No R-test reads so far, µm; no probe finds a sphere that far from where it was commanded to, mm.
const MOST_UM: f64 = 5000.0;
const MOST_MM: f64 = 20.0;

/// A ball's place in the workpiece that moves by less is one place, mm.
const ONE_PLACE_MM: f64 = 1.0;

/// Places outside the base's volume by less are rounding, mm.
const SLACK_MM: f64 = 1e-6;

/// Rows of all files, and where each stands.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) read: sources::Read<BallReading>,
    /// Names of the runs, with the file where there are several.
    pub(super) runs: Vec<String>,
    /// Where an ideal machine would have the tip, workpiece frame, mm.
    nominal_mm: Vec<Vector>,
}

impl Rows {
    pub(super) fn read(
        files: &[PathBuf],
        arguments: &RTest,
        profile: &Profile,
        output: &Output,
        work: &Work<'_>,
    ) -> Result<Self, Failure> {
        let mut all = Self::default();
        let said = conditions(work.options)?;
        let machine = profile.rigid_body_without_effects();
        let Self { read, runs, nominal_mm } = &mut all;
        for path in files {
            let sheet = sources::sheet(work.read(path)?, COLUMNS, EXPECTED, &arguments.target.ignore_column)?;
            columns(&sheet, arguments.method(), profile)?;
            let file = sheet.name().to_owned();
            read.add(sheet, |row| {
                let mut name = row.text("run").into_owned();
                if name.is_empty() {
                    return Err(Failure::at_cell(row, "run")(notice!(CELL;
                        "the row says no run", "в строке не названа серия";
                        "a run is one mounting of the ball", "серия — одна установка шара"
                    )));
                }
                if files.len() > 1 {
                    name = format!("{file} {name}");
                }
                let mut reading = reading(row, numbered(runs, &name), arguments.method(), profile, machine)?;
                let here = sources::conditions_of(row, said, arguments.target.temperature)?;
                let by_effects_mm = output.by_effects_mm(&reading.command, &here)?;
                for (value, by) in reading.deviation_mm.iter_mut().zip(&by_effects_mm) {
                    *value = value.map(|mm| mm - by);
                }
                let there = machine.predict(&reading.command);
                nominal_mm.push(there.position_mm - there.error_mm);
                Ok(reading)
            })?;
        }
        let stated = all.read.rows.iter().filter(|r| r.uncertainty_mm.is_some()).count();
        sources::all_state_or_none(stated, all.read.rows.len())?;
        all.turn_as_the_profile_says(profile)?;
        if arguments.method() == RTestMethod::Sphere {
            all.about_one_place()?;
        }
        Ok(all)
    }

    /// The run in which the ball's place in the workpiece moves farthest by the profile, and how far, mm.
    ///
    /// A ball in its nest stays where it is. Where it does not, a sign or a centre may be wrong, or the linear axes did
    /// not follow.
    pub(super) fn moving_ball(&self) -> Option<(&str, f64)> {
        let (run, mm) = self.farthest(&self.nominal_mm)?;
        (mm > MOST_MM).then_some((self.runs[run].as_str(), mm))
    }

    /// The run in which these places, one for each row, are farthest apart, and how far, mm.
    fn farthest(&self, places: &[Vector]) -> Option<(usize, f64)> {
        let spread = |run: usize| {
            let own = || self.read.rows.iter().zip(places).filter(|(r, _)| r.run == run).map(|(_, at)| at);
            let low = own().fold(Vector::repeat(f64::INFINITY), |low, at| low.inf(at));
            (own().fold(Vector::repeat(f64::NEG_INFINITY), |high, at| high.sup(at)) - low).norm()
        };
        (0..self.runs.len()).map(|run| (run, spread(run))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Refuses rows in which the ball stays where it is only if axes count the other way than the profile says.
    fn turn_as_the_profile_says(&self, profile: &Profile) -> Result<(), Failure> {
        let apart_mm = |places: &[Vector]| self.farthest(places).map_or(0.0, |(_, mm)| mm);
        let as_said_mm = apart_mm(&self.nominal_mm);
        if as_said_mm < ONE_PLACE_MM {
            return Ok(());
        }
        let rotary: Vec<Axis> = profile.chain().axes().filter(|axis| !axis.is_linear()).collect();
        // Every choice of axes, the fewest first.
        let mut choices: Vec<Vec<Axis>> = (1..1_usize << rotary.len())
            .map(|bits| (0..rotary.len()).filter(|k| bits >> k & 1 == 1).map(|k| rotary[k]).collect())
            .collect();
        choices.sort_by_key(Vec::len);
        for turned in choices {
            let places: Vec<Vector> = self
                .read
                .rows
                .iter()
                .map(|reading| {
                    let mut command = reading.command;
                    turned.iter().for_each(|axis| command.rotary_rad[axis.direction()] *= -1.0);
                    let there = profile.rigid_body_without_effects().predict(&command);
                    there.position_mm - there.error_mm
                })
                .collect();
            let turned_mm = apart_mm(&places);
            if turned_mm < ONE_PLACE_MM && turned_mm < 0.1 * as_said_mm {
                return Err(other_way(profile, &turned, [as_said_mm, turned_mm]));
            }
        }
        Ok(())
    }

    /// What is refused of the row of a reading.
    pub(super) fn at(&self, reading: usize) -> impl FnOnce(Diagnostic) -> Failure {
        move |wrong| match self.read.row(reading) {
            Some(row) => Failure::at_row(&row)(wrong),
            None => Failure::unfit(wrong),
        }
    }

    /// Nominal places of a sphere, which [`reading`] has given as deviations, about their mean in each run.
    ///
    /// The tip is at one place of the workpiece, `p_nominal + e = b`: `e = b - p_nominal`, b the offset of the run.
    fn about_one_place(&mut self) -> Result<(), Failure> {
        let place = |reading: &BallReading| reading.deviation_mm.map(|mm| mm.unwrap_or_default());
        for run in 0..self.runs.len() {
            let own = || self.read.rows.iter().filter(|reading| reading.run == run);
            let count = own().count() as f64;
            let mean = own().map(|r| Vector::from(place(r))).sum::<Vector>() / count;
            let mut far = None;
            for (k, reading) in self.read.rows.iter_mut().enumerate().filter(|(_, r)| r.run == run) {
                let off = Vector::from(place(reading)) - mean;
                reading.deviation_mm = [0, 1, 2].map(|i| Some(off[i]));
                if off.norm() > MOST_MM {
                    far = far.or(Some((k, off.norm())));
                }
            }
            if let Some((k, off_mm)) = far {
                return Err(self.at(k)(notice!(AXES;
                    "by the profile the tip was {off_mm:.1} mm from where run `{}` has the sphere in the mean",
                    "по профилю щуп был в {off_mm:.1} мм от среднего места сферы в серии `{}`", self.runs[run];
                    "a sphere stands at one place of the workpiece: check centre_mm, the tool vector, the signs of the angles, the run",
                    "сфера стоит в одном месте детали: проверьте centre_mm, вектор инструмента, знаки углов, серию"
                )));
            }
        }
        Ok(())
    }
}

/// Refuses a file that lacks a column, or has one of the other kind.
fn columns(sheet: &Sheet, method: RTestMethod, profile: &Profile) -> Result<(), Failure> {
    let help = both!(
        "a run is one mounting of the ball: its offset is never the machine's",
        "серия — одна установка шара: её сдвиг к станку не относится"
    );
    sheet.need(&["run"], help)?;
    let help = both!(
        "the commanded position of all three axes is needed",
        "нужно заданное положение всех трёх осей"
    );
    sheet.need(&["x_mm", "y_mm", "z_mm"], help)?;
    let deviation = DEVIATIONS.iter().find(|key| sheet.has(key));
    match (method, deviation) {
        (RTestMethod::Sphere, Some(key)) => {
            let message = both!("`{}` with `--sphere`", "`{}` вместе с `--sphere`", sheet.header(key));
            let help = both!(
                "rows of a sphere hold where the axes stood when the probe was centred; deviations are read without --sphere",
                "строки по сфере — положения осей, при которых щуп был отцентрирован; отклонения читаются без --sphere"
            );
            return Err(sheet.refuse_column(AXES, key, message, help).into());
        }
        (RTestMethod::Deviations, None) => {
            return Err(Failure::usage(notice!(QUESTION;
                "{} has no reading", "в {} нет отсчётов", sheet.name();
                "give dx_um,dy_um,dz_um; where a touch probe was centred on a sphere at every row, add `--sphere`",
                "дайте dx_um,dy_um,dz_um; если в каждой строке щуп центрировали по сфере, добавьте `--sphere`"
            )));
        }
        _ => {}
    }
    let angles = ["a_deg", "b_deg", "c_deg"];
    let has = profile.has_rotary();
    if has == [false; 3] {
        return Err(Failure::usage(notice!(AXES;
            "the chain {} has no rotary axis", "в цепи {} нет поворотной оси", profile.chain();
            "give the profile of a machine with A, B or C: an R-test measures its rotary axes",
            "дайте профиль станка с A, B или C: R-тест измеряет его поворотные оси"
        )));
    }
    let both_ways = |axis: &usize| has[*axis] && profile.description.rotary[*axis].errors_negative.is_some();
    if let Some(axis) = (0..3).find(both_ways) {
        let letter = ["A", "B", "C"][axis];
        return Err(Failure::usage(notice!(AXES;
            "[rotary.{letter}] of the base has `errors_negative`, and angles do not say from which side the axis came",
            "в [rotary.{letter}] исходного профиля есть `errors_negative`, а по углам не видно, с какой стороны пришла ось";
            "give a base with one table, the mean of both directions, and `backlash_urad`",
            "дайте профиль с одной таблицей, средней по направлениям, и `backlash_urad`"
        )));
    }
    if !(0..3).any(|axis| has[axis] && sheet.has(angles[axis])) {
        let wanted: Vec<&str> = (0..3).filter(|axis| has[*axis]).map(|axis| angles[axis]).collect();
        let help = both!(
            "the angles of {} are needed: {}",
            "нужны углы осей цепи {}: {}",
            profile.chain(),
            wanted.join(", ")
        );
        return Err(sheet.lacks(wanted[0], help).into());
    }
    if UNCERTAINTIES.iter().any(|key| sheet.has(key)) {
        let help = both!(
            "give the uncertainty of all three components, or u_um",
            "дайте неопределённость всех трёх составляющих или u_um"
        );
        sheet.need(&UNCERTAINTIES, help)?;
    }
    Ok(())
}

/// The refusal of rows from a machine on which these axes count the other way.
fn other_way(profile: &Profile, turned: &[Axis], [as_said_mm, turned_mm]: [f64; 2]) -> Failure {
    let names: Vec<String> = turned.iter().map(Axis::to_string).collect();
    let keys = turned.iter().map(|axis| {
        let own = profile.description.rotary[axis.direction()].direction;
        let [x, y, z] = own.unwrap_or_else(|| Vector::ith(axis.direction(), 1.0)).map(|v| 0.0 - v).into();
        format!("[rotary.{axis}] direction = [{x}, {y}, {z}]")
    });
    let keys = keys.collect::<Vec<_>>().join(", ");
    let said: Vec<Text> = turned.iter().map(|axis| profile.plus_turns(*axis)).collect();
    let said = Text::join(&said, "; ");
    let names = names.join(", ");
    Failure::usage(notice!(AXES;
        "plus of {names} turns the other way than the profile says: by it the ball moves by {as_said_mm:.1} mm in the workpiece, the other way by {turned_mm:.3} mm",
        "плюс {names} направлен не так, как в профиле: по нему шар смещается на детали на {as_said_mm:.1} мм, наоборот — на {turned_mm:.3} мм";
        "write {keys}; the profile says now: {said}", "напишите {keys}; сейчас в профиле: {said:#}"
    ))
}

fn reading(
    row: &Row<'_>,
    run: usize,
    method: RTestMethod,
    profile: &Profile,
    machine: &RigidBody,
) -> Result<BallReading, Failure> {
    let command = row.command(profile.default_tool_mm)?;
    stands_where_the_profile_knows(row, &command, profile, machine)?;
    let deviation_mm = if method == RTestMethod::Sphere {
        let there = machine.predict(&command);
        // Turned round: the sum with the run's offset is what the machine's error is.
        (there.error_mm - there.position_mm).map(Some).into()
    } else {
        let read = row.any_of(DEVIATIONS)?;
        for (key, um) in DEVIATIONS.iter().zip(read) {
            if um.is_some_and(|um| um.abs() > MOST_UM) {
                return Err(Failure::at_cell(row, key)(notice!(UNITS;
                    "a deviation of {} um is none that an R-test reads",
                    "отклонений в {} мкм R-тест не показывает", um.unwrap_or_default();
                    "measured minus commanded position of the tip, in um: look for another column or unit",
                    "измеренное минус заданное положение наконечника, в мкм: ищите другой столбец или единицу"
                )));
            }
        }
        if read == [None; 3] {
            return Err(Failure::at_cell(row, DEVIATIONS[0])(notice!(CELL;
                "the row holds no reading", "в строке нет отсчёта";
                "fill dx_um, dy_um or dz_um, or take the row out",
                "заполните dx_um, dy_um или dz_um либо уберите строку"
            )));
        }
        read.map(|um| um.map(|um| um * 1e-3))
    };
    let turning = [row.sign("dir_a")?, row.sign("dir_b")?, row.sign("dir_c")?];
    Ok(BallReading { run, command, turning, deviation_mm, uncertainty_mm: uncertainty(row)? })
}

/// By component, else of the row, mm.
fn uncertainty(row: &Row<'_>) -> Result<Option<[f64; 3]>, Failure> {
    let stated_mm = |key: &str| sources::uncertainty_mm(row, key);
    let [x, y, z] = UNCERTAINTIES.map(stated_mm);
    let (own, common) = ([x?, y?, z?], stated_mm("u_um")?);
    Ok(match own.map(|mm| mm.or(common)) {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
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
            return Err(Failure::at_cell(row, ["a_deg", "b_deg", "c_deg"][at])(notice!(AXES;
                "the machine has no axis {axis}: its chain is {}",
                "у станка нет оси {axis}: его цепь {}", profile.chain();
                "leave the column out, or give the profile of the machine that turns",
                "уберите столбец или дайте профиль станка с этой осью"
            )));
        }
    }
    let volume = profile.volume();
    for (axis, key) in ["x_mm", "y_mm", "z_mm"].into_iter().enumerate() {
        let (at, range) = (command.linear_mm[axis], volume.0[axis]);
        if at < range.low - SLACK_MM || at > range.high + SLACK_MM {
            return Err(Failure::at_cell(row, key)(notice!(AXES;
                "{} at {at} mm lies outside what the profile knows, {} to {} mm",
                "{} = {at} мм вне того, что знает профиль: от {} до {} мм", Axis::ALL[axis], range.low,
                range.high;
                "x_mm y_mm z_mm are machine coordinates; is `-m` the profile of this machine?",
                "x_mm y_mm z_mm — координаты станка; `-m` — профиль этого станка?"
            )));
        }
    }
    if let Err(error) = machine.rotary_inside(command) {
        return Err(Failure::at_row(row)(notice!(AXES; error.text();
            "angles are machine coordinates, degrees; `travel_deg` and the error tables of the profile say how far they go",
            "углы — координаты станка в градусах; их пределы — `travel_deg` и таблицы погрешностей профиля"
        )));
    }
    Ok(())
}
