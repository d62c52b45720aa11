//! `--against OLD.toml`: has the machine changed beyond what the two measurements are uncertain of?

use std::path::Path;

use calibration::change::{by_function, compare};
use diagnostic::{Language, Text, both};
use machine_model::{Range, Vector, Volume};
use machine_profile::Profile;
use measurement_files::micro;

use crate::message::Failure;
use crate::{file, profile};

use super::codes::question;
use crate::number::short;

/// Prints the comparison.
pub(super) fn report(old: &Path, new: &Profile, language: Language) -> Result<(), Failure> {
    let name = file::name(old);
    let old = profile::load_mill(old)?.profile;
    let (a, b) = (old.volume(), new.volume());
    let volume = Volume(
        [0, 1, 2].map(|i| Range { low: a.0[i].low.max(b.0[i].low), high: a.0[i].high.min(b.0[i].high) }),
    );
    let known = |p: &Profile| p.calibrated.as_ref().and_then(|c| c.uncertainty_um).map(|um| um * 1e-3);
    let change = compare(
        old.rigid_body_without_effects(),
        new.rigid_body_without_effects(),
        &volume,
        Vector::from(new.default_tool_mm),
        [known(&old), known(new)],
    )
    .ok_or_else(|| {
        question(
            both!(
                "{name} and the new measurements have no volume in common",
                "у {name} и новых измерений нет общего объёма"
            ),
            both!("compare profiles of one machine", "сравнивайте профили одного станка"),
        )
    })?;
    let at: Vec<String> = change.at_mm.iter().map(|v| short(*v, 3)).collect();
    let d = change.difference_mm * 1e3;
    let mut text = both!(
        "\nagainst {name}: errors differ by {:.2} um RMS, {:.2} um at 95 % of the points, at most {:.2} um at ({}) mm: x {:+.2} y {:+.2} z {:+.2} um; frames taken off\n",
        "\nотносительно {name}: погрешности различаются на {:.2} мкм (СКЗ), {:.2} мкм в 95 % точек, не больше {:.2} мкм в ({}) мм: x {:+.2} y {:+.2} z {:+.2} мкм; без систем координат\n",
        change.rms_mm * 1e3,
        change.p95_mm * 1e3,
        change.largest_mm * 1e3,
        at.join(", "),
        d.x,
        d.y,
        d.z
    );
    let verdict = match (change.is_beyond_uncertainty(), change.uncertainty_mm) {
        (Some(true), Some(u)) => both!(
            "  the machine has changed: the two are uncertain of ±{:.2} um together (95 % of the points)\n",
            "  станок изменился: неопределённость обоих вместе ±{:.2} мкм (95 % точек)\n",
            u * 1e3
        ),
        (Some(false), Some(u)) => {
            both!(
                "  no change is shown: the two are uncertain of ±{:.2} um together (95 % of the points)\n",
                "  изменений не видно: неопределённость обоих вместе ±{:.2} мкм (95 % точек)\n",
                u * 1e3
            )
        }
        _ => Text::pair(
            "  not decided: a profile does not say `uncertainty_um` in `calibrated`\n",
            "  не решено: в одном из профилей нет `uncertainty_um` в `calibrated`\n",
        ),
    };
    text.push(&verdict);
    if let (Some(true), Some(u)) = (change.is_beyond_uncertainty(), change.uncertainty_mm) {
        text.push(&functions(&old, new, u, &volume));
    }
    file::print(text.in_language(language).as_bytes())
}

/// What changed, function by function: place and amount at the tables' nodes, and the reversal value.
///
/// An angle counts by what it does over the longest side of the volume.
fn functions(old: &Profile, new: &Profile, uncertainty_mm: f64, volume: &Volume) -> Text {
    let arm_mm = volume.0.iter().map(|range| range.high - range.low).fold(0.0, f64::max);
    let mut text = Text::EMPTY;
    for change in by_function(&old.description, &new.description) {
        let name =
            format!("E{}{}", ["X", "Y", "Z", "A", "B", "C"][change.function], ["X", "Y", "Z"][change.axis]);
        let (factor, unit) = micro(change.function < 3);
        let arm = if change.function < 3 { 1.0 } else { arm_mm };
        if change.by.abs() * arm > 1.5 * uncertainty_mm {
            text.push(&both!(
                "  {name} by {:+.2} {unit} at {} mm\n",
                "  {name} на {:+.2} {unit:#} в {} мм\n",
                change.by * factor,
                short(change.at_mm, 3)
            ));
        }
        if change.reversal.abs() * arm > 1.5 * uncertainty_mm {
            text.push(&both!(
                "  reversal value of {name} by {:+.2} {unit}\n",
                "  зона нечувствительности {name} на {:+.2} {unit:#}\n",
                change.reversal * factor
            ));
        }
    }
    text
}
