//! What a solved model is worth: shares, rivals, forecasts, the verdict.

pub(crate) mod answer;
pub(crate) mod assembly;
pub(crate) mod confounding;
pub(crate) mod forecast;
pub(crate) mod locate;
pub(crate) mod next;
pub(crate) mod parameters;
pub(crate) mod risk;
pub(crate) mod rivals;
pub(crate) mod shrinkage;
pub(crate) mod structure;
pub(crate) mod unseen;
pub(crate) mod verdict;
