//! Machines of known truth, made by a generator that shares no code with the crate under test.

use calibration::tracker::{Frame, calibrate};
use calibration::volumetric::{self, Options, Point, PointReading};
use calibration::{MeanTraverse, Reading, quantile_95};
use gap_lab::calibration::{traverses, volume_points};
use machine_model::{Chain, Vector};

/// Counts how often each parameter's interval holds the truth.
struct Coverage {
    inside: Vec<usize>,
    runs: usize,
}

impl Coverage {
    fn new(parameters: usize) -> Self {
        Self { inside: vec![0; parameters], runs: 0 }
    }
    fn count(&mut self, found: impl IntoIterator<Item = (f64, f64, f64)>) {
        self.runs += 1;
        for (k, (value, half_width, truth)) in found.into_iter().enumerate() {
            self.inside[k] += usize::from((value - truth).abs() <= half_width);
        }
    }
    /// 95 % of a small number of runs: four standard deviations of the count either way.
    fn check(&self, what: &str) {
        let slack = 4.0 * (self.runs as f64 * 0.95 * 0.05).sqrt();
        for (k, inside) in self.inside.iter().enumerate() {
            let off = (*inside as f64 - 0.95 * self.runs as f64).abs();
            assert!(off <= slack, "{what} {k}: {inside} of {}", self.runs);
        }
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
        .map(|r| Point {
            run: r.run,
            commanded_mm: Vector::from(r.commanded_mm),
            tool_mm: Vector::from(r.tool_mm),
            reading: PointReading::Deviation(r.deviation_um.map(|d| Some(d * 1e-3))),
            uncertainty_mm: None,
        })
        .collect()
}

#[test]
fn points_in_the_volume_give_every_table() {
    let chain = Chain::parse("[w X Y b Z t]").unwrap();
    let options = Options { nodes: 4, holdout_every: 0 };
    let mut coverage: Option<Coverage> = None;
    for index in 0..60 {
        let (rows, truth) = volume_points(6, index, 1.0, 150);
        let found = volumetric::calibrate(&points(&rows), &chain, options).unwrap();
        assert!(found.open.is_empty(), "three tools tell everything apart: {:?}", found.open);
        let mut all = Vec::new();
        for f in &found.functions {
            for node in 0..4 {
                if f.half_widths_95[node] > 0.0 {
                    let scale = if f.function < 3 { 1e3 } else { 1e6 };
                    let wanted = truth.values[f.axis][node][f.function];
                    all.push((f.values[node] * scale, f.half_widths_95[node] * scale, wanted));
                }
            }
        }
        for k in 0..3 {
            let (value, half) = found.squareness_rad[k].unwrap();
            all.push((value * 1e6, half * 1e6, truth.squareness_urad[k]));
        }
        // 3 positioning and 9 angles with 3 free nodes, 6 straightnesses with 2, 3 angles between axes.
        assert_eq!(all.len(), 9 + 27 + 12 + 3);
        coverage.get_or_insert_with(|| Coverage::new(51)).count(all);
    }
    coverage.unwrap().check("volumetric");
}

#[test]
fn held_out_points_are_predicted_and_open_terms_named() {
    let chain = Chain::parse("[w X Y b Z t]").unwrap();
    let (rows, _) = volume_points(7, 0, 1.0, 240);
    let found =
        volumetric::calibrate(&points(&rows), &chain, Options { nodes: 4, holdout_every: 5 }).unwrap();
    let ([before, after], count) = found.holdout.unwrap();
    assert_eq!(count, 48);
    // 1 µm of noise; the unseen points also carry the uncertainty of 60 parameters from 190 points.
    assert!(before > 0.005 && after < 0.0014, "{before} {after}");
    // One tool: the angles of the axis nearest the tool look like its straightness.
    let one: Vec<Point> = points(&rows).into_iter().filter(|p| p.run == 1).collect();
    let found = volumetric::calibrate(&one, &chain, Options { nodes: 4, holdout_every: 0 }).unwrap();
    let open: Vec<&str> = found.open.iter().map(|(term, _)| term.as_str()).collect();
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
    let chain = Chain::parse("[w X Y b Z t]").unwrap();
    let (rows, truth) = volume_points(8, 0, 0.0, 480);
    let stations =
        [[-100.0, -80.0, 50.0], [500.0, -60.0, -40.0], [480.0, 400.0, 120.0], [-90.0, 380.0, 260.0]];
    let mut all = Vec::new();
    for (run, station) in stations.iter().enumerate() {
        let station = Vector::from(*station);
        for r in rows.iter().filter(|r| r.run == 0 || r.run == 2) {
            let at = Vector::from(r.commanded_mm) + Vector::from(r.tool_mm);
            // Deviations of one run share an offset, which is a shift of the station.
            let moved = at + Vector::from(r.deviation_um) * 1e-3;
            all.push(Point {
                run: run + 4 * usize::from(r.run == 2),
                commanded_mm: Vector::from(r.commanded_mm),
                tool_mm: Vector::from(r.tool_mm),
                reading: PointReading::Distance {
                    length_mm: (moved - station).norm() + 12.0 + run as f64,
                    station_mm: station + Vector::new(0.4, -0.7, 0.5),
                },
                uncertainty_mm: None,
            });
        }
    }
    let found = volumetric::calibrate(&all, &chain, Options { nodes: 4, holdout_every: 0 }).unwrap();
    for k in 0..3 {
        let (value, _) = found.squareness_rad[k].unwrap();
        assert!(
            (value * 1e6 - truth.squareness_urad[k]).abs() < 0.5,
            "{k}: {} {}",
            value * 1e6,
            truth.squareness_urad[k]
        );
    }
    assert!(found.fitted_rms_mm[1] < 2e-5, "{:?} {:?}", found.fitted_rms_mm, found.open);
}
