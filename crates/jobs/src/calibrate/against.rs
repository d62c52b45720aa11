//! `--against OLD.toml`: has the machine changed beyond what the two measurements are uncertain of?

use std::path::Path;

use calibration::change::{by_function, compare};
use diagnostic::{Text, both, notice};
use machine_model::{Component, Range, Vector, Volume};
use machine_profile::Profile;
use measurement_files::micro;

use crate::message::Failure;
use crate::{lines, profile};

use super::codes::QUESTION;
use crate::figures::short;

/// The comparison.
pub(super) fn report(old: &Path, new: &Profile) -> Result<Text, Failure> {
    let name = lines::name(old);
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
        Failure::usage(notice!(QUESTION;
            "{name} and the new measurements have no volume in common",
            "у {name} и новых измерений нет общего объёма";
            "compare profiles of one machine", "сравнивайте профили одного станка"
        ))
    })?;
    let at = change.at_mm.iter().map(|v| short(*v, 3)).collect::<Vec<_>>().join(", ");
    let [x, y, z] = <[f64; 3]>::from(change.difference_mm * 1e3);
    let [rms, p95, most] = [change.rms_mm, change.p95_mm, change.largest_mm].map(|mm| mm * 1e3);
    let mut text = both!(
        "\nagainst {name}: errors differ by {rms:.2} um RMS, {p95:.2} um at 95 % of the points, at most {most:.2} um at ({at}) mm: x {x:+.2} y {y:+.2} z {z:+.2} um; frames taken off\n",
        "\nотносительно {name}: погрешности различаются на {rms:.2} мкм (СКЗ), {p95:.2} мкм в 95 % точек, не больше {most:.2} мкм в ({at}) мм: x {x:+.2} y {y:+.2} z {z:+.2} мкм; без систем координат\n"
    );
    let Some((is_beyond, u)) = change.is_beyond_uncertainty().zip(change.uncertainty_mm) else {
        text.push(&both!(
            "  not decided: a profile does not say `uncertainty_um` in `calibrated`\n",
            "  не решено: в одном из профилей нет `uncertainty_um` в `calibrated`\n"
        ));
        return Ok(text);
    };
    let verdict = match is_beyond {
        true => both!("the machine has changed", "станок изменился"),
        false => both!("no change is shown", "изменений не видно"),
    };
    text.push(&both!(
        "  {verdict}: the two are uncertain of ±{:.2} um together (95 % of the points)\n",
        "  {verdict:#}: неопределённость обоих вместе ±{:.2} мкм (95 % точек)\n",
        u * 1e3
    ));
    if is_beyond {
        text.push(&functions(&old, new, u, &volume));
    }
    Ok(text)
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
        let (factor, unit) = micro(Component::of(change.function));
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
