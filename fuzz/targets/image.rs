#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = tyndall_formats::image::parse(bytes, "a", false);
});
