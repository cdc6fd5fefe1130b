// @ts-check
'use strict';
// Joints of the robot that are moved by hand: a link is dragged about its joint in the 3D view, or a slider is moved by keys. What comes
// of it stands in the fields of the planner.
/* global R */

/** @type {any} */ (R).Joints = (() => {
  const { Desk } = /** @type {any} */ (R);
  /** Most triangles that are looked through whenever the pointer moves. */
  const HOVER = 150000;
  /** Steps of keys, ° or mm: arrows, with Shift, Page Up and Down. */
  const STEP = 1, FINE = 0.1, COARSE = 10;
  /** Changes that can be taken back. */
  const KEPT = 100;
  /** @type {any} */ let owner = null;
  /** @type {any} */ let stage = null;
  /** @type {any[]} Slider, text and line of each axis. */ let rows = [];
  /** @type {any[]} What is drawn at each joint. */ let rings = [];
  /** @type {{which: string, axis: number, before: string, after: string, keys: boolean}[]} */ let done = [];
  /** Which joint is marked: under the pointer, dragged, or with the focus. */ let marked = -1, focused = -1;
  /** @type {any} */ const place = { which: null, by: null, undo: null };
  let hover = 0;

  const which = () => owner.isJoint() ? place.which.value : 'from';
  /** Range of an axis; one without ends is moved over a turn to each side, or a metre. @param {number} n */
  const limits = (n) => { const axis = owner.axes[n], far = axis.unit === 'mm' ? 1000 : 360; return { ...axis, lower: axis.lower ?? -far, upper: axis.upper ?? far }; };
  /** One unit of a field in rad or m. @param {number} n */
  const scale = (n) => limits(n).unit === 'mm' ? 1e-3 : Math.PI / 180;
  const inside = (/** @type {number} */ n, /** @type {number} */ x) => {
    const { lower, upper } = limits(n);
    const near = Math.round(Math.min(Math.max(x, lower), upper) * 100) / 100;
    return near > upper ? Math.floor(upper * 100) / 100 : near < lower ? Math.ceil(lower * 100) / 100 : near;
  };
  /** At which end of its range a joint stands: -1, 1, or 0. @param {number} n */
  const stop = (n) => { const x = owner.value(which(), n); return x >= limits(n).upper - 5e-3 ? 1 : x <= limits(n).lower + 5e-3 ? -1 : 0; };
  const pose = () => Float64Array.from(owner.axes, (/** @type {any} */ _, /** @type {number} */ n) => owner.value(which(), n) * scale(n));

  /** Shows what stands in the fields. */
  const show = () => {
    rows.forEach(({ slider, text, line }, n) => {
      const x = owner.value(which(), n), unit = limits(n).unit, at = stop(n);
      slider.value = String(x);
      const told = `${x.toFixed(2).replace('-', '−')} ${unit}`, end = at ? `, at its ${at > 0 ? 'upper' : 'lower'} limit` : '';
      text.textContent = told + (at ? ` ■ ${at > 0 ? 'upper' : 'lower'} limit` : '');
      slider.setAttribute('aria-valuetext', told + end);
      line.classList.toggle('stop', at !== 0);
    });
    place.undo.disabled = !done.length;
    place.line.hidden = !owner.isJoint();
  };
  /** The mechanism stands as the fields have it. */
  const hold = () => { if (stage) { owner.held(true); R.Space.hold(pose()); } };

  /** Moves a joint as far as its range goes. @param {number} n @param {number} x ° or mm. @returns {string} What stands in its field now. */
  const move = (n, x) => {
    const text = String(inside(n, x));
    owner.set(which(), n, text);
    show();
    hold();
    return text;
  };
  /** What was done can be taken back. @param {number} axis @param {string} before @param {string} after @param {boolean} joins Whether keys moved it, which go on with the last ones. */
  const note = (axis, before, after, joins) => {
    if (before === after) return;
    const last = done[done.length - 1], side = which();
    if (joins && last?.keys && last.axis === axis && last.which === side && last.after === before) last.after = after; else done.push({ which: side, axis, before, after, keys: joins });
    done = done.slice(-KEPT);
    show();
  };
  /** Takes the last movement back, unless its field has been typed in since. */
  const undo = () => {
    for (let last = done.pop(); last; last = done.pop()) {
      if (owner.text(last.which, last.axis) !== last.after) continue;
      owner.set(last.which, last.axis, last.before);
      Desk.say(`${limits(last.axis).name} is back at ${last.before || 'nothing'}`);
      break;
    }
    show();
    hold();
  };

  /** A piece of a disc round an axis, or of a rail along it. @param {any} motion @param {number} low @param {number} high @param {number} size */
  const ring = (motion, low, high, size) => {
    const [a, b, c] = motion.axis, away = Math.abs(a) < 0.8 ? [1, 0, 0] : [0, 1, 0];
    const cross = (/** @type {number[]} */ p, /** @type {number[]} */ q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const unit = (/** @type {number[]} */ p) => { const l = Math.hypot(...p) || 1; return p.map((x) => x / l); };
    const axis = unit([a, b, c]), u = unit(cross(axis, away)), v = cross(axis, u);
    const at = (/** @type {number} */ q, /** @type {number} */ r) => motion.kind === 'turn'
      ? u.map((x, k) => r * size * (x * Math.cos(q) + v[k] * Math.sin(q)))
      : u.map((x, k) => axis[k] * q + (r - 0.9) * size * x);
    const band = (/** @type {number} */ from, /** @type {number} */ to, /** @type {number} */ inner, /** @type {number} */ outer, /** @type {number} */ parts) => {
      /** @type {{triangles: number[], lines: number[]}} */ const mesh = { triangles: [], lines: [] };
      for (let k = 0; k < parts; k++) {
        const [p, q] = [from + (to - from) * k / parts, from + (to - from) * (k + 1) / parts];
        const [one, two, three, four] = [at(p, inner), at(p, outer), at(q, outer), at(q, inner)];
        for (const corner of [one, two, three, one, three, four]) mesh.triangles.push(...corner, ...axis);
        mesh.lines.push(...two, ...three);
      }
      mesh.lines.push(...at(from, inner), ...at(from, outer), ...at(to, inner), ...at(to, outer));
      return mesh;
    };
    const wide = motion.kind === 'turn' ? 0.03 : 0.03 * size;
    return { range: band(low, high, 0.82, 1, 48), low: band(low, low + wide, 0.74, 1.08, 1), high: band(high - wide, high, 0.74, 1.08, 1), hand: band(-wide / 2, wide / 2, motion.kind === 'turn' ? 0.1 : 0.74, 1.08, 1) };
  };
  /** Draws the marked joint: its range, where it is, and its ends. @param {any} pen @param {Float64Array[]} here */
  const draw = (pen, here) => {
    const n = marked >= 0 ? marked : focused;
    if (n < 0 || !stage || !rings[n]) return;
    const body = stage.joints[n], S = R.Shapes, one = stage.scene.bodies[body];
    const local = one.matrix ?? S.placed(one), base = one.parent === null || one.parent === undefined ? local : S.times(here[one.parent], local), end = stop(n);
    const rgb = (/** @type {string} */ name) => { const c = R.colour(name).replace(/^#(.)(.)(.)$/, '#$1$1$2$2$3$3'); return [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16) / 255); };
    const own = rgb(`s${n % 6 + 1}`), alarm = rgb('alarm');
    pen.solid(rings[n].range, base, [...own, 0.4]);
    pen.solid(rings[n].low, base, [...(end < 0 ? alarm : own), 0.99]);
    pen.solid(rings[n].high, base, [...(end > 0 ? alarm : own), 0.99]);
    pen.solid(rings[n].hand, here[body], [...(end ? alarm : own), 0.99]);
  };

  /** From a point of a body to the canvas, in its pixels of CSS. @param {ArrayLike<number>} m */
  const project = (m, /** @type {ArrayLike<number>} */ p) => {
    const w = m[3] * p[0] + m[7] * p[1] + m[11] * p[2] + m[15];
    const x = (m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12]) / w, y = (m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13]) / w;
    return [(1 + x) / 2 * stage.canvas.clientWidth, (1 - y) / 2 * stage.canvas.clientHeight, w];
  };
  /** Room for points of a mesh on the canvas. */ let room = new Float64Array(0);
  /** Which joint moves what is seen at a point of the canvas, and the point of its body there. @param {number} x @param {number} y */
  const pick = (x, y) => {
    const S = R.Shapes, view = R.Camera.looking(stage.canvas), here = S.poses(stage.scene, (/** @type {number} */ n) => R.Space.position(n));
    const wide = stage.canvas.clientWidth / 2, high = stage.canvas.clientHeight / 2;
    let near = Infinity;
    /** @type {any} */ let found = null;
    for (const { shape, mesh, local } of stage.parts) {
      if (shape.around) continue;
      const m = S.times(view, S.times(here[shape.body], local)), all = mesh.triangles, points = all.length / 6;
      if (room.length < 3 * points) room = new Float64Array(3 * points);
      for (let n = 0, from = 0, to = 0; n < points; n++, from += 6, to += 3) {
        const a = all[from], b = all[from + 1], c = all[from + 2], w = m[3] * a + m[7] * b + m[11] * c + m[15];
        room[to] = wide * (1 + (m[0] * a + m[4] * b + m[8] * c + m[12]) / w);
        room[to + 1] = high * (1 - (m[1] * a + m[5] * b + m[9] * c + m[13]) / w);
        room[to + 2] = w;
      }
      for (let n = 0; n + 8 < 3 * points; n += 9) {
        const ax = room[n] - x, ay = room[n + 1] - y, bx = room[n + 3] - x, by = room[n + 4] - y, cx = room[n + 6] - x, cy = room[n + 7] - y;
        const r = bx * cy - cx * by, s = cx * ay - ax * cy, t = ax * by - bx * ay, area = r + s + t;
        if (Math.abs(area) < 1e-9 || r * area < 0 || s * area < 0 || t * area < 0) continue;
        const [aw, bw, cw] = [room[n + 2], room[n + 5], room[n + 8]];
        if (aw <= 0 || bw <= 0 || cw <= 0) continue;
        // Along a line of sight one over the distance is straight on the screen.
        const deep = area / (r / aw + s / bw + t / cw);
        if (deep >= near) continue;
        near = deep;
        const share = [r / aw * deep / area, s / bw * deep / area, t / cw * deep / area];
        const point = [0, 1, 2].map((k) => share[0] * all[2 * n + k] + share[1] * all[2 * n + 6 + k] + share[2] * all[2 * n + 12 + k]);
        found = { body: shape.body, point: S.point(local, point) };
      }
    }
    let body = found?.body ?? null;
    while (body !== null && body !== undefined && !stage.joints.includes(body)) body = stage.scene.bodies[body].parent;
    const axis = stage.joints.indexOf(body);
    return axis < 0 ? null : { ...found, axis };
  };

  /** Turns a joint so that the point of its body comes as near to the pointer as it can. @param {any} held @param {number} x @param {number} y @param {number} from @returns {number} rad or m */
  const follow = (held, x, y, from) => {
    const S = R.Shapes, view = R.Camera.looking(stage.canvas), q = pose(), [low, high] = [limits(held.axis).lower, limits(held.axis).upper].map((end) => end * scale(held.axis));
    const seen = (/** @type {number} */ at) => { q[held.axis] = at; return project(S.times(view, S.poses(stage.scene, (/** @type {number} */ n) => q[n])[held.body]), held.point); };
    let at = from;
    for (let turn = 0; turn < 8; turn++) {
      const here = seen(at), next = seen(at + 1e-4), [dx, dy] = [(next[0] - here[0]) / 1e-4, (next[1] - here[1]) / 1e-4];
      // Where a joint moves towards the eye its way on the screen is short: then it goes slowly.
      const step = (dx * (x - here[0]) + dy * (y - here[1])) / (dx * dx + dy * dy + 900);
      at = Math.min(Math.max(at + Math.min(Math.max(step, -0.3), 0.3), low), high);
      if (Math.abs(step) < 1e-4) break;
    }
    return at;
  };

  /** @param {PointerEvent} event */
  const spot = (event) => { const box = stage.canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const mark = (/** @type {number} */ n) => {
    if (marked === n) return;
    marked = n;
    rows.forEach(({ line }, k) => line.classList.toggle('marked', k === n));
    if (stage) stage.canvas.style.cursor = n >= 0 ? 'move' : '';
    R.Space.ask();
  };
  /** @param {PointerEvent} event */
  const down = (event) => {
    if (!place.by.checked || event.button !== 0 || event.shiftKey || !event.isPrimary) return;
    // What is grabbed stands where the fields have it.
    const held = pick(...spotted(event));
    if (!held) return;
    event.stopImmediatePropagation();
    const before = owner.text(which(), held.axis), first = owner.value(which(), held.axis) * scale(held.axis);
    hold();
    // The pointer keeps the distance that it had from the point, which has moved if another pose was shown.
    const seat = project(R.Shapes.times(R.Camera.looking(stage.canvas), R.Shapes.poses(stage.scene, (/** @type {number} */ n) => pose()[n])[held.body]), held.point);
    let at = first, after = before;
    mark(held.axis);
    stage.canvas.setPointerCapture(event.pointerId);
    stage.canvas.focus({ preventScroll: true });
    // Its way counts in the window: what comes or goes above the picture moves that, and nobody has moved the pointer.
    const drag = (/** @type {PointerEvent} */ to) => {
      if (to.pointerId !== event.pointerId) return;
      at = follow(held, seat[0] + to.clientX - event.clientX, seat[1] + to.clientY - event.clientY, at);
      after = move(held.axis, at / scale(held.axis));
    };
    const end = (/** @type {Event|null} */ last) => {
      if (last && /** @type {PointerEvent} */ (last).pointerId !== event.pointerId) return;
      for (const [kind, does] of /** @type {[string, any][]} */ ([['pointermove', drag], ['pointerup', end], ['pointercancel', end]])) stage.canvas.removeEventListener(kind, does);
      document.removeEventListener('keydown', escape, true);
      mark(-1);
      if (last) note(held.axis, before, after, false);
    };
    const escape = (/** @type {KeyboardEvent} */ key) => {
      if (key.key !== 'Escape') return;
      key.preventDefault();
      key.stopPropagation();
      end(null);
      owner.set(which(), held.axis, before);
      show();
      hold();
    };
    stage.canvas.addEventListener('pointermove', drag);
    stage.canvas.addEventListener('pointerup', end);
    stage.canvas.addEventListener('pointercancel', end);
    document.addEventListener('keydown', escape, true);
  };
  /** @param {PointerEvent} event @returns {[number, number]} */
  const spotted = (event) => { const [x, y] = spot(event); return [x, y]; };
  /** @param {PointerEvent} event */
  const over = (event) => {
    if (event.buttons || hover || !place.by.checked) return;
    hover = requestAnimationFrame(() => { hover = 0; mark(stage.count < HOVER ? pick(...spotted(event))?.axis ?? -1 : -1); });
  };

  /** The mechanism is there. @param {number[]} joints The body of each axis. */
  const mechanism = (joints) => {
    const { canvas, scene, parts } = R.Space.stage();
    stage = { canvas, scene, parts, joints, count: parts.reduce((/** @type {number} */ sum, /** @type {any} */ part) => sum + part.mesh.triangles.length / 18, 0) };
    // As large as suits the mechanism: a tenth of what is seen.
    const here = R.Shapes.poses(scene, () => 0), spread = here.map((/** @type {Float64Array} */ at) => Math.hypot(at[12], at[13], at[14]));
    const size = 0.18 * Math.max(...spread, 0.1);
    rings = joints.map((body, n) => ring(scene.bodies[body].motion, limits(n).lower * scale(n), limits(n).upper * scale(n), size));
    R.Space.layers.splice(0, R.Space.layers.length, draw);
    canvas.addEventListener('pointerdown', down, true);
    canvas.addEventListener('pointermove', over);
    canvas.addEventListener('pointerleave', () => { if (marked >= 0 && !hover) mark(-1); });
  };

  /** Makes the sliders. @param {HTMLElement} view @param {any} given */
  const build = (view, given) => {
    owner = given;
    stage = null;
    done = [];
    marked = focused = -1;
    place.which = R.make('select', { 'aria-label': 'What is moved' }, R.make('option', { value: 'to' }, 'target'), R.make('option', { value: 'from' }, 'start'));
    place.which.addEventListener('change', () => { show(); hold(); });
    place.by ??= Object.assign(R.make('input', { type: 'checkbox' }), { checked: true });
    place.undo = Desk.button('Undo', undo, { title: 'Take the last movement of a joint back (Ctrl Z)' });
    place.line = R.make('label', {}, 'of the ', place.which);
    rows = owner.axes.map((/** @type {any} */ axis, /** @type {number} */ n) => {
      const slider = R.make('input', { type: 'range', min: String(limits(n).lower), max: String(limits(n).upper), step: 'any', 'aria-label': `${axis.name}, joint` }), text = R.make('output', {});
      let before = '', moving = false;
      slider.addEventListener('input', () => { if (!moving) before = owner.text(which(), n); moving = true; move(n, Number(slider.value)); });
      slider.addEventListener('change', () => { moving = false; note(n, before, owner.text(which(), n), false); });
      slider.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
        const by = event.shiftKey ? FINE : STEP, x = owner.value(which(), n), { lower, upper } = limits(n);
        const to = /** @type {Record<string, number>} */ ({ ArrowRight: x + by, ArrowUp: x + by, ArrowLeft: x - by, ArrowDown: x - by, PageUp: x + COARSE, PageDown: x - COARSE, Home: lower, End: upper })[event.key];
        if (to === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
        event.preventDefault();
        const was = owner.text(which(), n);
        note(n, was, move(n, to), true);
      });
      slider.addEventListener('focus', () => { focused = n; if (stage) R.Space.ask(); });
      slider.addEventListener('blur', () => { focused = -1; if (stage) R.Space.ask(); });
      return { slider, text, line: R.make('label', { class: 'joint' }, R.make('span', {}, axis.name), slider, text) };
    });
    view.replaceChildren(R.make('div', { class: 'joints-bar' }, R.make('b', {}, 'Joints'), ' ', place.line, ' ', R.make('label', { class: 'by-hand' }, place.by, ' drag links in the 3D view'), ' ', place.undo),
      R.make('div', { class: 'joints-rows' }, ...rows.map((row) => row.line)), R.make('p', { class: 'note' }, `Arrow keys move by ${STEP} (° or mm), with Shift by ${FINE}, Page Up and Down by ${COARSE}.`));
    document.getElementById('motion')?.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      const typing = event.target instanceof HTMLInputElement && event.target.type === 'text';
      if (!(event.ctrlKey || event.metaKey) || event.shiftKey || event.key.toLowerCase() !== 'z' || typing || !done.length || owner !== given) return;
      event.preventDefault();
      undo();
    });
    show();
  };
  return { build, mechanism, show, undo, pick: (/** @type {number} */ x, /** @type {number} */ y) => pick(x, y)?.axis ?? -1, project: (/** @type {number} */ n) => {
    const here = R.Shapes.poses(stage.scene, (/** @type {number} */ k) => R.Space.position(k))[stage.joints[n]];
    return project(R.Shapes.times(R.Camera.looking(stage.canvas), here), [0, 0, 0]);
  } };
})();
