//! Lathes: programs are corrected in (r, z), judged by the closed loop and by what `predict --lathe` says of the output.

use crate::common::{messages, run};

const PROFILE: &str = "machine-profiles/generic_lathe.toml";

/// A shaft of 40 mm along 120 mm, an arc, a collar, increments, and a face past the centre.
const SHAFT: &str = "%\nO1000\nG21 G18 G40 G99 G54\nG50 S2500\nT0101\nG96 S180 M3\nG0 X80. Z5.\nX20. Z2.\nG1 Z0. F0.2\nX36.\nX40. Z-2.\n\
Z-120.\nG2 X50. Z-125. R5.\nG1 X60.\nG3 X64. Z-127. I0. K-2.\nG1 W-20.\nU4.\nG0 X80.\nZ5.\nX34.\nG1 Z0.5\nX-1.6 F0.1\nG0 Z5.\nM9\nM5\nM30\n%\n";

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    }

    /// The shipped lathe with words of its profile replaced.
    fn profile(&self, changes: &[(&str, &str)]) -> String {
        let root = crate::common::root();
        let mut text = std::fs::read_to_string(root.join(PROFILE)).expect("readable");
        let tables = root.join("machine-profiles/generic_lathe");
        text = text.replace("generic_lathe/", &format!("{}/", tables.display()));
        for (from, to) in changes {
            assert!(text.contains(from), "{from} is not in the profile");
            text = text.replace(from, to);
        }
        self.file("lathe.toml", &text)
    }

    /// The output, which `check` has passed.
    fn corrected(&self, program: &str, profile: &str) -> String {
        let input = self.file("in.nc", program);
        let output = run(&[&input, "-m", profile]);
        assert!(output.status.success(), "{}", messages(&output));
        let text = String::from_utf8(output.stdout).expect("ASCII");
        let out = self.file("out.nc", &text);
        let checked = run(&["check", &input, &out, "-m", profile]);
        assert!(checked.status.success(), "{}\n{text}", messages(&checked));
        text
    }

    fn refused(&self, program: &str, profile: &str) -> String {
        let output = run(&[&self.file("bad.nc", program), "-m", profile, "--accept", "0"]);
        assert!(!output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        messages(&output)
    }

    /// z from the chuck, radius and its error in µm, of the places that a program turns.
    fn turned(&self, program: &str, profile: &str) -> Vec<[f64; 3]> {
        let input = self.file("turned.nc", program);
        let output = run(&["predict", "--lathe", &input, "-m", profile, "--step", "5"]);
        assert!(output.status.success(), "{}", messages(&output));
        let text = String::from_utf8(output.stdout).expect("ASCII");
        let number = |field: &str| field.parse::<f64>().expect("a number");
        text.lines()
            .skip(1)
            .map(|line| {
                let fields: Vec<&str> = line.split(',').collect();
                [number(fields[0]), number(fields[1]), number(fields[4])]
            })
            .collect()
    }
}

#[test]
fn a_shaft_is_turned_straight() {
    let bench = Bench::new();
    let before = bench.turned(SHAFT, PROFILE);
    let corrected = bench.corrected(SHAFT, PROFILE);
    assert_ne!(corrected, SHAFT);
    // U and W stay what they are, cutting speed and limit too.
    for kept in ["G50 S2500", "T0101", "G96 S180 M3", "W-", "U"] {
        assert!(corrected.contains(kept), "{kept}:\n{corrected}");
    }
    // Along the cylinder of 40 mm: Z 360 of the machine is the program's zero, the chuck's face 60.
    let along = |rows: &[[f64; 3]], nominal: f64| {
        let on = |row: &&[f64; 3]| row[0] > 182.0 && row[0] < 297.0;
        rows.iter().filter(on).map(|row| (row[1] - nominal).abs() * 1e3).fold(0.0, f64::max)
    };
    let largest_before = along(&before, 20.0);
    let largest_after = along(&bench.turned(&corrected, PROFILE), 20.0);
    assert!(largest_before > 2.0 + largest_after, "{largest_before}");
    // 1 µm and half a step of 0.5 µm on the radius, as a distance with that of Z.
    assert!(largest_after <= 1.0 + 0.56, "{largest_after}");
}

