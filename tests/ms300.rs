//! `machine-profiles/ms300_41.toml`: the 41 deviations of Serkov 2017 at his 60 points, added up here by hand.

use std::collections::BTreeMap;

use units::math::sin_cos;

use crate::common::{messages, root, run};

const PROFILE: &str = "machine-profiles/ms300_41.toml";
type Vector = [f64; 3];

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn unit(axis: usize) -> Vector {
    [0, 1, 2].map(|i| f64::from(u8::from(i == axis)))
}

/// Turned about X, Y or Z.
fn turned(v: Vector, axis: usize, degrees: f64) -> Vector {
    let (sin, cos) = sin_cos(degrees.to_radians());
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut to = v;
    (to[i], to[j]) = (cos * v[i] - sin * v[j], sin * v[i] + cos * v[j]);
    to
}

/// The six functions of an axis at a place, straight between nodes, um and urad.
fn functions(axis: char, at: f64) -> [f64; 6] {
    let path = root().join(format!("machine-profiles/ms300_41/{}.csv", axis.to_ascii_lowercase()));
    let text = std::fs::read_to_string(path).expect("readable");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    let next = rows.iter().position(|row| row[0] >= at).expect("within the table").max(1);
    let (low, high) = (&rows[next - 1], &rows[next]);
    let share = (at - low[0]) / (high[0] - low[0]);
    std::array::from_fn(|k| low[k + 1] + share * (high[k + 1] - low[k + 1]))
}

/// A number of the profile's text: `EX0B_um = 12.0`.
fn stated(text: &str, key: &str) -> f64 {
    let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("{key}"));
    line.split('=').nth(1).and_then(|value| value.trim().parse().ok()).expect("a number")
}

/// What each deviation alone does at a place, um, tool against workpiece, directions of X Y Z. First order:
/// one to one for lengths, the angle times its arm for angles.
fn contributions(text: &str, b: f64, c: f64) -> BTreeMap<String, Vector> {
    let tool = [0.0, 0.0, -100.0];
    let on_b = turned([120.0, 0.0, 50.0], 2, c);
    let ball = turned(on_b, 1, b);
    let axes = [0, 1, 2].map(|i| ball[i] - tool[i]);
    let mut all = BTreeMap::new();
    let mut add = |name: String, v: Vector, by: f64| all.insert(name, v.map(|x| x * by));
    // X carries Y, Y carries Z, Z the tool.
    for (k, axis) in ['X', 'Y', 'Z'].into_iter().enumerate() {
        let arm: Vector = std::array::from_fn(|i| tool[i] + if i > k { axes[i] } else { 0.0 });
        let f = functions(axis, axes[k]);
        for i in 0..3 {
            let (length, angle) = (["EX", "EY", "EZ"][i], ["EA", "EB", "EC"][i]);
            add(format!("{length}{axis}"), unit(i), f[i]);
            add(format!("{angle}{axis}"), cross(unit(i), arm), f[i + 3] * 1e-3);
        }
    }
    // ISO 230-1: the angle between the positive axes is smaller where EB0Z is positive, larger for the two others.
    for (name, towards, along, sign) in [("EC0Y", 0, 1, -1.0), ("EB0Z", 0, 2, 1.0), ("EA0Z", 1, 2, -1.0)] {
        add(
            name.to_owned(),
            unit(towards),
            sign * 1e-3 * stated(text, &format!("{name}_urad")) * axes[along],
        );
    }
    // The table moves under the tool: the other sign. What C does is turned by B.
    for (axis, about, angle, seen, back) in [('B', 1, b, ball, 0.0), ('C', 2, c, on_b, b)] {
        let f = functions(axis, angle);
        for i in 0..3 {
            let (length, turn) = (["EX", "EY", "EZ"][i], ["EA", "EB", "EC"][i]);
            let (shift, lean) = (turned(unit(i), 1, back), turned(cross(unit(i), seen), 1, back));
            add(format!("{length}{axis}"), shift, -f[i]);
            add(format!("{turn}{axis}"), lean, -f[i + 3] * 1e-3);
            // A place along the axis and a turn about it are no location errors of it.
            if i != about {
                add(format!("{length}0{axis}"), shift, -stated(text, &format!("{length}0{axis}_um")));
                add(format!("{turn}0{axis}"), lean, -1e-3 * stated(text, &format!("{turn}0{axis}_urad")));
            }
        }
    }
    all
}

