#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // Without its four first bytes another format would be tried.
    let _ = tyndall_formats::image::parse_picture(
        &[&[0x76, 0x2f, 0x31, 0x01], bytes.get(4..).unwrap_or(&[])].concat(),
        "a",
    );
});
