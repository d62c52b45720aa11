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
    let five = ["--chain", "[w C X Y b Z t]", "--centre", "C=-380,-210,0", "--table", "X=x.csv"];
    let output = path("five.toml");
    let ran = new(&[&TRAVELS[..], &five, &["-o", &output]].concat());
    assert!(ran.status.success() && ran.stdout.is_empty(), "{}", messages(&ran));
    let shown = run(&["profile", "show", &output]);
    let shown = String::from_utf8(shown.stdout).expect("text");
    for line in ["Стан \"5\"", "[w C X Y b Z t]", "travel -760 … 0 mm, step 0.001 mm", "travel -510 … 0 mm"]
    {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    // The table that was named counts: 5 um at the middle of its axis.
    std::fs::write(path("points.csv"), "x_mm,y_mm,z_mm\n-380,-200,-100\n").expect("written");
    let predicted = run(&["predict", &path("points.csv"), "-m", &output]);
    let predicted = String::from_utf8(predicted.stdout).expect("text");
    let row = predicted.lines().nth(1).expect("a row");
    assert_eq!(row.split(',').nth(6).map(str::parse), Some(Ok(5.0)), "{predicted}");
    // What is there is somebody's work.
    let again = new(&[&TRAVELS[..], &["-o", &output]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(messages(&again).contains("is there already"));
}

#[test]
fn what_is_missing_or_wrong_is_said() {
    let cases: [(&[&str], &str); 8] = [
        (&[&TRAVELS[..], &["--centre", "A=0,0,0"]].concat(), "is of no axis of [w X Y b Z t]"),
        (&[&TRAVELS[..], &["--chain", "[w C X Y b Z t]"]].concat(), "--centre of C is not given once"),
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
