//! Readings of a ball bar: files to circles and tests.

use std::collections::BTreeMap;
use std::path::PathBuf;

use calibration::linear_ballbar::CircleReading;
use calibration::rotary_ballbar::{Test, Turning};
use diagnostic::{Diagnostic, both, notice};
use machine_model::{Axis, Command, Vector};
use measurement_files::{Row, Sheet};

use crate::message::Failure;

use super::codes::{AXES, UNITS};
use super::sources;
use super::work::Work;

const COLUMNS: &str = "run repeat x_mm y_mm z_mm bx_mm by_mm bz_mm length_mm a_deg b_deg c_deg spindle_deg dir_x dir_y \
                       dir_z temp_c note plane radius_mm angle_deg deviation_um dir";

/// Columns of angles: A, B, C, spindle.
const ANGLES: [&str; 4] = ["a_deg", "b_deg", "c_deg", "spindle_deg"];

/// One row.
struct Line {
    /// File and row in it.
    place: (usize, usize),
    /// Tool ball, then the other, mm.
    balls: [Vector; 2],
    /// A, B, C, spindle, degrees.
    angles_deg: [f64; 4],
    length_mm: f64,
    direction: [i8; 3],
}

/// Readings that share a set-up.
struct Run {
    name: String,
    lines: Vec<Line>,
    temperatures_c: Vec<f64>,
}

/// What a run moves.
enum Moves {
    /// Two linear axes.
    Linear,
    /// One of [`ANGLES`].
    Turning(usize),
}

/// What the files hold.
pub(super) struct Readings {
    sheets: Vec<Sheet>,
    runs: Vec<(Run, Moves)>,
}

/// Runs of one kind, as the adjustment takes them, and where each reading stands.
pub(super) struct Measured<T> {
    /// Circles' readings, or tests.
    pub(super) what: Vec<T>,
    /// Names of the runs.
    pub(super) names: Vec<String>,
    /// Mean temperature of each run, °C.
    pub(super) temperatures_c: Vec<Option<f64>>,
    places: Vec<(usize, usize)>,
}

impl Readings {
    /// Reads the files; a run is one of its own file.
    pub(super) fn read(files: &[PathBuf], ignore: &[String], work: &Work<'_>) -> Result<Self, Failure> {
        let mut sheets = Vec::new();
        let mut runs: Vec<(Run, Moves)> = Vec::new();
        for (file, path) in files.iter().enumerate() {
            let expected = both!(
                "a reading of a ball bar is a length between two balls",
                "показание телескопического измерителя — длина между двумя шарами"
            );
            let sheet = sources::sheet(work.read(path)?, COLUMNS, expected.clone(), ignore)?;
            sheet.need(&["run"], expected)?;
            sheet.need_bars()?;
            let mut own: Vec<Run> = Vec::new();
            let mut known = BTreeMap::new();
            for (number, row) in sheet.rows().enumerate() {
                let name = row.text("run").into_owned();
                let at = *known.entry(name).or_insert_with_key(|name| {
                    own.push(Run { name: name.clone(), lines: Vec::new(), temperatures_c: Vec::new() });
                    own.len() - 1
                });
                let line = line(&row, (file, number))?;
                own[at].temperatures_c.extend(row.number("temp_c")?);
                own[at].lines.push(line);
            }
            for run in own {
                let moves = run.moves(sheet.name())?;
                runs.push((run, moves));
            }
            sheets.push(sheet);
        }
        Ok(Self { sheets, runs })
    }

    /// True where an axis of A, B, C or the spindle turns.
    pub(super) fn turn_something(&self) -> bool {
        self.runs.iter().any(|(_, moves)| matches!(moves, Moves::Turning(_)))
    }

    /// True where this axis turns.
    pub(super) fn turn(&self, axis: Axis) -> bool {
        self.runs.iter().any(|(_, moves)| matches!(moves, Moves::Turning(k) if *k == axis.direction()))
    }

    /// Temperatures of all readings that have one, °C.
    pub(super) fn temperatures_c(&self) -> impl Iterator<Item = f64> + '_ {
        self.runs.iter().flat_map(|(run, _)| run.temperatures_c.iter().copied())
    }

    /// Lowest and highest place of the moving ball.
    pub(super) fn span_mm(&self) -> [Vector; 2] {
        let balls = self.runs.iter().flat_map(|(run, _)| run.lines.iter().map(|line| line.balls[0]));
        let start = [Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)];
        balls.fold(start, |[low, high], ball| [low.inf(&ball), high.sup(&ball)])
    }

    /// The circles; `tool_mm` turns with the head: from the command's angles to the vector.
    pub(super) fn circles(
        &self,
        tool_mm: Vector,
        turned: &dyn Fn(&Command) -> Vector,
    ) -> Measured<CircleReading> {
        let mut all = Measured::new();
        for (run, _) in self.runs.iter().filter(|(_, moves)| matches!(moves, Moves::Linear)) {
            let number = all.names.len();
            all.names.push(run.name.clone());
            all.temperatures_c.push(run.temperature_c());
            for line in &run.lines {
                all.what.push(CircleReading {
                    run: number,
                    command: line.command(tool_mm, turned),
                    centre_mm: line.balls[1],
                    length_mm: line.length_mm,
                });
                all.places.push(line.place);
            }
        }
        all
    }

    /// The tests in which one axis or the spindle turns.
    pub(super) fn tests(&self, tool_mm: Vector, turned: &dyn Fn(&Command) -> Vector) -> Measured<Test> {
        let mut all = Measured::new();
        for (run, moves) in &self.runs {
            let Moves::Turning(one) = *moves else { continue };
            all.names.push(run.name.clone());
            all.temperatures_c.push(run.temperature_c());
            let first = &run.lines[0];
            all.what.push(Test {
                turning: Axis::ALL.get(3 + one).map_or(Turning::Spindle, |axis| Turning::Axis(*axis)),
                command: first.command(tool_mm, turned),
                bar_mm: first.balls[1] - first.balls[0],
                readings: run.lines.iter().map(|l| (l.angles_deg[one].to_radians(), l.length_mm)).collect(),
            });
            all.places.extend(run.lines.iter().map(|line| line.place));
        }
        all
    }

    /// What is refused of the length of one reading.
    pub(super) fn at(&self, (file, number): (usize, usize)) -> impl FnOnce(Diagnostic) -> Failure {
        move |wrong| match self.sheets[file].row(number) {
            Some(row) => Failure::at_cell(&row, row.bar_key())(wrong),
            None => Failure::usage(wrong),
        }
    }
}

