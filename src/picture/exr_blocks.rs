//! The blocks of an OpenEXR file: packed beside each other, written one after the other.
//!
//! Packing is most of what a file costs, and what layers beside a picture cost. The order of the blocks in the
//! file is that of their rows, whoever was done first: the same picture gives the same bytes.

use std::io::{Seek, Write};

use exr::{
    block::{chunk::Chunk, write, writer::ChunksWriter},
    image::write::layers::{LayersWriter, WritableLayers},
    prelude::{AnyChannels, Error, FlatSamples, Image, Layer},
};
use rayon::prelude::*;

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
            let pack = |(number, block): (usize, exr::block::UncompressedBlock)| {
                Ok((number, block.compress_to_chunk(headers)?))
            };
            let packed: Vec<(usize, Chunk)> = some.into_par_iter().map(pack).collect::<Result<_, Error>>()?;
            for (number, chunk) in packed {
                writer.write_chunk(number, chunk)?;
            }
        }
    })
}
