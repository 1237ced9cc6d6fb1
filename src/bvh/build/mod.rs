//! From references to a tree.
//!
//! By one of three qualities ([`Quality`]): a binary tree, by binned SAH \[Wal07\] (`binned`, and `sweep`
//! near the leaves) or along the Morton curve \[LGS09\] (`morton`), optimised by reinsertion \[MB18\]
//! (`reinsert`); then collapsed to eight children by dynamic programming \[YKL17\] (`weigh` decides,
//! `collapse` lays out).

mod binary;
mod binned;
mod bins;
mod bounds;
mod collapse;
mod links;
mod morton;
mod partition;
mod quality;
mod reference;
mod reinsert;
mod splits;
mod sweep;
mod weigh;

pub use binned::MAX_LEAF;
pub use quality::Quality;
pub use reference::Reference;
