//! Grid readers against files made here.

use tyndall_formats::grid::vol;

fn header(size: [i32; 4]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend(1i32.to_le_bytes());
    bytes.extend(size.iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([-1.0f32, -2.0, -3.0, 1.0, 2.0, 3.0].iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

#[test]
fn vol_keeps_the_order_of_the_samples() {
    let mut bytes = header([3, 2, 1, 3]);
    bytes.extend((0..18).flat_map(|i| (i as f32).to_le_bytes()));
    let grid = vol::parse(&bytes, "a.vol").unwrap();
    assert_eq!((grid.size, grid.channels), ([3, 2, 1], 3));
    assert_eq!(grid.bounds, [[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]]);
    assert_eq!(grid.values, (0..18).map(|i| i as f32).collect::<Vec<_>>());

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vol");
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(vol::read(&path).unwrap(), grid);
}

#[test]
fn vol_claiming_more_than_it_has_takes_no_memory() {
    let bytes = header([i32::MAX, i32::MAX, i32::MAX, 6]);
    let error = vol::parse(&bytes, "a.vol").unwrap_err().to_string();
    assert_eq!(
        error,
        "a.vol: byte 48: found 0 bytes of samples, expected 237684487210751619608478744552 for 2147483647 x 2147483647 x \
         2147483647 samples of 6 channels"
    );
}