/// The shaft of 40 mm, 300 mm out of the chuck, in one block along 280 mm, all effects of the profile together: its diameter by
/// `predict --lathe`, its path by `check`. The outside judge's figures of it stand in docs/reproduction.md.
#[test]
fn a_shaft_with_all_effects_together_keeps_its_diameter() {
    let bench = Bench::new();
    let shaft = "G21 G18 G40 G99 G54\nG50 S2500\nT0101\nG96 S180 M3\nG0 X60. Z5.\nX40.\nG1 Z-280. F0.2\nX60.\nG0 Z5.\nM30\n";
    let square = bench.profile(&[("EB0Z_urad = -80.0", "EB0Z_urad = 0.0")]);
    let square = bench.file("square.toml", &std::fs::read_to_string(square).expect("written"));
    // As shipped the squareness of Z takes most of what the tailstock does; without it the cone is seen.
    for (profile, least_before_um) in [(PROFILE, 3.0), (square.as_str(), 20.0)] {
        let off = |program: &str| {
            let rows = bench.turned(program, profile);
            let on: Vec<f64> =
                rows.iter().filter(|row| row[0] > 81.0 && row[0] < 359.0).map(|row| row[1] - 20.0).collect();
            assert!(on.len() > 40, "{}", on.len());
            on.iter().map(|mm| 1e3 * mm.abs()).fold(0.0, f64::max)
        };
        let (before, after) = (off(shaft), off(&bench.corrected(shaft, profile)));
        assert!(before > least_before_um && after <= 1.0 + 0.56, "{before} {after}");
    }
}

#[test]
fn a_perfect_lathe_returns_the_input() {
    let bench = Bench::new();
    let text = "format = 1\nname = \"P\"\ncontrol = \"fanuc-lathe\"\nchain = \"[w S b Z X t]\"\n[program]\ng_code_system = \"A\"\nx = \"diameter\"\n\
        [axis.X]\ntravel_mm = [-20, 160]\n[axis.Z]\ntravel_mm = [-20, 520]\n[tool]\nlengths_mm = { H1 = [12.5, 0, 41.25] }\n\
        [work_offsets_mm]\nG54 = [0, 0, 360.0]\n";
    let profile = bench.file("perfect.toml", text);
    assert_eq!(bench.corrected(SHAFT, &profile), SHAFT);
}

/// A contour under G42: a taper, an outer and an inner arc, G40 on the way out.
const UNDER_G42: &str = "%\nO1001\nG21 G18 G40 G99 G54\nG50 S2500\nT0101\nG97 S900 M3\nG0 X60. Z5.\nX20. Z3.\nG42 G1 X16. Z2. F0.3\n\
X20. Z-20. F0.2\nG3 X30. Z-25. R5.\nG1 Z-40.\nG2 X36. Z-43. I3. K0.\nG1 X46.\nG40 G0 X60. Z-42.\nZ5.\nM5\nM30\n%\n";

#[test]
fn the_nose_is_led_along_the_corrected_contour() {
    let bench = Bench::new();
    let under = bench.corrected(UNDER_G42, PROFILE);
    // Each block stays one, and the codes stay where they were.
    let lines = |text: &str| text.lines().filter(|line| !line.starts_with('(')).count();
    assert_eq!(lines(&under), lines(UNDER_G42));
    assert_eq!((under.matches("G42").count(), under.matches("G40").count()), (1, 2));
    // What it cuts is what the same contour is without compensation: but for where the tool comes from and goes to.
    let without = bench.corrected(&UNDER_G42.replace("G42 ", ""), PROFILE);
    let words = |text: &str| -> Vec<f64> {
        let words = text.split(|c: char| c.is_whitespace()).filter(|word| word.starts_with(['X', 'Z']));
        words.map(|word| word[1..].parse::<f64>().expect("a number")).collect()
    };
    let (under, without) = (words(&under), words(&without));
    assert_eq!(under.len(), without.len());
    for (led, free) in under.iter().zip(&without) {
        assert!((led - free).abs() < 1.1e-3, "{led} {free}");
    }
    // Nothing is left open where the nose is known; without it that is said.
    let told = |profile: &str| messages(&run(&[&bench.file("told.nc", UNDER_G42), "-m", profile]));
    assert!(!told(PROFILE).contains("VP0508"), "{}", told(PROFILE));
    let noseless =
        bench.profile(&[("noses      = { H1 = { radius_mm = 0.8, direction = 3, height_um = 30.0 } }", "")]);
    assert!(told(&noseless).contains("VP0508"), "{}", told(&noseless));
    // A button tool on a machine that leans: its nose touches where the error is another.
    let button = bench
        .profile(&[("radius_mm = 0.8", "radius_mm = 30.0"), ("EB0Z_urad = -80.0", "EB0Z_urad = -800.0")]);
    let said = bench.refused(&UNDER_G42.replace("G2 X36. Z-43. I3. K0.", "G1 X36. Z-43."), &button);
    assert!(said.contains("VP0521") && said.contains("another than at its tip"), "{said}");
}

