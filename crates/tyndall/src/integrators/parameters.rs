//! Parameters of integrators: declared once, checked and documented from the declaration.

use crate::scene::desc::{IntegratorDesc, ParameterValue};

/// The kind of a parameter's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// A whole number.
    Integer,
    /// A number.
    Float,
    /// true or false.
    Boolean,
    /// A word.
    Text,
    /// One of a few words.
    Choice(&'static [&'static str]),
    /// A size of memory in bytes, possibly with K, M or G.
    Bytes,
}

impl std::fmt::Display for ParameterKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Integer => "a whole number",
            Self::Float => "a number",
            Self::Boolean => "true or false",
            Self::Text => "a word",
            Self::Choice(words) => return write!(f, "one of {}", words.join(", ")),
            Self::Bytes => "a size such as 512M or 4G",
        })
    }
}

/// The declaration of a parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParameterInfo {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Kind of the value.
    pub kind: ParameterKind,
    /// Default, as text.
    pub default: &'static str,
    /// Unit, or an empty text.
    pub unit: &'static str,
    /// What it does, one sentence.
    pub description: &'static str,
}

/// A declaration.
pub(super) const fn parameter(
    name: &'static str,
    kind: ParameterKind,
    default: &'static str,
    unit: &'static str,
    description: &'static str,
) -> ParameterInfo {
    ParameterInfo { name, kind, default, unit, description }
}

/// What is wrong with an integrator's name or parameters.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParameterError {
    /// There is no such integrator.
    #[error("there is no integrator `{name}`; known are {known}")]
    UnknownIntegrator {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The integrator has no such parameter.
    #[error("`{integrator}` has no parameter `{name}`; it has {known}")]
    UnknownParameter {
        /// The integrator.
        integrator: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// Components are taken twice or not at all.
    #[error("`composite`: {what}")]
    Components {
        /// Which.
        what: String,
    },
    /// The value is of the wrong kind.
    #[error("parameter `{name}` of `{integrator}` is {expected}, found `{found}`")]
    WrongKind {
        /// The integrator.
        integrator: &'static str,
        /// The parameter.
        name: &'static str,
        /// The kind that it takes.
        expected: ParameterKind,
        /// What was given.
        found: String,
    },
    /// The value is out of range.
    #[error("parameter `{name}` of `{integrator}` must be {expected}, found `{found}`")]
    OutOfRange {
        /// The integrator.
        integrator: &'static str,
        /// The parameter.
        name: &'static str,
        /// The range.
        expected: &'static str,
        /// What was given.
        found: String,
    },
}

/// The parameters given for one integrator, checked against their declarations.
#[derive(Debug)]
pub struct Parameters<'a> {
    integrator: &'static str,
    declared: &'static [ParameterInfo],
    given: &'a [(String, ParameterValue)],
}

impl<'a> Parameters<'a> {
    /// Checks the names and kinds of everything given.
    pub fn new(
        integrator: &'static str,
        declared: &'static [ParameterInfo],
        desc: &'a IntegratorDesc,
    ) -> Result<Self, ParameterError> {
        for (name, value) in &desc.parameters {
            // `part.parameter` is checked by the part, which must be one of the declared names.
            let part = name.split_once('.').map_or("", |(part, _)| part);
            if super::find(part).is_some() && declared.iter().any(|info| info.name == part) {
                continue;
            }
            let Some(info) = declared.iter().find(|info| info.name == name) else {
                let known = declared.iter().map(|info| info.name).collect::<Vec<_>>().join(", ");
                return Err(ParameterError::UnknownParameter { integrator, name: name.clone(), known });
            };
            if convert(value, info.kind).is_none() {
                let (expected, found) = (info.kind, text(value));
                return Err(ParameterError::WrongKind { integrator, name: info.name, expected, found });
            }
        }
        Ok(Self { integrator, declared, given: &desc.parameters })
    }

    /// The last value given, or the default.
    fn value(&self, name: &'static str) -> ParameterValue {
        let info = self.declared.iter().find(|info| info.name == name).expect("only declared parameters are read");
        let given = self.given.iter().rev().find(|(given, _)| given == name).map(|(_, value)| value.clone());
        convert(&given.unwrap_or_else(|| ParameterValue::Text(info.default.into())), info.kind)
            .expect("kinds were checked, defaults parse")
    }

    /// The parameters given as `part.name`.
    pub fn nested(&self, part: &str) -> Vec<(String, ParameterValue)> {
        let of_part = |name: &str| name.strip_prefix(part)?.strip_prefix('.').map(str::to_string);
        self.given.iter().filter_map(|(name, value)| Some((of_part(name)?, value.clone()))).collect()
    }

    /// Whether the integrator has the parameter.
    pub fn declares(&self, name: &str) -> bool {
        self.declared.iter().any(|info| info.name == name)
    }

