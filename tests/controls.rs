//! What a program as a whole shows, and what only the machine's owner knows, on the command line: lathes, lengths without
//! a point, M codes, cut programs, tool changes.

use std::fmt::Write as _;
use std::process::Output;

use crate::common::{messages, vpost};

const CORPUS: &str = "tests/profiles/corpus.toml";

struct Part(tempfile::TempDir);

impl Part {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("part.nc"), text).expect("written");
        Self(folder)
    }

    /// The corpus' profile with more in it.
    fn profile(&self, more: &str) -> String {
        let folder = crate::common::root().join("tests/profiles");
        let text = std::fs::read_to_string(folder.join("corpus.toml")).expect("readable");
        let text = text.replace("[program]\nzero", "# zero");
        let tables = text.replace("\"wavy_", &format!("\"{}/wavy_", folder.display()));
        let path = self.0.path().join("machine.toml");
        std::fs::write(&path, format!("{tables}\n{more}\n")).expect("written");
        path.display().to_string()
    }

    fn run(&self, machine: &str, more: &[&str]) -> Output {
        let mut command = vpost();
        command
            .arg(self.0.path().join("part.nc"))
            .args(["-m", machine, "-d", "fanuc", "--zero", "true"])
            .args(more);
        command.output().expect("the command starts")
    }
}

fn refused_for(ran: &Output, code: &str) {
    let said = messages(ran);
    assert_eq!(ran.status.code(), Some(1), "{said}");
    assert!(said.starts_with(&format!("error[{code}]")) && said.contains("help:"), "{said}");
    assert!(ran.stdout.is_empty());
}

fn warned_of(ran: &Output, codes: &[&str]) {
    let said = messages(ran);
    assert!(ran.status.success(), "{said}");
    let found: Vec<&str> = said
        .lines()
        .filter_map(|line| line.strip_prefix("warning[").and_then(|rest| rest.split(']').next()))
        .collect();
    assert_eq!(found, codes, "{said}");
}

const MIXED: &str = "G21\nG90 G0 X10. Y10. Z50.\nG1 Z10 F200.\nM30\n";

#[test]
fn lengths_without_a_point_are_what_somebody_says() {
    let part = Part::new(MIXED);
    refused_for(&part.run(CORPUS, &[]), "VP0241");
    let z = |ran: &Output| {
        warned_of(ran, &[]);
        let out = String::from_utf8_lossy(&ran.stdout).into_owned();
        let line = out.lines().find(|line| line.starts_with("G1")).expect("a feed").to_owned();
        line.split('Z').nth(1).expect("Z").split(' ').next().expect("a number").to_owned()
    };
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let increments = z(&part.run(CORPUS, &["--decimal", "increments"]));
    let millimetres = z(&part.run(CORPUS, &["--decimal", "millimetres"]));
    // Written as it was read: the one in increments of 0.001 mm, the other in millimetres.
    let read = if increments.contains('.') { 1000.0 } else { 1.0 };
    assert!((number(&increments) * read - 10.0).abs() < 500.0, "{increments}");
    assert!((number(&millimetres) - 10.0).abs() < 0.5, "{millimetres}");
    let profile = part.profile("[program]\ndecimal = \"millimetres\"");
    assert_eq!(z(&part.run(&profile, &[])), millimetres);
    // The command line goes before the profile.
    assert_eq!(z(&part.run(&profile, &["--decimal", "increments"])), increments);
    // A dialect that leaves nothing open takes no contradiction.
    let ran = part.run(CORPUS, &["-d", "linuxcnc", "--decimal", "increments"]);
    assert!(!ran.status.success());
}

#[test]
fn doubtful_programs_are_warned_of_and_strictly_refused() {
    for (text, code) in [
        ("G21\nG90 G0 X10000 Y10000 Z50000\nG1 Z10000 F200.\nM30\n", "VP0242"),
        ("G21\nG90 G0 X10. Y10. Z50.\nM777\nG1 Z40. F200.\nM777\nM30\n", "VP0243"),
        ("G90 G0 X10. Y10. Z50.\nG1 Z40. F200.\nM30\n", "VP0244"),
        ("%\nO1\nG21\nG90 G0 X10. Y10. Z50.\nG1 Z40. F200.\n", "VP0245"),
        ("G21\nG90 G0 X10. Y10. Z50.\nG1 Z40. F200.\nX12.5", "VP0245"),
    ] {
        let part = Part::new(text);
        warned_of(&part.run(CORPUS, &[]), &[code]);
        refused_for(&part.run(CORPUS, &["--strict"]), code);
    }
    let quiet = Part::new("G21\nG90 G0 X10. Y10. Z50.\nG1 Z40. F200.\nM30\n");
    warned_of(&quiet.run(CORPUS, &["--strict"]), &[]);
    // Flow is executed, and counts as it is written.
    let loops = Part::new(
        "%\nG21\n#1=0\nG90 G0 X10. Y10. Z50.\nWHILE[#1LT5]DO1\nM777\nG1 Z[40.-#1] F200.\n#1=#1+1\nEND1\nM30\n%\n",
    );
    let ran = loops.run(CORPUS, &[]);
    assert!(messages(&ran).contains("1 M code(s)"), "{}", messages(&ran));
    refused_for(&loops.run(CORPUS, &["--strict"]), "VP0243");
}

