//! A page: values that are taken out of it as they are asked for.

use super::hybrid::Hybrid;
use super::meta::PageHead;
use super::values::Values;
use super::{SNAPPY, UNCOMPRESSED, encoding, page_type, physical};

/// Bytes that SNAPPY can make of one, at most: 64 of three.
const SNAPPY_MOST: usize = 22;

/// Why a page does not read.
type Why = &'static str;

const ENDS: Why = "a page ends before its values do";

/// The values that numbers of a column stand for.
#[derive(Debug)]
pub(super) enum Dictionary {
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    Words(Vec<u32>),
}

/// A page of data, its values taken from the front.
#[derive(Debug)]
pub(super) struct Page {
    bytes: Vec<u8>,
    /// Values and nulls that are left.
    pub(super) left: usize,
    /// Which of them are no nulls; `None`: all.
    levels: Option<Hybrid>,
    physical: i64,
    form: Form,
}

#[derive(Debug, Clone, Copy)]
enum Form {
    /// The next value is at this byte; flags, at this bit.
    Plain(usize),
    /// Bytes of all values apart: where they begin, how many values, and which is the next.
    Split(usize, usize, usize),
    Dictionary(Hybrid),
    /// Flags as runs.
    Runs(Hybrid),
}

/// What a page's bytes are once they are not compressed; never more than the codec can make of them.
pub(super) fn bare(codec: i64, bytes: Vec<u8>, size: i64) -> Result<Vec<u8>, Why> {
    let size = usize::try_from(size).map_err(|_| "a page has a negative size")?;
    match codec {
        UNCOMPRESSED if bytes.len() == size => Ok(bytes),
        UNCOMPRESSED => Err("a page that is not compressed has two sizes"),
        SNAPPY => {
            let told = snap::raw::decompress_len(&bytes).map_err(|_| "a page is no SNAPPY")?;
            if told != size || told / SNAPPY_MOST > bytes.len() {
                return Err("a page claims more bytes than it has");
            }
            let plain = snap::raw::Decoder::new().decompress_vec(&bytes);
            plain.map_err(|_| "a page is no SNAPPY")
        }
        _ => Err("a page is compressed in another way"),
    }
}

impl Page {
    /// A page of data; `nullable` columns have levels.
    pub(super) fn new(
        head: &PageHead,
        (codec, physical, nullable): (i64, i64, bool),
        mut bytes: Vec<u8>,
    ) -> Result<Self, Why> {
        let left = usize::try_from(head.values).map_err(|_| "a page has a negative size")?;
        let mut levels = None;
        let from = if head.kind == page_type::DATA_V2 {
            let size = |size: i64| usize::try_from(size).ok().filter(|size| *size <= bytes.len());
            let (repetition, definition) = (size(head.repetition_size), size(head.definition_size));
            let (Some(repetition), Some(definition)) = (repetition, definition) else {
                return Err("levels are larger than their page");
            };
            let from = repetition + definition;
            let rest = bytes.split_off(from.min(bytes.len()));
            let codec = if head.bare || rest.is_empty() { UNCOMPRESSED } else { codec };
            bytes.append(&mut bare(
                codec,
                rest,
                head.plain_size.saturating_sub(i64::try_from(from).unwrap_or(i64::MAX)),
            )?);
            if nullable {
                levels = Hybrid::new(repetition, from, 1);
            }
            from
        } else {
            bytes = bare(codec, bytes, head.plain_size)?;
            if nullable && head.level_encoding != encoding::RLE {
                return Err("levels are written in another way than RLE");
            }
            if nullable {
                let end = part(&bytes, 0)?;
                levels = Hybrid::new(4, end, 1);
                end
            } else {
                0
            }
        };
        let form = Form::of(head.encoding, physical, &bytes, from)?;
        Ok(Self { bytes, left, levels, physical, form })
    }

    /// Takes the next values, as many as are left at most.
    pub(super) fn take(
        &mut self,
        mut count: usize,
        dictionary: Option<&Dictionary>,
        into: &mut Values,
    ) -> Result<(), Why> {
        while count > 0 {
            let (present, run) = match &mut self.levels {
                Some(levels) => levels.next(&self.bytes, count).ok_or(ENDS)?,
                None => (1, count),
            };
            if present == 1 {
                self.values(run, dictionary, into)?;
            } else if !into.nulls(run) {
                return Err("a row has no value");
            }
            self.left -= run;
            count -= run;
        }
        Ok(())
    }

