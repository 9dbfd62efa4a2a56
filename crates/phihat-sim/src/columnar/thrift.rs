//! Thrift's compact protocol, as far as Parquet's own documents need it.

/// Types of fields and elements.
pub(super) const BOOL_TRUE: u8 = 1;
const BOOL_FALSE: u8 = 2;
pub(super) const I32: u8 = 5;
const I64: u8 = 6;
pub(super) const BINARY: u8 = 8;
const LIST: u8 = 9;
pub(super) const STRUCT: u8 = 12;

/// Structures inside of each other, at most: the format itself needs six.
const DEPTH: usize = 16;

/// Why a document does not read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Broken {
    /// It ends too early.
    Ends,
    /// It is none.
    Malformed,
}

type Read<T> = Result<T, Broken>;

/// A document that is read.
#[derive(Debug)]
pub(super) struct In<'a> {
    bytes: &'a [u8],
    at: usize,
    depth: usize,
}

impl<'a> In<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, depth: 0 }
    }

    /// How far it was read.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    fn byte(&mut self) -> Read<u8> {
        let byte = *self.bytes.get(self.at).ok_or(Broken::Ends)?;
        self.at += 1;
        Ok(byte)
    }

    fn varint(&mut self) -> Read<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Broken::Malformed)
    }

    pub(super) fn integer(&mut self) -> Read<i64> {
        let value = self.varint()?;
        Ok((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    pub(super) fn binary(&mut self) -> Read<&'a [u8]> {
        let length = usize::try_from(self.varint()?).map_err(|_| Broken::Malformed)?;
        let end = self.at.checked_add(length).ok_or(Broken::Malformed)?;
        let bytes = self.bytes.get(self.at..end).ok_or(Broken::Ends)?;
        self.at = end;
        Ok(bytes)
    }

    /// Each field of a structure: its number and its type. One that `take` does not take is passed over.
    pub(super) fn fields(
        &mut self,
        mut take: impl FnMut(&mut Self, i64, u8) -> Read<bool>,
    ) -> Read<()> {
        if self.depth == DEPTH {
            return Err(Broken::Malformed);
        }
        self.depth += 1;
        let mut id = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                self.depth -= 1;
                return Ok(());
            }
            let step = i64::from(head >> 4);
            id = if step == 0 { self.integer()? } else { id.saturating_add(step) };
            let kind = head & 0xf;
            if !take(self, id, kind)? {
                self.pass(kind, false)?;
            }
        }
    }

    /// Each element of a list; an element takes a byte at least, so what a list claims is bounded by what is there.
    pub(super) fn list(
        &mut self,
        kind: u8,
        mut each: impl FnMut(&mut Self) -> Read<()>,
    ) -> Read<()> {
        let (count, of) = self.list_head()?;
        if of != kind && count > 0 {
            return Err(Broken::Malformed);
        }
        (0..count).try_for_each(|_| each(self))
    }

    fn list_head(&mut self) -> Read<(u64, u8)> {
        let head = self.byte()?;
        let count = match u64::from(head >> 4) {
            15 => self.varint()?,
            few => few,
        };
        Ok((count, head & 0xf))
    }

    /// Passes over a value; flags stand in a field's head, but are bytes in a list.
    fn pass(&mut self, kind: u8, in_list: bool) -> Read<()> {
        match kind {
            BOOL_TRUE | BOOL_FALSE if !in_list => Ok(()),
            BOOL_TRUE | BOOL_FALSE | 3 => self.byte().map(drop),
            4..=6 => self.varint().map(drop),
            7 => (0..8).try_for_each(|_| self.byte().map(drop)),
            BINARY => self.binary().map(drop),
            LIST | 10 => {
                let (count, of) = self.list_head()?;
                self.deeper(|inside| (0..count).try_for_each(|_| inside.pass(of, true)))
            }
            11 => {
                let count = self.varint()?;
                if count == 0 {
                    return Ok(());
                }
                let kinds = self.byte()?;
                self.deeper(|inside| {
                    (0..count).try_for_each(|_| {
                        inside.pass(kinds >> 4, true)?;
                        inside.pass(kinds & 0xf, true)
                    })
                })
            }
            STRUCT => self.fields(|_, _, _| Ok(false)),
            _ => Err(Broken::Malformed),
        }
    }

    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Read<()>) -> Read<()> {
        if self.depth == DEPTH {
            return Err(Broken::Malformed);
        }
        self.depth += 1;
        read(self)?;
        self.depth -= 1;
        Ok(())
    }
}

/// A document that is written: structures as closures, fields in ascending order.
#[derive(Debug, Default)]
pub(super) struct Out {
    pub(super) bytes: Vec<u8>,
    last: u8,
}

impl Out {
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value.to_le_bytes()[0] | 0x80);
            value >>= 7;
        }
        self.bytes.push(value.to_le_bytes()[0]);
    }

    fn head(&mut self, id: u8, kind: u8) {
        // Numbers of fields are below 16, so a step always fits.
        self.bytes.push((id.wrapping_sub(self.last) << 4) | kind);
        self.last = id;
    }

    /// An integer alone, as an element of a list.
    pub(super) fn integer(&mut self, value: i64) {
        self.varint(((value << 1) ^ (value >> 63)).cast_unsigned());
    }

    pub(super) fn i32(&mut self, id: u8, value: i64) {
        self.head(id, I32);
        self.integer(value);
    }

    pub(super) fn i64(&mut self, id: u8, value: i64) {
        self.head(id, I64);
        self.integer(value);
    }

    /// A text alone, as an element of a list.
    pub(super) fn element(&mut self, text: &str) {
        self.varint(text.len() as u64);
        self.bytes.extend_from_slice(text.as_bytes());
    }

    pub(super) fn text(&mut self, id: u8, text: &str) {
        self.head(id, BINARY);
        self.element(text);
    }

    pub(super) fn list<T>(
        &mut self,
        (id, kind): (u8, u8),
        elements: &[T],
        mut each: impl FnMut(&mut Self, &T),
    ) {
        self.head(id, LIST);
        let count = elements.len();
        match u8::try_from(count) {
            Ok(few) if few < 15 => self.bytes.push((few << 4) | kind),
            _ => {
                self.bytes.push(0xf0 | kind);
                self.varint(count as u64);
            }
        }
        for element in elements {
            each(self, element);
        }
    }

    /// A structure as a field.
    pub(super) fn inner(&mut self, id: u8, fields: impl FnOnce(&mut Self)) {
        self.head(id, STRUCT);
        self.structure(fields);
    }

    /// A structure alone: the whole document, or an element of a list.
    pub(super) fn structure(&mut self, fields: impl FnOnce(&mut Self)) {
        let outer = std::mem::take(&mut self.last);
        fields(self);
        self.bytes.push(0);
        self.last = outer;
    }
}
