//! Mistakes that the readings themselves contradict, each by its name.
//!
//! A column exchanged or a sign turned round still gives numbers, and a machine of a hundred parameters takes up much of them. What
//! it cannot take up shows: the readings fit far better once the mistake is undone.

use diagnostic::{Text, both};
use machine_model::{Chain, Vector};
use units::math::exp;

use crate::adjustment::Outlier;
use crate::changed::Found;
use crate::error::{CalibrationError, LETTERS};
use crate::geometry::ideal_places;
use crate::known_places::known_places;
use crate::layout::Plan;
use crate::machine_change::find;
use crate::points::{Base, Point, PointReading, seen_mm};
use crate::rigid_motion::{RigidMotion, mirrored_rms_mm};

/// A good measurement loses a reading to this test once in so many.
const FALSE_ALARM: f64 = 1e-5;
/// What no instrument reads is no mistake of it, mm: readings that were computed leave their last digits.
const LEAST_MM: f64 = 1e-4;

/// Refuses numbers that are no geometric errors in the unit they claim.
pub(crate) fn plausible(points: &[Point], base: &Base, before: &Found) -> Result<(), CalibrationError> {
    /// Machines are not off by more, however bad, mm.
    const LARGEST_MM: f64 = 3.0;
    /// No machine of any size is that good all over, mm.
    const SMALLEST_MM: f64 = 5e-5;
    let commands: Vec<_> = points.iter().map(|p| p.command).collect();
    let ideal = ideal_places(base, &commands)?;
    let (mut deviations, mut all) = (Vec::new(), Vec::new());
    for run in 0..points.iter().map(|p| p.run + 1).max().unwrap_or(0) {
        let own = || points.iter().zip(&ideal).filter(|(p, _)| p.run == run);
        let pairs: Option<Vec<(Vector, Vector)>> =
            own().map(|(p, at)| Some((*at, seen_mm(p, at)?))).collect();
        let (from, to): (Vec<Vector>, Vec<Vector>) = pairs.unwrap_or_default().into_iter().unzip();
        if from.is_empty() {
            continue;
        }
        let motion = RigidMotion::nearest(&from, &to);
        let rms = motion.rms_mm(&from, &to);
        if let Some(mirrored) = mirrored_rms_mm(&from, &to)
            && rms > LARGEST_MM
            && mirrored < 0.1 * rms
        {
            return Err(CalibrationError::Axes(Text::pair(
                "the measured positions are a mirror image of the commanded ones: one axis has the opposite sign in the measurement, or two are exchanged",
                "измеренные положения — зеркальное отображение заданных: у одной оси в измерении обратный знак или две переставлены",
            )));
        }
        let left = from.iter().zip(&to).map(|(a, b)| (b - motion.apply(a)).amax());
        if own().all(|(p, _)| matches!(p.reading, PointReading::Deviation(_))) {
            deviations.extend(left.clone());
        }
        all.extend(left);
    }
    let at = |sizes: &mut Vec<f64>, share: f64| {
        sizes.sort_by(f64::total_cmp);
        sizes.get((sizes.len() as f64 * share) as usize).copied()
    };
    let mut rest: Vec<f64> = before.estimate.residuals.iter().map(|r| r.abs()).collect();
    let median = at(&mut all, 0.5).or_else(|| at(&mut rest, 0.5)).unwrap_or(0.0);
    if median > LARGEST_MM {
        return Err(CalibrationError::Units(both!(
            "half of the readings are more than {median:.1} mm off, the best set-up of the instrument taken off: units or frames do not fit",
            "половина показаний отходит больше чем на {median:.1} мм даже за вычетом лучшей установки прибора: не те единицы или системы координат"
        )));
    }
    let large = at(&mut deviations, 0.9).unwrap_or(f64::INFINITY);
    let stated: Option<Vec<f64>> = points.iter().map(|p| p.uncertainty_mm).collect();
    let noise = stated.and_then(|mut all| at(&mut all, 0.5)).unwrap_or(0.0);
    if deviations.len() > 3 && (large < SMALLEST_MM || large < 0.1 * noise) {
        return Err(CalibrationError::Units(both!(
            "nine deviations of ten are below {:.4} um, the set-up taken off: are they in mm where um was said?",
            "девять отклонений из десяти меньше {:.4} мкм за вычетом установки: они в мм, а названы мкм?",
            large * 1e3
        )));
    }
    Ok(())
}

