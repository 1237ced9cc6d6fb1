//! How a picture is written: for every command that writes one.

use clap::{Args, ValueEnum};

use super::{
    failure::warn_of,
    metadata::{About, Metadata},
};
use crate::picture::{ExrCompression, ExrStyle, Format, Preview, Style, Tone};

const FILE: &str = "File";

/// The options.
#[derive(Clone, Debug, Args)]
pub(super) struct StyleOptions {
    /// Stops by which a .png is brightened; none if not given
    #[arg(long, value_name = "STOPS", help_heading = FILE, allow_negative_numbers = true, value_parser = stops)]
    exposure: Option<f32>,

    /// What becomes of light that is too bright for a .png; `none` if not given
    #[arg(long, value_name = "NAME", help_heading = FILE)]
    tonemap: Option<ToneName>,

    /// Numbers of the colours in an .exr; depth, positions and ids keep 32 bits
    #[arg(long, value_name = "TYPE", help_heading = FILE, default_value = "float")]
    exr_type: ExrType,

    /// Compression of an .exr; none of them loses anything
    #[arg(long, value_name = "NAME", help_heading = FILE, default_value = "zip")]
    exr_compression: CompressionName,

    /// What an .exr says of its making
    #[arg(long, value_name = "HOW-MUCH", help_heading = FILE, default_value = "picture")]
    metadata: Metadata,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ToneName {
    /// White, colour by colour
    None,
    /// The curve of the Academy's screens, in Hill's fit
    Aces,
    /// Bright colours go to white and keep their hue
    Agx,
    /// x / (1 + x) of the luminance
    Reinhard,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum ExrType {
    /// 32 bits
    Float,
    /// 16 bits
    Half,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum CompressionName {
    /// Not at all
    None,
    /// Runs of equal bytes
    Rle,
    /// Deflate, row by row
    Zips,
    /// Deflate, sixteen rows at a time
    Zip,
    /// Wavelets
    Piz,
}

impl StyleOptions {
    /// A style for a picture of which this is to be said.
    pub(super) fn style(&self, about: &About<'_>) -> Style {
        let tone = match self.tonemap {
            None | Some(ToneName::None) => Tone::Clip,
            Some(ToneName::Aces) => Tone::Aces,
            Some(ToneName::Agx) => Tone::Agx,
            Some(ToneName::Reinhard) => Tone::Reinhard,
        };
        let compression = match self.exr_compression {
            CompressionName::None => ExrCompression::None,
            CompressionName::Rle => ExrCompression::Rle,
            CompressionName::Zips => ExrCompression::Zips,
            CompressionName::Zip => ExrCompression::Zip,
            CompressionName::Piz => ExrCompression::Piz,
        };
        Style {
            preview: Preview { exposure: self.exposure.unwrap_or(0.0), tone },
            exr: ExrStyle {
                half: self.exr_type == ExrType::Half,
                compression,
                attributes: about.attributes(self.metadata),
            },
        }
    }

    /// Warns of options that do nothing to a file of this format.
    pub(super) fn warn_of_idle(&self, format: Format) {
        let for_png = [("--exposure", self.exposure.is_some()), ("--tonemap", self.tonemap.is_some())];
        let for_exr = [
            ("--exr-type", self.exr_type != ExrType::Float),
            ("--exr-compression", self.exr_compression != CompressionName::Zip),
            ("--metadata", self.metadata != Metadata::Picture),
        ];
        let first =
            |options: &[(&'static str, bool)]| options.iter().find(|option| option.1).map(|option| option.0);
        if let Some(option) = first(&for_png).filter(|_| format != Format::Png) {
            warn_of(format!("{option} only changes a .png; the numbers of this file stay linear"));
        }
        if let Some(option) = first(&for_exr).filter(|_| format != Format::Exr) {
            warn_of(format!("{option} only changes an .exr"));
        }
    }
}

fn stops(argument: &str) -> Result<f32, String> {
    match argument.parse::<f32>() {
        Ok(stops) if stops.is_finite() => Ok(stops),
        _ => Err("expected a number of stops, as in --exposure -1.5".into()),
    }
}
