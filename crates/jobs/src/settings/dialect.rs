//! The dialect of a job: which it is, and what profile and command line put into it.

use std::path::Path;

use diagnostic::{Code, Diagnostic, Text, both, notice};
use machine_profile::{BareLengths, Profile};
use nc_dialect::{Action, CodeEntry, ControlCall, Dialect, MCode, PointFree, TipSwitch};
use nc_syntax::GCode;

use crate::lines;
use crate::message::{Failure, OPTION, Report, Source};
use crate::options::{self, JobOptions};

/// A lathe's dialect for a lathe and a mill's for a mill; of its G-code systems that of the profile.
pub(crate) fn turning_dialect(dialect: Dialect, profile: &Profile) -> Result<Dialect, Failure> {
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
pub(crate) fn declare_cycles(profile: &Profile, dialect: &mut Dialect) {
    let Some(turning) = &mut dialect.turning else { return };
    turning.diameters = profile.program.diameters;
    turning.cycles = profile.program.turning;
}

/// Their names.
pub(crate) fn lathe_dialects() -> String {
    let of_lathes = |name: &&str| nc_dialect::builtin(name).is_some_and(|dialect| dialect.turning.is_some());
    nc_dialect::builtin_names().into_iter().filter(of_lathes).collect::<Vec<_>>().join(", ")
}

/// Puts into the dialect what command line or profile say of lengths without a point; true where one of them does.
pub(crate) fn settle_lengths(
    options: &JobOptions,
    profile: &Profile,
    dialect: &mut Dialect,
) -> Result<bool, Failure> {
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
pub(crate) fn declare_calls(profile: &Profile, dialect: &mut Dialect) -> Result<(), Failure> {
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
pub(crate) fn declare_harmless(profile: &Profile, dialect: &mut Dialect) -> Result<(), Failure> {
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

/// Puts the M codes by which the machine switches tool centre point control into the dialect.
pub(crate) fn declare_switches(profile: &Profile, dialect: &mut Dialect) {
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

pub(crate) fn dialect(options: &JobOptions, profile: &Profile) -> Result<Dialect, Failure> {
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
pub(crate) fn no_dialect(code: Code, name: &str) -> Diagnostic {
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

pub(crate) fn parse_dialect(stem: &str, file_name: &str, bytes: &[u8]) -> Result<Dialect, Failure> {
    let text = String::from_utf8_lossy(bytes);
    nc_dialect::load(stem, &text).map_err(|diagnostics| {
        let source = Some(Source::whole(file_name, text.as_bytes()));
        Failure::Usage(vec![Report { source, diagnostics }])
    })
}
