// @ts-check
'use strict';
// Runs that were kept, and the page of one of them.
/* global R */

/** @type {any} */ (R).Runs = (() => {
  const { Desk } = /** @type {any} */ (R);
  /** Which run is shown, and which one waits for another to be compared with. */
  let shown = '', chosen = '';

  /** @param {string} name Of the run to show; nothing for the list. */
  const renew = async (name) => {
    const view = document.getElementById('runs-view');
    if (!view || view.closest('section')?.hidden) return;
    if (name) {
      if (shown === name) return;
      shown = name;
      const page = R.make('iframe', { src: `/runs/${encodeURIComponent(name)}`, title: `Results of ${name.replace('~', ' beside ')}`, class: 'run-page' });
      const told = R.make('span', { class: 'note', role: 'status' });
      // One file, which can be handed on.
      const write = async () => {
        try {
          const { file, bytes } = await Desk.ask('report', { run: name });
          told.textContent = `${file} is written (${Math.round(bytes / 1000)} kB)`;
        } catch (error) { Desk.refuse(error); }
      };
      view.replaceChildren(R.make('p', { class: 'tools' }, R.make('a', { href: '#runs' }, 'All runs'), R.make('b', {}, name.replace('~', ' beside ')), R.make('a', { href: `/runs/${encodeURIComponent(name)}`, target: '_blank', rel: 'noreferrer' }, 'in a page of its own'),
        name.includes('~') ? '' : Desk.button('Write report.html', write, { title: 'The page as one file in the folder of the run' }), told), page);
      return;
    }
    shown = '';
    let all = [];
    try { all = await Desk.ask('runs'); } catch (error) { Desk.refuse(error); return; }
    all.reverse();
    if (!all.some((/** @type {any} */ run) => run.name === chosen)) chosen = '';
    /** @param {any} run */
    const compare = ({ name }) => {
      if (chosen && chosen !== name) { location.hash = `#runs/${encodeURIComponent(`${chosen}~${name}`)}`; chosen = ''; return; }
      chosen = chosen ? '' : name;
      renew('').then(() => document.getElementById(`compare-${name}`)?.focus());
    };
    const text = (/** @type {any} */ run) => chosen === '' ? 'Compare' : chosen === run.name ? 'Choose another run, or leave it' : 'Compare with it';
    const rows = all.map((/** @type {any} */ run) => [R.make('a', { href: `#runs/${encodeURIComponent(run.name)}` }, run.name), R.make('bdi', {}, run.model ?? ''), run.ended, run.simulated, run.took,
      all.length > 1 ? Desk.button(text(run), () => compare(run), { id: `compare-${run.name}`, 'aria-pressed': String(chosen === run.name) }) : '']);
    view.replaceChildren(rows.length ? Desk.table('Runs', ['run', 'model', 'ended', 'simulated', 'took', 'side by side'], rows) : R.make('p', { class: 'note' }, 'There are no runs yet; F5 makes one.'));
  };
  return { renew };
})();
