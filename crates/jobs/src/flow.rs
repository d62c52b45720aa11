//! What programs with flow are given: values of variables, folders of subprograms.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::notice;
use nc_expand::{Limits, Preset};

use crate::message::{Failure, OPTION};
use crate::options::JobOptions;

/// A subprogram's file is no larger.
const LARGEST_FILE: u64 = 64 << 20;

/// What `--set` and `--include` say.
#[derive(Debug, Clone, Default)]
pub struct Flow {
    presets: Vec<Preset>,
    folders: Vec<PathBuf>,
    /// Where work ends that would not.
    pub limits: Limits,
}

impl Flow {
    /// Reads the options.
    ///
    /// # Errors
    /// A folder that is none.
    pub fn load(options: &JobOptions) -> Result<Self, Failure> {
        for folder in &options.include {
            if !folder.is_dir() {
                return Err(Failure::usage(notice!(OPTION;
                    "`--include {}` is no folder", "`--include {}` — не папка", folder.display();
                    "give the folder that holds the subprograms", "дайте папку, где лежат подпрограммы"
                )));
            }
        }
        let presets = options.set.iter().map(|given| (**given).clone()).collect();
        Ok(Self { presets, folders: options.include.clone(), limits: Limits::default() })
    }

    /// Values of variables.
    #[must_use]
    pub fn presets(&self) -> &[Preset] {
        &self.presets
    }

    /// A subprogram's file in the first folder that has it.
    #[must_use]
    pub fn path(&self, name: &str) -> Option<PathBuf> {
        self.folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file())
    }

    /// Reads a subprogram's file from the first folder that has it.
    pub(crate) fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let mut parts = Path::new(name).components();
        let plain = matches!((parts.next(), parts.next()), (Some(std::path::Component::Normal(_)), None));
        if !plain {
            return Err(io::Error::from(io::ErrorKind::InvalidInput));
        }
        for folder in &self.folders {
            let path = folder.join(name);
            if !path.is_file() {
                continue;
            }
            // A link may lead anywhere.
            if !path.canonicalize()?.starts_with(folder.canonicalize()?) {
                return Err(io::Error::from(io::ErrorKind::InvalidInput));
            }
            if path.metadata()?.len() > LARGEST_FILE {
                return Err(io::Error::other(format!("longer than {LARGEST_FILE} bytes")));
            }
            return std::fs::read(path);
        }
        Err(io::Error::from(io::ErrorKind::NotFound))
    }
}
