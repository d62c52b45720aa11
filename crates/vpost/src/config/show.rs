//! `vpost config`: which settings hold, and where each stands.

use std::path::PathBuf;

use clap::Args;
use diagnostic::both;
use serde::Serialize;

use super::held::{Held, Kept};
use crate::file;
use crate::message::{Failure, Messages};
use crate::summary::json;

/// `vpost config`
#[derive(Debug, Args)]
pub struct Config {
    /// The program, or its folder; default: the current one.
    #[arg(value_name = "PROGRAM")]
    pub program: Option<PathBuf>,
    /// The settings as JSON on standard output.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Shown<'a> {
    schema: &'static str,
    file: Option<String>,
    options: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    command: String,
    option: &'a str,
    values: &'a [String],
    line: usize,
}

/// `vpost config`
pub(crate) fn run(arguments: &Config, held: &Held, messages: &Messages) -> Result<(), Failure> {
    let file = held.file.as_deref().map(file::name);
    let row = |kept: &'_ Kept| kept.command.join(" ");
    if arguments.json {
        let options = held.kept.iter().map(|kept| Row {
            command: row(kept),
            option: &kept.option,
            values: &kept.values,
            line: kept.line,
        });
        return file::print(&json(&Shown { schema: "vpost.config/1", file, options: options.collect() }));
    }
    let Some(file) = file else {
        let none = both!(
            "no vpost.toml in {} or a folder above it\n",
            "ни в {}, ни в папках над ней нет vpost.toml\n",
            held.from.canonicalize().unwrap_or_else(|_| held.from.clone()).display()
        );
        return file::print(none.in_language(messages.language()).as_bytes());
    };
    let lines: Vec<[String; 2]> = held
        .kept
        .iter()
        .map(|kept| {
            let named = format!("{} --{}", row(kept), kept.option);
            [named.trim_start().to_owned(), kept.values.join("  ")]
        })
        .collect();
    let widest = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let [name, value] = [0, 1].map(widest);
    let mut text = String::new();
    for ([named, said], kept) in lines.iter().zip(&held.kept) {
        text.push_str(&format!("{named:name$}  {said:value$}  {file}:{}\n", kept.line));
    }
    file::print(text.as_bytes())
}
