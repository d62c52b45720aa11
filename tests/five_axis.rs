//! Tool centre point control: the tip goes where the program says, on a crooked tilting rotary table.

use std::fmt::Write as _;

use crate::common::{messages, run};

pub(crate) const PROFILE: &str = "tests/profiles/five_axis.toml";
/// As the profile has it: where the program's zero is, the tool's length, the control's centres.
pub(crate) const ZERO_MM: [f64; 3] = [10.0, 145.0, 180.0];
const LENGTH_MM: f64 = 120.0;
pub(crate) const CONTROL_MM: [[f64; 3]; 2] = [[5.0, 150.02, 119.98], [5.01, 150.0, 160.0]];
const MACHINE_MM: [[f64; 3]; 2] = [[5.0, 150.0, 120.0], [5.0, 150.0, 160.0]];

/// X, Y, Z, A, C of the tip at the end of each block.
const PLACES: [[f64; 5]; 8] = [
    [20.0, 10.0, 40.0, 0.0, 30.0],
    [20.0, 10.0, 5.0, 0.0, 30.0],
    [30.0, 12.0, 5.0, -5.0, 42.0],
    [38.0, 5.0, 4.0, -18.0, 75.0],
    [30.0, -15.0, 4.5, -35.0, 130.0],
    [10.0, -25.0, 6.0, -50.0, 160.5],
    [-12.0, -20.0, 6.0, -42.0, 210.0],
    [-12.0, -20.0, 46.0, -42.0, 210.0],
];

/// The same cut in the words of a dialect.
fn program(dialect: &str) -> String {
    let (on, off, equals) = match dialect {
        "fanuc" => ("G43.4 H1", "G49", ""),
        "haas" => ("G234 H1", "G49", ""),
        "linuxcnc" => ("G43 H1\nM428", "M429\nG49", ""),
        _ => ("TRAORI", "TRAFOOF", "="),
    };
    let point = if dialect == "sinumerik" { "" } else { "." };
    let mut text =
        format!("G17 G90 G94 G54 G{}\nG0 A{equals}0 C{equals}0\n{on}\n", if equals == "=" { 71 } else { 21 });
    for (k, [x, y, z, a, c]) in PLACES.into_iter().enumerate() {
        let number =
            |value: f64| if value.fract() == 0.0 { format!("{value}{point}") } else { value.to_string() };
        let [x, y, z, a, c] = [x, y, z, a, c].map(number);
        let code = match k {
            0 => "G0 ",
            1 => "G1 ",
            7 => "G0 ",
            _ => "",
        };
        let feed = if k == 1 { " F600" } else { "" };
        writeln!(text, "{code}X{x} Y{y} Z{z} A{equals}{a} C{equals}{c}{feed}").expect("a string takes all");
    }
    text + off + "\nM30\n"
}

pub(crate) struct Place(tempfile::TempDir);

impl Place {
    pub(crate) fn new(text: &str) -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(place.path("in.nc"), text).expect("writable");
        place
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }
}

/// The profile's machine without tool lengths: a Sinumerik has its own.
fn length_mm(dialect: &str) -> f64 {
    if dialect == "sinumerik" { 0.0 } else { LENGTH_MM }
}

fn dialect_of(name: &str) -> &str {
    if name == "haas" { "fanuc" } else { name }
}

/// Where a word with this letter leads.
pub(crate) fn word(line: &str, letter: char) -> Option<f64> {
    let at = line.find(letter)?;
    let rest = line[at + 1..].trim_start_matches('=');
    let end = rest.find(|c: char| !matches!(c, '0'..='9' | '.' | '-')).unwrap_or(rest.len());
    rest[..end].parse().ok()
}

