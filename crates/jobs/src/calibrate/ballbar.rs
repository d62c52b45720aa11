//! `vpost calibrate ballbar`.

use std::path::PathBuf;

use calibration::CalibrationError;
use calibration::linear_ballbar::{self, CircleCalibration};
use calibration::rotary_ballbar::{self, RotaryCalibration, Test};
use clap::Args;
use diagnostic::{Speaks, Text, notice};
use machine_model::effects::{Conditions, EffectTerm};
use machine_model::{
    Axis, Command, Description, Engine, LinearAxis, Range, RotaryAxis, Squareness, Vector, WithEffects,
};
use machine_profile::{Profile, ProfileText};

use crate::conditions;
use crate::message::Failure;
use crate::profile::load_mill;
use crate::values::{Given, Point3};

use super::bar_readings::{FAR, Measured, Readings};
use super::bar_report::{before_and_after, circle_report, rotary_report};
use super::codes::{AXES, CONTRADICTED, OPEN, OUTLIER, QUESTION, UNSAID, body, failure};
use super::output::{self, Output, Target, profile_text};
use super::page::{Bars, Shown};
use super::sources::mean;
use super::work::Work;

/// `vpost calibrate ballbar FILES… -o PROFILE`
#[derive(Debug, Args)]
pub struct Ballbar {
    /// Readings (CSV): run, x_mm … z_mm of the moving ball, bx_mm … bz_mm of the other at angle 0, length_mm, and
    /// a_deg, b_deg, c_deg, spindle_deg or dir_x … dir_z.
    #[arg(value_name = "READINGS.csv", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// A point through which the axes of the table should go, machine coordinates, mm, where the base profile has no
    /// centre_mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub crossing: Option<Given<Point3>>,
    /// The same tests after a compensation: a table before and after.
    #[arg(long, value_name = "READINGS.csv")]
    pub after: Option<PathBuf>,
    #[command(flatten)]
    pub shown: Shown,
}

/// The machine that readings are predicted with, before any change.
struct Base {
    description: Description,
    /// Without conditions; `None` for a machine of which only the chain is known.
    profile: Option<Profile>,
    tool_mm: Vector,
    /// Axes whose centre_mm is to be written.
    centred: Vec<Axis>,
}

/// Places nearer than this are one, mm.
const SAME_MM: f64 = 1e-3;

impl Base {
    /// From `-m`, or the chain alone: the axes then go as far as the balls stood.
    fn new(arguments: &Ballbar, work: &Work<'_>, readings: &Readings) -> Result<Self, Failure> {
        let Some(path) = &work.options.machine else {
            // Where no rotary axis turns, the order of perfect axes makes no difference.
            let any = if readings.turn_something() { None } else { Some("[w X Y b Z t]") };
            let Some(chain) = arguments.target.chain.as_deref().or(any) else {
                return Err(Failure::usage(notice!(QUESTION;
                    "which axis of the table carries which?", "какая ось стола несёт какую?";
                    "add `-m PROFILE.toml` of the machine, or `--chain \"[w C A X Y b Z t]\"`: axes from the workpiece on",
                    "добавьте `-m PROFILE.toml` станка или `--chain \"[w C A X Y b Z t]\"`: оси, начиная от детали"
                )));
            };
            let chain = output::chain(chain, "[w C A X Y b Z t]")?;
            let [low, high] = readings.span_mm();
            let linear = [0, 1, 2].map(|i| {
                // An axis that stood has no length; the model wants one.
                let high = high[i].max(low[i] + SAME_MM);
                LinearAxis::perfect(Range { low: low[i], high })
            });
            let rotary = [0; 3].map(|_| RotaryAxis::perfect(Vector::zeros()));
            let description = Description { chain, linear, rotary, squareness: Squareness::default() };
            return Ok(Self { description, profile: None, tool_mm: Vector::zeros(), centred: Vec::new() });
        };
        let profile = load_mill(path)?.profile;
        let tool_mm = Vector::from(profile.default_tool_mm);
        Ok(Self {
            description: profile.description.clone(),
            profile: Some(profile),
            tool_mm,
            centred: Vec::new(),
        })
    }

