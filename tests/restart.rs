//! `vpost restart`: a program from one of its lines on.

use std::process::Command;

use crate::common::{Place, have_interpreter, messages, run};

const MACHINE: &str = "format = 1\nname = \"m\"\nchain = \"[w X Y b Z t]\"\ncontrol = \"linuxcnc\"\n\
    axis.X = { travel_mm = [-500, 500], backlash_um = 10 }\naxis.Y = { travel_mm = [-500, 500], backlash_um = 6 }\n\
    axis.Z = { travel_mm = [-500, 500] }\nsquareness = { EC0Y_urad = 200 }\n\
    work_offsets_mm = { G54 = { at = [0, 0, 0], zero = \"true\" }, G55 = { at = [10, 0, 0], zero = \"true\" } }\n\
    tool = { lengths_mm = { H1 = 80, H2 = 90 } }\n";

const PART: &str = "(a part)\nG21 G17 G40 G49 G80 G90 G94 G54\nG64 P0.05\nT1 M6\nS3000 M3\nM8\nG0 G43 H1 Z30.\nX10. Y10.\nZ2.\n\
    G1 Z-1. F200.\nX60. F600.\nG3 X60. Y50. I0. J20.\nG1 X10.\nY10.\nG0 Z30.\nM9\nT2 M6\nS1000 M3\nG0 G43 H2 Z30.\n\
    G55 X10. Y10.\nG99 G81 X10. Y10. R2. Z-5. F100.\nX20.\nX30.\nG80\nG0 Z30.\nG91\nG1 X5. F300.\nX5.\nZ-3.\nG90\n\
    G0 Z30.\nM5\nM2\n";

struct Shop {
    place: Place,
    machine: String,
    program: String,
}

impl Shop {
    fn new(program: &str) -> Self {
        Self::on(MACHINE, program)
    }

    fn on(machine: &str, program: &str) -> Self {
        let place = Place::new();
        let (machine, program) = (place.write("machine.toml", machine), place.write("out.nc", program));
        Self { place, machine, program }
    }

    /// The program from a line on, or why there is none.
    fn from(&self, line: usize, more: &[&str]) -> Result<String, String> {
        let line = line.to_string();
        let ran = run(&[&["restart", &self.program, "--line", &line, "-m", &self.machine], more].concat());
        if ran.status.success() {
            Ok(String::from_utf8(ran.stdout).expect("text"))
        } else {
            assert_eq!((ran.status.code(), ran.stdout.len()), (Some(1), 0));
            Err(messages(&ran))
        }
    }

    /// What stands before the program's own lines.
    fn blocks(&self, line: usize) -> String {
        let tail: String = PART.split_inclusive('\n').skip(line - 1).collect();
        let whole = self.from(line, &[]).expect("a restart");
        whole.strip_suffix(&tail).expect("the program's own lines, byte for byte").to_owned()
    }
}

#[test]
fn the_tool_comes_back_from_above_and_from_its_side() {
    let shop = Shop::new(PART);
    // X has come from below; Y has hardly moved: nobody knows its side, and nothing is made of it.
    let modes = "(a part)\nG17 G90 G94 G21 G40 G54\nG64 P0.05\nT1 M6\nS3000 M3\nM8\n";
    assert_eq!(
        shop.blocks(12),
        format!("{modes}G0 G43 H1 Z30.\nG0 X59.98 Y10.\nG0 X60. Y10.\nG0 Z0.\nG1 Z-1. F100.\nF600.\n")
    );
    // Behind the half circle and the way back: X from above, Y too.
    assert_eq!(
        shop.blocks(15),
        format!("{modes}G0 G43 H1 Z30.\nG0 X10.02 Y10.012\nG0 X10. Y10.\nG0 Z0.\nG1 Z-1. F100.\nF600.\n")
    );
    // A tool change needs neither the old tool nor its place, the leader nothing.
    let changed = "(a part)\nG17 G90 G94 G21 G40 G54\nG64 P0.05\nS3000\nF600.\n";
    assert_eq!(shop.blocks(17), changed);
    assert_eq!(shop.blocks(2), "(a part)\n");
    // Increments, and the zero of the other part.
    let second = "(a part)\nG17 G94 G21 G40 G55 G90 G99\nG64 P0.05\nT2 M6\nS1000 M3\n";
    assert_eq!(
        shop.blocks(28),
        format!("{second}G0 G43 H2 Z30.\nG0 X34.98 Y10.\nG0 X35. Y10.\nG1 Z30. F100.\nF300.\nG91\n")
    );
    let higher = shop.from(12, &["--safe-z", "55"]).expect("a restart");
    assert!(higher.contains("G0 G43 H1 Z55.\n"), "{higher}");
}

