//! Runs of other programs: how long, how much of the processor, how much memory.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use wait4::Wait4;

/// What one run took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Run {
    /// Seconds on the clock.
    pub(crate) wall_s: f64,
    /// Seconds of processors, all threads and what they started, the system's share included.
    pub(crate) cpu_s: f64,
    /// Largest resident memory, MiB.
    pub(crate) peak_mib: f64,
}

/// Runs a command to its end.
pub(crate) fn run(command: &mut Command) -> anyhow::Result<Run> {
    let started = Instant::now();
    let mut child = command.stdin(Stdio::null()).spawn().with_context(|| format!("{command:?}"))?;
    let status = Path::new("/proc").join(child.id().to_string()).join("status");
    let (ended, end) = channel();
    let (used, wall_s, peak_mib) = std::thread::scope(|scope| {
        let watch = scope.spawn(move || peak_mib(&status, &end));
        let used = child.wait4();
        let wall_s = started.elapsed().as_secs_f64();
        drop(ended);
        (used, wall_s, watch.join().unwrap_or(0.0))
    });
    let used = used?;
    if !used.status.success() {
        bail!("{command:?}: {}", used.status);
    }
    Ok(Run { wall_s, cpu_s: (used.rusage.utime + used.rusage.stime).as_secs_f64(), peak_mib })
}

/// Largest resident memory of a running process until its end, MiB; 0 where the system does not tell. What is counted for an ended
/// process has that of this one in it.
fn peak_mib(status: &Path, end: &Receiver<()>) -> f64 {
    /// Seldom enough to take nothing from what is measured.
    const EVERY: Duration = Duration::from_millis(20);
    let mut peak_kib: f64 = 0.0;
    while end.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
        let text = std::fs::read_to_string(status).unwrap_or_default();
        let kib = text
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0.0));
    }
    peak_kib / 1024.0
}

/// Seconds of the processor that this thread took so far: others' work on the machine does not count.
pub(crate) fn own_cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) / 1e9
}

impl Run {
    /// The quicker in each respect: on a machine that others use too, the rest is their share.
    pub(crate) fn least(self, other: Self) -> Self {
        Self {
            wall_s: self.wall_s.min(other.wall_s),
            cpu_s: self.cpu_s.min(other.cpu_s),
            peak_mib: self.peak_mib.max(other.peak_mib),
        }
    }
}

/// Runs all kinds of run in turn, so that none has the machine's best minute for itself; of each what it took at the least.
pub(crate) fn in_turn<const KINDS: usize>(
    rounds: usize,
    mut round: impl FnMut(usize) -> anyhow::Result<[Run; KINDS]>,
) -> anyhow::Result<[Run; KINDS]> {
    let mut least = round(0)?;
    for number in 1..rounds {
        for (least, run) in least.iter_mut().zip(round(number)?) {
            *least = least.least(run);
        }
    }
    Ok(least)
}

/// Runs a command that writes a file. Freeing that of the run before is not what is measured.
pub(crate) fn run_anew(command: &mut Command, output: &Path) -> anyhow::Result<Run> {
    if output.exists() {
        std::fs::remove_file(output)?;
    }
    run(command)
}
