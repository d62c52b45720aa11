//! The promise, judged twice: by `vpost check`, and by LinuxCNC's interpreter with a model of its own.

use crate::common::{SAMPLES, have_interpreter, messages, referee, root, run};

/// 1.1 mrad of squareness with the interferometer tables, as the users' acceptance asks for.
const SQUARE: &str = "tests/profiles/stan_s500_square_1100.toml";
const PROFILES: [&str; 2] = ["machine-profiles/stan_s500.toml", SQUARE];

#[test]
fn every_sample_follows_its_path() {
    let second_judge = have_interpreter();
    if !second_judge {
        println!("skipped: linuxcnc-uspace is not installed; only `vpost check` judges");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut corrected = 0;
    for profile in PROFILES {
        for (sample, dialect) in SAMPLES {
            let out = folder.path().join("out.nc");
            let out_text = out.to_str().expect("a plain path");
            let ran = run(&[sample, "-m", profile, "--zero", "true", "-d", dialect, "-o", out_text]);
            assert!(ran.status.success(), "{sample} for {profile}\n{}", messages(&ran));
            let check =
                run(&["check", sample, out_text, "-m", profile, "--zero", "true", "-d", dialect, "--json"]);
            let judged: serde_json::Value = serde_json::from_slice(&check.stdout).expect("JSON");
            assert!(check.status.success(), "{sample} for {profile}: {judged:#}");
            let (before, after) = (&judged["deviation_before_um"], &judged["deviation_after_um"]);
            assert!(before.as_f64().is_some_and(|um| um > 80.0), "{sample}: {before}");
            println!("{sample} {profile}: {before} um before, {after} um after");
            if second_judge {
                let verdict = referee(&root().join(sample), &out, profile, dialect, &resolution(sample));
                assert_eq!(verdict["ok"], true, "{sample} for {profile}: {verdict:#}");
                let second = verdict["before"]["um"].as_f64().expect("a number");
                // Two programs, one machine: they agree on what the uncorrected program does.
                let first = before.as_f64().expect("a number");
                // (The second judge measures to the nearest motion, ours to the motion itself.)
                assert!((first - second).abs() < 0.05 * first, "{sample}: {first} against {second}");
            }
            corrected += 1;
        }
    }
    assert_eq!(corrected, PROFILES.len() * SAMPLES.len());
}

/// The inch sample is written in steps of 0.0001 inch.
fn resolution(sample: &str) -> Vec<&'static str> {
    if sample.contains("inch") { vec!["--resolution", "2.54"] } else { Vec::new() }
}

/// The other engines hold their own promise on the same programs, or refuse.
#[test]
fn path_engines_follow_their_own_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    let out = out.to_str().expect("a plain path");
    for engine in ["tracker", "tangential-static", "tangential-quasi-differential", "kmtpp"] {
        for (sample, dialect) in [SAMPLES[0], SAMPLES[2]] {
            let shared = ["-m", "machine-profiles/stan_s500.toml", "-d", dialect, "-e", engine];
            let ran = run(&[&[sample, "-o", out][..], &shared].concat());
            assert!(ran.status.success(), "{engine} on {sample}\n{}", messages(&ran));
            let check = run(&[&["check", sample, out][..], &shared].concat());
            assert!(
                check.status.success(),
                "{engine} on {sample}: {}",
                String::from_utf8_lossy(&check.stdout)
            );
        }
    }
    let jumps = run(&[
        "samples/plate_linuxcnc.nc",
        "-m",
        "machine-profiles/stan_s500.toml",
        "-d",
        "linuxcnc",
        "-e",
        "tangential-interval",
    ]);
    assert_eq!(jumps.status.code(), Some(1));
    assert!(jumps.stdout.is_empty() && messages(&jumps).starts_with("error[VP05"), "{}", messages(&jumps));
    let published = run(&[
        "samples/plate_linuxcnc.nc",
        "-m",
        "machine-profiles/stan_s500.toml",
        "-d",
        "linuxcnc",
        "-e",
        "kmtpp-published",
    ]);
    assert_eq!(published.status.code(), Some(2));
    assert!(messages(&published).contains("vpost solve"), "{}", messages(&published));
}

