//! Form of a turned surface: circles and cylinders through points, roundness, cylindricity, harmonics.

use machine_model::Vector;
use nalgebra::{DMatrix, DVector};
use units::math;

/// The outline of a cross-section, in the workpiece's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    points_mm: Vec<Vector>,
}

/// A circle and how far the outline leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// X and Y of its centre, mm.
    pub centre_mm: [f64; 2],
    /// Its radius, mm; of a zone its middle.
    pub radius_mm: f64,
    /// Largest distance outwards less largest inwards: RONt, mm.
    pub roundness_mm: f64,
}

/// A cylinder and how far the surface leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Its radius, mm; of a zone its middle.
    pub radius_mm: f64,
    /// Largest distance outwards less largest inwards: CYLt, mm.
    pub cylindricity_mm: f64,
}

/// One term of the outline's Fourier series about its least-squares centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Waves a turn.
    pub order: u32,
    /// mm; half of what it spans.
    pub amplitude_mm: f64,
    /// Angle of its cosine, rad.
    pub phase_rad: f64,
}

/// Rounds of the linearised fits; each gains the square of what is left.
const ROUNDS: usize = 30;
/// Rows of the order of 1 that are nearer than this to what others make follow from them.
const DEPENDENT: f64 = 1e-9;
/// Below this a fit has settled, mm.
const SETTLED_MM: f64 = 1e-13;

impl Section {
    /// Of its points, in order of the angle.
    #[must_use]
    pub fn new(points_mm: Vec<Vector>) -> Self {
        Self { points_mm }
    }

    /// Its points, mm.
    #[must_use]
    pub fn points_mm(&self) -> &[Vector] {
        &self.points_mm
    }

    /// Mean Z, mm.
    #[must_use]
    pub fn z_mm(&self) -> f64 {
        self.points_mm.iter().map(|p| p.z).sum::<f64>() / self.points_mm.len() as f64
    }

    /// The least-squares circle (ISO 12181-1), by distances, not by the limaçon.
    ///
    /// ```
    /// use machine_model::Vector;
    /// use turning::Section;
    ///
    /// // A circle stays round wherever it lies.
    /// let angles = (0..360).map(|k| f64::from(k).to_radians());
    /// let points = angles.map(|t| Vector::new(0.3 + 20.0 * t.cos(), 20.0 * t.sin() - 0.1, 5.0));
    /// let circle = Section::new(points.collect()).least_squares();
    /// assert!(circle.roundness_mm < 1e-12 && (circle.radius_mm - 20.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn least_squares(&self) -> Circle {
        self.circle(&[least_squares])
    }

    /// The minimum zone: two circles of one centre, least apart, with the outline between them (ISO 12181-1).
    #[must_use]
    pub fn minimum_zone(&self) -> Circle {
        self.circle(&[least_squares, minimax])
    }

    fn circle(&self, fits: &[Fit]) -> Circle {
        let [x, y, _, _, radius_mm, roundness_mm] = fitted(&self.points_mm, 2, fits);
        Circle { centre_mm: [x, y], radius_mm, roundness_mm }
    }

    /// The outline's waves about its least-squares circle, 2 to `highest` a turn; what is one wave a turn is the centre.
    ///
    /// Least squares over the polar angles at which the points lie.
    #[must_use]
    pub fn waves(&self, highest: u32) -> Vec<Wave> {
        let circle = self.least_squares();
        let [cx, cy] = circle.centre_mm;
        let polar =
            self.points_mm.iter().map(|p| (math::atan2(p.y - cy, p.x - cx), math::hypot(p.x - cx, p.y - cy)));
        let (angles, radii): (Vec<f64>, Vec<f64>) = polar.unzip();
        let unknowns = 2 * highest as usize + 1;
        let rows = DMatrix::from_fn(angles.len(), unknowns, |k, j| {
            let order = j.div_ceil(2) as f64;
            if j % 2 == 1 {
                math::cos(order * angles[k])
            } else if j == 0 {
                1.0
            } else {
                math::sin(order * angles[k])
            }
        });
        let Some(found) = least_squares(&rows, &DVector::from_vec(radii)) else { return Vec::new() };
        (2..=highest)
            .map(|order| {
                let (cos, sin) = (found[2 * order as usize - 1], found[2 * order as usize]);
                Wave { order, amplitude_mm: math::hypot(cos, sin), phase_rad: math::atan2(sin, cos) }
            })
            .collect()
    }
}

