//! How large a picture may be: what a header claims is believed only up to here, and nothing larger is written.

/// Columns, and rows.
pub(super) const MAX_SIDE: u64 = 1 << 16;
/// Pixels.
const MAX_PIXELS: u64 = 512 << 20;
/// Floats over all channels of a file: 8 GiB.
const MAX_SAMPLES: u64 = 2 << 30;

/// Refuses empty and absurd sizes.
pub(super) fn check(width: u64, height: u64, channels: u64) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err(format!("the picture is empty ({width} × {height} pixels)"));
    }
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("{width} × {height} pixels: a side has at most {MAX_SIDE}"));
    }
    if width * height > MAX_PIXELS || (width * height).saturating_mul(channels) > MAX_SAMPLES {
        return Err(format!("{width} × {height} pixels with {channels} channels are too many"));
    }
    Ok(())
}

/// What a file grows by at most when it is unpacked: deflate by 1032, and PXR24 by a third more; runs of all kinds by
/// less.
const MAX_EXPANSION: u64 = 2048;
/// Bytes of a picture that no file is too small for.
const SMALL: u64 = 1 << 20;

/// Refuses a size of so many bytes that the file can't hold it.
pub(super) fn check_expansion((width, height): (u64, u64), unpacked: u64, file: usize) -> Result<(), String> {
    match unpacked > SMALL.max((file as u64).saturating_mul(MAX_EXPANSION)) {
        true => Err(format!("it announces {width} × {height} pixels, more than its {file} bytes can hold")),
        false => Ok(()),
    }
}
