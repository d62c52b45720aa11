//! Non-linear shapes: found on the residual, refined on the fit (variable projection).

use machine_model::Vector;
use machine_model::effects::{EffectKind, Shape};
use units::math;

use crate::gram::{Gram, Source};
use crate::library::{Library, Variant};
use crate::linear::explained;
use crate::noise::median;
use crate::observation::Scalar;
use crate::term::Term;

/// Pitches that screws, racks and gears are made with, mm.
const NOMINAL_PITCHES_MM: [f64; 17] =
    [2.0, 2.5, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 16.0, 20.0, 24.0, 25.0, 30.0, 32.0, 40.0, 50.0];
/// Damage at a place is narrower than this share of the axis.
pub(crate) const LOCAL_WIDEST: f64 = 0.3;
/// So many places at uneven distances show a wave even where they lie further apart than half its period.
const ENOUGH_PLACES: usize = 24;
/// How far from a nominal pitch is still a neighbour.
const NEIGHBOURHOOD: f64 = 0.025;
/// Equations that a scan over shapes looks at; more are thinned evenly.
pub(crate) const SCAN_EQUATIONS: usize = 12_000;

/// Every n-th equation, so that at most [`SCAN_EQUATIONS`] remain.
#[must_use]
pub(crate) fn thinned(scalars: &[Scalar]) -> Vec<usize> {
    let step = scalars.len().div_ceil(SCAN_EQUATIONS).max(1);
    (0..scalars.len()).step_by(step).collect()
}

/// The pitches of one axis that explain most of the residual, and how many were looked at.
#[must_use]
pub(crate) fn pitches(source: &Source<'_>, residuals_um: &[f64], axis: usize) -> (Vec<f64>, usize) {
    let points: Vec<(f64, f64)> = thinned(source.scalars)
        .into_iter()
        .map(|i| (source.scalars[i], residuals_um[i]))
        .filter(|(s, _)| s.along[axis].abs() > 0.3)
        .map(|(s, r)| (source.rows[s.row].command.linear_mm[axis], r * s.along[axis]))
        .collect();
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (q, _)| (l.min(*q), h.max(*q)));
    let length = high - low;
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut asked = 0;
    if points.len() < 12 || length.is_nan() {
        return (Vec::new(), 0);
    }
    for nominal in NOMINAL_PITCHES_MM.into_iter().filter(|p| 3.0 * p <= length) {
        let step = (0.25 * nominal * nominal / length).max(2.0 * NEIGHBOURHOOD * nominal / 60.0);
        let count = (NEIGHBOURHOOD * nominal / step).floor() as i32;
        let mut best: Option<(f64, f64)> = None;
        for k in -count..=count {
            asked += 1;
            let pitch = nominal + step * f64::from(k);
            if is_strobed(source, axis, pitch) {
                continue;
            }
            let power = power(&points, pitch);
            if best.is_none_or(|(_, p)| power > p) {
                best = Some((pitch, power));
            }
        }
        found.extend(best);
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    (found.into_iter().take(2).map(|(p, _)| p).collect(), asked)
}

/// Square explained by a sine and a cosine of this period beside a constant.
fn power(points: &[(f64, f64)], pitch_mm: f64) -> f64 {
    let (mut s, mut c, mut ss, mut sc, mut cc, mut sy, mut cy, mut y) =
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (q, r) in points {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * q / pitch_mm);
        (s, c, ss, sc, cc) = (s + sin, c + cos, ss + sin * sin, sc + sin * cos, cc + cos * cos);
        (sy, cy, y) = (sy + sin * r, cy + cos * r, y + r);
    }
    let n = points.len() as f64;
    let (ss, sc, cc) = (ss - s * s / n, sc - s * c / n, cc - c * c / n);
    let (sy, cy) = (sy - s * y / n, cy - c * y / n);
    let determinant = ss * cc - sc * sc;
    if determinant < 0.02 * n * n {
        return 0.0;
    }
    (cc * sy * sy - 2.0 * sc * sy * cy + ss * cy * cy) / determinant
}

