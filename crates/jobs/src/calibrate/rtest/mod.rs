//! `vpost calibrate rtest`.

mod report;
mod rows;

use calibration::Base;
use calibration::rtest::{HeldOut, RotaryTables, Term, calibrate};
use diagnostic::{Speaks, Text, both, notice};

use crate::message::Failure;
use crate::profile::load_mill;

use super::codes::{AXES, CONTRADICTED, DOUBTFUL, OPEN, OUTLIER, QUESTION, UNFIT, UNSAID, body, failure};
use super::options::{RTest, RTestMethod};
use super::output::{Output, columns, error_table};
use super::work::Work;
use rows::Rows;

/// What is left of the readings, in units of their stated uncertainty, is a contradiction above this.
const CONTRADICTION: f64 = 5.0;

/// Above this the stated uncertainty does not explain what is left.
const ROUGH: f64 = 1.5;

/// No R-test and no touch probe scatters so, mm: refused, doubted. Who knows better states it as `u_um`.
const SCATTER_MM: [f64; 2] = [0.010, 0.004];

/// Held-out rows that a profile predicts leave no more than so many times the noise.
const UNSEEN: f64 = 2.0;

/// `vpost calibrate rtest`
pub(super) fn run(arguments: &RTest, work: &Work<'_>) -> Result<(), Failure> {
    let mut output = Output::start(&arguments.target, work, load_mill)?;
    let Some(profile) = output.base.clone() else {
        return Err(Failure::usage(notice!(QUESTION;
            "which machine? where its rotary axes are is not known",
            "какой станок? где его поворотные оси, неизвестно";
            "add `-m PROFILE.toml` with `centre_mm` of each rotary axis and the errors of the linear axes",
            "добавьте `-m PROFILE.toml` с `centre_mm` каждой поворотной оси и погрешностями линейных осей"
        )));
    };
    let base = output.measured_from(&arguments.target)?;
    let rows = Rows::read(&arguments.files, arguments, &profile, &output, work)?;
    if let Some((run, mm)) = rows.moving_ball().filter(|_| arguments.method() == RTestMethod::Deviations) {
        work.warning(notice!(DOUBTFUL;
            "run `{run}`: by the profile the place of the ball in the workpiece moves by {mm:.0} mm, and a ball stays in its nest",
            "серия `{run}`: по профилю место шара на детали смещается на {mm:.0} мм, а шар остаётся в гнезде";
            "check centre_mm, the tool vector and the signs of the angles; nothing is wrong where the rows are points anywhere",
            "проверьте centre_mm, вектор инструмента и знаки углов; если строки — произвольные точки, ошибки нет"
        ));
    }
    let found = calibrate(&rows.read.rows, &base, &rows.runs).map_err(|error| refused(&rows, &error))?;
    let held = match &arguments.holdout {
        Some(path) => {
            let held = Rows::read(std::slice::from_ref(path), arguments, &profile, &output, work)?;
            Some(held_out(&found, &held, &base)?)
        }
        None => None,
    };
    let text = report::text(&found, held.as_ref(), &rows);
    work.print(&text);
    work.show(arguments.json.as_ref(), || crate::summary::json(&report::json(&found, held.as_ref(), &rows)));
    judge(&found, held.as_ref(), work)?;
    if !arguments.target.writes() {
        return Ok(());
    }
    write(&mut output, &found);
    let uncertainty_mm = output.with_base_mm(found.field_u95_mm, work);
    let known_mm = [Some(found.estimate.sigma), Some(uncertainty_mm)];
    output.write(&arguments.target, work, rows.read.temperature_c(), known_mm)
}

