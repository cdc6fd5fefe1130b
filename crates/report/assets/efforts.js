// @ts-check
'use strict';
// What the actuators of the joints exert: an arc round the axis of each joint that turns, an arrow along that of one that slides.
/* global R */

/** The arcs of a mechanism. @param {any} scene @param {{body: number, signal: string, largest: number, values: ArrayLike<number>}[]} given */
R.efforts = (scene, given) => {
  const S = R.Shapes;
  /** A full arc, rad, and how many lengths an arc can have. */
  const FULL = 1.5 * Math.PI, LEVELS = 108;
  const all = given.filter((one) => scene.bodies[one.body]?.motion.axis);
  /** Meshes about z by their length. @type {Map<string, any>} */ const meshes = new Map();

  /** @param {number[][]} corners Triangles, one corner after the other. @param {number[]} normal @param {number[][]} edge */
  const flat = (corners, normal, edge) => ({ plain: true, triangles: corners.flatMap((corner) => [...corner, ...normal]), lines: edge.slice(1).flatMap((to, n) => [...edge[n], ...to]) });
  /** A band about z with a head where it ends, of radius 1. @param {number} level Signed. */
  const arc = (level) => {
    const end = FULL * level / LEVELS, head = Math.min(Math.abs(end), 0.28) * Math.sign(end), neck = end - head, parts = Math.max(1, Math.ceil(Math.abs(neck) / 0.09));
    const at = (/** @type {number} */ angle, /** @type {number} */ r) => [r * Math.cos(angle), r * Math.sin(angle), 0];
    /** @type {number[][]} */ const corners = [], edge = [at(0, 1)];
    for (let k = 0; k < parts; k++) {
      const [p, q] = [neck * k / parts, neck * (k + 1) / parts];
      corners.push(at(p, 0.93), at(p, 1.07), at(q, 1.07), at(p, 0.93), at(q, 1.07), at(q, 0.93));
      edge.push(at(q, 1));
    }
    corners.push(at(neck, 0.82), at(neck, 1.18), at(end, 1));
    edge.push(at(neck, 1.18), at(end, 1), at(neck, 0.82), at(neck, 1));
    return flat(corners, [0, 0, 1], edge);
  };
  /** An arrow along z of length 1 at most, seen from two sides. @param {number} level Signed. */
  const arrow = (level) => {
    const end = 2 * level / LEVELS, head = Math.min(Math.abs(end), 0.24) * Math.sign(end), neck = end - head;
    const at = (/** @type {number} */ z, /** @type {number} */ r, /** @type {number} */ side) => side ? [r, 0, z] : [0, r, z];
    const corners = [0, 1].flatMap((side) => [at(0, -0.06, side), at(0, 0.06, side), at(neck, 0.06, side), at(0, -0.06, side), at(neck, 0.06, side), at(neck, -0.06, side), at(neck, -0.18, side), at(neck, 0.18, side), at(end, 0, side)]);
    return flat(corners, [0.6, 0.6, 0.5], [at(0, 0, 0), at(neck, 0, 0), at(neck, 0.18, 0), at(end, 0, 0), at(neck, -0.18, 0), at(neck, 0, 0)]);
  };
  /** @param {string} kind @param {number} level */
  const mesh = (kind, level) => {
    const key = `${kind} ${level}`;
    let found = meshes.get(key);
    if (!found) meshes.set(key, found = kind === 'turn' ? arc(level) : arrow(level));
    return found;
  };
  /** From the axis of a joint to z, at a size. @param {number[]} axis @param {number} size */
  const towards = (axis, size) => {
    const length = Math.hypot(...axis) || 1, z = axis.map((x) => x / length), away = Math.abs(z[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0];
    const cross = (/** @type {number[]} */ p, /** @type {number[]} */ q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const across = cross(away, z), l = Math.hypot(...across), x = across.map((u) => u / l), y = cross(z, x);
    return Float64Array.of(...x.map((u) => u * size), 0, ...y.map((u) => u * size), 0, ...z.map((u) => u * size), 0, 0, 0, 0, 1);
  };
  // As large as suits the mechanism.
  const home = S.poses(scene, () => 0), size = 0.14 * Math.max(...home.map((/** @type {Float64Array} */ at) => Math.hypot(at[12], at[13], at[14])), 0.1);
  const places = all.map((one) => {
    const body = scene.bodies[one.body];
    return { parent: body.parent, local: S.times(body.matrix ?? S.placed(body), towards(body.motion.axis, size)), kind: body.motion.kind, unit: body.motion.kind === 'turn' ? 'N·m' : 'N' };
  });

  /** @param {number} n @param {ArrayLike<number>} time @param {number} t */
  const value = (n, time, t) => R.at(time, all[n].values, Math.min(Math.max(t, time[0]), time[time.length - 1]));
  /** @param {any} pen @param {Float64Array[]} here @param {ArrayLike<number>} time @param {(n: number) => number[]} colour */
  const draw = (pen, here, time, colour) => all.forEach((one, n) => {
    const { parent, local, kind } = places[n], level = one.largest > 0 ? Math.round(LEVELS * value(n, time, R.now) / one.largest) : 0;
    if (!level || Number.isNaN(level)) return;
    pen.solid(mesh(kind, Math.min(Math.max(level, -LEVELS), LEVELS)), parent === null || parent === undefined ? local : S.times(here[parent], local), [...colour(n), 0.95]);
  });

  /** What the arcs mean. */
  const legend = () => R.make('span', { class: 'effort-legend' }, `${[...new Set(places.map(({ kind }) => kind === 'turn' ? 'Arcs are the torques of the actuators, counter-clockwise about the axis of the joint where they are positive.' : 'Arrows are the forces of the actuators, along the axis of the joint where they are positive.'))].join(' ')} In full (${[...new Set(places.map(({ kind }) => kind === 'turn' ? '¾ of a turn' : 'a whole arrow'))].join(', ')}) they are the largest of each joint in this run: ${all.map((one, n) => `${scene.bodies[one.body].name} ${R.say(one.largest, 3)} ${places[n].unit}`).join(', ')}.`);
  return { all, value, draw, legend, unit: (/** @type {number} */ n) => places[n].unit };
};