/// Outputs with one mistake each, on a machine without errors, so that the program itself passes.
#[test]
fn a_wrong_program_is_found_out() {
    let posted = "G21 G17 G90 G54\nG0 X50. Y0. Z5.\nG1 Z0. F200.\nX0.\nY0.001\nY20.\nG2 X20. Y0. I0. J-20.\nG0 Z5.\nX10. Y10.\nG1 Z0.\nG0 Z5.\nM30\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plain = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let (wanted, commanded) = (plain("posted.nc"), plain("out.nc"));
    std::fs::write(&wanted, posted).expect("writable");
    let judged = |text: &str| {
        std::fs::write(&commanded, text).expect("writable");
        let ran = run(&[
            "check",
            &wanted,
            &commanded,
            "-m",
            "machine-profiles/perfect.toml",
            "-d",
            "fanuc",
            "--json",
        ]);
        let outcome: serde_json::Value = serde_json::from_slice(&ran.stdout).expect("JSON");
        assert_eq!(outcome["passed"], ran.status.success());
        outcome["findings"].to_string()
    };
    assert_eq!(judged(posted), "[]");
    for (right, wrong, finding) in [
        // 3 um aside, an end short of its place, another radius, the other way round.
        ("X0.\n", "X0.003\n", "line 6 of the corrected program is 3.000 um off the path of line 6"),
        ("\nX0.\n", "\nX0.01\nX0. Y0.01\nY0.\n", "line 5 of the corrected program is"),
        ("\nY20.\n", "\nY19.99\n", "line 7 of the corrected program is"),
        ("I0. J-20.", "I0.015 J-20.", "of the corrected program is"),
        ("G2 X20.", "G3 X20.", "line 7 of the corrected program is"),
        // A rapid instead of a cut, though the feed behind it ends where the cut would have ended.
        ("X0.\nY0.001\n", "G0 X0.\nG1 Y0.001\n", "the motion of line 4 is missing"),
        ("G1 Z0.\nG0 Z5.\nM30", "G0 Z0.\nG0 Z5.\nM30", "the motion of line 10 is missing"),
        // Cut twice; cut where nothing is programmed.
        ("G1 Z0.\nG0 Z5.\nM30", "G1 Z0.\nG0 Z5.\nG1 Z0.\nG0 Z5.\nM30", "line 12 of the corrected program"),
        ("X10. Y10.\n", "G1 X10. Y10.\n", "line 9 of the corrected program belongs to no programmed motion"),
        // A retract left out, too late, or downwards; a place passed over; a rapid where none is programmed.
        ("G0 Z5.\nX10.", "G0 X10.", "line 8 of the corrected program positions the tool where"),
        (
            "G0 Z5.\nX10. Y10.\n",
            "G0 X10. Y10.\nZ5.\n",
            "line 8 of the corrected program positions the tool where",
        ),
        ("\nG1 Z0.\nG0 Z5.\nM30", "\nG1 Z0.\nG0 Z-5.\nM30", "line 11 of the corrected program positions"),
        ("\nG1 Z0.\nG0 Z5.\nM30", "\nG1 Z0.\nM30", "the positioning of line 11 is missing"),
        (
            "X10. Y10.\nG1 Z0.\n",
            "X10. Y10.\nZ-3.\nZ5.\nG1 Z0.\n",
            "line 10 of the corrected program positions",
        ),
        // Something else than motion.
        ("M30", "M8\nM30", "M8 on line 12 of the corrected program is not programmed, or not there"),
        ("G54", "G55", "on line 2 of the corrected program G55 is in force, on line 2 of the program G54"),
    ] {
        let text = posted.replace(right, wrong);
        assert_ne!(text, posted, "{right:?}");
        let found = judged(&text);
        println!("{wrong:?}: {found}");
        assert!(found.contains(finding), "{wrong:?}: {found}");
    }
}

