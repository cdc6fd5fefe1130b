//! Vectors and rotations of space as plain numbers.

/// A vector.
pub type V3 = [f64; 3];
/// A rotation matrix, row by row.
pub type M3 = [[f64; 3]; 3];

pub fn add(a: V3, b: V3) -> V3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn scaled(a: V3, k: f64) -> V3 {
    a.map(|x| k * x)
}

pub fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// From the child to the parent.
pub fn turned(r: &M3, a: V3) -> V3 {
    [dot(r[0], a), dot(r[1], a), dot(r[2], a)]
}

/// From the parent to the child.
pub fn turned_back(r: &M3, a: V3) -> V3 {
    add(add(scaled(r[0], a[0]), scaled(r[1], a[1])), scaled(r[2], a[2]))
}

/// A turn by `angle` (rad) about `axis`, a unit vector (Rodrigues).
pub fn turn(axis: V3, angle: f64) -> M3 {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = axis;
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

/// Roll, pitch and yaw (rad): `Rz(yaw) Ry(pitch) Rx(roll)`.
pub fn rpy(angles: V3) -> M3 {
    let roll = turn([1.0, 0.0, 0.0], angles[0]);
    let pitch = turn([0.0, 1.0, 0.0], angles[1]);
    let yaw = turn([0.0, 0.0, 1.0], angles[2]);
    product(&yaw, &product(&pitch, &roll))
}

fn product(a: &M3, b: &M3) -> M3 {
    a.map(|row| turned_back(b, row))
}
