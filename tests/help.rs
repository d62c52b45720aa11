//! The help of each command: what it reads, on one screen.

use crate::common::{messages, run};

const COMMANDS: [&str; 23] = [
    "",
    "correct",
    "batch",
    "batch plan",
    "batch run",
    "batch merge",
    "check",
    "predict",
    "solve",
    "calibrate",
    "calibrate tracker",
    "calibrate interferometer",
    "calibrate volumetric",
    "calibrate ballbar",
    "calibrate turning",
    "diagnose",
    "map",
    "budget",
    "profile",
    "profile export",
    "grammar",
    "explain",
    "completions",
];

fn help(command: &str) -> String {
    let words: Vec<&str> = command.split_whitespace().chain(["--help"]).collect();
    let ran = run(&words);
    assert!(ran.status.success(), "{command}: {}", messages(&ran));
    String::from_utf8(ran.stdout).expect("text")
}

/// All commands, those below others too.
pub(crate) fn every_command() -> Vec<String> {
    let mut all = vec![String::new()];
    let mut at = 0;
    while at < all.len() {
        let above = all[at].clone();
        all.extend(
            crate::docs::subcommands(&help(&above))
                .iter()
                .map(|name| format!("{above} {name}").trim().to_owned()),
        );
        at += 1;
    }
    all
}

/// 80 characters by 50 lines, in both languages.
#[test]
fn it_fits_a_screen() {
    let commands = every_command();
    assert!(COMMANDS.iter().all(|known| commands.iter().any(|command| command == known)), "{commands:?}");
    let mut wrong = Vec::new();
    for command in &commands {
        for language in ["en", "ru"] {
            let words: Vec<&str> = command.split_whitespace().chain(["--help", "--lang", language]).collect();
            let page = String::from_utf8(run(&words).stdout).expect("text");
            let (lines, width) =
                (page.lines().count(), page.lines().map(|line| line.chars().count()).max().unwrap_or(0));
            if lines > 50 || width > 80 || lines < 3 {
                wrong.push(format!("{command} ({language}): {width} by {lines}"));
            }
        }
    }
    assert!(commands.len() > 28 && wrong.is_empty(), "{} commands: {wrong:#?}", commands.len());
}

/// What a command does not read it neither lists nor takes.
#[test]
fn no_option_is_ignored() {
    let options = [
        ("--strict", None),
        ("--tolerance", Some("2")),
        ("--start-at", Some("0,0,0")),
        ("--set", Some("#1=2")),
        ("--outside", Some("clamp")),
        ("--at", Some("temp_c=20")),
        ("-m", Some("machine-profiles/stan_s500.toml")),
    ];
    let mut ignored = 0;
    for command in ["solve", "map", "budget", "diagnose", "profile check", "grammar list", "explain"] {
        let listed = help(command);
        for (option, value) in options {
            if listed.contains(option) {
                continue;
            }
            ignored += 1;
            let place = match command {
                "map" | "budget" | "grammar list" => None,
                _ => Some("x"),
            };
            let words = command.split_whitespace().chain([option]).chain(value).chain(place);
            let ran = run(&words.collect::<Vec<_>>());
            let said = messages(&ran);
            assert_eq!(ran.status.code(), Some(2), "{command} {option}: {said}");
            assert!(said.contains("does not read"), "{command} {option}: {said}");
        }
    }
    assert!(ignored > 20, "only {ignored} cases");
}

/// Points and rows are no programs: what is said of programs is refused there, with what would make it of use.
#[test]
fn what_is_read_only_elsewhere_is_refused() {
    for (command, needs) in
        [("predict samples/points/table_4_9_targets.csv", "--lathe"), ("diagnose", "--plan program")]
    {
        let place = if command == "diagnose" { "diagnose samples/diagnosis/backlash.csv" } else { command };
        for option in ["--dialect=fanuc", "--work-offset=G54=1,2,3"] {
            let words: Vec<&str> =
                place.split(' ').chain(["-m", "machine-profiles/stan_s500.toml", option]).collect();
            let ran = run(&words);
            let said = messages(&ran);
            assert_eq!(ran.status.code(), Some(2), "{words:?}: {said}");
            let name = option.split('=').next().unwrap_or_default();
            assert!(said.contains(&format!("does not read `{name}` without `{needs}`")), "{said}");
            let russian = messages(&run(&[&words[..], &["--lang", "ru"]].concat()));
            assert!(russian.contains(&format!("не читает `{name}` без `{needs}`")), "{russian}");
        }
    }
}

