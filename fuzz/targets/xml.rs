#![no_main]

use tyndall_formats::mitsuba;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = mitsuba::read_str(text, std::path::Path::new("no such folder"), &mitsuba::Options::default());
});
