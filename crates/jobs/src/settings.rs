//! What the profile and the command line say together.

mod dialect;

pub use dialect::{check_control, load_dialect};

use std::path::{Path, PathBuf};

use correction::{Options, Orientation, Outside};
use diagnostic::{both, notice};
use machine_model::{Command, Engine, EngineId, Models, PathModel, TipControl};
use machine_profile::Profile;
use nc_dialect::Dialect;
use nc_program::{Questions, Setup};
use nc_syntax::Macros;
use rewrite::{Datums, Guards, Job, PathMode};

use crate::flow::Flow;
use crate::message::{Failure, OPTION, Report};
use crate::options::{self, JobOptions};
use crate::settings::dialect::{
    declare_calls, declare_cycles, declare_harmless, declare_switches, dialect, settle_lengths,
    turning_dialect,
};
pub use crate::setup::tools;
use crate::setup::{setup, start_anywhere};
use crate::stored::Stored;
use crate::{conditions, datums, lines, profile};

/// Where the tolerance cannot be held, so many of it are written where nobody says another limit: a plunge of 15 mm on a
/// machine that leans by 1 um a millimetre, under compensation, which lets no word undo it.
const ACCEPTED: f64 = 15.0;

/// Everything a job on a program needs.
pub struct Settings {
    /// The machine.
    pub profile: Profile,
    /// The name of its file in messages.
    pub profile_name: String,
    /// Of the profile and its tables.
    pub profile_hash: blake3::Hash,
    /// Profile, tables, and the dialect's where it is a file.
    pub files: Vec<PathBuf>,
    /// Of the control, with what the profile says of it.
    pub dialect: Dialect,
    /// What the machine knows before a program begins.
    pub setup: Setup,
    /// What corrects.
    pub engine: Box<dyn Engine>,
    /// The machine under tool centre point control.
    tip: Option<TipControl>,
    /// What correction keeps to.
    pub options: Options,
    /// How the work offsets came to be.
    pub datums: Datums,
    /// What programs with flow are given.
    pub flow: Flow,
    /// Doubtful programs are refused.
    pub strict: bool,
    /// `--guard`
    guards: Guards,
    /// `--path-control`
    pub path_mode: PathMode,
    /// What is to be said before any program is read.
    pub warnings: Vec<Report>,
}

impl Settings {
    /// Reads profile and dialect, builds the engine, applies the options.
    ///
    /// # Errors
    /// What is wrong with profile, dialect or options.
    pub fn load(options: &JobOptions) -> Result<Self, Failure> {
        let path = machine(options)?;
        let loaded = profile::load(path)?;
        let profile = loaded.profile;
        let engine_id = options.engine().unwrap_or(profile.correction.engine);
        let engine = conditions::engine(&profile, engine_id, options)?;
        let mut dialect = turning_dialect(dialect(options, &profile)?, &profile)?;
        let mut files = loaded.files;
        let tables = options.dialect.iter().chain(&profile.control).filter(|name| name.ends_with(".toml"));
        files.extend(tables.map(PathBuf::from));
        let stored = Stored::load(options, &profile, &dialect)?;
        let mut setup = setup(options, &profile, &stored)?;
        files.extend(stored.files);
        setup.lever_matters = match engine_id {
            EngineId::RigidBody => setup.lever_matters,
            // It knows the tip of one tool.
            EngineId::Field => true,
            // The others know no lever.
            _ => false,
        };
        if engine_id == EngineId::RigidBody && dialect.turning.is_none() {
            start_anywhere(&profile, engine.as_ref(), &mut setup);
        }
        setup.lengths_settled = settle_lengths(options, &profile, &mut dialect)?;
        declare_harmless(&profile, &mut dialect)?;
        declare_calls(&profile, &mut dialect)?;
        declare_switches(&profile, &mut dialect);
        declare_cycles(&profile, &mut dialect);
        let tip = profile.tip_control().filter(|_| engine_id == EngineId::RigidBody);
        setup.tip_control = match (&profile.kinematics, &tip) {
            (None, _) => nc_program::TipControl::Undeclared,
            (Some(_), None) => nc_program::TipControl::Unproven,
            (Some(_), Some(_)) => nc_program::TipControl::Declared,
        };
        if let Some(mm) = profile.program.arc_tolerance_mm {
            dialect.output.arc_radius_tolerance_mm = mm;
            dialect.output.arc_radius_tolerance_inch = None;
        }
        let tolerance_um = tolerance_um(options, &profile)?;
        let datums = datums::of(options, &profile, &setup, engine.as_ref())?;
        let engine = datums::counted_from(&datums, engine);
        let orientation = orientation(&profile, options, engine.as_ref())?;
        if orientation != Orientation::Tip {
            // Linear axes turn the tool too.
            setup.rotary_matters |= profile.has_errors();
        }
        let warning = conditions::temperature(&profile, options, tolerance_um)?;
        let doubts = conditions::doubts(&profile, engine_id);
        let limits = Options {
            tolerance_mm: tolerance_um * 1e-3,
            accept_mm: 1e-3
                * options.accept.or(profile.correction.accept_um).unwrap_or(ACCEPTED * tolerance_um),
            outside: outside(options, &profile),
            minimum_segment_mm: profile.correction.minimum_segment_mm,
            orientation_rad: profile.correction.orientation_urad * 1e-6,
            orientation,
        };
        let guards = guards(options, &dialect)?;
        let path_mode = path_mode(options, &dialect, limits.tolerance_mm)?;
        let profile_name = lines::name(path);
        let flow = Flow::load(options)?;
        Ok(Self {
            profile,
            profile_name,
            profile_hash: loaded.hash,
            files,
            dialect,
            setup,
            engine,
            tip,
            options: Options { tolerance_mm: limits.tolerance_mm - path_mode.share_mm(), ..limits },
            datums,
            flow,
            strict: options.strict,
            guards,
            path_mode,
            warnings: warning.into_iter().chain(doubts).collect(),
        })
    }

