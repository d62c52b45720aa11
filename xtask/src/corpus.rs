//! LinuxCNC's samples through the command: what is corrected, what is refused and why, and what two judges
//! say of each correction.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Args;
use nc_expand::{Environment, Limits, Preset, expand};
use rayon::prelude::*;

use crate::markdown::table;
use crate::wrap::wrapped;

/// Options of the corpus run.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Folder of the samples, with all folders in it.
    #[arg(long, default_value = "/usr/share/linuxcnc/ncfiles")]
    samples: PathBuf,
    /// Folder of an interpreter's test suite instead: LinuxCNC's sources have one in `tests`.
    #[arg(long)]
    suite: Option<PathBuf>,
    /// Machine profile.
    #[arg(long, default_value = "tests/profiles/linuxcnc_samples.toml")]
    profile: PathBuf,
    /// The command under test; default: the release build beside this program, built first.
    #[arg(long)]
    vpost: Option<PathBuf>,
    /// Programs at the same time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// What was run, for the page: the version of the package, the commit of the sources.
    #[arg(long)]
    of: Option<String>,
    /// Only programs whose path contains this text; nothing is written to docs/ then.
    #[arg(long)]
    only: Option<String>,
    /// Where the page goes.
    #[arg(long, default_value = "docs/corpus.md")]
    page: PathBuf,
}

impl Options {
    fn folder(&self) -> &Path {
        self.suite.as_deref().unwrap_or(&self.samples)
    }
}

const SAMPLES_HEADING: &str = "# LinuxCNC's samples\n";
const SAMPLES: &str = "# LinuxCNC's samples\n\nMade by `cargo run -p xtask -- corpus`: every program that comes with LinuxCNC, corrected for a wide crooked machine \
         (`tests/profiles/linuxcnc_samples.toml`), with the program's own folder as `--include`. Where a message names an option as the way out (`--set` for a variable, `--start-at`), it is given: 100 for a \
         variable. Each corrected one goes through the closed loop \
         (`vpost check`) and before the second judge (LinuxCNC's interpreter and a machine model that share no code with vpost). Most samples are subroutines alone (VP0141); \
         how these are executed when something calls them is compared with LinuxCNC's interpreter by the test `interpreter` of `nc-expand`.\n\n";

const SUITE_HEADING: &str = "# LinuxCNC's test suite\n";
const SUITE: &str = "# LinuxCNC's test suite\n\n\
    The same of the programs that LinuxCNC's developers test their interpreter and their trajectory planner with: corners of the language, \
    errors on purpose, toolpaths of posts. They come with its source code, not with its package: get the sources of LinuxCNC (their repository on \
    GitHub is LinuxCNC/linuxcnc), then `cargo run -p xtask -- corpus --suite SOURCES/tests`. A test's expectation is not looked at; many of \
    these programs are meant to fail.\n\n";

/// Longest time for one run of a tool.
const PATIENCE: Duration = Duration::from_secs(300);

/// How far a tapped hole is off, for its cycle stays one block.
const BOUND_TO_THE_SPINDLE: &str = "warning[VP0506]";

/// What became of a program.
struct Sample {
    name: String,
    /// Options that messages asked for.
    ways: Vec<String>,
    /// It computes, jumps or calls.
    flow: bool,
    fate: Fate,
}

enum Fate {
    /// Code and message.
    Refused(String, String),
    Corrected {
        check: Verdict,
        referee: Verdict,
    },
    /// It executes no feed motion.
    Idle,
    /// Neither: a defect of the command.
    Broken(String),
}

enum Verdict {
    Holds {
        motions: u64,
        before_um: f64,
        after_um: f64,
    },
    Fails(String),
    /// It fails by what the correction warned of.
    Warned(String),
    /// The judge could not read the program.
    Silent(String),
}

/// Runs everything; the summary for the terminal.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    let vpost = match &options.vpost {
        Some(path) => path.canonicalize().with_context(|| format!("{} is not there", path.display()))?,
        None => crate::gap_bench::released()?,
    };
    let mut paths = Vec::new();
    programs(options.folder(), &mut paths)?;
    paths.sort();
    if let Some(only) = &options.only {
        paths.retain(|path| path.display().to_string().contains(only));
    }
    if paths.is_empty() {
        bail!("no programs in {}", options.folder().display());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.jobs).build()?;
    let samples = pool.install(|| {
        paths.par_iter().map(|path| sample(&vpost, options, path)).collect::<anyhow::Result<Vec<_>>>()
    })?;
    let intro = if options.suite.is_some() { SUITE } else { SAMPLES };
    let of = options.of.as_ref().map_or_else(String::new, |of| format!(" on {of}"));
    let intro = format!("{intro}Run on {}{of}.\n\n", crate::gap_bench::date());
    let made = wrapped(&section(&samples, &intro));
    if options.only.is_none() {
        let page = std::fs::read_to_string(&options.page).unwrap_or_default();
        let heading = if options.suite.is_some() { SUITE_HEADING } else { SAMPLES_HEADING };
        std::fs::write(&options.page, with_section(&page, heading, &made))?;
    }
    Ok(made)
}

