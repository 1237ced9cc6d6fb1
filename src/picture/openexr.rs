//! OpenEXR, both ways: all channels out, `R G B` in.
//!
//! Colours are `R G B A`, or `Y`. What is in a layer is called `layer.component`, the component being one
//! letter: so OpenEXR divides names at their points \[KBS13\], Nuke makes channels of them \[Fou16\], and Blender
//! passes \[Ble22\]. A part of a picture keeps its pixels' coordinates: its data window lies where it belongs in
//! the display window, which is the whole \[KBS13\].

use std::io::Cursor;

use exr::{
    meta::{
        BlockDescription,
        attribute::ChannelDescription,
        header::{Header, ImageAttributes},
    },
    prelude::{
        Compression, Error, IntegerBounds, LayerAttributes, LineOrder, MetaData, ReadChannels, ReadLayers,
        Text, Vec2, read,
    },
};

use super::exr_blocks::{self, Plane};
use super::{Channel, Picture, Place, exr_header, limits};

/// The first bytes of every OpenEXR file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// How an OpenEXR file holds a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExrStyle {
    /// 16 bits a number of a colour instead of 32: 11 of them count, and what is above 65504 becomes infinite.
    /// Distances, places and numbers of things, for which that is too few, keep 32.
    pub half: bool,
    /// How it is made smaller.
    pub compression: ExrCompression,
    /// What else its header says: names and texts.
    pub attributes: Vec<(String, String)>,
}

/// Ways to make an OpenEXR file smaller; none of them loses anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExrCompression {
    /// Not at all.
    None,
    /// Runs of equal bytes.
    Rle,
    /// Deflate, row by row: for compositing.
    Zips,
    /// Deflate, sixteen rows at a time.
    #[default]
    Zip,
    /// Wavelets: often the smallest for noisy pictures.
    Piz,
}

impl From<ExrCompression> for Compression {
    fn from(compression: ExrCompression) -> Self {
        match compression {
            ExrCompression::None => Self::Uncompressed,
            ExrCompression::Rle => Self::RLE,
            ExrCompression::Zips => Self::ZIP1,
            ExrCompression::Zip => Self::ZIP16,
            ExrCompression::Piz => Self::PIZ,
        }
    }
}

/// All channels, in scan lines.
///
/// Nothing dates the file: the same picture gives the same bytes.
pub(super) fn encode(picture: &Picture, style: &ExrStyle) -> Result<Vec<u8>, String> {
    let mut channels = Vec::with_capacity(picture.channels.len());
    for channel in &picture.channels {
        let name = Text::new_or_none(&channel.name)
            .filter(|_| !channel.name.is_empty())
            .ok_or_else(|| format!("`{}` is no name for a channel of an EXR file", channel.name))?;
        let plane = match style.half && is_colour(&channel.name) {
            true => Plane::Half(&channel.samples),
            false => Plane::Float(&channel.samples),
        };
        let description = ChannelDescription {
            name,
            sample_type: plane.sample_type(),
            // A hint for compressions that lose something: what is no colour is not seen by an eye.
            quantize_linearly: !is_colour(&channel.name),
            sampling: Vec2(1, 1),
        };
        channels.push((description, plane));
    }
    channels.sort_unstable_by(|(a, _), (b, _)| a.name.cmp(&b.name));
    let (channels, planes): (Vec<_>, Vec<_>) = channels.into_iter().unzip();
    let Picture { width, height, place, .. } = *picture;
    let place = place.unwrap_or(Place { x: 0, y: 0, width, height });
    let whole = Vec2(place.width as usize, place.height as usize);
    let header = Header::new(Text::default(), Vec2(width as usize, height as usize), channels.into())
        .with_encoding(style.compression.into(), BlockDescription::ScanLines, LineOrder::Increasing)
        .with_shared_attributes(ImageAttributes::new(IntegerBounds::from_dimensions(whole)))
        .with_attributes(LayerAttributes {
            layer_position: Vec2(place.x as i32, place.y as i32),
            ..LayerAttributes::default()
        });
    let mut file = Cursor::new(Vec::new());
    exr_blocks::save(header, &planes, &mut file).map_err(|e| e.to_string())?;
    exr_header::insert(file.into_inner(), &style.attributes)
}

