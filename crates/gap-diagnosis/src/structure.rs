//! Is what is left noise?

use std::collections::BTreeMap;

use statrs::distribution::{ContinuousCDF, Normal};

use crate::engine::f_tail;
use crate::noise::{Noise, NoiseSource};
use crate::observation::{Measurements, Row, Scalar};

/// Probability that noise alone leaves this residual: the smaller of a variance ratio against repeats (where
/// there are any) and of the correlation of neighbours along the runs, corrected for asking twice.
#[must_use]
pub(crate) fn lack_of_fit(
    rows: &[Row],
    scalars: &[Scalar],
    residuals_um: &[f64],
    noise: Option<Noise>,
    degrees: f64,
) -> f64 {
    let square: f64 = scalars.iter().zip(residuals_um).map(|(s, r)| s.weight * r * r).sum();
    let against_repeats = noise.filter(|n| n.source != NoiseSource::Neighbours).map_or(1.0, |n| {
        let rest = (degrees - n.degrees).max(1.0);
        let lack = ((square - n.variance * n.degrees) / rest).max(0.0);
        f_tail(lack / n.variance.max(1e-12), rest, n.degrees)
    });
    let along_lines = neighbours_p(rows, scalars, residuals_um);
    (2.0 * against_repeats.min(along_lines)).min(1.0)
}

/// Lag-one correlation of residuals along the runs, one-sided: structure is smooth, noise is not.
fn neighbours_p(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> f64 {
    let mut lines: BTreeMap<(usize, usize, [i8; 3]), Vec<f64>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let row = &rows[scalar.row];
        let line = lines.entry((row.run, scalar.class, row.command.direction)).or_default();
        line.push(r * scalar.weight.sqrt());
    }
    let (mut product, mut square, mut pairs, mut count) = (0.0, 0.0, 0.0, 0.0);
    for line in lines.values().filter(|l| l.len() > 3) {
        let mean = line.iter().sum::<f64>() / line.len() as f64;
        product += line.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>();
        square += line.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        pairs += line.len() as f64 - 1.0;
        count += line.len() as f64;
    }
    if pairs < 12.0 || square <= 0.0 {
        return 1.0;
    }
    let correlation = (product / pairs) / (square / count);
    1.0 - Normal::standard().cdf(correlation * f64::sqrt(pairs))
}

/// Columns along which the leftover is uneven: squares of group means against the scatter.
#[must_use]
pub(crate) fn correlates(data: &Measurements, scalars: &[Scalar], residuals_um: &[f64]) -> Vec<String> {
    type Value = fn(&Row) -> Option<f64>;
    let columns: [(&str, Value); 12] = [
        ("x_mm", |r| Some(r.command.linear_mm.x)),
        ("y_mm", |r| Some(r.command.linear_mm.y)),
        ("z_mm", |r| Some(r.command.linear_mm.z)),
        ("a_deg", |r| Some(r.command.rotary_rad.x)),
        ("b_deg", |r| Some(r.command.rotary_rad.y)),
        ("c_deg", |r| Some(r.command.rotary_rad.z)),
        ("time_s", |r| r.conditions.time_s),
        ("temp_c", |r| r.conditions.temp_c[0]),
        ("feed_mm_min", |r| r.conditions.feed_mm_min),
        ("load_kg", |r| r.conditions.load_kg),
        ("tool_z_mm", |r| Some(r.command.tool_mm.z)),
        ("dir_x", |r| Some(f64::from(r.command.direction[0]))),
    ];
    let mut found: Vec<(f64, String)> = Vec::new();
    for (name, value) in columns {
        for class in 0..4 {
            let points: Vec<(f64, f64)> = scalars
                .iter()
                .zip(residuals_um)
                .filter(|(s, _)| s.class == class)
                .filter_map(|(s, r)| value(&data.rows[s.row]).map(|v| (v, *r)))
                .collect();
            let p = group_p(points);
            if p < 1e-4 {
                let component = ["dx", "dy", "dz", "length"][class];
                found.push((p, format!("{component} over {name}")));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().take(5).map(|(_, name)| name).collect()
}

/// One-way analysis of variance over ten groups of equal size.
fn group_p(mut points: Vec<(f64, f64)>) -> f64 {
    const GROUPS: usize = 10;
    if points.len() < 5 * GROUPS {
        return 1.0;
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    if points[0].0 == points[points.len() - 1].0 {
        return 1.0;
    }
    // Equal values stay in one group.
    let mut groups: Vec<Vec<f64>> = Vec::new();
    let size = points.len().div_ceil(GROUPS);
    let mut last = f64::NAN;
    for (value, residual) in points {
        let full = groups.last().is_none_or(|g| g.len() >= size);
        if full && value != last {
            groups.push(Vec::new());
        }
        if let Some(group) = groups.last_mut() {
            group.push(residual);
        }
        last = value;
    }
    let count: f64 = groups.iter().map(|g| g.len() as f64).sum();
    let mean = groups.iter().flatten().sum::<f64>() / count;
    let (mut between, mut within) = (0.0, 0.0);
    for group in &groups {
        let own = group.iter().sum::<f64>() / group.len() as f64;
        between += group.len() as f64 * (own - mean) * (own - mean);
        within += group.iter().map(|v| (v - own) * (v - own)).sum::<f64>();
    }
    let (a, b) = (groups.len() as f64 - 1.0, count - groups.len() as f64);
    if a < 1.0 || within <= 0.0 { 1.0 } else { f_tail(between / a / (within / b), a, b) }
}
