// @ts-check
'use strict';
// Moves of the robot: joint moves, lines, arcs and sequences of them, checked while one types, seen in 3D, kept as files.
/* global R, uPlot */

/** @type {any} */ (R).Motion = (() => {
  const { Desk, Live, Joints, Sequence, Sketch } = /** @type {any} */ (R);
  /** How long a joint that is dragged may rest before its move is planned, ms. */
  const REST = 15;
  /** @type {any} */ let robot = null;
  /** @type {any} The fields as they were typed. */ let typed = null;
  /** @type {any} What the last plan came to. */ let found = null;
  /** @type {any} */ let plot = null;
  /** @type {any} */ const place = { form: null, rows: [], result: null, slider: null, clock: null, name: null, space: null };
  let asked = 0, waiting = 0, pause = 0, playing = 0, drawn3d = false, busy = false;

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

  /** Fields by their names: what a refusal is about is found there. @type {Map<string, {input: any, told: any}>} */ const spots = new Map();
  /** @param {string} label @param {any} owner @param {string|number} key @param {string} unit @param {string} [hint] @param {string} [name] What the planner calls it. */
  const field = (label, owner, key, unit, hint, name = String(key)) => {
    const input = R.make('input', { type: 'text', value: owner[key] ?? '', 'aria-label': label, size: '9', spellcheck: 'false', inputmode: 'decimal' }), told = R.make('span', { class: 'told', role: 'alert' });
    input.addEventListener('input', () => { owner[key] = input.value; release(); look(); });
    spots.set(name, { input, told });
    return R.make('label', { class: 'field' }, R.make('span', {}, label), input, R.make('span', { class: 'note' }, [unit, hint].filter(Boolean).join('  ')), told);
  };
  /** @param {string} label @param {any} owner @param {string} key @param {string[]} words @param {boolean} [renews] Whether other fields depend on it. */
  const choice = (label, owner, key, words, renews) => {
    // A word of a file that is none of them stays until another one is chosen.
    const all = words.includes(owner[key]) || !owner[key] ? words : [...words, owner[key]];
    const select = R.make('select', { 'aria-label': label }, ...all.map((word) => R.make('option', { value: word }, word))), told = R.make('span', { class: 'told', role: 'alert' });
    select.value = owner[key] || words[0];
    select.addEventListener('change', () => {
      owner[key] = select.value;
      if (renews) { form(); spots.get(key)?.input.focus(); }
      look();
    });
    spots.set(key, { input: select, told });
    return R.make('label', { class: 'field' }, R.make('span', {}, label), select, R.make('span', {}), told);
  };
  /** Lines that are written above a move. @param {string} label @param {any} owner @param {string} key */
  const lines = (label, owner, key) => {
    const input = R.make('textarea', { 'aria-label': label, rows: '1', spellcheck: 'false' });
    input.value = owner[key] ?? '';
    input.addEventListener('input', () => { owner[key] = input.value; });
    return R.make('label', { class: 'field wide-field' }, R.make('span', {}, label), input);
  };

  /** The move in the fields: of a sequence the selected one. */
  const move = () => typed.kind === 'sequence' ? Sequence.move() : typed;
  /** Which of a sequence it is, counted from 0. */
  const index = () => typed.kind === 'sequence' ? Sequence.index() : 0;
  /** What holds a list of fields: only the start belongs to all moves. @param {string} which @returns {string[]} */
  const list = (which) => which === 'from' ? typed.from : move()[which];
  /** A move with all its fields. */
  const blank = () => {
    const home = robot.axes.map((/** @type {any} */ axis) => String(Number(axis.start.toFixed(4)))), tool = robot.tool.map((/** @type {number} */ x) => String(Number(x.toFixed(3))));
    const none = () => ['', '', ''];
    return { kind: 'joint', to: home, velocity: '40 %', acceleration: '30 %', point: tool, via: [...tool], orientation: 'free', rotation: none(), profile: 'sin2', speed: '250 mm/s', share: '20 %', turning: '', turning_acceleration: '', jerk: '', resolution: '1 mm', zone: '', wait: '', comment: '', object_point: none(), object_turn: none() };
  };
  const MOVE = ['to', 'velocity', 'acceleration', 'point', 'via', 'orientation', 'rotation', 'profile', 'speed', 'share', 'turning', 'turning_acceleration', 'jerk', 'resolution', 'zone', 'wait', 'comment', 'object_point', 'object_turn'];
  const shortly = (/** @type {number} */ x) => String(Number(x.toFixed(3)));
  /** One more move of a sequence, like another one: it ends where that one does. @param {any} like @param {any} pose */
  const next = (like, pose) => {
    const made = { ...structuredClone(like), zone: '', wait: '', comment: '' };
    // What is known of the pose is in the reference frame.
    if (pose) Object.assign(made, { to: pose.axes.map(shortly), point: pose.tool.map(shortly), object_point: ['', '', ''], object_turn: ['', '', ''] }, like.orientation === 'interpolated' ? { rotation: pose.rotation.map(shortly) } : {});
    return made;
  };

  /** Fields of the axes. @type {Record<string, any[]>} */ let inputs = { from: [], to: [] };
  /** What a field of an axis is worth, ° or mm; of what is no number the last one that was. @param {string} which @param {number} n */
  const worth = (which, n) => {
    const text = (list(which)[n] ?? '').trim(), [, front, unit] = /^([^a-z°]*(?:\de[+-]?\d+)?)\s*([a-z°]*)$/i.exec(text) ?? [];
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

  const KINDS = [['joint', 'joint'], ['linear', 'line of the tool'], ['circular', 'arc of the tool']];
  /** @param {string} name @param {string} legend @param {string[][]} all @param {string} present @param {(kind: string) => void} choose */
  const radios = (name, legend, all, present, choose) => R.make('fieldset', { class: 'kinds' }, R.make('legend', {}, legend), ...all.map(([kind, text]) => {
    const input = R.make('input', { type: 'radio', name, value: kind });
    input.checked = present === kind;
    input.addEventListener('change', () => { choose(kind); form(); look(); place.form.querySelector(`input[name="${name}"][value="${kind}"]`).focus(); });
    return R.make('label', {}, input, ' ', text);
  }));

  /** The form for the kind of move at hand. */
  const form = () => {
    const isSequence = typed.kind === 'sequence';
    place.kinds.replaceChildren(radios('kind', 'Kind of move', [...KINDS, ['sequence', 'sequence']], typed.kind, (kind) => {
      // A sequence begins with the move that was there.
      if (kind === 'sequence') typed.moves ??= [structuredClone({ kind: typed.kind, ...Object.fromEntries(MOVE.map((key) => [key, typed[key]])) })];
      typed.kind = kind;
      found = null;
    }));
    place.list.hidden = !isSequence;
    place.fields.classList.toggle('one-of', isSequence);
    if (isSequence) Sequence.show(); else place.strip.hidden = true;
    fields();
    release();
  };
  /** The fields of the move at hand. */
  const fields = () => {
    inputs = { from: [], to: [] };
    good.to = [];
    spots.clear();
    const own = move(), n = index(), isSequence = typed.kind === 'sequence', isJoint = own.kind === 'joint', isFirst = n === 0, axes = robot.axes;
    const kind = isSequence ? [R.make('h2', { class: 'of-move' }, `Move ${n + 1} of ${typed.moves.length}`), radios('move-kind', 'Kind', KINDS, own.kind, (kind) => { own.kind = kind; Sequence.show(); })] : [];
    place.rows = axes.map((/** @type {any} */ axis, /** @type {number} */ n) => {
      const told = R.make('td', { class: 'told', role: 'alert' });
      const cell = (/** @type {string} */ which) => {
        const input = R.make('input', { type: 'text', value: list(which)[n] ?? '', 'aria-label': `${axis.name} ${which === 'from' ? 'start' : 'target'}`, size: '8', spellcheck: 'false', inputmode: 'decimal' });
        input.addEventListener('input', () => { list(which)[n] = input.value; release(); look(); });
        inputs[which][n] = input;
        spots.set(`${which}.${n}`, { input, told });
        return R.make('td', {}, input);
      };
      // Where a later move begins is where the one before ends.
      const begins = isFirst ? [cell('from')] : isJoint ? [R.make('td', { class: 'begins' })] : [];
      const ends = R.make('span', { class: 'ends' });
      return { told, begins, ends, row: R.make('tr', {}, R.make('th', { scope: 'row' }, axis.name), ...begins, ...(isJoint ? [cell('to')] : []), R.make('td', { class: 'note' }, `${point(axis.lower, 0)} … ${point(axis.upper, 0)} ${axis.unit} `, ends), told) };
    });
    const head = ['', ...(isFirst || isJoint ? ['start'] : []), ...(isJoint ? ['target'] : []), 'range', ''].map((name) => R.make('th', { scope: 'col' }, name));
    const table = isFirst || isJoint ? [R.make('table', { class: 'axes', 'aria-label': 'Start and target' }, R.make('thead', {}, R.make('tr', {}, ...head)), R.make('tbody', {}, ...place.rows.map((/** @type {any} */ one) => one.row)))] : [];
    place.begins = R.make('p', { class: 'note begins-at' });
    const three = (/** @type {string} */ key, /** @type {string} */ what, /** @type {string} */ unit = 'mm', names = ['x', 'y', 'z'], hint = '') => names.map((name, n) => field(`${what} ${name}`, own[key], n, unit, hint, `${key}.${n}`));
    const copy = (/** @type {string} */ text, /** @type {() => void} */ does) => Desk.button(text, () => { does(); form(); look(); });
    const home = axes.map((/** @type {any} */ axis) => String(Number(axis.start.toFixed(4))));
    const here = (/** @type {(at: any) => void} */ does) => {
      const at = Sequence.step(n)?.from ?? Sequence.step(n - 1)?.to;
      if (!at) Desk.say('it is not known yet where this move starts', true);
      else if (!isJoint && [...own.object_point, ...own.object_turn].some((text) => text.trim())) Desk.say('the fields are in the work object, and the start is known in the reference frame alone', true);
      else does(at);
    };
    const copies = R.make('p', { class: 'copies' }, ...(isFirst ? [copy('start: as the model', () => { typed.from = [...home]; })] : []), ...(isJoint ? [copy('target: all 0', () => { own.to = axes.map(() => '0'); }), ...(isSequence ? [] : [copy('swap', () => { [typed.from, typed.to] = [typed.to, typed.from]; })])] : []),
      ...(isSequence && !isFirst ? [copy('target: where it starts', () => here((at) => { own.to = at.axes.map(shortly); own.point = at.tool.map(shortly); }))] : []),
      ...(isSequence && !isJoint && own.orientation === 'interpolated' ? [copy('rotation: as at the start', () => here((at) => { own.rotation = at.rotation.map(shortly); }))] : []));
    const turned = (own.rotation ?? []).some(Boolean) || own.orientation === 'interpolated';
    const more = () => {
      const filled = [own.jerk, own.turning, own.turning_acceleration, ...(own.object_point ?? []), ...(own.object_turn ?? [])].some(Boolean);
      const box = R.make('details', { class: 'more' }, R.make('summary', {}, 'Work object, turning, jerk'),
        R.make('p', { class: 'note' }, 'Target, point in between and rotation are in the work object; without one they are in the reference frame of the robot.'), ...three('object_point', 'work object', 'mm', ['x', 'y', 'z'], '0 if empty'), ...three('object_turn', 'work object', '°', ['roll', 'pitch', 'yaw'], '0 if empty'),
        field('turning speed', own, 'turning', '°/s', '90 if empty'), field('turning acceleration', own, 'turning_acceleration', '°/s²', '180 if empty'), field('jerk', own, 'jerk', 'm/s³', 'of an s-curve'));
      box.open = filled || opened;
      box.addEventListener('toggle', () => { opened = box.open; });
      return box;
    };
    const rest = isJoint
      ? [field('velocity', own, 'velocity', '% of the maximum of each axis'), field('acceleration', own, 'acceleration', '% of the move time')]
      : [...three('point', 'target'), ...(own.kind === 'circular' ? three('via', 'through') : []), choice('orientation', own, 'orientation', ['free', 'fixed', 'interpolated', 'tool-axis'], true),
        ...(turned && own.orientation === 'interpolated' ? [R.make('p', { class: 'note' }, 'The tool turns evenly to the ZYX Euler angles at the target, along a line and along an arc.'), ...three('rotation', 'rotation', '°', ['α (about z)', 'β (about y)', 'γ (about x)'])] : []),
        choice('profile', own, 'profile', ['sin2', 'trapezoid', 's-curve', 'time-optimal']),
        field('speed', own, 'speed', 'mm/s', `at most ${point(robot.speed, 0)}`), field('acceleration', own, 'share', `% of ${point(robot.acceleration, 1)} m/s²`), field('resolution', own, 'resolution', 'mm', 'of waypoints; 1 if empty'), more()];
    const isLast = n === (typed.moves?.length ?? 1) - 1;
    const between = isSequence ? [field('rounding', own, 'zone', 'mm', isLast ? 'not used: no move follows' : 'radius at its end; empty: it stops'), field('wait', own, 'wait', 's', 'at its end'), lines('comment', own, 'comment')] : [];
    const whole = isSequence || typed.singular || typed.head || typed.comment ? [R.make('details', { class: 'more' }, R.make('summary', {}, isSequence ? 'The whole sequence' : 'Comments, nearness to singular poses'),
      field('singular limit', typed, 'singular', 'm and rad', '0.01 if empty'), lines('comment of the file', typed, 'head'), ...(isSequence ? [] : [lines('comment', typed, 'comment')]))] : [];
    place.fields.replaceChildren(...kind, Sketch.of(own.kind), ...table, place.begins, copies, ...rest, ...between, ...whole);
    begins();
  };
  /** Where the move at hand begins, as far as that is known. */
  const begins = () => {
    if (typed.kind !== 'sequence' || index() === 0) { place.begins.textContent = ''; return; }
    const at = Sequence.step(index())?.from ?? Sequence.step(index() - 1)?.to;
    place.begins.textContent = at ? `It starts where move ${index()} ends: x ${point(at.tool[0], 1)} mm, y ${point(at.tool[1], 1)} mm, z ${point(at.tool[2], 1)} mm, turned ${at.rotation.map((/** @type {number} */ x) => `${point(x, 1)}°`).join(', ')}.` : `It starts where move ${index()} ends, which is not known yet.`;
    if (move().kind === 'joint') place.rows.forEach((/** @type {any} */ row, /** @type {number} */ n) => { row.begins[0].textContent = at ? point(at.axes[n]) : '–'; });
  };

  /** Looks at what was typed: at once what a field lacks, then the whole move. */
  const look = (rest = 0) => {
    asked++;
    pause = rest;
    locally();
    if (typed.kind === 'sequence') Sequence.show();
    soon();
  };
  /** Plans what is typed: now, or when the plan that is under way is there. */
  const soon = () => {
    clearTimeout(waiting);
    if (busy) return;
    if (pause > 0) waiting = setTimeout(plan, pause); else plan();
  };
  /** What the fields of the axes lack. */
  const locally = () => {
    const own = move();
    for (const [n, axis] of robot.axes.entries()) {
      const all = [...(index() === 0 ? [['start', typed.from[n]]] : []), ...(own.kind === 'joint' ? [['target', own.to[n]]] : [])];
      place.rows[n].told.textContent = all.map(([what, text]) => { const bad = trouble(axis, text ?? ''); return bad && `${what} ${bad}`; }).filter(Boolean).join('; ');
      const beyond = all.filter(([, text]) => { const x = number(text ?? ''); return x < axis.lower - 1e-9 || x > axis.upper + 1e-9; });
      // Who is at a button stays there as long as it is of use.
      const key = beyond.map(([what, text]) => `${what} ${number(text) > axis.upper}`).join();
      if (place.rows[n].ends.dataset.for === key) continue;
      place.rows[n].ends.dataset.for = key;
      place.rows[n].ends.replaceChildren(...beyond.map(([what, text]) => use(n, what === 'start' ? 'from' : 'to', number(text) > axis.upper)));
    }
  };
  /** A button that takes the end of the range in the place of what is beyond it. @param {number} n @param {string} which @param {boolean} upper */
  const use = (n, which, upper) => {
    const axis = robot.axes[n], end = upper ? axis.upper : axis.lower;
    // Rounded inwards, so that it is within the range.
    const digits = 1e4, text = String(Math.abs(end * digits - Math.round(end * digits)) < 1e-6 ? Math.round(end * digits) / digits : (upper ? Math.floor(end * digits) : Math.ceil(end * digits)) / digits);
    return Desk.button(`Use ${text.replace('-', '−')}`, () => { list(which)[n] = text; const input = inputs[which][n]; input.value = text; release(); look(); input.focus(); }, { title: `The ${upper ? 'upper' : 'lower'} limit of ${axis.name} as ${which === 'from' ? 'start' : 'target'}`, 'aria-label': `Use ${text} as the ${which === 'from' ? 'start' : 'target'} of ${axis.name}` });
  };
  /** What is typed, as it is planned. */
  const request = () => {
    const { moves, ...rest } = typed;
    return typed.kind === 'sequence' ? { kind: 'sequence', from: typed.from, moves, singular: typed.singular, table: typed.table, head: typed.head } : rest;
  };
  /** What stands against the move, as the program has found. @type {any[]} */ let troubles = [];
  /** What a field is called. @param {any} one */
  const called = (one) => {
    const label = spots.get(one.n === null ? one.field : `${one.field}.${one.n}`)?.input.getAttribute('aria-label');
    return label ?? (/** @type {any} */ ({ from: 'start', to: 'target', point: 'target', via: 'through', rotation: 'rotation', zone: 'rounding', share: 'acceleration', object_point: 'work object', object_turn: 'work object', singular: 'singular limit' })[one.field] ?? one.field ?? '');
  };
  /** Shows at each field of the move at hand what is wrong with it. */
  const showTroubles = () => {
    for (const [, { input }] of spots) input.removeAttribute('aria-invalid');
    for (const [name, { told }] of spots) if (!/^(from|to)\.\d/.test(name)) told.textContent = '';
    locally();
    for (const one of troubles) {
      if (one.move !== null && one.move !== index()) continue;
      const spot = spots.get(one.n === null ? one.field : `${one.field}.${one.n}`) ?? spots.get(`${one.field}.0`);
      if (!spot) continue;
      spot.input.setAttribute('aria-invalid', 'true');
      if (!spot.told.textContent) spot.told.textContent = one.message;
    }
  };
  /** Brings what is wrong into sight. @param {any} one */
  const go = (one) => {
    if (typed.kind === 'sequence' && one.move !== null) Sequence.choose(one.move, true);
    (spots.get(one.n === null ? one.field : `${one.field}.${one.n}`) ?? spots.get(`${one.field}.0`))?.input.focus();
  };

  /** Plans what is typed now. */
  const plan = async () => {
    const own = asked, begin = performance.now();
    busy = true;
    try {
      const told = await Desk.ask('plan', request());
      // Somebody has typed on.
      if (own !== asked) return;
      const isSequence = typed.kind === 'sequence';
      troubles = told.troubles ?? [];
      if (told.refused) {
        if (isSequence) Sequence.tell(told.steps, new Map(troubles.filter((one) => one.move !== null).reverse().map((one) => [one.move, one.message])), null);
        throw Object.assign(new Error(told.refused.message), { why: told.refused });
      }
      found = told;
      place.old.hidden = true;
      place.seen.classList.toggle('old', false);
      if (isSequence) Sequence.tell(told.steps, hurt(), told.duration);
      result();
      preview();
    } catch (error) {
      if (own !== asked) return;
      const { message, why } = /** @type {any} */ (error);
      found = null;
      const all = troubles.length ? troubles : [{ move: null, field: null, n: null, message, help: why?.help }];
      place.result.replaceChildren(...all.flatMap((one) => {
        const where = [typed.kind === 'sequence' && one.move !== null ? `Move ${one.move + 1}` : '', one.n !== null || one.message === 'missing' ? called(one) : ''].filter(Boolean).join(', ');
        return [R.make('p', { class: 'bad' }, where ? `${where}: ${one.message}` : one.message, ...(one.field ? [' ', Desk.button('Show', () => go(one), { 'aria-label': `Show ${where || called(one)}` })] : [])), one.help ? R.make('p', { class: 'note' }, one.help) : ''];
      }));
      // What is seen is not what stands in the fields.
      place.old.hidden = !plot;
      place.seen.classList.toggle('old', plot !== null);
      buttons();
    } finally {
      busy = false;
      if (own === asked) {
        begins();
        showTroubles();
        /** @type {any} */ (window).__m.planned = performance.now() - begin;
      } else soon();
    }
  };
  /** Moves of a sequence that exceed something or touch something, with what it is. */
  const hurt = () => {
    /** @type {Map<number, string>} */ const bad = new Map();
    for (const one of [...found.violations, ...(found.collision ? [found.collision] : [])]) if (!bad.has((one.move ?? 1) - 1)) bad.set((one.move ?? 1) - 1, one.what.replace(/^in move \d+, /, ''));
    return bad;
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
    shown();
    if (drawn3d) R.Space.renew(time, positions, ghost(positions), typed.kind === 'sequence' ? found.steps.map((/** @type {any} */ step) => step.begin) : undefined, start(positions));
    R.setTime(Math.min(R.now, found.duration));
    tell();
  };
  /** The target, at all times: of a sequence that of the selected move. @param {Float64Array[]} positions */
  const ghost = (positions) => {
    const end = typed.kind === 'sequence' ? found.steps[index()]?.to.axes : null;
    return positions.map((q, n) => new Float64Array(q.length).fill(end ? end[n] * (robot.axes[n].unit === 'mm' ? 1e-3 : Math.PI / 180) : q[q.length - 1]));
  };
  /** The pose at the start: of a sequence at that of the selected move. @param {Float64Array[]} positions */
  const start = (positions) => {
    const begin = typed.kind === 'sequence' ? found.steps[index()]?.from.axes : null;
    return positions.map((q, n) => begin ? begin[n] * (robot.axes[n].unit === 'mm' ? 1e-3 : Math.PI / 180) : q[0]);
  };
  /** Another move of the sequence is selected. */
  const chosen = () => {
    fields();
    release();
    showTroubles();
    if (found && drawn3d) { const { time, positions, parts } = R.data.space; R.Space.renew(time, positions, ghost(positions), parts, start(positions)); }
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
    R.data.space = { scene: robot.scene, time: Float64Array.of(0, 1), positions, set: positions, begin: positions.map((/** @type {Float64Array} */ q) => q[0]), contacts: [], surfaces: [] };
    R.guarded('The 3D view', () => { R.Space.build(); drawn3d = true; Joints.mechanism(joints); });
  };
  /** The times of the page are those of the move while it is looked at. */
  const shown = () => { if (found && !place.form.closest('section').hidden) { R.span = [0, found.duration]; place.slider.max = String(found.duration); } };
  const tell = () => { if (found) { place.slider.value = String(R.now); place.clock.textContent = `${point(R.now, 2)} of ${point(found.duration, 2)} s`; Sequence.at(R.now); } };

  R.onTime.push(() => { if (found && !place.form.closest('section')?.hidden) tell(); });
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
      const file = await Desk.ask('kept', { name });
      if (file.moves) {
        file.moves = file.moves.map((/** @type {any} */ one) => ({ ...blank(), ...one }));
        Sequence.renew();
      }
      Object.assign(typed, file);
      found = null;
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
    typed ??= { ...blank(), from: blank().to, singular: '', table: '', head: '' };
    [place.kinds, place.list, place.fields, place.strip] = ['kinds-of-move', 'sequence', 'fields', 'strip'].map((name) => R.make('div', { class: name }));
    place.form = R.make('div', { class: 'move-form' }, place.kinds, place.list, place.fields);
    place.result = R.make('div', { class: 'move-result', 'aria-live': 'polite' });
    place.plot = R.make('div', { class: 'card' });
    place.joints = R.make('div', { class: 'joints' });
    place.play = Desk.button('▶', play, { 'aria-label': 'Play or stop', title: 'Play or stop' });
    place.slider = R.make('input', { type: 'range', min: '0', max: '1', step: 'any', value: '0', 'aria-label': 'Time of the move' });
    place.slider.addEventListener('input', () => { release(); R.setTime(Number(place.slider.value)); tell(); });
    place.clock = R.make('output', { class: 'note' });
    place.bar = R.make('p', { class: 'keep' });
    place.old = R.make('p', { class: 'note', hidden: '' }, 'Path and curves are those of the last move that could be planned.');
    place.seen = R.make('div', { class: 'move-seen' }, place.old, R.make('div', { id: 'space-view' }), R.make('p', { class: 'move-time' }, place.play, place.slider, place.clock), place.strip, place.joints, place.plot);
    Sequence.build(place.list, place.strip, { typed: () => typed, look, next, chosen, focus: () => /** @type {any} */ (place.fields.querySelector('input[type=text]'))?.focus() });
    Joints.build(place.joints, {
      axes: robot.axes, isJoint: () => move().kind === 'joint', value: worth, text: (/** @type {string} */ which, /** @type {number} */ n) => list(which)[n] ?? '',
      set: (/** @type {string} */ which, /** @type {number} */ n, /** @type {string} */ text) => { list(which)[n] = text; if (inputs[which][n]) inputs[which][n].value = text; look(REST); },
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
  /** Whether the fields that are seldom used are open. */ let opened = false;
  let known = 0;
  return { renew, load, typed: () => typed, found: () => found, axes: () => robot.axes };
})();
