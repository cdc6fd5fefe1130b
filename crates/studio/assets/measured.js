// @ts-check
'use strict';
// Tables of other programs over runs: looked at, their columns assigned to signals, kept as small files of the project.
/* global R */

/** @type {any} */ (R).Measured = (() => {
  const { Desk } = /** @type {any} */ (R);
  /** How long the keys may rest before the table is looked at, ms. */
  const REST = 150;
  const SIGNS = /** @type {Record<string, string>} */ ({ ';': 'semicolons', '\t': 'tabs', ',': 'commas' });
  /** @typedef {{column: string, signal: string, unit: string, scale: string}} Column */
  /** What stands in the form; nothing while it is closed. @type {{file: string, run: string, time: string, time_unit: string, shift: string, columns: Column[], name: string, replace: boolean}|null} */ let form = null;
  /** @type {any} */ let listed = { tables: [], kept: [], edit: false };
  /** @type {any[]} */ let runs = [];
  /** What the program found in the table last. @type {any} */ let found = null;
  /** @type {any} */ const place = { all: null, seen: null };
  /** Where what is wrong is told, by the names that the program has for fields. @type {Map<string, {input: any, told: any}>} */ const spots = new Map();
  let asked = 0, waiting = 0;

  const renew = async () => {
    [listed, runs] = await Promise.all([Desk.ask('measured'), Desk.ask('runs')]);
    runs.reverse();
  };
  /** The measurements of the project; the view makes room for the form. @returns {Promise<HTMLElement>} */
  const section = async () => {
    try { await renew(); } catch (error) { Desk.refuse(error); }
    place.all = R.make('section', { class: 'measured', 'aria-label': 'Measurements' });
    show();
    return place.all;
  };
  /** Lays list and form out. */
  const show = () => {
    const rows = listed.kept.map((/** @type {any} */ one) => [R.make('bdi', {}, one.name), one.problem ?? one.file, one.problem ? '' : one.columns.map((/** @type {Column} */ column) => column.signal).join(', '), one.problem || !listed.edit ? '' : Desk.button('Change', () => open(one), { 'aria-label': `Change ${one.name}` })]);
    place.all.replaceChildren(R.make('h2', {}, 'Measurements'),
      R.make('p', { class: 'note' }, 'A measured table (CSV) can be laid over a run: its columns are assigned to signals here, and it is switched on above the page of the run.'),
      ...(rows.length ? [Desk.table('Measurements', ['name', 'table', 'signals', ''], rows)] : []),
      ...(listed.edit ? [] : [R.make('p', { class: 'note' }, 'To keep one, start the page with --edit; without it a table can be looked at.')]),
      form ? fields() : Desk.button('+ CSV', () => open(null), { title: 'Assign the columns of a table to signals' }));
    if (form) { told(); place.all.querySelector('select')?.focus(); }
  };
  /** @param {any} one A measurement that is kept, or nothing. */
  const open = (one) => {
    form = { file: one?.file ?? listed.tables[0] ?? '', run: runs[0]?.name ?? '', time: one?.time ?? '', time_unit: one?.time_unit ?? '', shift: one?.shift ?? '0 s', columns: structuredClone(one?.columns ?? []), name: one?.name ?? '', replace: Boolean(one) };
    found = null;
    fresh = !one;
    show();
    look();
  };
  const close = () => { form = null; show(); place.all.querySelector('button')?.focus(); };
  /** Signals are proposed when a table is looked at for the first time. */ let fresh = true;

  /** @param {string} name @param {any} input */
  const spot = (name, input) => { const told = R.make('span', { class: 'told', role: 'alert' }); spots.set(name, { input, told }); return told; };
  /** @param {string} label @param {any} owner @param {string} key @param {string} name @param {string} size */
  const text = (label, owner, key, name, size = '9') => {
    const input = R.make('input', { type: 'text', value: owner[key] ?? '', 'aria-label': label, size, spellcheck: 'false' });
    input.addEventListener('input', () => { owner[key] = input.value; soon(); });
    return { input, told: spot(name, input) };
  };
  /** @param {string} label @param {string[]} words @param {string} now @param {(word: string) => void} does @param {string} name */
  const choice = (label, words, now, does, name) => {
    const select = R.make('select', { 'aria-label': label }, ...words.map((word) => R.make('option', { value: word }, word || 'none')));
    select.value = now;
    select.addEventListener('change', () => does(select.value));
    return { input: select, told: spot(name, select) };
  };
  const line = (/** @type {string} */ label, /** @type {any} */ { input, told }, /** @type {any[]} */ ...more) => R.make('label', { class: 'field' }, R.make('span', {}, label), input, R.make('span', { class: 'note' }, ...more), told);

  /** The form. */
  const fields = () => {
    if (!form) return '';
    const own = form;
    spots.clear();
    place.seen = R.make('div', { class: 'measured-seen' });
    const file = R.make('input', { type: 'file', accept: '.csv,.txt,.tsv', class: 'unseen', tabindex: '-1' });
    file.addEventListener('change', () => take(file.files?.[0]));
    const elsewhere = listed.edit ? [file, Desk.button('From elsewhere …', () => file.click(), { title: 'Copies a file of up to 8 MB into the folder measured/ of the project' })] : [];
    const table = choice('Table', listed.tables.length ? listed.tables : [''], own.file, (word) => { Object.assign(own, { file: word, time: '', time_unit: '', columns: [] }); found = null; fresh = true; look(); }, 'file');
    const run = choice('Run', ['', ...runs.map((/** @type {any} */ one) => one.name)], own.run, (word) => { own.run = word; look(); }, 'run');
    return R.make('div', { class: 'measured-form' }, R.make('div', { class: 'form-grid' }, line('table', table), ...(elsewhere.length ? [R.make('p', { class: 'buttons' }, ...elsewhere)] : []), line('run', run, 'its signals, and what to align with')), place.seen);
  };

  /** What the program has found: the preview, and the fields that depend on it. */
  const told = () => {
    if (!form || !place.seen) return;
    const own = form, focus = document.activeElement instanceof HTMLElement ? document.activeElement.getAttribute('aria-label') : null;
    for (const name of [...spots.keys()]) if (!['file', 'run'].includes(name)) spots.delete(name);
    if (!listed.tables.length) { place.seen.replaceChildren(R.make('p', { class: 'note' }, 'The project has no table (.csv, .tsv, .txt) yet.')); return; }
    if (!found?.headings) { place.seen.replaceChildren(); problems(); return; }
    const { headings, lines, delimiter, decimal, rows, span } = found;
    const how = [`Columns are separated by ${SIGNS[delimiter] ?? delimiter}`, decimal ? `decimals by a ${decimal === ',' ? 'comma' : 'point'}` : 'without decimals', rows !== undefined ? `${rows} rows` : '', span?.[0] !== undefined && span[0] !== null ? `${R.say(span[0], 6)} s to ${R.say(span[1], 6)} s` : ''].filter(Boolean).join(', ');
    const heading = (/** @type {any} */ one) => one.name + (one.unit ? ` [${one.unit}]` : '');
    const names = [...new Set(headings.map((/** @type {any} */ one) => one.name).filter(Boolean))];
    const time = choice('Time column', /** @type {string[]} */ (names), own.time || found.time, (word) => { own.time = word; own.columns = own.columns.filter((column) => column.column !== word); look(); }, 'time');
    const of = headings.find((/** @type {any} */ one) => one.name === (own.time || found.time));
    const unit = text('Unit of the time', own, 'time_unit', 'time_unit', '5');
    unit.input.placeholder = of?.unit ?? 's';
    const shift = text('Shift', own, 'shift', 'shift');
    const align = Desk.button('Align', () => look(true), { title: 'Finds the shift at which the columns agree best with the signals of the run, by their cross-correlation' });
    align.disabled = !own.run;
    const known = new Map(found.signals.map((/** @type {any} */ one) => [one.path, one.unit]));
    const list = R.make('datalist', { id: 'measured-signals' }, ...found.signals.map((/** @type {any} */ one) => R.make('option', { value: one.path })));
    const others = names.filter((name) => name !== (own.time || found.time));
    let sent = 0;
    const assigned = others.map((name) => {
      let column = own.columns.find((one) => one.column === name);
      if (!column) own.columns.push(column = { column: /** @type {string} */ (name), signal: fresh ? meant(/** @type {string} */ (name), [...known.keys()]) : '', unit: '', scale: '1' });
      const at = column.signal.trim() ? sent++ : -1, key = (/** @type {string} */ what) => at >= 0 ? `columns.${at}.${what}` : `none ${name} ${what}`;
      const signal = text(`Signal of ${name}`, column, 'signal', key('signal'), '28'), unit = text(`Unit of ${name}`, column, 'unit', key('unit'), '6'), scale = text(`Scale of ${name}`, column, 'scale', key('scale'), '5');
      signal.input.setAttribute('list', 'measured-signals');
      unit.input.placeholder = headings.find((/** @type {any} */ one) => one.name === name)?.unit ?? known.get(column.signal) ?? '';
      const whole = spot(key('column'), signal.input);
      return R.make('tr', {}, R.make('th', { scope: 'row' }, R.make('bdi', {}, heading(headings.find((/** @type {any} */ one) => one.name === name)))), R.make('td', {}, signal.input, whole, signal.told, unit.told, scale.told), R.make('td', {}, unit.input), R.make('td', {}, scale.input));
    });
    fresh = false;
    const order = new Map(others.map((name, n) => [name, n]));
    own.columns = own.columns.filter((one) => order.has(one.column)).sort((a, b) => (order.get(a.column) ?? 0) - (order.get(b.column) ?? 0));
    const whole = R.make('span', { class: 'told', role: 'alert' });
    spots.set('columns', { input: null, told: whole });
    const name = R.make('input', { type: 'text', value: own.name, 'aria-label': 'Name of the measurement', size: '14', spellcheck: 'false' }), replace = R.make('input', { type: 'checkbox' }), command = R.make('code');
    const commanded = () => { command.textContent = `blocksim report ${own.run || 'RUN'} --overlay measured/${own.name || 'NAME'}.ron`; };
    name.addEventListener('input', () => { own.name = name.value.trim(); commanded(); });
    replace.checked = own.replace;
    replace.addEventListener('change', () => { own.replace = replace.checked; });
    commanded();
    place.seen.replaceChildren(R.make('p', { class: 'note', role: 'status' }, `${how}.`),
      Desk.table('Beginning of the table', headings.map(heading), lines.map((/** @type {string[]} */ cells) => cells)), list,
      R.make('div', { class: 'form-grid' }, line('time', time), line('its unit', unit), line('shift', shift, align)),
      R.make('div', { class: 'wide' }, R.make('table', { 'aria-label': 'Columns' }, R.make('thead', {}, R.make('tr', {}, ...['column', 'signal', 'unit', 'scale'].map((head) => R.make('th', { scope: 'col' }, head)))), R.make('tbody', {}, ...assigned))), whole,
      R.make('p', { class: 'buttons' }, R.make('label', {}, 'name ', name), R.make('label', {}, replace, ' replace'),
        ...(listed.edit ? [Desk.button('Keep', () => keep(false), { class: 'main' }), ...(own.run ? [Desk.button('Keep, and show over the run', () => keep(true))] : [])] : []), Desk.button('Close', close)),
      R.make('p', { class: 'note' }, 'On the command line: ', command));
    problems();
    if (focus) place.all.querySelector(`[aria-label="${CSS.escape(focus)}"]`)?.focus();
  };
  /** Shows what is wrong at its fields. */
  const problems = () => {
    for (const { input, told } of spots.values()) { told.textContent = ''; input?.removeAttribute('aria-invalid'); }
    for (const { field, message, help } of found?.problems ?? []) {
      const { input, told } = spots.get(field) ?? spots.get('columns') ?? spots.get('file') ?? {};
      if (!told) continue;
      told.textContent = [message, help].filter(Boolean).join('; ');
      input?.setAttribute('aria-invalid', 'true');
    }
  };

  /** The signal that is called as a column. @param {string} column @param {string[]} paths */
  const meant = (column, paths) => {
    const key = (/** @type {string} */ one) => one.toLowerCase().replace(/[^\p{L}\p{N}]/gu, ''), wanted = key(column);
    const alike = paths.filter((path) => path === column || key(path) === wanted);
    const ends = alike.length ? alike : paths.filter((path) => key(path).endsWith(wanted) && wanted.length > 1);
    // Where several would do, somebody has to choose.
    return ends.length === 1 ? ends[0] : '';
  };

  const sent = () => form ? { ...form, columns: form.columns.filter((column) => column.signal.trim()) } : {};
  const soon = () => { clearTimeout(waiting); waiting = setTimeout(look, REST); };
  /** Looks at the table as the form has it. @param {boolean} [align] */
  const look = async (align) => {
    clearTimeout(waiting);
    if (!form?.file) return;
    const own = ++asked, first = !found;
    try {
      const seen = await Desk.ask('measured', { ...sent(), align: align === true });
      if (own !== asked || !form) return;
      found = seen;
      form.time ||= seen.time ?? '';
      if (seen.shift) form.shift = seen.shift;
      const guesses = first && fresh;
      told();
      // What was proposed is to be looked at as well.
      if (guesses && form.columns.some((column) => column.signal)) look();
    } catch (error) { if (own === asked) { found = { problems: [{ field: 'file', message: /** @type {Error} */ (error).message, help: '' }] }; told(); } }
  };
  /** @param {boolean} shows Whether the run is shown with it. */
  const keep = async (shows) => {
    if (!form) return;
    try {
      const { name, file } = await Desk.ask('measure', sent()), { run } = form;
      Desk.say(`${file} is written`);
      form = null;
      if (shows) { location.hash = `#runs/${encodeURIComponent(`${run}*${name}`)}`; return; }
      await renew();
      show();
    } catch (error) {
      const why = /** @type {any} */ (error).why;
      if (why?.problems) { found.problems = why.problems; problems(); }
      Desk.refuse(error);
    }
  };
  /** @param {File|undefined} file */
  const take = async (file) => {
    if (!file || !form) return;
    if (file.size > 8e6) { Desk.say(`${file.name} is larger than 8 MB: copy it into the folder of the project`, true); return; }
    try {
      const taken = await Desk.ask('table', { name: file.name, text: await file.text() });
      await renew();
      Object.assign(form, { file: taken.file, time: '', time_unit: '', columns: [] });
      found = null;
      fresh = true;
      show();
      look();
    } catch (error) { Desk.refuse(error); }
  };

  /** Switches for measurements over a run. @param {string} run @param {string[]} chosen */
  const switches = async (run, chosen) => {
    try { await renew(); } catch (error) { Desk.refuse(error); return ''; }
    const usable = listed.kept.filter((/** @type {any} */ one) => !one.problem);
    if (!usable.length) return '';
    return R.make('span', { class: 'measured-switches', role: 'group', 'aria-label': 'Measurements over the run' }, 'measured: ', ...usable.map((/** @type {any} */ { name }) => {
      const input = R.make('input', { type: 'checkbox' });
      input.checked = chosen.includes(name);
      input.addEventListener('change', () => { location.hash = `#runs/${encodeURIComponent([run, ...usable.map((/** @type {any} */ one) => one.name).filter((/** @type {string} */ other) => other === name ? input.checked : chosen.includes(other))].join('*'))}`; });
      return R.make('label', {}, input, ' ', name, ' ');
    }));
  };
  return { section, switches };
})();
