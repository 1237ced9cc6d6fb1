//! What a reflection model looks like, and whether it is one: plots, numbers, and a certificate.
//!
//! A [`Swatch`] is a material at a point. Its numbers are in `curves`; `portrait` renders its lobe and a
//! lit sphere of it with the renderer itself; `plot` puts both on a page.
//!
//! The only room that names the plotting library.

mod certificate;
mod curves;
mod drawing;
mod page;
mod polar;
mod portrait;
mod roughness;
mod sheet;
mod solid;
mod swatch;

pub use certificate::{Certificate, Row};
pub use curves::{Albedo, Curves, Slice, Spike};
pub use drawing::{Drawing, Ink};
pub use page::{PageOptions, page};
pub use sheet::{Cell, sheet};
pub use swatch::Swatch;
