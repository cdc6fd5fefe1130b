// @ts-check
'use strict';
// The 3D view, at the present time of the page.
/* global R */

/** A 3D view.
 * @param {{camera: any, id: string, count: string, films: boolean, pause: number}} given The eye; the place by its id; what counts the pictures for
 * tests; whether they can be recorded; and how long the next picture waits at least, ms. */
R.view = ({ camera: C, id, count, films, pause }) => {
  const S = R.Shapes;
  const LINKS = [[0.42, 0.46, 0.52], [0.95, 0.52, 0.16], [0.93, 0.55, 0.22], [0.95, 0.52, 0.16], [0.93, 0.55, 0.22], [0.95, 0.52, 0.16], [0.35, 0.38, 0.44]];
  const AROUND = [0.6, 0.58, 0.54];
  /** The path of a movement that grows is drawn anew no more often than this, ms. */
  const TRACE = 250;
  const one = S.placed({ translation: [0, 0, 0], rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] });
  /** @typedef {[number, number, string, string, number]} Contact From, to, names, depth. */
  /** Where the floor is. */ let ground = one;
  /** @type {any} */ let data = null;
  /** @type {any} */ let scene = null;
  /** @type {any} */ let tool = null;
  /** @type {any} */ let canvas = null;
  /** @type {any} */ let pose = null;
  /** @type {any} */ let alarm = null;
  /** @type {{shape: any, mesh: any, local: Float64Array}[]} */ let parts = [];
  /** One line for each part of the time. @type {number[][]} */ let path = [];
  /** How long the pieces of each line take, s; lines by their speed, once they are drawn; and what they mean. @type {number[][]} */ let lasting = [];
  /** @type {{classes: number[][], most: number}|null} */ let speeds = null;
  /** @type {any} */ let efforts = null;
  /** @type {any} */ let table = null;
  /** @type {any} */ let legend = null;
  /** What the legend was made for. */ let legends = '';
  /** @type {Record<string, any>} */ const shown = {};
  /** A pose that is shown instead of that at the present time, one number for each position. @type {ArrayLike<number>|null} */ let held = null;
  /** What else is drawn, over everything. @type {((pen: any, here: Float64Array[]) => void)[]} */ const layers = [];
  let asked = false, seen = true, frame = 0, slow = 0, fine = 1, last = 0, rest = 0, chosen = false;
  /** The path is to be drawn anew; when it was last, where the movement grows. */
  let stale = false, traced = 0, later = 0;
  const triad = (/** @type {number} */ size) => [[0, 0, 0, size, 0, 0], [0, 0, 0, 0, size, 0], [0, 0, 0, 0, 0, size]];
  const small = triad(0.12), large = triad(0.4), AXES = [[0.85, 0.2, 0.2, 1], [0.1, 0.6, 0.25, 1], [0.15, 0.4, 0.95, 1]];
  const ball = S.mesh({ kind: 'sphere', radius: 0.03 });
  /** @type {number[]} */ const floor = [];
  for (let k = -8; k <= 8; k++) floor.push(k / 4, -2, 0, k / 4, 2, 0, -2, k / 4, 0, 2, k / 4, 0);

  /** What touches at a time. @param {number} t */
  const touches = (t) => (data.contacts ?? []).filter((/** @type {Contact} */ [from, to]) => from <= t && t <= to);

  /** A position of the pose that is shown. @param {number} n */
  const position = (n) => held ? held[n] : R.at(data.time, data.positions[n], Math.min(Math.max(R.now, data.time[0]), data.time[data.time.length - 1]));
  /** @param {boolean} set */
  const poses = (set, t = R.now) => {
    const rows = set && data.set ? data.set : data.positions;
    return S.poses(scene, (/** @type {number} */ n) => R.at(data.time, rows[n], Math.min(Math.max(t, data.time[0]), data.time[data.time.length - 1])));
  };
  const toolAt = (/** @type {Float64Array[]} */ all) => tool ? S.times(all[tool.body], tool.matrix) : all[all.length - 1];

  /** @param {string} name */
  const rgb = (name) => { const c = R.colour(name).replace(/^#(.)(.)(.)$/, '#$1$1$2$2$3$3'); return [1, 3, 5].map((n) => parseInt(c.slice(n, n + 2), 16) / 255); };

  const paint = () => {
    asked = false;
    if (!seen && !(films && R.Recorder.active())) return;
    const pen = data.pen, begin = performance.now();
    if (stale && begin - traced >= TRACE) follow();
    // What has come since is not forgotten, should nothing more come.
    clearTimeout(later);
    if (stale) later = setTimeout(ask, TRACE);
    // Where pictures follow each other slowly, as without a graphics card, half the dots will do, or a third.
    slow = begin - last > 60 + pause && begin - last < 1000 ? slow + 1 : 0;
    last = begin;
    if (slow >= 4) fine = slow >= 12 ? 0.34 : 0.5;
    clearTimeout(rest);
    // What stands still is drawn with all dots.
    if (fine < 1) rest = setTimeout(() => { fine = 1; slow = 0; last = 0; ask(); }, 500);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.round(size * devicePixelRatio * fine));
    if (width > 0 && (canvas.width !== width || canvas.height !== height)) { canvas.width = width; canvas.height = height; }
    pen.begin(C.looking(canvas), C.sun(), rgb('raised'));
    pen.lines(floor, ground, [...rgb('grid'), 1]);
    large.forEach((line, n) => pen.lines(line, one, AXES[n]));
    const here = held ? S.poses(scene, position) : poses(false);
    if (shown.path.checked && shown.speed.checked) R.Speed.draw(pen, bySpeed().classes, one);
    else if (shown.path.checked) {
      const t = Math.max(R.now, data.time[0]), now = (data.parts ?? []).reduce((/** @type {number} */ last, /** @type {number} */ begin, /** @type {number} */ n) => begin <= t + 1e-9 ? n : last, 0);
      path.forEach((line, n) => line.length && pen.lines(line, one, [...rgb(path.length > 1 && n === now ? 's2' : 's1'), 1]));
    }
    for (const { shape, mesh, local } of parts) pen.solid(mesh, S.times(here[shape.body], local), [...(shape.colour?.slice(0, 3) ?? (shape.around ? AROUND : LINKS[Math.min(shape.body, 6)])), 1]);
    /** @param {Float64Array[]} there @param {string} colour */
    const ghost = (there, colour) => {
      // What is where it should be would only cover itself.
      const apart = here.map((/** @type {Float64Array} */ at, /** @type {number} */ n) => at.some((x, k) => Math.abs(x - there[n][k]) > 4e-3));
      for (const { shape, mesh, local } of parts) if (apart[shape.body]) pen.solid(mesh, S.times(there[shape.body], local), [...rgb(colour), 0.3]);
    };
    if (data.set && shown.ghost.checked) ghost(poses(true), 's5');
    if (data.begin && shown.begin.checked) ghost(S.poses(scene, (/** @type {number} */ n) => data.begin[n]), 's2');
    pen.through();
    if (shown.frames.checked) {
      for (const f of scene.frames) small.forEach((line, n) => pen.lines(line, S.times(here[f.body], f.matrix), AXES[n]));
      for (const at of here.slice(1)) small.forEach((line, n) => pen.lines(line, at, AXES[n]));
    }
    if (shown.masses.checked) for (const mass of scene.masses) pen.solid(ball, S.times(here[mass.body], S.placed({ translation: mass.com, rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] })), [...rgb('alarm'), 1]);
    if (efforts && shown.torque.checked) efforts.draw(pen, here, data.time, (/** @type {number} */ n) => rgb(`s${n % 6 + 1}`));
    for (const draw of layers) draw(pen, here);
    const at = toolAt(here);
    explain();
    if (shown.table.checked) table.tell(told);
    alarm.textContent = touches(R.now).map((/** @type {Contact} */ [, , one, other]) => `${one} touches ${other}`).join('\n');
    pose.textContent = at ? `${tool ? tool.name : scene.bodies[scene.bodies.length - 1].name}\nx ${(at[12] * 1000).toFixed(1)} mm\ny ${(at[13] * 1000).toFixed(1)} mm\nz ${(at[14] * 1000).toFixed(1)} mm` : '';
    frame++;
    const m = /** @type {any} */ (window).__m;
    m[count] = frame;
    m.frame_ms = performance.now() - begin;
    if (films) R.Recorder.frame(canvas);
  };
  const ask = () => {
    if (asked) return;
    asked = true;
    const left = last + pause - performance.now();
    if (left > 0) setTimeout(() => requestAnimationFrame(paint), left); else requestAnimationFrame(paint);
  };

  /** The path by its speed, which is worked out when somebody looks. */
  const bySpeed = () => speeds ??= R.Speed.sorted(path, lasting);
  /** What colours and arcs mean, where they are shown. */
  const explain = () => {
    const colours = shown.path.checked && shown.speed.checked && bySpeed().most > 0, arcs = Boolean(efforts) && shown.torque.checked;
    const key = `${colours ? `${bySpeed().most} ${R.colour('ground')}` : ''} ${arcs}`;
    if (key === legends) return;
    legends = key;
    const pieces = lasting.flat();
    legend.replaceChildren(...(colours ? [R.Speed.legend(bySpeed().most, Math.max(...pieces))] : []), ...(arcs ? [efforts.legend()] : []));
    legend.hidden = !colours && !arcs;
  };
  /** The pose that is shown, for the tables. */
  const told = () => {
    const here = held ? S.poses(scene, position) : poses(false), there = data.set ? poses(true) : null, t = Math.min(Math.max(R.now, data.time[0]), data.time[data.time.length - 1]);
    return { t, tool: toolAt(here), setTool: there && toolAt(there), position, setPosition: (/** @type {number} */ n) => R.at(data.time, data.set[n], t), effort: (/** @type {number} */ n) => efforts.value(n, data.time, t) };
  };

  /** Way of the tool over the whole time, as lines short enough for one buffer each: one for each part. */
  const trace = () => {
    const [first, last] = [data.time[0], data.time[data.time.length - 1]];
    /** @type {number[]} */ const begins = data.parts?.length ? data.parts : [first];
    speeds = null;
    lasting = [];
    path = begins.map((begin, n) => {
      const end = begins[n + 1] ?? last, steps = Math.min(600, Math.ceil(data.time.length / begins.length));
      /** @type {number[]} */ const line = [];
      /** @type {number[]|null} */ let before = null;
      for (let k = 0; k < steps; k++) {
        const at = toolAt(poses(false, begin + (end - begin) * k / Math.max(steps - 1, 1))), here = [at[12], at[13], at[14]];
        if (before) line.push(...before, ...here);
        before = here;
      }
      lasting.push(Array(line.length / 6).fill((end - begin) / Math.max(steps - 1, 1)));
      return line;
    });
  };
  /** The path of a movement that grows: points at even distances in time, of which those that are known stay. @type {number[][]} */ let points = [];
  /** The past that they are of. */ let known = 0;
  const lengthen = () => {
    const { time } = data, [first, last] = [time[0], time[time.length - 1]], pitch = (R.span[1] - R.span[0]) / 600;
    if (!(pitch > 0) || !points.length || points[0][3] !== first || points[0][4] !== pitch) points = [];
    while (points.length && points[points.length - 1][3] > last) points.pop();
    const add = (/** @type {number} */ t) => { const at = toolAt(poses(false, t)); return [at[12], at[13], at[14], t, pitch]; };
    for (let t = first + points.length * pitch; t <= last; t = first + points.length * pitch) points.push(add(t));
    const all = [...points, add(last)];
    path = [all.slice(1).flatMap((point, n) => [...all[n].slice(0, 3), ...point.slice(0, 3)])];
    lasting = [all.slice(1).map((point, n) => point[3] - all[n][3])];
    speeds = null;
  };
  /** The path of a movement that has grown; what has left the picture is brought back, unless somebody has chosen what to see. */
  const follow = () => {
    stale = false;
    traced = performance.now();
    lengthen();
    if (!chosen && isOut()) fit();
  };
  /** Whether a part of the mechanism is beyond the edge of the picture. */
  const isOut = () => {
    const here = poses(false), looks = C.looking(canvas);
    return parts.some(({ shape, mesh, local }) => {
      const m = S.times(looks, S.times(here[shape.body], local));
      for (let n = 0; n + 2 < mesh.lines.length; n += 12) {
        const [x, y, z] = mesh.lines.slice(n, n + 3), deep = m[3] * x + m[7] * y + m[11] * z + m[15];
        if (Math.abs(m[0] * x + m[4] * y + m[8] * z + m[12]) > deep || Math.abs(m[1] * x + m[5] * y + m[9] * z + m[13]) > deep) return true;
      }
      return false;
    });
  };

  /** Shows everything at the begin, in the middle and at the end. */
  const fit = () => {
    const points = [R.span[0], (R.span[0] + R.span[1]) / 2, R.span[1]].flatMap((t) => {
      const at = poses(false, t);
      return parts.flatMap(({ shape, mesh, local }) => {
        const m = S.times(at[shape.body], local), all = [];
        for (let n = 0; n < mesh.lines.length; n += 12) all.push(S.point(m, mesh.lines.slice(n, n + 3)));
        return all;
      });
    });
    C.fit(points, canvas);
  };
  /** @param {string} number */
  const look = (number) => { C.look(number); fit(); ask(); };

  /** What touches when, each a way there. */
  const contacts = () => {
    const all = data.contacts ?? [];
    const meshes = data.unlooked ?? [];
    const note = meshes.length ? [R.make('p', { class: 'note', title: meshes.join('\n') }, `Contacts of ${meshes.length === 1 ? 'the mesh' : `the ${meshes.length} meshes`} are not looked for.`)] : [];
    if (!all.length) return note;
    const ways = all.slice(0, 6).map((/** @type {Contact} */ [from, to, one, other, depth]) => {
      const button = R.make('button', { type: 'button', title: `until ${R.time(to)} s, ${R.say(depth * 1000)} mm deep at most` }, `${R.time(from)} s: ${one} – ${other}`);
      button.addEventListener('click', () => R.setTime(from));
      return button;
    });
    return [R.make('p', { class: 'contacts' }, R.make('b', {}, 'Contacts.'), ' ', ...ways, all.length > 6 ? ` and ${all.length - 6} more, marked on the time line` : ''), ...note];
  };

  /** Shows a movement in its place. @param {any} [given] */
  const build = (given = R.data.space) => {
    const place = document.getElementById(id);
    // Browsers have few contexts to give.
    if (data !== given) data?.pen?.end?.();
    data = given;
    if (!place || !data) return;
    place.classList.add('space-view');
    scene = data.scene;
    [stale, chosen, held, points] = [false, false, null, []];
    const list = (/** @type {any} */ given) => ArrayBuffer.isView(given) ? given : R.list(given);
    data.time = list(data.time);
    data.positions = data.positions.map(list);
    data.set = data.set?.map(list);
    if (!(data.time.length > 0)) throw new Error('nothing was recorded');
    for (const f of scene.frames) f.matrix = S.placed(f);
    const named = scene.frames.filter((/** @type {any} */ f) => /tcp|tool|effector/i.test(f.name));
    tool = named[named.length - 1] ?? scene.frames[scene.frames.length - 1];
    parts = [];
    let left = 0;
    for (const shape of scene.shapes) {
      if (shape.use === 'collision') continue;
      const mesh = S.mesh(shape) ?? R.Meshes.mesh(shape, data.surfaces);
      if (mesh) parts.push({ shape, mesh, local: S.placed(shape) }); else left++;
    }
    canvas = R.make('canvas', { tabindex: '0', 'aria-label': 'The 3D view; drag turns, Shift and drag moves, the wheel zooms' });
    // It changes too often to be read out by itself.
    pose = R.make('output', { class: 'pose', 'aria-live': 'off' });
    alarm = R.make('output', { class: 'touching' });
    ground = S.placed({ translation: [0, 0, scene.floor ?? 0], rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] });
    // In the studio these keys do other things.
    const hint = (/** @type {string} */ key) => document.body.classList.contains('studio') ? '' : ` (${key})`;
    const toggle = (/** @type {string} */ key, /** @type {string} */ name, /** @type {boolean} */ on) => {
      shown[key] = R.make('input', { type: 'checkbox' });
      shown[key].checked = on;
      shown[key].addEventListener('change', ask);
      return R.make('label', {}, shown[key], ' ', name);
    };
    /** What a ghost is, with its colour. @param {string} key @param {string} name @param {string} colour */
    const ghostly = (key, name, colour) => {
      const label = toggle(key, name, true), mark = R.make('i', { class: 'ghost-mark' });
      mark.style.background = `var(--${colour})`;
      label.append(' ', mark);
      return label;
    };
    const views = Object.entries(C.VIEWS).map(([number, [, , name]]) => {
      const button = R.make('button', { type: 'button', title: `View from: ${name}${hint(number)}` }, name);
      button.addEventListener('click', () => look(number));
      return button;
    });
    const switches = [ghostly('ghost', `${data.begin ? 'target' : 'set value'}${hint('G')}`, 's5'), toggle('path', `path${hint('P')}`, true), toggle('speed', `speed${hint('S')}`, films && !document.body.classList.contains('studio')), toggle('torque', `torques${hint('E')}`, data.efforts?.length > 0), toggle('frames', `frames${hint('M')}`, false), toggle('masses', `centres of mass${hint('C')}`, false), toggle('table', `table${hint('J')}`, false)];
    if (data.begin) switches.splice(0, 0, ghostly('begin', 'start', 's2'));
    if (!data.set) shown.ghost.parentElement.hidden = true;
    for (const effort of data.efforts ?? []) effort.values = list(effort.values);
    efforts = data.efforts?.length ? R.efforts(scene, data.efforts) : null;
    if (!efforts?.all.length) { efforts = null; shown.torque.parentElement.hidden = true; }
    table = R.poseTable(scene, tool ? tool.name : scene.bodies[scene.bodies.length - 1].name, { set: Boolean(data.set), efforts });
    table.place.hidden = true;
    shown.table.addEventListener('change', () => { table.place.hidden = !shown.table.checked; });
    legend = R.make('p', { class: 'note space-legend', hidden: '' });
    legends = '';
    data.pen = R.Draw3d.webgl(canvas);
    if (!data.pen) {
      const blank = R.make('canvas', { tabindex: '0', 'aria-label': canvas.getAttribute('aria-label') });
      canvas = blank;
      data.pen = R.Draw3d.flat(canvas);
    }
    if (!data.pen) throw new Error('this browser has no canvas');
    /** @type {any} */ (window).__m.space = data.pen.name;
    document.documentElement.dataset.space = data.pen.name;
    const notes = [data.pen.name === 'WebGL' ? '' : 'No WebGL here: drawn as a wire frame.', left ? `Not shown: ${left === 1 ? 'one mesh' : `${left} meshes`}.` : ''].filter(Boolean).join(' ');
    const bar = R.make('div', { class: 'space-bar' }, ...views, ...switches, R.make('span', { class: 'note' }, notes));
    place.append(bar, ...contacts(), legend, R.make('div', { class: 'stage' }, canvas, pose, alarm), table.place);
    if (films) R.Recorder.build(bar, bar);
    trace();
    fit();
    C.mouse(canvas, ask);
    // What is out of sight is not drawn.
    watch?.disconnect();
    watch = new IntersectionObserver((all) => { seen = all[all.length - 1].isIntersecting; if (seen) ask(); });
    watch.observe(canvas);
    // Paper takes a picture of the view.
    canvas.classList.add('drawn');
    // Somebody has chosen what to see.
    for (const kind of ['pointerdown', 'wheel']) canvas.addEventListener(kind, () => { chosen = true; }, { passive: true });
    if (!listens) listen();
    paint();
  };
  /** @type {IntersectionObserver|null} */ let watch = null;
  let listens = false;
  /** What any movement in this place is to hear. */
  const listen = () => {
    listens = true;
    R.onTime.push(ask);
    R.onTheme.push(ask);
    /** @type {HTMLCanvasElement|null} */ let still = null;
    window.addEventListener('beforeprint', () => {
      if (!canvas.isConnected || !canvas.clientWidth) return;
      seen = true;
      paint();
      still ??= /** @type {HTMLCanvasElement} */ (R.make('canvas', { class: 'still' }));
      [still.width, still.height] = [canvas.width, canvas.height];
      still.getContext('2d')?.drawImage(canvas, 0, 0);
      canvas.parentElement.append(still);
    });
    window.addEventListener('afterprint', () => still?.remove());
    // A telephone that is turned: all is shown again, unless somebody has chosen what to see.
    window.addEventListener('resize', () => { if (!chosen && canvas.clientWidth > 0) fit(); ask(); });
  };

  /** Another movement of the same mechanism. @param {Float64Array} time @param {Float64Array[]} positions @param {Float64Array[]} set
   * @param {number[]} [parts] When its parts begin; the way of the present one has another colour. @param {number[]} [begin] The pose at the start, as another ghost. */
  const renew = (time, positions, set, parts, begin) => {
    Object.assign(data, { time, positions, set, parts, begin });
    trace();
    ask();
  };
  /** The movement as far as it is known by now. @param {Float64Array} time @param {Float64Array[]} positions @param {Float64Array[]} [set]
   * @param {number} [past] Another one where what was known before counts no more. */
  const grow = (time, positions, set, past = 0) => {
    if (past !== known) [known, points] = [past, []];
    Object.assign(data, { time, positions, ...(set ? { set } : {}) });
    stale = true;
    ask();
  };

  /** Shows a pose until another one is given, or nothing: then that at the present time. @param {ArrayLike<number>|null} pose */
  const hold = (pose) => { held = pose; ask(); };
  const stage = () => ({ canvas, scene, parts, movement: data });

  const flip = (/** @type {string} */ key) => () => { if (!shown[key] || shown[key].parentElement.hidden) return; shown[key].click(); };
  /** @type {Record<string, () => void>} */
  const keys = { g: flip('ghost'), p: flip('path'), m: flip('frames'), c: flip('masses'), s: flip('speed'), e: flip('torque'), j: flip('table'), f: () => { fit(); ask(); } };
  for (const number of Object.keys(C.VIEWS)) keys[number] = () => look(number);
  return { build, renew, grow, fit, keys, poses, paint, ask, hold, position, layers, stage };
};
R.Space = R.view({ camera: R.Camera, id: 'space-view', count: 'frames', films: true, pause: 0 });
