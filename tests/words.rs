//! Words that nobody wrote: none in a rapid, none for an axis that the program has not named in the frame in force.

use crate::common::{messages, root, run};

const PROFILE: &str = "tests/profiles/corpus.toml";
const HEAD: &str = "G21 G90 G17 G54\n";

fn corrected(body: &str, more: &[&str]) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, format!("{HEAD}{body}M30\n")).expect("writable");
    let program = program.to_str().expect("a plain path");
    let ran = run(&[&[program, "-m", PROFILE, "-d", "fanuc"][..], more].concat());
    if !ran.status.success() {
        return Err(messages(&ran));
    }
    let text = String::from_utf8(ran.stdout).expect("plain text");
    Ok(text.lines().skip(2).map(str::to_owned).collect())
}

/// The axes of a block, by letter.
fn axes(block: &str) -> String {
    block.chars().filter(|letter| "XYZ".contains(*letter)).collect()
}

#[test]
fn a_rapid_carries_its_own_axes_only() {
    // Where G53 has cancelled the tool length, a Z that nobody wrote dives by 120 mm.
    let out = corrected(
        "G0 X10. Y10.\nG43 H1 Z20.\nG0 G53 Z300.\nX50. Y30.\nZ20.\nG1 Z5. F100.\nG0 Z20.\nX300.\nY200.\n",
        &[],
    )
    .expect("corrected");
    let rapids: Vec<&String> = out.iter().filter(|block| !block.contains("G1")).collect();
    let named: Vec<String> = rapids.iter().map(|block| axes(block)).collect();
    assert_eq!(named[..5], ["XY", "Z", "Z", "XY", "Z"], "{out:#?}");
    assert_eq!(named[named.len() - 4..], ["Z", "X", "Y", ""], "{out:#?}");
    assert!(out[3].starts_with('X') && out[3] != "X50. Y30.", "corrected where it names: {out:#?}");
}

#[test]
fn the_next_feed_brings_what_rapids_left_out() {
    let out = corrected("G0 X10. Y10.\nG43 H1 Z60.\nZ2.\nG1 Z-5. F100.\nX40.\n", &[]).expect("corrected");
    // An approach at the height where the plunge begins, in X and Y; then the plunge.
    let at = out.iter().position(|block| block.starts_with("G1")).expect("a feed");
    assert_eq!((axes(&out[at]).as_str(), out[at].ends_with("F100.")), ("XY", true), "{out:#?}");
    assert!(axes(&out[at + 1]).ends_with('Z'), "{out:#?}");
}

#[test]
fn start_at_is_knowledge_and_no_motion() {
    let start = ["--start-at", "300,250,200"];
    let out = corrected("G0 Z20.\nX30. Y30.\nG1 Z5. F100.\n", &start).expect("corrected");
    assert_eq!((axes(&out[0]).as_str(), axes(&out[1]).as_str()), ("Z", "XY"), "{out:#?}");
    let said = corrected("G1 X20. F200.\n", &start).expect_err("Y and Z would need words");
    assert!(said.contains("VP0514") && said.contains("since the frame changed in line 1"), "{said}");
}

/// A first feed in a new frame that would start off its path is refused whether or not the machine has lost motion.
#[test]
fn play_hides_no_start_that_is_off() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    std::fs::write(path("ex.csv"), "position_mm,EXX_um,EYX_um,EZX_um\n-300,0,0,-60\n300,0,0,60\n")
        .expect("writable");
    let program = "G90 G17 G54\nG0 X-100 Y0 Z-60\nG1 Z-50 F200\nG20\nG0 X4 Y1\nG1 Z-1.5 F8\nG1 X5\nM2\n";
    std::fs::write(path("unit.ngc"), program).expect("writable");
    for play in ["", "backlash_um = 4\n"] {
        let axis = |name: &str, more: &str| format!("[axis.{name}]\ntravel_mm = [-300, 300]\n{more}");
        let axes = [axis("X", "errors = \"ex.csv\"\n"), axis("Y", ""), axis("Z", play)].concat();
        let profile = format!(
            "format = 1\nname = \"m\"\ncontrol = \"linuxcnc\"\nchain = \"[w X Y b Z t]\"\n{axes}[work_offsets_mm]\nG54 = [0, 0, 0]\n"
        );
        std::fs::write(path("m.toml"), profile).expect("writable");
        let ran = run(&[&path("unit.ngc"), "-m", &path("m.toml"), "--start-at", "0,0,0"]);
        let said = messages(&ran);
        assert!(said.contains("VP0514") && said.contains("40.32 um"), "{play}: {said}");
        // Named in the new unit it starts where it should.
        let named = program.replace("G0 X4 Y1", "G0 X4 Y1 Z-1.9685");
        std::fs::write(path("named.ngc"), named).expect("writable");
        let ran = run(&[&path("named.ngc"), "-m", &path("m.toml"), "--start-at", "0,0,0"]);
        assert!(ran.status.success(), "{play}: {}", messages(&ran));
    }
}

/// Where nothing is corrected no program need say where it begins: it comes out byte for byte. Play is something.
#[test]
fn a_perfect_machine_asks_nobody_where_it_stands() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.ngc");
    let text = "G21 G90 G54\nG1 Z5 F2540\nG0 X10 Y10\nG1 Z-1 F100\nX20\nM2\n";
    std::fs::write(&program, text).expect("writable");
    let program = program.to_str().expect("a plain path");
    let with =
        |profile: &str| run(&[program, "-m", profile, "-d", "linuxcnc", "--work-offset", "G54=140,100,120"]);
    let ran = with("machine-profiles/perfect.toml");
    assert_eq!(String::from_utf8_lossy(&ran.stdout), text, "{}", messages(&ran));
    assert!(messages(&with(PROFILE)).contains("VP0213"));
    let perfect = std::fs::read_to_string(root().join("machine-profiles/perfect.toml")).expect("readable");
    for axis in ["X", "Y", "Z"] {
        let table = format!("[axis.{axis}]\n");
        assert!(perfect.contains(&table), "{table}");
        let machine = folder.path().join("play.toml");
        let play = perfect.replace(&table, &format!("{table}backlash_um = 6.0\n"));
        std::fs::write(&machine, play).expect("writable");
        let ran = with(machine.to_str().expect("a plain path"));
        assert!(messages(&ran).contains("error[VP0213]"), "{axis}: {}", messages(&ran));
    }
}

#[test]
fn a_feed_gets_no_word_for_an_axis_that_is_not_named() {
    let stand = "G0 X10. Y10.\nG43 H1 Z60.\n";
    for (code, since) in [
        ("G55", "the frame changed in line 4"),
        ("G52 Z1.", "the frame changed in line 4"),
        ("G0 G53 Z200.", "G53 in line 4"),
    ] {
        let said = corrected(&format!("{stand}{code}\nG1 X300. Y200. F200.\n"), &[]).expect_err(code);
        assert!(
            said.contains("VP0514") && said.contains(since) && said.contains("`G90 G0 "),
            "{code}: {said}"
        );
        // The way out that the message shows.
        let typed = said.rsplit("as in `").next().and_then(|rest| rest.split('`').next()).expect("a block");
        let named = corrected(&format!("{stand}{code}\n{typed}\nG1 X300. Y200. F200.\n"), &[]);
        assert!(named.is_ok(), "{code}: {named:?}");
    }
    for code in ["G43 H2", "H2", "G49"] {
        let said = corrected(&format!("{stand}{code}\nG1 X300. F200.\n"), &[]).expect_err(code);
        assert!(said.contains("VP0213") && said.contains("tool length changed in line 4"), "{code}: {said}");
    }
}
