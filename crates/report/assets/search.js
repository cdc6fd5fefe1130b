// @ts-check
'use strict';
// Finds blocks, signals, pictures and parameters by any part of their names, and leads there.
/* global R */

R.Search = (() => {
  /** Most that are listed. */
  const MOST = 60;
  /** @typedef {{kind: string, text: string, more: string, low: string, go: () => void}} Entry */
  /** @type {any} */ let texts = null;
  /** @type {Entry[]|null} */ let entries = null;
  /** @type {any} */ let dialog = null;
  /** @type {any} */ let input = null;
  /** @type {any} */ let list = null;
  /** @type {Entry[]} */ let found = [];
  let chosen = 0;

  /** All there is, gathered when it is asked for. @returns {Entry[]} */
  const gather = () => {
    /** @type {Entry[]} */ const all = [];
    const add = (/** @type {string} */ kind, /** @type {string} */ text, /** @type {string} */ more, /** @type {() => void} */ go) => all.push({ kind, text, more, go, low: `${text} ${more}`.toLowerCase() });
    for (const panel of R.data.panels) add('picture', panel.title, panel.group, () => R.Plots.find(panel.series[0].path));
    for (const signal of R.Signals?.all() ?? []) add('signal', signal.path, `${signal.unit}${signal.panel ? '' : ' (no picture yet)'}`.trim(), () => R.Signals.show(signal));
    for (const level of texts?.levels ?? []) {
      for (const block of level.blocks) {
        if (!block) continue;
        const [name, kind, , , parameters] = block, path = level.path ? `${level.path}/${name}` : name;
        add('block', path, kind, () => R.Diagram.show(level.path, name));
        for (const [own, written, value] of parameters) {
          if (written === 'default') continue;
          add('parameter', `${path}.${own}`, `${written}${value && value !== written ? ` = ${value}` : ''}`, () => R.Diagram.show(level.path, name, own));
        }
      }
    }
    (texts?.tables ?? []).forEach((/** @type {any} */ { title, rows }, /** @type {number} */ at) => rows.forEach((/** @type {string[]} */ row, /** @type {number} */ n) => add('parameter', row[0], `${row.slice(1, 3).filter(Boolean).join(', ')} (${title})`.trim(), () => R.Tables.show(at, n))));
    return all;
  };

  /** The lower, the better a name fits; null where it does not. @param {Entry} entry @param {string[]} words */
  const rank = ({ text, low }, words) => {
    let sum = text.length / 100;
    const name = text.toLowerCase(), last = name.slice(Math.max(name.lastIndexOf('/'), name.lastIndexOf('.')) + 1);
    for (const word of words) {
      if (!low.includes(word)) return null;
      sum += last === word ? 0 : last.startsWith(word) ? 1 : last.includes(word) ? 2 : name.includes(word) ? 3 : 5;
    }
    return sum;
  };

  const mark = () => {
    [...list.children].forEach((line, n) => { line.setAttribute('aria-selected', String(n === chosen)); if (n === chosen) line.scrollIntoView({ block: 'nearest' }); });
    if (found.length) input.setAttribute('aria-activedescendant', `found-${chosen}`); else input.removeAttribute('aria-activedescendant');
  };
  const seek = () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    entries ??= gather();
    const fit = words.length ? entries.map((entry) => ({ entry, by: rank(entry, words) })).filter(({ by }) => by !== null) : [];
    fit.sort((a, b) => Number(a.by) - Number(b.by));
    found = fit.slice(0, MOST).map(({ entry }) => entry);
    chosen = 0;
    list.replaceChildren(...found.map((entry, n) => {
      const line = R.make('li', { role: 'option', id: `found-${n}` }, R.make('span', { class: 'kind' }, entry.kind), R.make('b', {}, entry.text), ' ', R.make('span', { class: 'more' }, entry.more));
      line.addEventListener('click', () => { chosen = n; go(); });
      return line;
    }));
    dialog.querySelector('.note').textContent = !words.length ? 'Any part of a name, several parts apart: blocks, signals, pictures, parameters.' : fit.length > found.length ? `${found.length} of ${fit.length}; more letters find fewer` : fit.length ? '' : 'Nothing is called so.';
    mark();
  };
  const go = () => {
    const entry = found[chosen];
    if (!entry) return;
    dialog.close();
    entry.go();
  };

  const open = () => {
    if (!dialog) return;
    if (!dialog.open) dialog.showModal();
    // What was drawn since may be found, too.
    entries = null;
    input.select();
    seek();
  };

  /** Other texts in the place of those before. @param {any} read */
  const renew = (read) => {
    if (!dialog) { build(read); return; }
    texts = read;
    entries = null;
  };

  /** @param {any} read Texts of the page. */
  const build = (read) => {
    texts = read;
    input = R.make('input', { type: 'search', role: 'combobox', 'aria-expanded': 'true', 'aria-controls': 'found', 'aria-autocomplete': 'list', 'aria-label': 'Find a block, a signal, a picture or a parameter', autocomplete: 'off', spellcheck: 'false', placeholder: 'such as: joint1 angle' });
    list = R.make('ul', { role: 'listbox', id: 'found', 'aria-label': 'Found' });
    dialog = R.make('dialog', { id: 'search', 'aria-label': 'Find' }, input, R.make('p', { class: 'note' }), list);
    input.addEventListener('input', seek);
    dialog.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
      if (by && found.length) chosen = Math.min(Math.max(chosen + by, 0), found.length - 1);
      else if (event.key === 'Enter') { event.preventDefault(); go(); return; }
      else return;
      event.preventDefault();
      mark();
    });
    // A click beside it closes it.
    dialog.addEventListener('click', (/** @type {MouseEvent} */ event) => { if (event.target === dialog) dialog.close(); });
    document.body.append(dialog);
    document.addEventListener('keydown', (event) => { if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'k') { event.preventDefault(); open(); } });
    const button = document.getElementById('find');
    button?.removeAttribute('hidden');
    button?.addEventListener('click', open);
  };
  return { build, renew, open };
})();