/// The page with its section of a heading made anew; what stands before and behind it stays.
fn with_section(page: &str, heading: &str, made: &str) -> String {
    let start = page.find(heading).unwrap_or(page.len());
    let (before, old) = page.split_at(start);
    let behind = old.find("\n# ").map_or("", |end| &old[end..]);
    let parts = [before, made, behind].map(str::trim);
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    parts.join("\n\n") + "\n"
}

fn programs(folder: &Path, found: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| format!("{} is not there", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            programs(&path, found)?;
        } else if path.extension().is_some_and(|ending| ending == "ngc") {
            found.push(path);
        }
    }
    Ok(())
}

fn sample(vpost: &Path, options: &Options, path: &Path) -> anyhow::Result<Sample> {
    let name = path.strip_prefix(options.folder())?.display().to_string();
    let folder = path.parent().unwrap_or(Path::new("."));
    let work = tempfile::tempdir()?;
    let out = work.path().join("out.ngc");
    let plain = work.path().join("plain.ngc");
    let text = std::fs::read(path)?;
    // The ways out that messages name are taken: a value for a variable, a place to start from.
    let mut ways: Vec<String> = Vec::new();
    let (status, said) = loop {
        let mut command = Command::new(vpost);
        command.arg(path).arg("-m").arg(&options.profile).args(["-d", "linuxcnc", "--color", "never"]);
        command.arg("--include").arg(folder).arg("-o").arg(&out).args(&ways);
        let (status, _, said) = finish(command)?;
        match way_out(&said) {
            Some(way) if status == Some(1) && ways.len() < 60 && !ways.contains(&way[1]) => ways.extend(way),
            _ => break (status, said),
        }
    };
    let flow = plain_program(&text, folder, &ways, &plain)?;
    let fate = match status {
        Some(0) => {
            let mut check = Command::new(vpost);
            check.arg("check").arg(path).arg(&out).arg("-m").arg(&options.profile);
            check
                .args(["-d", "linuxcnc", "--json", "--color", "never"])
                .arg("--include")
                .arg(folder)
                .args(&ways);
            let check = match checked(check)? {
                Verdict::Fails(why) if said.contains(BOUND_TO_THE_SPINDLE) => Verdict::Warned(why),
                check => check,
            };
            // The output step of the program's unit: 0.0001 inch is 2.54 um.
            let resolution_um = if inch(&text) { "2.54" } else { "1" };
            let mut referee = Command::new("/usr/bin/python3");
            referee.arg("tests/referee/referee.py").arg("--in").arg(&plain).arg("--out").arg(&out);
            referee.arg("--model").arg(&options.profile);
            referee.args(["--resolution", resolution_um]);
            match check {
                Verdict::Holds { motions: 0, .. } => Fate::Idle,
                check if machine_coordinates(&plain)? => Fate::Corrected {
                    check,
                    referee: Verdict::Silent("G53, whose place it does not know".to_owned()),
                },
                check if ways.iter().any(|way| way == "--start-at") => Fate::Corrected {
                    check,
                    referee: Verdict::Silent("its interpreter starts at zero".to_owned()),
                },
                check => Fate::Corrected { check, referee: judged(referee)? },
            }
        }
        Some(1) => match refusal(&said).and_then(|line| line.strip_prefix("error[")?.split_once("]: ")) {
            Some((code, message)) => Fate::Refused(code.to_owned(), message.to_owned()),
            None => Fate::Broken(said),
        },
        _ => Fate::Broken(said),
    };
    Ok(Sample { name, ways, flow, fate })
}

/// The first line of a refusal, behind the warnings.
fn refusal(said: &str) -> Option<&str> {
    said.lines().find(|line| line.starts_with("error["))
}

/// The option that a refusal's help names, with a value of ours.
fn way_out(said: &str) -> Option<[String; 2]> {
    let first = refusal(said)?;
    if first.starts_with("error[VP0121]") {
        let name = said.split_once("`--set \"")?.1.split_once("=12.5\"`")?.0;
        return Some(["--set".to_owned(), format!("{name}=100")]);
    }
    first.starts_with("error[VP0213]").then(|| ["--start-at".to_owned(), "100,80,300".to_owned()])
}

