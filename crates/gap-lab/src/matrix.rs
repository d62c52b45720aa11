//! Homogeneous 4 × 4 matrices, nothing else.

/// A homogeneous transform, row by row.
pub(crate) type Matrix = [[f64; 4]; 4];

/// Changes nothing.
pub(crate) const IDENTITY: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// Translation by `by`, mm.
pub(crate) fn shift(by: [f64; 3]) -> Matrix {
    let mut m = IDENTITY;
    for (row, value) in m.iter_mut().zip(by) {
        row[3] = value;
    }
    m
}

/// Rotation about the coordinate axis `about` (0 is X) by `angle` rad, right-handed.
pub(crate) fn turn(about: usize, angle: f64) -> Matrix {
    let (sine, cosine) = libm::sincos(angle);
    let (u, v) = ((about + 1) % 3, (about + 2) % 3);
    let mut m = IDENTITY;
    m[u][u] = cosine;
    m[v][v] = cosine;
    m[u][v] = -sine;
    m[v][u] = sine;
    m
}

/// Small rotation given by three angles, turned about X, then Y, then Z of the moving frame.
pub(crate) fn tilt(angles: [f64; 3]) -> Matrix {
    (0..3).fold(IDENTITY, |m, about| times(&m, &turn(about, angles[about])))
}

/// Product `a · b`.
pub(crate) fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let mut product = [[0.0; 4]; 4];
    for (row, out) in a.iter().zip(&mut product) {
        for (column, cell) in out.iter_mut().enumerate() {
            *cell = (0..4).map(|k| row[k] * b[k][column]).sum();
        }
    }
    product
}

/// The point `p` carried by `m`.
pub(crate) fn carry(m: &Matrix, p: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_right_handed() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for about in 0..3 {
            let mut from = [0.0; 3];
            from[(about + 1) % 3] = 1.0;
            let to = carry(&turn(about, quarter), from);
            assert!((to[(about + 2) % 3] - 1.0).abs() < 1e-15, "axis {about}: {to:?}");
        }
    }

    #[test]
    fn a_product_carries_as_its_factors_do() {
        let (a, b) = (tilt([0.1, -0.2, 0.3]), times(&shift([1.0, 2.0, 3.0]), &turn(1, 0.4)));
        let p = [4.0, -5.0, 6.0];
        let (once, twice) = (carry(&times(&a, &b), p), carry(&a, carry(&b, p)));
        for i in 0..3 {
            assert!((once[i] - twice[i]).abs() < 1e-13);
        }
    }
}
