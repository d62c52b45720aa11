//! A newcomer follows each how-to, in both languages, with a machine and jobs that ship nowhere.
//!
//! The commands are the pages' own; `tests/newcomer/pages.toml` says which files and numbers stand in the place of those that
//! the page names. No sample and no shipped profile lies in the newcomer's folder, so a command that needs one fails.

#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::root;
use crate::docs::{Clone, copy};

type Changes = BTreeMap<String, String>;

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Page, or `every`: what is written there, and what the newcomer writes.
fn changes() -> BTreeMap<String, Changes> {
    toml::from_str(&read("tests/newcomer/pages.toml")).expect("tables of texts")
}

/// The `sh` blocks of a page, as the newcomer types them.
fn typed(page: &str, changes: &BTreeMap<String, Changes>, name: &str) -> Result<Vec<String>, String> {
    let mut blocks: Vec<String> = page
        .split("\n```sh\n")
        .skip(1)
        .map(|rest| rest.split("\n```").next().unwrap_or_default().to_owned())
        .collect();
    for from in changes.get(name).into_iter().flat_map(BTreeMap::keys) {
        if !blocks.iter().any(|block| block.contains(from)) {
            return Err(format!("`{from}` is on the page no more: tests/newcomer/pages.toml"));
        }
    }
    // Longer ones first: a path may begin with another.
    let mut pairs: Vec<(&String, &String)> =
        [name, "every"].into_iter().filter_map(|which| changes.get(which)).flatten().collect();
    pairs.sort_by_key(|(from, _)| std::cmp::Reverse(from.len()));
    for block in &mut blocks {
        for (from, to) in &pairs {
            *block = block.replace(from.as_str(), to);
        }
        for shipped in ["samples/", "machine-profiles/"] {
            if block.replace("samples/cluster/", "").contains(shipped) {
                return Err(format!("the newcomer has nothing for this:\n{block}"));
            }
        }
    }
    Ok(blocks)
}

/// What each block prints; the first that fails is an error.
fn played(blocks: &[String], locale: &str) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let shop = folder.path().join("shop");
    copy(&root().join("tests/newcomer"), &shop);
    for maker in ["make.py", "pages.toml"] {
        std::fs::remove_file(shop.join(maker)).expect("it is there");
    }
    let tools = Clone::tools(folder.path());
    let print = |block: &String| {
        let ran = Command::new("bash")
            .args(["-e", "-o", "pipefail", "-c", &format!("exec 2>&1\n{block}")])
            .current_dir(&shop)
            .env_remove("NO_COLOR")
            .env_remove("LC_ALL")
            .env("LC_MESSAGES", locale)
            .env("PATH", format!("{}:{}", tools.display(), std::env::var("PATH").unwrap_or_default()))
            .env("VPOST_UNDER_TEST", env!("CARGO_BIN_EXE_vpost"))
            .stdin(Stdio::null())
            .output()
            .expect("bash is there");
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        if ran.status.success() { Ok(said) } else { Err(format!("{}:\n{block}\n{said}", ran.status)) }
    };
    blocks.iter().map(print).collect()
}

