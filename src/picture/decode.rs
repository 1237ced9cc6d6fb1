//! Files to linear pictures.

use std::{fmt, fs, io::Cursor, path::Path};

use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::{Channel, Picture, PictureError, limits, openexr, srgb};

/// What the numbers of an 8- or 16-bit file mean. Float files are always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB-encoded colours, linearised on reading.
    Srgb,
    /// Data: taken as they are, scaled to [0, 1].
    Raw,
}

/// Reads a picture as linear `R G B` planes (grey is repeated, alpha is dropped).
///
/// EXR, HDR, PNG, JPEG, BMP and TGA are told apart by their content; the name decides only for TGA,
/// which has no signature.
///
/// # Errors
/// [`PictureError`] if the file is missing, damaged or of an unknown kind.
pub fn decode(path: &Path, encoding: Encoding) -> Result<Picture, PictureError> {
    let bytes = fs::read(path).map_err(|source| PictureError::Io { path: path.into(), source })?;
    let picture = if bytes.starts_with(&openexr::MAGIC) {
        openexr::decode(&bytes)
    } else {
        decode_image(&bytes, path, encoding)
    };
    picture.map_err(|reason| PictureError::Format { path: path.into(), reason })
}

fn decode_image(bytes: &[u8], path: &Path, encoding: Encoding) -> Result<Picture, String> {
    let is_tga = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tga"));
    let format = image::guess_format(bytes)
        .ok()
        .or(is_tga.then_some(ImageFormat::Tga))
        .filter(ImageFormat::reading_enabled)
        .ok_or("not a picture that can be read (EXR, HDR, PNG, JPEG, BMP, TGA)")?;
    let kind = format!("{format:?}").to_uppercase();
    let damaged = |error: &dyn fmt::Display| format!("damaged {kind} file ({error})");

    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut allowed = Limits::default();
    allowed.max_image_width = Some(limits::MAX_SIDE as u32);
    allowed.max_image_height = Some(limits::MAX_SIDE as u32);
    allowed.max_alloc = Some(u64::MAX);
    reader.limits(allowed);
    let decoder = reader.into_decoder().map_err(|error| damaged(&error))?;
    let size = decoder.dimensions();
    let (width, height) = (u64::from(size.0), u64::from(size.1));
    limits::check(width, height, 3)?;
    limits::check_expansion((width, height), decoder.total_bytes(), bytes.len())
        .map_err(|error| damaged(&error))?;
    let image = DynamicImage::from_decoder(decoder).map_err(|error| damaged(&error))?;
    Ok(to_planes(image, encoding))
}

fn to_planes(image: DynamicImage, encoding: Encoding) -> Picture {
    let (width, height) = (image.width(), image.height());
    let planes = match image.color() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            let table = match encoding {
                Encoding::Srgb => *srgb::BYTE_TO_LINEAR,
                Encoding::Raw => std::array::from_fn(|byte| byte as f32 / 255.0),
            };
            split(image.into_rgb8().as_raw(), |byte| table[usize::from(byte)])
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let scaled = |word| f32::from(word) / 65535.0;
            let image = image.into_rgb16();
            match encoding {
                Encoding::Srgb => split(image.as_raw(), |word| srgb::to_linear(scaled(word))),
                Encoding::Raw => split(image.as_raw(), scaled),
            }
        }
        _ => split(image.into_rgb32f().as_raw(), |float| float),
    };
    let channels = ["R", "G", "B"].into_iter().zip(planes);
    Picture {
        width,
        height,
        channels: channels.map(|(name, samples)| Channel { name: name.into(), samples }).collect(),
        place: None,
    }
}

