//! What ways have cost lately, and which of them the next rays had better go.

/// One run in so many goes the way that has cost more, to see whether it still does; in four times as many if that
/// has cost twice as much.
const PROBE: u32 = 64;
/// The same for scattered rays, which packets seldom suit.
const PROBE_SCATTERED: u32 = 512;

/// Runs that a way is kept for once it is taken, unless the other is found to be cheaper by far: a wave is filled
/// and drained, and where both cost the same each run would change the way.
const SETTLE: u32 = 16;
const BY_FAR: f32 = 1.5;

/// How rays lie together. What suits the ones says nothing of the others, so each kind has its [`Habit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coherence {
    /// They point anywhere.
    Scattered,
    /// They spread little, around a direction in which octants meet.
    Straddling,
    /// They spread little, and all into one octant.
    Coherent,
}

impl Coherence {
    /// How many there are.
    pub(super) const COUNT: usize = 3;

    /// As a set of one.
    pub(super) fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// What a ray cost lately; 0 before anything is known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Habit {
    /// Together with others.
    together: f32,
    /// Alone.
    alone: f32,
    /// Was the last cost to be learnt one of rays that went alone?
    was_alone: bool,
    /// The way that is taken, and runs since it is.
    goes_alone: bool,
    settled: u32,
    /// Runs since the other way was tried.
    turn: u32,
}

impl Habit {
    /// Whether the next run goes together.
    pub(super) fn choose_together(&mut self, coherence: Coherence) -> bool {
        if self.together == 0.0 || self.alone == 0.0 {
            return self.together == 0.0;
        }
        let (less, more) = (self.together.min(self.alone), self.together.max(self.alone));
        self.settled += 1;
        if self.settled > SETTLE || more > less * BY_FAR {
            let alone = self.alone < self.together;
            if std::mem::replace(&mut self.goes_alone, alone) != alone {
                self.settled = 0;
            }
        }
        // The dearer the other way, the less often it is worth a try, and the less all tries together may cost.
        let probe = if coherence == Coherence::Scattered { PROBE_SCATTERED } else { PROBE };
        let dearer = more / less;
        self.turn += 1;
        if (self.turn as f32) < probe as f32 * dearer * dearer {
            return !self.goes_alone;
        }
        self.turn = 0;
        self.goes_alone
    }

    /// Remembers what a ray cost together with others.
    pub(super) fn learn_together(&mut self, cost: f32) {
        let change = blend(&mut self.together, cost);
        if !std::mem::replace(&mut self.was_alone, false) {
            self.alone *= change;
        }
    }

    /// Remembers what a ray cost alone.
    pub(super) fn learn_alone(&mut self, cost: f32) {
        let change = blend(&mut self.alone, cost);
        if std::mem::replace(&mut self.was_alone, true) {
            self.together *= change;
        }
    }
}

/// Takes part of a new value, and returns the factor by which the old one changes. Where rays become dearer one
/// way they do so the other way too: what is not tried follows by this factor, or it would be judged by what it
/// cost elsewhere.
fn blend(lately: &mut f32, now: f32) -> f32 {
    let before = *lately;
    *lately = if before == 0.0 { now } else { 0.75 * before + 0.25 * now };
    if before == 0.0 { 1.0 } else { *lately / before }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs through places that differ in what rays cost there, but not in which way is cheaper.
    #[test]
    fn what_a_ray_costs_elsewhere_is_not_held_against_a_way() {
        let mut habit = Habit::default();
        let mut alone = 0;
        for run in 0..10_000 {
            let place = if run % 600 < 500 { 1.0 } else { 1.4 };
            if habit.choose_together(Coherence::Coherent) {
                habit.learn_together(100.0 * place);
            } else {
                alone += 1;
                habit.learn_alone(120.0 * place);
            }
        }
        // One in 1.2² · 64 to see whether it still is so.
        assert!((100..200).contains(&alone), "{alone}");
    }

    /// Twice as often would cost twice as much: by the square, all tries together cost the less the dearer they are.
    #[test]
    fn a_way_that_is_dear_is_hardly_ever_tried() {
        let mut habit = Habit::default();
        let mut alone = 0;
        for _ in 0..10_240 {
            if habit.choose_together(Coherence::Coherent) {
                habit.learn_together(100.0);
            } else {
                alone += 1;
                habit.learn_alone(400.0);
            }
        }
        // One in 4² · 64, and the first.
        assert!((8..=12).contains(&alone), "{alone}");
    }

    #[test]
    fn a_way_that_becomes_cheaper_is_found() {
        let mut habit = Habit::default();
        let mut together = [0; 2];
        for run in 0..4_000 {
            let half = run / 2_000;
            if habit.choose_together(Coherence::Coherent) {
                together[half] += 1;
                habit.learn_together(100.0);
            } else {
                habit.learn_alone([200.0, 50.0][half]);
            }
        }
        assert!(together[0] > 1_900 && together[1] < 1_000, "{together:?}");
    }
}