#[test]
fn m_codes_that_the_profile_declares() {
    let text = "G21\nG90 G0 X10. Y10. Z50.\nM777\nG1 Z40. F200.\nM30\n";
    let part = Part::new(text);
    warned_of(&part.run(&part.profile("[m_codes]\nharmless = [\"M777\"]"), &["--strict"]), &[]);
    let mirror = Part::new("G21\nG90 G0 X10. Y10. Z50.\nM21\nG1 Z40. F200.\nM30\n");
    refused_for(&mirror.run(CORPUS, &[]), "VP0208");
    warned_of(&mirror.run(&mirror.profile("[m_codes]\nharmless = [\"M21\"]"), &[]), &[]);
    // What the table knows as something else cannot be declared away.
    for code in ["M30", "M98", "M6"] {
        let ran = part.run(&part.profile(&format!("[m_codes]\nharmless = [\"{code}\"]")), &[]);
        assert_eq!(ran.status.code(), Some(2), "{code}: {}", messages(&ran));
    }
}

#[test]
fn calls_that_the_control_has_stay_and_move_what_the_profile_says() {
    let text = "%\nO1001\nG21 G17 G40 G49 G80 G90\nG0 G54 X10. Y10. S3000 M3\nG43 H1 Z50.\nG65 P9832\n\
                G65 P9810 Z10. F3000.\nG65 P9833\nG0 X10. Y10. Z50.\nG1 Z-1. F100.\nX60.\nG0 Z50.\nM30\n%\n";
    let part = Part::new(text);
    let ran = part.run(CORPUS, &[]);
    warned_of(&ran, &["VP0147", "VP0147", "VP0147"]);
    let said = messages(&ran);
    assert!(said.contains("G65 P9810 is in no file") && said.contains("[calls]"), "{said}");
    let out = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(out.contains("\nG65 P9832\nG65 P9810 Z10. F3000.\nG65 P9833\n"), "{out}");
    assert!(!out.contains("PROGRAM FLOW EXPANDED"), "{out}");
    refused_for(&part.run(CORPUS, &["--strict"]), "VP0147");
    // A program below the control's own numbers is one that somebody forgot.
    refused_for(&Part::new(&text.replace("P9833", "P8000")).run(CORPUS, &[]), "VP0127");
    // Behind the call only what it moves has to be named.
    let short = Part::new(&text.replace("G0 X10. Y10. Z50.\n", "G0 Z50.\n"));
    refused_for(&short.run(CORPUS, &[]), "VP0213");
    let calls = |moves: &str| {
        format!(
            "[calls]\n\"G65 P9832\" = \"harmless\"\n\"G65 P9833\" = \"harmless\"\n\"G65 P9810\" = {moves}"
        )
    };
    warned_of(&short.run(&short.profile(&calls("{ unknown = \"Z\" }")), &["--strict"]), &[]);
    refused_for(&short.run(&short.profile(&calls("{ unknown = \"XZ\" }")), &[]), "VP0213");
    let none = Part::new(&text.replace("G0 X10. Y10. Z50.\n", ""));
    warned_of(&none.run(&none.profile(&calls("\"harmless\"")), &["--strict"]), &[]);
    // An entry without a program is for all that no other entry names.
    let all = short.profile("[calls]\nG65 = \"harmless\"\n\"G65 P9810\" = { unknown = \"XZ\" }");
    refused_for(&short.run(&all, &[]), "VP0213");
    warned_of(&none.run(&none.profile("[calls]\nG65 = \"harmless\""), &["--strict"]), &[]);
    // What an expanded program computes is no number for a call that stays.
    let computed = Part::new(&text.replace("G65 P9810 Z10.", "#1=10.\nG65 P9810 Z#1"));
    refused_for(&computed.run(CORPUS, &[]), "VP0137");
    // A function of the machine that moves Z.
    let function = Part::new("G21\nG90 G0 X10. Y10. Z50.\nM200\nG1 Z40. F200.\nM30\n");
    let profile = function.profile("[calls]\nM200 = { unknown = \"Z\" }");
    refused_for(&function.run(&profile, &[]), "VP0213");
    let taken = function.profile("[calls]\nM30 = \"harmless\"");
    assert_eq!(function.run(&taken, &[]).status.code(), Some(2));
}

