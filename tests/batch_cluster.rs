//! `vpost batch plan`, `run` and `merge`: the same as one run, from any number of tasks.

use std::path::PathBuf;
use std::process::{Command, Output};

use crate::common::{messages, root, vpost};
use crate::folders::{PROFILE, program, release, temporaries, tree};

/// A release, planned.
struct Planned {
    folder: tempfile::TempDir,
    input: PathBuf,
    output: PathBuf,
    manifest: PathBuf,
}

impl Planned {
    fn new(programs: u64) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = |name: &str| folder.path().join(name);
        let planned =
            Self { input: path("release"), output: path("out"), manifest: path("plan.jsonl"), folder };
        release(&planned.input, programs, 20);
        let ran = planned.plan(&[]);
        assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
        planned
    }

    fn plan(&self, more: &[&str]) -> Output {
        let mut command = vpost();
        command.args(["batch", "plan"]).arg(&self.input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]);
        command.arg(&self.output).arg("--manifest").arg(&self.manifest).args(more);
        command.output().expect("the command starts")
    }

    fn command(&self, task: &str) -> Command {
        let mut command = vpost();
        command.args(["batch", task, "--manifest"]).arg(&self.manifest);
        for name in ["HQ_TASK_ID", "SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"] {
            command.env_remove(name);
        }
        command
    }

    fn shard(&self, shard: &str) -> Output {
        self.command("run").args(["--shard", shard]).output().expect("the command starts")
    }

    fn merge(&self, more: &[&str]) -> Output {
        self.command("merge").args(more).output().expect("the command starts")
    }

    /// What one run of the same programs gives.
    fn local(&self) -> (PathBuf, PathBuf) {
        let (output, results) = (self.folder.path().join("local"), self.folder.path().join("local.jsonl"));
        let mut command = vpost();
        command.arg("batch").arg(&self.input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]).arg(&output);
        command.arg("--results").arg(&results).output().expect("the command starts");
        (output, results)
    }
}

fn assert_status(ran: &Output, status: i32) {
    assert_eq!(ran.status.code(), Some(status), "{}", messages(ran));
}

fn text(ran: &Output) -> String {
    String::from_utf8_lossy(&ran.stdout).into_owned()
}

#[test]
fn shards_in_any_order_and_number_are_the_local_run() {
    for order in [
        &["1/1"][..],
        &["3/3", "1/3", "2/3"],
        &["4/9", "9/9", "1/9", "2/9", "3/9", "8/9", "7/9", "6/9", "5/9"],
    ] {
        let planned = Planned::new(7);
        std::fs::write(planned.input.join("zz.nc"), "G21 G90\nG0 X#500\n").unwrap();
        std::fs::remove_file(&planned.manifest).unwrap();
        assert_status(&planned.plan(&[]), 0);
        let statuses: Vec<_> = order.iter().map(|shard| planned.shard(shard).status.code()).collect();
        // The refused program is the last of eight.
        let holds_refused = |shard: &&str| {
            let (number, of) = shard.split_once('/').unwrap();
            7 % of.parse::<usize>().unwrap() + 1 == number.parse::<usize>().unwrap()
        };
        let expected: Vec<_> = order.iter().map(|shard| Some(i32::from(holds_refused(shard)))).collect();
        assert_eq!(statuses, expected, "{order:?}");
        let merged = planned.folder.path().join("merged.jsonl");
        let ran = planned.merge(&["--results", merged.to_str().unwrap()]);
        assert_status(&ran, 1);
        let (local, results) = planned.local();
        assert!(tree(&planned.output) == tree(&local), "{order:?}");
        assert!(std::fs::read(merged).unwrap() == std::fs::read(results).unwrap(), "{order:?}");
        assert!(temporaries(&planned.output).is_empty());
        // A second merge says the same from the one journal that is left.
        assert_eq!(std::fs::read_dir(planned.output.join(".vpost/journal")).unwrap().count(), 1);
        assert_eq!(text(&planned.merge(&[])), text(&ran));
    }
}

