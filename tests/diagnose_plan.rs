//! `vpost diagnose --plan`: the design separates the causes, the rows can be filled in, the program runs.

use crate::common::{have_interpreter, messages, referee, run};
use gap_diagnosis::{Confounding, Measurements, Reading, Row, confounding};
use machine_model::effects::{Conditions, EffectGeometry, EffectKind};
use machine_model::{Command, Vector};

const PROFILES: [&str; 3] = [
    "samples/diagnosis/backlash.toml",
    "machine-profiles/stan_s500.toml",
    "machine-profiles/generic_vmc.toml",
];

/// What the command prints and says.
fn plan(form: &str, profile: &str, more: &[&str]) -> (String, String) {
    let ran = run(&[&["diagnose", "--plan", form, "-m", profile], more].concat());
    assert!(ran.status.success(), "{profile}: {}", messages(&ran));
    (String::from_utf8(ran.stdout.clone()).expect("text"), messages(&ran))
}

/// Rows of a plan as the diagnosis would see them, read by code of this test's own.
fn design(csv: &str, profile: &str, kept: &dyn Fn(&str) -> bool) -> Measurements {
    let text = std::fs::read_to_string(crate::common::root().join(profile)).expect("a profile");
    let chain = text.lines().find_map(|line| line.strip_prefix("chain")).expect("a chain");
    let chain = machine_model::Chain::parse(chain.split('"').nth(1).expect("in quotes")).expect("a chain");
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut data = Measurements {
        runs: Vec::new(),
        instruments: Vec::new(),
        rows: Vec::new(),
        geometry: EffectGeometry::from_chain(&chain),
    };
    for line in lines.filter(|line| kept(line)) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), header.len(), "{line}");
        let value = |name: &str| {
            let field = fields[header.iter().position(|h| *h == name).expect("the column")];
            (!field.is_empty()).then(|| field.parse::<f64>().expect("a number"))
        };
        let three = |names: [&str; 3]| Vector::from(names.map(|n| value(n).expect("filled in")));
        if data.runs.last().is_none_or(|run| run != fields[0]) {
            data.runs.push(fields[0].to_owned());
        }
        let command = Command {
            linear_mm: three(["x_mm", "y_mm", "z_mm"]),
            rotary_rad: Vector::zeros(),
            tool_mm: three(["tool_x_mm", "tool_y_mm", "tool_z_mm"]),
            direction: ["dir_x", "dir_y", "dir_z"].map(|n| value(n).expect("filled in") as i8),
            ..Default::default()
        };
        let unread = Reading::Displacement([Some(0.0); 3]);
        data.rows.push(Row {
            conditions: Conditions {
                time_s: value("time_s"),
                feed_mm_min: value("feed_mm_min"),
                ..Conditions::default()
            },
            ..Row::new(data.runs.len() - 1, command, unread)
        });
    }
    data
}

/// A warm-up moves a machine as slowly as a tracker drifts: only a fixed target tells them apart, which is no line.
fn inherent(a: EffectKind, b: EffectKind) -> bool {
    let warm = |k| matches!(k, EffectKind::Warmup(_));
    let drift = |k| matches!(k, EffectKind::InstrumentDrift);
    warm(a) && drift(b) || drift(a) && warm(b)
}

#[test]
fn no_pair_of_effects_looks_alike_on_the_planned_lines() {
    for profile in PROFILES {
        let (csv, said) = plan("points", profile, &[]);
        let found = confounding(&design(&csv, profile, &|_| true));
        assert!(found.effects.len() > 45, "{profile}: only {} effects are asked about", found.effects.len());
        assert!(found.hidden.is_empty(), "{profile}: {:?}", found.hidden);
        for (a, b, value) in found.pairs(Confounding::ALIKE) {
            assert!(inherent(a, b), "{profile}: {a} and {b}, {value}");
            // What cannot be separated is said, with the reason.
            let line = said.lines().find(|l| l.contains(&a.to_string()) && l.contains(&b.to_string()));
            assert!(line.is_some_and(|l| l.contains("fixed target")), "{said}");
        }
    }
}

