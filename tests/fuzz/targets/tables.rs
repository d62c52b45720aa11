//! Profiles, dialect tables, measurements: an answer, no panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    vpost_fuzz::tables(bytes);
});
