//! The numbers after the header of a PLY file.

use super::header::{Element, Format, Header, Kind, Property, Scalar};
use crate::file::{Bytes, FileError, Place, Words};

pub(super) struct Body<'a> {
    format: Format,
    binary: Bytes<'a>,
    text: Words<'a>,
    /// Where the number read last begins.
    before: Place,
    pub(super) name: &'a str,
}

impl<'a> Body<'a> {
    pub(super) fn new(header: &Header, bytes: &'a [u8], name: &'a str) -> Self {
        let text = Words::from_line(bytes, name, header.length, header.lines);
        let binary = Bytes { bytes, at: header.length, name };
        Self { format: header.format, binary, text, before: Place::Whole, name }
    }

    /// The number of elements, if as many can follow at all: nothing is allocated on the word of the header alone.
    pub(super) fn backed_count(&self, element: &Element) -> Result<usize, FileError> {
        let left = match self.format {
            // The last number needs no separator.
            Format::Text => self.binary.bytes.len() - self.text.offset() + 1,
            _ => self.binary.left(),
        };
        let least = element.least_size(self.format);
        if u128::from(element.count) * least as u128 > left as u128 {
            return Err(self.error(format!(
                "found {left} bytes, expected at least {least} for each of the {} elements {}",
                element.count, element.name
            )));
        }
        // Elements without properties take no bytes; there may be any number of them.
        Ok(if least == 0 { 0 } else { element.count as usize })
    }

    pub(super) fn skip(&mut self, element: &Element) -> Result<(), FileError> {
        for _ in 0..self.backed_count(element)? {
            for property in &element.properties {
                self.skip_property(property)?;
            }
        }
        Ok(())
    }

    pub(super) fn skip_property(&mut self, property: &Property) -> Result<(), FileError> {
        match property.kind {
            Kind::Scalar(scalar) => drop(self.value(scalar)?),
            Kind::List(length, item) => {
                for _ in 0..self.length(length)? {
                    self.value(item)?;
                }
            }
        }
        Ok(())
    }

    /// The next number.
    #[inline]
    pub(super) fn value(&mut self, scalar: Scalar) -> Result<f64, FileError> {
        match self.format {
            Format::Text => self.text_value(scalar),
            Format::Little => self.binary_value::<false>(scalar),
            Format::Big => self.binary_value::<true>(scalar),
        }
    }

    #[inline]
    fn binary_value<const BIG: bool>(&mut self, scalar: Scalar) -> Result<f64, FileError> {
        self.before = Place::Byte(self.binary.at as u64);
        macro_rules! read {
            ($number:ty) => {{
                let mut bytes = self.binary.array("a number")?;
                if BIG {
                    bytes.reverse();
                }
                <$number>::from_le_bytes(bytes) as f64
            }};
        }
        Ok(match scalar {
            Scalar::I8 => read!(i8),
            Scalar::U8 => read!(u8),
            Scalar::I16 => read!(i16),
            Scalar::U16 => read!(u16),
            Scalar::I32 => read!(i32),
            Scalar::U32 => read!(u32),
            Scalar::F32 => read!(f32),
            Scalar::F64 => read!(f64),
        })
    }

    fn text_value(&mut self, scalar: Scalar) -> Result<f64, FileError> {
        let Some(word) = self.text.anywhere() else {
            return Err(self.text.error("found the end of the file, expected a number"));
        };
        self.before = word.place;
        // Straight to the precision that the header names: rounding twice is not the same.
        let number = if scalar == Scalar::F32 { word.parse::<f32>().map(f64::from) } else { word.parse::<f64>() };
        match number {
            Some(x) if !scalar.is_whole() || x.fract() == 0.0 => Ok(x),
            _ => {
                let expected = if scalar.is_whole() { "a whole number" } else { "a number" };
                Err(self.text.error_at(word, format!("found {}, expected {expected}", word.shown())))
            }
        }
    }

    /// The next number, which must be finite as an `f32`.
    #[inline]
    pub(super) fn finite(&mut self, scalar: Scalar) -> Result<f32, FileError> {
        let value = self.value(scalar)? as f32;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.error_before(format!("found {value}, expected a finite number")))
        }
    }

    /// The length of a list.
    #[inline]
    pub(super) fn length(&mut self, scalar: Scalar) -> Result<u64, FileError> {
        let value = self.value(scalar)?;
        if value >= 0.0 {
            Ok(value as u64)
        } else {
            Err(self.error_before(format!("found a list of {value} items, expected none or more")))
        }
    }

    /// The index of a vertex.
    #[inline]
    pub(super) fn index(&mut self, scalar: Scalar) -> Result<u32, FileError> {
        let value = self.value(scalar)?;
        if (0.0..4_294_967_296.0).contains(&value) {
            Ok(value as u32)
        } else {
            Err(self.error_before(format!("found vertex index {value}, expected one from 0 on")))
        }
    }

    /// An error at the number read last.
    #[cold]
    pub(super) fn error_before(&self, message: String) -> FileError {
        FileError::new(self.name, self.before, message)
    }

    /// An error at the next number.
    #[cold]
    pub(super) fn error(&self, message: String) -> FileError {
        match self.format {
            Format::Text => self.text.error(message),
            _ => self.binary.error(message),
        }
    }
}
