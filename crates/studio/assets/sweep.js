// @ts-check
'use strict';
// Sweeps: a model run over values of its parameters, as a grid, small multiples, lines across parallel axes and a table.
/* global R */

/** @type {any} */ (R).Sweep = (() => {
  const { Desk, Charts, Live } = /** @type {any} */ (R);
  const METRICS = ['rise', 'overshoot', 'settling', 'iae', 'ise', 'final_error', 'maximum_error', 'min', 'max', 'peak', 'mean', 'rms', 'final'], OF_ANY = ['min', 'max', 'peak', 'mean', 'rms', 'final'];
  /** @type {any} */ const place = {};
  let version = -1, chosen = -1, shownMetric = 0;
  /** Which parameters stand across and down the grid, and what the others are held at. */
  let across = 0, down = 1;
  /** Parameters in the order in which they were typed. @type {string[]} */ let names = [];
  /** @type {any} */ let found = null;
  /** @type {any[]} */ let drawn = [];

  /** A row for a parameter and its values. @param {string} [name] @param {string} [values] */
  const row = (name = '', values = '') => {
    const target = R.make('input', { type: 'text', value: name, list: 'sweep-names', size: '20', 'aria-label': 'Parameter', spellcheck: 'false' });
    const text = R.make('input', { type: 'text', value: values, size: '18', placeholder: '4..16/5, or 4, 8, 16', 'aria-label': 'Values', spellcheck: 'false' });
    target.addEventListener('change', () => { if (!text.value) text.value = suggested(target.value.trim()); });
    const made = R.make('div', { class: 'over' }, target, ' = ', text, ' ', Desk.button('×', () => made.remove(), { 'aria-label': 'Take this parameter away' }));
    made.over = () => target.value.trim() && `${target.value.trim()}=${text.value.trim()}`;
    return made;
  };
  /** Five values around the one that a parameter has. @param {string} name */
  const suggested = (name) => {
    const target = place.targets?.find((/** @type {any} */ one) => one.name === name), [, number, unit] = /^([+-]?[\d.]+(?:e[+-]?\d+)?)\s*(.*)$/i.exec(target?.written ?? '') ?? [], x = Number(number);
    return x ? `${Number((x / 2).toPrecision(3))}..${Number((2 * x).toPrecision(3))}${unit ? ` ${unit}` : ''}/5` : '';
  };
  const metrics = () => [...place.metrics.querySelectorAll('.metric')].map((one) => one.metric()).filter(Boolean);
  const metric = () => {
    const choice = R.make('select', { 'aria-label': 'What is measured' }, ...METRICS.map((name) => R.make('option', { value: name }, name.replace('_', ' '))));
    const of = R.make('input', { type: 'text', list: 'sweep-signals', size: '18', placeholder: 'of which signal', 'aria-label': 'Of which signal', spellcheck: 'false' });
    const made = R.make('div', { class: 'metric' }, choice, ' of ', of, ' ', Desk.button('×', () => made.remove(), { 'aria-label': 'Do not measure this' }));
    made.metric = () => OF_ANY.includes(choice.value) || of.value.trim() ? `${choice.value}:${of.value.trim()}` : choice.value;
    return made;
  };

  const start = async () => {
    const over = [...place.over.children].map((one) => /** @type {any} */ (one).over()).filter(Boolean);
    if (!over.length) { told('name a parameter and its values first', true); return; }
    const random = place.random.checked ? Math.max(1, Math.round(Number(place.count.value) || 0)) : null;
    place.start.disabled = true;
    place.stop.hidden = false;
    told('the model is run …');
    try { found = await Desk.ask('sweep', { over, metric: metrics(), random }); } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      told([message, why?.help].filter(Boolean).join(' – '), true);
      return;
    } finally { place.start.disabled = false; place.stop.hidden = true; place.bar.hidden = true; }
    chosen = -1;
    names = over.map((one) => one.split('=')[0].trim());
    [across, down] = [0, 1];
    // What does not change tells nothing.
    shownMetric = Math.max(0, measured().findIndex((/** @type {any} */ one) => new Set(one.values.filter(Number.isFinite)).size > 1));
    show();
  };
  /** @param {string} text @param {boolean} [bad] */
  const told = (text, bad) => { place.told.textContent = text; place.told.classList.toggle('bad', bad === true); };

  /** Parameters with the value of each run: numbers where they are such. */
  const parameters = () => names.filter((name) => name in (found.runs[0]?.set ?? {})).map((name) => {
    const texts = found.runs.map((/** @type {any} */ run) => run.set[name]), numbers = texts.map((/** @type {string} */ text) => parseFloat(text));
    const units = new Set(texts.map((/** @type {string} */ text) => text.replace(/^[+-]?[\d.]+(e[+-]?\d+)?\s*/i, '')));
    return { name, texts, values: numbers.every(Number.isFinite) && units.size === 1 ? numbers : texts };
  });
  /** What was measured, with the value of each run. */
  const measured = () => {
    const first = found.runs.find((/** @type {any} */ run) => run.metrics?.length)?.metrics ?? [];
    return first.map((/** @type {any} */ one, /** @type {number} */ n) => {
      // Shares are told in per cent.
      const by = one.metric === 'overshoot' ? 100 : 1, unit = one.metric === 'overshoot' ? '%' : one.unit === '1' ? '' : (one.unit ?? '').replaceAll('*', '·').replace('deg', '°');
      return { name: `${one.metric.replace('_', ' ')}${one.signal ? ` ${one.signal}` : ''}`, unit, values: found.runs.map((/** @type {any} */ run) => by * (run.metrics?.[n]?.value ?? NaN)) };
    });
  };
  /** Shows a run in all views. @param {number} n */
  const pick = (n) => { chosen = n; show(); place.picked.scrollIntoView({ block: 'nearest' }); };

  const show = () => {
    for (const u of drawn) u.destroy();
    drawn = [];
    const all = parameters(), numbers = measured(), failed = found.runs.filter((/** @type {any} */ run) => run.failed).length;
    told(`${found.runs.length} runs${failed ? `, ${failed} of them without numbers` : ''}`);
    const lead = numbers[shownMetric];
    const choice = (/** @type {string} */ label, /** @type {string[]} */ names, /** @type {number} */ now, /** @type {(n: number) => void} */ does) => {
      const made = R.make('select', { 'aria-label': label }, ...names.map((name, n) => R.make('option', { value: String(n) }, name)));
      made.value = String(now);
      made.addEventListener('change', () => { does(Number(made.value)); show(); });
      return R.make('label', {}, `${label} `, made);
    };
    place.views.replaceChildren(R.make('div', { class: 'diagram-bar' }, ...(numbers.length > 1 ? [choice('Shown', numbers.map((/** @type {any} */ one) => one.name), shownMetric, (n) => { shownMetric = n; })] : []),
      ...(all.length > 2 ? [choice('Across', all.map((one) => one.name), across, (n) => { if (n === down) down = across; across = n; }), choice('Down', all.map((one) => one.name), down, (n) => { if (n === across) across = down; down = n; })] : [])));
    picked(all, numbers);
    if (lead && all.every((one) => new Set(one.texts).size < found.runs.length || all.length === 1)) grid(all, lead);
    if (numbers.length) multiples(all, numbers);
    if (numbers.length) place.views.append(R.make('figure', { class: 'card' }, R.make('figcaption', {}, R.make('span', { class: 'title' }, 'All runs across their parameters and numbers'), R.make('span', { class: 'note' }, 'click a line')), R.make('div', { class: 'wide' }, Charts.parallel({ label: `${found.runs.length} runs; the table below has the same`, axes: [...all, ...numbers.map((/** @type {any} */ one) => ({ name: `${one.name} ${one.unit ? `[${one.unit}]` : ''}`, values: one.values }))], chosen, on: pick }))));
    const button = (/** @type {number} */ n) => Desk.button(n === chosen ? '● chosen' : 'choose', () => pick(n), { 'aria-pressed': String(n === chosen), 'aria-label': `Choose run ${n + 1}` });
    place.views.append(Desk.table('Runs of the sweep', [...all.map((one) => one.name), ...numbers.map((/** @type {any} */ one) => `${one.name} ${one.unit ? `[${one.unit}]` : ''}`), ''], found.runs.map((/** @type {any} */ run, /** @type {number} */ n) => [...all.map((one) => one.texts[n]), ...(run.failed ? [R.make('span', { class: 'bad' }, run.failed), ...numbers.slice(1).map(() => '')] : numbers.map((/** @type {any} */ one) => R.say(one.values[n], 5))), button(n)])));
  };

  /** The run that was picked, and what can be done with it. @param {any[]} all @param {any[]} numbers */
  const picked = (all, numbers) => {
    place.picked.replaceChildren();
    if (chosen < 0) { place.picked.append(R.make('p', { class: 'note' }, 'Choose a run in the grid, among the lines or in the table.')); return; }
    const sets = all.map((one) => `${one.name}=${one.texts[chosen]}`);
    place.picked.append(R.make('b', {}, sets.join(', ')), R.make('span', {}, ` ${numbers.map((one) => `${one.name} ${R.say(one.values[chosen], 4)} ${one.unit ?? ''}`.trim()).join(', ')} `),
      Desk.button('Run it', () => Live.run(sets), { class: 'main', title: 'Run the model with these values, and see its scopes' }));
  };
  /** The shown number over two parameters. @param {any[]} all @param {any} lead */
  const grid = (all, lead) => {
    const columns = [...new Set(all[across].texts)], rows = all.length > 1 ? [...new Set(all[down].texts)] : [''];
    const known = lead.values.filter(Number.isFinite), low = Math.min(...known), high = Math.max(...known);
    // Of further parameters those of the chosen run, or of the first one, hold.
    const fixed = Math.max(chosen, 0), fits = (/** @type {number} */ n) => all.every((one, at) => at === across || at === down || one.texts[n] === one.texts[fixed]);
    const others = all.filter((_, at) => at !== across && at !== down).map((one) => `${one.name} = ${one.texts[fixed]}`);
    const cell = (/** @type {string} */ x, /** @type {string} */ y) => {
      const n = found.runs.findIndex((/** @type {any} */ _, /** @type {number} */ at) => all[across].texts[at] === x && (all.length < 2 || all[down].texts[at] === y) && fits(at));
      if (n < 0) return R.make('td', {}, '');
      const value = lead.values[n], share = high > low && Number.isFinite(value) ? (value - low) / (high - low) : 0;
      const button = Desk.button(Number.isFinite(value) ? R.say(value, 4) : '✕', () => pick(n), { class: 'cell', 'aria-pressed': String(n === chosen), 'aria-label': `${all[across].name} ${x}${y ? `, ${all[down].name} ${y}` : ''}: ${Number.isFinite(value) ? R.say(value, 4) : found.runs[n].failed}`, title: found.runs[n].failed ?? '' });
      button.style.setProperty('--share', String(share));
      return R.make('td', {}, button);
    };
    place.views.append(R.make('figure', { class: 'card grid-card' }, R.make('figcaption', {}, R.make('span', { class: 'title' }, `${lead.name} ${lead.unit ? `[${lead.unit}]` : ''}`), R.make('span', { class: 'note' }, `${others.join(', ')} from ${R.say(low, 4)} (light) to ${R.say(high, 4)} (dark)`)),
      R.make('div', { class: 'wide' }, R.make('table', { class: 'heat', 'aria-label': 'Grid of the sweep' }, R.make('thead', {}, R.make('tr', {}, R.make('th', { scope: 'col' }, all.length > 1 ? `${all[down].name} \\ ${all[across].name}` : all[across].name), ...columns.map((x) => R.make('th', { scope: 'col' }, x)))),
        R.make('tbody', {}, ...rows.map((y) => R.make('tr', {}, R.make('th', { scope: 'row' }, y), ...columns.map((x) => cell(x, y)))))))));
  };
  /** A small picture for each number, over the first parameter, a line for each value of the second. @param {any[]} all @param {any[]} numbers */
  const multiples = (all, numbers) => {
    const first = all[across];
    if (!first || first.values.some((/** @type {any} */ value) => typeof value === 'string') || new Set(first.values).size < 2) return;
    const x = [...new Set(first.values)].sort((a, b) => a - b), second = all.length > 1 ? all[down] : null;
    const fixed = Math.max(chosen, 0), fits = (/** @type {number} */ n) => all.every((one, at) => at === across || at === down || one.texts[n] === one.texts[fixed]);
    const groups = second ? [...new Set(second.texts)].slice(0, 6) : [''];
    // Random values do not stand in rows: there the lines across the axes show more.
    if (second && groups.length * x.length > 4 * found.runs.length) return;
    const box = R.make('div', { class: 'multiples' });
    place.views.append(box);
    for (const one of numbers.slice(0, 24)) {
      const series = groups.map((group) => ({ name: second ? `${second.name} ${group}` : one.name, values: x.map((value) => { const n = found.runs.findIndex((/** @type {any} */ _, /** @type {number} */ at) => first.values[at] === value && (!second || second.texts[at] === group) && fits(at)); return n >= 0 && Number.isFinite(one.values[n]) ? one.values[n] : null; }) }));
      drawn.push(Charts.curves(box, { title: `${one.name} ${one.unit ? `[${one.unit}]` : ''}`, x, series, across: first.name, height: 150 }));
    }
  };

  const build = () => {
    const view = document.getElementById('sweep-view');
    if (!view) return false;
    place.names = R.make('datalist', { id: 'sweep-names' });
    place.signals = R.make('datalist', { id: 'sweep-signals' });
    place.over = R.make('div', { class: 'overs' }, row());
    place.metrics = R.make('div', {});
    place.random = R.make('input', { type: 'checkbox' });
    place.count = R.make('input', { type: 'text', value: '50', size: '5', 'aria-label': 'Number of random runs', inputmode: 'numeric' });
    place.start = Desk.button('Run all', start, { class: 'main' });
    place.stop = Desk.button('■ Stop', () => Desk.ask('sweep', { stop: true }).catch(Desk.refuse));
    place.stop.hidden = true;
    place.bar = R.make('progress', { max: '1', value: '0', 'aria-label': 'Runs that are done' });
    place.bar.hidden = true;
    place.told = R.make('p', { class: 'note', role: 'status' });
    place.picked = R.make('div', { class: 'picked', 'aria-live': 'polite' });
    place.views = R.make('div', { class: 'sweep-views' });
    view.replaceChildren(R.make('div', { class: 'move-form sweep-form' }, place.names, place.signals, R.make('h2', {}, 'Parameters and their values'), place.over, Desk.button('+ parameter', () => place.over.append(row())),
      R.make('h2', {}, 'Measured'), R.make('p', { class: 'note' }, 'Without an entry: how set values are followed.'), place.metrics, Desk.button('+ number', () => place.metrics.append(metric())),
      R.make('div', { class: 'keep' }, R.make('label', {}, place.random, ' random values, '), place.count, ' runs'), R.make('div', { class: 'keep' }, place.start, place.stop), place.bar), place.told, place.picked, place.views);
    Desk.on('sweep', (/** @type {any} */ { done, of }) => { place.bar.hidden = place.stop.hidden; place.bar.value = done / of; if (!place.stop.hidden) told(`${done} of ${of} runs are done`); });
    R.onTheme.push(() => { for (const u of drawn) u.redraw(false, true); });
    return true;
  };
  /** @param {number} now Version of the model. */
  const renew = async (now) => {
    const view = document.getElementById('sweep-view');
    if (!view || view.closest('section')?.hidden || version === now) return;
    if (!place.told && !build()) return;
    version = now;
    try {
      const [signals, values] = await Promise.all([Desk.ask('signals'), Desk.ask('parameters')]);
      const options = (/** @type {string[]} */ all) => all.slice(0, 2000).map((name) => R.make('option', { value: name }));
      place.signals.replaceChildren(...options(signals.recorded));
      place.targets = values.targets;
      place.names.replaceChildren(...options(values.targets.map((/** @type {any} */ one) => one.name)));
    } catch (error) { Desk.refuse(error); }
  };
  return { build, renew, row, pick, found: () => found, place };
})();