/// What happens to the part besides where the tool goes, one mistake each.
#[test]
fn a_wrong_process_is_found_out() {
    let posted = "G21 G17 G90 G54 G94 G64\nT1 M6\nG43 H1\nS1000 M3\nG0 X50. Y80. Z50.\nM8\nG1 Z10. F200.\nX80. F500.\nG4 P500\nY120.\nG41 D1 X90.\nY140.\nG40 X100.\nM9\nG3 X110. Y150. J10.\nM777\nG61\nG1 X120.\nG64\nG9 X130.\nG0 Z50.\nG98 G83 X60. Y80. Z-20. R5. Q10. F200.\nG82 X90. P300\nG84 X120. Z-5. F1000.\nG85 X130. F100.\nG99 G81 X140.\nX150.\nG80\nG0 Z50.\nG93 G1 X160. F2.\nY130. F4.\nG94 G1 X100. F400.\nM1\nG0 Z80.\nM5\nM30\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let (wanted, commanded) = (path("posted.nc"), path("out.nc"));
    std::fs::write(&wanted, posted).expect("writable");
    let judged = |text: &str| {
        std::fs::write(&commanded, text).expect("writable");
        let shared = ["-m", "machine-profiles/perfect.toml", "-d", "fanuc", "--tool", "H1=0", "--json"];
        let ran = run(&[&["check", &wanted, &commanded][..], &shared].concat());
        let outcome: serde_json::Value = serde_json::from_slice(&ran.stdout).expect("JSON");
        assert_eq!(outcome["passed"], ran.status.success());
        outcome["findings"].to_string()
    };
    assert_eq!(judged(posted), "[]");
    // The same state by other words, in other places between two motions.
    let respelt = posted.replace("S1000 M3", "M03 S1000.").replace("G94 G64\n", "G64\nG94\n");
    assert_eq!(judged(&respelt.replace("G4 P500", "G04 P0500").replace("M8\nG1 Z10.", "M8 G01 Z10.0")), "[]");
    for (right, wrong, finding) in [
        ("F500.", "F5000.", "F5000 is in force, on line 8 of the program F500"),
        ("F200.\nX80.", "F210.\nX80.", "F210 is in force"),
        ("G4 P500\n", "", "G4 P500 of line 9 is missing"),
        ("P500", "P50", "G4 P50 on line 9"),
        ("G4 P500\nY120.\n", "Y120.\nG4 P500\n", "G4 P500 of line 9 is missing"),
        ("Q10.", "Q12.", "positions the tool where the program does not"),
        ("G83", "G81", "is missing"),
        ("G83", "G73", "positions the tool where the program does not"),
        ("P300", "P30", "G4 P30 on line 23"),
        ("G82", "G81", "G4 P300 of line 23 is missing"),
        ("G84", "G81", "no cycle of the spindle is in force, on line 24 of the program G84"),
        ("G84", "G74", "G74"),
        ("F1000.", "F100.", "F100 is in force"),
        ("G85", "G81", "the motion of line 25 is missing"),
        ("G99 G81", "G98 G81", "positions the tool where the program does not"),
        ("G98 G83", "G99 G83", "positions the tool where the program does not"),
        ("M9\n", "", "M9 of line 14 is missing"),
        ("M9\nG3 X110. Y150. J10.\n", "G3 X110. Y150. J10.\nM9\n", "M9 of line 14 is missing"),
        ("M8\n", "M7\n", "M8 of line 6 is missing"),
        ("M3\n", "M4\n", "M3 of line 4 is missing"),
        ("S1000", "S2000", "S2000 is in force"),
        ("T1", "T2", "T2 is in force"),
        (" M6", "", "M6 of line 2 is missing"),
        ("G43 H1", "G49", "G43 of line 3 is missing"),
        ("D1", "D2", "D2 is in force"),
        ("G41", "G42", "G42 is in force, on line 11 of the program G41"),
        ("G40 X100.", "X100.\nG40", "G41 is in force, on line 13 of the program G40"),
        ("G61\n", "", "G64 is in force, on line 18 of the program G61"),
        ("G9 X130.", "X130.", "G9 of line 20 is missing"),
        ("M777\n", "", "M777 of line 16 is missing"),
        ("M1\n", "", "M1 of line 33 is missing"),
        ("M30", "M0\nM30", "M0 on line 36"),
        ("F4.", "F8.", "times as long as line 31"),
        ("G93 G1 X160. F2.\nY130. F4.\nG94 G1", "G1 X160. F2.\nY130. F4.\nG94 G1", "G94 is in force"),
        ("G94 G1 X100.", "G95 G1 X100.", "G95 is in force, on line 32 of the program G94"),
        ("M5\nM30", "M30", "M5 of line 35 is missing"),
    ] {
        let text = posted.replacen(right, wrong, 1);
        assert_ne!(text, posted, "{right:?}");
        let found = judged(&text);
        println!("{right:?} -> {wrong:?}: {found}");
        assert!(found.contains(finding), "{right:?} -> {wrong:?}: {found}");
    }
}

