//! Places as few bytes: whole numbers of a step, what changes from place to place, seven bits a byte, base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::scene::Place;

/// Steps in which places and displacements are written, µm.
pub(super) const PLACE_UM: f64 = 1.0;
pub(super) const DISPLACED_UM: f64 = 0.01;

/// Rows of numbers, one for each place.
pub(super) struct Encoded {
    /// Base64 of all rows, one after the other.
    pub(super) text: String,
    /// For each row `1`, or `0` for one of zeros that is left out.
    pub(super) rows: String,
}

/// One number of each place.
type Row = Box<dyn Fn(&Place) -> i64>;

/// Line and flags; X, Y, Z; off before and after; then X, Y, Z of each displacement.
pub(super) fn encoded(places: &[Place], displacements: usize) -> Encoded {
    let mut rows: Vec<Row> = vec![Box::new(|place| place.line as i64)];
    for axis in 0..3 {
        rows.push(Box::new(move |place| (place.at_mm[axis] * 1e3 / PLACE_UM).round() as i64));
    }
    let steps = |um: f32| (f64::from(um) / DISPLACED_UM).round() as i64;
    for when in 0..2 {
        rows.push(Box::new(move |place| steps(place.off_um[when])));
    }
    for which in 0..displacements {
        for axis in 0..3 {
            rows.push(Box::new(move |place| steps(place.displaced_um[which][axis])));
        }
    }
    let (mut bytes, mut written) = (Vec::new(), String::new());
    for (at, row) in rows.iter().enumerate() {
        if at > 0 && places.iter().all(|place| row(place) == 0) {
            written.push('0');
            continue;
        }
        written.push('1');
        let mut before = 0;
        for place in places {
            let value = row(place);
            let change = value - before;
            before = value;
            // Small changes in either direction are small numbers.
            let number = ((change << 1) ^ (change >> 63)) as u64;
            let flags = u64::from(place.begins) | u64::from(place.unknown_after) << 1;
            varint(if at == 0 { number << 2 | flags } else { number }, &mut bytes);
        }
    }
    Encoded { text: STANDARD.encode(&bytes), rows: written }
}

fn varint(mut number: u64, bytes: &mut Vec<u8>) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let bytes = |number| {
            let mut bytes = Vec::new();
            varint(number, &mut bytes);
            bytes
        };
        assert_eq!((bytes(0), bytes(127), bytes(300)), (vec![0], vec![127], vec![0xac, 0x02]));
    }

    #[test]
    fn rows_of_zeros_are_left_out() {
        let place = |line, x: f64| Place {
            at_mm: [x, 0.0, 0.0],
            line,
            begins: line == 7,
            ends: true,
            off_um: [0.0, 0.5],
            unknown_after: line == 9,
            displaced_um: vec![[0.0, -0.02, 0.0]],
        };
        let found = encoded(&[place(7, 1.0), place(9, 0.998)], 1);
        assert_eq!(found.rows, "110001010");
        // 7·2 and a beginning, +2 and unknown; 1000 µm, −2 µm; 50 steps, none; −2 steps, none.
        assert_eq!(found.text, STANDARD.encode([14 << 2 | 1, 4 << 2 | 2, 0xd0, 0x0f, 3, 100, 0, 3, 0]));
    }
}
