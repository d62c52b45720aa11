//! A profile to begin with is a good one, and nothing in it is guessed.

use crate::common::{messages, run};

const TRAVELS: [&str; 6] = ["--travel", "X=-760..0", "--travel", "Y=-420..0", "--travel", "Z=-510..0"];

fn new(more: &[&str]) -> std::process::Output {
    run(&[&["profile", "new", "--name", "Стан \"5\"", "--control", "fanuc"], more].concat())
}

#[test]
fn what_is_written_is_a_good_profile_of_that_machine() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("plain").to_owned();
    let table = "position_mm,EXX_um\n-760,0\n0,10\n";
    std::fs::write(path("x.csv"), table).expect("written");
    let five = [
        "--chain",
        "[w C X Y b Z t]",
        "--centre",
        "C=-380,-210,0",
        "--sense",
        "C=left",
        "--table",
        "X=x.csv",
    ];
    let output = path("five.toml");
    let ran = new(&[&TRAVELS[..], &five, &["-o", &output]].concat());
    assert!(ran.status.success() && ran.stdout.is_empty(), "{}", messages(&ran));
    let shown = run(&["profile", "show", &output]);
    let shown = String::from_utf8(shown.stdout).expect("text");
    for line in [
        "Стан \"5\"",
        "[w C X Y b Z t]",
        "travel -760 … 0 mm, step 0.001 mm",
        "travel -510 … 0 mm",
        "plus C: the side of the table towards +X goes towards -Y",
    ] {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    // The table that was named counts: 5 um at the middle of its axis.
    std::fs::write(path("points.csv"), "x_mm,y_mm,z_mm\n-380,-200,-100\n").expect("written");
    let predicted = run(&["predict", &path("points.csv"), "-m", &output]);
    let predicted = String::from_utf8(predicted.stdout).expect("text");
    let row = predicted.lines().nth(1).expect("a row");
    assert_eq!(row.split(',').nth(6).map(str::parse), Some(Ok(5.0)), "{predicted}");
    // In Russian it is the same profile, with Russian comments.
    let [english, russian] = ["en", "ru"].map(|language| {
        let ran = new(&[
            &TRAVELS[..],
            &[
                "--chain",
                "[w C X Y b Z t]",
                "--centre",
                "C=-380,-210,0",
                "--sense",
                "C=left",
                "--lang",
                language,
            ],
        ]
        .concat());
        String::from_utf8(ran.stdout).expect("text")
    });
    let keys = |text: &str| {
        let lines = text.lines().map(|line| {
            line.trim_start_matches("# ").split('#').next().unwrap_or_default().trim().to_owned()
        });
        lines.filter(|line| line.contains('=') || line.starts_with('[')).collect::<Vec<_>>()
    };
    assert_eq!(keys(&english), keys(&russian));
    for line in russian.lines().filter_map(|line| line.strip_prefix("# ")).filter(|line| !line.contains('='))
    {
        assert!(line.chars().filter(|c| ('а'..='я').contains(c)).count() > 10, "{line}");
    }
    // What is there is somebody's work.
    let again = new(&[&TRAVELS[..], &["-o", &output]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(messages(&again).contains("is there already"));
}

/// What the control says of itself counts where nothing else is given; what it leaves open is asked for.
#[test]
fn a_control_says_what_its_machine_is() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ini = folder.path().join("mill.ini");
    let limits = |letter: char| format!("[AXIS_{letter}]\nMIN_LIMIT = -10\nMAX_LIMIT = 0\n");
    let text = "[EMC]\nMACHINE = Mill 5\n[TRAJ]\nCOORDINATES = XYZ\nLINEAR_UNITS = inch\n";
    let text = text.to_owned() + &limits('X') + &limits('Y') + &limits('Z');
    std::fs::write(&ini, &text).expect("written");
    let path = ini.to_str().expect("plain");
    let from = |more: &[&str]| run(&[&["profile", "new", "--from", path], more].concat());
    let written = from(&["--travel", "Z=-100..0"]);
    assert!(written.status.success(), "{}", messages(&written));
    let profile = String::from_utf8(written.stdout).expect("text");
    for line in ["\"Mill 5\"", "\"linuxcnc\"", "[-254, 0]", "[-100, 0]"] {
        assert!(profile.contains(line), "{line} in {profile}");
    }
    std::fs::write(&ini, text.replace("= XYZ", "= XYZA")).expect("written");
    let turning = from(&[]);
    assert_eq!(turning.status.code(), Some(2));
    assert!(messages(&turning).contains("which of them carry the workpiece no file says"));
    assert!(from(&["--chain", "[w X Y b Z t]"]).status.success());
}

/// A profile that is read is not yet one that means what its owner wanted.
#[test]
fn a_check_says_what_a_profile_that_can_be_read_does_not_mean() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("plain").to_owned();
    let (profile, program) = (path("m.toml"), path("p.nc"));
    assert!(new(&[&TRAVELS[..], &["-o", &profile]].concat()).status.success());
    let empty = run(&["profile", "check", &profile]);
    assert!(empty.status.success() && messages(&empty).contains("VP0316"), "{}", messages(&empty));
    // At every correction, and the bytes are the program's.
    let text = "G21 G17 G40 G49 G80 G90 G94\nG0 G53 X-100. Y-100. Z-100.\nM30\n";
    std::fs::write(&program, text).expect("written");
    let summary = path("s.json");
    let corrected = run(&["correct", &program, "-m", &profile, "--summary", &summary]);
    assert!(corrected.status.success() && messages(&corrected).contains("nothing is corrected by it"));
    assert_eq!(String::from_utf8(corrected.stdout).expect("text"), text);
    assert!(std::fs::read_to_string(&summary).expect("written").contains("VP0316"));
    // Nine tenths of a table as calibrate takes them: 20 mm for 20 um.
    for (value, said) in
        [("20000", "readings of EXX reach 20000 um"), ("0.001", "of ten of EXX are below 0.05 um")]
    {
        let rows: Vec<String> = (0..9).map(|k| format!("{},{value}", k * 95 - 760)).collect();
        std::fs::write(path("x.csv"), format!("position_mm,EXX_um\n{}\n", rows.join("\n"))).expect("written");
        let _ = std::fs::remove_file(&profile);
        let made = new(&[&TRAVELS[..], &["--table", "X=x.csv", "-o", &profile]].concat());
        assert!(made.status.success(), "{}", messages(&made));
        for command in [vec!["profile", "check", &profile], vec!["correct", &program, "-m", &profile]] {
            let checked = messages(&run(&command));
            assert!(checked.contains("VP0315") && checked.contains(said), "{checked}");
            assert!(checked.contains("[axis.X] errors") && !checked.contains("VP0316"), "{checked}");
        }
    }
    // A name that no control has.
    let text = std::fs::read_to_string(&profile).expect("written").replace("\"fanuc\"", "\"Fanuc\"");
    std::fs::write(&profile, text).expect("written");
    let wrong = run(&["profile", "check", &profile]);
    assert_eq!(wrong.status.code(), Some(2));
    for said in ["VP0303", "there is no dialect `Fanuc`", "m.toml:4:11", "did you mean fanuc?", "sinumerik"] {
        assert!(messages(&wrong).contains(said), "{said} in {}", messages(&wrong));
    }
}

