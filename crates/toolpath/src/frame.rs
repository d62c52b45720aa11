use std::sync::Arc;

use crate::Plane;

/// What a frame makes of circles.
///
/// ```
/// use toolpath::{Frame, Plane, Similarity};
///
/// // G51.1 X0 mirrors: what is G2 in the program turns the axes as G3 does. Scaled in X alone a circle is none.
/// let mirror = Frame::affine([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
/// assert_eq!(mirror.similarity(Plane::Xy), Some(Similarity { scale: 1.0, mirrored: true }));
/// let stretched = Frame::affine([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
/// assert_eq!(stretched.similarity(Plane::Xy), None);
/// assert_eq!(stretched.similarity(Plane::Yz), Some(Similarity { scale: 1.0, mirrored: false }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Radius by axis commands over radius in the program.
    pub scale: f64,
    /// G2 of the program turns the axes the way G3 does.
    pub mirrored: bool,
}

/// How program coordinates (millimetres) become axis commands: `axis = matrix · program + offset`.
///
/// Without G68, G51 or G51.1 the matrix is the identity and the frame a mere shift: work offset plus
/// tool length. The matrix is invertible by construction.
///
/// ```
/// use toolpath::Frame;
///
/// // G54 at X100 Y50 Z20 and a tool of 80 mm.
/// let frame = Frame::shift([100.0, 50.0, 20.0 + 80.0]);
/// assert_eq!(frame.to_machine([10.0, 0.0, -5.0]), [110.0, 50.0, 95.0]);
/// assert_eq!(frame.to_program([110.0, 50.0, 95.0]), [10.0, 0.0, -5.0]);
/// // G68 R90 about its zero turns X into Y.
/// let turned = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let frame = Frame::affine(turned, [100.0, 50.0, 100.0]).unwrap();
/// assert_eq!(frame.to_machine([10.0, 0.0, 0.0]), [100.0, 60.0, 100.0]);
/// // A matrix that makes a plane of space has no way back.
/// assert_eq!(Frame::affine([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]], [0.0; 3]), None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Axis commands of the program's zero.
    offset_mm: [f64; 3],
    /// `None` for a shift. A frame goes with every block, and next to all are shifts: what those do not have must not
    /// be copied with them.
    turned: Option<Arc<Turned>>,
}

/// A matrix that is not the identity.
#[derive(Debug, PartialEq)]
struct Turned {
    /// By rows.
    matrix: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
}

static IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Default for Frame {
    fn default() -> Self {
        Self::shift([0.0; 3])
    }
}

impl Frame {
    /// A frame parallel to the machine's.
    #[must_use]
    pub const fn shift(offset_mm: [f64; 3]) -> Self {
        Self { offset_mm, turned: None }
    }

