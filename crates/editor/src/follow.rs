//! Where a program goes on behind a line: the subprogram that it calls, the label that it jumps to.

use jobs::expand;
use lsp_types::{Location, Uri};
use nc_syntax::line_ends;

use crate::document::Document;
use crate::machine::Machine;
use crate::place::{Place, uri};

/// Where the program goes on behind a line (from 1), the first time; `None` where that is the next line.
pub(crate) fn from_line(
    document: &Document,
    place: &Place,
    machine: &Machine,
    line: u64,
) -> Option<Location> {
    let settings = &machine.settings;
    let expanded = expand::expanded(document.text().as_bytes(), place.name(), settings).ok()?;
    let lines = 1..=line_ends(expanded.text()) + 1;
    let mut behind = lines.map(|flat| expanded.source_line(flat)).skip_while(|from| *from != (0, line));
    let (file, to) = behind.find(|from| *from != (0, line))?;
    if file == 0 && (to == line + 1 || to == line) {
        return None;
    }
    let address: Option<Uri> = match expanded.file(file) {
        None => Some(place.uri.clone()),
        Some((name, _)) => settings.flow.path(name).and_then(|path| uri(&path.canonicalize().ok()?)),
    };
    let range = match expanded.file(file) {
        None => document.whole_line(to),
        Some((_, text)) => Document::new(String::from_utf8_lossy(text).into_owned()).whole_line(to),
    };
    Some(Location { uri: address?, range })
}
