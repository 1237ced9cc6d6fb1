//! The blocks of an OpenEXR file: packed beside each other, written one after the other.
//!
//! Packing is most of what a file costs, and what layers beside a picture cost. The order of the blocks in the
//! file is that of their rows, whoever was done first: the same picture gives the same bytes.

use std::io::{Seek, Write};

use exr::{
    block::{
        BlockIndex, UncompressedBlock,
        chunk::{Chunk, CompressedBlock, CompressedScanLineBlock},
        enumerate_ordered_header_block_indices, write,
        writer::ChunksWriter,
    },
    meta::{attribute::SampleType, header::Header},
    prelude::{Compression, Error, f16},
};
use rayon::prelude::*;

use super::exr_zip::Zip;

/// Blocks for each thread that are held packed at a time.
const AHEAD: usize = 8;

/// A channel, row-major, as a file holds it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plane<'p> {
    /// In 16 bits a number.
    Half(&'p [f32]),
    /// In 32.
    Float(&'p [f32]),
}

impl Plane<'_> {
    /// What a header calls it.
    pub(super) fn sample_type(&self) -> SampleType {
        match self {
            Self::Half(_) => SampleType::F16,
            Self::Float(_) => SampleType::F32,
        }
    }
}

/// Writes scan lines, on the current rayon pool. `planes` are the channels of the header in its order.
///
/// # Errors
/// What the crate says of a picture that no file can hold.
pub(super) fn save(header: Header, planes: &[Plane<'_>], file: impl Write + Seek) -> Result<(), Error> {
    write(file, std::iter::once(header).collect(), true, |meta, writer| {
        let headers = &meta.headers;
        let blocks: Vec<_> = enumerate_ordered_header_block_indices(headers).collect();
        for some in blocks.chunks(AHEAD * rayon::current_num_threads()) {
            let pack = |zip: &mut Zip, &(number, at): &(usize, BlockIndex)| {
                Ok((number, pack(at, headers, planes, zip)?))
            };
            let packed: Vec<(usize, Chunk)> =
                some.par_iter().map_init(Zip::default, pack).collect::<Result<_, Error>>()?;
            for (number, chunk) in packed {
                writer.write_chunk(number, chunk)?;
            }
        }
        Ok(())
    })
}

/// A block of scan lines, packed as its header says.
fn pack(index: BlockIndex, headers: &[Header], planes: &[Plane<'_>], zip: &mut Zip) -> Result<Chunk, Error> {
    let header = &headers[index.layer];
    // Bytes are as the processor has them, and in the file little-endian.
    let ours = cfg!(target_endian = "little")
        && matches!(header.compression, Compression::ZIP1 | Compression::ZIP16);
    if !ours {
        let mut data = Vec::new();
        bytes(index, header, planes, &mut data);
        return UncompressedBlock { index, data }.compress_to_chunk(headers);
    }
    let y_coordinate = index.pixel_position.y() as i32 + header.own_attributes.layer_position.y();
    let compressed_pixels_le = zip.pack(|data| bytes(index, header, planes, data));
    let compressed_block =
        CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate, compressed_pixels_le });
    Ok(Chunk { layer_index: index.layer, compressed_block })
}

/// Row by row, and in each channel by channel.
fn bytes(index: BlockIndex, header: &Header, planes: &[Plane<'_>], bytes: &mut Vec<u8>) {
    let (first, size) = (index.pixel_position, index.pixel_size);
    bytes.resize(header.channels.bytes_per_pixel * size.area(), 0);
    let mut rest = bytes.as_mut_slice();
    for y in first.y()..first.y() + size.height() {
        let start = y * header.layer_size.width() + first.x();
        for plane in planes {
            let width = size.width() * plane.sample_type().bytes_per_sample();
            let (place, behind) = rest.split_at_mut(width);
            match *plane {
                Plane::Half(plane) => {
                    let places = place.as_chunks_mut().0.iter_mut();
                    places
                        .zip(&plane[start..][..size.width()])
                        .for_each(|(place, &x)| *place = f16::from_f32(x).to_ne_bytes());
                }
                Plane::Float(plane) => {
                    let places = place.as_chunks_mut().0.iter_mut();
                    places
                        .zip(&plane[start..][..size.width()])
                        .for_each(|(place, x)| *place = x.to_ne_bytes());
                }
            }
            rest = behind;
        }
    }
}