/// What a control with these centres makes of a tip: LinuxCNC's xyzac-trt, the inverse of
/// `p = c_C + Rz(-C) (c_A + Rx(-A) (q - c_A) - c_C)`.
pub(crate) fn axis_command(
    [x, y, z, a, c]: [f64; 5],
    length_mm: f64,
    [about_a, about_c]: [[f64; 3]; 2],
) -> [f64; 3] {
    let (sin, cos) = units::math::sin_cos(c.to_radians());
    let (u, v) = (x - about_c[0], y - about_c[1]);
    let turned = [about_c[0] + cos * u - sin * v, about_c[1] + sin * u + cos * v, z];
    let (sin, cos) = units::math::sin_cos(a.to_radians());
    let (u, v) = (turned[1] - about_a[1], turned[2] - about_a[2]);
    [turned[0], about_a[1] + cos * u - sin * v, about_a[2] + sin * u + cos * v + length_mm]
}

/// The machine brings the tip of each row of points to its place, within `allowed_um`.
pub(crate) fn tips_are_there(points: &str, wanted: &[[f64; 3]], allowed_um: f64, what: &str) {
    let predicted = run(&["predict", points, "-m", PROFILE]);
    assert!(predicted.status.success(), "{}", messages(&predicted));
    let rows = String::from_utf8(predicted.stdout).expect("text");
    for (row, wanted) in rows.lines().skip(1).zip(wanted) {
        let real: Vec<f64> =
            row.split(',').skip(8).take(3).map(|cell| cell.parse().expect("a number")).collect();
        let off_um = [0, 1, 2].map(|i| (real[i] - wanted[i]) * 1e3);
        let distance = off_um.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!(distance < allowed_um, "{what}: {distance} um off at {wanted:?}");
    }
}

#[test]
fn the_tip_goes_where_the_program_says() {
    for name in ["fanuc", "haas", "linuxcnc", "sinumerik"] {
        let dialect = dialect_of(name);
        let place = Place::new(&program(name));
        let [from, to, points] = ["in.nc", "out.nc", "points.csv"].map(|name| place.path(name));
        let ran = run(&[&from, "-m", PROFILE, "--zero", "true", "-d", dialect, "-o", &to]);
        assert!(ran.status.success(), "{name}: {}", messages(&ran));
        let check = run(&["check", &from, &to, "-m", PROFILE, "--zero", "true", "-d", dialect]);
        let said = String::from_utf8_lossy(&check.stdout).into_owned();
        assert!(check.status.success(), "{name}: {said}");

        // Through the control's kinematics and the machine as it is, to where the tip was to go.
        let made = std::fs::read_to_string(&to).expect("written");
        let mut table = "x_mm,y_mm,z_mm,a_deg,c_deg,tool_x_mm,tool_y_mm,tool_z_mm\n".to_owned();
        let mut at = [0.0; 5];
        let mut wanted = Vec::new();
        for line in made.lines().filter(|line| !line.starts_with('(') && !line.starts_with(';')) {
            for (value, letter) in at.iter_mut().zip(['X', 'Y', 'Z', 'A', 'C']) {
                *value = word(line, letter).unwrap_or(*value);
            }
            let ends = PLACES
                .iter()
                .find(|place| place[3] == at[3] && place[4] == at[4] && (place[2] - at[2]).abs() < 1.0);
            let Some(ends) = ends.filter(|_| line.contains('X')) else { continue };
            let tip = [at[0] + ZERO_MM[0], at[1] + ZERO_MM[1], at[2] + ZERO_MM[2], at[3], at[4]];
            let [x, y, z] = axis_command(tip, length_mm(name), CONTROL_MM);
            writeln!(table, "{x},{y},{z},{},{},0,0,{}", at[3], at[4], -length_mm(name))
                .expect("a string takes all");
            wanted.push([0, 1, 2].map(|i| ends[i] + ZERO_MM[i]));
        }
        assert_eq!(wanted.len(), PLACES.len(), "{name}:\n{made}");
        std::fs::write(&points, table).expect("writable");
        // Half an output step in each direction.
        tips_are_there(&points, &wanted, 0.9, name);
    }
}

#[test]
fn without_correction_it_does_not() {
    let place = Place::new(&program("fanuc"));
    let from = place.path("in.nc");
    let check = run(&["check", &from, &from, "-m", PROFILE]);
    assert_eq!(check.status.code(), Some(1), "{}", String::from_utf8_lossy(&check.stdout));
}

