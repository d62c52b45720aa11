//! What else of a refused program would be refused, whatever becomes of its first refusal.

use diagnostic::{Code, Diagnostic, Text, both, russian_plural};
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

fn is_by_itself(code: Code) -> bool {
    /// What cannot be read at all, before anybody asks what it means.
    const UNREADABLE: std::ops::Range<u16> = 100..120;
    UNREADABLE.contains(&code.0) || BY_THEMSELVES.contains(&code)
}

/// Refusals of a program beside its `first` ones, each where it stands first, with how many more blocks have it.
#[must_use]
pub fn refused_besides(text: &[u8], job: &Job<'_>, first: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut interpreter = Interpreter::new(job.dialect, job.setup);
    let mut found: Vec<(Diagnostic, usize)> = Vec::new();
    each_block(text, job.dialect, |block| {
        // The state is then that before the block.
        let refused = interpreter.step(block).err().unwrap_or_default();
        for one in refused.into_iter().filter(|one| is_by_itself(one.code)) {
            if first.iter().any(|known| same(known, &one)) {
                continue;
            }
            match found.iter().position(|(known, _)| same(known, &one)) {
                Some(known) => found[known].1 += 1,
                None if found.len() < MOST => found.push((one, 0)),
                None => {}
            }
        }
    });
    found.into_iter().map(|(one, more)| counted(one, more)).collect()
}

/// True where the same settles both.
fn same(a: &Diagnostic, b: &Diagnostic) -> bool {
    (a.code, &a.message, &a.help) == (b.code, &b.message, &b.help)
}

fn counted(mut one: Diagnostic, more: usize) -> Diagnostic {
    if more > 0 {
        let forms = ["такой же кадр", "таких же кадра", "таких же кадров"];
        let forms = russian_plural(more as u64, forms);
        if !one.label.is_empty() {
            one.label.push(&Text::pair("; ", "; "));
        }
        one.label.push(&if more == 1 {
            both!("one more block like it", "ещё один такой же кадр")
        } else {
            both!("{more} more blocks like it", "ещё {more} {forms}")
        });
    }
    one
}
