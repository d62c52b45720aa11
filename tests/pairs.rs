//! Programs beside the same ones written out by hand (`tests/corpus/pairs`): what is written for the first is right by the
//! second, and the other way round. What both go through is no judge: `check` expands both alike.

use std::path::Path;

use crate::common::{messages, root, run};

/// A shipped profile with its tables where they are, and words of it replaced.
fn profile(folder: &Path, name: &str, change: (&str, &str)) -> String {
    let text = std::fs::read_to_string(root().join("machine-profiles").join(format!("{name}.toml")))
        .expect("readable");
    let tables = root().join("machine-profiles").join(name);
    let text = text.replace(&format!("\"{name}/"), &format!("\"{}/", tables.display()));
    assert!(text.contains(change.0), "{} is not in {name}", change.0);
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text.replacen(change.0, change.1, 1)).expect("writable");
    path.to_str().expect("a plain path").to_owned()
}

/// Arguments of the programs of a folder.
fn arguments(folder: &Path, kind: &str) -> Vec<String> {
    const PECKS: &str = "drill_pecks = \"full\"\ndrill_return_mm = 0.5\n";
    let lathe = |system: &str| {
        let said = format!("g_code_system = \"{system}\"\n{PECKS}");
        vec!["-m".to_owned(), profile(folder, "generic_lathe", ("g_code_system = \"A\"\n", &said))]
    };
    let mill = |dialect: &str, program: &str| {
        let profile = profile(folder, "stan_s500", ("[correction]\n", &format!("{program}[correction]\n")));
        let offsets = ["--work-offset", "G54=140,100,19", "--work-offset", "G55=150,105,18"];
        let all = ["-m", &profile, "-d", dialect];
        all.into_iter().chain(offsets).map(str::to_owned).collect()
    };
    match kind {
        "fanuc-lathe-a" => lathe("A"),
        "fanuc-lathe-b" => lathe("B"),
        "sinumerik-turn" => {
            let profile = profile(folder, "generic_lathe", ("g_code_system = \"A\"\n", ""));
            ["-m", &profile, "-d", kind].map(str::to_owned).to_vec()
        }
        "sinumerik" => {
            let include =
                root().join("tests/corpus/pairs/sinumerik").to_str().expect("a plain path").to_owned();
            [mill(kind, "[program]\nedge_at_change = 1\n"), vec!["--include".to_owned(), include]].concat()
        }
        _ => mill(kind, ""),
    }
}

#[test]
fn a_program_is_what_it_is_written_out_by_hand() {
    let pairs = root().join("tests/corpus/pairs");
    let (mut count, mut failed) = (0, Vec::new());
    for kind in ["fanuc", "sinumerik", "sinumerik-turn", "fanuc-lathe-a", "fanuc-lathe-b"] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let arguments = arguments(folder.path(), kind);
        let with = |first: &[&str]| {
            let rest: Vec<&str> = arguments.iter().map(String::as_str).collect();
            run(&[first, &rest].concat())
        };
        for hand in crate::common::files(&pairs.join(kind), &["nc", "mpf"]) {
            let hand = hand.to_str().expect("a plain path");
            let Some((name, ending)) = hand.split_once(".hand.") else { continue };
            let program = format!("{name}.{ending}");
            count += 1;
            for (one, other) in [(program.as_str(), hand), (hand, program.as_str())] {
                let out = folder.path().join("out.nc");
                let out = out.to_str().expect("a plain path");
                let corrected = with(&["correct", one, "-o", out]);
                if !corrected.status.success() {
                    failed.push(format!("{one}\n{}", messages(&corrected)));
                    continue;
                }
                let check = with(&["check", other, out]);
                if !check.status.success() {
                    let said = [check.stdout.as_slice(), &check.stderr].concat();
                    failed.push(format!("{other} against {one}\n{}", String::from_utf8_lossy(&said)));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count} pairs:\n{}", failed.len(), failed.join("\n"));
    assert!(count > 12, "only {count} pairs");
}
