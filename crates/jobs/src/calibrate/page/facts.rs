//! What a page is about besides its figures: files, machine, instrument, command.

use std::path::PathBuf;

use diagnostic::{Text, both};
use report::body::{Body, Fact};
use report::numbers::digits;
use report::text::{MACHINE, MEASUREMENTS};
use serde_json::{Value, json};

use crate::figures::{celsius, round};
use crate::message::Failure;
use crate::{lines, profile};

use super::super::output::Target;
use super::super::work::Work;

/// What the JSON is called.
pub(super) const SCHEMA: &str = "vpost.calibration/1";

/// A file by name and content.
struct Named {
    name: String,
    /// None of standard input, which was read once.
    hash: Option<String>,
}

impl Named {
    fn fact(&self, name: Text) -> Fact {
        Fact::file(name, &self.name, self.hash.clone())
    }
}

/// What the page says of where it comes from.
pub(in super::super) struct Facts {
    files: Vec<Named>,
    base: Option<(String, Named)>,
    /// The profile that was written.
    written: Option<PathBuf>,
    written_hash: Option<String>,
    instrument: Option<String>,
    date: Option<String>,
    temperature_c: Option<f64>,
    uncertainty_um: Option<f64>,
    command: Option<String>,
}

impl Facts {
    /// Of a calibration that is finished, its profile written where that was asked.
    ///
    /// * `temperature_c` – of the machine, as the options or the files say it
    /// * `uncertainty_mm` – what the deviation keeps at 95 % of the places of the volume, where that is known
    pub(in super::super) fn new(
        target: &Target,
        work: &Work<'_>,
        files: &[PathBuf],
        temperature_c: Option<f64>,
        uncertainty_mm: Option<f64>,
    ) -> Result<Self, Failure> {
        let named = |path: &PathBuf| -> Result<Named, Failure> {
            let hash = match path.as_os_str() == "-" {
                true => None,
                false => Some(blake3::hash(&work.read(path)?.1).to_string()),
            };
            Ok(Named { name: lines::name(path), hash })
        };
        let base = match &work.options.machine {
            Some(path) => {
                let loaded = profile::load(path)?;
                let named = Named { name: lines::name(path), hash: Some(loaded.hash.to_string()) };
                Some((loaded.profile.name, named))
            }
            None => None,
        };
        let written_hash = work.made.borrow().profile.as_ref().map(|written| written.hash.to_string());
        Ok(Self {
            files: files.iter().map(named).collect::<Result<_, _>>()?,
            base,
            written: target.output.clone(),
            written_hash,
            instrument: target.instrument.clone(),
            date: target.date.clone(),
            temperature_c,
            uncertainty_um: uncertainty_mm.map(|u| round(u * 1e3, 3)),
            command: work.setting.command.clone(),
        })
    }

    /// Names of the files, without their folders.
    pub(in super::super) fn names(&self) -> String {
        let last = |f: &Named| f.name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let names: Vec<String> = self.files.iter().map(last).collect();
        names.join(", ")
    }

    /// Figures with what they come from.
    pub(super) fn with(&self, mut found: Value) -> Value {
        let file = |f: &Named| json!({ "name": f.name, "blake3": f.hash });
        let made = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": self.command,
            "files": self.files.iter().map(file).collect::<Vec<_>>(),
            "base": self.base.as_ref().map(|(_, base)| file(base)),
            "profile": self.written.as_ref().map(|path| json!({
                "name": lines::name(path),
                "blake3": self.written_hash,
            })),
            "instrument": self.instrument,
            "date": self.date,
            "temperature_c": self.temperature_c.map(|t| round(t, 3)),
            "uncertainty_um": self.uncertainty_um,
        });
        found["schema"] = json!(SCHEMA);
        found["made"] = made;
        found
    }

    /// Whether there is a profile to correct by.
    pub(in super::super) fn say_written(&self, out: &mut Body) {
        match &self.written {
            Some(path) => out.p(&both!("Written to {}.", "Записано в {}.", lines::name(path))),
            None => out.muted(&both!(
                "No profile was written: add -o PROFILE.toml to correct by these readings.",
                "Профиль не записан: чтобы исправлять по этим измерениям, добавьте -o PROFILE.toml."
            )),
        }
    }

    /// For the section at the end of the page.
    pub(super) fn rows(&self) -> Vec<Fact> {
        let said = |name: Text, value: Option<Text>, option: &str| match value {
            Some(value) => Fact::new(name, &value),
            None => Fact::unknown(name, both!("not stated ({option})", "не указано ({option})")),
        };
        let mut all: Vec<Fact> = self.files.iter().map(|file| file.fact(MEASUREMENTS)).collect();
        if let Some((machine, base)) = &self.base {
            all.push(Fact::same(MACHINE, machine));
            all.push(base.fact(both!("base profile and its tables", "исходный профиль и его таблицы")));
        }
        if let (Some(path), Some(hash)) = (&self.written, &self.written_hash) {
            let name = both!("profile written, with its tables", "записанный профиль с таблицами");
            all.push(Fact::file(name, &lines::name(path), Some(hash.clone())));
        }
        let [instrument, date] = [&self.instrument, &self.date].map(|value| value.as_ref().map(Text::same));
        all.push(said(both!("instrument", "прибор"), instrument, "--instrument"));
        all.push(said(both!("date", "дата"), date, "--date"));
        let temperature = self.temperature_c.map(celsius);
        all.push(said(both!("temperature", "температура"), temperature, "--temperature"));
        all.extend(self.uncertainty_um.map(|um| {
            let um = digits(um, 3);
            let kept = both!(
                "{um} \u{b5}m, which 95 % of the places of the volume keep",
                "{um:#} мкм, её выдерживают 95 % мест рабочего объёма"
            );
            Fact::new(both!("uncertainty", "неопределённость"), &kept)
        }));
        let command = self.command.as_ref();
        all.extend(command.map(|typed| Fact::typed(both!("command", "команда"), typed.clone())));
        all
    }
}
