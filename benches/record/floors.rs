//! What the ratios to Embree should at least be.

/// The floors of a class: of each scene, and of the geometric mean over all scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floors {
    pub(crate) each: f64,
    pub(crate) mean: f64,
}

const ON_ONE_THREAD: [(&str, Floors); 5] = [
    ("primary", Floors { each: 1.5, mean: 2.0 }),
    ("shadow", Floors { each: 1.0, mean: 1.4 }),
    ("ao", Floors { each: 1.05, mean: 1.35 }),
    ("diffuse", Floors { each: 1.05, mean: 1.3 }),
    ("diffuse2", Floors { each: 1.2, mean: 1.5 }),
];
/// Of the floors on one thread, with two on either side.
const ON_TWO_THREADS: Floors = Floors { each: 0.9, mean: 0.95 };
/// Builds at default quality on two threads, against Embree's medium one.
const BUILD_ON_TWO_THREADS: Floors = Floors { each: 0.8, mean: 1.2 };

impl Floors {
    /// Those of a class of rays, or of [`BUILD`](crate::row::BUILD); nothing was promised for the rest.
    pub(crate) fn of(class: &str, threads: usize) -> Option<Self> {
        if (class, threads) == (crate::row::BUILD, 2) {
            return Some(BUILD_ON_TWO_THREADS);
        }
        let (_, Self { each, mean }) = ON_ONE_THREAD.into_iter().find(|(name, _)| *name == class)?;
        match threads {
            1 => Some(Self { each, mean }),
            2 => Some(Self { each: each * ON_TWO_THREADS.each, mean: mean * ON_TWO_THREADS.mean }),
            _ => None,
        }
    }
}