#[test]
fn diameters_and_radii_are_one_part() {
    let bench = Bench::new();
    let lines = |x: [&str; 3]| {
        format!("G21 G99\nT0101\nG0 X{} Z2.\nG1 X{} F0.2\nZ-40.\nX{}\nM30\n", x[0], x[1], x[2])
    };
    let places = |output: &str| {
        let words = output.split(|c: char| c.is_whitespace());
        words.filter_map(|word| word.strip_prefix('X')?.parse::<f64>().ok()).collect::<Vec<_>>()
    };
    let by_diameter = places(&bench.corrected(&lines(["60.", "40.", "60."]), PROFILE));
    let radius = bench.profile(&[("x             = \"diameter\"", "x = \"radius\"")]);
    let by_radius = places(&bench.corrected(&lines(["30.", "20.", "30."]), &radius));
    assert_eq!(by_diameter.len(), by_radius.len());
    for (diameter, radius) in by_diameter.iter().zip(&by_radius) {
        // Steps of 0.001 on the diameter and on the radius.
        assert!((diameter - 2.0 * radius).abs() <= 0.0021, "{diameter} {radius}");
    }
}

#[test]
fn what_a_lathe_does_not_do_is_refused_by_name() {
    let bench = Bench::new();
    let block = |text: &str| format!("G21 G99\nG50 S2000\nT0101\nG0 X60. Z2.\nG1 X40. F0.2\n{text}\nM30\n");
    for (text, code) in [
        ("G0 C90.", "VP0251"),
        ("Y5.", "VP0251"),
        ("G17 G2 X42. Z-5. R5.", "VP0251"),
        ("X-20.\nZ-30.", "VP0252"),
        ("X10. U2.", "VP0210"),
        ("G71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1", "VP0144"),
        ("G90 X30.", "VP0143"),
        ("G92 X30. Z-20. F1.5", "VP0145"),
        ("G0 X60.\nG76 P021060 Q100 R0.05\nG76 X38. Z-20. P900 Q300 F1.5", "VP0145"),
        ("G32 Z-20. K1.5", "VP0225"),
        ("G42 X38.\nG2 X39. Z1.5 R0.5", "VP0521"),
        ("G42 X38.\nG90 X30. Z-20.", "VP0143"),
        ("T0202", "VP0215"),
    ] {
        let said = bench.refused(&block(text), PROFILE);
        assert!(said.contains(code), "{text}: {said}");
    }
    for (text, words) in [
        ("!2", "waits for another turret or channel"),
        ("G68", "mirrors X for the second turret"),
        ("G84 Z-20. R-3. F1.5", "taps a face"),
        ("G87 X20. R-3. F0.1", "drills a side"),
    ] {
        let said = bench.refused(&block(text), PROFILE);
        assert!(said.contains(words), "{text}: {said}");
    }
    let unlimited = bench.refused("G21 G99\nT0101\nG96 S180 M3\nM30\n", PROFILE);
    assert!(unlimited.contains("VP0253"), "{unlimited}");
    let unsaid = bench.profile(&[("x             = \"diameter\"", "")]);
    assert!(bench.refused(&block("Z-5."), &unsaid).contains("VP0250"));
    let systemless = bench.profile(&[("g_code_system = \"A\"", "")]);
    assert!(bench.refused(&block("Z-5."), &systemless).contains("G-code system"));
    // A mill's dialect for a lathe, and a lathe's for a mill.
    let program = bench.file("part.nc", &block("Z-5."));
    let mill = run(&[&program, "-m", PROFILE, "-d", "fanuc"]);
    assert!(messages(&mill).contains("fanuc-lathe"), "{}", messages(&mill));
    let lathe = run(&[&program, "-m", "machine-profiles/stan_s500.toml", "-d", "fanuc-lathe"]);
    assert!(messages(&lathe).contains("no spindle"), "{}", messages(&lathe));
}

