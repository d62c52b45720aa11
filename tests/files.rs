//! What goes wrong with files: roles, links, permissions, pipes, changes, terminals.

#![cfg(unix)]

use std::io::Write;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::PathBuf;
use std::process::{Output, Stdio};
use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::common::{messages, root, run, vpost};

const PROFILE: &str = "machine-profiles/stan_s500.toml";
const GOOD: &str = "%\nG21 G90 G54\nG0 X10. Y10. Z60.\nG1 Z50. F200.\nX60. Y40.\nM30\n%\n";

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(place.path("part.nc"), GOOD).expect("written");
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn name(&self, name: &str) -> String {
        self.path(name).to_str().expect("a plain path").to_owned()
    }

    fn correct(&self, more: &[&str]) -> Output {
        run(&[&[self.name("part.nc").as_str(), "-m", PROFILE, "-d", "fanuc"], more].concat())
    }
}

fn refused(output: &Output, status: i32, code: &str) {
    assert_eq!(output.status.code(), Some(status), "{}", messages(output));
    assert!(messages(output).contains(code), "{}", messages(output));
}

#[test]
fn no_file_has_two_roles() {
    let place = Place::new();
    let table = root().join("machine-profiles/stan_s500.toml");
    let profile = place.name("mill.toml");
    let text = std::fs::read_to_string(&table).expect("there").replace("\"stan_s500/", "\"tables/");
    std::fs::write(&profile, text).expect("written");
    let tables = place.path("tables");
    std::fs::create_dir(&tables).expect("made");
    for entry in std::fs::read_dir(root().join("machine-profiles/stan_s500")).expect("there") {
        let entry = entry.expect("there");
        std::fs::copy(entry.path(), tables.join(entry.file_name())).expect("copied");
    }
    symlink("part.nc", place.path("link.nc")).expect("linked");
    std::fs::hard_link(place.path("part.nc"), place.path("hard.nc")).expect("linked");
    let table = place.name("tables/interferometer_x.csv");
    let (part, link, hard, new) =
        (place.name("part.nc"), place.name("link.nc"), place.name("hard.nc"), place.name("new.json"));
    for options in [
        ["-o", &part].as_slice(),
        &["-o", &link],
        &["-o", &hard],
        &["--summary", &part],
        &["-o", &profile],
        &["--summary", &profile],
        &["-o", &table],
        &["--summary", &table],
        &["-o", &new, "--summary", &new],
    ] {
        let before = std::fs::read(options[1]).ok();
        let ran = run(&[&[part.as_str(), "-m", &profile, "-d", "fanuc"], options].concat());
        refused(&ran, 2, "VP0004");
        assert_eq!(std::fs::read(options[1]).ok(), before, "{options:?}");
    }
}

