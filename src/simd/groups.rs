//! Lanes that are shared out in groups: each ray of several has so many of them.

use super::{Mask, Real, f32x8, f32x16, opaque::opaque, u32x8};

/// `N` groups of lanes, one after the other.
pub trait Groups<const N: usize>: Real {
    /// Lanes in a group.
    const WIDTH: usize = Self::LANES / N;

    /// A group's lanes are those of its row from a place on, which leaves enough of them: at most 8 − [`WIDTH`](Self::WIDTH).
    fn windows(rows: [&[f32; 8]; N], from: [usize; N]) -> Self;

    /// The same of words, as they are.
    fn word_windows(rows: [&[u32; 8]; N], from: [usize; N]) -> Self;

    /// The first four lanes of each group.
    fn fours(self) -> [[f32; 4]; N];

    /// Groups whose first four lanes these are; what the others are is not said.
    fn of_fours(fours: [[f32; 4]; N]) -> Self;

    /// Four numbers for each group, each in all lanes of its group.
    fn splats(numbers: [[f32; 4]; N]) -> [Self; 4];

    /// `f` of a lane and all others of its group.
    fn fold(self, f: impl Fn(Self, Self) -> Self) -> Self;

    /// A number for each group, in all its lanes.
    fn splat_each(numbers: [f32; N]) -> Self;

    /// The one lane of each group that is in a set, in all lanes of the group; 0 where there is none.
    #[inline(always)]
    fn shared(self, set: Self::Mask) -> Self {
        self.only(set).fold(|a, b| Self::from_bits(a.to_bits() | b.to_bits()))
    }

    /// Lane k of each group from the k-th of four, for its first four lanes.
    #[inline(always)]
    fn side_by_side([a, b, c, d]: [Self; 4]) -> Self {
        let from =
            |k: usize| Self::Mask::from_bitmask((0..N).fold(0, |set, i| set | 1 << (i * Self::WIDTH + k)));
        Self::select(from(0), a, Self::select(from(1), b, Self::select(from(2), c, d)))
    }
}

/// A row's lanes from a place on.
#[inline(always)]
fn window<T: Copy + Default>(row: &[T; 8], from: usize) -> [T; 4] {
    let from = from.min(4);
    let mut four = [T::default(); 4];
    four.copy_from_slice(&row[from..from + 4]);
    four
}

/// The same of words.
#[inline(always)]
fn word_window(row: &[u32; 8], from: usize) -> [f32; 4] {
    let [a, b, c, d] = window(row, from);
    [f32::from_bits(a), f32::from_bits(b), f32::from_bits(c), f32::from_bits(d)]
}

/// Words as lanes.
#[inline(always)]
fn words(row: &[u32; 8]) -> f32x8 {
    f32x8::from_bits(u32x8::new(*row))
}

impl f32x8 {
    /// Lane j of each four is lane `FROM`ⱼ of the same four.
    #[inline(always)]
    fn in_fours<const A: usize, const B: usize, const C: usize, const D: usize>(self) -> Self {
        let a = self.to_array();
        Self::new([a[A], a[B], a[C], a[D], a[4 + A], a[4 + B], a[4 + C], a[4 + D]])
    }
}

impl f32x16 {
    /// As [`f32x8::in_fours`].
    // Lane by lane: what is made by a loop is not seen to be one shuffle.
    #[inline(always)]
    fn in_fours<const A: usize, const B: usize, const C: usize, const D: usize>(self) -> Self {
        let a = self.to_array();
        Self::new([
            a[A],
            a[B],
            a[C],
            a[D],
            a[4 + A],
            a[4 + B],
            a[4 + C],
            a[4 + D],
            a[8 + A],
            a[8 + B],
            a[8 + C],
            a[8 + D],
            a[12 + A],
            a[12 + B],
            a[12 + C],
            a[12 + D],
        ])
    }

    /// Four quarters.
    #[inline(always)]
    fn of_quarters([a, b, c, d]: [[f32; 4]; 4]) -> Self {
        Self::of_halves([f32x8::of_halves(a, b), f32x8::of_halves(c, d)])
    }

    /// What [`Groups::splats`] gives, of four numbers in each quarter.
    #[inline(always)]
    fn splat_in_fours(self) -> [Self; 4] {
        [
            self.in_fours::<0, 0, 0, 0>(),
            self.in_fours::<1, 1, 1, 1>(),
            self.in_fours::<2, 2, 2, 2>(),
            self.in_fours::<3, 3, 3, 3>(),
        ]
    }
}

