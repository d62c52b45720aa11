//! Machines of known truth, made by a generator that shares no code with the crate under test.

use calibration::CalibrationError;
use calibration::tracker::{Frame, calibrate};
use calibration::volumetric::{self, Options, VolumetricCalibration};
use calibration::{Base, MeanTraverse, Point, PointReading, Reading, quantile_95};
use gap_lab::calibration::{traverses, volume_points};
use machine_model::{Chain, Vector};

/// Counts how often each parameter's interval holds the truth.
struct Coverage {
    inside: Vec<usize>,
    /// Of each machine: the share of its parameters.
    shares: Vec<f64>,
}

impl Coverage {
    fn new(parameters: usize) -> Self {
        Self { inside: vec![0; parameters], shares: Vec::new() }
    }
    fn count(&mut self, found: impl IntoIterator<Item = (f64, f64, f64)>) {
        let mut own = 0;
        for (k, (value, half_width, truth)) in found.into_iter().enumerate() {
            let hit = usize::from((value - truth).abs() <= half_width);
            self.inside[k] += hit;
            own += hit;
        }
        self.shares.push(own as f64 / self.inside.len() as f64);
    }
    /// Each parameter: four standard deviations of a binomial count, one of 16 000 by chance. All together: three of their mean,
    /// the parameters of a machine hanging together.
    fn check(&self, what: &str) {
        let runs = self.shares.len() as f64;
        let slack = 4.0 * (runs * 0.95 * 0.05).sqrt();
        for (k, inside) in self.inside.iter().enumerate() {
            let off = (*inside as f64 - 0.95 * runs).abs();
            assert!(off <= slack, "{what} {k}: {inside} of {runs}");
        }
        let mean = self.shares.iter().sum::<f64>() / runs;
        let variance = self.shares.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (runs - 1.0);
        let off = 3.0 * (variance / runs).sqrt();
        assert!((mean - 0.95).abs() <= off && off < 0.05, "{what}: {mean} of all intervals, ± {off}");
    }
}

#[test]
fn traverses_give_scale_and_squareness() {
    let mut coverage = Coverage::new(6);
    for index in 0..150 {
        let (rows, truth) = traverses(5, index, 3.0, 3);
        let means = [0, 1, 2].map(|axis| {
            let readings: Vec<Reading> = rows
                .iter()
                .filter(|r| r.axis == axis)
                .map(|r| Reading {
                    commanded_mm: Vector::from(r.commanded_mm),
                    measured_mm: Vector::from(r.measured_mm),
                    direction: 0,
                })
                .collect();
            MeanTraverse::new(axis, &readings, None).unwrap()
        });
        let found = calibrate(means, Frame::AsMeasured).unwrap();
        let t = quantile_95(Some(32));
        let s = found.squareness;
        let angles = [s.ec0y_rad, s.eb0z_rad, s.ea0z_rad];
        coverage.count((0..6).map(|k| {
            if k < 3 {
                let line = &found.lines[k];
                ((line.slope[k] - 1.0) * 1e6, t * line.uncertainty[k] * 1e6, truth.scale_um_m[k])
            } else {
                let u = found.squareness_uncertainty_rad[k - 3];
                (angles[k - 3] * 1e6, t * u * 1e6, truth.squareness_urad[k - 3])
            }
        }));
    }
    coverage.check("traverse");
}

fn points(rows: &[gap_lab::calibration::PointRow]) -> Vec<Point> {
    rows.iter()
        .map(|r| {
            let reading = PointReading::Deviation(r.deviation_um.map(|d| Some(d * 1e-3)));
            Point::new(r.run, Vector::from(r.commanded_mm), Vector::from(r.tool_mm), reading)
        })
        .collect()
}

fn bare() -> Base {
    Base::bare(Chain::parse("[w X Y b Z t]").expect("a chain"))
}

/// Every parameter of a calibration with its half width.
fn parameters(found: &VolumetricCalibration) -> Vec<(f64, f64)> {
    let nodes = |f: &volumetric::FoundFunction| f.values.clone().into_iter().zip(f.half_widths_95.clone());
    found.functions.iter().flat_map(nodes).chain(found.squareness_rad).collect()
}

