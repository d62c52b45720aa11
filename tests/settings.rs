//! `vpost.toml`, `vpost config`, and what stands in the wrong place.

use std::path::PathBuf;
use std::process::Output;

use crate::common::{messages, root, vpost};

const SETTINGS: &str = r#"
machine = "machines/stan_s500.toml"
dialect = "linuxcnc"
tolerance = 2.5
work-offset = { G54 = [100, 50.5, 20], G55 = "1,2,3" }
start-at = [0, 0, 180]

[correct]
summary = "last.json"

[batch]
output-dir = "corrected"
"#;

/// A shop: settings above, programs in folders below.
struct Shop(tempfile::TempDir);

impl Shop {
    fn new(settings: &str) -> Self {
        let shop = Self(tempfile::tempdir().expect("a temporary folder"));
        crate::folders::copy(&root().join("machine-profiles"), &shop.path("machines"));
        std::fs::create_dir_all(shop.path("jobs/op10")).expect("new folders");
        for place in ["jobs/part.nc", "jobs/op10/part.nc"] {
            std::fs::copy(root().join("samples/plate_linuxcnc.nc"), shop.path(place)).expect("a copy");
        }
        std::fs::write(shop.path("vpost.toml"), settings).expect("writable");
        shop
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().canonicalize().expect("it is there").join(name)
    }

    fn run(&self, line: &str) -> Output {
        vpost().current_dir(self.0.path()).args(line.split_whitespace()).output().expect("it starts")
    }

    fn fails(&self, line: &str, with: &[&str]) -> String {
        let ran = self.run(line);
        let said = messages(&ran);
        assert!(ran.status.code() == Some(2) && ran.stdout.is_empty(), "{line}: {said}");
        assert!(with.iter().all(|with| said.contains(with)), "{line}: {said}");
        said
    }
}

const TYPED: &str = "-m machines/stan_s500.toml -d linuxcnc --tolerance 2.5 --work-offset G54=100,50.5,20 \
                     --work-offset G55=1,2,3 --start-at 0,0,180";

#[test]
fn a_file_above_the_program_says_what_would_be_typed() {
    let shop = Shop::new(SETTINGS);
    let typed = shop.run(&format!("jobs/part.nc --config none {TYPED}"));
    let held = shop.run("jobs/op10/part.nc");
    assert!(typed.status.success() && held.status.success(), "{}{}", messages(&typed), messages(&held));
    assert_eq!(typed.stdout, held.stdout);
    let said = messages(&held);
    assert!(said.contains("settings from vpost.toml: summary (line 9), machine (line 2)"), "{said}");
    assert!(!messages(&typed).contains("settings from"), "{}", messages(&typed));
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(shop.path("last.json")).expect("beside the file"))
            .expect("JSON");
    assert_eq!(
        summary["settings"]["options"]["work-offset"],
        serde_json::json!(["G54=100,50.5,20", "G55=1,2,3"])
    );
    assert_eq!(summary["tolerance_um"], 2.5);
    // The command line goes before it, `-q` says nothing, standard input is of the current folder.
    let typed = shop.run(&format!("jobs/part.nc --config none {TYPED}").replace("2.5", "60"));
    let over = shop.run("jobs/part.nc --tolerance=60 -q");
    assert_eq!((typed.stdout, messages(&over).as_str()), (over.stdout, ""));
    let stdin = vpost()
        .current_dir(shop.path("jobs"))
        .arg("-")
        .stdin(std::fs::File::open(shop.path("jobs/part.nc")).expect("readable"))
        .output()
        .expect("it starts");
    assert_eq!(stdin.stdout, held.stdout);
    assert!(messages(&stdin).contains("settings from"));
}

#[test]
fn a_quiet_file_is_not_quiet_about_itself() {
    let shop = Shop::new(&format!("quiet = true\nlang = \"ru\"\n{SETTINGS}"));
    let said = messages(&shop.run("jobs/part.nc"));
    assert!(said.starts_with("настройки из ") && said.lines().count() == 1, "{said}");
}

#[test]
fn a_value_that_the_work_refuses_has_its_line() {
    let shop = Shop::new(&SETTINGS.replace("2.5", "-1"));
    shop.fails("jobs/part.nc", &["tolerance (line 4)", "VP0002", "-1 um"]);
}