/// A part of a colour, in whatever layer; `Y` in a layer is a coordinate.
fn is_colour(channel: &str) -> bool {
    let (layer, part) = channel.rsplit_once('.').unwrap_or(("", channel));
    matches!(part, "R" | "G" | "B" | "A") || (layer.is_empty() && part == "Y")
}

/// `R G B`, or `Y` three times, of the first layer that has them. Where they are in a larger picture is not read.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, String> {
    check_header(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| explain(&error))?;
    for layer in &image.layer_data {
        let plane = |name: &str| {
            let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name))?;
            let full_size = channel.sampling == Vec2(1, 1);
            full_size.then(|| channel.sample_data.values_as_f32().collect::<Vec<f32>>())
        };
        let colours = match (plane("R"), plane("G"), plane("B")) {
            (Some(r), Some(g), Some(b)) => Some([r, g, b]),
            _ => plane("Y").map(|y| [y.clone(), y.clone(), y]),
        };
        if let Some(planes) = colours {
            let channels = ["R", "G", "B"].into_iter().zip(planes);
            return Ok(Picture {
                width: layer.size.width() as u32,
                height: layer.size.height() as u32,
                channels: channels.map(|(name, samples)| Channel { name: name.into(), samples }).collect(),
                place: None,
            });
        }
    }
    let names: Vec<String> = image
        .layer_data
        .iter()
        .flat_map(|layer| &layer.channel_data.list)
        .map(|channel| channel.name.to_string())
        .collect();
    Err(format!("expected the channels R, G, B (or Y) at full size, found {}", names.join(", ")))
}

fn explain(error: &Error) -> String {
    match error {
        Error::NotSupported(what) => {
            format!(
                "EXR feature not supported ({what}); store the file again with ZIP, PIZ or RLE compression"
            )
        }
        _ => format!("damaged EXR file ({error})"),
    }
}

