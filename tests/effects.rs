//! Effects of a profile through the whole program: predicted, solved, corrected, checked, never guessed.

use crate::common::{SAMPLES, messages, root, run};

/// A perfect machine large enough for the samples.
const MACHINE: &str = r#"format = 1
name = "Effects"
control = "fanuc"
chain = "[w X Y b Z t]"
calibrated = { date = "2026-01-01", temperature_c = 20.0, instrument = "none" }
[axis.X]
travel_mm = [-100, 600]
[axis.Y]
travel_mm = [-100, 600]
[axis.Z]
travel_mm = [-300, 300]
[tool]
lengths_mm = { H1 = 100.0, H2 = 120.0, H3 = 90.0 }
[work_offsets_mm]
G54 = [100, 100, -100]
"#;

/// Several effects at once, curved, direction dependent, with conditions.
const SEVERAL: &str = r#"
[[effect]]
id = "backlash.X"
half_width_um = 6.2
[[effect]]
id = "backlash.Y"
half_width_um = 3.0
[[effect]]
id = "lost-motion.EYX"
half_width_um = 1.0
[[effect]]
id = "thermal.X"
expansion_um_per_m_k = 11.5
[[effect]]
id = "pitch.X"
pitch_mm = 10
sin1_um = 2.5
cos2_um = 0.7
[[effect]]
id = "squareness.XY"
angle_urad = 120
[[effect]]
id = "angular.EBX"
from_mm = -100
to_mm = 600
p1_urad = 20
p3_urad = -8
[[effect]]
id = "sag.Y"
from_mm = -100
to_mm = 600
droop3_um = 18
tilt_urad = 15
[[effect]]
id = "straightness.EZX"
from_mm = -100
to_mm = 600
p2_um = 9
p4_um = 3
[[effect]]
id = "local.Y"
centre_mm = 150
width_mm = 40
z_um = 8
[[effect]]
id = "load.Z"
compliance_um_per_kg = 0.1
"#;

const AT: [&str; 2] = ["--at", "temp_c=24,load_kg=100,time_s=600,feed_mm_min=6000"];

/// A folder with files in it, and their paths.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }
    fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.0.path().join(name), text).expect("a file");
        self.path(name)
    }
    fn machine(&self, effects: &str) -> String {
        self.write("machine.toml", &format!("{MACHINE}{effects}"))
    }
}

/// A column of a CSV answer.
fn column(csv: &[u8], name: &str) -> Vec<f64> {
    let text = String::from_utf8_lossy(csv);
    let mut lines = text.lines();
    let place = lines
        .next()
        .and_then(|header| header.split(',').position(|column| column == name))
        .expect("the column is there");
    lines.map(|line| line.split(',').nth(place).expect("a field").parse().expect("a number")).collect()
}

const HEADER: &str = "x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dir_x,dir_y,dir_z";

/// One effect each at x = 300, y = 200, z = 100, tool (0, 0, -100), all axes having moved in the positive
/// direction, 24 °C, 100 kg, 600 s, 6 m/min: the textbook's displacement in µm.
const TEXTBOOK: [(&str, &str, [f64; 3]); 20] = [
    ("scale.X", "scale_um_per_m = 20", [6.0, 0.0, 0.0]),
    ("thermal.Y", "expansion_um_per_m_k = 10", [0.0, 8.0, 0.0]),
    ("warmup.Z", "tau_s = 600\namplitude_um = 10", [0.0, 0.0, 6.321_206]),
    ("backlash.X", "half_width_um = 5", [-5.0, 0.0, 0.0]),
    ("lost-motion.EYX", "half_width_um = 5", [0.0, -5.0, 0.0]),
    ("squareness.XY", "angle_urad = 10", [-2.0, 0.0, 0.0]),
    ("squareness.XZ", "angle_urad = 10", [1.0, 0.0, 0.0]),
    ("squareness.YZ", "angle_urad = 10", [0.0, -1.0, 0.0]),
    // P2(0.5) = -0.125.
    ("positioning.EXX", "from_mm = 0\nto_mm = 400\np2_um = 8", [-1.0, 0.0, 0.0]),
    ("straightness.EYX", "from_mm = 0\nto_mm = 400\np2_um = 8", [0.0, -1.0, 0.0]),
    // A quarter of the pitch.
    ("pitch.X", "pitch_mm = 1200\nsin1_um = 3", [3.0, 0.0, 0.0]),
    // 10 µrad × ½ about X; the lever is y = 200, z = 100 - 100 = 0.
    ("angular.EAX", "from_mm = 0\nto_mm = 400\np1_urad = 10", [0.0, 0.0, 1.0]),
    ("sag.Y", "from_mm = 0\nto_mm = 400\ndroop3_um = 16", [0.0, 0.0, -2.0]),
    ("load.Z", "compliance_um_per_kg = 0.05", [0.0, 0.0, -5.0]),
    ("servo-lag.X", "lag_ms = 0.1", [-10.0, 0.0, 0.0]),
    // Half the difference each way; three axes move at 6/√3 m/min.
    ("servo-mismatch.XY", "mismatch_ms = 0.1", [-2.886_751, 2.886_751, 0.0]),
    ("step.X", "time_s = 500\nshift_um = 4", [4.0, 0.0, 0.0]),
    ("local.X", "centre_mm = 300\nwidth_mm = 20\ny_um = 3", [0.0, 3.0, 0.0]),
    // Faults of the instrument are none of the machine.
    ("probe-lobing", "cos2_um = 3", [0.0; 3]),
    ("instrument-drift", "x_um_per_h = 6", [0.0; 3]),
];

