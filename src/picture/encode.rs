//! Pictures to files.

use std::{
    fs::{self, File, OpenOptions},
    io,
    io::Write,
    path::Path,
};

use image::{ExtendedColorType, ImageEncoder, Rgb, codecs::hdr::HdrEncoder, codecs::png::PngEncoder};
use tempfile::NamedTempFile;

use super::{ExrStyle, Picture, PictureError, Tone, limits, openexr, srgb};

/// Kinds of file that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR, 32-bit float, linear, all channels.
    Exr,
    /// Radiance RGBE, linear, `R G B`.
    Hdr,
    /// 8-bit sRGB after exposure, `R G B`.
    Png,
}

impl Format {
    /// By the extension, in either case.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "exr" => Some(Self::Exr),
            "hdr" => Some(Self::Hdr),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

/// How floats become 8 bits in a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preview {
    /// Stops: colours are multiplied by 2^exposure first.
    pub exposure: f32,
    /// What becomes of what is then too bright.
    pub tone: Tone,
}

/// How files hold pictures, where there is a choice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Style {
    /// Of a PNG.
    pub preview: Preview,
    /// Of an EXR.
    pub exr: ExrStyle,
}

/// [`encode_with`] the default EXR.
///
/// # Errors
/// [`PictureError`] if the picture does not fit the format.
pub fn encode(picture: &Picture, format: Format, preview: Preview) -> Result<Vec<u8>, PictureError> {
    encode_with(picture, format, &Style { preview, ..Style::default() })
}

/// The bytes of a file: the same picture in the same style gives the same bytes.
///
/// # Errors
/// [`PictureError`] if the picture does not fit the format.
pub fn encode_with(picture: &Picture, format: Format, style: &Style) -> Result<Vec<u8>, PictureError> {
    encode_as(picture, format, style)
        .map_err(|reason| PictureError::Format { path: "picture".into(), reason })
}

/// Writes under a temporary name in the same folder, then renames: under the name `path` there is
/// always a whole file, the old one or the new one.
///
/// # Errors
/// [`PictureError`] if the extension is unknown or the file can't be written.
pub fn save(picture: &Picture, path: &Path, preview: Preview) -> Result<(), PictureError> {
    save_with(picture, path, &Style { preview, ..Style::default() })
}

/// [`save`] in a style.
///
/// # Errors
/// As for [`save`].
pub fn save_with(picture: &Picture, path: &Path, style: &Style) -> Result<(), PictureError> {
    let refuse = |reason: String| PictureError::Format { path: path.into(), reason };
    let format = Format::from_path(path)
        .ok_or_else(|| refuse("unknown kind of picture; the name has to end in .exr, .hdr or .png".into()))?;
    let bytes = encode_as(picture, format, style).map_err(refuse)?;
    write_whole(path, &bytes).map_err(|source| PictureError::Io { path: path.into(), source })
}

/// Writes the bytes of any file as [`save`] does: under its name there is always a whole file. What is no file, as
/// `/dev/stdout`, is written into; nothing takes its place.
///
/// # Errors
/// What the system says.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = temporary_in(folder)?;
    file.write_all(bytes)?;
    // Without it a crash of the machine can leave the new name with no content.
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

/// Readable by everyone whom the umask allows, as files are by default and temporary files are not.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile<File>> {
    #[cfg(unix)]
    {
        use std::{fs::Permissions, os::unix::fs::PermissionsExt};
        tempfile::Builder::new().permissions(Permissions::from_mode(0o644)).tempfile_in(folder)
    }
    #[cfg(not(unix))]
    NamedTempFile::new_in(folder)
}

fn encode_as(picture: &Picture, format: Format, style: &Style) -> Result<Vec<u8>, String> {
    check(picture)?;
    match format {
        Format::Exr => openexr::encode(picture, &style.exr),
        Format::Hdr => encode_hdr(picture),
        Format::Png => encode_png(picture, style.preview),
    }
}

/// Whether a picture of this size, with channels of these names, could be written: what is rendered for hours should
/// not be refused in the end.
///
/// # Errors
/// Why not, in words.
pub fn check_layout(width: u32, height: u32, names: &[&str]) -> Result<(), String> {
    limits::check(width.into(), height.into(), names.len() as u64)?;
    if names.is_empty() {
        return Err("the picture has no channels".into());
    }
    match names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        Some((_, name)) => Err(format!("two channels are called {name}")),
        None => Ok(()),
    }
}

