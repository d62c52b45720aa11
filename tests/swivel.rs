//! CYCLE800 of Sinumerik: the tip goes where the arguments say, by formulas of this file alone.

use std::fmt::Write as _;

use crate::common::{messages, run};
use crate::five_axis::{CONTROL_MM, PROFILE, Place, ZERO_MM, axis_command, tips_are_there, with_rule, word};

type Three = [f64; 3];

/// By `_MODE`: the axes of the turns in their order.
const ORDERS: [(u32, &str); 6] =
    [(57, "XYZ"), (45, "XZY"), (54, "YXZ"), (30, "YZX"), (39, "ZXY"), (27, "ZYX")];

/// X Y Z in the plane at the end of each block.
const IN_PLANE: [Three; 6] = [
    [0.0, 0.0, 40.0],
    [0.0, 0.0, 2.0],
    [25.0, 4.0, 2.0],
    [5.0, 30.0, 1.0],
    [-15.0, 10.0, 1.0],
    [-10.0, -5.0, 3.0],
];

/// One call: `_MODE` by its place in [`ORDERS`], and the three triples.
struct Swivel {
    order: usize,
    before_mm: Three,
    angles_deg: Three,
    behind_mm: Three,
}

fn turned(axis: char, angle_deg: f64, [x, y, z]: Three) -> Three {
    let (sin, cos) = units::math::sin_cos(angle_deg.to_radians());
    match axis {
        'X' => [x, cos * y - sin * z, sin * y + cos * z],
        'Y' => [cos * x + sin * z, y, cos * z - sin * x],
        _ => [cos * x - sin * y, sin * x + cos * y, z],
    }
}

fn plus(a: Three, b: Three) -> Three {
    [0, 1, 2].map(|i| a[i] + b[i])
}

impl Swivel {
    /// Of a vector in the plane's coordinates: in those that the call counts in. The last turn is done first.
    fn turned(&self, mut at: Three) -> Three {
        let turns: Vec<(char, f64)> = ORDERS[self.order].1.chars().zip(self.angles_deg).collect();
        for (axis, angle_deg) in turns.into_iter().rev() {
            at = turned(axis, angle_deg, at);
        }
        at
    }

    fn place(&self, at: Three) -> Three {
        plus(self.before_mm, self.turned(plus(self.behind_mm, at)))
    }

    fn call(&self, additive: bool, direction: i32) -> String {
        let three = |values: Three| values.map(|value| value.to_string()).join(",");
        format!(
            "CYCLE800(0,\"\",{},{},{},{},{},{direction},,1)",
            u8::from(additive),
            ORDERS[self.order].0,
            three(self.before_mm),
            three(self.angles_deg),
            three(self.behind_mm),
        )
    }
}

/// Where the planes lie one in the other.
fn in_workpiece(planes: &[Swivel], at: Three) -> Three {
    plus(ZERO_MM, planes.iter().rev().fold(at, |at, plane| plane.place(at)))
}

/// A and C of a rotary table on a tilting one that stand the tool along this direction, A below 0 or above:
/// it is `Rz(-C) Rx(-A) z = (sin C sin A, cos C sin A, cos A)`.
fn angles([x, y, z]: Three, above: bool) -> [f64; 2] {
    let sign = if above { 1.0 } else { -1.0 };
    let tilt = units::math::atan2(units::math::hypot(x, y), z).to_degrees();
    [sign * tilt, units::math::atan2(sign * x, sign * y).to_degrees()]
}

fn program(calls: &str) -> String {
    format!(
        "G17 G71 G90 G94 G54\nG0 A=0 C=0\n{calls}\nG0 X0 Y0 Z40\nG1 Z2 F600\nX25 Y4\nX5 Y30 Z1\n\
         G2 X-15 Y10 I-20 J0\nG1 X-10 Y-5 Z3\nG0 Z60\nCYCLE800()\nM30\n"
    )
}

const RULE: &str = "direction_reference = \"A\"\nturn = \"principal\"";