impl Groups<1> for f32x8 {
    #[inline(always)]
    fn splat_each(numbers: [f32; 1]) -> Self {
        Self::splat(numbers[0])
    }
    #[inline(always)]
    fn windows([row]: [&[f32; 8]; 1], _: [usize; 1]) -> Self {
        Self::new(*row)
    }
    #[inline(always)]
    fn word_windows([row]: [&[u32; 8]; 1], _: [usize; 1]) -> Self {
        words(row)
    }
    #[inline(always)]
    fn fours(self) -> [[f32; 4]; 1] {
        [self.half(0)]
    }
    #[inline(always)]
    fn of_fours([four]: [[f32; 4]; 1]) -> Self {
        Self::of_halves(four, four)
    }
    #[inline(always)]
    fn splats([numbers]: [[f32; 4]; 1]) -> [Self; 4] {
        numbers.map(Self::splat)
    }
    #[inline(always)]
    fn fold(self, f: impl Fn(Self, Self) -> Self) -> Self {
        let folded = f(self, Self::of_halves(self.half(1), self.half(0)));
        let folded = f(folded, folded.in_fours::<2, 3, 0, 1>());
        f(folded, folded.in_fours::<1, 0, 3, 2>())
    }
}

impl Groups<2> for f32x8 {
    #[inline(always)]
    fn splat_each([one, other]: [f32; 2]) -> Self {
        Self::of_halves([one; 4], [other; 4])
    }
    #[inline(always)]
    fn windows([one, other]: [&[f32; 8]; 2], [i, j]: [usize; 2]) -> Self {
        Self::of_halves(window(one, i), window(other, j))
    }
    #[inline(always)]
    fn word_windows([one, other]: [&[u32; 8]; 2], [i, j]: [usize; 2]) -> Self {
        Self::of_halves(word_window(one, i), word_window(other, j))
    }
    #[inline(always)]
    fn fours(self) -> [[f32; 4]; 2] {
        [self.half(0), self.half(1)]
    }
    #[inline(always)]
    fn of_fours([one, other]: [[f32; 4]; 2]) -> Self {
        Self::of_halves(one, other)
    }
    #[inline(always)]
    fn splats(numbers: [[f32; 4]; 2]) -> [Self; 4] {
        let numbers = opaque(Self::of_fours(numbers));
        [
            numbers.in_fours::<0, 0, 0, 0>(),
            numbers.in_fours::<1, 1, 1, 1>(),
            numbers.in_fours::<2, 2, 2, 2>(),
            numbers.in_fours::<3, 3, 3, 3>(),
        ]
    }
    #[inline(always)]
    fn fold(self, f: impl Fn(Self, Self) -> Self) -> Self {
        let folded = f(self, self.in_fours::<2, 3, 0, 1>());
        f(folded, folded.in_fours::<1, 0, 3, 2>())
    }
}

impl Groups<2> for f32x16 {
    #[inline(always)]
    fn splat_each(numbers: [f32; 2]) -> Self {
        Self::of_halves(numbers.map(f32x8::splat))
    }
    #[inline(always)]
    fn windows([one, other]: [&[f32; 8]; 2], _: [usize; 2]) -> Self {
        Self::of_halves([f32x8::new(*one), f32x8::new(*other)])
    }
    #[inline(always)]
    fn word_windows([one, other]: [&[u32; 8]; 2], _: [usize; 2]) -> Self {
        Self::of_halves([words(one), words(other)])
    }
    #[inline(always)]
    fn fours(self) -> [[f32; 4]; 2] {
        [self.quarter(0), self.quarter(2)]
    }
    #[inline(always)]
    fn of_fours([one, other]: [[f32; 4]; 2]) -> Self {
        Self::of_quarters([one, one, other, other])
    }
    #[inline(always)]
    fn splats(numbers: [[f32; 4]; 2]) -> [Self; 4] {
        // Known for what they are, they would be loaded one by one.
        opaque(Self::of_fours(numbers)).splat_in_fours()
    }
    #[inline(always)]
    fn fold(self, f: impl Fn(Self, Self) -> Self) -> Self {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.quarter(i));
        let folded = f(self, Self::of_quarters([b, a, d, c]));
        let folded = f(folded, folded.in_fours::<2, 3, 0, 1>());
        f(folded, folded.in_fours::<1, 0, 3, 2>())
    }
}

