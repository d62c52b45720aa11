//! What a control brings along and a program does not say, what cannot be held within the tolerance, and whether the numbers
//! of `check` are true.

use crate::common::{Place, root};

const STAN: &str = "machine-profiles/stan_s500.toml";
const OFFSET: &str = "G54=140,100,100";

/// The words of each block that is in it, comments apart.
fn blocks(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with(['(', '%', 'O'])).collect()
}

const WITHOUT_MOTION: [(&str, &str, &str); 3] = [
    (
        "fanuc",
        "G21 G17 G90 G94 G54 G40 G49 G80\nM3 S3000\nG0 X-30. Y-20. Z5.\nG41 D1\nG1 Z-10. F150\nG1 X0. Y-12. F400\nG1 Y30.\nG1 X40.\nG1 Y0.\nG40\nG1 Z5.\nG0 Z20.\nG0 X100.\nM30\n",
        "start-up and retract",
    ),
    (
        "linuxcnc",
        "G21 G17 G90 G94 G54 G40\nM3 S3000\nG0 X-30 Y-20 Z5\nG1 Z-10 F150\nG41 D1\nG1 X0 Y-12 F400\nG1 Y30\nG1 X40\nG1 Y5\nG40\nG1 Z5\nG0 Z20\nG0 X100\nM2\n",
        "a bare G40",
    ),
    (
        "linuxcnc",
        "G21 G17 G90 G94 G54 G40\nM3 S3000\nG0 X-30 Y-20 Z5\nG42 D1\nG1 X-10 Y-12 F400\nG1 X0 Y0\nG1 Z-10 F150\nG1 X40 F400\nG1 Y30\nG1 X-10\nG40 G1 X-30 Y40\nG0 Z20\nM2\n",
        "a plunge on the contour",
    ),
];

/// A control leads onto a contour and off it by the first motion in the plane, be it of a micrometre: where a block has none, it
/// is given none.
#[test]
fn what_plunges_under_compensation_stays_in_its_axis() {
    let place = Place::new();
    for (dialect, program, what) in WITHOUT_MOTION {
        let more = ["-m", STAN, "-d", dialect, "--work-offset", OFFSET];
        let (out, _) = place.corrected(program, &more);
        // Behind G41 or G42: a block that moves Z alone moves Z alone.
        let plunges = |text: &str| {
            let behind = blocks(text).into_iter().skip_while(|block| !block.contains("D1"));
            behind.filter(|block| block.starts_with("G1 Z")).count()
        };
        assert!(plunges(&out) >= plunges(program) && plunges(program) > 0, "{what}: {out}");
    }
}

#[test]
fn tools_that_cut_without_a_length_are_said() {
    let tool = |number: u32, z: u32| {
        format!("T{number} M6\nG0 G54 X0. Y0. S5000 M3\nZ{z}.\nG1 Z2. F300.\nX60. F800.\nY40.\nG0 Z50.\n")
    };
    let program = format!("G21 G17 G40 G49 G80 G90\n{}{}M30\n", tool(15, 50), tool(3, 50));
    let place = Place::new();
    let more = ["-m", STAN, "-d", "fanuc", "--work-offset", OFFSET];
    let (_, said) = place.corrected(&program, &more);
    assert!(said.contains("warning[VP0527]") && said.contains("T3, T15"), "{said}");
    assert!(place.refused(&program, &[&more[..], &["--strict"]].concat()).contains("error[VP0527]"));
    // The control brings it in: the same as with G43 behind the change.
    let text = std::fs::read_to_string(root().join(STAN)).expect("readable");
    let tables = root().join("machine-profiles/stan_s500");
    let text = text.replace("\"stan_s500/", &format!("\"{}/", tables.display()));
    let text = text.replacen("[correction]", "[program]\nt_means_h = true\n[correction]", 1);
    let machine = place.write("machine.toml", &text);
    let lengths = ["--tool", "H15=30", "--tool", "H3=45", "--work-offset", "G54=140,100,60", "-d", "fanuc"];
    let (brought, said) = place.corrected(&program, &[&["-m", &machine], &lengths[..]].concat());
    assert!(!said.contains("VP0527"), "{said}");
    let named = program.replace("T15 M6\n", "T15 M6\nG43 H15\n").replace("T3 M6\n", "T3 M6\nG43 H3\n");
    let (named, _) = place.corrected(&named, &[&["-m", STAN], &lengths[..]].concat());
    let moves = |text: &str| -> Vec<String> {
        blocks(text).into_iter().filter(|block| !block.starts_with("G43")).map(str::to_owned).collect()
    };
    assert_eq!(moves(&brought), moves(&named));
}

