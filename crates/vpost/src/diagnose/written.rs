//! The profile with what the diagnosis found: causes as effects, the measuring frame as set-up.

use std::path::{Component, Path, PathBuf};

use diagnostic::Code;
use gap_diagnosis::Diagnosis;
use machine_model::effects::EffectKind;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value};

use crate::file;
use crate::message::Failure;
use jobs::diagnose::json::{number, round};

/// The profile is no TOML any more: someone changed it meanwhile.
const UNREADABLE: Code = Code(301);

/// Writes the profile `from` to `path` with the causes as `[[effect]]` and the frame as `[setup]`; comments and order stay. Where
/// [`Diagnosis::corrects`] is false nothing is added.
pub(super) fn write(path: &Path, from: &Path, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let text = String::from_utf8_lossy(&file::read(from)?).into_owned();
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let diagnostic = diagnostic::Diagnostic::error(UNREADABLE, error.to_string());
        Failure::usage(diagnostic.help("run `vpost profile check` on it"))
    })?;
    move_tables(document.as_table_mut(), &folder(from), &folder(path));
    let causes = if diagnosis.corrects() { diagnosis.causes.as_slice() } else { &[] };
    let effects = document.entry("effect").or_insert(Item::ArrayOfTables(ArrayOfTables::new()));
    if let Some(effects) = effects.as_array_of_tables_mut() {
        // What a fault of the instrument could have shown as well is no correction of the machine.
        let of_the_machine = |cause: &&gap_diagnosis::Cause| {
            let mut rivals = cause.cannot_be_told_from.iter().filter_map(|id| id.parse::<EffectKind>().ok());
            cause.term.kind().is_instrument() || !rivals.any(|kind| kind.is_instrument())
        };
        for cause in causes.iter().filter(of_the_machine) {
            let mut entry = Table::new();
            entry.insert("id", Item::Value(cause.effect.as_str().into()));
            for (name, value) in cause.term.entry() {
                entry.insert(name, Item::Value(decimal(value)));
            }
            effects.push(entry);
        }
    }
    if !causes.is_empty() {
        let setup = document.entry("setup").or_insert(Item::Table(Table::new()));
        if let Some(setup) = setup.as_table_like_mut() {
            setup.insert("shift_mm", three(diagnosis.setup.shift_um.map(|v| 1e-3 * v)));
            setup.insert("rotation_urad", three(diagnosis.setup.rotation_urad));
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
fn move_tables(document: &mut Table, from: &Path, to: &Path) {
    if from == to {
        return;
    }
    let lead = relative(to, from);
    let rename = |item: &mut Item| {
        if let Some(old) = item.as_str().filter(|old| !Path::new(old).is_absolute()) {
            let joined = if old.is_empty() { lead.clone() } else { clean(&lead.join(old)) };
            let mut new = Value::from(joined.to_string_lossy().replace('\\', "/"));
            if let Some(value) = item.as_value() {
                *new.decor_mut() = value.decor().clone();
            }
            *item = Item::Value(new);
        }
    };
    for group in ["axis", "rotary"] {
        let axes = document.get_mut(group).and_then(Item::as_table_like_mut);
        for (_, axis) in axes.into_iter().flat_map(|axes| axes.iter_mut()) {
            for key in ["errors", "errors_negative"] {
                if let Some(item) = axis.as_table_like_mut().and_then(|a| a.get_mut(key)) {
                    rename(item);
                }
            }
        }
    }
    let tracker = document.get_mut("tracker").and_then(Item::as_table_like_mut);
    for (_, item) in tracker.into_iter().flat_map(|tracker| tracker.iter_mut()) {
        rename(item);
    }
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
        move_tables(document.as_table_mut(), Path::new("/p"), Path::new("/q/r"));
        assert_eq!(document.to_string().replace("../../p/t/x.csv", "t/x.csv"), text);
    }
}