impl<T> Measured<T> {
    fn new() -> Self {
        Self { what: Vec::new(), names: Vec::new(), temperatures_c: Vec::new(), places: Vec::new() }
    }

    /// File and row of a reading, counted over all runs.
    pub(super) fn place(&self, reading: usize) -> (usize, usize) {
        self.places[reading]
    }
}

fn line(row: &Row<'_>, place: (usize, usize)) -> Result<Line, Failure> {
    let bar = row.bar()?;
    let mut angles_deg = [0.0; 4];
    for (angle, column) in angles_deg.iter_mut().zip(ANGLES) {
        *angle = row.number(column)?.unwrap_or(0.0);
    }
    let (length_mm, apart_mm) = (bar.length_mm, (bar.centre_mm - bar.ball_mm).norm());
    // Lengths must be near what the balls' places say.
    if (length_mm - apart_mm).abs() > FAR * apart_mm {
        return Err(Failure::at_cell(row, row.bar_key())(notice!(UNITS;
            "a length of {length_mm} mm, where the balls are {apart_mm:.3} mm apart",
            "длина {length_mm} мм, а между шарами {apart_mm:.3} мм";
            "give the whole length in mm, not its change; and both balls' places at angle 0",
            "дайте всю длину в мм, а не её изменение; и места обоих шаров при угле 0"
        )));
    }
    let balls = [bar.ball_mm, bar.centre_mm];
    Ok(Line { place, balls, angles_deg, length_mm, direction: bar.direction })
}

/// No bar is so much longer or shorter than its balls stand apart.
pub(super) const FAR: f64 = 0.05;

impl Line {
    fn command(&self, tool_mm: Vector, turned: &dyn Fn(&Command) -> Vector) -> Command {
        let [a, b, c, _] = self.angles_deg.map(f64::to_radians);
        let mut command = Command {
            linear_mm: self.balls[0],
            rotary_rad: Vector::new(a, b, c),
            tool_mm,
            direction: self.direction,
            ..Default::default()
        };
        command.linear_mm -= turned(&command);
        command
    }
}

impl Run {
    fn temperature_c(&self) -> Option<f64> {
        sources::mean(&self.temperatures_c)
    }

    fn moves(&self, file: &str) -> Result<Moves, Failure> {
        let first = &self.lines[0];
        let moves = |of: &dyn Fn(&Line) -> f64| self.lines.iter().any(|l| (of(l) - of(first)).abs() > 1e-9);
        let turning: Vec<usize> = (0..4).filter(|&k| moves(&|l| l.angles_deg[k])).collect();
        let linear = (0..3).any(|i| moves(&|l| l.balls[0][i]));
        let refuse = |wrong: Diagnostic| {
            let message = wrong.message;
            let message = both!("{file}, run `{}`: {message}", "{file}, проход `{}`: {message:#}", self.name);
            Err(Failure::usage(Diagnostic { message, ..wrong }))
        };
        match (turning.as_slice(), linear) {
            ([], true) => Ok(Moves::Linear),
            ([one], false) => {
                let (low, high) = sources::span(self.lines.iter().map(|l| l.angles_deg[*one]));
                let span = high - low;
                // A turn or half a turn in radians is no round number of degrees.
                let turns = [std::f64::consts::TAU, std::f64::consts::PI];
                if turns.iter().any(|turn| (span - turn).abs() < 1e-3) {
                    return refuse(notice!(UNITS;
                        "{} goes over {span:.4}: a turn in radians",
                        "{} охватывает {span:.4}: оборот в радианах", ANGLES[*one];
                        "give degrees", "дайте градусы"
                    ));
                }
                Ok(Moves::Turning(*one))
            }
            ([], false) => refuse(notice!(AXES;
                "nothing moves", "ничего не движется";
                "a run turns one axis or moves two", "в проходе вращается одна ось или движутся две"
            )),
            _ => refuse(notice!(AXES;
                "linear and rotary axes move, or two rotary ones",
                "движутся и линейные, и поворотные оси или две поворотные";
                "turn one axis a run; the others stand", "вращайте в проходе одну ось, остальные стоят"
            )),
        }
    }
}