/// Interleaved samples to one plane a colour.
fn split<T: Copy>(rgb: &[T], convert: impl Fn(T) -> f32) -> [Vec<f32>; 3] {
    std::array::from_fn(|plane| rgb.iter().skip(plane).step_by(3).map(|&sample| convert(sample)).collect())
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use image::{GrayImage, ImageBuffer, Luma, Rgb, Rgba, RgbaImage};
    use tempfile::TempDir;

    use super::*;

    fn folder() -> TempDir {
        tempfile::tempdir().unwrap()
    }

    fn plane(picture: &Picture, name: &str) -> Vec<f32> {
        picture.plane(name).unwrap().to_vec()
    }

    #[test]
    fn sixteen_bits_are_not_rounded_to_eight() {
        let folder = folder();
        let path = folder.path().join("deep.png");
        let image: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_pixel(2, 1, Rgb([1000, 30001, 65535]));
        image.save(&path).unwrap();
        let raw = decode(&path, Encoding::Raw).unwrap();
        assert_eq!(plane(&raw, "G"), vec![30001.0 / 65535.0; 2]);
        let linear = decode(&path, Encoding::Srgb).unwrap();
        assert_eq!(plane(&linear, "R"), vec![srgb::to_linear(1000.0 / 65535.0); 2]);
        assert_eq!(plane(&linear, "B"), vec![1.0; 2]);
    }

    #[test]
    fn alpha_is_dropped_and_grey_repeated() {
        let folder = folder();
        let path = folder.path().join("alpha.png");
        RgbaImage::from_pixel(1, 1, Rgba([255, 0, 51, 0])).save(&path).unwrap();
        let picture = decode(&path, Encoding::Raw).unwrap();
        assert_eq!([plane(&picture, "R")[0], plane(&picture, "B")[0]], [1.0, 0.2]);

        let path = folder.path().join("grey.png");
        GrayImage::from_pixel(3, 2, Luma([102])).save(&path).unwrap();
        let picture = decode(&path, Encoding::Raw).unwrap();
        assert_eq!((picture.width, picture.height, picture.channels.len()), (3, 2, 3));
        assert_eq!(plane(&picture, "B"), vec![0.4; 6]);
    }

    /// A chunk of a PNG file.
    fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let body = [&name[..], data].concat();
        let length = (data.len() as u32).to_be_bytes();
        [&length[..], &body, &crc32(&body).to_be_bytes()].concat()
    }

    #[test]
    fn palettes_are_looked_up() {
        let folder = folder();
        let path = folder.path().join("palette.png");
        let header = [0, 0, 0, 2, 0, 0, 0, 1, 8, 3, 0, 0, 0];
        // One stored deflate block: filter 0, then the indices 1 and 0; Adler-32 at the end.
        let pixels = [0x78, 0x01, 1, 3, 0, 0xfc, 0xff, 0, 1, 0, 0, 5, 0, 2];
        let bytes = [
            b"\x89PNG\r\n\x1a\n".to_vec(),
            chunk(b"IHDR", &header),
            chunk(b"PLTE", &[255, 0, 0, 51, 102, 153]),
            chunk(b"IDAT", &pixels),
            chunk(b"IEND", &[]),
        ];
        fs::write(&path, bytes.concat()).unwrap();
        let picture = decode(&path, Encoding::Raw).unwrap();
        assert_eq!(plane(&picture, "R"), [0.2, 1.0]);
        assert_eq!(plane(&picture, "B"), [0.6, 0.0]);
    }

    #[test]
    fn content_decides_not_the_name() {
        let folder = folder();
        let path = folder.path().join("really_a_png.jpg");
        let png = folder.path().join("a.png");
        GrayImage::from_pixel(1, 1, Luma([255])).save(&png).unwrap();
        fs::rename(png, &path).unwrap();
        assert_eq!(plane(&decode(&path, Encoding::Srgb).unwrap(), "R"), [1.0]);
    }

    #[test]
    fn every_format_is_read() {
        let folder = folder();
        for name in ["a.png", "a.jpg", "a.bmp", "a.tga"] {
            let path = folder.path().join(name);
            image::RgbImage::from_pixel(8, 8, Rgb([255, 255, 255])).save(&path).unwrap();
            assert_eq!(plane(&decode(&path, Encoding::Srgb).unwrap(), "G"), vec![1.0; 64], "{name}");
        }
    }

    #[test]
    fn damaged_files_are_named() {
        let folder = folder();
        let missing = PathBuf::from("no/such/file.png");
        assert!(decode(&missing, Encoding::Srgb).unwrap_err().to_string().starts_with("no/such/file.png: "));

        for name in ["a.png", "a.jpg", "a.bmp", "a.tga"] {
            let path = folder.path().join(name);
            let noise =
                image::RgbImage::from_fn(16, 16, |x, y| Rgb([(x * 37 + y * 91) as u8, x as u8, y as u8]));
            noise.save(&path).unwrap();
            let bytes = fs::read(&path).unwrap();
            for length in [0, 1, 10, 20, bytes.len() / 2] {
                fs::write(&path, &bytes[..length]).unwrap();
                // Decoders of JPEG may fill in what is missing, as browsers do.
                if let Err(error) = decode(&path, Encoding::Srgb) {
                    assert!(error.to_string().contains(name), "{error}");
                } else {
                    assert!(name == "a.jpg" && length > 20, "{name} cut to {length} bytes was accepted");
                }
            }
        }
    }

    #[test]
    fn a_png_of_absurd_size_is_refused_by_its_header() {
        let folder = folder();
        let path = folder.path().join("bomb.png");
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, &[0], 1, 1, image::ExtendedColorType::L8).unwrap();
        bytes[16..24].copy_from_slice(&[0, 0, 0x7f, 0xff, 0, 0, 0x7f, 0xff]);
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        fs::write(&path, &bytes).unwrap();
        let error = decode(&path, Encoding::Srgb).unwrap_err().to_string();
        assert!(error.contains("32767 × 32767"), "{error}");
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
        })
    }
}
