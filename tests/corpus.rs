//! One small program per trap: those that must be corrected, and those that must be refused, each for
//! its reason.

use crate::common::{files, have_interpreter, messages, referee, root, run};

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
    for dialect in nc_dialect::builtin_names() {
        for path in files(&root().join("tests/corpus").join(dialect).join("accept"), &ENDINGS) {
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
    for dialect in nc_dialect::builtin_names() {
        for path in files(&root().join("tests/corpus").join(dialect).join("reject"), &ENDINGS) {
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

/// Programs that the second judge does not read: it takes M, S, T, D and H out of the text before its interpreter sees
/// it, and that wants them here; a length in words (G43.1) it does not know.
const NOT_READ: [&str; 10] = [
    "codes-that-move-nothing",
    "cutter-compensation",
    "cutter-compensation-right-by-diameter",
    "feed-per-revolution-and-back",
    "length-from-words",
    "m66-and-user-m-codes",
    "outputs-and-saved-state",
    "spindle-bound-cycles",
    "subprogram-call",
    "tapping-is-not-split",
];

/// The programs of LinuxCNC's corpus before LinuxCNC's interpreter and a model that shares no code with ours.
#[test]
fn the_second_judge_agrees_on_the_corpus() {
    if !have_interpreter() {
        println!("skipped: linuxcnc-uspace is not installed");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    let out_text = out.to_str().expect("a plain path");
    let mut failed = Vec::new();
    let mut judged = 0;
    for path in files(&root().join("tests/corpus/linuxcnc/accept"), &ENDINGS) {
        let program = path.to_str().expect("a plain path");
        let name = path.file_stem().expect("a name").to_string_lossy();
        if NOT_READ.contains(&name.as_ref()) {
            continue;
        }
        let ran = run(&[program, "-m", PROFILE, "-d", "linuxcnc", "-o", out_text]);
        assert!(ran.status.success(), "{program}\n{}", messages(&ran));
        // Inches are written in finer steps than millimetres.
        let verdict = referee(&path, &out, PROFILE, "linuxcnc", &[]);
        judged += 1;
        if verdict["ok"] != true {
            failed.push(format!("{program}: {:#}", verdict["failures"]));
        }
    }
    assert!(failed.is_empty(), "{} of {judged}:\n{}", failed.len(), failed.join("\n"));
    assert!(judged > 50, "only {judged}");
}
