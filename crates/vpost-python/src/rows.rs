//! Rows of three numbers in the bytes of an array.

use machine_model::{Command, Vector};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// The rows of an array of shape (n, 3), little-endian doubles. Python has seen to the shape.
pub(crate) fn vectors(bytes: &[u8]) -> Vec<Vector> {
    let (numbers, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|number| f64::from_le_bytes(*number)).collect();
    let (rows, _) = numbers.as_chunks::<3>();
    rows.iter().map(|row| Vector::from(*row)).collect()
}

/// Numbers as bytes.
pub(crate) fn bytes<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = f64>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
    PyBytes::new(py, &bytes)
}

/// Commands of points: position, mm; rotary axes, degrees; tool vector, mm; direction of approach. Each (n, 3).
pub(crate) fn commands(arrays: [&[u8]; 4]) -> Vec<Command> {
    let [position, rotary, tool, direction] = arrays.map(vectors);
    let rows = position.into_iter().zip(rotary).zip(tool).zip(direction);
    let command = |(((linear_mm, rotary_deg), tool_mm), direction): (((Vector, Vector), Vector), Vector)| {
        Command {
            linear_mm,
            rotary_rad: rotary_deg.map(f64::to_radians),
            tool_mm,
            // Python has seen to it that each is -1, 0 or 1.
            direction: [direction.x, direction.y, direction.z].map(|sign| sign as i8),
            ..Default::default()
        }
    };
    rows.map(command).collect()
}