/// What `check` says of a program and another that is to be its correction, on a machine without errors.
fn beside(posted: &str, corrected: &str, dialect: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [posted, corrected] = [("posted.nc", posted), ("out.nc", corrected)].map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    });
    let ran = run(&["check", &posted, &corrected, "-m", "machine-profiles/perfect.toml", "-d", dialect]);
    let said = messages(&ran) + &String::from_utf8_lossy(&ran.stdout);
    assert_eq!(said.contains("passed"), ran.status.success());
    said
}

/// On a control that starts in inches, or in another plane, the same words lead elsewhere.
#[test]
fn what_the_program_says_is_not_left_to_the_start_of_the_control() {
    let posted = "G21 G17 G90 G94 G54 G40\nG0 X50. Y0. Z5.\nG1 Z0. F200.\nX0.\nG17 G2 X10. Y10. I10. J0.\nG0 Z5.\nM30\n";
    for (right, wrong, code) in [
        ("G21 ", "", "G21"),
        ("G90 ", "", "G90"),
        ("G94 ", "", "G94"),
        ("G54 ", "", "G54"),
        (" G40", "", "G40"),
        ("\nG0 X50.", "\nX50.", "G0"),
        // Behind the first cut is too late.
        (
            "G21 G17 G90 G94 G54 G40\nG0 X50. Y0. Z5.\nG1 Z0.",
            "G17 G90 G94 G54 G40\nG0 X50. Y0. Z5.\nG1 Z0.\nG21",
            "G21",
        ),
    ] {
        let text = posted.replacen(right, wrong, 1);
        assert_ne!(text, posted);
        let said = beside(posted, &text, "fanuc");
        assert!(said.contains(&format!("moves under {code} only where the control starts in it")), "{said}");
        // What the program does not say either is its own affair, and saying it is none.
        assert!(beside(&text, &text, "fanuc").contains("passed"), "{text}");
        assert!(!wrong.is_empty() || beside(&text, posted, "fanuc").contains("passed"), "{text}");
    }
    let late = posted.replacen("G17 ", "", 1);
    let said = beside(&late, &late.replacen("G17 ", "", 1), "fanuc");
    assert!(said.contains("line 5 of the corrected program moves under G17 only"), "{said}");
}

/// A control that is not told how deep a peck is stops, or drills in one stroke.
#[test]
fn a_peck_cycle_keeps_its_words() {
    let start = "G21 G17 G90 G94 G54\nG0 X0. Y0. Z50. S500 M3\n";
    for (dialect, code) in
        ["fanuc", "haas", "linuxcnc", "mach", "centroid"].iter().flat_map(|d| [(d, "G83"), (d, "G73")])
    {
        // As deep as one peck, so that the moves are those of G81.
        let posted = format!("{start}G98 {code} X60. Y8. Z-5. R5. Q10. F200.\nX70.\nG80\nM30\n");
        assert!(beside(&posted, &posted, dialect).contains("passed"), "{dialect}");
        let lost = posted.replacen(" Q10.", "", 1);
        for programs in [[&posted, &lost], [&lost, &lost]] {
            let said = beside(programs[0], programs[1], dialect);
            assert!(said.contains("VP0216") && said.contains("has no Q"), "{dialect}: {said}");
        }
        for (right, wrong) in [(format!("{code} "), "G81 "), ("Q10.".to_owned(), "Q12.")] {
            let said = beside(&posted, &posted.replacen(&right, wrong, 1), dialect);
            assert!(said.contains(&format!("is in force, on line 3 of the program {code} Q10")), "{said}");
        }
        // Written as moves they are the same holes.
        let moves =
            format!("{start}G0 X60. Y8.\nZ5.\nG1 Z-5. F200.\nG0 Z50.\nX70.\nZ5.\nG1 Z-5.\nG0 Z50.\nM30\n");
        assert!(beside(&posted, &moves, dialect).contains("passed"), "{}", beside(&posted, &moves, dialect));
    }
}