/// A and C with play: led at their arms where they turn back. What was corrected for a machine without play is off there.
#[test]
fn play_of_rotary_axes_is_led_at_its_arm() {
    let tables = crate::common::root().join("tests/profiles");
    let tables = tables.to_str().expect("a plain path");
    let without = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let without = without.replace("\"wavy_", &format!("\"{tables}/wavy_"));
    let with = without
        .replace("EC0A_urad = -40.0", "EC0A_urad = -40.0\nbacklash_urad = 60.0")
        .replace("EB0C_urad = -50.0", "EB0C_urad = -50.0\nbacklash_urad = 80.0");
    for dialect in ["fanuc", "sinumerik"] {
        // C turns back in the middle of the cut.
        let place = Place::new(&program(dialect).replace("160.5", "101.5"));
        let [from, to, loose, tight] =
            ["in.nc", "out.nc", "loose.toml", "tight.toml"].map(|name| place.path(name));
        std::fs::write(&loose, &with).expect("writable");
        std::fs::write(&tight, &without).expect("writable");
        let corrected = |profile: &str| {
            let ran = run(&[&from, "-m", profile, "-d", dialect, "-o", &to, "--force"]);
            assert!(ran.status.success(), "{dialect}: {}", messages(&ran));
            let check = run(&["check", &from, &to, "-m", &loose, "-d", dialect]);
            (check.status.code(), String::from_utf8_lossy(&check.stdout).into_owned())
        };
        let (status, said) = corrected(&loose);
        assert_eq!(status, Some(0), "{dialect}: {said}");
        let (status, said) = corrected(&tight);
        assert_eq!(status, Some(1), "{dialect}: {said}");
        assert!(said.contains("off its path"), "{said}");
    }
}

/// The same cut with axis words, made by the formulas with the machine's own centres: `check` compares tips.
#[test]
fn the_same_tip_by_axis_words_is_the_same_path() {
    let line = |code: &str, [x, y, z, a, c]: [f64; 5]| {
        let tip = [x + ZERO_MM[0], y + ZERO_MM[1], z + ZERO_MM[2], a, c];
        let q = axis_command(tip, 0.0, MACHINE_MM);
        let [x, y, z] = [0, 1, 2].map(|i| q[i] - ZERO_MM[i]);
        format!("{code} X{x:.5} Y{y:.5} Z{z:.5} A{a:.5} C{c:.5} F600\n")
    };
    let mut text = "G17 G90 G94 G54 G21\nG0 A0. C0.\nG43 H1\n".to_owned() + &line("G0", PLACES[0]);
    for pair in PLACES[..7].windows(2) {
        // The tip's line in so many of the axes that none bends by more than the tolerance.
        const PARTS: u32 = 400;
        for k in 1..=PARTS {
            let s = f64::from(k) / f64::from(PARTS);
            text += &line("G1", [0, 1, 2, 3, 4].map(|i| pair[0][i] + (pair[1][i] - pair[0][i]) * s));
        }
    }
    text += &line("G0", PLACES[7]);
    text += "G49\nM30\n";
    let place = Place::new(&program("fanuc"));
    let [from, axes, made] = ["in.nc", "axes.nc", "made.nc"].map(|name| place.path(name));
    std::fs::write(&axes, &text).expect("writable");
    let ran = run(&[&axes, "-m", PROFILE, "-o", &made]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let check = run(&["check", &from, &made, "-m", PROFILE]);
    let said = String::from_utf8_lossy(&check.stdout).into_owned();
    let path: Vec<&str> = said.lines().filter(|line| line.contains("off the path")).collect();
    assert!(path.is_empty(), "{said}");
    assert!(said.starts_with("6 feed motions in, 2400 out"), "{said}");
    let after = said.lines().find_map(|line| line.strip_prefix("after:  the tool is up to ")).expect("said");
    let after_um: f64 =
        after.split_whitespace().next().and_then(|number| number.parse().ok()).expect("a number");
    assert!(after_um < 2.0, "{said}");
}

#[test]
fn what_does_not_go_together_is_refused_by_name() {
    let refused = |middle: &str| {
        let place = Place::new(&format!(
            "G21 G90 G94 G54 G0 A0. C0.\nG43.4 H1\nG0 X0. Y0. Z50. A-10. C20.\n{middle}\nM30\n"
        ));
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE]);
        (ran.status.code(), messages(&ran))
    };
    for (middle, says) in [
        ("G41 D1 G1 X10. F100.", "cutter compensation under tool centre point control"),
        ("G81 X5. Y5. Z-5. R2. F100.", "a drilling cycle under tool centre point control"),
        ("G68 X0. Y0. R30.", "a rotation, scaling or mirror under tool centre point control"),
    ] {
        let (status, said) = refused(middle);
        assert_eq!(status, Some(1), "{middle}");
        assert!(
            said.contains("error[VP0230]") && said.contains(says) && said.contains("help:"),
            "{middle}: {said}"
        );
    }
    // Behind the switch nobody knows where the tip is before it is said.
    for (middle, since) in [
        ("G49\nG1 Z0. F100.", "tool centre point control was switched in line 4"),
        ("G53 G0 Z100.\nG1 X5. F100.", "X, Y, Z not known since G53 in line 4"),
        ("G91 G28 Z0.\nG90 G1 X5. F100.", "X, Y, Z not known since the reference return in line 4"),
    ] {
        let (status, said) = refused(middle);
        assert_eq!(status, Some(1));
        assert!(said.contains(since), "{said}");
    }
}

