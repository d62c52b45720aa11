//! No command lists an option that it ignores: for each there is a call in which giving it changes something.

#![cfg(unix)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rayon::prelude::*;
use serde::Deserialize;

use crate::common::{root, run};
use crate::docs::{Clone, copy, options, subcommands};
use crate::help::every_command;

#[derive(Deserialize)]
struct Table {
    files: BTreeMap<String, String>,
    case: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    command: String,
    call: String,
    options: Vec<String>,
}

/// What came of a call: status, what was said, and every file that lies there then.
type Outcome = (Option<i32>, String, String, BTreeMap<PathBuf, Vec<u8>>);

fn files_below(folder: &Path, into: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            files_below(&path, into);
        } else {
            into.insert(path.clone(), std::fs::read(&path).expect("a file"));
        }
    }
}

fn outcome(call: &str, files: &BTreeMap<String, String>) -> Outcome {
    let place = tempfile::tempdir().expect("a temporary folder");
    let here = place.path().join("shop");
    copy(&root().join("tests/newcomer"), &here);
    for shipped in ["samples", "machine-profiles"] {
        std::os::unix::fs::symlink(root().join(shipped), here.join(shipped)).expect("a link");
    }
    for (name, text) in files {
        let path = here.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    }
    let tools = Clone::tools(place.path());
    let ran = Command::new("bash")
        .args(["-c", &format!("vpost {call}")])
        .current_dir(&here)
        .env("LC_ALL", "C")
        .env("PATH", format!("{}:{}", tools.display(), std::env::var("PATH").unwrap_or_default()))
        .env("VPOST_UNDER_TEST", env!("CARGO_BIN_EXE_vpost"))
        .stdin(Stdio::null())
        .output()
        .expect("bash is there");
    let mut found = BTreeMap::new();
    files_below(&here, &mut found);
    let found = found
        .into_iter()
        .map(|(path, bytes)| (path.strip_prefix(&here).map_or(path.clone(), Path::to_path_buf), bytes))
        .collect();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (ran.status.code(), text(&ran.stdout), text(&ran.stderr), found)
}

/// Command and option of each that a case tries, and what is wrong: nothing where giving it changed something.
fn tried<'c>(case: &'c Case, files: &BTreeMap<String, String>) -> Vec<(&'c str, String, Option<String>)> {
    let without = outcome(&case.call, files);
    let one = |option: &String| {
        let with = outcome(&format!("{} '{option}'", case.call), files);
        let no_call = ["unexpected argument", "cannot be used multiple times"];
        let fault = if no_call.iter().any(|said| with.2.contains(said)) {
            Some(format!("{} {option}: {}", case.call, with.2))
        } else {
            (with == without).then(|| format!("ignored: vpost {} '{option}'\n{}", case.call, with.2))
        };
        (case.command.as_str(), option.split('=').next().unwrap_or_default().to_owned(), fault)
    };
    case.options.iter().map(one).collect()
}

#[test]
fn every_option_that_is_listed_acts() {
    let table: Table =
        toml::from_str(&std::fs::read_to_string(root().join("tests/options.toml")).expect("text"))
            .expect("cases");
    // Each call in a folder of its own, so that they may run side by side.
    let tried: Vec<(&str, String, Option<String>)> =
        table.case.par_iter().flat_map_iter(|case| tried(case, &table.files)).collect();
    let mut acting: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    let mut wrong: Vec<String> = tried.iter().filter_map(|(.., fault)| fault.clone()).collect();
    for (command, option, fault) in tried {
        if fault.is_none() {
            acting.entry(command).or_default().insert(option);
        }
    }
    for command in every_command() {
        let words: Vec<&str> = command.split_whitespace().chain(["--help"]).collect();
        let page = String::from_utf8(run(&words).stdout).expect("text");
        // A group hands its options on to the command below it.
        if command.is_empty() || (command != "batch" && !subcommands(&page).is_empty()) {
            continue;
        }
        let none = BTreeSet::new();
        let shown = acting.get(command.as_str()).unwrap_or(&none);
        let untried: Vec<String> = options(&page).difference(shown).cloned().collect();
        if !untried.is_empty() {
            wrong.push(format!(
                "`vpost {command}` lists {untried:?}; in which call of tests/options.toml do they act?"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
