//! What stands in the brackets of a called cycle.

use diagnostic::{Text, both};
use nc_syntax::Span;

use super::Fault;
use crate::refusals::called as refusal;
use crate::shorthand::Words;
use crate::siemens::plain_number;

/// The arguments of a call, by place; one that is left out is none.
#[derive(Clone, Debug)]
pub(super) struct Arguments {
    /// In the words of the program, for messages.
    pub(super) name: String,
    pub(super) span: Span,
    values: Vec<Option<f64>>,
}

impl Arguments {
    /// Reads `NAME(1,,2.5)`.
    pub(super) fn read(words: &Words<'_, '_>, span: Span) -> Result<Self, Fault> {
        let text = String::from_utf8_lossy(words.block.text(span)).into_owned();
        let (name, inside) = match text.split_once('(') {
            Some((name, rest)) => {
                (name.trim().to_ascii_uppercase(), rest.trim_end().trim_end_matches(')').to_owned())
            }
            None => (text.trim().to_ascii_uppercase(), String::new()),
        };
        let mut values = Vec::new();
        for written in inside.split(',').map(str::trim) {
            values.push(match (written, plain_number(written)) {
                ("", _) => None,
                (_, Some(value)) => Some(value),
                (_, None) => {
                    return Err(words.fault(refusal::in_brackets(written, &name), span));
                }
            });
        }
        Ok(Self { name, span, values })
    }

    /// The argument at a place, from 0.
    pub(super) fn at(&self, place: usize) -> Option<f64> {
        self.values.get(place).copied().flatten()
    }

    /// The same; one that is left out is zero, as on the control.
    pub(super) fn or_zero(&self, place: usize) -> f64 {
        self.at(place).unwrap_or(0.0)
    }

    /// One without which there is no cycle.
    pub(super) fn needed(&self, words: &Words<'_, '_>, place: usize, what: &Text) -> Result<f64, Fault> {
        self.at(place).ok_or_else(|| {
            self.fault(
                words,
                both!("{} without {what}", "{} без {what:#}", self.name),
                both!("argument {} was expected", "ожидался аргумент {}", place + 1),
            )
        })
    }

    /// How many are written.
    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    /// Those from a place on choose ways of reading the others, which this room knows for none but zero.
    pub(super) fn nothing_behind(&self, words: &Words<'_, '_>, place: usize) -> Result<(), Fault> {
        self.chooses_nothing(words, place, &[])
    }

    /// The same, but that some of them may say what the others say already: a place, and the values it may have.
    pub(super) fn chooses_nothing(
        &self,
        words: &Words<'_, '_>,
        place: usize,
        said_again: &[(usize, &[f64])],
    ) -> Result<(), Fault> {
        let chooses = |place: &usize| {
            let value = self.or_zero(*place);
            let again = said_again.iter().any(|(at, values)| at == place && values.contains(&value));
            value != 0.0 && !again
        };
        let Some(found) = (place..self.values.len()).find(chooses) else { return Ok(()) };
        let (value, number) = (self.or_zero(found), found + 1);
        Err(words.fault(refusal::with_as_argument(&self.name, value, number, place), self.span))
    }

    pub(super) fn fault(&self, words: &Words<'_, '_>, message: Text, label: Text) -> Fault {
        words.fault(refusal::hole(message, label), self.span)
    }
}
