//! Curves by control points: corrected within tolerance of the exact curve, kept where nothing is to be corrected.

use std::path::Path;

use crate::common::{files, have_interpreter, messages, referee, root, run};

const CROOKED: &str = "tests/profiles/corpus.toml";
const PERFECT: &str = "machine-profiles/perfect.toml";

/// The programs of the corpus that hold curves, each with its dialect.
fn programs() -> Vec<(std::path::PathBuf, &'static str)> {
    let mut found = Vec::new();
    for dialect in ["linuxcnc", "fanuc"] {
        for path in files(&root().join("tests/corpus").join(dialect).join("accept"), &["nc"]) {
            let text = String::from_utf8_lossy(&std::fs::read(&path).expect("readable")).into_owned();
            if dialect == "linuxcnc" && text.contains("\nG5.") || text.contains("\nG6.2") {
                found.push((path, dialect));
            }
        }
    }
    assert_eq!(found.len(), 4, "{found:?}");
    found
}

fn corrected(program: &Path, out: &Path, dialect: &str, profile: &str) -> String {
    let (program, out_text) = (program.to_str().expect("plain"), out.to_str().expect("plain"));
    let ran = run(&[program, "-m", profile, "-d", dialect, "-o", out_text]);
    assert!(ran.status.success(), "{program}\n{}", messages(&ran));
    std::fs::read_to_string(out).expect("readable")
}

#[test]
fn lines_follow_the_exact_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    for (program, dialect) in programs() {
        let text = corrected(&program, &out, dialect, CROOKED);
        for code in ["G5 I", "G5.1 I", "G5.2", "G5.3", "G6.2"] {
            assert!(!text.contains(&format!("\n{code}")), "{}\n{text}", program.display());
        }
        let ran =
            run(&["check", program.to_str().unwrap(), out.to_str().unwrap(), "-m", CROOKED, "-d", dialect]);
        assert!(ran.status.success(), "{}\n{}", program.display(), String::from_utf8_lossy(&ran.stdout));
        if dialect == "linuxcnc" && have_interpreter() {
            // Evaluates curves by itself, and holds that against LinuxCNC's own evaluation where that has the form.
            let verdict = referee(&program, &out, CROOKED, dialect, &[]);
            assert_eq!(verdict["ok"], true, "{}: {verdict:#}", program.display());
        }
    }
}

#[test]
fn a_machine_without_errors_keeps_the_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    for (program, dialect) in programs() {
        let posted = std::fs::read_to_string(&program).expect("readable");
        assert_eq!(corrected(&program, &out, dialect, PERFECT), posted, "{}", program.display());
    }
}

/// What the blocks of a curve say besides stays where it was, and its F is the one of the lines.
#[test]
fn what_stands_beside_a_curve_stays() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (program, out) = (folder.path().join("in.ngc"), folder.path().join("out.ngc"));
    let text = "G17 G21 G90 G54\nG0 X10 Y10 Z60\nG1 Z50 F200\nN10 G5.2 X20 Y10 P1 L3 F150 (first)\nX20 Y20 P1\n\
                N30 X10 Y20 P2 (last) M8\nG5.3 (cut)\nG0 Z60\nM2\n";
    std::fs::write(&program, text).expect("writable");
    let written = corrected(&program, &out, "linuxcnc", CROOKED);
    let lines: Vec<&str> = written.lines().collect();
    let at = |wanted: &str| {
        lines.iter().position(|line| *line == wanted).unwrap_or_else(|| panic!("{wanted}\n{written}"))
    };
    // The block of which nothing is left is gone.
    assert_eq!(at("N10 G1 F150 (first)") + 1, at("N30 (last) M8"), "{written}");
    let cut = lines.iter().position(|line| line.ends_with("(cut)")).expect("the last block");
    assert_eq!(cut, at("N30 (last) M8") + 1, "{written}");
    assert!(lines[cut].starts_with("G1 X"), "{written}");
    assert!(lines.len() > cut + 20, "{written}");
}

/// Damaged on purpose: the judges see what is a few micrometres off.
#[test]
fn both_judges_see_a_line_beside_its_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (program, out) = (folder.path().join("in.ngc"), folder.path().join("out.ngc"));
    let text = "G17 G21 G90 G54\nG0 X10 Y10 Z60\nG1 Z50 F200\nG5 X50 Y10 I20 J40 P-20 Q40\nG0 Z60\nM2\n";
    std::fs::write(&program, text).expect("writable");
    let written = corrected(&program, &out, "linuxcnc", CROOKED);
    let mut lines: Vec<&str> = written.lines().collect();
    // Two lines in a row become one.
    let middle = lines.len() / 2;
    lines.drain(middle..middle + 4);
    std::fs::write(&out, lines.join("\n")).expect("writable");
    let ran =
        run(&["check", program.to_str().unwrap(), out.to_str().unwrap(), "-m", CROOKED, "-d", "linuxcnc"]);
    assert_eq!(ran.status.code(), Some(1), "{}", String::from_utf8_lossy(&ran.stdout));
    if have_interpreter() {
        assert_eq!(referee(&program, &out, CROOKED, "linuxcnc", &[])["ok"], false);
    }
}
