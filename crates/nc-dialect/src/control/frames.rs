//! How offsets, lengths and frames are read.

use serde::Deserialize;

/// What becomes of a tool length in force behind a code that ends offsets.
///
/// ```
/// use nc_dialect::LengthAfter;
///
/// // GOST 20999-83 can be read either way: refused while a length is in force.
/// assert_eq!(nc_dialect::builtin("perspektiva").unwrap().length_under_g40, LengthAfter::Unstated);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthAfter {
    /// It stays.
    Stays,
    /// It ends.
    Ends,
    /// Nobody said: the code is refused while one is in force.
    Unstated,
}

/// What `G10 L20 Pn` writes.
///
/// ```
/// use nc_dialect::OffsetL20;
///
/// let l20 = |dialect| nc_dialect::builtin(dialect).unwrap().frames.l20;
/// assert_eq!((l20("fanuc"), l20("linuxcnc")), (OffsetL20::Numbered, OffsetL20::Position));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OffsetL20 {
    /// The numbered work offset G54.1 Pn (Fanuc).
    #[serde(rename = "numbered-offset")]
    Numbered,
    /// Work offset n, so that the axes stand at the words (LinuxCNC).
    Position,
}

/// How the codes that move the frame work together, where controls differ.
///
/// ```
/// let frames = |dialect| nc_dialect::builtin(dialect).unwrap().frames;
/// // G52 and G92 add up on one control and are one shift on the other.
/// assert!(!frames("fanuc").local_is_preset && frames("linuxcnc").local_is_preset);
/// assert!(frames("fanuc").p_selects_numbered);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRules {
    /// `G54 P1` is `G54.1 P1` (Fanuc); where false a P beside a work offset is refused.
    pub p_selects_numbered: bool,
    /// What `G10 L20` writes.
    pub l20: OffsetL20,
    /// G52 and G92 are one shift (LinuxCNC); where false they add up (Fanuc).
    pub local_is_preset: bool,
    /// The factor of G51 that a P without a point counts.
    pub scaling_step: f64,
    /// G68 without its centre turns about where the tool stands; where false it is refused.
    pub rotation_about_tool: bool,
    /// Machine coordinates are those of the axes whatever rotation, scaling or mirror is in force.
    pub machine_words_stand_alone: bool,
    /// P of an arc counts its turns (LinuxCNC).
    pub arc_turns: bool,
    /// An axis' first increment behind a change of its zero may travel that change too (Sinumerik).
    pub increments_carry_shift: bool,
}

/// What a T word does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TWord {
    /// It selects what the M code that changes the tool brings in.
    #[default]
    Selects,
    /// It may bring in the tool, and its length, at once.
    MayChange,
    /// It is a tool change itself: what the M code of the table that changes the tool does, it does.
    Changes,
}

/// Which tool length holds behind a tool change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthAtChange {
    /// The one in force before, until a code says another.
    #[default]
    Stays,
    /// That of the tool which came in.
    LoadedTool,
    /// Controls differ: until a code says one, nothing may move along the tool.
    Unsaid,
}
