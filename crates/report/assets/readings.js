// @ts-check
'use strict';
// The values of the pictures as a table: now, at both cursors, and between them; as text and as a file.
/* global R */

R.Readings = (() => {
  const HEAD = ['signal', 'unit', 'now', 'A', 'B', 'B − A', 'minimum', 'maximum', 'mean', 'rms'];
  /** Numbers change no more often than can be read, ms. */
  const READ = 60;
  /** Rows of a saved file beyond which it has even distances in time. */
  const ROWS = 20000;
  /** @type {any} */ let dock = null;
  /** @type {any} */ let body = null;
  /** @type {any} */ let heading = null;
  /** @type {any} */ let nearby = null;
  /** @type {{panel: any, name: string, path: string, values: ArrayLike<number>, held: boolean, rough: boolean, dashed: boolean, tint: string, cells: any[]}[]} */ let rows = [];
  let told = 0, waiting = 0, listed = '';

  /** Begin and end of what is told: the cursors, or what is shown. @returns {[number, number, boolean]} */
  const stretch = () => {
    const [a, b] = R.cursors;
    if (a !== null && b !== null) return [Math.min(a, b), Math.max(a, b), true];
    const [from, to] = R.Plots.range();
    return [from, to, false];
  };

  /** Signals that are told: those that are not switched off, of the pictures in sight or of all. */
  const gather = () => {
    /** @type {typeof rows} */ const found = [];
    // Where no picture is in sight, all are meant.
    const near = nearby.checked && R.Plots.panels.some((/** @type {any} */ panel) => panel.seen);
    for (const panel of R.Plots.panels) {
      if (near && !panel.seen) continue;
      panel.series.forEach((/** @type {any} */ s, /** @type {number} */ at) => {
        if (s.hidden) return;
        const tint = R.Picture.colour(panel, at), common = { panel, path: s.path, held: s.held, tint, dashed: s.role === 'set', cells: [] };
        found.push({ ...common, name: s.name, values: s.values, rough: s.rough });
        if (s.other) found.push({ ...common, name: `${s.name} of ${R.data.compared.name}`, path: `${s.path} of ${R.data.compared.name}`, values: s.other, rough: s.rough });
      });
      if (!panel.pair) continue;
      const actual = panel.series[panel.pair[1]];
      if (!actual.hidden) found.push({ panel, path: `${actual.path.replace(/\.[^.]*$/, '')}.set-actual`, name: 'set − actual', values: actual.error, held: false, rough: actual.rough, dashed: false, tint: 'var(--quiet)', cells: [] });
    }
    return found;
  };

  /** Numbers of a signal in the order of the headings, from the third on. @param {typeof rows[0]} row @returns {number[]} */
  const numbers = ({ panel, values, held }) => {
    const at = (/** @type {number|null} */ t) => t === null ? NaN : R.at(panel.time, values, t, held);
    const [a, b] = R.cursors.map(at), [from, to] = stretch();
    const { low, high, mean, rms } = R.Stretches.of(panel.time, values, held, from, to);
    return [at(R.now), a, b, b - a, low, high, mean, rms];
  };

  /** Lays the rows out anew where others are listed. */
  const list = () => {
    const found = gather();
    const key = found.map((row) => `${R.Plots.panels.indexOf(row.panel)} ${row.name}`).join('\n');
    if (key === listed) return;
    [rows, listed] = [found, key];
    /** @type {any} */ let panel = null;
    body.replaceChildren(...rows.flatMap((row) => {
      row.cells = HEAD.slice(2).map(() => R.make('td', { class: 'n' }));
      const mark = R.make('i', { class: row.dashed ? 'mark dashed' : 'mark' });
      mark.style.borderColor = row.tint;
      const line = R.make('tr', {}, R.make('th', { scope: 'row', title: row.path }, mark, R.make('bdi', {}, row.name)), R.make('td', {}, row.panel.unit), ...row.cells);
      if (row.panel === panel) return [line];
      panel = row.panel;
      return [R.make('tr', { class: 'of' }, R.make('th', { scope: 'rowgroup', colspan: String(HEAD.length) }, panel.title)), line];
    }));
  };

  const write = () => {
    const begin = performance.now();
    list();
    const [from, to, marked] = stretch(), [a, b] = R.cursors;
    for (const row of rows) {
      numbers(row).forEach((x, n) => {
        const text = Number.isNaN(x) && n > 0 ? '' : (row.rough && n > 5 ? '≈ ' : '') + R.say(x, 7);
        if (row.cells[n].textContent !== text) row.cells[n].textContent = text;
      });
    }
    heading.textContent = marked ? `between A (${R.time(from)} s) and B (${R.time(to)} s)` : `over the shown time, ${R.time(from)} s to ${R.time(to)} s${a === null && b === null ? '; A and B set cursors' : ''}`;
    /** @type {any} */ (window).__m.table_ms = performance.now() - begin;
  };
  const tell = () => {
    if (!dock || dock.hidden) return;
    clearTimeout(waiting);
    const left = told + READ - performance.now();
    if (left > 0) { waiting = setTimeout(tell, left); return; }
    told = performance.now();
    write();
  };

  /** The table as text, cells separated by tabs. */
  const text = () => {
    write();
    const plain = (/** @type {number} */ x) => Number.isFinite(x) ? String(Number(x.toPrecision(R.data.full ? 15 : 7))) : '';
    const [from, to] = stretch(), [a, b] = R.cursors;
    const lines = rows.map((row) => [row.path, row.panel.unit, ...numbers(row).map(plain)]);
    const times = [`now ${plain(R.now)} s`, a === null ? '' : `A ${plain(a)} s`, b === null ? '' : `B ${plain(b)} s`, `minimum to rms from ${plain(from)} s to ${plain(to)} s`].filter(Boolean);
    return [times, HEAD, ...lines].map((cells) => cells.map((cell) => cell.replace(/[\t\r\n]/g, ' ')).join('\t')).join('\n') + '\n';
  };

  /** Times of the file: those of the pictures, both of a jump; or even ones where they would be too many. @param {typeof rows} all @param {number} from @param {number} to @returns {[number, boolean][]} With whether the value before a jump is meant. */
  const times = (all, from, to) => {
    /** @type {Map<number, number>} */ const found = new Map([[from, 1], [to, 1]]);
    for (const panel of new Set(all.map((row) => row.panel))) {
      for (let n = 0; n < panel.time.length; n++) {
        const t = panel.time[n];
        if (t < from || t > to) continue;
        const jumps = n > 0 && panel.time[n - 1] === t;
        found.set(t, Math.max(found.get(t) ?? 1, jumps ? 2 : 1));
      }
    }
    if (found.size > ROWS) return Array.from({ length: ROWS }, (_, n) => [n === ROWS - 1 ? to : from + (to - from) * n / (ROWS - 1), false]);
    return [...found].sort((x, y) => x[0] - y[0]).flatMap(([t, count]) => count === 2 ? /** @type {[number, boolean][]} */ ([[t, true], [t, false]]) : [/** @type {[number, boolean]} */ ([t, false])]);
  };
  /** What a file of the page lacks, where it lacks anything. */
  const partly = R.data.thinned ? 'The values that the page keeps, with 7 digits; `blocksim export RUN --csv FILE` writes all of them.' : '';
  /** What is listed, over the shown time, as a table of numbers. */
  const csv = () => {
    write();
    const [from, to] = R.Plots.range(), all = rows;
    const quoted = (/** @type {string} */ cell) => /[",;\r\n]/.test(cell) ? `"${cell.replace(/"/g, '""')}"` : cell;
    const head = ['time [s]', ...all.map((row) => row.path + (row.panel.unit ? ` [${row.panel.unit}]` : ''))];
    const before = (/** @type {typeof rows[0]} */ { panel, values, held }, /** @type {number} */ t) => {
      const n = panel.time.indexOf(t);
      return n < 0 || (n > 0 && held) ? R.at(panel.time, values, t - 1e-12 * Math.max(Math.abs(t), 1), held) : values[n];
    };
    const cell = (/** @type {number} */ x) => Number.isFinite(x) ? String(R.data.full ? x : Number(x.toPrecision(7))) : '';
    const lines = times(all, from, to).map(([t, first]) => [String(Number(t.toPrecision(15))), ...all.map((row) => cell(first ? before(row, t) : R.at(row.panel.time, row.values, t, row.held)))].join(','));
    return [...(partly ? [`# ${partly}`] : []), head.map(quoted).join(','), ...lines].join('\n') + '\n';
  };

  const say = (/** @type {string} */ message) => { dock.querySelector('.done').textContent = message; };
  const copy = async () => {
    const copied = text();
    try {
      await navigator.clipboard.writeText(copied);
    } catch {
      // Some browsers allow that on no page from disk.
      const field = R.make('textarea', { class: 'unseen' });
      field.value = copied;
      dock.append(field);
      field.select();
      document.execCommand('copy');
      field.remove();
    }
    say(`${rows.length} rows copied`);
  };
  const save = () => {
    const [from, to] = R.Plots.range(), file = new Blob([csv()], { type: 'text/csv' });
    const name = document.title.replace(/[^\p{L}\p{N}._-]+/gu, '_').slice(0, 60) || 'run';
    const link = R.make('a', { href: URL.createObjectURL(file), download: `${name}_${R.say(from, 4)}s_to_${R.say(to, 4)}s.csv`.replace('−', '-') });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    say(`saved as ${link.download}`);
  };

  /** Opens the table, or closes it. */
  const toggle = () => {
    dock.hidden = !dock.hidden;
    document.body.classList.toggle('docked', !dock.hidden);
    if (dock.hidden) return;
    told = 0;
    tell();
  };

  const build = () => {
    const foot = document.getElementById('timeline');
    if (!foot || !R.data.panels.length) return;
    const button = (/** @type {string} */ name, /** @type {() => void} */ does, /** @type {string} */ title = '') => {
      const made = R.make('button', { type: 'button', ...(title ? { title } : {}) }, name);
      made.addEventListener('click', does);
      return made;
    };
    nearby = R.make('input', { type: 'checkbox' });
    nearby.checked = true;
    nearby.addEventListener('change', () => { told = 0; tell(); });
    body = R.make('tbody');
    heading = R.make('span', { class: 'note' });
    dock = R.make('section', { id: 'readings', 'aria-label': 'Values at the cursors' },
      R.make('div', { class: 'readings-bar' }, R.make('strong', {}, 'Values'), heading, R.make('label', {}, nearby, ' only pictures in sight'), R.make('span', { class: 'done', role: 'status' }),
        button('Copy as text', copy), button(partly ? 'Save as CSV (thinned)' : 'Save as CSV', save, `What is listed, over the shown time. ${partly}`.trim()), button('Close (T)', toggle)),
      R.make('div', { class: 'readings-table', tabindex: '0', role: 'region', 'aria-label': 'Table of values' }, R.make('table', { 'aria-label': 'Values' }, R.make('thead', {}, R.make('tr', {}, ...HEAD.map((name, n) => R.make('th', { scope: 'col', class: n > 1 ? 'n' : '' }, name)))), body)),
      ...(R.data.thinned ? [R.make('p', { class: 'note' }, 'From the values that this page keeps; of those with ≈ mean and rms are rough.')] : []));
    dock.hidden = true;
    foot.prepend(dock);
    foot.append(button('Table', toggle, 'Values at the cursors and between them (T)'));
    for (const changes of [R.onTime, R.onCursors, R.onRange]) changes.push(tell);
  };
  return { build, toggle, text, csv, write };
})();
