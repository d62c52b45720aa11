//! The exact oracles of another hand: `tests/judges/turning/oracles.json`.

#![allow(clippy::disallowed_methods, reason = "the formulas are the standard library's on purpose")]

use machine_model::{
    Chain, Command, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Vector,
};
use serde_json::Value;
use turning::{
    Bending, Clamping, ErrorMotion, Force, Harmonic, Lathe, Spindle, Tailstock, Tip, Workpiece, roughness,
};

const FILE: &str = include_str!("../../../tests/judges/turning/oracles.json");

fn at(x: f64, z: f64) -> Command {
    Command { linear_mm: Vector::new(x, 0.0, z), ..Default::default() }
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or(0.0)
}

fn numbers(value: &Value, name: &str) -> Vec<f64> {
    value[name].as_array().map_or_else(Vec::new, |list| list.iter().filter_map(Value::as_f64).collect())
}

fn pair(value: &Value, name: &str) -> [f64; 2] {
    let list = numbers(value, name);
    [0, 1].map(|i| list.get(i).copied().unwrap_or(0.0) * 1e-3)
}

fn bending(inputs: &Value) -> Bending {
    let force = number(inputs, "radial_force_n");
    if force == 0.0 {
        return Bending::default();
    }
    let length = number(inputs, "length_mm");
    let rows = inputs["diameters_mm"].as_array().map_or_else(
        || vec![[0.0, number(inputs, "diameter_mm")], [length, number(inputs, "diameter_mm")]],
        |rows| rows.iter().map(|row| [0, 1].map(|i| row[i].as_f64().unwrap_or(0.0))).collect(),
    );
    let clamping = match inputs["clamping"].as_str() {
        Some("centres") => Clamping::Centres { at_mm: length },
        Some("chuck-tailstock") => Clamping::ChuckAndTailstock { at_mm: length },
        _ => Clamping::Chuck,
    };
    let bar = Workpiece {
        diameters_mm: rows,
        youngs_modulus_n_mm2: 1e3 * number(inputs, "e_gpa"),
        clamping,
        steady_rests_mm: inputs["steady_mm"].as_f64().into_iter().collect(),
    };
    Bending::new(&bar, Force::Radial { newton: force }).expect("a bar")
}

fn harmonics(inputs: &Value, axis: &str) -> Vec<Harmonic> {
    let (cosines, sines) =
        (numbers(inputs, &format!("E{axis}S_cos_um")), numbers(inputs, &format!("E{axis}S_sin_um")));
    let of = |list: &[f64], phase_rad: f64| {
        let term =
            move |(k, um): (usize, &f64)| Harmonic { order: k as u32 + 1, amplitude: um * 1e-3, phase_rad };
        list.iter().enumerate().map(term).collect::<Vec<_>>()
    };
    [of(&cosines, 0.0), of(&sines, -std::f64::consts::FRAC_PI_2)].concat()
}

fn lathe(inputs: &Value) -> Lathe {
    let urad = |name: &str| number(inputs, name) * 1e-6;
    let axis = || LinearAxis::perfect(Range { low: -200.0, high: 400.0 });
    let linear = RigidBody::new(Description {
        chain: Chain::parse("[w b Z X Y t]").expect("a chain"),
        linear: [axis(), axis(), axis()],
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness { eb0z_rad: urad("EB0Z_urad"), ..Squareness::default() },
    })
    .expect("a machine");
    let tailstock = inputs["tailstock_mm"]
        .as_f64()
        .map(|at_mm| Tailstock { at_mm, offset_mm: pair(inputs, "tailstock_offset_um") });
    let spindle = Spindle {
        tilt_rad: [urad("EA0S_urad"), urad("EB0S_urad")],
        headstock_mm: pair(inputs, "headstock_offset_um"),
        tailstock,
        synchronous: ErrorMotion {
            x: harmonics(inputs, "X"),
            y: harmonics(inputs, "Y"),
            ..ErrorMotion::default()
        },
        ..Spindle::default()
    };
    let tip = Tip { height_mm: number(inputs, "height_mm"), ..Tip::default() };
    Lathe::new(Box::new(linear), spindle, bending(inputs), tip, &[])
}

#[test]
fn oracles_of_the_judge() {
    let file: Value = serde_json::from_str(FILE).expect("JSON");
    let mut compared = 0;
    for case in file["cases"].as_array().expect("cases") {
        let (id, inputs) = (case["id"].as_str().expect("a name"), &case["inputs"]);
        let near_um = number(case, "tolerance_um");
        let lathe = lathe(inputs);
        let radius = if inputs["radius_mm"].is_null() { 20.0 } else { number(inputs, "radius_mm") };
        let gained_um = |z: f64| (lathe.turned_mm(&at(radius, z))[0] - radius) * 1e3;
        for (name, wanted) in case["expected"].as_object().expect("figures") {
            let wanted = wanted.as_f64().expect("a number");
            let place = name.rsplit_once("_at_").and_then(|(_, z)| z.parse().ok());
            let z = place.unwrap_or_else(|| number(inputs, "z_mm"));
            let section = || lathe.section(&at(radius, z), number(inputs, "angles") as usize);
            let ridge = || roughness(number(inputs, "feed_mm_rev"), number(inputs, "nose_radius_mm"), None);
            let found = match name.split("_at_").next().unwrap_or_default() {
                "diameter_error_um" => 2.0 * gained_um(z),
                "radius_error_um" if inputs["angles"].is_null() => gained_um(z),
                "radius_error_um" => (section().least_squares().radius_mm - radius) * 1e3,
                "largest_radius_error_um" => gained_um(number(case, "largest_at_mm")),
                "pip_diameter_um" => 2e3 * lathe.height_mm(&at(0.0, 0.0)).abs(),
                "roundness_least_squares_um" => 1e3 * section().least_squares().roundness_mm,
                "roundness_minimum_zone_um" => 1e3 * section().minimum_zone().roundness_mm,
                "displacement_um" => {
                    let [x, y] = section().least_squares().centre_mm;
                    1e3 * (x * x + y * y).sqrt()
                }
                "rz_exact_um" => 1e3 * ridge().exact_mm.expect("arcs meet"),
                "rz_parabola_um" => 1e3 * ridge().usual_mm,
                other => panic!("{id}: nobody knows {other}"),
            };
            assert!((found - wanted).abs() <= near_um, "{id} {name}: {found}, wanted {wanted}");
            compared += 1;
        }
    }
    assert!(compared > 30, "only {compared} figures");
}
