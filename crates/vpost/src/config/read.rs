//! A settings file as the options it says: its keys are the long names of options, its tables those of commands.

use std::path::Path;

use clap::builder::ValueHint;
use clap::{Arg, ArgAction, Args};
use diagnostic::{Code, Diagnostic, Text, both, closest, of_toml};
use toml_edit::{Document, Item, Key, TableLike, Value};

use super::held::Kept;
use crate::arguments::Shared;
use crate::message::{Failure, Source};
use crate::russian;

/// A settings file says what no option is.
pub(super) const UNFIT: Code = Code(6);

/// What is said anew in each call: what overrides a refusal, which one file would be written by every call, and from
/// where settings come.
pub(super) const OF_ONE_CALL: [&str; 4] = ["config", "force", "help", "output"];

/// What a file says, or everything wrong with it.
///
/// * `folder` – its own, from which its paths count
/// * `root` – the command line, each command with what it reads
pub(super) fn read(
    source: &Source,
    folder: &Path,
    root: &clap::Command,
) -> Result<Vec<Kept>, Vec<Diagnostic>> {
    let wrong = |at, message: Text| vec![Diagnostic::error(UNFIT, message).at(at, both!("here", "здесь"))];
    let text = std::str::from_utf8(&source.bytes).map_err(|error| {
        let at = error.valid_up_to() as u64;
        wrong(at..at + 1, both!("a settings file is UTF-8 text", "файл настроек — текст в UTF-8"))
    })?;
    let document = Document::parse(text).map_err(|error| {
        let said = of_toml(error.message());
        let at = error.span().unwrap_or_default();
        wrong(span(&at), both!("the settings are not TOML: {said}", "настройки — не TOML: {said:#}"))
    })?;
    let mut reading = Reading { source, folder, kept: Vec::new(), wrong: Vec::new() };
    let shared = Shared::augment_args(clap::Command::new("vpost"));
    reading.table(document.as_table(), &[], shared.get_arguments().collect(), root);
    if reading.wrong.is_empty() { Ok(reading.kept) } else { Err(reading.wrong) }
}

struct Reading<'a> {
    source: &'a Source,
    folder: &'a Path,
    kept: Vec<Kept>,
    wrong: Vec<Diagnostic>,
}

impl Reading<'_> {
    /// A table: options, and tables of the commands below.
    fn table(&mut self, table: &dyn TableLike, names: &[String], options: Vec<&Arg>, above: &clap::Command) {
        let may_be = |option: &&Arg| option.get_long().is_some_and(|long| !OF_ONE_CALL.contains(&long));
        let options: Vec<&Arg> = options.into_iter().filter(may_be).collect();
        for (name, _) in table.iter() {
            let Some((key, item)) = table.get_key_value(name) else { continue };
            let option = options.iter().find(|option| option.get_long() == Some(name));
            let command = above.get_subcommands().find(|command| command.get_name() == name);
            match (option, command, item.as_table_like()) {
                (Some(option), ..) => self.option(option, names, key, item),
                (None, Some(command), Some(inner)) => {
                    let names: Vec<String> = names.iter().cloned().chain([name.to_owned()]).collect();
                    let listed = command.get_arguments().filter(|option| !option.is_hide_set()).collect();
                    self.table(inner, &names, listed, command);
                }
                (None, ..) => {
                    let commands = above.get_subcommands().map(clap::Command::get_name);
                    let known: Vec<&str> =
                        options.iter().filter_map(|option| option.get_long()).chain(commands).collect();
                    self.unknown(key, names, &known);
                }
            }
        }
    }

    fn option(&mut self, option: &Arg, names: &[String], key: &Key, item: &Item) {
        let at = item.span().or_else(|| key.span()).unwrap_or_default();
        let long = option.get_long().unwrap_or_default();
        let words = item.as_value().map_or_else(|| item.as_table_like().and_then(pairs), words);
        let Some(words) = words else {
            let message = both!("`{long}` cannot be read from this", "`{long}` из этого не прочесть");
            return self.wrong.push(Diagnostic::error(UNFIT, message).at(span(&at), both!("here", "здесь")));
        };
        // An option that is given once takes a list as it is typed: `0,0,300`.
        let words = match option.get_action() {
            ArgAction::Append => words,
            _ => vec![words.join(",")],
        };
        for word in &words {
            if let Err(diagnostic) = parsed(option, word) {
                let label = both!("as `--{long}` would refuse it", "так же не принял бы ключ `--{long}`");
                return self.wrong.push(Diagnostic { code: UNFIT, ..diagnostic }.at(span(&at), label));
            }
        }
        let path = |word: String| match is_path(option, &word) {
            true => self.folder.join(word).to_string_lossy().into_owned(),
            false => word,
        };
        self.kept.push(Kept {
            command: names.to_vec(),
            option: long.to_owned(),
            id: option.get_id().to_string(),
            values: words.into_iter().map(path).collect(),
            line: self.source.line(key.span().unwrap_or(at).start as u64),
        });
    }

    fn unknown(&mut self, key: &Key, names: &[String], known: &[&str]) {
        let name = key.get();
        let of = names.join(" ");
        let message = match name {
            _ if OF_ONE_CALL.contains(&name) => {
                both!("`{name}` is said anew in each call", "`{name}` говорится в каждом вызове заново")
            }
            _ if names.is_empty() => both!(
                "`{name}` is neither a shared option nor a command",
                "`{name}` — не общий ключ и не команда"
            ),
            _ => both!("`vpost {of}` has no option `{name}`", "у `vpost {of}` нет ключа `{name}`"),
        };
        let help = match closest(name, known.iter().copied()) {
            Some(near) => both!("did you mean `{near}`?", "имелось в виду `{near}`?"),
            None => both!("there are {}", "есть {}", known.join(", ")),
        };
        let at = span(&key.span().unwrap_or_default());
        self.wrong.push(Diagnostic::error(UNFIT, message).at(at, both!("this key", "этот ключ")).help(help));
    }
}