/// Writes the program without flow, which the second judge is given; true where there was some.
///
/// That both move alike is shown apart, by LinuxCNC's interpreter (`nc-expand`, test `interpreter`).
fn plain_program(text: &[u8], folder: &Path, ways: &[String], plain: &Path) -> anyhow::Result<bool> {
    let variables: Vec<Preset> = ways.iter().filter_map(|way| Preset::parse(way)).collect();
    let dialect = nc_dialect::builtin("linuxcnc").context("a shipped dialect")?;
    let read = |name: &str| std::fs::read(folder.join(name));
    let setup = nc_program::Setup::default();
    let environment =
        Environment { variables: &variables, read_external: &read, setup: &setup, limits: Limits::default() };
    Ok(match expand(text, dialect, &environment) {
        Ok(expanded) => {
            std::fs::write(plain, expanded.text())?;
            expanded.changed()
        }
        Err(_) => true,
    })
}

/// Runs a command to its end: status, output, messages. No status: it had to be stopped.
fn finish(mut command: Command) -> anyhow::Result<(Option<i32>, String, String)> {
    let folder = tempfile::tempdir()?;
    let (out, messages) = (folder.path().join("out"), folder.path().join("messages"));
    let mut child = command
        .stdin(Stdio::null())
        .stdout(std::fs::File::create(&out)?)
        .stderr(std::fs::File::create(&messages)?)
        .spawn()?;
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status.code();
        }
        if start.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            break None;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let text = |path: &Path| -> anyhow::Result<String> {
        Ok(String::from_utf8_lossy(&std::fs::read(path)?).into_owned())
    };
    Ok((status, text(&out)?, text(&messages)?))
}

/// What a judge says: motions, deviations before and after, and what failed, by where its JSON has them. `Err`: its messages.
fn verdict(command: Command, places: [&str; 4]) -> anyhow::Result<Result<Verdict, String>> {
    let (status, out, said) = finish(command)?;
    let Ok(json) = serde_json::from_str::<serde_json::Value>(&out) else { return Ok(Err(said)) };
    let [motions, before, after, failed] = places.map(|place| json.pointer(place));
    let um = |value: Option<&serde_json::Value>| value.and_then(|um| um.as_f64()).unwrap_or_default();
    Ok(Ok(if status == Some(0) {
        let motions = motions.and_then(|count| count.as_u64()).unwrap_or_default();
        Verdict::Holds { motions, before_um: um(before), after_um: um(after) }
    } else {
        Verdict::Fails(failed.and_then(|why| why.as_str()).unwrap_or("no finding").to_owned())
    }))
}

fn checked(command: Command) -> anyhow::Result<Verdict> {
    let places = ["/feed_motions_in", "/deviation_before_um", "/deviation_after_um", "/findings/0"];
    Ok(verdict(command, places)?.unwrap_or_else(|said| Verdict::Fails(first_line(&said))))
}

fn judged(command: Command) -> anyhow::Result<Verdict> {
    let last = |said: String| said.lines().last().unwrap_or("no answer").to_owned();
    let places = ["/counts/moves_in", "/before/um", "/after/um", "/failures/0"];
    Ok(verdict(command, places)?.unwrap_or_else(|said| Verdict::Silent(last(said))))
}

/// True where the program goes to machine coordinates: the second judge has no work offsets in its interpreter
/// and takes the axes to be elsewhere afterwards.
fn machine_coordinates(program: &Path) -> anyhow::Result<bool> {
    let text = String::from_utf8_lossy(&std::fs::read(program)?).to_ascii_uppercase();
    Ok(text.lines().any(|line| line.split('(').next().is_some_and(|words| words.contains("G53"))))
}

/// True where the program chooses inches.
fn inch(text: &[u8]) -> bool {
    let text: String =
        String::from_utf8_lossy(text).to_ascii_uppercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let code = |at: usize| !text[at + 3..].starts_with(|c: char| c.is_ascii_digit() || c == '.');
    text.match_indices("G20").any(|(at, _)| code(at))
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or("no answer").to_owned()
}

