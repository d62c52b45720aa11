//! The manifest: which programs are to be corrected, and how, written down once for all machines.
//!
//! JSON Lines. The first line says how ([`Header`]), each further one names a program with its hash, in the order of
//! the outputs. The header holds the hash of the lines below it, so a manifest that was cut or edited is none.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use diagnostic::{Code, Text, both, notice};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::folder;
use super::folder::OWN;
use super::inputs::Item;
use super::job::Job;
use crate::arguments::{JobOptions, Shared};
use crate::file;
use crate::message::{Deed, Failure, Messages};

/// The manifest cannot be used.
const MANIFEST: Code = Code(1010);
/// What decides the outputs changed since the plan.
const JOB_CHANGED: Code = Code(1011);

const SCHEMA: &str = "vpost.manifest/1";

/// How the programs are corrected.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    schema: String,
    version: String,
    /// The output folder.
    output: PathBuf,
    options: JobOptions,
    /// Hash of everything that decides the outputs besides the programs.
    job_blake3: String,
    /// Hash of the folders given with `--include`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    include_blake3: Option<String>,
    programs: usize,
    /// Hash of the lines below.
    programs_blake3: String,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Program {
    output: String,
    input: PathBuf,
    bytes: u64,
    blake3: String,
}

/// A manifest that was read.
#[derive(Debug)]
pub(crate) struct Manifest {
    header: Header,
    /// The programs with their hashes, in the order of their outputs.
    pub items: Vec<Item>,
    /// Of the whole file: a short name for its journals.
    pub name: String,
}

/// The manifest's text for these programs; reads each of them.
pub(crate) fn text(items: &[Item], output: &Path, job: &Job, shared: &Shared) -> Result<Vec<u8>, Failure> {
    let hashed: Vec<Result<Program, Failure>> = items
        .par_iter()
        .map(|item| {
            let (bytes, hash) = folder::hash(&item.input).map_err(file::fails(&item.input, Deed::Read))?;
            let blake3 = hash.to_hex().to_string();
            Ok(Program { output: item.output.clone(), input: item.input.clone(), bytes, blake3 })
        })
        .collect();
    let (mut lines, mut unread) = (Vec::new(), Vec::new());
    for program in hashed {
        match program {
            Ok(program) => line(&mut lines, &program)?,
            Err(Failure::File(report)) => unread.push(report),
            Err(failure) => return Err(failure),
        }
    }
    // All of them, for a plan is made once.
    if !unread.is_empty() {
        return Err(Failure::Refused(unread));
    }
    let header = Header {
        schema: SCHEMA.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        output: output.to_owned(),
        options: shared.job.clone(),
        job_blake3: job.hash.to_hex().to_string(),
        include_blake3: include_hash(&shared.job.include)?,
        programs: items.len(),
        programs_blake3: blake3::hash(&lines).to_hex().to_string(),
    };
    let mut text = Vec::with_capacity(lines.len() + 1024);
    line(&mut text, &header)?;
    text.append(&mut lines);
    Ok(text)
}

fn line(text: &mut Vec<u8>, value: &impl Serialize) -> Result<(), Failure> {
    // Only the name of a file or folder can be what JSON does not hold.
    serde_json::to_writer(&mut *text, value).map_err(|error| {
        Failure::usage(notice!(MANIFEST;
            "the plan cannot be written: {error}", "план не записать: {error}";
            "give files and folders names that are UTF-8", "дайте файлам и папкам имена в UTF-8"
        ))
    })?;
    text.push(b'\n');
    Ok(())
}

/// Hash of the names and bytes of all files that could be called.
fn include_hash(folders: &[PathBuf]) -> Result<Option<String>, Failure> {
    if folders.is_empty() {
        return Ok(None);
    }
    let mut hasher = blake3::Hasher::new();
    for folder in folders {
        let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
        let entries = entries.map_err(file::fails(folder, Deed::Read))?;
        let mut paths: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
        paths.sort();
        hasher.update(b"\0folder\0");
        for path in paths.iter().filter(|path| path.is_file()) {
            hasher.update(path.file_name().unwrap_or_default().as_encoded_bytes());
            hasher.update(b"\0");
            hasher.update(blake3::hash(&file::read(path)?).as_bytes());
        }
    }
    Ok(Some(hasher.finalize().to_hex().to_string()))
}

/// Writes a manifest once. The same again changes nothing; another one needs another name.
pub(crate) fn write(path: &Path, text: &[u8]) -> Result<(), Failure> {
    match std::fs::read(path) {
        Ok(present) if present == text => Ok(()),
        Ok(_) => Err(Failure::usage(notice!(MANIFEST;
            "{} is there already, and a manifest does not change",
            "{} уже есть, а задание не меняется", path.display();
            "give another name, or delete it if no shard of it will run again",
            "дайте другое имя или удалите его, если его части больше не пойдут"
        ))),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => file::write(path, text),
        Err(error) => Err(Failure::file(&file::name(path), Deed::Read, &error)),
    }
}

