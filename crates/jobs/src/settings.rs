//! What the profile and the command line say together.

use std::path::{Path, PathBuf};

use correction::{Options, Orientation, Outside};
use diagnostic::{Code, Diagnostic, Text, both};
use machine_model::{Command, Engine, EngineId, Models, PathModel, TipControl};
use machine_profile::{BareLengths, Profile, TurningRules};
use nc_dialect::{
    Action, CodeEntry, ControlCall, Dialect, DrillPecks, DrillR, FlankFrom, MCode, PointFree, TipSwitch,
    TurningParameters,
};
use nc_program::{Questions, Setup};
use nc_syntax::{GCode, Macros};
use rewrite::{Datums, Guards, Job};

use crate::flow::Flow;
use crate::message::{Failure, OPTION, Report, Source, notice};
use crate::options::{self, JobOptions};
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
            options: limits,
            datums,
            flow,
            strict: options.strict,
            guards,
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
            blending_mm: self.profile.blending_mm,
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

/// A lathe's dialect for a lathe and a mill's for a mill; of its G-code systems that of the profile.
fn turning_dialect(dialect: Dialect, profile: &Profile) -> Result<Dialect, Failure> {
    let name = &dialect.name;
    let Some(turning) = &dialect.turning else {
        return match &profile.lathe {
            None => Ok(dialect),
            Some(lathe) => Err(Failure::usage(notice!(OPTION;
                "dialect {name} is of mills, and {} is a lathe",
                "диалект {name} — фрезерный, а {} — токарный станок", lathe.chain;
                "use a dialect of lathes: {}", "возьмите токарный диалект: {}", lathe_dialects()
            ))),
        };
    };
    let Some(lathe) = &profile.lathe else {
        return Err(Failure::usage(notice!(OPTION;
            "dialect {name} is of lathes, and {} has no spindle",
            "диалект {name} — токарный, а в {} нет шпинделя", profile.chain();
            "write the chain of the lathe into the profile, like \"[w S b Z X t]\", or use a mill's dialect",
            "впишите в профиль цепь токарного станка, например \"[w S b Z X t]\", или возьмите фрезерный диалект"
        )));
    };
    if turning.systems.is_empty() {
        return Ok(dialect);
    }
    let systems: Vec<&str> = turning.systems.iter().map(|system| system.name.as_str()).collect();
    let Some(system) = &profile.program.g_code_system else {
        return Err(Failure::usage(notice!(OPTION;
            "which G-code system? the profile of {} does not say",
            "какая система G-кодов? в профиле {} не сказано", lathe.chain;
            "write `g_code_system = \"A\"` under `[program]`, one of: {}",
            "впишите `g_code_system = \"A\"` в раздел `[program]`, одно из: {}", systems.join(", ")
        )));
    };
    dialect.in_system(system).ok_or_else(|| {
        Failure::usage(notice!(OPTION;
            "dialect {name} has no G-code system {system}", "в диалекте {name} нет системы G-кодов {system}";
            "one of: {}", "одно из: {}", systems.join(", ")
        ))
    })
}

/// Puts into a lathe's dialect what the profile says of its words and cycles.
fn declare_cycles(profile: &Profile, dialect: &mut Dialect) {
    let Some(turning) = &mut dialect.turning else { return };
    let TurningRules {
        thread_chamfer_leads,
        thread_chamfer_deg,
        roughing_escape_mm,
        groove_return_mm,
        thread_finishing_passes,
        thread_least_mm,
        thread_allowance_mm,
        thread_flank_from,
        drill_chips,
        drill_return_mm,
        drill_r_is_place,
        bore_return_percent,
        nose_in_finishing,
        plain_drawing,
    } = profile.program.turning;
    turning.diameters = profile.program.diameters;
    turning.cycles = TurningParameters {
        thread_chamfer_leads,
        thread_chamfer_deg,
        roughing_escape_mm,
        groove_return_mm,
        thread_finishing_passes,
        thread_least_mm,
        thread_allowance_mm,
        thread_flank_from: thread_flank_from.map(|from| match from {
            machine_profile::FlankFrom::Start => FlankFrom::Start,
            machine_profile::FlankFrom::FirstPass => FlankFrom::FirstPass,
            machine_profile::FlankFrom::LastPass => FlankFrom::LastPass,
        }),
        drill_pecks: drill_chips.map(|chips| if chips { DrillPecks::Chip } else { DrillPecks::Full }),
        drill_return_mm,
        drill_r: drill_r_is_place.map(|is_place| if is_place { DrillR::Place } else { DrillR::Way }),
        bore_return_percent,
        nose_in_finishing,
        plain_drawing,
    };
}