#[test]
fn points_in_the_volume_give_every_table() {
    const MACHINES: u64 = 20;
    let options = Options { nodes: 4, holdout_every: 0 };
    let mut coverage: Option<Coverage> = None;
    let (mut alarms, mut ratios) = (0, 0.0);
    for index in 0..MACHINES {
        let fit = |noise: f64| {
            let (rows, _) = volume_points(6, index, noise, 150);
            volumetric::calibrate(&points(&rows), &bare(), options).unwrap()
        };
        // What the same places say without noise is the truth in the fit's own gauge.
        let (found, exact) = (fit(1.0), fit(0.0));
        assert!(exact.fitted_rms_mm[1] < 1e-5, "{:?}", exact.fitted_rms_mm);
        let all: Vec<(f64, f64, f64)> = parameters(&found)
            .into_iter()
            .zip(parameters(&exact))
            .map(|((value, half), (truth, _))| (value, half, truth))
            .collect();
        assert_eq!(all.len(), 18 * 4 + 3);
        coverage.get_or_insert_with(|| Coverage::new(75)).count(all);
        // And the field between them keeps what is stated of it, for every tool in its own frame.
        let models = [&exact, &found].map(|f| machine_model::RigidBody::new(f.description.clone()).unwrap());
        let volume = machine_model::Engine::volume(&models[0]);
        let change = calibration::change::compare(
            &models[0],
            &models[1],
            &volume,
            Vector::zeros(),
            [Some(0.0), Some(found.field_u95_mm)],
        );
        let change = change.unwrap();
        alarms += usize::from(change.is_beyond_uncertainty() == Some(true));
        ratios += change.p95_mm / found.field_u95_mm / MACHINES as f64;
    }
    // One comparison of a hundred may say "changed": of 20 two or more do with a chance of 1.7 %, none with 82 %.
    assert!(alarms < 2, "{alarms} of {MACHINES} unchanged machines seem changed");
    // What 95 % of the places keep scatters by a fifth from machine to machine: by 0.05 in the mean of 20. It is looked at for the
    // shortest of the three tools, of which less is unknown than of all.
    assert!((0.5..1.1).contains(&ratios), "places keep {ratios} of what is stated");
    coverage.unwrap().check("volumetric");
}

/// An instrument that stands anywhere sees the same machine.
#[test]
fn an_instrument_turned_by_any_angle_changes_nothing() {
    let options = Options { nodes: 4, holdout_every: 5 };
    let (rows, _) = volume_points(9, 0, 0.0, 150);
    let straight = volumetric::calibrate(&points(&rows), &bare(), options).unwrap();
    for angle in [2e-4, 0.05, 2.0] {
        let turned: Vec<Point> = points(&rows)
            .into_iter()
            .map(|p| {
                let turn =
                    nalgebra::Rotation3::new(Vector::new(1.0, -2.0, 0.5 + p.run as f64).normalize() * angle);
                let PointReading::Deviation(d) = p.reading else { unreachable!() };
                let at = p.command.linear_mm + p.command.tool_mm + Vector::from(d.map(Option::unwrap));
                let seen = turn * at + Vector::new(900.0, -40.0, 3.0);
                Point { reading: PointReading::Position(seen.data.0[0].map(Some)), ..p }
            })
            .collect();
        let found = volumetric::calibrate(&turned, &bare(), options).unwrap();
        for ((a, _), (b, _)) in parameters(&found).into_iter().zip(parameters(&straight)) {
            assert!((a - b).abs() < 1e-7, "{angle}: {a} {b}");
        }
    }
}

/// A machine measured from its own profile gives it back, whatever the profile says.
#[test]
fn the_own_profile_comes_back() {
    let options = Options { nodes: 4, holdout_every: 5 };
    let (rows, _) = volume_points(10, 0, 0.0, 150);
    let known = volumetric::calibrate(&points(&rows), &bare(), options).unwrap();
    for interpolation in [machine_model::Interpolation::Linear, machine_model::Interpolation::Monotone] {
        let mut base = Base { description: known.description.clone(), interpolation, is_known: true };
        for (axis, linear) in base.description.linear.iter_mut().enumerate() {
            // Constant angles, play and a measured line that no fit's gauge holds.
            let constant = |f: usize| if f == 4 { 5e-5 } else { 0.0 };
            let own = &known.axes[axis];
            let table = |f: usize| {
                let values = own.errors.iter().map(|row| row[f] + constant(f)).collect();
                machine_model::Table::new(own.positions_mm.clone(), values, interpolation).ok()
            };
            linear.errors = machine_model::AxisTables::new(&std::array::from_fn(table));
            linear.backlash_mm = 0.006;
            linear.measured_at_mm = Vector::new(100.0, 200.0, 50.0);
            linear.measured_tool_mm = Vector::new(0.0, 30.0, -80.0);
        }
        let machine = machine_model::RigidBody::new(base.description.clone()).unwrap();
        let measured: Vec<Point> = points(&rows)
            .into_iter()
            .enumerate()
            .map(|(k, mut p)| {
                p.command.direction = [0, 1, 2].map(|bit| if k >> bit & 1 == 1 { 1 } else { -1 });
                let turn = nalgebra::Rotation3::new(Vector::new(0.01, -0.03, 0.02) * p.run as f64);
                let seen = turn * machine.predict(&p.command).position_mm;
                Point { reading: PointReading::Position(seen.data.0[0].map(Some)), ..p }
            })
            .collect();
        let found = volumetric::calibrate(&measured, &base, options).unwrap();
        let again = machine_model::RigidBody::new(found.description).unwrap();
        for p in &measured {
            let (a, b) = (machine.predict(&p.command), again.predict(&p.command));
            assert!((a.position_mm - b.position_mm).norm() < 1e-5, "{interpolation:?} {p:?}");
        }
    }
}