/// Refuses a reading that does not belong to the others.
pub(crate) fn outlier(points: &[Point], found: &Found) -> Result<(), CalibrationError> {
    let Some(Outlier { reading, residual, standardised, .. }) = found.estimate.outlier(FALSE_ALARM) else {
        return Ok(());
    };
    if residual.abs() < LEAST_MM {
        return Ok(());
    }
    let row = found.rows[reading];
    let at = points[row.point].command.linear_mm;
    Err(CalibrationError::Outlier {
        point: row.point,
        message: both!(
            "the {} at X{} Y{} Z{} is {:.1} um off what all other readings say: {:.0} times its standard deviation",
            "{:#} в X{} Y{} Z{} отходит на {:.1} мкм от того, что говорят все остальные отсчёты: это {:.0} стандартных отклонений",
            row.component.map_or(Text::pair("length", "длина"), |i| {
                both!("{} reading", "отсчёт {}", LETTERS[i])
            }),
            at.x,
            at.y,
            at.z,
            residual * 1e3,
            standardised.abs()
        ),
    })
}

/// Refuses play that is negative in every axis that has any: up and down were exchanged.
pub(crate) fn play(play_mm: &[Option<(f64, f64)>; 3]) -> Result<(), CalibrationError> {
    let clear: Vec<(usize, f64, f64)> = play_mm
        .iter()
        .enumerate()
        .filter_map(|(axis, play)| play.map(|(value, half)| (axis, value, half)))
        .filter(|(_, value, half)| value.abs() > 2.0 * half)
        .collect();
    match clear.first() {
        Some((axis, value, half)) if clear.iter().all(|(_, value, _)| *value < 0.0) => {
            Err(CalibrationError::Axes(both!(
                "every play comes out negative, that of {} as {:.2} ± {:.2} um: the directions of approach are exchanged (dir is +1 where the command rises)",
                "все люфты выходят отрицательными, у {} {:.2} ± {:.2} мкм: переставлены направления подхода (dir равен +1, где задание растёт)",
                LETTERS[*axis],
                value * 1e3,
                half * 1e3
            )))
        }
        _ => Ok(()),
    }
}

/// Readings as they would be without one mistake.
type Repair = (Text, Vec<Point>, Base);

/// Refuses readings that fit far better once a mistake is undone.
pub(crate) fn contradicted(points: &[Point], base: &Base, plan: &Plan) -> Result<(), CalibrationError> {
    /// More points than this say no more about a column or a sign.
    const POINTS: usize = 300;
    let every = points.len().div_ceil(POINTS).max(1);
    let thin = |all: Vec<Point>| -> Vec<Point> { all.into_iter().step_by(every).collect() };
    let fit = |points: Vec<Point>, base: &Base| {
        let plan = Plan { nodes_mm: fitting(plan, &points)?, ..plan.clone() };
        find(&thin(points), base, &plan).ok().map(|found| found.estimate)
    };
    let Some(estimate) = fit(points.to_vec(), base) else { return Ok(()) };
    if estimate.residuals.iter().all(|residual| residual.abs() < LEAST_MM) {
        return Ok(());
    }
    let (own, free) = (estimate.misfit, estimate.redundancy);
    // Ratio of two variances of as many degrees of freedom, one of a million by chance: five standard deviations of its
    // logarithm. Beyond a half more it is no matter of chance and shape alone.
    let limit = 1.5_f64.max(exp(5.0 * (4.0 / free.max(1) as f64).sqrt()));
    let mut best: Option<(f64, Text)> = None;
    for (name, repaired, base) in repairs(points, base) {
        let Some(misfit) = fit(repaired, &base).map(|fit| fit.misfit) else { continue };
        if misfit * misfit * limit < own * own && best.as_ref().is_none_or(|(least, _)| misfit < *least) {
            best = Some((misfit, name));
        }
    }
    match best {
        None => Ok(()),
        Some((left, name)) => Err(CalibrationError::Axes(both!(
            "the readings fit {:.1} times better {name}: a mistake in the file or on the command line",
            "показания подходят в {:.1} раза лучше {name:#}: ошибка в файле или в команде",
            own / left
        ))),
    }
}

