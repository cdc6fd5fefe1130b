// @ts-check
'use strict';
// Least, largest and mean values of a course over a stretch of time, in steps that hardly grow with its length.
/* global R */

/** @typedef {{low: number, high: number, mean: number, rms: number}} Stretch */
R.Stretches = (() => {
  /** Points whose least and largest value are kept together. */
  const BLOCK = 128;
  /** @typedef {{area: Float64Array, square: Float64Array, known: Float64Array, low: Float64Array, high: Float64Array}} Sums */
  /** @type {WeakMap<object, Sums>} */ const made = new WeakMap();

  /** Time that is known, area and area of the squares of one interval: straight between its ends, or held. Exact.
   * @param {number} wide @param {number} a @param {number} b @param {boolean} held */
  const part = (wide, a, b, held) => {
    if (!(wide > 0) || !Number.isFinite(a) || (!held && !Number.isFinite(b))) return [0, 0, 0];
    return held ? [wide, a * wide, a * a * wide] : [wide, (a + b) / 2 * wide, (a * a + a * b + b * b) / 3 * wide];
  };

  /** Sums up to each point, made once. @param {ArrayLike<number>} time @param {any} values @param {boolean} held @returns {Sums} */
  const sums = (time, values, held) => {
    const found = made.get(values);
    if (found) return found;
    const count = time.length, blocks = Math.ceil(count / BLOCK);
    const all = { area: new Float64Array(count), square: new Float64Array(count), known: new Float64Array(count), low: new Float64Array(blocks).fill(Infinity), high: new Float64Array(blocks).fill(-Infinity) };
    for (let n = 0; n < count; n++) {
      const x = values[n], block = Math.floor(n / BLOCK);
      if (Number.isFinite(x)) { all.low[block] = Math.min(all.low[block], x); all.high[block] = Math.max(all.high[block], x); }
      if (n === 0) continue;
      const [wide, area, square] = part(time[n] - time[n - 1], values[n - 1], x, held);
      all.known[n] = all.known[n - 1] + wide;
      all.area[n] = all.area[n - 1] + area;
      all.square[n] = all.square[n - 1] + square;
    }
    made.set(values, all);
    return all;
  };

  /** Of the points at or before a time the last one; −1 where there is none. @param {ArrayLike<number>} time @param {number} t */
  const last = (time, t) => {
    let low = 0, high = time.length;
    while (low < high) { const middle = (low + high) >> 1; if (time[middle] <= t) low = middle + 1; else high = middle; }
    return low - 1;
  };

  /** What a course is between two times. @param {ArrayLike<number>} time @param {ArrayLike<number>} values @param {boolean} held @param {number} from @param {number} to @returns {Stretch} */
  const of = (time, values, held, from, to) => {
    const nothing = { low: NaN, high: NaN, mean: NaN, rms: NaN };
    if (!time.length || !(to >= from)) return nothing;
    from = Math.max(from, time[0]);
    to = Math.min(to, time[time.length - 1]);
    if (from > to) return nothing;
    const all = sums(time, values, held), [a, b] = [from, to].map((t) => R.at(time, values, t, held));
    const up = (/** @type {number} */ t, /** @type {number} */ x) => {
      const n = last(time, t), [wide, area, square] = part(t - time[n], values[n], x, held);
      return [all.known[n] + wide, all.area[n] + area, all.square[n] + square];
    };
    const [begin, end] = [up(from, a), up(to, b)], [known, area, square] = end.map((x, k) => x - begin[k]);
    let [low, high] = [Infinity, -Infinity];
    const take = (/** @type {number} */ x) => { if (Number.isFinite(x)) { low = Math.min(low, x); high = Math.max(high, x); } };
    take(a);
    take(b);
    const stop = last(time, to);
    // Both values of a jump at the beginning count.
    for (let n = last(time, from) + (time[last(time, from)] < from ? 1 : 0); n <= stop;) {
      if (n % BLOCK === 0 && n + BLOCK - 1 <= stop) {
        const block = n / BLOCK;
        if (all.low[block] <= all.high[block]) { take(all.low[block]); take(all.high[block]); }
        n += BLOCK;
      } else take(values[n++]);
    }
    if (low > high) return nothing;
    // Of one instant the value is all there is.
    if (!(known > 0)) return { low, high, mean: (a + b) / 2, rms: Math.abs((a + b) / 2) };
    return { low, high, mean: area / known, rms: Math.sqrt(Math.max(square, 0) / known) };
  };
  return { of };
})();
