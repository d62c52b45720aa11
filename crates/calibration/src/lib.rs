//! Measurements to machine profiles.
