//! Which effects explain the gap: forms are proposed, scored, tested, and go again.

pub(crate) mod bounds;
pub(crate) mod climb;
pub(crate) mod crossval;
pub(crate) mod doubt;
pub(crate) mod explain;
pub(crate) mod explanation;
pub(crate) mod formula;
pub(crate) mod lengths;
pub(crate) mod moves;
pub(crate) mod proposals;
pub(crate) mod refine;
pub(crate) mod shapes;
pub(crate) mod space;
pub(crate) mod state;
pub(crate) mod straighten;
pub(crate) mod trial;