/// Corrects the cut in these planes, and asks a model of the machine where the tip goes. A ends `above` 0 or below.
fn tips_are_in(planes: &[Swivel], direction: i32, above: bool) {
    let calls: Vec<String> =
        planes.iter().enumerate().map(|(k, plane)| plane.call(k > 0, direction)).collect();
    let place = Place::new(&program(&calls.join("\n")));
    let profile = with_rule(&place, RULE);
    let [from, to, points] = ["in.nc", "out.nc", "points.csv"].map(|name| place.path(name));
    let ran = run(&[&from, "-m", &profile, "--zero", "true", "-d", "sinumerik", "-o", &to]);
    assert!(ran.status.success(), "{calls:?}: {}", messages(&ran));
    let check = run(&["check", &from, &to, "-m", &profile, "--zero", "true", "-d", "sinumerik"]);
    assert!(check.status.success(), "{calls:?}: {}", String::from_utf8_lossy(&check.stdout));
    let same = run(&["check", &from, &from, "-m", &profile, "--zero", "true", "-d", "sinumerik"]);
    assert_eq!(same.status.code(), Some(1), "uncorrected it is off: {calls:?}");

    let [zero, up] = [[0.0; 3], [0.0, 0.0, 1.0]].map(|at| in_workpiece(planes, at));
    let [a, c] = angles([0, 1, 2].map(|i| up[i] - zero[i]), above);
    let made = std::fs::read_to_string(&to).expect("written");
    let mut table = "x_mm,y_mm,z_mm,a_deg,c_deg,tool_x_mm,tool_y_mm,tool_z_mm\n".to_owned();
    let (mut at, mut wanted) = ([0.0; 3], Vec::new());
    let cut = made.lines().skip_while(|line| !line.starts_with("CYCLE800(0")).skip(calls.len());
    for line in cut.take_while(|line| *line != "CYCLE800()") {
        for (value, letter) in at.iter_mut().zip(['X', 'Y', 'Z']) {
            *value = word(line, letter).unwrap_or(*value);
        }
        let near = |place: &&Three| (0..3).all(|i| (place[i] - at[i]).abs() < 0.3);
        let Some(ends) = IN_PLANE.iter().find(near) else { continue };
        let [x, y, z] = in_workpiece(planes, at);
        let [x, y, z] = axis_command([x, y, z, a, c], 0.0, CONTROL_MM);
        writeln!(table, "{x},{y},{z},{a},{c},0,0,0").expect("a string takes all");
        wanted.push(in_workpiece(planes, *ends));
    }
    assert!(wanted.len() >= IN_PLANE.len(), "{calls:?}:\n{made}");
    std::fs::write(&points, table).expect("writable");
    // The tolerance, and half an output step in each direction: an end may lie within both.
    tips_are_there(&points, &wanted, 1.9, &calls.join(" "));
}

#[test]
fn the_tip_goes_where_the_swivelled_plane_says() {
    for order in 0..ORDERS.len() {
        let angles_deg = [20.0, -15.0, 35.0];
        tips_are_in(
            &[Swivel { order, before_mm: [20.0, 10.0, 5.0], angles_deg, behind_mm: [3.0, -2.0, 4.0] }],
            -1,
            false,
        );
    }
}

#[test]
fn a_swivel_adds_to_the_plane_in_force() {
    let first =
        Swivel { order: 0, before_mm: [0.0, 0.0, 20.0], angles_deg: [-15.0, 0.0, 0.0], behind_mm: [0.0; 3] };
    let second = Swivel {
        order: 2,
        before_mm: [15.0, -4.0, 0.0],
        angles_deg: [7.0, 12.0, 0.0],
        behind_mm: [0.0, 1.0, 0.0],
    };
    tips_are_in(&[first, second], -1, false);
}

/// A travels from -100 to 30: to 20 there are two ways, to 40 there is one, whatever is asked for.
#[test]
fn the_direction_chooses_where_there_is_a_choice() {
    for (angle, direction, above) in [(20.0, 1, true), (20.0, -1, false), (40.0, 1, false)] {
        let plane = Swivel {
            order: 0,
            before_mm: [0.0, 0.0, 10.0],
            angles_deg: [angle, 5.0, 0.0],
            behind_mm: [0.0; 3],
        };
        tips_are_in(&[plane], direction, above);
    }
}

fn refused(calls: &str, rule: &str) -> String {
    let place = Place::new(&program(calls));
    let profile = with_rule(&place, rule);
    let ran = run(&[&place.path("in.nc"), "-m", &profile, "-d", "sinumerik"]);
    assert_eq!(ran.status.code(), Some(1), "{calls} {rule}");
    messages(&ran)
}

