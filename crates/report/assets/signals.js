// @ts-check
'use strict';
// Recorded signals by their place in the page: what they are at the present time, and a picture of those that have none.
/* global R */

/** @typedef {{path: string, unit: string, panel: any, held: boolean, time: ArrayLike<number>, values: ArrayLike<number>, off: number, say: () => string}} Signal */
R.Signals = (() => {
  /** @type {Signal[]} Signals that no picture shows. */ let unseen = [];

  /** @param {ArrayLike<number>} values */
  const size = (values) => {
    let most = 0;
    for (let n = 0; n < values.length; n++) if (Number.isFinite(values[n])) most = Math.max(most, Math.abs(values[n]));
    return most;
  };
  /** A signal that can say its present value. @param {any} known @returns {Signal} */
  const speaking = (known) => {
    // What is far smaller than the signal ever is, is rounding.
    let floor = -1;
    known.say = () => {
      if (floor < 0) floor = Math.max(size(known.values) * 1e-7, 0);
      const x = R.at(known.time, known.values, R.now, known.held);
      return R.quantity(Math.abs(x) < floor ? 0 : x, known.unit, 4, known.off);
    };
    return known;
  };

  /** The signal at a place: in a picture, or among those that have none (−1). @param {number} at @param {number} place @returns {Signal} */
  const of = (at, place) => {
    if (at < 0) return unseen[place];
    const panel = R.data.panels[at], s = panel.byOrder[place];
    return s.signal ??= speaking({ path: s.path, unit: panel.unit, panel, held: s.held, time: panel.time, values: s.values, off: 0 });
  };

  /** All signals of the page, each once. @returns {Signal[]} */
  const all = () => {
    /** @type {Map<string, Signal>} */ const found = new Map();
    R.data.panels.forEach((/** @type {any} */ panel, /** @type {number} */ at) => panel.byOrder.forEach((/** @type {any} */ s, /** @type {number} */ n) => { if (!found.has(s.path)) found.set(s.path, of(at, n)); }));
    for (const signal of unseen) if (!found.has(signal.path)) found.set(signal.path, signal);
    return [...found.values()];
  };

  /** Shows a signal over time, in a picture of its own where it has none. @param {Signal} signal */
  const show = (signal) => {
    if (!signal.panel) {
      const port = signal.path.slice(signal.path.indexOf('.') + 1);
      signal.panel = { group: 'Asked for', title: signal.path, unit: signal.unit, pair: null, time: signal.time, series: [{ name: port, path: signal.path, role: 'plain', held: signal.held, values: signal.values, signal }] };
      R.Plots.add(signal.panel);
    }
    R.Plots.find(signal.path);
  };

  /** @param {any} texts */
  const build = (texts) => {
    const { counts, time, values, off } = R.data.unseen;
    const [times, all, tolerances] = [time, values, off].map(R.list);
    let from = 0;
    unseen = (texts.unseen ?? []).map((/** @type {[string, string, number]} */ [path, unit, held], /** @type {number} */ n) => {
      const [begin, end] = [from, from += counts[n]];
      return speaking({ path, unit, panel: null, held: held === 1, time: times.subarray(begin, end), values: all.subarray(begin, end), off: tolerances[n] });
    });
  };
  return { build, of, all, show };
})();
