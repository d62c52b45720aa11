//! Differences in words.

use diagnostic::{Text, both};
use nc_program::process::Process;
use path_comparison::{Comparison, Mismatch, What};

use super::reading::Numbers;

/// What the comparison found, a sentence each.
pub(super) fn of(comparison: &Comparison, numbers: &Numbers) -> Vec<Text> {
    let (mut findings, mut said) = (Vec::new(), Vec::new());
    for mismatch in &comparison.mismatches {
        findings.extend(sentences(mismatch, numbers, &mut said));
    }
    if comparison.more_mismatches > 0 {
        findings.push(both!(
            "and {} more of the path",
            "и ещё отклонения от траектории: {}",
            comparison.more_mismatches
        ));
    }
    findings
}

/// * `said` – settings that differ and were named: they differ until one of both programs sets them
fn sentences(mismatch: &Mismatch, numbers: &Numbers, said: &mut Vec<[Text; 2]>) -> Vec<Text> {
    let Mismatch { what, wanted_line: wanted, commanded_line: made } = mismatch;
    let one = match what {
        What::TooFar(mm) => {
            both!(
                "line {made} of the corrected program is {:.3} um off the path of line {wanted}",
                "строка {made} исправленной программы отходит от траектории строки {wanted} на {:.3} мкм",
                mm * 1e3
            )
        }
        What::Missing => both!(
            "the motion of line {wanted} is missing from the corrected program",
            "в исправленной программе нет движения строки {wanted}"
        ),
        What::Short(mm) => {
            both!(
                "the corrected program ends {:.3} um short of the end of line {wanted}",
                "исправленная программа не доходит до конца строки {wanted} на {:.3} мкм",
                mm * 1e3
            )
        }
        What::Extra => both!(
            "line {made} of the corrected program belongs to no programmed motion",
            "строка {made} исправленной программы не относится ни к одному движению исходной"
        ),
        What::Turned => both!(
            "the rotary axes stand elsewhere in line {made} of the corrected program than in line {wanted}",
            "в строке {made} исправленной программы поворотные оси стоят не там, где в строке {wanted}"
        ),
        What::Leans(rad) => both!(
            "in line {made} of the corrected program the tool points {:.1} urad away from its direction in line {wanted}",
            "в строке {made} исправленной программы инструмент отклонён от направления строки {wanted} на {:.1} мкрад",
            rad * 1e6
        ),
        What::NotPositioned => {
            both!(
                "the positioning of line {wanted} is missing from the corrected program",
                "в исправленной программе нет позиционирования строки {wanted}"
            )
        }
        What::PositionedElsewhere => {
            both!(
                "line {made} of the corrected program positions the tool where the program does not",
                "строка {made} исправленной программы ставит инструмент туда, куда исходная не ставит"
            )
        }
        What::Process([here, there]) => {
            let processes = [here, there].map(|number| numbers.process(*number));
            return processes_differ((*wanted, *made), processes, said);
        }
        What::Feed(feeds) => {
            let [here, there] =
                feeds.map(|f| f.map_or_else(|| both!("no F", "без F"), |f| Text::same(format!("F{f}"))));
            in_force(*wanted, *made, &here, &there)
        }
        What::Compensated => both!(
            "under cutter compensation line {made} of the corrected program is not the block of line {wanted}: one was put in or left out, and the control offsets block by block",
            "при коррекции на радиус строка {made} исправленной программы — не кадр строки {wanted}: кадр вставлен или пропущен, а стойка смещает кадр за кадром"
        ),
        What::Time(times) => both!(
            "line {made} of the corrected program takes {times:.2} times as long as line {wanted} says by F",
            "строка {made} исправленной программы длится в {times:.2} раза дольше, чем говорит F строки {wanted}"
        ),
        What::NotDone(deed) => {
            both!(
                "{} of line {wanted} is missing from the corrected program",
                "в исправленной программе нет {} из строки {wanted}",
                numbers.deed(*deed)
            )
        }
        What::DoneToo(deed) => both!(
            "{} on line {made} of the corrected program is not programmed, or not there",
            "{} в строке {made} исправленной программы не запрограммировано или стоит не там",
            numbers.deed(*deed)
        ),
    };
    vec![one]
}

/// Settings that differ and have not been named yet.
fn processes_differ(
    (wanted, made): (u64, u64),
    processes: [Option<&Process>; 2],
    said: &mut Vec<[Text; 2]>,
) -> Vec<Text> {
    let [Some(here), Some(there)] = processes else { return Vec::new() };
    let mut differences = here.differences(there);
    differences.retain(|pair| !said.contains(pair));
    said.extend(differences.iter().cloned());
    differences.iter().map(|[here, there]| in_force(wanted, made, here, there)).collect()
}

fn in_force(wanted: u64, made: u64, here: &Text, there: &Text) -> Text {
    both!(
        "on line {made} of the corrected program {there} is in force, on line {wanted} of the program {here}",
        "в строке {made} исправленной программы действует {there:#}, а в строке {wanted} исходной — {here:#}"
    )
}