#[test]
fn a_flag_that_is_off_and_a_folder_of_that_name_decide_nothing() {
    let shop = Shop::new("strict = true\ntolerance = 2.5\n[correct]\nstrict = false\n");
    let line = format!("jobs/op10/part.nc {TYPED}").replace("--tolerance 2.5", "");
    std::fs::create_dir(shop.path("jobs/vpost.toml")).expect("a new folder");
    let said = messages(&shop.run(&line));
    assert!(said.contains("settings from vpost.toml: tolerance (line 2)\n"), "{said}");
    std::fs::write(shop.path("jobs/op10/vpost.toml"), "strict = false\n").expect("writable");
    let said = messages(&shop.run(&line));
    assert!(!said.contains("settings from"), "{said}");
}

#[test]
fn a_batch_has_one_file() {
    let shop = Shop::new(SETTINGS);
    let ran = shop.run("batch jobs");
    assert!(ran.status.success() && shop.path("corrected/op10/part.nc").is_file(), "{}", messages(&ran));
    std::fs::write(shop.path("jobs/op10/vpost.toml"), "tolerance = 5\n").expect("writable");
    shop.fails("batch jobs", &["VP0007", "op10", "--config"]);
    assert!(shop.run("batch jobs --config vpost.toml").status.success());
}

#[test]
fn what_the_file_says_wrongly_is_said_with_its_place() {
    for (settings, with) in [
        ("tolerence = 2\n", ["VP0006", "vpost.toml:1:1", "did you mean `tolerance`?"]),
        ("tolerance = \"two\"\n", ["VP0006", "vpost.toml:1:13", "--tolerance two"]),
        ("\n[batch]\njobs = 0\n", ["VP0006", "vpost.toml:3:8", "0 is not in 1.."]),
        ("strict = \"yes\"\n", ["VP0006", "vpost.toml:1:10", "yes"]),
        ("force = true\n", ["VP0006", "vpost.toml:1:1", "anew in each call"]),
        ("[map]\nstrict = true\n", ["VP0006", "vpost.toml:2:1", "`vpost map` has no option `strict`"]),
        ("[chek]\njson = true\n", ["VP0006", "vpost.toml:1:2", "did you mean `check`?"]),
        ("engine = \"rigidbody\"\n", ["VP0006", "vpost.toml:1:10", "did you mean rigid-body?"]),
        ("tolerance 2\n", ["VP0006", "vpost.toml:1:", "not TOML"]),
        ("machine = 1979-05-27\n", ["VP0006", "vpost.toml:1:11", "cannot be read"]),
    ] {
        let shop = Shop::new(settings);
        shop.fails("jobs/part.nc", &with);
        let russian = messages(&shop.run("jobs/part.nc --lang ru"));
        assert!(russian.starts_with("ошибка[VP0006]"), "{russian}");
    }
    let shop = Shop::new(SETTINGS);
    shop.fails("jobs/part.nc --config nowhere.toml", &["cannot read", "nowhere.toml"]);
}

#[test]
fn what_holds_is_shown_with_its_place() {
    let shop = Shop::new(SETTINGS);
    let ran = shop.run("config jobs/op10/part.nc");
    let text = String::from_utf8(ran.stdout).expect("text");
    let line = |name: &str| text.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    assert!(line("--tolerance").contains(" 2.5 ") && line("--tolerance").ends_with("vpost.toml:4"), "{text}");
    assert!(line("batch --output-dir").contains(" corrected "), "{text}");
    let json: serde_json::Value =
        serde_json::from_slice(&shop.run("config jobs --json").stdout).expect("JSON");
    assert_eq!(json["options"][0]["values"][0], "machines/stan_s500.toml");
    let none = shop.run("config jobs --config none --json");
    let json: serde_json::Value = serde_json::from_slice(&none.stdout).expect("JSON");
    assert_eq!(json["file"], serde_json::Value::Null);
}

/// An option of any command is a key of its table: the file and clap cannot drift apart.
#[test]
fn every_option_is_a_key() {
    let mut tables = 0;
    for command in crate::help::every_command() {
        let words: Vec<&str> = command.split_whitespace().chain(["--help"]).collect();
        let page = String::from_utf8(crate::common::run(&words).stdout).expect("text");
        let table = if command.is_empty() { String::new() } else { command.replace(' ', ".") };
        let options = crate::docs::options(&page);
        for option in
            options.iter().filter(|option| !["--force", "--output", "--config"].contains(&option.as_str()))
        {
            let option = option.trim_start_matches("--");
            let settings = match table.as_str() {
                "" => continue,
                table => format!("[{table}]\n{option} = [[\"nonsense\"]]\n"),
            };
            let place = tempfile::tempdir().expect("a temporary folder");
            std::fs::write(place.path().join("vpost.toml"), settings).expect("writable");
            let ran = vpost().current_dir(place.path()).arg("config").output().expect("it starts");
            assert!(!messages(&ran).contains("has no option"), "{}", messages(&ran));
        }
        tables += usize::from(!options.is_empty());
    }
    assert!(tables > 15, "{tables}");
}

