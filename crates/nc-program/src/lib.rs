//! Blocks to tool path motions.
