//! Quantities whose unit is part of the type.

use std::ops::{Add, Neg, Sub};

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// Nothing of it.
            pub const ZERO: Self = Self(0.0);

            /// True unless the value is infinite or not a number.
            #[must_use]
            pub const fn is_finite(self) -> bool {
                self.0.is_finite()
            }
        }

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
    };
}

quantity! {
    /// A length, kept in millimetres.
    Length
}
quantity! {
    /// A plane angle, kept in radians.
    Angle
}

impl Length {
    /// From millimetres.
    #[must_use]
    pub const fn from_mm(mm: f64) -> Self {
        Self(mm)
    }
    /// From micrometres.
    #[must_use]
    pub const fn from_um(um: f64) -> Self {
        Self(um * 1e-3)
    }
    /// From inches (25.4 mm exactly).
    #[must_use]
    pub const fn from_inch(inch: f64) -> Self {
        Self(inch * 25.4)
    }
    /// In millimetres.
    #[must_use]
    pub const fn mm(self) -> f64 {
        self.0
    }
    /// In micrometres.
    #[must_use]
    pub const fn um(self) -> f64 {
        self.0 * 1e3
    }
}

impl Angle {
    /// From radians.
    #[must_use]
    pub const fn from_rad(rad: f64) -> Self {
        Self(rad)
    }
    /// From microradians.
    #[must_use]
    pub const fn from_urad(urad: f64) -> Self {
        Self(urad * 1e-6)
    }
    /// From degrees.
    #[must_use]
    pub const fn from_deg(deg: f64) -> Self {
        Self(deg * (std::f64::consts::PI / 180.0))
    }
    /// From seconds of arc.
    #[must_use]
    pub const fn from_arcsec(arcsec: f64) -> Self {
        Self(arcsec * (std::f64::consts::PI / 648_000.0))
    }
    /// In radians.
    #[must_use]
    pub const fn rad(self) -> f64 {
        self.0
    }
    /// In microradians.
    #[must_use]
    pub const fn urad(self) -> f64 {
        self.0 * 1e6
    }
    /// In degrees.
    #[must_use]
    pub const fn deg(self) -> f64 {
        self.0 * (180.0 / std::f64::consts::PI)
    }
}