/// The check can fail: without the second and third tool an angle is a squareness, read one way a backlash is nothing.
#[test]
fn poorer_lines_do_look_alike() {
    let (csv, _) = plan("points", PROFILES[0], &[]);
    let one_tool = design(&csv, PROFILES[0], &|line| !line.contains("tool,") && !line.contains("aside,"));
    let alike = confounding(&one_tool).pairs(Confounding::ALIKE);
    let angular = alike.iter().filter(|(a, b, _)| {
        [a, b].iter().any(|k| matches!(k, EffectKind::Angular { .. })) && !inherent(*a, *b)
    });
    assert!(angular.count() > 0, "{alike:?}");
    let one_way = design(&csv, PROFILES[0], &|line| !line.split(',').skip(7).take(3).any(|f| f == "-1"));
    let effects = confounding(&one_way).effects;
    assert!(!effects.iter().any(|k| matches!(k, EffectKind::Backlash(0))), "{effects:?}");
}

/// Filled in with readings of a machine that has a backlash and a squareness, the plan finds both.
#[test]
fn a_plan_that_was_filled_in_names_the_causes() {
    let (csv, _) = plan("points", PROFILES[0], &[]);
    let mut state = 1_u64;
    // Sum of twelve uniform numbers: a standard deviation of 1.
    let mut noise = || {
        (0..12)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    };
    let filled: String = csv
        .lines()
        .enumerate()
        .map(|(at, line)| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            if at > 0 {
                let number = |k: usize| fields[k].parse::<f64>().expect("a number");
                let (y, dir_x) = (number(2), number(7));
                // diagnosis.md: dx = -h dir_x, dx = -a y; 4 um and 30 urad.
                let dx = -4.0 * dir_x - 0.030 * y + noise();
                let values = [dx, noise(), noise()];
                for (field, value) in fields[4..7].iter_mut().zip(values) {
                    *field = format!("{value:.3}");
                }
            }
            fields.join(",") + "\n"
        })
        .collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("filled.csv");
    std::fs::write(&path, filled).expect("writable");
    let ran = run(&["diagnose", path.to_str().expect("a plain path"), "-m", PROFILES[0]]);
    let text = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{}", messages(&ran));
    let first = text.lines().next().unwrap_or_default();
    assert!(
        first.starts_with("NAMED") && first.contains("backlash.X") && first.contains("squareness.XY"),
        "{text}"
    );
}

#[test]
fn the_program_goes_through_the_points_in_order() {
    let profile = "machine-profiles/generic_vmc.toml";
    let (csv, _) = plan("points", profile, &[]);
    let (program, _) = plan("program", profile, &[]);
    // G54 of that profile.
    let zero = [-440.0, -250.0, -350.0];
    let mut motions = program.lines().filter(|l| l.starts_with("G1 X") && l.contains('Z')).map(|line| {
        let words = line.split(' ').skip(1);
        words.zip(zero).map(|(w, z)| w[1..].parse::<f64>().expect("a number") + z).collect::<Vec<f64>>()
    });
    for line in csv.lines().skip(1) {
        let point: Vec<f64> = line.split(',').skip(1).take(3).map(|f| f.parse().expect("a number")).collect();
        let same = |m: &Vec<f64>| m.iter().zip(&point).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(motions.any(|m| same(&m)), "the program does not come to {line}");
    }
    assert!(
        program.contains("G4 X3.0") && program.contains("G49") && program.contains("M0"),
        "dwell, length, stop"
    );
}

/// Every dialect: a perfect machine leaves the program as it is, so vpost understands every block of it.
#[test]
fn the_program_is_one_that_vpost_accepts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("plan.nc");
    let name = path.to_str().expect("a plain path");
    for dialect in ["fanuc", "linuxcnc", "centroid", "perspektiva", "balt-system", "sinumerik"] {
        let (program, _) = plan("program", "machine-profiles/perfect.toml", &["-d", dialect]);
        std::fs::write(&path, &program).expect("writable");
        let ran = run(&[name, "-m", "machine-profiles/perfect.toml", "-d", dialect]);
        assert!(ran.status.success(), "{dialect}: {}", messages(&ran));
        assert!(ran.stdout == program.as_bytes(), "{dialect}: the program was changed");
    }
}

/// A tilting rotary table, its axes through these points.
const TILTING: &str = "samples/profiles/tilting_table.toml";
const CENTRE: [f64; 3] = [200.0, 200.0, 100.0];

