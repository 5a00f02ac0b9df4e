//! The header of a PLY file.

use crate::file::{FileError, Place, Word, Words};

/// How the elements are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Text,
    Little,
    Big,
}

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a number in a binary.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// One number, or a list: type of its length, type of its items.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Scalar(Scalar),
    List(Scalar, Scalar),
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    place: Place,
}

impl Element {
    /// The index of a property that is a single number.
    pub(super) fn scalar(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)))
    }

    /// An error at the element's line in the header.
    pub(super) fn error(&self, file: &str, message: &str) -> FileError {
        FileError::new(file, self.place, message)
    }

    /// The fewest bytes that one such element can take.
    pub(super) fn least_size(&self, format: Format) -> usize {
        let size = |p: &Property| match (format, p.kind) {
            // A digit and a separator.
            (Format::Text, _) => 2,
            (_, Kind::Scalar(scalar) | Kind::List(scalar, _)) => scalar.size(),
        };
        self.properties.iter().map(size).sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// Bytes of the header.
    pub(super) length: usize,
    /// Lines of the header.
    pub(super) lines: usize,
}

impl Header {
    pub(super) fn parse(bytes: &[u8], name: &str) -> Result<Self, FileError> {
        let words = &mut Words::new(bytes, name);
        let magic = expect(words, "the word ply")?;
        if magic.bytes != b"ply" {
            return Err(unexpected(words, magic, "the word ply"));
        }
        let mut format = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            end_of_line(words)?;
            let Some(keyword) = words.in_line() else { continue };
            match keyword.bytes {
                b"comment" | b"obj_info" => while words.in_line().is_some() {},
                b"format" => format = Some(parse_format(words)?),
                b"element" => elements.push(parse_element(words, keyword.place)?),
                b"property" => {
                    let Some(element) = elements.last_mut() else {
                        return Err(unexpected(words, keyword, "an element before its properties"));
                    };
                    let property = parse_property(words)?;
                    if element.properties.iter().any(|p| p.name == property.name) {
                        return Err(words.error_at(keyword, format!("found the property {} twice", property.name)));
                    }
                    element.properties.push(property);
                }
                b"end_header" => {
                    let Some(format) = format else {
                        return Err(unexpected(words, keyword, "a line format before it"));
                    };
                    end_of_line(words)?;
                    return Ok(Self { format, elements, length: words.offset(), lines: words.line() });
                }
                _ => return Err(unexpected(words, keyword, "format, comment, element, property or end_header")),
            }
        }
    }
}

fn parse_format(words: &mut Words) -> Result<Format, FileError> {
    let what = "ascii, binary_little_endian or binary_big_endian";
    let word = expect(words, what)?;
    let format = match word.bytes {
        b"ascii" => Format::Text,
        b"binary_little_endian" => Format::Little,
        b"binary_big_endian" => Format::Big,
        _ => return Err(unexpected(words, word, what)),
    };
    let version = expect(words, "version 1.0")?;
    if version.bytes != b"1.0" {
        return Err(unexpected(words, version, "version 1.0"));
    }
    Ok(format)
}

fn parse_element(words: &mut Words, place: Place) -> Result<Element, FileError> {
    let name = expect(words, "the name of an element")?;
    let count = expect(words, "a number of elements")?;
    let Some(number) = count.parse() else { return Err(unexpected(words, count, "a number of elements")) };
    Ok(Element { name: name.text(), count: number, properties: Vec::new(), place })
}

fn parse_property(words: &mut Words) -> Result<Property, FileError> {
    let first = expect(words, "a type")?;
    let kind = if first.bytes == b"list" {
        let word = expect(words, "the type of a list's length")?;
        let length = scalar(words, word)?;
        if !length.is_whole() {
            return Err(unexpected(words, word, "a type of whole numbers for a list's length"));
        }
        let word = expect(words, "the type of a list's items")?;
        Kind::List(length, scalar(words, word)?)
    } else {
        Kind::Scalar(scalar(words, first)?)
    };
    let name = expect(words, "the name of a property")?;
    Ok(Property { name: name.text(), kind })
}

fn scalar(words: &Words, word: Word) -> Result<Scalar, FileError> {
    Scalar::of(word.bytes)
        .ok_or_else(|| unexpected(words, word, "a type (char, uchar, short, ushort, int, uint, float, double)"))
}

fn expect<'a>(words: &mut Words<'a>, what: &str) -> Result<Word<'a>, FileError> {
    words.in_line().ok_or_else(|| words.error(format!("found the end of the line, expected {what}")))
}

fn end_of_line(words: &mut Words) -> Result<(), FileError> {
    if let Some(word) = words.in_line() {
        return Err(unexpected(words, word, "the end of the line"));
    }
    if !words.next_line() {
        return Err(words.error("found the end of the file, expected the line end_header before it"));
    }
    Ok(())
}

fn unexpected(words: &Words, word: Word, what: &str) -> FileError {
    words.error_at(word, format!("found {}, expected {what}", word.shown()))
}