    /// What is asked of a whole program.
    #[must_use]
    pub fn questions(&self) -> Questions<'_> {
        Questions::new(&self.dialect, &self.setup)
    }

    /// The engine as a model of paths; the published variants are none.
    ///
    /// # Errors
    /// What to use instead of those.
    pub fn path_model(&self) -> Result<&dyn machine_model::PathModel, Failure> {
        self.engine.path_model().ok_or_else(|| {
            let name = self.engine.id().name();
            Failure::usage(notice!(OPTION;
                "engine `{name}` reproduces a publication and corrects no programs",
                "метод `{name}` воспроизводит публикацию и программ не исправляет";
                "use `--engine {}`, or `vpost solve` for single points",
                "возьмите `--engine {}` или, для отдельных точек, `vpost solve`",
                name.trim_end_matches("-published")
            ))
        })
    }

    /// What machine and control keep to together, mm; the control's share is 0 where it is not asked for.
    #[must_use]
    pub fn tolerance_mm(&self) -> f64 {
        self.options.tolerance_mm + self.path_mode.share_mm()
    }

    /// Decimals that write the profile's resolution exactly, or finer.
    #[must_use]
    pub fn decimals_mm(&self) -> [u8; 3] {
        const MOST: u8 = 6;
        self.profile.resolution_mm.map(|step| decimal_steps(step).0.min(MOST))
    }

    /// What the comment in the output says after its marker.
    #[must_use]
    pub fn provenance(&self) -> String {
        format!("{} FOR {} ENGINE {}", env!("CARGO_PKG_VERSION"), self.profile.name, self.engine.id().name())
    }

    /// The job of correcting a program.
    ///
    /// # Errors
    /// The engine corrects no programs.
    pub fn job<'a>(&'a self, provenance: &'a str) -> Result<Job<'a>, Failure> {
        Ok(Job {
            dialect: &self.dialect,
            setup: &self.setup,
            models: Models {
                axes: self.path_model()?,
                tip: self.tip.as_ref().map(|tip| -> &dyn PathModel { tip }),
            },
            datums: &self.datums,
            options: self.options,
            decimals_mm: self.decimals_mm(),
            rotary_steps: self.profile.resolution_deg.map(decimal_steps),
            force: false,
            provenance,
            guards: self.guards,
            interpolator: self.profile.interpolator,
            path_mode: self.path_mode,
        })
    }
}

/// What correction keeps to, µm.
fn tolerance_um(options: &JobOptions, profile: &Profile) -> Result<f64, Failure> {
    let tolerance_um = options.tolerance.unwrap_or(profile.correction.tolerance_um);
    if !(tolerance_um > 0.0 && tolerance_um.is_finite()) {
        return Err(Failure::usage(notice!(OPTION;
            "a tolerance of {tolerance_um} um cannot be kept",
            "допуск {tolerance_um} мкм выдержать нельзя";
            "give micrometres above zero: `--tolerance 1`",
            "дайте микрометры больше нуля: `--tolerance 1`"
        )));
    }
    Ok(tolerance_um)
}

/// What becomes of motions outside the calibrated volume.
fn outside(options: &JobOptions, profile: &Profile) -> Outside {
    match (options.outside, profile.correction.outside) {
        (Some(options::Outside::Refuse), _) | (None, machine_profile::Outside::Refuse) => Outside::Refuse,
        (Some(options::Outside::Clamp), _) | (None, machine_profile::Outside::Clamp) => Outside::Clamp,
    }
}

