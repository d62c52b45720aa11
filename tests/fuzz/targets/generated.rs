//! Programs of a grammar: what is corrected passes the product's own check.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    vpost_fuzz::generated(bytes);
});