/// The radius in force, its side, and where it begins and ends.
#[test]
fn cutter_compensation_is_the_programs() {
    let posted = "G21 G17 G90 G94 G54 G40\nG10 L12 P1 R5.\nG0 X50. Y80. Z50.\nG1 Z0. F300.\nG41 D1\nG0 X20. Y100.\nG1 X60.\nY140.\nX90.\nG40 G0 X100.\nG0 Z80.\nM30\n";
    for (right, wrong, finding) in [
        ("G10 L12 P1 R5.\n", "", "G10 L12 P1 R5 of line 2 is missing"),
        ("R5.", "R6.", "G10 L12 P1 R5 of line 2 is missing"),
        ("G41 D1", "G41", "no D is in force"),
        ("D1", "D2", "D2 is in force"),
        ("G41 D1\n", "", "G40 is in force"),
        ("G41", "G42", "G42 is in force"),
        ("G41 D1\nG0 X20. Y100.\nG1 X60.", "G0 X20. Y100.\nG41 D1 G1 X60.", "G40 is in force"),
        ("G40 G0", "G0", "G41 is in force"),
        ("X90.\nG40 G0", "G40 X90.\nG0", "G40 is in force"),
    ] {
        let said = beside(posted, &posted.replacen(right, wrong, 1), "fanuc");
        assert!(said.contains(finding), "{wrong}: {said}");
    }
}

const TILTING: &str = "format = 1\nname = \"TILTING\"\ncontrol = \"fanuc\"\nchain = \"[w A X Y b Z t]\"\n\
    axis = { X.travel_mm = [-500, 500], Y.travel_mm = [-500, 500], Z.travel_mm = [-500, 500] }\n\
    [rotary.A]\ntilt = \"body\"\nEB0A_urad = 100.0\n[work_offsets_mm]\nG54 = [0, 0, 0]\n";

/// A feed of rotary axes alone has a path too: nobody passes it who does not know where it leads.
#[test]
fn a_feed_of_rotary_axes_alone_is_judged() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let written = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    let machine = written("tilting.toml", TILTING);
    let program = written("posted.nc", "G21 G17 G90 G54\nG0 X200. Y0. Z100. A0.\nG1 A60. F500.\nM30\n");
    let ran = run(&["check", &program, &program, "-m", &machine, "-d", "fanuc"]);
    assert_eq!(ran.status.code(), Some(1), "{}", String::from_utf8_lossy(&ran.stdout));
}

