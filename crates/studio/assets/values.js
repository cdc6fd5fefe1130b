// @ts-check
'use strict';
// Parameters of the model: what is written, what it is worth, where. A change is a small edit of the text, shown as a difference.
/* global R */

/** @type {any} */ (R).Values = (() => {
  const { Desk, Live } = /** @type {any} */ (R);
  /** Most lines that are shown at a time. */
  const MOST = 400;
  /** @type {any} */ let known = null;
  /** @type {any} */ const place = { filter: null, list: null, change: null };
  /** What was typed and is not written, by its target; nothing of it is lost when the model changes. @type {Map<string, string>} */ const typed = new Map();
  /** Why what was typed is not taken, by its target. @type {Map<string, {message: string, help?: string}>} */ const wrong = new Map();

  /** Shows why a value is not taken, or that nothing is wrong with it. @param {string} target @param {HTMLElement} [place] Where, if not in the list. */
  const explain = (target, place) => {
    const answer = place ?? document.querySelector(`#values-view .answer[data-target="${CSS.escape(target)}"]`), why = wrong.get(target);
    answer?.replaceChildren(...(why ? [R.make('span', { class: 'bad' }, why.message), ...(why.help ? [R.make('div', { class: 'note' }, why.help)] : [])] : []));
  };
  /** @param {string} target @param {string} value @param {boolean} only Run with it, without writing it. */
  const change = async (target, value, only) => {
    wrong.delete(target);
    explain(target);
    try {
      if (only) {
        await Desk.ask('run', { set: [`${target}=${value}`], speed: Live.speed() });
        location.hash = '#run';
        return;
      }
      const done = await Desk.ask('set', { target, value });
      typed.delete(target);
      told(done);
    } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      // The list may be another one by now.
      wrong.set(target, { message, help: why?.help });
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
    if (target.lines > 1) return [R.make('bdi', {}, target.name), R.make('span', { class: 'note' }, `${target.lines} lines`), target.worth, where, shared];
    const answer = R.make('div', { class: 'answer', role: 'alert', 'data-target': target.name });
    explain(target.name, answer);
    const field = R.make('input', { type: 'text', value: typed.get(target.name) ?? target.written, 'aria-label': target.name, spellcheck: 'false', size: String(Math.min(Math.max(target.written.length, 8), 36)) });
    if (!known.edit) field.setAttribute('data-look', 'true');
    const write = Desk.button('Write', () => change(target.name, field.value, false), { title: `Write it to ${target.place} (Enter)` });
    const run = Desk.button('Run with it', () => change(target.name, field.value, true), { title: 'Run with this value; no file is changed (Shift Enter)' });
    const turn = Desk.button('Turn', () => Live.turn(target.name, target), { title: 'Turn it while a run goes on' });
    const differs = () => field.value !== target.written;
    const shown = () => { write.hidden = !differs() || !known.edit; run.hidden = !differs(); if (differs()) typed.set(target.name, field.value); else typed.delete(target.name); };
    field.addEventListener('input', shown);
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      if (event.key === 'Enter' && differs()) change(target.name, field.value, event.shiftKey || !known.edit);
      if (event.key === 'Escape') { field.value = target.written; wrong.delete(target.name); explain(target.name); shown(); }
    });
    shown();
    return [R.make('bdi', {}, target.name), R.make('div', {}, field, write, run, ...(/^[+-]?[\d.]|^(true|false)$/.test(target.written) ? [turn] : []), answer), target.worth, where, shared];
  };

  const show = () => {
    if (!known || !place.list) return;
    const words = place.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const all = known.targets.filter((/** @type {any} */ target) => words.every((/** @type {string} */ word) => target.name.toLowerCase().includes(word)));
    const more = all.length - MOST;
    place.list.replaceChildren(Desk.table(['parameter', 'written', 'value', 'place', 'shared by'], all.slice(0, MOST).map(row)), more > 0 ? R.make('p', { class: 'note' }, `${more} more; type more of the name`) : '');
  };

  const renew = async () => {
    const view = document.getElementById('values-view');
    if (!view || view.closest('section')?.hidden) return;
    try { known = await Desk.ask('parameters'); } catch (error) { Desk.refuse(error); return; }
    if (!place.list) {
      place.filter = R.make('input', { type: 'search', placeholder: 'part of a name', 'aria-label': 'Parts of names' });
      place.filter.addEventListener('input', show);
      place.change = R.make('div', { class: 'change' });
      place.list = R.make('div');
      view.replaceChildren(place.filter, place.change, place.list);
    }
    // Who types goes on typing.
    const focus = /** @type {any} */ (document.activeElement), name = place.list.contains(focus) ? focus.getAttribute('aria-label') : null;
    const [from, to] = name ? [focus.selectionStart, focus.selectionEnd] : [0, 0];
    show();
    const again = name && place.list.querySelector(`input[aria-label="${CSS.escape(name)}"]`);
    if (again) { again.focus(); again.setSelectionRange(from, to); }
  };
  /** Shows one parameter, or those of a block. @param {string} name */
  const find = async (name) => {
    await renew();
    if (!place.filter) return;
    place.filter.value = name;
    show();
  };
  return { renew, undo, find };
})();