/// `--guard`: the output asks the control for what it was corrected for, where it can be asked.
fn guards(options: &JobOptions, dialect: &Dialect) -> Result<Guards, Failure> {
    if !options.guard {
        return Ok(Guards::None);
    }
    // Whether a lathe keeps X as a diameter its parameters say.
    if dialect.flow.macros == Macros::None || dialect.turning.is_some() {
        return Err(Failure::usage(notice!(OPTION;
            "no way is known to ask dialect {} for its work offsets",
            "как спросить у диалекта {} его смещения нуля, неизвестно", dialect.name;
            "correct without `--guard`, and compare the offsets by hand",
            "исправляйте без `--guard` и сравните смещения вручную"
        )));
    }
    Ok(Guards::Put)
}

/// `--path-control`: what the output tells the control, where it has words for that.
fn path_mode(options: &JobOptions, dialect: &Dialect, tolerance_mm: f64) -> Result<PathMode, Failure> {
    let mode = match options.path_control {
        None | Some(options::PathControl::Keep) => return Ok(PathMode::AsPosted),
        Some(options::PathControl::Tolerance) => PathMode::Within(0.5 * tolerance_mm),
        Some(options::PathControl::Exact) => PathMode::Exact,
    };
    if mode.block(dialect, 25.4).is_some() {
        return Ok(mode);
    }
    let name = &dialect.name;
    Err(Failure::usage(match mode {
        PathMode::Within(_) if PathMode::Exact.block(dialect, 1.0).is_some() => notice!(OPTION;
            "dialect {name} has no words for a tolerance of corners of {} um",
            "у диалекта {name} нет слов для допуска на углах в {} мкм", 500.0 * tolerance_mm;
            "use `--path-control exact`", "возьмите `--path-control exact`"
        ),
        _ => notice!(OPTION;
            "dialect {name} has no words by which it keeps to the path",
            "у диалекта {name} нет слов, которые держат его на траектории";
            "correct without `--path-control`, and say in the profile what the control does at corners: `blending`",
            "исправляйте без `--path-control` и скажите в профиле, что стойка делает на углах: `blending`"
        ),
    }))
}

/// A step as decimals and how many of their steps; what no seven decimals say is rounded to the next finer one that they do.
fn decimal_steps(step: f64) -> (u8, u32) {
    const MOST: u8 = 7;
    let scaled = |decimals: u8| step * f64::from(10u32.pow(u32::from(decimals)));
    let whole = |decimals: &u8| {
        let steps = scaled(*decimals);
        steps > 0.5 && (steps - steps.round()).abs() <= 1e-9 * steps
    };
    match (0..=MOST).find(whole) {
        Some(decimals) => (decimals, scaled(decimals).round() as u32),
        None => (MOST, (scaled(MOST).floor() as u32).max(1)),
    }
}

/// Whether directions are corrected.
///
/// # Errors
/// The machine has not two rotary axes, or nothing is proven of its directions: another engine, effects, lost motion.
fn orientation(profile: &Profile, options: &JobOptions, engine: &dyn Engine) -> Result<Orientation, Failure> {
    let full = match options.orientation {
        Some(options::Orientation::Full) => true,
        Some(options::Orientation::Xyz) => false,
        None => profile.correction.directions,
    };
    if !full {
        return Ok(Orientation::Tip);
    }
    let help = || {
        both!("correct the tip alone: `--orientation xyz`", "исправляйте только вершину: `--orientation xyz`")
    };
    if profile.has_rotary().iter().filter(|has| **has).count() != 2 {
        return Err(Failure::usage(notice!(OPTION;
            "directions cannot be corrected on a machine with other than two rotary axes: {}",
            "направления нельзя исправлять на станке, у которого не две поворотные оси: {}", profile.chain();
            help()
        )));
    }
    let proven = engine.path_model().is_some_and(|model| {
        let at = Command::default();
        model.tool_directions(&at, &at.rotary_rad).is_some()
            && model.follows_turns()
            && !model.depends_on_direction()
            && !model.has_rotary_play()
    });
    if !proven {
        return Err(Failure::usage(notice!(OPTION;
            "directions are corrected by engine `rigid-body` alone, without [[effect]] entries and lost motion of axes",
            "направления исправляет только метод `rigid-body`, без разделов [[effect]] и без люфта осей";
            help()
        )));
    }
    Ok(Orientation::Full(profile.correction.singularity))
}

/// The profile's path, which every job needs.
///
/// # Errors
/// None was given.
pub fn machine(options: &JobOptions) -> Result<&Path, Failure> {
    options.machine.as_deref().ok_or_else(|| {
        Failure::usage(notice!(OPTION;
            "which machine? no profile was given", "какой станок? профиль не задан";
            "add `-m PROFILE.toml`, for example `-m machine-profiles/stan_s500.toml`",
            "добавьте `-m PROFILE.toml`, например `-m machine-profiles/stan_s500.toml`"
        ))
    })
}

/// The tool vector of points that give none.
#[must_use]
pub fn setup_tool(profile: &Profile) -> [f64; 3] {
    profile.default_tool_mm
}
