//! Which known name was meant by what was typed.

/// The known name nearest to what was typed, where one is near enough to be meant.
#[must_use]
pub fn closest<'n>(typed: &str, known: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    known
        .into_iter()
        .map(|name| (distance(typed, name), name))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, name)| *distance <= 1 + name.len().min(typed.len()) / 3)
        .map(|(_, name)| name)
}

/// Levenshtein's, upper and lower case alike.
fn distance(a: &str, b: &str) -> usize {
    strsim::levenshtein(&a.to_lowercase(), &b.to_lowercase())
}
