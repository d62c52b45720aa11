//! Tool lengths and work offsets that the control keeps in files.

use std::path::{Path, PathBuf};

use control_files::{Ini, Length};
use diagnostic::notice;
use machine_profile::Profile;
use nc_dialect::Dialect;
use nc_syntax::Macros;

use crate::lines;
use crate::message::{Failure, OPTION};
use crate::options::JobOptions;

/// What files say of lengths and zeros; where they do, the profile's do not count.
#[derive(Default)]
pub(crate) struct Stored {
    /// `--tool-table`, or the table that an INI file names.
    pub(crate) lengths: Option<Vec<Length>>,
    /// Of the parameters that an INI file names.
    pub(crate) work_offsets: Option<Vec<(String, [f64; 3])>>,
    /// All that were read.
    pub(crate) files: Vec<PathBuf>,
}

impl Stored {
    /// Reads what the options name.
    ///
    /// # Errors
    /// Files of LinuxCNC for another control; a file cannot be read; what is wrong with it.
    pub(crate) fn load(options: &JobOptions, profile: &Profile, dialect: &Dialect) -> Result<Self, Failure> {
        if options.linuxcnc_ini.is_some() && dialect.flow.macros != Macros::LinuxCnc {
            return Err(Failure::usage(notice!(OPTION;
                "`--linuxcnc-ini` says what LinuxCNC keeps, and the dialect is {}",
                "`--linuxcnc-ini` говорит, что хранит LinuxCNC, а диалект — {}", dialect.name;
                "leave it out, or give `--dialect linuxcnc`", "уберите его или дайте `--dialect linuxcnc`"
            )));
        }
        let mut stored = Self::default();
        let ini = match &options.linuxcnc_ini {
            None => None,
            Some(path) => {
                let bytes = stored.read(path)?;
                Some((path, Ini::read(&lines::name(path), &bytes)?))
            }
        };
        let unit_mm = ini.as_ref().map(|(_, ini)| ini.unit_mm);
        // LinuxCNC takes them from the folder of its INI file.
        let beside = |path: &Path, name: &str| path.parent().unwrap_or(Path::new("")).join(name);
        if let Some((path, ini)) = &ini {
            stored.work_offsets = Some(match &ini.parameters {
                None => Vec::new(),
                Some(name) => {
                    let parameters = beside(path, name);
                    let bytes = stored.read(&parameters)?;
                    let name = lines::name(&parameters);
                    control_files::work_offsets(&name, &bytes, ini.unit_mm, profile.has_rotary())?
                }
            });
            stored.lengths = Some(Vec::new());
        }
        let of_ini = ini.as_ref().and_then(|(path, ini)| Some(beside(path, ini.tool_table.as_deref()?)));
        if let Some(path) = options.tool_table.clone().or(of_ini) {
            let bytes = stored.read(&path)?;
            stored.lengths = Some(control_files::tool_lengths(&lines::name(&path), &bytes, unit_mm)?);
        }
        Ok(stored)
    }

    fn read(&mut self, path: &Path) -> Result<Vec<u8>, Failure> {
        let bytes = std::fs::read(path).map_err(|error| Failure::unread(&lines::name(path), &error))?;
        self.files.push(path.to_owned());
        Ok(bytes)
    }
}
