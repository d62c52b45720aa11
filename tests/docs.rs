//! The documentation, held to what it says.
//!
//! Every `sh` block of the documents runs; a `text` block behind it is what that prints, byte for byte;
//! every option, message number, dependency and link in the documents exists, and every one that exists
//! is in the documents. How blocks are marked: `docs/testing.md`.

// The blocks are written for a POSIX shell.
#![cfg(unix)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use machine_model::effects::EffectKind;

use crate::common::{messages, root, run, vpost};

/// A fenced block of a document.
#[derive(Debug)]
pub(crate) struct Fence {
    /// Language and what follows it.
    info: String,
    pub(crate) text: String,
    pub(crate) line: usize,
    /// The heading above.
    pub(crate) heading: String,
}

impl Fence {
    pub(crate) fn language(&self) -> &str {
        self.info.split(' ').next().unwrap_or_default()
    }
    /// What stands behind the language.
    pub(crate) fn option(&self) -> &str {
        self.info.split_once(' ').map_or("", |(_, option)| option)
    }
}

pub(crate) fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The documents, relative to the root.
fn documents() -> Vec<String> {
    let mut found = vec!["README.md".to_owned(), "README.ru.md".to_owned(), "CONTRIBUTING.md".to_owned()];
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("docs are there") {
            let path = folder.join(entry.expect("a readable folder").file_name());
            if root().join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path.to_str().expect("a plain name").to_owned());
            }
        }
    }
    found.sort();
    found
}

pub(crate) fn fences(text: &str) -> Vec<Fence> {
    let mut found: Vec<Fence> = Vec::new();
    let mut open = false;
    let mut heading = String::new();
    for (at, line) in text.lines().enumerate() {
        if let Some(info) = line.strip_prefix("```") {
            open = !open;
            if open {
                let info = info.trim().to_owned();
                found.push(Fence { info, text: String::new(), line: at + 1, heading: heading.clone() });
            }
        } else if open {
            let fence = found.last_mut().expect("one is open");
            fence.text.push_str(line);
            fence.text.push('\n');
        } else if line.starts_with('#') {
            heading = line.trim_start_matches('#').trim().to_owned();
        }
    }
    assert!(!open, "a block is not closed");
    found
}

fn blocks_of<'f>(fences: &'f [Fence], language: &str) -> Vec<&'f Fence> {
    fences.iter().filter(|fence| fence.language() == language).collect()
}

/// A folder as a new user has it after a clone, without what would have to be built.
pub(crate) struct Clone {
    folder: tempfile::TempDir,
}

impl Clone {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["samples", "machine-profiles", "grammars", "tests/profiles"] {
            copy(&root().join(name), &folder.path().join("project").join(name));
        }
        Self::tools(folder.path());
        Self { folder }
    }

    /// A folder with the commands that the documents call, to stand first in `PATH`.
    pub(crate) fn tools(folder: &Path) -> PathBuf {
        let tools = folder.join("tools");
        std::fs::create_dir(&tools).expect("a new folder");
        let stub = "#!/bin/sh\nexec \"$VPOST_UNDER_TEST\" \"$@\"\n";
        let cargo = r#"#!/bin/sh
case "$*" in
  "run --release --quiet -- "*) shift 4; exec "$VPOST_UNDER_TEST" "$@" ;;
  test*) exit 0 ;; # these are the tests
  *) echo "this test does not know how to run: cargo $*" >&2; exit 99 ;;