fn section(samples: &[Sample], intro: &str) -> String {
    let total = samples.len();
    let corrected: Vec<(&Sample, &Verdict, &Verdict)> = samples
        .iter()
        .filter_map(|sample| match &sample.fate {
            Fate::Corrected { check, referee } => Some((sample, check, referee)),
            _ => None,
        })
        .collect();
    let checks = |is: fn(&Verdict) -> bool| corrected.iter().filter(|(_, c, _)| is(c)).count().to_string();
    let judged = |is: fn(&Verdict) -> bool| corrected.iter().filter(|(.., j)| is(j)).count().to_string();
    let share = |part: usize| format!("{part} ({:.0} %)", 100.0 * part as f64 / total as f64);
    let is_wrong = |(_, check, judge): &&(&Sample, &Verdict, &Verdict)| {
        !matches!(check, Verdict::Holds { .. } | Verdict::Warned(_)) || matches!(judge, Verdict::Fails(_))
    };
    let wrong = corrected.iter().filter(is_wrong).count();
    let with_flow = corrected.iter().filter(|(sample, ..)| sample.flow).count();
    let idle = samples.iter().filter(|sample| matches!(sample.fate, Fate::Idle)).count();
    let broken = samples.iter().filter(|sample| matches!(sample.fate, Fate::Broken(_))).count();
    let refused = total - corrected.len() - broken - idle;
    let alone =
        samples.iter().filter(|s| matches!(&s.fate, Fate::Refused(code, _) if code == "VP0141")).count();
    let with_options = corrected.iter().filter(|(sample, ..)| !sample.ways.is_empty()).count();
    let rows = [
        ("all", total.to_string()),
        ("corrected", share(corrected.len())),
        ("… of these with variables, loops or subroutines", with_flow.to_string()),
        ("… of these with options that a message asked for", with_options.to_string()),
        ("refused: subroutines alone (VP0141)", share(alone)),
        ("refused for other reasons", share(refused - alone)),
        ("without feed motion, unchanged", share(idle)),
        ("wrong by either judge", wrong.to_string()),
        (
            "off by what was warned of: a tapped hole (VP0506)",
            checks(|check| matches!(check, Verdict::Warned(_))),
        ),
        ("neither corrected nor refused", broken.to_string()),
        ("held by the closed loop", checks(|check| matches!(check, Verdict::Holds { .. }))),
        ("held by the second judge", judged(|judge| matches!(judge, Verdict::Holds { .. }))),
        ("not read by the second judge", judged(|judge| matches!(judge, Verdict::Silent(_)))),
    ];
    let rows = rows.map(|(what, count)| vec![what.to_owned(), count]);
    let mut text = intro.to_owned() + &table(&["", "programs"], &rows);
    let mut codes: BTreeMap<&str, (usize, &str, &str)> = BTreeMap::new();
    for sample in samples {
        if let Fate::Refused(code, message) = &sample.fate {
            codes.entry(code).or_insert((0, &sample.name, message)).0 += 1;
        }
    }
    text += "\n## Refused, by message\n\n";
    let rows: Vec<Vec<String>> = codes
        .iter()
        .map(|(code, (count, name, message))| {
            vec![(*code).to_owned(), count.to_string(), format!("`{name}`: {}", cell(message))]
        })
        .collect();
    text += &table(&["message", "programs", "the first"], &rows);
    text += "\n## Corrected\n\nLargest path deviation before and after, in µm.\n\n";
    let rows: Vec<Vec<String>> = corrected
        .iter()
        .map(|(sample, check, referee)| {
            let ways = sample.ways.join(" ").replace("--set ", "");
            vec![
                format!("`{}`", sample.name),
                if ways.is_empty() { ways } else { format!("`{ways}`") },
                if sample.flow { "yes" } else { "" }.into(),
                shown(check),
                shown(referee),
            ]
        })
        .collect();
    text += &table(&["program", "given", "flow", "closed loop", "second judge"], &rows);
    for sample in samples {
        if let Fate::Broken(said) = &sample.fate {
            text += &format!("\nDefect on `{}`: {}\n", sample.name, first_line(said));
        }
    }
    text
}

fn shown(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Holds { before_um, after_um, .. } => format!("{before_um:.1} → {after_um:.2}"),
        Verdict::Fails(why) => format!("**wrong**: {}", cell(why)),
        Verdict::Warned(why) => format!("warned of: {}", cell(why)),
        Verdict::Silent(why) => format!("not read: {}", cell(why)),
    }
}

/// Text that fits a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "/").replace('<', "&lt;").chars().take(140).collect()
}

#[cfg(test)]
mod tests {
    use super::with_section;

    #[test]
    fn a_section_is_made_anew_between_the_others() {
        let page = "# A\n\nold\n\n## A1\n\n# B\n\nkept\n\n# C\n\nkept\n";
        let expected = "# A\n\nnew\n\n# B\n\nkept\n\n# C\n\nkept\n";
        assert_eq!(with_section(page, "# A\n", "# A\n\nnew\n"), expected);
        assert!(with_section(page, "# B\n", "# B\n").ends_with("# B\n\n# C\n\nkept\n"));
        assert!(with_section(page, "# D\n", "# D\n\nnew\n").ends_with("# C\n\nkept\n\n# D\n\nnew\n"));
    }
}
