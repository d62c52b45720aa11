//! The measure of the house: how large it is, what in it is too long, and which files go in circles.
//!
//! What each figure is: `docs/house.md`.

mod imports;
mod ratchet;
mod source;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;
use serde::Serialize;
use serde_json::Value;

use crate::markdown::table;
use source::{Function, Source};

/// A file with more lines has more than one idea.
const LONG_FILE: usize = 500;
/// A function with more lines does more than one thing.
const LONG_FUNCTION: usize = 80;

/// Options of the measure.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// The figures as JSON.
    #[arg(long)]
    json: bool,
    /// Names behind the figures: long files and functions, circles, `bool` parameters.
    #[arg(long)]
    list: bool,
    /// Clone what is committed, run `cargo test --workspace` there, and say how long that takes and how large target/ gets.
    #[arg(long)]
    time: bool,
    /// Hold the figures against the limits of docs/house.toml.
    #[arg(long)]
    check: bool,
    /// Turn the limits down to today's figures, and make docs/house.md.
    #[arg(long)]
    write: bool,
    /// Let a figure rise to what it is now: KEY=One sentence why.
    #[arg(long, value_name = "KEY=WHY", value_parser = key_and_why)]
    raise: Vec<(String, String)>,
}

fn key_and_why(written: &str) -> Result<(String, String), String> {
    let (key, why) = written.split_once('=').ok_or("expected KEY=One sentence why.")?;
    match why.split_whitespace().count() {
        0..3 => Err("expected a sentence behind the sign: what the rise is for".to_owned()),
        _ => Ok((key.to_owned(), why.to_owned())),
    }
}

/// One figure of the sources, for the code and for its tests.
#[derive(Debug, Default, PartialEq, Eq, Serialize)]
struct Split {
    code: usize,
    tests: usize,
}

impl Split {
    fn of<'a, T: 'a>(all: &'a [T], is_test: impl Fn(&T) -> bool) -> Self {
        let tests = all.iter().filter(|one| is_test(one)).count();
        Self { code: all.len() - tests, tests }
    }
}

/// The figures.
#[derive(Debug, Serialize)]
struct House {
    lines_of_code: Split,
    files: Split,
    files_above_500_lines: Split,
    functions: Split,
    functions_above_80_lines: Split,
    bool_parameters: Split,
    lines_above_120_columns: usize,
    lines_of_scripts: usize,
    lines_of_judges: usize,
    circles: usize,
    files_in_circles: usize,
    test_binaries: usize,
    test_binaries_with_vpost: usize,
    target_mb: Option<u64>,
    clone_to_green: Option<CloneToGreen>,
}

#[derive(Debug, Serialize)]
struct CloneToGreen {
    seconds: u64,
    passed: bool,
    target_mb: u64,
}

impl House {
    /// The figures that have limits. How large `target/` is says nothing where builds of many days lie in it: it is
    /// asked on build machines only.
    fn limited(&self) -> Vec<ratchet::Measured> {
        let target_mb = std::env::var_os("CI").and(self.target_mb);
        vec![
            ("lines_of_code", Some(self.lines_of_code.code)),
            ("lines_of_tests", Some(self.lines_of_code.tests)),
            ("files_above_500_lines", Some(self.files_above_500_lines.code)),
            ("functions_above_80_lines", Some(self.functions_above_80_lines.code)),
            ("bool_parameters", Some(self.bool_parameters.code)),
            ("circles", Some(self.circles)),
            ("lines_above_120_columns", Some(self.lines_above_120_columns)),
            ("lines_of_scripts", Some(self.lines_of_scripts)),
            ("lines_of_judges", Some(self.lines_of_judges)),
            ("test_programs", Some(self.test_binaries)),
            ("target_mb", target_mb.and_then(|mb| usize::try_from(mb).ok())),
        ]
    }
}

