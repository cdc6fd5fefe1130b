// @ts-check
'use strict';
// Pictures of what the fields of a move mean: the speed of an axis over time, a line and an arc of the tool in space.
/* global R */

/** @type {any} */ (R).Sketch = (() => {
  const WIDTH = 320, HEIGHT = 128;
  const svg = (/** @type {any[]} */ ...all) => /** @type {any} */ (R).Charts.svg(...all);
  /** @param {string} d @param {string} look */
  const path = (d, look = '') => svg('path', { d, class: look });
  /** @param {number} x @param {number} y @param {string} words @param {string} anchor */
  const text = (x, y, words, anchor = 'middle') => svg('text', { x, y, 'text-anchor': anchor }, words);
  /** An arrow from one point to another. @param {number[]} from @param {number[]} to @param {string} look */
  const arrow = ([x0, y0], [x1, y1], look = '') => {
    const length = Math.hypot(x1 - x0, y1 - y0), [u, v] = [(x1 - x0) / length * 7, (y1 - y0) / length * 7];
    return path(`M${x0} ${y0}L${x1} ${y1}M${x1} ${y1}L${x1 - u - v / 2} ${y1 - v + u / 2}M${x1} ${y1}L${x1 - u + v / 2} ${y1 - v - u / 2}`, look);
  };
  const dot = (/** @type {number[]} */ [cx, cy]) => svg('circle', { cx, cy, r: 4 });
  /** The axes of the reference frame. */
  const frame = () => [arrow([28, 104], [76, 104]), arrow([28, 104], [58, 84]), arrow([28, 104], [28, 56]), text(84, 108, 'x'), text(66, 82, 'y'), text(28, 50, 'z')];

  /** The speed of one axis. */
  const joint = () => [
    arrow([30, 100], [306, 100]), arrow([30, 100], [30, 14]), text(306, 116, 'time', 'end'), text(36, 20, 'speed', 'start'),
    path('M30 100C58 100 62 34 92 34H220C250 34 254 100 282 100', 'course'),
    path('M92 34V108M30 34H92', 'thin'), text(156, 28, 'velocity, % of the maximum'), text(61, 122, 'acceleration'), text(251, 122, 'the same'),
    path('M30 108H92M220 108H282M220 34V108M282 100V108', 'thin'),
  ];
  /** A line of the tool. */
  const linear = () => [...frame(), path('M112 96L276 40', 'course'), dot([112, 96]), dot([276, 40]), text(112, 116, 'start'), text(276, 28, 'target'), arrow([150, 64], [206, 45]), text(168, 42, 'speed', 'end')];
  /** An arc of the tool. */
  const circular = () => [...frame(), path('M112 100C128 26 214 6 284 62', 'course'), dot([112, 100]), dot([178, 32]), dot([284, 62]), text(112, 120, 'start'), text(170, 22, 'through', 'end'), text(284, 82, 'target')];

  /** @type {Record<string, [() => Element[], string]>} */ const KINDS = {
    joint: [joint, 'All axes begin and end together; velocity and acceleration are those of the axis that takes longest.'],
    linear: [linear, 'The tool goes straight from where the start has it to the target, in mm of the reference frame of the robot, or of a work object.'],
    circular: [circular, 'The tool goes along the circle through start, a point in between and target.'],
  };
  /** The picture for a kind of move, with what it shows in words. @param {string} kind */
  const of = (kind) => {
    const [draw, caption] = KINDS[kind];
    return R.make('figure', { class: 'sketch', 'aria-label': 'What the fields mean' }, svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, 'aria-hidden': 'true' }, ...draw()), R.make('figcaption', { class: 'note' }, caption));
  };
  return { of };
})();