/// The time at which the residual of one axis jumps most, and how many were looked at.
#[must_use]
pub(crate) fn knock(source: &Source<'_>, residuals_um: &[f64], axis: usize) -> Option<(f64, usize)> {
    let mut points: Vec<(f64, f64)> = source
        .scalars
        .iter()
        .zip(residuals_um)
        .filter(|(s, _)| s.along[axis].abs() > 0.3)
        .filter_map(|(s, r)| source.rows[s.row].conditions.time_s.map(|t| (t, r * s.along[axis])))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = points.len() as f64;
    let total: f64 = points.iter().map(|p| p.1).sum();
    let mut before = 0.0;
    let mut best: Option<(f64, f64)> = None;
    let mut asked = 0;
    for (place, pair) in points.windows(2).enumerate() {
        before += pair[0].1;
        if pair[1].0 <= pair[0].0 {
            continue;
        }
        asked += 1;
        let (n, m) = (place as f64 + 1.0, count - place as f64 - 1.0);
        // Square explained by two means instead of one.
        let gap = before / n - (total - before) / m;
        let power = gap * gap * n * m / count;
        if best.is_none_or(|(_, p)| power > p) {
            best = Some((0.5 * (pair[0].0 + pair[1].0), power));
        }
    }
    best.map(|(time, _)| (time, asked))
}

