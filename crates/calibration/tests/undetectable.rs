//! Mistakes that no measurement shows: docs/how-to/calibrate.md names them, and these tests say that it is so.

use calibration::volumetric::{self, Options};
use calibration::{Base, Point, PointReading};
use gap_lab::calibration::volume_points;
use machine_model::{Chain, Vector};

#[test]
fn deviations_with_the_other_sign_fit_as_well_and_mean_the_opposite() {
    let chain = Chain::parse("[w X Y b Z t]").unwrap();
    let (rows, _) = volume_points(11, 0, 1.0, 200);
    let fit = |sign: f64| {
        let points: Vec<Point> = rows
            .iter()
            .map(|r| {
                let reading = PointReading::Deviation(r.deviation_um.map(|d| Some(sign * d * 1e-3)));
                Point::new(r.run, Vector::from(r.commanded_mm), Vector::from(r.tool_mm), reading)
            })
            .collect();
        let base = Base::bare(chain.clone());
        volumetric::calibrate(&points, &base, Options { nodes: 4, holdout_every: 5 }).unwrap()
    };
    let (right, wrong) = (fit(1.0), fit(-1.0));
    let unseen = |f: &volumetric::VolumetricCalibration| f.holdout.unwrap().0[1];
    // But for products of errors.
    assert!((unseen(&right) - unseen(&wrong)).abs() < 1e-5);
    assert!((right.squareness_rad[0].0 + wrong.squareness_rad[0].0).abs() < 1e-7);
}