    /// A size of memory, bytes.
    pub fn bytes(&self, name: &'static str) -> u64 {
        self.integer(name) as u64
    }

    /// A whole number.
    pub fn integer(&self, name: &'static str) -> i64 {
        match self.value(name) {
            ParameterValue::Integer(value) => value,
            other => unreachable!("`{name}` is not a whole number: {other:?}"),
        }
    }

    /// A number.
    pub fn float(&self, name: &'static str) -> f64 {
        match self.value(name) {
            ParameterValue::Float(value) => value,
            other => unreachable!("`{name}` is not a number: {other:?}"),
        }
    }

    /// A word.
    pub fn text(&self, name: &'static str) -> String {
        match self.value(name) {
            ParameterValue::Text(value) => value,
            other => unreachable!("`{name}` is not a word: {other:?}"),
        }
    }

    /// A whole number that is not too large to count with and at least `least`.
    pub fn count(&self, name: &'static str, least: u32, expected: &'static str) -> Result<u32, ParameterError> {
        let value = u32::try_from(self.integer(name)).ok().filter(|n| (least..u32::MAX - 2).contains(n));
        value.ok_or_else(|| self.out_of_range(name, expected))
    }

    /// A number in a range that `expected` describes.
    pub fn number(
        &self,
        name: &'static str,
        allowed: impl Fn(f32) -> bool,
        expected: &'static str,
    ) -> Result<f32, ParameterError> {
        let value = self.float(name) as f32;
        if value.is_finite() && allowed(value) { Ok(value) } else { Err(self.out_of_range(name, expected)) }
    }

    /// Yes or no.
    pub fn boolean(&self, name: &'static str) -> bool {
        match self.value(name) {
            ParameterValue::Boolean(value) => value,
            other => unreachable!("`{name}` is not a boolean: {other:?}"),
        }
    }

    /// The error that the value of `name` is out of range.
    pub fn out_of_range(&self, name: &'static str, expected: &'static str) -> ParameterError {
        ParameterError::OutOfRange { integrator: self.integrator, name, expected, found: text(&self.value(name)) }
    }
}

/// The value as `kind`; texts, which come from the command line, are parsed.
fn convert(value: &ParameterValue, kind: ParameterKind) -> Option<ParameterValue> {
    use ParameterValue as V;
    Some(match (kind, value) {
        (ParameterKind::Integer, V::Integer(i)) => V::Integer(*i),
        (ParameterKind::Integer, V::Text(t)) => V::Integer(whole(t.trim())?),
        (ParameterKind::Float, V::Integer(i)) => V::Float(*i as f64),
        (ParameterKind::Float, V::Float(f)) => V::Float(*f),
        (ParameterKind::Float, V::Text(t)) => V::Float(t.trim().parse().ok().filter(|f: &f64| f.is_finite())?),
        (ParameterKind::Boolean, V::Boolean(b)) => V::Boolean(*b),
        (ParameterKind::Boolean, V::Text(t)) => V::Boolean(t.trim().to_ascii_lowercase().parse().ok()?),
        (ParameterKind::Text, V::Text(t)) => V::Text(t.clone()),
        (ParameterKind::Choice(words), V::Text(t)) => V::Text(words.iter().find(|w| **w == t.trim())?.to_string()),
        (ParameterKind::Bytes, V::Integer(i)) => V::Integer(*i),
        (ParameterKind::Bytes, V::Text(t)) => V::Integer(bytes(t.trim())?),
        _ => return None,
    })
}

/// A whole number, also as 1e6.
fn whole(text: &str) -> Option<i64> {
    let exact = |f: &f64| f.fract() == 0.0 && f.abs() <= 9e15;
    text.parse().ok().or_else(|| text.parse::<f64>().ok().filter(exact).map(|f| f as i64))
}

/// A size with a unit of powers of 1024.
fn bytes(text: &str) -> Option<i64> {
    let (digits, unit) = match text.to_ascii_uppercase().trim_end_matches('B') {
        t if t.ends_with('K') => (t.trim_end_matches('K').to_string(), 10),
        t if t.ends_with('M') => (t.trim_end_matches('M').to_string(), 20),
        t if t.ends_with('G') => (t.trim_end_matches('G').to_string(), 30),
        t => (t.to_string(), 0),
    };
    let size = digits.trim().parse::<f64>().ok()? * f64::from(1u32 << unit);
    (1.0..9e15).contains(&size).then_some(size as i64)
}

fn text(value: &ParameterValue) -> String {
    match value {
        ParameterValue::Integer(i) => i.to_string(),
        ParameterValue::Float(f) => f.to_string(),
        ParameterValue::Boolean(b) => b.to_string(),
        ParameterValue::Text(t) => t.clone(),
    }
}
