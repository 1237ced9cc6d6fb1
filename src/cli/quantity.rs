//! Numbers for people.

use std::time::Duration;

/// `1,234,567`.
pub(super) fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `12.345 M`, and `1,234` where that would be little but noughts.
pub(super) fn mega(n: u64) -> String {
    if n < 10_000 { grouped(n) } else { format!("{:.3} M", n as f64 * 1e-6) }
}

/// `1 light`, `2 lights`.
pub(super) fn counted(n: impl Into<u64>, noun: &str) -> String {
    let n = n.into();
    format!("{} {noun}{}", grouped(n), if n == 1 { "" } else { "s" })
}

/// `850 µs`, `12.5 ms`, `3.27 s`, `4 min 05 s`.
pub(super) fn time(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    match seconds {
        s if s < 1e-3 => format!("{:.0} µs", s * 1e6),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s if s < 60.0 => format!("{s:.2} s"),
        _ => format!("{} min {:02} s", duration.as_secs() / 60, duration.as_secs() % 60),
    }
}

/// `850 bytes`, `4.2 KiB`, `12.0 MiB`, `3.3 GiB`.
pub(super) fn memory(bytes: u64) -> String {
    let of = |power: u32| bytes as f64 / 1024f64.powi(power as i32);
    match bytes.checked_ilog2().unwrap_or(0) / 10 {
        0 => counted(bytes, "byte"),
        1 => format!("{:.1} KiB", of(1)),
        2 => format!("{:.1} MiB", of(2)),
        _ => format!("{:.1} GiB", of(3)),
    }
}

/// Millions a second; 0 where no time passed.
pub(super) fn mega_per_second(n: u64, time: Duration) -> f64 {
    if time.is_zero() { 0.0 } else { n as f64 * 1e-6 / time.as_secs_f64() }
}

/// Five digits that count, with a power of ten only where there would be many noughts.
pub(super) fn significant(x: f64) -> String {
    let power = if x == 0.0 { 0.0 } else { x.abs().log10().floor() };
    if !x.is_finite() || !(-4.0..6.0).contains(&power) {
        return format!("{x:.4e}");
    }
    let places = (4.0 - power).max(0.0) as usize;
    format!("{x:.places$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_set_apart() {
        for (n, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")] {
            assert_eq!(grouped(n), text);
        }
    }

    #[test]
    fn few_are_not_told_in_millions() {
        for (n, text) in [(0, "0"), (9_999, "9,999"), (10_000, "0.010 M"), (12_345_678, "12.346 M")] {
            assert_eq!(mega(n), text);
        }
    }

    #[test]
    fn five_digits_count() {
        for (x, text) in [
            (0.0, "0.0000"),
            (1.147_496, "1.1475"),
            (-0.002_898_577, "-0.0028986"),
            (123_456.7, "123457"),
            (2.5e-9, "2.5000e-9"),
            (3e30, "3.0000e30"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(significant(x), text);
        }
    }

    #[test]
    fn one_is_singular() {
        assert_eq!(counted(1_u32, "light"), "1 light");
        assert_eq!(counted(0_u32, "light"), "0 lights");
    }

    #[test]
    fn times_are_read_in_their_own_unit() {
        for (millis, text) in [(0.85, "850 µs"), (12.5, "12.5 ms"), (3270.0, "3.27 s"), (245e3, "4 min 05 s")]
        {
            assert_eq!(time(Duration::from_secs_f64(millis * 1e-3)), text);
        }
    }

    #[test]
    fn bytes_are_read_in_their_own_unit() {
        for (bytes, text) in [
            (0, "0 bytes"),
            (1023, "1,023 bytes"),
            (1536, "1.5 KiB"),
            (3 << 20, "3.0 MiB"),
            (5 << 30, "5.0 GiB"),
        ] {
            assert_eq!(memory(bytes), text);
        }
    }

    #[test]
    fn no_time_is_no_rate() {
        assert_eq!(mega_per_second(5, Duration::ZERO), 0.0);
        assert_eq!(mega_per_second(3_000_000, Duration::from_secs(2)), 1.5);
    }
}