#[test]
fn what_stands_in_the_wrong_place_is_said_as_what_it_is() {
    const MACHINE: &str = "-m machine-profiles/stan_s500.toml";
    for (line, said) in [
        ("corect samples/plate_fanuc.nc", "'correct'"),
        ("chekc a.nc b.nc", "'check'"),
        (
            "samples/points/table_4_9_targets.csv",
            "VP0008]: samples/points/table_4_9_targets.csv is no program but a table",
        ),
        ("machine-profiles/stan_s500.toml", "VP0008]: machine-profiles/stan_s500.toml is no program"),
        ("samples", "vpost batch samples"),
        (r"C:\nc\*.nc", r#"vpost batch C:\nc --pattern "*.nc""#),
        ("*.nc", r#"vpost batch . --pattern "*.nc""#),
        ("a.nc b.nc", "vpost batch a.nc b.nc"),
        ("samples/plate_fanuc.nc --engine rigidbody", "did you mean rigid-body?"),
        ("samples/plate_fanuc.nc --dialect fanux", "did you mean fanuc?"),
        ("samples/plate_fanuc.nc --tolerence 2", "'--tolerance'"),
    ] {
        let line = format!("{line} {MACHINE}");
        let ran = crate::common::run(&line.split(' ').collect::<Vec<_>>());
        assert!(ran.status.code() == Some(2) && messages(&ran).contains(said), "{line}: {}", messages(&ran));
    }
    for (profile, said) in [
        ("samples/plate_fanuc.nc", "is no profile but a program"),
        ("samples/points/table_4_9_targets.csv", "is no profile but a table"),
        ("machine-profiles/stan_s500", "did you mean machine-profiles/stan_s500.toml?"),
        ("machine-profiles/stan_s50.toml", "did you mean machine-profiles/stan_s500.toml?"),
    ] {
        let ran = crate::common::run(&["samples/plate_fanuc.nc", "-m", profile]);
        assert!(
            ran.status.code() == Some(2) && messages(&ran).contains(said),
            "{profile}: {}",
            messages(&ran)
        );
    }
}

/// AXIS shows no messages of a filter that succeeds, and reads these comments while it draws the preview.
#[test]
fn warnings_of_a_filter_stand_in_front_of_its_program() {
    let place = crate::common::Place::new();
    let program = crate::folders::program(1, 20);
    let input = place.write("in.nc", &program);
    let summary = place.0.path().join("summary.json");
    let ran = |more: &[&str]| {
        let mut command = vpost();
        command
            .args([input.as_str(), "-m", crate::folders::PROFILE, "-d", "linuxcnc", "--summary"])
            .arg(&summary);
        let ran = command.args(more).output().expect("it starts");
        assert!(ran.status.success(), "{}", messages(&ran));
        let said: serde_json::Value =
            serde_json::from_slice(&std::fs::read(&summary).expect("written")).expect("JSON");
        assert_eq!(said["output"]["bytes"], ran.stdout.len());
        (String::from_utf8(ran.stdout).expect("ASCII"), said)
    };
    let (plain, said) = ran(&[]);
    let (filtered, said_of_filter) = ran(&["--progress", "linuxcnc"]);
    let is_note = |line: &&str| line.starts_with("(AXIS,notify,");
    let notes: Vec<&str> = filtered.lines().filter(is_note).collect();
    let warnings = said["warnings"].as_array().expect("a list");
    assert!(!notes.is_empty() && notes.len() == warnings.len(), "{notes:?}");
    for (note, warning) in notes.iter().zip(warnings) {
        let text = note.trim_start_matches("(AXIS,notify,").trim_end_matches(')');
        assert!(
            text.starts_with(&format!("vpost {}: ", warning["code"].as_str().expect("a code"))),
            "{note}"
        );
        assert!(note.len() < 255 && !text.contains([',', '(', ')']), "{note}");
    }
    // Behind the `%` that opens it; nothing else is other than without.
    assert!(filtered.starts_with("%\n(AXIS,notify,"), "{filtered}");
    let rest: String =
        filtered.lines().filter(|line| !is_note(line)).map(|line| format!("{line}\n")).collect();
    assert_eq!(rest, plain);
    assert_ne!(said["output"]["blake3"], said_of_filter["output"]["blake3"]);
    assert_eq!(ran(&["--progress", "linuxcnc", "-q"]).0, plain);
}
