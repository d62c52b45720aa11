//! Shards under the engines of the documents: Slurm's script, GNU parallel, HyperQueue.
//!
//! The scripts are those of `samples/cluster`. Where an engine is not installed the test says so; on the build machines
//! it must be.

#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{messages, root, vpost};
use crate::folders::{PROFILE, release, temporaries, tree};

/// A release that was planned, and a folder with a `vpost` for the scripts to find.
struct Work {
    folder: tempfile::TempDir,
}

impl Work {
    fn new(programs: u64, blocks: u64) -> Self {
        let work = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        release(&work.path("release"), programs, blocks);
        let ran = vpost()
            .args(["batch", "plan", "-m", PROFILE, "-d", "linuxcnc"])
            .arg(work.path("release"))
            .arg("-O")
            .arg(work.path("out"))
            .arg("--manifest")
            .arg(work.path("plan.jsonl"))
            .output()
            .expect("the command starts");
        assert!(ran.status.success(), "{}", messages(&ran));
        std::fs::create_dir(work.path("tools")).expect("a new folder");
        work
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn tool(&self, name: &str, script: &str) {
        let path = self.path("tools").join(name);
        std::fs::write(&path, format!("#!/bin/bash\n{script}\n")).expect("a new file");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("our own file");
    }

    /// A command that finds the tools first.
    fn command(&self, program: &Path) -> Command {
        let path = std::env::var("PATH").expect("there is one");
        let mut command = Command::new(program);
        command.current_dir(root()).env("PATH", format!("{}:{path}", self.path("tools").display()));
        command
    }

    fn merge(&self, more: &[&str]) -> Output {
        let mut command = vpost();
        command.args(["batch", "merge", "--manifest"]).arg(self.path("plan.jsonl")).args(more);
        command.output().expect("the command starts")
    }

    /// All outputs are there and are those of one local run.
    fn assert_complete(&self) {
        let ran = self.merge(&[]);
        assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
        let local = self.path("local");
        let mut command = vpost();
        command
            .arg("batch")
            .arg(self.path("release"))
            .args(["-m", PROFILE, "-d", "linuxcnc", "-O"])
            .arg(&local);
        assert!(command.output().expect("the command starts").status.success());
        assert!(tree(&self.path("out")) == tree(&local), "other outputs than those of the local run");
        assert_eq!(temporaries(&self.path("out")), Vec::<PathBuf>::new());
    }
}

fn sample(name: &str) -> PathBuf {
    root().join("samples/cluster").join(name)
}

/// True where an engine answers; false after saying that the test is skipped.
fn have(what: &str, mut question: Command) -> bool {
    let there = question.output().is_ok_and(|output| output.status.success());
    assert!(there || std::env::var_os("CI").is_none(), "{what} must be installed where CI is set");
    there
}

#[test]
fn the_slurm_script_runs_the_tasks_of_its_array() {
    let work = Work::new(9, 20);
    let script = sample("slurm.sh");
    assert!(Command::new("bash").arg("-n").arg(&script).status().unwrap().success());
    work.tool("vpost", &format!("exec {} \"$@\"", env!("CARGO_BIN_EXE_vpost")));
    work.tool("scontrol", &format!("echo \"$@\" >> {}", work.path("requeued").display()));
    // The place of the second output is a folder: an error of a disk, as far as a task can tell.
    let outputs = tree(&work.path("release"));
    let second = work.path("out").join(outputs.keys().nth(1).unwrap());
    std::fs::create_dir_all(&second).unwrap();
    let task = |number: u32| {
        let mut command = work.command(Path::new("bash"));
        command.arg(&script).arg(work.path("plan.jsonl")).arg("4");
        command.env("SLURM_ARRAY_JOB_ID", "77").env("SLURM_ARRAY_TASK_ID", number.to_string());
        // Of the array as it was submitted, which the script must not take for the number of shards.
        command.env("SLURM_ARRAY_TASK_COUNT", "2").env("SLURM_CPUS_PER_TASK", "2");
        command.output().unwrap().status.code()
    };
    assert_eq!([1, 2, 4].map(task), [Some(0), Some(75), Some(0)]);
    assert_eq!(std::fs::read_to_string(work.path("requeued")).unwrap(), "requeue 77_2\n");
    let missing = work.merge(&["--shards", "4", "--missing", "slurm"]);
    assert_eq!(String::from_utf8_lossy(&missing.stdout), "2-3\n");
    std::fs::remove_dir(&second).unwrap();
    assert_eq!([2, 3].map(task), [Some(0), Some(0)]);
    assert_eq!(task(0), Some(2), "an array from 0");
    work.assert_complete();
}

#[test]
fn gnu_parallel_goes_on_where_it_failed() {
    let mut question = Command::new("parallel");
    question.arg("--version");
    if !have("GNU parallel", question) {
        println!("skipped: GNU parallel is not installed (Debian: parallel)");
        return;
    }
    let work = Work::new(14, 20);
    // The third shard's machine is broken: tasks on it are killed.
    let broken = work.path("broken");
    let log = work.path("log");
    std::fs::write(&broken, "").unwrap();
    work.tool(
        "vpost",
        &format!(
            "echo \"${{@: -1}}\" >> {log}\nif [ \"${{@: -1}}\" = 3/5 ] && [ -e {broken} ]; then kill -9 $$; fi\nexec {vpost} \"$@\"",
            log = log.display(),
            broken = broken.display(),
            vpost = env!("CARGO_BIN_EXE_vpost"),
        ),
    );
    let go = || {
        let mut command = work.command(&sample("parallel.sh"));
        command.arg(work.path("plan.jsonl")).args(["5", "--jobs", "2"]).env("HOME", work.folder.path());
        let ran = command.output().unwrap();
        let mut shards: Vec<String> =
            std::fs::read_to_string(&log).unwrap().lines().map(str::to_owned).collect();
        shards.sort();
        std::fs::write(&log, "").unwrap();
        (ran.status.success(), shards, messages(&ran))
    };
    let (ended_well, shards, said) = go();
    assert!(!ended_well, "{said}");
    assert_eq!(shards, ["1/5", "2/5", "3/5", "3/5", "3/5", "4/5", "5/5"], "{said}");
    let missing = work.merge(&["--shards", "5", "--missing", "parallel"]);
    assert_eq!((missing.status.code(), String::from_utf8_lossy(&missing.stdout).as_ref()), (Some(75), "3\n"));
    std::fs::remove_file(&broken).unwrap();
    let (ended_well, shards, said) = go();
    assert!(ended_well, "{said}");
    assert_eq!(shards, ["3/5"], "only what failed: {said}");
    work.assert_complete();
}

#[test]
fn hyperqueue_loses_a_worker_and_nothing_else() {
    let python = std::env::var("VPOST_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut question = Command::new(&python);
    question.args(["-c", "import hyperqueue"]);
    if !cfg!(target_os = "linux") || !have("hyperqueue", question) {
        println!(
            "skipped: HyperQueue is not installed (pip install hyperqueue; VPOST_PYTHON names the interpreter)"
        );
        return;
    }
    // Long enough that a task is seen between its first output and its last.
    let work = Work::new(36, 20_000);
    let mut command = work.command(Path::new(&python));
    command.arg(root().join("tests/cluster/hyperqueue_loses_a_worker.py")).arg(env!("CARGO_BIN_EXE_vpost"));
    command.arg(work.path("plan.jsonl")).arg("9").arg(work.path("out")).env("PYTHONDONTWRITEBYTECODE", "1");
    let ran = command.output().unwrap();
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    let last = said.lines().last().unwrap_or_default();
    let happened: serde_json::Value =
        serde_json::from_str(last).unwrap_or_else(|error| panic!("{error}: {said}\n{}", messages(&ran)));
    println!("{happened}");
    assert_eq!(happened["killed"], true, "{happened}");
    assert_eq!(happened["tasks"], 1, "it was killed in the middle of a task: {happened}");
    assert!(happened["stood"].as_u64().unwrap() < 36, "{happened}");
    assert_eq!(happened["done"], true, "the task ran again elsewhere: {happened}");
    work.assert_complete();
}
