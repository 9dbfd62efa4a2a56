//! The one way to the disk: files that belong together are there whole, or not at all.
//!
//! [`Whole`] prepares files next to their places; [`Whole::commit`] takes away the file that says that the
//! older ones are whole, moves the new ones in, and the one that says so of them last. [`Lock`] keeps a
//! second process out of a folder.

mod error;
mod folder;
mod lock;
mod rows;
mod seam;

use core::fmt;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use tempfile::TempPath;

pub use error::DiskError;
pub use folder::{folder_of, make_folder, sync_folder};
pub use lock::Lock;
pub use lock::locked;
pub use rows::{Growing, move_to, open_in_place, take_away, take_folder_away};
pub use seam::{Operation, strike, write_all};

use crate::hash::hexadecimal;

/// Files that are written whole or not at all; the last one added says that the others are.
///
/// Each is prepared beside its place under a name of its own, opened exclusively and synced. Nothing that was there is
/// touched before [`commit`](Self::commit).
#[derive(Debug, Default)]
pub struct Whole {
    ready: Vec<Ready>,
    stale: Vec<PathBuf>,
    /// Folders that were cleared of what a killed process left; `None` where another process may be at work.
    swept: Option<BTreeSet<PathBuf>>,
}

#[derive(Debug)]
struct Ready {
    path: PathBuf,
    partial: Partial,
}

impl Whole {
    /// Of files in folders where no other process is at work, since the caller holds a [`Lock`] or a journal there:
    /// what a killed process left half-written is removed.
    pub fn in_locked_folder() -> Self {
        Self { swept: Some(BTreeSet::new()), ..Self::default() }
    }

    /// Of files in a folder that the caller has locked, if there is a lock; else of files among which another
    /// process may prepare its own.
    pub fn where_held(lock: Option<&Lock>) -> Self {
        lock.map_or_else(Self::default, |_| Self::in_locked_folder())
    }

    /// Prepares a file; the SHA-256 of its bytes, hexadecimal.
    ///
    /// # Errors
    ///
    /// [`DiskError::Untouched`].
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<String, DiskError> {
        self.add_with(path, |file| file.write_all(bytes))
    }

    /// Prepares a file whose bytes `write` gives piece by piece; their SHA-256, hexadecimal.
    ///
    /// # Errors
    ///
    /// [`DiskError::Untouched`].
    pub fn add_with<E: fmt::Display>(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), E>,
    ) -> Result<String, DiskError> {
        let mut piece = self.begin(path)?;
        fill(&mut piece).map_err(|why| DiskError::untouched(path, why))?;
        self.end(piece)
    }

    /// Opens a file that is filled while other things happen; [`end`](Self::end) counts it in.
    ///
    /// # Errors
    ///
    /// [`DiskError::Untouched`].
    pub fn begin(&mut self, path: &Path) -> Result<Piece, DiskError> {
        let told = |error: io::Error| DiskError::untouched(path, error);
        let folder = folder_of(path);
        make_folder(folder).map_err(told)?;
        if path.is_dir() {
            return Err(DiskError::untouched(path, "it is a folder"));
        }
        self.sweep(folder).map_err(told)?;
        let (file, partial) = Partial::beside(path).map_err(told)?;
        let hashed = Hashed { file, path: partial.path().to_owned(), hash: Sha256::new() };
        let out = BufWriter::with_capacity(BUFFER, hashed);
        Ok(Piece { path: path.to_owned(), out, partial })
    }

    /// A file that was filled; the SHA-256 of its bytes, hexadecimal.
    ///
    /// # Errors
    ///
    /// [`DiskError::Untouched`].
    pub fn end(&mut self, piece: Piece) -> Result<String, DiskError> {
        let Piece { path, out, partial } = piece;
        let told = |error: io::Error| DiskError::untouched(&path, error);
        let Hashed { file, path: at, hash } = out.into_inner().map_err(|e| told(e.into_error()))?;
        strike(Operation::Sync, &at).and_then(|()| file.sync_all()).map_err(told)?;
        self.ready.push(Ready { path, partial });
        Ok(hexadecimal(&hash.finalize()))
    }

    /// A file of older results that the new ones do not have: it is removed before any new one is moved in.
    pub fn remove(&mut self, path: PathBuf) {
        if path.symlink_metadata().is_ok() {
            self.stale.push(path);
        }
    }

    /// Removes what a killed process left half-written in a folder, once, and where no other process is at work.
    fn sweep(&mut self, folder: &Path) -> io::Result<()> {
        let first = self.swept.as_mut().is_some_and(|swept| swept.insert(folder.to_owned()));
        if first { sweep(folder) } else { Ok(()) }
    }

    /// Moves every file to its place, the last one last. A file alone replaces the older one at once; of
    /// several, the older last one is removed before anything else changes, so that it never stands next to
    /// files that are not its own.
    ///
    /// # Errors
    ///
    /// [`DiskError`] says what is there now; what was not moved is removed.
    pub fn commit(mut self) -> Result<(), DiskError> {
        let places: Vec<_> = self.ready.iter().map(|file| file.path.clone()).collect();
        let Some(last) = places.last() else { return Ok(()) };
        for path in self.stale.clone() {
            self.sweep(folder_of(&path)).map_err(|why| DiskError::untouched(&path, why))?;
        }
        let several = places.len() + self.stale.len() > 1;
        if several {
            remove(last).map_err(|why| DiskError::untouched(last, why))?;
        }
        let mut moved = 0;
        let mut at = last.clone();
        let ready = std::mem::take(&mut self.ready);
        let folders: BTreeSet<_> = places.iter().map(|path| folder_of(path)).collect();
        let change = || -> io::Result<()> {
            for path in &self.stale {
                at.clone_from(path);
                remove(path)?;
            }
            // What was taken away is gone from the disk before anything new is there.
            if several {
                folder_of(last).clone_into(&mut at);
                sync_folder(&at)?;
            }
            for file in ready {
                at.clone_from(&file.path);
                if several && moved + 1 == places.len() {
                    folders.iter().try_for_each(|folder| sync_folder(folder))?;
                }
                file.partial.persist(&file.path)?;
                moved += 1;
            }
            Ok(())
        };
        if let Err(why) = change() {
            let (path, why) = (at, why.to_string());
            let (new, missing) = (places[..moved].to_vec(), places[moved..].to_vec());
            return Err(if several {
                DiskError::Broken { path, why, new, missing }
            } else {
                DiskError::Untouched { path, why }
            });
        }
        let path = folder_of(last).to_owned();
        sync_folder(&path).map_err(|why| DiskError::Unconfirmed { path, why: why.to_string() })
    }
}