/// What contradicts the readings, an outlier at its row.
fn refused(rows: &Rows, error: &calibration::CalibrationError) -> Failure {
    use calibration::CalibrationError::{Axes, Contradicted, Outlier, Unobservable};
    Failure::unfit(match error {
        Outlier { point, .. } => {
            return rows.at(*point)(notice!(OUTLIER; error.text();
                "measure it again, or take the row out", "измерьте снова или уберите строку"
            ));
        }
        Axes(_) => notice!(AXES; error.text();
            "is `-m` the profile of the machine that was measured? an R-test turns A, B or C within a run, the ball in its nest",
            "`-m` — профиль измеренного станка? в R-тесте внутри серии поворачивается A, B или C, а шар остаётся в гнезде"
        ),
        Unobservable(_) => notice!(OPEN; error.text();
            "mount the ball beside the axis as well, 100 mm from it, at another height: three places not in one line show all",
            "ставьте шар и в стороне от оси, в 100 мм от неё, на другой высоте: три точки не на одной прямой покажут всё"
        ),
        Contradicted(_) => notice!(CONTRADICTED; error.text();
            "measure again, a file for each machine; or calibrate the linear axes of the profile first",
            "измерьте снова, на каждый станок свой файл; или сначала откалибруйте линейные оси профиля"
        ),
        _ => return failure("", &[], error),
    })
}

/// Judges by rows that the fit did not see; each must stand where the changed machine is known.
fn held_out(found: &RotaryTables, held: &Rows, base: &Base) -> Result<HeldOut, Failure> {
    let machine = body(&found.description)?;
    for (row, reading) in held.read.rows.iter().enumerate() {
        if let Err(error) = machine.rotary_inside(&reading.command) {
            return Err(held.at(row)(notice!(AXES; error.text();
                "hold out rows at angles between those that were measured",
                "откладывайте строки с углами между измеренными"
            )));
        }
    }
    if held.read.rows.len() < 2 * held.runs.len() {
        return Err(Failure::unfit(notice!(OPEN;
            "the hold-out has runs of one row: the offset of the run takes all it says",
            "среди отложенных есть серии из одной строки: её целиком забирает сдвиг серии";
            "hold out several angles of each mounting", "откладывайте несколько углов каждой установки шара"
        )));
    }
    found.held_out(&held.read.rows, base).map_err(|error| failure("", &[], &error))
}

/// What would make the noise less.
static LINEAR: Text = Text::pair(
    "calibrate the linear axes of the profile first; measure more places of the ball; state the scatter as `u_um`",
    "сначала откалибруйте линейные оси профиля; измерьте шар в большем числе мест; укажите разброс в `u_um`",
);

/// Refuses what contradicts what is known of noise; warns where it is doubtful.
fn judge_noise(found: &RotaryTables, work: &Work<'_>) -> Result<(), Failure> {
    let sigma_mm = found.estimate.sigma;
    let strangers = || {
        both!(
            "look for rows of two machines, exchanged columns, errors of the linear axes",
            "ищите строки двух станков, перепутанные столбцы, погрешности линейных осей"
        )
    };
    if let Some(stated_mm) = found.stated_mm {
        let times = sigma_mm / stated_mm;
        if times > CONTRADICTION {
            return Err(Failure::unfit(notice!(CONTRADICTED;
                "the best machine leaves {times:.1} times what `u_um` states: the rows are of no one machine of this chain",
                "наилучшая модель оставляет в {times:.1} раза больше, чем указано в `u_um`: строки не от одного станка с этой цепью";
                strangers()
            )));
        }
        if times > ROUGH {
            work.warning(notice!(DOUBTFUL;
                "the best machine leaves {times:.1} times what `u_um` states: intervals are widened by as much",
                "наилучшая модель оставляет в {times:.1} раза больше, чем указано в `u_um`: интервалы расширены во столько же";
                LINEAR.clone()
            ));
        }
    } else if sigma_mm > SCATTER_MM[0] {
        return Err(Failure::unfit(notice!(CONTRADICTED;
            "the best machine leaves {:.1} um: no R-test scatters so, the rows are of no one machine of this chain",
            "наилучшая модель оставляет {:.1} мкм: у R-теста такого разброса нет, строки не от одного станка с этой цепью",
            sigma_mm * 1e3;
            strangers()
        )));
    } else if sigma_mm > SCATTER_MM[1] {
        work.warning(notice!(DOUBTFUL;
            "the best machine leaves {:.1} um, more than an R-test scatters",
            "наилучшая модель оставляет {:.1} мкм: больше разброса R-теста", sigma_mm * 1e3;
            LINEAR.clone()
        ));
    }
    Ok(())
}

