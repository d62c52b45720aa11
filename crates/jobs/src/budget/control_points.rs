//! Where the criteria are taken: a grid over the volume, or the points of a file.

use diagnostic::{Diagnostic, Speaks, Text, both, notice};
use error_budget::Machine;
use error_map::Nodes;
use machine_model::{Axis, Command, Engine, PathModel, Range, RotaryAxis, RotaryPlay, Vector, Volume};
use machine_profile::Profile;

use crate::figures::{printable, triple};
use crate::map::{grid, outside, rotary};
use crate::message::{Failure, OPTION, Report};
use crate::options::{JobOptions, Outside};
use crate::points::{self, POINTS};
use crate::predict::POINT_OUTSIDE;
use crate::values::{Ball, Given, Lattice, Rotary};

/// Most control points: with forty deviations they fill a quarter of a gigabyte.
const MOST: usize = 250_000;

/// The control points.
pub struct ControlPoints {
    /// What the machine is told.
    pub commands: Vec<Command>,
    /// What they are, in words.
    pub what: Text,
}

/// What points are made of.
pub(super) struct Taken<'a> {
    pub(super) options: &'a JobOptions,
    pub(super) profile: &'a Profile,
    pub(super) machine: &'a Machine,
    pub(super) tool_mm: Vector,
    /// What is to be said of them.
    pub(super) warnings: &'a mut Vec<Report>,
}

