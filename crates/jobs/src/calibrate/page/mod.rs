//! What a calibration found as one page, as JSON, and as CSV of what is drawn.
//!
//! Everything here only shows: figures come from the crate `calibration`.

mod bars;
mod bars_csv;
mod circle_verdict;
mod circles;
mod facts;
mod found;
mod positioning;
mod runs;

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::Language;
use report::page::Page;

pub(super) use bars::Bars;
pub(super) use facts::Facts;
pub(super) use found::Found;
pub(super) use runs::{Positions, Read};

use super::output::Target;
use super::work::Work;
use crate::message::Failure;

/// Where what was found is shown.
#[derive(Debug, Clone, Default, Args)]
pub struct Shown {
    /// Write a page for a browser: drawings, numbers.
    ///
    /// One file; no network, no script.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write what was found as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the numbers of the drawings as CSV.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Shown {
    /// Page, JSON and CSV: where they go.
    pub(super) fn files(&self) -> [Option<&Path>; 3] {
        [&self.html, &self.json, &self.csv].map(Option::as_deref)
    }

    /// Makes what is asked for of a calibration that is finished, its profile made where that was asked.
    ///
    /// * `temperature_c` – of the machine, as the files say it; `--temperature` goes before it
    /// * `uncertainty_mm` – what the deviation keeps at 95 % of the places of the volume, where that is known
    pub(super) fn write(
        &self,
        found: &dyn Found,
        files: &[PathBuf],
        target: &Target,
        work: &Work<'_>,
        temperature_c: Option<f64>,
        uncertainty_mm: Option<f64>,
    ) -> Result<(), Failure> {
        if self.html.is_none() && self.json.is_none() && self.csv.is_none() {
            return Ok(());
        }
        let temperature_c = target.temperature.or(temperature_c);
        let facts = &Facts::new(target, work, files, temperature_c, uncertainty_mm)?;
        let json = || crate::summary::json(&facts.with(found.json()));
        work.show(self.csv.as_ref(), || found.csv().into_bytes());
        work.show(self.json.as_ref(), json);
        work.show(self.html.as_ref(), || {
            html(found, facts, &String::from_utf8_lossy(&json()), work.setting.language).into_bytes()
        });
        Ok(())
    }
}

fn html(found: &dyn Found, facts: &Facts, json: &str, language: Language) -> String {
    let mut page = Page::new(language, found.title(), "calibrate", facts::SCHEMA);
    found.head(&mut page.head, facts);
    found.sections(&mut page);
    page.provenance(facts.rows());
    page.into_html(json)
}