/// The same of what is known of unseen rows.
fn judge(found: &RotaryTables, held: Option<&HeldOut>, work: &Work<'_>) -> Result<(), Failure> {
    judge_noise(found, work)?;
    let sigma_mm = found.estimate.sigma;
    if let Some(alone_mm) = found.alone_mm {
        work.warning(notice!(DOUBTFUL;
            "runs leave {:.2} um one by one and {:.2} um together: they differ by more than noise",
            "серии порознь оставляют {:.2} мкм, вместе {:.2} мкм: они различаются больше, чем на шум",
            alone_mm * 1e3, found.estimate.misfit * 1e3;
            LINEAR.clone()
        ));
    }
    let open: Vec<&str> = found.not_told_apart.iter().flatten().map(String::as_str).collect();
    if !open.is_empty() {
        work.warning(notice!(UNSAID;
            "{} cannot be told apart by these rows: they stay as in the profile, and `uncertainty_um` does not count them",
            "{}: по этим строкам не различить; они остаются как в профиле, и `uncertainty_um` их не учитывает",
            open.join(", ");
            "mount the ball at three places at least, not in one line, at two heights",
            "ставьте шар не меньше чем в трёх местах не на одной прямой, на двух высотах"
        ));
    }
    let [before, after] = found.rms_mm;
    if found.field_u95_mm > 0.5 * before && before > 2.0 * sigma_mm {
        work.warning(notice!(DOUBTFUL;
            "what is written is known to {:.1} um over the volume, and the rows were {:.1} um off: more rows, farther from the axes, would say more",
            "записанное известно по объёму с точностью {:.1} мкм, а строки отличались на {:.1} мкм: нужно больше строк, дальше от осей",
            found.field_u95_mm * 1e3, before * 1e3;
            "mount the ball where the machine cuts, at places far from one another",
            "ставьте шар там, где станок режет, в местах, далёких друг от друга"
        ));
    }
    if after > before && after > ROUGH * sigma_mm {
        return Err(Failure::unfit(notice!(UNFIT;
            "what may be written leaves {:.2} um of the rows, the base {:.2} um: most of it cannot be told apart",
            "с тем, что можно записать, в строках остаётся {:.2} мкм, с исходным профилем {:.2} мкм: большую часть не различить",
            after * 1e3, before * 1e3;
            "mount the ball at three places at least, not in one line",
            "ставьте шар не меньше чем в трёх местах не на одной прямой"
        )));
    }
    let Some(judged) = held else { return Ok(()) };
    if judged.rms_after_mm > judged.rms_before_mm && judged.rms_after_mm > ROUGH * sigma_mm {
        return Err(Failure::unfit(notice!(UNFIT;
            "{} held-out readings get worse: {:.2} um RMS before, {:.2} um after",
            "отложенных отсчётов {}, и они становятся хуже: {:.2} мкм до, {:.2} мкм после (среднеквадратичное)",
            judged.readings, judged.rms_before_mm * 1e3, judged.rms_after_mm * 1e3;
            "look for rows of another machine or another day; nothing was written",
            "ищите строки другого станка или другого дня; ничего не записано"
        )));
    }
    if judged.rms_after_mm > UNSEEN * sigma_mm.max(1e-5) {
        work.warning(notice!(DOUBTFUL;
            "held-out readings keep {:.2} um, the noise is {:.2} um: the profile does not hold everywhere as it holds where it was measured",
            "в отложенных отсчётах остаётся {:.2} мкм при шуме {:.2} мкм: профиль верен не везде так, как там, где измеряли",
            judged.rms_after_mm * 1e3, sigma_mm * 1e3;
            LINEAR.clone()
        ));
    }
    Ok(())
}

fn write(output: &mut Output, found: &RotaryTables) {
    for term in found.terms.iter().filter(|term| term.is_written) {
        let Term::Location(location) = term.term else { continue };
        output.location(&location, term.base + term.change, 4);
    }
    for table in &found.tables {
        let text = error_table(table.axis, &table.angles_deg, &columns(table.given, &table.rows));
        let letter = table.axis.letter();
        let name = output.table(&format!("{}.csv", letter.to_ascii_lowercase()), text.into_bytes());
        output.text.set_text(&["rotary", &letter.to_string(), "errors"], &name);
    }
}
