//! Zeros that were touched on the machine: what they carry, what a profile may say of them, and what it may not.

use crate::common::{messages, run};

/// X too long by 200 µm a metre, Z leaning, a table whose axis stands 203.5 µm off.
const MACHINE: &str = r#"format = 1
name = "shop"
control = { dialect = "fanuc", blending = { mode = "exact-stop" } }
chain = "[w C b X Y Z t]"
axis.X = { travel_mm = [-500, 500], errors = "x.csv" }
axis.Y = { travel_mm = [-500, 500] }
axis.Z = { travel_mm = [-500, 500] }
squareness = { EB0Z_urad = 400 }
rotary.C = { centre_mm = [0, 0, 0], tilt = "body", EX0C_um = 203.5 }
tool = { lengths_mm = { H1 = 100.0, H2 = 60.0 } }
"#;
const TABLE: &str = "position_mm,EXX_um\n-500,-100\n500,100\n";

struct Shop(tempfile::TempDir);

impl Shop {
    fn new() -> Self {
        let shop = Self(tempfile::tempdir().expect("a temporary folder"));
        shop.write("x.csv", TABLE);
        shop
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.0.path().join(name), text).expect("writable");
        self.path(name)
    }

    /// What becomes of a program with offsets written so, or what is said.
    fn corrected(&self, offsets: &str, program: &str, more: &[&str]) -> Result<String, (i32, String)> {
        self.corrected_on(MACHINE, offsets, program, more)
    }

    fn corrected_on(
        &self,
        machine: &str,
        offsets: &str,
        program: &str,
        more: &[&str],
    ) -> Result<String, (i32, String)> {
        let machine = self.write("m.toml", &format!("{machine}\n[work_offsets_mm]\n{offsets}\n"));
        let program = self.write("in.nc", program);
        let ran = run(&[&[program.as_str(), "-m", &machine], more].concat());
        match ran.status.code() {
            Some(0) => Ok(String::from_utf8_lossy(&ran.stdout).into_owned()),
            code => Err((code.unwrap_or(-1), messages(&ran))),
        }
    }
}

/// The words of the last block that moves X.
fn last_cut(corrected: &str) -> &str {
    corrected.lines().rfind(|line| line.contains('X') && !line.starts_with('(')).expect("it cuts")
}

const PLAIN: &str = "G21 G90 G54\nG0 X0 Y0 Z0 C0\nG1 X100. F500.\nM30\n";

#[test]
fn what_was_touched_at_zero_stays_at_zero() {
    let shop = Shop::new();
    let touched = shop.corrected("G54 = [200, 0, 0]", PLAIN, &[]).expect("inside");
    assert!(touched.contains("G0 X0 Y0 Z0 C0"), "{touched}");
    // 100 mm further on X has grown by 20 µm.
    assert_eq!(last_cut(&touched), "G1 X99.98 F500.");
    let said_true = [
        ("G54 = [200, 0, 0]", &["--zero", "true"][..]),
        ("G54 = { at = [200, 0, 0], zero = \"true\" }", &[]),
    ];
    for (offset, more) in said_true {
        let moved = shop.corrected(offset, PLAIN, more).expect("inside");
        // From the measuring frame X stands 40 µm farther, and the axis of the table as much nearer as it lies off.
        assert!(moved.contains("G0 X0.163 Y0 Z0 C0"), "{moved}");
    }
}

#[test]
fn a_datum_turns_with_the_table() {
    let shop = Shop::new();
    let program = "G21 G90 G54\nG0 X10. Y10. Z0 C0\nG1 X40. F500.\nG0 X10. Y10. C180.\nG1 X40.\nM30\n";
    let turned = shop.corrected("G54 = [0, 0, 0]", program, &[]).expect("inside");
    let cuts: Vec<&str> = turned.lines().filter(|line| line.starts_with("G1")).collect();
    // The axis stands 203.5 µm off: at C0 that is in the datum, half a turn on twice as much is not.
    assert_eq!(cuts, ["G1 X39.992 F500.", "G1 X40.399"], "{turned}");
}

#[test]
fn where_and_with_what_it_was_touched_counts() {
    let shop = Shop::new();
    let program = "G21 G90 G54\nG0 X0 Y0 C0\nG43 H1 Z0\nG1 X100. F500.\nM30\n";
    let of = |touched_at: &str| {
        let offset = format!("G54 = {{ at = [200, 0, 0], touched_at = {touched_at} }}");
        let corrected = shop.corrected(&offset, program, &[]).expect("inside");
        last_cut(&corrected).to_owned()
    };
    // Touched with H1 where it cuts: 20 µm in X over 100 mm, and no more.
    assert_eq!(of("{ tool = \"H1\" }"), "G1 X99.98 F500.");
    assert_eq!(of("{ at = [200, 0, 100], tool = \"H1\" }"), "G1 X99.98 F500.");
    // X alone touched at its other end: 100 mm of it are right by themselves.
    assert_eq!(of("{ tool = \"H1\", X = { at = [300, 0, 100] } }"), "X100.");
    // Between two walls the middle counts.
    assert_eq!(of("{ tool = \"H1\", X = { at = [[200, 0, 100], [400, 0, 100]] } }"), "X100.");
    // Without a length Z stood 100 mm lower, where X leans 40 µm less.
    let ran = shop.corrected("G54 = [200, 0, 0]", program, &["--strict"]).expect("a warning, no doubt");
    assert_eq!(last_cut(&ran), "X99.94");
}

