//! `vpost batch`, ended at any moment: by Ctrl-C, or without being asked.

// Signals are those of POSIX.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::Duration;

use crate::common::vpost;
use crate::folders::{PROFILE, release, temporaries, tree};

fn start(input: &Path, output: &Path) -> Child {
    let mut command = vpost();
    command.arg("batch").arg(input).args(["-m", PROFILE, "-d", "linuxcnc", "-q", "-O"]).arg(output);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the command starts")
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    // Gone already, where the moment came late: no failure.
    Command::new("kill").args([name, &id]).stderr(Stdio::null()).status().expect("kill is there");
}

/// One test at a time: each kills runs in their middle.
static ALONE: Mutex<()> = Mutex::new(());

/// A release, and what its correction is.
struct Release {
    folder: tempfile::TempDir,
    input: PathBuf,
    wanted: BTreeMap<PathBuf, Vec<u8>>,
}

impl Release {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let input = folder.path().join("release");
        release(&input, 60, 6000);
        let output = folder.path().join("wanted");
        assert!(start(&input, &output).wait().expect("it ends").success());
        Self { wanted: tree(&output), input, folder }
    }

    /// Everything under a final name is whole.
    fn assert_whole(&self, output: &Path) -> usize {
        let there = if output.exists() { tree(output) } else { BTreeMap::new() };
        for (name, bytes) in &there {
            assert!(self.wanted.get(name) == Some(bytes), "{} is not whole", name.display());
        }
        there.len()
    }

    /// The same command again brings the same bytes and leaves nothing lying about.
    fn assert_completes(&self, output: &Path) {
        assert_eq!(start(&self.input, output).wait().expect("it ends").code(), Some(0));
        assert!(tree(output) == self.wanted, "other bytes after the rerun");
        assert_eq!(temporaries(output), Vec::<PathBuf>::new());
        let journal: Vec<_> =
            std::fs::read_dir(output.join(".vpost/journal")).expect("it is there").collect();
        assert_eq!(journal.len(), 1, "{journal:?}");
    }

    /// Waits until so many outputs stand, or the run has ended.
    fn wait_for(&self, count: usize, child: &mut Child, output: &Path) {
        let there = || if output.exists() { tree(output).len() } else { 0 };
        while there() < count && child.try_wait().expect("it can be asked").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Kills `times` runs, each when its share of the outputs stands: how many stood then.
    fn kill(&self, times: u32) -> Vec<usize> {
        let mut whole = Vec::new();
        for k in 0..times {
            let output = self.folder.path().join(format!("out{k}"));
            // Somewhere in the k-th share: the fractional part of multiples of the golden ratio.
            let within = f64::from(k + 1) * 0.618_033_988_749_895 % 1.0;
            let mut child = start(&self.input, &output);
            let share = (f64::from(k) + within) / f64::from(times);
            self.wait_for((share * self.wanted.len() as f64) as usize, &mut child, &output);
            signal(&child, "-KILL");
            child.wait().expect("it ends");
            whole.push(self.assert_whole(&output));
            self.assert_completes(&output);
            std::fs::remove_dir_all(&output).expect("our own folder");
        }
        assert!(
            whole.iter().any(|count| (1..self.wanted.len()).contains(count)),
            "no run was killed in the middle: {whole:?}"
        );
        whole
    }
}

#[test]
fn killed_four_times_the_rerun_gives_the_same_bytes() {
    let _alone = ALONE.lock();
    println!("outputs that stood when a run of 60 was killed: {:?}", Release::new().kill(4));
}

#[test]
#[ignore = "a minute; `cargo test -p vpost --test whole batch_kill:: -- --ignored --nocapture`"]
fn killed_twenty_times_the_rerun_gives_the_same_bytes() {
    let _alone = ALONE.lock();
    println!("outputs that stood when a run of 60 was killed: {:?}", Release::new().kill(20));
}

#[test]
fn interrupted_it_ends_at_once_and_leaves_nothing_half_done() {
    let _alone = ALONE.lock();
    let release = Release::new();
    for (name, status) in [("-INT", 130), ("-TERM", 143)] {
        // The signal may come when all is done: then it is tried again.
        let in_the_middle = (0..20).any(|k| {
            let output = release.folder.path().join(format!("{name}{k}"));
            let mut child = start(&release.input, &output);
            release.wait_for(1, &mut child, &output);
            signal(&child, name);
            let code = child.wait().expect("it ends").code();
            let whole = release.assert_whole(&output);
            assert_eq!(temporaries(&output), Vec::<PathBuf>::new());
            if code == Some(0) {
                return false;
            }
            assert_eq!(code, Some(status));
            release.assert_completes(&output);
            whole < release.wanted.len()
        });
        assert!(in_the_middle, "{name} never came in the middle");
    }
}
