//! What F means.

/// What F means (ISO 6983: G93, G94, G95).
///
/// ```
/// use toolpath::FeedRate;
///
/// // What F must become where a motion is cut into equal pieces.
/// let piece = |rate: FeedRate, pieces: f64| match rate {
///     FeedRate::InverseTime(f) => FeedRate::InverseTime(f * pieces),
///     other => other,
/// };
/// assert_eq!(piece(FeedRate::InverseTime(2.0), 4.0), FeedRate::InverseTime(8.0));
/// assert_eq!(piece(FeedRate::default(), 4.0), FeedRate::PerMinute);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum FeedRate {
    /// Millimetres per minute, or whatever the control makes of F: nothing depends on it here.
    #[default]
    PerMinute,
    /// Inverse time: the motion takes 1/F minutes. Must be divided when the motion is.
    InverseTime(f64),
    /// Millimetres per spindle turn.
    PerRevolution,
}
