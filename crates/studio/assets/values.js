// @ts-check
'use strict';
// Parameters of the model: what is written, what it is worth, where. A change is a small edit of the text, shown as a difference.
/* global R */

/** @type {any} */ (R).Values = (() => {
  const { Desk, Project, Live } = /** @type {any} */ (R);
  /** Most lines that are shown at a time. */
  const MOST = 400;
  /** @type {any} */ let known = null;
  /** @type {any} */ const place = { filter: null, list: null, change: null };
  /** The sheet that is shown; empty for all. */ let sheet = '';
  /** Values of the run that is compared with. @type {any} */ let other = null;
  /** What was typed and is not written, by its target, and what was written when that began; nothing of it is lost when the model changes.
   * @type {Map<string, {value: string, was: string}>} */ let typed = new Map();
  /** Why what was typed is not taken, by its target. @type {Map<string, {message: string, help?: string}>} */ let wrong = new Map();
  /** Both, of the other models of the project: names of one mean something else in another. @type {Map<string, [Map<string, {value: string, was: string}>, Map<string, {message: string, help?: string}>]>} */ const drafts = new Map();

  /** Shows why a value is not taken, or that nothing is wrong with it. @param {string} target @param {HTMLElement} [place] Where, if not in the list. */
  const explain = (target, place) => {
    const answer = place ?? document.querySelector(`#values-view .answer[data-target="${CSS.escape(target)}"]`), why = wrong.get(target) ?? overtaken(target);
    // An empty one would only be in the way of those who listen.
    if (why) answer?.setAttribute('role', 'alert'); else answer?.removeAttribute('role');
    answer?.replaceChildren(...(why ? [R.make('span', { class: 'bad' }, why.message), ...(why.help ? [R.make('div', { class: 'note' }, why.help)] : [])] : []));
  };
  /** What is to be known of a value that others have changed while one typed another. @param {string} target */
  const overtaken = (target) => {
    const one = typed.get(target), now = known.targets.find((/** @type {any} */ one) => one.name === target)?.written;
    return one && now !== undefined && now !== one.was ? { message: `the file has ${now} by now; it had ${one.was}`, help: 'what you typed stays; Esc takes the value of the file' } : undefined;
  };
  /** @param {string} target @param {string} value @param {boolean} only Run with it, without writing it. */
  const change = async (target, value, only) => {
    // The model may be another one by the time of the answer.
    const [mine, why] = [typed, wrong], model = known.model;
    why.delete(target);
    explain(target);
    try {
      if (only) {
        await Live.run([`${target}=${value}`]);
        return;
      }
      const done = await Desk.ask('set', { model, target, value, was: mine.get(target)?.was });
      mine.delete(target);
      told(done);
    } catch (error) {
      const { message, why: refused } = /** @type {any} */ (error);
      // It was refused for what the file has by now; who has read that may write over it.
      if (refused?.written !== undefined) mine.set(target, { value, was: refused.written });
      // The list may be another one by now.
      why.set(target, { message, help: refused?.help });
      explain(target);
    }
  };
  /** Shows what was written. @param {any} done */
  const told = (done) => {
    place.change?.replaceChildren(R.make('pre', { class: 'difference' }, done.difference || done.message), Desk.button('Undo (Ctrl Z)', undo));
    Desk.say(done.message);
  };
  /** Takes the last change back. */
  const undo = async () => {
    try { const done = await Desk.ask('undo', {}); place.change?.replaceChildren(R.make('pre', { class: 'difference' }, done.difference)); Desk.say(done.message); } catch (error) { Desk.refuse(error); }
  };

  /** @param {any} target */
  const row = (target) => {
    const shared = target.sharers > 1 ? `${target.sharers} parts` : '', where = R.make('code', {}, target.place);
    // What has several lines is changed in an editor; its items stand below.
    if (target.lines > 1) return [R.make('bdi', {}, target.name), R.make('span', { class: 'note' }, `${target.lines} lines`), target.worth, target.unit, '', '', where, shared, ...(other ? [beside(target)] : [])];
    const answer = R.make('div', { class: 'answer', 'data-target': target.name });
    explain(target.name, answer);
    const field = R.make('input', { type: 'text', value: typed.get(target.name)?.value ?? target.written, 'aria-label': target.name, spellcheck: 'false', size: String(Math.min(Math.max(target.written.length, 8), 36)) });
    if (!known.edit) field.setAttribute('data-look', 'true');
    const write = Desk.button('Write', () => change(target.name, field.value, false), { title: `Write it to ${target.place} (Enter)` });
    const run = Desk.button('Run with it', () => change(target.name, field.value, true), { title: 'Run with this value; no file is changed (Shift Enter)' });
    const turn = Desk.button('Turn', () => Live.turn(target.name, target, panel(target.name)), { title: 'Turn it while a run goes on' });
    const open = () => field.value !== target.written;
    const shown = () => { write.hidden = !open() || !known.edit; run.hidden = !open(); if (open()) typed.set(target.name, { value: field.value, was: typed.get(target.name)?.was ?? target.written }); else typed.delete(target.name); };
    field.addEventListener('input', () => { shown(); bar(); });
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      if (event.key === 'Enter' && open()) change(target.name, field.value, event.shiftKey || !known.edit);
      if (event.key === 'Escape') { field.value = target.written; wrong.delete(target.name); explain(target.name); shown(); bar(); }
    });
    shown();
    // As in a sheet: up and down along the column.
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (!by || event.ctrlKey || event.altKey || event.metaKey) return;
      const all = [...place.list.querySelectorAll('input[type=text]')];
      const next = all[all.indexOf(field) + by];
      if (next) { event.preventDefault(); next.focus(); next.select(); }
    });
    const own = panel(target.name), ends = own ? `${own.range.map((/** @type {number} */ x) => R.say(x)).join(' … ')}${own.unit === target.unit ? '' : ` ${own.shown}`}` : allowed(target), source = [target.source, target.note, target.tolerance && `± ${target.tolerance}`].filter(Boolean).join('; ');
    return [R.make('bdi', {}, target.name), R.make('div', {}, field, write, run, ...(/^[+-]?[\d.]|^(true|false)$/.test(target.written) ? [turn] : []), answer), target.worth, target.unit, ends, source, where, shared, ...(other ? [beside(target)] : [])];
  };
  /** The values that the kind of a block allows, in the unit in which this one is written. @param {any} target */
  const allowed = ({ range, ends: [low, high] }) => range || (low?.[1] && high?.[1] ? `${R.say(low[0])} … ${R.say(high[0])}` : [low && `${low[1] ? '≥' : '>'} ${R.say(low[0])}`, high && `${high[1] ? '≤' : '<'} ${R.say(high[0])}`].filter(Boolean).join(', '));
  /** The slider or knob of a parameter on the panel of the model, if it has one. @param {string} name */
  const panel = (name) => Project.known()?.panel?.find((/** @type {any} */ one) => one.name === name && /slider|knob/i.test(one.kind));
  /** Whether the run that is compared with had another value. @param {any} target */
  const differs = (target) => {
    const was = other?.values[target.name];
    return !was || was.written !== target.written || (!was.set && target.expression && was.worth !== target.worth);
  };
  /** What the other run had. @param {any} target */
  const beside = (target) => {
    const was = other.values[target.name];
    if (!was) return R.make('span', { class: 'note' }, 'was not there');
    const text = was.set || !target.expression ? was.written || 'several lines' : `${was.written} = ${was.worth}`;
    return differs(target) ? R.make('b', { class: 'differs' }, `≠ ${text}${was.set ? ' (set for it)' : ''}`) : R.make('span', { class: 'note' }, 'the same');
  };
  /** Chooses the run to compare with. @param {string} name */
  const compare = async (name) => {
    other = null;
    if (name) try { other = await Desk.ask(`parameters/${encodeURIComponent(name)}`); } catch (error) { place.run.value = ''; Desk.refuse(error); }
    place.only.parentElement.hidden = !other;
    show();
  };

  /** What was typed and is not written, all at a time. */
  const bar = () => {
    const count = typed.size, sets = () => [...typed].map(([target, { value }]) => `${target}=${value}`);
    const all = async () => { for (const [target, { value }] of [...typed]) await change(target, value, false); await renew(); };
    const drop = () => { typed.clear(); wrong.clear(); show(); };
    place.pending.replaceChildren(...(count > 1 ? [R.make('b', {}, `${count} changes are not written`), ' ', ...(known.edit ? [Desk.button('Write all', all)] : []), Desk.button('Run with all', () => Live.run(sets()), { title: 'Run with these values; no file is changed' }), Desk.button('Discard all', drop)] : []));
  };

  const show = () => {
    if (!known || !place.list) return;
    const words = place.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const sheets = [...new Set(known.targets.map((/** @type {any} */ target) => target.sheet))].sort((a, b) => Number(!/^\(\d/.test(a)) - Number(!/^\(\d/.test(b)) || (/^\(\d/.test(a) ? a.localeCompare(b, 'en', { numeric: true }) : 0));
    if (!sheets.includes(sheet)) sheet = '';
    const fits = (/** @type {any} */ target) => words.every((/** @type {string} */ word) => target.name.toLowerCase().includes(word)) && (!other || !place.only.checked || differs(target));
    const fitting = known.targets.filter(fits), count = (/** @type {string} */ name) => fitting.filter((/** @type {any} */ target) => !name || target.sheet === name).length;
    const focus = document.activeElement, was = place.sheets.contains(focus) ? focus?.getAttribute('data-sheet') : null;
    place.sheets.replaceChildren(...(sheets.length > 1 ? ['', ...sheets] : []).map((name) => Desk.button(`${name || 'All'} (${count(name)})`, () => { sheet = name; show(); }, { 'aria-pressed': String(name === sheet), 'data-sheet': name })));
    if (was !== null) place.sheets.querySelector(`[data-sheet="${CSS.escape(was ?? '')}"]`)?.focus();
    const all = fitting.filter((/** @type {any} */ target) => !sheet || target.sheet === sheet);
    const more = all.length - MOST, head = ['parameter', 'written', 'value', 'unit', 'range', 'source', 'place', 'shared by', ...(other ? [other.run] : [])];
    const names = new Set(known.targets.map((/** @type {any} */ target) => target.name)), gone = other ? Object.keys(other.values).filter((name) => !names.has(name)) : [];
    // A column in which nothing stands takes no room.
    const rows = all.slice(0, MOST).map(row), used = head.map((_, n) => n < 2 || rows.some((/** @type {any[]} */ cells) => cells[n] !== ''));
    const narrow = (/** @type {any[]} */ cells) => cells.filter((_, n) => used[n]);
    place.list.replaceChildren(all.length ? Desk.table(sheet || 'All parameters', narrow(head), rows.map(narrow)) : R.make('p', { class: 'note' }, 'No parameter fits.'), more > 0 ? R.make('p', { class: 'note' }, `${more} more; type more of the name`) : '',
      gone.length ? R.make('p', { class: 'note' }, `${other.run} had ${gone.length} more: ${gone.slice(0, 12).join(', ')}${gone.length > 12 ? ' …' : ''}`) : '');
    bar();
  };

  const renew = async () => {
    const view = document.getElementById('values-view');
    if (!view || view.closest('section')?.hidden) return;
    const before = known?.model;
    try { known = await Desk.ask('parameters'); } catch (error) { Desk.refuse(error); return; }
    if (before !== undefined && before !== known.model) {
      drafts.set(before, [typed, wrong]);
      [typed, wrong] = drafts.get(known.model) ?? [new Map(), new Map()];
    }
    if (!place.list) {
      place.filter = R.make('input', { type: 'search', placeholder: 'part of a name', 'aria-label': 'Parts of names' });
      place.filter.addEventListener('input', show);
      place.change = R.make('div', { class: 'change' });
      place.list = R.make('div');
      place.sheets = R.make('div', { class: 'sheets', role: 'group', 'aria-label': 'Sheets' });
      place.pending = R.make('div', { class: 'pending' });
      place.run = R.make('select', { 'aria-label': 'Run to compare with' });
      place.run.addEventListener('change', () => compare(place.run.value));
      place.only = R.make('input', { type: 'checkbox' });
      place.only.addEventListener('change', show);
      view.replaceChildren(R.make('div', { class: 'sheet-tools' }, place.filter, place.run, R.make('label', { hidden: '' }, place.only, ' only what differs')), place.sheets, place.pending, place.change, place.list);
    }
    // Who types goes on typing.
    const focus = /** @type {any} */ (document.activeElement), name = place.list.contains(focus) ? focus.getAttribute('aria-label') : null;
    const [from, to] = name ? [focus.selectionStart, focus.selectionEnd] : [0, 0];
    show();
    const again = name && place.list.querySelector(`input[aria-label="${CSS.escape(name)}"]`);
    if (again) { again.focus(); again.setSelectionRange(from, to); }
    try {
      const runs = (await Desk.ask('runs')).reverse(), chosen = place.run.value;
      place.run.replaceChildren(R.make('option', { value: '' }, 'compare with a run …'), ...runs.map((/** @type {any} */ run) => R.make('option', { value: run.name }, run.name)));
      place.run.value = runs.some((/** @type {any} */ run) => run.name === chosen) ? chosen : '';
    } catch (error) { Desk.refuse(error); }
  };
  /** Shows one parameter, or those of a block. @param {string} name */
  const find = async (name) => {
    await renew();
    if (!place.filter) return;
    place.filter.value = name;
    sheet = '';
    show();
  };
  return { renew, undo, find, typed: () => [...typed].map(([name, { value }]) => [name, value]) };
})();
