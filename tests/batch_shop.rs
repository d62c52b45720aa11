//! `vpost batch` on folders and disks as shops have them: names of all kinds, links that lead in circles, files that
//! cannot be read, a disk that is full.

#![cfg(unix)]

use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{messages, root, vpost};
use crate::folders::{PROFILE, program, temporaries, tree};

fn batch(input: &Path, output: &Path) -> Command {
    let mut command = vpost();
    command.arg("batch").arg(input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]).arg(output);
    command
}

fn run(mut command: Command) -> (Option<i32>, String, String) {
    let ran: Output = command.output().expect("the command starts");
    (ran.status.code(), String::from_utf8_lossy(&ran.stdout).into_owned(), messages(&ran))
}

/// The same where no file may grow beyond `kib`: as on a full disk, a write fails in the middle.
fn limited(command: &Command, kib: u32) -> Command {
    let mut limited = Command::new("bash");
    limited.current_dir(root()).args(["-c", "trap '' XFSZ; ulimit -f $0; exec \"$@\"", &kib.to_string()]);
    limited.arg(command.get_program()).args(command.get_args());
    limited
}

const FOLDERS: [&str; 5] = ["", "op 10", "ОП 20/Левая сторона", "детали/крышка №3", "a/b/c/d"];
const NAMES: [&str; 5] = ["part K.nc", "Деталь_K.NC", "p'art\"K.tap", "-K.ngc", "K.nc"];

/// 200 programs, one of them broken, two links that lead nowhere, and a link to a program.
fn shop(input: &Path) {
    for k in 0..200_u64 {
        let folder = input.join(FOLDERS[(k % 5) as usize]);
        std::fs::create_dir_all(&folder).expect("a new folder");
        let name = NAMES[(k / 5 % 5) as usize].replace('K', &format!("{k:03}"));
        std::fs::write(folder.join(name), program(k, 8)).expect("a new file");
    }
    std::fs::write(input.join("op 10/сломанная.nc"), "G21 G90\nG0 X#500\n").expect("a new file");
    symlink("..", input.join("a/loop")).expect("a new file");
    symlink("itself.nc", input.join("a/itself.nc")).expect("a new file");
    symlink("nowhere.nc", input.join("a/dangling.nc")).expect("a new file");
    symlink("b/c/d/024.nc", input.join("a/linked.nc")).expect("a new file");
}

#[test]
fn a_shops_folder_is_corrected_but_for_what_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("выпуск 7");
    shop(&input);
    let output = input.join("corrected");
    let (status, table, said) = run(batch(&input, &output));
    assert_eq!(status, Some(1), "{said}");
    let outputs = tree(&output);
    assert_eq!(outputs.len(), 201, "{table}{said}");
    for k in [0, 6, 12, 18, 24] {
        let name = NAMES[k / 5 % 5].replace('K', &format!("{k:03}"));
        assert!(outputs.contains_key(&Path::new(FOLDERS[k % 5]).join(&name)), "{name}");
    }
    assert!(outputs[Path::new("a/linked.nc")] == outputs[Path::new("a/b/c/d/024.nc")]);
    // Each reason by itself, with the program that has it.
    for line in [
        "corrected        201",
        "failed             2",
        "       1  VP0001  No such file or directory (os error 2): a/dangling.nc",
        "(os error 40): a/itself.nc",
        ": op 10/сломанная.nc\n",
    ] {
        assert!(table.contains(line), "{line}: {table}");
    }
    assert!(said.contains("1 link(s) to folders were not followed") && said.contains("a/loop"), "{said}");
    assert!(!said.contains("no programs by name or kind"), "{said}");

    // Nothing of it is done twice, and another output folder does not take the first one's files for programs.
    let (_, table, _) = run(batch(&input, &output));
    assert!(table.contains("201 of them were done by an earlier run"), "{table}");
    let other = folder.path().join("other");
    let (status, _, said) = run(batch(&input, &other));
    assert_eq!(status, Some(1), "{said}");
    assert!(tree(&other) == outputs, "other programs");
    assert!(said.contains("1 folder(s) of another `vpost batch`'s outputs were passed over"), "{said}");
    // Named, it is taken, and refused for what it is.
    let (status, _, said) = run(batch(&output, &folder.path().join("third")));
    assert!(status == Some(1) && said.contains("error[VP0505]"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_read_stops_nothing() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    for name in ["closed", "open"] {
        std::fs::create_dir_all(input.join(name)).unwrap();
        std::fs::write(input.join(name).join("part.nc"), program(1, 5)).unwrap();
    }
    let allow =
        |mode| std::fs::set_permissions(input.join("closed"), PermissionsExt::from_mode(mode)).unwrap();
    allow(0);
    let everything_is_allowed = input.join("closed").read_dir().is_ok();
    let (status, table, said) = run(batch(&input, &output));
    let (planned, _, plan_said) = run({
        let mut command = vpost();
        command.args(["batch", "plan"]).arg(&input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]);
        command.arg(&output).arg("--manifest").arg(folder.path().join("plan.jsonl"));
        command
    });
    allow(0o755);
    assert!(output.join("open/part.nc").exists(), "{said}");
    // An administrator reads what is closed.
    if everything_is_allowed {
        assert_eq!((status, planned), (Some(0), Some(0)), "{said}{plan_said}");
        return;
    }
    assert_eq!((status, planned), (Some(1), Some(1)), "{said}{plan_said}");
    assert!(table.contains("Permission denied (os error 13): closed\n"), "{table}");
    assert!(plan_said.contains("closed: Permission denied"), "{plan_said}");
}

