//! What is refused, and what to type instead: one item for each reason, by theme.

pub(crate) mod circular;
pub(crate) mod curves;
pub(crate) mod cycle;
pub(crate) mod delete;
pub(crate) mod direction;
pub(crate) mod frames;
pub(crate) mod interpreter;
pub(crate) mod motion;
pub(crate) mod position;
pub(crate) mod settings;
pub(crate) mod tilted;
pub(crate) mod tip;
pub(crate) mod tool_length;
pub(crate) mod turning;
pub(crate) mod words;