    /// Settles where the axes that turned are: by the profile, or by `--crossing` where it does not say.
    fn pivots(&mut self, arguments: &Ballbar, work: &Work<'_>, readings: &Readings) -> Result<(), Failure> {
        let crossing = arguments.crossing.as_ref().map(|given| (given, Vector::from(given.0)));
        let text = match &work.options.machine {
            Some(path) => ProfileText::parse(&profile_text(path)?),
            None => None,
        };
        let chain = &self.description.chain;
        if let Some(axis) = chain.head().iter().find(|axis| readings.turn(**axis)) {
            return Err(Failure::usage(notice!(AXES;
                "{axis} turns the tool on {chain}: a ball bar calibrates axes that turn the table, not those of a head",
                "{axis} поворачивает на {chain} инструмент: телескопическим измерителем калибруют оси стола, а не головы";
                "leave the runs of {axis} out; location errors known from elsewhere go into [rotary.{axis}] of the profile",
                "исключите проходы {axis}; известные из других измерений погрешности положения оси впишите в [rotary.{axis}] профиля"
            )));
        }
        for axis in self.description.chain.table().to_vec() {
            let own = &mut self.description.rotary[axis.direction()];
            let letter = axis.letter().to_string();
            let said = text.as_ref().is_some_and(|text| text.says(&["rotary", &letter, "centre_mm"]));
            match crossing {
                Some((text, at)) if said => {
                    let mut beside = at - own.centre_mm;
                    beside[axis.direction()] = 0.0;
                    if beside.norm() > SAME_MM {
                        let [x, y, z] = own.centre_mm.into();
                        return Err(Failure::usage(notice!(AXES;
                            "`--crossing {text}` lies {:.3} mm beside the axis of {axis}, which goes through centre_mm = [{x}, {y}, {z}]",
                            "`--crossing {text}` лежит в {:.3} мм от оси {axis}, которая проходит через centre_mm = [{x}, {y}, {z}]",
                            beside.norm();
                            "leave `--crossing` out, or correct centre_mm in the profile",
                            "уберите `--crossing` или исправьте centre_mm в профиле"
                        )));
                    }
                }
                Some((_, at)) => {
                    own.centre_mm = at;
                    self.centred.push(axis);
                }
                None if !said && readings.turn(axis) => {
                    return Err(Failure::usage(notice!(QUESTION;
                        "where is the axis of {axis}? its location errors count from there",
                        "где ось {axis}? её погрешности положения отсчитываются оттуда";
                        "add `--crossing X,Y,Z`, or `-m PROFILE` with centre_mm of the axes of the table",
                        "добавьте `--crossing X,Y,Z` или `-m PROFILE` с centre_mm осей стола"
                    )));
                }
                None => {}
            }
        }
        Ok(())
    }

    /// The machine under these conditions.
    fn machine(&self, conditions: Conditions) -> Result<WithEffects, Failure> {
        let effects: Vec<EffectTerm> = match &self.profile {
            Some(profile) => profile.effect_terms().map_err(|error| conditions::failure(&error))?,
            None => Vec::new(),
        };
        WithEffects::new(body(&self.description)?, effects, conditions)
            .map_err(|error| conditions::failure(&error.into()))
    }

    /// The machine of each run, at the temperature of its readings.
    fn machines(
        &self,
        temperatures_c: &[Option<f64>],
        target: &Target,
        work: &Work<'_>,
    ) -> Result<Vec<WithEffects>, Failure> {
        let given = conditions::conditions(work.options)?;
        let each = temperatures_c.iter().map(|read_c| {
            let mut own = given;
            if let Some(measured_c) = target.temperature.or(*read_c) {
                own.temp_c = own.temp_c.map(|said_c| said_c.or(Some(measured_c)));
            }
            self.machine(own)
        });
        each.collect()
    }

    /// Refuses readings at places that the base does not know.
    fn knows(&self, name: &str, machine: &WithEffects, command: &Command) -> Result<(), Failure> {
        if self.profile.is_none() {
            return Ok(());
        }
        let volume = machine.volume();
        for (i, axis) in Axis::ALL[..3].iter().enumerate() {
            let (at, range) = (command.linear_mm[i], volume.0[i]);
            if at < range.low - SAME_MM || at > range.high + SAME_MM {
                return Err(Failure::usage(notice!(AXES;
                    "run `{name}`: {axis} at {at:.3} mm lies outside what the base profile knows, {:.3} to {:.3} mm",
                    "проход `{name}`: {axis} в {at:.3} мм лежит вне того, что знает исходный профиль, от {:.3} до {:.3} мм",
                    range.low, range.high;
                    "is `-m` the profile of this machine? x_mm y_mm z_mm are machine coordinates",
                    "в `-m` профиль этого станка? x_mm y_mm z_mm — координаты станка"
                )));
            }
        }
        Ok(())
    }
}

/// Tests with the machines that predict them.
struct Table {
    tests: Measured<Test>,
    machines: Vec<WithEffects>,
}

impl Table {
    fn new(base: &Base, readings: &Readings, target: &Target, work: &Work<'_>) -> Result<Self, Failure> {
        let machine = body(&base.description)?;
        let tests = readings.tests(base.tool_mm, &|command| machine.nominal_tool(command));
        let machines = base.machines(&tests.temperatures_c, target, work)?;
        Ok(Self { tests, machines })
    }