/// Where the table sees the tool's end of a machine [w C A X Y b Z t], and which way it sees the tool point: `Rz(-C) Rx(-A)`.
fn seen(q: [f64; 3], tool_mm: f64, a: f64, c: f64) -> [[f64; 3]; 2] {
    let back = |v: [f64; 3]| {
        let (sin, cos) = units::math::sin_cos(a.to_radians());
        let [x, y, z] = [v[0], cos * v[1] + sin * v[2], cos * v[2] - sin * v[1]];
        let (sin, cos) = units::math::sin_cos(c.to_radians());
        [cos * x + sin * y, cos * y - sin * x, z]
    };
    let arm = [q[0] - CENTRE[0], q[1] - CENTRE[1], q[2] + tool_mm - CENTRE[2]];
    [back(arm), back([0.0, 0.0, 1.0])]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn linear_axes_follow_a_target_while_rotary_ones_turn() {
    let (csv, said) = plan("points", TILTING, &[]);
    assert!(!said.contains("except everything of"), "{said}");
    let header: Vec<&str> = csv.lines().next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|known| *known == name).expect("the column");
    let mut runs: Vec<(String, Vec<[f64; 6]>)> = Vec::new();
    for line in csv.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), header.len());
        let value = |name: &str| fields[column(name)].parse::<f64>().expect("a number");
        let row = ["x_mm", "y_mm", "z_mm", "tool_z_mm", "a_deg", "c_deg"].map(value);
        if runs.last().is_none_or(|(run, _)| run != fields[0]) {
            runs.push((fields[0].to_owned(), Vec::new()));
        }
        runs.last_mut().expect("just added").1.push(row);
    }
    let turning: Vec<&(String, Vec<[f64; 6]>)> = runs.iter().filter(|(run, _)| run.contains("BK")).collect();
    let names: Vec<&str> = turning.iter().map(|(run, _)| &run[3..]).collect();
    let each = ["BK1 C", "BK2 A", "BK4 C A"];
    let longer = each.map(|name| format!("{name} longer tool"));
    assert_eq!(names, each.into_iter().chain(longer.iter().map(String::as_str)).collect::<Vec<_>>());
    for (run, rows) in &turning {
        let places: Vec<_> = rows.iter().map(|[x, y, z, t, a, c]| seen([*x, *y, *z], *t, *a, *c)).collect();
        // Places are rounded to hundredths.
        assert!(places.iter().all(|[tip, _]| apart(*tip, places[0][0]) < 0.02), "{run}: {places:?}");
        let way =
            rows.iter().map(|row| apart([row[0], row[1], row[2]], [rows[0][0], rows[0][1], rows[0][2]]));
        assert!(way.fold(0.0, f64::max) > 100.0, "{run}: a short arm shows little");
        if run.contains("BK4") {
            let (sin, cos) = units::math::sin_cos(10f64.to_radians());
            for [_, towards] in &places {
                let angle = units::math::acos(sin * towards[0] + cos * towards[2]).to_degrees();
                assert!((angle - 15.0).abs() < 0.02, "{run}: {towards:?}");
            }
        }
    }
    // The program passes all of them, and leaves the target nowhere on the way.
    let (program, _) = plan("program", TILTING, &[]);
    let zero = [200.0, 200.0, 150.0];
    let (mut target, mut at, mut tool_mm) = (None, [0.0; 5], 0.0);
    let mut wanted = turning.iter().flat_map(|(_, rows)| rows).peekable();
    for line in program.lines() {
        if let Some(rest) = line.split("TARGET AT ").nth(1).or_else(|| line.split("target at ").nth(1)) {
            tool_mm = rest.split(' ').nth(2).expect("three numbers").parse().expect("a number");
        }
        if !(line.starts_with("G1 X") && line.contains('C')) {
            target = None;
            continue;
        }
        let mut to = at;
        for word in line.split(' ').skip(1) {
            let k = ['X', 'Y', 'Z', 'A', 'C']
                .iter()
                .position(|letter| word.starts_with(*letter))
                .expect("an axis");
            to[k] = word[1..].parse::<f64>().expect("a number") + if k < 3 { zero[k] } else { 0.0 };
        }
        let place = |v: [f64; 5]| seen([v[0], v[1], v[2]], tool_mm, v[3], v[4])[0];
        let target = target.get_or_insert_with(|| place(to));
        let from = if apart(place(at), *target) < 0.05 { at } else { to };
        for s in [0.25, 0.5, 0.75, 1.0] {
            let off = apart(place([0, 1, 2, 3, 4].map(|i| from[i] + (to[i] - from[i]) * s)), *target);
            assert!(off < 0.04, "{off} mm off the target at {line}");
        }
        at = to;
        if wanted.peek().is_some_and(|row| apart([row[0], row[1], row[2]], [at[0], at[1], at[2]]) < 1e-6) {
            wanted.next();
        }
    }
    assert_eq!(wanted.next(), None, "the program does not come there");
}

