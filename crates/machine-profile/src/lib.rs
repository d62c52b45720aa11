//! Machine descriptions as values.
