//! The document explains what a table may say. What it says of each code: `tests/dialects.rs`.

use nc_dialect::action_names;

const DOCUMENT: &str = include_str!("../../../docs/dialects.md");

#[test]
fn every_action_is_explained() {
    for name in action_names() {
        assert!(DOCUMENT.contains(&format!("| `{name}` |")), "docs/dialects.md does not explain `{name}`");
    }
}
