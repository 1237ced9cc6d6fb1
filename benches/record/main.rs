//! The record: how fast packlight is on this machine, written down where everyone can see it.
//!
//! `cargo bench --bench record` measures all of it; `-- --help` says how to measure a part. What is in the
//! file is said in benches/record/README.md.

mod book;
mod compared;
mod date;
mod fit;
mod floors;
mod growth;
mod machine;
mod options;
mod peers;
mod plot;
mod row;
mod run;
mod scenes;
mod tables;
mod traced;

use std::{path::Path, process::ExitCode};

use clap::Parser;

use book::Book;
use options::{Extent, Options};
use run::Run;

const PICTURE: &str = "growth.svg";

fn main() -> ExitCode {
    let options = Options::parse();
    if !options.is_meant() {
        return ExitCode::SUCCESS;
    }
    match make(options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("record: {message}");
            ExitCode::FAILURE
        }
    }
}

fn make(options: Options) -> Result<(), String> {
    let scratch = tempfile::tempdir().map_err(|error| error.to_string())?;
    let extent = options.extent();
    let folder = extent.folder(scratch.path());
    if options.tables {
        let book = options.into.as_deref().map_or_else(|| Book::newest(&folder), Book::open)?;
        return publish(&book);
    }
    let mut run = Run::open(options, extent, folder)?;
    growth::measure(&mut run)?;
    scenes::measure(&mut run)?;
    peers::measure(&mut run)?;
    publish(&run.book)?;
    if extent == Extent::Smoke { works(&run.book) } else { stands(&run.book) }
}

/// Prints the tables and draws the picture.
fn publish(book: &Book) -> Result<(), String> {
    print!("{}", tables::all(book.rows()));
    let picture = book.path().parent().unwrap_or(Path::new("")).join(PICTURE);
    let drawn = plot::draw(book.rows(), &picture)?;
    println!("\n{} rows in {}", book.rows().len(), book.path().display());
    if drawn {
        println!("drawn: {}", picture.display());
    }
    Ok(())
}

/// A record is only worth keeping if every way gives the same answers and nodes grow like log N.
fn stands(book: &Book) -> Result<(), String> {
    let disagree = book.rows().iter().filter(|row| row.agrees == Some(false));
    let disagree = disagree.map(|row| format!("{}, {}: {} disagrees", row.scene, row.class, row.beside));
    let found: Vec<String> = disagree.chain(tables::unfounded(book.rows())).collect();
    if found.is_empty() { Ok(()) } else { Err(found.join("\n")) }
}

/// What the tiny run must have left behind.
fn works(book: &Book) -> Result<(), String> {
    let again = Book::open(book.path())?;
    if again.rows() != book.rows() || book.rows().is_empty() {
        return Err("the file does not hold what was measured".into());
    }
    let picture = book.path().with_file_name(PICTURE);
    let picture = std::fs::read_to_string(&picture).map_err(|error| error.to_string())?;
    if growth::KINDS.iter().any(|kind| !picture.contains(&format!("gen:{kind}"))) {
        return Err("the picture does not name the meshes".into());
    }
    if again.rows().iter().any(|row| row.agrees == Some(false)) {
        return Err("packets and single rays differ".into());
    }
    Ok(())
}
