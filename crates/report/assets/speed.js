// @ts-check
'use strict';
// The path of the tool by its speed: lines of one colour for each class of speed, and what the colours mean.
/* global R */

R.Speed = (() => {
  const CLASSES = 24;
  /** Cividis, which people with any vision of colours read alike: Nuñez, Anderton, Renslow, PLoS ONE 13 (2018) e0199239. From dark to light. */
  const CIVIDIS = [[0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120], [165, 156, 116], [195, 179, 105], [225, 204, 85], [254, 232, 56]];
  const isDark = () => document.documentElement.dataset.theme ? document.documentElement.dataset.theme === 'dark' : R.dark.matches;

  /** Colour of a share of the largest speed, red, green and blue from 0 to 1. The end of the scale that the ground swallows is left away. @param {number} share */
  const colour = (share) => {
    const [from, to] = isDark() ? [0.28, 1] : [0, 0.84], x = (from + (to - from) * Math.min(Math.max(share, 0), 1)) * (CIVIDIS.length - 1), n = Math.min(Math.floor(x), CIVIDIS.length - 2);
    return CIVIDIS[n].map((low, k) => (low + (CIVIDIS[n + 1][k] - low) * (x - n)) / 255);
  };

  /** Lines by the class of their speed. @param {number[][]} lines Ends of pieces, m, six numbers each. @param {number[][]} times How long each piece takes, s.
   * @returns {{classes: number[][], most: number}} The largest speed, m/s. */
  const sorted = (lines, times) => {
    const speed = (/** @type {number[]} */ line, /** @type {number} */ n, /** @type {number} */ dt) => dt > 0 ? Math.hypot(line[6 * n + 3] - line[6 * n], line[6 * n + 4] - line[6 * n + 1], line[6 * n + 5] - line[6 * n + 2]) / dt : NaN;
    let most = 0;
    lines.forEach((line, part) => times[part].forEach((dt, n) => { const v = speed(line, n, dt); if (v > most) most = v; }));
    /** @type {number[][]} */ const classes = Array.from({ length: CLASSES }, () => []);
    lines.forEach((line, part) => times[part].forEach((dt, n) => {
      const v = speed(line, n, dt), at = most > 0 ? Math.min(CLASSES - 1, Math.floor(v / most * CLASSES)) : 0;
      // A piece that takes no time has no speed.
      if (!Number.isNaN(v)) classes[at].push(...line.slice(6 * n, 6 * n + 6));
    }));
    return { classes, most };
  };
  /** @param {any} pen @param {number[][]} classes @param {any} place */
  const draw = (pen, classes, place) => classes.forEach((line, n) => line.length && pen.lines(line, place, [...colour((n + 0.5) / CLASSES), 1]));

  /** What the colours mean. @param {number} most Largest speed, m/s. @param {number} mean Over how long speeds are averaged, s. */
  const legend = (most, mean) => {
    const scale = R.make('i', { class: 'speed-scale' });
    scale.style.background = `linear-gradient(to right, ${Array.from({ length: 9 }, (_, n) => `rgb(${colour(n / 8).map((x) => Math.round(255 * x)).join(',')})`).join(',')})`;
    return R.make('span', { class: 'speed-legend', title: `Colours of the path: mean speeds over ${R.say(1000 * mean, 2)} ms each` }, 'Speed of the tool: 0 ', scale, ` ${R.say(1000 * most, 4)} mm/s`);
  };
  return { sorted, draw, legend };
})();
