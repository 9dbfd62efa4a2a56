//! A signal in few bits: every sample of it, to five digits.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::bits::{BitReader, Bits};

/// Samples of a block.
pub(super) const BLOCK: usize = 256;
/// Bits of the largest value of a block: what is kept is off by at most 2⁻¹⁷ of it.
const BITS: i32 = 17;
/// Bits of a value that is written as it is: four times a value, with its sign.
const WHOLE: u32 = 21;
/// Differences that are tried: none, of the first order, up to this one.
const ORDERS: usize = 4;
/// So many ones in a row say that a remainder is written as it is.
const ESCAPE: u64 = 20;
/// Bits of a remainder of the highest order: eight times a value, with its sign.
const REMAINDER: u32 = 22;

/// A signal on its way into bits.
///
/// # Method
///
/// Blocks of 256 samples. A block has one quantum, a power of two, so that its largest value has 17 bits; its
/// values are whole multiples of it. Of them the differences of order 0 to 3 are taken, whichever are shortest,
/// and written in Rice's code: the low bits as they are, the rest as so many ones and a zero. Values that are not
/// finite are marked, and stand as the value before them.
///
/// # References
///
/// Robinson, *SHORTEN: simple lossless and near-lossless waveform compression*, 1994.
#[derive(Debug, Clone, Default)]
pub(crate) struct Coded {
    bits: Bits,
    block: Vec<f64>,
    count: usize,
}

impl Coded {
    /// The next sample.
    pub(crate) fn push(&mut self, value: f64) {
        self.block.push(value);
        self.count += 1;
        if self.block.len() == BLOCK {
            self.close();
        }
    }

    /// The bits of all samples, as text.
    pub(crate) fn text(&self) -> String {
        STANDARD.encode(self.bytes())
    }

    fn bytes(&self) -> Vec<u8> {
        let mut whole = self.clone();
        whole.close();
        whole.bits.finish()
    }

    /// The samples as a page reads them.
    pub(crate) fn values(&self) -> Vec<f64> {
        let bytes = self.bytes();
        let mut bits = BitReader::new(&bytes);
        let mut values = Vec::with_capacity(self.count);
        while values.len() < self.count {
            read(&mut bits, BLOCK.min(self.count - values.len()), &mut values);
        }
        values
    }

    fn close(&mut self) {
        if self.block.is_empty() {
            return;
        }
        let finite = self.block.iter().filter(|value| value.is_finite());
        let exponent = exponent(finite.fold(0.0, |most: f64, value| most.max(value.abs())));
        let gaps = !self.block.iter().all(|value| value.is_finite());
        let whole = whole(&self.block, quantum(exponent));
        let (order, rest, low) = shortest(whole);
        self.bits.put(u64::from((exponent + 128).unsigned_abs()), 8);
        self.bits.put(order as u64, 2);
        self.bits.put(u64::from(low), 5);
        self.bits.put(u64::from(gaps), 1);
        if gaps {
            self.block.iter().for_each(|value| self.bits.put(u64::from(!value.is_finite()), 1));
        }
        for (k, remainder) in rest.into_iter().enumerate() {
            let folded = folded(remainder);
            if k < order {
                self.bits.put(folded, WHOLE);
            } else {
                put(&mut self.bits, folded, low);
            }
        }
        self.block.clear();
    }
}

/// The power of two that is the quantum of a block whose largest value is this.
fn exponent(most: f64) -> i32 {
    // The exponent of a number's own notation: the same on every machine.
    let own = i32::try_from((most.to_bits() >> 52) & 0x7ff).unwrap_or(0) - 1023;
    (own + 1 - BITS).clamp(-127, 127)
}

fn quantum(exponent: i32) -> f64 {
    f64::from_bits(u64::from((1023 + exponent).unsigned_abs()) << 52)
}

/// The values in quanta, a gap as the value before it.
fn whole(values: &[f64], quantum: f64) -> Vec<i64> {
    let mut before = 0;
    let value = |value: &f64| {
        if value.is_finite() {
            before = integer(value / quantum);
        }
        before
    };
    values.iter().map(value).collect()
}

/// The nearest integer of a number below 2⁵⁰: beside 1.5·2⁵² the last bit of a number is worth 1.
fn integer(value: f64) -> i64 {
    const BESIDE: f64 = 6_755_399_441_055_744.0;
    (value + BESIDE).to_bits().wrapping_sub(BESIDE.to_bits()).cast_signed()
}

/// Positive and negative numbers in turn.
fn folded(value: i64) -> u64 {
    (value.unsigned_abs() << 1) - u64::from(value < 0)
}

fn unfolded(value: u64) -> i64 {
    let half = value.div_ceil(2).cast_signed();
    if value % 2 == 1 { -half } else { half }
}