/// A profile, changes of it, a program, and what its refusal says.
type Refused<'a> = (String, Vec<(&'a str, &'a str)>, &'a str, &'a str);

/// Each mistake that people make with a lathe has a message of its own: its number, and words that no other one has.
#[test]
fn bad_input_of_lathes_is_told_by_name() {
    let bench = Bench::new();
    let block = |text: &str| format!("G21 G99\nG50 S2000\nT0101\nG0 X60. Z2.\nG1 X40. F0.2\n{text}\nM30\n");
    let contour =
        |text: &str| block(&format!("G0 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1\nN10 G0 X20.\n{text}"));
    let unsaid = ("x             = \"diameter\"", "");
    let clamping = ("clamping       = \"chuck-tailstock\"", "");
    let beyond = ("at_mm     = 300.0", "at_mm     = 301.0");
    let stations = ("[work_offsets_mm]", "turret_um = { H2 = [1, 2] }\n[work_offsets_mm]");
    let cases: Vec<Refused<'_>> = vec![
        (block("Z-5."), vec![unsaid], "VP0250", "a diameter or a radius is not said"),
        (block("Z-5."), vec![("g_code_system = \"A\"", "")], "VP", "G-code system"),
        (block("X-20.\nZ-30."), vec![], "VP0252", "turning below the axis"),
        ("G21 G99\nT0101\nG96 S180 M3\nM30\n".to_owned(), vec![], "VP0253", "without a limit"),
        (contour("G1 Z-20.\nX40."), vec![], "VP0144", "no block N20"),
        (
            contour("G1 Z-20.\nN20 X60.").replace("P10 Q20 ", ""),
            vec![],
            "VP0144",
            "W is of the block that cuts",
        ),
        (block("G72 W2. R0.5\nG72 U0.4 W0.1\nX60."), vec![], "VP0144", "U is of the block that cuts"),
        (contour("G1 Z-20.\nX40. Z-10.\nN20 X60."), vec![], "VP0144", "turns back along Z"),
        (contour("G1 Z-20. R3.\nN20 X60."), vec![], "VP0144", "R3. on a line of a contour"),
        (block("G42 X38.\nG2 X39. Z1.5 R0.5"), vec![], "VP0521", "nose"),
        (block("Z-5."), vec![beyond], "VP03", "the tailstock at Z 301 mm lies beyond the bar"),
        (block("Z-5."), vec![clamping], "VP03", "a cutting force without clamping"),
        (block("G0 C90."), vec![], "VP0251", "C on a lathe of two axes"),
        (block("Y5."), vec![], "VP0251", "Y on a lathe of two axes"),
        (block("G0 H90."), vec![], "VP0251", "H on a lathe of two axes"),
        (block("G0 H1"), vec![], "VP0251", "V adds to Y and H adds to C"),
        (block("G1 V5."), vec![], "VP0251", "V on a lathe of two axes"),
        (
            "G21 G90 G95\nG92 S2000\nT0101\nG0 X60. Z2.\nG1 X40. F0.2\nG0 H1\nM30\n".to_owned(),
            vec![("g_code_system = \"A\"", "g_code_system = \"B\"")],
            "VP0251",
            "T says the offset",
        ),
        (block("G68"), vec![], "VP0208", "mirrors X for the second turret"),
        (block("!2"), vec![], "VP0105", "waits for another turret or channel"),
        (block("Z-5."), vec![stations], "VP03", "`H2` under turret_um is no tool"),
    ];
    for (program, changes, number, words) in cases {
        let said = bench.refused(&program, &bench.profile(&changes));
        assert!(said.contains(number) && said.contains(words), "{words}:\n{program}\n{said}");
    }
}

