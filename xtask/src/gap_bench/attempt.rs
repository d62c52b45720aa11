//! One run of the command under test, and what it wrote.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::Context;

use super::answer::Answer;

/// Longest time one diagnosis may take, of the processor where the system tells it: others may use the machine, too.
const PATIENCE: Duration = Duration::from_secs(60);

/// The answer that a diagnosis wrote, or why there is none.
pub(crate) fn read(path: &Path) -> Result<Answer, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("no JSON was written: {e}"))?;
    serde_json::from_str(&text).map_err(|e| format!("the JSON is not of the contract: {e}"))
}

/// How a command ended.
pub(crate) struct Ran {
    /// What went wrong.
    pub failure: Option<String>,
    /// On the clock.
    pub seconds: f64,
    /// Of the processor, to the last look but at most a hundredth short; `None` where the system does not tell.
    pub cpu_seconds: Option<f64>,
    /// Largest resident memory seen, MiB; `None` where the system does not tell.
    pub peak_mib: Option<f64>,
}

/// Runs a command to its end, its output in files of that `name`.
pub(crate) fn attempt(mut command: Command, folder: &Path, name: &str) -> anyhow::Result<Ran> {
    let errors = folder.join(format!("{name}.err"));
    let output = folder.join(format!("{name}.out"));
    let started = Instant::now();
    let mut child = command
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .stdout(std::fs::File::create(output)?)
        .stderr(std::fs::File::create(&errors)?)
        .spawn()
        .context("cannot start the command under test")?;
    let mut pause = Duration::from_millis(1);
    let (mut peak_mib, mut cpu_seconds) = (None, None);
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if cpu_seconds.unwrap_or_else(|| started.elapsed().as_secs_f64()) > PATIENCE.as_secs_f64() {
            child.kill()?;
            child.wait()?;
            let failure = Some(format!("no answer after {} s", PATIENCE.as_secs()));
            return Ok(Ran { failure, seconds: PATIENCE.as_secs_f64(), cpu_seconds, peak_mib });
        }
        // The system keeps the high-water mark itself; only the last pause before the end is not seen.
        peak_mib = peak_mib_of(child.id()).or(peak_mib);
        cpu_seconds = cpu_seconds_of(child.id()).or(cpu_seconds);
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(10));
    };
    let seconds = started.elapsed().as_secs_f64();
    if status.success() {
        return Ok(Ran { failure: None, seconds, cpu_seconds, peak_mib });
    }
    let words = std::fs::read_to_string(errors).unwrap_or_default();
    let first = words.lines().next().unwrap_or("no message").to_owned();
    let failure = format!("exit {}: {first}", status.code().map_or("by signal".into(), |c| c.to_string()));
    Ok(Ran { failure: Some(failure), seconds, cpu_seconds, peak_mib })
}

/// High-water mark of a process's resident memory, as Linux tells it.
fn peak_mib_of(process: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib / 1024.0)
}

/// Processor time of a process, user and system, as Linux tells it.
fn cpu_seconds_of(process: u32) -> Option<f64> {
    /// Ticks per second, the same on every Linux since 2.6.
    const TICKS: f64 = 100.0;
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name in brackets may hold spaces; the numbers come after it, the state first.
    let mut numbers = text.rsplit(')').next()?.split_whitespace();
    let user: f64 = numbers.nth(11)?.parse().ok()?;
    let system: f64 = numbers.next()?.parse().ok()?;
    Some((user + system) / TICKS)
}
