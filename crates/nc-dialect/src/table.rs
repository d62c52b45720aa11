//! The shape of a grammar file.

use std::collections::BTreeMap;

use crate::control::{CycleBack, CycleLevels, LengthAtChange, OffsetL20, PointFree, RotaryFeed, TWord};
use nc_syntax::{Colon, Macros, Semicolon};
use serde::Deserialize;
use toml::Spanned;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Grammar {
    pub(crate) title: String,
    /// The shipped table that has all that is not said here.
    pub(crate) extends: Option<String>,
    #[serde(default)]
    pub(crate) assumptions: Vec<String>,
    pub(crate) text: Text,
    pub(crate) numbers: NumberRules,
    pub(crate) start: Start,
    #[serde(default)]
    pub(crate) flow: FlowRules,
    pub(crate) cycles: Cycles,
    pub(crate) tool_length: ToolLength,
    #[serde(default)]
    pub(crate) frames: Frames,
    pub(crate) output: OutputRules,
    #[serde(default)]
    pub(crate) words: BTreeMap<Spanned<String>, WordRow>,
    pub(crate) codes: BTreeMap<Spanned<String>, CodeRow>,
    #[serde(default)]
    pub(crate) m_codes: BTreeMap<Spanned<String>, MRow>,
    #[serde(default)]
    pub(crate) commands: BTreeMap<Spanned<String>, CommandRow>,
    /// Codes and commands that say how near the control keeps to the path.
    #[serde(default)]
    pub(crate) path_control: BTreeMap<Spanned<String>, Spanned<String>>,
    #[serde(default)]
    pub(crate) lathe: Vec<LatheRow>,
    pub(crate) turning: Option<TurningRules>,
}

/// How a block is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Text {
    pub(crate) round_brackets: RoundBrackets,
    pub(crate) semicolon: Semicolon,
    pub(crate) end_of_block: Option<Spanned<char>>,
    pub(crate) block_delete: Option<Spanned<char>>,
    #[serde(default)]
    pub(crate) percent: PercentRule,
    #[serde(default)]
    pub(crate) colon: Colon,
    #[serde(default)]
    pub(crate) equals_words: bool,
    #[serde(default)]
    pub(crate) labels: bool,
    /// Names of several letters, and the letter that they stand for.
    #[serde(default)]
    pub(crate) long_words: BTreeMap<String, Spanned<char>>,
    pub(crate) letters: Spanned<String>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RoundBrackets {
    None,
    Comment,
    NestedComment,
    Command,
}

/// What stands behind `%`.
#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PercentRule {
    #[default]
    Name,
    NameAndWords,
}

/// How numbers are written and read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct NumberRules {
    pub(crate) without_point: PointFree,
    pub(crate) least_increment_decimals_mm: Spanned<u8>,
    pub(crate) least_increment_decimals_inch: Spanned<u8>,
    #[serde(default)]
    pub(crate) spaces_inside: bool,
    pub(crate) dwell_time: Option<Spanned<String>>,
}

/// State at the start of a program.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Start {
    pub(crate) codes: Vec<Spanned<String>>,
    #[serde(default)]
    pub(crate) unit: StartUnit,
}

/// What a lathe's programs have.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TurningRules {
    pub(crate) increments: bool,
    pub(crate) offset_in_t: bool,
    pub(crate) offset_in_d: bool,
    pub(crate) thread_lead: LeadName,
    /// Name of the G-code system of `[codes]`, where there are several.
    pub(crate) system: Option<String>,
    pub(crate) systems: BTreeMap<String, SystemRules>,
}

/// The letter of a thread's lead.
#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub(crate) enum LeadName {
    #[default]
    F,
    K,
}

/// Another G-code system: what it has in place of `[codes]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SystemRules {
    #[serde(default)]
    pub(crate) increments: bool,
    #[serde(default)]
    pub(crate) without: Vec<Spanned<String>>,
    pub(crate) start: Vec<Spanned<String>>,
    pub(crate) codes: BTreeMap<Spanned<String>, CodeRow>,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum StartUnit {
    /// That of `codes`.
    #[default]
    Set,
    /// That of the program before.
    Kept,
}

/// A block by which a lathe's program is known.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LatheRow {
    #[serde(default)]
    pub(crate) codes: Vec<Spanned<String>>,
    #[serde(default)]
    pub(crate) commands: Vec<String>,
    #[serde(default)]
    pub(crate) alone: bool,
    pub(crate) with: Option<Spanned<String>>,
    pub(crate) without: Option<Spanned<String>>,
    pub(crate) digits: Option<Spanned<String>>,
    #[serde(default)]
    pub(crate) sure: bool,
    pub(crate) says: String,
    pub(crate) mill: String,
}

/// Variables, program flow and subprograms.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FlowRules {
    #[serde(default)]
    pub(crate) macros: Macros,
    #[serde(default)]
    pub(crate) packed_repeats: bool,
    #[serde(default)]
    pub(crate) full_circle_atan: bool,
    #[serde(default)]
    pub(crate) corner_words: bool,
    /// M97 P1000 calls the blocks from N1000 on, M99 returns.
    #[serde(default)]
    pub(crate) local_calls: bool,
    /// ATAN takes one value.
    #[serde(default)]
    pub(crate) one_value_atan: bool,
    /// First and last number of programs that are the control's own.
    pub(crate) control_programs: Option<(u32, u32)>,
}

