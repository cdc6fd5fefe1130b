// @ts-check
'use strict';
// One picture: signals over time with legend and cursors, and a strip with the error below where set and actual values are
// paired.
/* global R, uPlot */

R.Picture = (() => {
  /** Width kept for numbers at the left, so that times lie below each other. */
  const GUTTER = 70;
  /** Height of truth in its lane. */
  const LANE = 0.7;

  /** @param {number} n */
  const series = (n) => () => R.colour('s' + (n % 6 + 1));

  /** Colour of a signal: the joint's number gives it where the picture is about one. */
  const tint = (/** @type {any} */ panel, /** @type {number} */ at) => {
    if (panel.pair && panel.series.length === 2) return Number(/(\d+)\D*$/.exec(panel.title)?.[1] || 1) - 1;
    const number = /(\d+)\D*$/.exec(panel.series[at].name)?.[1];
    const all = panel.series.filter((/** @type {any} */ s) => s.role !== 'set').map((/** @type {any} */ s) => /(\d+)\D*$/.exec(s.name)?.[1]);
    // Elements of lists are counted from 0 on.
    return number && new Set(all).size === all.length && !all.includes(undefined) ? Number(number) - (all.includes('0') ? 0 : 1) : at;
  };

  /** Colour of a signal in the style sheet. @param {any} panel @param {number} at */
  const colour = (panel, at) => panel.series[at].role === 'set' ? 'var(--text)' : `var(--s${tint(panel, at) % 6 + 1})`;

  /** Puts cursors and the present time of a drawing where they are. @param {any} u */
  const lines = (u) => {
    for (const [line, t] of [[u.lines[0], R.cursors[0]], [u.lines[1], R.cursors[1]], [u.lines[2], R.now]]) {
      const at = t === null ? -1 : u.valToPos(t, 'x');
      // The width as the picture knows it: asking the element would lay the page out anew for each line.
      const shown = at >= 0 && at <= u.bbox.width / devicePixelRatio;
      line.style.display = shown ? '' : 'none';
      if (shown) line.style.transform = `translateX(${at}px)`;
    }
  };

  /** Mouse: drag zooms, Shift and drag moves, a click sets the time. @param {any} u @param {any} target @param {any} handler */
  const pressed = (u, target, handler) => (/** @type {MouseEvent} */ event) => {
    if (event.button !== 0) return null;
    const from = event.clientX, { min, max } = u.scales.x, perDot = (max - min) / u.over.clientWidth;
    if (!event.shiftKey) {
      const begin = u.posToVal(event.offsetX, 'x');
      document.addEventListener('mouseup', (up) => { if (Math.abs(up.clientX - from) < 3) R.setTime(begin); }, { once: true });
      return handler(event);
    }
    const move = (/** @type {MouseEvent} */ to) => R.Plots.show(min - (to.clientX - from) * perDot, max - (to.clientX - from) * perDot);
    document.addEventListener('mousemove', move);
    document.addEventListener('mouseup', () => document.removeEventListener('mousemove', move), { once: true });
    return null;
  };

  /** @param {any} panel @param {any[]} drawn @param {any[]} columns @param {HTMLElement} place @param {number} height @param {boolean} last */
  const plot = (panel, drawn, columns, place, height, last) => {
    const u = new uPlot({
      width: Math.max(place.clientWidth, 280), height, legend: { show: false }, padding: [8, 20, 0, 0],
      scales: { x: { time: false }, ...(height > 100 ? { y: { range: (/** @type {any} */ _, /** @type {number|null} */ low, /** @type {number|null} */ high) => panel.reach ? panel.reach(low, high) : R.Overlay.reach(panel, low, high) } } : {}) },
      cursor: { sync: { key: 'time', setSeries: false }, drag: { x: true, y: false }, points: { size: 6 }, bind: { mousedown: pressed } },
      series: [{}, ...drawn],
      axes: [
        { stroke: () => R.colour('quiet'), grid: { stroke: () => R.colour('grid'), width: 1 }, ticks: { stroke: () => R.colour('grid'), width: 1, size: 4 }, size: last ? 30 : 6, values: last ? (/** @type {any} */ _, /** @type {number[]} */ all) => all.map((x) => R.say(x, 7) + ' s') : () => [], font: '12px system-ui, sans-serif' },
        { stroke: () => R.colour('quiet'), grid: { stroke: () => R.colour('grid'), width: 1 }, ticks: { show: false }, size: GUTTER, space: height > 100 ? 32 : 22,
          ...(panel.lanes ? { splits: () => panel.lanes.map((/** @type {string} */ _, /** @type {number} */ at) => panel.lanes.length - 1 - at + LANE / 2), grid: { show: false } } : {}),
          values: (/** @type {any} */ _, /** @type {number[]} */ all) => panel.lanes?.map((/** @type {string} */ name) => name.slice(-9)) ?? all.map((x) => x === null ? '' : R.say(x, 6)), font: '12px system-ui, sans-serif' },
      ],
      hooks: {
        setScale: [(/** @type {any} */ self, /** @type {string} */ key) => {
          if (key !== 'x') return;
          // A picture that has just been made takes its own range for a moment.
          if (self.live) R.Plots.zoomed(self.scales.x.min, self.scales.x.max);
          lines(self);
        }],
        ready: [(/** @type {any} */ self) => { self.live = true; }],
        setSize: [(/** @type {any} */ self) => lines(self)],
        draw: [(/** @type {any} */ self) => R.Overlay.draw(self, panel, height > 100)],
      },
    }, columns, place);
    // Its place keeps its height where the browser leaves out what is out of sight.
    place.style.containIntrinsicSize = `auto ${height}px`;
    // On paper four rows of pictures share a page.
    u.heights = { screen: height, paper: Math.round(height * (height > 100 ? 0.56 : 0.68)) };
    u.lines = ['a', 'b', 'now'].map((name) => {
      const line = R.make('div', { class: 'line line-' + name });
      line.style.display = 'none';
      u.over.append(line);
      return line;
    });
    u.lines.slice(0, 2).forEach((/** @type {HTMLElement} */ line, /** @type {number} */ which) => {
      // The picture itself would begin to zoom.
      line.addEventListener('mousedown', (event) => event.stopPropagation());
      line.addEventListener('pointerdown', (event) => {
        event.preventDefault();
        line.setPointerCapture(event.pointerId);
        const left = u.over.getBoundingClientRect().left;
        const move = (/** @type {PointerEvent} */ to) => R.setCursor(/** @type {0|1} */ (which), Math.min(Math.max(u.posToVal(to.clientX - left, 'x'), R.span[0]), R.span[1]));
        line.addEventListener('pointermove', move);
        line.addEventListener('pointerup', () => line.removeEventListener('pointermove', move), { once: true });
      });
    });
    R.named(u, `${panel.title || 'Signals'} over time`);
    return u;
  };

  /** @param {any} panel */
  const legend = (panel) => {
    const rows = panel.series.map((/** @type {any} */ s, /** @type {number} */ at) => {
      const mark = R.make('i', { class: 'mark' + (s.role === 'set' ? ' dashed' : '') });
      mark.style.borderColor = colour(panel, at);
      const value = R.make('b'), marked = R.make('em');
      const row = R.make('button', { class: 'entry', type: 'button', 'aria-pressed': 'true', title: s.path }, mark, R.make('bdi', {}, s.name), ' ', value, marked);
      row.addEventListener('click', () => {
        const shown = row.getAttribute('aria-pressed') !== 'true';
        row.setAttribute('aria-pressed', String(shown));
        s.hidden = !shown;
        for (const tell of R.onRange) tell();
        panel.main.setSeries(at + 1, { show: shown });
        if (s.second) panel.main.setSeries(s.second, { show: shown });
      });
      s.tell = () => {
        value.textContent = R.say(R.at(panel.time, s.values, R.now, s.held));
        const [a, b] = R.cursors.map((t) => t === null ? null : R.at(panel.time, s.values, t, s.held));
        const parts = [];
        if (s.other) parts.push(`${R.data.compared.name}: ${R.say(R.at(panel.time, s.other, R.now, s.held))}`);
        if (a !== null) parts.push('A ' + R.say(a));
        if (b !== null) parts.push('B ' + R.say(b));
        if (a !== null && b !== null) parts.push('Δ ' + R.say(b - a));
        marked.textContent = parts.length ? ` (${parts.join(', ')})` : '';
      };
      return row;
    });
    return R.make('div', { class: 'legend' }, ...rows);
  };

  // NaN is what is missing; the plots want null for it.
  const column = (/** @type {ArrayLike<number>} */ all) => Array.prototype.some.call(all, (x) => !Number.isFinite(x)) ? Array.from(all, (x) => Number.isFinite(x) ? x : null) : all;

  /** Gaps of a line, in dots: where values are missing, and where an angle jumps by a turn. @param {any} panel @param {ArrayLike<number>} values */
  const gaps = (panel, values) => {
    const jumps = R.jumps(panel.time, values, panel.turn);
    return (/** @type {any} */ u, /** @type {number} */ _, /** @type {number} */ from, /** @type {number} */ to, /** @type {[number, number][]} */ missing) => {
      const half = 2 * Math.max(devicePixelRatio, 1), at = (/** @type {number} */ n) => u.valToPos(panel.time[n], 'x', true);
      const seen = jumps.filter((n) => n > from && n <= to).map((n) => /** @type {[number, number]} */ ([at(n - 1) - half, at(n) + half]));
      return [...missing, ...seen].sort((a, b) => a[0] - b[0]);
    };
  };

  /** Values that have no neighbours make no line: they are dots. @param {ArrayLike<number>} time @param {ArrayLike<number>} values */
  const dots = (time, values) => {
    const known = (/** @type {number} */ n) => n >= 0 && n < time.length && Number.isFinite(values[n]);
    /** @type {number[]} */ const alone = [];
    for (let n = 0; n < time.length; n++) if (known(n) && !known(n - 1) && !known(n + 1)) alone.push(n);
    return { show: alone.length > 0, size: 5, filter: () => alone };
  };

  /** Truth values would lie on each other: each has a lane of its own. Their names, the first on top; none for other signals.
   * @param {any} panel @returns {string[]|null} */
  const lanes = (panel) => {
    const truth = (/** @type {any} */ s) => s.held && s.role === 'plain' && !s.other && s.values.every((/** @type {number} */ x) => x === 0 || x === 1 || Number.isNaN(x));
    if (panel.unit || panel.series.length < 2 || !panel.series.every(truth)) return null;
    const names = panel.series.map((/** @type {any} */ s) => s.name);
    // What all names begin with tells nothing.
    let common = 0;
    while (common < names[0].length && names.every((/** @type {string} */ name) => name[common] === names[0][common])) common++;
    return names.map((/** @type {string} */ name) => name.slice(/[[\d]$/.test(name.slice(0, common)) ? common - 1 : common) || name);
  };

  /** Lays the card of a picture out; what draws it. @param {any} panel @param {HTMLElement} box */
  const lay = (panel, box) => {
    const canvas = R.make('div', { class: 'canvas' }), strip = R.make('div', { class: 'canvas' });
    const title = panel.title + (panel.unit ? ` [${panel.unit}]` : '');
    const card = R.make('figure', { class: 'card', tabindex: '0', 'aria-label': title },
      R.make('figcaption', {}, R.make('span', { class: 'title' }, R.make('bdi', {}, panel.title), panel.unit ? ` [${panel.unit}]` : ''), legend(panel)), canvas);
    box.append(card);
    /** @type {(() => void)[]} */ const draw = [];
    panel.card = card;
    const looks = panel.series.map((/** @type {any} */ s, /** @type {number} */ at) => ({
      label: s.name, stroke: s.role === 'set' ? () => R.colour('text') : series(tint(panel, at)), width: (s.role === 'set' ? 1.4 : 2.2) * (matchMedia('(prefers-contrast: more)').matches ? 1.4 : 1), dash: s.role === 'set' ? [7, 5] : undefined,
      points: dots(panel.time, s.values), gaps: gaps(panel, s.values), paths: s.held ? uPlot.paths.stepped?.({ align: 1 }) : undefined,
    }));
    panel.lanes = lanes(panel);
    const columns = [panel.time, ...panel.series.map((/** @type {any} */ s, /** @type {number} */ at) => panel.lanes ? column(s.values.map((/** @type {number} */ x) => panel.lanes.length - 1 - at + LANE * x)) : column(s.values))];
    panel.series.forEach((/** @type {any} */ s, /** @type {number} */ at) => {
      if (!s.other) return;
      s.second = columns.length;
      columns.push(column(s.other));
      looks.push({ ...looks[at], label: `${s.name} of ${R.data.compared.name}`, width: 1.1, dash: s.role === 'set' ? [2, 4] : undefined, gaps: gaps(panel, s.other) });
    });
    draw.push(() => { panel.main = plot(panel, looks, columns, canvas, panel.pair ? 200 : 230, !panel.pair); });
    if (panel.pair) {
      card.append(R.make('div', { class: 'strip-name' }, `set − actual [${panel.unit || '1'}]`), strip);
      const actual = panel.series[panel.pair[1]];
      const red = { label: 'error', stroke: () => R.colour('quiet'), width: 1.25, points: { show: false }, fill: () => R.colour('shade') };
      const errors = [column(actual.error)], wanted = panel.series[panel.pair[0]].other ?? panel.series[panel.pair[0]].values;
      /** @type {any[]} */ const strips = [red];
      if (actual.other) {
        errors.push(column(wanted.map((/** @type {number} */ x, /** @type {number} */ n) => {
          const off = x - actual.other[n];
          // Where one has jumped by a turn and the other has not, a turn is no error.
          return panel.turn ? off - panel.turn * Math.round(off / panel.turn) : off;
        })));
        strips.push({ ...red, label: `error of ${R.data.compared.name}`, stroke: series(tint(panel, panel.pair[1])), width: 1, fill: undefined });
      }
      draw.push(() => { panel.strip = plot(panel, strips, [panel.time, ...errors], strip, 96, true); });
    }
    return draw;
  };
  const mark = (/** @type {any} */ panel) => { lines(panel.main); if (panel.strip) lines(panel.strip); };
  return { lay, mark, colour };
})();
