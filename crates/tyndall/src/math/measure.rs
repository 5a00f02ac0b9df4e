//! Probability densities named by their measure.
//!
//! A density is a plain number until it is multiplied by one of another measure: these zero-cost types make the
//! conversion explicit.

macro_rules! density {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
        #[repr(transparent)]
        pub struct $name(pub f32);

        impl std::ops::Mul<f32> for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, probability: f32) -> Self {
                Self(self.0 * probability)
            }
        }
        impl std::ops::Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
    };
}

density! {
    /// Density per solid angle, 1/sr.
    PerSolidAngle
}
density! {
    /// Density per area, 1/m^2.
    PerArea
}
density! {
    /// Density per volume, 1/m^3.
    PerVolume
}
density! {
    /// Density per length, 1/m.
    PerLength
}

impl PerSolidAngle {
    /// Density per area of the surface point at distance `d` (metres) whose normal makes the angle of cosine
    /// `cos_next` with the direction: `p cos / d^2`.
    #[inline(always)]
    pub fn to_area(self, d: f32, cos_next: f32) -> PerArea {
        PerArea(self.0 * cos_next.abs() / (d * d))
    }

    /// Density per volume of a point at distance `d` sampled along the direction with density `along`.
    #[inline(always)]
    pub fn to_volume(self, d: f32, along: PerLength) -> PerVolume {
        PerVolume(self.0 * along.0 / (d * d))
    }
}

impl PerArea {
    /// Density per solid angle seen from distance `d` (metres) at the angle of cosine `cos_here`: `p d^2 / cos`.
    /// Zero when the surface is seen edge-on.
    #[inline(always)]
    pub fn to_solid_angle(self, d: f32, cos_here: f32) -> PerSolidAngle {
        let cos = cos_here.abs();
        PerSolidAngle(if cos > 0.0 { self.0 * d * d / cos } else { 0.0 })
    }
}