    /// A rotated, scaled or mirrored frame; `None` where the matrix has no inverse.
    #[must_use]
    pub fn affine(matrix: [[f64; 3]; 3], offset_mm: [f64; 3]) -> Option<Self> {
        let m = &matrix;
        let cofactor = |r: usize, c: usize| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
        };
        let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        if !determinant.is_finite() || determinant.abs() < 1e-12 {
            return None;
        }
        let inverse = [0, 1, 2].map(|r| [0, 1, 2].map(|c| cofactor(c, r) / determinant));
        let turned = (matrix != IDENTITY).then(|| Arc::new(Turned { matrix, inverse }));
        Some(Self { offset_mm, turned })
    }

    /// Axis commands of the program's zero, mm.
    #[must_use]
    pub const fn offset_mm(&self) -> [f64; 3] {
        self.offset_mm
    }

    /// True where program axes are machine axes: each program word moves its own axis alone, by as much.
    #[must_use]
    pub const fn is_shift(&self) -> bool {
        self.turned.is_none()
    }

    /// True where each program word moves its own axis alone, be it mirrored or scaled.
    #[must_use]
    pub fn is_axial(&self) -> bool {
        self.is_shift() || (0..3).all(|r| (0..3).all(|c| r == c || self.matrix()[r][c] == 0.0))
    }

    /// Rows of the matrix; the identity for a shift.
    #[must_use]
    pub fn matrix(&self) -> &[[f64; 3]; 3] {
        self.turned.as_ref().map_or(&IDENTITY, |turned| &turned.matrix)
    }

    /// Rows of the inverse: program coordinates by axis commands.
    #[must_use]
    pub fn inverse(&self) -> &[[f64; 3]; 3] {
        self.turned.as_ref().map_or(&IDENTITY, |turned| &turned.inverse)
    }

    /// How circles of a plane are mapped; `None` where they become ellipses or leave the plane.
    #[must_use]
    pub fn similarity(&self, plane: Plane) -> Option<Similarity> {
        let Some(Turned { matrix: m, .. }) = self.turned.as_deref() else {
            return Some(Similarity { scale: 1.0, mirrored: false });
        };
        let [u, v, n] = plane.axes();
        let (a, b, c, d) = (m[u][u], m[u][v], m[v][u], m[v][v]);
        let near = |x: f64, y: f64| (x - y).abs() <= 1e-12 * (x.abs() + y.abs()).max(1e-3);
        let in_plane = m[n][u] == 0.0 && m[n][v] == 0.0 && m[u][n] == 0.0 && m[v][n] == 0.0;
        let turned = near(a, d) && near(b, -c);
        let mirrored = near(a, -d) && near(b, c);
        (in_plane && (turned || mirrored))
            .then(|| Similarity { scale: (a * a + c * c).sqrt(), mirrored: a * d - b * c < 0.0 })
    }

    /// The largest factor by which the matrix lengthens a program axis; 1 for a shift.
    #[must_use]
    pub fn largest_scale(&self) -> f64 {
        let Some(Turned { matrix, .. }) = self.turned.as_deref() else { return 1.0 };
        let column = |c: usize| {
            let [x, y, z] = [0, 1, 2].map(|r| matrix[r][c]);
            (x * x + y * y + z * z).sqrt()
        };
        column(0).max(column(1)).max(column(2))
    }

    /// Axis command of a program point.
    #[must_use]
    #[inline]
    pub fn to_machine(&self, program_mm: [f64; 3]) -> [f64; 3] {
        let turned = match &self.turned {
            None => program_mm,
            Some(turned) => product(&turned.matrix, program_mm),
        };
        [0, 1, 2].map(|i| turned[i] + self.offset_mm[i])
    }

    /// Program point of an axis command.
    #[must_use]
    #[inline]
    pub fn to_program(&self, machine_mm: [f64; 3]) -> [f64; 3] {
        let shifted = [0, 1, 2].map(|i| machine_mm[i] - self.offset_mm[i]);
        match &self.turned {
            None => shifted,
            Some(turned) => product(&turned.inverse, shifted),
        }
    }
}

fn product(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let frame =
            Frame::affine([[0.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [5.0, 6.0, 7.0]).unwrap();
        let p = [1.25, -2.5, 3.0];
        assert_eq!(frame.to_machine(p), [7.5, 8.5, 10.0]);
        assert_eq!(frame.to_program(frame.to_machine(p)), p);
        assert!(Frame::affine([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).is_none());
    }

    #[test]
    fn circles_stay_circles_under_turns_mirrors_and_even_scaling() {
        let of = |m: [[f64; 3]; 3], plane| Frame::affine(m, [0.0; 3]).unwrap().similarity(plane);
        let turned = of([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], Plane::Xy).unwrap();
        assert!((turned.scale - 1.0).abs() < 1e-15 && !turned.mirrored);
        let mirror = [[-2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        assert_eq!(of(mirror, Plane::Xy), Some(Similarity { scale: 2.0, mirrored: true }));
        assert_eq!(of(mirror, Plane::Yz), Some(Similarity { scale: 2.0, mirrored: false }));
        assert_eq!(of([[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 1.0]], Plane::Xy), None);
        assert_eq!(of([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], Plane::Zx), None);
    }
}
