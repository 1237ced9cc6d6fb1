//! Sixty-four bits that tell two bodies of data apart.

use std::fmt;

/// FNV-1a, over words of 32 bits where data has them. Against accidents, not against an adversary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Takes in one word. No two words lead from one state to the same next one.
    #[inline]
    pub fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    }

    /// Takes in the bits of floats.
    pub fn floats(mut self, floats: impl IntoIterator<Item = f32>) -> Self {
        floats.into_iter().for_each(|x| self.word(x.to_bits()));
        self
    }

    /// Takes in bytes, one by one.
    pub fn bytes(mut self, bytes: &[u8]) -> Self {
        bytes.iter().for_each(|&byte| self.word(byte.into()));
        self
    }

    /// The digest of what was taken in.
    pub fn value(self) -> u64 {
        self.0
    }
}

/// Text is taken in as it is written, so that what can be formatted can be digested without being kept.
impl fmt::Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        *self = self.bytes(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    #[test]
    fn bytes_have_the_published_values() {
        for (text, value) in
            [("", 0xcbf2_9ce4_8422_2325), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            assert_eq!(Digest::default().bytes(text.as_bytes()).value(), value);
            let mut written = Digest::default();
            write!(written, "{text}").unwrap();
            assert_eq!(written.value(), value);
        }
    }

    #[test]
    fn a_sign_and_an_order_are_seen() {
        let of = |floats: [f32; 2]| Digest::default().floats(floats).value();
        assert_ne!(of([0.0, 1.0]), of([-0.0, 1.0]));
        assert_ne!(of([0.0, 1.0]), of([1.0, 0.0]));
    }
}
