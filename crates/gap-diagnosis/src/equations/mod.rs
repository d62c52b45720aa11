//! From rows to equations: what was read, the columns that could explain it, their products.

pub(crate) mod align;
pub(crate) mod columns;
pub(crate) mod f_test;
pub(crate) mod fit;
pub(crate) mod gram;
pub(crate) mod linear;
pub(crate) mod motion;
pub(crate) mod noise;
pub(crate) mod observation;
pub(crate) mod pool;
pub(crate) mod serial;
pub(crate) mod set_up;
pub(crate) mod term;
pub(crate) mod tile;
