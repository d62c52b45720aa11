//! What a page is about besides its figures: files, machine, instrument, command.

use std::path::PathBuf;

use diagnostic::{Language, say};
use maud::{Markup, html};
use report::text::{Numbers, shown};
use serde_json::{Value, json};

use crate::arguments::Shared;
use crate::figures::round;
use crate::message::Failure;
use crate::origin::{command, command_row};
use crate::{file, profile};

use super::super::output::Target;

/// What the JSON is called.
pub(super) const SCHEMA: &str = "vpost.calibration/1";

/// A file by name and content.
struct Named {
    name: String,
    /// None of standard input, which was read once.
    hash: Option<String>,
}

/// What the page says of where it comes from.
pub(in super::super) struct Facts {
    files: Vec<Named>,
    base: Option<(String, Named)>,
    /// The profile that was written.
    pub(in super::super) written: Option<PathBuf>,
    written_hash: Option<String>,
    instrument: Option<String>,
    date: Option<String>,
    temperature_c: Option<f64>,
    uncertainty_um: Option<f64>,
    command: String,
}

impl Facts {
    /// Of a calibration that is finished, its profile written where that was asked.
    ///
    /// * `temperature_c` – of the machine, as the options or the files say it
    /// * `uncertainty_mm` – what the deviation keeps at 95 % of the places of the volume, where that is known
    pub(in super::super) fn new(
        target: &Target,
        shared: &Shared,
        files: &[PathBuf],
        temperature_c: Option<f64>,
        uncertainty_mm: Option<f64>,
    ) -> Result<Self, Failure> {
        let named = |path: &PathBuf| -> Result<Named, Failure> {
            let hash = match path.as_os_str() == "-" {
                true => None,
                false => Some(blake3::hash(&file::read(path)?).to_string()),
            };
            Ok(Named { name: file::name(path), hash })
        };
        let base = match &shared.job.machine {
            Some(path) => {
                let loaded = profile::load(path)?;
                let named = Named { name: file::name(path), hash: Some(loaded.hash.to_string()) };
                Some((loaded.profile.name, named))
            }
            None => None,
        };
        let written_hash = match &target.output {
            Some(path) => Some(profile::load(path)?.hash.to_string()),
            None => None,
        };
        Ok(Self {
            files: files.iter().map(named).collect::<Result<_, _>>()?,
            base,
            written: target.output.clone(),
            written_hash,
            instrument: target.instrument.clone(),
            date: target.date.clone(),
            temperature_c,
            uncertainty_um: uncertainty_mm.map(|u| round(u * 1e3, 3)),
            command: command(),
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
                "name": file::name(path),
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

    /// The section at the end of the page.
    pub(super) fn section(&self, language: Language) -> Markup {
        let said = |value: &Option<String>, option: &str| {
            html! {
                @match value {
                    Some(value) => (shown(value)),
                    None => span.muted { (say!(language, "not stated ({option})", "не указано ({option})")) },
                }
            }
        };
        let named = |f: &Named| {
            html! {
                (shown(&f.name))
                @if let Some(hash) = &f.hash { " " span.muted { "BLAKE3 " (hash) } }
            }
        };
        let temperature =
            self.temperature_c.map(|t| language.figures(format!("{} \u{b0}C", crate::number::short(t, 2))));
        html! {
            dl {
                @for file in &self.files { dt { (say!(language, "measurements", "измерения")) } dd { (named(file)) } }
                @if let Some((machine, base)) = &self.base {
                    dt { (say!(language, "machine", "станок")) } dd { (shown(machine)) }
                    dt { (say!(language, "base profile and its tables", "исходный профиль и его таблицы")) }
                    dd { (named(base)) }
                }
                @if let (Some(path), Some(hash)) = (&self.written, &self.written_hash) {
                    dt { (say!(language, "profile written, with its tables", "записанный профиль с таблицами")) }
                    dd { (shown(&file::name(path))) " " span.muted { "BLAKE3 " (hash) } }
                }
                dt { (say!(language, "instrument", "прибор")) } dd { (said(&self.instrument, "--instrument")) }
                dt { (say!(language, "date", "дата")) } dd { (said(&self.date, "--date")) }
                dt { (say!(language, "temperature", "температура")) } dd { (said(&temperature, "--temperature")) }
                @if let Some(u) = self.uncertainty_um {
                    dt { (say!(language, "uncertainty", "неопределённость")) }
                    dd {
                        (say!(
                            language,
                            "{} \u{b5}m, which 95 % of the places of the volume keep",
                            "{} мкм, её выдерживают 95 % мест рабочего объёма",
                            language.digits(u, 3)
                        ))
                    }
                }
                dt { (say!(language, "made by", "создано")) } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", " (SCHEMA) }
                (command_row(language))
            }
        }
    }
}
