//! Whatever stands in the files, loading answers with values or with errors whose places exist.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use std::path::Path;

use machine_profile::load;
use proptest::prelude::*;

fn shipped(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machine-profiles").join(path)).unwrap()
}

/// Replaces, removes or doubles a stretch of the text.
fn changed(bytes: &[u8], at: prop::sample::Index, length: usize, what: &[u8]) -> Vec<u8> {
    let at = at.index(bytes.len());
    let end = (at + length).min(bytes.len());
    [&bytes[..at], what, &bytes[end..]].concat()
}

fn check(text: &str, read: &dyn Fn(&str) -> std::io::Result<Vec<u8>>) -> Result<(), TestCaseError> {
    let Err(errors) = load(text, read) else { return Ok(()) };
    prop_assert!(!errors.is_empty());
    for error in errors {
        let length = match &error.file {
            // Places count bytes of the text that a table holds.
            Some(file) => measurement_files::decoded(&read(file).unwrap()).len(),
            None => text.len(),
        };
        if let Some(span) = error.diagnostic.span {
            prop_assert!(span.start <= span.end && span.end <= length as u64, "{span:?} in {length} bytes");
        }
        prop_assert!(!error.diagnostic.message.is_empty());
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn changed_profiles(which in 0usize..2, at: prop::sample::Index, length in 0usize..30, what in "[-a-zA-Z0-9_ .=\\[\\]{}\"#\n]{0,8}") {
        let name = ["stan_s500.toml", "generic_vmc.toml"][which];
        let text = changed(&shipped(name), at, length, what.as_bytes());
        let text = String::from_utf8_lossy(&text).into_owned();
        check(&text, &|path| {
            let known = path.starts_with("stan_s500/") || path.starts_with("generic_vmc/");
            if known && !path.contains("..") {
                std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machine-profiles").join(path))
            } else {
                Err(std::io::ErrorKind::NotFound.into())
            }
        })?;
    }

    #[test]
    fn changed_tables(at: prop::sample::Index, length in 0usize..12, what in prop::collection::vec(any::<u8>(), 0..6), tracker: bool) {
        let text = String::from_utf8(shipped("stan_s500.toml")).unwrap();
        let victim = if tracker { "stan_s500/tracker_315_y.csv" } else { "stan_s500/interferometer_y.csv" };
        check(&text, &|path| {
            let bytes = shipped(path);
            Ok(if path == victim { changed(&bytes, at, length, &what) } else { bytes })
        })?;
    }
}