#[test]
fn systems_b_and_c_read_their_own_codes() {
    let bench = Bench::new();
    for (system, unit, limit) in [("B", "G21", "G92 S2000"), ("C", "G71", "G92 S2000")] {
        let profile = bench.profile(&[("g_code_system = \"A\"", &format!("g_code_system = \"{system}\""))]);
        let program = format!(
            "{unit} G90 G95 G54\n{limit}\nT0101\nG96 S150 M3\nG0 X60. Z2.\nG1 X40. F0.2\nZ-60.\nG91 X2.\nZ-20.\nG90 X60.\nM30\n"
        );
        let corrected = bench.corrected(&program, &profile);
        assert!(corrected.contains(limit) && corrected != program, "{system}:\n{corrected}");
    }
}

#[test]
fn linuxcnc_says_diameters_itself() {
    let bench = Bench::new();
    let profile =
        bench.profile(&[("\"fanuc-lathe\"", "\"linuxcnc-lathe\""), ("x             = \"diameter\"", "")]);
    let program = |code: &str, x: [&str; 2]| {
        format!(
            "G21 G18 G90 {code}\nT1 M6\nG43 H1\nG95 G96 D2500 S180 M3\nG0 X{} Z2\nG1 X{} F0.2\nZ-60\nX{}\nM2\n",
            x[0], x[1], x[0]
        )
    };
    for (code, x) in [("G7", ["60", "40"]), ("G8", ["30", "20"])] {
        let program = program(code, x);
        assert_ne!(bench.corrected(&program, &profile), program);
    }
    assert!(bench.refused(&program("", ["60", "40"]), &profile).contains("VP0250"));
}

/// One part in Fanuc's cycles: passes with a taper, a face, a contour roughed and finished, a groove, threads.
const CYCLES: &str = "G21 G18 G40 G99 G54\nG50 S2500\nT0101\nG97 S800 M3\nG0 X60. Z2.\nG90 X50. Z-60. F0.2\nX46.\nU-16. R-1.\n\
G0 X62.\nG94 X40. Z-1. F0.1\nZ-2.\nG0 X60. Z2.\nG71 U2. R0.5\nN5 G71 P10 Q20 U0.4 W0.1 F0.3 M8\nN10 G0 X20.\nG1 Z0. F0.1\n\
X30. Z-5.\nZ-20.\nG2 X40. Z-25. R5.\nN20 G1 X60.\nN30 G70 P10 Q20\nG0 X50. Z-30.\nG75 R0.2\nG75 X34. Z-36. P1500 Q3000 F0.08\n\
G0 X60. Z5.\nG0 X36.\nG92 X29.2 Z-18. F1.5\nX28.6\nG0 X36. Z5.\nG76 P020000 Q100 R0.05\nG76 X28.16 Z-18. P920 Q300 F1.5\nG0 X80. Z20.\nM30\n";

#[test]
fn cycles_are_corrected_as_the_moves_they_are() {
    let bench = Bench::new();
    let profile = bench.profile(&[("decimal       =", "thread_chamfer_leads = 1.0\ndecimal       =")]);
    let corrected = bench.corrected(CYCLES, &profile);
    // A thread is one block, and one more for its chamfer: two passes of G92, nine of G76.
    let threads = corrected.lines().filter(|line| line.starts_with("G32 ")).count();
    assert_eq!(threads, 2 * 2 + 9, "{corrected}");
    assert!(!corrected.lines().any(|line| line.starts_with("G90") || line.starts_with("G71")), "{corrected}");
    // What check finds: a thread that became a feed, and another lead.
    let input = bench.file("in.nc", CYCLES);
    for (from, to) in [("\nG32 Z", "\nG1 Z"), ("\nF1.5 ", "\nF1.25 ")] {
        assert!(corrected.contains(from), "{corrected}");
        let damaged = bench.file("damaged.nc", &corrected.replacen(from, to, 1));
        let checked = run(&["check", &input, &damaged, "-m", &profile]);
        assert!(!checked.status.success(), "{from} {to}: {}", messages(&checked));
    }
    // On a lathe without errors the cycles stay what they are.
    let text = "format = 1\nname = \"P\"\ncontrol = \"fanuc-lathe\"\nchain = \"[w S b Z X t]\"\n[program]\ng_code_system = \"A\"\nx = \"diameter\"\n\
        thread_chamfer_leads = 0.0\n[axis.X]\ntravel_mm = [-20, 160]\n[axis.Z]\ntravel_mm = [-20, 520]\n[tool]\nlengths_mm = { H1 = [12.5, 0, 41.25] }\n\
        [work_offsets_mm]\nG54 = [0, 0, 360.0]\n";
    let perfect = bench.file("perfect.toml", text);
    assert_eq!(bench.corrected(CYCLES, &perfect), CYCLES);
}

