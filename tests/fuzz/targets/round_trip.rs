//! A machine without errors: identical bytes or a refusal.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    vpost_fuzz::round_trip(bytes);
});