esac
"#;
        for (name, text) in [("vpost", stub), ("cargo", cargo)] {
            write_executable(&tools.join(name), text);
        }
        tools
    }

    /// Runs a block: standard output, with standard error where it was written.
    ///
    /// A Russian page's reader has a Russian locale.
    fn run(&self, script: &str, document: &str) -> (Option<i32>, String) {
        let path = std::env::var("PATH").unwrap_or_default();
        let mut command = Command::new("bash");
        command.args(["-e", "-o", "pipefail", "-c", &format!("exec 2>&1\n{script}")]);
        command.current_dir(self.folder.path().join("project")).env_remove("NO_COLOR");
        // `LC_ALL` would have the shell look for the locale, which need not be installed.
        let locale = if document.ends_with(".ru.md") { "ru_RU.UTF-8" } else { "C" };
        command.env_remove("LC_ALL").env("LC_MESSAGES", locale);
        command.env("PATH", format!("{}:{path}", self.folder.path().join("tools").display()));
        command.env("VPOST_UNDER_TEST", env!("CARGO_BIN_EXE_vpost")).stdin(Stdio::null());
        let output: Output = command.output().expect("bash is there");
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

fn write_executable(path: &Path, text: &str) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::write(path, text).expect("a new file");
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).expect("our own file");
}

pub(crate) fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        std::fs::create_dir_all(to).expect("a new folder");
        for entry in std::fs::read_dir(from).expect("it is there") {
            let name = entry.expect("a readable folder").file_name();
            copy(&from.join(&name), &to.join(&name));
        }
    } else {
        std::fs::copy(from, to).expect("a copy");
    }
}

#[test]
fn every_command_of_the_documents_runs_and_prints_what_they_show() {
    let mut ran = 0;
    let mut shown = 0;
    let mut wrong = Vec::new();
    let update = std::env::var_os(UPDATE).is_some();
    for document in documents() {
        let text = read(&document);
        let fences = fences(&text);
        let mut new = Vec::new();
        if blocks_of(&fences, "sh").is_empty() {
            continue;
        }
        // One folder a document: later blocks use what earlier ones made.
        let clone = Clone::new();
        let mut printed: Option<(String, &Fence)> = None;
        for fence in &fences {
            match fence.language() {
                "sh" => {
                    let (status, output) = clone.run(&fence.text, &document);
                    ran += 1;
                    if status != Some(0) {
                        wrong.push(format!("{document}:{}: exit {status:?}\n{output}", fence.line));
                    }
                    printed = Some((output, fence));
                }
                "text" => {
                    if let Some((output, above)) = printed.take()
                        && above.heading == fence.heading
                    {
                        shown += 1;
                        if !same(&output, &fence.text) && update {
                            new.push((fence, output));
                        } else if !same(&output, &fence.text) {
                            wrong.push(format!(
                                "{document}:{}: shown is not what line {} prints:\n{output}",
                                fence.line, above.line
                            ));
                        }
                    }
                }
                _ => {}
            }
        }
        if !new.is_empty() {
            std::fs::write(root().join(&document), updated(&text, &new)).expect("a writable document");
        }
    }
    let hint = format!(
        "if that is how it should be: `{UPDATE}=1 cargo test -p vpost --test whole docs::`, and read the diff"
    );
    assert!(wrong.is_empty(), "{}\n{hint}", wrong.join("\n"));
    assert!(ran > 20 && shown > 10, "{ran} blocks ran and {shown} outputs were compared");
}