/// A perfect table leaves the program as it is.
#[test]
fn vpost_accepts_the_program_with_rotary_axes() {
    let text = std::fs::read_to_string(crate::common::root().join(TILTING)).expect("readable");
    let perfect: String = text
        .lines()
        .filter(|line| !line.contains("_um ") && !line.contains("_urad "))
        .map(|line| line.to_owned() + "\n")
        .collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [machine, path] = ["machine.toml", "plan.nc"].map(|name| folder.path().join(name));
    std::fs::write(&machine, perfect).expect("writable");
    let [machine, name] = [&machine, &path].map(|path| path.to_str().expect("a plain path"));
    for dialect in ["fanuc", "linuxcnc", "sinumerik"] {
        let (program, _) = plan("program", machine, &["-d", dialect]);
        assert!(program.contains(if dialect == "sinumerik" { "C=" } else { " C" }), "{dialect}");
        std::fs::write(&path, &program).expect("writable");
        let ran = run(&[name, "-m", machine, "-d", dialect]);
        assert!(ran.status.success(), "{dialect}: {}", messages(&ran));
        assert!(ran.stdout == program.as_bytes(), "{dialect}: the program was changed");
    }
}

#[test]
fn the_second_judge_runs_the_program() {
    if !have_interpreter() {
        println!("skipped: linuxcnc-uspace is not installed");
        return;
    }
    // The second judge interpolates tables linearly.
    let profile = "machine-profiles/stan_s500.toml";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [input, output] = ["plan.ngc", "out.ngc"].map(|name| folder.path().join(name));
    let (program, _) = plan("program", profile, &["-d", "linuxcnc"]);
    std::fs::write(&input, program).expect("writable");
    let [from, to] = [&input, &output].map(|p| p.to_str().expect("a plain path"));
    let ran = run(&[from, "-m", profile, "-d", "linuxcnc", "--zero", "true", "-o", to]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let verdict = referee(&input, &output, profile, "linuxcnc", &[]);
    assert_eq!(verdict["ok"], true, "{verdict:#}");
}

#[test]
fn a_plan_needs_a_work_offset_for_its_program_only() {
    let profile = "samples/diagnosis/backlash.toml";
    plan("points", profile, &[]);
    let ran = run(&["diagnose", "--plan", "program", "-m", profile, "-d", "fanuc"]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(messages(&ran).contains("--work-offset G54=0,0,0"), "{}", messages(&ran));
}

/// One feed cannot tell lag from play. The line that is proposed, filled in by a machine with play, settles it.
#[test]
fn the_proposed_line_filled_in_settles_what_was_open() {
    let [file, profile] = ["one_feed.csv", "one_feed.toml"].map(|name| format!("samples/diagnosis/{name}"));
    let ran = run(&["diagnose", &file, "-m", &profile, "--next", "points"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    assert!(messages(&ran).contains("it tells servo-lag.X from backlash.X"), "{}", messages(&ran));
    let proposed = String::from_utf8(ran.stdout).expect("text");
    let measured = std::fs::read_to_string(crate::common::root().join(&file)).expect("a file");
    let head: Vec<&str> = proposed.lines().next().expect("a header").split(',').collect();
    // The frame that the rows were read in is turned; the first run goes along X.
    let columns: Vec<&str> = measured.lines().next().expect("a header").split(',').collect();
    let cell = |line: &str, name: &str| -> f64 {
        let at = columns.iter().position(|h| *h == name).expect("a column");
        line.split(',').nth(at).expect("a cell").parse().expect("a number")
    };
    let slope = |name: &str| {
        let first = measured.lines().filter(|line| line.starts_with("r0,"));
        let pairs: Vec<(f64, f64)> = first.map(|line| (cell(line, "x_mm"), cell(line, name))).collect();
        let count = pairs.len() as f64;
        let (x, y) = pairs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
        let of = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
        of(&|p| (p.0 - x) * (p.1 - y)) / of(&|p| (p.0 - x) * (p.0 - x))
    };
    let (slope_y, slope_z) = (slope("dy_um"), slope("dz_um"));
    let mut whole = measured.trim_end().to_owned();
    for (nth, line) in proposed.lines().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let of = |name: &str| cells[head.iter().position(|h| *h == name).expect("a column")];
        let noise = |by: usize| 2.0 * ((nth * by % 23) as f64 / 11.0 - 1.0);
        let number = |name: &str| of(name).parse::<f64>().expect("a number");
        let filled = |name: &&str| match *name {
            "dx_um" => format!("{:.3}", noise(5) - 13.8 * number("dir_x")),
            "dy_um" => format!("{:.3}", noise(7) + slope_y * number("x_mm")),
            "dz_um" => format!("{:.3}", noise(9) + slope_z * number("x_mm")),
            name => of(name).to_owned(),
        };
        whole += &format!("\n{}", columns.iter().map(filled).collect::<Vec<_>>().join(","));
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("whole.csv");
    std::fs::write(&path, whole).expect("writable");
    let ran = run(&["diagnose", path.to_str().expect("a plain path"), "-m", &profile]);
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(said.starts_with("NAMED") && said.contains("cause   backlash.X"), "{said}");
}

/// The program of a proposal comes to its points in order, within the travel, and from the side that is read.
#[test]
fn the_program_of_a_proposal_goes_through_its_points() {
    let next = |form: &str| {
        let rows = ["diagnose", "samples/diagnosis/one_feed.csv", "-m", "samples/diagnosis/one_feed.toml"];
        // Points are in machine coordinates: no work offset is read there.
        let offset: &[&str] = if form == "program" { &["--work-offset", "G54=100,50,-200"] } else { &[] };
        let ran = run(&[&rows[..], &["--next", form], offset].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        String::from_utf8(ran.stdout).expect("text")
    };
    let (points, program) = (next("points"), next("program"));
    let places: Vec<[f64; 3]> = program
        .lines()
        .filter(|line| line.starts_with("G1 X") && line.contains('Z'))
        .map(|line| {
            let words: Vec<&str> = line.split(' ').skip(1).collect();
            [(0, 100.0), (1, 50.0), (2, -200.0)]
                .map(|(axis, zero)| words[axis][1..].parse::<f64>().expect("a number") + zero)
        })
        .collect();
    assert!(places.iter().all(|at| (0.0..=600.0).contains(&at[0])), "beyond the travel: {places:?}");
    let mut here = 0;
    for line in points.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').skip(1).map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        let found = (here..places.len()).find(|k| (0..3).all(|a| (places[*k][a] - cells[a]).abs() < 1e-6));
        let found = found.unwrap_or_else(|| panic!("the program does not come to {line}"));
        if found > 0 {
            let step = places[found][0] - places[found - 1][0];
            assert!(step * cells[6] > 0.0, "from the other side: {line}");
        }
        here = found + 1;
    }
    assert!(program.contains("F4000.") && !program.contains("G4 "), "read on the fly");
}

#[test]
fn where_nothing_is_open_there_is_no_next_line() {
    let ran = run(&[
        "diagnose",
        "samples/diagnosis/backlash.csv",
        "-m",
        "samples/diagnosis/backlash.toml",
        "--next",
        "points",
    ]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(ran.stdout.is_empty() && messages(&ran).contains("the verdict is NAMED"), "{}", messages(&ran));
}

/// Who watched a target that stands still knows that the instrument does not drift.
#[test]
fn an_effect_that_is_not_there_is_taken_out_by_name() {
    let with = |more: &[&str]| {
        let file = ["diagnose", "samples/diagnosis/one_feed.csv", "-m", "samples/diagnosis/one_feed.toml"];
        run(&[&file[..], more].concat())
    };
    let ran = with(&["--without", "servo-lag.X"]);
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(said.starts_with("NAMED") && said.contains("cause   backlash.X"), "{said}");
    let ran = with(&["--without", "servo-leg.X"]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(messages(&ran).contains("servo-leg.X"), "{}", messages(&ran));
}
