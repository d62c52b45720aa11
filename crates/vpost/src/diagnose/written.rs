//! The profile with what the diagnosis found: causes as effects, the measuring frame as set-up.

use std::path::{Component, Path, PathBuf};

use diagnostic::{Code, both, of_toml};
use gap_diagnosis::Diagnosis;
use machine_model::Volume;
use machine_model::effects::EffectTerm;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value};

use crate::file;
use crate::message::Failure;
use jobs::diagnose::json::{number, round};

/// The profile is no TOML any more: someone changed it meanwhile.
const UNREADABLE: Code = Code(301);

/// Writes the profile `from` to `path` with the causes as `[[effect]]` and the frame as `[setup]`; comments and order stay. Where
/// [`Diagnosis::corrects`] is false nothing is added; where it is true in a part of the volume alone, the axes end there.
pub(super) fn write(path: &Path, from: &Path, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let text = String::from_utf8_lossy(&file::read(from)?).into_owned();
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let diagnostic = diagnostic::Diagnostic::error(UNREADABLE, of_toml(&error.to_string()));
        Failure::usage(
            diagnostic
                .help(both!("run `vpost profile check` on it", "запустите для него `vpost profile check`")),
        )
    })?;
    move_tables(&mut document, &folder(from), &folder(path));
    let effects = document.entry("effect").or_insert(Item::ArrayOfTables(ArrayOfTables::new()));
    if let Some(effects) = effects.as_array_of_tables_mut() {
        for cause in diagnosis.corrections() {
            let mut entry = Table::new();
            entry.insert("id", Item::Value(cause.effect.as_str().into()));
            for (name, value) in cause.term.iter().flat_map(EffectTerm::entry) {
                entry.insert(name, Item::Value(decimal(value)));
            }
            effects.push(entry);
        }
    }
    if let Some(Volume(part)) = diagnosis.within.filter(|_| diagnosis.corrects()) {
        for (letter, range) in ["X", "Y", "Z"].into_iter().zip(part) {
            document["axis"][letter]["travel_mm"] =
                Item::Value([range.low, range.high].into_iter().map(decimal).collect::<Array>().into());
        }
    }
    if let Some(found) = diagnosis.setup.as_ref().filter(|_| diagnosis.corrects()) {
        let setup = document.entry("setup").or_insert(Item::Table(Table::new()));
        if let Some(setup) = setup.as_table_like_mut() {
            setup.insert("shift_mm", three(found.shift_um.map(|v| 1e-3 * v)));
            setup.insert("rotation_urad", three(found.rotation_urad));
        }
    }
    file::write(path, document.to_string().as_bytes())
}

fn decimal(value: f64) -> Value {
    number(value).parse().unwrap_or_else(|_| round(value).into())
}

fn three(values: [f64; 3]) -> Item {
    Item::Value(values.into_iter().map(decimal).collect::<Array>().into())
}

fn folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // What does not exist cannot be written to, and the message then is about that.
    std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf())
}

/// Table files are named relative to the profile: in another folder they need other names.
fn move_tables(document: &mut DocumentMut, from: &Path, to: &Path) {
    if from == to {
        return;
    }
    let lead = relative(to, from);
    machine_profile::rename_tables(document, &mut |old| {
        if Path::new(old).is_absolute() {
            return old.to_owned();
        }
        let moved = if old.is_empty() { lead.clone() } else { clean(&lead.join(old)) };
        moved.to_string_lossy().replace('\\', "/")
    });
}

/// The way from one folder to another, both absolute.
fn relative(from: &Path, to: &Path) -> PathBuf {
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(common).map(|_| Component::ParentDir);
    up.chain(to.components().skip(common)).collect()
}

/// `a/../b` is `b`.
fn clean(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::ParentDir, Some(Component::Normal(_))) => {
                parts.pop();
            }
            (Component::CurDir, _) => {}
            _ => parts.push(part),
        }
    }
    parts.iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_found_from_another_folder() {
        assert_eq!(relative(Path::new("/a/out"), Path::new("/a/b/c")), Path::new("../b/c"));
        assert_eq!(clean(Path::new("../b/c/../d.csv")), Path::new("../b/d.csv"));
        assert_eq!(clean(Path::new("../../d.csv")), Path::new("../../d.csv"));
    }

    #[test]
    fn only_table_files_are_renamed() {
        let text = "name = \"a\"\n[axis.X]\nerrors = \"t/x.csv\" # measured\ntravel_mm = [0, 1]\n[tracker]\nx = \"/abs.csv\"\n";
        let mut document: DocumentMut = text.parse().expect("TOML");
        move_tables(&mut document, Path::new("/p"), Path::new("/q/r"));
        assert_eq!(document.to_string().replace("../../p/t/x.csv", "t/x.csv"), text);
    }
}
