//! The document explains what a table may say. What it says of each code: `tests/dialects.rs`.

use nc_dialect::ACTION_NAMES;

const DOCUMENT: &str = include_str!("../../../docs/dialects.md");

#[test]
fn every_action_is_explained() {
    for name in ACTION_NAMES {
        assert!(DOCUMENT.contains(&format!("| `{name}` |")), "docs/dialects.md does not explain `{name}`");
    }
}