/// A travels from -100 to 30: beyond it nothing is corrected, and no other turn or way is taken instead.
#[test]
fn a_turn_beyond_travel_is_refused() {
    refuses_beyond_travel(&["G1 X5. A31. F100.", "G1 A-101. F100."]);
}

/// Also where nothing is corrected: the control stops at its limit.
#[test]
fn a_rapid_turn_beyond_travel_is_refused() {
    refuses_beyond_travel(&["G0 A35.", "G0 A35. C0.", "G49\nG0 A35.", "G49\nG53 G0 A35."]);
    for text in ["G0 A35.\nM30\n", "G0 C0.\nG0 X5. A35.\nM30\n"] {
        let place = Place::new(&format!("G21 G90 G94 G54 {text}"));
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE]);
        assert!(
            ran.status.code() == Some(1) && messages(&ran).contains("error[VP0501]"),
            "{text}: {}",
            messages(&ran)
        );
    }
}

fn refuses_beyond_travel(middles: &[&str]) {
    for middle in middles {
        let place = Place::new(&format!(
            "G21 G90 G94 G54 G0 A0. C0.\nG43.4 H1\nG0 X0. Y0. Z50. A-10. C20.\n{middle}\nG49\nM30\n"
        ));
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE]);
        let said = messages(&ran);
        assert_eq!(ran.status.code(), Some(1), "{middle}: {said}");
        assert!(said.contains("error[VP0501]") && said.contains("`travel_deg` of A"), "{middle}: {said}");
    }
}

