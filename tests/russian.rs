//! What is said in Russian is all Russian, and says the same as the English.

use crate::common::{files, messages, root, run};

const DIALECTS: [&str; 6] = ["fanuc", "perspektiva", "linuxcnc", "balt-system", "sinumerik", "centroid"];
const PROFILE: &str = "tests/profiles/corpus.toml";

/// What people read of a message: its lines without those of the program and without what stands in backticks.
fn words(said: &str) -> String {
    let quoted = |line: &str| {
        let line = line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
        line.starts_with("| ") && !line.contains('^') || line.starts_with("--> ")
    };
    let lines = said.lines().filter(|line| !quoted(line) && !line.trim_start().starts_with("-->"));
    let text = lines.collect::<Vec<_>>().join("\n");
    text.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// The first three Latin words in a row that are no codes, names in capitals, keys, options or paths.
fn latin_sentence(text: &str) -> Option<String> {
    let is_prose = |word: &&str| {
        let word = word.trim_matches(|c: char| c.is_ascii_punctuation() || c == '«' || c == '»');
        word.len() > 1
            && word.bytes().all(|byte| byte.is_ascii_alphabetic() || byte == b'\'')
            && !word.bytes().all(|byte| byte.is_ascii_uppercase())
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    // A list of keys or units is no sentence.
    let goes_on = |three: &&[&str]| three[..2].iter().all(|word| !word.ends_with(','));
    let found = words.windows(3).filter(goes_on).find(|three| three.iter().all(is_prose));
    found.map(|three| three.join(" "))
}

fn codes(said: &str) -> Vec<&str> {
    said.match_indices("[VP").map(|(at, _)| &said[at + 1..at + 7]).collect()
}

fn places(said: &str) -> Vec<&str> {
    said.lines().filter_map(|line| line.trim_start().strip_prefix("--> ")).collect()
}

/// Both outputs: what is wrong with the Russian, if anything.
pub(crate) fn fault(english: &str, russian: &str) -> Option<String> {
    if codes(english) != codes(russian) || places(english) != places(russian) {
        return Some("other codes or places".to_owned());
    }
    let words = words(russian);
    if words.contains("error[") || words.contains("warning[") || words.contains("help:") {
        return Some("an English title".to_owned());
    }
    latin_sentence(&words)
}

#[test]
fn a_latin_sentence_is_found_and_names_are_none() {
    assert_eq!(latin_sentence("ошибка: the arc has no centre").as_deref(), Some("the arc has"));
    let fine = "напишите G90 G0 X10 раздел [tool] профиля CUTTING_EDGE_DEFAULT MD TRANS ATRANS, Renishaw XL";
    assert_eq!(latin_sentence(fine), None);
}

#[test]
fn refusals_of_the_corpus_are_said_in_russian() {
    let (mut failed, mut count, mut seen) = (Vec::new(), 0, std::collections::BTreeSet::new());
    for dialect in DIALECTS {
        for path in files(&root().join("tests/corpus").join(dialect).join("reject"), &["nc", "ngc"]) {
            count += 1;
            let program = path.to_str().expect("a plain path");
            let options = [program, "-m", PROFILE, "-d", dialect];
            let english = messages(&run(&options));
            let russian = messages(&run(&[&options[..], &["--lang", "ru"]].concat()));
            seen.extend(codes(&russian).into_iter().map(str::to_owned));
            if let Some(fault) = fault(&english, &russian) {
                failed.push(format!("{program}: {fault}\n{russian}"));
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count} programs:\n{}", failed.len(), failed.join("\n"));
    assert!(count > 250 && seen.len() > 50, "only {count} programs, {} codes", seen.len());
}

#[test]
fn help_and_wrong_arguments_are_said_in_russian() {
    for command in [
        &[][..],
        &["correct"],
        &["batch"],
        &["batch", "run"],
        &["check"],
        &["calibrate", "tracker"],
        &["map"],
    ] {
        let ran = run(&[command, &["--help", "--lang", "ru"]].concat());
        let help = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.success() && help.contains("Запуск: vpost"), "{command:?}\n{help}");
        assert!(
            !["Usage", "Options:", "Commands:", "Arguments:"].iter().any(|word| help.contains(word)),
            "{help}"
        );
        let told = help.lines().filter(|line| !line.contains("vpost "));
        let told = told.collect::<Vec<_>>().join("\n");
        assert_eq!(latin_sentence(&told), None, "{command:?}\n{help}");
    }
    let cases: [(&[&str], &str); 6] = [
        (&["part.nc", "--machin", "x"], "ключ `--machin` незнаком"),
        (&["check", "part.nc"], "не хватает: <OUT.nc>"),
        (&["check", "a.nc", "b.nc", "--force"], "ключ `--force` незнаком"),
        (&["check", "a.nc", "b.nc", "--guard"], "`vpost check` не читает `--guard`"),
        (&["part.nc", "--color", "pink"], "`--color <COLOR>`: значения `pink` нет; есть auto, always, never"),
        (&["batch", "frobnicate-it", "--nothing"], "ключ `--nothing` незнаком"),
    ];
    for (arguments, expected) in cases {
        let ran = run(&[arguments, &["--lang", "ru"]].concat());
        let said = messages(&ran);
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}\n{said}");
        assert!(said.starts_with("ошибка: ") && said.contains(expected), "{arguments:?}\n{said}");
        assert_eq!(latin_sentence(&said), None, "{arguments:?}\n{said}");
    }
}

#[test]
fn a_language_is_asked_for_or_the_locale_says_it() {
    let said = |locale: &str, more: &[&str]| {
        let mut command = crate::common::vpost();
        command.env("LC_ALL", locale).args(["no-such.nc", "-m", PROFILE]).args(more);
        messages(&command.output().expect("the command starts"))
    };
    assert!(said("C", &[]).starts_with("error[VP0001]"));
    assert!(said("ru_RU.UTF-8", &[]).starts_with("ошибка[VP0001]"), "{}", said("ru_RU.UTF-8", &[]));
    assert!(said("ru_RU.UTF-8", &["--lang", "en"]).starts_with("error[VP0001]"));
    assert!(said("no_such", &[]).starts_with("error[VP0001]"));
    let wrong = said("C", &["--lang", "xx"]);
    assert!(wrong.starts_with("error[VP0002]") && wrong.contains("`--lang ru`"), "{wrong}");
    let wrong = said("ru", &["--lang", "xx"]);
    assert!(wrong.starts_with("ошибка[VP0002]") && wrong.contains("`--lang ru`"), "{wrong}");
}
