//! A Parquet file, written one row group at a time.

use std::io::{self, Write};

use snap::raw::{Encoder, max_compress_len};

use super::meta::{ColumnChunk, Element, Footer, PageHead, RowGroup};
use super::{MAGIC, SNAPPY, encoding, hybrid, page_type, physical};

/// Who wrote a file.
const WRITER: &str = concat!("phihat version ", env!("CARGO_PKG_VERSION"));

/// What a column stores.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stored {
    Integers,
    Numbers,
    Flags,
    Texts,
}

impl Stored {
    fn physical(self) -> i64 {
        match self {
            Self::Integers => physical::INT64,
            Self::Numbers => physical::DOUBLE,
            Self::Flags => physical::BOOLEAN,
            Self::Texts => physical::BYTE_ARRAY,
        }
    }
}

/// A file on its way: its columns, then row groups with each of them in turn.
#[derive(Debug)]
pub(crate) struct TableWriter<W: Write> {
    out: W,
    at: u64,
    columns: Vec<(&'static str, Stored)>,
    footer: Footer,
    /// Of the page that is made: as it is, and compressed.
    plain: Vec<u8>,
    packed: Vec<u8>,
}

impl<W: Write> TableWriter<W> {
    pub(crate) fn new(out: W) -> Self {
        let (plain, packed) = (Vec::new(), Vec::new());
        let (columns, footer) = (Vec::new(), Footer::default());
        Self { out, at: 0, columns, footer, plain, packed }
    }