    fn values(
        &mut self,
        count: usize,
        dictionary: Option<&Dictionary>,
        into: &mut Values,
    ) -> Result<(), Why> {
        match &mut self.form {
            Form::Plain(at) => plain(&self.bytes, self.physical, at, count, into),
            Form::Split(from, all, next) => {
                let planes = self.bytes.get(*from..).ok_or(ENDS)?;
                split(planes, (self.physical, *all), *next, count, into)?;
                *next += count;
                Ok(())
            }
            Form::Dictionary(numbers) => {
                let dictionary =
                    dictionary.ok_or("a page asks for a dictionary, and there is none")?;
                looked_up(&self.bytes, numbers, count, dictionary, into)
            }
            Form::Runs(runs) => {
                let Values::Flags(flags) = into else { return Err("runs are of flags alone") };
                let mut left = count;
                while left > 0 {
                    let (value, run) = runs.next(&self.bytes, left).ok_or(ENDS)?;
                    flags.extend(std::iter::repeat_n(value != 0, run));
                    left -= run;
                }
                Ok(())
            }
        }
    }
}

impl Form {
    fn of(encoding: i64, physical: i64, bytes: &[u8], from: usize) -> Result<Self, Why> {
        let flags = physical == physical::BOOLEAN;
        match encoding {
            encoding::PLAIN => Ok(Self::Plain(if flags { from.saturating_mul(8) } else { from })),
            encoding::PLAIN_DICTIONARY | encoding::RLE_DICTIONARY if !flags => {
                let width = bytes.get(from).copied().unwrap_or(0);
                let numbers = Hybrid::new(from + 1, bytes.len(), width);
                Ok(Self::Dictionary(numbers.ok_or("a dictionary's numbers are too wide")?))
            }
            encoding::RLE if flags => {
                let end = part(bytes, from)?;
                Ok(Self::Runs(Hybrid::new(from + 4, end, 1).ok_or(ENDS)?))
            }
            encoding::BYTE_STREAM_SPLIT => {
                let size = size_of(physical).ok_or("only numbers are split by bytes")?;
                Ok(Self::Split(from, bytes.len().saturating_sub(from) / size, 0))
            }
            _ => Err(
                "values are written in another way than PLAIN, RLE, a dictionary or BYTE_STREAM_SPLIT",
            ),
        }
    }
}

/// Where a part ends that begins with its length.
fn part(bytes: &[u8], from: usize) -> Result<usize, Why> {
    let length = bytes.get(from..).and_then(|rest| rest.first_chunk()).ok_or(ENDS)?;
    let length = usize::try_from(u32::from_le_bytes(*length)).map_err(|_| ENDS)?;
    (from + 4).checked_add(length).filter(|end| *end <= bytes.len()).ok_or(ENDS)
}

/// Bytes of a value of fixed size.
fn size_of(physical: i64) -> Option<usize> {
    match physical {
        physical::INT32 | physical::FLOAT => Some(4),
        physical::INT64 | physical::DOUBLE => Some(8),
        _ => None,
    }
}

/// The whole dictionary of a column.
pub(super) fn dictionary(
    (physical, count): (i64, i64),
    bytes: &[u8],
    column: &mut Values,
) -> Result<Dictionary, Why> {
    let count = usize::try_from(count).ok().filter(|count| *count <= bytes.len());
    let count = count.ok_or("a dictionary claims more values than it has bytes")?;
    if let Values::Texts(texts) = column {
        let (mut at, mut words) = (0, Vec::new());
        for _ in 0..count {
            words.push(texts.word(text(bytes, &mut at)?));
        }
        return Ok(Dictionary::Words(words));
    }
    let mut values = match column {
        Values::Integers(_) => Values::Integers(Vec::new()),
        _ => Values::Numbers(Vec::new()),
    };
    plain(bytes, physical, &mut 0, count, &mut values)?;
    match values {
        Values::Integers(values) => Ok(Dictionary::Integers(values)),
        Values::Numbers(values) => Ok(Dictionary::Numbers(values)),
        _ => Err("a dictionary of flags"),
    }
}

