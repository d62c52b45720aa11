//! Where a program lies: the editor's address of it, and the path that the command knows it by.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use jobs::lines;
use lsp_types::Uri;

/// A program's address.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) uri: Uri,
    path: PathBuf,
    /// The name in messages.
    name: String,
}

impl Place {
    /// Of an address; one that is no file's has no folder.
    pub(crate) fn of(uri: &Uri) -> Self {
        let path = path(uri).unwrap_or_else(|| PathBuf::from(uri.as_str()));
        Self { uri: uri.clone(), name: lines::name(&path), path }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The address of a file that a message names: from the folder of the command, or beside the program.
    pub(crate) fn beside(&self, name: &str) -> Option<Uri> {
        let here = self.path.parent().map(|folder| folder.join(name));
        let found = [Some(PathBuf::from(name)), here].into_iter().flatten().find(|path| path.is_file())?;
        uri(&found.canonicalize().ok()?)
    }
}

/// The path that an address of a file says.
pub(crate) fn path(uri: &Uri) -> Option<PathBuf> {
    let scheme = uri.scheme()?.as_str();
    if !scheme.eq_ignore_ascii_case("file") {
        return None;
    }
    let path = uri.path().as_estr().decode().into_string().ok()?.into_owned();
    // `/C:/nc` of Windows.
    let drive = path.as_bytes().get(2) == Some(&b':') && cfg!(windows);
    Some(PathBuf::from(if drive { &path[1..] } else { &path }))
}

/// The address of a file.
pub(crate) fn uri(path: &Path) -> Option<Uri> {
    let path = path.to_str()?.replace('\\', "/");
    let root = if path.starts_with('/') { "" } else { "/" };
    let escaped: String = path
        .bytes()
        .map(|byte| match byte {
            b'/' | b'-' | b'.' | b'_' | b'~' | b':' => char::from(byte).to_string(),
            _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect();
    Uri::from_str(&format!("file://{root}{escaped}")).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_paths_are_one() {
        let path = Path::new("/nc/деталь 1%.nc");
        let uri = uri(path).unwrap();
        assert_eq!(uri.as_str(), "file:///nc/%D0%B4%D0%B5%D1%82%D0%B0%D0%BB%D1%8C%201%25.nc");
        assert_eq!(Place::of(&uri).path(), path);
        let new = Uri::from_str("untitled:Untitled-1").unwrap();
        assert_eq!(Place::of(&new).name(), "untitled:Untitled-1");
    }
}