/// `C=DC(90)` is the angle where the way to it does not cross 0, and stays as it is written.
#[test]
fn direct_angles_are_angles_within_a_turn() {
    let plain = program("sinumerik");
    let mut direct = String::new();
    for line in plain.lines() {
        match line.split_once(" C=") {
            Some((before, angle)) => {
                let (angle, rest) = angle.split_once(' ').unwrap_or((angle, ""));
                writeln!(direct, "{before} C=DC({angle}) {rest}").expect("a string takes all");
            }
            None => writeln!(direct, "{line}").expect("a string takes all"),
        }
    }
    let corrected = |text: &str| {
        let place = Place::new(text);
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE, "-d", "sinumerik"]);
        (ran.status.success(), String::from_utf8_lossy(&ran.stdout).into_owned(), messages(&ran))
    };
    let (done, made, said) = corrected(&direct);
    assert!(done && made.contains("C=DC(75)"), "{said}\n{made}");
    let words = |text: &str| -> Vec<String> {
        text.lines().map(|line| line.replace("DC(", "").replace(')', "").trim_end().to_owned()).collect()
    };
    let (_, wanted, _) = corrected(&plain);
    assert_eq!(words(&made), words(&wanted));
    // Half a turn and more, across 0, out of the turn.
    for (wrong, right) in [("C=DC(250)", "C=DC(42)"), ("C=DC(-10)", "C=DC(42)"), ("C=DC(360)", "C=DC(210)")] {
        let (done, _, said) = corrected(&direct.replacen(right, wrong, 1));
        assert!(!done && said.contains("between 0 and 360") && said.contains("help:"), "{wrong}: {said}");
    }
}

#[test]
fn without_a_model_it_is_refused() {
    let profile = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let start = profile.find("[kinematics]").expect("a section");
    let tables = crate::common::root().join("tests/profiles");
    let tables = tables.to_str().expect("a plain path");
    let with = |text: String| text.replace("\"wavy_", &format!("\"{tables}/wavy_"));
    for (text, says) in [
        (with(profile[..start].to_owned()), "with which centres the control computes is not said"),
        (
            with(profile.replace("errors = \"wavy_x.csv\"", "errors = \"wavy_x.csv\"\nbacklash_um = 4.0")),
            "with lost motion of linear axes",
        ),
    ] {
        let place = Place::new(&program("fanuc"));
        std::fs::write(place.path("machine.toml"), text).expect("writable");
        let ran = run(&[&place.path("in.nc"), "-m", &place.path("machine.toml")]);
        assert_eq!(ran.status.code(), Some(1));
        assert!(
            messages(&ran).contains("error[VP0230]") && messages(&ran).contains(says),
            "{}",
            messages(&ran)
        );
    }
}

/// A cut in a tilted plane, whose X Y Z at the ends of its lines are these.
const IN_PLANE: [[f64; 3]; 6] = [
    [0.0, 0.0, 40.0],
    [0.0, 0.0, 2.0],
    [25.0, 4.0, 2.0],
    [5.0, 30.0, 1.0],
    [-15.0, 10.0, 1.0],
    [-10.0, -5.0, 3.0],
];

/// The cut, an arc and holes among it; `turned` and `plane`: blocks that turn the table and define the plane.
fn in_a_plane(turned: &str, plane: &str) -> String {
    format!(
        "G17 G21 G90 G94 G54\nG0 {turned}\n{plane}\nG0 X0. Y0.\nG43 H1 Z40.\nG1 Z2. F600.\nX25. Y4.\nX5. Y30. Z1.\n\
         G2 X-15. Y10. I-20. J0.\nG1 X-10. Y-5. Z3.\nG0 Z60.\nG99 G81 X10. Y10. Z-8. R2. F100.\nX-12. Y18.\nG80\n\
         G0 Z60.\nG49\nG69\nM30\n"
    )
}

/// By Rx(30) about its zero, which stands at X20 Y10 Z5: in each of the four ways to say so.
const PLANES: [&str; 4] = [
    "G68.2 X20. Y10. Z5. I0. J30. K0.",
    "G68.2 P1 Q123 X20. Y10. Z5. I30. J0. K0.",
    "G68.2 P2 Q1 X20. Y10. Z5.\nG68.2 P2 Q2 X50. Y10. Z5.\nG68.2 P2 Q3 X20. Y18.660254 Z10.",
    "G68.2 P3 Q1 X20. Y10. Z5. I1. J0. K0.\nG68.2 P3 Q2 I0. J-0.5 K0.866025404",
];

