//! One program from a reader to a file: small ones in memory, large ones in chunks.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jobs::correct::{self, Program};
use rewrite::{Job, Large, LargeEnd, Manner, Part};

use crate::file;
use crate::growing::Growing;
use crate::message::{Deed, Failure, Report, Source};
use crate::settings::Settings;
use crate::source::{Reading, Still};

/// A program up to this size is corrected in memory, all at once.
const SMALL_BYTES: u64 = 4 << 20;

/// Where a program comes from.
pub(crate) enum Input {
    /// A file, which can be read more than once.
    File(PathBuf),
    /// Anything else, by the name it has in messages.
    Stream(String, Box<dyn Read + Send>),
}

impl Input {
    /// A file, or standard input for `-`. Errors come when it is read.
    pub(crate) fn open(path: &Path) -> Self {
        if path.as_os_str() == "-" {
            return Self::Stream(file::name(path), Box::new(io::stdin()));
        }
        let pipe = path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
        match pipe.then(|| File::open(path)) {
            Some(Ok(pipe)) => Self::Stream(file::name(path), Box::new(pipe)),
            _ => Self::File(path.to_owned()),
        }
    }
}

/// Corrects one program; `out` is empty, and of no use after an error.
///
/// `progress` is told the share that is done, 0 to 1, and may end the work. A large program takes some megabytes
/// for each thread, whatever its size; one with flow is worked on in memory as a whole.
///
/// # Errors
/// What was wrong with the program, or the file system, or what `progress` said.
pub(crate) fn program(
    input: Input,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    let program = whatever_is_doubtful(input, settings, manner, out, progress)?;
    if settings.strict {
        correct::refuse_doubts(&program.warnings, |_| true)?;
    }
    Ok(program)
}

fn whatever_is_doubtful(
    input: Input,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    match input {
        Input::File(path) => {
            let name = file::name(&path);
            let still = Still::open(&path).map_err(|error| Failure::file(&name, Deed::Read, &error))?;
            let text = Text { name: &name, kept: Some(&still), rest: Box::new(still.reading()) };
            let done = text.corrected(still.bytes(), settings, manner, out, progress);
            // What is wrong with half a program is not the user's fault to mend.
            if !matches!(done, Err(Failure::Interrupted(_))) {
                still.unchanged(&path, &name)?;
            }
            done
        }
        Input::Stream(name, stream) => {
            Text { name: &name, kept: None, rest: stream }.corrected(0, settings, manner, out, progress)
        }
    }
}

/// A program that is about to be read.
struct Text<'a> {
    name: &'a str,
    /// Where it can be read again.
    kept: Option<&'a Still>,
    rest: Box<dyn Read + Send>,
}

impl Text<'_> {
    /// `bytes`: its length where that is known; only room is made by it.
    fn corrected(
        mut self,
        bytes: u64,
        settings: &Settings,
        manner: Manner,
        out: &mut impl Growing,
        progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
    ) -> Result<Program, Failure> {
        let name = self.name;
        let unread = |error: &io::Error| Failure::file(name, Deed::Read, error);
        // A small file is read at once, and room is left to see that it ends there.
        let mut head = Vec::with_capacity(bytes.min(SMALL_BYTES) as usize + 1);
        self.rest.by_ref().take(SMALL_BYTES).read_to_end(&mut head).map_err(|error| unread(&error))?;
        file::check_lines(&head, name)?;
        if (head.len() as u64) < SMALL_BYTES {
            return in_memory(&head, name, settings, manner, out, progress);
        }
        // A stream is kept on disk: it is read more than once.
        let kept = match self.kept {
            Some(still) => Kept::File(still.clone()),
            None => Kept::spool(&head, self.rest).map_err(|error| unread(&error))?,
        };
        let provenance = settings.provenance();
        let job = Job { force: manner.force, ..settings.job(&provenance)? };
        let source = rewrite::Source { head: &head, open: || kept.reading(), job: &job, manner };
        let report = |part: Part| {
            let Part { bytes, offset, first_line, diagnostics } = part;
            Report { source: Some(Source { name: name.to_owned(), bytes, offset, first_line }), diagnostics }
        };
        let mut done = source.correct(out, progress);
        if let Err(LargeEnd::AsAWhole) = done {
            out.clear().map_err(|error| unwritten(&error))?;
            done = source.correct_lowered(out, progress);
        }
        match done {
            Ok(Large { input, output, changed, figures, warnings }) => Ok(Program {
                name: name.to_owned(),
                input,
                output,
                changed,
                figures,
                warnings: warnings.into_iter().map(report).collect(),
                // What calls subprograms is worked on as a whole.
                lookups: Vec::new(),
            }),
            Err(LargeEnd::AsAWhole) => {
                drop(head);
                out.clear().map_err(|error| unwritten(&error))?;
                let text = file::read_lines(kept.reading(), name)?;
                in_memory(&text, name, settings, manner, out, progress)
            }
            Err(LargeEnd::Refused(part)) => Err(Failure::Refused(vec![report(part)])),
            Err(LargeEnd::Unread(error)) => Err(unread(&error)),
            Err(LargeEnd::Unwritten(error)) => Err(unwritten(&error)),
            Err(LargeEnd::Stopped(failure)) => Err(failure),
        }
    }
}

fn unwritten(error: &io::Error) -> Failure {
    Failure::place(&diagnostic::Text::pair("the output", "выходной файл"), Deed::Write, error)
}

fn in_memory(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    let (text, program) = correct::in_memory(text, name, settings, manner, progress)?;
    out.write_all(&text).map_err(|error| unwritten(&error))?;
    Ok(program)
}

/// A program on disk.
enum Kept {
    /// Where it was posted.
    File(Still),
    /// A copy of a stream, without a name: however the process ends, nothing is left of it.
    Spool(Arc<File>),
}

impl Kept {
    fn spool(head: &[u8], mut rest: impl Read) -> io::Result<Self> {
        let mut spool = tempfile::tempfile()?;
        spool.write_all(head)?;
        let mut part = Vec::new();
        // What has no line end will be refused when it is read, however much of it there is.
        while file::ends_lines(&part) {
            part.clear();
            let read = (&mut rest).take(file::LONGEST_LINE as u64).read_to_end(&mut part)?;
            spool.write_all(&part)?;
            if read < file::LONGEST_LINE {
                break;
            }
        }
        Ok(Self::Spool(Arc::new(spool)))
    }

    fn reading(&self) -> Reading {
        match self {
            Self::File(still) => still.reading(),
            Self::Spool(spool) => Reading::of(spool),
        }
    }
}