#[test]
fn what_is_missing_is_said_in_the_engines_form() {
    let planned = Planned::new(8);
    for shard in ["1/6", "3/6"] {
        assert_status(&planned.shard(shard), 0);
    }
    let missing = |form: &str| {
        let ran = planned.merge(&["--shards", "6", "--missing", form]);
        (ran.status.code(), text(&ran))
    };
    assert_eq!(missing("slurm"), (Some(75), "2,4-6\n".to_owned()));
    assert_eq!(missing("hq"), (Some(75), "2,4-6\n".to_owned()));
    assert_eq!(missing("parallel"), (Some(75), "2\n4\n5\n6\n".to_owned()));
    let ran = planned.merge(&["--shards", "6"]);
    assert_status(&ran, 75);
    assert!(messages(&ran).contains("--array=2,4-6"), "{}", messages(&ran));
    for shard in ["2/6", "4/6", "5/6", "6/6"] {
        assert_status(&planned.shard(shard), 0);
    }
    assert_eq!(missing("slurm"), (Some(0), String::new()));
    // An output that is not as it was written is missing: the seventh program belongs to the first shard.
    let outputs = tree(&planned.output);
    let seventh = outputs.keys().nth(6).unwrap();
    std::fs::write(planned.output.join(seventh), &outputs[seventh][..50]).unwrap();
    assert_eq!(missing("slurm"), (Some(75), "1\n".to_owned()));
    assert_status(&planned.shard("1/6"), 0);
    assert_eq!(missing("slurm"), (Some(0), String::new()));
    assert!(tree(&planned.output) == outputs);
}

#[test]
fn a_manifest_does_not_change() {
    let planned = Planned::new(4);
    let first = std::fs::read_to_string(&planned.manifest).unwrap();
    let names: Vec<String> = first
        .lines()
        .skip(1)
        .map(|line| {
            serde_json::from_str::<serde_json::Value>(line).unwrap()["output"].as_str().unwrap().to_owned()
        })
        .collect();
    assert!(names.is_sorted() && names.len() == 4, "{names:?}");
    assert_status(&planned.plan(&[]), 0);
    assert_eq!(std::fs::read_to_string(&planned.manifest).unwrap(), first, "the same plan again");
    let ran = planned.plan(&["--tolerance", "2"]);
    assert_status(&ran, 2);
    assert!(messages(&ran).contains("error[VP1010]"), "{}", messages(&ran));
    assert_eq!(std::fs::read_to_string(&planned.manifest).unwrap(), first);

    let lines: Vec<&str> = first.lines().collect();
    let cut = lines[..4].join("\n") + "\n";
    let other_version = first.replacen("\"version\":\"", "\"version\":\"9", 1);
    let edited = first.replacen("part0000.nc", "part0009.nc", 2);
    for damaged in [&cut, &edited, &other_version, &first[1..], "", "{}\n"] {
        std::fs::write(&planned.manifest, damaged).unwrap();
        for ran in [planned.shard("1/1"), planned.merge(&[])] {
            assert_status(&ran, 2);
            assert!(messages(&ran).contains("error[VP1010]"), "{}", messages(&ran));
        }
    }
    std::fs::remove_file(&planned.manifest).unwrap();
    assert_status(&planned.shard("1/1"), 2);
    assert!(!planned.output.exists());
}

#[test]
fn what_changed_since_the_plan_is_refused() {
    let planned = Planned::new(4);
    std::fs::write(planned.input.join("part0000.nc"), program(50, 20)).unwrap();
    std::fs::remove_file(planned.input.join("part0003.nc")).unwrap();
    let ran = planned.shard("1/1");
    assert_status(&ran, 1);
    assert_eq!(messages(&ran).matches("error[VP1007]").count(), 2, "{}", messages(&ran));
    assert_eq!(tree(&planned.output).len(), 2, "the others are corrected");
    // Running it again would not help, so no shard is asked for.
    let ran = planned.merge(&["--shards", "2", "--missing", "slurm"]);
    assert_eq!((ran.status.code(), text(&ran)), (Some(1), String::new()));
    // Brought back, it is what was planned.
    std::fs::write(planned.input.join("part0000.nc"), program(0, 20)).unwrap();
    std::fs::write(planned.input.join("part0003.nc"), program(3, 20)).unwrap();
    assert_status(&planned.shard("1/1"), 0);
    assert_status(&planned.merge(&[]), 0);

    let options = planned.command("run").args(["--tolerance", "2"]).output().unwrap();
    assert_status(&options, 2);
    assert!(messages(&options).contains("does not read `--tolerance`"), "{}", messages(&options));
}

