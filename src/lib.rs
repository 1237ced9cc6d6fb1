//! # packlight
//!
//! A renderer that traces light in packets of eight rays.
//!
//! ```text
//!  .xml .obj .ply ──load──▶ SceneDescription ──compile──▶ Scene (columns + BVH)
//!                                                            │
//!   ┌──────────────────── render, tile by tile ──────────────┘
//!   ▼
//!  camera ─▶ ray packets ─▶ trace ─▶ hits ─▶ sort by material ─▶ runs ─▶ shade (8 at a time) ─▶ radiance ─▶ film ─▶ picture
//!                ▲                                                 │
//!                └──────────── next rays, shadow rays ─────────────┘
//! ```
//!
//! Modules stand in the order of the floors they are on; a module imports only from floors below its
//! own (`tests/architecture.rs` proves it).

// floor 0
pub mod simd;
// floor 1
pub mod math;
// floor 2
pub mod geometry;
pub mod picture;
pub mod texture;
// floor 3
pub mod bvh;
pub mod camera;
pub mod compare;
pub mod denoise;
pub mod film;
pub mod light;
pub mod material;
// floor 4
pub mod scene;
// floor 5
pub mod compile;
pub mod load;
// floor 6
pub mod render;
// floor 7
pub mod lobe;
pub mod verify;
// roof
pub mod cli;
