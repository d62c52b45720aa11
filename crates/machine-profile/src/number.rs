//! Numbers as profiles write them.

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

/// A number that is neither infinite nor NaN: TOML knows both, machines neither.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema)]
#[schemars(transparent)]
pub(crate) struct Finite(pub(crate) f64);

impl<'de> Deserialize<'de> for Finite {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)?;
        if value.is_finite() {
            Ok(Self(value))
        } else {
            Err(serde::de::Error::custom(format!("{value} is not a finite number")))
        }
    }
}

/// Three numbers X, Y, Z.
pub(crate) type Triple = [Finite; 3];

/// A length along Z, or a vector.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a length along Z in mm, or three numbers [x, y, z]")]
pub(crate) enum Length {
    Number(Finite),
    Vector(Triple),
}

/// A value with the bytes of the profile that say it; to the schema the value alone.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(transparent, bound(deserialize = "T: Deserialize<'de>"))]
pub(crate) struct Spanned<T>(#[schemars(with = "T")] toml::Spanned<T>);

impl<T> Spanned<T> {
    /// Where it stands.
    pub(crate) fn span(&self) -> Range<usize> {
        self.0.span()
    }

    /// What it is.
    pub(crate) fn get_ref(&self) -> &T {
        self.0.get_ref()
    }
}