fn check(picture: &Picture) -> Result<(), String> {
    let names: Vec<&str> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
    check_layout(picture.width, picture.height, &names)?;
    let pixels = picture.width as usize * picture.height as usize;
    for channel in &picture.channels {
        if channel.samples.len() != pixels {
            return Err(format!(
                "channel {} has {} samples for {pixels} pixels",
                channel.name,
                channel.samples.len()
            ));
        }
    }
    Ok(())
}

/// Radiance RGBE, which holds neither negative numbers nor infinities: both are clamped.
fn encode_hdr(picture: &Picture) -> Result<Vec<u8>, String> {
    const LARGEST: f32 = 8.507_059e37;
    const SMALLEST: f32 = 1.175_494_4e-38;
    let pixels: Vec<Rgb<f32>> = colours(picture, "HDR")?
        .map(|rgb| {
            let rgb = rgb.map(|value| if value > 0.0 { value.min(LARGEST) } else { 0.0 });
            // Below, the exponent would wrap round its byte.
            if rgb.iter().all(|&value| value < SMALLEST) { Rgb([0.0; 3]) } else { Rgb(rgb) }
        })
        .collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, picture.width as usize, picture.height as usize)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The pixels as a PNG has them: 8-bit sRGB, row by row.
///
/// # Errors
/// A sentence, if the picture has no `R G B`.
pub fn to_srgb(picture: &Picture, preview: Preview) -> Result<Vec<[u8; 3]>, String> {
    let scale = libm::exp2f(preview.exposure);
    let shown = |rgb: [f32; 3]| preview.tone.map(rgb.map(|value| value * scale)).map(srgb::to_byte);
    Ok(colours(picture, "PNG")?.map(shown).collect())
}

