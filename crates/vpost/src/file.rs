//! Files: read whole, written whole or not at all.

use std::io::{BufRead, BufReader, IsTerminal, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub(crate) use jobs::lines::{LONGEST_LINE, check_lines, ends_lines, name, read_lines};

use crate::growing::{Growing, GrowingFile, Nursery, sweep};
use crate::message::{Deed, Failure};
use crate::source::Still;
use crate::terminal;
use crate::to_disk::{self, ToDisk};
use diagnostic::{Text, both};
use rewrite::Digest;

/// A name without its folders, which stand at the end of a page.
pub(crate) fn without_folders(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// What to say where something cannot be done with a file.
pub(crate) fn fails(path: &Path, deed: Deed) -> impl Fn(std::io::Error) -> Failure {
    move |error| Failure::file(&name(path), deed, &error)
}

/// Reads a file, or standard input for `-`.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let result = if path.as_os_str() == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    result.map_err(fails(path, Deed::Read))
}

/// Reads a program. Gives up at the first megabyte that holds text and no line end, whatever follows; refuses a file that
/// changes meanwhile.
pub(crate) fn read_program(path: &Path) -> Result<Vec<u8>, Failure> {
    let name = name(path);
    if path.as_os_str() == "-" {
        return read_lines(std::io::stdin().lock(), &name);
    }
    let fail = |error: std::io::Error| Failure::file(&name, Deed::Read, &error);
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return read_lines(std::fs::File::open(path).map_err(fail)?, &name);
    }
    let still = Still::open(path).map_err(fail)?;
    let text = read_lines(still.reading(), &name)?;
    still.unchanged(path, &name)?;
    Ok(text)
}

/// Outputs beyond this that are not beside their file wait on disk, smaller ones in memory.
const SPOOLED_BYTES: usize = 16 << 20;

/// Where a result grows before it is shown: beside the file it becomes, or out of sight.
///
/// A file is there whole or, where that fails, an earlier one is left as it was; standard output gets nothing
/// before all of it is known to be right.
#[derive(Debug)]
pub(crate) struct Output {
    path: Option<PathBuf>,
    /// What is written to.
    place: Place,
    to_disk: ToDisk,
}

/// Where that is.
#[derive(Debug)]
pub(crate) enum Place {
    /// Takes the place of the file in the end.
    Beside(GrowingFile),
    /// Is copied in the end: devices and pipes cannot be replaced.
    Apart(tempfile::SpooledTempFile),
}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What makes two paths one file: links and other spellings. None where nothing is there.
#[cfg(unix)]
pub(crate) fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().ok().map(|found| (found.dev(), found.ino()))
}
#[cfg(not(unix))]
pub(crate) fn identity(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}

/// Where a path leads through links, whether anything is there or not: what is written to a link is its target's.
pub(crate) fn target(path: &Path) -> PathBuf {
    /// More than any system follows.
    const MOST_LINKS: usize = 64;
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&place) {
            Ok(next) => place = folder_of(&place).join(next),
            Err(_) => break,
        }
    }
    place
}

impl Output {
    /// An output to a file, or to standard output.
    pub(crate) fn new(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(to) = path.map(target) else {
            let place = Place::Apart(tempfile::spooled_tempfile(SPOOLED_BYTES));
            return Ok(Self { path: None, place, to_disk: ToDisk::default() });
        };
        let fail = |error: &std::io::Error| Failure::file(&name(&to), Deed::Write, error);
        if let (true, Err(error)) = (to.is_symlink(), to.metadata()) {
            // It leads in a circle.
            return Err(fail(&error));
        }
        if to.is_dir() {
            return Err(fail(&std::io::Error::from(std::io::ErrorKind::IsADirectory)));
        }
        let place = if to.exists() && !to.is_file() {
            Place::Apart(tempfile::spooled_tempfile(SPOOLED_BYTES))
        } else {
            // An overwritten file keeps its owner and its permissions.
            let old = to.metadata().ok();
            Place::Beside(
                Nursery::new(folder_of(&to).to_owned()).file(old.as_ref()).map_err(|error| fail(&error))?,
            )
        };
        Ok(Self { path: Some(to), place, to_disk: ToDisk::default() })
    }

