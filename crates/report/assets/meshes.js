// @ts-check
'use strict';
// Meshes of files as triangles with normals: smooth where faces meet at a small angle, sharp at edges.
/* global R */

R.Meshes = (() => {
  const SMOOTH = Math.cos(35 * Math.PI / 180), FLAT = Math.cos(Math.PI / 180), MOST = 64, WIRES = 800;
  /** @type {WeakMap<object, {triangles: number[], lines: number[]}>} */ const made = new WeakMap();

  /** Numbers from their differences in 16 bits. @param {[number, number, number]} where */
  const summed = (where) => {
    const list = R.list(where);
    for (let n = 0, sum = 0; n < list.length; n++) list[n] = sum = (sum + list[n]) & 65535;
    return list;
  };

  /** @param {number[]} a @param {number[]} b */
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  /** @param {any} surface */
  const build = (surface) => {
    const steps = summed(surface.corners), count = steps.length / 3;
    const index = surface.small ? summed(surface.triangles) : R.list(surface.triangles), faces = index.length / 3;
    const corner = (/** @type {number} */ n) => [0, 1, 2].map((k) => surface.low[k] + surface.step[k] * steps[k * count + n]);
    const corners = Array.from({ length: count }, (_, n) => corner(n));
    const face = (/** @type {number} */ f) => [index[f], index[faces + f], index[2 * faces + f]];
    /** @type {number[][]} Faces around each corner. */ const around = Array.from({ length: count }, () => []);
    /** @type {number[][]} Normals as long as twice the area. */ const areas = [];
    /** @type {number[][]} */ const normals = [];
    for (let f = 0; f < faces; f++) {
      const [a, b, c] = face(f).map((n) => corners[n]);
      const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
      const area = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const size = Math.hypot(...area) || 1;
      areas.push(area);
      normals.push(area.map((x) => x / size));
      for (const n of face(f)) around[n].push(f);
    }
    /** @type {number[]} */ const triangles = [];
    /** @type {Map<number, number>} */ const edges = new Map();
    /** @type {{bend: number, ends: number[]}[]} Edges with the cosine between their faces. */ const bent = [];
    for (let f = 0; f < faces; f++) {
      const three = face(f);
      three.forEach((n, k) => {
        let normal = normals[f];
        if (around[n].length <= MOST) {
          const sum = [0, 0, 0];
          for (const other of around[n]) if (dot(normals[f], normals[other]) >= SMOOTH) areas[other].forEach((x, i) => { sum[i] += x; });
          const size = Math.hypot(...sum);
          if (size > 0) normal = sum.map((x) => x / size);
        }
        triangles.push(...corners[n], ...normal);
        const next = three[(k + 1) % 3], key = Math.min(n, next) * count + Math.max(n, next), other = edges.get(key);
        if (other === undefined) {
          edges.set(key, f);
        } else {
          edges.set(key, -1);
          const bend = other < 0 ? -1 : dot(normals[f], normals[other]);
          if (bend < FLAT) bent.push({ bend, ends: [n, next] });
        }
      });
    }
    // Edges with one face only are the rims of open surfaces.
    for (const [key, f] of edges) if (f >= 0) bent.push({ bend: -1, ends: [Math.floor(key / count), key % count] });
    if (!bent.length) for (const key of edges.keys()) bent.push({ bend: 1, ends: [Math.floor(key / count), key % count] });
    // As wires: all sharp edges, and of the others as many of the sharpest as make the shape.
    bent.sort((a, b) => a.bend - b.bend);
    const lines = bent.filter(({ bend }, n) => bend < SMOOTH || n < WIRES).flatMap(({ ends }) => ends.flatMap((n) => corners[n]));
    return { triangles, lines };
  };

  /** @param {any} shape @param {any[]|undefined} surfaces */
  const mesh = (shape, surfaces) => {
    const surface = surfaces?.[shape.surface];
    if (shape.kind !== 'mesh' || !surface) return null;
    let found = made.get(surface);
    if (!found) made.set(surface, found = build(surface));
    return found;
  };
  return { mesh };
})();