#[test]
fn in_a_tilted_plane_the_tip_goes_where_the_program_says() {
    for plane in PLANES {
        let place = Place::new(&in_a_plane("A-30. C0.", plane));
        let [from, to, points] = ["in.nc", "out.nc", "points.csv"].map(|name| place.path(name));
        let ran = run(&[&from, "-m", PROFILE, "--zero", "true", "-o", &to]);
        assert!(ran.status.success(), "{plane}: {}", messages(&ran));
        let check = run(&["check", &from, &to, "-m", PROFILE, "--zero", "true"]);
        assert!(check.status.success(), "{plane}: {}", String::from_utf8_lossy(&check.stdout));
        let unchanged = run(&["check", &from, &from, "-m", PROFILE, "--zero", "true"]);
        assert_eq!(unchanged.status.code(), Some(1), "uncorrected it is off: {plane}");

        let made = std::fs::read_to_string(&to).expect("written");
        let mut table = "x_mm,y_mm,z_mm,a_deg,c_deg,tool_x_mm,tool_y_mm,tool_z_mm\n".to_owned();
        let (mut at, mut wanted) = ([0.0; 3], Vec::new());
        let (sin, cos) = units::math::sin_cos(30f64.to_radians());
        let in_workpiece = |[x, y, z]: [f64; 3]| {
            let turned = [x, cos * y - sin * z, sin * y + cos * z];
            [0, 1, 2].map(|i| turned[i] + [20.0, 10.0, 5.0][i] + ZERO_MM[i])
        };
        let cut =
            made.lines().skip_while(|line| !line.starts_with("G43")).take_while(|line| *line != "G0 Z60.");
        for line in cut.filter(|line| !line.contains("G0 Z") && !line.contains("G81")) {
            for (value, letter) in at.iter_mut().zip(['X', 'Y', 'Z']) {
                *value = word(line, letter).unwrap_or(*value);
            }
            let near = |place: &&[f64; 3]| (0..3).all(|i| (place[i] - at[i]).abs() < 0.2);
            // The first block leaves X and Y to the next feed.
            let Some(ends) = IN_PLANE.iter().skip(1).find(near) else { continue };
            let [x, y, z] = in_workpiece(at);
            let [x, y, z] = axis_command([x, y, z, -30.0, 0.0], LENGTH_MM, CONTROL_MM);
            writeln!(table, "{x},{y},{z},-30,0,0,0,{}", -LENGTH_MM).expect("a string takes all");
            wanted.push(in_workpiece(*ends));
        }
        assert!(wanted.len() >= IN_PLANE.len() - 1, "{plane}:\n{made}");
        std::fs::write(&points, table).expect("writable");
        // The tolerance, and half an output step in each direction: an end may lie within both.
        tips_are_there(&points, &wanted, 1.9, plane);
    }
}

/// Haas' dynamic work offset: the plane along the machine's axes, its zero where the table has turned the work offset.
#[test]
fn g254_is_the_plane_on_which_the_tool_stands_upright() {
    let cut = |text: &str, more: &[&str]| {
        let place = Place::new(text);
        let [from, to] = ["in.nc", "out.nc"].map(|name| place.path(name));
        let with = [&["-m", PROFILE, "--zero", "true"][..], more].concat();
        let ran = run(&[&[from.as_str(), "-o", &to][..], &with].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        let check = run(&[&["check", &from, &to][..], &with].concat());
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
        let made = std::fs::read_to_string(&to).expect("written");
        let lines = made.lines().skip_while(|line| !line.starts_with("G0 X0."));
        lines.take_while(|line| *line != "G49").map(str::to_owned).collect::<Vec<_>>()
    };
    for (turned, angles) in [("A-30. C0.", "I0. J30. K0."), ("A-30. C40.", "I-40. J30. K0.")] {
        let plane = cut(&in_a_plane(turned, &format!("G68.2 X20. Y10. Z5. {angles}")), &[]);
        // The same zero as a work offset.
        let program = in_a_plane(turned, "G254").replace("G69", "G255");
        let haas = ["-d", "haas", "--work-offset", "G54=30,155,185"];
        assert_eq!(cut(&program, &haas), plane, "{turned}");
        assert!(plane.len() > 8);
    }
    for (turned, blocks, says) in [
        ("A-30. C0.", "G254\nG0 A-20. X0. Y0. Z50.", "end it with G255 before the turn"),
        ("A-30.", "G254", "a rotary axis is unknown"),
        ("A-30. C0.", "G43 H1 G0 Z90.\nG254", "with a tool length in force"),
    ] {
        let place = Place::new(&format!("G17 G21 G90 G94 G54\nG0 {turned}\n{blocks}\nM30\n"));
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE, "-d", "haas"]);
        assert!(!ran.status.success() && messages(&ran).contains(says), "{blocks}: {}", messages(&ran));
    }
}

