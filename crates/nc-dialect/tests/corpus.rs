//! The programs in `tests/corpus/*/accept` and `tests/corpus/*/reject`, as far as reading and the tables decide.
//!
//! The whole-program test runs them through the command; here it is made sure that every accepted one is
//! readable and holds known codes only, and that every rejected one says which message it expects.

use std::collections::BTreeMap;
use std::path::Path;

use nc_dialect::{Action, Dialect, builtin, builtin_names};
use nc_expand::{Environment, Limits, expand};
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, ItemKind, Reader, Value, looks_like_program};

/// Messages that reading and the tables alone decide: unreadable, not static, unknown, refused, command.
const DECIDED_HERE: [u16; 10] = [101, 102, 103, 104, 105, 106, 202, 207, 208, 224];

/// Messages that a program as a whole decides, whatever its blocks would be refused for.
const DECIDED_BY_THE_WHOLE: std::ops::Range<u16> = 240..250;

/// Messages of the execution of variables and flow.
const EXPANSION: std::ops::Range<u16> = 120..160;

/// Name and bytes of every program in a folder, in alphabetical order.
fn programs(dialect: &str, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus").join(dialect).join(folder);
    let Ok(entries) = std::fs::read_dir(folder) else { return BTreeMap::new() };
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.expect("the corpus can be listed");
        let text = std::fs::read(entry.path()).expect("the corpus can be read");
        (entry.file_name().to_string_lossy().into_owned(), text)
    };
    entries.map(read).collect()
}

/// Work offsets and tools for every program of the corpus.
fn setup() -> Setup {
    let named = (54..60).map(|code| format!("G{code}")).chain(["G500".to_owned()]);
    let numbered = (1..100).flat_map(|number| [format!("G15H{number}"), format!("G54.1P{number}")]);
    Setup {
        work_offsets: named.chain(numbered).map(|name| (name, [0.0; 3])).collect(),
        tools: (1..100).map(|number| (number, [0.0; 3])).collect(),
        ..Setup::default()
    }
}

/// The first message that reading or the tables decide, once program flow is executed.
fn verdict(text: &[u8], dialect: &Dialect) -> Option<u16> {
    let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let setup = setup();
    let environment =
        Environment { variables: &[], read_external: &nothing, setup: &setup, limits: Limits::default() };
    let expanded = match expand(text, dialect, &environment) {
        Ok(expanded) => expanded,
        Err(refusal) => return Some(refusal.diagnostics[0].code.0),
    };
    let text = expanded.text();
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    while reader.next(&mut block) {
        for item in &block.items {
            let first = block.text(item.span).first().map_or(0, u8::to_ascii_uppercase);
            let found = match item.kind {
                ItemKind::Word { .. } | ItemKind::Invalid(_)
                    if dialect.refused_words.iter().any(|row| row.letter == first) =>
                {
                    Some(208)
                }
                ItemKind::Invalid(why) => Some(block.unreadable_at(why, item.span).code.0),
                ItemKind::Flow | ItemKind::Word { value: Value::Expression, .. } => Some(202),
                ItemKind::BracketCommand => {
                    let text = block.text(item.span);
                    match dialect.command(text) {
                        // What its arguments mean depends on the state.
                        Some(command) if command.action == Some(Action::ContourTolerance) => {
                            let settings = Interpreter::new(dialect, &setup).settings(&block);
                            settings.err().map(|refused| refused.code.0)
                        }
                        Some(command) if command.refusal(text).is_none() => None,
                        _ => Some(224),
                    }
                }
                _ => None,
            };
            if found.is_some() {
                return found;
            }
        }
        for word in block.words() {
            let refused = match word.letter {
                b'G' => match word.g_code().and_then(|code| dialect.code(code)) {
                    None => return Some(207),
                    Some(entry) => matches!(entry.action, Action::Refuse { .. }),
                },
                b'M' => {
                    let number = word.number().and_then(nc_syntax::Number::integer);
                    let row = number.and_then(|number| dialect.m_code(u16::try_from(number).ok()?));
                    row.is_some_and(|row| row.refuse.is_some() || row.switches.is_some())
                }
                _ => false,
            };
            if refused {
                return Some(208);
            }
        }
    }
    None
}

/// The number in the first `expect VPnnnn` of a program.
fn expected(text: &[u8]) -> Option<u16> {
    let text = String::from_utf8_lossy(text);
    let number = text.split("expect VP").nth(1)?.get(..4)?;
    number.parse().ok()
}

#[test]
fn accepted_programs_are_readable() {
    for name in builtin_names() {
        let dialect = builtin(name).unwrap();
        for (file, text) in programs(name, "accept") {
            assert_eq!(looks_like_program(&text), Ok(()), "{name}/accept/{file}");
            // Flow that is not refused is executed before the tables are asked.
            assert_eq!(verdict(&text, dialect), None, "{name}/accept/{file}");
        }
    }
}

#[test]
fn rejected_programs_say_why_and_are_rejected_for_it() {
    for name in builtin_names() {
        let dialect = builtin(name).unwrap();
        for (file, text) in programs(name, "reject") {
            let Some(expected) = expected(&text) else {
                panic!("{name}/reject/{file} has no `expect VPnnnn`")
            };
            if DECIDED_BY_THE_WHOLE.contains(&expected) {
                continue;
            }
            if EXPANSION.contains(&expected) {
                assert_eq!(verdict(&text, dialect), Some(expected), "{name}/reject/{file}");
                continue;
            }
            let found = verdict(&text, dialect).filter(|found| DECIDED_HERE.contains(found));
            let wanted = Some(expected).filter(|code| DECIDED_HERE.contains(code));
            assert_eq!(found, wanted, "{name}/reject/{file}");
        }
    }
}

#[test]
fn no_corpus_is_empty() {
    for name in ["fanuc", "linuxcnc", "perspektiva"] {
        assert!(programs(name, "accept").len() > 40 && programs(name, "reject").len() > 40, "{name}");
    }
}