    /// Begins the file.
    pub(crate) fn begin(&mut self, columns: Vec<(&'static str, Stored)>) -> io::Result<()> {
        let children = signed(columns.len());
        let root = Element { name: "trace".to_owned(), children, ..Element::default() };
        let column = |(name, stored): &(&'static str, Stored)| Element {
            name: (*name).to_owned(),
            physical: Some(stored.physical()),
            ..Element::default()
        };
        self.footer.schema = std::iter::once(root).chain(columns.iter().map(column)).collect();
        self.columns = columns;
        self.put_plain(&MAGIC)
    }

    /// Begins a row group of so many rows.
    pub(crate) fn group(&mut self, rows: usize) -> io::Result<()> {
        self.whole()?;
        let columns = Vec::with_capacity(self.columns.len());
        self.footer.groups.push(RowGroup { rows: signed(rows), columns });
        Ok(())
    }

    /// Whether the row group that was begun has all its columns.
    fn whole(&self) -> io::Result<()> {
        let last = self.footer.groups.last();
        if last.is_some_and(|group| group.columns.len() != self.columns.len()) {
            return Err(io::Error::other("a row group lacks columns"));
        }
        Ok(())
    }

    /// The next column: whole numbers as they are.
    pub(crate) fn integers(&mut self, values: impl Iterator<Item = i64>) -> io::Result<()> {
        self.plain.clear();
        values.for_each(|value| self.plain.extend_from_slice(&value.to_le_bytes()));
        self.column(Stored::Integers, encoding::PLAIN, None)
    }

    /// The next column: numbers, their bytes apart, so that those which hardly change stand together.
    pub(crate) fn numbers(&mut self, values: impl Iterator<Item = f64>) -> io::Result<()> {
        let rows = self.rows();
        self.plain.clear();
        self.plain.resize(8 * rows, 0);
        let mut planes = self.plain.chunks_exact_mut(rows.max(1));
        let mut planes: [&mut [u8]; 8] =
            core::array::from_fn(|_| planes.next().unwrap_or_default());
        for (row, value) in values.take(rows).enumerate() {
            for (plane, byte) in planes.iter_mut().zip(value.to_le_bytes()) {
                plane[row] = byte;
            }
        }
        self.column(Stored::Numbers, encoding::BYTE_STREAM_SPLIT, None)
    }

    /// The next column: flags, a bit each.
    pub(crate) fn flags(&mut self, values: impl Iterator<Item = bool>) -> io::Result<()> {
        self.plain.clear();
        self.plain.resize(self.rows().div_ceil(8), 0);
        for (row, _) in values.enumerate().filter(|(_, value)| *value) {
            if let Some(byte) = self.plain.get_mut(row / 8) {
                *byte |= 1 << (row % 8);
            }
        }
        self.column(Stored::Flags, encoding::PLAIN, None)
    }

    /// The next column: of each row, which of these texts it has.
    pub(crate) fn texts(&mut self, words: &[&str], rows: &[u32]) -> io::Result<()> {
        self.plain.clear();
        for word in words {
            let length = u32::try_from(word.len()).map_err(io::Error::other)?;
            self.plain.extend_from_slice(&length.to_le_bytes());
            self.plain.extend_from_slice(word.as_bytes());
        }
        let values = signed(words.len());
        let before = self.page(page_type::DICTIONARY, (values, encoding::PLAIN))?;
        let most = u32::try_from(words.len()).map_or(u32::MAX, |count| count.saturating_sub(1));
        let width = (u32::BITS - most.leading_zeros()).max(1).to_le_bytes()[0];
        self.plain.clear();
        self.plain.push(width);
        hybrid::write(&mut self.plain, rows, width);
        self.column(Stored::Texts, encoding::RLE_DICTIONARY, Some(before))
    }

    /// Writes the end of the file; the writer, back.
    pub(crate) fn finish(mut self) -> io::Result<W> {
        self.whole()?;
        let mut footer = self.footer.write(WRITER);
        let size = u32::try_from(footer.len()).map_err(io::Error::other)?;
        footer.extend_from_slice(&size.to_le_bytes());
        footer.extend_from_slice(&MAGIC);
        self.put_plain(&footer)?;
        Ok(self.out)
    }

    /// Rows of the group that was begun.
    fn rows(&self) -> usize {
        self.footer.groups.last().map_or(0, |group| usize::try_from(group.rows).unwrap_or(0))
    }

    /// Writes the next column's only page of data, after its dictionary.
    fn column(
        &mut self,
        stored: Stored,
        encoding: i64,
        dictionary: Option<PageAt>,
    ) -> io::Result<()> {
        let rows = self.footer.groups.last().map_or(0, |group| group.rows);
        let data = self.page(page_type::DATA, (rows, encoding))?;
        let group = self.footer.groups.last_mut();
        let group = group.ok_or_else(|| io::Error::other("no row group was begun"))?;
        let Some((name, _)) =
            self.columns.get(group.columns.len()).filter(|(_, next)| *next == stored)
        else {
            return Err(io::Error::other("a row group has another column there"));
        };
        let before = dictionary.unwrap_or(PageAt { at: data.at, size: 0, plain_size: 0 });
        group.columns.push(ColumnChunk {
            physical: stored.physical(),
            codec: SNAPPY,
            data_at: data.at,
            dictionary_at: dictionary.map(|page| page.at),
            size: before.size + data.size,
            plain_size: before.plain_size + data.plain_size,
            values: rows,
            name,
            elsewhere: false,
        });
        Ok(())
    }

    /// Writes a page with its head, compressed.
    fn page(&mut self, kind: i64, (values, encoding): (i64, i64)) -> io::Result<PageAt> {
        let most = max_compress_len(self.plain.len());
        if self.packed.len() < most {
            self.packed.resize(most, 0);
        }
        let packed = Encoder::new().compress(&self.plain, &mut self.packed);
        let packed = packed.map_err(io::Error::other)?;
        let (size, plain_size) = (signed(packed), signed(self.plain.len()));
        let head = PageHead { kind, plain_size, size, values, encoding, ..PageHead::default() };
        let head = head.write();
        let at = i64::try_from(self.at).map_err(io::Error::other)?;
        self.out.write_all(&head)?;
        self.out.write_all(self.packed.get(..packed).unwrap_or_default())?;
        self.at += (head.len() + packed) as u64;
        let head = signed(head.len());
        Ok(PageAt { at, size: head + size, plain_size: head + plain_size })
    }

    fn put_plain(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.at += bytes.len() as u64;
        Ok(())
    }
}

/// A page that was written, its head included.
#[derive(Debug, Clone, Copy)]
struct PageAt {
    at: i64,
    size: i64,
    plain_size: i64,
}

/// A count as the format has it.
fn signed(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
