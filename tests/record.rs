//! The parts of `cargo bench --bench record` that measure nothing: its file, its dates, its fits, and what it
//! reads of other programs. Benches have no test harness of their own.

#![allow(missing_docs)]
#![allow(dead_code)] // The bench uses the rest.

#[path = "../benches/record/book.rs"]
mod book;
#[path = "../benches/record/compared.rs"]
mod compared;
#[path = "../benches/record/date.rs"]
mod date;
#[path = "../benches/record/fit.rs"]
mod fit;
#[path = "../benches/record/machine.rs"]
mod machine;
#[path = "../benches/record/row.rs"]
mod row;

use std::fs;

use book::Book;
use compared::{Class, Compared};
use fit::{Fit, Growth};
use machine::Machine;
use row::{Row, Table};

fn row(scene: &str, rate: f64) -> Row {
    let machine = Machine { cpu: "a cpu".into(), lanes: "avx2", commit: "abc".into() };
    let mut row = Row::new("2026-11-22", &machine, 1, Table::Peers, scene, "ao");
    row.mega_per_s = Some(rate);
    row.agrees = Some(true);
    row
}

#[test]
fn a_record_is_made_in_pieces() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("deep/2026-11-22-a-cpu.csv");
    let mut book = Book::open(&path).expect("an empty book");
    book.take(row("a", 1.0)).expect("writable");
    book.take(row("b", 2.0)).expect("writable");
    let mut again = Book::open(&path).expect("readable");
    assert_eq!(again.rows(), book.rows());
    again.take(row("a", 3.5)).expect("writable");
    let last = Book::newest(&folder.path().join("deep")).expect("there is one");
    assert_eq!(last.rows(), [row("a", 3.5), row("b", 2.0)]);
    assert!(fs::read_to_string(&path).expect("a file").starts_with("# Made by"));
}

#[test]
fn a_file_that_is_no_record_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    fs::write(&path, "date,commit\n2026,a\n").expect("writable");
    assert!(Book::open(&path).expect_err("columns are missing").contains("a.csv"));
    assert!(Book::newest(&folder.path().join("none")).expect_err("no folder").contains("no record"));
}

#[test]
fn quantities_keep_four_digits() {
    assert_eq!(row::rounded(1.234_56), Some(1.235));
    assert_eq!(row::rounded(98_765.4), Some(98_770.0));
    assert_eq!(row::rounded(0.0), Some(0.0));
    assert_eq!(row::rounded(f64::NAN), None);
}

#[test]
fn days_are_counted_through_leap_years() {
    for (days, date) in [
        (0, "1970-01-01"),
        (58, "1970-02-28"),
        (59, "1970-03-01"),
        (364, "1970-12-31"),
        (789, "1972-02-29"),
        (790, "1972-03-01"),
        (11_016, "2000-02-29"),
        (20_779, "2026-11-22"),
        (47_540, "2100-02-28"),
        (47_541, "2100-03-01"),
    ] {
        assert_eq!(date::iso(days), date);
    }
}

#[test]
fn a_processor_has_a_short_name() {
    for (model, expected) in [
        ("AMD EPYC 9654 96-Core Processor", "AMD EPYC 9654"),
        ("Intel(R) Xeon(R) Platinum 8375C CPU @ 2.90GHz", "Intel Xeon Platinum 8375C"),
        ("AMD EPYC", "AMD EPYC family 25 model 17"),
    ] {
        let text =
            format!("processor\t: 0\ncpu family\t: 25\nmodel\t\t: 17\nmodel name\t: {model}\nmodel\t: 9\n");
        assert_eq!(machine::name(&text).as_deref(), Some(expected));
    }
    assert_eq!(machine::name("Hardware : a board\n"), None);
    assert_eq!(machine::name("model name :\n"), None);
}

#[test]
fn a_slug_is_fit_for_a_file() {
    assert_eq!(machine::slug("Intel Core i7/9750H"), "intel-core-i7-9750h");
    assert_eq!(machine::slug("x86_64"), "x86-64");
}

fn fit(nodes: impl Fn(f64) -> f64) -> Fit {
    let points: Vec<_> = (3..=7).map(|i| 10f64.powi(i)).map(|n| (n, nodes(n))).collect();
    Fit::of(&points).expect("five points")
}

#[test]
fn a_logarithm_is_a_straight_line() {
    let fit = fit(|n| 1.5 + 0.5 * n.log2());
    assert!((fit.a - 1.5).abs() < 1e-9 && (fit.b - 0.5).abs() < 1e-9, "{fit:?}");
    assert!((fit.r2 - 1.0).abs() < 1e-9 && (fit.last_step - 1.0).abs() < 1e-9, "{fit:?}");
    assert_eq!(fit.growth(), Growth::Logarithm);
}

#[test]
fn roots_are_not_taken_for_logarithms() {
    for exponent in [0.15, 0.2, 1.0 / 3.0, 0.5] {
        let fit = fit(|n| n.powf(exponent));
        assert_eq!(fit.growth(), Growth::Power, "{exponent}: {fit:?}");
        assert!((fit.exponent - exponent).abs() < 1e-9, "{exponent}: {fit:?}");
    }
    assert!((fit(|n| n.powf(0.2)).last_step - 1.75).abs() < 0.01);
    assert!((fit(|n| n.powf(1.0 / 3.0)).last_step - 2.25).abs() < 0.01);
}

#[test]
fn a_line_that_bends_is_no_power() {
    // Camera rays at a sphereflake.
    let points = [(320.0, 3.02), (9_920.0, 3.3), (99_200.0, 3.9), (1_049_600.0, 4.57), (9_996_800.0, 5.46)];
    let fit = Fit::of(&points).expect("five points");
    assert_eq!(fit.growth(), Growth::Bent, "{fit:?}");
}

#[test]
fn three_points_say_nothing() {
    assert_eq!(Fit::of(&[(1.0, 1.0), (2.0, 2.0), (4.0, 3.0)]), None);
    assert!(Fit::of(&[(1.0, 1.0), (2.0, 2.0), (4.0, 3.0), (8.0, 4.0)]).is_some());
}

const SAID: &str = "\
Embree: AVX512; 69451 triangles, 2 thread(s)
class         ours   embree  ratio  mode             robust  ratio  hits off t_sum off result
primary     24.000   16.000  1.500  medium 16-coh    15.300  1.569     0.0e0     1.1e-9 agrees
ao           2.828    4.376  0.646  high 8-inc        3.300  0.857     2.0e-3     0.0e0 DISAGREES
built: ours 0.123 s, 78.0 bytes/tri
built: embree/medium 0.060 s, 66.8 bytes/tri
";

#[test]
fn a_comparison_is_read() {
    let read = Compared::read(SAID).expect("readable");
    assert_eq!(read.triangles, 69_451);
    let mode = |class: &Class| (class.mode.clone(), class.agrees);
    let modes: Vec<_> = read.classes.iter().map(mode).collect();
    assert_eq!(modes, [("medium 16-coh".to_owned(), true), ("high 8-inc".to_owned(), false)]);
    assert_eq!((read.classes[0].ours, read.classes[0].theirs), (24.0, 16.0));
    assert_eq!(read.build("embree/medium").map(|build| build.bytes_per_triangle), Some(66.8));
    assert_eq!(read.build("ours").map(|build| build.seconds), Some(0.123));
}

#[test]
fn what_is_not_understood_is_told() {
    assert!(Compared::read(&SAID.replace("agrees", "perhaps")).is_err());
    assert!(Compared::read(&SAID.replace("bytes/tri", "octets")).is_err());
    assert!(Compared::read("").expect_err("nothing said").contains("everything"));
}
