//! Where the gap lies in the volume: the worst cells of the truth against those of the answer.

use super::outcome::Outcome;

/// Cells per axis, over the range of the commands: the answer's own division.
const CELLS: usize = 3;
/// Share of the occupied cells that counts as the worst.
const WORST: f64 = 0.2;

/// Part of the truly worst cells that the answer lists among its own worst, as many as there are.
pub(crate) fn overlap(outcome: &Outcome) -> Option<f64> {
    let gap = &outcome.case.truth.gap;
    let (mut low, mut high) = (gap.first()?.0, gap.first()?.0);
    for (command, _) in gap {
        for a in 0..3 {
            low[a] = low[a].min(command[a]);
            high[a] = high[a].max(command[a]);
        }
    }
    let width = [0, 1, 2].map(|a| ((high[a] - low[a]) / CELLS as f64).max(1e-9));
    let cell = |p: &[f64; 3]| {
        [0, 1, 2]
            .map(|a| (((p[a] - low[a]) / width[a]) as usize).min(CELLS - 1))
            .iter()
            .fold(0, |n, k| CELLS * n + k)
    };
    let mut sums = [None; CELLS * CELLS * CELLS];
    for (command, square) in gap {
        *sums[cell(command)].get_or_insert(0.0) += square;
    }
    let mut occupied: Vec<(usize, f64)> =
        sums.iter().enumerate().filter_map(|(k, s)| s.map(|s| (k, s))).collect();
    occupied.sort_by(|a, b| b.1.total_cmp(&a.1));
    let count = (WORST * occupied.len() as f64).ceil() as usize;
    let mut listed: Vec<(usize, f64)> = Vec::new();
    for place in outcome.said()?.places.iter().filter(|p| p.by == "voxel") {
        listed.push((cell(&middle(&place.cell)?), place.share));
    }
    if listed.is_empty() || occupied.len() < 5 {
        return None;
    }
    listed.sort_by(|a, b| b.1.total_cmp(&a.1));
    let listed: Vec<usize> = listed.into_iter().take(count).map(|(k, _)| k).collect();
    let hits = occupied.iter().take(count).filter(|(k, _)| listed.contains(k)).count();
    Some(hits as f64 / count as f64)
}

/// Middle of a cell written as `X 550..816, Y 372..552, Z 223..331`.
fn middle(words: &str) -> Option<[f64; 3]> {
    let mut point = [0.0; 3];
    for part in words.split(", ") {
        let (axis, range) = part.split_once(' ')?;
        let (from, to) = range.split_once("..")?;
        let place = ["X", "Y", "Z"].iter().position(|a| *a == axis)?;
        point[place] = 0.5 * (from.parse::<f64>().ok()? + to.parse::<f64>().ok()?);
    }
    Some(point)
}

#[cfg(test)]
mod tests {
    use super::middle;

    #[test]
    fn the_middle_of_a_cell_as_it_is_written() {
        assert_eq!(middle("X 550..816, Y -10..10, Z 223.5..331.5"), Some([683.0, 0.0, 277.5]));
        assert_eq!(middle("r0"), None);
    }
}
