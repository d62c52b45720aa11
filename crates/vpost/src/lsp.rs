//! `vpost lsp`: what an editor asks on standard input, and what it is answered on standard output.
//!
//! A thread reads; all else is done here, message by message, and programs are checked while none waits. Work asks
//! whether one does: an edit ends the check of the text before it, a cancelled request its answer.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, BufRead, Read, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use diagnostic::{Language, Text};
use editor::Editor;
use jobs::options::JobOptions;
use lsp_server::{ErrorCode, Message};

use crate::arguments::Lsp;
use crate::command_line::Arguments;
use crate::message::{Deed, Failure};
use crate::{config, language};

/// A message of the protocol is no longer, bytes: what is longer is passed over.
const LARGEST: u64 = 64 << 20;
/// So many messages wait, no more are read.
const WAITING: usize = 256;

/// What came from the editor.
enum Came {
    Message(Message),
    /// What was no message.
    Malformed(String),
    /// Megabytes of what was passed over.
    TooLarge(u64),
    End,
}

/// What holds for a program: what the editor said, and else the settings file above the program.
fn options(program: &Path, told: &JobOptions) -> Result<JobOptions, Failure> {
    let line: Vec<OsString> =
        ["vpost", "correct"].map(OsString::from).into_iter().chain([program.into()]).collect();
    let held = config::find(&line)?;
    match Arguments::read(line, held) {
        Ok(arguments) => Ok(told.over(&arguments.shared.job)),
        Err(error) => Err(jobs::options::misread(&error)),
    }
}

/// Answers an editor until it says that it ends.
///
/// * `asked` – the language of `--lang`
pub(crate) fn run(_: &Lsp, asked: Option<Language>) -> Result<(), Failure> {
    let mut editor = Editor::new(options, asked, language::chosen(None));
    let (sender, receiver) = sync_channel(WAITING);
    thread::Builder::new().spawn(move || read(&sender)).map_err(|error| unread(&error))?;
    let inbox = Inbox { receiver, waiting: RefCell::default() };
    loop {
        let came = match editor.has_unchecked().then(|| inbox.take_waiting()) {
            Some(None) => {
                write(editor.check(&|| inbox.has_waiting()))?;
                continue;
            }
            Some(Some(came)) => came,
            None => inbox.take(),
        };
        match came {
            Came::Message(Message::Request(request)) => {
                let id = request.id.clone();
                let cancelled = || inbox.cancels(&id);
                write([Message::Response(editor.request(request, &cancelled))])?;
            }
            Came::Message(Message::Notification(said)) if said.method == "exit" => break,
            Came::Message(Message::Notification(said)) => write(editor.notify(said))?,
            Came::Message(Message::Response(_)) => {}
            Came::Malformed(why) => malformed(&why)?,
            Came::TooLarge(megabytes) => write([editor.too_large(megabytes)])?,
            Came::End => break,
        }
    }
    if editor.is_shut_down() { Ok(()) } else { Err(Failure::Said(1)) }
}

/// What has come and was not taken yet.
struct Inbox {
    receiver: Receiver<Came>,
    waiting: RefCell<VecDeque<Came>>,
}

impl Inbox {
    /// The next, whenever it comes.
    fn take(&self) -> Came {
        self.take_waiting().unwrap_or_else(|| self.receiver.recv().unwrap_or(Came::End))
    }

    fn take_waiting(&self) -> Option<Came> {
        self.look();
        self.waiting.borrow_mut().pop_front()
    }

    fn has_waiting(&self) -> bool {
        self.look();
        !self.waiting.borrow().is_empty()
    }

    /// A request was taken back.
    fn cancels(&self, id: &lsp_server::RequestId) -> bool {
        self.look();
        let id = serde_json::to_value(id).unwrap_or_default();
        self.waiting.borrow().iter().any(|came| match came {
            Came::Message(Message::Notification(said)) => {
                said.method == "$/cancelRequest" && said.params.get("id") == Some(&id)
            }
            _ => false,
        })
    }

    fn look(&self) {
        self.waiting.borrow_mut().extend(self.receiver.try_iter().take(WAITING));
    }
}

/// Reads standard input to its end, or until nobody takes what is read.
fn read(sender: &SyncSender<Came>) {
    let mut input = io::stdin().lock();
    loop {
        let came = frame(&mut input).unwrap_or(Came::End);
        let ends = matches!(came, Came::End);
        if sender.send(came).is_err() || ends {
            return;
        }
    }
}

/// A message: lines of a head, of which one says its length, an empty one, and JSON.
fn frame(input: &mut impl BufRead) -> io::Result<Came> {
    /// No line of a head is longer.
    const LONGEST: u64 = 4096;
    let (mut begun, mut length) = (false, None);
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(LONGEST).read_until(b'\n', &mut line)? == 0 {
            return Ok(if begun { cut_off() } else { Came::End });
        }
        begun = true;
        let line = line.trim_ascii();
        if line.is_empty() {
            break;
        }
        let mut parts = line.splitn(2, |byte| *byte == b':');
        let name = parts.next().unwrap_or_default().trim_ascii();
        if name.eq_ignore_ascii_case(b"Content-Length") {
            let number = parts.next().and_then(|number| str::from_utf8(number).ok());
            length = number.and_then(|number| number.trim().parse::<u64>().ok());
        }
    }
    let Some(length) = length else { return Ok(Came::Malformed("no Content-Length".to_owned())) };
    let mut rest = input.by_ref().take(length);
    if length > LARGEST {
        io::copy(&mut rest, &mut io::sink())?;
        return Ok(Came::TooLarge(length >> 20));
    }
    let mut text = Vec::new();
    if rest.read_to_end(&mut text)? < length as usize {
        return Ok(cut_off());
    }
    Ok(serde_json::from_slice(&text).map_or_else(|why| Came::Malformed(why.to_string()), Came::Message))
}

fn cut_off() -> Came {
    Came::Malformed("the message ends before its length".to_owned())
}

fn write(messages: impl IntoIterator<Item = Message>) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    let written = messages.into_iter().try_for_each(|message| message.write(&mut output));
    written.map_err(|error| unwritten(&error))
}

/// Says that what came was no message; whose, nobody knows.
fn malformed(why: &str) -> Result<(), Failure> {
    let error = serde_json::json!({ "code": ErrorCode::ParseError as i32, "message": why });
    let text = serde_json::json!({ "jsonrpc": "2.0", "id": null, "error": error }).to_string();
    let mut output = io::stdout().lock();
    let written =
        write!(output, "Content-Length: {}\r\n\r\n{text}", text.len()).and_then(|()| output.flush());
    written.map_err(|error| unwritten(&error))
}

fn unread(error: &io::Error) -> Failure {
    Failure::place(&Text::pair("standard input", "стандартный ввод"), Deed::Read, error)
}

fn unwritten(error: &io::Error) -> Failure {
    Failure::place(&Text::pair("standard output", "стандартный вывод"), Deed::WriteTo, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_within_a_message_is_said() {
        for cut in ["Content-Len", "Content-Length: 9\r\n", "Content-Length: 9\r\n\r\n{"] {
            assert!(matches!(frame(&mut cut.as_bytes()), Ok(Came::Malformed(_))), "{cut:?}");
        }
        assert!(matches!(frame(&mut &b""[..]), Ok(Came::End)));
    }
}
