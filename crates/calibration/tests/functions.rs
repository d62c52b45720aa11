//! Error functions of one axis: directions, slopes, conventions, finer tables.

use calibration::functions::{FunctionReading, SquarenessConvention, function, refined, squareness};
use machine_model::Interpolation;

fn reading(run: &str, position_mm: f64, value: f64, direction: i8) -> FunctionReading {
    FunctionReading { run: run.to_owned(), position_mm, value, direction }
}

#[test]
fn two_directions_keep_their_means_and_scatter() {
    let mut all = Vec::new();
    for (run, noise) in [("1", 1e-3), ("2", -1e-3)] {
        for (q, up, down) in [(0.0, 0.0, 0.006), (100.0, 0.010, 0.016)] {
            all.push(reading(run, q, up + noise, 1));
            all.push(reading(run, q, down - noise, -1));
        }
    }
    let found = function(&all).unwrap();
    let [up, down] = found.directions.unwrap();
    assert!((up[1] - 0.010).abs() < 1e-15 && (down[0] - 0.006).abs() < 1e-15);
    assert!((found.mean[0] - 0.003).abs() < 1e-15);
    // Eight squares of 1e-6 over four degrees of freedom.
    assert!((found.scatter.unwrap() - (2e-6_f64).sqrt()).abs() < 1e-12);
}

#[test]
fn tables_4_5_to_4_7_are_straight_lines_between_the_targets() {
    let positions = [0.0, 20.0, 40.0];
    let values = [0.0, 1.0, -1.0];
    let (fine, made) = refined(&positions, &values, 2.0, Interpolation::Linear).unwrap();
    assert_eq!(fine.len(), 21);
    for (q, v) in fine.iter().zip(&made) {
        let wanted = if *q <= 20.0 { q / 20.0 } else { 1.0 - 2.0 * (q - 20.0) / 20.0 };
        assert!((v - wanted).abs() < 1e-14, "{q}");
    }
    // A step that does not divide the range still ends at its end; the cubic keeps to the range of its nodes.
    let (fine, made) = refined(&positions, &values, 7.0, Interpolation::Monotone).unwrap();
    assert_eq!(fine.last(), Some(&40.0));
    assert!(made.iter().all(|v| (-1.0 - 1e-12..=1.0 + 1e-12).contains(v)));
    assert!(refined(&positions, &values, 0.0, Interpolation::Linear).is_none());
}

#[test]
fn conventions_differ_in_the_plane_zx_only() {
    let read = [1e-6, 2e-6, 3e-6];
    let iso = squareness(read, SquarenessConvention::RightHanded);
    let larger = squareness(read, SquarenessConvention::LargerThan90);
    assert_eq!((iso.ec0y_rad, iso.eb0z_rad, iso.ea0z_rad), (1e-6, 2e-6, 3e-6));
    assert_eq!((larger.ec0y_rad, larger.eb0z_rad, larger.ea0z_rad), (1e-6, -2e-6, 3e-6));
    // What the words say, in the model: the angle between +X and +Z with EB0Z = 2e-6 is below 90°, z leans to +x.
    assert!(iso.tilts()[2].x > 0.0 && larger.tilts()[2].x < 0.0);
}
