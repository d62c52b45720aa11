//! Synthetic machines with withheld effects.