    fn calibrate(&self, base: &Base, readings: &Readings) -> Result<RotaryCalibration, Failure> {
        let tests = &self.tests.what;
        for ((test, name), machine) in tests.iter().zip(&self.tests.names).zip(&self.machines) {
            base.knows(name, machine, &test.command)?;
        }
        let expected = rotary_ballbar::expected_mm(tests, &self.machines).map_err(|error| refusal(&error))?;
        let read = tests.iter().flat_map(|test| &test.readings);
        for (reading, (expected_mm, (angle, length_mm))) in expected.iter().flatten().zip(read).enumerate() {
            if (length_mm - expected_mm).abs() > FAR * expected_mm {
                return Err(readings.at(self.tests.place(reading))(notice!(CONTRADICTED;
                    "at {:.1} degrees the balls would be {expected_mm:.3} mm apart on this table, not {length_mm} mm",
                    "при {:.1} градуса шары на этом столе были бы в {expected_mm:.3} мм друг от друга, а не в {length_mm} мм",
                    angle.to_degrees();
                    "which axis turned? check the columns of the angles, centre_mm and the places of both balls",
                    "какая ось вращалась? проверьте столбцы углов, centre_mm и места обоих шаров"
                )));
            }
        }
        rotary_ballbar::calibrate(tests, &self.machines)
            .map_err(|error| located(&error, readings, |reading| self.tests.place(reading)))
    }
}

/// `vpost calibrate ballbar`
pub(super) fn run(arguments: &Ballbar, work: &Work<'_>) -> Result<(), Failure> {
    let target = &arguments.target;
    let readings = Readings::read(&arguments.files, &target.ignore_column, work)?;
    let mut base = Base::new(arguments, work, &readings)?;
    let mut out = Text::EMPTY;
    let mut rotary = None;
    if readings.turn_something() {
        base.pivots(arguments, work, &readings)?;
        let table = Table::new(&base, &readings, target, work)?;
        let found = table.calibrate(&base, &readings)?;
        out.push(&rotary_report(&found, &table.tests.what, &base.description));
        if let Some(path) = &arguments.after {
            let readings = Readings::read(std::slice::from_ref(path), &target.ignore_column, work)?;
            let after = Table::new(&base, &readings, target, work)?.calibrate(&base, &readings)?;
            out.push(&before_and_after(&found, &after));
        }
        rotary = Some(found);
    }
    let circles = circles(&base, &readings, target, work)?;
    if let Some((found, _)) = &circles {
        out.push(&circle_report(found));
    }
    let temperature_c = mean(&readings.temperatures_c().collect::<Vec<_>>());
    let show = |uncertainty_mm: Option<f64>| {
        let circles = circles.as_ref().map(|(found, names)| (found, names.as_slice()));
        let found = Bars { circles, rotary: rotary.as_ref() };
        arguments.shown.write(&found, &arguments.files, target, work, temperature_c, uncertainty_mm)
    };
    let parts = [rotary.as_ref().map(|r| r.uncertainty_mm), circles.as_ref().map(|(c, _)| c.uncertainty_mm)];
    let found_mm = parts.into_iter().flatten().fold(0.0, units::math::hypot);
    work.print(&out);
    if !target.writes() {
        // What stays of a base is as uncertain as it says, which is asked where a profile is made.
        return show(base.profile.is_none().then_some(found_mm));
    }
    let mut output = Output::start(target, work, load_mill)?;
    if base.profile.is_none() {
        let [low, high] = readings.span_mm();
        output.travel([0, 1, 2].map(|axis| [low[axis], high[axis]]), work);
    }
    if let Some(found) = &rotary {
        write_locations(&mut output, found, &base);
    }
    if let Some((found, _)) = &circles {
        write_circles(&mut output, found, work);
    }
    let sigma = rotary
        .iter()
        .map(|r| r.estimate.sigma)
        .chain(circles.iter().map(|(c, _)| c.estimate.sigma))
        .fold(0.0, f64::max);
    let uncertainty_mm = output.with_base_mm(found_mm, work);
    output.write(target, work, temperature_c, [Some(sigma), Some(uncertainty_mm)])?;
    show(Some(uncertainty_mm))
}