#[test]
fn each_effect_is_predicted_as_the_textbook_has_it_and_solved_back() {
    let folder = Folder::new();
    let points = folder.write("points.csv", &format!("{HEADER}\n300,200,100,0,0,-100,1,1,1\n"));
    for (id, numbers, expected) in TEXTBOOK {
        let machine = folder.machine(&format!("[[effect]]\nid = \"{id}\"\n{numbers}\n"));
        let predicted = run(&[&["predict", &points, "-m", &machine][..], &AT].concat());
        assert!(predicted.status.success(), "{id}: {}", messages(&predicted));
        for (name, expected) in ["dx_um", "dy_um", "dz_um"].into_iter().zip(expected) {
            let found = column(&predicted.stdout, name)[0];
            assert!((found - expected).abs() < 2e-6, "{id} {name}: {found}, the textbook has {expected}");
        }
        // Commanding what `solve` says brings the tool where it was wanted.
        let solved = run(&[&["solve", &points, "-m", &machine][..], &AT].concat());
        assert!(solved.status.success(), "{id}: {}", messages(&solved));
        let [x, y, z] = ["qx_mm", "qy_mm", "qz_mm"].map(|name| column(&solved.stdout, name)[0]);
        let again = folder.write("again.csv", &format!("{HEADER}\n{x:.12},{y:.12},{z:.12},0,0,-100,1,1,1\n"));
        let reached = run(&[&["predict", &again, "-m", &machine][..], &AT].concat());
        for (name, wanted) in [("px_mm", 300.0), ("py_mm", 200.0), ("pz_mm", 0.0)] {
            let found = column(&reached.stdout, name)[0];
            // Nine decimals are written, rounded twice.
            assert!((found - wanted).abs() < 2e-9, "{id} {name}: {found}");
        }
    }
    let machine = folder.machine("[[effect]]\nid = \"instrument-drift\"\nx_um_per_h = 6\n");
    let seen = run(&[&["predict", &points, "-m", &machine, "--include-setup"][..], &AT].concat());
    assert!((column(&seen.stdout, "dx_um")[0] - 1.0).abs() < 1e-6, "the instrument shows its own fault");
}

fn corrected_and_checked(profile: &str, more: &[&str]) {
    let folder = Folder::new();
    let out = folder.path("out.nc");
    for (sample, dialect) in SAMPLES {
        let shared = [&["-m", profile, "-d", dialect, "--zero", "true"][..], more].concat();
        let ran = run(&[&[sample, "-o", &out][..], &shared].concat());
        assert!(ran.status.success(), "{sample}\n{}", messages(&ran));
        let check = run(&[&["check", sample, &out, "--json"][..], &shared].concat());
        let judged: serde_json::Value = serde_json::from_slice(&check.stdout).expect("JSON");
        assert!(check.status.success(), "{sample}: {judged:#}");
        let before = judged["deviation_before_um"].as_f64().expect("a number");
        assert!(before > 10.0, "{sample}: {before}");
        // The program as it was fails the same check.
        let unchanged = run(&[&["check", sample, sample][..], &shared].concat());
        assert_eq!(unchanged.status.code(), Some(1), "{sample}");
    }
}

#[test]
fn a_machine_with_backlash_follows_every_sample() {
    corrected_and_checked("machine-profiles/generic_vmc.toml", &[]);
}

#[test]
fn a_machine_with_several_effects_follows_every_sample() {
    let folder = Folder::new();
    let machine = folder.machine(SEVERAL);
    // Where X turns it moves the tool 2 µm sideways: half of that is left at best, all of it where Y would have to go into its play.
    corrected_and_checked(&machine, &[&AT[..], &["--tolerance", "3"]].concat());
}

