//! Why programs were refused, summed over a batch by what settles it.

use std::collections::BTreeSet;

use diagnostic::{Entry, Language, Text, both};

use super::record::{Fault, Record, Settling, Status};
use crate::explain;

/// No more ways out are shown of one message: the rest is in the results.
const MOST_WAYS: usize = 3;

/// Programs that one thing would settle.
struct Cause<'r> {
    /// What was said of the first.
    fault: &'r Fault,
    message: &'r str,
    /// What became of them.
    status: Status,
    /// What the profile lacks, each once.
    entries: Vec<Entry>,
    programs: BTreeSet<&'r str>,
    /// The output of the first program.
    first: &'r str,
}

impl<'r> Cause<'r> {
    /// What stands together in one line: the number of the message, and where files failed what the system said.
    fn headline(&self) -> (&'r str, &'r str) {
        (&self.fault.code, if self.status == Status::Failed { self.message } else { "" })
    }

    /// One message number, and one way out: the same words, or entries of the same table of the profile.
    fn takes(&self, fault: &Fault, message: &str, status: Status) -> bool {
        if self.fault.code != fault.code {
            return false;
        }
        match (self.entries.first(), fault.settled_by.first()) {
            (Some(known), Some(entry)) => known.is_beside(&entry.entry()),
            (None, None) if status == Status::Failed => self.message == message,
            (None, None) => self.fault.help == fault.help,
            _ => false,
        }
    }

    fn add(&mut self, fault: &Fault) {
        for entry in fault.settled_by.iter().map(Settling::entry) {
            if !self.entries.contains(&entry) {
                self.entries.push(entry);
            }
        }
    }
}

/// What programs were refused for, the causes of most programs first, each with what settles it.
pub(crate) fn causes(records: &[Record]) -> Text {
    let causes = gathered(records);
    if causes.is_empty() {
        return Text::EMPTY;
    }
    let mut lines: Vec<Vec<&Cause<'_>>> = Vec::new();
    for cause in &causes {
        match lines.iter_mut().find(|ways| ways[0].headline() == cause.headline()) {
            Some(ways) => ways.push(cause),
            None => lines.push(vec![cause]),
        }
    }
    let programs =
        |ways: &[&Cause<'_>]| ways.iter().flat_map(|way| way.programs.iter()).collect::<BTreeSet<_>>().len();
    lines.sort_by_key(|ways| std::cmp::Reverse(programs(ways)));
    let mut text = both!("refused or failed:\n", "не приняты или не удались:\n");
    for ways in &lines {
        let Cause { fault, message, first, .. } = ways[0];
        text.push(&line(programs(ways), &fault.code, message, first));
        for way in ways.iter().take(MOST_WAYS) {
            text.push(&settled(way, ways.len()));
        }
        if let Some(more) = ways.len().checked_sub(MOST_WAYS).filter(|more| *more > 0) {
            text.push(&both!(
                "                 … and {more} more ways out, of fewer programs: `--results FILE` has them\n",
                "                 … и ещё {more} для меньшего числа программ: они есть в `--results FILE`\n"
            ));
        }
    }
    text
}

/// All causes, those of most programs first.
fn gathered(records: &[Record]) -> Vec<Cause<'_>> {
    let mut causes: Vec<Cause<'_>> = Vec::new();
    for record in records {
        let status = record.status;
        for fault in &record.errors {
            // Files fail for more than one reason: what the system said stands behind the name.
            let reason = (status == Status::Failed).then(|| fault.message.rsplit_once(": ")).flatten();
            let message = reason.map_or(fault.message.as_str(), |(_, reason)| reason);
            let known = causes.iter().position(|cause| cause.takes(fault, message, status));
            let index = known.unwrap_or_else(|| {
                let (entries, programs, first) = (Vec::new(), BTreeSet::new(), record.output.as_str());
                causes.push(Cause { fault, message, status, entries, programs, first });
                causes.len() - 1
            });
            causes[index].add(fault);
            causes[index].programs.insert(&record.output);
        }
    }
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.programs.len()));
    causes
}

/// `       7  VP0215  tool length H1 is not given: op10/lid.nc, …`
pub(super) fn line(count: usize, code: &str, message: &str, first: &str) -> Text {
    let more = if count > 1 { ", …" } else { "" };
    // Records are English; what a number means stands in the page that explains it.
    let russian = explain::title(code, Language::Russian).unwrap_or(message);
    both!("{count:8}  {code}  {message}: {first}{more}\n", "{count:8}  {code}  {russian}: {first}{more}\n")
}

/// What settles a cause; for how many programs, where a message has several ways out.
fn settled(cause: &Cause<'_>, ways: usize) -> Text {
    let count = cause.programs.len();
    let count = if ways > 1 { format!("{count} x ") } else { String::new() };
    let way = if cause.entries.is_empty() {
        let Some(english) = &cause.fault.help else { return Text::EMPTY };
        let russian = cause.fault.help_in_russian.as_ref().unwrap_or(english);
        Text::new(english.clone(), russian.clone())
    } else {
        Entry::written(&cause.entries)
    };
    both!("                 {count}help: {way}\n", "                 {count}что делать: {way:#}\n")
}