/// The adjustment of the circles, with the names of their runs.
fn circles(
    base: &Base,
    readings: &Readings,
    target: &Target,
    work: &Work<'_>,
) -> Result<Option<(CircleCalibration, Vec<String>)>, Failure> {
    let machine = body(&base.description)?;
    let circles = readings.circles(base.tool_mm, &|command| machine.nominal_tool(command));
    if circles.what.is_empty() {
        return Ok(None);
    }
    let machines = base.machines(&circles.temperatures_c, target, work)?;
    for reading in &circles.what {
        base.knows(&circles.names[reading.run], &machines[reading.run], &reading.command)?;
    }
    let found = linear_ballbar::calibrate(&circles.what, &machines)
        .map_err(|error| located(&error, readings, |reading| circles.place(reading)))?;
    Ok(Some((found, circles.names)))
}

/// What to say of readings that give no profile; an outlier where it stands.
fn located(
    error: &CalibrationError,
    readings: &Readings,
    place: impl Fn(usize) -> (usize, usize),
) -> Failure {
    let CalibrationError::Outlier { point, message } = error else { return refusal(error) };
    readings.at(place(*point))(notice!(OUTLIER; message.clone();
        "measure it again, or leave it out; readings moved by a row look like this as well",
        "измерьте снова или исключите; так же выглядят показания со сдвигом на строку"
    ))
}

fn refusal(error: &CalibrationError) -> Failure {
    Failure::unfit(match error {
        CalibrationError::Axes(_) => notice!(AXES; error.text();
            "is `-m` (or `--chain`) the machine that was measured?",
            "в `-m` (или `--chain`) тот станок, который измеряли?"
        ),
        CalibrationError::Unobservable(_) => notice!(OPEN; error.text();
            "add the test that tells them apart: the spindle's turn for eX and eY, the ball 100 mm beside or above for a tilt",
            "добавьте опыт, который их различит: поворот шпинделя для eX и eY, шар на 100 мм в стороне или выше для наклона"
        ),
        CalibrationError::Contradicted(_) => notice!(CONTRADICTED; error.text();
            "check the files: columns exchanged, directions the wrong way round, a circle of another day or another bar",
            "проверьте файлы: переставленные столбцы, направления наоборот, круг другого дня или другого измерителя"
        ),
        _ => return failure("", &[], error),
    })
}

fn write_locations(output: &mut Output, found: &RotaryCalibration, base: &Base) {
    for axis in &base.centred {
        let centre = base.description.rotary[axis.direction()].centre_mm.into();
        output.text.set_triple(&["rotary", &axis.letter().to_string(), "centre_mm"], centre, 6);
    }
    for f in &found.locations {
        output.location(&f.location, f.value, 3);
    }
}

fn write_circles(output: &mut Output, found: &CircleCalibration, work: &Work<'_>) {
    for (k, key) in ["EC0Y_urad", "EB0Z_urad", "EA0Z_urad"].into_iter().enumerate() {
        if let Some(term) = found.squareness_rad[k] {
            output.text.set_number(&["squareness", key], term.value * 1e6, 3);
        }
    }
    for axis in &Axis::ALL[..3] {
        let Some(term) = found.backlash_mm[axis.direction()] else { continue };
        let base = output.base.as_ref().map(|base| base.description.linear[axis.direction()].clone());
        let (before_mm, change_mm) = (base.as_ref().map_or(0.0, |b| b.backlash_mm), term.value - term.base);
        let Some(LinearAxis { errors: Some(positive), errors_negative: Some(negative), .. }) = base else {
            let key = ["axis", &axis.letter().to_string(), "backlash_um"];
            output.text.set_number(&key, (before_mm + change_mm) * 1e3, 3);
            continue;
        };
        // Two tables hold the reversal between them: each takes half of the change.
        for (key, tables, half_mm) in [("errors", positive, -0.5), ("errors_negative", negative, 0.5)] {
            let nodes = tables.nodes();
            let mut functions: [Option<Vec<f64>>; 6] =
                std::array::from_fn(|k| Some(nodes.iter().map(|q| tables.at(*q)[k]).collect()));
            if let Some(along) = &mut functions[axis.direction()] {
                along.iter_mut().for_each(|value| *value += half_mm * change_mm);
            }
            output.errors(*axis, key, nodes, &functions);
        }
    }
    for (name, term) in super::bar_report::SCALES.into_iter().zip(found.mismatch) {
        if let Some(term) = term.filter(|t| t.value.abs() > t.half_width_95.max(SEEN_RATIO)) {
            work.warning(notice!(UNSAID;
                "scale {name} of {:.1} um/m is not written: a bar does not say which of the two axes it is",
                "масштаб {name} {:.1} мкм/м не записан: измеритель не говорит, какой из двух осей он",
                term.value * 1e6;
                "measure the positioning of both axes with an interferometer",
                "измерьте позиционирование обеих осей интерферометром"
            ));
        }
    }
}

/// A mismatch below is not worth a word: 5 µm in a metre.
const SEEN_RATIO: f64 = 5e-6;