/// One contour, roughed and finished, in Fanuc's form and in LinuxCNC's.
const CONTOURS: [&str; 2] = [
    "G21 G18 G40 G99 G54\nG50 S2500\nT0101\nG97 S800 M3\nG0 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.3\nN10 G0 X20.\n\
     G1 Z0. F0.1\nX30. Z-5.\nZ-20.\nG2 X40. Z-25. R5.\nN20 G1 X60.\nG70 P10 Q20\nG0 X80. Z20.\nM30\n",
    "G21 G18 G90 G7\no100 sub\nG0 X20\nG1 Z0\nX30 Z-5\nZ-20\nG2 X40 Z-25 R5\nG1 X60\no100 endsub\nT1 M6\nG43 H1\nG97 S800 M3\n\
     G95 F0.1\nG0 X60 Z2\nG71 Q100 D0.2 I2 R0.5\nG0 X60 Z2\nG70 Q100\nG0 X80 Z20\nM2\n",
];

#[test]
fn a_contour_of_linuxcnc_is_the_one_of_fanuc() {
    let bench = Bench::new();
    let linuxcnc = bench.profile(&[("\"fanuc-lathe\"", "\"linuxcnc-lathe\"")]);
    let linuxcnc = bench.file("linuxcnc.toml", &std::fs::read_to_string(linuxcnc).expect("written"));
    let profiles = [PROFILE, linuxcnc.as_str()];
    let finished = profiles.iter().zip(CONTOURS).map(|(profile, program)| {
        let corrected = bench.corrected(program, profile);
        assert!(!corrected.lines().any(|line| line.starts_with("G7") && line != "G7"), "{corrected}");
        bench.turned(&corrected, profile)
    });
    let finished: Vec<_> = finished.collect();
    assert!(finished[0].len() > 4, "{finished:?}");
    assert_eq!(finished[0].len(), finished[1].len(), "{finished:?}");
    for (one, other) in finished[0].iter().zip(&finished[1]) {
        // Each is right to 1 um and its rounding.
        assert!((one[0] - other[0]).abs() < 1e-6 && (one[1] - other[1]).abs() < 3e-3, "{one:?} {other:?}");
    }
    assert!(bench.refused(&CONTOURS[1].replace("D0.2 I2", "U0.4 I2"), &linuxcnc).contains("VP0143"));
    assert!(bench.refused(&CONTOURS[1].replace("G18", "G17"), &linuxcnc).contains("VP0143"));
    assert!(bench.refused(&CONTOURS[1].replace("G70 Q100", "G73 Q100"), &linuxcnc).contains("VP0208"));
}

#[test]
fn a_thread_is_never_split() {
    let bench = Bench::new();
    let program =
        |code: &str| format!("G21 G99\nT0101\nG0 X60. Z5.\nX39.\n{code} Z-280. F1.5\nG0 X60.\nM30\n");
    // The shaft bends: along 280 mm one line is no cylinder. A feed is split, a thread is refused with the figure.
    let split = bench.corrected(&program("G1"), PROFILE);
    assert!(split.lines().count() > program("G1").lines().count() + 1, "{split}");
    let said = bench.refused(&program("G32"), PROFILE);
    assert!(said.contains("VP0503") && said.contains("thread") && said.contains("um"), "{said}");
    let rough = bench.profile(&[("tolerance_um = 1.0", "tolerance_um = 30.0")]);
    let whole = bench.corrected(&program("G32"), &rough);
    assert_eq!(whole.matches("G32").count(), 1, "{whole}");
}

