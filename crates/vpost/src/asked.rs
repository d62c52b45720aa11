//! `vpost part.nc` at a terminal and without a profile: what has to be known is asked, one question at a time.
//!
//! The questions are the refusals that the command has anyway, their answers the options that a refusal's help offers.
//! What was answered is kept as settings beside the program where somebody wants that.

use std::path::{Path, PathBuf};

use diagnostic::{Text, both};

use crate::command_line::{Arguments, Command, command};
use crate::message::{Failure, Messages};
use crate::questions::Questions;
use crate::{config, file};

/// What was answered so far, as options of the command line.
pub(crate) type Answers = Vec<String>;

/// The option that answers a failure, if somebody is asked and answers.
///
/// Somebody is asked at a terminal whose call corrects a program and names no profile.
pub(crate) fn answer(
    failure: &Failure,
    arguments: &Arguments,
    answers: &Answers,
    messages: &Messages,
) -> Option<String> {
    let program = program(arguments)?;
    let has_profile = arguments.shared.job.machine.is_some();
    if has_profile && answers.is_empty() {
        return None;
    }
    let questions = Questions::at_a_terminal(messages)?;
    let answer = if has_profile {
        option(&questions, &offers(&messages.text(failure)))
    } else {
        profile(&questions, &profiles(program))
    };
    // Who asks the same again has been answered already.
    answer.filter(|answer| !answers.contains(answer))
}

/// Offers to keep the answers that led to a corrected program.
///
/// # Errors
/// The settings cannot be written.
pub(crate) fn keep(answers: &Answers, arguments: &Arguments, messages: &Messages) -> Result<(), Failure> {
    let (Some(program), Some(questions)) = (program(arguments), Questions::at_a_terminal(messages)) else {
        return Ok(());
    };
    let folder = file::folder_of(program);
    let place = folder.join(config::NAME);
    if arguments.shared.held.file.is_some() || place.exists() {
        return Ok(());
    }
    let name = file::name(&place);
    let question = both!(
        "Keep these answers for all programs of this folder, in {name}? y or n",
        "Сохранить ответы для всех программ этой папки, в {name}? д или н"
    );
    let wants = questions.ask(&question, |text| match text.to_lowercase().as_str() {
        "y" | "yes" | "д" | "да" => Ok(true),
        "n" | "no" | "н" | "нет" | "" => Ok(false),
        _ => Err(Text::pair("y or n", "д или н")),
    });
    // Who says nothing keeps nothing; the program is corrected all the same.
    if wants.unwrap_or(false) {
        file::write(&place, config::written(answers, folder).as_bytes())
    } else {
        Ok(())
    }
}

/// The program of a call that corrects one.
fn program(arguments: &Arguments) -> Option<&Path> {
    let correct = match &arguments.command {
        None => &arguments.correct,
        Some(Command::Correct(correct)) => correct,
        Some(_) => return None,
    };
    // A program that comes through standard input leaves no line for answers.
    correct.input.as_deref().filter(|input| input.as_os_str() != "-")
}

/// Which of the profiles that lie about, or another one.
fn profile(questions: &Questions<'_>, known: &[PathBuf]) -> Option<String> {
    let list = listed(known.iter().map(|path| path.display()));
    let question = both!(
        "Which machine?{list}\nA number, the path of a profile, or nothing to end (`vpost profile new` makes one)",
        "Какой станок?{list}\nНомер, путь к профилю или пусто: закончить (новый создаёт `vpost profile new`)"
    );
    let path = chosen(questions, &question, known, |path| match PathBuf::from(unquoted(path)) {
        path if path.is_file() => Ok(path),
        path => Err(both!("{}: there is no such file", "{}: такого файла нет", path.display())),
    })?;
    Some(format!("--machine={}", path.display()))
}

/// One of the options that a refusal offers, or another one.
fn option(questions: &Questions<'_>, offers: &[String]) -> Option<String> {
    let list = listed(offers);
    let question = both!(
        "Which answer?{list}\nA number, an option as it is typed, or nothing to end",
        "Какой ответ?{list}\nНомер, ключ, как он набирается, или пусто, чтобы закончить"
    );
    let chosen = chosen(questions, &question, offers, |typed| match typed.starts_with("--") {
        true => Ok(typed.to_owned()),
        false => Err(both!("{typed}: no option begins so", "{typed}: ключ так не начинается")),
    })?;
    let is_offered = offers.contains(&chosen);
    let (name, value) = chosen.split_once([' ', '=']).unwrap_or((&chosen, ""));
    let value = unquoted(value);
    if value.is_empty() && !takes_value(name) {
        return Some(name.to_owned());
    }
    // Who typed it meant it; of what is offered, numbers are an example's.
    let value = if is_offered { blank(value) } else { value.to_owned() };
    if !value.is_empty() && !is_open(&value) {
        return Some(format!("{name}={value}"));
    }
    let question = both!("{name}: what stands for {value}?", "{name}: что вместо {value}?");
    let value = questions.ask(&question, |text| Ok(text.to_owned())).ok().filter(|text| !text.is_empty())?;
    Some(format!("{name}={value}"))
}