/// Commands of who changes vpost ask for hours, the network or root, and are not run: the shell reads them, and what they
/// name of the tree is there.
#[test]
fn commands_that_are_not_run_are_commands_and_name_what_there_is() {
    let (mut read_by_shell, mut named) = (0, 0);
    let mut wrong = Vec::new();
    for document in documents() {
        let text = read(&document);
        for fence in blocks_of(&fences(&text), "console") {
            let read = Command::new("bash").args(["-n", "-c", &fence.text]).output().expect("bash is there");
            read_by_shell += 1;
            let said = String::from_utf8_lossy(&read.stderr);
            if !said.is_empty() {
                wrong.push(format!("{document}:{}: {said}", fence.line));
            }
            let commands = fence.text.lines().map(|line| line.split('#').next().unwrap_or_default());
            for word in commands.flat_map(str::split_whitespace) {
                let of_the_tree = |folder: &&str| word.starts_with(&format!("{folder}/"));
                if ["tests", "crates", "docs", "samples", "machine-profiles", ".ci"].iter().any(of_the_tree) {
                    named += 1;
                    if !root().join(word).exists() {
                        wrong.push(format!("{document}:{}: there is no {word}", fence.line));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(read_by_shell > 10 && named > 15, "{read_by_shell} blocks, {named} files");
}

/// Of a script for somebody else's program its grammar is looked at, by the browser of the other tests.
#[test]
fn scripts_of_the_documents_are_read_by_an_interpreter() {
    let Some(mut browser) = crate::devtools::Browser::start() else { return };
    let mut found = 0;
    for document in documents() {
        let text = read(&document);
        for fence in blocks_of(&fences(&text), "javascript") {
            let script = serde_json::Value::from(fence.text.clone());
            let said = browser
                .evaluate(&format!("try {{ new Function({script}); \"\" }} catch (e) {{ String(e) }}"));
            assert_eq!(said, "", "{document}:{}", fence.line);
            found += 1;
        }
    }
    let said = browser.evaluate("try { new Function(\"f(\"); \"\" } catch (e) { String(e) }");
    assert_ne!(said, "", "it finds what is wrong");
    assert!(found > 1, "{found} scripts");
    browser.end();
}

/// Set, the documents take what their commands print.
const UPDATE: &str = "VPOST_UPDATE_DOCS";

/// The document with other texts in some of its blocks.
fn updated(text: &str, new: &[(&Fence, String)]) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    for (fence, output) in new.iter().rev() {
        // `line` counts from 1 and is the opening fence's.
        let old = fence.line..fence.line + fence.text.lines().count();
        lines.splice(old, output.trim_end().lines().map(str::trim_end));
    }
    lines.join("\n") + "\n"
}

#[test]
fn updated_blocks_replace_their_lines_only() {
    let text = "a\n```text\nold\nolder\n```\nb\n```text\nkept\n```\n";
    let fences = fences(text);
    let new = updated(text, &[(&fences[0], "new \n".to_owned()), (&fences[1], "1\n2\n".to_owned())]);
    assert_eq!(new, "a\n```text\nnew\n```\nb\n```text\n1\n2\n```\n");
}

/// Equal, spaces at line ends apart; a line `...` stands for any lines.
fn same(printed: &str, shown: &str) -> bool {
    let trimmed = |text: &str| text.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>();
    let printed = trimmed(printed.trim_end());
    let shown = trimmed(shown.trim_end());
    let parts: Vec<&[String]> = shown.split(|line| line == "...").collect();
    let mut at = 0;
    for (k, part) in parts.iter().enumerate() {
        let first = k == 0;
        let last = k + 1 == parts.len();
        let found = (at..=printed.len().saturating_sub(part.len())).find(|from| {
            printed[*from..].starts_with(part)
                && (!first || *from == 0)
                && (!last || from + part.len() == printed.len())
        });
        match found {
            Some(from) => at = from + part.len(),
            None => return false,
        }
    }
    true
}

#[test]
fn comparison_of_outputs_can_fail() {
    assert!(same("a \nb\n", "a\nb\n"));
    assert!(same("a\nb\nc\nd\n", "a\n...\nd\n"));
    assert!(same("a\nb\n", "...\nb\n"));
    assert!(!same("a\nb\n", "a\n"));
    assert!(!same("a\nb\nc\n", "a\n...\nb\n"));
    assert!(!same("a\n", "a\n...\nb\n"));
}

#[test]
fn the_first_two_blocks_of_the_readme_are_the_two_commands() {
    let text = read("README.md");
    let fences = fences(&text);
    let shell = blocks_of(&fences, "sh");
    assert!(shell[0].text.starts_with("cargo run --release --quiet -- samples/"), "{}", shell[0].text);
    assert_eq!(shell[0].text.lines().count(), 1, "one command builds and corrects");
    assert_eq!(shell[1].text, "cargo test --workspace\n");
    // Other blocks that a reader of the first two may take for commands must not come before.
    let before: Vec<&str> =
        fences.iter().map(Fence::language).take_while(|language| *language != "sh").collect();
    assert!(
        before.iter().all(|language| !matches!(*language, "" | "bash" | "console" | "shell")),
        "{before:?}"
    );
}

/// The pages that exist in both languages: English, Russian.
fn pairs() -> Vec<(String, String)> {
    let english =
        |page: &String| page.strip_suffix(".ru.md").map(|name| (format!("{name}.md"), page.clone()));
    documents().iter().filter_map(english).collect()
}

#[test]
fn every_how_to_is_there_in_russian_and_they_lead_to_each_other() {
    let pairs = pairs();
    let mut wrong = Vec::new();
    for page in
        documents().iter().filter(|page| page.starts_with("docs/how-to/") && !page.ends_with(".ru.md"))
    {
        if !pairs.iter().any(|(english, _)| english == page) {
            wrong.push(format!("{page} has no Russian page"));
        }
    }
    let name = |page: &str| page.rsplit('/').next().unwrap_or_default().to_owned();
    for (english, russian) in &pairs {
        for (page, other) in [(english, russian), (russian, english)] {
            // Behind the title, where its reader looks for it.
            let top: String = read(page).lines().take(14).collect();
            if !top.contains(&format!("]({})", name(other))) {
                wrong.push(format!("{page} does not lead to {other}"));
            }
        }
        // A Russian reader is led to Russian pages, where there are any.
        let text = read(russian);
        for (linked, twin) in &pairs {
            let links = ["/", "]("].map(|before| format!("{before}{})", name(linked)));
            if linked != english && links.iter().any(|link| text.contains(link)) {
                wrong.push(format!("{russian} leads to {linked} instead of {twin}"));
            }
        }
    }
    assert!(pairs.len() > 15 && wrong.is_empty(), "{} pairs\n{}", pairs.len(), wrong.join("\n"));
}

#[test]
fn russian_pages_have_the_same_commands_and_pictures() {
    for (english, russian) in pairs() {
        // `help::` holds the pages of messages against each other: their examples stand in the English one.
        if english == "docs/diagnostics.md" {
            continue;
        }
        let blocks = |name: &str| {
            // What is printed is in the reader's language.
            let kept = |fence: &Fence| {
                let text = if fence.language() == "text" { String::new() } else { fence.text.clone() };
                (fence.info.clone(), text)
            };
            fences(&read(name)).iter().map(kept).collect::<Vec<_>>()
        };
        assert_eq!(blocks(&english), blocks(&russian), "{russian}");
        let pictures = |name: &str| read(name).matches("img/").count();
        assert_eq!(pictures(&english), pictures(&russian), "{russian}");
    }
}

#[test]
fn lines_of_prose_have_at_most_120_characters() {
    let others = [
        "CHANGELOG.md",
        "samples/README.md",
        "samples/diagnosis/README.md",
        "samples/real-machines/README.md",
        "xtask/src/gap_bench/rules.md",
    ];
    let mut pages: Vec<String> = documents().into_iter().chain(others.map(str::to_owned)).collect();
    pages.retain(|page| {
        let text = read(page);
        text != crate::wrap::wrapped(&text)
    });
    assert!(pages.is_empty(), "`cargo xtask wrap {}` breaks their long lines", pages.join(" "));
}

#[test]
fn links_lead_somewhere() {
    let mut dead = Vec::new();
    for document in documents() {
        let text = read(&document);
        let folder = root().join(&document).parent().expect("a folder").to_path_buf();
        let mut inside = false;
        for (at, line) in text.lines().enumerate() {
            inside ^= line.starts_with("```");
            if inside {
                continue;
            }
            for part in line.split("](").skip(1) {
                let target = part.split(')').next().unwrap_or_default();
                let file = target.split('#').next().unwrap_or_default();
                if !file.is_empty() && !file.contains("://") && !folder.join(file).exists() {
                    dead.push(format!("{document}:{}: {target}", at + 1));
                }
            }
        }
    }
    assert!(dead.is_empty(), "{dead:#?}");
}

// ---- docs/reference.md -------------------------------------------------------------------------------

/// Long options that a help text or a document line names first: `--json`, `-o, --output <FILE>`.
fn first_option(line: &str) -> Option<String> {
    let start = line.find("--")?;
    let name: String = line[start..]
        .chars()
        .take_while(|c| *c == '-' || c.is_ascii_lowercase() || c.is_ascii_digit())
        .collect();
    (name.len() > 2).then_some(name)
}

fn help(command: &[&str]) -> String {
    let output = vpost().args(command).arg("--help").output().expect("the command starts");
    assert!(output.status.success(), "{command:?}: {}", messages(&output));
    String::from_utf8(output.stdout).expect("text")
}

/// The names below `Commands:`.
pub(crate) fn subcommands(help: &str) -> Vec<String> {
    help.lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  "))
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split(' ').next())
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

pub(crate) fn options(help: &str) -> BTreeSet<String> {
    help.lines()
        .filter(|line| line.trim_start().starts_with('-') && line.starts_with("  ") && !line.contains("- "))
        .filter_map(first_option)
        .filter(|name| name != "--help" && name != "--version")
        .collect()
}

#[test]
fn the_reference_has_every_command_and_option_and_no_other() {
    let reference = read("docs/reference.md");
    // Heading → options of the tables below it.
    let mut documented: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut section = String::new();
    for line in reference.lines() {
        if line.starts_with('#') {
            section = line.trim_start_matches('#').trim().trim_matches('`').to_owned();
            documented.entry(section.clone()).or_default();
        } else if let Some(option) = line.strip_prefix("| `-").and_then(|_| first_option(line)) {
            documented.entry(section.clone()).or_default().insert(option);
        }
    }
    let shared = documented.get("Shared options").expect("a section on shared options").clone();
    let mut commands: Vec<Vec<String>> = vec![vec![]];
    let mut at = 0;
    while at < commands.len() {
        let command = commands[at].clone();
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let text = help(&words);
        for name in subcommands(&text) {
            let mut next = command.clone();
            next.push(name);
            commands.push(next);
        }
        if words.is_empty() {
            // The first screen lists commands; the main job's options are those of its name.
            at += 1;
            continue;
        }
        let title = match words.join(" ").as_str() {
            "correct" => "vpost IN.nc".to_owned(),
            words => format!("vpost {words}"),
        };
        let described = documented.remove(&title);
        let all = described.unwrap_or_else(|| panic!("docs/reference.md has no section `{title}`"));
        // Of the shared ones each lists what it reads.
        let own: BTreeSet<String> = options(&text).difference(&shared).cloned().collect();
        assert_eq!(own, all, "options of `{title}`: left is --help, right is docs/reference.md");
        at += 1;
    }
    let left: Vec<&String> = documented.keys().filter(|title| title.starts_with("vpost ")).collect();
    assert!(left.is_empty(), "docs/reference.md has sections of commands that do not exist: {left:?}");
}

/// The names of all properties in a JSON Schema.
fn properties(schema: &serde_json::Value, names: &mut BTreeSet<String>) {
    match schema {
        serde_json::Value::Object(map) => {
            if let Some(serde_json::Value::Object(own)) = map.get("properties") {
                names.extend(own.keys().cloned());
            }
            map.values().for_each(|value| properties(value, names));
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| properties(value, names)),
        _ => {}
    }
}

#[test]
fn the_reference_has_every_key_of_a_profile_and_its_example_is_one() {
    let reference = read("docs/reference.md");
    let schema: serde_json::Value =
        serde_json::from_slice(&run(&["profile", "schema"]).stdout).expect("a JSON Schema");
    let mut names = BTreeSet::new();
    properties(&schema, &mut names);
    assert!(names.len() > 30, "{names:?}");
    let missing: Vec<&String> = names.iter().filter(|name| !reference.contains(name.as_str())).collect();
    assert!(missing.is_empty(), "docs/reference.md lacks {missing:?}");

    let fences = fences(&reference);
    let example = blocks_of(&fences, "toml")[0];
    let clone = Clone::new();
    let project = clone.folder.path().join("project");
    std::fs::write(project.join("example.toml"), &example.text).expect("a writable folder");
    std::fs::write(project.join("errors_x.csv"), "position_mm,EXX_um\n0,0\n1000,5\n").expect("the same");
    let (status, output) = clone.run("vpost profile check example.toml", "docs/reference.md");
    assert_eq!(status, Some(0), "{output}");
}

#[test]
fn the_reference_has_every_effect_with_its_parameters() {
    let reference = read("docs/reference.md");
    let mut missing = Vec::new();
    for kind in EffectKind::all() {
        let family = kind.family();
        // Its members' row, rather than an engine of the same name.
        let row_of = |start: String| reference.lines().find(|line| line.starts_with(&start));
        let row = row_of(format!("| `{family}."))
            .or_else(|| row_of(format!("| `{family}`")))
            .unwrap_or_else(|| panic!("docs/reference.md has no effect {family}"));
        let names = kind.coefficient_names().iter().copied().chain(kind.shape_names());
        missing.extend(
            names.filter(|name| !row.contains(&format!("`{name}`"))).map(|name| format!("{kind}: {name}")),
        );
    }
    assert!(missing.is_empty(), "{missing:?}");
}

// ---- docs/diagnostics.md -----------------------------------------------------------------------------

/// Numbers of `Code(123)` in the sources of all crates.
fn codes_in_sources() -> BTreeSet<u16> {
    let mut codes = BTreeSet::new();
    let mut folders = vec![root().join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("it is there") {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                // Tests of the crates make codes up.
                if !path.ends_with("tests") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).expect("a readable file");
                let text = text.split("#[cfg(test)]").next().unwrap_or_default();
                codes.extend(codes_of(text));
            }
        }
    }
    codes
}

fn codes_of(text: &str) -> BTreeSet<u16> {
    let mut codes = BTreeSet::new();
    for (at, _) in text.match_indices("Code(") {
        let whole = !text[..at].ends_with(|c: char| c.is_alphanumeric());
        let digits: String = text[at + 5..].chars().take_while(|c| c.is_ascii_digit()).collect();
        if let (true, Ok(code)) = (whole, digits.parse()) {
            codes.insert(code);
        }
    }
    // Where the number is chosen first: lines that are a number alone.
    if text.contains("Code(code)") {
        codes.extend(text.lines().filter_map(|line| line.trim().strip_suffix(',')?.parse::<u16>().ok()));
    }
    codes
}

#[test]
fn every_message_number_has_an_entry_and_every_entry_a_message() {
    let page = read("docs/diagnostics.md");
    let mut entries = BTreeSet::new();
    for line in page.lines().filter_map(|line| line.strip_prefix("### VP")) {
        let code: u16 = line[..4].parse().expect("four digits");
        assert!(entries.insert(code), "VP{code:04} has two entries");
        assert!(line.len() > 10, "VP{code:04} has no title");
    }
    let used = codes_in_sources();
    assert!(used.len() > 60, "{} codes were found: the search is broken", used.len());
    let show = |codes: Vec<&u16>| codes.iter().map(|code| format!("VP{code:04}")).collect::<Vec<_>>();
    let missing = show(used.difference(&entries).collect());
    let stale = show(entries.difference(&used).collect());
    assert!(missing.is_empty() && stale.is_empty(), "no entry: {missing:?}; no such message: {stale:?}");
}

/// Each example below an entry is given to the command, which must answer with that number, in Russian too.
///
/// `nc D`: a program of dialect D for the STAN S500 or for the profile that is named with further options behind it; `toml`: a profile;
/// `csv predict`, `csv diagnose`: a file for that job.
#[test]
fn the_examples_of_messages_cause_them() {
    let page = read("docs/diagnostics.md");
    let clone = Clone::new();
    let project = clone.folder.path().join("project");
    let mut tried = 0;
    let mut wrong = Vec::new();
    for fence in fences(&page) {
        let Some(code) = fence.heading.strip_prefix("VP").map(|title| format!("[VP{}]", &title[..4])) else {
            continue;
        };
        let (file, job) = match fence.language() {
            "nc" => {
                let options = fence.option();
                let machine =
                    if options.contains(" -m ") { "" } else { " -m machine-profiles/stan_s500.toml" };
                ("example.nc", format!("vpost example.nc{machine} -d {options}"))
            }
            "toml" => ("example.toml", "vpost profile check example.toml".to_owned()),
            "csv" => (
                "example.csv",
                format!("vpost {} example.csv -m machine-profiles/stan_s500.toml", fence.option()),
            ),
            _ => continue,
        };
        std::fs::write(project.join(file), &fence.text).expect("a writable folder");
        let (_, output) = clone.run(&job, "docs/diagnostics.md");
        tried += 1;
        if !output.contains(&code) {
            wrong.push(format!("docs/diagnostics.md:{}: no {code} but\n{output}", fence.line));
        }
        let (_, russian) = clone.run(&format!("{job} --lang ru"), "docs/diagnostics.md");
        if let Some(fault) = crate::russian::fault(&output, &russian) {
            wrong.push(format!("docs/diagnostics.md:{}: in Russian {fault}\n{russian}", fence.line));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(tried > 40, "only {tried} examples were found");
}

// ---- docs/dependencies.md ----------------------------------------------------------------------------

#[test]
fn every_dependency_has_its_reason() {
    let workspace: toml::Table = read("Cargo.toml").parse().expect("TOML");
    let table = workspace["workspace"]["dependencies"].as_table().expect("a table");
    let taken: BTreeSet<&str> = table
        .iter()
        .filter(|(_, value)| value.get("path").is_none())
        .map(|(name, _)| name.as_str())
        .collect();
    let page = read("docs/dependencies.md");
    let section = page.split("\n## ").find(|part| part.starts_with("Taken")).expect("a section `Taken`");
    let explained: BTreeSet<&str> =
        section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    assert_eq!(taken, explained, "left is Cargo.toml, right is docs/dependencies.md");
}

// ---- others ------------------------------------------------------------------------------------------

#[test]
fn every_engine_of_the_readme_exists() {
    let text = read("README.md");
    let none = run(&["samples/plate_linuxcnc.nc", "-m", "machine-profiles/stan_s500.toml", "-e", "none"]);
    let known = messages(&none);
    let engines: Vec<&str> = text
        .split("\n## ")
        .find(|part| part.starts_with("Engines"))
        .expect("a section on engines")
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
        .collect();
    assert!(engines.len() >= 6, "{engines:?}");
    for engine in engines {
        assert!(known.contains(engine), "{engine} is not in: {known}");
    }
}

/// What a crate is compiled of must be packed with it: a published one has no clone around it.
#[test]
fn no_source_includes_what_lies_outside_its_crate() {
    let mut folders = vec![root().join("crates")];
    let (mut files, mut outside) = (0, Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("readable") {
            let path = entry.expect("readable").path();
            if path.is_dir() && !path.is_symlink() && !path.ends_with("tests") {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                files += 1;
                let text = std::fs::read_to_string(&path).expect("text");
                let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                let includes = code.filter(|line| line.contains("include_") && line.contains("\"../"));
                outside.extend(includes.map(|line| format!("{}: {}", path.display(), line.trim())));
            }
        }
    }
    assert!(files > 200, "{files} sources");
    assert!(outside.is_empty(), "{outside:#?}");
    // What is taken from above in a clone is inside too, once the crate is packed.
    let links = [
        "crates/nc-dialect/grammars/fanuc.toml",
        "crates/vpost/diagnostics.md",
        "crates/vpost/diagnostics.ru.md",
    ];
    for link in links {
        if cfg!(unix) {
            assert!(read(link).len() > 1000, "{link}");
        }
    }
}
