//! What `calibrate ballbar` prints.

use std::fmt::{Result, Write};

use calibration::linear_ballbar::CircleCalibration;
use calibration::rotary_ballbar::{Found, RotaryCalibration, Test};
use calibration::rotary_sequence::{Sequence, approximation_mm, sequence};
use machine_model::{Axis, Description, Vector};

/// The pairs of axes of the planes XY, ZX, YZ.
pub(super) const SCALES: [&str; 3] = ["X-Y", "Z-X", "Y-Z"];

/// Factor to what is printed, and its unit.
fn unit(found: &Found) -> (f64, &'static str) {
    if found.location.is_length { (1e3, "um") } else { (1e6, "urad") }
}

/// Where an A that carries C crosses it; `None` for other tables, for which no sequence was published.
fn crossing(description: &Description) -> Option<Vector> {
    let [a, _, c] = &description.rotary;
    let crosses = (a.centre_mm.y - c.centre_mm.y).abs() < 1e-6;
    (description.chain.table() == [Axis::C, Axis::A] && crosses)
        .then(|| Vector::new(c.centre_mm.x, a.centre_mm.y, a.centre_mm.z))
}

pub(super) fn rotary_report(
    out: &mut String,
    found: &RotaryCalibration,
    tests: &[Test],
    description: &Description,
) -> Result {
    let crossing = crossing(description);
    let published: Option<Sequence> = crossing.and_then(|at| sequence(tests, &at));
    let mut axes: Vec<String> = found.locations.iter().map(|f| f.location.axis.to_string()).collect();
    axes.dedup();
    writeln!(
        out,
        "location errors of {}, {} readings, {:.3} um left (standard deviation)",
        axes.join(" and "),
        found.estimate.residuals.len(),
        found.estimate.sigma * 1e3
    )?;
    let based = found.locations.iter().any(|f| f.base != 0.0);
    let head = |shown: bool, text: &'static str| if shown { text } else { "" };
    writeln!(
        out,
        "          joint fit        95 %{}{}",
        head(published.is_some(), "   in sequence"),
        head(based, "        base")
    )?;
    for (k, f) in found.locations.iter().enumerate() {
        let (scale, unit) = unit(f);
        write!(out, "  {}  {:>10.3} ± {:>8.3}", f.location.name(), f.value * scale, f.half_width_95 * scale)?;
        if let Some(by) = &published {
            write!(out, " {:>10.3}", by.piges[k] * scale)?;
        }
        if based {
            write!(out, " {:>11.3}", f.base * scale)?;
        }
        writeln!(out, " {unit}")?;
    }
    for (k, name) in ["eX", "eY"].into_iter().enumerate() {
        write!(
            out,
            "  {name}    {:>10.3} ± {:>8.3}",
            found.cup_mm[k] * 1e3,
            found.cup_half_width_95_mm[k] * 1e3
        )?;
        if let Some(by) = &published {
            write!(out, " {:>10.3}", by.cup_mm[k] * 1e3)?;
        }
        writeln!(out, "{} um (tool ball against the spindle axis)", head(based, "            "))?;
    }
    if let Some(off) = crossing.and_then(|at| approximation_mm(tests, &at, found)) {
        writeln!(
            out,
            "  the first-order formulas of the sequence leave the exact chain by up to {:.3} um",
            off * 1e3
        )?;
    }
    Ok(())
}

/// Table 4 of Zhang 2024: location errors before and after the compensation of the four positions.
pub(super) fn before_and_after(
    out: &mut String,
    before: &RotaryCalibration,
    after: &RotaryCalibration,
) -> Result {
    writeln!(out, "\n            before      after")?;
    let mut largest = [0.0_f64; 2];
    for f in &before.locations {
        let Some(g) = after.locations.iter().find(|g| g.location == f.location) else { continue };
        let (scale, unit) = unit(f);
        writeln!(out, "  {}  {:>9.2}  {:>9.2} {unit}", f.location.name(), f.value * scale, g.value * scale)?;
        if f.location.is_length {
            largest[0] = largest[0].max(f.value.abs() * scale);
            largest[1] = largest[1].max(g.value.abs() * scale);
        }
    }
    writeln!(out, "  largest position error {:.1} -> {:.1} um", largest[0], largest[1])
}

pub(super) fn circle_report(out: &mut String, found: &CircleCalibration) -> Result {
    writeln!(
        out,
        "circles, {} readings, {:.3} um left (standard deviation)",
        found.estimate.residuals.len(),
        found.estimate.sigma * 1e3
    )?;
    let base = |value: f64, decimals: usize| match value {
        0.0 => String::new(),
        value => format!(" (base {value:.decimals$})"),
    };
    for (name, term) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().zip(found.squareness_rad) {
        if let Some(t) = term {
            let before = base(t.base * 1e6, 2);
            writeln!(
                out,
                "  {name}        {:>9.2} ± {:.2} urad{before}",
                t.value * 1e6,
                t.half_width_95 * 1e6
            )?;
        }
    }
    for (name, term) in SCALES.into_iter().zip(found.mismatch) {
        if let Some(t) = term {
            writeln!(
                out,
                "  scale {name}   {:>9.2} ± {:.2} um/m (one axis against the other: a bar sees no common scale)",
                t.value * 1e6,
                t.half_width_95 * 1e6
            )?;
        }
    }
    if let Some(sum) = found.closure {
        writeln!(
            out,
            "  closure     {:>9.2} ± {:.2} um/m (the three must add up to 0)",
            sum.value * 1e6,
            sum.half_width_95 * 1e6
        )?;
    }
    for (axis, term) in Axis::ALL.iter().zip(found.backlash_mm) {
        match term {
            Some(t) => {
                let before = base(t.base * 1e3, 2);
                writeln!(
                    out,
                    "  backlash {axis}  {:>9.2} ± {:.2} um{before}",
                    t.value * 1e3,
                    t.half_width_95 * 1e3
                )?;
            }
            None => writeln!(
                out,
                "  backlash {axis}  not seen: no reading says the direction of {axis} both ways"
            )?,
        }
    }
    Ok(())
}
