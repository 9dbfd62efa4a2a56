//! A Parquet file, read some rows at a time.

use std::io::{ErrorKind, Read, Seek, SeekFrom};

use super::meta::{ColumnChunk, Element, Footer, PageHead};
use super::page::{Dictionary, Page, bare, dictionary};
use super::thrift::Broken;
use super::values::{Kind, Values};
use super::{CODECS, MAGIC, ParquetError, SNAPPY, UNCOMPRESSED, page_type, physical};

/// Rows that a byte of a file stands for at most: a trace has some twenty numbers in a row, of which not all are constant.
const ROWS_PER_BYTE: u64 = 8;

/// The head of a page, at first and at most.
const HEAD: u64 = 256;
const HEAD_MOST: u64 = 1 << 20;

/// Bytes of a footer, at most.
const FOOTER_MOST: u64 = 1 << 28;

/// A Parquet file that is read some rows at a time, column by column.
#[derive(Debug)]
pub struct ParquetTable<R> {
    reader: R,
    length: u64,
    leaves: Vec<Leaf>,
    footer: Footer,
    rows: u64,
}

/// A column as the schema has it.
#[derive(Debug)]
struct Leaf {
    name: String,
    physical: i64,
    nullable: bool,
    /// It is in a group, or a list.
    nested: bool,
}

impl<R: Read + Seek> ParquetTable<R> {
    /// Reads what the file says of itself.
    ///
    /// # Errors
    ///
    /// [`ParquetError`]: it is none, or not whole.
    pub fn open(mut reader: R) -> Result<Self, ParquetError> {
        let length = reader.seek(SeekFrom::End(0))?;
        let Some(body) = length.checked_sub(8).filter(|body| *body >= 4) else {
            return Err(ParquetError::NotWhole("it is too short"));
        };
        let (first, last) = (bytes(&mut reader, 0, 4)?, bytes(&mut reader, body, 8)?);
        let size = last.first_chunk().map_or(0, |size| u64::from(u32::from_le_bytes(*size)));
        if first != MAGIC || last.get(4..) != Some(&MAGIC) {
            return Err(ParquetError::NotWhole("it does not begin and end with PAR1"));
        }
        if size > (body - 4).min(FOOTER_MOST) {
            return Err(ParquetError::NotWhole("its footer is longer than the file"));
        }
        let text = bytes(&mut reader, body - size, size)?;
        let footer =
            Footer::read(&text).map_err(|_| ParquetError::NotWhole("its footer does not read"))?;
        let leaves = leaves(&footer.schema);
        let mut rows = 0_u64;
        for group in &footer.groups {
            let more = u64::try_from(group.rows).ok().and_then(|more| rows.checked_add(more));
            rows = more.ok_or(ParquetError::NotWhole("it claims too many rows"))?;
            if group.columns.len() != leaves.len() {
                return Err(ParquetError::NotWhole("a row group lacks columns"));
            }
        }
        if rows > length.saturating_mul(ROWS_PER_BYTE) {
            return Err(ParquetError::NotWhole("it claims more rows than it has room for"));
        }
        Ok(Self { reader, length, leaves, footer, rows })
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The columns' names, and what they hold; `None`: what is not read.
    pub fn columns(&self) -> impl Iterator<Item = (&str, Option<Kind>)> {
        self.leaves.iter().map(|leaf| (leaf.name.as_str(), leaf.kind()))
    }

    /// Where a column is.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.leaves.iter().position(|leaf| leaf.name == name && !leaf.nested)
    }

