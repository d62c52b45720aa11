//! What the profile and the command line say together.

use std::path::Path;

use correction::{Options, Outside};
use machine_model::{Engine, EngineId};
use machine_profile::Profile;
use nc_program::Setup;
use nc_syntax::Dialect;

use crate::arguments::{self, Shared};
use crate::correct::Job;
use crate::expand::Flow;
use crate::message::{Failure, Messages, Report, Source};
use crate::{conditions, file, profile};

/// Everything a job on a program needs.
pub(crate) struct Settings {
    pub profile: Profile,
    pub profile_name: String,
    pub profile_hash: blake3::Hash,
    pub dialect: Dialect,
    pub setup: Setup,
    pub engine: Box<dyn Engine>,
    pub options: Options,
    pub flow: Flow,
}

impl Settings {
    /// Reads profile and dialect, builds the engine, applies the options.
    pub(crate) fn load(shared: &Shared, messages: &Messages) -> Result<Self, Failure> {
        let path = machine(shared)?;
        let loaded = profile::load(path)?;
        let profile = loaded.profile;
        let engine_id = match &shared.engine {
            Some(name) => engine_named(name)?,
            None => profile.correction.engine,
        };
        let engine = conditions::engine(&profile, engine_id, shared)?;
        let dialect = dialect(shared, &profile)?;
        let setup = setup(shared, &profile)?;
        let tolerance_um = shared.tolerance.unwrap_or(profile.correction.tolerance_um);
        if !(tolerance_um > 0.0 && tolerance_um.is_finite()) {
            return Err(Failure::option(
                format!("a tolerance of {tolerance_um} um cannot be kept"),
                "give micrometres above zero: `--tolerance 1`",
            ));
        }
        conditions::warn_of_temperature(&profile, shared, tolerance_um, messages)?;
        let outside = match (shared.outside, profile.correction.outside) {
            (Some(arguments::Outside::Refuse), _) | (None, machine_profile::Outside::Refuse) => {
                Outside::Refuse
            }
            (Some(arguments::Outside::Clamp), _) | (None, machine_profile::Outside::Clamp) => Outside::Clamp,
        };
        let options = Options {
            tolerance_mm: tolerance_um * 1e-3,
            outside,
            minimum_segment_mm: profile.correction.minimum_segment_mm,
        };
        let profile_name = file::name(path);
        let flow = Flow::load(shared)?;
        Ok(Self { profile, profile_name, profile_hash: loaded.hash, dialect, setup, engine, options, flow })
    }

    /// The engine as a model of paths; the published variants are none.
    pub(crate) fn path_model(&self) -> Result<&dyn machine_model::PathModel, Failure> {
        self.engine.path_model().ok_or_else(|| {
            let name = self.engine.id().name();
            Failure::option(
                format!("engine `{name}` reproduces a publication and corrects no programs"),
                format!(
                    "use `--engine {}`, or `vpost solve` for single points",
                    name.trim_end_matches("-published")
                ),
            )
        })
    }

    /// Decimals that write the profile's resolution exactly, or finer.
    pub(crate) fn decimals_mm(&self) -> [u8; 3] {
        self.profile.resolution_mm.map(|step| {
            let mut decimals = 0;
            let mut scaled = step;
            while decimals < 6 && (scaled - scaled.round()).abs() > 1e-9 * scaled.abs().max(1.0)
                || scaled < 0.5
            {
                scaled *= 10.0;
                decimals += 1;
                if decimals >= 6 {
                    break;
                }
            }
            decimals
        })
    }

    /// What the comment in the output says after its marker.
    pub(crate) fn provenance(&self) -> String {
        format!("{} FOR {} ENGINE {}", env!("CARGO_PKG_VERSION"), self.profile.name, self.engine.id().name())
    }

    /// The job of correcting a program.
    pub(crate) fn job<'a>(&'a self, force: bool, provenance: &'a str) -> Result<Job<'a>, Failure> {
        Ok(Job {
            dialect: &self.dialect,
            setup: &self.setup,
            model: self.path_model()?,
            options: self.options,
            decimals_mm: self.decimals_mm(),
            force,
            provenance,
        })
    }
}

/// The profile's path, which every job needs.
pub(crate) fn machine(shared: &Shared) -> Result<&Path, Failure> {
    shared.machine.as_deref().ok_or_else(|| {
        Failure::option(
            "which machine? no profile was given",
            "add `-m PROFILE.toml`, for example `-m machine-profiles/stan_s500.toml`",
        )
    })
}

/// The tool vector of points that give none.
pub(crate) fn setup_tool(profile: &Profile) -> [f64; 3] {
    profile.default_tool_mm
}

