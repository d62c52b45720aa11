//! What a page of a turned part is made of.

use jobs::turned::judged::Outline;
use jobs::turned::surface::{Surface, Turned};

use super::round::Drawn;
use crate::message::Failure;
use crate::settings::Settings;

/// What the main job makes of the program.
pub(in crate::turned) enum Correction {
    /// What the lathe turns by the corrected one.
    Turned(Turned),
    /// Nothing to correct.
    Unchanged,
    /// It is refused, for this.
    Refused(Failure),
}

/// What the page is made of besides the surface.
pub(in crate::turned) struct Facts<'a> {
    /// The program, as it is called.
    pub(in crate::turned) name: &'a str,
    /// Its bytes.
    pub(in crate::turned) text: &'a [u8],
    pub(in crate::turned) settings: &'a Settings,
    /// Z of the cross sections that are wanted, from the chuck, mm.
    pub(in crate::turned) at_mm: &'a [f64],
}

/// All that the sections are made of.
pub(super) struct Shown<'a> {
    pub(super) facts: &'a Facts<'a>,
    pub(super) surface: &'a Surface,
    pub(super) turned: &'a Turned,
    pub(super) correction: &'a Correction,
    pub(super) before: Outline,
    pub(super) after: Option<Outline>,
    pub(super) sections: Vec<Drawn>,
}
