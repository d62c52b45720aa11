//! Rotation, scaling and mirror: what stands between the words and the work offset.

use diagnostic::Text;
use toolpath::{Frame, Plane};
use units::math;

/// The one transformation in force. Two at once are refused where they are commanded: in which order
/// controls apply them depends on the make, and for two of these three also on parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transform {
    /// G69, G50, G50.1.
    #[default]
    None,
    /// G68: about a point of the plane.
    Rotation {
        /// The plane that was selected.
        plane: Plane,
        /// First and second axis of the plane, mm.
        centre_mm: [f64; 2],
        /// Positive turns the first axis towards the second.
        angle_deg: f64,
    },
    /// G51: about a point.
    Scaling {
        /// The point that stays, mm.
        centre_mm: [f64; 3],
        /// Factor of each axis.
        factors: [f64; 3],
    },
    /// G51.1: of each axis about a value, where one is given, mm.
    Mirror([Option<f64>; 3]),
}

impl Transform {
    /// Its name for people.
    #[must_use]
    pub const fn name(&self) -> Text {
        match self {
            Self::None => Text::pair(
                "no rotation, scaling or mirror",
                "ни поворота, ни масштаба, ни зеркального отображения",
            ),
            Self::Rotation { .. } => Text::pair("a rotation", "поворот"),
            Self::Scaling { .. } => Text::pair("a scaling", "масштабирование"),
            Self::Mirror(_) => Text::pair("a mirror", "зеркальное отображение"),
        }
    }

    /// True where there is none.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// The axes whose words mean something else under it.
    #[must_use]
    pub fn touches(&self) -> [bool; 3] {
        match *self {
            Self::None => [false; 3],
            Self::Rotation { plane, .. } => {
                let normal = plane.axes()[2];
                [0, 1, 2].map(|axis| axis != normal)
            }
            Self::Scaling { .. } => [true; 3],
            Self::Mirror(about) => about.map(|value| value.is_some()),
        }
    }

    /// Program words to axis commands, mm: transformed, then shifted.
    ///
    /// `None` where the matrix has no inverse.
    pub(crate) fn frame(&self, shift_mm: [f64; 3]) -> Option<Frame> {
        const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (mut matrix, mut centre) = (IDENTITY, [0.0; 3]);
        match *self {
            Self::None => return Some(Frame::shift(shift_mm)),
            Self::Rotation { plane, centre_mm, angle_deg } => {
                let [u, v, _] = plane.axes();
                let (sin, cos) = math::sin_cos_deg(angle_deg);
                (matrix[u][u], matrix[u][v]) = (cos, -sin);
                (matrix[v][u], matrix[v][v]) = (sin, cos);
                (centre[u], centre[v]) = (centre_mm[0], centre_mm[1]);
            }
            Self::Scaling { centre_mm, factors } => {
                (0..3).for_each(|i| matrix[i][i] = factors[i]);
                centre = centre_mm;
            }
            Self::Mirror(about) => {
                for i in 0..3 {
                    if let Some(value) = about[i] {
                        (matrix[i][i], centre[i]) = (-1.0, value);
                    }
                }
            }
        }
        // axis = M (p - c) + c + shift.
        let moved = |r: usize| (0..3).map(|c| matrix[r][c] * centre[c]).sum::<f64>();
        Frame::affine(matrix, [0, 1, 2].map(|r| shift_mm[r] + (centre[r] - moved(r))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_stay_where_they_are() {
        let centre = [3.0, -4.0, 5.0];
        let all = [
            Transform::Rotation { plane: Plane::Zx, centre_mm: [5.0, 3.0], angle_deg: 33.0 },
            Transform::Scaling { centre_mm: centre, factors: [2.0, 0.5, 3.0] },
            Transform::Mirror([Some(3.0), None, Some(5.0)]),
        ];
        for transform in all {
            let frame = transform.frame([10.0, 20.0, 30.0]).unwrap();
            let at = frame.to_machine(centre);
            for i in 0..3 {
                assert!((at[i] - centre[i] - [10.0, 20.0, 30.0][i]).abs() < 1e-12, "{transform:?}: {at:?}");
            }
        }
    }

    #[test]
    fn positive_angles_turn_the_first_axis_towards_the_second() {
        for (plane, from, to) in [
            (Plane::Xy, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            (Plane::Zx, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            (Plane::Yz, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ] {
            let transform = Transform::Rotation { plane, centre_mm: [0.0; 2], angle_deg: 90.0 };
            assert_eq!(transform.frame([0.0; 3]).unwrap().to_machine(from), to);
        }
        assert_eq!(math::sin_cos_deg(-90.0), (-1.0, 0.0));
        assert_eq!(math::sin_cos_deg(540.0), (0.0, -1.0));
    }
}
