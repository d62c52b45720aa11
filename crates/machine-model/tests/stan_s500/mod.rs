//! Measurements of the STAN S500 and the printed tables, read from the shipped files.
//!
//! Also used by `xtask`, which prints the tables of the documentation from the same data.

#![allow(dead_code, unreachable_pub, reason = "each user of this module takes a part of it")]

use std::path::{Path, PathBuf};

use machine_model::engines::{EngineInputs, ErrorVector, Field, ParametricTable};
use machine_model::{
    AxisTables, Chain, Command, Description, Interpolation, LinearAxis, PathModel as _, Range, RigidBody,
    RotaryAxis,
};
use machine_model::{Squareness, Traverse, Vector};

fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let up = here.ancestors().find(|path| path.join("machine-profiles").is_dir());
    up.expect("the project's root holds machine-profiles").to_path_buf()
}

/// Numbers of a CSV file; a cell that is no number stands as NaN.
pub fn numbers(path: &str) -> Vec<Vec<f64>> {
    let path = root().join(path);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().unwrap_or(f64::NAN)).collect();
    text.lines().skip(1).filter(|line| !line.trim().is_empty()).map(row).collect()
}

/// A printed table of `samples/published`.
pub fn published(name: &str) -> Vec<Vec<f64>> {
    numbers(&format!("samples/published/{name}.csv"))
}

/// Interferometer tables of X, Y, Z.
pub fn tables() -> [ParametricTable; 3] {
    ["x", "y", "z"].map(|axis| {
        let rows = numbers(&format!("machine-profiles/stan_s500/interferometer_{axis}.csv"));
        let positions = rows.iter().map(|row| row[0]).collect();
        // µm and µm/mm, which is 1e-3 rad: both are thousandths.
        let values = rows.iter().map(|row| std::array::from_fn(|f| row[f + 1] * 1e-3)).collect();
        ParametricTable::new(positions, values).expect("shipped tables are tables")
    })
}

/// Tracker traverses of one cube (48, 240 or 315 mm).
pub fn traverses(cube: u32) -> [Traverse; 3] {
    [(0, "x"), (1, "y"), (2, "z")].map(|(axis, name)| {
        let rows = numbers(&format!("machine-profiles/stan_s500/tracker_{cube}_{name}.csv"));
        Traverse {
            axis,
            nodes_mm: rows.iter().map(|row| row[axis]).collect(),
            start_mm: std::array::from_fn(|c| rows[0][c]),
            measured_mm: rows.iter().map(|row| std::array::from_fn(|c| row[3 + c])).collect(),
            published_cosines: Some(rows.iter().map(|row| std::array::from_fn(|c| row[6 + c])).collect()),
        }
    })
}

/// Slope of the least-squares line with intercept.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (mean_q, mean_p) = (mean(|p| p.0), mean(|p| p.1));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (q, p) in points {
        covariance += (q - mean_q) * (p - mean_p);
        variance += (q - mean_q) * (q - mean_q);
    }
    covariance / variance
}

/// Slopes of the traverses against the commands, scale error on the diagonal: `[i][c]` of axis i towards c.
pub fn traverse_slopes(traverses: &[Traverse; 3]) -> [Vector; 3] {
    [0, 1, 2].map(|i| {
        let line = |c: usize| {
            traverses[i].nodes_mm.iter().copied().zip(traverses[i].measured_mm.iter().map(move |p| p[c]))
        };
        Vector::from_fn(|c, _| slope(&line(c).collect::<Vec<_>>()) - if c == i { 1.0 } else { 0.0 })
    })
}

/// Slopes that the interferometer tables keep in themselves, over the 315 mm of the traverses.
pub fn table_slopes(tables: &[ParametricTable; 3]) -> [Vector; 3] {
    [0, 1, 2].map(|i| {
        let positions = tables[i].positions_mm().iter().copied().enumerate().filter(|(_, q)| *q <= 315.0);
        let rows: Vec<(usize, f64)> = positions.collect();
        let line = |c: usize| rows.iter().map(move |&(k, q)| (q, tables[i].linear_mm(k)[c]));
        Vector::from_fn(|c, _| slope(&line(c).collect::<Vec<_>>()))
    })
}

/// Squareness that is left to say beside the tables, ISO 230-1 signs: the angles between the traverses less those
/// that the slopes of the straightness tables already hold (a slope is counted once; docs/decisions.md).
pub fn squareness(tables: &[ParametricTable; 3], traverses: &[Traverse; 3]) -> Squareness {
    let (seen, held) = (traverse_slopes(traverses), table_slopes(tables));
    let left = |i: usize, c: usize| seen[i][c] - held[i][c];
    Squareness {
        ec0y_rad: -(left(1, 0) + left(0, 1)),
        eb0z_rad: left(2, 0) + left(0, 2),
        ea0z_rad: -(left(2, 1) + left(1, 2)),
    }
}

/// The rigid-body model `[w X Y b Z t]` of some tables.
pub fn rigid_body(tables: &[ParametricTable; 3], squareness: Squareness) -> RigidBody {
    let linear = [0, 1, 2].map(|i| {
        let positions = tables[i].positions_mm();
        let travel = Range { low: positions[0], high: positions[positions.len() - 1] };
        let functions: [_; 6] = std::array::from_fn(|which| Some(tables[i].linear_table(which)));
        LinearAxis { errors: AxisTables::new(&functions), ..LinearAxis::perfect(travel) }
    });
    let rotary = [0, 1, 2].map(|_| RotaryAxis::perfect(Vector::zeros()));
    let chain = Chain::parse("[w X Y b Z t]").expect("a chain");
    RigidBody::new(Description { chain, linear, rotary, squareness }).expect("shipped tables make a machine")
}

/// The error of a machine at all nodes of its tables, as vectors that are met exactly.
pub fn field(machine: &RigidBody, tables: &[ParametricTable; 3]) -> Field {
    let [x, y, z] = tables.each_ref().map(ParametricTable::positions_mm);
    let mut vectors = Vec::with_capacity(x.len() * y.len() * z.len());
    for &z in z {
        for &y in y {
            for &x in x {
                let place_mm = Vector::new(x, y, z);
                let error_mm = machine.error_mm(&Command { linear_mm: place_mm, ..Default::default() });
                vectors.push(ErrorVector { place_mm, error_mm, uncertainty_mm: Vector::zeros(), run: 0 });
            }
        }
    }
    Field::new(&vectors, Vector::zeros()).expect("a complete lattice")
}

/// Everything the engines can be built from.
pub fn inputs(
    tables: &[ParametricTable; 3],
    traverses: &[Traverse; 3],
    squareness: Squareness,
) -> EngineInputs {
    EngineInputs {
        rigid: Some(Box::new(rigid_body(tables, squareness))),
        traverses: Some(traverses.clone()),
        traverse_interpolation: Interpolation::Monotone,
        tables: Some(tables.clone()),
        field: Some(field(&rigid_body(tables, squareness), tables)),
    }
}
