// @ts-check
'use strict';
// Shapes as triangles with normals, and as lines for where there is no WebGL. Metres; axes of shapes along z.
/* global R */

R.Shapes = (() => {
  const ROUND = 28;
  /** @typedef {{triangles: number[], lines: number[]}} Mesh */

  /** A body of revolution: rings of [radius, z, normal outwards, normal upwards]. @param {number[][]} rings @returns {Mesh} */
  const turned = (rings) => {
    /** @type {Mesh} */ const mesh = { triangles: [], lines: [] };
    const at = (/** @type {number[]} */ ring, /** @type {number} */ n) => {
      const [c, s] = [Math.cos(n * 2 * Math.PI / ROUND), Math.sin(n * 2 * Math.PI / ROUND)];
      return [ring[0] * c, ring[0] * s, ring[1], ring[2] * c, ring[2] * s, ring[3]];
    };
    for (let k = 0; k + 1 < rings.length; k++) {
      const [low, high] = [rings[k], rings[k + 1]];
      for (let n = 0; n < ROUND; n++) {
        const [a, b, c, d] = [at(low, n), at(low, n + 1), at(high, n + 1), at(high, n)];
        mesh.triangles.push(...a, ...b, ...c, ...a, ...c, ...d);
        if (n % 7 === 0) mesh.lines.push(...a.slice(0, 3), ...d.slice(0, 3));
      }
    }
    for (const ring of rings.filter((r, k) => r[0] > 0 && (k === 0 || rings[k - 1][1] !== r[1]))) {
      for (let n = 0; n < ROUND; n += 2) mesh.lines.push(...at(ring, n).slice(0, 3), ...at(ring, n + 2).slice(0, 3));
    }
    return mesh;
  };

  /** Half or whole balls: rings from one angle to another. @param {number} r @param {number} from @param {number} to @param {number} z */
  const arc = (r, from, to, z) => Array.from({ length: 9 }, (_, k) => {
    const a = from + (to - from) * k / 8;
    return [r * Math.cos(a), z + r * Math.sin(a), Math.cos(a), Math.sin(a)];
  });

  /** @param {number[]} size @returns {Mesh} */
  const box = (size) => {
    /** @type {Mesh} */ const mesh = { triangles: [], lines: [] };
    const [x, y, z] = size.map((s) => s / 2);
    for (let axis = 0; axis < 3; axis++) {
      for (const side of [-1, 1]) {
        const corner = (/** @type {number} */ u, /** @type {number} */ v) => {
          const p = [0, 0, 0];
          p[axis] = side * [x, y, z][axis];
          p[(axis + 1) % 3] = u * side * [x, y, z][(axis + 1) % 3];
          p[(axis + 2) % 3] = v * [x, y, z][(axis + 2) % 3];
          const normal = [0, 0, 0];
          normal[axis] = side;
          return [...p, ...normal];
        };
        const [a, b, c, d] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        mesh.triangles.push(...a, ...b, ...c, ...a, ...c, ...d);
        for (const [p, q] of [[a, b], [b, c], [c, d], [d, a]]) mesh.lines.push(...p.slice(0, 3), ...q.slice(0, 3));
      }
    }
    return mesh;
  };

  /** @param {any} shape @returns {Mesh|null} */
  const mesh = (shape) => {
    const h = (shape.length ?? 0) / 2, r = shape.radius ?? 0, half = Math.PI / 2;
    switch (shape.kind) {
      case 'box': return box(shape.size);
      case 'cylinder': return turned([[0, -h, 0, -1], [r, -h, 0, -1], [r, -h, 1, 0], [r, h, 1, 0], [r, h, 0, 1], [0, h, 0, 1]]);
      case 'cone': {
        const slope = Math.hypot(2 * h, r - shape.top) || 1, [out, up] = [2 * h / slope, (r - shape.top) / slope];
        return turned([[0, -h, 0, -1], [r, -h, 0, -1], [r, -h, out, up], [shape.top, h, out, up], [shape.top, h, 0, 1], [0, h, 0, 1]]);
      }
      case 'sphere': return turned([...arc(r, -half, 0, 0), ...arc(r, 0, half, 0)]);
      case 'capsule': return turned([...arc(r, -half, 0, -h), ...arc(r, 0, half, h)]);
      default: return null;
    }
  };

  // Matrices of 4 x 4, column by column.
  /** @param {ArrayLike<number>} a @param {ArrayLike<number>} b */
  const times = (a, b) => {
    const c = new Float64Array(16);
    for (let column = 0; column < 4; column++) {
      for (let row = 0; row < 4; row++) {
        let sum = 0;
        for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
        c[4 * column + row] = sum;
      }
    }
    return c;
  };
  /** @param {{translation: number[], rotation: number[][]}} place */
  const placed = ({ translation: t, rotation: r }) => Float64Array.of(r[0][0], r[1][0], r[2][0], 0, r[0][1], r[1][1], r[2][1], 0, r[0][2], r[1][2], r[2][2], 0, t[0], t[1], t[2], 1);
  /** @param {number} w @param {number} x @param {number} y @param {number} z */
  const quaternion = (w, x, y, z) => {
    const n = 1 / (Math.hypot(w, x, y, z) || 1);
    [w, x, y, z] = [w * n, x * n, y * n, z * n];
    return Float64Array.of(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0, 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0, 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0, 0, 0, 0, 1);
  };

  /** How many positions a body's joint has. @param {any} motion */
  const freedoms = (motion) => ({ turn: 1, slide: 1, ball: 4 })[/** @type {'turn'} */ (motion.kind)] ?? 0;

  /** Where each body is in the world. @param {any} scene @param {(n: number) => number} position */
  const poses = (scene, position) => {
    /** @type {Float64Array[]} */ const all = [];
    let next = 0;
    for (const body of scene.bodies) {
      let at = body.matrix ??= placed(body);
      const motion = body.motion, axis = motion.axis;
      if (motion.kind === 'turn') {
        const half = position(next) / 2, s = Math.sin(half);
        at = times(at, quaternion(Math.cos(half), axis[0] * s, axis[1] * s, axis[2] * s));
      } else if (motion.kind === 'slide') {
        const x = position(next);
        at = times(at, Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, axis[0] * x, axis[1] * x, axis[2] * x, 1));
      } else if (motion.kind === 'ball') {
        at = times(at, quaternion(position(next), position(next + 1), position(next + 2), position(next + 3)));
      }
      next += freedoms(motion);
      all.push(body.parent === null || body.parent === undefined ? at : times(all[body.parent], at));
    }
    return all;
  };
  /** @param {ArrayLike<number>} m @param {number[]} p */
  const point = (m, p) => [0, 1, 2].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
  return { mesh, times, placed, poses, point };
})();
