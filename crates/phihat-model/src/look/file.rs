//! The file of a mesh: where it is, and what is in it.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::soup::{Result, Soup, TRIANGLES_MAX, Unread, plain};
use super::{collada, obj, stl};
use crate::input;

/// Largest mesh that is read \[bytes\].
const BYTES_MAX: u64 = 128 << 20;
/// Schemes by which a URDF names a package.
const SCHEMES: [&str; 2] = ["package://", "model://"];

/// Folders in which meshes are searched.
pub(super) struct Files<'a> {
    pub(super) urdf: &'a Path,
    /// The folder that nothing is read outside of.
    pub(super) within: Option<&'a Path>,
}

impl Files<'_> {
    /// Mesh of the file that a URDF names, if it has no more triangles than there is room for.
    pub(super) fn mesh(&self, name: &str, room: usize) -> Result<Soup> {
        let told = |why: &dyn core::fmt::Display| Unread::from(format!("{}: {why}", plain(name)));
        let path = self.path(name).ok_or_else(|| told(&"there is no such file"))?;
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let read = match &*extension {
            "stl" => stl::read,
            "obj" => obj::read,
            "dae" => collada::read,
            _ => return Err(told(&"meshes are read from .stl, .obj and .dae")),
        };
        let mut bytes = Vec::new();
        let opened = input::open(&path).map_err(|why| told(&why))?;
        opened.take(BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|why| told(&why))?;
        if bytes.len() as u64 > BYTES_MAX {
            return Err(told(&format!("it is larger than {} MiB", BYTES_MAX >> 20)));
        }
        let soup = read(&bytes, room).map_err(|why| told(&why))?;
        if soup.triangles.is_empty() {
            return Err(told(&"it has no triangles"));
        }
        if soup.triangles.len() > room {
            return Err(told(&format!("the meshes have more than {TRIANGLES_MAX} triangles")));
        }
        Ok(soup)
    }

    /// Path of an existing file in a place where files may be read: next to the URDF; a package's folder is
    /// the nearest of its name at or next to a folder that the URDF is in.
    fn path(&self, name: &str) -> Option<PathBuf> {
        let folder = self.urdf.canonicalize().ok()?.parent()?.to_owned();
        let found = match SCHEMES.iter().find_map(|scheme| name.strip_prefix(scheme)) {
            Some(rest) => {
                let (package, rest) = rest.split_once('/')?;
                let places = folder.ancestors().flat_map(|above| {
                    let own = above.file_name().is_some_and(|own| own == package);
                    let own = own.then(|| above.join(rest));
                    own.into_iter().chain([above.join(package).join(rest)])
                });
                places.into_iter().find(|path| path.is_file())?
            }
            None => folder.join(name.strip_prefix("file://").unwrap_or(name)),
        };
        let found = found.canonicalize().ok()?;
        let Some(within) = self.within else { return Some(found) };
        let within = within.canonicalize().ok()?;
        found.starts_with(within).then_some(found)
    }
}
