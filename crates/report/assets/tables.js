// @ts-check
'use strict';
// Tables of the model's parameters: folded, and made when they are opened.
/* global R */

R.Tables = (() => {
  /** @type {((row: number) => void)[]} Shows a row of each table. */ let shows = [];
  /** @param {string} name @param {string[]} head @param {string[][]} rows */
  const table = (name, head, rows) => R.make('div', { class: 'wide' }, R.make('table', { 'aria-label': name },
    R.make('thead', {}, R.make('tr', {}, ...head.map((name) => R.make('th', { scope: 'col' }, name)))),
    R.make('tbody', {}, ...rows.map((row) => R.make('tr', {}, ...row.map((cell) => R.make('td', {}, cell)))))));

  /** @param {any} texts */
  const build = (texts) => {
    const place = document.getElementById('tables');
    if (!place || !texts.tables.length) return;
    const filter = R.make('input', { type: 'search', placeholder: 'filter', 'aria-label': 'Filter the parameters', class: 'screen' });
    const all = texts.tables.map((/** @type {any} */ { title, head, rows }) => {
      const name = R.make('summary'), box = R.make('details', { class: 'parameters' }, name);
      const fill = () => {
        const wanted = filter.value.trim().toLowerCase();
        const fit = wanted ? rows.filter((/** @type {string[]} */ row) => row.some((cell) => cell.toLowerCase().includes(wanted))) : rows;
        name.textContent = `${title} (${fit.length}${fit.length < rows.length ? ` of ${rows.length}` : ''})`;
        box.hidden = wanted !== '' && fit.length === 0;
        if (box.open) box.replaceChildren(name, table(title, head, fit));
      };
      box.addEventListener('toggle', fill);
      shows.push((row) => {
        filter.value = '';
        box.open = true;
        for (const one of all) one.fill();
        const line = box.querySelectorAll('tbody tr')[row];
        line?.classList.add('chosen');
        line?.scrollIntoView({ block: 'center' });
        name.focus({ preventScroll: true });
      });
      return { box, fill };
    });
    filter.addEventListener('input', () => { for (const { box, fill } of all) { if (filter.value.trim()) box.open = true; fill(); } });
    place.append(filter, ...all.map((/** @type {any} */ one) => one.box));
    for (const one of all) one.fill();
  };
  /** @param {number} at @param {number} row */
  const show = (at, row) => shows[at]?.(row);
  return { build, show };
})();
