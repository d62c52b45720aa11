//! The INI file of a LinuxCNC machine: its unit, and which files hold tools and parameters.

use diagnostic::both;
use measurement_files::{Piece, Refusal, decoded};

use crate::refusals::{BEYOND, File, UNREADABLE, refuse, refuse_whole};

/// What an INI file says of a machine's lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Ini {
    /// `[TRAJ] LINEAR_UNITS`: of tool table and parameters, mm.
    pub unit_mm: f64,
    /// `[EMCIO] TOOL_TABLE`, relative to the INI file.
    pub tool_table: Option<String>,
    /// `[RS274NGC] PARAMETER_FILE`, relative to the INI file.
    pub parameters: Option<String>,
}

impl Ini {
    /// Reads the INI file of a machine.
    ///
    /// # Errors
    /// It has no LINEAR_UNITS, or an unknown one; tools are kept by a program; it is included in pieces.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, Box<Refusal>> {
        let text = decoded(bytes);
        let file = (name, text.as_ref());
        let (mut unit, mut tool_table, mut parameters) = (None, None, None);
        for entry in entries(file)? {
            let value = entry.value;
            let is = |of: &str, name: &str| entry.is(of, name);
            if is("EMCIO", "DB_PROGRAM") {
                let message = both!(
                    "the tools of this machine are kept by a program of their own",
                    "данные об инструментах этого станка хранит отдельная программа"
                );
                let label = both!(
                    "which lengths it holds this file does not say",
                    "какие в ней длины, этот файл не говорит"
                );
                let help = both!(
                    "write them as CSV (tool,length_mm) and give that: `--tool-table FILE`, and the zeros with `--work-offset`",
                    "запишите их как CSV (tool,length_mm) и дайте его: `--tool-table FILE`, а нули — ключом `--work-offset`"
                );
                return Err(refuse(file, value, BEYOND, message, label, help));
            }
            if is("TRAJ", "LINEAR_UNITS") {
                unit.get_or_insert(value);
            } else if is("EMCIO", "TOOL_TABLE") {
                tool_table.get_or_insert(value.text);
            } else if is("RS274NGC", "PARAMETER_FILE") {
                parameters.get_or_insert(value.text);
            }
        }
        let unit_mm = unit_mm(file, unit)?;
        let owned = |value: Option<&str>| value.map(str::to_owned);
        Ok(Self { unit_mm, tool_table: owned(tool_table), parameters: owned(parameters) })
    }
}

/// A key of an INI file with its value.
pub(crate) struct Entry<'t> {
    section: &'t str,
    key: &'t str,
    pub(crate) value: Piece<'t>,
}

impl Entry<'_> {
    /// True where this key of that section has a value.
    pub(crate) fn is(&self, section: &str, key: &str) -> bool {
        self.section.eq_ignore_ascii_case(section)
            && self.key.eq_ignore_ascii_case(key)
            && !self.value.text.is_empty()
    }
}

/// The keys of an INI file in their order; of one that stands twice LinuxCNC takes the first.
pub(crate) fn entries(file: File<'_>) -> Result<Vec<Entry<'_>>, Box<Refusal>> {
    let mut section = "";
    let mut found = Vec::new();
    for line in Piece::lines(file.1).map(Piece::trimmed) {
        if line.text.starts_with("#INCLUDE") {
            let help = both!(
                "give the whole one that LinuxCNC writes beside it when it starts, with `.expanded` behind its name",
                "дайте полный, который LinuxCNC при запуске пишет рядом: с `.expanded` после имени"
            );
            let message = both!("this INI file takes in others", "этот INI-файл включает другие");
            let label = both!("what they say would be missed", "сказанное в них пропало бы");
            return Err(refuse(file, line, UNREADABLE, message, label, help));
        }
        if line.text.is_empty() || line.text.starts_with(['#', ';']) {
            continue;
        }
        if let Some(rest) = line.text.strip_prefix('[') {
            section = rest.split(']').next().unwrap_or_default().trim();
            continue;
        }
        let Some(equals) = line.text.find('=') else { continue };
        let key = line.before(&['=']).trimmed().text;
        found.push(Entry { section, key, value: line.behind(equals + 1).trimmed() });
    }
    Ok(found)
}

/// What `[TRAJ] LINEAR_UNITS` says, mm.
pub(crate) fn unit_mm(file: File<'_>, unit: Option<Piece<'_>>) -> Result<f64, Box<Refusal>> {
    let Some(unit) = unit else {
        let message = both!(
            "no LINEAR_UNITS under [TRAJ]: this is no INI file of a LinuxCNC machine",
            "в [TRAJ] нет LINEAR_UNITS: это не INI-файл станка с LinuxCNC"
        );
        let help =
            both!("give the file that LinuxCNC is started with", "дайте файл, с которым запускают LinuxCNC");
        return Err(refuse_whole(file, UNREADABLE, message, help));
    };
    match unit.text.to_ascii_lowercase().as_str() {
        "mm" | "metric" => Ok(1.0),
        "in" | "inch" | "imperial" => Ok(25.4),
        _ => {
            let label = both!("expected mm or inch", "ожидалось mm или inch");
            let help = both!(
                "write what the machine's axes count in: LINEAR_UNITS = mm, or inch",
                "напишите, в чём считают оси станка: LINEAR_UNITS = mm или inch"
            );
            let message = both!("LINEAR_UNITS is `{}`", "LINEAR_UNITS — `{}`", unit.text);
            Err(refuse(file, unit, UNREADABLE, message, label, help))
        }
    }
}