/// The option of a correction has a value.
fn takes_value(name: &str) -> bool {
    let long = Some(name.trim_start_matches('-'));
    let takes = |option: &clap::Arg| option.get_long() == long && option.get_action().takes_values();
    command().find_subcommand("correct").is_some_and(|correct| correct.get_arguments().any(takes))
}

/// A word without the shell's quotes.
fn unquoted(word: &str) -> &str {
    let inner = |quote| word.strip_prefix(quote)?.strip_suffix(quote);
    inner('"').or_else(|| inner('\'')).unwrap_or(word)
}

/// A value of an example without its numbers: `H7=120` is `H7=…`.
fn blank(value: &str) -> String {
    let is_number =
        |part: &str| part.trim_start_matches('-').starts_with(|first: char| first.is_ascii_digit());
    let without = |part: &str| if is_number(part) { "…".to_owned() } else { part.to_owned() };
    let parts = value.split(',').map(|part| match part.split_once('=') {
        Some((name, number)) => format!("{name}={}", without(number)),
        None => without(part),
    });
    parts.collect::<Vec<_>>().join(",")
}

/// A value in which somebody has yet to say something: `G54=X,Y,Z`, `B=…`.
fn is_open(value: &str) -> bool {
    let is_name = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_uppercase());
    let said = value.split_once('=').map_or(value, |(_, said)| said);
    value.contains('…') || said.split(',').any(is_name)
}

/// Choices with their numbers, a line each.
fn listed(choices: impl IntoIterator<Item = impl std::fmt::Display>) -> String {
    choices.into_iter().enumerate().map(|(at, choice)| format!("\n  {}  {choice}", at + 1)).collect()
}

/// One of the choices by its number, or what else can be read; `None` for nothing.
fn chosen<T: Clone>(
    questions: &Questions<'_>,
    question: &Text,
    choices: &[T],
    other: impl Fn(&str) -> Result<T, Text>,
) -> Option<T> {
    let by_number = |text: &str| choices.get(text.parse::<usize>().ok()?.checked_sub(1)?).cloned();
    let read = |text: &str| match text {
        "" => Ok(None),
        text => by_number(text).map_or_else(|| other(text), Ok).map(Some),
    };
    questions.ask(question, read).ok().flatten()
}

/// The options between backticks of a message.
fn offers(text: &str) -> Vec<String> {
    let mut offers: Vec<String> = Vec::new();
    for quoted in text.split('`').skip(1).step_by(2) {
        if quoted.starts_with("--") && !offers.iter().any(|offer| offer == quoted) {
            offers.push(quoted.to_owned());
        }
    }
    offers
}

/// Profiles beside the program and here, and in folders of their name.
fn profiles(program: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in [file::folder_of(program), Path::new(".")] {
        for folder in [folder.to_owned(), folder.join("machine-profiles")] {
            let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
            let profiles = entries.map(|entry| entry.path()).filter(|path| is_profile(path));
            found.extend(profiles.map(|path| path.strip_prefix(".").map_or(path.clone(), Path::to_owned)));
        }
    }
    found.sort();
    found.dedup();
    found
}

fn is_profile(path: &Path) -> bool {
    let text = || std::fs::read_to_string(path).unwrap_or_default();
    path.extension().is_some_and(|ending| ending == "toml")
        && text().lines().any(|line| line.split('=').next().is_some_and(|key| key.trim() == "chain"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_s_options_are_its_answers() {
        let text = "error[VP0241]: …\nhelp: `--decimal increments` where Z10 is ten steps, `--decimal millimetres` \
                    where it is Z10.; or `decimal = \"…\"` under `[program]`, `--decimal increments`";
        assert_eq!(offers(text), ["--decimal increments", "--decimal millimetres"]);
    }

    #[test]
    fn what_somebody_has_yet_to_say_is_open() {
        for value in ["G54=X,Y,Z", "X,Y,Z", "B=…,C=…", "H1=LENGTH"] {
            assert!(is_open(value), "{value}");
        }
        for value in ["", "exact", "G54=1,2,3", "B=0,C=0", "touched"] {
            assert!(!is_open(value), "{value}");
        }
    }

    #[test]
    fn an_example_s_numbers_are_nobody_s_answer() {
        for (offered, left) in [
            ("H7=120", "H7=…"),
            ("Z=300,A=0", "Z=…,A=…"),
            ("temp_c=24", "temp_c=…"),
            ("-5.5", "…"),
            ("X,Y,Z", "X,Y,Z"),
            ("millimetres", "millimetres"),
        ] {
            assert_eq!(blank(offered), left);
            assert_eq!(is_open(left), left != "millimetres");
        }
        assert_eq!(unquoted("\"#<depth>=12.5\""), "#<depth>=12.5");
        assert!(takes_value("--dialect") && !takes_value("--strict"));
    }
}
