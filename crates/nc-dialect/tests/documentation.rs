//! The document says what the tables say.

use nc_dialect::{ACTION_NAMES, builtin, builtin_names, describe};

const DOCUMENT: &str = include_str!("../../../docs/dialects.md");

#[test]
fn every_code_of_every_dialect_is_listed() {
    for name in builtin_names() {
        let expected = describe(builtin(name).expect("shipped grammars load"));
        assert!(
            DOCUMENT.contains(&expected),
            "docs/dialects.md is stale for {name}: below its line `<!-- tables -->` belongs what \
             `cargo run -p nc-dialect --example dialect-tables` prints"
        );
    }
}

#[test]
fn every_action_is_explained() {
    for name in ACTION_NAMES {
        assert!(DOCUMENT.contains(&format!("| `{name}` |")), "docs/dialects.md does not explain `{name}`");
    }
}
