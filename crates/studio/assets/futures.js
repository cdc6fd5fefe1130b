// @ts-check
'use strict';
// Back into the past of a run, and the futures that were left for that: dashed behind the present one in the scopes.
/* global R, uPlot */

/** @type {any} */ (R).Futures = (() => {
  const { Desk } = /** @type {any} */ (R);
  /** Futures that are drawn at a time, and instants that are listed. */
  const DRAWN = 3, LISTED = 40;
  /** @type {{from: number, to: number, columns: Float64Array[], rows: number, hidden: boolean}[]} */ let left = [];
  /** @type {{t: number, text: string}[]} */ let instants = [];
  /** The instant that one looks at, where that is not the last one; null otherwise. @type {number|null} */ let chosen = null;
  let own = false;
  /** @type {any} */ const place = { slider: null, go: null, mark: null, latest: null, list: null, futures: null };
  /** @type {any} */ let run = null;

  /** How far the run is: rows tell that more often than its state. */
  const now = () => Math.max(run.state()?.t ?? 0, run.time());
  /** An instant was chosen, by the slider or in a scope. @param {number|null} t */
  const choose = (t) => {
    chosen = t;
    own = true;
    R.setTime(t ?? run.time());
    own = false;
    told();
  };
  const told = () => {
    if (!place.slider || !run) return;
    const last = run.time(), there = run.rows() > 1 && last > 0;
    const t = chosen ?? last;
    place.bar.hidden = !there;
    place.slider.max = String(last);
    if (chosen === null) place.slider.value = String(last); else place.slider.value = String(chosen);
    place.slider.setAttribute('aria-valuetext', `${R.say(t)} s`);
    place.go.textContent = `↶ Back to ${R.say(t, 4)} s`;
    place.go.disabled = chosen === null || chosen >= now() || !run.goesBack();
    place.latest.hidden = chosen === null;
  };
  /** Goes back to the chosen instant. */
  const back = () => { if (!place.go.disabled) run.control({ do: 'back', t: chosen }); };
  /** Keeps an instant in the list. @param {number} t @param {string} text */
  const note = (t, text) => {
    instants = [...instants.filter((one) => one.t !== t || one.text !== text), { t, text }].sort((a, b) => a.t - b.t).slice(-LISTED);
    list();
  };
  const list = () => {
    place.list.replaceChildren(...instants.map(({ t, text }) => R.make('li', {}, Desk.button(`${R.say(t, 4)} s`, () => choose(t), { title: 'Look at this instant; B goes back to it' }), ' ', R.make('bdi', {}, text))));
    place.instants.hidden = instants.length === 0;
    place.instants.firstChild.textContent = `${instants.length} ${instants.length === 1 ? 'instant' : 'instants'} of this run`;
  };

  /** The futures that were left, with the pages that show and compare them. @param {any} state */
  const futures = (state) => {
    const all = state?.futures ?? [], name = state?.name;
    place.futures.hidden = all.length === 0;
    place.futures.replaceChildren(R.make('b', {}, all.length === 1 ? 'The other future' : 'Other futures'), R.make('ul', {}, ...all.map((/** @type {any} */ one, /** @type {number} */ n) => {
      const drawn = left[n + left.length - all.length], box = R.make('input', { type: 'checkbox' });
      box.checked = drawn ? !drawn.hidden : false;
      box.disabled = !drawn;
      box.addEventListener('change', () => { drawn.hidden = !box.checked; run.redraw(); });
      const parts = [R.make('label', {}, box, ` dashed, up to ${R.say(one.t, 4)} s`)];
      if (one.name) parts.push(' ', R.make('a', { href: `#runs/${encodeURIComponent(one.name)}` }, 'Results'));
      if (one.name && name) parts.push(' ', R.make('a', { href: `#runs/${encodeURIComponent(`${name}~${one.name}`)}` }, 'Compare with it'));
      return R.make('li', {}, ...parts);
    })));
  };

  /** The command that repeats a run, from the start and to the bit. @param {any} state */
  const command = (state) => {
    const records = state?.record ?? [], sets = state?.set ?? [], changes = state?.changes ?? [];
    place.command.hidden = !state?.model || state.state === 'idle';
    if (place.command.hidden) return;
    const word = (/** @type {string} */ text) => /^[\w./:=+-]+$/.test(text) ? text : `"${text.replace(/["\\$`]/g, '\\$&')}"`;
    const line = ['blocksim run', word(state.model), ...sets.map((/** @type {string} */ set) => `--set ${word(set)}`), ...(records.length ? [`--record ${word(records.join(','))}`] : []), ...changes.map((/** @type {string} */ change) => `--change ${word(change)}`)].join(' ');
    if (place.line.textContent === line) return;
    place.line.textContent = line;
  };

  /** The run stands at an instant of its past. @param {number} t @param {Float64Array[]} columns @param {number} rows @param {number} kept Rows that both futures have. */
  const leave = (t, columns, rows, kept) => {
    // From the last common row on.
    const from = Math.max(0, kept - 1);
    left.push({ from: t, to: columns[0][rows - 1], columns: columns.map((column) => column.slice(from, rows)), rows: rows - from, hidden: false });
    left = left.slice(-DRAWN);
    instants = instants.filter((one) => one.t < t || one.text === 'marked');
    list();
    choose(null);
  };
  /** Another run has begun. */
  const begin = () => { left = []; instants = []; chosen = null; if (place.list) { list(); told(); } };

  const shown = () => left.filter((one) => !one.hidden);
  /** Ends of what other futures add to a picture, so that it has room for them. @param {any} panel */
  const reach = (panel) => {
    let low = Infinity, high = -Infinity;
    for (const future of shown()) for (const s of panel.series) {
      if (s.hidden) continue;
      for (const x of future.columns[s.column + 1] ?? []) if (Number.isFinite(x)) { low = Math.min(low, x); high = Math.max(high, x); }
    }
    return low <= high ? [low, high] : null;
  };
  /** Draws the other futures into a picture. @param {any} u @param {any} panel */
  const draw = (u, panel) => {
    const all = shown();
    if (!all.length || panel.lanes) return;
    const context = u.ctx, { left: x, top, width, height } = u.bbox, dot = devicePixelRatio;
    context.save();
    context.beginPath();
    context.rect(x, top, width, height);
    context.clip();
    context.setLineDash([3 * dot, 3 * dot]);
    context.lineWidth = 1.3 * dot;
    for (const future of all) panel.series.forEach((/** @type {any} */ s, /** @type {number} */ n) => {
      const values = future.columns[s.column + 1];
      if (s.hidden || !values) return;
      context.strokeStyle = u.series[n + 1].stroke(u, n + 1);
      context.beginPath();
      // No more points than the screen has.
      const step = Math.max(1, Math.floor(future.rows / (2 * width)));
      let open = false;
      for (let row = 0; row < future.rows; row += step) {
        if (!Number.isFinite(values[row])) { open = false; continue; }
        const px = u.valToPos(future.columns[0][row], 'x', true), py = u.valToPos(values[row], 'y', true);
        if (open) context.lineTo(px, py); else context.moveTo(px, py);
        open = true;
      }
      context.stroke();
    });
    context.restore();
  };

  /** @param {HTMLElement} view @param {any} owner */
  const build = (view, owner) => {
    run = owner;
    place.slider = R.make('input', { type: 'range', min: '0', max: '1', step: 'any', value: '0', 'aria-label': 'Instant', title: 'Look at an instant of the run' });
    place.slider.addEventListener('input', () => choose(Number(place.slider.value)));
    place.go = Desk.button('↶ Back', back, { title: 'Back to this instant; what came behind it is kept as a run (B)' });
    place.mark = Desk.button('Mark', () => note(chosen ?? run.time(), 'marked'), { title: 'Keep this instant in the list (M)' });
    place.latest = Desk.button('To the last row', () => choose(null), { title: 'Follow the run again' });
    place.bar = R.make('div', { class: 'instant' }, place.slider, place.go, place.mark, place.latest);
    place.list = R.make('ul', {});
    place.instants = R.make('details', { class: 'instants' }, R.make('summary', {}, ''), place.list);
    place.futures = R.make('div', { class: 'futures' });
    place.line = R.make('code', {});
    const copy = Desk.button('Copy', async () => { try { await navigator.clipboard.writeText(place.line.textContent); Desk.say('the command is in the clipboard'); } catch { getSelection()?.selectAllChildren(place.line); Desk.say('the command is selected; Ctrl C copies it'); } });
    place.command = R.make('details', { class: 'command' }, R.make('summary', {}, 'This run by a command, to the bit'), place.line, ' ', copy);
    view.replaceChildren(place.bar, place.instants, place.futures, place.command);
    for (const one of [place.instants, place.futures, place.command, place.bar]) one.hidden = true;
    // A click in a scope chooses its instant.
    R.onTime.push((t) => { if (!own && !run.draws() && run.rows() > 1 && !view.closest('section')?.hidden) { chosen = t >= run.time() ? null : t; told(); } });
    const before = R.Overlay.draw;
    R.Overlay.draw = (/** @type {any} */ u, /** @type {any} */ panel, /** @type {boolean} */ main) => { before(u, panel, main); if (main) draw(u, panel); };
    Desk.on('tuned', (/** @type {any} */ { t, set, refused }) => { if (!refused) note(t, set); });
  };
  /** How the run is. @param {any} state */
  const renew = (state) => { futures(state); command(state); told(); };
  return { build, renew, begin, leave, told, back, mark: () => { if (!place.bar.hidden) place.mark.click(); }, chosen: () => chosen, note, instants: () => instants, adopt: (/** @type {{t: number, text: string}[]} */ all) => { for (const { t, text } of all) note(t, text); }, reach, left: () => left };
})();
