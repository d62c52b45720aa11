//! Programs too large to be held in memory at once: the same bytes for any number of threads, nothing half done.

use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::{messages, vpost};

const PROFILE: &str = "machine-profiles/stan_s500.toml";

/// About five megabytes: surfaces with arcs, holes and increments in between; more chunks than any machine has threads.
fn program(ending: &str) -> String {
    let mut text =
        "%\nO1000\n(LARGE)\nG17 G21 G40 G49 G80 G90 G54\nT1 M6\nG43 H1\nG0 X0. Y0. Z30.\n".to_owned();
    let mut line = 0_u32;
    while text.len() < 5_000_000 {
        let mut row = |text: &mut String, y: i32| {
            for step in 0..400 {
                line += 1;
                let x = (step - 200) * 600;
                let z = 8_000 + (step * step + y) % 997;
                let _ = writeln!(text, "X{:.3} Y{:.3} Z{:.3}", milli(x), milli(y + step % 7), milli(z));
            }
        };
        text.push_str("G0 Z20.\nG1 Z10. F900\n");
        (0..20).for_each(|k| row(&mut text, -60_000 + k * 5_000));
        text.push_str("(POCKET)\nG1 X10. Y0.\nG3 X-10. Y0. I-10. J0.\nG3 X10. Y0. I10. J0.\n");
        text.push_str(
            "G91\nG1 X.5 Y.25\nX-.5\nG90\nG0 Z25.\nG81 X5. Y5. Z3. R12. F100\nX15.\nG80\nG1 Z12. F600\n",
        );
    }
    text.push_str(ending);
    text
}

fn milli(value: i32) -> f64 {
    f64::from(value) / 1000.0
}

struct Place(tempfile::TempDir);

impl Place {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("in.nc"), text).expect("written");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, threads: usize, profile: &str) -> Command {
        let mut command = vpost();
        command.env("RAYON_NUM_THREADS", threads.to_string());
        command.args(["-m", profile, "-d", "fanuc"]);
        command
    }

    fn correct(&self, threads: usize, profile: &str, more: &[&str]) -> Output {
        self.command(threads, profile)
            .arg(self.path("in.nc"))
            .args(more)
            .output()
            .expect("the command starts")
    }
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("readable")
}

fn succeeded(ran: &Output) {
    assert!(ran.status.success(), "{}", messages(ran));
}

/// A summary without the input's name.
fn summary(path: &Path) -> String {
    let text = String::from_utf8(read(path)).expect("text");
    text.lines().filter(|line| !line.contains("\"name\"")).collect()
}