#[test]
fn a_profile_or_a_subprogram_that_changed_since_the_plan_is_refused() {
    let planned = Planned::new(2);
    let profile = planned.folder.path().join("machine.toml");
    let library = planned.folder.path().join("library");
    std::fs::create_dir(&library).unwrap();
    std::fs::write(library.join("O1000.nc"), "O1000\nM99\n").unwrap();
    let shipped = std::fs::read_to_string(root().join(PROFILE)).unwrap();
    let shipped = shipped
        .replace("\"stan_s500/", &format!("\"{}/stan_s500/", root().join("machine-profiles").display()));
    std::fs::write(&profile, &shipped).unwrap();
    std::fs::remove_file(&planned.manifest).unwrap();
    let more = ["-m", profile.to_str().unwrap(), "--include", library.to_str().unwrap()];
    let mut command = vpost();
    command.args(["batch", "plan"]).arg(&planned.input).args(["-d", "linuxcnc", "-O"]).arg(&planned.output);
    let ran = command.arg("--manifest").arg(&planned.manifest).args(more).output().unwrap();
    assert_status(&ran, 0);

    std::fs::write(&profile, format!("{shipped}\n# a remark\n")).unwrap();
    let ran = planned.shard("1/1");
    assert_status(&ran, 2);
    assert!(messages(&ran).contains("error[VP1011]: the profile"), "{}", messages(&ran));
    std::fs::write(&profile, &shipped).unwrap();
    std::fs::write(library.join("O1000.nc"), "O1000\nG4 P1\nM99\n").unwrap();
    let ran = planned.shard("1/1");
    assert_status(&ran, 2);
    assert!(
        messages(&ran).contains("error[VP1011]: a file in a folder of subprograms"),
        "{}",
        messages(&ran)
    );
    assert!(!planned.output.exists());
}

#[test]
fn the_task_array_says_which_shard() {
    let planned = Planned::new(6);
    let with = |variables: &[(&str, &str)], shard: &str| {
        let mut command = planned.command("run");
        command.args(["--shard", shard, "--results", "-"]).envs(variables.iter().copied());
        let ran = command.output().unwrap();
        (ran.status.code(), text(&ran).lines().count(), messages(&ran))
    };
    assert_eq!(with(&[("SLURM_ARRAY_TASK_ID", "4")], "auto/4").1, 1);
    assert_eq!(with(&[("HQ_TASK_ID", "1"), ("SLURM_ARRAY_TASK_ID", "4")], "auto/4").1, 2);
    assert_eq!(with(&[("JOB_COMPLETION_INDEX", "0")], "auto/4").1, 2);
    assert_eq!(
        with(&[("JOB_COMPLETION_INDEX", "9")], "auto/10"),
        (Some(0), 0, String::new()),
        "an empty share"
    );
    for (variables, shard) in [(&[][..], "auto/4"), (&[("SLURM_ARRAY_TASK_ID", "0")], "auto/4"), (&[], "5/4")]
    {
        let (status, _, said) = with(variables, shard);
        assert_eq!(status, Some(2), "{said}");
        assert!(said.contains("error[VP1009]"), "{said}");
    }
}

/// A disk that refuses: no output is half there, the task asks for another attempt, and that completes.
#[cfg(unix)]
#[test]
fn a_write_that_fails_is_worth_another_attempt() {
    let planned = Planned::new(3);
    std::fs::write(planned.input.join("large.nc"), program(9, 4000)).unwrap();
    std::fs::remove_file(&planned.manifest).unwrap();
    assert_status(&planned.plan(&[]), 0);
    // No file may grow beyond 32 blocks of 1024 bytes: as on a full disk, a write fails in the middle.
    let script = "trap '' XFSZ; ulimit -f 32; exec \"$@\"";
    let task = planned.command("run");
    let mut limited = Command::new("bash");
    limited.current_dir(root()).args(["-c", script, "bash"]).arg(task.get_program()).args(task.get_args());
    let ran = limited.output().unwrap();
    assert_status(&ran, 75);
    assert!(messages(&ran).contains("cannot write"), "{}", messages(&ran));
    assert_eq!(tree(&planned.output).len(), 3, "what fits is there");
    assert!(temporaries(&planned.output).is_empty());
    assert_status(&planned.merge(&[]), 75);
    assert_status(&planned.shard("1/1"), 0);
    assert_status(&planned.merge(&[]), 0);
    assert!(tree(&planned.output) == tree(&planned.local().0));
}

/// An engine that lost sight of a task starts it again beside the first.
#[test]
fn the_same_shard_twice_at_once_does_no_harm() {
    let planned = Planned::new(30);
    let start = || planned.command("run").stdout(std::process::Stdio::null()).spawn().unwrap();
    let both = [start(), start()];
    for mut task in both {
        assert!(task.wait().unwrap().success());
    }
    assert_status(&planned.merge(&[]), 0);
    assert!(tree(&planned.output) == tree(&planned.local().0));
    assert!(temporaries(&planned.output).is_empty());
}