#[test]
fn lengths_touched_off_on_one_surface_count_from_there() {
    let shop = Shop::new();
    shop.write("z.csv", "position_mm,EZZ_um\n-500,-500\n500,500\n");
    let machine = MACHINE.replace(
        "axis.Z = { travel_mm = [-500, 500] }",
        "axis.Z = { travel_mm = [-500, 500], errors = \"z.csv\" }",
    );
    let program = "G21 G90 G54\nG0 X0 Y0 C0\nG43 H1 Z0\nG1 X10. F500.\nG0 Z50.\nG43 H2 Z0\nG1 X0\nM30\n";
    let z_words = |tool: &str| {
        let offsets = "[work_offsets_mm]\nG54 = { at = [0, 0, 0], touched_at = { tool = \"H1\" } }\n";
        let machine = shop.write("m.toml", &format!("{}\n{offsets}", machine.replace("H2 = 60.0 }", tool)));
        let ran = run(&[&shop.write("in.nc", program), "-m", &machine]);
        assert!(ran.status.success(), "{}", messages(&ran));
        let text = String::from_utf8_lossy(&ran.stdout).into_owned();
        let of = |head: &str| {
            let line = text.lines().find(|line| line.starts_with(head)).expect("it is there");
            line.rsplit('Z').next().unwrap_or_default().to_owned()
        };
        [of("G43 H1"), of("G43 H2")]
    };
    // Z is long by a thousandth: with true lengths the shorter tool stands 40 mm lower, 40 µm less.
    assert_eq!(z_words("H2 = 60.0 }"), ["0", "0.04"]);
    // Touched off on the table, both were right there.
    assert_eq!(z_words("H2 = 60.0 }, touched_at_mm = [0, 0, 0]"), ["0", "0"]);
}

/// A mill whose Y leans by 1 mrad towards -X.
const OUT_OF_SQUARE: &str = r#"format = 1
name = "shop"
control = "fanuc"
chain = "[w X Y b Z t]"
axis.X = { travel_mm = [-500, 500] }
axis.Y = { travel_mm = [-500, 500] }
axis.Z = { travel_mm = [-500, 500] }
squareness = { EC0Y_urad = 1000 }
"#;

#[test]
fn a_workpiece_dialled_along_an_axis_lies_as_that_axis_runs() {
    let shop = Shop::new();
    let program = "G21 G90 G54\nG0 X0 Y0 Z0\nG1 X200. F500.\nX0\nY100.\nG2 X100. Y0 J-100.\nM30\n";
    let cuts = |offset: &str| {
        let text =
            shop.corrected_on(OUT_OF_SQUARE, &format!("G54 = {offset}"), program, &[]).expect("inside");
        let again = shop.write("out.nc", &text);
        let [before, machine] = ["in.nc", "m.toml"].map(|name| shop.path(name));
        let checked = run(&["check", &before, &again, "-m", &machine]);
        assert!(checked.status.success(), "{}", messages(&checked));
        let lines = text.lines().filter(|line| line.starts_with(['G', 'X', 'Y']));
        lines.skip(1).map(str::to_owned).collect::<Vec<String>>()
    };
    // Dialled along X, or not at all: X is right, Y goes over to where it is square.
    for plain in ["[50, 0, 0]", "{ at = [50, 0, 0], aligned = { along = \"X\", from = 0, to = 200 } }"] {
        assert_eq!(cuts(plain)[1..4], ["G1 X200. F500.", "X0", "X0.1 Y100."], "{plain}");
    }
    // Dialled along Y that is right, and X goes over: 200 mm of it by 0.2 mm, and 0.1 um shorter.
    let along_y = "{ at = [50, 0, 0], aligned = { along = \"Y\", from = -100, to = 100 } }";
    assert_eq!(cuts(along_y)[1..4], ["G1 X200. Y0.2 F500.", "X0 Y0.", "Y100."]);
    // Touched 100 mm up Y, X is the same: the face runs as the way does.
    let up = "{ at = [50, 0, 0], touched_at = { X = { at = [50, 100, 0] }, Y = { at = [50, 0, 0] } }, aligned = { along = \"Y\", from = [0, -100, 0], to = [0, 100, 0] } }";
    assert_eq!([cuts(up)[0].as_str(), &cuts(up)[3]], ["G0 X0 Y0 Z0", "Y100."]);
}

