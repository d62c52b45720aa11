//! Points, measurements and maps.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;

use diagnostic::{Diagnostic, Language, Severity, both};
use jobs::budget::BudgetOptions;
use jobs::calibrate::{Calibrate, Calibration, Said, Setting};
use jobs::conditions;
use jobs::diagnose::{Books, Model};
use jobs::map::asked::MapOptions;
use jobs::message::{Failure, Report};
use jobs::options::{self, JobOptions, Whole};
use jobs::points::POINTS;
use jobs::predict::{Frame, PointsOutside, Predictor};
use jobs::profile;
use jobs::settings::machine;
use jobs::solve::Solver;
use machine_model::{Command, PathModel, RigidBody};
use machine_profile::Profile;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::jobs_on_programs::Text;
use crate::messages::{Told, raised, told};
use crate::rows::{bytes, commands};

/// Arrays of points: position, rotary axes, tool vector (empty: the profile's), direction.
type Arrays = [PyBackedBytes; 4];

fn mill(options: &JobOptions) -> Result<Profile, Failure> {
    Ok(profile::load_mill(machine(options)?)?.profile)
}

/// The commands of points for a machine; none turns an axis that it has not.
fn points(profile: &Profile, arrays: &Arrays) -> Result<Vec<Command>, Failure> {
    let [position, rotary, tool, direction] = arrays.each_ref().map(|array| -> &[u8] { array });
    let count = position.len() / (3 * size_of::<f64>());
    let usual: Vec<u8> =
        profile.default_tool_mm.repeat(count).into_iter().flat_map(f64::to_le_bytes).collect();
    let tool = if tool.is_empty() { &usual } else { tool };
    let commands = commands([position, rotary, tool, direction]);
    let has = profile.has_rotary();
    for (row, command) in commands.iter().enumerate() {
        if let Some(axis) = (0..3).find(|&axis| command.rotary_rad[axis] != 0.0 && !has[axis]) {
            let message = both!(
                "point {}: the machine has no axis {}: its chain is {}",
                "точка {}: на станке нет оси {}: его цепь — {}",
                row + 1,
                ['A', 'B', 'C'][axis],
                profile.chain()
            );
            let help = both!(
                "leave the column out, or give the profile of the machine that turns",
                "уберите столбец или дайте профиль станка с этой осью"
            );
            return Err(Failure::usage(Diagnostic::error(POINTS, message).help(help)));
        }
    }
    Ok(commands)
}

/// The tool's real direction and its angle from the ideal one, µrad, as rows of four.
fn directions(machine: &RigidBody, commands: impl IntoIterator<Item = Command>) -> Vec<f64> {
    let row = |command: Command| {
        let [_, real] = machine.directions(&command);
        [real.x, real.y, real.z, PathModel::tilt_rad(machine, &command) * 1e6]
    };
    commands.into_iter().flat_map(row).collect()
}

type Predicted<'py> = (Bound<'py, PyBytes>, Bound<'py, PyBytes>, Vec<bool>, Bound<'py, PyBytes>, Vec<Told>);

/// Positions, mm; errors and their lengths, µm, in rows of four; what is inside; directions; warnings.
#[pyfunction]
pub(crate) fn predict<'py>(
    py: Python<'py>,
    arrays: Arrays,
    include_setup: bool,
    options: Vec<OsString>,
) -> PyResult<Predicted<'py>> {
    let work = || -> Result<_, Failure> {
        let options = JobOptions::read(options)?;
        let profile = mill(&options)?;
        let commands = points(&profile, &arrays)?;
        let frame = if include_setup { Frame::Measuring } else { Frame::Machine };
        let predictor = Predictor::new(&profile, &options, frame)?;
        let (mut positions, mut errors) = (Vec::new(), Vec::new());
        for (row, command) in commands.iter().enumerate() {
            predictor.require_tool(row, command).map_err(Failure::usage)?;
            let predicted = predictor.predict(command);
            positions.extend(predicted.position_mm.iter());
            errors.extend(predicted.error_mm.iter().map(|mm| mm * 1e3));
            errors.push(predicted.error_mm.norm() * 1e3);
        }
        let inside: Vec<bool> = commands.iter().map(|command| predictor.contains(command)).collect();
        let mut warnings: Vec<Report> = predictor.doubts().into_iter().collect();
        if let Some(outside) = PointsOutside::of(inside.iter().copied()) {
            let diagnostic = outside.diagnostic(&options);
            if diagnostic.severity == Severity::Error {
                return Err(Failure::usage(diagnostic));
            }
            warnings.push(Report { source: None, diagnostics: vec![diagnostic] });
        }
        let turned = if predictor.turns() { directions(predictor.base(), commands) } else { Vec::new() };
        Ok((positions, errors, inside, turned, warnings))
    };
    let (positions, errors, inside, turned, warnings) =
        py.detach(work).map_err(|failure| raised(py, &failure))?;
    Ok((bytes(py, positions), bytes(py, errors), inside, bytes(py, turned), told(&warnings)))
}

type Solved<'py> = (Bound<'py, PyBytes>, Vec<u32>, Bound<'py, PyBytes>, Bound<'py, PyBytes>);

