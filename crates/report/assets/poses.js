// @ts-check
'use strict';
// A pose as tables: where the tool is, its orientation, and the positions of the joints, at the present time of the page.
/* global R */

/** The tables of a mechanism. @param {any} scene @param {string} toolName @param {{set: boolean, efforts: any}} has */
R.poseTable = (scene, toolName, has) => {
  /** Numbers change no more often than can be read, ms. */
  const READ = 100;
  const DEGREES = 180 / Math.PI;
  /** Where cos β is below this, two of the angles turn about the same line. */
  const LOCK = 1e-9;
  let told = 0, waiting = 0;

  /** ZYX Euler angles of a matrix, degrees: R = Rz(α) Ry(β) Rx(γ). At β = ±90° γ is 0, and α has all of the turn. @param {ArrayLike<number>} m */
  const euler = (m) => {
    const r = (/** @type {number} */ row, /** @type {number} */ column) => m[4 * column + row], cosine = Math.hypot(r(0, 0), r(1, 0));
    const alpha = cosine < LOCK ? Math.atan2(-r(0, 1), r(1, 1)) : Math.atan2(r(1, 0), r(0, 0)), s = Math.sin(alpha), c = Math.cos(alpha);
    return [alpha, Math.atan2(-r(2, 0), cosine), Math.atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1))].map((x) => x * DEGREES);
  };
  const point = (/** @type {number} */ x, /** @type {number} */ digits) => Number.isFinite(x) ? (Math.abs(x) < 0.5 / 10 ** digits ? 0 : x).toFixed(digits).replace('-', '−') : '–';

  /** @typedef {{name: string, unit: string, digits: number, now: (now: any) => number, set: (now: any) => number, effort?: number}} Row */
  /** @type {Row[]} */ const tool = ['x', 'y', 'z'].map((name, k) => ({ name, unit: 'mm', digits: 1, now: (/** @type {any} */ now) => 1000 * now.tool[12 + k], set: (/** @type {any} */ now) => 1000 * now.setTool[12 + k] }));
  ['α about z', 'β about the new y', 'γ about the new x'].forEach((name, k) => tool.push({ name, unit: '°', digits: 2, now: (now) => now.euler[k], set: (now) => now.setEuler[k] }));
  /** @type {Row[]} */ const joints = [];
  let next = 0;
  scene.bodies.forEach((/** @type {any} */ body, /** @type {number} */ n) => {
    const { kind } = body.motion, parts = kind === 'ball' ? ['w', 'x', 'y', 'z'] : kind === 'fixed' ? [] : [''];
    const effort = has.efforts ? has.efforts.all.findIndex((/** @type {any} */ one) => one.body === n) : -1;
    for (const part of parts) {
      const at = next++, times = kind === 'turn' ? DEGREES : kind === 'slide' ? 1000 : 1;
      joints.push({ name: part ? `${body.name} ${part}` : body.name, unit: kind === 'turn' ? '°' : kind === 'slide' ? 'mm' : '', digits: kind === 'turn' ? 2 : kind === 'slide' ? 1 : 4, now: (now) => times * now.position(at), set: (now) => times * now.setPosition(at), ...(effort >= 0 ? { effort } : {}) });
    }
  });
  const driven = joints.some((row) => row.effort !== undefined);
  /** @type {{row: Row, cells: any[]}[]} */ const lines = [];
  const table = (/** @type {string} */ caption, /** @type {Row[]} */ rows, /** @type {boolean} */ efforts) => {
    const head = ['', 'now', ...(has.set ? ['set value', 'set − now'] : []), 'unit', ...(efforts ? ['actuator', 'of its largest'] : [])];
    const body = rows.map((row) => {
      const cells = head.slice(1).map((name) => R.make('td', name === 'unit' ? {} : { class: 'n' }));
      cells[head.indexOf('unit') - 1].textContent = row.unit;
      lines.push({ row, cells });
      return R.make('tr', {}, R.make('th', { scope: 'row' }, R.make('bdi', {}, row.name)), ...cells);
    });
    return R.make('table', {}, R.make('caption', {}, caption), R.make('thead', {}, R.make('tr', {}, ...head.map((name, n) => n ? R.make('th', { scope: 'col', ...(name === 'unit' ? {} : { class: 'n' }) }, name) : R.make('td')))), R.make('tbody', {}, ...body));
  };
  const clock = R.make('span');
  const place = R.make('div', { class: 'poses', role: 'region', 'aria-label': 'Pose', tabindex: '0' },
    R.make('p', { class: 'note' }, 'Pose at ', clock, '. Orientation of the tool: ZYX Euler angles, about z, then about the new y, then about the new x, in the frame of the world.'),
    table(`Tool: ${toolName}`, tool, false), joints.length ? table('Joints', joints, driven) : '');

  /** @param {{t: number, tool: ArrayLike<number>, setTool: ArrayLike<number>|null, position: (n: number) => number, setPosition: (n: number) => number, effort: (n: number) => number}} given */
  const write = (given) => {
    told = performance.now();
    const now = { ...given, euler: euler(given.tool), setEuler: given.setTool ? euler(given.setTool) : null };
    clock.textContent = `${R.time(given.t)} s`;
    for (const { row, cells } of lines) {
      const here = row.now(now), texts = [point(here, row.digits)];
      if (has.set) {
        const there = row.set(now), off = there - here;
        // Angles of an orientation are the same a turn later.
        texts.push(point(there, row.digits), point(row.unit === '°' && tool.includes(row) ? off - 360 * Math.round(off / 360) : off, row.digits));
      }
      texts.push(row.unit);
      if (row.effort !== undefined) {
        const x = now.effort(row.effort), { largest } = has.efforts.all[row.effort];
        texts.push(Number.isFinite(x) ? `${R.say(x, 4)} ${has.efforts.unit(row.effort)}` : '–', largest > 0 && Number.isFinite(x) ? `${point(100 * Math.abs(x) / largest, 0)} %` : '–');
      }
      texts.forEach((text, n) => { if (cells[n].textContent !== text) cells[n].textContent = text; });
    }
  };
  /** Writes what is given, or soon. @param {() => any} given What to write by then. */
  const tell = (given) => {
    clearTimeout(waiting);
    const left = told + READ - performance.now();
    if (left > 0) waiting = setTimeout(() => write(given()), left); else write(given());
  };
  return { place, tell, euler };
};
