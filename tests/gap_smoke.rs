//! A few dozen of the lab's cases through the command: what `cargo run -p xtask --release -- gap-bench` asks of a
//! thousand, so that a change that ruins the diagnosis is seen before the benchmark is run again.

use std::process::Command;

use gap_lab::{Case, CaseSpec, Kind, catalogue};
use serde_json::Value;

/// Diagnoses one case; verdict, first name, and every name with its rivals.
fn answer(case: &Case) -> (String, Option<String>, Vec<String>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in &case.files {
        std::fs::write(folder.path().join(name), text).expect("writable");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_vpost"))
        .args(["diagnose", "measurement.csv", "-m", "profile.toml", "--json", "answer.json"])
        .current_dir(folder.path())
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{}: {}", case.id, String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.path().join("answer.json")).expect("it was written");
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let causes = json["causes"].as_array().expect("a list");
    let word = |v: &Value| v.as_str().expect("a word").to_owned();
    let rivals =
        |c: &Value| c["cannot_be_told_from"].as_array().expect("a list").iter().map(word).collect::<Vec<_>>();
    let names = causes.iter().flat_map(|c| std::iter::once(word(&c["effect"])).chain(rivals(c))).collect();
    (word(&json["verdict"]), causes.first().map(|c| word(&c["effect"])), names)
}

/// Every so manyth case of a kind, of a seed that nothing was tuned on.
fn some(kind: Kind, count: usize, wanted: impl Fn(&CaseSpec) -> bool) -> Vec<Case> {
    let list: Vec<CaseSpec> =
        catalogue(1200, 11).into_iter().filter(|s| s.kind == kind && wanted(s)).collect();
    let stride = list.len() / count;
    list.iter().step_by(stride).take(count).map(CaseSpec::build).collect()
}

/// The goal of the benchmark is 95 %; at that rate more than three of 20 are lost once in sixty draws.
#[test]
fn the_right_effect_comes_first() {
    let cases = some(Kind::Single, 20, |s| s.snr[0] > 2.0);
    let identifiable = cases.iter().filter(|c| c.truth.identifiable);
    let missed: Vec<String> = identifiable
        .filter_map(|case| {
            let (verdict, first, names) = answer(case);
            let truth = &case.truth.effects[0].id;
            (first.as_ref() != Some(truth)).then(|| format!("{}: {truth} -> {verdict} {names:?}", case.id))
        })
        .collect();
    assert!(missed.len() <= 3, "{missed:#?}");
}

/// At most one alarm in seven nulls, one of each kind of noise; the goal is 5 %.
#[test]
fn nothing_is_named_where_nothing_is() {
    let alarms: Vec<String> = some(Kind::Null, 7, |_| true)
        .iter()
        .filter_map(|case| {
            let (verdict, first, names) = answer(case);
            let owned_up = names.iter().any(|n| n == "instrument-drift");
            (first.is_some() && !owned_up).then(|| format!("{}: {verdict} {names:?}", case.id))
        })
        .collect();
    assert!(alarms.len() <= 1, "{alarms:#?}");
}

/// A design that cannot tell two names must not pretend to.
#[test]
fn an_aliased_design_gives_the_set() {
    let missed: Vec<String> = some(Kind::Aliased, 6, |_| true)
        .iter()
        .filter_map(|case| {
            let (verdict, _, names) = answer(case);
            let honest = verdict == "AMBIGUOUS" && names.contains(&case.truth.effects[0].id);
            (!honest).then(|| format!("{}: {verdict} {names:?}", case.id))
        })
        .collect();
    assert!(missed.len() <= 1, "{missed:#?}");
}

/// An effect without a name must not get one.
#[test]
fn what_has_no_name_is_not_named() {
    let named: Vec<String> = some(Kind::Outside, 3, |_| true)
        .iter()
        .filter_map(|case| {
            let (verdict, _, names) = answer(case);
            let admits = verdict == "PARTIAL" || verdict == "UNKNOWN";
            (!admits).then(|| format!("{}: {verdict} {names:?}", case.id))
        })
        .collect();
    assert!(named.is_empty(), "{named:#?}");
}

/// Two linear axes that stand at few places beside a table that turns look exchanged where the table is beside its place:
/// the file must be diagnosed, not refused, and the table stand among the names.
#[test]
fn a_table_beside_its_place_is_no_slip_of_the_columns() {
    let list = catalogue(1200, 1);
    // The benchmark's cases that were refused with VP0919, x_mm and z_mm exchanged.
    for id in ["rotary-1192", "rotary-1199"] {
        let case = list.iter().find(|spec| spec.id() == id).expect("it is in the catalogue").build();
        let (verdict, _, names) = answer(&case);
        assert!(names.contains(&case.truth.effects[0].id), "{id}: {verdict} {names:?}");
    }
}

/// The lab's chain of matrices and the model agree on what the profile as handed out predicts, tables that turn included.
#[test]
fn the_lab_and_the_model_are_the_same_machine() {
    let mut cases = some(Kind::Single, 4, |_| true);
    cases.extend(some(Kind::Rotary, 4, |_| true));
    for case in &cases {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (name, text) in &case.files {
            std::fs::write(folder.path().join(name), text).expect("writable");
        }
        std::fs::write(folder.path().join("points.csv"), case.fresh.points_csv()).expect("writable");
        let output = Command::new(env!("CARGO_BIN_EXE_vpost"))
            .args(["predict", "points.csv", "-m", "profile.toml"])
            .current_dir(folder.path())
            .output()
            .expect("it starts");
        assert!(output.status.success(), "{}: {}", case.id, String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let known = case.fresh.known_um();
        assert_eq!(lines.len(), known.len() + 1, "{}", case.id);
        for (axis, head) in ["dx_um", "dy_um", "dz_um"].into_iter().enumerate() {
            let column = lines[0].iter().position(|h| *h == head).expect("a column");
            for (line, known) in lines[1..].iter().zip(&known) {
                let predicted: f64 = line[column].parse().expect("a number");
                assert!((predicted - known[axis]).abs() < 0.01, "{}: {head} {predicted}, {known:?}", case.id);
            }
        }
    }
}