#[test]
fn a_link_is_followed_and_a_file_keeps_its_permissions() {
    let place = Place::new();
    std::fs::write(place.path("real.nc"), "old\n").expect("written");
    for mode in [0o664, 0o600] {
        std::fs::set_permissions(place.path("real.nc"), std::fs::Permissions::from_mode(mode)).expect("set");
        for link in ["link.nc", "dangling.nc"] {
            let target = if link == "link.nc" { "real.nc" } else { "not_yet.nc" };
            let _ = symlink(target, place.path(link));
            let ran = place.correct(&["-o", &place.name(link)]);
            assert!(ran.status.success(), "{}", messages(&ran));
            assert!(place.path(link).symlink_metadata().expect("there").is_symlink());
            assert!(std::fs::read(place.path(target)).expect("there").ends_with(b"M30\n%\n"));
        }
        let kept = place.path("real.nc").metadata().expect("there").permissions().mode();
        assert_eq!(kept & 0o777, mode);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_or_full_standard_output_is_an_error() {
    let place = Place::new();
    let vpost = env!("CARGO_BIN_EXE_vpost");
    let part = place.name("part.nc");
    for (to, status) in [(">&-", 1), (">/dev/full", 1), (">/dev/null", 0)] {
        for command in [format!("{part} -m {PROFILE} -d fanuc"), "grammar list".to_owned()] {
            let script = format!("{vpost} {command} {to}");
            let ran = std::process::Command::new("sh").current_dir(root()).args(["-c", &script]).output();
            let ran = ran.expect("starts");
            assert_eq!(ran.status.code(), Some(status), "{script}: {}", messages(&ran));
        }
    }
}

/// A writer is still at work: half a program must not be corrected as a whole one.
#[test]
fn a_program_that_changes_while_it_is_read_is_refused() {
    let place = Place::new();
    let mut program = GOOD.replace("M30\n%\n", "").into_bytes();
    for k in 0..400_000 {
        writeln!(program, "X{}.{:03} Y{}.", 10 + k % 90, k % 1000, 20 + k % 70).expect("memory");
    }
    std::fs::write(place.path("part.nc"), &program).expect("written");
    let out = place.path("out.nc");
    let mut file = std::fs::File::options().append(true).open(place.path("part.nc")).expect("there");
    let (at_work, written) = (AtomicBool::new(true), Barrier::new(2));
    let ran = std::thread::scope(|scope| {
        scope.spawn(|| {
            file.write_all(b"X50. Y50.\n").expect("written");
            written.wait();
            // From before the program is opened until the command has ended: no moment of either is told by a clock.
            while at_work.load(Ordering::Relaxed) {
                file.write_all(b"X50. Y50.\n").expect("written");
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        written.wait();
        let ran = run(&[&place.name("part.nc"), "-m", PROFILE, "-d", "fanuc", "-o", &place.name("out.nc")]);
        at_work.store(false, Ordering::Relaxed);
        ran
    });
    refused(&ran, 1, "VP0003");
    assert!(!out.exists());
}

/// Nobody writes to the pipe, nobody reads from it: the command waits, and ends when it is told to.
#[test]
fn signals_end_a_wait_for_a_pipe() {
    let place = Place::new();
    let pipe = place.name("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|made| made.success()));
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        for input in [pipe.as_str(), "-"] {
            let mut child = vpost()
                .args([input, "-m", PROFILE, "-d", "fanuc"])
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("starts");
            // Waiting for the end would close it.
            let _held = child.stdin.take();
            std::thread::sleep(Duration::from_millis(500));
            let told = Instant::now();
            let kill = ["-s", signal, &child.id().to_string()].map(str::to_owned);
            assert!(std::process::Command::new("kill").args(kill).status().is_ok_and(|sent| sent.success()));
            assert_eq!(child.wait().expect("ends").code(), Some(status), "{input}");
            assert!(told.elapsed() < Duration::from_secs(10));
        }
    }
}

#[test]
fn a_terminal_obeys_nothing_of_others() {
    let place = Place::new();
    let evil = "part\u{1b}[2J\u{202e}.nc";
    std::fs::write(place.path(evil), "G21 G90\n(\u{1b}]0;owned\u{7}) G1 X1E5 \u{9b}2J\n").expect("written");
    let ran = run(&[&place.name(evil), "-m", PROFILE, "-d", "fanuc"]);
    assert_eq!(ran.status.code(), Some(1));
    let said = messages(&ran);
    assert!(said.contains("\\u001b[2J\\u202e.nc"), "{said}");
    assert!(!said.contains(['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}']), "{said:?}");
}

/// Whoever calls a subprogram must find it again.
#[test]
fn a_subprogram_is_not_written_over() {
    let place = Place::new();
    std::fs::create_dir(place.path("subs")).expect("made");
    std::fs::write(place.path("subs/O2000.nc"), "O2000\nM99\n").expect("written");
    let (folder, sub) = (place.name("subs"), place.name("subs/O2000.nc"));
    refused(&place.correct(&["--include", &folder, "-o", &sub]), 2, "VP0004");
}

#[test]
fn a_link_that_leads_in_a_circle_is_an_error() {
    let place = Place::new();
    symlink("circle.nc", place.path("circle.nc")).expect("linked");
    refused(&place.correct(&["-o", &place.name("circle.nc")]), 1, "VP0001");
    assert!(place.path("circle.nc").is_symlink());
}

/// What was typed, or what a script put there, gives no orders either.
#[test]
fn quoted_options_give_no_orders() {
    let ran = run(&["part.nc", "--tolerance", "\u{1b}[2J\u{202e}"]);
    assert_eq!(ran.status.code(), Some(2));
    let said = messages(&ran);
    assert!(said.contains("--tolerance") && !said.contains(['\u{1b}', '\u{202e}']), "{said:?}");
}

/// Outputs stay in their folder, and vpost's own files are its own.
#[test]
fn batch_follows_no_link_out_of_its_folder() {
    for link in [".vpost", ".vpost/tmp", ".vpost/journal", ".vpost/lock", "op10"] {
        let place = Place::new();
        for folder in ["in/op10", "out/.vpost", "elsewhere"] {
            std::fs::create_dir_all(place.path(folder)).expect("made");
        }
        std::fs::write(place.path("in/op10/part.nc"), GOOD).expect("written");
        std::fs::write(place.path("elsewhere/precious"), "").expect("written");
        if link == ".vpost" {
            std::fs::remove_dir(place.path("out/.vpost")).expect("empty");
        }
        symlink(place.path("elsewhere"), place.path("out").join(link)).expect("linked");
        let ran = run(&["batch", &place.name("in"), "-m", PROFILE, "-d", "fanuc", "-O", &place.name("out")]);
        refused(&ran, 2, "VP1012");
        let left = std::fs::read_dir(place.path("elsewhere")).expect("there").count();
        assert_eq!(left, 1, "{link}");
    }
}