fn span(range: &std::ops::Range<usize>) -> std::ops::Range<u64> {
    range.start as u64..range.end as u64
}

/// A value as what would be typed: one word, or one for each entry.
fn words(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::Array(entries) => entries.iter().map(word).collect(),
        Value::InlineTable(entries) => pairs(entries),
        _ => word(value).map(|word| vec![word]),
    }
}

/// `G54=100,50,0` of `G54 = [100, 50, 0]`.
fn pairs(table: &dyn TableLike) -> Option<Vec<String>> {
    table.iter().map(|(name, item)| Some(format!("{name}={}", word(item.as_value()?)?))).collect()
}

fn word(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.value().clone()),
        Value::Array(entries) => {
            entries.iter().map(word).collect::<Option<Vec<_>>>().map(|words| words.join(","))
        }
        Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => {
            Some(value.clone().decorated("", "").to_string())
        }
        Value::Datetime(_) | Value::InlineTable(_) => None,
    }
}

/// What the option itself says of a value.
fn parsed(option: &Arg, word: &str) -> Result<(), Diagnostic> {
    let long = option.get_long().unwrap_or_default().to_owned();
    let alone = Arg::new("value")
        .long(long.clone())
        .action(ArgAction::Set)
        .allow_hyphen_values(true)
        .value_parser(option.get_value_parser().clone());
    let command = clap::Command::new("vpost").no_binary_name(true).arg(alone);
    command.try_get_matches_from([format!("--{long}={word}")]).map(drop).map_err(|error| {
        match jobs::options::unread(&error) {
            Some(Failure::Usage(reports)) => reports.into_iter().flat_map(|report| report.diagnostics).next(),
            _ => None,
        }
        .unwrap_or_else(|| {
            let first = |text: String, word| {
                text.lines().next().unwrap_or_default().trim_start_matches(word).to_owned()
            };
            let english = first(error.to_string(), "error: ");
            let russian = first(russian::error(&error), "ошибка: ");
            Diagnostic::error(UNFIT, Text::new(english, russian))
        })
    })
}

/// A file or folder; a dialect is one where it is no name.
pub(super) fn is_path(option: &Arg, word: &str) -> bool {
    let path = option.get_value_hint() == ValueHint::AnyPath && word != "-";
    path || (option.get_id() == "dialect" && word.ends_with(".toml"))
}
