//! Non-linear shapes, found on the residual: where, when, with which period.

use machine_model::Vector;
use units::math;

use crate::equations::columns::Source;
use crate::equations::noise::median;
use crate::equations::observation::{Row, Scalar};
use crate::library::sampling::{ENOUGH_PLACES, FINE, UNEVEN};

/// Pitches that screws, racks and gears are made with, mm; five, four, two and one a turn of an inch among them.
const NOMINAL_PITCHES_MM: [f64; 21] = [
    2.0, 2.5, 4.0, 5.0, 5.08, 6.0, 6.35, 8.0, 10.0, 12.0, 12.7, 15.0, 16.0, 20.0, 24.0, 25.0, 25.4, 30.0,
    32.0, 40.0, 50.0,
];
/// How far from a nominal pitch is still a neighbour.
const NEIGHBOURHOOD: f64 = 0.025;
/// Free periods are looked for where an axis was read at enough places, and within these, mm.
const SHORTEST_MM: f64 = 1.0;
const LONGEST_MM: f64 = 60.0;
/// Rows before and after a knock: of fewer at the end of a file nobody can tell it from a blunder or two.
pub(crate) const STEP_ROWS: usize = 4;
/// Places in a damage: one or two alone could be anything.
pub(crate) const LOCAL_PLACES: usize = 3;
/// Equations that a scan over shapes looks at; more are thinned evenly.
pub(crate) const SCAN_EQUATIONS: usize = 12_000;

/// Every n-th equation, so that at most [`SCAN_EQUATIONS`] remain.
pub(crate) fn thinned(scalars: &[Scalar]) -> Vec<usize> {
    let step = scalars.len().div_ceil(SCAN_EQUATIONS).max(1);
    (0..scalars.len()).step_by(step).collect()
}

/// The pitches of one axis that can be asked about: nominal ones, each with its neighbours, and any where the axis is read
/// finely.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pitches {
    grid: Vec<Band>,
    /// Of the nominal ones those that even steps show as a slow curve, or not at all: rivals of curves.
    strobed: Vec<Band>,
    /// How many are looked at.
    asked: usize,
}

