//! The program: CPU guard, then the command line.

fn main() {}