#[test]
fn points_and_budgets_count_from_a_zero_that_is_named() {
    let shop = Shop::new();
    shop.corrected("G54 = [200, 0, 0]\nG55 = { at = [200, 0, 0], zero = \"true\" }", PLAIN, &[])
        .expect("inside");
    let (machine, points) =
        (shop.path("m.toml"), shop.write("points.csv", "x_mm,y_mm,z_mm\n200,0,0\n300,0,0\n"));
    let said = |arguments: &[&str]| {
        let ran = run(&[arguments, &["-m", &machine]].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        String::from_utf8_lossy(&ran.stdout).into_owned()
    };
    let predicted = said(&["predict", &points, "--datum", "G54"]);
    let errors = |line: &str| {
        line.split(',').skip(6).take(8).map(|v| v.parse().expect("a number")).collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = predicted.lines().skip(1).map(errors).collect();
    // X is long by 20 um over 100 mm; in the measuring frame the table's axis stands off besides.
    assert_eq!(rows[0][..4], [0.0; 4]);
    assert!((rows[1][0] - 20.0).abs() < 1e-3 && (rows[1][4] - rows[0][4] - 20.0).abs() < 1e-3, "{rows:?}");
    let absolute = said(&["predict", &points]);
    let of_true = said(&["predict", &points, "--datum", "G55"]);
    for (line, same) in absolute.lines().zip(of_true.lines()) {
        assert!(line.split(',').take(10).eq(same.split(',').take(10)), "{same}");
    }
    let budget = said(&["budget", "--points", &points, "--datum", "G54"]);
    assert!(budget.contains("M = max |d| 20.00 at") && budget.contains("counted from G54"), "{budget}");
    // Who counts from no zero is not asked how one was touched.
    let unsaid = "G54 = { at = [0, 0, 0], touched_at = { tool = \"H7\" } }";
    let unsaid = shop.write("unsaid.toml", &format!("{MACHINE}\n[work_offsets_mm]\n{unsaid}\n"));
    assert!(run(&["predict", &points, "-m", &unsaid]).status.success());
    let ran = run(&["predict", &points, "-m", &machine, "--datum", "G57"]);
    assert!(
        ran.status.code() == Some(2) && messages(&ran).contains("the profile has no G57"),
        "{}",
        messages(&ran)
    );
}

#[test]
fn what_contradicts_itself_is_refused_each_in_its_words() {
    let shop = Shop::new();
    let refused = [
        ("{ at = [0, 0, 0], touched_at = { at = [600, 0, 0] } }", "outside the calibrated volume"),
        ("{ at = [0, 0, 0], touched_at = { tool = \"H7\" } }", "touched with H7, whose length is not given"),
        ("{ at = [0, 0, 0], touched_at = { tool = \"T7\" } }", "touched with `T7`, which is no H number"),
        (
            "{ at = [0, 0, 0], touched_at = { at = [0, 0, 0], X = { at = [1, 0, 0] } } }",
            "X was touched at two places",
        ),
        ("{ at = [0, 0, 0], touched_at = { rotary_deg = { A = 90 } } }", "touched with A at an angle"),
        ("{ at = [0, 0, 0], touched_at = { direction = 2 } }", "the direction of touching is 2"),
        ("{ at = [0, 0, 0], zero = \"true\", touched_at = {} }", "is both true and touched"),
        ("{ at = [0, 0, 0], zero = \"guessed\" }", "expected three numbers [x, y, z] in mm, or {"),
    ];
    let along = [
        ("\"A\", from = 0, to = 9", "aligned along `A`, which is no linear axis"),
        ("\"X\", from = 9, to = 9", "between places that X does not join"),
        ("\"X\", from = [0, 0, 0], to = [9, 1, 0]", "between places that X does not join"),
        ("\"X\", from = 0, to = 9, faces = \"X\"", "no faces that lie along it"),
        ("\"X\", from = 0, to = 900", "outside the calibrated -500 to 500 mm"),
        (
            "\"X\", from = 0, to = 9 }, zero = \"true\", touched_at = { direction = 1",
            "is both true and touched",
        ),
    ];
    let along =
        along.map(|(way, words)| (format!("{{ at = [0, 0, 0], aligned = {{ along = {way} }} }}"), words));
    let with_table = (along[1].0.clone(), "aligned on a machine with rotary axes");
    let of_table = refused.map(|(offset, words)| (offset.to_owned(), words)).into_iter().chain([with_table]);
    let of_table = of_table.map(|case| (MACHINE, case));
    for (machine, (offset, words)) in of_table.chain(along.map(|case| (OUT_OF_SQUARE, case))) {
        let offsets = format!("G54 = {offset}");
        let (code, said) = shop.corrected_on(machine, &offsets, PLAIN, &[]).expect_err(&offset);
        assert!(code == 2 && said.contains(words), "{offset}: {code}\n{said}");
    }
}
