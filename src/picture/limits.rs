//! How large a picture may be: what a header claims is believed only up to here.

/// Columns, and rows.
pub(super) const MAX_SIDE: u64 = 1 << 15;
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
        return Err(format!("{width} × {height} pixels: at most {MAX_SIDE} a side can be read"));
    }
    if width * height > MAX_PIXELS || (width * height).saturating_mul(channels) > MAX_SAMPLES {
        return Err(format!("{width} × {height} pixels with {channels} channels are too many"));
    }
    Ok(())
}
