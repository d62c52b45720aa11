//! Programs of a grammar with rotary words: what is corrected passes the product's own check.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    vpost_fuzz::five_axis(bytes);
});