#[test]
fn a_plane_that_lies_elsewhere_is_found_whichever_of_its_blocks_says_so() {
    let elsewhere = [
        (PLANES[0], "X20. Y10. Z5.", "X20.02 Y10. Z5."),
        (PLANES[1], "Z5.", "Z5.02"),
        (PLANES[2], "Q1 X20. Y10.", "Q1 X20.02 Y10."),
        (PLANES[2], "X50. Y10.", "X50. Y10.1"),
        (PLANES[2], "Y18.660254 Z10.", "Y18.660254 Z10.1"),
        (PLANES[3], "Z5.", "Z5.02"),
        (PLANES[3], "I1. J0. K0.", "I0. J0.866025404 K0.5"),
    ];
    for (plane, right, wrong) in elsewhere {
        let text = in_a_plane("A-30. C0.", plane);
        let place = Place::new(&text);
        let [from, to] = ["in.nc", "out.nc"].map(|name| place.path(name));
        assert!(run(&[&from, "-m", PROFILE, "-o", &to]).status.success(), "{plane}");
        let made = std::fs::read_to_string(&to).expect("written");
        assert!(made.contains(right), "{right}:\n{made}");
        std::fs::write(&to, made.replacen(right, wrong, 1)).expect("writable");
        let check = run(&["check", &from, &to, "-m", PROFILE]);
        assert_eq!(check.status.code(), Some(1), "{wrong}: {}", String::from_utf8_lossy(&check.stdout));
    }
}

/// The machine with a rule by which the control turns its table.
pub(crate) fn with_rule(place: &Place, rule: &str) -> String {
    let profile = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let tables = crate::common::root().join("tests/profiles");
    let text = profile.replace("\"wavy_", &format!("\"{}/wavy_", tables.to_str().expect("a plain path")));
    let path = place.path("machine.toml");
    std::fs::write(&path, text.replace("[kinematics]", &format!("[kinematics]\n{rule}"))).expect("writable");
    path
}

