//! What a page with one script may do: run that script, named by its hash, and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// A script or a style as a policy names it: by its hash.
///
/// SHA-256: browsers take no hash that is quicker.
#[must_use]
pub fn source(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

/// The content of a Content-Security-Policy for a page with this script and these styles.
pub(super) fn policy(script: &str, style: &str) -> String {
    let [script, style] = [script, style].map(source);
    format!(
        "default-src 'none'; script-src {script}; style-src {style}; img-src data:; base-uri 'none'; form-action 'none'"
    )
}
