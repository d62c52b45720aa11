//! The largest length of a sum of vectors with free signs.

use machine_model::Vector;

/// Relative size below which a product of two vectors counts as zero.
const PARALLEL: f64 = 1e-12;

/// Signs that make a sum as long as can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Farthest {
    /// Length of the sum.
    pub length: f64,
    /// One for each vector, +1 or -1.
    pub signs: Vec<f64>,
}

/// The largest `|Σ s_i g_i|` over all signs `s_i = ±1`: exact, without trying all 2ⁿ.
///
/// The sums with factors between -1 and 1 fill a zonotope, a convex body whose vertices are sums with
/// signs only; a length is convex, so it is largest at a vertex. A vertex that is farthest in direction
/// u has `s_i = sign(g_i·u)`: vertices are the cells into which the planes `g_i·u = 0` cut the sphere of
/// directions. Every cell has a corner, where two of the planes meet: `u = g_i × g_j`. At the corner the
/// signs of all other vectors are known; those in the plane of the two are settled on an edge that ends there,
/// `v = ± u × g_i`, and `s_i` is either. Of the two edges of a cell at its corner the one of the smaller index will
/// do: `2n(n-1)` sign patterns, i < j, hold the answer (equation (54); Ferrez, Fukuda and Liebling 2005).
/// Parallel vectors are added up before: on a machine most are.
#[must_use]
pub fn farthest(vectors: &[Vector]) -> Farthest {
    let (generators, member_of) = merged(vectors);
    let n = generators.len();
    let mut best = Farthest { length: 0.0, signs: vec![1.0; n] };
    let mut try_pattern = |sign: &dyn Fn(usize) -> f64| {
        let sum: Vector = generators.iter().enumerate().map(|(k, g)| g * sign(k)).sum();
        if sum.norm() > best.length {
            best = Farthest { length: sum.norm(), signs: (0..n).map(sign).collect() };
        }
    };
    if n == 1 {
        try_pattern(&|_| 1.0);
    }
    let lengths: Vec<f64> = generators.iter().map(Vector::norm).collect();
    for i in 0..n {
        for j in i + 1..n {
            let corner = generators[i].cross(&generators[j]);
            let zero = PARALLEL * corner.norm();
            // A product that is nothing but rounding is zero: its sign would be chance.
            let side = |k: usize| Some(generators[k].dot(&corner)).filter(|d| d.abs() > zero * lengths[k]);
            let sides: Vec<Option<f64>> =
                (0..n).map(|k| if k == i || k == j { None } else { side(k) }).collect();
            let edge = corner.cross(&generators[i]);
            for (along, own) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                try_pattern(&|k| match sides[k] {
                    _ if k == i => own,
                    Some(side) => side.signum(),
                    None => (generators[k].dot(&edge) * along).signum(),
                });
            }
        }
    }
    let signs = member_of.iter().map(|member| member.map_or(1.0, |(k, way)| way * best.signs[k])).collect();
    Farthest { length: best.length, signs }
}

/// Vectors without two that are parallel, and for each given one which of them holds it, and which way round;
/// vectors of no length are in none.
fn merged(vectors: &[Vector]) -> (Vec<Vector>, Vec<Option<(usize, f64)>>) {
    let mut generators: Vec<Vector> = Vec::new();
    let mut member_of = Vec::with_capacity(vectors.len());
    for vector in vectors {
        let length = vector.norm();
        if length == 0.0 {
            member_of.push(None);
            continue;
        }
        let parallel = |g: &Vector| g.cross(vector).norm() <= PARALLEL * g.norm() * length;
        match generators.iter().position(parallel) {
            Some(k) => {
                let way = generators[k].dot(vector).signum();
                generators[k] += vector * way;
                member_of.push(Some((k, way)));
            }
            None => {
                generators.push(*vector);
                member_of.push(Some((generators.len() - 1, 1.0)));
            }
        }
    }
    (generators, member_of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(vectors: &[Vector], sign: impl Fn(usize) -> f64) -> Vector {
        vectors.iter().enumerate().map(|(k, g)| g * sign(k)).sum()
    }

    /// All 2ⁿ signs.
    fn by_force(vectors: &[Vector]) -> f64 {
        (0..1_u32 << vectors.len())
            .map(|bits| sum(vectors, |k| if bits >> k & 1 == 1 { 1.0 } else { -1.0 }).norm())
            .fold(0.0, f64::max)
    }

    fn agrees(vectors: &[Vector]) {
        let found = farthest(vectors);
        let (force, scale) = (by_force(vectors), vectors.iter().map(Vector::norm).sum::<f64>());
        assert!((found.length - force).abs() <= 1e-12 * scale, "{} {force}: {vectors:?}", found.length);
        assert!(found.signs.iter().all(|s| s.abs() == 1.0));
        let again = sum(vectors, |k| found.signs[k]).norm();
        assert!((again - found.length).abs() <= 1e-12 * scale, "the signs do what they say: {again}");
    }

    #[test]
    fn no_vector_one_and_what_lies_in_a_line_or_a_plane() {
        assert_eq!(farthest(&[]), Farthest { length: 0.0, signs: vec![] });
        agrees(&[Vector::zeros()]);
        agrees(&[Vector::new(1.0, 2.0, 2.0)]);
        agrees(&[Vector::x(), Vector::x() * -3.0, Vector::zeros(), Vector::x() * 0.5]);
        agrees(&[Vector::x(), Vector::y() * 2.0]);
        agrees(&[
            Vector::new(1.0, 1.0, 0.0),
            Vector::new(1.0, -1.0, 0.0),
            Vector::new(0.0, 3.0, 0.0),
            Vector::new(-2.0, 0.5, 0.0),
        ]);
        // The directions of a machine: three axes, and turns about them.
        let cube = [Vector::x(), Vector::y(), Vector::z(), Vector::new(1.0, 1.0, 0.0)];
        agrees(&[&cube[..], &[Vector::new(0.0, 1.0, 1.0), Vector::new(1.0, 0.0, -1.0)]].concat());
    }

    proptest! {
        #[test]
        fn as_by_force(vectors in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..11)) {
            agrees(&vectors.into_iter().map(Vector::from).collect::<Vec<_>>());
        }

        /// All in one plane, which no coordinate knows of: the corners are two, and hold every cell.
        #[test]
        fn as_by_force_in_a_plane(vectors in prop::collection::vec(prop::array::uniform2(-5..6_i32), 1..12)) {
            let [a, b] = [Vector::new(1.0, 2.0, -1.0), Vector::new(2.0, -1.0, 3.0)];
            agrees(&vectors.into_iter().map(|[u, v]| a * f64::from(u) + b * f64::from(v)).collect::<Vec<_>>());
        }

        /// Whole numbers: many parallel, many in one plane.
        #[test]
        fn as_by_force_where_much_coincides(vectors in prop::collection::vec(prop::array::uniform3(-1..2_i32), 1..12)) {
            agrees(&vectors.into_iter().map(|v| Vector::from(v.map(f64::from))).collect::<Vec<_>>());
        }
    }
}