#[test]
fn what_is_not_certain_of_a_swivel_is_refused_by_name() {
    for (calls, says) in [
        ("CYCLE800(0,\"\",0,64,0,0,0,20,0,0,0,0,0,-1)", "a solid angle"),
        ("CYCLE800(0,\"\",0,128,0,0,0,20,0,0,0,0,0,-1)", "projected angles"),
        ("CYCLE800(0,\"\",0,192,0,0,0,20,0,0,0,0,0,-1)", "the rotary axes' own angles"),
        ("CYCLE800(0,\"\",0,25,0,0,0,20,0,0,0,0,0,-1)", "not X, Y and Z once each"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,0)", "for axes that do not turn"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0)", "which way is not said"),
        ("CYCLE800(0,\"\",100,57,0,0,0,20,0,0,0,0,0,-1)", "align the tool"),
        ("CYCLE800(0,\"\",200000,57,0,0,0,20,0,0,0,0,0,-1)", "another direction than _DIR"),
        ("CYCLE800(3,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", "_FR = `3`"),
        ("CYCLE800(5,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,-10)", "a way back below 0"),
        ("CYCLE800(0,\"\",0,57,0,0,0,R5,0,0,0,0,0,-1)", "not a plain number"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,,2)", "_DMODE = `2`"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,,0,7)", "a seventeenth argument"),
        ("G0 CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", "in one block"),
        ("G70\nCYCLE800(0,\"\",0,57,1,0,0,20,0,0,0,0,0,-1)", "lengths under inches"),
        ("TRAORI\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", "under tool centre point control"),
        ("TRANS X5\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", "while a frame of the program is in force"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nG0 A=5", "a rotary axis turns inside a tilted plane"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nG55", "work offset"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nTRAORI", "TRAORI inside a tilted plane"),
        ("CYCLE800(0,\"\",0,57,0,0,0,0,170,0,0,0,0,-1)", "no angles within travel"),
    ] {
        let said = refused(calls, RULE);
        assert!(said.contains(says) && said.contains("help:"), "{calls}: {said}");
    }
    let call = "CYCLE800(1,\"TC1\",0,57,0,0,0,20,0,0,0,0,0,-1)";
    let said = refused(call, "turn = \"principal\"");
    assert!(said.contains("VP0232") && said.contains("direction_reference = \"A\""), "{said}");
    // Upright, C may stand anywhere: where it does not stand at 0, the control's way must be said.
    let said = refused("G0 C=30\nCYCLE800(1,\"TC1\",0,57,0,0,0,0,0,0,0,0,0,-1)", RULE);
    assert!(said.contains("may stand anywhere"), "{said}");
}

/// What no plane is: at the head of a program, and behind a plane. A retraction leaves X, Y and Z to the next words.
#[test]
fn planes_that_are_none_and_ends_of_planes_pass() {
    let upright = "CYCLE800(1,\"TC1\",0,57,0,0,0,0,0,0,0,0,0,1,,0)";
    let place = Place::new(&program(upright));
    let profile = with_rule(&place, RULE);
    let ran = run(&[&place.path("in.nc"), "-m", &profile, "-d", "sinumerik"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    for end in ["CYCLE800()", "CYCLE800(2,\"0\",100000,57,0,0,0,0,0,0,0,0,0,-1,,1)"] {
        let text = format!(
            "G17 G71 G90 G94 G54\nG0 A=0 C=0\n{}\nG0 X0 Y0 Z40\nG1 Z2 F600\n{end}\nG1 X5 F200\nM30\n",
            "CYCLE800(1,\"TC1\",100000,57,0,0,0,20,0,0,0,0,0,-1,,1)"
        );
        std::fs::write(place.path("in.nc"), &text).expect("writable");
        let ran = run(&[&place.path("in.nc"), "-m", &profile, "--zero", "true", "-d", "sinumerik"]);
        assert_eq!(ran.status.code(), Some(1), "{end}");
        let said = messages(&ran);
        assert!(said.contains("the tilted plane in line 6"), "{end}: {said}");
        std::fs::write(place.path("in.nc"), text.replace("G1 X5 F", "G0 X5 Y0 Z90\nG1 X9 F"))
            .expect("writable");
        let ran = run(&[&place.path("in.nc"), "-m", &profile, "--zero", "true", "-d", "sinumerik"]);
        assert!(ran.status.success(), "{end}: {}", messages(&ran));
    }
}

/// Without the section the profile says nothing of the control's kinematics; a machine of three axes has none.
#[test]
fn without_kinematics_only_the_end_of_a_plane_passes() {
    let whole = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let start = whole.find("[kinematics]").expect("a section");
    let tables = crate::common::root().join("tests/profiles");
    let bare =
        whole[..start].replace("\"wavy_", &format!("\"{}/wavy_", tables.to_str().expect("a plain path")));
    for (call, status) in [
        ("CYCLE800()", 0),
        ("CYCLE800(0,\"0\",0,57,0,0,0,0,0,0,0,0,0,-1)", 0),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", 1),
    ] {
        let place = Place::new(&program(call));
        let profile = place.path("machine.toml");
        std::fs::write(&profile, &bare).expect("writable");
        let ran = run(&[&place.path("in.nc"), "-m", &profile, "--zero", "true", "-d", "sinumerik"]);
        assert_eq!(ran.status.code(), Some(status), "{call}: {}", messages(&ran));
        assert_eq!(messages(&ran).contains("error[VP0231]"), status == 1, "{call}: {}", messages(&ran));
    }
}
