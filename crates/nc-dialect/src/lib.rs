//! Grammar tables as values.
