//! `vpost batch` on one machine.

use std::path::Path;
use std::process::Output;

use crate::common::{messages, root, run, vpost};
use crate::folders::{PROFILE, copy, program, release, temporaries, tree};

fn batch(input: &Path, output: &Path, more: &[&str]) -> Output {
    let mut command = vpost();
    command.arg("batch").arg(input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]).arg(output).args(more);
    command.output().expect("the command starts")
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// How many programs the run found done.
fn resumed(output: &Output) -> usize {
    let text = text(output);
    let line = text.lines().find(|line| line.ends_with("done by an earlier run"));
    line.map_or(0, |line| line.split(' ').next().and_then(|count| count.parse().ok()).expect("a count"))
}

fn results(path: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(path).expect("results were written");
    text.lines().map(|line| serde_json::from_str(line).expect("a JSON line")).collect()
}

#[test]
fn outputs_are_those_of_one_run_for_each_program() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 5, 40);
    let ran = batch(&input, &output, &[]);
    assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
    let inputs = tree(&input);
    let outputs = tree(&output);
    assert_eq!(inputs.keys().collect::<Vec<_>>(), outputs.keys().collect::<Vec<_>>());
    for (name, bytes) in &outputs {
        let single = vpost()
            .arg(input.join(name))
            .args(["-m", PROFILE, "-d", "linuxcnc"])
            .output()
            .expect("the command starts");
        assert!(single.stdout == *bytes, "{}", name.display());
        assert_ne!(*bytes, inputs[name], "{} was corrected", name.display());
    }
    assert!(temporaries(&output).is_empty());
    // Off a terminal nothing is said of progress.
    assert_eq!(messages(&ran), "");
}

#[test]
fn what_fails_stops_nothing_and_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 4, 10);
    std::fs::write(input.join("a_variable.nc"), "G21 G90\nG0 X#500\n").unwrap();
    // The place of an output is a folder.
    std::fs::create_dir_all(output.join("part0000.nc")).unwrap();
    let lines = folder.path().join("results.jsonl");
    let ran = batch(&input, &output, &["--results", lines.to_str().unwrap()]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(messages(&ran).contains("error[VP0121]"), "{}", messages(&ran));
    let said: Vec<(String, String)> = results(&lines)
        .iter()
        .map(|line| {
            (line["output"].as_str().unwrap().to_owned(), line["status"].as_str().unwrap().to_owned())
        })
        .collect();
    let expected = [
        ("a_variable.nc", "refused"),
        ("op10/part0001.nc", "corrected"),
        ("op20/left/part0002.nc", "corrected"),
        ("part0000.nc", "failed"),
        ("part0003.nc", "corrected"),
    ];
    assert_eq!(said, expected.map(|(name, status)| (name.to_owned(), status.to_owned())));
    let refused = &results(&lines)[0]["errors"][0];
    assert_eq!((refused["code"].as_str(), refused["line"].as_u64()), (Some("VP0121"), Some(2)));
    assert!(!output.join("a_variable.nc").exists());
}

/// Names as an old share has them. The two differ, and look alike where they are shown.
#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_not_utf8_stops_no_other_program() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 4, 5);
    for name in [&b"\xEF\xE0\xE7.nc"[..], b"\xEF\xF0\xF3.nc"] {
        std::fs::write(input.join(std::ffi::OsStr::from_bytes(name)), program(5, 5)).unwrap();
    }
    let lines = folder.path().join("results.jsonl");
    let ran = batch(&input, &output, &["--results", lines.to_str().unwrap()]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert_eq!(messages(&ran).matches("error[VP1004]").count(), 2, "{}", messages(&ran));
    let results = results(&lines);
    let refused = results.iter().filter(|line| line["errors"][0]["code"].as_str() == Some("VP1004")).count();
    assert_eq!((results.len(), refused, tree(&output).len()), (6, 2, 4));
    assert!(messages(&ran).contains("release/паз.nc"), "{}", messages(&ran));
    let manifest = folder.path().join("plan.jsonl");
    let mut plan = vpost();
    plan.args(["batch", "plan", "-m", PROFILE, "-d", "linuxcnc"]).arg(&input).arg("-O").arg(&output);
    let planned = plan.arg("--manifest").arg(&manifest).output().expect("the command starts");
    assert_eq!(planned.status.code(), Some(2), "{}", messages(&planned));
    assert!(messages(&planned).contains("error[VP1004]") && !manifest.exists(), "{}", messages(&planned));
}