/// Each run is a set-up: as many of them as points would take memory without end.
#[test]
fn a_run_for_every_point_is_refused() {
    let (rows, _) = volume_points(7, 0, 1.0, 240);
    let each: Vec<Point> =
        points(&rows).into_iter().enumerate().map(|(run, point)| Point { run, ..point }).collect();
    let refused = volumetric::calibrate(&each, &bare(), Options { nodes: 4, holdout_every: 5 });
    assert!(matches!(refused, Err(CalibrationError::TooFew(why)) if why.english().starts_with("240 runs")));
}

#[test]
fn held_out_points_are_predicted_and_open_terms_named() {
    let (rows, _) = volume_points(7, 0, 1.0, 240);
    let found =
        volumetric::calibrate(&points(&rows), &bare(), Options { nodes: 4, holdout_every: 5 }).unwrap();
    let ([before, after], count) = found.holdout.unwrap();
    // A fifth of 240, and the first.
    assert_eq!(count, 49);
    // 1 µm of noise; the unseen points also carry the uncertainty of 60 parameters from 190 points.
    assert!(before > 0.005 && after < 0.0014, "{before} {after}");
    // One tool: the angles of the axis nearest the tool look like its straightness.
    let one: Vec<Point> = points(&rows).into_iter().filter(|p| p.run == 1).collect();
    let found = volumetric::calibrate(&one, &bare(), Options { nodes: 4, holdout_every: 0 }).unwrap();
    let open: Vec<&str> = found.open.iter().map(|(term, _)| term.english()).collect();
    for wanted in ["EAZ", "EBZ", "ECZ", "ECY"] {
        assert!(open.contains(&wanted), "{wanted} in {:?}", found.open);
    }
    assert!(found.fitted_rms_mm[1] < 0.0012);
    assert!(
        open.iter().all(|term| term.contains('A') || term.contains('B') || term.contains('C')),
        "{:?}",
        found.open
    );
}

#[test]
fn distances_from_stations_find_the_machine_too() {
    // A tracking interferometer: lengths only, four stations, the stations themselves unknown to a millimetre.
    let (rows, _) = volume_points(8, 0, 0.0, 480);
    let stations =
        [[-100.0, -80.0, 50.0], [500.0, -60.0, -40.0], [480.0, 400.0, 120.0], [-90.0, 380.0, 260.0]];
    let mut all = Vec::new();
    for (run, station) in stations.iter().enumerate() {
        let station = Vector::from(*station);
        for r in rows.iter().filter(|r| r.run == 0 || r.run == 2) {
            let at = Vector::from(r.commanded_mm) + Vector::from(r.tool_mm);
            // Deviations of one run share an offset, which is a shift of the station.
            let moved = at + Vector::from(r.deviation_um) * 1e-3;
            let reading = PointReading::Distance {
                length_mm: (moved - station).norm() + 12.0 + run as f64,
                station_mm: station + Vector::new(0.4, -0.7, 0.5),
            };
            let run = run + 4 * usize::from(r.run == 2);
            all.push(Point::new(run, Vector::from(r.commanded_mm), Vector::from(r.tool_mm), reading));
        }
    }
    let options = Options { nodes: 4, holdout_every: 0 };
    let found = volumetric::calibrate(&all, &bare(), options).unwrap();
    assert!(found.fitted_rms_mm[1] < 2e-5, "{:?} {:?}", found.fitted_rms_mm, found.open);
    // The same machine as that of positions, but for what one tool fewer leaves open.
    let seen = volumetric::calibrate(&points(&rows), &bare(), options).unwrap();
    let models = [&seen, &found].map(|f| machine_model::RigidBody::new(f.description.clone()).unwrap());
    let volume = machine_model::Engine::volume(&models[0]);
    let change =
        calibration::change::compare(&models[0], &models[1], &volume, Vector::zeros(), [None; 2]).unwrap();
    assert!(change.largest_mm < 1e-4, "{change:?}");
}
