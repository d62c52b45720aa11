//! The map for other programs: CSV, and VTK for ParaView.

use std::fmt::Write;

use crate::figures::fixed;
use crate::map::deformation;
use crate::map::study::Study;

/// Decimals of a micrometre.
const DECIMALS: usize = 6;

/// `x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,d_um`, a row for each node, X fastest; of a field also stretch, shear and rotation of
/// the cell that begins at the node, nothing at the last nodes.
#[must_use]
pub fn csv(study: &Study) -> Vec<u8> {
    let mut out = String::from("x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,d_um");
    let names: &[&str] = if study.cells.is_empty() { &[] } else { &deformation::NAMES };
    for name in names {
        out.push(',');
        out.push_str(name);
    }
    out.push('\n');
    for (index, error) in study.map.errors_mm().iter().enumerate() {
        let place = study.map.grid().place_mm(index);
        for value in place.iter() {
            out.push_str(&fixed(*value, 9));
            out.push(',');
        }
        for value in error.iter() {
            out.push_str(&fixed(value * 1e3, DECIMALS));
            out.push(',');
        }
        out.push_str(&fixed(error.norm() * 1e3, DECIMALS));
        let cell = deformation::of_node(&study.map, &study.cells, index).map(|cell| cell.values());
        for which in 0..names.len() {
            out.push(',');
            if let Some(values) = cell {
                out.push_str(&fixed(values[which], DECIMALS));
            }
        }
        out.push('\n');
    }
    out.into_bytes()
}

/// Legacy VTK, a rectilinear grid: errors and their lengths, as they are and after the shift by the
/// geometric median.
#[must_use]
pub fn vtk(study: &Study) -> Vec<u8> {
    let grid = study.map.grid();
    let [nx, ny, nz] = grid.counts();
    // The title is one line of at most 255 characters.
    let plain = |c: char| if c.is_ascii_graphic() { c } else { ' ' };
    let name: String = nc_emit::ascii(&study.machine).chars().map(plain).take(200).collect();
    let mut out = format!(
        "# vtk DataFile Version 3.0\nvpost map of {name}\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS {nx} {ny} {nz}\n"
    );
    for (axis, nodes) in ["X", "Y", "Z"].iter().zip(grid.axes()) {
        let places = nodes.places_mm();
        let _ = writeln!(out, "{axis}_COORDINATES {} double", places.len());
        let text: Vec<String> = places.iter().map(|v| fixed(*v, 9)).collect();
        out.push_str(&text.join(" "));
        out.push('\n');
    }
    let _ = writeln!(out, "POINT_DATA {}", grid.len());
    let shift = study.parts[0].median().shift_mm;
    for (name, shift) in [("error", shift * 0.0), ("error_after_shift", shift)] {
        let _ = writeln!(out, "VECTORS {name}_um double");
        for error in study.map.errors_mm() {
            let left = (error - shift) * 1e3;
            let text = [0, 1, 2].map(|axis| fixed(left[axis], DECIMALS));
            out.push_str(&text.join(" "));
            out.push('\n');
        }
        let _ = writeln!(out, "SCALARS {name}_length_um double 1\nLOOKUP_TABLE default");
        for error in study.map.errors_mm() {
            out.push_str(&fixed((error - shift).norm() * 1e3, DECIMALS));
            out.push('\n');
        }
    }
    if !study.cells.is_empty() {
        let _ = writeln!(out, "CELL_DATA {}", study.cells.len());
        for (first, name) in [(0, "stretch_um_m"), (3, "shear_urad"), (6, "rotation_urad")] {
            let _ = writeln!(out, "VECTORS {name} double");
            for cell in &study.cells {
                let values = cell.values();
                let text = [0, 1, 2].map(|k| fixed(values[first + k], DECIMALS));
                out.push_str(&text.join(" "));
                out.push('\n');
            }
        }
    }
    out.into_bytes()
}
