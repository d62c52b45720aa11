//! Is what is left noise?

use diagnostic::Text;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::equations::f_test::f_tail;
use crate::equations::noise::{Noise, NoiseSource, along_runs, median};
use crate::equations::observation::{Measurements, Row, Scalar};

/// Probability that noise alone leaves this residual: the smaller of a variance ratio against repeats (where
/// there are any) and of the correlation of neighbours along the runs, corrected for asking twice.
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
    let lines = along_runs(rows, scalars, residuals_um);
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

/// An axis that moves in jerks while it is slow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jerks {
    pub axis: usize,
    /// Below this speed of the axis, mm/min.
    pub below_mm_min: f64,
    /// Its scatter from reading to reading there over that at higher speed.
    pub ratio: f64,
}

/// Axes whose readings, taken one after the other in motion, differ by far more while the axis is slow: stick-slip has no
/// shape that comes back, so its roughness is all that shows it. Second differences along the runs, by their medians: a
/// spike or a step at a turning point is few of them.
pub(crate) fn jerks(data: &Measurements, scalars: &[Scalar], residuals_um: &[f64]) -> Vec<Jerks> {
    /// Shares of the readings that are called slow.
    const SLOW: [f64; 4] = [0.1, 0.2, 0.35, 0.5];
    /// The scatter must grow by this factor …
    const ROUGHER: f64 = 1.7;
    /// … and by so many standard errors of a sign test; neighbouring differences share readings.
    const SURE: f64 = 7.0;
    let all: Vec<(&Scalar, f64)> = scalars.iter().zip(residuals_um.iter().copied()).collect();
    let mut rough: [Vec<(f64, f64)>; 3] = Default::default();
    for three in all.windows(3) {
        let [(before, r0), (here, r1), (after, r2)] = [three[0], three[1], three[2]];
        let row = &data.rows[here.row];
        let follows = |s: &Scalar| data.rows[s.row].run == row.run && s.class == here.class;
        let (Some(share), Some(feed)) = (row.conditions.share, row.conditions.feed_mm_min) else { continue };
        if !follows(before) || !follows(after) || before.row == here.row || here.row == after.row {
            continue;
        }
        for axis in (0..3).filter(|a| here.along[*a] * here.along[*a] > 0.5 && share[*a] > 0.0) {
            rough[axis].push((share[axis] * feed, (r1 - 0.5 * (r0 + r2)).abs()));
        }
    }
    let worst = |axis: usize| {
        let points = &mut rough[axis].clone();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let typical = |part: &[(f64, f64)]| median(&mut part.iter().map(|p| p.1).collect::<Vec<f64>>());
        let split = |share: f64| {
            let (slow, fast) = points.split_at((share * points.len() as f64) as usize);
            let (own, usual) = (typical(slow)?, typical(fast)?);
            let (count, above) = (slow.len() as f64, slow.iter().filter(|p| p.1 > usual).count() as f64);
            let sure = (above - 0.5 * count) / (0.5 * count.sqrt()) > SURE;
            let ratio = own / usual.max(1e-9);
            (sure && ratio > ROUGHER).then_some(Jerks { axis, below_mm_min: fast[0].0, ratio })
        };
        SLOW.into_iter().filter_map(split).max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    };
    (0..3).filter_map(worst).collect()
}

/// Columns along which the leftover is uneven: squares of group means against the scatter.
pub(crate) fn correlates(data: &Measurements, scalars: &[Scalar], residuals_um: &[f64]) -> Vec<Text> {
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
    let mut found: Vec<(f64, Text)> = Vec::new();
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
                let russian = ["dx", "dy", "dz", "длина"][class];
                found
                    .push((p, Text::new(format!("{component} over {name}"), format!("{russian} от {name}"))));
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