impl Manifest {
    /// Reads a manifest and checks that it is whole and of this version.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => Failure::unread(&file::name(path), &error),
            _ => Failure::file(&file::name(path), Deed::Read, &error),
        })?;
        let damaged = |what: Text| {
            Failure::usage(notice!(MANIFEST;
                "{} is no manifest as `vpost batch plan` wrote it: {what}",
                "{} — не задание в том виде, как его записал `vpost batch plan`: {what:#}", path.display();
                "copy it again, or make a new one with `vpost batch plan`",
                "скопируйте его снова или составьте заново: `vpost batch plan`"
            ))
        };
        let at = text.iter().position(|byte| *byte == b'\n').map_or(text.len(), |at| at + 1);
        let (first, lines) = text.split_at(at);
        // Before the fields, which may be others in another version.
        let schema: serde_json::Value = serde_json::from_slice(first)
            .map_err(|error| damaged(both!("line 1: {error}", "строка 1: {error}")))?;
        if schema["schema"] != SCHEMA {
            return Err(damaged(both!(
                "its first line does not say {SCHEMA}",
                "в его первой строке нет {SCHEMA}"
            )));
        }
        if schema["version"] != env!("CARGO_PKG_VERSION") {
            let other = schema["version"].as_str();
            let other = other.map_or(Text::pair("of another version", "другой версии"), Text::same);
            return Err(Failure::usage(notice!(MANIFEST;
                "{} was written by vpost {}, this is {}",
                "{} записан vpost {:#}, а этот — {}", path.display(), other, env!("CARGO_PKG_VERSION");
                "run one version on all machines; another version may write other bytes",
                "запускайте на всех машинах одну версию: другая может записать другие байты"
            )));
        }
        let header: Header = serde_json::from_slice(first)
            .map_err(|error| damaged(both!("line 1: {error}", "строка 1: {error}")))?;
        if blake3::hash(lines).to_hex().as_str() != header.programs_blake3 {
            return Err(damaged(both!(
                "the lines below the first were changed or cut",
                "строки после первой изменены или обрезаны"
            )));
        }
        let mut outputs = BTreeSet::new();
        let lines = lines.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        let item = |(line, at): (&[u8], u64)| {
            let wrong = |what: Text| damaged(both!("line {at}: {what}", "строка {at}: {what:#}"));
            item(line, &mut outputs).map_err(wrong)
        };
        let items = lines.zip(2..).map(item).collect::<Result<Vec<Item>, Failure>>()?;
        if items.iter().try_fold(0_u64, |sum, item: &Item| sum.checked_add(item.bytes)).is_none() {
            return Err(damaged(both!(
                "its programs are larger than any disk",
                "его программы больше любого диска"
            )));
        }
        if items.len() != header.programs {
            return Err(damaged(both!(
                "it says {} programs and has {}",
                "в нём сказано программ {}, а есть {}",
                header.programs,
                items.len()
            )));
        }
        let name = blake3::hash(&text).to_hex()[..16].to_owned();
        Ok(Self { header, items, name })
    }

    /// The output folder.
    pub(crate) fn output(&self) -> &Path {
        &self.header.output
    }

    /// The job's hash.
    pub(crate) fn job_blake3(&self) -> &str {
        &self.header.job_blake3
    }

    /// Profile, dialect and options as they were planned; refused where they are others today.
    pub(crate) fn job(&self, own: &Shared, messages: &Messages) -> Result<Job, Failure> {
        let shared = Shared { job: self.header.options.clone(), ..own.clone() };
        let job = Job::load(&shared, messages)?;
        let changed = |what: Text| {
            Failure::usage(notice!(JOB_CHANGED;
                "{what} changed since the plan was made", "{what:#}: изменилось после составления плана";
                "bring it back, or make a new plan with `vpost batch plan`",
                "верните прежнее или составьте план заново: `vpost batch plan`"
            ))
        };
        if job.hash.to_hex().as_str() != self.header.job_blake3 {
            return Err(changed(both!(
                "the profile, one of its tables, or the dialect",
                "профиль, одна из его таблиц или диалект"
            )));
        }
        if include_hash(&shared.job.include)? != self.header.include_blake3 {
            return Err(changed(both!(
                "a file in a folder of subprograms (`--include`)",
                "файл в папке подпрограмм (`--include`)"
            )));
        }
        Ok(job)
    }
}

/// A program of the manifest; `outputs`: those before it.
fn item(line: &[u8], outputs: &mut BTreeSet<String>) -> Result<Item, Text> {
    let Program { output, input, bytes, blake3 } =
        serde_json::from_slice(line).map_err(|error| Text::same(error.to_string()))?;
    if !stays_inside(&output) {
        return Err(both!("its output leaves the output folder", "её выходной файл вне выходной папки"));
    }
    // As for `plan`: letters' case counts for nothing on the shares that most controls read.
    if !outputs.insert(output.to_lowercase()) {
        return Err(both!(
            "its output is another program's, too",
            "её выходной файл — ещё и другой программы"
        ));
    }
    Ok(Item { input, output, bytes, blake3: Some(blake3) })
}

/// A name below the output folder, spelled in the one way in which `plan` spells it, and none of vpost's own.
fn stays_inside(output: &str) -> bool {
    let parts: Vec<&str> = output.split('/').collect();
    let plain =
        |part: &&str| !part.is_empty() && *part != "." && *part != ".." && !part.contains(['\\', '\0']);
    parts.iter().all(plain) && parts.first() != Some(&OWN) && !Path::new(output).has_root()
}