/// Place and width where a bump along one axis explains most of the residual, all components together; how many
/// were looked at.
#[must_use]
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
            let (mut cross, mut square, mut different) = (Vector::zeros(), Vector::zeros(), 0);
            let mut last = f64::NAN;
            for (q, along, r) in &points[from..to] {
                let wave = math::cos(std::f64::consts::PI * (q - centre) / width);
                let bump = along * (wave * wave);
                cross += bump * *r;
                square += bump.component_mul(&bump);
                different += i32::from(*q != last);
                last = *q;
            }
            // One or two places alone could be anything.
            if different < 3 {
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

/// True where the places measured along the axis lie further apart than half a period.
#[must_use]
pub(crate) fn is_coarse(source: &Source<'_>, axis: usize, pitch_mm: f64) -> bool {
    let mut places: Vec<f64> = source.rows.iter().map(|r| r.command.linear_mm[axis]).collect();
    places.sort_by(f64::total_cmp);
    let mut steps: Vec<f64> = places.windows(2).map(|w| w[1] - w[0]).filter(|s| *s > 1e-3).collect();
    steps.len() < ENOUGH_PLACES && median(&mut steps).is_none_or(|step| step > 0.5 * pitch_mm)
}

/// True where steps from row to row are so close to whole periods that the wave is sampled as a slow curve.
fn is_strobed(source: &Source<'_>, axis: usize, pitch_mm: f64) -> bool {
    let mut slow = 0;
    let mut all = 0;
    for pair in source.rows.windows(2) {
        let step = (pair[1].command.linear_mm[axis] - pair[0].command.linear_mm[axis]).abs();
        if pair[0].run != pair[1].run || step < 0.5 * pitch_mm {
            continue;
        }
        let phase = step / pitch_mm;
        all += 1;
        slow += i32::from((phase - phase.round()).abs() < 0.12);
    }
    all > 8 && 10 * slow > 8 * all
}

/// Forms of a pitch error with this period: textbook, with harmonics, with a slope of the amplitude.
pub(crate) fn pitch_variants(
    library: &mut Library,
    axis: usize,
    pitch_mm: f64,
    range: (f64, f64),
) -> Vec<Variant> {
    let shape = Shape { pitch_mm, from_mm: range.0, to_mm: range.1, ..Shape::default() };
    let all: Vec<usize> = (0..12).collect();
    let columns = library.add_columns(EffectKind::Pitch(axis), shape, &all);
    let pick = |list: &[usize]| list.iter().map(|i| columns[*i]).collect::<Vec<_>>();
    vec![
        Variant { columns: pick(&[0, 1]), enriched: false, only_rival: false },
        Variant { columns: pick(&[0, 1, 2, 3]), enriched: true, only_rival: false },
        Variant { columns: pick(&[0, 1, 6, 7]), enriched: true, only_rival: false },
        Variant { columns: pick(&[0, 1, 2, 3, 4, 5]), enriched: true, only_rival: false },
        Variant { columns, enriched: true, only_rival: false },
    ]
}

/// One free number of a shape.
#[derive(Clone, Copy, Debug)]
struct Free {
    get: fn(&Shape) -> f64,
    set: fn(&mut Shape, f64),
    /// Half of the first step.
    step: f64,
    low: f64,
    high: f64,
}

fn free_numbers(kind: EffectKind, shape: &Shape, length_mm: f64, narrowest_mm: f64) -> Vec<Free> {
    match kind {
        EffectKind::Pitch(_) => vec![Free {
            get: |s| s.pitch_mm,
            set: |s, v| s.pitch_mm = v,
            step: 0.15 * shape.pitch_mm * shape.pitch_mm / length_mm.max(shape.pitch_mm),
            low: 0.2,
            high: f64::INFINITY,
        }],
        EffectKind::Warmup(_) => vec![Free {
            get: |s| s.tau_s,
            set: |s, v| (s.tau_s, s.tau2_s) = (v, v * (s.tau2_s / s.tau_s)),
            step: 0.4 * shape.tau_s,
            low: 1.0,
            high: f64::INFINITY,
        }],
        EffectKind::Local(_) => vec![
            Free {
                get: |s| s.centre_mm,
                set: |s, v| s.centre_mm = v,
                step: 0.25 * shape.width_mm,
                low: f64::NEG_INFINITY,
                high: f64::INFINITY,
            },
            Free {
                get: |s| s.width_mm,
                set: |s, v| s.width_mm = v,
                step: 0.4 * shape.width_mm,
                low: narrowest_mm.min(LOCAL_WIDEST * length_mm),
                // Wider is a bow, not damage at a place.
                high: LOCAL_WIDEST * length_mm,
            },
        ],
        _ => Vec::new(),
    }
}

/// Shape of one effect that, beside the other columns, explains most; `None` where it has no free number.
///
/// `others`: set-up and the other effects; `indices`: coefficients of this one.
#[must_use]
pub(crate) fn refined(
    source: &Source<'_>,
    others: &[Term],
    kind: EffectKind,
    shape: &Shape,
    indices: &[usize],
    rho: f64,
    narrowest_mm: f64,
) -> Option<Shape> {
    let length_mm = match kind {
        EffectKind::Pitch(a) | EffectKind::Local(a) => range(source, a),
        _ => 0.0,
    };
    let thin: Vec<Scalar> = thinned(source.scalars).into_iter().map(|i| source.scalars[i]).collect();
    let source = Source { scalars: &thin, ..*source };
    let gain = |shape: &Shape| {
        let mut terms = others.to_vec();
        terms.extend(indices.iter().map(|index| Term::Effect { kind, index: *index, shape: *shape }));
        let gram = Gram::new(terms, &source);
        let (whitened, _) = gram.whitened(rho);
        let columns: Vec<usize> = (0..gram.terms.len()).collect();
        explained(&whitened, &columns, &gram.squares()).0
    };
    let mut best = *shape;
    if let EffectKind::Step(_) = kind {
        return step_time(&source, shape, gain);
    }
    let frees = free_numbers(kind, shape, length_mm, narrowest_mm);
    if frees.is_empty() {
        return None;
    }
    let mut value = gain(&best);
    let mut steps: Vec<f64> = frees.iter().map(|f| f.step).collect();
    for _ in 0..10 {
        for (free, step) in frees.iter().zip(&mut steps) {
            let here = (free.get)(&best);
            let tries = [here - *step, here + *step].map(|v| {
                let mut shape = best;
                (free.set)(&mut shape, v.clamp(free.low, free.high));
                (shape, gain(&shape))
            });
            let better = if tries[0].1 > tries[1].1 { tries[0] } else { tries[1] };
            if better.1 > value {
                (best, value) = better;
            } else {
                *step *= 0.45;
            }
        }
    }
    Some(best)
}

/// A knock happened between two rows: try every gap near the first guess.
fn step_time(source: &Source<'_>, shape: &Shape, gain: impl Fn(&Shape) -> f64) -> Option<Shape> {
    let mut times: Vec<f64> = source.rows.iter().filter_map(|r| r.conditions.time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let place = times.partition_point(|t| *t < shape.time_s);
    let mut best: Option<(f64, f64)> = None;
    let reach = times.len() / 24 + 2;
    let stride = (reach / 24).max(1);
    let mut centre = place;
    for pass_stride in [stride, 1] {
        let span = if pass_stride == stride { reach } else { stride };
        for k in (centre.saturating_sub(span)..=centre + span).step_by(pass_stride) {
            let (Some(before), Some(after)) = (k.checked_sub(1).and_then(|b| times.get(b)), times.get(k))
            else {
                continue;
            };
            let time_s = 0.5 * (before + after);
            let value = gain(&Shape { time_s, ..*shape });
            if best.is_none_or(|(_, v)| value > v) {
                best = Some((time_s, value));
                centre = k;
            }
        }
    }
    best.map(|(time_s, _)| Shape { time_s, ..*shape })
}

fn range(source: &Source<'_>, axis: usize) -> f64 {
    let (low, high) = source.rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| {
        (l.min(r.command.linear_mm[axis]), h.max(r.command.linear_mm[axis]))
    });
    high - low
}
