//! Fields of vectors that are known.

use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

fn at(q: Vector) -> Command {
    Command { linear_mm: q, ..Default::default() }
}

/// A field as a machine makes it, mm: functions of one axis, and angles with their levers.
fn truth(q: &Vector) -> Vector {
    let wave = |v: f64, length: f64| units::math::sin(v / length);
    Vector::new(
        4e-3 * wave(q.x, 60.0) + 3e-5 * q.y + 2e-5 * q.z * wave(q.x, 130.0),
        2e-3 * wave(q.y, 40.0) - 1e-5 * q.z + 1e-7 * q.x * q.x,
        3e-3 * wave(q.z, 90.0) + 2e-5 * q.y * wave(q.x, 110.0),
    )
}

fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    // The sum of twelve: as good as normal for what is asked here.
    (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0
}

fn noisy(count: usize, noise_mm: f64, stated_mm: f64, seed: u64) -> Vec<ErrorVector> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let place_mm = Vector::new(
                rng.random_range(0.0..400.0),
                rng.random_range(0.0..300.0),
                rng.random_range(0.0..200.0),
            );
            let noise = Vector::from_fn(|_, _| gauss(&mut rng) * noise_mm);
            ErrorVector {
                place_mm,
                error_mm: truth(&place_mm) + noise,
                uncertainty_mm: Vector::repeat(stated_mm),
                run: 0,
            }
        })
        .collect()
}

fn left_um(field: &Field) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(99);
    let (mut sum, mut count) = (0.0, 0.0);
    while count < 500.0 {
        let q = Vector::new(
            rng.random_range(0.0..400.0),
            rng.random_range(0.0..300.0),
            rng.random_range(0.0..200.0),
        );
        if field.supports(&q) {
            sum += (field.error_mm(&at(q)) - truth(&q)).norm_squared();
            count += 1.0;
        }
    }
    (sum / count).sqrt() * 1e3
}

#[test]
fn noise_is_taken_off_as_far_as_it_lets_itself() {
    for (count, most_um) in [(240, 1.0), (1000, 0.6)] {
        let field = Field::new(&noisy(count, 1e-3, 1e-3, 5), Vector::zeros()).unwrap();
        println!("{count}: {:.3} um left, {:?}, {:?}", left_um(&field), field.made(), field.doubt());
        assert!(left_um(&field) < most_um, "{count}: {}", left_um(&field));
        assert_eq!(field.doubt(), None);
    }
}

#[test]
fn a_noise_that_the_residuals_contradict_is_said() {
    let field = |noise: f64, stated: f64| Field::new(&noisy(240, noise, stated, 6), Vector::zeros());
    assert!(field(1.3e-3, 1e-3).unwrap().doubt().is_some_and(|d| d.scatter_mm > 1.1e-3));
    assert!(field(0.5e-3, 1e-3).unwrap().doubt().is_some_and(|d| d.scatter_mm < 0.8e-3));
    assert!(matches!(field(3e-3, 1e-3), Err(FieldError::Noise(d)) if d.scatter_mm > 1.5e-3));
    assert!(matches!(field(1e-5, 1e-3), Err(FieldError::Noise(_))));
}

#[test]
fn runs_that_lie_apart_are_found() {
    let mut vectors = noisy(240, 1e-3, 1e-3, 7);
    for (k, vector) in vectors.iter_mut().enumerate() {
        vector.run = k % 3;
    }
    Field::new(&vectors, Vector::zeros()).unwrap();
    for vector in vectors.iter_mut().filter(|vector| vector.run == 1) {
        vector.error_mm.y += 2e-3;
    }
    match Field::new(&vectors, Vector::zeros()) {
        Err(FieldError::Offset { vector: 1, offset_mm }) => assert!((offset_mm.y - 2e-3).abs() < 6e-4),
        other => panic!("{:?}", other.map(|field| field.made())),
    }
}

fn lattice(counts: [usize; 3]) -> Vec<ErrorVector> {
    let mut all = Vec::new();
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let place_mm = Vector::new(i as f64 * 50.0, j as f64 * 60.0, k as f64 * 40.0);
                all.push(ErrorVector {
                    place_mm,
                    error_mm: truth(&place_mm),
                    uncertainty_mm: Vector::zeros(),
                    run: 0,
                });
            }
        }
    }
    all
}

#[test]
fn a_lattice_is_met_exactly_whatever_the_order_of_its_rows() {
    let mut vectors = lattice([4, 3, 5]);
    vectors.reverse();
    let field = Field::new(&vectors, Vector::zeros()).unwrap();
    assert_eq!(field.made(), Made::Lattice([4, 3, 5]));
    for vector in &vectors {
        assert_eq!(field.error_mm(&at(vector.place_mm)), vector.error_mm);
    }
    assert!(matches!(
        field.solve(&at(Vector::new(151.0, 0.0, 0.0))),
        Err(SolveError::OutsideVolume { axis: 'X', .. })
    ));
}

