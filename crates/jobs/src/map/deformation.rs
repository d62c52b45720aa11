//! What a field does to small boxes of commands, cell by cell of the map's grid: equation (96) of `docs/equations.md`.

use diagnostic::{Text, both};
use error_map::ErrorMap;
use machine_model::{Matrix, PathModel, Range, Vector};

use super::asked::Asked;

/// Of one cell, in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation {
    /// Along X, Y, Z.
    pub stretch: Vector,
    /// By how much the right angles between X and Y, X and Z, Y and Z are smaller, rad.
    pub shear_rad: Vector,
    /// About X, Y, Z, rad: of the box, not of the tool.
    pub rotation_rad: Vector,
}

impl Deformation {
    fn of(jacobian: &Matrix) -> Self {
        let j = |row: usize, column: usize| jacobian[(row, column)];
        Self {
            stretch: Vector::new(j(0, 0), j(1, 1), j(2, 2)),
            shear_rad: Vector::new(j(0, 1) + j(1, 0), j(0, 2) + j(2, 0), j(1, 2) + j(2, 1)),
            rotation_rad: Vector::new(j(2, 1) - j(1, 2), j(0, 2) - j(2, 0), j(1, 0) - j(0, 1)) * 0.5,
        }
    }

    /// All nine, µm/m and µrad, in the order of [`NAMES`].
    pub fn values(&self) -> [f64; 9] {
        let parts = [self.stretch, self.shear_rad, self.rotation_rad];
        std::array::from_fn(|k| parts[k / 3][k % 3] * 1e6)
    }
}

/// Columns of files, with units.
pub const NAMES: [&str; 9] = [
    "stretch_x_um_m",
    "stretch_y_um_m",
    "stretch_z_um_m",
    "shear_xy_urad",
    "shear_xz_urad",
    "shear_yz_urad",
    "rotation_a_urad",
    "rotation_b_urad",
    "rotation_c_urad",
];

/// The same for readers.
pub const WORDS: [Text; 9] = [
    Text::pair("stretch along X", "растяжение по X"),
    Text::pair("stretch along Y", "растяжение по Y"),
    Text::pair("stretch along Z", "растяжение по Z"),
    Text::pair("shear X to Y", "сдвиг X к Y"),
    Text::pair("shear X to Z", "сдвиг X к Z"),
    Text::pair("shear Y to Z", "сдвиг Y к Z"),
    Text::pair("rotation about X", "поворот вокруг X"),
    Text::pair("rotation about Y", "поворот вокруг Y"),
    Text::pair("rotation about Z", "поворот вокруг Z"),
];

/// Unit of one of them.
pub fn unit(which: usize) -> Text {
    if which < 3 { both!("um/m", "мкм/м") } else { both!("urad", "мкрад") }
}

/// All cells, X fastest; none where an axis has one node, or where the model is one of axes.
pub(super) fn cells(map: &ErrorMap, model: &dyn PathModel, asked: &Asked) -> Vec<Deformation> {
    let axes = map.grid().axes();
    let middles = axes.each_ref().map(|nodes| {
        nodes.places_mm().windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect::<Vec<f64>>()
    });
    let [x, y, z] = &middles;
    let mut all = Vec::with_capacity(x.len() * y.len() * z.len());
    for k in z {
        for j in y {
            for i in x {
                let Some(jacobian) = model.jacobian(&asked.command(Vector::new(*i, *j, *k), [0; 3])) else {
                    return Vec::new();
                };
                all.push(Deformation::of(&jacobian));
            }
        }
    }
    all
}

/// Smallest, largest and RMS of each of the nine, µm/m and µrad; `None` where there are no cells.
pub fn figures(cells: &[Deformation]) -> Option<[(Range, f64); 9]> {
    let n = cells.len() as f64;
    (!cells.is_empty()).then(|| {
        std::array::from_fn(|k| {
            let values = || cells.iter().map(|cell| cell.values()[k]);
            let range = Range {
                low: values().fold(f64::INFINITY, f64::min),
                high: values().fold(f64::NEG_INFINITY, f64::max),
            };
            (range, (values().map(|v| v * v).sum::<f64>() / n).sqrt())
        })
    })
}

/// The cell that begins at a node, by the node's index.
pub fn of_node<'c>(map: &ErrorMap, cells: &'c [Deformation], index: usize) -> Option<&'c Deformation> {
    let [nx, ny, nz] = map.grid().counts();
    let [i, j, k] = [index % nx, index / nx % ny, index / nx / ny];
    let inner = i + 1 < nx && j + 1 < ny && k + 1 < nz;
    inner.then(|| i + (nx - 1) * (j + (ny - 1) * k)).and_then(|cell| cells.get(cell))
}
