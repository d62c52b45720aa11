//! Every way a profile can be wrong is an error with its place and the way out.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use insta::assert_snapshot;
use machine_profile::{AfterChange, BareLengths, LeftAlone, ProfileError, load};

fn base() -> String {
    "format = 1\nname = \"test\"\nchain = \"[w X Y b Z t]\"\n\n[axis.X]\ntravel_mm = [0, 400]\n[axis.Y]\ntravel_mm = [0, 280]\n\
     [axis.Z]\ntravel_mm = [0, 200]\n"
        .to_owned()
}

fn with_table(name: &str) -> String {
    base().replace("travel_mm = [0, 400]", &format!("travel_mm = [0, 400]\nerrors = \"{name}\""))
}

const FILES: [(&str, &[u8]); 18] = [
    ("good.csv", b"position_mm,EXX_um\n0,1\n400,2\n"),
    ("nan.csv", b"position_mm,EXX_um\n0,1\n10,NaN\n"),
    ("empty_cell.csv", b"position_mm,EXX_um\n0,1\n10,\n"),
    ("order.csv", b"position_mm,EXX_um\n0,1\n20,1\n10,1\n"),
    ("twice.csv", b"position_mm,EXX_um\r\n0,1\r\n20,1\r\n20,1\r\n"),
    ("short.csv", b"position_mm,EXX_um\n0,1\n"),
    ("empty.csv", b""),
    ("ragged.csv", b"position_mm,EXX_um\n0,1\n10\n"),
    ("other_axis.csv", b"position_mm,EXY_um\n0,1\n10,1\n"),
    ("unit.csv", b"position_mm,EAX_um\n0,1\n10,1\n"),
    ("no_unit.csv", b"position_mm,EXX\n0,1\n10,1\n"),
    ("no_position.csv", b"y_mm,EXX_um\n0,1\n10,1\n"),
    ("two_units.csv", b"position_mm,EXX_um,EXX_mm\n0,1,1\n10,1,1\n"),
    ("huge.csv", b"position_mm,EXX_mm\n0,1\n10,25\n"),
    ("binary.csv", b"position_mm,EXX_um\n\xff\xfe"),
    (
        "tracker_two.csv",
        b"commanded_x_mm,commanded_y_mm,commanded_z_mm,measured_x_mm,measured_y_mm,measured_z_mm\n0,0,0,0,0,0\n1,1,0,1,1,0\n",
    ),
    (
        "tracker_y.csv",
        b"commanded_x_mm,commanded_y_mm,commanded_z_mm,measured_x_mm,measured_y_mm,measured_z_mm\n0,0,0,0,0,0\n0,1,0,0,1,0\n",
    ),
    ("tracker_columns.csv", b"commanded_x_mm,comanded_y_mm\n0,0\n"),
];

fn read(name: &str) -> std::io::Result<Vec<u8>> {
    match FILES.iter().find(|(known, _)| *known == name) {
        Some((_, bytes)) => Ok(bytes.to_vec()),
        None => Err(std::io::Error::new(std::io::ErrorKind::NotFound, "no such file")),
    }
}

fn told(text: &str) -> String {
    let errors = load(text, &read).expect_err("the profile is wrong");
    errors.iter().map(|e| one(text, e)).collect::<Vec<_>>().join("\n")
}

fn one(text: &str, error: &ProfileError) -> String {
    let d = &error.diagnostic;
    let bytes = error.file.as_deref().map_or_else(
        || text.as_bytes().to_vec(),
        |name| measurement_files::decoded(&read(name).unwrap()).into_owned().into_bytes(),
    );
    let mut out = error.to_string();
    if let Some(span) = &d.span {
        let place = &bytes[span.start as usize..span.end as usize];
        let line = 1 + bytes[..span.start as usize].iter().filter(|b| **b == b'\n').count();
        let start = String::from_utf8_lossy(place).lines().next().unwrap_or_default().to_owned();
        out += &format!("\n  line {line}: `{start}` {}", d.label);
    }
    if let Some(help) = &d.help {
        out += &format!("\nhelp: {help}");
    }
    out
}

