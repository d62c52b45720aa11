//! One small program per trap: those that must be corrected, and those that must be refused, each for
//! its reason.

mod common;

use common::{files, messages, root, run};

const DIALECTS: [&str; 6] = ["fanuc", "perspektiva", "linuxcnc", "balt-system", "sinumerik", "centroid"];
/// Crooked in everything a 3-axis machine can be, with offsets and tools for every program of the corpus.
const PROFILE: &str = "tests/profiles/corpus.toml";
const ENDINGS: [&str; 2] = ["nc", "ngc"];

#[test]
fn accepted_programs_follow_their_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    let out = out.to_str().expect("a plain path");
    let mut failed = Vec::new();
    let mut count = 0;
    for dialect in DIALECTS {
        for path in files(&root().join("grammars").join(dialect).join("accept"), &ENDINGS) {
            count += 1;
            let program = path.to_str().expect("a plain path");
            let ran = run(&[program, "-m", PROFILE, "-d", dialect, "-o", out]);
            if !ran.status.success() {
                failed.push(format!("{program}\n{}", messages(&ran)));
                continue;
            }
            let check = run(&["check", program, out, "-m", PROFILE, "-d", dialect]);
            if !check.status.success() {
                let text = [check.stdout.as_slice(), &check.stderr].concat();
                failed.push(format!("{program}\n{}", String::from_utf8_lossy(&text)));
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count} programs:\n{}", failed.len(), failed.join("\n"));
    assert!(count > 30, "only {count} programs found");
}

#[test]
fn rejected_programs_are_refused_for_their_reason() {
    let mut failed = Vec::new();
    let mut count = 0;
    for dialect in DIALECTS {
        for path in files(&root().join("grammars").join(dialect).join("reject"), &ENDINGS) {
            count += 1;
            let program = path.to_str().expect("a plain path");
            let text = std::fs::read(&path).expect("readable");
            let text = String::from_utf8_lossy(&text);
            let at =
                text.find("expect VP").unwrap_or_else(|| panic!("{program} does not say what to expect"));
            let code = &text[at + "expect ".len()..at + "expect VP0000".len()];
            let ran = run(&[program, "-m", PROFILE, "-d", dialect]);
            let said = messages(&ran);
            let first = said.lines().next().unwrap_or_default();
            if ran.status.code() != Some(1) || !ran.stdout.is_empty() || !first.contains(code) {
                failed.push(format!("{program}: expected {code}, status {:?}\n{said}", ran.status.code()));
            } else if !said.contains("-->") || !said.contains("help:") {
                failed.push(format!("{program}: no place or no way out\n{said}"));
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count} programs:\n{}", failed.len(), failed.join("\n"));
    assert!(count > 30, "only {count} programs found");
}
