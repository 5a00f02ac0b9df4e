//! The transfer curve of sRGB (IEC 61966-2-1).

/// Encoded value in [0, 1] to linear.
pub(super) fn decode(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear value to encoded, both in [0, 1].
pub(super) fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