/// Rapids of a cycle written as moves, and turns of a rotary axis, each with one mistake.
#[test]
fn rapids_of_pecks_and_turns_are_judged() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let written = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    let judged = |posted: &str, corrected: &str, profile: &str| {
        let (posted, corrected) = (written("posted.nc", posted), written("out.nc", corrected));
        let shared = ["-m", profile, "-d", "fanuc", "--zero", "true"];
        let ran = run(&[&["check", &posted, &corrected, "--json"][..], &shared].concat());
        let outcome: serde_json::Value = serde_json::from_slice(&ran.stdout).expect("JSON");
        outcome["findings"].to_string()
    };
    let posted = "G21 G17 G90 G54\nG43 H1\nG0 X50. Y80. Z50.\nG98 G83 X60. Y80. Z-20. R5. Q10. F200.\nX90.\nG80\nG0 Z80.\nM30\n";
    let program = written("program.nc", posted);
    let ran = run(&[&program, "-m", SQUARE, "-d", "fanuc", "-q", "--zero", "true"]);
    let right = String::from_utf8(ran.stdout).expect("text");
    assert_eq!(judged(posted, &right, SQUARE), "[]");
    // From the peck at -5 back to R and to 0.25 mm above it: a millimetre deeper, or aside; straight down to the next hole.
    for (good, wrong) in [
        ("Z-4.757", "Z-5.757"),
        ("X90.188 Y79.928 Z4.99", "X91.188 Y79.928 Z4.99"),
        ("X90.185 Y79.932 Z49.989", "X90.185 Y79.932 Z3.989"),
    ] {
        let text = right.replacen(good, wrong, 1);
        assert_ne!(text, right, "{good}:\n{right}");
        let found = judged(posted, &text, SQUARE);
        println!("{wrong:?}: {found}");
        assert!(found.contains("positions the tool where the program does not"), "{wrong:?}: {found}");
    }
    let machine = written("tilting.toml", TILTING);
    let posted = "G21 G17 G90 G54\nG0 X0. Y0. Z100. A0.\nG0 A90.\nG1 X50. F200.\nG0 Z200.\nA0.\nM30\n";
    let ran = run(&[&written("program.nc", posted), "-m", &machine, "-d", "fanuc", "-q", "--zero", "true"]);
    let right = String::from_utf8(ran.stdout).expect("text");
    assert_eq!(judged(posted, &right, &machine), "[]", "{right}");
    for (good, wrong, finding) in [
        ("G0 A90.", "G0 A80.", "the rotary axes stand elsewhere in line"),
        ("G0 A90.\n", "", "the positioning of line 3 is missing"),
        ("\nA0.", "", "the positioning of line 6 is missing"),
    ] {
        let text = right.replacen(good, wrong, 1);
        assert_ne!(text, right, "{good}:\n{right}");
        let found = judged(posted, &text, &machine);
        println!("{wrong:?}: {found}");
        assert!(found.contains(finding), "{wrong:?}: {found}");
    }
}

/// The first differences are listed, the others counted.
#[test]
fn no_difference_is_left_uncounted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let written = |name: &str, aside: &str| {
        let rows: String =
            (1..=30).map(|row| format!("X{}. Y{row}0.{aside}\n", 100 + 300 * (row % 2))).collect();
        let path = folder.path().join(name);
        std::fs::write(&path, format!("G21 G17 G90 G54\nG0 X100. Y0. Z200.\nG1 F500.\n{rows}M30\n"))
            .expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    let (posted, aside) = (written("posted.nc", ""), written("aside.nc", "005"));
    let ran =
        run(&["check", &posted, &aside, "-m", "machine-profiles/perfect.toml", "-d", "fanuc", "--json"]);
    let outcome: serde_json::Value = serde_json::from_slice(&ran.stdout).expect("JSON");
    let findings = outcome["findings"].as_array().expect("a list");
    assert_eq!((outcome["feed_motions_out"].as_u64(), findings.len()), (Some(30), 22), "{outcome:#}");
    assert_eq!(findings[0], "this program was not corrected: it bears no mark of vpost");
    assert_eq!(findings[21], "and 10 more of the path");
}

/// The last motion leads nowhere and has other words than the one before: found by fuzzing.
#[test]
fn motions_that_lead_nowhere_are_there_in_their_own_process() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    for (dialect, program) in [
        ("linuxcnc", "G17 G21 G40\nG0 X10. Y10. Z60.\nG1 Z50. F200.\nX10. Y10.\nH10. Q10. Z50.\nM2\n"),
        (
            "centroid",
            "G17 G21 G40 G49 G54 G80 G90\nG0 X10. Y10. Z60.\nG98 G83 X20. Y40. R52. Z60. Q40.\nG1 Z50. F200.\nG42 D40.\nY40.\nG99 X20.\nG80\nM30\n",
        ),
    ] {
        let (input, out) = (path("in.nc"), path("out.nc"));
        std::fs::write(&input, program).expect("writable");
        let options = ["-q", "-m", "machine-profiles/generic_vmc.toml", "--tolerance", "4", "-d", dialect];
        let corrected = run(&[&[input.as_str(), "-o", &out], &options[..]].concat());
        assert!(corrected.status.success(), "{}", messages(&corrected));
        let checked = run(&[&["check", &input, &out], &options[..]].concat());
        assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    }
}
