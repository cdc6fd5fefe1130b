//! Triangles in STL files, binary and as text.
//!
//! The format has no units: a factor makes metres of its numbers.

use super::MeshFault;

/// Three corners, counter-clockwise seen from outside.
pub type Triangle = [[f64; 3]; 3];

const HEADER: usize = 84;
const RECORD: usize = 50;

/// Reads an STL file; corners in the numbers of the file.
///
/// # Errors
/// A file that is cut off or has more than it says, numbers that are not finite, text that is no STL, no triangles.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, MeshFault> {
    let triangles = match count(bytes) {
        // Some binary files begin with the word of the text format; their length tells.
        Some(n) if bytes.len() == HEADER + n * RECORD => binary(bytes)?,
        _ if bytes.trim_ascii_start().starts_with(b"solid") => ascii(bytes)?,
        Some(n) => {
            let reason = format!(
                "the header promises {n} triangles, {} bytes, but the file has {}",
                HEADER + n * RECORD,
                bytes.len()
            );
            return Err(MeshFault::new(reason, "the file is damaged or cut off; export it again"));
        }
        None => {
            let reason = format!("{} bytes are too few for an STL file", bytes.len());
            return Err(MeshFault::new(reason, "the file is damaged or cut off; export it again"));
        }
    };
    match triangles.is_empty() {
        true => Err(MeshFault::new("the file has no triangles", "export the part again")),
        false => Ok(triangles),
    }
}

/// Triangles that the header of a binary file promises.
fn count(bytes: &[u8]) -> Option<usize> {
    let four: [u8; 4] = bytes.get(80..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(four)).ok()
}

fn binary(bytes: &[u8]) -> Result<Vec<Triangle>, MeshFault> {
    let mut triangles = Vec::with_capacity((bytes.len() - HEADER) / RECORD);
    for (i, record) in bytes[HEADER..].chunks_exact(RECORD).enumerate() {
        let mut triangle = [[0.0; 3]; 3];
        // Twelve bytes of the normal come first, which follows from the corners.
        for (value, four) in triangle.iter_mut().flatten().zip(record[12..48].chunks_exact(4)) {
            *value = f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
        }
        if triangle.iter().flatten().any(|x| !x.is_finite()) {
            let reason = format!("triangle {} has a corner that is not finite", i + 1);
            return Err(MeshFault::new(reason, "export the part again"));
        }
        triangles.push(triangle);
    }
    Ok(triangles)
}

fn ascii(bytes: &[u8]) -> Result<Vec<Triangle>, MeshFault> {
    let mut triangles = Vec::new();
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    let mut ended = false;
    let fault = |line: usize, reason: String, remedy: &str| {
        Err(MeshFault { line: u32::try_from(line + 1).ok(), ..MeshFault::new(reason, remedy) })
    };
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        // Names of solids may be in any code; all else is ASCII.
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match word.to_ascii_lowercase().as_str() {
            "vertex" => match corner(rest) {
                Some(corner) if corners.len() < 3 => corners.push(corner),
                Some(_) => return fault(i, "a facet has a fourth vertex".into(), "STL has triangles only"),
                None => {
                    let reason = format!("`{}` are no three numbers", shown(rest));
                    return fault(
                        i,
                        reason,
                        "write three finite numbers with a decimal point and spaces between",
                    );
                }
            },
            "endfacet" => {
                let [a, b, c] = corners[..] else {
                    return fault(
                        i,
                        format!("a facet has {} vertices", corners.len()),
                        "export the part again",
                    );
                };
                triangles.push([a, b, c]);
                corners.clear();
            }
            "endsolid" => ended = true,
            "" | "solid" | "facet" | "outer" | "endloop" => {}
            _ => return fault(i, format!("`{}` is not a word of STL", shown(word)), "export the part again"),
        }
    }
    match ended && corners.is_empty() {
        true => Ok(triangles),
        false => {
            Err(MeshFault::new("the file ends before `endsolid`", "the file is cut off; export it again"))
        }
    }
}

fn corner(text: &str) -> Option<[f64; 3]> {
    let mut words = text.split_whitespace();
    let mut next = || words.next()?.parse::<f64>().ok().filter(|x| x.is_finite());
    let corner = [next()?, next()?, next()?];
    words.next().is_none().then_some(corner)
}

/// A text of the file as it is shown in a message: one line, not too long.
pub(super) fn shown(text: &str) -> String {
    text.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect()
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
        let mut bytes = b"solid made by a test".to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            triangle.iter().flatten().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    pub(crate) fn as_text(triangles: &[Triangle]) -> String {
        let mut text = "solid cuboid\n".to_owned();
        for triangle in triangles {
            text.push_str("  facet normal 0 0 0\n    outer loop\n");
            triangle.iter().for_each(|[x, y, z]| text.push_str(&format!("      vertex {x} {y} {z}\n")));
            text.push_str("    endloop\n  endfacet\n");
        }
        text + "endsolid cuboid\n"
    }

    fn refused(bytes: &[u8]) -> MeshFault {
        read(bytes).unwrap_err()
    }

    #[test]
    fn both_forms_hold_the_same_triangles() {
        let triangles = cuboid([0.5, -1.0, 0.25], [1.0, 2.0, 0.5]);
        assert_eq!(read(&as_binary(&triangles)), Ok(triangles.clone()));
        assert_eq!(read(as_text(&triangles).as_bytes()), Ok(triangles));
    }

    #[test]
    fn damaged_files_are_refused_with_the_reason() {
        let triangles = cuboid([0.0; 3], [1.0; 3]);
        let mut bytes = as_binary(&triangles);
        bytes[0] = b'x';
        assert!(refused(&bytes[..bytes.len() - 1]).reason.contains("promises 12 triangles"));
        assert!(refused(&bytes[..50]).reason.contains("too few"));
        let mut more = bytes.clone();
        more[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(refused(&more).reason.contains("promises 4294967295"));
        let mut nan = bytes.clone();
        nan[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(refused(&nan).reason.contains("triangle 2"));
        assert!(refused(&as_binary(&[])).reason.contains("no triangles"));
        let text = as_text(&triangles);
        assert!(refused(&text.as_bytes()[..text.len() - 16]).reason.contains("endsolid"));
        assert_eq!(refused(text.replacen("vertex 0 0 0", "vertex 0 nan 0", 1).as_bytes()).line, Some(4));
        assert!(
            refused(text.replacen("    endloop", "vertex 1 2 3", 1).as_bytes()).reason.contains("fourth")
        );
    }
}