impl Cylinder {
    /// The least-squares cylinder through sections (ISO 12180-1), its axis free.
    #[must_use]
    pub fn least_squares(sections: &[Section]) -> Self {
        Self::fitted(sections, &[least_squares])
    }

    /// The minimum zone cylinder (ISO 12180-1).
    #[must_use]
    pub fn minimum_zone(sections: &[Section]) -> Self {
        Self::fitted(sections, &[least_squares, minimax])
    }

    fn fitted(sections: &[Section], fits: &[Fit]) -> Self {
        let points: Vec<Vector> =
            sections.iter().flat_map(|section| section.points_mm.iter().copied()).collect();
        let [_, _, _, _, radius_mm, cylindricity_mm] = fitted(&points, 4, fits);
        Self { radius_mm, cylindricity_mm }
    }
}

/// How the numbers of an axis are found from rows and values that are linear in them.
type Fit = fn(&DMatrix<f64>, &DVector<f64>) -> Option<DVector<f64>>;

/// Axis (x, y at the middle, and its slopes), radius, and range of the distances, of the last fit with so many free
/// numbers of the axis: 2 for a circle, 4 for a cylinder.
///
/// Distances from the axis are made linear in its numbers until they stand still. A fit begins where the one before it
/// ended, and what it ends with has no larger range: the minimum zone is no wider than that of least squares.
fn fitted(points: &[Vector], free: usize, fits: &[Fit]) -> [f64; 6] {
    let count = points.len() as f64;
    let middle = points.iter().map(|p| p.z).sum::<f64>() / count;
    let reach = points.iter().map(|p| (p.z - middle).abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    // x, y at the middle; what x, y gain to the end.
    let mut axis = [0.0; 4];
    let mut best = [f64::NAN; 6];
    for (turn, fit) in fits.iter().enumerate() {
        let mut settled = best;
        for _ in 0..ROUNDS {
            let along = Vector::new(axis[2] / reach, axis[3] / reach, 1.0).normalize();
            let ways: Vec<Vector> = points
                .iter()
                .map(|p| {
                    let way = Vector::new(p.x - axis[0], p.y - axis[1], p.z - middle);
                    if free == 2 { Vector::new(way.x, way.y, 0.0) } else { way - along * along.dot(&way) }
                })
                .collect();
            let distances = DVector::from_iterator(points.len(), ways.iter().map(|w| w.norm()));
            let (low, high) = (distances.min(), distances.max());
            let rows = DMatrix::from_fn(points.len(), free + 1, |k, j| match j {
                _ if j == free => 1.0,
                0 | 1 => ways[k][j] / distances[k],
                _ => ways[k][j - 2] / distances[k] * (points[k].z - middle) / reach,
            });
            let Some(found) = fit(&rows, &distances) else { break };
            let radius = if turn == 0 { found[free] } else { 0.5 * (low + high) };
            let now = [axis[0], axis[1], axis[2] / reach, axis[3] / reach, radius, high - low];
            // Least squares ends where it stands still; a zone keeps the narrowest that it met.
            if turn == 0 || now[5] <= settled[5] {
                settled = now;
            }
            let moved = (0..free).map(|j| found[j].abs()).fold(0.0, f64::max);
            if moved <= SETTLED_MM {
                break;
            }
            for (own, by) in axis.iter_mut().zip(found.iter().take(free)) {
                *own += by;
            }
        }
        best = settled;
        if best.iter().any(|value| value.is_nan()) {
            break;
        }
        axis = [best[0], best[1], best[2] * reach, best[3] * reach];
    }
    best
}

/// Least squares by the normal equations: few unknowns, rows of the order of 1.
fn least_squares(rows: &DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    rows.tr_mul(rows).cholesky().map(|normal| normal.solve(&rows.tr_mul(values)))
}

/// What makes the largest residual least: Stiefel's exchange.
///
/// The answer is that of the worst choice of one row more than unknowns. A row beyond the level of the choice at hand is
/// taken in for the one without which the level is highest, until there is none.
fn minimax(rows: &DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    let mut chosen = independent(rows)?;
    let through = rows.select_rows(&chosen).lu().solve(&values.select_rows(&chosen))?;
    let off = values - rows * &through;
    let worst = (0..rows.nrows())
        .filter(|k| !chosen.contains(k))
        .max_by(|a, b| off[*a].abs().total_cmp(&off[*b].abs()))?;
    chosen.push(worst);
    let mut best = levelled(rows, values, &chosen)?;
    for _ in 0..rows.nrows() {
        let residuals = values - rows * &best.0;
        let worst = residuals.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?.0;
        if residuals[worst].abs() <= best.1 * (1.0 + 1e-12) + 1e-15 || chosen.contains(&worst) {
            break;
        }
        let exchanged = (0..chosen.len()).filter_map(|out| {
            let mut other = chosen.clone();
            other[out] = worst;
            levelled(rows, values, &other).map(|level| (level, other))
        });
        let (level, other) = exchanged.max_by(|a, b| a.0.1.total_cmp(&b.0.1))?;
        if level.1 <= best.1 {
            break;
        }
        (best, chosen) = (level, other);
    }
    Some(best.0)
}

/// As many rows as unknowns, none of which follows from the others: the longest, then always what is farthest from those
/// that were taken. (Rows at even steps may all lie at one angle.)
fn independent(rows: &DMatrix<f64>) -> Option<Vec<usize>> {
    let mut left = rows.clone();
    (0..rows.ncols())
        .map(|_| {
            let size = |k: usize| left.row(k).norm_squared();
            let taken = (0..left.nrows()).max_by(|a, b| size(*a).total_cmp(&size(*b)))?;
            let way = left.row(taken).into_owned();
            let length = way.norm();
            if length < DEPENDENT {
                return None;
            }
            let shares = &left * way.transpose() / length.powi(2);
            left -= shares * way;
            Some(taken)
        })
        .collect()
}

/// The unknowns that give the chosen rows residuals of one size, and that size; the signs are those of the
/// combination in which the rows vanish.
fn levelled(rows: &DMatrix<f64>, values: &DVector<f64>, chosen: &[usize]) -> Option<(DVector<f64>, f64)> {
    let unknowns = rows.ncols();
    let padded =
        DMatrix::from_fn(
            unknowns + 1,
            unknowns + 1,
            |j, k| {
                if j < unknowns { rows[(chosen[k], j)] } else { 0.0 }
            },
        );
    let svd = padded.svd(false, true);
    let null = svd.singular_values.imin();
    // More than one combination in which they vanish: their residuals have no one size.
    if svd.singular_values.iter().enumerate().any(|(k, size)| k != null && *size < DEPENDENT) {
        return None;
    }
    let vanishing = svd.v_t?.row(null).transpose();
    let bordered = DMatrix::from_fn(unknowns + 1, unknowns + 1, |k, j| {
        if j < unknowns {
            rows[(chosen[k], j)]
        } else if vanishing[k] < 0.0 {
            -1.0
        } else {
            1.0
        }
    });
    let wanted = DVector::from_iterator(chosen.len(), chosen.iter().map(|k| values[*k]));
    let found = bordered.lu().solve(&wanted)?;
    Some((found.rows(0, unknowns).into_owned(), found[unknowns].abs()))
}
