// @ts-check
'use strict';
// The moves of a sequence: listed with their targets, times and troubles; added, copied, removed, moved up and down by mouse and by keys.
/* global R */

/** @type {any} */ (R).Sequence = (() => {
  const { Desk } = /** @type {any} */ (R);
  const KINDS = /** @type {Record<string, string>} */ ({ joint: 'joint', linear: 'line', circular: 'arc' });
  /** Changes of the list that can be taken back. */
  const KEPT = 100;
  /** @type {any} The planner that the list belongs to. */ let owner = null;
  let chosen = 0, present = -1;
  /** @type {{list: any[], chosen: number}[]} */ let done = [];
  /** @type {any[]} What is known of each move: when it begins, how long it takes, and between which poses it goes. */ let steps = [];
  /** @type {Map<number, string>} What is wrong with a move. */ let wrong = new Map();
  /** @type {any} */ const place = { list: null, strip: null, count: null, undo: null, remove: null, up: null, down: null };

  /** @returns {any[]} */
  const moves = () => owner?.typed().moves ?? [];
  const index = () => Math.min(chosen, moves().length - 1);
  const move = () => moves()[index()];
  const short = (/** @type {number} */ x, digits = 2) => x.toFixed(digits).replace('-', '−');
  /** A value with the unit of its field, unless it has one. @param {string} text @param {string} unit */
  const united = (text, unit) => text.trim() && !/[a-z°%]/i.test(text) ? `${text.trim()} ${unit}` : text.trim();

  /** A move in words. @param {any} one */
  const words = (one) => {
    const isJoint = one.kind === 'joint', target = (isJoint ? one.to : one.point).map((/** @type {string} */ text) => text.trim() || '?').join(isJoint ? ' / ' : ', ');
    const stay = [one.zone?.trim() ? `rounded ${united(one.zone, 'mm')}` : '', one.wait?.trim() ? `then waits ${united(one.wait, 's')}` : ''].filter(Boolean);
    return [`to ${target}${isJoint ? '' : ' mm'}`, united(isJoint ? one.velocity : one.speed, isJoint ? '%' : 'mm/s'), ...stay].filter(Boolean).join(', ');
  };

  /** Lists the moves as they are typed now. */
  const show = () => {
    if (!place.list) return;
    const all = moves();
    place.list.replaceChildren(...all.map((one, n) => {
      const time = steps[n] ? `${short(steps[n].duration)} s` : '', bad = wrong.get(n);
      const row = R.make('li', { role: 'option', id: `move-${n}`, 'aria-selected': String(n === index()), class: bad ? 'wrong-move' : '' },
        R.make('span', { class: 'number' }, `${bad ? '✕ ' : ''}${n + 1}`), R.make('span', { class: 'kind' }, KINDS[one.kind]), R.make('span', { class: 'goes' }, words(one)), R.make('span', { class: 'takes' }, time), ...(bad ? [R.make('span', { class: 'bad why' }, bad)] : []));
      row.addEventListener('click', () => { choose(n); place.list.focus(); });
      return row;
    }));
    place.list.setAttribute('aria-activedescendant', `move-${index()}`);
    const waits = all.filter((one) => one.wait?.trim()).length;
    place.count.textContent = `${all.length} ${all.length === 1 ? 'move' : 'moves'}${waits ? `, ${waits} ${waits === 1 ? 'wait' : 'waits'}` : ''}`;
    place.remove.disabled = all.length < 2;
    place.up.disabled = index() === 0;
    place.down.disabled = index() === all.length - 1;
    place.undo.disabled = !done.length;
    mark();
  };
  /** The parts of the time line, one for each move. @param {number} whole */
  const line = (whole) => {
    const begins = steps.map((step) => step.begin ?? 0);
    place.strip.hidden = begins.length < 2;
    place.strip.replaceChildren(...begins.map((begin, n) => {
      const part = Desk.button(String(n + 1), () => choose(n), { title: `Move ${n + 1} begins at ${short(begin)} s`, 'aria-label': `To move ${n + 1}, at ${short(begin)} s` });
      part.style.flexGrow = String(Math.max((begins[n + 1] ?? whole) - begin, 0));
      return part;
    }));
    present = -1;
    at(R.now);
  };
  /** Marks the move that runs at a time. @param {number} t */
  const at = (t) => {
    if (owner?.typed().kind !== 'sequence' || !steps.length || steps.some((step) => step.begin === null)) return;
    const now = steps.reduce((last, step, n) => step.begin <= t + 1e-9 ? n : last, 0);
    if (now === present) return;
    present = now;
    mark();
  };
  const mark = () => {
    [...place.list.children].forEach((row, n) => { row.classList.toggle('present', n === present); if (n === present) row.setAttribute('aria-current', 'step'); else row.removeAttribute('aria-current'); });
    [...place.strip.children].forEach((part, n) => { part.classList.toggle('present', n === present); part.classList.toggle('chosen', n === index()); });
  };

  /** Brings a move into the fields. @param {number} n @param {boolean} [stays] Whether the time stays. */
  const choose = (n, stays) => {
    chosen = Math.min(Math.max(n, 0), moves().length - 1);
    owner.chosen();
    show();
    document.getElementById(`move-${chosen}`)?.scrollIntoView({ block: 'nearest' });
    const begin = steps[chosen]?.begin;
    if (!stays && typeof begin === 'number') R.setTime(begin);
  };
  /** Another list, which can be taken back. @param {any[]} list @param {number} n @param {string} told */
  const change = (list, n, told) => {
    done.push({ list: [...moves()], chosen: index() });
    done = done.slice(-KEPT);
    set(list, n, told);
  };
  const set = (/** @type {any[]} */ list, /** @type {number} */ n, /** @type {string} */ told) => {
    owner.typed().moves = list;
    steps = [];
    wrong = new Map();
    choose(n, true);
    owner.look();
    Desk.say(told);
  };
  const add = () => { const n = index() + 1; change(moves().toSpliced(n, 0, owner.next(move(), steps[n - 1]?.to)), n, `move ${n + 1} is added`); };
  const copy = () => { const n = index() + 1; change(moves().toSpliced(n, 0, structuredClone(move())), n, `move ${n} is duplicated`); };
  const remove = () => {
    const n = index();
    if (moves().length < 2) { Desk.say('a sequence has at least one move', true); return; }
    change(moves().toSpliced(n, 1), Math.min(n, moves().length - 2), `move ${n + 1} is removed`);
  };
  /** @param {number} by */
  const shift = (by) => {
    const n = index(), to = n + by;
    if (to < 0 || to >= moves().length) return;
    change(moves().toSpliced(n, 1).toSpliced(to, 0, move()), to, `move ${n + 1} is move ${to + 1} now`);
  };
  const undo = () => {
    const last = done.pop();
    if (last) set(last.list, last.chosen, 'the list is as before'); else Desk.say('nothing of the list can be taken back');
  };

  /** @param {KeyboardEvent} event */
  const key = (event) => {
    const held = event.ctrlKey || event.metaKey, letter = event.key.toLowerCase();
    const does = held ? /** @type {any} */ ({ d: copy, z: undo })[letter]
      : event.altKey ? /** @type {any} */ ({ ArrowUp: () => shift(-1), ArrowDown: () => shift(1) })[event.key]
        : /** @type {any} */ ({ ArrowUp: () => choose(index() - 1), ArrowDown: () => choose(index() + 1), Home: () => choose(0), End: () => choose(moves().length - 1), Insert: add, '+': add, Delete: remove, Enter: () => owner.focus() })[event.key];
    if (!does) return;
    event.preventDefault();
    event.stopPropagation();
    does();
  };

  /** Makes the list. @param {HTMLElement} view @param {HTMLElement} strip Below the time. @param {any} given */
  const build = (view, strip, given) => {
    owner = given;
    done = [];
    place.strip = strip;
    place.list = R.make('ol', { class: 'moves', role: 'listbox', tabindex: '0', 'aria-label': 'Moves of the sequence', 'aria-describedby': 'moves-keys' });
    place.list.addEventListener('keydown', key);
    place.count = R.make('b', {});
    place.remove = Desk.button('Remove', remove, { title: 'Remove the selected move (Delete)' });
    place.up = Desk.button('Up', () => shift(-1), { title: 'One place up (Alt and arrow)' });
    place.down = Desk.button('Down', () => shift(1), { title: 'One place down (Alt and arrow)' });
    place.undo = Desk.button('Undo', undo, { title: 'Take the last change of the list back (Ctrl Z)', 'aria-label': 'Undo the last change of the list' });
    view.replaceChildren(R.make('div', { class: 'moves-bar' }, place.count, Desk.button('Add', add, { title: 'Add a move behind the selected one (Insert)' }), Desk.button('Duplicate', copy, { title: 'Duplicate the selected move (Ctrl D)' }), place.remove, place.up, place.down, place.undo),
      place.list, R.make('p', { class: 'note', id: 'moves-keys' }, 'In the list: arrows select, with Alt they move; Insert adds, Ctrl D duplicates, Delete removes, Enter goes to the fields.'));
  };
  /** What planning has come to. @param {any[]} known @param {Map<number, string>} bad @param {number|null} whole Time of all moves, s. */
  const tell = (known, bad, whole) => {
    // What a refused sequence has no times for keeps none.
    steps = known;
    wrong = bad;
    show();
    if (whole === null) place.strip.hidden = true; else line(whole);
  };
  /** A list that was loaded. */
  const renew = () => { chosen = 0; done = []; steps = []; wrong = new Map(); };
  return { build, show, tell, at, choose, renew, move, index, step: (/** @type {number} */ n) => steps[n], present: () => present };
})();