#[test]
fn the_base_of_these_tests_is_sound() {
    assert!(load(&base(), &read).is_ok());
    assert!(load(&with_table("good.csv"), &read).is_ok());
}

#[test]
fn not_toml() {
    assert_snapshot!(told("format = 1\nname = \"a"), @r####"
    error[VP0301]: the profile is not TOML: invalid basic string, expected `"`
      line 2: `` here
    "####);
}

#[test]
fn unknown_key_with_the_one_that_was_meant() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travle_mm = [0, 400]")), @r####"
    error[VP0302]: unknown key `travle_mm`
      line 6: `travle_mm` not a key of this table
    help: did you mean `travel_mm`? Known here: travel_mm, resolution_mm, errors, errors_negative, measured_at_mm, backlash_um
    "####);
}

#[test]
fn unknown_table() {
    assert_snapshot!(told(&format!("{}\n[sqareness]\nEC0Y_urad = 1\n", base())), @r####"
    error[VP0302]: unknown key `sqareness`
      line 12: `sqareness` not a key of this table
    help: did you mean `squareness`? Known here: format, name, control, chain, interpolation, calibrated, axis, squareness, tracker, field, rotary, spindle, headstock, tailstock, workpiece, tool, work_offsets_mm, correction, program, m_codes, calls, kinematics, effect, setup
    "####);
}

#[test]
fn wrong_unit_in_a_key() {
    assert_snapshot!(told(&format!("{}\n[squareness]\nEC0Y_mrad = 1\n", base())), @r####"
    error[VP0302]: unknown key `EC0Y_mrad`
      line 13: `EC0Y_mrad` not a key of this table
    help: did you mean `EC0Y_urad`? Known here: EC0Y_urad, EB0Z_urad, EA0Z_urad
    "####);
}

#[test]
fn missing_name() {
    assert_snapshot!(told(&base().replace("name = \"test\"\n", "")), @r####"
    error[VP0302]: the profile lacks the key `name`
      line 1: `` here
    "####);
}

#[test]
fn format_of_another_version() {
    assert_snapshot!(told(&base().replace("format = 1", "format = 2")), @r####"
    error[VP0310]: format 2 of the profile is not known
      line 1: `2` expected 1
    help: write format = 1, or use a newer vpost
    "####);
}

#[test]
fn axis_twice_in_the_chain() {
    assert_snapshot!(told(&base().replace("[w X Y b Z t]", "[w X Y b X t]")), @r####"
    error[VP0304]: `X` stands in the chain twice
      line 3: `"[w X Y b X t]"` this chain
    help: write the axes from workpiece (w) to tool (t), b for the bed, like "[w X Y b Z t]"
    "####);
}

#[test]
fn chain_without_tool() {
    assert_snapshot!(told(&base().replace("[w X Y b Z t]", "[w X Y b Z]")), @r####"
    error[VP0304]: the chain lacks `t`: it begins with w (workpiece), ends with t (tool) and holds b (bed) between them
      line 3: `"[w X Y b Z]"` this chain
    help: write the axes from workpiece (w) to tool (t), b for the bed, like "[w X Y b Z t]"
    "####);
}

#[test]
fn chain_without_workpiece() {
    assert_snapshot!(told(&base().replace("[w X Y b Z t]", "[X Y b Z t]")), @r####"
    error[VP0304]: the chain lacks `w`: it begins with w (workpiece), ends with t (tool) and holds b (bed) between them
      line 3: `"[X Y b Z t]"` this chain
    help: write the axes from workpiece (w) to tool (t), b for the bed, like "[w X Y b Z t]"
    "####);
}

#[test]
fn travel_reversed() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [400, 0]")), @r####"
    error[VP0303]: travel_mm of X runs from 400 to 0
      line 6: `[400, 0]` the lower end must lie below the upper
    help: write the lower end first: [0, 400]
    "####);
}

#[test]
fn resolution_zero() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [0, 400]\nresolution_mm = 0")), @r####"
    error[VP0303]: resolution_mm of X is 0
      line 7: `0` expected a number above 0, at most 0.1
    help: write the smallest step the control takes, like 0.001
    "####);
}

/// A micrometre step written as one: everything would be rounded to it.
#[test]
fn resolution_in_the_wrong_unit() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [0, 400]\nresolution_mm = 1")), @r####"
    error[VP0303]: resolution_mm of X is 1
      line 7: `1` expected a number above 0, at most 0.1
    help: write the smallest step the control takes, like 0.001
    "####);
}

#[test]
fn not_a_number() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [0, nan]")), @r####"
    error[VP0303]: NaN is not a finite number
      line 6: `[0, nan]` here
    "####);
}

#[test]
fn a_text_where_a_number_belongs() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [0, \"400\"]")), @r####"
    error[VP0303]: invalid type: string "400", expected a number
      line 6: `"400"` here
    "####);
}

#[test]
fn axis_missing() {
    assert_snapshot!(told(&base().replace("[axis.Z]\ntravel_mm = [0, 200]\n", "")), @r####"
    error[VP0302]: the profile lacks [axis.Z]
    help: add [axis.Z] with travel_mm = [lowest, highest]
    "####);
}

#[test]
fn no_such_date() {
    assert_snapshot!(told(&format!("{}\n[calibrated]\ndate = \"2023-02-29\"\n", base())), @r####"
    error[VP0303]: `2023-02-29` is not a date
      line 13: `"2023-02-29"` expected year-month-day
    help: write year-month-day, like "2023-05-15"
    "####);
}

#[test]
fn table_that_cannot_be_read() {
    assert_snapshot!(told(&with_table("missing.csv")), @r####"
    error[VP0305]: cannot read the table missing.csv: no such file
      line 7: `"missing.csv"` named here
    help: paths are relative to the profile's own folder
    "####);
}

#[test]
fn unknown_engine() {
    assert_snapshot!(told(&format!("{}\n[correction]\nengine = \"rigidbody\"\n", base())), @r####"
    error[VP0303]: `rigidbody` is no engine that corrects programs
      line 13: `"rigidbody"` this engine
    help: did you mean "rigid-body"? Engines: rigid-body, tracker, tangential-static, tangential-interval, tangential-quasi-differential, kmtpp, field
    "####);
}

#[test]
fn published_engines_correct_no_programs() {
    assert_snapshot!(told(&format!("{}\n[correction]\nengine = \"kmtpp-published\"\n", base())), @r####"
    error[VP0303]: `kmtpp-published` is no engine that corrects programs
      line 13: `"kmtpp-published"` this engine
    help: engines: rigid-body, tracker, tangential-static, tangential-interval, tangential-quasi-differential, kmtpp, field
    "####);
}

#[test]
fn tolerance_zero() {
    assert_snapshot!(told(&format!("{}\n[correction]\ntolerance_um = 0\n", base())), @r####"
    error[VP0303]: tolerance_um is 0
      line 13: `0` expected a number above 0
    "####);
}

#[test]
fn backlash_counted_twice() {
    assert_snapshot!(told(&with_table("good.csv\"\nbacklash_um = 3\nerrors_negative = \"good.csv")), @r####"
    error[VP0309]: axis X has both errors_negative and backlash_um
      line 8: `3` counted twice
    help: two tables already hold the reversal value: leave backlash_um out
    "####);
}

#[test]
fn errors_negative_alone() {
    assert_snapshot!(told(&base().replace("travel_mm = [0, 400]", "travel_mm = [0, 400]\nerrors_negative = \"good.csv\"")), @r####"
    error[VP0309]: axis X has errors_negative, but no errors
      line 7: `"good.csv"` the other direction is missing
    help: errors is the table of the positive direction; a table for both directions is errors alone
    "####);
}

#[test]
fn measuring_line_of_the_axis_itself() {
    assert_snapshot!(told(&with_table("good.csv\"\nmeasured_at_mm = { X = 3 }\n#\"")), @r####"
    error[VP0309]: measured_at_mm of X names X itself
      line 8: `{ X = 3 }` X moved along the whole line
    help: it says where the other axes stood while this one was measured
    "####);
}

#[test]
fn travel_and_table_have_nothing_in_common() {
    assert_snapshot!(told(&with_table("good.csv").replace("[0, 400]", "[-400, -1]")), @r####"
    error[VP0309]: axis X: its tables and its travel have no interval in common
      line 5: `[axis.X]` this axis
    help: travel_mm and the tables' position_mm are both machine coordinates
    "####);
}

#[test]
fn tilt_whose_meaning_is_not_said() {
    let turning = base().replace("[w X Y b Z t]", "[w C X Y b Z t]");
    let tilted = format!("{turning}\n[rotary.C]\ncentre_mm = [0, 0, 0]\nEA0C_urad = 5\n");
    let said = told(&tilted);
    assert!(said.contains("error[VP0314]") && said.contains("tilt = \"body\" in [rotary.C]"), "{said}");
    // Said, or no tilt at all: nothing to ask.
    for fine in [tilted.replace("EA0C", "tilt = \"axis\"\nEA0C"), tilted.replace("= 5", "= 0")] {
        assert!(load(&fine, &read).is_ok(), "{fine}");
    }
}

#[test]
fn rotary_axis_the_chain_lacks() {
    assert_snapshot!(told(&format!("{}\n[rotary.C]\ncentre_mm = [0, 0, 0]\n", base())), @r####"
    error[VP0309]: [rotary.C] is described, but the chain lacks C
      line 12: `[rotary.C]` not in the chain
    help: add C to the chain, or remove [rotary.C]
    "####);
}

#[test]
fn location_error_of_another_axis() {
    assert_snapshot!(told(&format!("{}\n[rotary.C]\nEX0A_um = 1\n", base())), @r####"
    error[VP0302]: unknown key `EX0A_um`
      line 13: `EX0A_um` not a key of this table
    help: did you mean `EX0C_um`? Known here: centre_mm, travel_deg, direction, tilt, resolution_deg, errors, errors_negative, backlash_urad, EX0C_um, EY0C_um, EA0C_urad, EB0C_urad
    "####);
}

#[test]
fn tool_without_number() {
    assert_snapshot!(told(&format!("{}\n[tool.lengths_mm]\nT1 = 120.0\n", base())), @r####"
    error[VP0302]: `T1` is no H number
      line 13: `120.0` of this entry
    help: write H and a whole number from 1, like H1 = 120.0
    "####);
}

#[test]
fn tool_length_of_two_numbers() {
    assert_snapshot!(told(&format!("{}\n[tool.lengths_mm]\nH1 = [1, 2]\n", base())), @r####"
    error[VP0303]: expected a length along Z in mm, or three numbers [x, y, z]
      line 13: `[1, 2]` here
    "####);
}

#[test]
fn lengths_of_a_tip_control_count_from_the_gauge_point() {
    let text = format!(
        "{}\n[tool]\ngauge_point_mm = -470.0\n[kinematics]\nstraight = \"tip\"\ncentres_mm = {{}}\n",
        base()
    );
    assert_snapshot!(told(&text), @r####"
    error[VP0309]: `gauge_point_mm` and `[kinematics]`: the control turns tools about what it takes for the gauge point
      line 13: `-470.0` this key
    help: give lengths from the gauge point, on the control and here, and leave `gauge_point_mm` out
    "####);
}

#[test]
fn tool_name_without_its_length() {
    let text = format!("{}\n[tool]\nnames = {{ \"MILL 12\" = 7 }}\n", base());
    assert_snapshot!(told(&text), @r####"
    error[VP0302]: the tool "MILL 12" has the length H7
      line 13: `7` lengths_mm has no such length
    help: add the length to `lengths_mm`, or correct the number
    "####);
}

#[test]
fn edge_that_is_neither_the_first_nor_none() {
    let text = format!("{}\n[program]\nedge_at_change = 2\n", base());
    assert_snapshot!(told(&text), @r####"
    error[VP0303]: edge_at_change is 2
      line 13: `2` expected 0 or 1
    help: 1 where a tool change brings in the first edge, 0 where it brings in none (MD20270)
    "####);
}

#[test]
fn finishing_passes_are_whole() {
    let text = format!("{}\n[program]\nthread_finishing_passes = 1.5\n", base());
    assert_snapshot!(told(&text), @r####"
    error[VP0303]: thread_finishing_passes is 1.5
      line 13: `1.5` expected a whole number from 1 to 99
    help: give the control's value (parameter 5142)
    "####);
}

#[test]
fn work_offset_without_name() {
    assert_snapshot!(told(&format!("{}\n[work_offsets_mm]\noffset = [0, 0, 0]\n", base())), @r####"
    error[VP0302]: `offset` is no work offset
      line 13: `[0, 0, 0]` of this entry
    help: write the word that selects it, like G54 or "G54.1 P2"
    "####);
}

#[test]
fn unknown_effect() {
    assert_snapshot!(told(&format!("{}\n[[effect]]\nid = \"backlsh.X\"\nhalf_width_um = 6.2\n", base())), @r####"
    error[VP0311]: unknown effect 'backlsh.X'; known are for example scale.X, backlash.Y, squareness.XZ, straightness.EYX, angular.EAX
      line 13: `"backlsh.X"` this effect
    "####);
}

#[test]
fn effect_without_id() {
    assert_snapshot!(told(&format!("{}\n[[effect]]\nhalf_width_um = 6.2\n", base())), @r####"
    error[VP0311]: an effect lacks its id
      line 12: `[[effect]]` this effect
    help: add id = "backlash.X", or whichever it is
    "####);
}

#[test]
fn several_at_once() {
    assert_snapshot!(told(&base().replace("[0, 400]", "[400, 0]").replace("[0, 280]", "[0, 280]\nresolution_mm = -1")), @r####"
    error[VP0303]: travel_mm of X runs from 400 to 0
      line 6: `[400, 0]` the lower end must lie below the upper
    help: write the lower end first: [0, 400]
    error[VP0303]: resolution_mm of Y is -1
      line 9: `-1` expected a number above 0, at most 0.1
    help: write the smallest step the control takes, like 0.001
    "####);
}

#[test]
fn table_with_nan() {
    assert_snapshot!(told(&with_table("nan.csv")), @r####"
    nan.csv: error[VP0307]: `NaN` is not a number
      line 3: `NaN` EXX_um
    help: write a decimal number like -12.5
    "####);
}

#[test]
fn table_with_an_empty_cell() {
    assert_snapshot!(told(&with_table("empty_cell.csv")), @r####"
    empty_cell.csv: error[VP0307]: `EXX_um` is empty
      line 3: `` EXX_um
    help: a function that was not measured is a column left out, not an empty cell
    "####);
}

#[test]
fn table_out_of_order() {
    assert_snapshot!(told(&with_table("order.csv")), @r####"
    order.csv: error[VP0308]: out of order: position_mm 10 follows 20, positions must increase from row to row
      line 4: `10,1` this row
    help: sort the rows; two runs, or two directions, are two tables
    "####);
}

#[test]
fn table_with_a_position_twice() {
    assert_snapshot!(told(&with_table("twice.csv")), @r####"
    twice.csv: error[VP0308]: the same position twice: position_mm 20 follows 20, positions must increase from row to row
      line 4: `20,1` this row
    help: sort the rows; two runs, or two directions, are two tables
    "####);
}

#[test]
fn table_of_one_row() {
    assert_snapshot!(told(&with_table("short.csv")), @r####"
    short.csv: error[VP0308]: a table needs at least 2 rows, this one has 1
      line 2: `0,1` the only row
    help: measure the ends of the travel at least
    "####);
}

#[test]
fn table_that_is_empty() {
    assert_snapshot!(told(&with_table("empty.csv")), @r####"
    empty.csv: error[VP0305]: the file is empty
    help: expected: position_mm and error functions of X with their units, EXX_um … ECX_urad
    "####);
}

#[test]
fn table_with_a_short_row() {
    assert_snapshot!(told(&with_table("ragged.csv")), @r####"
    ragged.csv: error[VP0307]: the row has 1 cells, the header 2
      line 3: `10` this row
    help: give every row as many cells as the header, empty ones where nothing was measured
    "####);
}

#[test]
fn column_of_another_axis() {
    assert_snapshot!(told(&with_table("other_axis.csv")), @r####"
    other_axis.csv: error[VP0306]: column `EXY_um` is an error function of Y, and the file is of another axis
      line 1: `EXY_um` this column
    help: give each axis a file of its own
    "####);
}

#[test]
fn column_in_a_wrong_unit() {
    assert_snapshot!(told(&with_table("unit.csv")), @r####"
    unit.csv: error[VP0306]: column `EAX_um`: EAX is an angle, um is a length
      line 1: `EAX_um` this column
    help: write `EAX_urad`; units of an angle: deg, rad, um_per_mm, urad, arcsec
    "####);
}

#[test]
fn column_without_unit() {
    assert_snapshot!(told(&with_table("no_unit.csv")), @r####"
    no_unit.csv: error[VP0306]: column `EXX` says no unit
      line 1: `EXX` this column
    help: write `EXX_um`
    "####);
}

#[test]
fn table_without_positions() {
    assert_snapshot!(told(&with_table("no_position.csv")), @r####"
    no_position.csv: error[VP0306]: column `y_mm` is unknown
      line 1: `y_mm` this column
    help: known here: position_mm, EXX_um, EYX_um, EZX_um, EAX_urad, EBX_urad, ECX_urad
    "####);
}

#[test]
fn column_twice_in_two_units() {
    assert_snapshot!(told(&with_table("two_units.csv")), @r####"
    two_units.csv: error[VP0306]: column `EXX_mm` stands twice: `EXX_um` is the same
      line 1: `EXX_mm` this column
    help: remove one of them
    "####);
}

#[test]
fn errors_too_large_to_be_errors() {
    assert_snapshot!(told(&with_table("huge.csv")), @r####"
    huge.csv: error[VP0308]: an error of 25.000 mm and 0.000 mrad is larger than geometric errors get: wrong unit?
      line 3: `10,25` up to 20 mm and 100 mrad are read
    help: name each column by its unit
    "####);
}

#[test]
fn table_that_is_not_text() {
    assert_snapshot!(told(&with_table("binary.csv")), @r####"
    binary.csv: error[VP0307]: the row has 1 cells, the header 2
      line 2: `яю` this row
    help: give every row as many cells as the header, empty ones where nothing was measured
    "####);
}

#[test]
fn traverse_that_moves_two_axes() {
    assert_snapshot!(told(&format!("{}\n[tracker]\nx = \"tracker_two.csv\"\ny = \"tracker_y.csv\"\nz = \"tracker_columns.csv\"\n", base())), @r####"
    tracker_two.csv: error[VP0308]: axis Y moves in the traverse of X: 1 mm after 0 mm
      line 3: `1,1,0,1,1,0` a traverse moves one axis alone
    help: give each axis a file of its own
    tracker_columns.csv: error[VP0306]: column `comanded_y_mm` is unknown
      line 1: `comanded_y_mm` this column
    help: did you mean commanded_y_mm? known here: commanded_x_mm, commanded_y_mm, commanded_z_mm, measured_x_mm, measured_y_mm, measured_z_mm, published_cos_x, published_cos_y, published_cos_z
    "####);
}

/// What programs of this machine mean: read, and wrong in each way.
#[test]
fn program_rules() {
    let rules = |text: &str| load(&format!("{}{text}\n", base()), &read).unwrap().program;
    assert_eq!(rules("").tool_change, [AfterChange::Unknown; 3]);
    assert_eq!(rules("[program]\ndecimal = \"increments\"").bare_lengths, Some(BareLengths::Increments));
    assert_eq!(rules("[m_codes]\nharmless = [\"M777\", \"m12\"]").harmless_m_codes, [777, 12]);
    let calls = rules("[calls]\n\"G65 P9810\" = { unknown = \"ZB\" }\nM200 = \"harmless\"").calls;
    let left = |letter, tenths, program, unknown| LeftAlone { letter, tenths, program, unknown };
    let moves = [false, false, true, false, true, false];
    assert_eq!(calls, [left('G', 650, Some(9810), moves), left('M', 2000, None, [false; 6])]);
    let change = |text: &str| rules(&format!("[program]\ntool_change = {text}")).tool_change;
    let at = AfterChange::At;
    assert_eq!(change("{ keeps = \"XYZ\" }"), [AfterChange::Stays; 3]);
    assert_eq!(change("[1, 2, 3]"), [at(1.0), at(2.0), at(3.0)]);
    assert_eq!(change("{ position_mm = [1, 2, 3] }"), [at(1.0), at(2.0), at(3.0)]);
    assert_eq!(
        change("{ keeps = \"X\", position_mm = { Z = 350.0 } }"),
        [AfterChange::Stays, AfterChange::Unknown, at(350.0)]
    );
    for (text, code) in [
        ("[program]\ndecimal = \"inches\"", "VP0303"),
        ("[program]\ntool_change = { keeps = \"XW\" }", "VP0303"),
        ("[program]\ntool_change = { keeps = \"XYZ\", position_mm = { Z = 350.0 } }", "VP0309"),
        ("[program]\ntool_change = [1, 2]", "VP0303"),
        ("[program]\ntool_change = [1, 2, inf]", "VP0303"),
        ("[program]\ntoolchange = 1", "VP0302"),
        ("[m_codes]\nharmless = [\"777\"]", "VP0303"),
        ("[m_codes]\nharmless = [\"M70000\"]", "VP0303"),
        ("[calls]\n\"G65 9810\" = { unknown = \"Z\" }", "VP0303"),
        ("[calls]\n\"G65 P9810\" = { unknown = \"ZW\" }", "VP0303"),
        ("[calls]\n\"L9810\" = \"harmless\"", "VP0303"),
        ("[calls]\n\"G65 P9810\" = \"moves\"", "VP0303"),
        ("[calls]\n\"G65 P9810\" = { moves = \"Z\" }", "VP0303"),
    ] {
        let said = told(&format!("{}{text}\n", base()));
        assert!(said.contains(code), "{text}: {said}");
    }
}

/// A field knows its vectors alone; whoever wrote errors of axes beside them may take both for corrected.
#[test]
fn errors_of_axes_beside_a_field_are_said_to_be_unused() {
    let mut vectors = "x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n".to_owned();
    for k in 0..8 {
        let [x, y, z] = [400 * (k & 1), 280 * (k >> 1 & 1), 200 * (k >> 2)];
        vectors.push_str(&format!("{x},{y},{z},1,2,3\n"));
    }
    let with = |axes: &str| {
        let more = "[field]\nfile = \"vectors.csv\"\nnoise_um = 0\n[correction]\nengine = \"field\"\n";
        let text = format!("{axes}{more}");
        let profile = load(&text, &|name| match name {
            "vectors.csv" => Ok(vectors.clone().into_bytes()),
            other => read(other),
        });
        let doubts = profile.unwrap().doubts(machine_model::EngineId::Field);
        doubts.iter().map(|d| format!("{} {}", d.message.english(), d.help.is_some())).collect::<Vec<_>>()
    };
    assert_eq!(with(&base()), Vec::<String>::new());
    let square = format!("{}[squareness]\nEC0Y_urad = 20\n", with_table("good.csv"));
    let said = with(&square);
    let expected = "the errors in [axis.X], [squareness] are not used";
    assert!(said.len() == 1 && said[0].starts_with(expected), "{said:?}");
}
