//! Triangles in STL files, binary and as text.

use std::path::Path;

use blocksim_scene::mesh::stl;
pub use blocksim_scene::mesh::stl::Triangle;

use crate::fault::Fault;

/// Reads an STL file; corners in the numbers of the file.
///
/// # Errors
/// A file that is cut off or has more than it says, numbers that are not finite, text that is no STL, no triangles.
pub fn read(file: &Path, bytes: &[u8]) -> Result<Vec<Triangle>, Fault> {
    stl::read(bytes).map_err(|fault| {
        let told = Fault::new(file, fault.reason, fault.remedy);
        match fault.line {
            Some(line) => told.at(line),
            None => told,
        }
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A box with a corner at `low`, as triangles.
    pub(crate) fn cuboid(low: [f64; 3], size: [f64; 3]) -> Vec<Triangle> {
        let corner = |i: usize| [0, 1, 2].map(|k| low[k] + if i >> k & 1 == 1 { size[k] } else { 0.0 });
        // Each face by its corners, bits x, y, z, counter-clockwise from outside.
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        halves.map(|triangle| triangle.map(corner)).collect()
    }

    pub(crate) fn as_binary(triangles: &[Triangle]) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            triangle.iter().flatten().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn a_fault_of_a_mesh_has_its_file_and_line() {
        let fault = read(Path::new("a.stl"), b"solid a\nvertex 1 2\nendsolid").unwrap_err();
        assert_eq!((fault.file.as_path(), fault.line), (Path::new("a.stl"), Some(2)));
        assert_eq!(read(Path::new("a.stl"), &as_binary(&cuboid([0.0; 3], [1.0; 3]))).unwrap().len(), 12);
    }
}