/// Play: no feed of a corrected program ends on the way of an axis that turns, before its play is taken up.
#[test]
fn every_reversal_takes_up_the_play() {
    let folder = Folder::new();
    let machine = folder.machine("[[effect]]\nid = \"backlash.X\"\nhalf_width_um = 6.2\n");
    let program = folder.write(
        "there_and_back.nc",
        "%\nO1\nG90 G54 G17 G21\nG43 H1 Z50.\nG0 X0. Y0.\nG1 Z-1. F100.\nX50.\nX20.\nY30.\nX60.\nM30\n%\n",
    );
    let out = run(&[&program, "-m", &machine]);
    assert!(out.status.success(), "{}", messages(&out));
    let text = String::from_utf8_lossy(&out.stdout);
    let words: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split_once('X'))
        .filter_map(|(_, rest)| rest.split([' ', 'Y', 'Z', 'F']).next()?.parse().ok())
        .collect();
    // Up to 50, back by twice the half width, on to 20, up again by as much, on to 60.
    let turned: Vec<f64> = words.into_iter().filter(|x| *x > 1.0).collect();
    assert_eq!(turned, [50.006, 49.994, 19.994, 20.006, 60.006], "{text}");
}

#[test]
fn nothing_is_guessed() {
    let folder = Folder::new();
    let points = folder.write("points.csv", "x_mm,y_mm,z_mm\n300,200,100\n");
    let machine = folder.machine(SEVERAL);
    for arguments in [
        vec!["samples/contour_incremental_fanuc.nc"],
        vec!["predict", &points],
        vec!["solve", &points],
        vec!["check", "samples/contour_incremental_fanuc.nc", "samples/contour_incremental_fanuc.nc"],
    ] {
        let refused = run(&[&arguments[..], &["-m", &machine]].concat());
        let said = messages(&refused);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(refused.stdout.is_empty(), "{arguments:?}");
        assert!(
            said.contains("VP0401") && said.contains("thermal.X") && said.contains("--at temp_c=24"),
            "{said}"
        );
        let half = run(&[&arguments[..], &["-m", &machine, "--at", "temp_c=24"]].concat());
        assert!(messages(&half).contains("--at load_kg=100"), "{}", messages(&half));
    }
    let lag = folder.machine("[[effect]]\nid = \"servo-lag.X\"\nlag_ms = 0.1\n");
    let refused = run(&["samples/contour_incremental_fanuc.nc", "-m", &lag]);
    assert!(messages(&refused).contains("--at feed_mm_min=500"), "{}", messages(&refused));
    for wrong in
        ["temp_c", "temp=24", "temp_c=warm", "temp_c=24,temp_x_c=25", "load_kg=-1", "load_kg=1,load_kg=2"]
    {
        let refused = run(&["predict", &points, "-m", &machine, "--at", wrong]);
        assert_eq!(refused.status.code(), Some(2), "{wrong}");
        assert!(messages(&refused).contains("--at"), "{}", messages(&refused));
    }
    // Without the temperature of the calibration there is nothing to count from.
    let text = MACHINE.lines().filter(|line| !line.starts_with("calibrated")).collect::<Vec<_>>().join("\n");
    let effect = "[[effect]]\nid = \"thermal.X\"\nexpansion_um_per_m_k = 11.5\n";
    let unknown = folder.write("uncalibrated.toml", &format!("{text}\n{effect}"));
    let refused = run(&["predict", &points, "-m", &unknown, "--at", "temp_c=24"]);
    assert!(messages(&refused).contains("calibrated = {"), "{}", messages(&refused));
}

#[test]
fn an_engine_that_cannot_take_effects_says_which_can() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(root().join("machine-profiles/stan_s500.toml")).expect("a profile");
    let tables = format!("\"{}/stan_s500/", root().join("machine-profiles").display());
    let text = text.replace("\"stan_s500/", &tables);
    let machine =
        folder.write("stan.toml", &format!("{text}\n[[effect]]\nid = \"backlash.X\"\nhalf_width_um = 5\n"));
    let points = folder.write("points.csv", "x_mm,y_mm,z_mm\n100,100,100\n");
    for engine in ["tracker", "kmtpp", "tangential-static", "kmtpp-published"] {
        let refused = run(&["solve", &points, "-m", &machine, "-e", engine]);
        let said = messages(&refused);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(
            said.contains("VP0402") && said.contains("backlash.X") && said.contains("--engine rigid-body"),
            "{said}"
        );
    }
    let fine = run(&["solve", &points, "-m", &machine]);
    assert!(fine.status.success(), "{}", messages(&fine));
}
