//! Programs with variables, loops and subprograms, through the command.

use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::{files, have_interpreter, messages, referee, root, run, vpost};

const CROOKED: &str = "tests/profiles/corpus.toml";
const PERFECT: &str = "machine-profiles/perfect.toml";
/// Generous against a busy machine; the release build needs a tenth.
const SOON: Duration = Duration::from_secs(120);

/// A folder with files.
struct Place(tempfile::TempDir);

impl Place {
    fn new(contents: &[(&str, &str)]) -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        for (name, text) in contents {
            let path = place.0.path().join(name);
            std::fs::create_dir_all(path.parent().expect("in a folder")).expect("writable");
            std::fs::write(path, text).expect("writable");
        }
        place
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join(name)).expect("readable")
    }

    /// Corrects `part.nc` to `out.nc`.
    fn correct(&self, dialect: &str, profile: &str, more: &[&str]) -> Output {
        let (part, out) = (self.path("part.nc"), self.path("out.nc"));
        run(&[&[part.as_str(), "-m", profile, "-d", dialect, "-o", out.as_str()], more].concat())
    }

    fn check(&self, dialect: &str, more: &[&str]) -> Output {
        let (part, out) = (self.path("part.nc"), self.path("out.nc"));
        run(&[&["check", part.as_str(), out.as_str(), "-m", CROOKED, "-d", dialect], more].concat())
    }
}

const HEAD: &str = "G17 G21 G40 G49 G54 G80 G90\nG0 X10. Y10. Z60.\n";

#[test]
fn a_machine_without_errors_leaves_flow_as_it_is() {
    let mut count = 0;
    for dialect in ["fanuc", "linuxcnc"] {
        for path in files(&root().join("tests/corpus").join(dialect).join("accept"), &["nc"]) {
            let text = std::fs::read(&path).expect("readable");
            if !text.contains(&b'#') && !text.windows(3).any(|w| w == b"M98" || w == b"G65") {
                continue;
            }
            let path = path.to_str().expect("a plain path");
            let offsets = ["--work-offset", "G54=100,80,40", "--work-offset", "G55=110,75,41"];
            let ran = run(&[&[path, "-m", PERFECT, "-d", dialect], &offsets[..]].concat());
            assert!(ran.status.success(), "{path}: {}", messages(&ran));
            assert!(ran.stdout == text, "{path} was changed");
            count += 1;
        }
    }
    assert!(count > 15, "only {count} programs with flow");
}