/// Commands, mm; iterations; residuals, µm; directions.
#[pyfunction]
pub(crate) fn solve<'py>(py: Python<'py>, arrays: Arrays, options: Vec<OsString>) -> PyResult<Solved<'py>> {
    let work = || -> Result<_, Failure> {
        let options = JobOptions::read(options)?;
        let profile = mill(&options)?;
        let solver = Solver::new(&profile, &options)?;
        let mut targets = points(&profile, &arrays)?;
        let (mut commanded, mut iterations, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
        for (row, target) in targets.iter_mut().enumerate() {
            let solution = solver.solve(row, target).map_err(Failure::usage)?;
            commanded.extend(solution.linear_mm.iter());
            iterations.push(solution.iterations);
            residuals.push(solution.residual_mm * 1e3);
            target.linear_mm = solution.linear_mm;
        }
        let turned =
            if solver.turns { directions(profile.rigid_body_without_effects(), targets) } else { Vec::new() };
        Ok((commanded, iterations, residuals, turned))
    };
    let (commanded, iterations, residuals, turned) =
        py.detach(work).map_err(|failure| raised(py, &failure))?;
    Ok((bytes(py, commanded), iterations, bytes(py, residuals), bytes(py, turned)))
}

/// The JSON of `diagnose --json`.
#[pyfunction]
pub(crate) fn diagnose(
    py: Python<'_>,
    rows: Text,
    holdout: Option<Text>,
    asked: (Vec<String>, bool, u64, Vec<String>),
    options: Vec<OsString>,
) -> PyResult<String> {
    let (ignore, as_written, seed, without) = asked;
    let work = || -> Result<String, Failure> {
        let model = Model::load(&JobOptions::read(options)?)?;
        let books = if as_written { Books::AsWritten } else { Books::Checked };
        let read = |(name, text): &Text| jobs::diagnose::read(name, text, &model, &ignore, books);
        let measured = read(&rows)?;
        let held = holdout.as_ref().map(read).transpose()?;
        if let (Some((name, _)), Some(held)) = (&holdout, &held) {
            jobs::diagnose::of_one_machine(name, &measured, held)?;
        }
        Ok(jobs::diagnose::diagnose(&model, &measured, held.as_ref(), seed, &without)?.json)
    };
    py.detach(work).map_err(|failure| raised(py, &failure))
}

/// A file that options name, of those that came with them.
fn read_of<'a>(files: &'a [Text]) -> impl Fn(&Path) -> Result<Vec<u8>, Failure> + 'a {
    |path| match files.iter().find(|(name, _)| Path::new(&**name) == path) {
        Some((_, bytes)) => Ok(bytes.to_vec()),
        None => Err(Failure::unread(&jobs::lines::name(path), &ErrorKind::NotFound.into())),
    }
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8_lossy(&bytes).into_owned()
}

type Mapped<'py> = ([Vec<f64>; 3], Bound<'py, PyBytes>, String, Vec<Told>);

/// Nodes of X, Y and Z, mm; errors, mm, X fastest; the JSON of `map --json`; warnings.
#[pyfunction]
pub(crate) fn map<'py>(py: Python<'py>, options: Vec<OsString>) -> PyResult<Mapped<'py>> {
    let work = || -> Result<_, Failure> {
        let Whole { job, own } = options::read::<Whole<MapOptions>>(options)?;
        let profile = mill(&job)?;
        let engine = conditions::engine(&profile, profile.forward_engine(job.engine()), &job)?;
        let mut warnings = Vec::new();
        let study = jobs::map::of(&job, &profile, engine.as_ref(), &own, &mut warnings)?;
        Ok((study, warnings))
    };
    let (study, warnings) = py.detach(work).map_err(|failure| raised(py, &failure))?;
    let places = study.map.grid().axes().each_ref().map(|nodes| nodes.places_mm().to_vec());
    let errors = study.map.errors_mm().iter().flat_map(|error| [error.x, error.y, error.z]);
    Ok((places, bytes(py, errors), text(jobs::map::json::bytes(&study)), told(&warnings)))
}

/// The JSON of `budget --json`, and warnings.
#[pyfunction]
pub(crate) fn budget(
    py: Python<'_>,
    files: Vec<Text>,
    options: Vec<OsString>,
) -> PyResult<(String, Vec<Told>)> {
    let work = || -> Result<_, Failure> {
        let Whole { job, own } = options::read::<Whole<BudgetOptions>>(options)?;
        let mut warnings = Vec::new();
        let study = jobs::budget::of(&job, &mill(&job)?, &own, &read_of(&files), &mut warnings)?;
        Ok((text(jobs::budget::json::bytes(&study)), warnings))
    };
    let (json, warnings) = py.detach(work).map_err(|failure| raised(py, &failure))?;
    Ok((json, told(&warnings)))
}

/// What a calibration says and makes: its report; the profile, its tables' folder and their texts; the JSON of
/// `--json`; warnings.
type Calibrated = (String, Option<(String, String, Vec<(String, Vec<u8>)>)>, Option<String>, Vec<Told>);

/// `vpost calibrate INSTRUMENT …`
#[pyfunction]
pub(crate) fn calibrate(py: Python<'_>, files: Vec<Text>, options: Vec<OsString>) -> PyResult<Calibrated> {
    let work = || -> Result<Calibration, Failure> {
        let Whole { job, own } = options::read::<Whole<Calibrate>>(options)?;
        let read = read_of(&files);
        let setting = Setting { options: &job, read: &read, language: Language::English, command: None };
        let made = jobs::calibrate::of(&own.command, &setting);
        match made.refused {
            Some(refused) => Err(refused),
            None => Ok(made),
        }
    };
    let made = py.detach(work).map_err(|failure| raised(py, &failure))?;
    let profile = made.profile.map(|made| {
        let folder = made.folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (made.text, folder, made.tables)
    });
    let json = made.results.into_iter().next().map(|(_, bytes)| text(bytes));
    let (mut report, mut warnings) = (String::new(), Vec::new());
    for said in made.said {
        match said {
            Said::Result(text) => report.push_str(text.english()),
            Said::Warning(warning) => warnings.push(warning),
        }
    }
    Ok((report, profile, json, told(&warnings)))
}