impl Pitches {
    /// What the rows of a file can show of one axis.
    pub(crate) fn new(source: &Source<'_>, axis: usize) -> Self {
        let places = || {
            let seen = thinned(source.scalars).into_iter().map(|i| &source.scalars[i]);
            seen.filter(|s| s.along[axis].abs() > 0.3).map(|s| source.rows[s.row].command.linear_mm[axis])
        };
        let (low, high) = places().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(q), h.max(q)));
        let length = high - low;
        let mut found = Self::default();
        if places().count() < 12 || length.is_nan() {
            return found;
        }
        let steps: Vec<f64> = source
            .rows
            .windows(2)
            .filter(|pair| pair[0].run == pair[1].run)
            .map(|pair| (pair[1].command.linear_mm[axis] - pair[0].command.linear_mm[axis]).abs())
            .filter(|step| *step > 0.0)
            .collect();
        let counts = counted(&steps);
        for nominal in NOMINAL_PITCHES_MM.into_iter().filter(|p| 3.0 * p <= length) {
            let step = (0.25 / length).max(2.0 * NEIGHBOURHOOD / (60.0 * nominal));
            let count = (NEIGHBOURHOOD / (nominal * step)).floor();
            let band = Band::new(1.0 / nominal - count * step, step, 2 * count as usize + 1, &counts);
            found.asked += band.is_seen.len();
            found.grid.push(band);
            if is_strobed(&counts, nominal) {
                found.strobed.push(Band::new(1.0 / nominal, step, 1, &[]));
            }
        }
        // Where an axis is read so finely that no curve passes for a wave, gears and racks may have any period.
        let read = thinned(source.scalars).into_iter().map(|i| source.scalars[i].row);
        let mut distinct: Vec<f64> = read.map(|row| source.rows[row].command.linear_mm[axis]).collect();
        distinct.sort_by(f64::total_cmp);
        let square: f64 = distinct.windows(2).map(|w| (w[1] - w[0]) * (w[1] - w[0])).sum();
        distinct.dedup();
        if distinct.len() <= ENOUGH_PLACES {
            return found;
        }
        // Places without an order show any wave, even ones only what is far longer than their step.
        let step = median(&mut steps.clone()).unwrap_or(f64::INFINITY);
        let odd = steps.iter().filter(|s| (**s / step - 1.0).abs() > UNEVEN).count();
        let fine = if 3 * odd >= steps.len() { 0.0 } else { FINE * (square / length.max(1e-9)).max(step) };
        let (mut highest, lowest) = (1.0 / fine.max(SHORTEST_MM), 1.0 / LONGEST_MM.min(length / 3.0));
        let step = 0.25 / length;
        while highest >= lowest {
            let least = (0.8 * highest).max(lowest);
            let count = ((highest - least) / step).floor() + 1.0;
            found.asked += count as usize;
            found.grid.push(Band::new(highest - (count - 1.0) * step, step, count as usize, &counts));
            highest -= count * step;
        }
        found
    }

    /// Those that explain most of the residual, the best first, how many were looked at, and the best one that even steps hide.
    pub(crate) fn best(
        &self,
        source: &Source<'_>,
        residuals_um: &[f64],
        axis: usize,
    ) -> (Vec<f64>, usize, Option<f64>) {
        let mut places: Vec<Place> = thinned(source.scalars)
            .into_iter()
            .map(|i| (&source.scalars[i], residuals_um[i]))
            .filter(|(s, _)| s.along[axis].abs() > 0.3)
            .map(|(s, r)| Place {
                position_mm: source.rows[s.row].command.linear_mm[axis],
                count: 1.0,
                sum_um: r * s.along[axis],
            })
            .collect();
        places.sort_by(|a, b| a.position_mm.total_cmp(&b.position_mm));
        places.dedup_by(|next, first| {
            let same = next.position_mm == first.position_mm;
            if same {
                first.count += next.count;
                first.sum_um += next.sum_um;
            }
            same
        });
        let strongest = |grid: &[Band]| {
            let mut found: Vec<(f64, f64)> = grid.iter().filter_map(|band| band.strongest(&places)).collect();
            found.sort_by(|a, b| b.1.total_cmp(&a.1));
            found.into_iter().map(|(pitch, _)| pitch)
        };
        (strongest(&self.grid).take(2).collect(), self.asked, strongest(&self.strobed).next())
    }
}

/// Residuals at one position of an axis.
#[derive(Clone, Copy, Debug)]
struct Place {
    position_mm: f64,
    count: f64,
    sum_um: f64,
}

/// Periods beside each other, even in turns per millimetre.
#[derive(Clone, Debug)]
struct Band {
    /// Turns per millimetre of the longest, and from each to the next.
    from: f64,
    step: f64,
    /// False of those that the steps from row to row show as a slow curve.
    is_seen: Vec<bool>,
}

impl Band {
    fn new(from: f64, step: f64, count: usize, steps_mm: &[(f64, usize)]) -> Self {
        let period_mm = |k: usize| 1.0 / (from + step * k as f64);
        Self { from, step, is_seen: (0..count).map(|k| !is_strobed(steps_mm, period_mm(k))).collect() }
    }

    /// The period that explains most, mm, and the square it explains.
    fn strongest(&self, places: &[Place]) -> Option<(f64, f64)> {
        let turned = |per_mm: f64| {
            let turn = |place: &Place| math::sin_cos(std::f64::consts::TAU * per_mm * place.position_mm);
            places.iter().map(turn).collect::<Vec<(f64, f64)>>()
        };
        // From period to period each place turns by the same angle.
        let (mut turns, by) = (turned(self.from), turned(self.step));
        let mut best: Option<(f64, f64)> = None;
        for (k, is_seen) in self.is_seen.iter().enumerate() {
            let found = is_seen.then(|| power(places, &turns));
            if let Some(found) = found.filter(|found| best.is_none_or(|(_, most)| *found > most)) {
                best = Some((1.0 / (self.from + self.step * k as f64), found));
            }
            for ((sin, cos), (s, c)) in turns.iter_mut().zip(&by) {
                (*sin, *cos) = (*sin * c + *cos * s, *cos * c - *sin * s);
            }
        }
        best
    }
}

