//! How text is written for a control.

use serde::Deserialize;

/// How text is written.
///
/// ```
/// let output = |dialect| nc_dialect::builtin(dialect).unwrap().output.clone();
/// // LinuxCNC's interpreter reads lines of 254 bytes and their end; Sinumerik's R is another word.
/// assert_eq!(output("linuxcnc").max_block_bytes, 255);
/// assert!(!output("sinumerik").radius_word && output("fanuc").radius_word);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Decimals of an inch word; those of a millimetre word come from the profile's resolution.
    pub decimals_inch: u8,
    /// Decimals of F when it must be computed (G93).
    pub decimals_feed: u8,
    /// Longest block, bytes without its end; 0 for no limit.
    pub max_block_bytes: u32,
    /// Inserted blocks get N numbers when the program has them.
    pub number_inserted_blocks: bool,
    /// Largest N.
    pub max_block_number: u32,
    /// The control takes I J K; where false only R.
    pub centre_words: bool,
    /// The control takes R.
    pub radius_word: bool,
    /// Largest difference between an arc's radius at its start and at its end that the control takes, mm.
    pub arc_radius_tolerance_mm: f64,
    /// The same under inches, inch, where the control counts them apart.
    pub arc_radius_tolerance_inch: Option<f64>,
    /// The same as a share of the radius, where the control takes that too and it is more; 0 for none.
    pub arc_radius_tolerance_share: f64,
    /// How far the chords by which the control cuts arcs are meant to lie beside them, mm; `None` where it follows arcs.
    pub arc_chord_tolerance_mm: Option<f64>,
    /// What F of G94 counts where rotary axes turn; `None` where the control's manual leaves it open.
    pub rotary_feed: Option<RotaryFeed>,
    /// Largest F of G93 that the control reads, 1/min.
    pub largest_inverse_feed: f64,
    /// Distance above the last depth where a G83 peck resumes feeding when written as moves, mm.
    pub peck_clearance_mm: f64,
    /// Retreat of a G73 peck when written as moves, mm.
    pub chip_retreat_mm: f64,
}

/// What F of G94 counts where rotary axes turn at feed rate.
///
/// ```
/// use nc_dialect::RotaryFeed;
///
/// let counts = |dialect| nc_dialect::builtin(dialect).unwrap().output.rotary_feed;
/// assert_eq!(counts("linuxcnc"), Some(RotaryFeed::LinearAxes));
/// assert_eq!(counts("perspektiva"), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RotaryFeed {
    /// The way of X, Y, Z alone; degrees where none of them moves.
    LinearAxes,
    /// The way of all axes, a degree as a millimetre or an inch.
    AllAxes,
}

impl Output {
    /// Largest difference of an arc's radii, mm, where one unit of the program is so long.
    #[must_use]
    pub fn arc_tolerance_mm(&self, unit_mm: f64) -> f64 {
        let inches = self.arc_radius_tolerance_inch.filter(|_| unit_mm != 1.0);
        inches.map_or(self.arc_radius_tolerance_mm, |inches| inches * unit_mm)
    }
}