    /// Puts lines in front of what standard output will get, behind a `%` that opens it; what is there then.
    pub(crate) fn put_in_front(&mut self, lines: &[String]) -> std::io::Result<Digest> {
        let Place::Apart(apart) = &mut self.place else {
            return Err(std::io::Error::from(std::io::ErrorKind::InvalidInput));
        };
        apart.rewind()?;
        let mut rest = BufReader::new(apart);
        let mut first = Vec::new();
        rest.read_until(b'\n', &mut first)?;
        let end = if first.ends_with(b"\r\n") { "\r\n" } else { "\n" };
        let lines: String = lines.iter().map(|line| format!("{line}{end}")).collect();
        let at = if first.starts_with(b"%") { first.len() } else { 0 };
        first.splice(at..at, lines.into_bytes());
        let mut grown = tempfile::spooled_tempfile(SPOOLED_BYTES);
        let bytes = std::io::copy(&mut first.as_slice().chain(rest), &mut grown)?;
        grown.rewind()?;
        let hash = blake3::Hasher::new().update_reader(&mut grown)?.finalize();
        self.place = Place::Apart(grown);
        Ok(Digest { bytes, hash: Some(hash) })
    }

    /// Shows it. A file is then on the disk under its name, whatever becomes of the power.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let named = self.path.as_deref().map_or_else(|| "standard output".to_owned(), name);
        let fail = |error: &std::io::Error| Failure::file(&named, Deed::Write, error);
        match (self.place, self.path.as_deref()) {
            (Place::Beside(beside), Some(path)) => {
                self.to_disk.finish(beside.file()).map_err(|error| fail(&error))?;
                sweep(folder_of(path));
                beside
                    .put_new(path)
                    .or_else(|(_, beside)| beside.replace(folder_of(path), path))
                    .and_then(|()| to_disk::names(folder_of(path)))
                    .map_err(|error| fail(&error))
            }
            (Place::Beside(_), None) => Ok(()),
            (Place::Apart(mut apart), path) => {
                apart.seek(SeekFrom::Start(0)).map_err(|error| fail(&error))?;
                match path {
                    Some(path) => {
                        let mut out = std::fs::OpenOptions::new()
                            .write(true)
                            .open(path)
                            .map_err(|error| fail(&error))?;
                        std::io::copy(&mut apart, &mut out).map(|_| ()).map_err(|error| fail(&error))
                    }
                    None => {
                        if std::io::stdout().is_terminal() {
                            terminal::obeys_nothing_of(&mut apart)?;
                            apart.seek(SeekFrom::Start(0)).map_err(|error| fail(&error))?;
                        }
                        printed(|out| std::io::copy(&mut apart, out).map(|_| ()))
                    }
                }
            }
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.place.write(bytes)?;
        if let Place::Beside(beside) = &self.place {
            self.to_disk.wrote(beside.file(), written);
        }
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.place.flush()
    }
}

impl Growing for Output {
    fn clear(&mut self) -> std::io::Result<()> {
        self.place.clear()
    }
}

impl Write for Place {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Beside(beside) => beside.write(bytes),
            Self::Apart(apart) => apart.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Self::Beside(beside) => beside.flush(),
            Self::Apart(apart) => apart.flush(),
        }
    }
}

impl Growing for Place {
    fn clear(&mut self) -> std::io::Result<()> {
        match self {
            Self::Beside(beside) => beside.clear(),
            Self::Apart(apart) => {
                apart.set_len(0)?;
                apart.rewind()
            }
        }
    }
}

/// Writes a file so that it is there whole or, where that fails, an earlier one is left as it was.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    written(path, bytes)?.finish()
}

/// A file that is written and not shown yet.
pub(crate) fn written(path: &Path, bytes: &[u8]) -> Result<Output, Failure> {
    let mut output = Output::new(Some(path))?;
    output.write_all(bytes).map_err(fails(path, Deed::Write))?;
    Ok(output)
}

/// Prints a report, a table or JSON to standard output; of names and ids in it a terminal obeys nothing.
pub(crate) fn print(bytes: &[u8]) -> Result<(), Failure> {
    match std::str::from_utf8(bytes) {
        Ok(text) => printed(|out| out.write_all(terminal::shown(text).as_bytes())),
        Err(_) => printed(|out| out.write_all(bytes)),
    }
}

fn printed(print: impl FnOnce(&mut std::io::StdoutLock<'_>) -> std::io::Result<()>) -> Result<(), Failure> {
    if !open_streams::is_stdout_open() {
        let closed = std::io::Error::other(both!(
            "it was closed before vpost began",
            "он был закрыт до начала работы vpost"
        ));
        return Err(Failure::place(
            &Text::pair("standard output", "стандартный вывод"),
            Deed::WriteTo,
            &closed,
        ));
    }
    let mut out = std::io::stdout().lock();
    match print(&mut out).and_then(|()| out.flush()) {
        // Whoever reads has seen enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::Check),
        result => result.map_err(|error| {
            Failure::place(&Text::pair("standard output", "стандартный вывод"), Deed::WriteTo, &error)
        }),
    }
}
