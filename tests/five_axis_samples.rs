//! `samples/five_axis`: made by a program, posted three ways, and corrected on crooked machines.

use crate::common::{messages, root, run};
use crate::five_axis_parts::{chain_of, files};

fn dialect_of(file: &str) -> &'static str {
    match file.rsplit('.').next() {
        Some("mpf") => "sinumerik",
        Some("ngc") => "linuxcnc",
        _ => "fanuc",
    }
}

#[test]
fn they_are_what_the_program_makes() {
    let folder = root().join("samples/five_axis");
    let mut there: Vec<String> = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable").file_name().into_string().expect("a plain name"))
        .collect();
    there.sort();
    let mut made: Vec<String> = files().into_iter().map(|(name, _)| name).collect();
    made.sort();
    assert_eq!(there, made, "cargo xtask five-axis-samples writes them");
    for (name, text) in files() {
        let kept = std::fs::read_to_string(folder.join(&name)).expect("readable");
        assert!(kept == text, "{name}: cargo xtask five-axis-samples writes it anew");
    }
}

/// The machines are off by more than the tolerance, and the corrected programs are not.
#[test]
fn each_is_corrected_within_tolerance() {
    for (name, _) in files() {
        let chain = chain_of(&name);
        let profile = format!("samples/profiles/five_axis_{chain}.toml");
        let from = format!("samples/five_axis/{name}");
        let place = tempfile::tempdir().expect("a temporary folder");
        let to = place.path().join("out.nc");
        let to = to.to_str().expect("a plain path");
        let dialect = dialect_of(&name);
        let ran = run(&[&from, "-m", &profile, "--zero", "true", "-d", dialect, "-o", to]);
        assert!(ran.status.success() && messages(&ran).is_empty(), "{name}: {}", messages(&ran));
        let check = run(&["check", &from, to, "-m", &profile, "--zero", "true", "-d", dialect]);
        assert!(check.status.success(), "{name}: {}", String::from_utf8_lossy(&check.stdout));
        let before = run(&["check", &from, &from, "-m", &profile, "--zero", "true", "-d", dialect]);
        assert_eq!(before.status.code(), Some(1), "{name} needs no correction");
    }
}