#[test]
fn g53_1_turns_by_the_rule_of_the_profile_or_not_at_all() {
    let text = in_a_plane("A0. C0.", &format!("{}\nG53.1", PLANES[0]));
    let by_hand = in_a_plane("A-30. C0.", PLANES[0]);
    let place = Place::new(&text);
    let profile = with_rule(&place, "branch = \"A-\"\nturn = \"principal\"");
    let ran = run(&[&place.path("in.nc"), "-m", &profile]);
    assert!(ran.status.success(), "{}", messages(&ran));
    std::fs::write(place.path("by_hand.nc"), by_hand).expect("writable");
    let same = run(&[&place.path("by_hand.nc"), "-m", &profile]);
    let cut = |out: &[u8]| {
        let text = String::from_utf8_lossy(out).into_owned();
        text.lines().skip_while(|line| !line.starts_with("G43")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(cut(&ran.stdout), cut(&same.stdout));
    for (rule, says) in [("", "error[VP0232]"), ("turn = \"principal\"", "two pairs of angles")] {
        let profile = with_rule(&place, rule);
        let ran = run(&[&place.path("in.nc"), "-m", &profile]);
        assert_eq!(ran.status.code(), Some(1), "{rule}");
        assert!(messages(&ran).contains(says), "{rule}: {}", messages(&ran));
    }
}

#[test]
fn what_is_not_certain_of_a_tilted_plane_is_refused_by_name() {
    let plane = PLANES[0];
    for (blocks, says) in [
        ("G0 A-29.\n{}\nG0 X0. Y0. Z50.".to_owned(), "do not stand the tool upright"),
        ("{}\nG0 X0. Y0. Z50. A-20.".to_owned(), "a rotary axis turns inside a tilted plane"),
        ("{}\nG43.4 H1".to_owned(), "G43.4 inside a tilted plane"),
        ("G43.4 H1\n{}".to_owned(), "under tool centre point control"),
        ("G43 H1 G0 Z90.\n{}".to_owned(), "with a tool length in force"),
        ("{}\n{}".to_owned(), "inside a tilted plane"),
        ("{}\nG52 X1. Y0. Z0.".to_owned(), "moves the frame"),
        ("{}\nG28 Z0.".to_owned(), "moves axes of the machine"),
        ("G53.1".to_owned(), "without a tilted plane"),
        ("G68.2 P4 X0. Y0. Z0. I10. J0. K0.".to_owned(), "by projected angles"),
        ("G68.2 P3 Q1 X0. Y0. Z0. I0. J0. K0.".to_owned(), "a vector of no length"),
        ("G68.2 P3 Q1 X0. Y0. Z0. I1. J0. K0.\nG68.2 P3 Q2 I0.001 J0. K1.".to_owned(), "not at right angles"),
        ("G68.2 P2 Q1 X0. Y0. Z0.\nG0 X1.".to_owned(), "is not whole"),
    ] {
        let place =
            Place::new(&format!("G17 G21 G90 G94 G54\nG0 A-30. C0.\n{}\nM30\n", blocks.replace("{}", plane)));
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE]);
        assert_eq!(ran.status.code(), Some(1), "{blocks}");
        assert!(
            messages(&ran).contains(says) && messages(&ran).contains("help:"),
            "{blocks}: {}",
            messages(&ran)
        );
    }
}

/// Where the rotary axes stand at the start is knowledge: the program without their block comes out as with it.
#[test]
fn rotary_axes_may_be_said_to_stand_somewhere() {
    let whole = program("fanuc");
    let without = whole.replace("G0 A0 C0\n", "");
    let [out, corrected] = [(&whole, &[][..]), (&without, &["--start-at", "A=0,C=0"])].map(|(text, more)| {
        let place = Place::new(text);
        let ran = run(&[&[place.path("in.nc").as_str(), "-m", PROFILE, "-d", "fanuc"][..], more].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        String::from_utf8(ran.stdout).expect("text")
    });
    assert_eq!(out.replace("G0 A0 C0\n", ""), corrected);
    // The first rapid names A and C; a rapid of Z before it goes where nobody knows.
    let early = without.replace("G43.4 H1\n", "G0 Z300.\nG43.4 H1\n");
    let place = Place::new(&early);
    let input = place.path("in.nc");
    let command = |more: &[&str]| {
        let ran = run(&[&[input.as_str(), "-m", PROFILE, "-d", "fanuc"][..], more].concat());
        (ran.status.success(), messages(&ran))
    };
    let (done, said) = command(&[]);
    assert!(!done && said.contains("VP0213") && said.contains("--start-at A=0,C=0"), "{said}");
    assert!(command(&["--start-at", "A=0,C=0"]).0);
    // Or of every program of the machine.
    let profile = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let tables = crate::common::root().join("tests/profiles");
    let said = profile.replace("\"wavy_", &format!("\"{}/wavy_", tables.display()))
        + "\n[program]\nrotary_start = { A = 0, C = 0 }\n";
    std::fs::write(place.path("machine.toml"), said).expect("writable");
    let ran = run(&[&input, "-m", &place.path("machine.toml"), "-d", "fanuc"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    for (wrong, words) in [("B=0", "no such axis"), ("A=0,A=1", "said twice"), ("W=3", "no axis `W`")] {
        let (done, said) = command(&["--start-at", wrong]);
        assert!(!done && said.contains(words), "{said}");
    }
}