/// The engine of a name.
pub(crate) fn engine_named(name: &str) -> Result<EngineId, Failure> {
    EngineId::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = EngineId::ALL.iter().map(|id| id.name()).collect();
        Failure::option(format!("there is no engine `{name}`"), format!("one of: {}", names.join(", ")))
    })
}

fn dialect(shared: &Shared, profile: &Profile) -> Result<Dialect, Failure> {
    let Some(name) = shared.dialect.as_deref().or(profile.control.as_deref()) else {
        return Err(Failure::option(
            "which dialect? neither the profile's `control` nor `--dialect` says",
            format!("add `--dialect D`, one of: {}", nc_dialect::builtin_names().join(", ")),
        ));
    };
    load_dialect(name)
}

/// A shipped dialect by name, or a grammar file by path.
pub(crate) fn load_dialect(name: &str) -> Result<Dialect, Failure> {
    if let Some(dialect) = nc_dialect::builtin(name) {
        return Ok(dialect.clone());
    }
    if !name.ends_with(".toml") {
        return Err(Failure::option(
            format!("there is no dialect `{name}`"),
            format!(
                "one of: {}; or the path of a grammar file ending in .toml",
                nc_dialect::builtin_names().join(", ")
            ),
        ));
    }
    let bytes = std::fs::read(name)
        .map_err(|error| Failure::usage(crate::message::file_diagnostic(name, "read", &error)))?;
    let stem = Path::new(name)
        .file_stem()
        .map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    parse_dialect(&stem, name, &bytes)
}

fn parse_dialect(stem: &str, file_name: &str, bytes: &[u8]) -> Result<Dialect, Failure> {
    let text = String::from_utf8_lossy(bytes);
    nc_dialect::load(stem, &text).map_err(|diagnostics| {
        let source = Some(Source::whole(file_name, text.as_bytes()));
        Failure::Usage(vec![Report { source, diagnostics }])
    })
}

fn setup(shared: &Shared, profile: &Profile) -> Result<Setup, Failure> {
    let mut setup = Setup {
        work_offsets: profile.work_offsets.clone(),
        tools: tools(shared, profile)?,
        default_tool_mm: profile.default_tool_mm,
        has_rotary: profile.has_rotary(),
        rotary_matters: profile.rotary_matters(),
        start_mm: None,
    };
    for option in &shared.work_offset {
        let (name, value) = assignment("--work-offset", option, "G54=100,50,0")?;
        let name = name.to_ascii_uppercase();
        let value = triple("--work-offset", option, value, "G54=100,50,0")?;
        match setup.work_offsets.iter_mut().find(|(known, _)| *known == name) {
            Some(entry) => entry.1 = value,
            None => setup.work_offsets.push((name, value)),
        }
    }
    if let Some(start) = &shared.start_at {
        setup.start_mm = Some(triple("--start-at", start, start, "400,280,200")?);
    }
    Ok(setup)
}

/// Length vectors of the H numbers: the profile's and the command line's.
pub(crate) fn tools(shared: &Shared, profile: &Profile) -> Result<Vec<(u32, [f64; 3])>, Failure> {
    let mut tools = profile.tools.clone();
    for option in &shared.tool {
        let example = "H1=120 or H1=0,0,120";
        let (name, value) = assignment("--tool", option, example)?;
        let number: u32 = name
            .strip_prefix(['H', 'h'])
            .and_then(|digits| digits.parse().ok())
            .ok_or_else(|| wrong("--tool", option, example))?;
        let vector = if value.contains(',') {
            triple("--tool", option, value, example)?
        } else {
            [0.0, 0.0, millimetres(value).ok_or_else(|| wrong("--tool", option, example))?]
        };
        match tools.iter_mut().find(|(known, _)| *known == number) {
            Some(entry) => entry.1 = vector,
            None => tools.push((number, vector)),
        }
    }
    Ok(tools)
}

fn wrong(option: &str, given: &str, example: &str) -> Failure {
    Failure::option(
        format!("`{option} {given}` cannot be read"),
        format!("write millimetres as in `{option} {example}`"),
    )
}

fn assignment<'v>(option: &str, given: &'v str, example: &str) -> Result<(&'v str, &'v str), Failure> {
    given
        .split_once('=')
        .map(|(name, value)| (name.trim(), value.trim()))
        .ok_or_else(|| wrong(option, given, example))
}

fn millimetres(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|v| v.is_finite())
}

fn triple(option: &str, given: &str, value: &str, example: &str) -> Result<[f64; 3], Failure> {
    let numbers: Option<Vec<f64>> = value.split(',').map(millimetres).collect();
    match numbers.as_deref() {
        Some([x, y, z]) => Ok([*x, *y, *z]),
        _ => Err(wrong(option, given, example)),
    }
}
