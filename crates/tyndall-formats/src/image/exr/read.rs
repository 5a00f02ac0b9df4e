//! Reading OpenEXR through the crate `exr`.

use crate::file::{FileError, decode};
use crate::image::picture::{Channel, Layer, Picture};
use crate::image::{Metadata, check_backed};
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use std::collections::BTreeMap;
use std::io::Cursor;

pub(crate) fn parse(bytes: &[u8], name: &str) -> Result<Picture, FileError> {
    let meta = decode(name, || MetaData::read_from_buffered(Cursor::new(bytes), false))?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        check_backed(name, width, height, 4 * header.channels.list.len(), bytes.len())?;
    }
    // In this thread: a panic among the library's own threads would end the program.
    let image = decode(name, || {
        let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
        reader.all_channels().all_layers().all_attributes().non_parallel().from_buffered(Cursor::new(bytes))
    })?;

    let mut attributes = BTreeMap::new();
    let mut size = None;
    let mut layers: BTreeMap<String, Vec<Channel>> = BTreeMap::new();
    let several = image.layer_data.len() > 1;
    collect_texts(&image.attributes.other, &mut attributes);
    for part in image.layer_data {
        collect_texts(&part.attributes.other, &mut attributes);
        let found = (part.size.width(), part.size.height());
        let expected = *size.get_or_insert(found);
        if found != expected {
            let message = format!("found parts of {expected:?} and {found:?} pixels, expected one size");
            return Err(FileError::whole(name, message));
        }
        let part_name = part.attributes.layer_name.filter(|_| several).map(|text| utf8(&text)).unwrap_or_default();
        for channel in part.channel_data.list {
            let values = to_f32(channel.sample_data);
            let full = utf8(&channel.name);
            if values.len() != found.0 * found.1 {
                return Err(FileError::whole(
                    name,
                    format!("found the subsampled channel {full}, expected full resolution"),
                ));
            }
            let (layer, channel) = split(&part_name, &full);
            layers.entry(layer).or_default().push(Channel { name: channel, values });
        }
    }
    let (width, height) = size.ok_or_else(|| FileError::whole(name, "found no parts, expected at least one"))?;
    let layers = layers.into_iter().map(|(name, mut channels)| {
        channels.sort_by_cached_key(|c| {
            (["R", "G", "B", "A"].iter().position(|&n| n == c.name).unwrap_or(4), c.name.clone())
        });
        Layer { name, channels }
    });
    Ok(Picture { width, height, layers: layers.collect(), attributes: attributes.into_iter().collect() })
}

/// Size and texts, without the samples.
pub(crate) fn parse_metadata(
    reader: impl std::io::Read + std::panic::UnwindSafe,
    name: &str,
) -> Result<Metadata, FileError> {
    let meta = decode(name, || MetaData::read_from_buffered(reader, false))?;
    let mut attributes = BTreeMap::new();
    for header in &meta.headers {
        collect_texts(&header.shared_attributes.other, &mut attributes);
        collect_texts(&header.own_attributes.other, &mut attributes);
    }
    let size =
        meta.headers.first().ok_or_else(|| FileError::whole(name, "found no parts, expected at least one"))?.layer_size;
    Ok(Metadata { width: size.width(), height: size.height(), attributes: attributes.into_iter().collect() })
}

/// Layer and channel by a channel's full name; parts of a file with several are layers too.
fn split(part: &str, full: &str) -> (String, String) {
    let (layer, channel) = full.rsplit_once('.').unwrap_or(("", full));
    // Some programs repeat the part's name in those of its channels.
    let layer =
        if part.is_empty() || layer == part || layer.strip_prefix(part).is_some_and(|rest| rest.starts_with('.')) {
            layer.to_owned()
        } else if layer.is_empty() {
            part.to_owned()
        } else {
            format!("{part}.{layer}")
        };
    (layer, channel.to_owned())
}

fn to_f32(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(values) => values.into_iter().map(f32::from).collect(),
        FlatSamples::F32(values) => values,
        FlatSamples::U32(values) => values.into_iter().map(|x| x as f32).collect(),
    }
}

/// The attributes that are texts.
fn collect_texts<'a>(
    found: impl IntoIterator<Item = (&'a exr::prelude::Text, &'a AttributeValue)>,
    texts: &mut BTreeMap<String, String>,
) {
    for (name, value) in found {
        if let AttributeValue::Text(text) = value {
            texts.insert(utf8(name), utf8(text));
        }
    }
}

fn utf8(text: &exr::prelude::Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}
