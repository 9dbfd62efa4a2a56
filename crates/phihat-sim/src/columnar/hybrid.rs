//! Small whole numbers as runs: repeated ones, and packed ones.

/// Numbers that are read out of bytes that somebody else keeps.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Hybrid {
    at: usize,
    end: usize,
    width: u32,
    /// Of the run that was begun: how many are left, and what is repeated; `None`: they are packed, the next one at this bit.
    left: u64,
    repeated: Option<u32>,
    bit: usize,
}

impl Hybrid {
    /// Of `width` bits each, in this part of the bytes; `None`: no number is that wide.
    pub(super) fn new(from: usize, end: usize, width: u8) -> Option<Self> {
        (width <= 32).then(|| Self { at: from, end, width: u32::from(width), ..Self::default() })
    }

    /// The next number and how often it comes, `most` times at most; `None`: there is none.
    pub(super) fn next(&mut self, bytes: &[u8], most: usize) -> Option<(u32, usize)> {
        while self.left == 0 {
            self.begin(bytes)?;
        }
        let Some(value) = self.repeated else {
            let value = bits(bytes.get(..self.end)?, self.bit, self.width)?;
            self.bit += self.width as usize;
            self.left -= 1;
            return Some((value, 1));
        };
        let count = usize::try_from(self.left).unwrap_or(usize::MAX).min(most);
        self.left -= count as u64;
        Some((value, count))
    }

    fn begin(&mut self, bytes: &[u8]) -> Option<()> {
        let bytes = bytes.get(..self.end)?;
        let mut head = 0_u64;
        for shift in (0..35).step_by(7) {
            let byte = *bytes.get(self.at)?;
            self.at += 1;
            head |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return self.run(bytes, head);
            }
        }
        None
    }

    fn run(&mut self, bytes: &[u8], head: u64) -> Option<()> {
        let size = if head & 1 == 1 {
            (self.repeated, self.bit) = (None, self.at.checked_mul(8)?);
            self.left = (head >> 1).checked_mul(8)?;
            // The last groups may be cut off: their numbers are not asked for.
            usize::try_from((head >> 1).checked_mul(u64::from(self.width))?).ok()?
        } else {
            let size = self.width.div_ceil(8) as usize;
            let value = bits(bytes, self.at.checked_mul(8)?, self.width)?;
            (self.repeated, self.left) = (Some(value), head >> 1);
            size
        };
        self.at = self.at.checked_add(size)?;
        Some(())
    }
}

/// So many bits from a bit on, the lowest first.
fn bits(bytes: &[u8], from: usize, width: u32) -> Option<u32> {
    let (first, shift) = (from / 8, from % 8);
    let last = (from + width as usize).div_ceil(8);
    let there = bytes.get(first..last)?;
    let mut all = [0; 8];
    all[..there.len()].copy_from_slice(there);
    let mask = (1_u64 << width) - 1;
    u32::try_from((u64::from_le_bytes(all) >> shift) & mask).ok()
}

/// Writes numbers of so many bits: one run where all are the same, else packed.
pub(super) fn write(into: &mut Vec<u8>, numbers: &[u32], width: u8) {
    let head = |into: &mut Vec<u8>, mut value: u64| {
        while value >= 0x80 {
            into.push(value.to_le_bytes()[0] | 0x80);
            value >>= 7;
        }
        into.push(value.to_le_bytes()[0]);
    };
    let size = usize::from(width).div_ceil(8);
    if numbers.iter().all(|number| Some(number) == numbers.first()) {
        head(into, (numbers.len() as u64) << 1);
        into.extend_from_slice(&numbers.first().map_or([0; 4], |n| n.to_le_bytes())[..size.min(4)]);
        return;
    }
    head(into, ((numbers.len().div_ceil(8) as u64) << 1) | 1);
    let (mut held, mut count) = (0_u64, 0);
    let padding = numbers.len().div_ceil(8) * 8 - numbers.len();
    for number in numbers.iter().copied().chain(std::iter::repeat_n(0, padding)) {
        held |= u64::from(number) << count;
        count += u32::from(width);
        while count >= 8 {
            into.push(held.to_le_bytes()[0]);
            held >>= 8;
            count -= 8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Hybrid, write};

    /// Wrong if a number came back as another, or a packed run ended elsewhere.
    #[test]
    fn what_is_written_is_read() {
        for width in 1..=20_u8 {
            for count in [1, 7, 8, 9, 100] {
                let mixed: Vec<u32> = (0..count)
                    .map(|k: u32| k.wrapping_mul(2_654_435_761) >> (32 - u32::from(width)))
                    .collect();
                for numbers in [mixed, vec![1; count as usize]] {
                    let mut bytes = Vec::new();
                    write(&mut bytes, &numbers, width);
                    let mut hybrid = Hybrid::new(0, bytes.len(), width).unwrap();
                    let mut read = Vec::new();
                    while read.len() < numbers.len() {
                        let (value, n) = hybrid.next(&bytes, numbers.len() - read.len()).unwrap();
                        read.extend(std::iter::repeat_n(value, n));
                    }
                    assert_eq!(read, numbers, "{width} bits");
                }
            }
        }
    }
}