#[test]
fn a_tool_change_leaves_the_axes_where_the_profile_says() {
    let text = "G21 G90 G54\nG0 X10. Y10. Z50.\nG1 Z45. F300.\nT2 M6\nG1 X60. F200.\nY40.\nM30\n";
    let part = Part::new(text);
    let ran = part.run(CORPUS, &[]);
    refused_for(&ran, "VP0213");
    let said = messages(&ran);
    assert!(
        said.contains("M6 in line 4") && said.contains("tool_change") && !said.contains("--start-at"),
        "{said}"
    );
    // Where the machine stops, an increment knows where it starts.
    let from_there = text.replace("T2 M6\n", "T2 M6\nG91 G0 Z-400.\nG90 X20. Y10. Z45.\n");
    for (text, change) in [
        (text, "tool_change = { keeps = \"XYZ\" }"),
        (&from_there, "tool_change = [110, 90, 500]"),
        (&from_there, "tool_change = { keeps = \"XY\", position_mm = { Z = 500.0 } }"),
    ] {
        let part = Part::new(text);
        let out = part.0.path().join("out.nc");
        let profile = part.profile(&format!("[program]\n{change}"));
        let ran = part.run(&profile, &["-o", out.to_str().expect("plain")]);
        assert!(ran.status.success(), "{change}: {}", messages(&ran));
        let mut check = vpost();
        check
            .arg("check")
            .arg(part.0.path().join("part.nc"))
            .arg(&out)
            .args(["-m", &profile, "-d", "fanuc", "--zero", "true"]);
        let check = check.output().expect("the command starts");
        assert!(check.status.success(), "{change}: {}", String::from_utf8_lossy(&check.stdout));
    }
    // With everything kept the tool stands where the feed before M6 brought it.
    let profile = part.profile("[program]\ntool_change = { keeps = \"XYZ\" }");
    let kept = part.run(&profile, &[]);
    let plain = Part::new(&text.replace("T2 M6\n", ""));
    let without = plain.run(CORPUS, &[]);
    let feeds = |ran: &Output| -> Vec<String> {
        let out = String::from_utf8_lossy(&ran.stdout).into_owned();
        out.lines()
            .filter(|line| !line.contains("M6") && !line.contains("VPOST"))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(feeds(&kept), feeds(&without));
}

/// The same questions to a program that is corrected in chunks, on several threads.
#[test]
fn large_programs_are_asked_too() {
    let large = |begin: &str, behind: &str, end: &str| {
        let mut text = format!("%\nO1\n{begin}G90 G54\nG0 X0. Y0. Z30.\nG1 Z10. F900\n");
        let mut k = 0_u32;
        while text.len() < 5_500_000 {
            k += 1;
            if k == 150_000 {
                text.push_str(behind);
            }
            let _ = writeln!(text, "X{:.3} Y{:.3}", f64::from(k % 997) / 10.0, f64::from(k % 89) / 10.0);
        }
        text.push_str(end);
        Part::new(&text)
    };
    let line = |ran: &Output| messages(ran).lines().nth(1).unwrap_or_default().to_owned();
    let mixed = large("G21\n", "Z9000\n", "M30\n%\n");
    let ran = mixed.run(CORPUS, &[]);
    refused_for(&ran, "VP0241");
    assert!(line(&ran).contains("part.nc:150006:1"), "{}", messages(&ran));
    warned_of(&mixed.run(CORPUS, &["--decimal", "increments"]), &[]);
    let lathe = large("G21\nG50 S2000\n", "G96 S180\n", "M30\n%\n");
    refused_for(&lathe.run(CORPUS, &[]), "VP0240");
    // Behind a block that is refused for something else.
    let both = large("G21\nG50 S2000\n", "X1. U2.\nG96 S180\n", "M30\n%\n");
    refused_for(&both.run(CORPUS, &[]), "VP0240");
    let doubtful = large("", "M777\n", "M777\n");
    let ran = doubtful.run(CORPUS, &[]);
    warned_of(&ran, &["VP0243", "VP0244", "VP0245"]);
    assert!(messages(&ran).contains("2 M code(s)"), "{}", messages(&ran));
    refused_for(&doubtful.run(CORPUS, &["--strict"]), "VP0243");
}

#[test]
fn batch_tells_doubts_by_program_and_is_strict() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("plain.nc", "G21\nG90 G0 X10. Y10. Z50.\nG1 Z40. F200.\nM30\n");
    write("doubtful.nc", "G21\nG90 G0 X10. Y10. Z50.\nM777\nG1 Z40. F200.\nM30\n");
    let out = folder.path().join("out");
    let batch = |more: &[&str]| {
        let mut command = vpost();
        command.arg("batch").arg(folder.path().join("plain.nc")).arg(folder.path().join("doubtful.nc"));
        command.arg("-O").arg(&out).args(["-m", CORPUS, "-d", "fanuc", "--results", "-"]).args(more);
        command.output().expect("the command starts")
    };
    let told = |ran: &Output| String::from_utf8_lossy(&ran.stdout).into_owned();
    let ran = batch(&[]);
    assert!(ran.status.success(), "{}", messages(&ran));
    assert_eq!(told(&ran).matches("VP0243").count(), 1, "{}", told(&ran));
    // A run that was not strict proves nothing to one that is.
    let ran = batch(&["--strict"]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(told(&ran).contains("\"status\":\"refused\""), "{}", told(&ran));
}