/// Nodes for places that a repair has exchanged.
fn fitting(plan: &Plan, points: &[Point]) -> Option<[Vec<f64>; 3]> {
    let mut nodes = plan.nodes_mm.clone();
    for (axis, own) in nodes.iter_mut().enumerate() {
        let places = || points.iter().map(|p| p.command.linear_mm[axis]);
        let (low, high) = (places().reduce(f64::min)?, places().reduce(f64::max)?);
        let (from, to) = (*own.first()?, *own.last()?);
        for q in own.iter_mut() {
            *q = low + (high - low) * (*q - from) / (to - from);
        }
    }
    Some(nodes)
}

/// Every mistake that a file or a command line can hold without being malformed, undone.
fn repairs(points: &[Point], base: &Base) -> Vec<Repair> {
    let mut all: Vec<Repair> = Vec::new();
    let changed = |change: &dyn Fn(&mut Point)| -> Vec<Point> {
        points
            .iter()
            .map(|p| {
                let mut p = *p;
                change(&mut p);
                p
            })
            .collect()
    };
    let on_deviations = |change: &dyn Fn(&mut [Option<f64>; 3])| {
        changed(&|p| {
            if let PointReading::Deviation(d) = &mut p.reading {
                change(d);
            }
        })
    };
    let name = |i: usize| ["x", "y", "z"][i];
    if points.iter().any(|p| matches!(p.reading, PointReading::Deviation(_))) {
        for i in 0..3 {
            let j = (i + 1) % 3;
            let exchanged = on_deviations(&|d| d.swap(i, j));
            all.push((
                both!("with d{} and d{} exchanged", "с переставленными d{} и d{}", name(i), name(j)),
                exchanged,
                base.clone(),
            ));
            let turned = on_deviations(&|d| d[i] = d[i].map(|v| -v));
            all.push((
                both!("with the other sign of d{}", "с обратным знаком d{}", name(i)),
                turned,
                base.clone(),
            ));
            let commands = changed(&|p| p.command.linear_mm.swap_rows(i, j));
            all.push((
                both!("with {}_mm and {}_mm exchanged", "с переставленными {}_mm и {}_mm", name(i), name(j)),
                commands,
                base.clone(),
            ));
        }
    }
    let tools = changed(&|p| p.command.tool_mm = -p.command.tool_mm);
    all.push((
        Text::pair("with the other sign of the tool vectors", "с обратным знаком векторов инструмента"),
        tools,
        base.clone(),
    ));
    for (late, by) in [(Text::pair("early", "раньше"), 1), (Text::pair("late", "позже"), points.len() - 1)]
    {
        let moved = points.iter().enumerate().filter_map(|(k, p)| {
            let from = &points[(k + by) % points.len()];
            // A station's place belongs to its run.
            (from.run == p.run).then_some(Point { reading: from.reading, ..*p })
        });
        all.push((
            both!("with readings one row {late}", "с отсчётами на строку {late:#}"),
            moved.collect(),
            base.clone(),
        ));
    }
    if !base.is_known {
        all.extend(other_chains(base).map(|(name, base)| (name, points.to_vec(), base)));
    }
    // A repair that moves places out of the base's volume is none.
    all.retain(|(_, points, base)| known_places(points, base).is_ok_and(|kept| kept.len() == points.len()));
    all
}

/// The linear axes in every other order.
fn other_chains(base: &Base) -> impl Iterator<Item = (Text, Base)> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let own = base.description.chain.linear().map(|axis| axis.direction());
    let rest = |axes: &[machine_model::Axis]| {
        axes.iter().map(|axis| format!("{} ", axis.letter())).collect::<String>()
    };
    ORDERS.into_iter().filter(move |order| *order != own).filter_map(move |order| {
        let chain = &base.description.chain;
        let linear = order.map(|axis| LETTERS[axis]);
        let text = format!(
            "[w {}{} {} b {} {}t]",
            rest(chain.table()),
            linear[0],
            linear[1],
            linear[2],
            rest(chain.head())
        );
        let chain = Chain::parse(&text).ok()?;
        let mut other = base.clone();
        other.description.chain = chain;
        let order = linear.map(String::from).join(" ");
        let name = both!(
            "with the axes {order} in this order from workpiece to tool",
            "с осями в таком порядке от детали к инструменту: {order}"
        );
        Some((name, other))
    })
}