#[test]
fn results_and_outputs_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("release");
    release(&input, 12, 30);
    std::fs::write(input.join("op10/bad.nc"), "G21 G90\nG1 X1E-3 F100\n").unwrap();
    let runs = ["1", "5"].map(|jobs| {
        let output = folder.path().join("out").join(jobs);
        let ran = batch(&input, &output, &["--jobs", jobs, "--results", "-"]);
        assert_eq!(ran.status.code(), Some(1));
        (text(&ran), messages(&ran), tree(&output))
    });
    assert!(runs[0] == runs[1], "{:#?}\n{:#?}", runs[0].0, runs[1].0);
    assert_eq!(runs[0].0.lines().count(), 13);
}

#[test]
fn what_is_done_is_not_done_again_unless_something_changed() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 6, 10);
    // A profile of our own, with its tables.
    let shipped = root().join("machine-profiles");
    for name in ["stan_s500.toml", "stan_s500"] {
        copy(&shipped.join(name), &folder.path().join(name));
    }
    let profile = folder.path().join("stan_s500.toml");
    let go = |more: &[&str]| {
        let mut all = vec!["-m", profile.to_str().unwrap()];
        all.extend(more);
        let mut command = vpost();
        command.arg("batch").arg(&input).args(["-d", "linuxcnc", "-O"]).arg(&output).args(all);
        let ran = command.output().expect("the command starts");
        assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
        resumed(&ran)
    };
    assert_eq!(go(&[]), 0, "nothing was there");
    let first = tree(&output);
    assert_eq!(go(&[]), 6, "nothing changed");
    assert_eq!(go(&["--tolerance", "1.0"]), 6, "the profile's own tolerance, written another way");

    std::fs::write(input.join("part0003.nc"), program(77, 10)).unwrap();
    assert_eq!(go(&[]), 5, "one program changed");
    std::fs::write(input.join("part0003.nc"), program(3, 10)).unwrap();
    assert_eq!(go(&[]), 5, "and back");
    std::fs::write(output.join("part0000.nc"), &first[Path::new("part0000.nc")][..100]).unwrap();
    assert_eq!(go(&["--force"]), 0, "everything anew");
    assert_eq!(tree(&output), first);

    std::fs::remove_file(output.join("part0000.nc")).unwrap();
    assert_eq!(go(&[]), 5, "an output was deleted");
    assert_eq!(go(&["--tolerance", "3"]), 0, "another tolerance");
    assert_eq!(go(&["--work-offset", "G54=141,100,20"]), 0, "another work offset");
    assert_eq!(go(&[]), 0, "and back: outputs of other options are no outputs");

    let table = folder.path().join("stan_s500/interferometer_x.csv");
    let mut bytes = std::fs::read(&table).unwrap();
    bytes.extend_from_slice(b"\n");
    std::fs::write(&table, bytes).unwrap();
    assert_eq!(go(&[]), 0, "a table of the profile changed");

    std::fs::remove_dir_all(output.join(".vpost")).unwrap();
    assert_eq!(go(&[]), 0, "the journal is gone");
    assert_eq!(tree(&output), first);
}

