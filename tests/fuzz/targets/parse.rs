//! Any bytes, each dialect: nothing lost, no panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    vpost_fuzz::parse(bytes);
});