#[test]
fn options_may_stand_before_the_command() {
    const POINTS: &str = "samples/points/table_4_9_targets.csv";
    const PROFILE: &str = "machine-profiles/stan_s500.toml";
    let before = run(&["-m", PROFILE, "-q", "solve", POINTS]);
    let behind = run(&["solve", POINTS, "-m", PROFILE, "-q"]);
    assert!(before.status.success(), "{}", messages(&before));
    assert_eq!(before.stdout, behind.stdout);
    // Those of the main job are no options of another.
    let stray = run(&["-o", "x.nc", "-m", PROFILE, "check", "a.nc", "b.nc"]);
    assert_eq!(stray.status.code(), Some(2));
    assert!(messages(&stray).contains("`vpost check` does not read `--output`"), "{}", messages(&stray));
}

#[test]
fn the_main_job_has_a_name() {
    const PROGRAM: &str = "samples/plate_linuxcnc.nc";
    const PROFILE: &str = "machine-profiles/stan_s500.toml";
    let [named, unnamed] = [vec!["correct", PROGRAM], vec![PROGRAM]]
        .map(|words| run(&[words.as_slice(), &["-m", PROFILE, "-d", "linuxcnc"]].concat()));
    assert!(named.status.success() && !named.stdout.is_empty(), "{}", messages(&named));
    assert_eq!(named.stdout, unnamed.stdout);
}

