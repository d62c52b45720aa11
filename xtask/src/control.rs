//! Corrected programs on a real control: the judges of tests/control, one after the other.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, bail};
use clap::Args;

/// What is judged, and how much of it.
#[derive(Args)]
pub(crate) struct Options {
    /// The command that corrects.
    #[arg(long, default_value = "target/release/vpost")]
    vpost: PathBuf,
    /// Machines of each judge on the controller, which runs in real time: some ten seconds a program.
    #[arg(long, default_value_t = 20)]
    machines: u32,
    /// Lines of restarts that the interpreter alone reads.
    #[arg(long, default_value_t = 5000)]
    lines: u32,
    /// Where machines and programs start from.
    #[arg(long, default_value_t = 1)]
    seed: u32,
}

/// Runs the judges; what they print goes to standard output.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    let [machines, lines, seed] =
        [options.machines, options.lines, options.seed].map(|count| count.to_string());
    let judges: [(&str, &[&str]); 7] = [
        ("restart", &["--interpreter", "--lines", &lines]),
        ("judge", &["--machines", &machines]),
        ("modes", &["--machines", &machines]),
        ("planner", &["--programs", &machines]),
        ("five_axis", &["--programs", &machines]),
        ("loop", &["--machines", &machines]),
        ("lag", &["--programs", &machines]),
    ];
    let mut failed = Vec::new();
    for (judge, counts) in judges {
        if counts.last() == Some(&"0") {
            continue;
        }
        writeln!(std::io::stdout(), "=== {judge}")?;
        let mut command = Command::new("/usr/bin/python3");
        command.arg("-B").arg(format!("tests/control/{judge}.py")).arg("--vpost").arg(&options.vpost);
        let status = command.args(counts).args(["--seed", &seed]).status();
        if !status.context("/usr/bin/python3, with LinuxCNC's modules and NumPy, is needed")?.success() {
            failed.push(judge);
        }
    }
    if failed.is_empty() {
        Ok("all judges pass\n".to_owned())
    } else {
        bail!("not passed: {}", failed.join(", "))
    }
}
