//! A linear axis of the chain, with the tables of its errors.

use crate::axis_tables::AxisTables;
use crate::{LinearAxis, Vector};

/// One linear axis, ready to be evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    /// 0 X, 1 Y, 2 Z.
    pub(crate) axis: usize,
    /// Ideal direction of the axis.
    pub(crate) way: Vector,
    /// Real minus ideal direction of the axis, per mm.
    pub(crate) tilt: Vector,
    /// Tables for motion in the negative, unknown and positive direction; empty where the axis has none.
    pub(crate) by_direction: Vec<AxisTables>,
    /// From this axis to the measured point, mm: where the lever arms begin. Equation (7).
    pub(crate) measured_lever_mm: Vector,
}

impl Link {
    /// Tables for a direction of motion, `None` where the axis has no errors.
    #[inline]
    pub(crate) fn tables(&self, direction: i8) -> Option<&AxisTables> {
        // One set holds for all directions, or there are three.
        match self.by_direction.len() {
            0 => None,
            1 => self.by_direction.first(),
            _ => self.by_direction.get((direction.signum() + 1) as usize),
        }
    }
}

/// Tables per direction: one set for all, or negative, mean, positive.
pub(crate) fn by_direction(data: &LinearAxis, axis: usize) -> Vec<AxisTables> {
    let half = 0.5 * data.backlash_mm;
    let Some(positive) = data.errors.clone() else {
        if half == 0.0 {
            return Vec::new();
        }
        let only = |by: f64| AxisTables::constant(data.travel_mm, [0.0; 6]).shifted(axis, by);
        return vec![only(half), only(0.0), only(-half)];
    };
    if let Some(negative) = data.errors_negative.clone()
        && let Some(mean) = AxisTables::mean(&positive, &negative)
    {
        return vec![negative.shifted(axis, half), mean, positive.shifted(axis, -half)];
    }
    if half == 0.0 {
        return vec![positive];
    }
    vec![positive.clone().shifted(axis, half), positive.clone(), positive.shifted(axis, -half)]
}
