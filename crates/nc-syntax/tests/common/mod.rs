//! Dialects that tests read with.

use nc_syntax::Dialect;
use nc_syntax::dialect::{
    Colon, CycleLevels, FrameRules, LengthAfter, LengthAtChange, Numbers, OffsetL20, Output, Paren,
    PointFree, Semicolon, TWord,
};

/// A dialect without codes: reading needs none.
pub(crate) fn dialect() -> Dialect {
    Dialect {
        name: "test".to_owned(),
        title: String::new(),
        extends: None,
        assumptions: Vec::new(),
        paren: Paren::Comment { nested: false },
        semicolon: Semicolon::Comment,
        end_of_block: None,
        percent_words: false,
        skip: Some(b'/'),
        colon: Colon::Number,
        long_words: Vec::new(),
        labels: false,
        equals_words: false,
        letters: (b'A'..=b'Z').collect(),
        refused_words: Vec::new(),
        dwell_time: None,
        numbers: Numbers {
            point_free: PointFree::Unit,
            least_increment_decimals_mm: 3,
            least_increment_decimals_inch: 4,
            spaces_inside: true,
        },
        codes: nc_syntax::dialect::Codes::default(),
        m_codes: Vec::new(),
        commands: Vec::new(),
        initial: Vec::new(),
        path_control: Vec::new(),
        unit_is_kept: false,
        lathe: Vec::new(),
        turning: None,
        cycle_repeats: Vec::new(),
        zero_repeats_define: false,
        bottom_lies_below_r: false,
        length_under_g40: LengthAfter::Stays,
        length_under_g49: LengthAfter::Ends,
        length_shifts: false,
        t_word: TWord::Selects,
        length_at_change: LengthAtChange::Stays,
        writes_lengths: false,
        edge_in_d: false,
        cycle_levels: CycleLevels::Unstated,
        flow: nc_syntax::dialect::Flow::default(),
        length_of_loaded_tool: false,
        calls: Vec::new(),
        frames: FrameRules {
            p_selects_numbered: false,
            l20: OffsetL20::Numbered,
            local_is_preset: false,
            scaling_step: 0.001,
            arc_turns: false,
            rotation_about_tool: false,
            machine_words_stand_alone: false,
            increments_carry_shift: false,
        },
        output: Output {
            decimals_inch: 4,
            decimals_feed: 3,
            max_block_bytes: 0,
            number_inserted_blocks: false,
            max_block_number: 99_999,
            centre_words: true,
            radius_word: true,
            arc_radius_tolerance_mm: 0.01,
            arc_radius_tolerance_inch: None,
            arc_radius_tolerance_share: 0.0,
            rotary_feed: None,
            largest_inverse_feed: 99_999.999,
            peck_clearance_mm: 1.0,
            chip_retreat_mm: 0.5,
        },
    }
}

/// The same, of the conventional type: `;` ends blocks, no spaces in numbers.
pub(crate) fn conventional() -> Dialect {
    let mut dialect = dialect();
    dialect.semicolon = Semicolon::None;
    dialect.end_of_block = Some(b';');
    dialect.numbers.spaces_inside = false;
    dialect
}
