// @ts-check
'use strict';
// Moves of the robot: joint moves, lines and arcs, checked while one types, seen in 3D, kept as files.
/* global R, uPlot */

/** @type {any} */ (R).Motion = (() => {
  const { Desk, Live, Joints } = /** @type {any} */ (R);
  /** How long the keys may rest before a move is planned, ms. */
  const REST = 15;
  /** @type {any} */ let robot = null;
  /** @type {any} The fields as they were typed. */ let typed = null;
  /** @type {any} What the last plan came to. */ let found = null;
  /** @type {any} */ let plot = null;
  /** @type {any} */ const place = { form: null, rows: [], result: null, slider: null, clock: null, name: null, space: null };
  let asked = 0, waiting = 0, playing = 0, drawn3d = false;

  /** A number as typed, with a decimal comma or a point; what else stands there is NaN. @param {string} text */
  const number = (text) => /^[+-]?(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?$/i.test(text.trim()) ? Number(text.trim().replace(',', '.')) : NaN;
  const point = (/** @type {any} */ x, digits = 2) => Number(x).toFixed(digits).replace('-', '−');

  /** What a field has, and what is wrong with it at once, before anything is planned. @param {any} axis @param {string} text */
  const trouble = (axis, text) => {
    const value = number(text);
    if (!text.trim()) return 'missing';
    // With a unit of its own the planner reads it.
    if (Number.isNaN(value)) return /[a-z°]/i.test(text) && /\d|pi/i.test(text) ? '' : `${text.trim()} is not a number`;
    if (value < axis.lower - 1e-9) return `${point(value)} is below the limit ${point(axis.lower)}`;
    if (value > axis.upper + 1e-9) return `${point(value)} is above the limit ${point(axis.upper)}`;
    return '';
  };

  /** @param {string} label @param {any} owner @param {string|number} key @param {string} unit @param {string} [hint] */
  const field = (label, owner, key, unit, hint) => {
    const input = R.make('input', { type: 'text', value: owner[key] ?? '', 'aria-label': label, size: '9', spellcheck: 'false', inputmode: 'decimal' });
    input.addEventListener('input', () => { owner[key] = input.value; release(); look(); });
    return R.make('label', { class: 'field' }, R.make('span', {}, label), input, R.make('span', { class: 'note' }, [unit, hint].filter(Boolean).join('  ')));
  };
  /** @param {string} label @param {any} owner @param {string} key @param {string[]} words */
  const choice = (label, owner, key, words) => {
    const select = R.make('select', { 'aria-label': label }, ...words.map((word) => R.make('option', { value: word }, word)));
    select.value = owner[key];
    select.addEventListener('change', () => { owner[key] = select.value; look(); });
    return R.make('label', { class: 'field' }, R.make('span', {}, label), select);
  };

  /** Fields of the axes. @type {Record<string, any[]>} */ let inputs = { from: [], to: [] };
  /** What a field of an axis is worth, ° or mm; of what is no number the last one that was. @param {string} which @param {number} n */
  const worth = (which, n) => {
    const text = (typed[which][n] ?? '').trim(), [, front, unit] = /^([^a-z°]*(?:\de[+-]?\d+)?)\s*([a-z°]*)$/i.exec(text) ?? [];
    const own = robot.axes[n].unit === 'mm' ? { '': 1, mm: 1, cm: 10, m: 1000 } : { '': 1, '°': 1, deg: 1, rad: 180 / Math.PI };
    const x = number(front ?? '') * (/** @type {any} */ (own)[unit ?? ''] ?? NaN);
    if (!Number.isNaN(x)) good[which][n] = x;
    return good[which][n] ?? robot.axes[n].start;
  };
  /** @type {Record<string, number[]>} */ const good = { from: [], to: [] };
  /** The pose that was held is let go: what was typed counts, or the present time. */
  const release = () => {
    if (!place.seen) return;
    place.seen.classList.remove('held');
    if (drawn3d) R.Space.hold(null);
    Joints.show();
  };

  /** The form for the kind of move at hand. */
  const form = () => {
    inputs = { from: [], to: [] };
    const isJoint = typed.kind === 'joint', axes = robot.axes;
    const kinds = R.make('fieldset', { class: 'kinds' }, R.make('legend', {}, 'Kind of move'), ...[['joint', 'joint'], ['linear', 'line of the tool'], ['circular', 'arc of the tool']].map(([kind, text]) => {
      const input = R.make('input', { type: 'radio', name: 'kind', value: kind });
      input.checked = typed.kind === kind;
      input.addEventListener('change', () => { typed.kind = kind; form(); look(); place.form.querySelector(`input[value="${kind}"]`).focus(); });
      return R.make('label', {}, input, ' ', text);
    }));
    place.rows = axes.map((/** @type {any} */ axis, /** @type {number} */ n) => {
      const told = R.make('td', { class: 'told', role: 'alert' });
      const cell = (/** @type {string} */ which) => {
        const input = R.make('input', { type: 'text', value: typed[which][n] ?? '', 'aria-label': `${axis.name} ${which === 'from' ? 'start' : 'target'}`, size: '8', spellcheck: 'false', inputmode: 'decimal' });
        input.addEventListener('input', () => { typed[which][n] = input.value; release(); look(); });
        inputs[which][n] = input;
        return R.make('td', {}, input);
      };
      return { told, row: R.make('tr', {}, R.make('th', { scope: 'row' }, axis.name), cell('from'), ...(isJoint ? [cell('to')] : []), R.make('td', { class: 'note' }, `${point(axis.lower, 0)} … ${point(axis.upper, 0)} ${axis.unit}`), told) };
    });
    const head = ['', 'start', ...(isJoint ? ['target'] : []), 'range', ''].map((name) => R.make('th', { scope: 'col' }, name));
    const table = R.make('table', { class: 'axes', 'aria-label': 'Start and target' }, R.make('thead', {}, R.make('tr', {}, ...head)), R.make('tbody', {}, ...place.rows.map((/** @type {any} */ one) => one.row)));
    const three = (/** @type {string} */ key, /** @type {string} */ what) => ['x', 'y', 'z'].map((name, n) => field(`${what} ${name}`, typed[key], n, 'mm'));
    const copy = (/** @type {string} */ text, /** @type {() => void} */ does) => Desk.button(text, () => { does(); form(); look(); });
    const home = axes.map((/** @type {any} */ axis) => String(Number(axis.start.toFixed(4))));
    const copies = R.make('p', { class: 'copies' }, copy('start: as the model', () => { typed.from = [...home]; }), ...(isJoint ? [copy('target: all 0', () => { typed.to = axes.map(() => '0'); }), copy('swap', () => { [typed.from, typed.to] = [typed.to, typed.from]; })] : []));
    const rest = isJoint
      ? [field('velocity', typed, 'velocity', '% of the maximum of each axis'), field('acceleration', typed, 'acceleration', '% of the move time')]
      : [...three('point', 'target'), ...(typed.kind === 'circular' ? three('via', 'through') : []), choice('orientation', typed, 'orientation', ['free', 'fixed', 'tool-axis']), choice('profile', typed, 'profile', ['sin2', 'trapezoid', 's-curve', 'time-optimal']),
        field('speed', typed, 'speed', 'mm/s', `at most ${point(robot.speed, 0)}`), field('acceleration', typed, 'share', `% of ${point(robot.acceleration, 1)} m/s²`), field('resolution', typed, 'resolution', 'mm')];
    place.form.replaceChildren(kinds, table, copies, ...rest);
    release();
  };

  /** Looks at what was typed: at once what a field lacks, then the whole move. */
  const look = () => {
    for (const [n, axis] of robot.axes.entries()) {
      const own = [['start', typed.from[n]], ...(typed.kind === 'joint' ? [['target', typed.to[n]]] : [])];
      place.rows[n].told.textContent = own.map(([what, text]) => { const bad = trouble(axis, text ?? ''); return bad && `${what} ${bad}`; }).filter(Boolean).join('; ');
    }
    clearTimeout(waiting);
    waiting = setTimeout(plan, REST);
  };
  /** What is typed, as it is planned: a bare number of an axis that slides is in the mm that stand beside it. */
  const request = () => {
    const own = (/** @type {string[]} */ all) => all.map((text, n) => robot.axes[n]?.unit === 'mm' && !Number.isNaN(number(text ?? '')) ? `${text.trim()} mm` : text);
    return { ...typed, from: own(typed.from), to: own(typed.to) };
  };

  const plan = async () => {
    const own = ++asked, begin = performance.now();
    try {
      const told = await Desk.ask('plan', request());
      // Somebody has typed on.
      if (own !== asked) return;
      if (told.refused) throw Object.assign(new Error(told.refused.message), { why: told.refused });
      found = told;
      place.old.hidden = true;
      place.seen.classList.toggle('old', false);
      result();
      preview();
    } catch (error) {
      if (own !== asked) return;
      const { message, why } = /** @type {any} */ (error);
      found = null;
      place.result.replaceChildren(R.make('p', { class: 'bad' }, message), why?.help ? R.make('p', { class: 'note' }, why.help) : '');
      // What is seen is not what stands in the fields.
      place.old.hidden = !plot;
      place.seen.classList.toggle('old', plot !== null);
      buttons();
    }
    /** @type {any} */ (window).__m.planned = performance.now() - begin;
  };

  /** What the move is like, and what stands against it. */
  const result = () => {
    const rows = found.axes.map((/** @type {any} */ axis, /** @type {number} */ n) => {
      const { margins } = axis, turns = robot.axes[n].unit === '°', shown = (/** @type {number} */ x) => point(turns ? x * 180 / Math.PI : 1000 * x);
      const share = (/** @type {number} */ value, /** @type {number} */ left) => { const all = value + left; return `${(100 * value / all).toFixed(0)} %`; };
      const line = [robot.axes[n].name, `${shown(axis.lowest)} … ${shown(axis.highest)}`, shown(Math.min(margins.lower, margins.upper)), share(axis.speed, margins.speed), share(axis.acceleration, margins.acceleration)];
      return { line, bad: Math.min(margins.lower, margins.upper, margins.speed, margins.acceleration) < -1e-9 };
    });
    const table = Desk.table('Axes of the move', ['axis', 'from … to', 'left to the limits', 'speed', 'acceleration'], rows.map((/** @type {any} */ row) => row.line));
    rows.forEach((/** @type {any} */ row, /** @type {number} */ n) => table.querySelectorAll('tbody tr')[n].classList.toggle('bad', row.bad));
    const wrong = [...found.violations.map((/** @type {any} */ one) => [one.what, one.help]), ...(found.collision ? [[found.collision.what, found.collision.help]] : [])];
    place.result.replaceChildren(
      R.make('p', { class: found.passes ? 'passes' : 'bad' }, found.passes ? `✔ ${point(found.duration, 3)} s, tool at most ${point(1000 * found.tool_speed, 0)} mm/s${found.collisions ? ', nothing touched' : ''}` : `✕ ${point(found.duration, 3)} s, and something stands against it`),
      ...wrong.map(([what, help]) => R.make('p', {}, R.make('span', { class: 'bad' }, what), R.make('span', { class: 'note' }, ` ${help}`))), table);
    if (found.collisions === null) place.result.append(R.make('p', { class: 'note' }, 'Collisions are not looked for: the robot has no shapes.'));
    buttons();
  };

  /** The course of the axes, and the mechanism in 3D. */
  const preview = () => {
    const time = Float64Array.from(found.times);
    const columns = [time, ...found.course.map((/** @type {any} */ axis) => Float64Array.from(axis.shown))];
    if (!plot) {
      plot = new uPlot({
        width: Math.max(place.plot.clientWidth, 280), height: 210, padding: [8, 12, 0, 0], scales: { x: { time: false } }, cursor: { drag: { x: false, y: false } },
        series: [{ label: 's' }, ...robot.axes.map((/** @type {any} */ axis, /** @type {number} */ n) => ({ label: axis.name, stroke: () => R.colour(`s${n % 6 + 1}`), width: 2 }))],
        axes: [{ stroke: () => R.colour('quiet'), grid: { stroke: () => R.colour('grid'), width: 1 } }, { stroke: () => R.colour('quiet'), grid: { stroke: () => R.colour('grid'), width: 1 }, size: 60 }],
      }, columns, place.plot);
      R.named(plot, 'Axes over time');
      R.onTheme.push(() => plot.redraw(false, true));
    } else plot.setData(columns);
    const positions = found.course.map((/** @type {any} */ axis) => Float64Array.from(axis.q));
    const set = positions.map((/** @type {Float64Array} */ q) => new Float64Array(q.length).fill(q[q.length - 1]));
    shown();
    if (drawn3d) R.Space.renew(time, positions, set);
    R.setTime(Math.min(R.now, found.duration));
    tell();
  };
  /** The mechanism as it stands at the start, before anything is planned. */
  const mechanism = () => {
    const joints = robot.scene?.bodies.flatMap((/** @type {any} */ body, /** @type {number} */ n) => body.motion.kind === 'fixed' ? [] : [n]) ?? [];
    // Where each joint is an axis, and none is another thing, the mechanism is that of the model.
    if (joints.length !== robot.axes.length || joints.some((/** @type {number} */ n) => robot.scene.bodies[n].motion.kind === 'ball')) {
      const why = robot.scene ? 'The mechanism is not shown: the model has other joints than the axes of the robot.' : 'The mechanism is shown when the model has been run once, since its plug-ins are not known before.';
      document.getElementById('space-view')?.replaceChildren(R.make('p', { class: 'note' }, why));
      return;
    }
    const positions = robot.axes.map((/** @type {any} */ axis, /** @type {number} */ n) => new Float64Array(2).fill(worth('from', n) * (axis.unit === 'mm' ? 1e-3 : Math.PI / 180)));
    R.data.space = { scene: robot.scene, time: Float64Array.of(0, 1), positions, set: positions, contacts: [], surfaces: [] };
    R.guarded('The 3D view', () => { R.Space.build(); drawn3d = true; Joints.mechanism(joints); });
  };
  /** The times of the page are those of the move while it is looked at. */
  const shown = () => { if (found && !place.form.closest('section').hidden) { R.span = [0, found.duration]; place.slider.max = String(found.duration); } };
  const tell = () => { if (found) { place.slider.value = String(R.now); place.clock.textContent = `${point(R.now, 2)} of ${point(found.duration, 2)} s`; } };

  R.onTime.push(() => { if (found && drawn3d && !place.form.closest('section')?.hidden) tell(); });
  window.addEventListener('resize', () => { const width = place.plot?.clientWidth; if (plot && width > 0) plot.setSize({ width, height: 210 }); });

  const play = () => {
    if (playing) { cancelAnimationFrame(playing); playing = 0; place.play.textContent = '▶'; return; }
    if (!found) return;
    release();
    if (R.now >= found.duration - 1e-6) R.setTime(0);
    let before = performance.now();
    place.play.textContent = '❚❚';
    const step = (/** @type {number} */ stamp) => {
      R.setTime(R.now + Math.max(0, stamp - before) / 1000);
      before = stamp;
      tell();
      if (R.now >= found.duration) { playing = 0; place.play.textContent = '▶'; return; }
      playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  };

  const buttons = () => { for (const one of place.keep) one.disabled = !found?.passes; };
  /** @param {boolean} used @param {boolean} run */
  const keep = async (used, run) => {
    const name = place.name.value.trim();
    try {
      const done = await Desk.ask('keep', { ...request(), name, use: used, replace: place.replace.checked });
      Desk.say(done.message);
      if (run) Live.start();
    } catch (error) { Desk.refuse(error); }
  };
  /** Brings a move that was kept into the form. @param {string} name */
  const load = async (name) => {
    if (!name) return;
    try {
      Object.assign(typed, await Desk.ask('kept', { name }));
      place.name.value = name.replace(/^moves\//, '').replace(/\.ron$/, '');
      form();
      look();
    } catch (error) { Desk.refuse(error); }
  };

  /** Moves that were kept, and what keeps another. */
  const bar = () => {
    const moves = R.make('select', { 'aria-label': 'Move that was kept' }, R.make('option', { value: '' }, 'a move that was kept …'), ...robot.moves.map((/** @type {string} */ name) => R.make('option', { value: name }, name)));
    moves.addEventListener('change', () => load(moves.value));
    place.name ??= R.make('input', { type: 'text', 'aria-label': 'Name of the move', placeholder: 'name', size: '12' });
    place.replace ??= R.make('input', { type: 'checkbox' });
    place.keep = [Desk.button('Keep', () => keep(false, false), { title: 'Keep it as a file beside the model' })];
    if (robot.move) place.keep.push(Desk.button('Use in the model', () => keep(true, false), { title: 'Keep it, and have the model use it' }), Desk.button('Use and run', () => keep(true, true)));
    const typing = document.activeElement === place.name;
    place.bar.replaceChildren(moves, ' ', place.name, R.make('label', {}, place.replace, ' replace'), ' ', ...place.keep, R.make('span', { class: 'note' }, robot.move ? `the model uses ${robot.move}` : ''));
    if (typing) place.name.focus();
    buttons();
  };

  const build = () => {
    const view = document.getElementById('motion-view');
    if (!view) return;
    const home = robot.axes.map((/** @type {any} */ axis) => String(Number(axis.start.toFixed(4))));
    const tool = robot.tool.map((/** @type {number} */ x) => String(Number(x.toFixed(3))));
    typed ??= { kind: 'joint', from: [...home], to: [...home], velocity: '40 %', acceleration: '30 %', point: [...tool], via: [...tool], orientation: 'free', profile: 'sin2', speed: '250 mm/s', share: '20 %', resolution: '1 mm' };
    place.form = R.make('div', { class: 'move-form' });
    place.result = R.make('div', { class: 'move-result', 'aria-live': 'polite' });
    place.plot = R.make('div', { class: 'card' });
    place.joints = R.make('div', { class: 'joints' });
    place.play = Desk.button('▶', play, { 'aria-label': 'Play or stop', title: 'Play or stop' });
    place.slider = R.make('input', { type: 'range', min: '0', max: '1', step: 'any', value: '0', 'aria-label': 'Time of the move' });
    place.slider.addEventListener('input', () => { release(); R.setTime(Number(place.slider.value)); tell(); });
    place.clock = R.make('output', { class: 'note' });
    place.bar = R.make('p', { class: 'keep' });
    place.old = R.make('p', { class: 'note', hidden: '' }, 'Path and curves are those of the last move that could be planned.');
    place.seen = R.make('div', { class: 'move-seen' }, place.old, R.make('div', { id: 'space-view' }), R.make('p', { class: 'move-time' }, place.play, place.slider, place.clock), place.joints, place.plot);
    Joints.build(place.joints, {
      axes: robot.axes, isJoint: () => typed.kind === 'joint', value: worth, text: (/** @type {string} */ which, /** @type {number} */ n) => typed[which][n] ?? '',
      set: (/** @type {string} */ which, /** @type {number} */ n, /** @type {string} */ text) => { typed[which][n] = text; if (inputs[which][n]) inputs[which][n].value = text; look(); },
      held: (/** @type {boolean} */ is) => place.seen.classList.toggle('held', is),
    });
    bar();
    view.replaceChildren(place.bar, R.make('div', { class: 'move-parts' }, R.make('div', {}, place.form, place.result), place.seen));
    plot = null;
    drawn3d = false;
    form();
    mechanism();
    look();
  };

  /** Brings the screen up to date, if somebody looks at it. @param {number} version Of the model. */
  const renew = async (version) => {
    const view = document.getElementById('motion-view');
    if (!view || view.closest('section')?.hidden) return;
    if (known === version) { shown(); tell(); return; }
    known = version;
    try {
      const now = await Desk.ask('robot');
      if (!now || now.trouble) {
        view.replaceChildren(R.make('p', { class: 'note' }, now?.trouble ?? 'This model has no robot: moves are for diagrams with the parameter `manipulator`.'));
        robot = null;
        return;
      }
      const same = robot && JSON.stringify([robot.axes, robot.scene]) === JSON.stringify([now.axes, now.scene]);
      robot = now;
      // Who types goes on typing.
      if (!same) build(); else { bar(); look(); }
    } catch (error) { Desk.refuse(error); }
  };
  let known = 0;
  return { renew, load, typed: () => typed, found: () => found };
})();