/// Square explained by a sine and a cosine of these values beside a constant.
fn power(places: &[Place], turns: &[(f64, f64)]) -> f64 {
    let (mut s, mut c, mut ss, mut sc, mut cc, mut sy, mut cy, mut y, mut n) =
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (place, (sin, cos)) in places.iter().zip(turns) {
        let (k, r) = (place.count, place.sum_um);
        (s, c, ss, sc, cc) =
            (s + k * sin, c + k * cos, ss + k * sin * sin, sc + k * sin * cos, cc + k * cos * cos);
        (sy, cy, y, n) = (sy + sin * r, cy + cos * r, y + r, n + k);
    }
    let (ss, sc, cc) = (ss - s * s / n, sc - s * c / n, cc - c * c / n);
    let (sy, cy) = (sy - s * y / n, cy - c * y / n);
    let determinant = ss * cc - sc * sc;
    if determinant < 0.02 * n * n {
        return 0.0;
    }
    (cc * sy * sy - 2.0 * sc * sy * cy + ss * cy * cy) / determinant
}

/// The moment at which the residual of one axis jumps most, and how many were looked at: a time, or how far through
/// the file where no row has one.
pub(crate) fn knock(source: &Source<'_>, residuals_um: &[f64], axis: usize) -> Option<(f64, usize)> {
    let timed = source.rows.iter().any(|row| row.conditions.time_s.is_some());
    let moment = |row: &Row| if timed { row.conditions.time_s } else { Some(row.order[0]) };
    let mut points: Vec<(f64, f64)> = source
        .scalars
        .iter()
        .zip(residuals_um)
        .filter(|(s, _)| s.along[axis].abs() > 0.3)
        .filter_map(|(s, r)| moment(&source.rows[s.row]).map(|t| (t, r * s.along[axis])))
        .collect();
    let mut jumps = Jumps { least: STEP_ROWS, ..Jumps::default() };
    jumps.look(&mut points, f64::MIN_POSITIVE);
    jumps.largest()
}

/// Where the mean of some numbers changes most along a line.
#[derive(Default)]
struct Jumps {
    /// The place so far, and the square it explains.
    best: Option<(f64, f64)>,
    asked: usize,
    /// Points on either side that a change needs.
    least: usize,
}

impl Jumps {
    /// Looks between all neighbouring `points` (place, value) that are at least `apart` from each other; sorts them by place.
    fn look(&mut self, points: &mut [(f64, f64)], apart: f64) {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let count = points.len() as f64;
        let total: f64 = points.iter().map(|p| p.1).sum();
        let mut before = 0.0;
        for (place, pair) in points.windows(2).enumerate() {
            before += pair[0].1;
            let side = (place + 1).min(points.len() - place - 1);
            if pair[1].0 - pair[0].0 < apart || side < self.least {
                continue;
            }
            self.asked += 1;
            let (n, m) = (place as f64 + 1.0, count - place as f64 - 1.0);
            // Square explained by two means instead of one.
            let gap = before / n - (total - before) / m;
            let power = gap * gap * n * m / count;
            if self.best.is_none_or(|(_, p)| power > p) {
                self.best = Some((0.5 * (pair[0].0 + pair[1].0), power));
            }
        }
    }

    /// The best place, and how many were looked at.
    fn largest(self) -> Option<(f64, usize)> {
        self.best.map(|(place, _)| (place, self.asked))
    }
}

