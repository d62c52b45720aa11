//! Which axis carries which: lever arms and rotary joints.

use nalgebra::{Matrix3, Rotation3};

use crate::rotation::of_any_size;
use crate::{Chain, Command, Tilt, Vector};

/// One joint of the chain, workpiece to tool.
///
/// ```
/// use machine_model::Chain;
/// use machine_model::effects::{EffectGeometry, Joint};
///
/// // A table that turns about Z, and a head that turns about Y.
/// let geometry = EffectGeometry::from_chain(&Chain::parse("[w C X Y b Z B t]").unwrap());
/// assert_eq!(geometry.joints().first(), Some(&Joint::Table(2)));
/// assert_eq!(geometry.joints().last(), Some(&Joint::Head(1)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// X, Y or Z.
    Linear(usize),
    /// A, B or C on the workpiece side of the bed: turns the workpiece.
    Table(usize),
    /// A, B or C on the tool side of the bed: turns the tool.
    Head(usize),
}

/// What the effects must know of the machine: the order of its axes, where its rotary axes lie, at which
/// temperature it was calibrated.
///
/// ```
/// use machine_model::Chain;
/// use machine_model::effects::EffectGeometry;
///
/// let mill = EffectGeometry::from_chain(&Chain::parse("[w X Y b Z t]").unwrap());
/// assert_eq!(mill, EffectGeometry::default());
/// assert!(!mill.has_table() && mill.reference_temp_c == 20.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EffectGeometry {
    joints: Vec<Joint>,
    /// A point on each of the axes A, B, C, machine coordinates, mm.
    pub rotary_centre_mm: [Vector; 3],
    /// Where the axes A, B, C point, unit vectors; `None` for that of the letter.
    pub rotary_direction: [Option<Vector>; 3],
    /// What a location tilt of A, B, C means.
    pub rotary_tilt: [Tilt; 3],
    /// Temperature at which the machine is as its tables say, °C.
    pub reference_temp_c: f64,
}

impl Default for EffectGeometry {
    /// Chain `[w X Y b Z t]`, 20 °C.
    fn default() -> Self {
        Self {
            joints: vec![Joint::Linear(0), Joint::Linear(1), Joint::Linear(2)],
            rotary_centre_mm: [Vector::zeros(); 3],
            rotary_direction: [None; 3],
            rotary_tilt: [Tilt::Body; 3],
            reference_temp_c: 20.0,
        }
    }
}

impl EffectGeometry {
    /// The geometry of a machine with this chain, rotary axes through the origin, 20 °C.
    #[must_use]
    pub fn from_chain(chain: &Chain) -> Self {
        let axes = |axes: &[crate::Axis], joint: fn(usize) -> Joint| {
            axes.iter().map(|axis| joint(axis.direction())).collect::<Vec<_>>()
        };
        let mut joints = axes(chain.table(), Joint::Table);
        joints.extend(axes(&chain.linear(), Joint::Linear));
        joints.extend(axes(chain.head(), Joint::Head));
        Self { joints, ..Self::default() }
    }

    /// The joints, workpiece to tool.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// True where the chain has this rotary axis.
    #[must_use]
    pub fn has_rotary(&self, axis: usize) -> bool {
        self.joints.contains(&Joint::Table(axis)) || self.joints.contains(&Joint::Head(axis))
    }

    /// Lever arm of the rotation errors of a linear axis: commands of the linear axes beyond it plus the
    /// tool vector as the heads turn it, mm (first-order sum of methods §2).
    #[must_use]
    pub fn lever_mm(&self, axis: usize, command: &Command) -> Vector {
        let mut lever = command.tool_mm;
        for joint in self.joints.iter().rev() {
            if let (Joint::Head(_), Some((head, turn))) = (*joint, self.rotation(*joint, command)) {
                let centre = self.rotary_centre_mm[head];
                lever = centre + turn * (lever - centre);
            }
        }
        let beyond = self.joints.iter().skip_while(|j| **j != Joint::Linear(axis)).skip(1);
        for joint in beyond {
            if let Joint::Linear(other) = *joint {
                lever[other] += command.linear_mm[other];
            }
        }
        lever
    }