#[test]
fn what_makes_no_field_is_refused_by_name() {
    let of = |vectors: &[ErrorVector]| Field::new(vectors, Vector::zeros()).unwrap_err();
    let mut vectors = lattice([4, 3, 5]);
    vectors.remove(17);
    assert_eq!(
        of(&vectors),
        FieldError::Hole { counts: [4, 3, 5], missing: 1, place_mm: Vector::new(50.0, 60.0, 40.0) }
    );
    assert_eq!(of(&lattice([4, 3, 1])), FieldError::Flat { shape: "plane" });
    assert_eq!(of(&lattice([4, 1, 1])), FieldError::Flat { shape: "line" });
    let mut twice = lattice([2, 2, 2]);
    twice.push(ErrorVector { error_mm: twice[3].error_mm + Vector::x() * 1e-4, ..twice[3].clone() });
    assert!(matches!(of(&twice), FieldError::Repeated { first: 3, second: 8, component: 0, .. }));
    twice[8].error_mm.x -= 1e-4;
    assert!(Field::new(&twice, Vector::zeros()).is_ok());
    let mut scattered = noisy(40, 0.0, 0.0, 8);
    assert_eq!(of(&scattered), FieldError::Scattered { places: 40 });
    scattered[3].uncertainty_mm = Vector::repeat(1e-3);
    assert_eq!(of(&scattered), FieldError::Exact { vector: 0 });
    assert_eq!(of(&noisy(15, 1e-3, 1e-3, 9)), FieldError::TooFew { found: 15, needed: 16 });
}

#[test]
fn another_tool_and_places_without_vectors_are_refused() {
    let mut vectors = noisy(600, 1e-3, 1e-3, 10);
    vectors.retain(|vector| vector.place_mm.x + vector.place_mm.y < 450.0);
    let field = Field::new(&vectors, Vector::new(0.0, 0.0, -150.0)).unwrap();
    let with = |x: f64, y: f64, length: f64| Command {
        tool_mm: Vector::new(0.0, 0.0, -length),
        ..at(Vector::new(x, y, 100.0))
    };
    assert!(field.is_cut());
    field.solve(&with(200.0, 150.0, 150.0)).unwrap();
    assert!(matches!(field.solve(&with(200.0, 150.0, 151.0)), Err(SolveError::OtherTool { .. })));
    assert!(matches!(field.solve(&with(370.0, 270.0, 150.0)), Err(SolveError::OutsideVectors { .. })));
    // Outside it is the error of a place inside.
    let near = field.support.nearest(&Vector::new(370.0, 270.0, 100.0));
    assert!(field.supports(&near));
    assert_eq!(field.error_mm(&with(370.0, 270.0, 150.0)), field.error_mm(&with(near.x, near.y, 150.0)));
}

/// Places that were read three times, of a field that no axes make: what bends without joints swells.
#[test]
fn few_places_tell_a_field_that_knows_no_axes() {
    let bumps = [
        (Vector::new(120.0, 90.0, 60.0), 1.0, Vector::new(14.0, -9.0, 6.0)),
        (Vector::new(300.0, 200.0, 150.0), 1.3, Vector::new(-7.0, 12.0, 10.0)),
        (Vector::new(60.0, 260.0, 120.0), 1.1, Vector::new(8.0, 5.0, -13.0)),
    ];
    let size = Vector::new(400.0, 300.0, 200.0);
    let swells = |q: &Vector| -> Vector {
        let one = |(centre, reach, error_um): &(Vector, f64, Vector)| {
            let from = (q - centre).component_div(&size) * (2.0 / reach);
            error_um * (4e-3 * units::math::exp(-2.5 * from.norm_squared()))
        };
        bumps.iter().map(one).sum()
    };
    let mut vectors = noisy(80, 0.0, 1e-3, 11);
    vectors.extend_from_within(..);
    vectors.extend_from_within(..80);
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for vector in &mut vectors {
        let noise = Vector::from_fn(|_, _| gauss(&mut rng) * 1e-3);
        vector.error_mm = swells(&vector.place_mm) + noise;
    }
    let field = Field::new(&vectors, Vector::zeros()).unwrap();
    let (mut sum, mut count) = (0.0, 0.0);
    for vector in noisy(800, 0.0, 1e-3, 13) {
        if field.supports(&vector.place_mm) {
            sum += (field.error_mm(&at(vector.place_mm)) - swells(&vector.place_mm)).norm_squared();
            count += 1.0;
        }
    }
    let left_um = 1e3 * (sum / count).sqrt();
    println!("{left_um:.3} um left of swells, {:?}", field.made());
    // The classes of axes alone leave 3 to 6 um of such fields.
    assert!(left_um < 2.4, "{left_um}");
}
