//! Ball-bar circles with one to four faults: how many are found, and how many names are none.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use anyhow::Context;
use gap_lab::circles::{Circles, circles};
use rayon::prelude::*;

use super::answer::Answer;
use super::scores::Rate;

/// Faults at once.
const MOST: usize = 4;

/// What came of one case.
struct Found {
    count: usize,
    recall: Rate,
    precision: Rate,
    /// An axis that sticks and slips was told, or one that does not was.
    told: (bool, bool),
    line: String,
}

/// Diagnoses `cases` circles, as many of each number of faults, and says how often the answers are right.
pub(crate) fn run(vpost: &Path, root: &Path, cases: usize, seed: u64) -> anyhow::Result<String> {
    let all: Vec<(usize, u64)> = (0..cases).map(|k| (k % MOST + 1, (k / MOST) as u64)).collect();
    let found: Vec<Found> = all
        .par_iter()
        .map(|(count, index)| examine(vpost, root, *count, *index, seed))
        .collect::<anyhow::Result<_>>()?;
    let mut text =
        "| faults | found, or in the set | names that are right | sticking told | told where none sticks |\n\
        |---|---|---|---|---|\n"
            .to_owned();
    for count in 1..=MOST {
        let own = || found.iter().filter(move |f| f.count == count);
        let sum = |rate: &dyn Fn(&Found) -> Rate| {
            own()
                .map(rate)
                .fold(Rate::default(), |a, b| Rate { hits: a.hits + b.hits, total: a.total + b.total })
        };
        let (recall, precision) = (sum(&|f| f.recall), sum(&|f| f.precision));
        let mut told = [Rate::default(); 2];
        own().for_each(|f| told[usize::from(!f.told.0)].add(f.told.1));
        writeln!(
            text,
            "| {count} | {} of {} | {} of {} | {} of {} | {} of {} |",
            recall.hits,
            recall.total,
            precision.hits,
            precision.total,
            told[0].hits,
            told[0].total,
            told[1].hits,
            told[1].total
        )?;
    }
    text.push('\n');
    found.iter().filter(|f| !f.line.is_empty()).for_each(|f| text += &f.line);
    Ok(text)
}

fn examine(vpost: &Path, root: &Path, count: usize, index: u64, seed: u64) -> anyhow::Result<Found> {
    let folder = root.join(format!("circles-{count}-{index:03}"));
    std::fs::create_dir_all(&folder)?;
    let Circles { profile, measurement, faults, jerks } = circles(count, index, seed);
    std::fs::write(folder.join("profile.toml"), profile)?;
    std::fs::write(folder.join("measurement.csv"), measurement)?;
    std::fs::write(folder.join("truth.txt"), format!("{faults:?} {jerks:?}\n"))?;
    let mut command = Command::new(vpost);
    command.args(["diagnose", "measurement.csv", "-m", "profile.toml", "--json", "answer.json"]);
    let output = command.current_dir(&folder).env("RAYON_NUM_THREADS", "1").output()?;
    std::fs::write(folder.join("diagnose.out"), &output.stdout)?;
    let json = std::fs::read(folder.join("answer.json"))
        .with_context(|| format!("{}: {}", folder.display(), String::from_utf8_lossy(&output.stderr)))?;
    let answer: Answer = serde_json::from_slice(&json)?;
    let (mut recall, mut precision) = (Rate::default(), Rate::default());
    faults.iter().for_each(|fault| recall.add(answer.set().contains(&fault.as_str())));
    let is_true = |name: &String| faults.contains(name);
    for cause in &answer.causes {
        precision.add(is_true(&cause.effect) || cause.cannot_be_told_from.iter().any(is_true));
    }
    let told = String::from_utf8_lossy(&output.stdout).contains("moves in jerks");
    let wrong = recall.hits < recall.total || precision.hits < precision.total || told != jerks.is_some();
    let names: Vec<&str> = answer.causes.iter().map(|c| c.effect.as_str()).collect();
    let line = format!(
        "- `{count}-{index:03}` {}: {}{}; found {}{}\n",
        answer.verdict,
        faults.join(", "),
        jerks.map_or_else(String::new, |axis| format!(", {axis} sticks")),
        names.join(", "),
        if told { ", told to stick" } else { "" }
    );
    let line = if wrong { line } else { String::new() };
    Ok(Found { count, recall, precision, told: (jerks.is_some(), told), line })
}
