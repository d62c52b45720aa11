//! What an editor is told that it may ask.

use serde_json::{Value, json};

/// What is answered to `initialize`: texts come as changes, places are UTF-16.
pub(crate) fn capabilities() -> Value {
    json!({
        "capabilities": {
            "positionEncoding": "utf-16",
            "textDocumentSync": { "openClose": true, "change": 2, "save": true },
            "hoverProvider": true,
            "documentSymbolProvider": true,
            "foldingRangeProvider": true,
            "definitionProvider": true,
            "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        },
        "serverInfo": { "name": "vpost", "version": env!("CARGO_PKG_VERSION") },
    })
}