#[test]
fn a_thread_of_linuxcnc_keeps_its_lead() {
    let bench = Bench::new();
    let profile = bench.profile(&[("\"fanuc-lathe\"", "\"linuxcnc-lathe\"")]);
    let program = |thread: &str| {
        format!("G21 G18 G90 G7\nT1 M6\nG43 H1\nG97 S500 M3 G95 F0.2\nG0 X36 Z5\nX29\n{thread}\nG0 X36\nM2\n")
    };
    let corrected = bench.corrected(&program("G33 Z-20 K1.5"), &profile);
    assert!(corrected.contains("G33") && corrected.contains("K1.5"), "{corrected}");
    assert!(bench.refused(&program("G33 Z-20"), &profile).contains("K"));
}

#[test]
fn wear_offsets_leave_half_of_what_a_cylinder_differs_by() {
    let bench = Bench::new();
    let input = bench.file("shaft.nc", SHAFT);
    let output = run(&["predict", "--lathe", &input, "-m", PROFILE, "--wear"]);
    assert!(output.status.success(), "{}", messages(&output));
    let text = String::from_utf8(output.stdout).expect("ASCII");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let shaft = rows.iter().find(|row| row[3] == "40.000").unwrap_or_else(|| panic!("{text}"));
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let offset_mm = number(shaft[4]);
    assert!(offset_mm.abs() > 0.9e-3 && (number(shaft[5]) - 2.0 * offset_mm).abs() <= 1.01e-3, "{text}");
    // What a wear offset does: the axis is told so much more.
    let worn = bench.profile(&[("G54 = [0, 0, 360.0]", &format!("G54 = [{offset_mm}, 0, 360.0]"))]);
    let along = |profile: &str| -> Vec<f64> {
        let rows = bench.turned(SHAFT, profile);
        let shaft = rows.iter().filter(|row| row[0] > 182.0 && row[0] < 297.0);
        shaft.map(|row| (row[1] - 20.0) * 1e3).collect()
    };
    let largest = |all: &[f64]| all.iter().map(|um| um.abs()).fold(0.0, f64::max);
    let (before, after) = (along(PROFILE), along(&worn));
    assert!(largest(&before) <= number(shaft[6]) + 1e-3, "{text} {before:?}");
    // The step of 1 µm is rounded to.
    assert!(largest(&after) <= number(shaft[7]) + 0.5 + 1e-3, "{text} {after:?}");
    assert!(largest(&after) < largest(&before), "{text}");
}

#[test]
fn a_lathe_is_exported_by_its_own_axes_only() {
    let bench = Bench::new();
    let folder = bench.folder.path().join("tables");
    let into = folder.to_str().expect("a plain path");
    let export = |format: &str| run(&["profile", "export", PROFILE, "--format", format, "-O", into]);
    let output = export("linuxcnc");
    assert!(output.status.success(), "{}", messages(&output));
    let said = messages(&output);
    assert!(said.contains("VP1112") && said.contains("what the workpiece gives way"), "{said}");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["x.comp", "z.comp"]);
    // Nominal, forward, reverse: what the table of the profile says at that place.
    let table = std::fs::read_to_string(crate::common::root().join("machine-profiles/generic_lathe/z.csv"));
    let table = table.expect("the table");
    let header: Vec<&str> =
        table.lines().find(|line| line.starts_with("position")).expect("a header").split(',').collect();
    let column = header.iter().position(|name| *name == "EZZ_um").expect("EZZ");
    let rows = table.lines().skip_while(|line| !line.starts_with("position")).skip(1);
    let known: Vec<(f64, f64)> = rows
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            (cells[0], cells[column])
        })
        .collect();
    let written = std::fs::read_to_string(folder.join("z.comp")).expect("written");
    let read: Vec<Vec<f64>> =
        written.lines().map(|line| line.split(' ').map(|v| v.parse().expect("a number")).collect()).collect();
    assert_eq!(read.len(), known.len());
    for (row, (z, um)) in read.iter().zip(&known) {
        assert!((row[0] - z).abs() < 1e-6 && (row[1] - z - um * 1e-3).abs() < 1e-6, "{row:?} {z} {um}");
    }
    assert!(export("isg").status.success());
    let refused = export("lattice");
    assert!(!refused.status.success() && messages(&refused).contains("--wear"), "{}", messages(&refused));
}
