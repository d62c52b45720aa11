//! The machine that a program is for: profile, dialect and options, read once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use diagnostic::{Language, Text, both, notice, of_toml};
use jobs::causes::Causes;
use jobs::conditions::conditions;
use jobs::message::{Failure, OPTION};
use jobs::options::JobOptions;
use jobs::settings::Settings;
use nc_dialect::Dialect;
use serde_json::Value;

/// What holds for a program: of what the editor was told, and of what stands beside the program.
pub type Find = fn(program: &Path, told: &JobOptions) -> Result<JobOptions, Failure>;

/// Everything a program is read with.
pub(crate) struct Machine {
    pub(crate) settings: Settings,
    /// The machine without each of its causes of error.
    pub(crate) causes: Option<Causes>,
}

impl Machine {
    fn load(options: &JobOptions) -> Result<Self, Failure> {
        let settings = Settings::load(options)?;
        let causes = Causes::of(&settings.profile, settings.engine.id(), &conditions(options)?)?;
        Ok(Self { settings, causes })
    }
}

/// Machines by their options.
pub(crate) struct Machines {
    find: Find,
    told: JobOptions,
    /// What was found for each program.
    found: BTreeMap<PathBuf, JobOptions>,
    known: Vec<(JobOptions, Machine)>,
}

impl Machines {
    pub(crate) const fn new(find: Find, told: JobOptions) -> Self {
        Self { find, told, found: BTreeMap::new(), known: Vec::new() }
    }

    /// Other options hold.
    pub(crate) fn tell(&mut self, told: JobOptions) {
        *self = Self::new(self.find, told);
    }

    /// Files that they were read from may be others now.
    pub(crate) fn forget(&mut self) {
        self.found.clear();
        self.known.clear();
    }

    /// What holds for a program. Settings are looked for once, not behind every key that is pressed.
    fn options(&mut self, program: &Path) -> Result<JobOptions, Failure> {
        if let Some(found) = self.found.get(program) {
            return Ok(found.clone());
        }
        let found = (self.find)(program, &self.told)?;
        self.found.insert(program.to_owned(), found.clone());
        Ok(found)
    }

    /// How a program is spelled, where its machine is not known too.
    pub(crate) fn dialect(&mut self, program: &Path) -> Option<&Dialect> {
        let name = self.options(program).ok()?.dialect;
        match self.of(program) {
            Ok(machine) => Some(&machine.settings.dialect),
            Err(_) => nc_dialect::builtin(&name?),
        }
    }

    /// The machine of a program.
    pub(crate) fn of(&mut self, program: &Path) -> Result<&Machine, Failure> {
        let options = self.options(program)?;
        let known = self.known.iter().position(|(known, _)| *known == options);
        let at = match known {
            Some(at) => at,
            None => {
                let machine = Machine::load(&options)?;
                self.known.push((options, machine));
                self.known.len() - 1
            }
        };
        Ok(&self.known[at].1)
    }
}

/// What an editor's settings say.
#[derive(Default)]
pub(crate) struct Told {
    pub(crate) options: JobOptions,
    pub(crate) language: Option<Language>,
    /// Keys and values that are none; the others hold without them.
    pub(crate) wrong: Vec<Failure>,
}

/// Options as a manifest spells them, and `language`; paths from the editor's folder on.
pub(crate) fn told(settings: &Value, folder: Option<&Path>) -> Told {
    let mut told = Told::default();
    let mut wrong = |why: Text| {
        told.wrong.push(Failure::usage(notice!(OPTION;
            both!("a setting of the editor cannot be understood: {why}", "настройка редактора непонятна: {why:#}");
            "its keys are those of docs/how-to/editor.md", "её ключи перечислены в docs/how-to/editor.ru.md"
        )));
    };
    let mut options = JobOptions::default();
    for (key, value) in settings.as_object().into_iter().flatten().filter(|(_, value)| !value.is_null()) {
        if key == "language" {
            told.language = value.as_str().and_then(Language::from_name);
            if told.language.is_none() {
                wrong(both!("`language` is `en` or `ru`", "`language` — это `en` или `ru`"));
            }
            continue;
        }
        match serde_json::from_value::<JobOptions>(serde_json::json!({ key: value })) {
            Ok(one) => options = one.over(&options),
            Err(error) => {
                let why = of_toml(&error.to_string());
                wrong(both!("`{key}`: {why}", "`{key}`: {why:#}"));
            }
        }
    }
    if let Some(folder) = folder {
        let from = |path: &mut PathBuf| *path = folder.join(&*path);
        let single = [&mut options.machine, &mut options.tool_table, &mut options.linuxcnc_ini];
        single.into_iter().flatten().chain(&mut options.include).for_each(from);
        let table = options.dialect.as_mut().filter(|name| name.ends_with(".toml"));
        table.into_iter().for_each(|name| *name = folder.join(&*name).to_string_lossy().into_owned());
    }
    Told { options, ..told }
}