#[test]
fn a_plan_names_everything_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let (input, manifest) = (folder.path().join("release"), folder.path().join("plan.jsonl"));
    shop(&input);
    let plan = || {
        let mut command = vpost();
        command.args(["batch", "plan"]).arg(&input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]);
        command.arg(folder.path().join("out")).arg("--manifest").arg(&manifest);
        run(command)
    };
    let (status, _, said) = plan();
    assert_eq!((status, manifest.exists()), (Some(1), false), "{said}");
    assert!(said.contains("a/dangling.nc: No such file") && said.contains("a/itself.nc: "), "{said}");
    for name in ["a/dangling.nc", "a/itself.nc"] {
        std::fs::remove_file(input.join(name)).unwrap();
    }
    assert_eq!(plan().0, Some(0));
}

/// The outputs fit, the journal does not: they are corrected, the table says so, and what went wrong is said once.
#[test]
fn a_journal_that_cannot_be_written_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    std::fs::create_dir_all(&input).unwrap();
    for k in 0..10 {
        std::fs::write(input.join(format!("part{k}.nc")), program(k, 5)).unwrap();
    }
    let (status, table, said) = run(limited(&batch(&input, &output), 1));
    assert_eq!(status, Some(1), "{said}");
    assert!(table.contains("corrected         10"), "{table}{said}");
    assert_eq!(said.matches("error[VP0001]").count(), 1, "{said}");
    assert!(said.contains(".vpost/journal/batch.jsonl: File too large"), "{said}");
    assert!(!said.contains("at path"), "temporaries are our own affair: {said}");
    let outputs = tree(&output);
    assert_eq!(outputs.len(), 10);
    // A full journal is no reason to correct other bytes, nor to take the outputs for somebody else's.
    let (status, _, said) = run(batch(&input, &output));
    assert_eq!((status, said.as_str()), (Some(0), ""));
    assert!(tree(&output) == outputs && temporaries(&output).is_empty());
    let (_, table, _) = run(batch(&input, &output));
    assert!(table.contains("10 of them were done by an earlier run"), "{table}");
}

/// Nothing fits but the smallest: said once, counted in the table, and completed once there is room.
#[test]
fn a_full_disk_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    std::fs::create_dir_all(&input).unwrap();
    for k in 0..30 {
        std::fs::write(input.join(format!("part{k:02}.nc")), program(k, if k == 7 { 5 } else { 100 }))
            .unwrap();
    }
    let (status, table, said) = run(limited(&batch(&input, &output), 1));
    assert_eq!(status, Some(1), "{said}");
    assert!(table.contains("corrected          1") && table.contains("failed            29"), "{table}");
    assert!(table.contains("29  VP0001  File too large (os error 27): part00.nc, …"), "{table}");
    assert_eq!(said.matches("cannot write the output: File too large").count(), 1, "{said}");
    assert_eq!(tree(&output).len(), 1);
    assert!(temporaries(&output).is_empty());
    assert_eq!(run(batch(&input, &output)).0, Some(0));
    assert_eq!(tree(&output).len(), 30);
}

/// A shard's journal is its proof: without it the task asks for another attempt, and merge for the shard.
#[test]
fn a_shard_without_journal_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    let manifest = folder.path().join("plan.jsonl");
    std::fs::create_dir_all(&input).unwrap();
    for k in 0..10 {
        std::fs::write(input.join(format!("part{k}.nc")), program(k, 5)).unwrap();
    }
    let task = |arguments: &[&str]| {
        let mut command = vpost();
        command.arg("batch").args(arguments).arg("--manifest").arg(&manifest);
        command
    };
    let mut plan = task(&["plan", "-m", PROFILE, "-d", "linuxcnc", "-O", output.to_str().unwrap()]);
    plan.arg(&input);
    assert_eq!(run(plan).0, Some(0));
    let (status, table, said) = run(limited(&task(&["run", "--shard", "2/3"]), 1));
    assert_eq!(status, Some(75), "{said}");
    assert!(table.contains("corrected          3"), "{table}{said}");
    assert_eq!(run(task(&["run", "--shard", "1/3"])).0, Some(0));
    let missing = || run(task(&["merge", "--shards", "3", "--missing", "slurm"]));
    assert_eq!(missing().1, "2-3\n");
    for shard in ["2/3", "3/3"] {
        assert_eq!(run(task(&["run", "--shard", shard])).0, Some(0));
    }
    assert_eq!((missing().0, missing().1), (Some(0), String::new()));
}

#[test]
fn an_output_folder_that_cannot_be_is_told_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("release");
    std::fs::create_dir_all(&input).unwrap();
    std::fs::write(input.join("part.nc"), program(1, 5)).unwrap();
    // Below a file there is no folder, not even for an administrator.
    let (status, table, said) = run(batch(&input, &input.join("part.nc/out")));
    assert_eq!((status, table.as_str()), (Some(1), ""), "{said}");
    assert!(said.contains("cannot write to") && said.contains("part.nc/out: Not a directory"), "{said}");
}
