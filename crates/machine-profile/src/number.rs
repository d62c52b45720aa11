//! Numbers as profiles write them.

use std::borrow::Cow;
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize};

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

/// A number of all axes, or one of each.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number, or three of X, Y and Z")]
pub(crate) enum Each {
    All(Finite),
    Own(Triple),
}

impl Each {
    /// Of X, Y, Z.
    pub(crate) fn axes(self) -> [f64; 3] {
        match self {
            Self::All(Finite(number)) => [number; 3],
            Self::Own(numbers) => numbers.map(|Finite(number)| number),
        }
    }
}

/// A value with the bytes of the profile that say it; to the schema the value alone.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(transparent)]
pub(crate) struct Spanned<T>(toml::Spanned<T>);

impl<T: JsonSchema> JsonSchema for Spanned<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

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