#[test]
fn alone_it_shows_what_there_is() {
    let ran = run(&[]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(messages(&ran).contains("Commands:") && messages(&ran).contains("vpost correct --help"));
    let russian = crate::common::vpost().env("LC_ALL", "ru_RU.UTF-8").output().expect("it starts");
    let said = messages(&russian);
    assert!(russian.status.code() == Some(2) && said.contains("Команды:"), "{said}");
    assert!(said.contains("vpost correct --help"), "{said}");
}

#[test]
fn every_message_is_explained() {
    let page = std::fs::read_to_string(crate::common::root().join("docs/diagnostics.md")).expect("readable");
    let codes: Vec<&str> =
        page.lines().filter_map(|line| line.strip_prefix("### ")?.split(' ').next()).collect();
    assert!(codes.len() > 80);
    for code in codes {
        let ran = run(&["explain", code]);
        let text = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.success() && text.starts_with(code) && !text.contains("```"), "{code}: {text}");
    }
    let unknown = run(&["explain", "VP9999"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(messages(&unknown).contains("there is no message `VP9999`"));
}

/// The entries of a page of messages: number, and what is written up to the next heading.
fn entries(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("\n### ").skip(1);
    parts.map(|part| (&part[..6], part.split("\n## ").next().unwrap_or(part))).collect()
}

/// Three Latin words in a row that are not in backquotes.
fn latin_sentence(text: &str) -> Option<String> {
    let prose: Vec<&str> = text.split('`').step_by(2).collect();
    let words: Vec<String> = prose.join(" | ").split_whitespace().map(str::to_owned).collect();
    let latin = |word: &String| {
        let word = word.trim_matches(|c: char| c.is_ascii_punctuation() && c != '|');
        word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase())
    };
    words.windows(3).find(|three| three.iter().all(latin)).map(|three| three.join(" "))
}

#[test]
fn messages_are_explained_in_russian() {
    let root = crate::common::root();
    let [english, russian] = ["docs/diagnostics.md", "docs/diagnostics.ru.md"]
        .map(|page| std::fs::read_to_string(root.join(page)).expect("readable"));
    let translated = entries(&russian);
    let codes = |page: &str| entries(page).iter().map(|(code, _)| (*code).to_owned()).collect::<Vec<_>>();
    assert_eq!(codes(&russian), codes(&english));
    for (code, entry) in &translated {
        let cyrillic = entry.chars().filter(|c| ('а'..='я').contains(c)).count();
        assert!(cyrillic > 40, "{code}: {entry}");
        assert_eq!(latin_sentence(entry), None, "{code}");
        let ran = run(&["explain", code, "--lang", "ru"]);
        assert_eq!(String::from_utf8_lossy(&ran.stdout).trim_end(), entry.trim_end());
    }
    assert_eq!(latin_sentence("Это `a b c` и the file is тут").as_deref(), Some("the file is"));
    let whole = |arguments: &[&str], locale: &str| {
        let mut command = crate::common::vpost();
        command.env_remove("LC_MESSAGES").env_remove("LANG").env("LC_ALL", locale);
        String::from_utf8(command.args(arguments).output().expect("it starts").stdout).expect("text")
    };
    assert!(whole(&["explain", "VP0509"], "ru_RU.UTF-8").contains("люфта"));
    assert!(whole(&["explain", "VP0509"], "POSIX").contains("play"));
    assert!(whole(&["explain", "VP0509", "--lang", "en"], "ru_RU.UTF-8").contains("play"));
    let wrong = run(&["explain", "VP0509", "--lang", "russian"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        messages(&wrong).contains("VP0002") && messages(&wrong).contains("`--lang ru`"),
        "{}",
        messages(&wrong)
    );
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let to = folder.path().join("new/man1");
    let ran = run(&["man", "-O", to.to_str().expect("UTF-8")]);
    assert!(ran.status.success() && ran.stdout.is_empty(), "{}", messages(&ran));
    let mut pages = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(&to).expect("made") {
        let path = entry.expect("readable").path();
        let name = path.file_stem().expect("a name").to_str().expect("UTF-8").to_owned();
        pages.insert(name, std::fs::read_to_string(&path).expect("text"));
    }
    for command in COMMANDS {
        let name = ["vpost"].into_iter().chain(command.split_whitespace()).collect::<Vec<_>>().join("-");
        let page = pages.get(&name).unwrap_or_else(|| panic!("no page {name}"));
        // The empty date must stay, or `man` shows the version in its place.
        let title = format!(".TH \"{name}\" 1 \"\" \"vpost {}\"", env!("CARGO_PKG_VERSION"));
        assert!(page.starts_with(&title), "{name}: {}", page.lines().next().unwrap_or_default());
        // What the help lists, the page does: in roff a hyphen of an option is escaped.
        for option in help(command).split_whitespace().filter(|word| word.starts_with("--")) {
            let option = option.trim_end_matches([',', '.', ':', '`']).replace('-', "\\-");
            assert!(page.contains(&option) || command.is_empty(), "{name}: {option}");
        }
    }
    assert!(pages.len() > COMMANDS.len(), "{:?}", pages.keys());
    assert_eq!(String::from_utf8(run(&["man"]).stdout).expect("text"), pages["vpost"]);
}

#[test]
fn manual_pages_are_russian_where_it_is_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [english, russian] = ["en", "ru"].map(|language| {
        let to = folder.path().join(language);
        let ran = run(&["man", "-O", to.to_str().expect("UTF-8"), "--lang", language]);
        assert!(ran.status.success() && ran.stdout.is_empty(), "{}", messages(&ran));
        to
    });
    for entry in std::fs::read_dir(&english).expect("made") {
        let name = entry.expect("readable").file_name();
        let page = std::fs::read_to_string(russian.join(&name)).expect("a page in Russian too");
        for heading in page.lines().filter_map(|line| line.strip_prefix(".SH ")) {
            assert!(!heading.chars().any(|letter| letter.is_ascii_alphabetic()), "{name:?}: {heading}");
        }
        // `man -k` reads what stands behind this heading, `name \- description`.
        let named = page.split(".SH \"ИМЯ\"\n").nth(1).and_then(|rest| rest.split(".SH").next());
        let said = named.and_then(|section| section.split("\\- ").nth(1)).unwrap_or_default();
        let letters = said.chars().find(|letter| letter.is_alphabetic());
        assert!(letters.is_some_and(|letter| !letter.is_ascii()), "{name:?}: {said}");
    }
}