/// Their names.
fn lathe_dialects() -> String {
    let of_lathes = |name: &&str| nc_dialect::builtin(name).is_some_and(|dialect| dialect.turning.is_some());
    nc_dialect::builtin_names().into_iter().filter(of_lathes).collect::<Vec<_>>().join(", ")
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

/// Puts into the dialect what command line or profile say of lengths without a point; true where one of them does.
fn settle_lengths(options: &JobOptions, profile: &Profile, dialect: &mut Dialect) -> Result<bool, Failure> {
    let said = options.decimal.map(|decimal| match decimal {
        options::Decimal::Increments => BareLengths::Increments,
        options::Decimal::Millimetres => BareLengths::Millimetres,
    });
    let point_free = &mut dialect.numbers.point_free;
    match said.or(profile.program.bare_lengths) {
        None => return Ok(false),
        Some(BareLengths::Millimetres) => *point_free = PointFree::Unit,
        Some(BareLengths::Increments) if *point_free == PointFree::Unit => {
            return Err(Failure::usage(notice!(OPTION;
                "dialect {} reads a length without a point as Z10 = Z10., not as increments",
                "диалект {} читает размер без точки как Z10 = Z10., а не в дискретах", dialect.name;
                "give the dialect of the control, or change `numbers.without_point` in a copy of the grammar where its manual says so",
                "дайте диалект этой стойки или, если так сказано в её руководстве, измените `numbers.without_point` в копии таблицы"
            )));
        }
        Some(BareLengths::Increments) => {}
    }
    Ok(true)
}

/// Puts what the profile leaves to the control into the dialect.
fn declare_calls(profile: &Profile, dialect: &mut Dialect) -> Result<(), Failure> {
    for call in &profile.program.calls {
        let (letter, tenths) = (call.letter as u8, call.tenths);
        let taken = if letter == b'G' {
            let is_free = |row: &CodeEntry| matches!(row.action, Action::Call | Action::Refuse { .. });
            let taken = dialect.code(GCode(tenths)).is_some_and(|row| !is_free(row));
            let others = dialect.codes.iter().filter(|row| row.code != GCode(tenths)).cloned();
            let own = CodeEntry { code: GCode(tenths), group: 0, action: Action::Call };
            dialect.codes = others.chain([own]).collect::<Vec<_>>().into();
            taken
        } else {
            let row = MCode { calls: true, ..MCode::harmless(tenths / 10) };
            match dialect.m_codes.binary_search_by_key(&row.number, |row| row.number) {
                Err(at) => {
                    dialect.m_codes.insert(at, row);
                    false
                }
                Ok(at) => {
                    let is = std::mem::replace(&mut dialect.m_codes[at], row);
                    is.ends_program || is.changes_tool || is.after_motion
                }
            }
        };
        if taken {
            return Err(Failure::usage(notice!(OPTION;
                "the profile leaves {}{} to the control, which the table of dialect {} knows as something else",
                "профиль оставляет {}{} стойке, а в таблице диалекта {} это другое", call.letter, tenths / 10,
                dialect.name;
                "remove it from `[calls]` in the profile", "уберите её из раздела `[calls]` профиля"
            )));
        }
        let unknown = call.unknown;
        dialect.calls.push(ControlCall { letter, tenths, program: call.program, unknown });
    }
    Ok(())
}

/// Puts the M codes that the profile calls harmless into the dialect, beside those that its table has.
fn declare_harmless(profile: &Profile, dialect: &mut Dialect) -> Result<(), Failure> {
    for &number in &profile.program.harmless_m_codes {
        let harmless = MCode::harmless(number);
        match dialect.m_codes.binary_search_by_key(&number, |row| row.number) {
            Err(at) => dialect.m_codes.insert(at, harmless),
            Ok(at) if dialect.m_codes[at].switches.is_some() => dialect.m_codes[at] = harmless,
            Ok(at) => {
                let row = &dialect.m_codes[at];
                let acts =
                    row.ends_program || row.calls || row.refuse.is_some() || row.loses_position != [false; 3];
                if acts {
                    return Err(Failure::usage(notice!(OPTION;
                        "the profile calls M{number} harmless, which the table of dialect {} knows as something else",
                        "профиль называет M{number} безобидной, а в таблице диалекта {} она значит другое",
                        dialect.name;
                        "remove \"M{number}\" from `harmless` under `[m_codes]`; where a tool change leaves the axes is said with `tool_change` under `[program]`",
                        "уберите \"M{number}\" из `harmless` раздела `[m_codes]`; где оставляет оси смена инструмента, говорит `tool_change` в разделе `[program]`"
                    )));
                }
            }
        }
    }
    Ok(())
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

/// Puts the M codes by which the machine switches tool centre point control into the dialect.
fn declare_switches(profile: &Profile, dialect: &mut Dialect) {
    let Some(kinematics) = &profile.kinematics else { return };
    let codes = |numbers: &[u16], switch: TipSwitch| {
        numbers.iter().map(|number| (*number, switch)).collect::<Vec<_>>()
    };
    for (number, switch) in
        [codes(&kinematics.on, TipSwitch::On), codes(&kinematics.off, TipSwitch::Off)].concat()
    {
        let row = MCode { tip: Some(switch), ..MCode::harmless(number) };
        match dialect.m_codes.binary_search_by_key(&number, |row| row.number) {
            Err(at) => dialect.m_codes.insert(at, row),
            Ok(at) => dialect.m_codes[at] = row,
        }
    }
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

fn dialect(options: &JobOptions, profile: &Profile) -> Result<Dialect, Failure> {
    let Some(name) = options.dialect.as_deref().or(profile.control.as_deref()) else {
        return Err(Failure::usage(notice!(OPTION;
            "which dialect? neither the profile's `control` nor `--dialect` says",
            "какой диалект? не говорят ни `control` профиля, ни `--dialect`";
            "add `--dialect D`, one of: {}",
            "добавьте `--dialect D`, одно из: {}", nc_dialect::builtin_names().join(", ")
        )));
    };
    load_dialect(name)
}

/// A shipped dialect by name, or a grammar file by path.
///
/// # Errors
/// There is none of that name; what is wrong with the file.
pub fn load_dialect(name: &str) -> Result<Dialect, Failure> {
    if let Some(dialect) = nc_dialect::builtin(name) {
        return Ok(dialect.clone());
    }
    if !name.ends_with(".toml") {
        return Err(Failure::usage(no_dialect(OPTION, name)));
    }
    let bytes = std::fs::read(name).map_err(|error| Failure::unread(name, &error))?;
    let stem = Path::new(name)
        .file_stem()
        .map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    parse_dialect(&stem, name, &bytes)
}

/// That a name is of no shipped dialect, and of which it may be meant.
fn no_dialect(code: Code, name: &str) -> Diagnostic {
    let names = nc_dialect::builtin_names();
    let mut help = diagnostic::closest(name, names.iter().copied())
        .map_or(Text::EMPTY, |near| both!("did you mean {near}? ", "имелось в виду {near}? "));
    help.push(&both!(
        "one of: {}; or the path of a grammar file ending in .toml",
        "одно из: {}; или путь к файлу таблицы, который кончается на .toml",
        names.join(", ")
    ));
    notice!(code; "there is no dialect `{name}`", "диалекта `{name}` нет"; help)
}

/// Checks that there is the dialect which a profile names.
///
/// # Errors
/// There is none: where the profile says it. What is wrong with a file.
pub fn check_control(path: &Path, profile: &Profile) -> Result<(), Failure> {
    let (Some(name), Some(at)) = (&profile.control, &profile.control_at) else { return Ok(()) };
    if name.ends_with(".toml") || nc_dialect::builtin(name).is_some() {
        return load_dialect(name).map(drop);
    }
    let label = both!("names no control", "не называет стойку");
    let bytes = std::fs::read(path).map_err(|error| Failure::unread(&lines::name(path), &error))?;
    Err(Failure::Usage(vec![Report {
        source: Some(Source::whole(lines::name(path), bytes.as_slice())),
        diagnostics: vec![no_dialect(Code(303), name).at(at.clone(), label)],
    }]))
}

fn parse_dialect(stem: &str, file_name: &str, bytes: &[u8]) -> Result<Dialect, Failure> {
    let text = String::from_utf8_lossy(bytes);
    nc_dialect::load(stem, &text).map_err(|diagnostics| {
        let source = Some(Source::whole(file_name, text.as_bytes()));
        Failure::Usage(vec![Report { source, diagnostics }])
    })
}
