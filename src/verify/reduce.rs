//! The least of a list that still shows a fault: delta debugging \[ZH02\].

/// Leaves out parts for as long as `shows` is true of the rest, in at most `tries` trials: halves first, then
/// smaller parts, in the end single ones.
pub(super) fn smallest<T: Clone>(
    items: Vec<T>,
    mut tries: usize,
    mut shows: impl FnMut(&[T]) -> bool,
) -> Vec<T> {
    let mut rest = items;
    let mut parts = 2;
    while rest.len() > 1 && tries > 0 {
        let size = rest.len().div_ceil(parts);
        let mut first = 0;
        let mut less = false;
        while first < rest.len() && rest.len() > 1 && tries > 0 {
            tries -= 1;
            let last = rest.len().min(first + size);
            let without: Vec<T> = rest[..first].iter().chain(&rest[last..]).cloned().collect();
            if !without.is_empty() && shows(&without) {
                rest = without;
                less = true;
            } else {
                first = last;
            }
        }
        if size == 1 && !less {
            break;
        }
        parts = if less { parts.min(rest.len()) } else { parts * 2 }.clamp(2, rest.len().max(2));
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_needed_stays_and_nothing_else() {
        for needed in [vec![17], vec![0, 999], vec![3, 4, 500]] {
            let shows = |items: &[usize]| needed.iter().all(|needed| items.contains(needed));
            assert_eq!(smallest((0..1000).collect(), 1000, shows), needed);
        }
    }

    #[test]
    fn trials_are_counted() {
        let mut trials = 0;
        let rest = smallest((0..1000).collect(), 3, |items: &[usize]| {
            trials += 1;
            items.contains(&7)
        });
        assert_eq!(trials, 3);
        assert!(rest.contains(&7) && rest.len() < 1000);
    }
}
