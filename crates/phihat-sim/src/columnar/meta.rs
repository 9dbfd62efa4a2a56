//! The documents inside of a Parquet file: its footer, and the head of a page.

use super::thrift::{BINARY, BOOL_TRUE, Broken, I32, In, Out, STRUCT};
use super::{SNAPPY, encoding, page_type, physical};

/// Columns and groups of columns, at most.
const ELEMENTS: usize = 10_000;

/// A column's place in the footer's schema.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    /// `None`: it is a group.
    pub(super) physical: Option<i64>,
    /// 0 required, 1 optional, 2 repeated.
    pub(super) repetition: i64,
    pub(super) children: i64,
}

/// A column of a row group.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct ColumnChunk {
    pub(super) physical: i64,
    pub(super) codec: i64,
    pub(super) data_at: i64,
    pub(super) dictionary_at: Option<i64>,
    pub(super) size: i64,
    /// Bytes before compression, and values: for those who write.
    pub(super) plain_size: i64,
    pub(super) values: i64,
    pub(super) name: &'static str,
    /// In another file, or encrypted.
    pub(super) elsewhere: bool,
}

#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct RowGroup {
    pub(super) rows: i64,
    pub(super) columns: Vec<ColumnChunk>,
}

#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Footer {
    pub(super) schema: Vec<Element>,
    pub(super) groups: Vec<RowGroup>,
}