/// Measures the project in the working folder.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    let root = PathBuf::from(text_of(Command::new("git").args(["rev-parse", "--show-toplevel"]))?.trim());
    let metadata: Value = serde_json::from_str(&text_of(
        Command::new("cargo").args(["metadata", "--no-deps", "--format-version", "1"]).current_dir(&root),
    )?)?;
    let roots = imports::roots(&metadata, &root);
    let trees =
        roots.iter().map(|path| imports::Tree::read(&root, path)).collect::<anyhow::Result<Vec<_>>>()?;
    let of_tests: BTreeSet<PathBuf> = trees.iter().flat_map(imports::Tree::test_files).collect();
    let sources = sources(&root, &of_tests)?;
    let circles: Vec<imports::Circle> = trees.iter().flat_map(imports::Tree::circles).collect();
    let functions: Vec<&Function> = sources.iter().flat_map(|source| &source.functions).collect();
    let long_files: Vec<&Source> = sources.iter().filter(|source| source.lines > LONG_FILE).collect();
    let long_functions: Vec<&Function> =
        functions.iter().copied().filter(|function| function.lines > LONG_FUNCTION).collect();
    let flags: Vec<&Function> =
        functions.iter().flat_map(|function| std::iter::repeat_n(*function, function.flags)).collect();
    let (test_binaries, test_binaries_with_vpost) = test_binaries(&metadata);
    let target = PathBuf::from(metadata["target_directory"].as_str().context("no target directory")?);
    let house = House {
        lines_of_code: Split {
            code: sources.iter().map(|source| source.code).sum(),
            tests: sources.iter().map(|source| source.test_code).sum(),
        },
        files: Split::of(&sources, |source| source.is_test),
        files_above_500_lines: Split::of(&long_files, |source| source.is_test),
        functions: Split::of(&functions, |function| function.is_test),
        functions_above_80_lines: Split::of(&long_functions, |function| function.is_test),
        bool_parameters: Split::of(&flags, |function| function.is_test),
        lines_above_120_columns: sources.iter().map(|source| source.wide).sum(),
        lines_of_scripts: lines(&root, &["crates/*.js", "editors/*.js", "crates/*.css"], "//")?,
        lines_of_judges: lines(&root, &["tests/*.py", "tests/*.mjs"], "#")?,
        files_in_circles: circles.iter().map(|circle| circle.files.len()).sum(),
        circles: circles.len(),
        test_binaries,
        test_binaries_with_vpost,
        target_mb: target.exists().then(|| megabytes(&target)).transpose()?,
        clone_to_green: options.time.then(|| clone_to_green(&root)).transpose()?,
    };
    let root = &root;
    if options.write || !options.raise.is_empty() {
        return ratchet::write(root, &house.limited(), &options.raise);
    }
    if options.check {
        unnamed_tests(root, &sources, &metadata)?;
        return ratchet::check(root, &house.limited());
    }
    if options.json {
        return Ok(serde_json::to_string_pretty(&house)? + "\n");
    }
    let mut text = page(&house);
    if options.list {
        let name = |function: &&Function| format!("{}: `{}`", function.place, function.name);
        text += &list(
            "Files above 500 lines",
            long_files.iter().map(|s| format!("{} {}", s.lines, s.path.display())),
        );
        text += &list(
            "Functions above 80 lines",
            long_functions.iter().map(|function| format!("{} {}", function.lines, name(function))),
        );
        text += &list("`bool` parameters", flags.iter().map(name));
        let heads = circles.iter().map(|circle| {
            let files = circle.files.iter().map(|path| path.display().to_string());
            files.collect::<Vec<_>>().join(", ")
        });
        text += &list("Circles", heads);
        let lines = circles.iter().flat_map(|circle| &circle.imports).map(|import| {
            format!("{} → {}: {}", import.from.display(), import.to.display(), import.names.join(", "))
        });
        text += &list("What closes the circles", lines);
    }
    Ok(text)
}

fn page(house: &House) -> String {
    let split =
        |name: &str, split: &Split| vec![name.to_owned(), split.code.to_string(), split.tests.to_string()];
    let alone = |name: &str, value: String| vec![name.to_owned(), value, String::new()];
    let mut rows = vec![
        split("lines of code", &house.lines_of_code),
        split("files", &house.files),
        split("files above 500 lines", &house.files_above_500_lines),
        split("functions", &house.functions),
        split("functions above 80 lines", &house.functions_above_80_lines),
        split("`bool` parameters", &house.bool_parameters),
        alone("lines above 120 columns", house.lines_above_120_columns.to_string()),
        alone("lines of scripts and styles of pages", house.lines_of_scripts.to_string()),
        vec!["lines of judges".to_owned(), String::new(), house.lines_of_judges.to_string()],
        alone("circles of files", format!("{} ({} files)", house.circles, house.files_in_circles)),
        vec![
            "test binaries".to_owned(),
            String::new(),
            format!("{} ({} link vpost)", house.test_binaries, house.test_binaries_with_vpost),
        ],
    ];
    if let Some(size) = house.target_mb {
        rows.push(alone("`target/` here", format!("{size} MB")));
    }
    if let Some(time) = &house.clone_to_green {
        let verdict = if time.passed { "clone to green" } else { "clone, tests FAILED" };
        rows.push(alone(verdict, format!("{} min {:02} s", time.seconds / 60, time.seconds % 60)));
        rows.push(alone("`target/` of the clone", format!("{} MB", time.target_mb)));
    }
    table(&["", "code", "tests"], &rows)
}