    /// Rotation of everything on the tool side of a rotary joint as the workpiece side sees it.
    fn rotation(&self, joint: Joint, command: &Command) -> Option<(usize, Rotation3<f64>)> {
        let (axis, angle_rad) = match joint {
            Joint::Linear(_) => return None,
            Joint::Table(axis) => (axis, -command.rotary_rad[axis]),
            Joint::Head(axis) => (axis, command.rotary_rad[axis]),
        };
        if let Some(along) = self.rotary_direction[axis] {
            return Some((axis, Rotation3::from_matrix_unchecked(of_any_size(&(along * angle_rad)))));
        }
        let (sin, cos) = units::math::sin_cos(angle_rad);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut matrix = Matrix3::identity();
        matrix[(a, a)] = cos;
        matrix[(b, b)] = cos;
        matrix[(a, b)] = -sin;
        matrix[(b, a)] = sin;
        Some((axis, Rotation3::from_matrix_unchecked(matrix)))
    }

    /// From the directions of the linear axes to those of the workpiece, ideal table: the identity without one.
    #[must_use]
    pub fn table_turn(&self, command: &Command) -> Matrix3<f64> {
        let tables = self.joints.iter().filter(|joint| matches!(joint, Joint::Table(_)));
        tables.filter_map(|joint| self.rotation(*joint, command)).fold(
            Matrix3::identity(),
            |turn, (_, own)| {
                // From the workpiece on, each table turns what lies beyond it.
                turn * own.matrix()
            },
        )
    }

    /// True where a table turns the workpiece: then a displacement along a linear axis is seen along several.
    #[must_use]
    pub fn has_table(&self) -> bool {
        self.joints.iter().any(|joint| matches!(joint, Joint::Table(_)))
    }

    /// Where an ideal machine puts the tool tip, workpiece frame (equal to the machine frame with all
    /// rotary axes at zero), mm.
    #[must_use]
    pub fn nominal_tip_mm(&self, command: &Command) -> Vector {
        let mut point = command.linear_mm + command.tool_mm;
        for joint in self.joints.iter().rev() {
            if let Some((axis, turn)) = self.rotation(*joint, command) {
                let centre = self.centre_mm(*joint, axis, command);
                point = centre + turn * (point - centre);
            }
        }
        point
    }

    /// Displacement of the tip, workpiece frame, mm, by location errors of a rotary axis as a profile has them: equation
    /// (9) to first order. Offset and tilt displace what the axis carries at every angle, under [`Tilt::Axis`] the tilt
    /// turns with it.
    #[must_use]
    pub fn rotary_location_mm(
        &self,
        axis: usize,
        offset_mm: Vector,
        tilt_rad: Vector,
        command: &Command,
    ) -> Vector {
        let is_table = self.joints.contains(&Joint::Table(axis));
        let turns_upright = self.rotary_tilt[axis] == Tilt::Axis;
        self.through(axis, command, |turn, arm| {
            let ahead = tilt_rad.cross(&(turn * arm));
            let behind = turn * tilt_rad.cross(&arm);
            match (is_table, turns_upright) {
                // A table is seen from what it carries: the inverse.
                (true, false) => -(turn * offset_mm) - behind,
                (true, true) => -(turn * offset_mm) + ahead - behind,
                (false, false) => offset_mm + ahead,
                (false, true) => offset_mm + ahead - behind,
            }
        })
    }

    /// Displacement of the tip, workpiece frame, mm, where a rotary axis turns by `error_rad` too much and what it
    /// carries has moved by `radial_mm`, in the directions that do not turn with it, like an error table's.
    #[must_use]
    pub fn rotary_motion_mm(
        &self,
        axis: usize,
        error_rad: f64,
        radial_mm: Vector,
        command: &Command,
    ) -> Vector {
        let mut direction = Vector::zeros();
        direction[axis] = 1.0;
        let direction = self.rotary_direction[axis].unwrap_or(direction) * error_rad;
        let is_table = self.joints.contains(&Joint::Table(axis));
        self.through(axis, command, |turn, arm| {
            let turned = direction.cross(&(turn * arm));
            if is_table { -turned - turn * radial_mm } else { turned + radial_mm }
        })
    }

    /// Carries a small displacement that arises at one rotary joint through the joints on its workpiece side.
    fn through(
        &self,
        axis: usize,
        command: &Command,
        arises: impl Fn(&Rotation3<f64>, Vector) -> Vector,
    ) -> Vector {
        let mut point = command.linear_mm + command.tool_mm;
        let mut displacement = Vector::zeros();
        for joint in self.joints.iter().rev() {
            if let Some((this, turn)) = self.rotation(*joint, command) {
                let centre = self.centre_mm(*joint, this, command);
                let arm = point - centre;
                displacement = turn * displacement;
                if this == axis {
                    displacement += arises(&turn, arm);
                }
                point = centre + turn * arm;
            }
        }
        displacement
    }