/// A rapid that turns a table and says its place again goes there by what the new angle asks of it.
#[test]
fn a_rapid_that_turns_and_repeats_its_place_is_corrected() {
    let program = "G21 G90 G17 G54\nG0 X30. Y20. Z80. A0. C0.\nG0 Z3.\nG1 Z-1. F100.\nG0 Z80.\nG0 X30. Y20. Z80. A0. C90.\nG0 Z3.\nG1 Z-1. F100.\nG0 Z80.\nM30\n";
    let (place, more) = (Place::new(), ["-m", "samples/profiles/tilting_table.toml"]);
    let (out, _) = place.corrected(program, &more);
    let turned = out.lines().find(|line| line.contains("C90.")).expect("it turns");
    assert!(!turned.contains("X30. Y20."), "{out}");
    assert_eq!(place.check(program, &out, &more)["passed"], true);
}

const UNNAMED: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nG0 X10. Y10. Z100.\nG52 X0 Y0\nG1 Y40. F400.\nM30\n";
const SQUARE: &str = "format = 1\nname = \"Square\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\naxis.X = { travel_mm = [-100, 600] }\naxis.Y = { travel_mm = [-100, 600] }\naxis.Z = { travel_mm = [-100, 600] }\nsquareness = { EC0Y_urad = 100, EA0Z_urad = 140 }\nwork_offsets_mm = { G54 = [95, 88, 60] }\n";

/// X has no word in the frame in force, and Y leans by 3 µm over its 30 mm.
#[test]
fn what_cannot_be_held_is_written_and_said_or_refused() {
    let place = Place::new();
    let machine = place.write("square.toml", SQUARE);
    let more = ["-m", machine.as_str()];
    let (out, said) = place.corrected(UNNAMED, &more);
    assert!(said.contains("warning[VP0528]: 1 motion(s) leave their path by up to 3.00 um"), "{said}");
    let checked = place.check(UNNAMED, &out, &more);
    assert_eq!((&checked["passed"], &checked["accepted_lines"]), (&true.into(), &1.into()), "{checked:#}");
    // Another micrometre is not what was proven.
    let worse = out.replace("Y40.014", "Y40.018");
    assert_ne!(worse, out);
    assert_eq!(place.check(UNNAMED, &worse, &more)["passed"], false);
    for refused in [&["--accept", "2"][..], &["--accept", "0"], &["--strict"]] {
        let said = place.refused(UNNAMED, &[&more[..], refused].concat());
        let code = if refused == ["--strict"] { "VP0528" } else { "VP0514" };
        assert!(said.starts_with(&format!("error[{code}]")), "{refused:?}: {said}");
    }
    assert_eq!(place.check(UNNAMED, &out, &[&more[..], &["--accept", "0"]].concat())["passed"], false);
}

/// A hole bound to the spindle leans by what VP0506 says. What else is off is measured from where the cut begins: the
/// moves down to it and to its corrected start are none of it.
#[test]
fn a_tapped_hole_is_held_against_what_is_said_of_it() {
    let place = Place::new();
    let machine = place.write("square.toml", SQUARE);
    let program = "G21 G17 G40 G49 G80 G90 G94 G54\nG0 X40. Y90. Z100.\nZ2.\nG1 Z-4. F200.\nX80.\nG0 Z10.\n\
        G98 G84 X30. Y30. Z-40. R2. F400.\nG80\nG0 Z100.\nM30\n";
    let more = ["-m", machine.as_str()];
    let (out, said) = place.corrected(program, &more);
    assert!(said.contains("warning[VP0506]: 1 hole(s) are off by up to 3.3 um"), "{said}");
    let checked = place.check(program, &out, &more);
    assert_eq!((&checked["passed"], &checked["accepted_lines"]), (&true.into(), &1.into()), "{checked:#}");
    let deeper = out.replace("Z-40.", "Z-40.01");
    assert_ne!(deeper, out);
    assert_eq!(place.check(program, &deeper, &more)["passed"], false);
    let beside = out.replace("X80.009", "X80.009 Y90.019");
    assert_ne!(beside, out);
    let findings = place.check(program, &beside, &more)["findings"].to_string();
    assert!(findings.contains("line 5") && !findings.contains("line 4\""), "{findings}");
}