impl Groups<4> for f32x16 {
    #[inline(always)]
    fn splat_each(numbers: [f32; 4]) -> Self {
        Self::of_quarters(numbers.map(|number| [number; 4]))
    }
    #[inline(always)]
    fn windows([a, b, c, d]: [&[f32; 8]; 4], [i, j, k, l]: [usize; 4]) -> Self {
        Self::of_quarters([window(a, i), window(b, j), window(c, k), window(d, l)])
    }
    #[inline(always)]
    fn word_windows([a, b, c, d]: [&[u32; 8]; 4], [i, j, k, l]: [usize; 4]) -> Self {
        Self::of_quarters([word_window(a, i), word_window(b, j), word_window(c, k), word_window(d, l)])
    }
    #[inline(always)]
    fn fours(self) -> [[f32; 4]; 4] {
        [self.quarter(0), self.quarter(1), self.quarter(2), self.quarter(3)]
    }
    #[inline(always)]
    fn of_fours(fours: [[f32; 4]; 4]) -> Self {
        Self::of_quarters(fours)
    }
    #[inline(always)]
    fn splats(numbers: [[f32; 4]; 4]) -> [Self; 4] {
        opaque(Self::of_quarters(numbers)).splat_in_fours()
    }
    #[inline(always)]
    fn fold(self, f: impl Fn(Self, Self) -> Self) -> Self {
        let folded = f(self, self.in_fours::<2, 3, 0, 1>());
        f(folded, folded.in_fours::<1, 0, 3, 2>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Mask;

    /// What each method says, lane by lane.
    fn check<const N: usize, R: Groups<N>>() {
        let width = R::WIDTH;
        let number = |lane: usize| (lane * 37 % 16) as f32 + 1.0;
        let lanes = R::from_fn(number);
        let is = |got: R, want: &dyn Fn(usize, usize) -> f32| {
            for lane in 0..R::LANES {
                assert_eq!(got.lane(lane), want(lane / width, lane % width), "lane {lane} of {N} groups");
            }
        };
        let rows: [[f32; 8]; N] = std::array::from_fn(|i| std::array::from_fn(|k| (10 * i + k) as f32));
        for first in 0..=8 - width {
            let from: [usize; N] = std::array::from_fn(|i| (first + i) % (9 - width));
            is(R::windows(rows.each_ref(), from), &|i, k| rows[i][from[i] + k]);
            let words = rows.map(|row| row.map(f32::to_bits));
            is(R::word_windows(words.each_ref(), from), &|i, k| rows[i][from[i] + k]);
        }
        let numbers: [[f32; 4]; N] = std::array::from_fn(|i| std::array::from_fn(|k| (10 * i + k) as f32));
        for (k, splat) in R::splats(numbers).into_iter().enumerate() {
            is(splat, &|i, _| numbers[i][k]);
        }
        is(R::splat_each(std::array::from_fn(|i| i as f32)), &|i, _| i as f32);
        assert_eq!(R::of_fours(numbers).fours(), numbers);
        let members = |i: usize| (0..width).map(move |k| number(i * width + k));
        is(lanes.fold(R::min), &|i, _| members(i).fold(f32::INFINITY, f32::min));
        is(lanes.fold(|a, b| a + b), &|i, _| members(i).sum());
        // In each group another lane, and none in the last.
        let chosen = |i: usize| (i + 1 < N || N == 1).then_some(i * width + (3 * i + 2) % width);
        let set = (0..N).filter_map(chosen).fold(0, |set, lane| set | 1 << lane);
        is(lanes.shared(R::Mask::from_bitmask(set)), &|i, _| chosen(i).map_or(0.0, number));
        let columns = [0.0, 100.0, 200.0, 300.0].map(|hundreds| lanes + R::splat(hundreds));
        let rows = R::side_by_side(columns).fours();
        for (i, row) in rows.into_iter().enumerate() {
            assert_eq!(row, std::array::from_fn(|k| number(i * width + k) + 100.0 * k as f32));
        }
    }

    #[test]
    fn groups_are_their_lanes() {
        check::<1, f32x8>();
        check::<2, f32x8>();
        check::<2, f32x16>();
        check::<4, f32x16>();
    }
}