fn looked_up(
    bytes: &[u8],
    numbers: &mut Hybrid,
    count: usize,
    dictionary: &Dictionary,
    into: &mut Values,
) -> Result<(), Why> {
    const NONE: Why = "a number is not that of a value in the dictionary";
    let mut left = count;
    while left > 0 {
        let (number, run) = numbers.next(bytes, left).ok_or(ENDS)?;
        let at = number as usize;
        match (dictionary, &mut *into) {
            (Dictionary::Numbers(all), Values::Numbers(into)) => {
                into.extend(std::iter::repeat_n(*all.get(at).ok_or(NONE)?, run));
            }
            (Dictionary::Integers(all), Values::Integers(into)) => {
                into.extend(std::iter::repeat_n(*all.get(at).ok_or(NONE)?, run));
            }
            (Dictionary::Words(all), Values::Texts(into)) => {
                into.push(*all.get(at).ok_or(NONE)?, run);
            }
            _ => return Err("a dictionary of other values"),
        }
        left -= run;
    }
    Ok(())
}

/// The text at a byte, and on to the next.
fn text<'a>(bytes: &'a [u8], at: &mut usize) -> Result<&'a str, Why> {
    let end = part(bytes, *at)?;
    let text = bytes.get(*at + 4..end).ok_or(ENDS)?;
    *at = end;
    core::str::from_utf8(text).map_err(|_| "a text is not UTF-8")
}

/// The next values as they are.
fn plain(
    bytes: &[u8],
    physical: i64,
    at: &mut usize,
    count: usize,
    into: &mut Values,
) -> Result<(), Why> {
    match into {
        Values::Texts(texts) => {
            for _ in 0..count {
                let word = texts.word(text(bytes, at)?);
                texts.push(word, 1);
            }
            return Ok(());
        }
        Values::Flags(flags) => {
            for bit in *at..at.checked_add(count).ok_or(ENDS)? {
                flags.push(bytes.get(bit / 8).ok_or(ENDS)? >> (bit % 8) & 1 == 1);
            }
            *at += count;
            return Ok(());
        }
        Values::Numbers(_) | Values::Integers(_) => {}
    }
    let size = size_of(physical).ok_or("values of another type")?;
    let end = count.checked_mul(size).and_then(|size| at.checked_add(size)).ok_or(ENDS)?;
    let part = bytes.get(*at..end).ok_or(ENDS)?;
    *at = end;
    let (eight, four) = (part.as_chunks::<8>().0.iter(), part.as_chunks::<4>().0.iter());
    match (into, physical) {
        (Values::Numbers(into), physical::DOUBLE) => {
            into.extend(eight.map(|b| f64::from_le_bytes(*b)));
        }
        (Values::Numbers(into), _) => into.extend(four.map(|b| f64::from(f32::from_le_bytes(*b)))),
        (Values::Integers(into), physical::INT64) => {
            into.extend(eight.map(|b| i64::from_le_bytes(*b)));
        }
        (Values::Integers(into), _) => into.extend(four.map(|b| i64::from(i32::from_le_bytes(*b)))),
        _ => return Err("values of another type"),
    }
    Ok(())
}

/// The next of values whose bytes stand apart.
fn split(
    planes: &[u8],
    (physical, all): (i64, usize),
    next: usize,
    count: usize,
    into: &mut Values,
) -> Result<(), Why> {
    let end = next.checked_add(count).filter(|end| *end <= all).ok_or(ENDS)?;
    let range = next..end;
    match (into, physical) {
        (Values::Numbers(into), physical::DOUBLE) => {
            joined(planes, all, range, |b| into.push(f64::from_le_bytes(b)))
        }
        (Values::Numbers(into), _) => {
            joined(planes, all, range, |b| into.push(f32::from_le_bytes(b).into()))
        }
        (Values::Integers(into), physical::INT64) => {
            joined(planes, all, range, |b| into.push(i64::from_le_bytes(b)))
        }
        (Values::Integers(into), _) => {
            joined(planes, all, range, |b| into.push(i32::from_le_bytes(b).into()))
        }
        _ => Err("only numbers are split by bytes"),
    }
}

fn joined<const N: usize>(
    planes: &[u8],
    all: usize,
    range: core::ops::Range<usize>,
    mut push: impl FnMut([u8; N]),
) -> Result<(), Why> {
    let mut plane: [&[u8]; N] = [&[]; N];
    for (b, plane) in plane.iter_mut().enumerate() {
        *plane = planes.get(b * all + range.start..b * all + range.end).ok_or(ENDS)?;
    }
    for i in 0..range.len() {
        push(core::array::from_fn(|b| plane[b][i]));
    }
    Ok(())
}
