//! Meshes from files, made fit to be drawn: read and checked, welded, simplified, and in few bits.

mod pack;
mod simplify;
pub mod stl;
mod surface;

use std::fmt;

pub use pack::Packed;
pub use simplify::simplified;
pub use stl::Triangle;
pub use surface::Surface;

/// What is wrong with a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFault {
    /// Line of a text, from 1.
    pub line: Option<u32>,
    /// What is wrong.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl MeshFault {
    pub(crate) fn new(reason: impl Into<String>, remedy: impl Into<String>) -> MeshFault {
        MeshFault { line: None, reason: reason.into(), remedy: remedy.into() }
    }
}

impl fmt::Display for MeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        f.write_str(&self.reason)
    }
}

impl std::error::Error for MeshFault {}

/// Reads the bytes of a mesh as one surface in metres: `scale` makes metres of its numbers along x, y and z. `name` tells
/// the kind by its ending; STL is read.
///
/// # Errors
/// A kind that is not read, a damaged file, a mesh without extent or beyond what numbers hold.
pub fn read(name: &str, bytes: &[u8], scale: [f64; 3]) -> Result<Surface, MeshFault> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    if !ending.eq_ignore_ascii_case("stl") {
        let reason = format!("meshes of the kind `.{}` are not drawn", stl::shown(ending));
        return Err(MeshFault::new(reason, "export the part as STL"));
    }
    let surface = Surface::welded(&stl::read(bytes)?, scale);
    match surface.triangles.is_empty() || !surface.corners.iter().flatten().all(|x| x.is_finite()) {
        true => Err(MeshFault::new("no triangle has an area", "check its scale, or export the part again")),
        false => Ok(surface),
    }
}
