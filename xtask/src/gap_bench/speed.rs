//! Time and memory of one diagnosis on files of a stated size.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use anyhow::Context;
use gap_lab::{CaseSpec, Kind, Plan, catalogue};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::attempt::{attempt, read};

/// One file measured.
pub(crate) struct Speed {
    pub(crate) what: &'static str,
    pub(crate) rows: usize,
    /// On the clock.
    pub(crate) seconds: f64,
    /// Of the processor; on the clock where the system does not tell.
    pub(crate) cpu_seconds: f64,
    pub(crate) peak_mib: Option<f64>,
    pub(crate) verdict: String,
    /// Longest time and largest memory allowed.
    pub(crate) goal: (f64, f64),
}

/// Diagnoses 3000 rows of every kind of observation and of an effect outside the library (the search goes on longest
/// there), and a single effect with 100 000.
pub(crate) fn measure(vpost: &Path, root: &Path) -> anyhow::Result<Vec<Speed>> {
    let list = catalogue(1200, 1);
    let pick = |kind: Kind, wanted: &dyn Fn(&CaseSpec) -> bool| {
        list.iter()
            .find(|s| {
                s.kind == kind
                    && (s.plans == [Plan::Good] || kind == Kind::BallBar)
                    && s.snr.iter().all(|v| *v > 2.0)
                    && wanted(s)
            })
            .context("the catalogue has such a case")
    };
    let single = pick(Kind::Single, &|s| s.effects[0].id().starts_with("squareness"))?;
    let bar = pick(Kind::BallBar, &|_| true)?;
    let lengths = pick(Kind::Magnitude, &|_| true)?;
    let outside = pick(Kind::Outside, &|s| s.build().truth.effects[0].id.ends_with("field"))?;
    let jobs = [
        ("one effect, 3000 rows", single, 3000, (2.0, 1024.0)),
        ("ball bar, 3000 rows", bar, 3000, (2.0, 1024.0)),
        ("distances only, 3000 rows", lengths, 3000, (2.0, 1024.0)),
        ("effect outside the library, 3000 rows", outside, 3000, (2.0, 1024.0)),
        ("one effect, 100 000 rows", single, 100_000, (30.0, 1024.0)),
    ];
    let mut found = Vec::new();
    for (what, spec, rows, goal) in jobs {
        let folder = root.join(format!("speed-{}-{rows}", spec.id()));
        std::fs::create_dir_all(&folder)?;
        for (name, text) in &spec.build().files {
            let text = if name == "measurement.csv" { repeated(text, rows)? } else { text.clone() };
            std::fs::write(folder.join(name), text)?;
        }
        let mut command = Command::new(vpost);
        command.args(["diagnose", "measurement.csv", "-m", "profile.toml", "--json", "answer.json"]);
        let ran = attempt(command, &folder, "diagnose")?;
        let verdict = match ran.failure {
            Some(words) => words,
            None => read(&folder.join("answer.json")).map_or_else(|e| e, |a| a.verdict),
        };
        let cpu_seconds = ran.cpu_seconds.unwrap_or(ran.seconds);
        let (seconds, peak_mib) = (ran.seconds, ran.peak_mib);
        found.push(Speed { what, rows, seconds, cpu_seconds, peak_mib, verdict, goal });
        std::fs::remove_dir_all(&folder)?;
    }
    Ok(found)
}

/// The same plan measured again and again until there are `wanted` rows: runs of their own names, later times, and
/// 1 µm of noise more (uniform), since no measurement repeats itself to the digit.
fn repeated(text: &str, wanted: usize) -> anyhow::Result<String> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().context("a header")?.split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let time = header.iter().position(|h| *h == "time_s");
    let span = match time {
        None => 0.0,
        Some(t) => rows.iter().filter_map(|r| r[t].parse::<f64>().ok()).fold(0.0, f64::max) + 60.0,
    };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut out = header.join(",");
    for count in 0..wanted {
        let (turn, row) = (count / rows.len(), &rows[count % rows.len()]);
        let cells = row.iter().zip(&header).map(|(cell, head)| match (*head, cell.parse::<f64>()) {
            ("run", _) => format!("{cell}t{turn}"),
            ("time_s", Ok(v)) => format!("{:.2}", v + span * turn as f64),
            ("dx_um" | "dy_um" | "dz_um", Ok(v)) if turn > 0 => {
                format!("{:.3}", v + random.random_range(-1.7..1.7))
            }
            ("d_um", Ok(v)) if turn > 0 => format!("{:.3}", (v + random.random_range(-1.7..1.7)).abs()),
            ("length_mm", Ok(v)) if turn > 0 => format!("{:.6}", v + random.random_range(-1.7e-3..1.7e-3)),
            _ => (*cell).to_owned(),
        });
        write!(out, "\n{}", cells.collect::<Vec<_>>().join(",")).expect("writing to a string cannot fail");
    }
    out.push('\n');
    Ok(out)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_plan_is_repeated_with_later_times_and_other_noise() {
        let text = "run,x_mm,dx_um,time_s,d_um\na,1.0,2.0,10,2.0\nb,5.0,3.0,40,3.0\n";
        let long = super::repeated(text, 5).unwrap();
        let lines: Vec<&str> = long.lines().collect();
        assert_eq!(lines.len(), 6);
        assert_eq!(lines[1], "at0,1.0,2.0,10.00,2.0");
        assert!(lines[3].starts_with("at1,1.0,") && lines[3].contains(",110.00,"), "{}", lines[3]);
        assert_ne!(lines[3].split(',').nth(2), Some("2.0"));
        assert_ne!(lines[3].split(',').nth(4), Some("2.0"));
    }
}