#[test]
fn where_there_is_none_the_nearest_line_is_named() {
    let shop = Shop::new(PART);
    let refused = shop.from(22, &[]).expect_err("inside a cycle");
    assert!(refused.starts_with("error[VP0550]: no restart at line 22: a cycle is in force"), "{refused}");
    assert!(refused.contains("`--line 21`"), "{refused}");
    let refused = shop.from(99, &[]).expect_err("behind its end");
    assert!(refused.contains("no restart at line 99"), "{refused}");
    for (lines, line, why) in [
        ("G41 D1 X10.\nY20.\n", 9, "cutter compensation is in force"),
        ("G52 X1.\nG0 X0 Y0\n", 9, "a shift, a rotation or a scaling is in force"),
        ("G2 X30. Y0. I10. J0\nX10. Y0. I-10. J0\n", 9, "it goes on with G2"),
        ("G10 L2 P1 X0 Y0 Z0\nG54\nG0 X0 Y0 Z5.\n", 10, "the program has written offsets"),
        ("/G1 X20.\n/X30.\nG0 X0 Y0\n", 9, "among blocks that may be skipped"),
        ("M2\nG0 X0\n", 9, "has ended"),
        ("G0 Z5. D1\nG0 X0 Y0\nG41 X10.\nY20.\n", 9, "counts on a D before it"),
    ] {
        let start =
            "G21 G17 G40 G49 G90 G94 G54\nS1000 M3\nG43 H1\nG0 X0. Y0. Z10.\nZ2.\nG1 Z0. F200.\nX10.\n";
        let program = format!("{start}{lines}G40\nG0 Z10.\nM2\n");
        let refused = Shop::new(&program).from(line, &[]).expect_err(why);
        assert!(refused.contains(why), "{why}: {refused}");
    }
    let named =
        MACHINE.replace("linuxcnc", "sinumerik").replace("tool = { ", "tool = { names = { MILL = 1 }, ");
    let program = "G71 G90 G94 G17 G54\nT=\"MILL\" M6\nD1\nS1000 M3\nG0 X0 Y0 Z10\nG1 Z0 F100\nX10\nM30\n";
    let refused = Shop::on(&named, program).from(7, &[]).expect_err("a name");
    assert!(refused.contains("its tool has a name and no number"), "{refused}");
    let refused = Shop::new("G21 G90 G54\n#1=5\nG0 X#1 Y0 Z5.\nG1 X5. F100.\nM2\n").from(4, &[]);
    assert!(refused.expect_err("flow").contains("computes, jumps or calls"));
    let clamps = Shop::new("G21 G90 G94 G54\nM10\nG0 X0 Y0 Z5.\nG1 X5. F100.\nY5.\nM2\n");
    let ran = run(&["restart", &clamps.program, "--line", "5", "-m", &clamps.machine]);
    assert!(ran.status.success() && messages(&ran).contains("M10 (line 2)"), "{}", messages(&ran));
}

/// An axis that has to stand on the upper side of its play cannot be brought there from above.
#[test]
fn a_side_that_cannot_be_had_is_refused() {
    let machine = MACHINE.replace(
        "axis.Z = { travel_mm = [-500, 500] }",
        "axis.Z = { travel_mm = [-500, 500], backlash_um = 8 }",
    );
    let program = "G21 G90 G94 G54\nG0 X0 Y0 Z10.\nG1 Z-2. F100.\nX5.\nZ-1.\nX10.\nX15.\nM2\n";
    let shop = Shop::on(&machine, program);
    assert!(shop.from(4, &[]).is_ok());
    let refused = shop.from(6, &[]).expect_err("Z has come up");
    assert!(refused.contains("Z has come up there at feed") && refused.contains("`--line 5`"), "{refused}");
    assert!(Shop::new(program).from(6, &[]).is_ok());
}

/// What LinuxCNC's own interpreter makes of it ends as the whole program does.
#[test]
fn the_rest_is_what_the_interpreter_makes_of_the_whole() {
    if !have_interpreter() {
        return;
    }
    let shop = Shop::new(PART);
    let table = shop.place.write("tool.tbl", "T1 P1 Z80\nT2 P2 Z90\n");
    let var = shop
        .place
        .write("rig.var", "5220\t1.0\n5221\t0.0\n5222\t0.0\n5223\t0.0\n5241\t10.0\n5242\t0.0\n5243\t0.0\n");
    let canonical = |text: &str| {
        let path = shop.place.write("run.ngc", text);
        let ran =
            Command::new("rs274").args(["-g", "-t", &table, "-v", &var, &path]).output().expect("it runs");
        let out = String::from_utf8_lossy(&ran.stdout).into_owned();
        let feeds = out.lines().filter(|line| ["_FEED(", "TRAVERSE("].iter().any(|name| line.contains(name)));
        let calls: Vec<String> = feeds
            .map(|line| line.trim_start().splitn(3, ' ').last().unwrap_or_default().trim_start().to_owned())
            .collect();
        assert!(!calls.is_empty(), "{text}\n{out}{}", String::from_utf8_lossy(&ran.stderr));
        calls
    };
    let whole = canonical(PART);
    let mut begun = 0;
    for line in 1..=PART.lines().count() {
        let Ok(text) = shop.from(line, &[]) else { continue };
        let rest: String = PART.split_inclusive('\n').skip(line - 1).collect();
        let moves = rest.lines().filter(|line| line.contains(['X', 'Y', 'Z'])).count();
        let calls = canonical(&text);
        // A hole is three calls; no line of what is left makes fewer than one.
        let same = calls.iter().rev().zip(whole.iter().rev()).take_while(|(a, b)| a == b).count();
        assert!(same >= moves, "line {line}: {same} of {moves}\n{text}");
        begun += 1;
    }
    assert!(begun > 25, "{begun}");
}
