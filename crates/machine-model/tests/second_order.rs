//! When the second order of rotations begins to matter, on the tables of the STAN S500.

use crate::stan_s500;

use machine_model::finite_rotations::{second_order, threshold};
use machine_model::{Command, Vector};
use stan_s500::{rigid_body, squareness, tables, traverses};

fn commands() -> Vec<Command> {
    let at = |n: u32, axis: u32, length: f64| f64::from(n / 5u32.pow(axis) % 5) * length / 4.0;
    (0..125)
        .map(|n| Command {
            linear_mm: Vector::new(at(n, 0, 400.0), at(n, 1, 280.0), at(n, 2, 200.0)),
            ..Default::default()
        })
        .collect()
}

#[test]
fn the_difference_grows_as_the_square_of_the_angles() {
    // Without squareness, so that all products are of two angles or of an angle and a translation.
    let machine = rigid_body(&tables(), Default::default()).description().clone();
    let difference =
        |scale: f64| second_order(&machine.with_angles_scaled(scale), &commands()).unwrap().difference_mm;
    let ratio = difference(400.0) / difference(200.0);
    assert!((3.8..4.2).contains(&ratio), "{ratio}");
    assert!(difference(1.0) < 1e-4, "less than 0.1 um as measured");
}

#[test]
fn the_threshold_is_where_the_difference_reaches_the_limit() {
    let machine = rigid_body(&tables(), squareness(&tables(), &traverses(315))).description().clone();
    let found = threshold(&machine, &commands(), 1e-3).unwrap();
    let difference =
        |scale: f64| second_order(&machine.with_angles_scaled(scale), &commands()).unwrap().difference_mm;
    assert!((difference(found.scale) - 1e-3).abs() < 1e-8, "{found:?}");
    assert!(difference(found.scale * 0.99) < 1e-3);
    // Angles that are none have no threshold.
    assert_eq!(threshold(&machine.with_angles_scaled(0.0), &commands(), 1e-3), None);
    // Squareness of a milliradian alone bends nothing: the sum is exact in it.
    let straight = second_order(&machine.with_angles_scaled(0.0), &commands()).unwrap();
    assert!(straight.difference_mm < 1e-12, "{straight:?}");
}
