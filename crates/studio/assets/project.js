// @ts-check
'use strict';
// The project: what is ready, what is stale and why, what is wrong, and what to do next. Problems stand above the diagram, too.
/* global R */

/** @type {any} */ (R).Project = (() => {
  const { Desk } = /** @type {any} */ (R);
  const SIGNS = { ready: '✔', stale: '↻', error: '✕', missing: '○' };
  /** @type {any} */ let known = null;

  /** Corrects a problem as it proposes itself. @param {number} n */
  const fix = async (n) => {
    try { const done = await Desk.ask('fix', { problem: n, version: known.version }); Desk.say(`${done.message}; Ctrl Z takes it back`); } catch (error) { Desk.refuse(error); }
  };
  /** A problem with its place and its remedy. @param {any} problem @param {number} n */
  const item = (problem, n) => {
    const place = problem.file ? `${problem.file}${problem.line ? `:${problem.line}` : ''}` : '';
    const parts = [R.make('b', {}, problem.severity), ` ${problem.message} `, place ? R.make('code', {}, place) : ''];
    if (problem.help) parts.push(R.make('div', { class: 'note' }, problem.help));
    if (problem.fix !== null && known.edit) parts.push(Desk.button('Fix', () => fix(n), { title: `Write ${problem.fix.trim() || 'nothing'} there` }));
    return R.make('li', { class: problem.severity }, ...parts);
  };
  /** @param {any[]} problems */
  const list = (problems) => R.make('ul', { class: 'problems' }, ...problems.map((one) => item(one, known.problems.indexOf(one))));

  const problems = () => {
    const place = document.getElementById('problems');
    const told = known.problems.filter((/** @type {any} */ problem) => problem.severity !== 'note');
    place?.replaceChildren(...(told.length ? [list(told)] : []));
  };

  const next = () => {
    const does = known.next.map((/** @type {[string, string]} */ [screen, text]) => R.make('li', {}, R.make('a', { href: `#${screen}` }, text)));
    return R.make('ul', { class: 'next' }, ...does);
  };

  const show = () => {
    const place = document.getElementById('project-view');
    if (!place || !known) return;
    const rows = known.rows.map((/** @type {any} */ row) => [
      R.make('bdi', {}, row.item),
      R.make('span', { class: `state ${row.state}` }, `${/** @type {any} */ (SIGNS)[row.state]} ${row.state}`),
      R.make('bdi', {}, row.detail),
      row.written ? new Date(1000 * row.written).toLocaleString([], { dateStyle: 'short', timeStyle: 'medium', hour12: false }) : '',
      row.screen ? R.make('a', { href: `#${row.screen}` }, row.action) : row.action,
    ]);
    place.replaceChildren(R.make('p', { class: 'note' }, known.root, known.edit ? '' : ' – to look at; `blocksim studio --edit` lets you change parameters here'),
      Desk.table('What the project consists of', ['item', 'state', 'what is known', 'written', 'see'], rows),
      ...(known.problems.length ? [R.make('h2', {}, 'Problems'), list(known.problems)] : []), R.make('h2', {}, 'What next'), next());
  };

  /** The name of a file before its folder, as the end of what is too long is out of sight. @param {string} path */
  const shortest = (path) => { const [, folder, file] = path.match(/^(?:(.*)[\\/])?([^\\/]*)$/) ?? []; return folder ? `${file} – ${folder}` : file ?? path; };

  /** @param {any} told */
  const renew = (told) => {
    known = told;
    const choice = /** @type {HTMLSelectElement} */ (document.getElementById('models'));
    choice.replaceChildren(...told.models.map((/** @type {string} */ name) => R.make('option', { value: name }, shortest(name))));
    choice.value = told.model;
    choice.title = `Model ${told.model}`;
    choice.hidden = told.models.length < 2;
    show();
    problems();
  };
  return { renew, known: () => known, SIGNS };
})();