    /// A head travels with the linear axes that carry it; a table stands.
    fn centre_mm(&self, joint: Joint, axis: usize, command: &Command) -> Vector {
        let mut centre = self.rotary_centre_mm[axis];
        if let Joint::Head(_) = joint {
            for other in self.joints.iter().take_while(|j| **j != joint) {
                if let Joint::Linear(i) = *other {
                    centre[i] += command.linear_mm[i];
                }
            }
        }
        centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(rotary_rad: Vector) -> Command {
        Command {
            linear_mm: Vector::new(100.0, -40.0, 30.0),
            rotary_rad,
            tool_mm: Vector::new(0.0, 0.0, -50.0),
            ..Default::default()
        }
    }

    #[test]
    fn lever_holds_the_axes_beyond_and_the_tool() {
        let geometry = EffectGeometry::from_chain(&Chain::parse("[w X Y b Z t]").unwrap());
        let q = command(Vector::zeros());
        assert_eq!(geometry.lever_mm(0, &q), Vector::new(0.0, -40.0, -20.0));
        assert_eq!(geometry.lever_mm(2, &q), Vector::new(0.0, 0.0, -50.0));
    }

    #[test]
    fn location_errors_are_those_of_a_profile() {
        let mut geometry = EffectGeometry::from_chain(&Chain::parse("[w C A Y X b Z t]").unwrap());
        geometry.rotary_centre_mm =
            [Vector::new(0.0, 3.0, -20.0), Vector::zeros(), Vector::new(7.0, 3.0, 0.0)];
        let q = command(Vector::new(0.3, 0.0, 1.1));
        // The real machine of a profile with the same error, on a chain with a table upon another and on one with heads.
        for (chain, axes) in [("[w C A Y X b Z t]", [2, 0]), ("[w b X Y Z C A t]", [2, 0])] {
            geometry = EffectGeometry {
                rotary_centre_mm: geometry.rotary_centre_mm,
                ..EffectGeometry::from_chain(&Chain::parse(chain).unwrap())
            };
            for axis in axes {
                for tilt in [Tilt::Body, Tilt::Axis] {
                    geometry.rotary_tilt[axis] = tilt;
                    let machine = |shift_mm: Vector, tilt_rad: Vector| {
                        let perfect = |a: usize| crate::RotaryAxis::perfect(geometry.rotary_centre_mm[a]);
                        let mut rotary = [perfect(0), perfect(1), perfect(2)];
                        rotary[axis] = crate::RotaryAxis { shift_mm, tilt_rad, tilt, ..rotary[axis].clone() };
                        let linear = [(); 3]
                            .map(|()| crate::LinearAxis::perfect(crate::Range { low: -500.0, high: 500.0 }));
                        let squareness = crate::Squareness::default();
                        let description = crate::Description {
                            chain: Chain::parse(chain).unwrap(),
                            linear,
                            rotary,
                            squareness,
                        };
                        crate::RigidBody::new(description).unwrap().predict(&q).error_mm
                    };
                    for (shift, lean) in [
                        (Vector::new(1e-5, -2e-5, 0.0), Vector::zeros()),
                        (Vector::zeros(), Vector::new(1e-7, 2e-7, 0.0)),
                    ] {
                        let expected = machine(shift, lean);
                        let found = geometry.rotary_location_mm(axis, shift, lean, &q);
                        assert!(
                            (found - expected).norm() < 1e-9,
                            "{chain} {axis} {tilt:?}: {found} {expected}"
                        );
                    }
                }
            }
        }
        let geometry = EffectGeometry {
            rotary_centre_mm: geometry.rotary_centre_mm,
            ..EffectGeometry::from_chain(&Chain::parse("[w C A Y X b Z t]").unwrap())
        };
        // An angle too large is the same as another command.
        let mut further = q;
        further.rotary_rad[0] += 1e-6;
        let expected = geometry.nominal_tip_mm(&further) - geometry.nominal_tip_mm(&q);
        let found = geometry.rotary_motion_mm(0, 1e-6, Vector::zeros(), &q);
        assert!((found - expected).norm() < 1e-9, "{found} {expected}");
    }
}
