//! A machine with 8 µm of lost motion in X that its model does not know: which effect is it, and how much?
//!
//! Twelve lines along the axes of a cube, both ways at two feeds, read to about 1 µm.
//!
//! ```console
//! $ cargo run -q --release -p gap-diagnosis --example find_backlash
//! verdict: Named
//! backlash.X half_width_um = 4.1 ± 0.1
//! gap: 2.9 µm before, 1.7 µm with it in the model
//! ```

use gap_diagnosis::{Measurements, Options, Reading, Row, Verdict, diagnose};
use machine_model::effects::{Conditions, EffectGeometry};
use machine_model::{Command, Vector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    // The sum of twelve uniform numbers is normal enough up to three sigma.
    let mut noise_um = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
    let mut rows = Vec::new();
    for line in 0..12_u8 {
        for step in 0..68_u8 {
            let (axis, corner, back) = (line % 3, line / 3, step / 17 % 2 == 1);
            let along = if back { 16 - step % 17 } else { step % 17 };
            let mut linear_mm = Vector::from_element(40.0);
            linear_mm[usize::from(axis + 1) % 3] += 300.0 * f64::from(corner & 1);
            linear_mm[usize::from(axis + 2) % 3] += 300.0 * f64::from(corner >> 1);
            // Uneven steps: even ones cannot tell a period from a curve.
            linear_mm[usize::from(axis)] = 25.0 * f64::from(along) + 7.0 * (f64::from(along) * 0.618).fract();
            // Two feeds: with one a lag of the servo looks the same.
            let feed = if step < 34 { 500.0 } else { 3000.0 };
            let mut direction = [0; 3];
            direction[usize::from(axis)] = if back { -1 } else { 1 };
            let lost_um = Vector::new(-4.0 * f64::from(direction[0]), 0.0, 0.0);
            let read = lost_um + Vector::new(noise_um(), noise_um(), noise_um());
            let tool_mm = Vector::new(0.0, 0.0, if corner % 2 == 0 { -80.0 } else { -200.0 });
            let command = Command { linear_mm, tool_mm, direction, ..Default::default() };
            let reading = Reading::Displacement([Some(read.x), Some(read.y), Some(read.z)]);
            rows.push(Row {
                conditions: Conditions { feed_mm_min: Some(feed), ..Conditions::default() },
                line: rows.len() as u64 + 2,
                ..Row::new(usize::from(line), command, reading)
            });
        }
    }
    let runs = (0..12).map(|line| format!("line {line}")).collect();
    let data = Measurements { runs, instruments: Vec::new(), rows, geometry: EffectGeometry::default() };

    let answer = diagnose(&data, None, &Options::default());
    let mut text = format!("verdict: {:?}\n", answer.verdict);
    for cause in &answer.causes {
        for (number, u95) in cause.parameters.iter().filter_map(|number| Some((number, number.u95?))) {
            text += &format!("{} {} = {:.1} ± {u95:.1}\n", cause.effect, number.name, number.value);
        }
        text += &format!(
            "gap: {:.1} µm before, {:.1} µm with it in the model\n",
            cause.rms_before_um, cause.rms_after_um
        );
    }
    assert_eq!(answer.verdict, Verdict::Named);
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes())?;
    Ok(())
}
