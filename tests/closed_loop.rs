//! The promise, judged twice: by `vpost check`, and by LinuxCNC's interpreter with a model of its own.

mod common;

use common::{SAMPLES, have_interpreter, messages, referee, root, run};

/// 1.1 mrad of squareness with the interferometer tables, as the users' acceptance asks for.
const SQUARE: &str = "tests/profiles/stan_s500_square_1100.toml";
const PROFILES: [&str; 2] = ["machine-profiles/stan_s500.toml", SQUARE];

#[test]
fn every_sample_follows_its_path() {
    let second_judge = have_interpreter();
    if !second_judge {
        println!("skipped: linuxcnc-uspace is not installed; only `vpost check` judges");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut corrected = 0;
    for profile in PROFILES {
        for (sample, dialect) in SAMPLES {
            let out = folder.path().join("out.nc");
            let out_text = out.to_str().expect("a plain path");
            let ran = run(&[sample, "-m", profile, "-d", dialect, "-o", out_text]);
            assert!(ran.status.success(), "{sample} for {profile}\n{}", messages(&ran));
            let check = run(&["check", sample, out_text, "-m", profile, "-d", dialect, "--json"]);
            let judged: serde_json::Value = serde_json::from_slice(&check.stdout).expect("JSON");
            assert!(check.status.success(), "{sample} for {profile}: {judged:#}");
            let (before, after) = (&judged["deviation_before_um"], &judged["deviation_after_um"]);
            assert!(before.as_f64().is_some_and(|um| um > 80.0), "{sample}: {before}");
            println!("{sample} {profile}: {before} um before, {after} um after");
            if second_judge {
                let verdict = referee(&root().join(sample), &out, profile, dialect, &resolution(sample));
                assert_eq!(verdict["ok"], true, "{sample} for {profile}: {verdict:#}");
                let second = verdict["before"]["um"].as_f64().expect("a number");
                // Two programs, one machine: they agree on what the uncorrected program does.
                let first = before.as_f64().expect("a number");
                // (The second judge measures to the nearest motion, ours to the motion itself.)
                assert!((first - second).abs() < 0.05 * first, "{sample}: {first} against {second}");
            }
            corrected += 1;
        }
    }
    assert_eq!(corrected, PROFILES.len() * SAMPLES.len());
}

/// The inch sample is written in steps of 0.0001 inch.
fn resolution(sample: &str) -> Vec<&'static str> {
    if sample.contains("inch") { vec!["--resolution", "2.54"] } else { Vec::new() }
}

/// The other engines hold their own promise on the same programs, or refuse.
#[test]
fn path_engines_follow_their_own_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nc");
    let out = out.to_str().expect("a plain path");
    for engine in ["tracker", "tangential-static", "tangential-quasi-differential", "kmtpp"] {
        for (sample, dialect) in [SAMPLES[0], SAMPLES[2]] {
            let shared = ["-m", "machine-profiles/stan_s500.toml", "-d", dialect, "-e", engine];
            let ran = run(&[&[sample, "-o", out][..], &shared].concat());
            assert!(ran.status.success(), "{engine} on {sample}\n{}", messages(&ran));
            let check = run(&[&["check", sample, out][..], &shared].concat());
            assert!(
                check.status.success(),
                "{engine} on {sample}: {}",
                String::from_utf8_lossy(&check.stdout)
            );
        }
    }
    let jumps = run(&[
        "samples/plate_linuxcnc.nc",
        "-m",
        "machine-profiles/stan_s500.toml",
        "-d",
        "linuxcnc",
        "-e",
        "tangential-interval",
    ]);
    assert_eq!(jumps.status.code(), Some(1));
    assert!(jumps.stdout.is_empty() && messages(&jumps).starts_with("error[VP05"), "{}", messages(&jumps));
    let published = run(&[
        "samples/plate_linuxcnc.nc",
        "-m",
        "machine-profiles/stan_s500.toml",
        "-d",
        "linuxcnc",
        "-e",
        "kmtpp-published",
    ]);
    assert_eq!(published.status.code(), Some(2));
    assert!(messages(&published).contains("vpost solve"), "{}", messages(&published));
}
