#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = tyndall_formats::mesh::obj::parse(bytes, "a");
});