/// Bytes that are written at once.
const BUFFER: usize = 1 << 18;

/// A file on its way: prepared beside its place, and gone with this unless [`Whole::end`] takes it.
#[derive(Debug)]
pub struct Piece {
    path: PathBuf,
    out: BufWriter<Hashed>,
    partial: Partial,
}

impl Piece {
    /// Path at which it is prepared.
    pub fn prepared_at(&self) -> &Path {
        self.partial.path()
    }
}

impl Write for Piece {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// A file whose bytes are hashed on their way.
#[derive(Debug)]
struct Hashed {
    file: File,
    path: PathBuf,
    hash: Sha256,
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_all(&mut self.file, &self.path, bytes)?;
        self.hash.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A file beside its place, under a name of its own; removed unless it is moved there.
#[derive(Debug)]
struct Partial(Option<TempPath>);

/// Suffix of the name of a partial file; the name begins with a dot.
const ENDING: &str = ".partial";

impl Partial {
    fn beside(path: &Path) -> io::Result<(File, Self)> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut builder = tempfile::Builder::new();
        let prefix = format!(".{name}.");
        builder.prefix(&prefix).suffix(ENDING);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As any other file: what the user's mask leaves of it.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        strike(Operation::Create, path)?;
        let (file, partial) = builder.tempfile_in(folder_of(path))?.into_parts();
        Ok((file, Self(Some(partial))))
    }

    fn path(&self) -> &Path {
        self.0.as_deref().unwrap_or(Path::new(""))
    }

    fn persist(mut self, path: &Path) -> io::Result<()> {
        strike(Operation::Move, path)?;
        self.0.take().map_or(Ok(()), |partial| partial.persist(path).map_err(|e| e.error))
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if let Some(partial) = self.0.take()
            && strike(Operation::Remove, &partial).is_err()
        {
            // The file stays for whoever sweeps the folder next; the failure is already being told.
            let _ = partial.keep();
        }
    }
}

/// Checks that a file can be made in a folder, by making one and removing it.
///
/// # Errors
///
/// Error of the operating system.
pub fn takes_files(folder: &Path) -> io::Result<()> {
    Partial::beside(&folder.join("phihat")).map(drop)
}

/// Removes a file if there is one.
fn remove(path: &Path) -> io::Result<()> {
    strike(Operation::Remove, path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

/// Removes what is prepared at a place, of a process that ends now; whatever stays is swept away by the next one.
pub fn discard(prepared: &Path) {
    let _ = remove(prepared);
}

/// Removes what a killed process left half-written in a folder.
fn sweep(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') && name.ends_with(ENDING) {
            remove(&folder.join(&*name))?;
        }
    }
    Ok(())
}
