//! Mistakes that no measurement shows: docs/how-to/calibrate.md names them, and these tests say that it is so.

use calibration::rotary_ballbar::{self, Test, Turning, is_length};
use calibration::volumetric::{self, Options, Point, PointReading};
use gap_lab::calibration::{TableTruth, Turns, ball_bar, volume_points};
use machine_model::{Chain, Vector};

#[test]
fn deviations_with_the_other_sign_fit_as_well_and_mean_the_opposite() {
    let chain = Chain::parse("[w X Y b Z t]").unwrap();
    let (rows, _) = volume_points(11, 0, 1.0, 200);
    let fit = |sign: f64| {
        let points: Vec<Point> = rows
            .iter()
            .map(|r| Point {
                run: r.run,
                commanded_mm: Vector::from(r.commanded_mm),
                tool_mm: Vector::from(r.tool_mm),
                reading: PointReading::Deviation(r.deviation_um.map(|d| Some(sign * d * 1e-3))),
                uncertainty_mm: None,
            })
            .collect();
        volumetric::calibrate(&points, &chain, Options { nodes: 4, holdout_every: 5 }).unwrap()
    };
    let (right, wrong) = (fit(1.0), fit(-1.0));
    let unseen = |f: &volumetric::VolumetricCalibration| f.holdout.unwrap().0[1];
    assert!((unseen(&right) - unseen(&wrong)).abs() < 1e-12);
    assert!((right.squareness_rad[0].unwrap().0 + wrong.squareness_rad[0].unwrap().0).abs() < 1e-12);
}

#[test]
fn a_table_that_turns_the_other_way_fits_to_a_micrometre() {
    let truth = TableTruth::random(12, 0);
    let rows = ball_bar(&truth, 12, 0, 0.3, 5.0, 2);
    let fit = |sign: f64| {
        let mut tests: Vec<Test> = Vec::new();
        for row in &rows {
            if row.test == tests.len() {
                let turning = match row.turns {
                    Turns::A => Turning::A,
                    Turns::C => Turning::C,
                    Turns::Spindle => Turning::Spindle,
                };
                let bar_mm = Vector::from(row.bar_mm);
                tests.push(Test {
                    turning,
                    tool_ball_mm: Vector::from(row.tool_ball_mm),
                    bar_mm,
                    readings: Vec::new(),
                });
            }
            let own = if row.turns == Turns::Spindle { 1.0 } else { sign };
            tests[row.test].readings.push((own * row.angle_deg.to_radians(), row.length_mm));
        }
        rotary_ballbar::calibrate(&tests).unwrap()
    };
    let (right, wrong) = (fit(1.0), fit(-1.0));
    // Products of errors, tenths of a micrometre, are all that tells them apart.
    assert!(
        wrong.estimate.sigma < right.estimate.sigma + 1e-3,
        "{} {}",
        wrong.estimate.sigma,
        right.estimate.sigma
    );
    // And the answer is another one: what goes with the sine has the other sign.
    assert!(is_length(1) && (right.piges[1] + wrong.piges[1]).abs() < 2e-3 && right.piges[1].abs() > 5e-3);
}
