//! What a field of 240 noisy vectors leaves on unseen places, against the best that the noise allows.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use std::path::Path;

use machine_model::engines::{ErrorVector, Field};
use machine_model::{AxisTables, Command, Interpolation, LinearAxis, PathModel, RigidBody, Table, Vector};
use machine_profile::{ErrorRows, Profile, load};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

const VECTORS: usize = 240;
const UNSEEN: usize = 300;
const SEEDS: u64 = 3;
const NOISE_MM: f64 = 1e-3;

fn machine() -> Profile {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machine-profiles");
    let text = std::fs::read_to_string(folder.join("generic_vmc.toml")).unwrap();
    load(&text, &|path| std::fs::read(folder.join(path))).unwrap()
}

fn places(profile: &Profile, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vector> {
    let ranges = profile.volume().0;
    let place = |_| Vector::from_fn(|a, _| rng.random_range(ranges[a].low..ranges[a].high));
    (0..count).map(place).collect()
}

fn at(profile: &Profile, place_mm: Vector) -> Command {
    Command { linear_mm: place_mm, tool_mm: profile.default_tool_mm.into(), ..Default::default() }
}

/// Normal deviates by the sum of twelve even ones, of variance 1.
fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0
}

/// Functions of one axis, by rows.
fn tables(rows: &ErrorRows, interpolation: Interpolation) -> AxisTables {
    let function = |f: usize| {
        let values = rows.rows.iter().map(|row| row[f]).collect();
        Table::new(rows.positions.clone(), values, interpolation).ok()
    };
    AxisTables::new(&std::array::from_fn(function)).unwrap()
}

/// How the errors at places depend on every number of the tables, at the true machine: three rows a place.
fn sensitivities(profile: &Profile, places: &[Vector]) -> DMatrix<f64> {
    let errors = |model: &RigidBody| -> DVector<f64> {
        let all = places.iter().flat_map(|place| {
            let error = model.error_mm(&at(profile, *place));
            [error.x, error.y, error.z]
        });
        DVector::from_vec(all.collect())
    };
    let truth = errors(profile.rigid_body_without_effects());
    let mut columns = Vec::new();
    for axis in 0..3 {
        let rows = profile.rows[axis].clone().unwrap();
        for node in 0..rows.rows.len() {
            for f in 0..6 {
                // A nanometre, or as much on a lever of a metre.
                let step = if f < 3 { 1e-6 } else { 1e-9 };
                let mut changed = rows.clone();
                changed.rows[node][f] += step;
                let mut description = profile.description.clone();
                let linear: &mut LinearAxis = &mut description.linear[axis];
                linear.errors = Some(tables(&changed, profile.interpolation));
                columns.push((errors(&RigidBody::new(description).unwrap()) - &truth) / step);
            }
        }
    }
    DMatrix::from_columns(&columns)
}

/// What the noise of the vectors becomes at unseen places by least squares in the machine's own family: all numbers of its
/// tables, as many of them as the vectors tell.
fn own_family(profile: &Profile, seen: &[Vector], unseen: &[Vector], noise: &DVector<f64>) -> f64 {
    let (mut design, mut there) = (sensitivities(profile, seen), sensitivities(profile, unseen));
    for k in 0..design.ncols() {
        // A number that no vector depends on would have no scale.
        let size = design.column(k).norm().max(1e-12);
        design.column_mut(k).scale_mut(1.0 / size);
        there.column_mut(k).scale_mut(1.0 / size);
    }
    let mut normal = design.tr_mul(&design);
    for k in 0..normal.nrows() {
        normal[(k, k)] += 1e-9;
    }
    let found = normal.cholesky().unwrap().solve(&design.tr_mul(noise));
    (there * found).norm_squared() / unseen.len() as f64
}

#[test]
fn what_is_left_is_what_the_noise_allows() {
    let profile = machine();
    let truth = profile.rigid_body_without_effects();
    let (mut of_field, mut of_family, mut of_oracle) = (0.0, 0.0, 0.0);
    for seed in 0..SEEDS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let seen = places(&profile, VECTORS, &mut rng);
        let noise = DVector::from_fn(3 * VECTORS, |_, _| NOISE_MM * gauss(&mut rng));
        let field = |stated_mm: f64| {
            let vectors: Vec<ErrorVector> = seen
                .iter()
                .enumerate()
                .map(|(k, place)| ErrorVector {
                    place_mm: *place,
                    error_mm: truth.error_mm(&at(&profile, *place)) + noise.fixed_rows::<3>(3 * k),
                    uncertainty_mm: Vector::repeat(stated_mm),
                    run: 0,
                })
                .collect();
            Field::new(&vectors, profile.default_tool_mm.into())
        };
        let ours = field(NOISE_MM).unwrap();
        assert_eq!(ours.doubt(), None);
        let mut unseen = places(&profile, UNSEEN, &mut rng);
        let before = unseen.len();
        unseen.retain(|place| ours.supports(place));
        assert!(unseen.len() * 10 > before * 9, "{} of {before} places are supported", unseen.len());
        let left = |field: &Field| {
            let squares = unseen.iter().map(|place| {
                let command = at(&profile, *place);
                (field.error_mm(&command) - truth.error_mm(&command)).norm_squared()
            });
            squares.sum::<f64>() / unseen.len() as f64
        };
        of_field += left(&ours);
        of_family += own_family(&profile, &seen, &unseen, &noise);
        // The same smoother, its amount of smoothing chosen by who knows the truth.
        let amounts = [0.8, 0.9, 1.0, 1.15, 1.3, 1.5];
        of_oracle += amounts
            .iter()
            .filter_map(|amount| field(amount * NOISE_MM).ok())
            .map(|field| left(&field))
            .fold(f64::INFINITY, f64::min);
    }
    let um = |sum: f64| (sum / SEEDS as f64).sqrt() * 1e3;
    let (field, family, oracle) = (um(of_field), um(of_family), um(of_oracle));
    println!(
        "left {field:.3} um; own family by least squares {family:.3} um; smoothed knowing the truth {oracle:.3} um"
    );
    assert!(field <= 1.2 * family.min(oracle), "{field} against {family} and {oracle}");
    // Three components of a micrometre: the vectors themselves are 1.73 um off.
    assert!(field < 1.5, "{field}");
}
