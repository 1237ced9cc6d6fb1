//! What the program says to the shell. `packlight --help` documents it.

/// What was asked for was done.
pub const SUCCESS: u8 = 0;
/// A file could not be read, understood or written, or a model or scene failed its check.
pub const FAILURE: u8 = 1;
/// The command line was not understood.
pub const USAGE: u8 = 2;
/// The processor lacks instructions that the program was compiled to use.
pub const CPU: u8 = 3;
/// A signal stopped it before it was done; what was there was written.
pub const STOPPED: u8 = 4;
