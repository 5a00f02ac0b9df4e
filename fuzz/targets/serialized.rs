#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for index in 0..2 {
        let _ = tyndall_formats::mesh::serialized::parse(bytes, "a", index);
    }
});