fn list(heading: &str, entries: impl Iterator<Item = String>) -> String {
    let lines: Vec<String> = entries.map(|entry| format!("- {entry}\n")).collect();
    format!("\n## {heading}\n\n{}", lines.concat())
}

/// Rust files that git knows or would take, measured.
fn sources(root: &Path, of_tests: &BTreeSet<PathBuf>) -> anyhow::Result<Vec<Source>> {
    let files = texts(root, &["*.rs"])?;
    files
        .iter()
        .map(|(path, text)| {
            let outside = ["tests", "benches", "examples"];
            let is_test = of_tests.contains(path)
                || path.components().any(|part| outside.iter().any(|name| part.as_os_str() == *name));
            Source::measure(path, text, is_test)
        })
        .collect()
}

/// The files that git knows or would take, by patterns, from the root.
fn texts(root: &Path, patterns: &[&str]) -> anyhow::Result<Vec<(PathBuf, String)>> {
    let names = text_of(
        Command::new("git")
            .args(["ls-files", "--cached", "--others", "--exclude-standard", "-z"])
            .args(patterns)
            .current_dir(root),
    )?;
    let there = names.split('\0').filter(|name| !name.is_empty() && root.join(name).exists());
    there
        .map(|name| {
            let text =
                std::fs::read_to_string(root.join(name)).with_context(|| format!("{name}: unreadable"))?;
            Ok((PathBuf::from(name), text))
        })
        .collect()
}

/// Lines of files in another language that say something; `comment` begins one that says nothing to a machine.
fn lines(root: &Path, patterns: &[&str], comment: &str) -> anyhow::Result<usize> {
    let says = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with(comment);
    Ok(texts(root, patterns)?.iter().map(|(_, text)| text.lines().filter(says).count()).sum())
}

/// A file of tests that no test program names would never run, and nothing would say so.
fn unnamed_tests(root: &Path, sources: &[Source], metadata: &Value) -> anyhow::Result<()> {
    let programs = metadata.to_string();
    let unnamed = |path: &&Path| {
        let (Some(folder), Some(name)) = (path.parent(), path.file_stem().and_then(OsStr::to_str)) else {
            return false;
        };
        let whole = std::fs::read_to_string(root.join(folder).join("whole.rs")).unwrap_or_default();
        folder.file_name() == Some(OsStr::new("tests"))
            && !path.iter().any(|part| part == "src")
            && !programs.contains(&format!("/{}\"", path.display()))
            && !whole.lines().any(|line| line == format!("mod {name};"))
    };
    let unnamed = sources.iter().map(|source| source.path.as_path()).filter(unnamed);
    let unnamed: Vec<String> = unnamed.map(|path| path.display().to_string()).collect();
    if unnamed.is_empty() {
        return Ok(());
    }
    bail!("no test program names {}: write `mod` for it in the whole.rs beside it", unnamed.join(", "))
}

/// Programs that `cargo test` builds beside those of unit tests, and how many of them link the whole command.
fn test_binaries(metadata: &Value) -> (usize, usize) {
    let count = |package: &Value| {
        let targets = package["targets"].as_array().map_or(&[][..], Vec::as_slice);
        targets.iter().filter(|target| target["kind"][0] == "test").count()
    };
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    let with_vpost = packages.iter().filter(|package| package["name"] == "vpost").map(count).sum();
    (packages.iter().map(count).sum(), with_vpost)
}

fn clone_to_green(root: &Path) -> anyhow::Result<CloneToGreen> {
    let folder = tempfile::tempdir()?;
    let clone = folder.path().join("clone");
    let begun = Instant::now();
    text_of(Command::new("git").args(["clone", "--quiet"]).arg(root).arg(&clone))?;
    let status = Command::new("cargo")
        .args(["test", "--workspace", "--quiet"])
        .current_dir(&clone)
        .env_remove("CARGO_TARGET_DIR")
        .stdout(std::io::stderr())
        .status()?;
    let seconds = begun.elapsed().as_secs();
    Ok(CloneToGreen { seconds, passed: status.success(), target_mb: megabytes(&clone.join("target"))? })
}

/// What a folder takes on the disk; what has two names once.
fn megabytes(folder: &Path) -> anyhow::Result<u64> {
    let said = text_of(Command::new("du").arg("-sk").arg(folder))?;
    let kilobytes: u64 = said.split_whitespace().next().context("du says nothing")?.parse()?;
    Ok(kilobytes / 1024)
}

pub(crate) fn text_of(command: &mut Command) -> anyhow::Result<String> {
    let output = command.output().with_context(|| format!("{command:?} does not start"))?;
    if !output.status.success() {
        bail!("{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(String::from_utf8(output.stdout)?)
}