    /// Hands over these columns, so many rows at most at once, with the number of the first of them, from 0.
    ///
    /// # Errors
    ///
    /// [`ParquetError`]: a column is in a form that is not read, or broken; and whatever `each` says.
    pub fn read<E: From<ParquetError>>(
        &mut self,
        columns: &[usize],
        most: usize,
        mut each: impl FnMut(u64, &[Values]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut values = Vec::new();
        let mut first = 0;
        for column in columns {
            values.push(Values::new(self.kind(*column)?));
        }
        for group in 0..self.footer.groups.len() {
            let mut left = u64::try_from(self.footer.groups[group].rows).unwrap_or(0);
            let mut open = Vec::new();
            for column in columns {
                open.push(self.chunk(group, *column)?);
            }
            while left > 0 {
                let count = usize::try_from(left).unwrap_or(usize::MAX).min(most.max(1));
                for ((chunk, values), column) in open.iter_mut().zip(&mut values).zip(columns) {
                    values.clear();
                    let taken = chunk.take(&mut self.reader, count, values);
                    taken.map_err(|why| why.told(&self.leaves[*column].name))?;
                }
                each(first, &values)?;
                first += count as u64;
                left -= count as u64;
            }
        }
        Ok(())
    }

    fn kind(&self, column: usize) -> Result<Kind, ParquetError> {
        let Some(leaf) = self.leaves.get(column) else {
            return Err(ParquetError::NotWhole("it has fewer columns"));
        };
        leaf.kind().ok_or_else(|| ParquetError::Column {
            column: leaf.name.clone(),
            reason: "holds neither numbers nor flags nor texts".to_owned(),
        })
    }

    /// A column of a row group, before its first value.
    fn chunk(&self, group: usize, column: usize) -> Result<Chunk, ParquetError> {
        let (leaf, told) = (&self.leaves[column], &self.footer.groups[group].columns[column]);
        let refuse = |reason: String| ParquetError::Column { column: leaf.name.clone(), reason };
        if told.elsewhere || told.physical != leaf.physical {
            return Err(refuse("is not in this file as the schema says".to_owned()));
        }
        if told.codec != UNCOMPRESSED && told.codec != SNAPPY {
            let name = usize::try_from(told.codec).ok().and_then(|codec| CODECS.get(codec));
            let name = name.unwrap_or(&"something unknown");
            return Err(refuse(format!("is compressed by {name}; SNAPPY or none is read")));
        }
        let (at, end) = place(told, self.length)
            .ok_or_else(|| refuse("is said to be where the file has nothing".to_owned()))?;
        Ok(Chunk {
            at,
            end,
            codec: told.codec,
            physical: leaf.physical,
            nullable: leaf.nullable,
            dictionary: None,
            page: None,
        })
    }
}

/// From and to which byte a column of a row group goes.
fn place(told: &ColumnChunk, length: u64) -> Option<(u64, u64)> {
    let dictionary = told.dictionary_at.filter(|at| *at > 0);
    let at = dictionary.map_or(told.data_at, |dictionary| dictionary.min(told.data_at));
    let at = u64::try_from(at).ok()?;
    let end = at.checked_add(u64::try_from(told.size).ok()?)?;
    (end <= length).then_some((at, end))
}

/// The columns of a schema, which is a tree, its groups before what they hold.
fn leaves(schema: &[Element]) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    let mut top = true;
    // How many elements of each group around are still to come.
    let mut around: Vec<i64> = Vec::new();
    for element in schema {
        let nested = around.len() > 1;
        if let Some(left) = around.last_mut() {
            *left -= 1;
        }
        if let Some(physical) = element.physical {
            let (name, nullable) = (element.name.clone(), element.repetition == 1);
            let nested = nested || element.repetition > 1;
            leaves.push(Leaf { name, physical, nullable, nested });
        } else if top || element.children > 0 {
            around.push(element.children);
        }
        top = false;
        while around.last().is_some_and(|left| *left <= 0) {
            around.pop();
        }
    }
    leaves
}

impl Leaf {
    fn kind(&self) -> Option<Kind> {
        match self.physical {
            _ if self.nested => None,
            physical::BOOLEAN => Some(Kind::Flags),
            physical::INT32 | physical::INT64 => Some(Kind::Integers),
            physical::FLOAT | physical::DOUBLE => Some(Kind::Numbers),
            physical::BYTE_ARRAY => Some(Kind::Texts),
            _ => None,
        }
    }
}

