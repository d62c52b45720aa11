//! Where the criteria are taken: a grid over the volume, or the points of a file.

use diagnostic::{Diagnostic, Speaks, Text, both};
use error_budget::Machine;
use error_map::Nodes;
use machine_model::{Command, Engine, PathModel, Vector};
use machine_profile::Profile;

use super::arguments::Budget;
use crate::arguments::{Outside, Shared};
use crate::figures::{printable, triple};
use crate::file;
use crate::message::{Failure, Messages, OPTION, Report};
use crate::points::{self, POINTS};
use crate::predict::POINT_OUTSIDE;
use jobs::map::{grid, rotary, tool};

/// Most control points: with forty deviations they fill a quarter of a gigabyte.
const MOST: usize = 250_000;

/// The control points.
pub(super) struct ControlPoints {
    pub commands: Vec<Command>,
    /// What they are, in words.
    pub what: Text,
}

/// From the options.
pub(super) fn read(
    arguments: &Budget,
    shared: &Shared,
    profile: &Profile,
    machine: &Machine,
    messages: &Messages,
) -> Result<ControlPoints, Failure> {
    let tool_mm = tool(arguments.tool_vector.as_ref(), &shared.job, profile)?;
    match &arguments.points {
        Some(path) => {
            let (name, bytes) = (file::name(path), file::read(path)?);
            from_file(&name, &bytes, tool_mm, shared, profile, machine, messages)
        }
        None => over_the_volume(arguments, tool_mm, shared, profile, machine, messages),
    }
}

fn over_the_volume(
    arguments: &Budget,
    tool_mm: Vector,
    shared: &Shared,
    profile: &Profile,
    machine: &Machine,
    messages: &Messages,
) -> Result<ControlPoints, Failure> {
    let volume = machine.model().volume();
    let grid = grid(&arguments.grid, volume)?;
    crate::map::outside([grid.axes().each_ref().map(Nodes::range_mm)], volume, shared, messages)?;
    let rotary_rad = rotary(arguments.rotary.as_ref(), profile)?;
    // Where lost motion counts, the worst approach of each axis is looked for, too.
    let directions: Vec<[i8; 3]> = if machine.model().depends_on_direction() {
        (0..8_u8).map(|bits| [0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { 1 } else { -1 })).collect()
    } else {
        vec![[0; 3]]
    };
    let count = grid.len().saturating_mul(directions.len());
    if count > MOST {
        return Err(too_many(&format!("`--grid {}`", arguments.grid), count, directions.len()));
    }
    let command = |(place, direction): (usize, &[i8; 3])| Command {
        linear_mm: grid.place_mm(place),
        rotary_rad,
        tool_mm,
        direction: *direction,
    };
    let commands: Vec<Command> =
        (0..grid.len()).flat_map(|place| directions.iter().map(move |d| (place, d))).map(command).collect();
    let axes = ["X", "Y", "Z"].iter().zip(grid.axes()).map(|(name, nodes)| {
        let range = nodes.range_mm();
        let (low, high, count) = (range.low, range.high, nodes.places_mm().len());
        both!("{name} {low} to {high} mm ({count})", "{name} от {low} до {high} мм ({count})")
    });
    let axes = Text::join(&axes.collect::<Vec<_>>(), ", ");
    let approach = if directions.len() > 1 {
        Text::pair(", each approached from all 8 sides", ", подход к каждой со всех 8 сторон")
    } else {
        Text::EMPTY
    };
    let what = both!(
        "{}{approach}\ntool vector {}, rotary axes {}",
        "{:#}{approach:#}\nвектор инструмента {}, поворотные оси {}",
        axes,
        triple(&tool_mm, 3),
        triple(&rotary_rad.map(f64::to_degrees), 3)
    );
    Ok(ControlPoints { commands, what })
}

