//! Programs under LinuxCNC's tool centre point control, read as simply as the tests' own need.

/// End of a block under tool centre point control.
pub(crate) struct Place {
    pub(crate) tip_mm: [f64; 3],
    /// Of A or B.
    pub(crate) tilt_deg: f64,
    pub(crate) c_deg: f64,
    pub(crate) feeds: bool,
    /// It has a word for X, Y or Z; a rapid without one keeps the words of before, corrected for other angles.
    pub(crate) names_tip: bool,
}

/// Reads G0, G1, X Y Z A (or B) C between M428 and M429, absolute and in mm: nothing else moves anything in these programs.
pub(crate) fn places(text: &str) -> Vec<Place> {
    let (mut at, mut feeds, mut is_on, mut found) = ([0.0; 5], false, false, Vec::new());
    for line in text.lines() {
        let code: String = line.split(['(', ';']).next().unwrap_or_default().split_whitespace().collect();
        is_on = (is_on || code.contains("M428")) && !code.contains("M429");
        let (mut moves, mut names_tip) = (false, false);
        for word in words(&code) {
            match word {
                ('G', 0.0) => feeds = false,
                ('G', 1.0) => feeds = true,
                (letter, value) => {
                    if let Some(axis) = "XYZAC".find(if letter == 'B' { 'A' } else { letter }) {
                        (at[axis], moves) = (value, true);
                        names_tip |= axis < 3;
                    }
                }
            }
        }
        if moves && is_on {
            found.push(Place {
                tip_mm: [at[0], at[1], at[2]],
                tilt_deg: at[3],
                c_deg: at[4],
                feeds,
                names_tip,
            });
        }
    }
    found
}

fn words(code: &str) -> impl Iterator<Item = (char, f64)> {
    let starts: Vec<usize> =
        code.char_indices().filter(|(_, c)| c.is_ascii_uppercase()).map(|(k, _)| k).collect();
    let ends: Vec<usize> = starts.iter().skip(1).copied().chain([code.len()]).collect();
    let word = move |(from, to): (usize, usize)| {
        Some((code[from..].chars().next()?, code[from + 1..to].parse().ok()?))
    };
    starts.into_iter().zip(ends).filter_map(word)
}
