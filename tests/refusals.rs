//! Bad input: a clear error, no output, the right exit status, and an earlier output left alone.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use crate::common::{messages, root, run, vpost};

const PROFILE: [&str; 2] = ["-m", "machine-profiles/stan_s500.toml"];
const GOOD: &str = "G21 G17 G90 G54\nG0 X10. Y10. Z20.\nG1 X50. F500.\nM30\n";

struct Trial {
    folder: tempfile::TempDir,
}

impl Trial {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }
    fn file(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    }
    /// Runs on a program; the messages with the folder's name taken out.
    fn refused(&self, program: &[u8], more: &[&str]) -> String {
        let path = self.file("part.nc", program);
        self.refused_path(&path, more)
    }
    fn refused_path(&self, path: &str, more: &[&str]) -> String {
        let ran = run(&[&[path], &PROFILE[..], more].concat());
        assert!(ran.stdout.is_empty(), "something was written");
        let code = ran.status.code().expect("an exit status");
        assert!(code == 1 || code == 2, "exit status {code}");
        let said = messages(&ran).replace(self.folder.path().to_str().expect("plain"), "");
        format!("exit status {code}\n{said}")
    }
}

#[test]
fn a_feed_outside_the_volume() {
    insta::assert_snapshot!(Trial::new().refused(b"G21 G90\nG0 X0 Y0 Z50.\nG1 X300. F100.\n", &[]), @"
    exit status 1
    error[VP0501]: this feed motion leaves the calibrated volume
     --> /part.nc:3:4
      |
    3 | G1 X300. F100.
      |    ^^^^^ axis X would be commanded to 440.133 mm, calibrated is 0 to 400 mm
      |
    help: place the workpiece inside the volume: `--work-offset` with X moved by -40.133 mm or further, or accept the nearest point's correction with `--outside clamp`
    ");
}

#[test]
fn a_number_that_is_none() {
    insta::assert_snapshot!(Trial::new().refused(b"G21 G90\nG0 Xnan Y0\n", &[]), @"
    exit status 1
    error[VP0101]: `Xnan` is not a number a control reads
     --> /part.nc:2:4
      |
    2 | G0 Xnan Y0
      |    ^^^^ expected a sign, digits and one decimal point
      |
    help: write it like `X-12.5`: no exponent, one sign, a point and not a comma
    ");
}

#[test]
fn an_arc_that_cannot_be() {
    insta::assert_snapshot!(Trial::new().refused(b"G21 G90\nG0 X4. Y3. Z20.\nN20 G2 X10. Y0. R0.1\n", &[]), @"
    exit status 1
    error[VP0203]: arc radius is smaller than half the chord
     --> /part.nc:3:17
      |
    3 | N20 G2 X10. Y0. R0.1
      |                 ^^^^ R0.1 mm, chord is 6.7082 mm
      |
    help: use I/J centre form, or R of at least 3.3542
    ");
}

#[test]
fn the_faulty_arc_of_a_real_post() {
    insta::assert_snapshot!(Trial::new().refused_path("samples/plate_fanuc.nc", &["-d", "fanuc"]), @"
    exit status 1
    error[VP0204]: arc without centre
       --> samples/plate_fanuc.nc:148:4
        |
    148 | G3 X51.853 Y49.000
        |    ^^^^^^^^^^^^^^^ neither I/J nor R in this block, and neither is modal
        |
    help: post the program again so that each arc block has its I and J (some posts drop unchanged ones), or add R
    ");
}

#[test]
fn a_tool_the_profile_lacks() {
    insta::assert_snapshot!(Trial::new().refused(b"G21 G90\nG43 H7\nG0 X0 Y0 Z10.\n", &[]), @"
    exit status 1
    error[VP0215]: tool length H7 is not given
     --> /part.nc:2:5
      |
    2 | G43 H7
      |     ^^ given by no profile, file or option
      |
    help: `--tool H7=120` for a length of 120 mm, or `lengths_mm = { H7 = 120.0 }` under `[tool]` in the profile
    ");
}

#[test]
fn a_work_offset_the_profile_lacks() {
    insta::assert_snapshot!(Trial::new().refused(b"G21 G90 G57\nG0 X0 Y0 Z10.\n", &[]), @"
    exit status 1
    error[VP0214]: work offset G57 is not given
     --> /part.nc:1:9
      |
    1 | G21 G90 G57
      |         ^^^ given by no profile, file or option
      |
    help: `--work-offset G57=X,Y,Z` with the machine coordinates of the program's zero, or `G57 = [X, Y, Z]` under `[work_offsets_mm]` in the profile
    ");
}

/// All that a program is refused for by itself is told at once, each with what settles it; what only follows from a refused block
/// is not: behind `G43 H7` nobody knows where Z stands, and that is no fault of the program.
#[test]
fn all_refusals_at_once() {
    let program = b"G21 G90 G54\nG43 H7 Z50.\nG1 X10. F100.\nG12.1\nG55\nG12.1\nG68.9\nG12.1\nG0 X+-3\nM30\n";
    let said = Trial::new().refused(program, &[]);
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error")).collect();
    insta::assert_snapshot!(errors.join("\n"), @"
    error[VP0215]: tool length H7 is not given
    error[VP0207]: G12.1 is not in the table of dialect perspektiva
    error[VP0214]: work offset G55 is not given
    error[VP0207]: G68.9 is not in the table of dialect perspektiva
    error[VP0101]: `X+-3` is not a number a control reads
    ");
    assert!(said.contains("2 more blocks like it"), "{said}");
    assert_eq!(said.matches("help:").count(), errors.len());
    // Remarks in a form that the control has not: other words in every block, and one way out.
    let remarks = b"G21 G90 G54; METRIC\nG0 X0 Y0 Z50.; rapid\nG1 X10. F100.; cut\nM30\n";
    let said = Trial::new().refused(remarks, &["-d", "fanuc"]);
    assert!(said.matches("error[").count() == 1 && said.contains("2 more blocks like it"), "{said}");
}

const PLAIN: &str = "format = 1\nname = \"Square\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n[axis.X]\ntravel_mm = [-500, 500]\n\
    [axis.Y]\ntravel_mm = [-500, 500]\n[axis.Z]\ntravel_mm = [-500, 500]\n[squareness]\nEC0Y_urad = 60.0\n";

/// What the help of a refusal says to write under a section, between its first backquotes.
fn written<'s>(said: &'s str, section: &str) -> &'s str {
    let line =
        said.lines().find(|line| line.contains(section)).unwrap_or_else(|| panic!("{section}: {said}"));
    line.split('`').nth(1).expect("an entry")
}

/// Lengths that the profile lacks are one refusal, and so are zeros: two entries mend the program.
#[test]
fn what_one_table_of_the_profile_settles_is_one_refusal() {
    let trial = Trial::new();
    let mut program = String::from("G21 G90 G17 G40 G80\n");
    for (tool, zero) in [(1, "G54"), (2, "G54"), (7, "G55"), (2, "G57")] {
        write!(program, "T{tool} M6\n{zero}\nG0 G43 H{tool} Z50.\nX0. Y0.\nG1 Z10. F200.\nX40.\n")
            .expect("a text");
    }
    let part = trial.file("part.nc", format!("{program}M30\n").as_bytes());
    let bare = trial.file("bare.toml", PLAIN.as_bytes());
    let ran = run(&[&part, "-m", &bare]);
    let said = messages(&ran);
    assert_eq!((ran.status.code(), said.matches("error[").count()), (Some(1), 2), "{said}");
    let lengths = written(&said, "`[tool]`");
    assert_eq!(lengths, "lengths_mm = { H1 = 120.0, H2 = 120.0, H7 = 120.0 }");
    assert!(said.contains("one more block like it"), "H2 twice: {said}");
    let offsets = said.lines().find(|line| line.contains("`[work_offsets_mm]`")).expect("offsets");
    let offsets: Vec<&str> = offsets.split('`').filter(|part| part.starts_with('G')).collect();
    assert_eq!(offsets, ["G54 = [X, Y, Z]", "G55 = [X, Y, Z]", "G57 = [X, Y, Z]"]);
    // What it says to write mends the program.
    let offsets = offsets.join("\n").replace("[X, Y, Z]", "[0, 0, 0]");
    let mended = format!("{PLAIN}[tool]\n{lengths}\n[work_offsets_mm]\n{offsets}\n");
    let ran = run(&[&part, "-m", &trial.file("mended.toml", mended.as_bytes())]);
    assert!(ran.status.success(), "{}", messages(&ran));
}

/// `vpost batch` sums refusals by what settles them: one entry of the profile for all programs.
#[test]
fn a_batch_says_what_mends_it() {
    let trial = Trial::new();
    let programs = trial.folder.path().join("release");
    std::fs::create_dir(&programs).expect("a folder");
    for (name, tool) in [("a", 1), ("b", 2), ("c", 2)] {
        let text = format!(
            "G21 G90 G17 G54\nT{tool} M6\nG0 G43 H{tool} Z50.\nG1 Z10. F200.\nG0 X0. Y0.\nG1 X40.\nM30\n"
        );
        std::fs::write(programs.join(format!("{name}.nc")), text).expect("written");
    }
    let programs = programs.to_str().expect("a plain path");
    let batch = |profile: &str, out: &str| {
        let (profile, out) = (trial.file("machine.toml", profile.as_bytes()), trial.folder.path().join(out));
        let ran = run(&["batch", programs, "-m", &profile, "-O", out.to_str().expect("a plain path")]);
        (ran.status.code(), String::from_utf8_lossy(&ran.stdout).into_owned())
    };
    let zero = format!("{PLAIN}[work_offsets_mm]\nG54 = [0, 0, 0]\n");
    let (status, table) = batch(&zero, "first");
    assert!(status == Some(1) && table.contains("       3  VP0215  "), "{table}");
    let lengths = written(&table, "`[tool]`");
    assert_eq!(lengths, "lengths_mm = { H1 = 120.0, H2 = 120.0 }");
    // The next cause comes to light: the same key for all three.
    let with_lengths = format!("{zero}[tool]\n{lengths}\n");
    let (status, table) = batch(&with_lengths, "second");
    assert!(status == Some(1) && table.contains("       3  VP0213  "), "{table}");
    let change = written(&table, "`[program]`");
    assert_eq!(change, "tool_change = { keeps = \"XYZ\" }");
    // Nobody knows yet where X and Y stand at the start: only the program can say.
    let (status, table) = batch(&format!("{with_lengths}[program]\n{change}\n"), "third");
    assert!(
        status == Some(1) && table.contains("       3  VP0213  ") && table.contains("help: program a rapid"),
        "{table}"
    );
}

#[test]
fn a_second_pass() {
    let trial = Trial::new();
    let first = run(&[&[trial.file("good.nc", GOOD.as_bytes()).as_str()], &PROFILE[..]].concat());
    assert!(first.status.success());
    insta::assert_snapshot!(trial.refused(&first.stdout, &[]), @"
    exit status 1
    error[VP0505]: this program was corrected before
     --> /part.nc:1:1
      |
    1 | (CORRECTED BY VPOST 0.1.0 FOR STAN S500 ENGINE RIGID-BODY)
      | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ its mark
      |
    help: correct the program as posted, not its corrected copy; `--force` corrects once more
    ");
    let forced =
        run(&[&[trial.file("again.nc", &first.stdout).as_str()], &PROFILE[..], &["--force"]].concat());
    assert!(forced.status.success());
}

#[test]
fn empty_and_binary_files() {
    let trial = Trial::new();
    insta::assert_snapshot!(trial.refused(b"", &[]), @"
    exit status 1
    error[VP0110]: the file is empty: nothing to correct
    --> /part.nc
     |
    help: check that the post processor wrote the program and that the name is right
    ");
    insta::assert_snapshot!(trial.refused(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", &[]), @"
    exit status 1
    error[VP0111]: this is a picture (PNG), not a part program
     --> /part.nc:1:1
      |
    1 | ·PNG
      | ^ no text from here on
      |
    help: give the part program, not a picture of it
    ");
}

#[test]
fn paths_that_are_no_programs() {
    let trial = Trial::new();
    insta::assert_snapshot!(trial.refused_path("samples", &[]), @"
    exit status 2
    error[VP0008]: samples is a folder
    help: all programs in it: `vpost batch samples -m PROFILE -O corrected`
    ");
    insta::assert_snapshot!(trial.refused_path("no/such/file.nc", &[]), @"
    exit status 1
    error[VP0001]: cannot read no/such/file.nc: No such file or directory (os error 2)
    help: check the name; nothing of it exists there
    ");
}

#[test]
fn options_that_cannot_be() {
    let trial = Trial::new();
    let good = trial.file("good.nc", GOOD.as_bytes());
    insta::assert_snapshot!(trial.refused_path(&good, &["--engine", "magic"]), @"
    exit status 2
    error[VP0002]: `--engine magic`: there is no such engine; there are rigid-body, tracker, tangential-static, tangential-interval, tangential-quasi-differential, kmtpp, field, tangential-static-published, tangential-interval-published, tangential-quasi-differential-published, kmtpp-published
    help: write its name as in `--engine rigid-body`
    ");
    insta::assert_snapshot!(trial.refused_path(&good, &["--dialect", "fanux"]), @"
    exit status 2
    error[VP0002]: there is no dialect `fanux`
    help: did you mean fanuc? one of: balt-system, centroid, fagor, fanuc, fanuc-lathe, grbl, haas, heidenhain-iso, linuxcnc, linuxcnc-lathe, mach, mitsubishi, okuma, perspektiva, sinumerik, sinumerik-turn; or the path of a grammar file ending in .toml
    ");
    insta::assert_snapshot!(trial.refused_path(&good, &["--work-offset", "G54=1,2"]), @"
    exit status 2
    error[VP0002]: `--work-offset G54=1,2` cannot be read
    help: write millimetres as in `--work-offset G54=100,50,0`
    ");
    insta::assert_snapshot!(trial.refused_path(&good, &["--tolerance", "0"]), @"
    exit status 2
    error[VP0002]: a tolerance of 0 um cannot be kept
    help: give micrometres above zero: `--tolerance 1`
    ");
    insta::assert_snapshot!(trial.refused_path(&good, &["--engine", "kmtpp-published"]), @"
    exit status 2
    error[VP0002]: engine `kmtpp-published` reproduces a publication and corrects no programs
    help: use `--engine kmtpp`, or `vpost solve` for single points
    ");
}

#[test]
fn a_profile_with_a_slip() {
    let trial = Trial::new();
    let good = trial.file("good.nc", GOOD.as_bytes());
    let profile = trial.file(
        "slip.toml",
        b"format = 1\nname = \"X\"\nchain = \"[w X Y b Z t]\"\n[axis.X]\ntravel = [0, 100]\n",
    );
    let ran = run(&[good.as_str(), "-m", &profile]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(ran.stdout.is_empty());
    let said = messages(&ran);
    assert!(said.contains("VP03") && said.contains("travel") && said.contains("travel_mm"), "{said}");
    assert!(said.contains("slip.toml:5:"), "{said}");
}

#[test]
fn an_existing_output_survives_a_refusal_and_a_full_disk() {
    let trial = Trial::new();
    let out = trial.file("out.nc", b"precious\n");
    let bad = trial.file("bad.nc", b"G21 G90\nG0 X0 Y0 Z50.\nG1 X900. F100.\n");
    let ran = run(&[&[bad.as_str(), "-o", &out], &PROFILE[..]].concat());
    assert_eq!(ran.status.code(), Some(1));
    assert_eq!(std::fs::read(&out).expect("there"), b"precious\n");
    let left: Vec<_> = std::fs::read_dir(trial.folder.path()).expect("there").collect();
    assert_eq!(left.len(), 2, "a temporary file was left behind");
    if cfg!(target_os = "linux") {
        let good = trial.file("good.nc", GOOD.as_bytes());
        let full = run(&[&[good.as_str(), "-o", "/dev/full"], &PROFILE[..]].concat());
        assert_eq!(full.status.code(), Some(1));
        assert!(messages(&full).contains("VP0001"), "{}", messages(&full));
    }
}

#[test]
fn standard_input_and_output_are_a_pipe() {
    let mut child = vpost()
        .args(["-", "-m", PROFILE[1], "-v"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    child.stdin.take().expect("piped").write_all(GOOD.as_bytes()).expect("takes it");
    let output = child.wait_with_output().expect("ends");
    assert!(output.status.success(), "{}", messages(&output));
    let text = String::from_utf8(output.stdout).expect("ASCII");
    assert!(text.contains("(CORRECTED BY VPOST") && text.ends_with("M30\n"), "{text}");
    let trial = Trial::new();
    let same = run(&[&[trial.file("good.nc", GOOD.as_bytes()).as_str()], &PROFILE[..]].concat());
    assert_eq!(String::from_utf8(same.stdout).expect("ASCII"), text);
}

/// A signal between two blocks ends the work with the shell's exit status and leaves nothing behind.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let trial = Trial::new();
    let mut program = GOOD.replace("M30\n", "").into_bytes();
    for k in 0..1_500_000 {
        writeln!(program, "G1 X{}.{:03} Y{}.", 10 + k % 90, k % 1000, 20 + k % 70).expect("memory");
    }
    let input = trial.file("long.nc", &program);
    let out = trial.folder.path().join("out.nc");
    let out_text = out.to_str().expect("plain").to_owned();
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        let mut child = vpost()
            .args([input.as_str(), "-m", PROFILE[1], "-o", &out_text, "--progress", "linuxcnc"])
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        // The work says that it has begun: no machine is too fast or too slow for this.
        let mut first = String::new();
        let mut said = BufReader::new(child.stderr.as_mut().expect("piped"));
        said.read_line(&mut first).expect("readable");
        assert!(first.starts_with("FILTER_PROGRESS="), "{first}");
        let sent =
            std::process::Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
        assert!(sent.is_ok_and(|sent| sent.success()), "the work was done before the signal came");
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), Some(status), "{}", messages(&output));
        assert!(!out.exists());
        let left: Vec<_> = std::fs::read_dir(trial.folder.path()).expect("there").collect();
        assert_eq!(left.len(), 1, "a temporary file was left behind");
    }
}

/// The same bytes whatever the number of threads a machine offers.
#[test]
fn the_same_input_gives_the_same_bytes() {
    let once = |threads: &str| {
        let output = vpost()
            .env("RAYON_NUM_THREADS", threads)
            .args(["samples/plate_linuxcnc.nc", "-m", PROFILE[1], "-d", "linuxcnc"])
            .output()
            .expect("runs");
        assert!(output.status.success());
        output.stdout
    };
    let first = once("1");
    assert!(!first.is_empty() && first == once("4") && first == once("1"));
    assert!(root().join("samples").is_dir());
}
