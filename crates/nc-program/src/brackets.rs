//! What stands in the brackets of a call: `CYCLE800(1,"",100000)`.

/// What stands in the brackets, by argument; none without brackets or with empty ones.
pub(crate) fn arguments(text: &str) -> Vec<&str> {
    let inside = text.split_once('(').map_or("", |(_, rest)| rest.strip_suffix(')').unwrap_or(rest));
    if inside.trim().is_empty() {
        return Vec::new();
    }
    let mut quoted = false;
    inside
        .split(|mark: char| {
            quoted ^= mark == '"';
            mark == ',' && !quoted
        })
        .map(str::trim)
        .collect()
}

/// True of CYCLE800(): the plane ends, and nothing moves.
pub(crate) fn is_reset(text: &str) -> bool {
    arguments(text).is_empty()
}