/// Refuses what can't be read before memory is taken for it.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| explain(&error))?;
    let mut unpacked = 0;
    for header in &meta.headers {
        let size = header.layer_size;
        limits::check(size.width() as u64, size.height() as u64, header.channels.list.len() as u64)?;
        unpacked += size.area() as u64 * header.channels.bytes_per_pixel as u64;
        limits::check_expansion((size.width() as u64, size.height() as u64), unpacked, bytes.len())
            .map_err(|error| format!("damaged EXR file ({error})"))?;
        if header.deep {
            return Err("deep EXR files are not supported; flatten the file first".into());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::FlatSamples;

    fn picture(names: &[&str]) -> Picture {
        let samples = |k: usize| (0..35).map(|i| (i * i) as f32 * 0.37 - k as f32).collect();
        let channels =
            names.iter().enumerate().map(|(k, &name)| Channel { name: name.into(), samples: samples(k) });
        Picture { width: 7, height: 5, channels: channels.collect(), place: None }
    }

    #[test]
    fn colours_survive_to_the_bit() {
        let mut original = picture(&["R", "G", "B"]);
        original.channels[0].samples[3] = f32::INFINITY;
        original.channels[1].samples[4] = -0.0;
        let back = decode(&encode(&original, &ExrStyle::default()).unwrap()).unwrap();
        assert_eq!(back, original);
        assert!(back.channels[1].samples[4].is_sign_negative());
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        // Of several blocks, the last one of them lower than the others.
        let (width, height) = (3, 200);
        let channel = |name: &&str| Channel {
            name: (*name).into(),
            samples: (0..width * height).map(|i| (i * 7919 % 613) as f32 * 0.01).collect(),
        };
        let channels = ["R", "G", "B", "nn.X", "nn.Y", "nn.Z"].iter().map(channel).collect();
        let picture = Picture { width, height, channels, place: None };
        for compression in [ExrCompression::None, ExrCompression::Zip, ExrCompression::Piz] {
            let style = ExrStyle { compression, ..ExrStyle::default() };
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| encode(&picture, &style).unwrap())
            };
            let one = on(1);
            assert!(one == on(3) && one == on(7), "{compression:?}");
            assert_eq!(decode(&one).unwrap().plane("G"), picture.plane("G"));
        }
    }

    #[test]
    fn channels_are_sorted_and_keep_their_names_and_values() {
        let original = picture(&["nn.X", "dd.T", "R", "uv.U"]);
        let bytes = encode(&original, &ExrStyle::default()).unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let list = &image.layer_data.channel_data.list;
        assert_eq!(
            list.iter().map(|c| c.name.to_string()).collect::<Vec<_>>(),
            ["R", "dd.T", "nn.X", "uv.U"]
        );
        assert_eq!(list[2].sample_data, FlatSamples::F32(original.channels[0].samples.clone()));
    }

    #[test]
    fn a_grey_file_is_repeated_and_one_without_colours_is_named() {
        let grey = decode(&encode(&picture(&["Y"]), &ExrStyle::default()).unwrap()).unwrap();
        assert_eq!(grey.channels[0].samples, grey.channels[2].samples);
        let error = decode(&encode(&picture(&["dd.T"]), &ExrStyle::default()).unwrap()).unwrap_err();
        assert!(error.contains("found dd.T"), "{error}");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = encode(&picture(&["R", "G", "B"]), &ExrStyle::default()).unwrap();
        for length in 0..bytes.len() - 1 {
            assert!(decode(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
        }
    }

    #[test]
    fn an_unknown_compression_is_named() {
        let mut bytes = encode(&picture(&["R", "G", "B"]), &ExrStyle::default()).unwrap();
        let name = b"compression\0compression\0";
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len() + 4;
        for compression in [10, 11, 200] {
            bytes[at] = compression;
            let error = decode(&bytes).unwrap_err();
            assert!(error.contains("EXR"), "{error}");
        }
    }

    #[test]
    fn sizes_are_refused_by_the_header_alone() {
        let mut bytes = encode(&picture(&["R", "G", "B"]), &ExrStyle::default()).unwrap();
        for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
            let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
            bytes[at + 8..at + 12].copy_from_slice(&1_000_000_i32.to_le_bytes());
            bytes[at + 12..at + 16].copy_from_slice(&1_000_000_i32.to_le_bytes());
        }
        let error = decode(&bytes).unwrap_err();
        assert!(error.contains("1000001 × 1000001"), "{error}");
    }

    #[test]
    fn half_floats_and_every_compression_are_read_back() {
        let original = picture(&["R", "G", "B"]);
        for compression in [
            ExrCompression::None,
            ExrCompression::Rle,
            ExrCompression::Zips,
            ExrCompression::Zip,
            ExrCompression::Piz,
        ] {
            for half in [false, true] {
                let style = ExrStyle { half, compression, attributes: Vec::new() };
                let back = decode(&encode(&original, &style).unwrap()).unwrap();
                for (a, b) in original.channels.iter().zip(&back.channels) {
                    let tolerance = if half { 2.0f32.powi(-11) } else { 0.0 };
                    assert!(
                        a.samples.iter().zip(&b.samples).all(|(a, b)| (a - b).abs() <= tolerance * a.abs())
                    );
                }
            }
        }
    }

    #[test]
    fn what_the_header_says_is_read_back_in_its_order() {
        let said = [("packlight.seed", "7"), ("a", ""), ("comment", "ä\nb")];
        let said: Vec<_> = said.map(|(name, value)| (name.to_owned(), value.to_owned())).into();
        let original = picture(&["R", "G", "B"]);
        for compression in [ExrCompression::None, ExrCompression::Zip] {
            let style = ExrStyle { attributes: said.clone(), compression, ..ExrStyle::default() };
            let bytes = encode(&original, &style).unwrap();
            assert_eq!(exr_header::strings(&bytes)[..3], said);
            assert_eq!(decode(&bytes).unwrap(), original);
        }
        let style = ExrStyle { attributes: vec![("x".repeat(32), String::new())], ..ExrStyle::default() };
        assert!(encode(&original, &style).is_err());
    }

    #[test]
    fn more_than_the_file_can_hold_is_refused_before_it_is_unpacked() {
        let mut bytes = encode(&picture(&["R", "G", "B"]), &ExrStyle::default()).unwrap();
        for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
            let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
            bytes[at + 8..at + 12].copy_from_slice(&29_999_i32.to_le_bytes());
            bytes[at + 12..at + 16].copy_from_slice(&9_999_i32.to_le_bytes());
        }
        let error = decode(&bytes).unwrap_err();
        assert!(error.contains("30000 × 10000 pixels, more than its"), "{error}");
    }
}