/// Order of the differences, these, and number of their low bits.
type CodedText = (usize, Vec<i64>, u32);

/// Order, differences of that order after the first values, and number of low bits: those that take the fewest bits.
fn shortest(mut rest: Vec<i64>) -> CodedText {
    let mut best: Option<(u64, CodedText)> = None;
    for order in 0..ORDERS.min(rest.len()) {
        if order > 0 {
            for k in (order..rest.len()).rev() {
                rest[k] -= rest[k - 1];
            }
        }
        let coded = &rest[order..];
        let sum: u64 = coded.iter().map(|value| folded(*value)).sum();
        let about = (sum / coded.len() as u64).checked_ilog2().unwrap_or(0);
        for low in about..=about + 1 {
            let one = |value: &i64| match folded(*value) >> low {
                ones if ones < ESCAPE => ones + 1 + u64::from(low),
                _ => ESCAPE + u64::from(REMAINDER),
            };
            let bits = order as u64 * u64::from(WHOLE) + coded.iter().map(one).sum::<u64>();
            if best.as_ref().is_none_or(|(fewest, _)| bits < *fewest) {
                best = Some((bits, (order, rest.clone(), low)));
            }
        }
    }
    best.map_or((0, rest, 0), |(_, best)| best)
}

fn put(bits: &mut Bits, value: u64, low: u32) {
    let ones = value >> low;
    if ones >= ESCAPE {
        bits.put((1 << ESCAPE) - 1, 20);
        bits.put(value, REMAINDER);
        return;
    }
    for _ in 0..ones {
        bits.put(1, 1);
    }
    bits.put(0, 1);
    bits.put(value, low);
}

fn take(bits: &mut BitReader<'_>, low: u32) -> u64 {
    let mut ones = 0;
    while ones < ESCAPE && bits.take(1) == 1 {
        ones += 1;
    }
    if ones == ESCAPE { bits.take(REMAINDER) } else { (ones << low) | bits.take(low) }
}

/// Reads a block of so many samples.
fn read(bits: &mut BitReader<'_>, count: usize, values: &mut Vec<f64>) {
    let exponent = i32::try_from(bits.take(8)).unwrap_or(0) - 128;
    let order = usize::try_from(bits.take(2)).unwrap_or(0);
    let low = u32::try_from(bits.take(5)).unwrap_or(0);
    let gaps = bits.take(1) == 1;
    let gaps: Vec<bool> = (0..count).map(|_| gaps && bits.take(1) == 1).collect();
    let one = |k| unfolded(if k < order { bits.take(WHOLE) } else { take(bits, low) });
    let mut whole: Vec<i64> = (0..count).map(one).collect();
    for order in (1..=order).rev() {
        for k in order..count {
            whole[k] += whole[k - 1];
        }
    }
    let quantum = quantum(exponent);
    let value = |(whole, gap): (i64, bool)| if gap { f64::NAN } else { whole as f64 * quantum };
    values.extend(whole.into_iter().zip(gaps).map(value));
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, Coded};
    use proptest::prelude::*;

    fn coded(values: &[f64]) -> Coded {
        let mut coded = Coded::default();
        for value in values {
            coded.push(*value);
        }
        coded
    }

    proptest! {
        #[test]
        fn every_sample_comes_back_to_five_digits_of_its_block(
            values in proptest::collection::vec(
                prop_oneof![-1.0..1.0, -1e12..1e12, Just(0.0), Just(f64::NAN), -1e-9..1e-9, Just(5e-324)], 0..700),
        ) {
            let back = coded(&values).values();
            prop_assert_eq!(back.len(), values.len());
            for (given, back) in values.chunks(BLOCK).zip(back.chunks(BLOCK)) {
                let finite = given.iter().filter(|value| value.is_finite());
                let most = finite.fold(0.0, |most: f64, value| most.max(value.abs()));
                for (given, back) in given.iter().zip(back) {
                    prop_assert_eq!(given.is_nan(), back.is_nan());
                    prop_assert!(given.is_nan() || (given - back).abs() <= 8e-6 * most.max(1e-30), "{} \
                        {}", given, back);
                }
            }
        }
    }

    #[test]
    fn what_is_smooth_takes_few_bits_and_what_jumps_is_kept() {
        let smooth: Vec<f64> = (0..10_000).map(|k| (1e-3 * f64::from(k)).sin()).collect();
        assert!(coded(&smooth).bytes().len() < 10_000, "{}", coded(&smooth).bytes().len());
        let mut jump = vec![1e-3; 1_000];
        jump[500] = 7.0;
        let back = coded(&jump).values();
        assert!((back[500] - 7.0).abs() < 6e-5 && (back[499] - 1e-3).abs() < 6e-5);
        assert!(coded(&vec![0.0; 2_560]).bytes().len() < 350);
    }
}
