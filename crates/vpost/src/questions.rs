//! Questions to somebody at a terminal, one line each.

use std::io::{BufRead, IsTerminal};

use diagnostic::{Text, notice};

use crate::message::{Deed, Failure, Messages, OPTION};

/// Asks on standard error and reads standard input.
pub(crate) struct Questions<'m> {
    messages: &'m Messages,
}

impl<'m> Questions<'m> {
    /// Somebody to ask; `None` in pipes and scripts, and where the user wants no words.
    pub(crate) fn at_a_terminal(messages: &'m Messages) -> Option<Self> {
        let there = std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
        (there && !messages.are_quiet()).then_some(Self { messages })
    }

    /// The answer to a question; asked again until it can be read.
    pub(crate) fn ask<T>(
        &self,
        question: &Text,
        read: impl Fn(&str) -> Result<T, Text>,
    ) -> Result<T, Failure> {
        self.messages.note(question);
        loop {
            let mut line = String::new();
            let bytes = std::io::stdin()
                .lock()
                .read_line(&mut line)
                .map_err(|error| Failure::place(&Text::pair("the answer", "ответ"), Deed::Read, &error))?;
            if bytes == 0 {
                return Err(Failure::usage(notice!(OPTION;
                    "the answers ended before the questions", "ответы кончились раньше вопросов";
                    "nothing was written; begin again", "ничего не записано; начните снова"
                )));
            }
            match read(line.trim()) {
                Ok(answer) => return Ok(answer),
                Err(why) => self.messages.note(&why),
            }
        }
    }
}