#[test]
fn what_is_missing_or_wrong_is_said() {
    let cases: [(&[&str], &str); 11] = [
        (&[&TRAVELS[..], &["--device", "VF-2"]].concat(), "--from"),
        (&[&TRAVELS[..], &["--centre", "A=0,0,0"]].concat(), "is of no axis of [w X Y b Z t]"),
        (&[&TRAVELS[..], &["--chain", "[w C X Y b Z t]"]].concat(), "--centre of C is not given once"),
        (
            &[&TRAVELS[..], &["--chain", "[w C X Y b Z t]", "--centre", "C=0,0,0"]].concat(),
            "`--sense C=left`: plus C: the side of the table towards +X goes towards -Y (left by ISO 841)",
        ),
        (&["--sense", "C=up"], "cannot be read"),
        (&TRAVELS[..4], "--travel of Z is not given once"),
        (&["--travel", "X=5..5"], "cannot be read"),
        (&["--travel", "A=0..360"], "cannot be read"),
        (&[TRAVELS[0], TRAVELS[1], "--table", "X=nowhere.csv", "--chain", "[w X b Z t]"], "--chain"),
        (&[&TRAVELS[..], &["--table", "X=nowhere.csv"]].concat(), "cannot read the table nowhere.csv"),
        (&[&TRAVELS[..], &["--resolution", "0"]].concat(), "resolution_mm"),
    ];
    for (arguments, said) in cases {
        let ran = new(arguments);
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}");
        assert!(ran.stdout.is_empty() && messages(&ran).contains(said), "{arguments:?}: {}", messages(&ran));
    }
}
