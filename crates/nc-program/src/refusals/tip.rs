//! Refusals of tool centre point control.

use diagnostic::{Refusal, refusal};

use crate::codes;

pub(crate) const INSIDE_TILTED_PLANE: Refusal = refusal!(const codes::TILTED_PLANE;
    "inside a tilted plane", "в наклонной плоскости";
    "is the tip then in the plane's coordinates, or in the workpiece's?",
    "в чьих координатах тогда вершина: плоскости или детали?";
    "cancel the plane with G69 before it, or post the points of the plane without it",
    "отмените перед ней плоскость функцией G69 или выводите точки плоскости без неё"
);
