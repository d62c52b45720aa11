//! What F means for a motion.

use nc_syntax::Letters;
use toolpath::FeedRate;

use crate::modal::{FeedMode, LastFeed, Modal};
use crate::refusals::motion as refusal;
use crate::words::{AXIS_LETTERS, Outcome, Words};

/// What F means for a motion; `value` is F where G93 is in force.
pub(crate) const fn rate(state: &Modal, value: f64) -> FeedRate {
    match state.feed_mode {
        FeedMode::InverseTime => FeedRate::InverseTime(value),
        FeedMode::PerMinute => FeedRate::PerMinute,
        FeedMode::PerRevolution => FeedRate::PerRevolution,
    }
}

/// F of a feed motion: under G93 it must stand in the block itself.
pub(crate) fn feed_rate(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<FeedRate> {
    const F: Letters = Letters::of(b"F");
    if state.feed_mode != FeedMode::InverseTime {
        own_feed(words, state)?;
        return Ok(rate(state, 0.0));
    }
    match words.plain(b'F') {
        Some(value) if value > 0.0 => Ok(rate(state, value)),
        Some(_) => Err(words.refuse(refusal::INVERSE_TIME_NOT_ABOVE_ZERO, words.span(F))),
        None => Err(words.refuse(refusal::G93_WITHOUT_F, words.span(AXIS_LETTERS))),
    }
}

/// Behind G93 a feed needs an F: what the last one is in another unit, controls answer with a stop or in silence.
pub(crate) fn own_feed(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<()> {
    if state.last_feed != LastFeed::Inverse {
        return Ok(());
    }
    Err(words.refuse(refusal::FEED_BEHIND_G93_WITHOUT_F, words.span(AXIS_LETTERS)))
}
