//! The error over the volume: where it is asked for, and what it is there.

pub mod asked;
pub mod curves;
pub mod deformation;
pub mod dominant;
pub mod drawn;
pub mod export;
mod job;
pub mod json;
pub mod second_order;
pub mod study;
pub mod text;

pub use job::of;

use diagnostic::{Speaks, Text, both, notice};
use error_map::{ErrorMap, Grid, Nodes};
use machine_model::{Command, Engine, PathModel, Range, SolveError, Vector, Volume};
use machine_profile::Profile;
use rayon::prelude::*;

use crate::message::{Failure, OPTION, Report};
use crate::options::{JobOptions, Outside};
use crate::predict::{POINT_OUTSIDE, other_tool};
use crate::values::{Given, Lattice, Rotary, ToolVector};

/// The engine as a model of paths, which says errors.
///
/// # Errors
/// It only solves.
pub fn model(engine: &dyn Engine) -> Result<&dyn PathModel, Failure> {
    engine.path_model().ok_or_else(|| {
        Failure::usage(notice!(OPTION;
            "engine `{}` has no forward model: it reproduces a publication",
            "у метода `{}` нет прямой модели: он воспроизводит публикацию", engine.id();
            "leave `--engine` out, or take one of the engines without `-published`",
            "уберите `--engine` или возьмите метод без `-published`"
        ))
    })
}

/// Refuses a tool vector of which the model knows nothing.
fn require_tool(model: &dyn PathModel, tool_mm: Vector) -> Result<(), Failure> {
    match model.knows(&Command { tool_mm, ..Command::default() }) {
        Err(error @ SolveError::OtherTool { .. }) => {
            let help = both!(
                "give the tool vector of the measured vectors with `--tool-vector X,Y,Z`, or write it as default_mm",
                "задайте вектор инструмента измеренных векторов: `--tool-vector X,Y,Z`, или напишите его в default_mm"
            );
            Err(Failure::usage(other_tool(error.text()).help(help)))
        }
        _ => Ok(()),
    }
}

/// Boxes of nodes that reach outside the calibrated volume: refused, unless the nearest point's error is asked for.
pub(crate) fn outside(
    boxes_mm: impl IntoIterator<Item = [Range; 3]>,
    volume: Volume,
    options: &JobOptions,
) -> Result<Vec<Report>, Failure> {
    let mut warnings = Vec::new();
    for ranges in boxes_mm {
        for (axis, range) in ranges.iter().enumerate() {
            let known = volume.0[axis];
            if known.contains(range.low) && known.contains(range.high) {
                continue;
            }
            let message = both!(
                "{} from {} to {} mm reaches outside the calibrated volume, {} to {} mm",
                "{} от {} до {} мм выходит из калиброванного объёма, от {} до {} мм",
                ['X', 'Y', 'Z'][axis],
                range.low,
                range.high,
                known.low,
                known.high
            );
            if options.outside != Some(Outside::Clamp) {
                return Err(Failure::usage(notice!(POINT_OUTSIDE; message;
                    "stay inside, or take the nearest point's error with `--outside clamp`",
                    "оставайтесь внутри или возьмите погрешность ближайшей точки: `--outside clamp`"
                )));
            }
            warnings.push(Report::warning(notice!(POINT_OUTSIDE; message;
                "the nodes outside have the error of the volume's nearest point",
                "у узлов снаружи погрешность ближайшей точки объёма"
            )));
        }
    }
    Ok(warnings)
}

/// The map of a grid, on all cores; each node is computed by itself, so their number changes nothing.
fn evaluated(grid: Grid, error_mm: impl Fn(&Vector) -> Vector + Sync) -> ErrorMap {
    let errors = (0..grid.len()).into_par_iter().with_min_len(256).map(|i| error_mm(&grid.place_mm(i)));
    let errors = errors.collect();
    ErrorMap::new(grid, errors)
}

/// Nodes over the volume, or where they were said to be.
pub(crate) fn grid(given: &Given<Lattice>, volume: Volume) -> Result<Grid, Failure> {
    let refuse = |why: Text| {
        Failure::usage(notice!(OPTION;
            "`--grid {given}`: {why}", "`--grid {given}`: {why:#}";
            "write numbers of nodes as in `--grid 22x22x21`, or from:to:step in mm as in `--grid 40:880:40,30:450:20,5:505:25`",
            "напишите числа узлов, например `--grid 22x22x21`, или от:до:шаг в мм, например `--grid 40:880:40,30:450:20,5:505:25`"
        ))
    };
    let axis = |k: usize| match **given {
        Lattice::Counts(counts) => Nodes::over(volume.0[k], counts[k]),
        Lattice::Stepped(axes) => Nodes::stepped(axes[k][0], axes[k][1], axes[k][2]),
    };
    let nodes = [0, 1, 2].map(|k| axis(k).map_err(|error| refuse(error.text())));
    let [x, y, z] = nodes;
    Grid::new([x?, y?, z?]).map_err(|error| refuse(error.text()))
}

/// An H number stands for minus its length vector, as under G43.
pub(crate) fn tool(
    given: Option<&Given<ToolVector>>,
    options: &JobOptions,
    profile: &Profile,
) -> Result<Vector, Failure> {
    match given.map(|given| **given) {
        None => Ok(Vector::from(profile.default_tool_mm)),
        Some(ToolVector::Vector(mm)) => Ok(Vector::from(mm)),
        Some(ToolVector::Length(number)) => crate::settings::tools(options, profile)
            .iter()
            .find(|(known, _)| *known == number)
            .map(|(_, length)| {
                Vector::new(0.0, 0.0, profile.gauge_point_mm.unwrap_or(0.0)) - Vector::from(*length)
            })
            .ok_or_else(|| {
                Failure::usage(notice!(OPTION;
                    "`--tool-vector H{number}`: neither the profile nor `--tool` has an H{number}",
                    "`--tool-vector H{number}`: H{number} нет ни в профиле, ни в `--tool`";
                    "add `--tool H{number}=120`", "добавьте `--tool H{number}=120`"
                ))
            }),
    }
}

/// Where the rotary axes stand, rad; those that are not named stand at 0.
pub(crate) fn rotary(given: Option<&Given<Rotary>>, profile: &Profile) -> Result<Vector, Failure> {
    let Some(given) = given else { return Ok(Vector::zeros()) };
    for (axis, angle) in given.0.iter().enumerate() {
        if angle.is_some() && !profile.has_rotary()[axis] {
            return Err(Failure::usage(notice!(OPTION;
                "`--rotary {given}`: the profile's chain has no such axis",
                "`--rotary {given}`: такой оси в цепи профиля нет";
                "the chain is {}", "цепь — {}", profile.chain()
            )));
        }
    }
    let rotary_rad = Vector::from(given.0.map(|angle| angle.unwrap_or(0.0).to_radians()));
    let turned = Command { rotary_rad, ..Command::default() };
    profile.rigid_body_without_effects().rotary_inside(&turned).map_err(|error| {
        let error = error.text();
        Failure::usage(notice!(OPTION;
            "`--rotary {given}`: {error}", "`--rotary {given}`: {error:#}";
            "give angles inside its travel and its table", "дайте углы в пределах её хода и её таблицы"
        ))
    })?;
    Ok(rotary_rad)
}
