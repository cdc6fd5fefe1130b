// @ts-check
'use strict';
// Puts the page together: time line, playback, keys, light and dark, levels of the diagram.
/* global R */

(() => {
  const KEYS = [
    ['Space', 'play and stop'], ['← →', 'one step back and on (Shift: ten)'], ['Home, End', 'begin and end'],
    ['A, B', 'set cursor A or B to the present time, again to take it away; with the mouse they can be drawn along'], ['T', 'table of values at the cursors and between them'], ['+ −', 'zoom in and out in time'], ['[ ]', 'move the range'],
    ['0', 'all times'], ['1 – 6', '3D: oblique, front, back, left, right, above'], ['F', '3D: fit'], ['G, P, M, C', '3D: set value, path, frames, centres of mass'], ['S, E, J', '3D: speed along the path, torques of the joints, table of the pose'],
    ...(R.data.compared ? [['N', 'next place where the runs differ (Shift: the one before)']] : []), ['Enter, Backspace', 'diagram: into a block, one level up'], ['arrows', 'diagram: along the wires, where a block is chosen'], ['W', 'diagram: from wire to wire (Shift: back)'], ['V', 'diagram: values on wires'], ['/', 'find a block, a signal, a picture, a parameter (also Ctrl K)'], ['O', 'lay a measurement over'], ['D', 'light or dark'], ['?', 'this list'],
  ];
  let playing = false, speed = 1, before = 0, single = true;
  /** @type {any} */ let slider = null;
  /** @type {any} */ let clock = null;
  /** @type {any} */ let play = null;
  /** @type {any} */ let readout = null;
  let said = 0;

  const timeline = () => {
    const foot = document.getElementById('timeline');
    if (!foot || (!R.data.panels.length && !R.data.space)) return;
    play = R.make('button', { type: 'button', title: 'Play or stop (Space)', 'aria-label': 'Play' }, '▶');
    play.addEventListener('click', toggle);
    slider = R.make('input', { type: 'range', min: '0', max: '1000', step: 'any', value: '0', 'aria-label': 'Time' });
    slider.addEventListener('input', () => R.setTime(R.span[0] + Number(slider.value) / 1000 * (R.span[1] - R.span[0])));
    clock = document.createTextNode('');
    readout = R.make('output', { class: 'readout' });
    const choice = R.make('select', { 'aria-label': 'Speed', title: 'Speed' }, ...[0.1, 0.25, 0.5, 1, 2, 5].map((x) => R.make('option', { value: String(x) }, x + '×')));
    choice.value = '1';
    choice.addEventListener('change', () => { speed = Number(choice.value); });
    const cursor = (/** @type {0|1} */ which) => {
      const button = R.make('button', { type: 'button', class: 'cursor-' + 'ab'[which], title: `Cursor ${'AB'[which]} here, again to take it away (${'AB'[which]})` }, 'AB'[which]);
      button.addEventListener('click', () => mark(which));
      return button;
    };
    const full = R.span[1] - R.span[0];
    // Where something touches is marked below the slider.
    const marks = (R.data.space?.contacts ?? []).map((/** @type {[number, number, string, string, number]} */ [from, to, one, other]) => {
      const mark = R.make('i', { title: `${one} touches ${other}` });
      mark.style.left = `${(from - R.span[0]) / full * 100}%`;
      mark.style.width = `max(3px, ${(to - from) / full * 100}%)`;
      return mark;
    });
    foot.append(play, R.make('div', { class: 'rail' }, slider, ...marks), R.make('output', { class: 'clock' }, clock, R.make('span', { class: 'all' }, ` of ${R.time(R.span[1])} s`)), choice, cursor(0), cursor(1), readout);
    R.onTime.push((t) => { slider.value = String((t - R.span[0]) / full * 1000); clock.data = `t = ${R.time(t)} s`; slider.setAttribute('aria-valuetext', R.time(t) + ' s'); });
    R.onCursors.push(() => {
      const [a, b] = R.cursors, parts = [];
      if (a !== null) parts.push(`A ${R.time(a)} s`);
      if (b !== null) parts.push(`B ${R.time(b)} s`);
      if (a !== null && b !== null && a !== b) parts.push(`Δ ${R.say(b - a)} s`, `1/Δ ${R.say(1 / (b - a))} Hz`);
      readout.textContent = parts.join('  ·  ');
      clearTimeout(said);
      said = setTimeout(() => { const place = document.getElementById('announcement'); if (place) place.textContent = readout.textContent; }, 250);
    });
  };

  const toggle = () => {
    playing = !playing;
    play.textContent = playing ? '❚❚' : '▶';
    play.setAttribute('aria-label', playing ? 'Stop' : 'Play');
    if (!playing) return;
    if (R.now >= R.span[1]) R.setTime(R.span[0]);
    before = performance.now();
    requestAnimationFrame(step);
  };
  /** @param {number} stamp */
  const step = (stamp) => {
    if (!playing) return;
    R.setTime(R.now + Math.max(0, stamp - before) / 1000 * speed);
    before = stamp;
    if (R.now >= R.span[1]) toggle(); else requestAnimationFrame(step);
  };
  /** @param {0|1} which */
  const mark = (which) => R.setCursor(which, R.cursors[which] === R.now ? null : R.now);

  /** Where the second run leaves the first: from one signal to the next. */
  let difference = -1;
  const differ = (/** @type {number} */ by) => {
    const marks = R.data.compared?.marks ?? [];
    if (!marks.length) return;
    difference = (difference + by + marks.length) % marks.length;
    const [row, path, t] = marks[difference];
    document.querySelectorAll('#compared tbody tr').forEach((line, n) => line.classList.toggle('chosen', n === row));
    R.setTime(t);
    R.Plots.find(path);
    const place = document.getElementById('announcement');
    if (place) place.textContent = `${path} differs from ${t} s on`;
  };
  const compared = () => {
    const table = document.querySelector('#compared .wide');
    if (!table || !R.data.compared.marks.length) return;
    const next = R.make('button', { type: 'button', class: 'screen' }, 'Next difference (N)');
    next.addEventListener('click', () => differ(1));
    table.before(next);
  };

  const dark = () => document.documentElement.dataset.theme ? document.documentElement.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  const theme = () => {
    document.documentElement.dataset.theme = dark() ? 'light' : 'dark';
    for (const tell of R.onTheme) tell();
  };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { for (const tell of R.onTheme) tell(); });

  const help = () => {
    const dialog = /** @type {HTMLDialogElement} */ (document.getElementById('keys'));
    if (dialog.open) return dialog.close();
    if (!dialog.firstChild) {
      const close = R.make('button', { type: 'button' }, 'Close (Esc)');
      close.addEventListener('click', () => dialog.close());
      const letters = R.make('input', { type: 'checkbox' });
      letters.checked = single;
      letters.addEventListener('change', () => { single = letters.checked; });
      dialog.append(R.make('h2', {}, 'Keys'), R.make('p', {}, R.make('label', {}, letters, ' single letters act as keys')), R.make('dl', {}, ...KEYS.filter(([, does]) => (R.Space || !does.startsWith('3D')) && (R.Diagram || !/^(diagram|find)/.test(does))).flatMap(([key, does]) => [R.make('dt', {}, R.make('kbd', {}, key)), R.make('dd', {}, does)])), close);
    }
    dialog.showModal();
  };

  /** @param {KeyboardEvent} event */
  const typing = (event) => event.target instanceof HTMLElement && (event.target.matches('select, textarea, input:not([type=range])'));
  /** @param {KeyboardEvent} event */
  const key = (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || typing(event)) return;
    const dialog = /** @type {HTMLDialogElement} */ (document.getElementById('keys'));
    if (dialog.open && event.key !== '?') return;
    const small = (R.span[1] - R.span[0]) / 1000 * (event.shiftKey ? 10 : 1);
    /** @type {Record<string, () => void>} */
    const does = {
      ' ': toggle, ArrowLeft: () => R.setTime(R.now - small), ArrowRight: () => R.setTime(R.now + small), Home: () => R.setTime(R.span[0]), End: () => R.setTime(R.span[1]),
      a: () => mark(0), b: () => mark(1), '+': () => R.Plots.zoom(0.5), '=': () => R.Plots.zoom(0.5), '-': () => R.Plots.zoom(2), '[': () => R.Plots.pan(-0.25), ']': () => R.Plots.pan(0.25), '0': () => R.Plots.all(),
      Backspace: () => R.Diagram?.out(), n: () => differ(event.shiftKey ? -1 : 1), w: () => R.Diagram?.walk(event.shiftKey ? -1 : 1), t: () => R.Readings.toggle(), d: theme, '?': help, '/': () => R.Search?.open(), o: () => document.getElementById('overlay-file')?.click(),
    };
    const letter = event.key.toLowerCase();
    // Who speaks to the computer, or types by accident, can switch them off.
    if (!single && /^[a-z0-9]$/.test(letter)) return;
    const action = does[event.key] ?? does[letter] ?? R.Space?.keys?.[letter] ?? R.Diagram?.keys?.[letter];
    if (!action || (event.key === ' ' && event.target instanceof HTMLButtonElement)) return;
    if (!play && [' ', 'a', 'b', 't'].includes(event.key.toLowerCase())) return;
    event.preventDefault();
    action();
  };

  const start = async () => {
    document.getElementById('theme')?.addEventListener('click', theme);
    document.getElementById('help')?.addEventListener('click', help);
    document.addEventListener('keydown', key);
    R.bytes = await R.unpack('report-numbers') ?? R.bytes;
    const m = /** @type {any} */ (window).__m;
    m.unpacked = performance.now();
    R.guarded('The scopes', R.Plots.build);
    // A page without scopes goes over the time of its movement.
    if (!R.data.panels.length && R.data.space) R.guarded('The time', () => { const time = R.list(R.data.space.time); R.span = [time[0], Math.max(time[time.length - 1], time[0] + 1e-9)]; });
    R.guarded('The measurements', R.Overlay.build);
    R.guarded('The time line', timeline);
    R.guarded('The table', R.Readings.build);
    R.guarded('The comparison', compared);
    m.drawn = performance.now();
    // What there is can be seen before the rest is made.
    await new Promise((done) => setTimeout(done, 20));
    const texts = await R.unpack('report-texts');
    if (texts) {
      const read = JSON.parse(new TextDecoder().decode(texts));
      R.guarded('The signals', () => R.Signals.build(read));
      R.guarded('The diagram', () => R.Diagram.build(read));
      R.guarded('The parameters', () => R.Tables.build(read));
      R.guarded('The search', () => R.Search.build(read));
    }
    // Where there is no graphics card, a browser takes a second to make one up.
    R.guarded('The 3D view', () => R.Space?.build());
    R.setTime(R.span[0]);
    for (const tell of R.onCursors) tell();
    m.ready = performance.now();
    document.documentElement.dataset.ready = 'true';
    if (location.hash === '#measure' && play) await R.Measure.run();
  };
  start().catch((error) => R.guarded('The page', () => { throw error; }));
})();