impl Footer {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Broken> {
        let mut footer = Self::default();
        In::new(bytes).fields(|inside, id, _| {
            match id {
                2 => inside.list(STRUCT, |inside| {
                    footer.schema.push(element(inside)?);
                    fine(footer.schema.len() <= ELEMENTS)
                })?,
                4 => inside.list(STRUCT, |inside| {
                    footer.groups.push(group(inside, footer.schema.len())?);
                    Ok(())
                })?,
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        Ok(footer)
    }

    /// The document, with the name of its writer.
    pub(super) fn write(&self, by: &str) -> Vec<u8> {
        let mut out = Out::default();
        out.structure(|out| {
            out.i32(1, 1);
            out.list((2, STRUCT), &self.schema, |out, element| {
                out.structure(|out| element.write(out));
            });
            out.i64(3, self.groups.iter().map(|group| group.rows).sum());
            out.list((4, STRUCT), &self.groups, |out, group| out.structure(|out| group.write(out)));
            out.text(6, by);
        });
        out.bytes
    }
}

fn element(inside: &mut In<'_>) -> Result<Element, Broken> {
    let mut element = Element::default();
    inside.fields(|inside, id, _| {
        match id {
            1 => element.physical = Some(inside.integer()?),
            3 => element.repetition = inside.integer()?,
            4 => element.name = String::from_utf8_lossy(inside.binary()?).into_owned(),
            5 => element.children = inside.integer()?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    Ok(element)
}

impl Element {
    fn write(&self, out: &mut Out) {
        let Some(kind) = self.physical else {
            out.text(4, &self.name);
            out.i32(5, self.children);
            return;
        };
        out.i32(1, kind);
        out.i32(3, self.repetition);
        out.text(4, &self.name);
        if kind == physical::BYTE_ARRAY {
            // UTF-8: as it was said first, and as it is said now.
            out.i32(6, 0);
            out.inner(10, |out| out.inner(1, |_| ()));
        }
    }
}

/// An empty structure is a byte: what cannot be is told before there are many of it.
fn fine(so: bool) -> Result<(), Broken> {
    if so { Ok(()) } else { Err(Broken::Malformed) }
}

fn group(inside: &mut In<'_>, elements: usize) -> Result<RowGroup, Broken> {
    let mut group = RowGroup::default();
    inside.fields(|inside, id, _| {
        match id {
            1 => inside.list(STRUCT, |inside| {
                group.columns.push(chunk(inside)?);
                fine(group.columns.len() <= elements)
            })?,
            3 => group.rows = inside.integer()?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    fine(!group.columns.is_empty())?;
    Ok(group)
}

impl RowGroup {
    fn write(&self, out: &mut Out) {
        out.list((1, STRUCT), &self.columns, |out, chunk| {
            out.structure(|out| {
                out.i64(2, chunk.dictionary_at.unwrap_or(chunk.data_at));
                out.inner(3, |out| chunk.write(out));
            });
        });
        out.i64(2, self.columns.iter().map(|chunk| chunk.plain_size).sum());
        out.i64(3, self.rows);
        let first = self.columns.first().map_or(0, |c| c.dictionary_at.unwrap_or(c.data_at));
        out.i64(5, first);
        out.i64(6, self.columns.iter().map(|chunk| chunk.size).sum());
    }
}

fn chunk(inside: &mut In<'_>) -> Result<ColumnChunk, Broken> {
    let mut chunk = ColumnChunk::default();
    inside.fields(|inside, id, _| {
        match id {
            1 => chunk.elsewhere |= !inside.binary()?.is_empty(),
            3 => inside.fields(|inside, id, _| about(&mut chunk, inside, id))?,
            8 => {
                chunk.elsewhere = true;
                return Ok(false);
            }
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    fine(chunk.data_at > 0)?;
    Ok(chunk)
}

fn about(chunk: &mut ColumnChunk, inside: &mut In<'_>, id: i64) -> Result<bool, Broken> {
    match id {
        1 => chunk.physical = inside.integer()?,
        4 => chunk.codec = inside.integer()?,
        5 => chunk.values = inside.integer()?,
        7 => chunk.size = inside.integer()?,
        9 => chunk.data_at = inside.integer()?,
        11 => chunk.dictionary_at = Some(inside.integer()?),
        _ => return Ok(false),
    }
    Ok(true)
}

impl ColumnChunk {
    fn write(&self, out: &mut Out) {
        let encodings: &[i64] = match self.physical {
            physical::BYTE_ARRAY => &[encoding::PLAIN, encoding::RLE_DICTIONARY],
            physical::DOUBLE => &[encoding::BYTE_STREAM_SPLIT],
            _ => &[encoding::PLAIN],
        };
        out.i32(1, self.physical);
        out.list((2, I32), encodings, |out, encoding| out.integer(*encoding));
        out.list((3, BINARY), &[self.name], |out, name| out.element(name));
        out.i32(4, SNAPPY);
        out.i64(5, self.values);
        out.i64(6, self.plain_size);
        out.i64(7, self.size);
        out.i64(9, self.data_at);
        if let Some(at) = self.dictionary_at {
            out.i64(11, at);
        }
    }
}

/// What stands before a page.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct PageHead {
    pub(super) kind: i64,
    pub(super) plain_size: i64,
    pub(super) size: i64,
    pub(super) values: i64,
    pub(super) encoding: i64,
    /// How the levels of a page are written.
    pub(super) level_encoding: i64,
    /// In pages of the second version: bytes of repetition and definition levels, and whether the rest is not compressed.
    pub(super) repetition_size: i64,
    pub(super) definition_size: i64,
    pub(super) bare: bool,
}

impl PageHead {
    /// With the number of its bytes.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, usize), Broken> {
        let mut head = Self { level_encoding: encoding::RLE, ..Self::default() };
        let mut inside = In::new(bytes);
        inside.fields(|inside, id, _| {
            match id {
                1 => head.kind = inside.integer()?,
                2 => head.plain_size = inside.integer()?,
                3 => head.size = inside.integer()?,
                5 | 7 => inside.fields(|inside, id, _| head.of_data(inside, id))?,
                8 => inside.fields(|inside, id, kind| head.of_second(inside, (id, kind)))?,
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        Ok((head, inside.at()))
    }

    /// A page of data or a dictionary.
    fn of_data(&mut self, inside: &mut In<'_>, id: i64) -> Result<bool, Broken> {
        match id {
            1 => self.values = inside.integer()?,
            2 => self.encoding = inside.integer()?,
            // A dictionary has a flag there, which takes no bytes: its kind of page does not ask.
            3 if self.kind == page_type::DATA => self.level_encoding = inside.integer()?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn of_second(&mut self, inside: &mut In<'_>, (id, kind): (i64, u8)) -> Result<bool, Broken> {
        match id {
            1 => self.values = inside.integer()?,
            4 => self.encoding = inside.integer()?,
            5 => self.definition_size = inside.integer()?,
            6 => self.repetition_size = inside.integer()?,
            7 => self.bare = kind != BOOL_TRUE,
            _ => return Ok(false),
        }
        Ok(true)
    }

    pub(super) fn write(&self) -> Vec<u8> {
        let mut out = Out::default();
        out.structure(|out| {
            out.i32(1, self.kind);
            out.i32(2, self.plain_size);
            out.i32(3, self.size);
            let dictionary = self.kind == page_type::DICTIONARY;
            out.inner(if dictionary { 7 } else { 5 }, |out| {
                out.i32(1, self.values);
                out.i32(2, self.encoding);
                if !dictionary {
                    out.i32(3, encoding::RLE);
                    out.i32(4, encoding::RLE);
                }
            });
        });
        out.bytes
    }
}