#[test]
fn threads_and_pipes_change_no_byte() {
    let place = Place::new(&program("G0 Z30.\nM30\n%\n"));
    let (out, told) = (place.path("out.nc"), place.path("out.json"));
    let arguments = ["-o", out.to_str().expect("plain"), "--summary", told.to_str().expect("plain")];
    succeeded(&place.correct(1, PROFILE, &arguments));
    let (expected, figures) = (read(&out), summary(&told));
    assert!(expected.starts_with(b"%\nO1000\n(CORRECTED BY VPOST "), "the mark stands in its place");
    assert_eq!(expected.windows(18).filter(|w| *w == b"CORRECTED BY VPOST").count(), 1);
    for threads in [2, 5] {
        succeeded(&place.correct(threads, PROFILE, &arguments));
        assert!(read(&out) == expected, "{threads} threads");
        assert_eq!(summary(&told), figures, "{threads} threads");
    }
    // From a pipe to a pipe.
    let mut child = place
        .command(2, PROFILE)
        .args(["-", "--summary", told.to_str().expect("plain")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the command starts");
    child.stdin.take().expect("a pipe").write_all(&read(&place.path("in.nc"))).expect("taken");
    let ran = child.wait_with_output().expect("it ends");
    assert!(ran.status.success() && ran.stdout == expected);
    assert_eq!(summary(&told), figures);
    // Once only.
    std::fs::rename(&out, place.path("in.nc")).expect("renamed");
    let ran = place.correct(2, PROFILE, &[]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(messages(&ran).contains("VP0505") && messages(&ran).contains("in.nc:3:"), "{}", messages(&ran));
}

#[test]
fn a_machine_without_errors_changes_no_byte() {
    let place = Place::new(&program("G0 Z30.\nM30\n%\n"));
    let ran = place.correct(2, "machine-profiles/perfect.toml", &[]);
    succeeded(&ran);
    assert!(ran.stdout == read(&place.path("in.nc")));
}

#[test]
fn a_refusal_at_the_end_names_its_line_and_leaves_the_output() {
    let text = program("G1 X10. Y20.\nG1 X10. Y20. Q1.5.5\nM30\n%\n");
    let line = text.lines().count() - 2;
    let place = Place::new(&text);
    let out = place.path("out.nc");
    std::fs::write(&out, "as it was").expect("written");
    let ran = place.correct(3, PROFILE, &["-o", out.to_str().expect("plain")]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(messages(&ran).contains(&format!("in.nc:{line}:14")), "{}", messages(&ran));
    assert_eq!(read(&out), b"as it was");
    let ran = place.correct(3, PROFILE, &[]);
    assert!(ran.status.code() == Some(1) && ran.stdout.is_empty());
    let left: Vec<_> = std::fs::read_dir(place.0.path()).expect("readable").collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn a_program_that_computes_is_worked_on_as_a_whole() {
    let place = Place::new(&program("#1=12.5\nG1 X#1 Y0.\nM30\n%\n"));
    let ran = place.correct(2, PROFILE, &[]);
    succeeded(&ran);
    let text = String::from_utf8(ran.stdout).expect("text");
    assert!(text.contains("PROGRAM FLOW EXPANDED") && text.contains("(#1=12.5)"));
    let place = Place::new(&program("#1=12.5\nG1 X#2 Y0.\nM30\n%\n"));
    let ran = place.correct(2, PROFILE, &[]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(ran.stdout.is_empty() && messages(&ran).contains("G1 X#2 Y0."), "{}", messages(&ran));
}

/// Corners and polar words, written out in chunks: what a small program becomes, its messages and figures.
#[test]
fn shorthand_of_a_large_program_is_that_of_a_small_one() {
    let mut text = "%\nO1000\nG17 G21 G40 G49 G80 G90 G54\nT1 M6\nG43 H1\nG0 X0. Y0. Z30.\n".to_owned();
    for k in 0..12_000 {
        let (x, y) = (milli(30_000 + k % 977), milli(25_000 + k % 1013));
        let _ = write!(
            text,
            "G1 X-{x:.3} Y-{y:.3} Z5. F900\nX{x:.3} ,R2.\n(WALL {k})\nY{y:.3},C1.5\nX-{x:.3}\nY{:.3}\n",
            -y + 3.0
        );
        if k % 1000 == 7 {
            text.push_str("G16\nG1 X20. Y30.\nY75.\nG15\nG0 X400. Y0. Z30.\nG0 X0. Y0.\n");
        }
    }
    text.push_str("G0 Z30.\nM30\n%\n");
    let trailer = "(BEHIND THE PROGRAM)\n".repeat(200_000);
    for profile in [PROFILE, "machine-profiles/perfect.toml"] {
        let run = |text: &str| {
            let place = Place::new(text);
            let told = place.path("out.json");
            let ran = place.correct(2, profile, &["--summary", told.to_str().expect("plain")]);
            succeeded(&ran);
            let mut told: serde_json::Value = serde_json::from_slice(&read(&told)).expect("JSON");
            // The trailer is read and written as well.
            for figure in ["input", "output", "blocks_in", "blocks_out"] {
                told.as_object_mut().expect("an object").remove(figure);
            }
            let said = messages(&ran).replace(place.0.path().to_str().expect("plain"), "");
            (String::from_utf8(ran.stdout).expect("text"), told.to_string(), said)
        };
        let (small, large) = (run(&text), run(&format!("{text}{trailer}")));
        assert!(large.0.strip_suffix(&trailer) == Some(&small.0), "{profile}");
        assert_eq!(small.0 == text, profile != PROFILE);
        assert_eq!((&small.1, &small.2), (&large.1, &large.2), "{profile}");
    }
}

#[test]
fn warnings_show_their_line() {
    let text = program("G0 X400. Y0. Z30.\nG0 X0. Y0.\nM30\n%\n");
    let line = text.lines().count() - 3;
    let place = Place::new(&text);
    let ran = place.correct(2, PROFILE, &[]);
    succeeded(&ran);
    let said = messages(&ran);
    assert!(said.contains("VP0507") && said.contains(&format!("in.nc:{line}:1")), "{said}");
    assert!(said.contains("G0 X400. Y0. Z30."), "{said}");
}

/// Killed at any moment, nothing half done stands under the final name, and the next run is not disturbed.
#[test]
fn killed_twenty_times_it_leaves_nothing_half_done() {
    let place = Place::new(&program("G0 Z30.\nM30\n%\n"));
    let out = place.path("out.nc");
    let started = Instant::now();
    succeeded(&place.correct(2, PROFILE, &["-o", out.to_str().expect("plain")]));
    let whole = started.elapsed();
    let expected = read(&out);
    let mut killed = 0;
    for round in 0..20_u32 {
        if round % 2 == 0 {
            std::fs::remove_file(&out).expect("removed");
        } else {
            std::fs::write(&out, "as it was").expect("written");
        }
        let mut child = place
            .command(2, PROFILE)
            .arg(place.path("in.nc"))
            .arg("-o")
            .arg(&out)
            .spawn()
            .expect("the command starts");
        // Moments all over the run, in no order: multiples of the golden section.
        let share = (f64::from(round) * 0.618_034) % 1.0;
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * share));
        child.kill().expect("killed");
        killed += u32::from(!child.wait().expect("it ends").success());
        match std::fs::read(&out) {
            Ok(found) => assert!(found == expected || (round % 2 == 1 && found == b"as it was"), "{round}"),
            Err(_) => assert_eq!(round % 2, 0, "an output that was there is gone"),
        }
        if !out.exists() {
            std::fs::write(&out, "as it was").expect("written");
        }
    }
    assert!(killed > 0, "every run had ended before it was killed");
    succeeded(&place.correct(2, PROFILE, &["-o", out.to_str().expect("plain")]));
    assert!(read(&out) == expected);
}
