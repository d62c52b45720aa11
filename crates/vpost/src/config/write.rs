//! Options of a call as a settings file says them.

use std::path::Path;

use clap::Args;
use toml_edit::{Array, DocumentMut, Item, Value};

use super::read::{OF_ONE_CALL, is_path};
use crate::arguments::Shared;

/// A settings file that says options as they were typed: `--tolerance=2`, `--strict`; what is said anew in each call is
/// left out.
///
/// * `folder` – the file's own, from which its paths count: those of another folder are made whole
pub(crate) fn written(options: &[String], folder: &Path) -> String {
    let shared = Shared::augment_args(clap::Command::new("vpost"));
    let placed = |long: &str, word: &str| {
        let is_path = |option: &clap::Arg| option.get_long() == Some(long) && is_path(option, word);
        let is_elsewhere = folder != Path::new(".") && shared.get_arguments().any(is_path);
        let path = if is_elsewhere { std::path::absolute(word).ok() } else { None };
        path.map_or_else(|| word.to_owned(), |path| path.to_string_lossy().into_owned())
    };
    let mut document = DocumentMut::new();
    for option in options {
        let option = option.trim_start_matches('-');
        let (long, word) = option.split_once('=').map_or((option, None), |(long, word)| (long, Some(word)));
        if OF_ONE_CALL.contains(&long) {
            continue;
        }
        let value = word.map_or_else(|| Value::from(true), |word| Value::from(placed(long, word)));
        match document.get_mut(long).and_then(Item::as_value_mut) {
            None => document[long] = Item::Value(value),
            Some(Value::Array(all)) => all.push(value),
            Some(first) => *first = Value::Array(Array::from_iter([first.clone(), value])),
        }
    }
    document.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_settings() {
        let options = "--machine=mill.toml --work-offset=G54=1,2,3 --strict --force --work-offset=G55=4,5,6 \
                       --work-offset=G56=7,8,9 --dialect=my.toml";
        let options: Vec<String> = options.split_whitespace().map(str::to_owned).collect();
        assert_eq!(
            written(&options, Path::new(".")),
            "machine = \"mill.toml\"\nwork-offset = [\"G54=1,2,3\", \"G55=4,5,6\", \"G56=7,8,9\"]\nstrict = true\n\
             dialect = \"my.toml\"\n"
        );
        let elsewhere = written(&options, Path::new("jobs"));
        for name in ["mill.toml", "my.toml"] {
            let path = std::path::absolute(name).unwrap();
            assert!(elsewhere.contains(&format!("= \"{}\"", path.display())), "{elsewhere}");
        }
    }
}