fn length(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

fn sum<'a>(all: impl Iterator<Item = &'a Vector>) -> Vector {
    all.fold([0.0; 3], |s, v| [0, 1, 2].map(|i| s[i] + v[i]))
}

/// The longest sum that signs can make: from many directions, each vector with the sign that points there, until it stays.
fn longest(all: &BTreeMap<String, Vector>) -> f64 {
    let mut best = 0.0_f64;
    for k in 0..150 {
        let z = (f64::from(k) + 0.5) / 150.0;
        let (sin, cos) = sin_cos(2.399_963 * f64::from(k));
        let ring = (1.0 - z * z).sqrt();
        let mut towards = [ring * cos, ring * sin, z];
        for _ in 0..15 {
            let signed: Vec<Vector> =
                all.values().map(|v| v.map(|x| x * dot(*v, towards).signum())).collect();
            towards = sum(signed.iter());
        }
        best = best.max(length(towards));
    }
    best
}

#[test]
fn the_41_deviations_add_up_by_hand() {
    let checked = run(&["profile", "check", PROFILE]);
    assert!(checked.status.success(), "{}", messages(&checked));
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("budget.json");
    let json = json.to_str().expect("a plain path");
    let ran = run(&["budget", "-m", PROFILE, "--ball", "R=120,H=50,lead=B", "--json", json]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let found: serde_json::Value =
        serde_json::from_slice(&std::fs::read(json).expect("readable")).expect("JSON");
    let text = std::fs::read_to_string(root().join(PROFILE)).expect("readable");
    let places = [30.0, 0.0, -30.0, -60.0, -90.0]
        .into_iter()
        .flat_map(|b| (0..12).map(move |k| (b, 30.0 * f64::from(k))))
        .map(|(b, c)| contributions(&text, b, c))
        .collect::<Vec<_>>();
    assert_eq!((places.len(), places[0].len()), (60, 41));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let deviations = found["deviations"].as_array().expect("a list");
    assert_eq!((found["control_points"].as_u64(), deviations.len()), (Some(60), 41));
    // Each alone. Products of two deviations make 0.002 um, and the file has four decimals.
    for deviation in deviations {
        let name = deviation["name"].as_str().expect("a name");
        let sizes: Vec<f64> = places.iter().map(|all| length(all[name])).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let spread = largest - sizes.iter().copied().fold(f64::MAX, f64::min);
        let alone = &deviation["alone"];
        assert!((number(&alone["M_um"]) - largest).abs() < 2e-3, "{name}: {largest}, {alone}");
        assert!((number(&alone["A_um"]) - spread).abs() < 2e-3, "{name}: {spread}, {alone}");
    }
    // Together as measured, and the worst of 2^41 choices of signs.
    let together: Vec<f64> = places.iter().map(|all| length(sum(all.values()))).collect();
    let largest = together.iter().copied().fold(0.0, f64::max);
    let spread = largest - together.iter().copied().fold(f64::MAX, f64::min);
    let measured = &found["measured"];
    assert!((number(&measured["M_um"]) - largest).abs() < 0.01, "{largest}, {measured}");
    assert!((number(&measured["A_um"]) - spread).abs() < 0.01, "{spread}, {measured}");
    let worst = places.iter().map(longest).fold(0.0, f64::max);
    let stated = number(&found["signs_free"]["worst_case"]["um"]);
    assert!((stated - worst).abs() < 0.01, "{worst}, {stated}");
    println!("M {largest:.2} um, A {spread:.2} um, worst of 2^41 {worst:.2} um");
}