impl Taken<'_> {
    pub(super) fn over_the_volume(
        &mut self,
        given: &Given<Lattice>,
        angles: Option<&Given<Rotary>>,
    ) -> Result<ControlPoints, Failure> {
        let Self { machine, profile, tool_mm, .. } = *self;
        let volume = machine.model().volume();
        let grid = grid(given, volume)?;
        let boxes_mm = [grid.axes().each_ref().map(Nodes::range_mm)];
        self.warnings.extend(outside(boxes_mm, volume, self.options)?);
        let rotary_rad = rotary(angles, profile)?;
        // Where lost motion counts, the worst approach of each axis is looked for, too.
        let sides = |plays: [bool; 3]| -> Vec<[i8; 3]> {
            let all = (0..8_u8).filter(|bits| (0..3).all(|axis| plays[axis] || bits >> axis & 1 == 0));
            let side = |bits: u8, axis: usize| if bits >> axis & 1 == 0 { 1 } else { -1 };
            all.map(|bits| [0, 1, 2].map(|axis| i8::from(plays[axis]) * side(bits, axis))).collect()
        };
        let linear = sides([machine.model().depends_on_direction(); 3]);
        let rotary = sides(machine.model().base().description().rotary.each_ref().map(RotaryAxis::has_play));
        let directions: Vec<([i8; 3], [i8; 3])> =
            linear.iter().flat_map(|linear| rotary.iter().map(|rotary| (*linear, *rotary))).collect();
        let count = grid.len().saturating_mul(directions.len());
        if count > MOST {
            return Err(too_many(&format!("`--grid {}`", given), count, directions.len()));
        }
        let command = |(place, (direction, rotary)): (usize, &([i8; 3], [i8; 3]))| Command {
            linear_mm: grid.place_mm(place),
            rotary_rad,
            tool_mm,
            direction: *direction,
            rotary_play: RotaryPlay { direction: *rotary, ..RotaryPlay::default() },
            ..Command::default()
        };
        let commands: Vec<Command> = (0..grid.len())
            .flat_map(|place| directions.iter().map(move |d| (place, d)))
            .map(command)
            .collect();
        let axes = ["X", "Y", "Z"].iter().zip(grid.axes()).map(|(name, nodes)| {
            let range = nodes.range_mm();
            let (low, high, count) = (range.low, range.high, nodes.places_mm().len());
            both!("{name} {low} to {high} mm ({count})", "{name} от {low} до {high} мм ({count})")
        });
        let axes = Text::join(&axes.collect::<Vec<_>>(), ", ");
        let approach = match directions.len() {
            1 => Text::EMPTY,
            sides => {
                both!(", each approached from all {sides} sides", ", подход к каждой со всех {sides} сторон")
            }
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

    /// A ball on the table that the linear axes follow through the angles of the table's axes (Serkov 2017), all rotary
    /// axes coming from below, the linear ones as they come from place to place.
    pub(super) fn on_a_ball(&self, ball: &Given<Ball>) -> Result<ControlPoints, Failure> {
        let Ball { radius_mm, height_mm, lead } = **ball;
        let Self { machine, profile, tool_mm, .. } = *self;
        let table = profile.chain().table();
        let Some(spin) = table.first().copied() else {
            return Err(Failure::usage(notice!(OPTION;
                "`--ball {ball}`: this machine has no rotary table",
                "`--ball {ball}`: у этого станка нет поворотного стола";
                "give the points by `--points`", "задайте точки через `--points`"
            )));
        };
        let other = profile.chain().axes().find(|axis| !axis.is_linear() && *axis != spin);
        let mut axes = [Some(spin), other].into_iter().flatten();
        let Some(lead) = axes.clone().find(|axis| axis.letter() == lead) else {
            let axes: Vec<String> = axes.map(|axis| axis.to_string()).collect();
            return Err(Failure::usage(notice!(OPTION;
                "`--ball {ball}`: there is no rotary axis {lead}", "`--ball {ball}`: поворотной оси {lead} нет";
                "let one of {} lead", "ведущей может быть {}", axes.join(", ")
            )));
        };
        let angles = |axis: Axis| {
            let round = if axis == spin { [0.0, 359.0] } else { [-180.0, 179.0] };
            places_deg(profile.description.rotary[axis.direction()].calibrated_rad(), round)
        };
        let outer = angles(lead);
        let inner = axes.find(|axis| *axis != lead);
        let inner_deg = inner.map_or(vec![0.0], angles);
        let body = machine.model().base();
        let centre = body.description().rotary[spin.direction()].centre_mm;
        let place = centre + Vector::new(radius_mm, 0.0, height_mm) - tool_mm;
        let plays = body.description().rotary.each_ref().map(|rotary| i8::from(rotary.has_play()));
        let mut commands: Vec<Command> = Vec::new();
        for one in &outer {
            for two in &inner_deg {
                let mut degrees = Vector::zeros();
                degrees[lead.direction()] = *one;
                if let Some(inner) = inner {
                    degrees[inner.direction()] = *two;
                }
                let rotary_play = RotaryPlay { direction: plays, ..RotaryPlay::default() };
                let rotary_rad = degrees.map(f64::to_radians);
                let mut command = Command { rotary_rad, tool_mm, rotary_play, ..Command::default() };
                command.linear_mm = body.same_tip_mm(&place, &command, &Vector::zeros());
                let before = commands.last().map_or(command, |before| *before);
                let way = command.linear_mm - before.linear_mm;
                command.direction = [0, 1, 2].map(|i| match way[i] {
                    step if step > 1e-9 => 1,
                    step if step < -1e-9 => -1,
                    _ => before.direction[i],
                });
                commands.push(command);
            }
        }
        let volume: Volume = machine.model().volume();
        if let Some(outside) = commands.iter().find(|command| !volume.contains(&command.linear_mm)) {
            let at = triple(&outside.linear_mm, 3);
            return Err(Failure::usage(notice!(OPTION;
                "`--ball {ball}`: the linear axes would have to go to {at}, outside the calibrated volume",
                "`--ball {ball}`: линейным осям пришлось бы идти в {at}, вне калиброванного объёма";
                "take a smaller R or H, or another tool (`--tool-vector`)",
                "возьмите меньше R или H или другой инструмент (`--tool-vector`)"
            )));
        }
        let tool = triple(&tool_mm, 3);
        let what = both!(
            "a ball at R {radius_mm} mm, {height_mm} mm above the centre of {spin}, in steps of {BALL_STEP_DEG} degrees, {lead} leading\ntool vector {tool}",
            "шар на радиусе {radius_mm} мм, на {height_mm} мм выше центра {spin}, с шагом {BALL_STEP_DEG}°, ведущая ось {lead}\nвектор инструмента {tool}"
        );
        Ok(ControlPoints { commands, what })
    }

    pub(super) fn in_a_file(&mut self, name: &str, bytes: &[u8]) -> Result<ControlPoints, Failure> {
        let Self { machine, profile, tool_mm, .. } = *self;
        let points = points::read(name, bytes, tool_mm.into(), profile)?;
        let refuse = |diagnostic: Diagnostic| Failure::refused(name, bytes, vec![diagnostic]);
        if points.rows.is_empty() {
            return Err(refuse(notice!(POINTS;
                "the point file has no rows", "в файле точек нет строк";
                "give a row for each point at which the machine is to be judged",
                "дайте по строке на каждую точку, в которой оценивать станок"
            )));
        }
        if points.rows.len() > MOST {
            return Err(too_many(name, points.rows.len(), 1));
        }
        let volume = machine.model().volume();
        let mut outside = 0;
        for (row, (_, command)) in points.rows.iter().enumerate() {
            if let Err(error) = machine.model().base().rotary_inside(command) {
                let error = error.text();
                return Err(refuse(notice!(POINT_OUTSIDE;
                    "point {}: {error}", "точка {}: {error:#}", row + 1;
                    "leave the point out", "исключите точку"
                )));
            }
            if volume.contains(&command.linear_mm) {
                continue;
            }
            if self.options.outside != Some(Outside::Clamp) {
                let [x, y, z] = volume.0.map(|range| both!("{} to {}", "{}…{}", range.low, range.high));
                let (point, at) = (row + 1, triple(&command.linear_mm, 3));
                return Err(refuse(notice!(POINT_OUTSIDE;
                    "point {point} at {at} lies outside the calibrated volume, X {x}, Y {y}, Z {z} mm",
                    "точка {point} в {at} лежит вне калиброванного объёма, X {x:#}, Y {y:#}, Z {z:#} мм";
                    "leave it out, or take the nearest point's error with `--outside clamp`",
                    "исключите её или возьмите погрешность ближайшей точки: `--outside clamp`"
                )));
            }
            outside += 1;
        }
        if outside > 0 {
            self.warnings.push(Report::warning(notice!(POINT_OUTSIDE;
                "{outside} of {} points lie outside the calibrated volume",
                "вне калиброванного объёма лежат точки: {outside} из {}", points.rows.len();
                "each has the error of the volume's nearest point",
                "каждой приписана погрешность ближайшей точки объёма"
            )));
        }
        let commands: Vec<Command> = points.rows.into_iter().map(|(_, command)| command).collect();
        let mut what = both!("from {}", "из {}", printable(name));
        // Half of every reversal value would go unseen, and nobody would know.
        if machine.model().depends_on_direction() && commands.iter().any(|c| c.direction.contains(&0)) {
            what.push(&Text::pair(
                ", where dir_x, dir_y, dir_z do not say: the mean of both directions, without lost motion",
                ", где dir_x, dir_y, dir_z не указаны: среднее обоих направлений, без мёртвого хода",
            ));
        }
        Ok(ControlPoints { commands, what })
    }
}

/// Between places of a ball its axes turn by so many degrees: Serkov 2017.
const BALL_STEP_DEG: f64 = 30.0;

/// The angles of an axis that a ball is followed through, once round at most.
fn places_deg(range: Range, round_deg: [f64; 2]) -> Vec<f64> {
    let (low, high) = (range.low.to_degrees().max(round_deg[0]), range.high.to_degrees().min(round_deg[1]));
    // The end of a range in degrees is not exact in radians.
    let first = ((low - 1e-9) / BALL_STEP_DEG).ceil() as i32;
    let last = ((high + 1e-9) / BALL_STEP_DEG).floor() as i32;
    (first..=last).map(|k| f64::from(k) * BALL_STEP_DEG).collect()
}

fn too_many(what: &str, count: usize, directions: usize) -> Failure {
    let each = if directions > 1 {
        both!(
            " (each node from {directions} sides, for lost motion)",
            " (каждый узел с {directions} сторон, из-за мёртвого хода)"
        )
    } else {
        Text::EMPTY
    };
    Failure::usage(notice!(OPTION;
        "{what}: {count} control points{each} are more than the {MOST} of a budget",
        "{what}: контрольных точек{each:#} {count}, а в бюджете их не больше {MOST}";
        "errors are smooth: take a coarser grid", "погрешности плавны: возьмите сетку крупнее"
    ))
}
