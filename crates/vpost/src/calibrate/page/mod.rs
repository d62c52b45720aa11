//! What a calibration found as one page, as JSON, and as CSV of what is drawn.
//!
//! Everything here only shows: figures come from the crate `calibration`.

mod bars;
mod bars_csv;
mod circles;
mod facts;
mod found;
mod positioning;
mod runs;

use std::path::PathBuf;

use clap::Args;
use report::page::{Page, Section};

pub(super) use bars::Bars;
pub(super) use facts::Facts;
pub(super) use runs::{Positions, Read};

use crate::file;
use crate::message::Failure;
use crate::roles::Roles;

use found::Found;

/// Where what was found is shown.
#[derive(Debug, Clone, Default, Args)]
pub struct Shown {
    /// Write what was found as one page for a browser: drawings, their numbers, no network, no script.
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
    /// Whether anything is to be written.
    pub(super) fn is_asked(&self) -> bool {
        self.html.is_some() || self.json.is_some() || self.csv.is_some()
    }

    /// The files that will be written.
    pub(super) fn roles<'a>(&'a self, roles: Roles<'a>) -> Roles<'a> {
        roles
            .writes("--html", self.html.as_deref())
            .writes("--json", self.json.as_deref())
            .writes("--csv", self.csv.as_deref())
    }

    /// Writes what is asked for.
    pub(super) fn write(&self, found: &dyn Found, facts: &Facts) -> Result<(), Failure> {
        let put = |path: &Option<PathBuf>, bytes: &dyn Fn() -> Vec<u8>| match path {
            Some(path) => file::write(path, &bytes()),
            None => Ok(()),
        };
        let json = || jobs::summary::json(&facts.with(found.json()));
        put(&self.csv, &|| found.csv().into_bytes())?;
        put(&self.json, &json)?;
        put(&self.html, &|| html(found, facts, &String::from_utf8_lossy(&json())).into_bytes())
    }
}

fn html(found: &dyn Found, facts: &Facts, json: &str) -> String {
    let mut sections = found.sections();
    sections.push(Section { id: "provenance", title: "Where this comes from", body: facts.section() });
    Page {
        title: &found.title(),
        head: found.head(facts),
        sections,
        json,
        foot: &format!(
            "vpost {} calibrate. This page needs no network, holds no script and is the same for the same files. Its numbers are in it as JSON ({}).",
            env!("CARGO_PKG_VERSION"),
            facts::SCHEMA
        ),
    }
    .into_html()
}
