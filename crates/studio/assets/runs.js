// @ts-check
'use strict';
// Runs that were kept, and the page of one of them.
/* global R */

/** @type {any} */ (R).Runs = (() => {
  const { Desk, Measured } = /** @type {any} */ (R);
  /** Which run is shown, and which one waits for another to be compared with. */
  let shown = '', chosen = '';
  const SECTIONS = [['3d', '3D'], ['scopes', 'scopes'], ['planes', 'planes'], ['diagram', 'diagram'], ['tracking', 'tracking'], ['parameters', 'parameters'], ['events', 'events']];
  /** What the written page has, until somebody chooses otherwise. @type {{full: boolean, author: string, left: Set<string>}} */ const options = { full: false, author: '', left: new Set() };

  /** What writes one file, which can be handed on: a button, what came of it, and options. @param {string} run @param {string[]} measured */
  const written = (run, measured) => {
    const told = R.make('span', { class: 'note', role: 'status' }), command = R.make('code');
    const sections = () => options.left.size ? SECTIONS.map(([name]) => name).filter((name) => !options.left.has(name)) : [];
    const write = async () => {
      told.textContent = '';
      if (options.left.size === SECTIONS.length) { Desk.say('a page has one section at least', true); return; }
      try {
        const { file, bytes } = await Desk.ask('report', { run, measured, full: options.full, author: options.author, sections: sections() });
        told.textContent = `${file} is written (${Math.round(bytes / 1000)} kB)`;
      } catch (error) { Desk.refuse(error); }
    };
    const quoted = (/** @type {string} */ text) => /^[\w./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
    const commanded = () => {
      const words = [options.full ? '--full' : '', options.left.size ? `--sections ${sections().join(',')}` : '', options.author.trim() ? `--author ${quoted(options.author.trim())}` : '', ...measured.map((name) => `--overlay measured/${name}.ron`)];
      command.textContent = ['blocksim report', quoted(run), ...words].filter(Boolean).join(' ');
    };
    const tick = (/** @type {string} */ text, /** @type {boolean} */ on, /** @type {(on: boolean) => void} */ does) => {
      const input = R.make('input', { type: 'checkbox' });
      input.checked = on;
      input.addEventListener('change', () => { does(input.checked); commanded(); });
      return R.make('label', {}, input, ' ', text);
    };
    const author = R.make('input', { type: 'text', value: options.author, size: '20', maxlength: '200', autocomplete: 'name' });
    author.addEventListener('input', () => { options.author = author.value; commanded(); });
    commanded();
    const button = Desk.button('Write report.html', write, { title: 'The page as one file in the folder of the run' });
    const details = R.make('details', { class: 'written' }, R.make('summary', {}, 'Options of report.html'), R.make('div', { class: 'written-form' },
      R.make('fieldset', { class: 'kinds' }, R.make('legend', {}, 'Sections beside the summary'), ...SECTIONS.map(([name, text]) => tick(text, !options.left.has(name), (on) => { if (on) options.left.delete(name); else options.left.add(name); }))),
      R.make('p', { class: 'buttons' }, tick('all values, however large the file becomes', options.full, (on) => { options.full = on; })),
      R.make('p', { class: 'buttons' }, R.make('label', {}, 'name of the student or author ', author)),
      R.make('p', {}, 'On the command line: ', command)));
    return { button, told, details };
  };

  /** The page of a run, or of two. @param {HTMLElement} view @param {string} name */
  const page = async (view, name) => {
    const [run, ...measured] = name.split('*'), title = run.replace('~', ' beside '), isOne = !run.includes('~');
    const frame = R.make('iframe', { src: `/runs/${encodeURIComponent(name)}`, title: `Results of ${title}`, class: 'run-page' });
    const over = isOne ? await Measured.switches(run, measured) : '';
    if (shown !== name) return;
    const one = isOne ? written(run, measured) : null;
    view.replaceChildren(R.make('p', { class: 'tools' }, R.make('a', { href: '#runs' }, 'All runs'), R.make('b', {}, title), R.make('a', { href: `/runs/${encodeURIComponent(name)}`, target: '_blank', rel: 'noreferrer' }, 'in a page of its own'), ...(one ? [one.button, one.told] : []), over),
      one?.details ?? '', frame);
  };

  /** @param {string} name Of the run to show; nothing for the list. */
  const renew = async (name) => {
    const view = document.getElementById('runs-view');
    if (!view || view.closest('section')?.hidden) return;
    if (name) {
      if (shown === name) return;
      shown = name;
      await page(view, name);
      return;
    }
    // Whoever is at work on a measurement stays there.
    if (shown === '' && view.querySelector('.measured-form')) return;
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
    const measured = await Measured.section();
    if (shown !== '') return;
    view.replaceChildren(rows.length ? Desk.table('Runs', ['run', 'model', 'ended', 'simulated', 'took', 'side by side'], rows) : R.make('p', { class: 'note' }, 'There are no runs yet; F5 makes one.'), measured);
  };
  return { renew };
})();
