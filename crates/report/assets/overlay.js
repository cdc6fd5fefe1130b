// @ts-check
'use strict';
// Measurements over the pictures: from the page's data, or from a CSV file that is dropped on it.
/* global R, uPlot */

R.Overlay = (() => {
  /** @type {{name: string, file: string, time: Float64Array, values: Float64Array, unit: string, panel: number, factor: number, shift: number}[]} */
  const courses = [];
  const LARGEST = 50e6;

  /** Numbers with decimal commas or points. @param {string} text @param {boolean} comma */
  const number = (text, comma) => {
    const plain = comma ? text.trim().replace(',', '.') : text.trim();
    return plain === '' ? NaN : Number(plain);
  };

  /** @param {string} line @param {string} separator */
  const cells = (line, separator) => {
    const found = [];
    let cell = '', quoted = false;
    for (const sign of line) {
      if (sign === '"') quoted = !quoted;
      else if (sign === separator && !quoted) { found.push(cell); cell = ''; }
      else cell += sign;
    }
    found.push(cell);
    return found.map((c) => c.trim());
  };

  /** Reads a table whose first column is time in s (or ms). @param {string} text @param {string} file */
  const read = (text, file) => {
    const lines = text.replace(/^\uFEFF/, '').split(/\r?\n/).filter((line) => line.trim() !== '' && !line.startsWith('#'));
    if (lines.length < 2) throw new Error('the file has no rows');
    const count = (/** @type {string} */ sign) => lines[0].split(sign).length;
    const separator = [';', '\t', ','].reduce((best, sign) => count(sign) > count(best) ? sign : best, ';');
    const comma = separator !== ',' && lines.slice(1, 20).some((line) => /\d,\d/.test(line));
    const first = cells(lines[0], separator);
    if (first.length < 2) throw new Error('one column only; columns are separated by commas, semicolons or tabs');
    const headed = first.some((cell) => Number.isNaN(number(cell, comma)));
    const names = headed ? first : first.map((_, n) => (n ? 'column ' + (n + 1) : 'time'));
    const rows = lines.slice(headed ? 1 : 0).map((line) => cells(line, separator).map((cell) => number(cell, comma)));
    const bad = rows.findIndex((row) => !Number.isFinite(row[0]));
    if (bad >= 0) throw new Error(`line ${bad + 1 + (headed ? 1 : 0)}: the first column is no time`);
    const milli = /\[\s*ms\s*\]|\bms\b/.test(names[0]) ? 1e-3 : 1;
    rows.sort((a, b) => a[0] - b[0]);
    const time = Float64Array.from(rows, (row) => row[0] * milli);
    names.slice(1).forEach((name, at) => {
      const unit = /\[(.*)\]/.exec(name)?.[1].trim() ?? '';
      add(file, name.replace(/\[.*\]/, '').trim(), unit, time, Float64Array.from(rows, (row) => row[at + 1] ?? NaN));
    });
  };

  /** @param {string} unit */
  const plain = (unit) => unit.replace('deg', '°').replace('^2', '²').replace('*', '·').replace('Nm', 'N·m');
  /** Factors from one unit to another. @param {string} from @param {string} to */
  const factor = (from, to) => {
    const [a, b] = [plain(from), plain(to)];
    if (a === b || !a || !b) return 1;
    for (const [one, other, times] of /** @type {[string, string, number][]} */ ([['rad', '°', 180 / Math.PI], ['mm', 'm', 1e-3]])) {
      const same = (/** @type {string} */ x, /** @type {string} */ y) => x.startsWith(one) && y.startsWith(other) && x.slice(one.length) === y.slice(other.length);
      if (same(a, b)) return times;
      if (same(b, a)) return 1 / times;
    }
    return 1;
  };

  /** The picture whose signal is named most like a column, with a unit of its kind. @param {string} name @param {string} unit */
  const meant = (name, unit) => {
    const key = (/** @type {string} */ text) => text.toLowerCase().replace(/[^a-z0-9]/g, '');
    const wanted = key(name), digits = /(\d+)/.exec(name)?.[1];
    const fits = (/** @type {any} */ p) => !unit || !p.unit || plain(unit) === plain(p.unit) || factor(unit, p.unit) !== 1;
    const all = R.data.panels.map((/** @type {any} */ p) => fits(p) ? p : { title: '', series: [], pair: null });
    let found = all.findIndex((/** @type {any} */ p) => p.series.some((/** @type {any} */ s) => s.path === name));
    if (found < 0) found = all.findIndex((/** @type {any} */ p) => p.series.some((/** @type {any} */ s) => key(s.path) === wanted));
    if (found < 0) found = all.findIndex((/** @type {any} */ p) => key(p.title) === wanted || p.series.some((/** @type {any} */ s) => key(s.name) === wanted));
    if (found < 0 && digits && /^(q|a|axis|joint|angle|j)/i.test(name)) found = all.findIndex((/** @type {any} */ p) => p.pair && /(\d+)\D*$/.exec(p.title)?.[1] === digits);
    return found;
  };

  /** @param {string} file @param {string} name @param {string} unit @param {Float64Array} time @param {Float64Array} values */
  const add = (file, name, unit, time, values) => {
    const panel = meant(name, unit);
    courses.push({ name, file, time, values, unit, panel, factor: panel < 0 ? 1 : factor(unit, R.data.panels[panel].unit), shift: 0 });
  };

  /** Range of values of a picture that has courses over it, of those at the times that are shown. @param {any} panel @param {number|null} low @param {number|null} high */
  const reach = (panel, low, high) => {
    const [from, to] = R.Plots.range(), at = courses.length ? R.data.panels.indexOf(panel) : -1;
    let [min, max] = [low ?? Infinity, high ?? -Infinity];
    for (const { time, values, shift, factor } of at < 0 ? [] : courses.filter((course) => course.panel === at)) {
      for (let n = 0; n < time.length; n++) {
        const t = time[n] + shift, y = values[n] * factor;
        if (t >= from && t <= to && Number.isFinite(y)) { if (y < min) min = y; if (y > max) max = y; }
      }
    }
    return min <= max ? uPlot.rangeNum(min, max, 0.1, true) : [null, null];
  };
  /** Draws all anew, with ranges that hold what has come. */
  const again = () => { R.Plots.show(...R.Plots.range()); R.Plots.redraw(); };

  /** Draws what belongs to a picture. @param {any} u @param {any} panel @param {boolean} main */
  const draw = (u, panel, main) => {
    const at = R.data.panels.indexOf(panel);
    const own = main ? courses.filter((course) => course.panel === at) : [];
    if (!own.length) return;
    const context = u.ctx, { left, top, width, height } = u.bbox;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    context.strokeStyle = context.fillStyle = R.colour('text');
    const dot = devicePixelRatio;
    for (const course of own) {
      context.setLineDash([1.5 * dot, 4 * dot]);
      context.lineWidth = 1.6 * dot;
      context.beginPath();
      let open = false, last = -1e9;
      /** @type {[number, number][]} */ const marks = [];
      for (let n = 0; n < course.time.length; n++) {
        const y = course.values[n] * course.factor;
        if (!Number.isFinite(y)) { open = false; continue; }
        const px = u.valToPos(course.time[n] + course.shift, 'x', true), py = u.valToPos(y, 'y', true);
        if (open) context.lineTo(px, py); else context.moveTo(px, py);
        open = true;
        if (px - last > 40 * dot) { marks.push([px, py]); last = px; }
      }
      context.stroke();
      for (const [x, y] of marks) context.fillRect(x - 2.5 * dot, y - 2.5 * dot, 5 * dot, 5 * dot);
    }
    context.restore();
  };

  const bar = () => {
    const place = document.getElementById('overlay-bar');
    if (!place) return;
    const input = R.make('input', { type: 'file', accept: '.csv,.txt,.tsv', class: 'unseen', id: 'overlay-file', tabindex: '-1' });
    input.addEventListener('change', () => take(input.files));
    const button = R.make('button', { type: 'button' }, 'Lay a measurement over (CSV) …');
    button.addEventListener('click', () => input.click());
    const list = courses.map((course, n) => {
      const choice = R.make('select', { 'aria-label': `picture for ${course.name}` }, R.make('option', { value: '-1' }, 'nowhere'),
        ...R.data.panels.map((/** @type {any} */ p, /** @type {number} */ at) => R.make('option', { value: String(at) }, p.title)));
      choice.value = String(course.panel);
      choice.addEventListener('change', () => { course.panel = Number(choice.value); course.factor = course.panel < 0 ? 1 : factor(course.unit, R.data.panels[course.panel].unit); bar(); again(); });
      const field = (/** @type {'factor'|'shift'} */ key, /** @type {string} */ title) => {
        const entry = R.make('input', { value: String(course[key]), size: '6', inputmode: 'decimal', 'aria-label': `${title} of ${course.name}` });
        entry.addEventListener('change', () => { const x = number(entry.value, true); if (Number.isFinite(x)) course[key] = x; entry.value = String(course[key]); again(); });
        return R.make('label', {}, ` ${title} `, entry);
      };
      const gone = R.make('button', { type: 'button', 'aria-label': `take ${course.name} away` }, '×');
      gone.addEventListener('click', () => { courses.splice(n, 1); bar(); again(); });
      return R.make('li', {}, R.make('b', {}, course.name), ` ${course.unit ? `[${course.unit}] ` : ''}of ${course.file} in `, choice, field('factor', 'times'), field('shift', 'later by [s]'), ' ', gone);
    });
    place.replaceChildren(button, input, ...(list.length ? [R.make('ul', { class: 'courses' }, ...list)] : []));
  };

  /** @param {FileList|null} files */
  const take = async (files) => {
    for (const file of files ?? []) {
      const text = file.size > LARGEST ? '' : await file.text();
      R.guarded(`“${file.name}”`, () => {
        if (file.size > LARGEST) throw new Error('it is larger than 50 MB');
        read(text, file.name);
      });
    }
    bar();
    again();
  };

  const build = () => {
    for (const overlay of R.data.overlays ?? []) {
      const time = R.list(overlay.time);
      for (const column of overlay.columns) add(overlay.name, column.name, column.unit, time, R.list(column.values));
    }
    bar();
    if (courses.length) again();
    document.addEventListener('dragover', (event) => event.preventDefault());
    document.addEventListener('drop', (event) => { event.preventDefault(); take(event.dataTransfer?.files ?? null); });
  };
  return { build, draw, reach, read, courses };
})();