#[test]
fn a_subprogram_that_changed_or_appeared_is_a_change() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output, library) =
        (folder.path().join("release"), folder.path().join("out"), folder.path().join("library"));
    std::fs::create_dir_all(&input).unwrap();
    std::fs::create_dir_all(&library).unwrap();
    let main = |call: &str| {
        format!("G21 G90 G17 G54\nG43 H1\nG0 X10. Y10. Z30.\nG1 Z15. F600\n{call}\nG0 Z30.\nM30\n")
    };
    std::fs::write(input.join("calls.nc"), main("M98 P1000")).unwrap();
    std::fs::write(input.join("plain.nc"), main("G1 X20.")).unwrap();
    let sub = |x: u32| format!("O1000\nG1 X{x}. Y20.\nM99\n");
    std::fs::write(library.join("O1000.nc"), sub(50)).unwrap();
    let go = || {
        let mut command = vpost();
        command.arg("batch").arg(&input).args(["-m", PROFILE, "-d", "fanuc", "-O"]).arg(&output);
        let ran = command.arg("--include").arg(&library).output().expect("the command starts");
        assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
        resumed(&ran)
    };
    assert_eq!(go(), 0);
    assert_eq!(go(), 2);
    std::fs::write(library.join("O1000.nc"), sub(60)).unwrap();
    assert_eq!(go(), 1, "the one that calls it is corrected again");
    // Looked for before `O1000.nc`.
    std::fs::write(library.join("O1000"), sub(70)).unwrap();
    assert_eq!(go(), 1, "a file that is found first appeared");
    let corrected = String::from_utf8_lossy(&tree(&output)[Path::new("calls.nc")]).into_owned();
    assert!(corrected.contains("X69."), "{corrected}");
}

#[test]
fn only_programs_are_taken_and_the_rest_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("release/out"));
    release(&input, 3, 5);
    for name in ["PART.NC", ".hidden.nc", "readme.txt", "op10/._part0001.nc", "old/part.tap"] {
        let path = input.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, program(9, 5)).unwrap();
    }
    let taken = |more: &[&str]| {
        let mut all = vec!["--results", "-"];
        all.extend(more);
        let ran = batch(&input, &output, &all);
        assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
        let names = text(&ran)
            .lines()
            .map(|line| {
                serde_json::from_str::<serde_json::Value>(line).unwrap()["output"]
                    .as_str()
                    .unwrap()
                    .to_owned()
            })
            .collect::<Vec<_>>();
        (names, messages(&ran))
    };
    let (names, said) = taken(&[]);
    let all = ["PART.NC", "old/part.tap", "op10/part0001.nc", "op20/left/part0002.nc", "part0000.nc"];
    assert_eq!(names, all);
    assert!(said.contains("1 file(s)") && said.contains("readme.txt"), "{said}");
    // The output folder lies in the input folder and is not read back.
    assert_eq!(taken(&[]).0, all);
    assert_eq!(taken(&["--exclude", "old", "--exclude", "op*/**"]).0, ["PART.NC", "part0000.nc"]);
    assert_eq!(taken(&["--pattern", "*.txt"]).0, ["readme.txt"]);
    assert_eq!(taken(&["--pattern", "op20/**/*.nc"]).0, ["op20/left/part0002.nc"]);
    // What is named is taken.
    let ran = batch(&input.join(".hidden.nc"), &folder.path().join("other"), &["--results", "-"]);
    assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
}

