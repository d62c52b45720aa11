//! From a change of the lathe to what would be read: equations (71) to (73), exactly.

use machine_model::{Axis, Description, Interpolation, PathModel, Range, RigidBody, Unusable, Vector};
use turning::{Bending, Lathe, Spindle, Station, Tip};

use super::rows::{Feature, TurnedReading};
use crate::ChangedAxis;
use crate::layout::tables_of;

/// The lathe as it is known.
#[derive(Clone, Debug)]
pub struct TurningBase {
    /// X and Z, and a Y that stands still.
    pub description: Description,
    /// Between the nodes of its tables.
    pub interpolation: Interpolation,
    /// Its spindle, the tailstock where it bears the workpiece.
    pub spindle: Spindle,
    /// What the workpiece gives way: taken off, never fitted.
    pub bending: Bending,
    /// How the tool stands.
    pub tip: Tip,
    /// Stations of the turret that err: known, never fitted.
    pub stations: Vec<Station>,
}

/// A change of the lathe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Of EB0S, rad; where a tailstock bears the workpiece, of its offset ΔX3, mm: the axis then goes where that is.
    pub axis: f64,
    /// Of EB0Z, rad.
    pub eb0z_rad: f64,
    /// Of EXZ, mm: how much its middle is above its ends, and the part of order 4 ([`Stretch::shapes`]).
    pub bow_mm: [f64; 2],
}

/// Where along Z the carriage was seen, mm of its command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// From here.
    pub low_mm: f64,
    /// To here.
    pub high_mm: f64,
}

/// Nodes of the bow: between them a straight line leaves a parabola by 1/1600 of its bow.
const BOW_NODES: usize = 41;

impl Stretch {
    pub(super) fn of(rows: &[TurnedReading]) -> Self {
        let places = rows.iter().filter(|row| row.feature == Feature::Diameter);
        let (low_mm, high_mm) = places
            .map(|row| row.command.linear_mm.z)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        Self { low_mm, high_mm }
    }

    /// Even shapes of EXZ without mean and slope, u from −1 to 1 along the stretch: `1/3 − u²`, whose middle is 1 above
    /// its ends, and the Legendre polynomial `(35 u⁴ − 30 u² + 3)/8`. Outside the ends' values hold: what nobody saw
    /// does not bend.
    #[must_use]
    pub fn shapes(&self, z_mm: f64) -> [f64; 2] {
        let half = 0.5 * (self.high_mm - self.low_mm);
        let u = ((z_mm - 0.5 * (self.low_mm + self.high_mm)) / half).clamp(-1.0, 1.0);
        let square = u * u;
        [1.0 / 3.0 - square, (35.0 * square * square - 30.0 * square + 3.0) / 8.0]
    }
}

impl TurningBase {
    /// The tables of Z with a change of EXZ; `None` where it does not bend.
    #[must_use]
    pub fn z_tables(&self, change: &Change, stretch: Stretch) -> Option<ChangedAxis> {
        if change.bow_mm == [0.0; 2] {
            return None;
        }
        let linear = &self.description.linear[Axis::Z.direction()];
        let Range { low, high } = linear.calibrated_mm();
        let share = |k: usize| k as f64 / (BOW_NODES - 1) as f64;
        let own = (0..BOW_NODES).map(|k| stretch.low_mm + share(k) * (stretch.high_mm - stretch.low_mm));
        let known = [&linear.errors, &linear.errors_negative].into_iter().flatten();
        let mut positions_mm: Vec<f64> =
            known.flat_map(|tables| tables.nodes().to_vec()).chain(own).chain([low, high]).collect();
        positions_mm.retain(|z| (low..=high).contains(z));
        positions_mm.sort_by(f64::total_cmp);
        // The written table has six decimals.
        positions_mm.dedup_by(|b, a| *b - *a < 1e-5);
        let rows = |tables: Option<&machine_model::AxisTables>| {
            let row = |z: &f64| {
                let mut six = tables.map_or([0.0; 6], |tables| tables.at(*z));
                let shapes = stretch.shapes(*z);
                six[0] += change.bow_mm[0] * shapes[0] + change.bow_mm[1] * shapes[1];
                six
            };
            positions_mm.iter().map(row).collect::<Vec<_>>()
        };
        let errors = rows(linear.errors.as_ref());
        let negative = linear.errors_negative.as_ref().map(|tables| rows(Some(tables)));
        let given = std::array::from_fn(|f| {
            f == 0 || errors.iter().chain(negative.iter().flatten()).any(|row| row[f] != 0.0)
        });
        Some(ChangedAxis { positions_mm, errors, negative, given })
    }

    /// The lathe with a change.
    ///
    /// # Errors
    /// [`Unusable`] where an axis' tables and its travel have no interval in common.
    pub fn with(&self, change: &Change, stretch: Stretch, rows: &[TurnedReading]) -> Result<Lathe, Unusable> {
        let mut description = self.description.clone();
        description.squareness.eb0z_rad += change.eb0z_rad;
        if let Some(changed) = self.z_tables(change, stretch) {
            let linear = &mut description.linear[Axis::Z.direction()];
            linear.errors = tables_of(&changed.positions_mm, &changed.errors, self.interpolation);
            let negative = changed.negative.as_ref();
            linear.errors_negative =
                negative.and_then(|rows| tables_of(&changed.positions_mm, rows, self.interpolation));
        }
        let mut spindle = self.spindle.clone();
        match &mut spindle.tailstock {
            Some(tailstock) => tailstock.offset_mm[0] += change.axis,
            None => spindle.tilt_rad[1] += change.axis,
        }
        let mut tools: Vec<Vector> = rows.iter().map(|row| row.command.tool_mm).collect();
        tools.dedup();
        let linear = Box::new(RigidBody::new(description)?);
        let lathe = Lathe::new(linear, spindle, self.bending.clone(), self.tip, &tools);
        Ok(lathe.with_stations(self.stations.clone()))
    }

    /// What would be read with a change, size of the tool, growth and wear apart, mm.
    ///
    /// A diameter is `2 (r − R)` of (73) at the command, a face `z − Z`.
    ///
    /// # Errors
    /// As [`Self::with`].
    pub fn predicted_mm(
        &self,
        change: &Change,
        stretch: Stretch,
        rows: &[TurnedReading],
    ) -> Result<Vec<f64>, Unusable> {
        let lathe = self.with(change, stretch, rows)?;
        let read = |row: &TurnedReading| {
            let error_mm = lathe.error_mm(&row.command);
            row.by_effects_mm
                + match row.feature {
                    Feature::Diameter => 2.0 * error_mm.x,
                    Feature::Face => error_mm.z,
                }
        };
        Ok(rows.iter().map(read).collect())
    }
}