fn encode_png(picture: &Picture, preview: Preview) -> Result<Vec<u8>, String> {
    let pixels = to_srgb(picture, preview)?.into_flattened();
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&pixels, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The pixels of a picture that has `R G B`, or `Y`, which is grey.
fn colours<'a>(picture: &'a Picture, kind: &str) -> Result<impl Iterator<Item = [f32; 3]> + 'a, String> {
    let plane = |name| {
        picture.plane(name).or_else(|| picture.plane("Y")).ok_or_else(|| {
            let names: Vec<&str> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
            format!("{kind} files hold R, G, B, the picture has {}; write it as .exr", names.join(", "))
        })
    };
    let (r, g, b) = (plane("R")?, plane("G")?, plane("B")?);
    Ok(r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Channel, Encoding, decode};

    fn picture(width: u32, height: u32, value: impl Fn(usize) -> f32) -> Picture {
        let pixels = (width * height) as usize;
        let plane = |k: usize| (0..pixels).map(|i| value(3 * i + k)).collect();
        let channels = ["R", "G", "B"].into_iter().enumerate();
        let channels = channels.map(|(k, name)| Channel { name: name.into(), samples: plane(k) });
        Picture { width, height, channels: channels.collect(), place: None }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn bytes_survive_a_png() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let original = picture(16, 16, |i| srgb::BYTE_TO_LINEAR[i % 256]);
        save(&original, &path, Preview::default()).unwrap();
        assert_eq!(decode(&path, Encoding::Srgb).unwrap(), original);
    }

    #[test]
    fn a_stop_doubles() {
        let stop = Preview { exposure: 1.0, ..Preview::default() };
        let dark = encode(&picture(1, 1, |_| 0.25), Format::Png, stop).unwrap();
        assert_eq!(dark, encode(&picture(1, 1, |_| 0.5), Format::Png, Preview::default()).unwrap());
        let nothing = encode(&picture(1, 1, |_| f32::NAN), Format::Png, stop).unwrap();
        assert_eq!(nothing, encode(&picture(1, 1, |_| 0.0), Format::Png, stop).unwrap());
    }

    #[test]
    fn hdr_keeps_eight_bits_of_the_brightest_colour() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        let original = picture(16, 3, |i| (i as f32 - 20.0).exp2());
        save(&original, &path, Preview::default()).unwrap();
        let back = decode(&path, Encoding::Srgb).unwrap();
        for i in 0..48 {
            let brightest = original.channels[2].samples[i];
            for (a, b) in original.channels.iter().zip(&back.channels) {
                assert!((a.samples[i] - b.samples[i]).abs() <= brightest / 128.0);
            }
        }
    }

    #[test]
    fn hdr_clamps_what_it_cannot_hold() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        for (value, low, high) in [
            (f32::NAN, 0.0, 0.0),
            (-1.0, 0.0, 0.0),
            (1e-42, 0.0, 0.0),
            (f32::INFINITY, 1e37, 1e38),
            (f32::MAX, 1e37, 1e38),
        ] {
            save(&picture(1, 1, |_| value), &path, Preview::default()).unwrap();
            let back = decode(&path, Encoding::Raw).unwrap().channels[0].samples[0];
            assert!((low..=high).contains(&back), "{value} came back as {back}");
        }
    }

    #[test]
    fn aovs_go_to_exr_only() {
        let mut aov = picture(2, 2, |i| i as f32);
        aov.channels[0].name = "dd.T".into();
        for format in [Format::Png, Format::Hdr] {
            let error = encode(&aov, format, Preview::default()).unwrap_err().to_string();
            assert!(error.contains("dd.T, G, B; write it as .exr"), "{error}");
        }
        assert!(encode(&aov, Format::Exr, Preview::default()).is_ok());
    }

    #[test]
    fn pictures_that_contradict_themselves_are_refused() {
        let mut short = picture(2, 2, |_| 0.0);
        short.channels[1].samples.pop();
        let mut twice = picture(2, 2, |_| 0.0);
        twice.channels[1].name = "R".into();
        for wrong in [short, twice, Picture::default(), picture(0, 1, |_| 0.0)] {
            for format in [Format::Exr, Format::Hdr, Format::Png] {
                assert!(encode(&wrong, format, Preview::default()).is_err());
            }
        }
    }

    #[test]
    fn saving_replaces_the_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.EXR");
        for value in [1.0, 2.0] {
            save(&picture(1, 1, |_| value), &path, Preview::default()).unwrap();
            assert_eq!(decode(&path, Encoding::Raw).unwrap().channels[0].samples, [value]);
        }
        assert_eq!(names(folder.path()), ["a.EXR"]);
    }

    /// The old file is never written to, so whoever dies while saving leaves all of it.
    #[test]
    fn saving_puts_another_file_in_the_place_of_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let (path, same) = (folder.path().join("a.exr"), folder.path().join("same.exr"));
        save(&picture(1, 1, |_| 1.0), &path, Preview::default()).unwrap();
        fs::hard_link(&path, &same).unwrap();
        save(&picture(1, 1, |_| 2.0), &path, Preview::default()).unwrap();
        let first = |path| decode(path, Encoding::Raw).unwrap().channels[0].samples[0];
        assert_eq!((first(&path), first(&same)), (2.0, 1.0));
    }

    #[test]
    fn a_failed_save_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let picture = picture(1, 1, |_| 1.0);
        let error = save(&picture, &folder.path().join("a.gif"), Preview::default()).unwrap_err();
        assert!(error.to_string().ends_with("has to end in .exr, .hdr or .png"), "{error}");
        assert!(save(&picture, &folder.path().join("no/such/a.png"), Preview::default()).is_err());
        // A folder stands where the file should go: writing succeeds, renaming fails.
        fs::create_dir(folder.path().join("b.png")).unwrap();
        assert!(save(&picture, &folder.path().join("b.png"), Preview::default()).is_err());
        assert_eq!(names(folder.path()), ["b.png"]);
    }

    /// By a link, so that no device is lost if something took its place after all.
    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_into() {
        let folder = tempfile::tempdir().unwrap();
        let (full, null) = (folder.path().join("full.exr"), folder.path().join("null.exr"));
        std::os::unix::fs::symlink("/dev/full", &full).unwrap();
        std::os::unix::fs::symlink("/dev/null", &null).unwrap();
        let picture = picture(1, 1, |_| 1.0);
        let told = save(&picture, &full, Preview::default()).unwrap_err().to_string();
        assert!(told.contains("No space left"), "{told}");
        save(&picture, &null, Preview::default()).unwrap();
        assert!(full.is_symlink() && null.is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn saved_files_are_as_readable_as_others() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        save(&picture(1, 1, |_| 1.0), &path, Preview::default()).unwrap();
        fs::write(folder.path().join("other"), "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&folder.path().join("other")));
    }
}