/// A column of a row group, page by page.
#[derive(Debug)]
struct Chunk {
    at: u64,
    end: u64,
    codec: i64,
    physical: i64,
    nullable: bool,
    dictionary: Option<Dictionary>,
    page: Option<Page>,
}

/// Why a column does not read.
enum Why {
    Error(ParquetError),
    /// What is wrong in the page that ends at this byte.
    Page(u64, &'static str),
}

impl Why {
    fn told(self, column: &str) -> ParquetError {
        match self {
            Self::Error(why) => why,
            Self::Page(at, reason) => ParquetError::Column {
                column: column.to_owned(),
                reason: format!("{reason}, before byte {at}"),
            },
        }
    }
}

impl From<std::io::Error> for Why {
    fn from(why: std::io::Error) -> Self {
        Self::Error(why.into())
    }
}

impl Chunk {
    /// Takes the next values.
    fn take(
        &mut self,
        reader: &mut (impl Read + Seek),
        mut count: usize,
        into: &mut Values,
    ) -> Result<(), Why> {
        while count > 0 {
            let Some(page) = self.page.as_mut().filter(|page| page.left > 0) else {
                self.next(reader, into)?;
                continue;
            };
            let some = count.min(page.left);
            let taken = page.take(some, self.dictionary.as_ref(), into);
            taken.map_err(|why| Why::Page(self.at, why))?;
            count -= some;
        }
        Ok(())
    }

    /// Goes on to the next page of data.
    fn next(&mut self, reader: &mut (impl Read + Seek), into: &mut Values) -> Result<(), Why> {
        let (head, size) = self.head(reader)?;
        let body = self.at + size as u64;
        let end = u64::try_from(head.size).ok().and_then(|size| body.checked_add(size));
        let Some(end) = end.filter(|end| *end <= self.end) else {
            return Err(Why::Page(self.end, "a page is longer than its column"));
        };
        let bytes = bytes(reader, body, end - body)?;
        self.at = end;
        let told = |why| Why::Page(end, why);
        match head.kind {
            page_type::DATA | page_type::DATA_V2 => {
                let of = (self.codec, self.physical, self.nullable);
                self.page = Some(Page::new(&head, of, bytes).map_err(told)?);
            }
            page_type::DICTIONARY => {
                let plain = bare(self.codec, bytes, head.plain_size).map_err(told)?;
                let read = dictionary((self.physical, head.values), &plain, into);
                self.dictionary = Some(read.map_err(told)?);
            }
            // An index, or what a later version of the format has.
            _ => {}
        }
        Ok(())
    }

    /// The head of the next page, and how long it is.
    fn head(&self, reader: &mut (impl Read + Seek)) -> Result<(PageHead, usize), Why> {
        let left = self.end - self.at;
        if left == 0 {
            return Err(Why::Page(self.end, "it ends before its rows do"));
        }
        let mut room = HEAD;
        loop {
            let part = bytes(reader, self.at, room.min(left))?;
            match PageHead::read(&part) {
                Ok(read) => return Ok(read),
                Err(Broken::Ends) if room < left.min(HEAD_MOST) => room *= 16,
                Err(_) => return Err(Why::Page(self.at, "the head of a page does not read")),
            }
        }
    }
}

/// Bytes of a file whose length was looked at.
fn bytes(reader: &mut (impl Read + Seek), at: u64, count: u64) -> Result<Vec<u8>, std::io::Error> {
    reader.seek(SeekFrom::Start(at))?;
    let mut bytes = Vec::with_capacity(usize::try_from(count).unwrap_or(0));
    reader.take(count).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == count { Ok(bytes) } else { Err(ErrorKind::UnexpectedEof.into()) }
}
