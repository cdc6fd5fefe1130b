// @ts-check
'use strict';
// Small charts of sweeps and of linear analysis: a plane, curves, and lines across parallel axes.
/* global R, uPlot */

/** @type {any} */ (R).Charts = (() => {
  const SVG = 'http://www.w3.org/2000/svg';
  /** @param {string} name @param {Record<string, string|number>} attributes @param {(Element|string)[]} children */
  const svg = (name, attributes, ...children) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
    made.append(...children);
    return made;
  };
  /** Round numbers within a range. @param {number} min @param {number} max @param {number} count */
  const ticks = (min, max, count) => {
    const raw = (max - min) / count, size = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((by) => by * size).find((by) => by >= raw) ?? raw;
    const all = [];
    for (let n = Math.ceil(min / step); n * step <= max + step * 1e-9 && all.length < 50; n++) all.push(n === 0 ? 0 : Number((n * step).toPrecision(12)));
    return all;
  };
  /** A range with room around it. @param {number[]} values @param {number} [room] @returns {[number, number]} */
  const around = (values, room = 0.07) => {
    let low = Infinity, high = -Infinity;
    for (const x of values) if (Number.isFinite(x)) { low = Math.min(low, x); high = Math.max(high, x); }
    if (!(low <= high)) return [-1, 1];
    const wide = high - low || Math.abs(high) || 1;
    return [low - room * wide, high + room * wide];
  };

  /** A plane with points and lines, all in one unit where `equal`.
   * @param {{label: string, axes: [string, string], equal?: boolean, marks: {x: number, y: number, sign: string, name: string, look?: string}[], lines?: {points: number[][], look: string}[], range?: [number, number, number, number]}} asked */
  const plane = ({ label, axes, equal, marks, lines = [], range }) => {
    const [width, height, left, bottom, top, right] = [520, 340, 58, 34, 10, 14];
    let [x0, x1, y0, y1] = range ?? [...around(marks.map((mark) => mark.x)), ...around(marks.map((mark) => mark.y))];
    const [wide, high] = [width - left - right, height - top - bottom];
    if (equal) {
      const per = Math.max((x1 - x0) / wide, (y1 - y0) / high), [cx, cy] = [(x0 + x1) / 2, (y0 + y1) / 2];
      [x0, x1, y0, y1] = [cx - per * wide / 2, cx + per * wide / 2, cy - per * high / 2, cy + per * high / 2];
    }
    const px = (/** @type {number} */ x) => left + (x - x0) / (x1 - x0) * wide, py = (/** @type {number} */ y) => top + (y1 - y) / (y1 - y0) * high;
    const made = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'plane-chart', role: 'img', 'aria-label': label });
    for (const x of ticks(x0, x1, 6)) made.append(svg('path', { class: x === 0 ? 'axis' : 'grid-line', d: `M${px(x)} ${top}v${high}` }), svg('text', { x: px(x), y: height - bottom + 14, 'text-anchor': 'middle' }, R.say(x, 4)));
    for (const y of ticks(y0, y1, 5)) made.append(svg('path', { class: y === 0 ? 'axis' : 'grid-line', d: `M${left} ${py(y)}h${wide}` }), svg('text', { x: left - 5, y: py(y) + 4, 'text-anchor': 'end' }, R.say(y, 4)));
    made.append(svg('text', { x: left + wide / 2, y: height - 4, 'text-anchor': 'middle', class: 'axis-name' }, axes[0]), svg('text', { x: 12, y: top + high / 2, 'text-anchor': 'middle', class: 'axis-name', transform: `rotate(-90 12 ${top + high / 2})` }, axes[1]));
    // What lies far outside of the frame is cut there.
    const frame = svg('svg', { x: left, y: top, width: wide, height: high, viewBox: `${left} ${top} ${wide} ${high}`, overflow: 'hidden' });
    const near = (/** @type {number} */ x) => Math.min(Math.max(x, -1e4), 1e4).toFixed(2);
    for (const { points, look } of lines) {
      const seen = points.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
      if (seen.length > 1) frame.append(svg('path', { class: look, d: `M${seen.map(([x, y]) => `${near(px(x))} ${near(py(y))}`).join('L')}` }));
    }
    for (const { x, y, sign, name, look = '' } of marks) {
      if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
      const [cx, cy] = [Number(near(px(x))), Number(near(py(y)))];
      const shape = sign === 'cross' ? svg('path', { d: `M${cx - 5} ${cy - 5}l10 10m0 -10l-10 10` }) : sign === 'plus' ? svg('path', { d: `M${cx - 6} ${cy}h12m-6 -6v12` }) : svg('circle', { cx, cy, r: sign === 'dot' ? 2.2 : 5 });
      const group = svg('g', { class: `sign ${sign} ${look}` }, svg('title', {}, name), shape);
      frame.append(group);
    }
    made.append(frame);
    return made;
  };

  /** Curves over a common axis. @param {HTMLElement} place
   * @param {{title: string, x: number[], series: {name: string, values: (number|null)[]}[], log?: boolean, across: string, height?: number}} asked */
  const curves = (place, { title, x, series, log, across, height = 190 }) => {
    const figure = R.make('figure', { class: 'card', 'aria-label': title }, R.make('figcaption', {}, R.make('span', { class: 'title' }, title)));
    const canvas = R.make('div', { class: 'canvas' });
    figure.append(canvas);
    if (series.length > 1) figure.append(R.make('div', { class: 'legend' }, ...series.map((one, n) => {
      const mark = R.make('i', { class: 'mark' });
      mark.style.borderColor = `var(--s${n % 6 + 1})`;
      return R.make('span', {}, mark, R.make('bdi', {}, one.name));
    })));
    place.append(figure);
    const colour = (/** @type {number} */ n) => () => R.colour(`s${n % 6 + 1}`);
    const axis = { stroke: () => R.colour('quiet'), grid: { stroke: () => R.colour('grid'), width: 1 }, ticks: { show: false }, font: '12px system-ui, sans-serif' };
    const u = new uPlot({
      width: Math.max(canvas.clientWidth, 260), height, legend: { show: false }, padding: [8, 24, 0, 0],
      scales: { x: { time: false, ...(log ? { distr: 3 } : {}) } }, cursor: { drag: { x: true, y: false } },
      series: [{ label: across }, ...series.map((one, n) => ({ label: one.name, stroke: colour(n), width: 2, points: { show: false } }))],
      axes: [{ ...axis, label: across, labelSize: 18, labelFont: '12px system-ui, sans-serif', size: 28, values: (/** @type {any} */ _, /** @type {(number|null)[]} */ all) => all.map((t) => t === null ? '' : R.say(t, 4)) },
        { ...axis, size: 62, values: (/** @type {any} */ _, /** @type {(number|null)[]} */ all) => all.map((t) => t === null ? '' : R.say(t, 5)) }],
    }, /** @type {any} */ ([x, ...series.map((one) => one.values)]), canvas);
    // The place may become wider or narrower later.
    const watch = new ResizeObserver(() => { if (!canvas.isConnected) watch.disconnect(); else if (canvas.clientWidth > 0 && Math.abs(canvas.clientWidth - u.width) > 1) u.setSize({ width: canvas.clientWidth, height }); });
    watch.observe(canvas);
    R.named(u, title);
    return u;
  };

  /** Lines across parallel axes, one for each row. @param {{label: string, axes: {name: string, values: (number|string)[]}[], chosen: number, on: (row: number) => void}} asked */
  const parallel = ({ label, axes, chosen, on }) => {
    const width = Math.max(480, 130 * axes.length), height = 300, top = 34, bottom = 26, side = 60;
    const at = (/** @type {number} */ n) => axes.length > 1 ? side + n * (width - 2 * side) / (axes.length - 1) : width / 2;
    const made = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'parallel', role: 'img', 'aria-label': label });
    const scales = axes.map(({ values }) => {
      // Words stand one above the other in the order in which they come.
      if (values.some((value) => typeof value === 'string')) {
        const words = [...new Set(values.map(String))];
        return { y: (/** @type {any} */ v) => words.length > 1 ? top + (words.length - 1 - words.indexOf(String(v))) / (words.length - 1) * (height - top - bottom) : (top + height - bottom) / 2, ends: words };
      }
      const known = /** @type {number[]} */ (values).filter(Number.isFinite), low = Math.min(...known), high = Math.max(...known);
      return { y: (/** @type {any} */ v) => !Number.isFinite(v) ? NaN : high > low ? top + (high - v) / (high - low) * (height - top - bottom) : (top + height - bottom) / 2, ends: known.length ? [R.say(low, 4), R.say(high, 4)] : [] };
    });
    axes.forEach(({ name }, n) => {
      made.append(svg('path', { class: 'axis', d: `M${at(n)} ${top}V${height - bottom}` }), svg('text', { x: at(n), y: 14, 'text-anchor': 'middle', class: 'axis-name' }, name.length > 22 ? `…${name.slice(-21)}` : name, svg('title', {}, name)));
      const ends = scales[n].ends;
      if (ends.length) made.append(svg('text', { x: at(n), y: height - 8, 'text-anchor': 'middle' }, String(ends[0])), svg('text', { x: at(n), y: 28, 'text-anchor': 'middle' }, String(ends[ends.length - 1])));
    });
    const rows = axes[0]?.values.length ?? 0;
    const line = (/** @type {number} */ row) => {
      const points = axes.map(({ values }, n) => [at(n), scales[n].y(values[row])]).filter(([, y]) => Number.isFinite(y));
      const path = svg('path', { class: `row${row === chosen ? ' chosen' : ''}`, d: `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}` }, svg('title', {}, axes.map(({ name, values }) => `${name} ${typeof values[row] === 'number' ? R.say(/** @type {number} */ (values[row]), 4) : values[row]}`).join(', ')));
      path.addEventListener('click', () => on(row));
      return path;
    };
    for (let row = 0; row < rows; row++) if (row !== chosen) made.append(line(row));
    if (chosen >= 0 && chosen < rows) made.append(line(chosen));
    return made;
  };
  return { plane, curves, parallel, around, svg };
})();
