// @ts-check
'use strict';
// A run while it runs: how far it is, scopes that fill, pause, speed, and what became of it.
/* global R, uPlot */

/** @type {any} */ (R).Live = (() => {
  const { Desk, Panel, Futures, Movement } = /** @type {any} */ (R);
  /** Numbers beside the pictures change no more often than this, ms. */
  const READ = 100;
  /** A strip with errors is drawn anew no more often than this, ms. */
  const STRIP = 200;
  /** Numbers that a scope has room for at first. */
  const ROOM = 4096;
  /** Steps of a slider, and how many times as wide as a value is a range may be over which its slider goes. */
  const STEPS = 200, WIDE = 20;
  /** @type {any} */ let state = null;
  /** @type {any[]} */ let panels = [];
  /** @type {Float64Array[]} Columns with room behind what is known: the times, then the values. */ let columns = [];
  /** Whether values are missing, by column. @type {boolean[]} */ let gaps = [];
  let read = 0, readLater = 0;
  let rows = 0, dirty = false, fresh = true, follow = 0, until = 1, said = '', shown = 1, joints = 1, draws = false, starts = false, wanted = '', model = '', path = '', source = '';
  /** Signals that are recorded beside those of the model. @type {Set<string>} */ const extra = new Set();
  /** What came before, and is not known here yet, is asked for; news wait for it. */ let behind = true;
  /** @type {[number, () => void][]} */ let waiting = [];
  /** What the run that is asked for has nothing of, and the one that is shown. @type {string[]} */ let unsaved = [], /** @type {string[]} */ lacking = [];
  /** Which run is shown, how often it was missed, and the last news that what was asked for contains. */ let number = 0, missed = 0, known = 0;
  /** @type {any} */ const place = { line: null, bar: null, pause: null, step: null, speed: null, follow: null };
  const running = () => state?.state === 'running' || state?.state === 'paused';
  /** Whether the run is one of the model that is shown. */
  const own = () => state?.model === path;
  /** Whether there is a run of that model that can be changed: one that is compiled yet takes the change when it begins. */
  const turns = () => own() && (running() || state.state === 'starting');

  /** Bytes of a text in base64. @param {string} text */
  const bytes = (text) => {
    const signs = atob(text), all = new Uint8Array(signs.length);
    for (let n = 0; n < signs.length; n++) all[n] = signs.charCodeAt(n);
    return all.buffer;
  };

  /** Lays the scopes of a run out, empty. @param {any} told */
  const scopes = (told) => {
    const look = document.getElementById('plots');
    if (!look) return;
    look.replaceChildren();
    panels = told.panels;
    source = state?.model ?? '';
    R.data.panels = panels;
    columns = [];
    gaps = [];
    rows = 0;
    until = told.until;
    R.span = [0, until];
    Futures.begin();
    // Those of the panel stand behind those of the scopes, and those of the mechanism behind both.
    shown = 1 + panels.reduce((sum, panel) => sum + panel.series.length, 0);
    joints = shown + told.shown.length;
    for (let n = 0; n < joints + (told.joints ?? 0) + (told.sets?.length ?? 0); n++) columns.push(new Float64Array(ROOM));
    Panel.quiet();
    Movement.begin(told, joints);
    for (const panel of panels) {
      panel.time = columns[0].subarray(0, 0);
      for (const s of panel.series) s.values = panel.time;
      panel.byOrder = [...panel.series];
      // Where other futures are drawn as well, they have room.
      panel.reach = (/** @type {number|null} */ low, /** @type {number|null} */ high) => {
        const [least, most] = Futures.reach(panel) ?? [Infinity, -Infinity];
        const [min, max] = [Math.min(low ?? Infinity, least), Math.max(high ?? -Infinity, most)];
        return min <= max ? uPlot.rangeNum(min, max, 0.1, true) : [null, null];
      };
      const roles = panel.series.map((/** @type {any} */ s) => s.role).sort().join();
      panel.series.sort((/** @type {any} */ a, /** @type {any} */ b) => Number(a.role === 'set') - Number(b.role === 'set'));
      panel.pair = roles === 'actual,set' ? [1, 0] : null;
      if (panel.pair) panel.series[0].error = panel.time;
    }
    R.Plots.cards(look, panels);
    // The range of times is that of the run; nobody zooms while it grows.
    for (const panel of panels) for (const u of [panel.main, panel.strip]) if (u) u.live = false;
    watch.disconnect();
    for (const panel of panels) { panel.seen = false; watch.observe(panel.card); }
    range();
    if (wanted) { const name = wanted; wanted = ''; setTimeout(() => R.Plots.find(panels.flatMap((panel) => panel.series).find((/** @type {any} */ s) => s.path === name || s.path.startsWith(`${name}[`))?.path)); }
  };

  /** Times that are shown: all, or the last ones. */
  const range = () => {
    for (const panel of panels) if (panel.seen || !rows) ranged(panel); else panel.stale = true;
  };
  /** @param {any} panel */
  const ranged = (panel) => {
    const now = rows ? columns[0][rows - 1] : 0;
    const [min, max] = follow && now > follow ? [now - follow, now] : [0, follow || until];
    for (const u of [panel.main, panel.strip]) u?.setScale('x', { min, max });
  };

  /** Does what news bring, when all before them is known. @param {number} id @param {() => void} does */
  const ordered = (id, does) => { if (behind) waiting.push([id, does]); else if (id > known) does(); };

  /** Adds rows. @param {any} told */
  const add = (told) => {
    if (!columns.length) return;
    const times = new Float64Array(bytes(told.t)), values = new Float32Array(bytes(told.values));
    const more = times.length;
    if (rows + more > columns[0]?.length) {
      columns = columns.map((column) => { const wide = new Float64Array(Math.max(2 * column.length, rows + more)); wide.set(column); return wide; });
    }
    columns[0]?.set(times, rows);
    for (let n = 1; n < columns.length; n++) {
      const part = values.subarray((n - 1) * more, n * more);
      columns[n].set(part, rows);
      gaps[n] ||= !part.every(Number.isFinite);
    }
    rows += more;
    if (!dirty) { dirty = true; requestAnimationFrame(draw); }
  };

  /** The run stands at an instant of its past: what came behind it is another future. @param {any} told */
  const back = ({ t, refused }) => {
    if (refused) { Desk.say(refused, true); return; }
    let kept = rows;
    while (kept > 0 && columns[0][kept - 1] >= t) kept--;
    Futures.leave(t, columns, rows, kept);
    rows = kept;
    Movement.anew();
    for (const panel of panels) { panel.offRows = Math.min(panel.offRows ?? 0, rows); panel.stale = true; }
    if (!dirty) { dirty = true; requestAnimationFrame(draw); }
  };

  const draw = () => {
    dirty = false;
    if (!columns.length) return;
    const time = columns[0].subarray(0, rows);
    for (const panel of panels) {
      panel.time = time;
      for (const s of panel.series) {
        s.values = columns[s.column + 1].subarray(0, rows);
        if (s.signal) [s.signal.time, s.signal.values] = [time, s.values];
      }
      // What is out of sight is drawn when it comes into sight.
      if (!panel.seen) panel.stale = true;
      else if (!extend(panel)) { paint(panel); ranged(panel); }
    }
    if (running() && rows) { state.t = time[rows - 1]; told(); }
    Movement.grow(columns, rows);
    draws = true;
    R.setTime(Futures.chosen() ?? (rows ? time[rows - 1] : 0));
    draws = false;
    Futures.told();
    for (const panel of panels) if (panel.seen) R.Picture.mark(panel);
    tell();
    gauges();
  };
  /** Gauges and lamps show the last row, if it is one of their model. */
  const gauges = () => {
    if (source !== path) Panel.quiet();
    else if (rows) Panel.show(columns.slice(shown, joints).map((column) => column[rows - 1]));
  };
  /** Gives a picture its rows. @param {any} panel @param {boolean} [kept] Whether what is drawn stays as it is. */
  const give = (panel, kept) => {
    panel.main.setData([panel.time, ...panel.series.map((/** @type {any} */ s) => plain(s.values, gaps[s.column + 1]))], false);
    if (panel.strip && !kept) { panel.strip.setData([panel.time, errors(panel)], false); panel.stripped = performance.now(); }
  };
  /** Draws a picture anew, with its range of times, which is set by who calls. @param {any} panel */
  const paint = (panel) => {
    panel.stale = false;
    panel.time = columns[0].subarray(0, rows);
    give(panel);
    panel.drawn = rows;
  };
  /** Draws what has come since the picture was drawn last, as long as it has room for that: to draw all of it would cost most of the time.
   * @param {any} panel @returns {boolean} Whether that was possible. */
  const extend = (panel) => {
    const u = panel.main, { x, y } = u.scales, from = panel.drawn - 1;
    if (panel.stale || follow || !running() || !(from >= 0) || rows < panel.drawn || x.min !== 0 || x.max !== until || y.min === null) return false;
    if (rows === panel.drawn) return true;
    for (const s of panel.series) {
      if (gaps[s.column + 1]) return false;
      for (let n = from; n < rows; n++) {
        // Where there is no room, or an angle jumps by a turn, the whole picture is another one.
        if (!(s.values[n] >= y.min && s.values[n] <= y.max) || (panel.turn && n > from && Math.abs(s.values[n] - s.values[n - 1]) >= 0.75 * panel.turn)) return false;
      }
    }
    give(panel, true);
    const context = u.ctx, { left, top, width, height } = u.bbox, ratio = devicePixelRatio;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    context.lineJoin = 'round';
    panel.series.forEach((/** @type {any} */ s, /** @type {number} */ at) => {
      const look = u.series[at + 1];
      if (!look.show) return;
      context.strokeStyle = look.stroke(u, at + 1);
      context.lineWidth = look.width * ratio;
      const dash = (look.dash ?? []).map((/** @type {number} */ length) => length * ratio);
      context.setLineDash(dash);
      // Dashes go on where the last ones ended.
      context.lineDashOffset = s.dashed ?? 0;
      // As the picture draws them: at whole dots, moved by what a line of this width needs to be sharp.
      const dot = (/** @type {number} */ x, /** @type {string} */ axis) => Math.round(u.valToPos(x, axis, true)) + (context.lineWidth % 2) / 2;
      context.beginPath();
      let px = dot(panel.time[from], 'x'), py = dot(s.values[from], 'y'), long = 0;
      context.moveTo(px, py);
      for (let n = from + 1; n < rows; n++) {
        const qx = dot(panel.time[n], 'x'), qy = dot(s.values[n], 'y');
        if (s.held) context.lineTo(qx, py);
        context.lineTo(qx, qy);
        long += s.held ? qx - px + Math.abs(qy - py) : Math.hypot(qx - px, qy - py);
        [px, py] = [qx, qy];
      }
      context.stroke();
      const period = dash.reduce((/** @type {number} */ sum, /** @type {number} */ length) => sum + length, 0);
      if (period) s.dashed = ((s.dashed ?? 0) + long) % period;
    });
    context.restore();
    panel.drawn = rows;
    // The strip below is small, and filled: it is drawn anew, but not as often.
    if (panel.strip && performance.now() - (panel.stripped ?? 0) >= STRIP) {
      panel.strip.setData([panel.time, errors(panel)], false);
      panel.strip.setScale('x', { min: 0, max: until });
      panel.stripped = performance.now();
    }
    return true;
  };
  /** How far set and actual values are from each other; only new rows are computed. @param {any} panel */
  const errors = (panel) => {
    const [set, actual] = panel.pair.map((/** @type {number} */ at) => panel.series[at]);
    if (!panel.off || panel.off.length < rows) { const wide = new Float64Array(columns[0].length); wide.set(panel.off?.subarray(0, panel.offRows) ?? []); panel.off = wide; }
    // Where one has jumped by a turn and the other has not, a turn is no error.
    const folds = Boolean(panel.turn) && [set, actual].some((s) => R.jumps(panel.time, s.values, panel.turn).length > 0);
    if (folds !== panel.folds) [panel.folds, panel.offRows] = [folds, 0];
    for (let n = panel.offRows ?? 0; n < rows; n++) {
      const x = set.values[n] - actual.values[n];
      panel.off[n] = folds ? x - panel.turn * Math.round(x / panel.turn) : x;
    }
    panel.offRows = rows;
    return plain(panel.off.subarray(0, rows), gaps[set.column + 1] || gaps[actual.column + 1]);
  };
  /** Numbers beside the pictures change no more often than can be read. */
  const tell = () => {
    clearTimeout(readLater);
    const left = read + READ - performance.now();
    if (left > 0) { readLater = setTimeout(tell, left); return; }
    read = performance.now();
    for (const panel of panels) if (panel.seen) for (const s of panel.series) s.tell();
  };
  /** Draws what has come into sight. */
  const watch = new IntersectionObserver((all) => {
    for (const one of all) {
      const panel = panels.find((candidate) => candidate.card === one.target);
      if (!panel) continue;
      panel.seen = one.isIntersecting;
      if (panel.seen && panel.stale && columns.length) { paint(panel); ranged(panel); }
      if (panel.seen) { R.Picture.mark(panel); for (const s of panel.series) s.tell(); }
    }
  }, { rootMargin: '100px' });
  /** What is missing is null for the plots. @param {Float64Array} values @param {boolean} missing */
  const plain = (values, missing) => missing ? Array.from(values, (x) => Number.isFinite(x) ? x : null) : values;

  /** Time of the last row. */
  const last = () => rows ? columns[0][rows - 1] : 0;
  /** Blocks that are to blame for the end of the last run. @returns {string[]} */
  const failed = () => own() && state.state === 'failed' ? state.blocks ?? [] : [];
  /** Marks them in the picture, and subsystems that they are in. */
  const blame = () => {
    const { level, nodes } = R.Diagram.now();
    if (!level || !nodes) return;
    for (const [n, group] of nodes) {
      const name = level.blocks[n]?.[0], path = name && (level.path ? `${level.path}/${name}` : name);
      const is = Boolean(path) && failed().some((block) => block === path || block.startsWith(`${path}/`));
      group.classList.toggle('failed', is);
      if (is) group.setAttribute('aria-description', 'the last run failed here'); else group.removeAttribute('aria-description');
    }
  };
  const told = () => {
    if (!place.line) return;
    const { model, until, factor, reason, name } = state ?? {};
    // Rows tell more often than the state how far the run is.
    const t = Math.max(state?.t ?? 0, last());
    const text = {
      idle: 'Nothing runs. F5 or the button above runs the model.',
      starting: `${model} is compiled …`,
      running: `${model}: ${R.say(t)} of ${R.say(until ?? 0)} s${factor ? `, ${R.say(factor, 3)} times real time` : ''}`,
      paused: `${model}: paused at ${R.say(t)} of ${R.say(until ?? 0)} s`,
      done: `${model}: ${R.say(until ?? 0)} s simulated in ${R.say(state?.took ?? 0, 3)} s. `,
      stopped: `${model}: ended at ${R.say(t)} s. `,
      failed: `${model}: ${reason}`,
    }[/** @type {'idle'} */ (state?.state ?? 'idle')];
    said = text ?? '';
    // Who is at a link stays there.
    const key = [said, name, ...failed()].join(' ');
    if (place.line.dataset.told !== key) {
      const focus = place.line.contains(document.activeElement);
      const blamed = failed().map((path) => Desk.button(path, () => R.showBlock?.(path), { 'aria-label': `Show ${path} in the diagram`, title: 'Show in the diagram' }));
      place.line.replaceChildren(said, ...(blamed.length ? [' ', ...blamed, ' '] : []), ...(name ? [R.make('a', { href: `#runs/${encodeURIComponent(name)}` }, 'Results')] : []));
      place.line.dataset.told = key;
      if (focus) /** @type {HTMLElement|null} */ (place.line.querySelector('a, button'))?.focus();
    }
    place.line.classList.toggle('bad', state?.state === 'failed');
    place.bar.value = until ? Math.min(1, t / until) : 0;
    place.bar.hidden = !running();
    place.pause.textContent = state?.state === 'paused' ? '▶ Go on' : '❚❚ Pause';
    for (const one of [place.pause, place.step]) one.disabled = !running();
    place.step.disabled = state?.state !== 'paused';
    /** @type {HTMLButtonElement} */ (document.getElementById('end')).hidden = !running() && state?.state !== 'starting';
    /** @type {HTMLButtonElement} */ (document.getElementById('start')).disabled = running() || state?.state === 'starting';
  };

  /** @param {any} now */
  const renew = (now) => {
    // What was asked for may come behind what has been told since.
    if (state && (now.count ?? 0) < (state.count ?? 0) && !fresh) return;
    fresh = false;
    const before = state?.state;
    state = now;
    if (now.state === 'starting' && before !== 'starting') { warn(unsaved); unsaved = []; }
    // What was drawn piece by piece is drawn as a whole in the end.
    if (!running() && before === 'running' && !dirty) { dirty = true; requestAnimationFrame(draw); }
    told();
    blame();
    stand();
    Futures.renew(now);
    if (before !== now.state && before !== undefined) Desk.say(now.state === 'running' ? `${now.model} runs` : said, now.state === 'failed');
  };

  /** What was set while the run goes on, as `--change` takes it. @returns {{t: number, set: string}[]} */
  const changes = () => (state?.changes ?? []).map((/** @type {string} */ change) => { const [, t, set] = /** @type {string[]} */ (/^after ([^:]*)s:(.*)$/s.exec(change)); return { t: Number(t), set }; });
  /** What the run has been set to last of each parameter, and when; from its start on without a time.
   * @returns {Map<string, {t: number|null, text: string}>} */
  const changed = () => {
    const all = [...(state?.set ?? []).map((/** @type {string} */ set) => ({ t: null, set })), ...changes()];
    return new Map(all.map(({ t, set }) => { const [name, ...rest] = set.split('='); return [name.trim(), { t, text: rest.join('=').trim() }]; }));
  };
  /** What can be turned stands where the run does, whoever has turned it. */
  const stand = () => {
    if (!turns()) { Panel.settle(); return; }
    const all = changed();
    Panel.stand(state.standing ?? [], all);
    for (const [name, one] of knobs) one.stand(all.get(name));
  };

  const control = (/** @type {any} */ body) => Desk.ask('control', body).catch(Desk.refuse);
  /** Runs the model with these values, and with what its panel shows of other parameters. @param {string[]} sets */
  const run = async (sets) => {
    if (running()) { Desk.say('a run goes on already; end it, or wait for it', true); return; }
    const named = new Set(sets.map((set) => set.split('=')[0]));
    const all = [...settings().filter((set) => !named.has(set.split('=')[0])), ...sets];
    location.hash = '#run';
    try {
      unsaved = await leftOut(all);
      await Desk.ask('run', { speed: Number(place.speed.value), set: all, record: [...extra] });
    } catch (error) { unsaved = []; Desk.refuse(error); }
  };
  /** What was typed here and is in no file, so that a run with these values has nothing of it. @param {string[]} sets */
  const leftOut = async (sets) => {
    const { Text, Values } = /** @type {any} */ (R), named = new Set(sets.map((set) => set.split('=')[0].trim()));
    const texts = Text.dirty(), files = texts.length ? (await Desk.ask('text', { file: '' })).files : [];
    return [
      ...texts.filter((/** @type {string} */ file) => files.includes(file)).map((/** @type {string} */ file) => `the text of ${file}, which is not saved (Ctrl S beside the diagram)`),
      ...Values.typed().filter((/** @type {[string, string]} */ [name]) => !named.has(name)).map((/** @type {[string, string]} */ [name, value]) => `${name} = ${value}, which is typed in Parameters and not written`),
    ];
  };
  /** Warns that a run has nothing of this. @param {string[]} all */
  const warn = (all) => {
    lacking = all;
    place.unsaved.hidden = !all.length;
    place.unsaved.replaceChildren('Typed, but not in this run:', R.make('ul', {}, ...all.map((one) => R.make('li', {}, one))));
  };
  /** Runs the model. */
  const start = async () => {
    // A key that is pressed twice starts one run.
    if (starts || running() || state?.state === 'starting') return;
    starts = true;
    await run([]);
    starts = false;
  };

  /** The run as it is, with other signals recorded: from its start, and soon where it was. */
  const again = () => {
    if (!own()) return;
    unsaved = lacking;
    Desk.ask('run', { again: true, record: [...extra], speed: Number(place.speed.value) }).catch(Desk.refuse);
  };
  /** Records a signal and shows it over time, in this run and in those to come. @param {string} name */
  const record = (name) => {
    extra.add(name);
    recorded();
    wanted = name;
    const runs = own();
    Desk.say(runs ? `${name} is recorded: the run is repeated to where it was` : `${name} is recorded by the next run`);
    if (runs) again();
  };
  const recorded = () => {
    const chip = (/** @type {string} */ name) => R.make('li', {}, R.make('bdi', {}, name), ' ', Desk.button('×', () => { extra.delete(name); recorded(); }, { 'aria-label': `Do not record ${name}`, title: 'Not in the runs to come' }));
    place.extra.replaceChildren(...(extra.size ? [R.make('b', {}, 'Recorded as well'), R.make('ul', {}, ...[...extra].map(chip))] : []));
  };
  /** What was asked for of another model has no meaning here. @param {string} name @param {string} at Its place, as runs name it. @param {boolean} has Whether it has a panel. */
  const of = (name, at, has) => {
    if (model && model !== name) {
      extra.clear();
      recorded();
      others.set(model, [...knobs]);
      knobs.clear();
      for (const [own, one] of others.get(name) ?? []) knobs.set(own, one);
      panel();
    }
    [model, path] = [name, at];
    gauges();
    // Who turns something is to see what comes of it.
    if (!place.paced) place.speed.value = has ? '1' : '0';
  };

  const build = () => {
    const view = document.getElementById('run-bar');
    if (!view) return;
    place.line = R.make('p', { class: 'run-line' });
    place.knobs = R.make('div', { class: 'knobs' });
    place.unsaved = R.make('div', { class: 'warning', role: 'status', hidden: '' });
    place.bar = R.make('progress', { max: '1', value: '0', 'aria-label': 'Simulated time' });
    place.pause = Desk.button('❚❚ Pause', () => control({ do: state?.state === 'paused' ? 'go' : 'pause' }), { title: 'Pause and go on (Space)' });
    place.step = Desk.button('Step', () => control({ do: 'step' }), { title: 'To the next row (S)' });
    place.speed = R.make('select', { 'aria-label': 'Speed', title: 'Speed' }, ...[['0', 'as fast as it can'], ['0.1', '0.1 × real time'], ['0.5', '0.5 × real time'], ['1', 'real time'], ['2', '2 × real time'], ['10', '10 × real time']].map(([value, text]) => R.make('option', { value }, text)));
    place.speed.addEventListener('change', () => { place.paced = true; if (running() || state?.state === 'starting') control({ do: 'speed', speed: Number(place.speed.value) }); });
    place.follow = R.make('select', { 'aria-label': 'Times shown', title: 'Times shown' }, ...[['0', 'all times'], ['0.1', 'the last 0.1 s'], ['1', 'the last 1 s'], ['2', 'the last 2 s'], ['10', 'the last 10 s']].map(([value, text]) => R.make('option', { value }, text)));
    place.follow.addEventListener('change', () => { follow = Number(place.follow.value); range(); });
    place.extra = R.make('div', { class: 'extra' });
    const past = R.make('div', { class: 'past' });
    const tools = R.make('div', { class: 'run-tools' }, place.pause, place.step, place.speed, place.follow);
    view.replaceChildren(place.line, place.unsaved, place.bar, tools, past, place.extra, place.knobs);
    Movement.build(tools, { resized: fit });
    R.onChosen.push(blame);
    Futures.build(past, { control, rows: () => rows, time: last, state: () => state, draws: () => draws, redraw: draw, goesBack: () => ['running', 'paused', 'done', 'failed'].includes(state?.state) });
    Panel.build(document.getElementById('panel'), { running: turns, set: (/** @type {string} */ set) => control({ do: 'set', set }) });
    told();
    Desk.on('scopes', (/** @type {any} */ data, /** @type {number} */ id) => ordered(id, () => { number = state?.number ?? 0; R.guarded('The scopes', () => scopes(data)); }));
    Desk.on('rows', (/** @type {any} */ data, /** @type {number} */ id) => ordered(id, () => add(data)));
    Desk.on('back', (/** @type {any} */ data, /** @type {number} */ id) => ordered(id, () => back(data)));
    Desk.on('tuned', (/** @type {any} */ told) => {
      const { t, set, refused, help, without_effect: lost } = told;
      if (!own()) return;
      Panel.tuned(told);
      const [name, ...rest] = set.split('='), one = knobs.get(name);
      if (one && !refused) one.has = key({ t, text: rest.join('=') });
      if (one) { one.told.textContent = refused ? [refused, help].filter(Boolean).join(' – ') : `since ${R.say(t)} s${lost?.length ? `; values at the start of ${lost.join(', ')} have no effect any more` : ''}`; one.told.classList.toggle('bad', Boolean(refused)); }
    });
    Desk.on('run', renew);
    // Another instant was chosen: scopes and their legends show it, also where nothing runs.
    R.onTime.push(() => {
      if (draws || view.closest('section')?.hidden) return;
      for (const panel of panels) if (panel.seen) R.Picture.mark(panel);
      tell();
    });
    R.onTheme.push(() => { for (const panel of panels) for (const u of [panel.main, panel.strip]) u?.redraw(false, true); });
    window.addEventListener('resize', fit);
  };
  /** The times of the page are those of the run again, with its last one. */
  const span = () => { if (rows) { R.span = [0, until]; R.setTime(columns[0][rows - 1]); } Movement.show(); };
  /** Parameters that one wants to turn while a run goes on, and what they were set to. @type {Map<string, any>} */ const knobs = new Map();
  /** Those of other models of the project. @type {Map<string, [string, any][]>} */ const others = new Map();
  /** Between which numbers a slider moves a value: from nothing to twice of it, as far as its kind allows; or over all that is allowed, where that
   * is not much wider. @param {number} start @param {[number, boolean]|null} low @param {[number, boolean]|null} high Each with whether it is allowed itself. */
  const reach = (start, low, high) => {
    const all = low && high && (start === 0 || high[0] - low[0] <= WIDE * Math.abs(start));
    let [from, to] = all ? [low[0], high[0]] : [Math.min(0, 2 * start), Math.max(0, 2 * start)];
    if (low) from = Math.max(from, low[0]);
    if (high) to = Math.min(to, high[0]);
    const step = (to - from) / STEPS;
    if (low && !low[1] && from === low[0]) from += step;
    if (high && !high[1] && to === high[0]) to -= step;
    return [from, to];
  };
  /** A parameter with a slider and a field; a panel of the model says how far the slider goes. @param {string} name @param {any} target @param {any} [own] Its element on the panel. */
  const knob = (name, target, own) => {
    const [, number, behind] = /^([+-]?[\d.]+(?:e[+-]?\d+)?)\s*(.*)$/i.exec(target.written) ?? [];
    const [start, unit] = own ? [own.value, own.unit] : [Number(number), behind];
    const told = R.make('span', { class: 'note', role: 'status' });
    const field = R.make('input', { type: 'text', value: target.written, 'aria-label': name, size: '12', spellcheck: 'false' });
    const set = (/** @type {string} */ value) => { told.textContent = ''; told.classList.remove('bad'); field.value = value; follow(); if (turns()) control({ do: 'set', set: `${name}=${value}` }); else told.textContent = 'for the next run'; };
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') set(field.value); });
    const parts = [R.make('bdi', {}, name), field];
    /** The slider goes where the value is, if it is a number of its unit. */ let follow = () => {};
    const [least, most] = target.ends ?? [null, null], [low, high] = own ? own.range : reach(start, least, most);
    if (low < high) {
      const slider = R.make('input', { type: 'range', min: String(low), max: String(high), step: String((high - low) / STEPS), value: String(start), 'aria-label': `${name}, slider` });
      let wait = 0;
      const chosen = () => Math.min(Math.max(Number(Number(slider.value).toPrecision(4)), low), high);
      slider.addEventListener('input', () => { field.value = `${chosen()} ${unit}`.trim(); clearTimeout(wait); wait = setTimeout(() => set(field.value), 60); });
      follow = () => { const [, value, of] = /^([+-]?[\d.]+(?:e[+-]?\d+)?)\s*(.*)$/i.exec(field.value) ?? []; if (value && of === unit) slider.value = value; };
      parts.push(slider);
    } else if (target.written === 'true' || target.written === 'false') parts.push(Desk.button('switch', () => set(field.value === 'true' ? 'false' : 'true')));
    const away = Desk.button('×', () => { knobs.delete(name); panel(); }, { 'aria-label': `Take ${name} away` });
    /** Stands where the run is, and sends nothing; what was typed since stays until the run has another value.
     * @param {{t: number|null, text: string}|undefined} now */
    const stand = (now) => {
      if (one.has === key(now)) return;
      one.has = key(now);
      field.value = now?.text ?? field.defaultValue;
      told.textContent = typeof now?.t === 'number' ? `since ${R.say(now.t)} s` : '';
      told.classList.remove('bad');
      follow();
    };
    const one = { told, field, has: '', stand, row: R.make('div', { class: 'knob' }, ...parts, away, told) };
    return one;
  };
  /** @param {{t: number|null, text: string}|undefined} now */
  const key = (now) => now ? `${now.t} ${now.text}` : '';
  const panel = () => place.knobs.replaceChildren(...[...knobs.values()].map((one) => one.row));
  /** Puts a parameter among those that one wants to turn. @param {string} name @param {any} target @param {any} [own] Its element on the panel of the model. */
  const turn = (name, target, own) => {
    if (!knobs.has(name)) knobs.set(name, knob(name, target, own));
    panel();
    stand();
    location.hash = '#run';
    Desk.say(`${name} can be turned while a run goes on`);
  };
  /** What has been set for runs, as `--set` takes it: what stands in the fields. */
  const settings = () => [...Panel.settings(), ...[...knobs].filter(([, one]) => one.field.value !== one.field.defaultValue).map(([name, one]) => `${name}=${one.field.value}`)];

  /** What a run that goes on, or the last one, has shown before this page was there, or while it was not. */
  const catchUp = async () => {
    if (!behind) return;
    const mine = missed, { at, number: run, scopes: told, rows: all } = await Desk.ask('live');
    if (!behind || mine !== missed) return;
    // Of a program that has just been started nothing is known; what is here stays.
    if (told) {
      const marks = run === number ? Futures.instants() : [];
      number = run;
      R.guarded('The scopes', () => scopes(told));
      for (const one of all) if (one.type === 'back') back(one); else add(one);
      Futures.adopt([...marks, ...changes().map(({ t, set }) => ({ t, text: set }))]);
    }
    // News may come later than the answer that contains them.
    [behind, known] = [false, at];
    for (const [id, does] of waiting) ordered(id, does);
    waiting = [];
  };
  const fit = () => {
    for (const panel of panels) for (const u of [panel.main, panel.strip]) {
      const width = u?.root.parentElement.clientWidth;
      if (width > 0) u.setSize({ width, height: u.heights.screen });
    }
  };
  return { build, renew, shows: (/** @type {string} */ at) => source === at, turn, record, of, run, again: () => { fresh = true; behind = true; waiting = []; missed++; }, start, fit, span, catchUp, end: () => control({ do: 'stop' }), pause: () => { if (running()) place.pause.click(); }, step: () => { if (!place.step.disabled) place.step.click(); }, rows: () => rows };
})();