fn from_file(
    name: &str,
    bytes: &[u8],
    tool_mm: Vector,
    shared: &Shared,
    profile: &Profile,
    machine: &Machine,
    messages: &Messages,
) -> Result<ControlPoints, Failure> {
    let points = points::read(name, bytes, tool_mm.into(), profile)?;
    let refuse = |diagnostic: Diagnostic| Failure::refused(name, bytes, vec![diagnostic]);
    if points.rows.is_empty() {
        let help = both!(
            "give a row for each point at which the machine is to be judged",
            "дайте по строке на каждую точку, в которой оценивать станок"
        );
        return Err(refuse(
            Diagnostic::error(POINTS, both!("the point file has no rows", "в файле точек нет строк"))
                .help(help),
        ));
    }
    if points.rows.len() > MOST {
        return Err(too_many(name, points.rows.len(), 1));
    }
    let volume = machine.model().volume();
    let mut outside = 0;
    for (row, (_, command)) in points.rows.iter().enumerate() {
        if let Err(error) = machine.model().base().rotary_inside(command) {
            let error = error.text();
            let message = both!("point {}: {error}", "точка {}: {error:#}", row + 1);
            return Err(refuse(
                Diagnostic::error(POINT_OUTSIDE, message)
                    .help(both!("leave the point out", "исключите точку")),
            ));
        }
        if volume.contains(&command.linear_mm) {
            continue;
        }
        if shared.job.outside != Some(Outside::Clamp) {
            let known = volume.0.map(|range| both!("{} to {}", "{}…{}", range.low, range.high));
            let message = both!(
                "point {} at {} lies outside the calibrated volume, X {}, Y {}, Z {} mm",
                "точка {} в {} лежит вне калиброванного объёма, X {:#}, Y {:#}, Z {:#} мм",
                row + 1,
                triple(&command.linear_mm, 3),
                known[0],
                known[1],
                known[2]
            );
            let help = both!(
                "leave it out, or take the nearest point's error with `--outside clamp`",
                "исключите её или возьмите погрешность ближайшей точки: `--outside clamp`"
            );
            return Err(refuse(Diagnostic::error(POINT_OUTSIDE, message).help(help)));
        }
        outside += 1;
    }
    if outside > 0 {
        let message = both!(
            "{outside} of {} points lie outside the calibrated volume",
            "вне калиброванного объёма лежат точки: {outside} из {}",
            points.rows.len()
        );
        let help = both!(
            "each has the error of the volume's nearest point",
            "каждой приписана погрешность ближайшей точки объёма"
        );
        let diagnostic = Diagnostic::warning(POINT_OUTSIDE, message).help(help);
        messages.report(&Report { source: None, diagnostics: vec![diagnostic] });
    }
    let commands: Vec<Command> = points.rows.into_iter().map(|(_, command)| command).collect();
    let mut what = both!("from {}", "из {}", printable(name));
    // Half of every reversal value would go unseen, and nobody would know.
    if machine.model().depends_on_direction() && commands.iter().any(|c| c.direction.contains(&0)) {
        what.push(&Text::pair(
            ", where dir_x, dir_y, dir_z do not say: the mean of both directions, without lost motion",
            ", где dir_x, dir_y, dir_z не указаны: среднее обоих направлений, без потери хода",
        ));
    }
    Ok(ControlPoints { commands, what })
}

fn too_many(what: &str, count: usize, directions: usize) -> Failure {
    let each = if directions > 1 {
        both!(" (each node from 8 sides, for lost motion)", " (каждый узел с 8 сторон, из-за потери хода)")
    } else {
        Text::EMPTY
    };
    let message = both!(
        "{what}: {count} control points{each} are more than the {MOST} of a budget",
        "{what}: контрольных точек{each:#} {count}, а в бюджете их не больше {MOST}"
    );
    Failure::usage(
        Diagnostic::error(OPTION, message).help(both!(
            "errors are smooth: take a coarser grid",
            "погрешности плавны: возьмите сетку крупнее"
        )),
    )
}
