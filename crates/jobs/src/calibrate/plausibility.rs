//! Mistakes that an interferometer's readings themselves contradict, and what ISO 230-2 asks of a test.

use calibration::functions::Function;
use calibration::iso230_2::{self, Runs};
use diagnostic::{Text, both, notice};
use machine_model::Component;

use crate::message::Failure;

use measurement_files::series::{Origin, Series};
use measurement_files::{OddSizes, micro};

use super::codes::{AXES, MISSING, RUNS, UNITS};
use super::work::Work;
use crate::figures::short;

/// Deviations that are much too small or too large for their unit.
///
/// # Errors
/// Readings of an instrument that nine times in ten are below what any machine's are.
pub(super) fn units(series: &Series, work: &Work<'_>) -> Result<(), Failure> {
    let values = series.readings.iter().map(|r| r.value);
    let Some(odd) = OddSizes::of(&series.source, &series.name(), series.function, values) else {
        return Ok(());
    };
    if odd.are_small && series.origin == Origin::Instrument {
        return Err(Failure::asks(UNITS, odd.message, odd.help));
    }
    work.warn(UNITS, odd.message, odd.help);
    Ok(())
}

/// Targets that were read again and again, and nothing says from which side.
pub(super) fn directions(series: &Series, work: &Work<'_>) {
    let unsaid: Vec<f64> =
        series.readings.iter().filter(|r| r.direction == 0).map(|r| r.position_mm).collect();
    let again = unsaid.iter().enumerate().find(|(k, at)| unsaid[..*k].contains(at));
    let Some((_, at_mm)) = again.filter(|_| series.function == series.axis.direction()) else { return };
    work.warning(notice!(MISSING;
        "{}: {} was read several times at {} mm, and nothing says from which side: all readings without a direction count as reached towards plus",
        "{}: {} снята в {} мм несколько раз, и не сказано, с какой стороны: все отсчёты без направления считаются подходом в плюс",
        series.source, series.name(), short(*at_mm, 3);
        "the direction decides what is lost motion and what is scatter: add a column `dir`, 1 where the axis moved towards plus and -1 where towards minus; without it B stays unknown, and the table holds the mean of both sides",
        "направление решает, где мёртвый ход, а где разброс: добавьте столбец `dir`: 1 при движении в плюс, -1 в минус; без него B останется неизвестной, а таблица — средней для обеих сторон"
    ));
}

/// Below this no instrument tells two readings apart, mm and rad.
const FINEST: f64 = 1e-5;
const FINEST_RAD: f64 = 1e-8;

/// Runs that agree to the last digit.
///
/// # Errors
/// They do, but the two directions do not keep their distance: one run was written several times.
pub(super) fn copies(
    series: &Series,
    runs: &Runs,
    function: &Function,
    work: &Work<'_>,
) -> Result<(), Failure> {
    let same = |all: &[Vec<f64>]| all.windows(2).all(|pair| pair[0] == pair[1]);
    let repeated = runs.positive.len().max(runs.negative.len()) > 1;
    if !(repeated && same(&runs.positive) && same(&runs.negative)) {
        return Ok(());
    }
    let message = both!(
        "{}: all runs of {} are the same to the last digit",
        "{}: все проходы {} одинаковы до последней цифры",
        series.source,
        series.name()
    );
    let apart = function.directions.as_ref().map_or(0.0, |[up, down]| {
        let differences = || up.iter().zip(down).map(|(u, d)| u - d);
        differences().fold(f64::MIN, f64::max) - differences().fold(f64::MAX, f64::min)
    });
    let component = Component::of(series.function);
    let (scale, unit) = micro(component);
    let finest = match component {
        Component::Linear => FINEST,
        Component::Angular => FINEST_RAD,
    };
    if apart > finest {
        return Err(Failure::usage(notice!(RUNS;
            "{message}, while the difference of the directions wanders by {} {unit} from target to target: was one run written several times?",
            "{message:#}, а разность направлений гуляет от цели к цели на {} {unit:#}: один проход записан несколько раз?",
            short(apart * scale, 3);
            "give runs that were each measured, or one run alone",
            "дайте проходы, каждый из которых измерен, или один проход"
        )));
    }
    work.warning(notice!(MISSING; message;
        "then they say nothing of the repeatability; the uncertainty counts the instrument's alone",
        "о повторяемости они тогда ничего не говорят; в неопределённости учтена только приборная"
    ));
    Ok(())
}

/// Reversal values that no lost motion has.
///
/// # Errors
/// At every target the axis stands further behind a motion towards plus than behind one towards minus.
pub(super) fn reversal(series: &Series, function: &Function) -> Result<(), Failure> {
    let Some([up, down]) = &function.directions else { return Ok(()) };
    if series.function != series.axis.direction() {
        return Ok(());
    }
    let values: Vec<f64> = up.iter().zip(down).map(|(u, d)| u - d).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    // Three standard uncertainties of the mean of all targets, and at every one of them.
    let uncertainty = function.scatter.unwrap_or(0.0) * (4.0 / (function.count as f64 * n)).sqrt();
    if values.iter().any(|b| *b <= 0.0) || mean <= f64::max(3.0 * uncertainty, LEAST_MM) {
        return Ok(());
    }
    Err(Failure::usage(notice!(AXES;
        "{}: at every target {} stands further when it comes from below than from above, by {} um on average: lost motion is the other way round",
        "{}: в каждой цели {} при подходе снизу стоит дальше, чем сверху, в среднем на {} мкм: мёртвый ход обратного знака",
        series.source, series.axis, short(mean * 1e3, 3);
        "were up and down exchanged (column dir, order of the runs), or are the deviations target minus actual? a backlash compensation of the control that is set too high does it too: switch it off for the measurement",
        "не переставлены ли направления (столбец dir, порядок проходов), не цель ли минус измеренное в отклонениях? так же действует завышенная компенсация люфта в стойке: на время измерения отключите её"
    )))
}

/// A reversal value below this is none, mm.
const LEAST_MM: f64 = 1e-4;

/// What ISO 230-2 asks of a test and these runs are not.
pub(super) fn missing_of_the_standard(found: &iso230_2::Evaluation) -> Vec<Text> {
    let length = found.targets[found.targets.len() - 1].position - found.targets[0].position;
    let mut missing = Vec::new();
    if found.runs.iter().any(|n| *n < 5) {
        missing.push(both!(
            "{} and {} runs instead of five in each direction",
            "проходов {} и {} вместо пяти в каждом направлении",
            found.runs[0],
            found.runs[1]
        ));
    }
    let least = if length < 1000.0 { 5.0 } else { 5.0 * length / 1000.0 };
    if (found.targets.len() as f64) < least {
        missing.push(both!(
            "{} targets over {length} mm instead of {least:.0}",
            "целей {} на {length} мм вместо {least:.0}",
            found.targets.len()
        ));
    }
    missing
}

/// Warns of what ISO 230-2 asks of a test.
pub(super) fn conditions_of_the_standard(name: &str, found: &iso230_2::Evaluation, work: &Work<'_>) {
    let missing = missing_of_the_standard(found);
    if !missing.is_empty() {
        work.warning(notice!(MISSING;
            "{name} is evaluated after ISO 230-2 but was not measured so: {}",
            "{name} оценена по ISO 230-2, а измерена не так: {:#}", Text::join(&missing, "; ");
            "do not quote the figures as those of the standard",
            "не приводите эти числа как полученные по стандарту"
        ));
    }
}
