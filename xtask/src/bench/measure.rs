//! Runs of other programs: how long, how much of the processor, how much memory.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};

/// What one run took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Seconds on the clock.
    pub(crate) wall_s: f64,
    /// Seconds of processors, all threads and what they started, the system's share included.
    pub(crate) cpu_s: f64,
    /// Largest resident memory, MiB.
    pub(crate) peak_mib: f64,
}

/// Ticks of `/proc/PID/stat` in a second; the same on every Linux that Rust runs on.
const TICKS_PER_SECOND: f64 = 100.0;

/// Runs a command to its end.
pub(crate) fn run(command: &mut Command) -> anyhow::Result<Run> {
    let started = Instant::now();
    let mut child = command.stdin(Stdio::null()).spawn().with_context(|| format!("{command:?}"))?;
    let folder = Path::new("/proc").join(child.id().to_string());
    let mut found = Run { wall_s: 0.0, cpu_s: 0.0, peak_mib: 0.0 };
    loop {
        if let Ok(status) = std::fs::read_to_string(folder.join("status"))
            && let Some(line) = status.lines().find(|line| line.starts_with("VmHWM:"))
            && let Some(kib) = line.split_whitespace().nth(1).and_then(|kib| kib.parse::<f64>().ok())
        {
            found.peak_mib = kib / 1024.0;
        }
        // An ended child keeps its times until it is waited for.
        let stat = std::fs::read_to_string(folder.join("stat")).context("reading /proc needs Linux")?;
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
        let ticks = |at: usize| fields.get(at).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
        found.cpu_s = (11..=14).map(ticks).sum::<f64>() / TICKS_PER_SECOND;
        if fields.first() == Some(&"Z") {
            found.wall_s = started.elapsed().as_secs_f64();
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let status = child.wait()?;
    if !status.success() {
        bail!("{command:?}: {status}");
    }
    Ok(found)
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

/// The quickest of several runs.
pub(crate) fn best(runs: usize, mut once: impl FnMut() -> anyhow::Result<Run>) -> anyhow::Result<Run> {
    let mut best = once()?;
    for _ in 1..runs {
        best = best.least(once()?);
    }
    Ok(best)
}