/// Drilling cycles.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cycles {
    pub(crate) levels: CycleLevels,
    /// Letters that count the holes of a block.
    #[serde(default)]
    pub(crate) repeats: String,
    #[serde(default)]
    pub(crate) zero_repeats: ZeroRepeats,
    #[serde(default)]
    pub(crate) bottom_lies_below_r: bool,
    pub(crate) written_out: Option<WrittenOut>,
    pub(crate) peck_clearance_mm: Spanned<f64>,
    pub(crate) chip_retreat_mm: Spanned<f64>,
}

/// Cycles that are written out as moves: letters of the level where the feed begins and of the bottom, and what says where
/// they return to.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WrittenOut {
    pub(crate) level: Spanned<char>,
    pub(crate) bottom: Spanned<char>,
    pub(crate) back: CycleBack,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ZeroRepeats {
    #[default]
    Refused,
    Define,
}

/// G43.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToolLength {
    pub(crate) without_h: WithoutH,
    #[serde(default)]
    pub(crate) under_g40: UnderG40,
    #[serde(default)]
    pub(crate) under_g49: UnderG49,
    #[serde(default)]
    pub(crate) alone: Alone,
    #[serde(default)]
    pub(crate) t_word: TWord,
    #[serde(default)]
    pub(crate) at_change: LengthAtChange,
    #[serde(default)]
    pub(crate) writes_lengths: bool,
    #[serde(default)]
    pub(crate) edge_in_d: bool,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum UnderG40 {
    #[default]
    Stays,
    Ends,
    Unstated,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum UnderG49 {
    #[default]
    Ends,
    Unstated,
}

/// G43 and its like in a block that does not name the axis.
#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Alone {
    /// Nothing moves; the frame shifts.
    Shifts,
    #[default]
    Unstated,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum WithoutH {
    Refused,
    LoadedTool,
}

/// Codes that move the frame, where controls differ. Left out: what refuses most.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Frames {
    pub(crate) p_selects_numbered: bool,
    pub(crate) l20: OffsetL20,
    pub(crate) local_is_preset: bool,
    pub(crate) scaling_step: Spanned<f64>,
    pub(crate) arc_turns: bool,
    pub(crate) rotation_about_tool: bool,
    pub(crate) machine_words_stand_alone: bool,
    pub(crate) increments_carry_shift: bool,
}

impl Default for Frames {
    fn default() -> Self {
        Self {
            p_selects_numbered: false,
            l20: OffsetL20::Numbered,
            local_is_preset: false,
            scaling_step: Spanned::new(0..0, 0.001),
            arc_turns: false,
            rotation_about_tool: false,
            machine_words_stand_alone: false,
            increments_carry_shift: false,
        }
    }
}

/// What the control takes back.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputRules {
    pub(crate) decimals_inch: Spanned<u8>,
    pub(crate) decimals_feed: Spanned<u8>,
    pub(crate) max_block_bytes: u32,
    pub(crate) number_inserted_blocks: bool,
    pub(crate) max_block_number: Spanned<u32>,
    pub(crate) centre_words: bool,
    pub(crate) radius_word: bool,
    pub(crate) arc_radius_tolerance_mm: Spanned<f64>,
    pub(crate) arc_radius_tolerance_inch: Option<Spanned<f64>>,
    pub(crate) arc_radius_tolerance_share: Option<Spanned<f64>>,
    pub(crate) arc_chord_tolerance_mm: Option<Spanned<f64>>,
    pub(crate) rotary_feed: Option<RotaryFeed>,
    pub(crate) largest_inverse_feed: Option<Spanned<f64>>,
}

/// One G code: `does`, or `refuse` with `help`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CodeRow {
    pub(crate) group: u8,
    pub(crate) does: Option<Spanned<String>>,
    /// Of a work offset: its name in the profile, where that is not the code's.
    pub(crate) offset: Option<String>,
    pub(crate) refuse: Option<String>,
    pub(crate) help: Option<String>,
}

/// A letter whose words are refused.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WordRow {
    pub(crate) refuse: String,
    pub(crate) help: String,
}

/// One M code that is more than text.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MRow {
    #[serde(default)]
    pub(crate) after_motion: bool,
    pub(crate) loses_position: Option<Spanned<String>>,
    #[serde(default)]
    pub(crate) ends_program: bool,
    #[serde(default)]
    pub(crate) slash_arguments: bool,
    #[serde(default)]
    pub(crate) changes_tool: bool,
    pub(crate) switches: Option<String>,
    #[serde(default)]
    pub(crate) calls: bool,
    pub(crate) refuse: Option<String>,
    pub(crate) help: Option<String>,
}

/// One command by name; passes unless refused.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CommandRow {
    pub(crate) does: Option<Spanned<String>>,
    pub(crate) passes_with: Option<u32>,
    pub(crate) refuse: Option<String>,
    pub(crate) help: Option<String>,
}
