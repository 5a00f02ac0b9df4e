//! From linear values to what a screen shows.

use super::srgb;

/// Maps linear values of any size to [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// Cuts off above 1.
    #[default]
    Clamp,
    /// x / (1 + x), each channel by itself (Reinhard et al. 2002, eq. 3).
    Reinhard,
    /// A film-like curve: darkest tones at half their slope, 0.18 kept, 1 becomes 0.8, no cut above.
    Filmic,
}

impl ToneMap {
    /// The mapped value, linear.
    pub fn apply(self, x: f32) -> f32 {
        // Also turns NaN into 0.
        let x = x.max(0.0);
        match self {
            Self::Clamp => x.min(1.0),
            Self::Reinhard if x.is_infinite() => 1.0,
            Self::Reinhard => x / (1.0 + x),
            Self::Filmic => {
                // x (x + c/2) / (x^2 + b x + c), with b and c solved for 0.18 -> 0.18 and 1 -> 0.8.
                const B: f32 = 0.161_040_46;
                const C: f32 = 0.237_225_43;
                if x > 1e9 { 1.0 } else { x * (x + 0.5 * C) / (x * (x + B) + C) }
            }
        }
    }

    /// The mapped value as a byte of sRGB.
    pub(super) fn byte(self, x: f32) -> u8 {
        (srgb::encode(self.apply(x)) * 255.0 + 0.5) as u8
    }
}
