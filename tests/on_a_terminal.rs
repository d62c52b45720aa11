//! What somebody at a terminal sees and a pipe does not: one line of success, a bar where it takes longer.

#![cfg(target_os = "linux")]

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{messages, root, run};
use crate::folders::copy;

const PROFILE: &str = "tests/profiles/corpus.toml";
const PROGRAM: &str = "samples/bolt_circle_fanuc.nc";

/// True where `script` of util-linux is there; false after saying that the test is skipped.
#[expect(clippy::print_stdout, reason = "a test says that it was skipped")]
fn have_terminals() -> bool {
    let there = Command::new("script").arg("--version").output().is_ok_and(|ran| ran.status.success());
    assert!(there || std::env::var_os("CI").is_none(), "script must be installed where CI is set");
    if !there {
        println!("skipped: script is not installed (util-linux)");
    }
    there
}

/// A command on a pseudo-terminal: what the terminal was sent.
fn on_a_terminal(arguments: &[&str]) -> String {
    let quoted: Vec<String> = [&[env!("CARGO_BIN_EXE_vpost")], arguments]
        .concat()
        .iter()
        .map(|argument| format!("'{argument}'"))
        .collect();
    let script = ["-q", "-e", "-c", &quoted.join(" "), "/dev/null"];
    let ran = Command::new("script").args(script).current_dir(root()).output().expect("script is there");
    let seen = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{seen}");
    seen
}

/// A call on a pseudo-terminal in a folder, with what somebody types there: its status, and what the terminal was sent.
fn answered(folder: &Path, call: &str, answers: &str) -> (Option<i32>, String) {
    let line = format!("'{}' {call}", env!("CARGO_BIN_EXE_vpost"));
    let mut script = Command::new("script")
        .args(["-q", "-e", "-c", &line, "/dev/null"])
        .current_dir(folder)
        .env("LC_ALL", "C")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("script is there");
    script.stdin.take().expect("piped").write_all(answers.as_bytes()).expect("answered");
    let ran = script.wait_with_output().expect("ended");
    (ran.status.code(), String::from_utf8_lossy(&ran.stdout).into_owned())
}

#[test]
fn success_is_one_line_for_eyes_and_none_for_pipes() {
    if !have_terminals() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    let arguments = [PROGRAM, "-m", PROFILE, "-o", out.to_str().expect("plain")];
    let seen = on_a_terminal(&arguments);
    assert_eq!(seen.lines().count(), 1, "{seen:?}");
    assert!(seen.starts_with("25 blocks in, 115 out, 6 split; largest correction "), "{seen:?}");
    assert_eq!(on_a_terminal(&[&arguments[..], &["-q"]].concat()), "");
    let piped = run(&arguments);
    assert!(piped.status.success() && piped.stdout.is_empty() && piped.stderr.is_empty());
}

/// A check of that many blocks takes seconds: the bar comes and goes, and the answer stands alone.
#[test]
fn long_work_shows_how_far_it_is() {
    if !have_terminals() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    let mut text = "G21 G90 G54\nG0 X10. Y10. Z60.\nG1 Z50. F200.\n".to_owned();
    for k in 0..250_000 {
        writeln!(text, "X{}.{:03} Y{}.", 10 + k % 90, k % 1000, 20 + k % 70).expect("memory");
    }
    std::fs::write(&program, text + "M30\n").expect("written");
    let program = program.to_str().expect("plain");
    let arguments = ["check", program, program, "-m", "machine-profiles/perfect.toml", "-d", "fanuc"];
    let seen = on_a_terminal(&arguments);
    assert!(seen.contains(" %  ") && seen.contains(" left"), "{:?}", seen.get(..300));
    let answer = seen.rsplit("\u{1b}[2K").next().expect("the bar was taken away");
    assert!(answer.ends_with("passed\r\n") && !answer.contains('%'), "{answer:?}");
    let piped = run(&arguments);
    // What is said is that the machine is perfect.
    let said = messages(&piped);
    assert!(
        piped.status.success() && said.starts_with("warning[VP0316]") && said.lines().count() == 2,
        "{said}"
    );
}

/// Five questions, a wrong answer among them, and Enter for the file.
#[test]
fn a_profile_is_asked_for() {
    if !have_terminals() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let answers = "Mill 5\nfanuk\nfanuc\n2\n0..500\n400..0\n-400..0\n-300..0\n\n";
    let (status, seen) = answered(folder.path(), "profile new --lang en", answers);
    assert_eq!(status, Some(0), "{seen}");
    for said in [
        "1. What is the machine called?",
        "one of these: ",
        "two numbers, the lesser first",
        "5. To which file?",
    ] {
        assert!(seen.contains(said), "{said} in {seen}");
    }
    let profile = std::fs::read_to_string(folder.path().join("mill_5.toml")).expect("written");
    for line in ["\"Mill 5\"", "\"fanuc\"", "[w b X Y Z t]", "[0, 500]", "[-400, 0]", "[-300, 0]"] {
        assert!(profile.contains(line), "{line} in {profile}");
    }
}

/// A call without a profile asks one question after the other, and keeps the answers where that is wanted.
#[test]
fn what_is_missing_is_asked_and_kept() {
    if !have_terminals() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy(&root().join("machine-profiles"), &folder.path().join("machine-profiles"));
    let program = "G21 G90 G17 G54\nG0 X10. Y10. Z50\nG1 Z1. F300\nG1 X100. Y80.\nM30\n";
    std::fs::write(folder.path().join("part.nc"), program).expect("writable");
    let asked = |call: &str, answers: &str| answered(folder.path(), call, answers);
    // Nobody answers: as in a pipe.
    let (status, seen) = asked("part.nc -o out.nc", "\n");
    assert_eq!(status, Some(2), "{seen}");
    assert!(
        seen.contains("Which machine?") && seen.contains("1  machine-profiles/generic_lathe.toml"),
        "{seen}"
    );
    let (status, seen) = asked("part.nc -o out.nc", "machine-profiles/generic_vmc.toml\n2\ny\n");
    assert_eq!(status, Some(0), "{seen}");
    let settings = std::fs::read_to_string(folder.path().join("vpost.toml")).expect("kept");
    assert_eq!(settings, "machine = \"machine-profiles/generic_vmc.toml\"\ndecimal = \"millimetres\"\n");
    // From now on nothing is asked.
    let by_answers = std::fs::read(folder.path().join("out.nc")).expect("written");
    let (status, seen) = asked("part.nc -o again.nc", "");
    assert!(status == Some(0) && !seen.contains("Which"), "{seen}");
    assert!(by_answers == std::fs::read(folder.path().join("again.nc")).expect("written"));
}