/// The place of an axis at which the residual of one other component jumps most, and how many were looked at.
pub(crate) fn joint(source: &Source<'_>, residuals_um: &[f64], axis: usize) -> Option<(f64, usize)> {
    /// Places closer than this are one, mm.
    const APART_MM: f64 = 1e-3;
    let mut jumps = Jumps::default();
    for class in (0..3).filter(|class| *class != axis) {
        let mut points: Vec<(f64, f64)> = thinned(source.scalars)
            .into_iter()
            .filter(|i| source.scalars[*i].along[class].abs() > 0.3)
            .map(|i| {
                let s = &source.scalars[i];
                (source.rows[s.row].command.linear_mm[axis], residuals_um[i] * s.along[class])
            })
            .collect();
        jumps.look(&mut points, APART_MM);
    }
    jumps.largest()
}

/// Place and width where a bump along one axis explains most of the residual, all components together; how many
/// were looked at.
pub(crate) fn damage(
    source: &Source<'_>,
    residuals_um: &[f64],
    axis: usize,
    narrowest_mm: f64,
) -> Option<(f64, f64, usize)> {
    const WIDTHS: [f64; 5] = [0.04, 0.07, 0.12, 0.18, 0.27];
    let mut points: Vec<(f64, Vector, f64)> = thinned(source.scalars)
        .into_iter()
        .map(|i| (&source.scalars[i], residuals_um[i]))
        .map(|(s, r)| (source.rows[s.row].command.linear_mm[axis], s.along, r))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (low, high) = (points.first()?.0, points.last()?.0);
    let length = high - low;
    if length <= 0.0 {
        return None;
    }
    let (mut best, mut asked) = (None, 0);
    let mut most = 0.0;
    for share in WIDTHS.into_iter().filter(|share| share * length >= narrowest_mm) {
        let (width, step) = (share * length, share * length / 4.0);
        let count = (length / step) as i32;
        for k in 0..=count {
            let centre = low + step * f64::from(k);
            asked += 1;
            let from = points.partition_point(|p| p.0 <= centre - 0.5 * width);
            let to = points.partition_point(|p| p.0 < centre + 0.5 * width);
            let (mut cross, mut square, mut different) = (Vector::zeros(), Vector::zeros(), 0_usize);
            let mut last = f64::NAN;
            for (q, along, r) in &points[from..to] {
                let wave = math::cos(std::f64::consts::PI * (q - centre) / width);
                let bump = along * (wave * wave);
                cross += bump * *r;
                square += bump.component_mul(&bump);
                different += usize::from(*q != last);
                last = *q;
            }
            if different < LOCAL_PLACES {
                continue;
            }
            let power: f64 =
                (0..3).filter(|c| square[*c] > 1e-9).map(|c| cross[c] * cross[c] / square[c]).sum();
            if power > most {
                most = power;
                best = Some((centre, width));
            }
        }
    }
    best.map(|(centre, width)| (centre, width, asked))
}

/// Lengths of steps and how many have each, those alike within a nanometre as one.
fn counted(steps_mm: &[f64]) -> Vec<(f64, usize)> {
    const ALIKE_MM: f64 = 1e-6;
    let mut counted: Vec<(f64, usize)> = steps_mm.iter().map(|step| (*step, 1)).collect();
    counted.sort_by(|a, b| a.0.total_cmp(&b.0));
    counted.dedup_by(|next, first| {
        let alike = next.0 - first.0 < ALIKE_MM;
        first.1 += if alike { next.1 } else { 0 };
        alike
    });
    counted
}