#[test]
fn the_output_says_that_it_was_expanded_and_the_source_stays_readable() {
    let text = format!(
        "%\nO0001\n{HEAD}#1=20.\nG1 X#1 F200.\nM98 P1000 L2\nG0 Z60.\nM30\nO1000\nN10 G91 Y1.\nG90\nM99\n%\n"
    );
    let place = Place::new(&[("part.nc", &text)]);
    let ran = place.correct("fanuc", CROOKED, &[]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let out = place.read("out.nc");
    for part in
        ["CORRECTED BY VPOST", "PROGRAM FLOW EXPANDED", "(#1=20.)", "(G1 X#1 F200.)", "(O1000 CALL 2 OF 2)"]
    {
        assert!(out.contains(part), "{part} is not in\n{out}");
    }
    assert!(
        !out.lines().any(|line| !line.starts_with('(') && (line.contains('#') || line.contains("M98"))),
        "{out}"
    );
    assert_eq!(out.matches("O1000").count(), 2, "the calls' comments only:\n{out}");
    let check = place.check("fanuc", &[]);
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
    // Once only, as every program.
    let again = run(&[&place.path("out.nc"), "-m", CROOKED, "-d", "fanuc"]);
    assert!(messages(&again).contains("VP0505"), "{}", messages(&again));
}

#[test]
fn check_sees_one_wrong_turn_of_a_loop() {
    let text = format!("{HEAD}#1=0\nWHILE[#1LT3]DO1\nG1 X[20+#1*10] Y[20+#1] F200.\n#1=#1+1\nEND1\nM30\n");
    let place = Place::new(&[("part.nc", &text)]);
    assert!(place.correct("fanuc", CROOKED, &[]).status.success());
    assert!(place.check("fanuc", &[]).status.success());
    // The last turn taken out of the output.
    let out = place.read("out.nc");
    let last = out
        .lines()
        .rfind(|line| line.starts_with("G1") || line.starts_with('X'))
        .expect("a motion")
        .to_owned();
    std::fs::write(place.path("out.nc"), out.replace(&last, "(gone)")).expect("writable");
    let check = place.check("fanuc", &[]);
    assert_eq!(check.status.code(), Some(1));
    assert!(
        String::from_utf8_lossy(&check.stdout).contains("missing"),
        "{}",
        String::from_utf8_lossy(&check.stdout)
    );
}

#[test]
fn values_come_from_the_command_line() {
    let text = format!("{HEAD}G1 X#500 Y[#501*2] F200.\nM30\n");
    let place = Place::new(&[("part.nc", &text)]);
    let refused = place.correct("fanuc", CROOKED, &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(messages(&refused).contains("--set \"#500=12.5\""), "{}", messages(&refused));
    let more = ["--set", "#500=12.5", "--set", "#501=-3"];
    let ran = place.correct("fanuc", CROOKED, &more);
    assert!(ran.status.success(), "{}", messages(&ran));
    assert!(place.check("fanuc", &more).status.success());
    let bad = place.correct("fanuc", CROOKED, &["--set", "500=1"]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(messages(&bad).contains("VP0002") && messages(&bad).contains("help:"), "{}", messages(&bad));
}

#[test]
fn subprograms_come_from_named_folders_and_from_nowhere_else() {
    let text = format!("{HEAD}o<pocket> call [30] [20]\nM2\n");
    let sub = "o<pocket> sub\nG1 X#1 F200\nG1 Y#2\no<pocket> endsub\nM2\n";
    let place = Place::new(&[("part.nc", &text), ("pocket.ngc", "never read"), ("subs/pocket.ngc", sub)]);
    let alone = place.correct("linuxcnc", CROOKED, &[]);
    assert!(
        messages(&alone).contains("VP0127") && messages(&alone).contains("--include"),
        "{}",
        messages(&alone)
    );
    let subs = place.path("subs");
    let more = ["--include", subs.as_str()];
    let ran = place.correct("linuxcnc", CROOKED, &more);
    assert!(ran.status.success(), "{}", messages(&ran));
    assert!(place.check("linuxcnc", &more).status.success());
    // A fault in the other file is told with its name and line.
    std::fs::write(place.path("subs/pocket.ngc"), sub.replace("Y#2", "Y[#2/0]")).expect("writable");
    let said = messages(&place.correct("linuxcnc", CROOKED, &more));
    assert!(said.contains("VP0122") && said.contains("pocket.ngc:3:1"), "{said}");
    std::fs::write(place.path("subs/pocket.ngc"), sub.replace("F200", "")).expect("writable");
    std::fs::write(place.path("subs/pocket.ngc"), sub.replace("G1 Y#2", "G33.1 Z-#2 K1")).expect("writable");
    let said = messages(&place.correct("linuxcnc", CROOKED, &more));
    assert!(said.contains("VP0208") && said.contains("pocket.ngc:3:1"), "{said}");
    let missing = place.correct("linuxcnc", CROOKED, &["--include", "no/such/folder"]);
    assert_eq!(missing.status.code(), Some(2), "{}", messages(&missing));
}

#[test]
#[cfg(unix)]
fn no_name_and_no_link_leads_out_of_the_folder() {
    let sub = "o<pocket> sub\nG1 X20 F200\no<pocket> endsub\nM2\n";
    let place = Place::new(&[("elsewhere/pocket.ngc", sub), ("subs/other.ngc", sub)]);
    let subs = place.path("subs");
    std::os::unix::fs::symlink(place.path("elsewhere/pocket.ngc"), place.path("subs/pocket.ngc"))
        .expect("links");
    for name in ["pocket", "../elsewhere/pocket", "/etc/passwd", ".hidden"] {
        std::fs::write(place.path("part.nc"), format!("{HEAD}o<{name}> call\nM2\n")).expect("writable");
        let ran = place.correct("linuxcnc", CROOKED, &["--include", &subs]);
        assert_eq!(ran.status.code(), Some(1), "{name}");
        assert!(messages(&ran).contains("VP0128"), "{name}: {}", messages(&ran));
        assert!(!Path::new(&place.path("out.nc")).exists(), "{name}");
    }
}

#[test]
fn programs_without_end_are_refused_soon() {
    let bomb: String = (2..10).map(|n| format!("O{n}\nG1 X{n}0. F200.\nM98 P{} L99\nM99\n", n + 1)).collect();
    let programs = [
        (
            "fanuc",
            format!("{HEAD}#1=0\nWHILE[#1LT1000000000000]DO1\nG1 X[20+#1] F200.\n#1=#1+0\nEND1\nM30\n"),
            "VP0130",
        ),
        ("linuxcnc", format!("{HEAD}o1 repeat [1000000000000]\n#1=1\no1 endrepeat\nM2\n"), "VP0130"),
        ("fanuc", format!("{HEAD}M98 P2 L99\nM30\n{bomb}O10\nG1 X1. F200.\nM99\n"), "VP013"),
        ("fanuc", format!("{HEAD}G1 X{}1{} F200.\nM30\n", "[".repeat(30_000), "]".repeat(30_000)), "VP0120"),
        (
            "fanuc",
            format!("{HEAD}G1 X{}1{} F200.\nM30\n", "[".repeat(1_000_000), "]".repeat(1_000_000)),
            "VP0106",
        ),
    ];
    for (dialect, text, code) in programs {
        let place = Place::new(&[("part.nc", &text)]);
        let start = Instant::now();
        let ran = place.correct(dialect, CROOKED, &[]);
        let took = start.elapsed();
        let said = messages(&ran);
        assert!(
            ran.status.code() == Some(1) && said.contains(code),
            "{code}: {}",
            said.chars().take(500).collect::<String>()
        );
        assert!(took < SOON, "{code}: {took:?}");
        assert!(said.len() < 10_000, "{code}: a message of {} bytes", said.len());
    }
}

/// A gigabyte without a line end: given up at the first megabyte, whatever follows.
#[test]
fn a_line_without_end_is_not_read_to_its_end() {
    let mut child = vpost()
        .args(["-", "-m", CROOKED, "-d", "fanuc"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut input = child.stdin.take().expect("a pipe");
    let start = Instant::now();
    let part = b"G1 X1. ".repeat(10_000);
    let mut written = 0_u64;
    // The command closes its end once it has seen enough.
    while written < 1 << 30 && input.write_all(&part).is_ok() {
        written += part.len() as u64;
    }
    drop(input);
    let ran = child.wait_with_output().expect("it ends");
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    assert!(written < 16 << 20, "{written} bytes were taken");
    assert_eq!(ran.status.code(), Some(1));
    assert!(ran.stdout.is_empty() && messages(&ran).contains("VP0106"), "{}", messages(&ran));
}

/// LinuxCNC's interpreter runs the program with its flow, and the corrected one without: the second judge.
#[test]
fn the_second_judge_agrees_on_programs_with_flow() {
    if !have_interpreter() {
        return;
    }
    let programs = [
        "o<slot> sub\nG0 X#1 Y#2\nG1 Z55 F100\nG1 X[#1+#3]\nG0 Z60\no<slot> endsub\no<slot> call [20] [20] [15]\no<slot> call [20] [40] [25]\nG0 X10 Y10\nM2\n",
        "#<n>=0\no1 while [#<n> LT 12]\nG1 X[40+20*COS[#<n>*30]] Y[40+12*SIN[#<n>*30]] Z[58-#<n>/4] F300\n#<n>=[#<n>+1]\no1 endwhile\nG0 Z60\nM2\n",
        "#<n>=0\no1 repeat [4]\nG2 X40 Y30 I-10 J0 Z[58-#<n>*2] F200\n#<n>=[#<n>+1]\no1 endrepeat\nG0 Z60\nM2\n",
    ];
    for (number, body) in programs.iter().enumerate() {
        let text = format!("G17 G21 G40 G49 G54 G80 G90\nG0 X40 Y30 Z60\n{body}");
        let place = Place::new(&[("part.nc", &text)]);
        let ran = place.correct("linuxcnc", CROOKED, &[]);
        assert!(ran.status.success(), "{number}: {}", messages(&ran));
        let verdict = referee(
            Path::new(&place.path("part.nc")),
            Path::new(&place.path("out.nc")),
            CROOKED,
            "linuxcnc",
            &[],
        );
        assert_eq!(
            verdict["ok"],
            serde_json::Value::Bool(true),
            "{number}: {verdict:#}\n{}",
            place.read("out.nc")
        );
        // The judge can fail: as it was, the program leaves its path on this machine.
        let part = place.path("part.nc");
        let verdict = referee(Path::new(&part), Path::new(&part), CROOKED, "linuxcnc", &[]);
        assert_eq!(verdict["ok"], serde_json::Value::Bool(false), "{number}: {verdict:#}");
    }
}
