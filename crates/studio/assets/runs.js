// @ts-check
'use strict';
// Runs that were kept, and the page of one of them.
/* global R */

/** @type {any} */ (R).Runs = (() => {
  const { Desk } = /** @type {any} */ (R);
  let shown = '';

  /** @param {string} name Of the run to show; nothing for the list. */
  const renew = async (name) => {
    const view = document.getElementById('runs-view');
    if (!view || view.closest('section')?.hidden) return;
    if (name) {
      if (shown === name) return;
      shown = name;
      const page = R.make('iframe', { src: `/runs/${encodeURIComponent(name)}`, title: `Results of ${name.replace('~', ' beside ')}`, class: 'run-page' });
      view.replaceChildren(R.make('p', {}, R.make('a', { href: '#runs' }, 'All runs'), ' ', R.make('b', {}, name.replace('~', ' beside ')), ' ', R.make('a', { href: `/runs/${encodeURIComponent(name)}`, target: '_blank', rel: 'noreferrer' }, 'in a page of its own')), page);
      return;
    }
    shown = '';
    let all = [];
    try { all = await Desk.ask('runs'); } catch (error) { Desk.refuse(error); return; }
    const rows = all.reverse().map((/** @type {any} */ run) => [R.make('a', { href: `#runs/${encodeURIComponent(run.name)}` }, run.name), R.make('bdi', {}, run.model ?? ''), run.ended, run.simulated, run.took]);
    view.replaceChildren(rows.length ? Desk.table('Runs', ['run', 'model', 'ended', 'simulated', 'took'], rows) : R.make('p', { class: 'note' }, 'There are no runs yet; F5 makes one.'));
  };
  return { renew };
})();