/// True where steps from row to row are so close to whole periods that the wave is sampled as a slow curve.
fn is_strobed(steps_mm: &[(f64, usize)], pitch_mm: f64) -> bool {
    let long = steps_mm.iter().filter(|(step, _)| *step >= 0.5 * pitch_mm);
    let (all, slow) = long.fold((0, 0), |(all, slow), (step, count)| {
        let phase = step / pitch_mm;
        (all + count, slow + count * usize::from((phase - phase.round()).abs() < 0.12))
    });
    all > 8 && 10 * slow > 8 * all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_jump_lies_between_the_places_where_the_mean_changes() {
        // Out of order, two readings at one place: none lies between those.
        let mut points = vec![(5.0, 3.0), (1.0, 0.0), (3.0, 0.1), (2.0, -0.1), (4.0, 2.9), (4.0, 3.1)];
        let mut jumps = Jumps::default();
        jumps.look(&mut points, f64::MIN_POSITIVE);
        assert_eq!(jumps.largest(), Some((3.5, 4)));
    }

    #[test]
    fn the_larger_of_two_components_jumps_counts_and_both_were_asked() {
        let mut jumps = Jumps::default();
        jumps.look(&mut [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)], 1e-3);
        jumps.look(&mut [(0.0, 0.0), (1.0, 5.0), (1.0005, 5.0)], 1e-3);
        assert_eq!(jumps.largest(), Some((0.5, 3)));
        assert_eq!(Jumps::default().largest(), None);
    }

    #[test]
    fn power_is_the_square_that_the_wave_explains() {
        let wave = |q: f64, pitch: f64| math::sin(std::f64::consts::TAU * q / pitch);
        let places: Vec<Place> = (0..200)
            .map(|k| f64::from(k) * 0.7)
            .map(|q| Place { position_mm: q, count: 1.0, sum_um: 2.0 + 3.0 * wave(q, 10.0) })
            .collect();
        let mean = places.iter().map(|p| p.sum_um).sum::<f64>() / 200.0;
        let square: f64 = places.iter().map(|p| (p.sum_um - mean) * (p.sum_um - mean)).sum();
        let power =
            |places: &[Place], pitch: f64| Band::new(1.0 / pitch, 1.0, 1, &[]).strongest(places).map(|f| f.1);
        assert!(power(&places, 7.3) < Some(0.05 * square));
        // Turned from period to period, it is found among its neighbours.
        let (pitch, found) =
            Band::new(0.1 - 40.0 * 1e-4, 1e-4, 90, &[]).strongest(&places).expect("one of them");
        assert!((pitch - 10.0).abs() < 1e-9 && (found / square - 1.0).abs() < 1e-9, "{pitch} {found}");
        // A period on which every place stands alike has no sine to speak of.
        let strobed: Vec<Place> =
            (0..50).map(|k| Place { position_mm: 10.0 * f64::from(k), count: 1.0, sum_um: 1.0 }).collect();
        assert_eq!(power(&strobed, 10.0), Some(0.0));
    }

    #[test]
    fn steps_of_whole_periods_are_strobed() {
        assert!(is_strobed(&counted(&[20.0; 12]), 10.0));
        assert!(!is_strobed(&counted(&[23.0; 12]), 10.0));
        assert!(!is_strobed(&counted(&[20.0; 8]), 10.0), "too few steps to tell");
        assert!(!is_strobed(&counted(&[1.0; 100]), 10.0), "steps below half a period see the wave");
    }

    #[test]
    fn a_knock_needs_rows_on_both_sides() {
        let place = |off: usize| {
            let value = |k: usize| if k + off >= 40 { 9.0 } else { f64::from(u8::from(k.is_multiple_of(3))) };
            let mut points: Vec<(f64, f64)> = (0..40).map(|k| (k as f64, value(k))).collect();
            let mut jumps = Jumps { least: STEP_ROWS, ..Jumps::default() };
            jumps.look(&mut points, f64::MIN_POSITIVE);
            jumps.largest().map(|(place, _)| place)
        };
        assert_eq!(place(6), Some(33.5));
        // Two rows at the end are never all that lies behind a knock.
        assert_eq!(place(2), Some(35.5));
        let mut few = vec![(0.0, 0.0), (1.0, 0.0), (2.0, 9.0)];
        let mut jumps = Jumps { least: STEP_ROWS, ..Jumps::default() };
        jumps.look(&mut few, f64::MIN_POSITIVE);
        assert_eq!(jumps.largest(), None);
    }
}
