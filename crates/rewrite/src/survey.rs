//! What else of a refused program would be refused, whatever becomes of its first refusal, grouped by what settles it.

use diagnostic::{Code, Diagnostic, Entry, Text, WayOut, both, russian_plural};
use nc_program::{Interpreter, codes};

use crate::job::Job;
use crate::whole::each_block;

/// Most refusals that are told beside the first.
const MOST: usize = 9;

/// Refusals that a block has by itself: no block before it, mended or left out, makes it right. What depends on where the
/// axes stand or on what is in force is none of them, for behind a refused block nobody knows that.
const BY_THEMSELVES: [Code; 10] = [
    codes::NOT_STATIC,
    codes::UNKNOWN_CODE,
    codes::REFUSED_CODE,
    codes::SAME_GROUP,
    codes::LETTER_TWICE,
    codes::BAD_NUMBER,
    codes::WORK_OFFSET,
    codes::TOOL_LENGTH,
    codes::NO_SUCH_AXIS,
    codes::COMMAND,
];

/// What cannot be read at all, before anybody asks what it means.
fn is_unreadable(code: Code) -> bool {
    (100..120).contains(&code.0)
}

fn is_by_itself(code: Code) -> bool {
    is_unreadable(code) || BY_THEMSELVES.contains(&code)
}

/// All refusals of a program: its `first` ones and those that blocks have by themselves, each where it stands first, with
/// how many more blocks have it; those that entries of one table of the profile settle are one.
#[must_use]
pub fn all_refusals(text: &[u8], job: &Job<'_>, first: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut interpreter = Interpreter::new(job.dialect, job.setup);
    let most = first.len() + MOST;
    let mut found: Vec<Group> = first.into_iter().map(Group::of).collect();
    let firsts = found.len();
    each_block(text, job.dialect, |block| {
        // The state is then that before the block.
        let refused = interpreter.step(block).err().unwrap_or_default();
        for one in refused.into_iter().filter(|one| is_by_itself(one.code)) {
            match found.iter_mut().position(|group| group.takes(&one)) {
                // The block that was refused first is met again.
                Some(known) if known < firsts && one.span == found[known].face.span => {}
                Some(known) => found[known].take(&one),
                None if found.len() < most => found.push(Group::of(one)),
                None => {}
            }
        }
    });
    found.into_iter().map(Group::told).collect()
}

/// Refusals that one thing settles.
struct Group {
    /// The one that stands first.
    face: Diagnostic,
    /// What the profile lacks, each once.
    entries: Vec<Entry>,
    /// How many more blocks have it.
    more: usize,
}

impl Group {
    fn of(face: Diagnostic) -> Self {
        let entries = face.entries().to_vec();
        Self { face, entries, more: 0 }
    }

    /// True where the same settles both.
    fn takes(&self, other: &Diagnostic) -> bool {
        let Diagnostic { code, message, help, .. } = &self.face;
        if *code != other.code {
            return false;
        }
        // What stands there differs from block to block, remarks that are none: the way out is one.
        let alike = message == &other.message || is_unreadable(*code);
        let pair = self.entries.first().zip(other.entries().first());
        (alike && help == &other.help) || pair.is_some_and(|(a, b)| a.is_beside(b))
    }

    fn take(&mut self, other: &Diagnostic) {
        let known = self.entries.len();
        for entry in other.entries() {
            if !self.entries.contains(entry) {
                self.entries.push(entry.clone());
            }
        }
        self.more += usize::from(self.entries.len() == known);
    }

    fn told(self) -> Diagnostic {
        let Self { mut face, entries, more } = self;
        if let [_, others @ ..] = &entries[..]
            && !others.is_empty()
        {
            let names: Vec<&str> = others.iter().map(|entry| entry.name.as_str()).collect();
            let names = names.join(", ");
            add(&mut face.label, &both!("nor are {names}", "нет и {names}"));
            let written = Entry::written(&entries);
            face.way_out = Some(Box::new(WayOut::Entries(entries)));
            face.help = Some(both!(
                "this settles all of them, with your values: {written}",
                "всё сразу, со своими значениями: {written:#}"
            ));
        }
        counted(face, more)
    }
}

/// Says more under the caret.
fn add(label: &mut Text, more: &Text) {
    if !label.is_empty() {
        label.push(&Text::pair("; ", "; "));
    }
    label.push(more);
}

fn counted(mut one: Diagnostic, more: usize) -> Diagnostic {
    if more > 0 {
        let forms = ["такой же кадр", "таких же кадра", "таких же кадров"];
        let forms = russian_plural(more as u64, forms);
        let said = if more == 1 {
            both!("one more block like it", "ещё один такой же кадр")
        } else {
            both!("{more} more blocks like it", "ещё {more} {forms}")
        };
        add(&mut one.label, &said);
    }
    one
}
