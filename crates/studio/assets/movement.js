// @ts-check
'use strict';
// The mechanism of a run in 3D beside its scopes: where it is while the run goes on, and where it was at any instant before.
/* global R */

/** @type {any} */ (R).Movement = (() => {
  const { Desk } = /** @type {any} */ (R);
  /** The next picture waits at least so long, ms: scopes have to be drawn as well. */
  const PAUSE = 40;
  const view = R.view({ camera: R.camera(), id: 'movement-view', count: 'movement_frames', films: false, pause: PAUSE });
  /** @type {{resized: () => void}} */ let owner = { resized: () => {} };
  /** @type {any} */ const place = { all: null, view: null, notes: null, button: null };
  /** How many positions there are, and where the first of them stands among the columns. */ let count = 0, first = 0;
  /** Which positions have set values, whose columns stand behind theirs. @type {number[]} */ let sets = [];
  /** What the program has told of the mechanism, and how it stands before anything is known. @type {any} */ let known = null;
  /** @type {Float64Array[]} */ let start = [];
  /** What the view shows, as text; empty if it shows nothing. */ let built = '';
  /** Counts what was asked for. */ let asked = 0;
  /** Rows that came while nobody looked: times, positions, set values. @type {[Float64Array, Float64Array[], Float64Array[]|undefined]|null} */ let waiting = null;
  let wanted = true;
  /** Counts pasts: another run, or one that has gone back, has another path. */ let past = 0;

  const isSeen = () => !place.all.hidden && !place.all.closest('section')?.hidden;
  /** @param {(string|undefined|null)[]} all */
  const notes = (all) => place.notes.replaceChildren(...all.flatMap((text) => text ? [R.make('p', { class: 'note' }, text)] : []));
  /** There is something to see, or not. */
  const arrange = () => {
    const has = count > 0 || place.notes.childElementCount > 0;
    place.button.hidden = !has;
    place.button.setAttribute('aria-pressed', String(wanted));
    place.all.hidden = !has || !wanted;
    place.all.parentElement.classList.toggle('with-movement', has && wanted);
    owner.resized();
  };

  /** A run has begun. @param {any} told Its scopes. @param {number} column Where positions begin among the columns. */
  const begin = (told, column) => {
    [count, first, known, waiting] = [told.joints ?? 0, column, null, null];
    anew();
    sets = told.sets ?? [];
    notes([told.unseen]);
    if (!count) { built = ''; place.view.replaceChildren(); }
    place.view.hidden = !count;
    arrange();
    if (count) ask();
  };
  /** Asks for what is seen of the mechanism. */
  const ask = async () => {
    const own = ++asked;
    try {
      const told = await Desk.ask('space');
      if (own !== asked || !told.scene) return;
      const bytes = told.surfaces?.length ? await R.inflate(told.numbers) : null;
      if (own !== asked) return;
      // The same mechanism stays as somebody looks at it.
      known = { ...told, text: JSON.stringify([told.scene, told.numbers, sets]) };
      if (bytes) R.bytes = bytes;
      start = told.scene.bodies.flatMap((/** @type {any} */ body) => body.motion.kind === 'fixed' ? [] : body.start).map((/** @type {number} */ x) => Float64Array.of(x));
      notes([...place.notes.querySelectorAll('p')].map((note) => note.textContent).concat(told.warnings ?? []));
      show();
    } catch (error) {
      if (own === asked) fail(error);
    }
  };
  /** All else goes on without it. @param {any} error */
  const fail = (error) => {
    built = '';
    place.view.replaceChildren(R.make('p', { class: 'note' }, `The mechanism cannot be shown: ${error instanceof Error ? error.message : error}.`));
  };

  /** Builds the view, or brings it up to date, if somebody looks. */
  const show = () => {
    if (!known || !isSeen()) return;
    const [time, positions, set] = waiting ?? [Float64Array.of(0), start, sets.length ? start : undefined];
    try {
      if (known.text === built) { view.grow(time, positions, set, past); return; }
      place.view.replaceChildren();
      // The view marks what it has computed in the scene.
      view.build({ scene: structuredClone(known.scene), surfaces: known.surfaces ?? [], time, positions, set, contacts: [] });
      built = known.text;
    } catch (error) { fail(error); }
  };
  /** What was known of the past counts no more. */
  const anew = () => { past++; };
  /** Rows are known. @param {Float64Array[]} columns @param {number} rows */
  const grow = (columns, rows) => {
    if (!count) return;
    const of = (/** @type {number} */ at) => columns[at].subarray(0, rows);
    // What has no set value is where it should be.
    const set = (/** @type {number} */ n) => of(sets.includes(n) ? first + count + sets.indexOf(n) : first + n);
    const all = Array.from({ length: count }, (_, n) => n);
    waiting = rows ? [of(0), all.map((n) => of(first + n)), sets.length ? all.map(set) : undefined] : null;
    show();
  };

  /** @param {HTMLElement} tools Where the button stands that shows and hides it. @param {typeof owner} given */
  const build = (tools, given) => {
    owner = given;
    place.all = document.getElementById('movement');
    place.view = R.make('div', { id: 'movement-view' });
    place.notes = R.make('div', {});
    place.all.append(place.view, place.notes);
    place.button = Desk.button('3D', () => { wanted = !wanted; arrange(); show(); }, { title: 'Show or hide the mechanism' });
    tools.append(place.button);
    arrange();
  };
  return { build, begin, anew, grow, show, view };
})();
