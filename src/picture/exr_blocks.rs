//! The blocks of an OpenEXR file: packed beside each other, written one after the other.
//!
//! Packing is most of what a file costs, and what layers beside a picture cost. The order of the blocks in the
//! file is that of their rows, whoever was done first: the same picture gives the same bytes.

use std::io::{Seek, Write};

use exr::{
    block::{
        UncompressedBlock,
        chunk::{Chunk, CompressedBlock, CompressedScanLineBlock},
        write,
        writer::ChunksWriter,
    },
    image::write::layers::{LayersWriter, WritableLayers},
    meta::header::Header,
    prelude::{AnyChannels, Compression, Error, FlatSamples, Image, Layer},
};
use rayon::prelude::*;

use super::exr_zip;

/// Blocks for each thread that are held unpacked at a time.
const AHEAD: usize = 2;

/// Writes an image, on the current rayon pool.
///
/// # Errors
/// What the crate says of an image that no file can hold.
pub(super) fn save(
    image: &Image<Layer<AnyChannels<FlatSamples>>>,
    file: impl Write + Seek,
) -> Result<(), Error> {
    let headers = image.layer_data.infer_headers(&image.attributes);
    let layers = image.layer_data.create_writer(&headers);
    write(file, headers, true, |meta, writer| {
        let headers = &meta.headers;
        let mut blocks = meta.collect_ordered_block_data(|at| layers.extract_uncompressed_block(headers, at));
        loop {
            let some: Vec<_> = blocks.by_ref().take(AHEAD * rayon::current_num_threads()).collect();
            if some.is_empty() {
                return Ok(());
            }
            let pack = |(number, block)| Ok((number, pack(block, headers)?));
            let packed: Vec<(usize, Chunk)> = some.into_par_iter().map(pack).collect::<Result<_, Error>>()?;
            for (number, chunk) in packed {
                writer.write_chunk(number, chunk)?;
            }
        }
    })
}

/// A block of scan lines, packed as its header says.
fn pack(block: UncompressedBlock, headers: &[Header]) -> Result<Chunk, Error> {
    let index = block.index;
    let header = &headers[index.layer];
    // Bytes are as the processor has them, and in the file little-endian.
    let ours = cfg!(target_endian = "little")
        && matches!(header.compression, Compression::ZIP1 | Compression::ZIP16);
    if !ours {
        return block.compress_to_chunk(headers);
    }
    let y_coordinate = index.pixel_position.y() as i32 + header.own_attributes.layer_position.y();
    let compressed_pixels_le = exr_zip::pack(&block.data).unwrap_or(block.data);
    let compressed_block =
        CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate, compressed_pixels_le });
    Ok(Chunk { layer_index: index.layer, compressed_block })
}
