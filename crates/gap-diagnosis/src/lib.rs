//! Which effect explains the gap.