/// The figure of the message is all that the tool is off, of two axes here, so that accepting it is enough.
#[test]
fn a_program_that_begins_with_a_feed_is_written_as_near_as_the_message_says() {
    let place = Place::new();
    let leaning = SQUARE.replace("EA0Z_urad = 140", "EA0Z_urad = 140, EB0Z_urad = 110");
    let machine = place.write("leaning.toml", &leaning);
    let program = "G21 G90\nG1 Z2.5 F700\nG0 X33 Y21\nG1 Z-1.5 F90\nX61\nM2\n";
    let more = ["-m", machine.as_str(), "-d", "linuxcnc", "--start-at", "95,88,157.5"];
    let said = place.refused(program, &more);
    // Over 95 mm of Z X leans by 10.45 um and Y by 13.3; the rest is the steps of the output.
    assert!(said.starts_with("error[VP0514]: the tool would be 17.36 um off"), "{said}");
    let um = said.split("`--accept ").nth(1).and_then(|rest| rest.split('`').next()).expect("a figure");
    let more = [&more[..], &["--accept", um]].concat();
    let (out, said) = place.corrected(program, &more);
    assert!(said.contains("warning[VP0528]: 1 motion(s)"), "{said}");
    assert!(!blocks(&out)[1].contains(['X', 'Y']), "{out}");
    assert_eq!(place.check(program, &out, &more)["passed"], true);
}

/// A program held against itself is off by what its machine does, in each motion, and no more.
#[test]
fn a_program_that_was_not_corrected_is_measured_truly() {
    let machine = "machine-profiles/generic_vmc.toml";
    let rows: String =
        (1..12).map(|k| format!("X{}. Y{}.\nZ{}.\n", 20 * (k % 3), 15 * k, -(k % 2))).collect();
    let program = format!("G21 G17 G90 G54\nG0 X0 Y0 Z20.\nG1 Z5. F500.\n{rows}G0 Z20.\nM30\n");
    let checked = Place::new().check(&program, &program, &["-m", machine, "-d", "fanuc", "--zero", "true"]);
    assert_eq!(checked["passed"], false);
    assert_eq!(checked["deviation_after_um"], checked["deviation_before_um"], "{checked:#}");
    assert_eq!(checked["deviation_after_line"], checked["deviation_before_line"]);
    assert_eq!(checked["findings"][0], "this program was not corrected: it bears no mark of vpost");
}

/// Linear axes that were to stand follow a crooked table, and F would count their micrometres: the time is told.
#[test]
fn a_turn_at_feed_rate_takes_the_time_it_took() {
    let program =
        "G21 G90 G94 G17 G40 G49\nG0 X10 Y5 Z150 A0 C0\nG1 Z120 F500\nG1 A30 F300\nG1 C40\nX20 F500\nM30\n";
    let place = Place::new();
    let more = ["-m", "samples/profiles/tilting_table.toml", "-d", "linuxcnc"];
    let (out, _) = place.corrected(program, &more);
    let told: Vec<&str> =
        blocks(&out).into_iter().filter(|block| block.starts_with("G9") || block.contains(" F1")).collect();
    // 30 degrees at 300 a minute are a tenth of it; 40 in two halves of 4/60.
    assert_eq!(told[..2], ["G93", "G1 X10.012 Y4.986 Z119.977 A30 F10"], "{out}");
    assert_eq!(told.iter().filter(|block| block.ends_with(" F15")).count(), 2, "{out}");
    assert_eq!(told.iter().filter(|block| **block == "G94 F300").count(), 2, "{out}");
    assert_eq!(place.check(program, &out, &more)["passed"], true);
    for (from, to) in [(" F15", " F9"), (" F10\n", " F100\n"), ("G93\n", ""), ("G94 F300", "G95 F300")] {
        assert_eq!(place.check(program, &out.replace(from, to), &more)["passed"], false, "{from} -> {to}");
    }
    // What no two controls do alike is not told: F while the tip stands.
    let program =
        "G17 G90 G54 G21\nG0 A0. C0.\nG234 H1\nG0 X20. Y10. Z40. C30.\nG1 Z5. F900.\nA-20. C50. F200.\nM30\n";
    let said = place.refused(program, &["-m", "tests/profiles/five_axis.toml", "-d", "haas"]);
    assert!(said.contains("VP0532") && said.contains("in.nc:6:1"), "{said}");
}

/// No F of more digits than controls read: play is taken up slower, and what is cut finer than that is refused.
#[test]
fn inverse_time_stays_within_what_a_control_reads() {
    let program = |feed: u32| {
        format!(
            "G54 G21 G90 G17 G40 G49\nG0 X10. Y5. Z150. A0. C0.\nG93\nG1 Z120. F4\nG1 A30. X40. F{feed}\nG94\nM30\n"
        )
    };
    let place = Place::new();
    let more = ["-m", "samples/profiles/tilting_table.toml", "-d", "fanuc"];
    let (out, _) = place.corrected(&program(30_000), &more);
    let feeds = out.lines().filter_map(|line| line.rsplit_once(" F")?.1.parse::<f64>().ok());
    assert!(feeds.fold(0.0, f64::max) < 99_999.999, "{out}");
    let said = place.refused(&program(60_000), &more);
    assert!(said.contains("VP0532") && said.contains("99999.999"), "{said}");
}