#[test]
fn every_how_to_leads_a_newcomer_to_the_end_in_both_languages() {
    let changes = changes();
    let (mut wrong, mut ran, mut pages) = (Vec::new(), 0, 0);
    let mut names: Vec<String> = std::fs::read_dir(root().join("docs/how-to"))
        .expect("how-tos")
        .filter_map(|entry| {
            entry.ok()?.file_name().into_string().ok()?.strip_suffix(".md").map(str::to_owned)
        })
        .filter(|name| !name.ends_with(".ru"))
        .collect();
    names.sort();
    for name in &names {
        let play = |ending: &str, locale: &str| {
            let page = read(&format!("docs/how-to/{name}{ending}"));
            played(&typed(&page, &changes, name)?, locale)
        };
        match (play(".md", "C"), play(".ru.md", "ru_RU.UTF-8")) {
            (Ok(english), Ok(russian)) => {
                assert_eq!(english.len(), russian.len(), "{name}");
                pages += usize::from(!english.is_empty());
                ran += english.len() + russian.len();
                for (english, russian) in english.iter().zip(&russian) {
                    // A file of ParaView's is in English to its end.
                    let spoken = |text: &str| text.split("# vtk ").next().unwrap_or_default().to_owned();
                    if let Some(fault) = crate::russian::fault(&spoken(english), &spoken(russian)) {
                        wrong.push(format!("{name}, in Russian: {fault}\n{russian}"));
                    }
                    for shipped in ["STAN", "Generic", "MS-300", "Leica", "Renishaw"] {
                        if english.contains(shipped) {
                            wrong.push(format!("{name}: {shipped} is not the newcomer's\n{english}"));
                        }
                    }
                }
            }
            (english, russian) => {
                wrong.extend(
                    [english.err(), russian.err()].into_iter().flatten().map(|e| format!("{name}: {e}")),
                );
            }
        }
    }
    let known: Vec<&String> =
        changes.keys().filter(|name| *name != "every" && !names.contains(name)).collect();
    assert!(known.is_empty(), "tests/newcomer/pages.toml has pages that are none: {known:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(pages > 14 && ran > 100, "{pages} pages, {ran} blocks");
}

#[test]
fn a_page_that_leads_astray_is_found() {
    let none = BTreeMap::new();
    let page = "text\n```sh\nvpost samples/plate_linuxcnc.nc\n```\n";
    assert!(typed(page, &none, "x").expect_err("shipped").contains("has nothing for this"));
    let stale = BTreeMap::from([("x".to_owned(), Changes::from([("G54".to_owned(), "G55".to_owned())]))]);
    assert!(typed("\n```sh\nvpost\n```\n", &stale, "x").expect_err("stale").contains("no more"));
    let failing = vec![
        "vpost profile check vega/vega.toml".to_owned(),
        "vpost nothing.nc -m vega/vega.toml".to_owned(),
    ];
    assert!(played(&failing, "C").expect_err("no such file").contains("nothing.nc"));
    assert!(played(&failing[..1], "C").is_ok());
}

/// What was hidden in the newcomer's measurements is found, within the intervals that are printed.
#[test]
fn the_newcomers_instruments_find_what_was_hidden() {
    let found = |arguments: &[&str], names: &[(&str, f64)]| {
        let folder = root().join("tests/newcomer");
        let ran = crate::common::vpost()
            .current_dir(Path::new(&folder))
            .args(arguments)
            .output()
            .expect("it starts");
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.success(), "{said}{}", crate::common::messages(&ran));
        for (name, hidden) in names {
            let line = said.lines().find(|line| line.trim_start().starts_with(name)).expect("a line");
            let rest = line.trim_start().strip_prefix(name).unwrap_or_default();
            let mut numbers =
                rest.split(|c: char| c.is_whitespace() || c == '±').filter_map(|n| n.parse::<f64>().ok());
            let (value, interval) = (numbers.next().expect("a value"), numbers.next().expect("an interval"));
            // 95 % intervals of a dozen values: one may well miss, by half of its own width.
            assert!((value - hidden).abs() <= 1.5 * interval, "{name}: {hidden} hidden, {line}");
        }
    };
    let circles = [("EC0Y", 41.0), ("EB0Z", -22.0), ("EA0Z", 17.0), ("backlash X", 5.2), ("backlash Z", 7.4)];
    found(&["calibrate", "ballbar", "measured/circles.csv"], &circles);
    let table =
        [("EZ0A", -61.0), ("EB0A", 118.0), ("EX0C", 87.0), ("EY0C", -42.0), ("EA0C", 55.0), ("EB0C", -71.0)];
    let chain = ["--chain", "[w C A b X Y Z t]", "--crossing", "410,-220,-380"];
    found(&[&["calibrate", "ballbar", "measured/bar.csv"], &chain[..]].concat(), &table);
    let rtest =
        [("EX0C", 31.0), ("EY0C", -12.0), ("EA0C", 77.0), ("EY0A", 18.0), ("EZ0A", -23.0), ("EC0A", -44.0)];
    found(&["calibrate", "rtest", "table/rtest.csv", "-m", "table/table.toml"], &rtest);
}