#[test]
fn nothing_is_written_where_it_must_not_be() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("release");
    release(&input, 4, 5);
    let before = tree(&input);
    let refused = |arguments: &[&Path], output: &Path, code: &str| {
        let mut command = vpost();
        command.arg("batch").args(arguments).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]).arg(output);
        let ran = command.output().expect("the command starts");
        assert_eq!(ran.status.code(), Some(2), "{}", messages(&ran));
        assert!(messages(&ran).contains(code), "{}", messages(&ran));
    };
    refused(&[&input], &input, "VP1003");
    refused(&[&input.join("op10/part0001.nc")], &input.join("op10"), "VP1003");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&input, folder.path().join("link")).unwrap();
        refused(&[&input], &folder.path().join("link"), "VP1003");
    }
    // Two programs of one name; of one name on a share that knows no capitals.
    let other = folder.path().join("other");
    std::fs::create_dir_all(&other).unwrap();
    std::fs::write(other.join("part0000.nc"), program(5, 5)).unwrap();
    refused(&[&input, &other], &folder.path().join("out"), "VP1002");
    std::fs::rename(other.join("part0000.nc"), other.join("Part0000.NC")).unwrap();
    refused(&[&input, &other], &folder.path().join("out"), "VP1002");
    // A file where another needs a folder.
    std::fs::rename(other.join("Part0000.NC"), other.join("op10")).unwrap();
    refused(&[&input, &other.join("op10")], &folder.path().join("out"), "VP1002");
    refused(&[&folder.path().join("nothing")], &folder.path().join("out"), "VP0001");
    refused(&[&root().join("docs")], &folder.path().join("out"), "VP1001");
    assert!(!folder.path().join("out").exists());
    assert_eq!(tree(&input), before);
}

#[test]
fn a_file_that_vpost_did_not_write_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 2, 5);
    std::fs::create_dir_all(&output).unwrap();
    std::fs::write(output.join("part0000.nc"), "(WORK OF A WEEK)\n").unwrap();
    let ran = batch(&input, &output, &[]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(messages(&ran).contains("error[VP1006]"), "{}", messages(&ran));
    assert_eq!(std::fs::read(output.join("part0000.nc")).unwrap(), b"(WORK OF A WEEK)\n");
    assert!(output.join("op10/part0001.nc").exists());
    let ran = batch(&input, &output, &["--force"]);
    assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
    assert!(tree(&output)[Path::new("part0000.nc")].len() > 100);
    // A program that is refused now keeps its older output, and that is said.
    std::fs::write(input.join("part0000.nc"), "G21 G90\nG0 X#500\n").unwrap();
    let ran = batch(&input, &output, &[]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(text(&ran).contains("out of date: part0000.nc"), "{}", text(&ran));
}

#[test]
fn two_runs_do_not_work_in_one_folder_and_leftovers_are_swept() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("release"), folder.path().join("out"));
    release(&input, 2, 5);
    std::fs::create_dir_all(output.join(".vpost/tmp")).unwrap();
    std::fs::write(output.join(".vpost/tmp/.tmpAbCdEf"), "half a pro").unwrap();
    let lock = std::fs::File::create(output.join(".vpost/lock")).unwrap();
    lock.lock().unwrap();
    let ran = batch(&input, &output, &[]);
    assert_eq!(ran.status.code(), Some(75), "{}", messages(&ran));
    assert!(messages(&ran).contains("error[VP1005]"), "{}", messages(&ran));
    assert_eq!(temporaries(&output).len(), 1, "it may be the other's");
    drop(lock);
    let ran = batch(&input, &output, &[]);
    assert_eq!(ran.status.code(), Some(0), "{}", messages(&ran));
    assert!(temporaries(&output).is_empty());
}

#[test]
fn usage_errors_write_nothing() {
    for arguments in [
        &["batch", "samples", "-O", "no_such_output", "--pattern", "[", "-m", PROFILE][..],
        &["batch", "samples", "-O", "no_such_output"],
        &["batch", "samples", "-m", PROFILE],
        &["batch", "samples", "-O", "no_such_output", "-m", PROFILE, "--jobs", "0"],
        &["batch", "samples", "-O", "no_such_output", "-m", PROFILE, "--results", "no_such_folder/r.jsonl"],
        &["batch", "samples", "-O", "no_such_output", "-m", PROFILE, "-e", "kmtpp-published"],
    ] {
        let ran = run(arguments);
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}: {}", messages(&ran));
    }
    assert!(!root().join("no_such_output").exists());
}
