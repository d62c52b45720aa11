//! A measurement file with its predictions.

use diagnostic::{Speaks, Text, both, notice};
use gap_diagnosis::{Measurements, Row};
use machine_profile::Profile;

use super::books::{self, Books};
use super::measurements;
use super::model::Model;
use crate::message::{Failure, OPTION};
use crate::settings::setup_tool;

/// A measurement file with its predictions, and what a report says of the file.
pub struct Measured {
    /// Rows with their predictions.
    pub data: Measurements,
    /// Where they stand.
    pub file: File,
}

/// A file that was read.
#[derive(Debug, Clone)]
pub struct File {
    /// As it was given.
    pub name: String,
    /// BLAKE3 of its bytes.
    pub hash: String,
    /// Its comment lines.
    pub comments: Vec<String>,
}

/// Refuses a hold-out whose rows move what the measurements hold still: a rotary axis, or nothing that they move.
///
/// # Errors
/// The axis.
pub fn of_one_machine(name: &str, measured: &Measured, held: &Measured) -> Result<(), Failure> {
    /// An angle that is the same, rad.
    const SAME_RAD: f64 = 1e-6;
    let turns = |data: &Measurements, axis: usize| {
        let angles = || data.rows.iter().map(|row| row.command.rotary_rad[axis]);
        let (low, high) = angles().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low > SAME_RAD
    };
    let refuse = |message: Text| {
        Failure::usage(notice!(OPTION;
            "the hold-out {name}: {message}", "контрольные измерения {name}: {message:#}";
            "give a hold-out of the same machine that moves the same axes, or diagnose without --holdout",
            "дайте контрольные измерения того же станка с теми же осями или проводите диагностику без --holdout"
        ))
    };
    for (axis, letter) in ["A", "B", "C"].into_iter().enumerate() {
        if turns(&held.data, axis) && !turns(&measured.data, axis) {
            return Err(refuse(both!(
                "{letter} turns there, and stands still in the measurements",
                "{letter} там вращается, а в измерениях стоит"
            )));
        }
    }
    let moves = |data: &Measurements, axis: usize| {
        let (low, high) = data.range_mm(axis);
        high - low > 1e-3
    };
    let letters = |data: &Measurements| -> Vec<&str> {
        ["X", "Y", "Z"].into_iter().enumerate().filter(|(a, _)| moves(data, *a)).map(|(_, l)| l).collect()
    };
    let (fitted, unseen) = (letters(&measured.data), letters(&held.data));
    if !unseen.is_empty() && unseen.iter().all(|letter| !fitted.contains(letter)) {
        return Err(refuse(both!(
            "it moves {}, and the measurements {}",
            "там движутся {}, а в измерениях {}",
            unseen.join(", "),
            fitted.join(", ")
        )));
    }
    Ok(())
}

/// Reads measurements, and leaves it at that.
///
/// # Errors
/// What is wrong with the table.
pub fn readable(bytes: &[u8], profile: &Profile) -> Result<(), Failure> {
    let (data, sheet) =
        measurements::read("measurements", bytes, setup_tool(profile), &[], &profile.effect_geometry())?;
    measurements::commands_and_frames(&sheet, &data, profile, Books::Checked)
}

/// Reads a file and predicts its rows; columns in `ignore` are passed over.
///
/// # Errors
/// What is wrong with the table; what an effect of the profile depends on and the table does not say.
pub fn read(
    name: &str,
    bytes: &[u8],
    model: &Model,
    ignore: &[String],
    books: Books,
) -> Result<Measured, Failure> {
    let tool_mm = setup_tool(&model.profile);
    let (mut data, sheet) = measurements::read(name, bytes, tool_mm, ignore, &model.geometry)?;
    measurements::commands_and_frames(&sheet, &data, &model.profile, books)?;
    let rigid = model.profile.rigid_body_without_effects();
    let predict = |row: &mut Row| -> Result<(), Failure> {
        row.predicted_mm = match model.engine.as_deref().and_then(|e| e.path_model()) {
            // Said along the linear axes, read by the workpiece.
            Some(engine) => model.geometry.table_turn(&row.command) * engine.error_mm(&row.command),
            None => rigid.predict(&row.command).error_mm,
        };
        for effect in &model.effects {
            row.predicted_mm += effect.displacement_mm(&row.command, &row.conditions).map_err(|error| {
                let error = error.text();
                Failure::usage(notice!(OPTION;
                    "{} of the profile: {error}", "{} профиля: {error:#}", effect.kind();
                    "give the measurements that column, or take the effect out of the profile",
                    "добавьте этот столбец в измерения или уберите эффект из профиля"
                ))
            })?;
        }
        Ok(())
    };
    data.rows.iter_mut().try_for_each(predict)?;
    measurements::readings_against_model(&sheet, &data)?;
    let travel_mm =
        [0, 1, 2].map(|axis| model.profile.description.linear[axis].travel_mm).map(|r| (r.low, r.high));
    if books == Books::Checked
        && let Some(slip) = books::slip(&data, &model.profile.work_offsets, travel_mm, predict)
        && !books::is_caused(&data, &slip)
    {
        return Err(measurements::slipped(&sheet, &slip));
    }
    in_order_of_time(&mut data);
    let comments = sheet.comments().to_vec();
    let file = File { name: name.to_owned(), hash: blake3::hash(bytes).to_string(), comments };
    Ok(Measured { data, file })
}

/// Neighbours are rows that were measured one after the other: where every row has its time, that is the order, whatever
/// the order of the lines. Else a run was measured as its lines stand, and the runs as they first appear.
fn in_order_of_time(data: &mut Measurements) {
    if data.rows.iter().any(|row| row.conditions.time_s.is_none()) {
        return;
    }
    let names = std::mem::take(&mut data.runs);
    let key = |row: &Row| {
        let command = &row.command;
        let vectors = [command.linear_mm, command.rotary_rad, command.tool_mm];
        let mut numbers = vec![row.conditions.time_s.unwrap_or_default()];
        numbers.extend(vectors.iter().flat_map(|v| v.iter().copied()));
        numbers.extend(command.direction.map(f64::from));
        numbers
    };
    data.rows.sort_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        let order = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
        // What was measured at one time in one place has no order but that of the lines.
        order.unwrap_or(std::cmp::Ordering::Equal).then_with(|| names[a.run].cmp(&names[b.run]))
    });
    let mut place: Vec<Option<usize>> = vec![None; names.len()];
    for row in &mut data.rows {
        row.run = *place[row.run].get_or_insert_with(|| {
            data.runs.push(names[row.run].clone());
            data.runs.len() - 1
        });
    }
}
