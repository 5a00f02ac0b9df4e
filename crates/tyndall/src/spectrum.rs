//! The one spectrum of Tyndall: linear sRGB.

use glam::Vec3A;
use std::ops::{Add, AddAssign, Div, DivAssign, Index, Mul, MulAssign, Neg, Sub};

/// Three channels of linear sRGB (red, green, blue).
///
/// The unit depends on the quantity: radiance in W/(m^2 sr), extinction in 1/m, albedo without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Spectrum(Vec3A);

impl Spectrum {
    /// Number of channels.
    pub const CHANNELS: usize = 3;
    /// All channels zero.
    pub const ZERO: Self = Self(Vec3A::ZERO);
    /// All channels one.
    pub const ONE: Self = Self(Vec3A::ONE);

    /// A spectrum from red, green and blue.
    #[inline(always)]
    pub const fn new(red: f32, green: f32, blue: f32) -> Self {
        Self(Vec3A::new(red, green, blue))
    }

    /// The same value in every channel.
    #[inline(always)]
    pub const fn grey(value: f32) -> Self {
        Self(Vec3A::splat(value))
    }

    /// A spectrum from `[red, green, blue]`.
    #[inline(always)]
    pub const fn from_rgb(rgb: [f32; 3]) -> Self {
        Self(Vec3A::from_array(rgb))
    }

    /// `[red, green, blue]`.
    #[inline(always)]
    pub fn to_rgb(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// The largest channel.
    #[inline(always)]
    pub fn max_channel(self) -> f32 {
        self.0.x.max(self.0.y).max(self.0.z)
    }

    /// The smallest channel.
    #[inline(always)]
    pub fn min_channel(self) -> f32 {
        self.0.x.min(self.0.y).min(self.0.z)
    }

    /// The mean of the channels.
    #[inline(always)]
    pub fn mean(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) * (1.0 / 3.0)
    }

    /// Luminance (Rec. 709 weights).
    #[inline(always)]
    pub fn luminance(self) -> f32 {
        self.0.dot(Vec3A::new(0.212_671, 0.715_16, 0.072_169))
    }

    /// Whether every channel is exactly zero.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self.0 == Vec3A::ZERO
    }

    /// Whether every channel is finite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Whether all channels are equal.
    #[inline(always)]
    pub fn is_grey(self) -> bool {
        self.0.x == self.0.y && self.0.y == self.0.z
    }

    /// `exp` of each channel.
    #[inline(always)]
    pub fn exp(self) -> Self {
        Self::new(self.0.x.exp(), self.0.y.exp(), self.0.z.exp())
    }

    /// Square root of each channel.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self::new(self.0.x.sqrt(), self.0.y.sqrt(), self.0.z.sqrt())
    }

    /// The larger of both, channel by channel.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The smaller of both, channel by channel.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// `self * (1 - t) + other * t`.
    #[inline(always)]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        Self(self.0 + (other.0 - self.0) * t)
    }

    /// Quotient of each channel; zero where the divisor is.
    #[inline(always)]
    pub fn over(self, divisor: Self) -> Self {
        let channel = |c: usize| if divisor[c] == 0.0 { 0.0 } else { self[c] / divisor[c] };
        Self::new(channel(0), channel(1), channel(2))
    }

    /// `function` of each channel.
    #[inline(always)]
    pub fn map(self, function: impl Fn(f32) -> f32) -> Self {
        Self::new(function(self.0.x), function(self.0.y), function(self.0.z))
    }
}

impl Default for Spectrum {
    fn default() -> Self {
        Self::ZERO
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline(always)]
    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

macro_rules! channelwise {
    ($trait:ident, $function:ident, $assign:ident, $assign_function:ident, $op:tt) => {
        impl $trait for Spectrum {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.0 $op other.0)
            }
        }
        impl $assign for Spectrum {
            #[inline(always)]
            fn $assign_function(&mut self, other: Self) {
                self.0 = self.0 $op other.0;
            }
        }
    };
}
channelwise!(Add, add, AddAssign, add_assign, +);
channelwise!(Mul, mul, MulAssign, mul_assign, *);
channelwise!(Div, div, DivAssign, div_assign, /);

impl Sub for Spectrum {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Spectrum {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul<f32> for Spectrum {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }
}

impl Mul<Spectrum> for f32 {
    type Output = Spectrum;
    #[inline(always)]
    fn mul(self, spectrum: Spectrum) -> Spectrum {
        spectrum * self
    }
}

impl MulAssign<f32> for Spectrum {
    #[inline(always)]
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Div<f32> for Spectrum {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: f32) -> Self {
        Self(self.0 * (1.0 / divisor))
    }
}

impl std::iter::Sum for Spectrum {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::ZERO, |a, b| a + b)
    }
}
