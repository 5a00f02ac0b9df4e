//! A picture of named layers, as renders are kept.

use crate::file::FileError;
use tyndall::scene::desc::{ImageDesc, Rgb};

/// A picture: linear values, row 0 at the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The layers; the one without a name is what viewers show.
    pub layers: Vec<Layer>,
    /// Names and texts.
    pub attributes: Vec<(String, String)>,
}

/// Channels that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Name, empty for the main layer. A point separates it from the channel's name in a file: `variance.R`.
    pub name: String,
    /// The channels.
    pub channels: Vec<Channel>,
}

/// A channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// Name without the layer's: `R`.
    pub name: String,
    /// `width * height` values, row by row.
    pub values: Vec<f32>,
}

impl Layer {
    /// The layer of a colour picture.
    pub fn from_rgb(name: impl Into<String>, pixels: &[Rgb]) -> Self {
        let channel = |i: usize| pixels.iter().map(|p| p[i]).collect();
        let channels = ["R", "G", "B"].iter().zip(0..);
        Self {
            name: name.into(),
            channels: channels.map(|(&name, i)| Channel { name: name.into(), values: channel(i) }).collect(),
        }
    }

    /// A channel's values.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// The layer as colours: from R, G and B, or from Y, or from the only channel.
    pub fn to_rgb(&self) -> Option<Vec<Rgb>> {
        if let (Some(r), Some(g), Some(b)) = (self.channel("R"), self.channel("G"), self.channel("B")) {
            return Some(r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect());
        }
        let grey = match (self.channel("Y"), self.channels.as_slice()) {
            (Some(y), _) => y,
            (None, [only]) => &only.values,
            _ => return None,
        };
        Some(grey.iter().map(|&y| [y; 3]).collect())
    }
}

impl Picture {
    /// A picture of one nameless colour layer.
    pub fn from_rgb(width: usize, height: usize, pixels: &[Rgb]) -> Self {
        Self { width, height, layers: vec![Layer::from_rgb("", pixels)], attributes: Vec::new() }
    }

    /// The layer of a name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|l| l.name == name)
    }

    /// The text of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str())
    }

    /// The first layer with colours or grey as a texture.
    pub(super) fn rgb(&self, name: &str) -> Result<ImageDesc, FileError> {
        let pixels = self.layers.iter().find_map(Layer::to_rgb).ok_or_else(|| {
            let found: Vec<String> = self.channel_names().take(20).collect();
            FileError::whole(name, format!("found the channels {}, expected R, G, B or Y", found.join(", ")))
        })?;
        Ok(ImageDesc { width: self.width, height: self.height, pixels })
    }

    fn channel_names(&self) -> impl Iterator<Item = String> {
        self.layers.iter().flat_map(|layer| layer.channels.iter().map(|c| full_name(&layer.name, &c.name)))
    }
}

/// A channel's name in a file.
pub(super) fn full_name(layer: &str, channel: &str) -> String {
    if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") }
}
