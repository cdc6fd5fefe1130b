// @ts-check
'use strict';
// The panel that a diagram declares: sliders, knobs, switches and buttons that change a run, gauges and lamps that show it.
/* global R */

/** @type {any} */ (R).Panel = (() => {
  const { Desk } = /** @type {any} */ (R);
  const SVG = 'http://www.w3.org/2000/svg';
  /** Changes of a slider are sent no more often than this, ms; screen readers hear of gauges no more often than that. */
  const SEND = 60, HEAR = 250;
  let known = '', model = '';
  /** What was turned of other models of the project, by the text of the element. @type {Map<string, Map<string, any>>} */ const others = new Map();
  /** @type {any[]} */ let elements = [];
  /** @type {any} */ let place = null;
  /** @type {{running: () => boolean, set: (set: string) => void}} */ let run = { running: () => false, set: () => {} };

  /** @param {string} name @param {Record<string, string>} attributes @param {Element[]} children */
  const svg = (name, attributes, ...children) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };
  /** A point of a circle of radius 30 around 36, 36; `share` goes from lower left to lower right. @param {number} share @param {number} [radius] */
  const point = (share, radius = 30) => {
    const angle = (135 + 270 * share) * Math.PI / 180;
    return [36 + radius * Math.cos(angle), 36 + radius * Math.sin(angle)].map((x) => x.toFixed(2));
  };
  /** The way from one share to another. @param {number} from @param {number} to */
  const arc = (from, to) => `M${point(from)} A30 30 0 ${270 * (to - from) > 180 ? 1 : 0} 1 ${point(to)}`;
  /** A number with its unit. @param {number} value @param {string} unit */
  const told = (value, unit) => `${R.say(value)} ${unit}`.trim();
  /** A value of a text as people write it. @param {string} text */
  const pretty = (text) => text.replaceAll('*', '·').replaceAll('deg', '°');

  /** What every element has: its name, a line for what came of a change, what it stands on; whether a run has still to answer what was
   * sent, and since when the run has it so. @param {any} item */
  const base = (item) => ({ item, name: item.name, label: item.label ?? item.name, note: R.make('div', { class: 'note', role: 'status' }), waits: false, since: /** @type {number|null|undefined} */ (null) });
  /** Sends a value, or keeps it for the next run. @param {any} element @param {string} text */
  const send = (element, text) => {
    element.note.classList.remove('bad');
    element.sent = text;
    element.waits = run.running();
    if (element.waits) { element.note.textContent = ''; run.set(`${element.name}=${text}`); } else {
      element.note.textContent = element.isWritten() ? '' : 'for the next run';
      // Whatever that one tells of it is new.
      element.since = undefined;
    }
    again();
  };

  /** A number that moves along a range: what sliders and knobs share. @param {any} item */
  const number = (item) => {
    const [low, high] = item.range, unit = item.unit, wide = high - low;
    const digits = Math.max(0, 3 - Math.floor(Math.log10(wide)));
    const element = /** @type {any} */ (base(item));
    const field = R.make('input', { type: 'text', size: '8', 'aria-label': `${element.label}${unit ? `, ${unit}` : ''}`, spellcheck: 'false', inputmode: 'decimal' });
    let wait = 0;
    /** Rounded as finely as a hand can choose. @param {number} value */
    const round = (value) => Number(Math.min(Math.max(value, low), high).toFixed(Math.min(digits, 15)));
    element.value = item.value;
    element.isWritten = () => element.value === item.value;
    element.text = () => `${element.value} ${unit}`.trim();
    element.say = () => told(element.value, item.shown);
    /** @param {number} value @param {boolean} now Whether it is sent at once. */
    element.set = (value, now) => {
      element.value = value;
      element.waits = true;
      field.value = String(value);
      element.shown();
      clearTimeout(wait);
      wait = setTimeout(() => send(element, element.text()), now ? 0 : SEND);
    };
    element.now = () => ({ value: element.value });
    /** Whether this is told of the element. @param {any} now */
    element.isMeant = (now) => now.name === item.name && now.unit === unit;
    /** @param {any} now */
    element.isAt = (now) => element.value === now.value;
    /** Stands where the run is, or as it is written, and sends nothing. @param {any} now */
    element.adopt = (now) => {
      element.value = now?.value ?? item.value;
      field.value = String(element.value);
      element.shown();
      element.note.textContent = '';
    };
    element.reset = () => element.set(item.value, true);
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      if (event.key === 'Escape') { field.value = String(element.value); element.note.textContent = ''; element.note.classList.remove('bad'); }
      if (event.key !== 'Enter') return;
      let typed = field.value.trim().replace(/^([+-]?\d+),(\d+)/, '$1.$2');
      if (unit && typed.endsWith(unit)) typed = typed.slice(0, -unit.length).trim();
      const value = typed === '' ? NaN : Number(typed);
      const bad = !Number.isFinite(value) ? `${field.value || 'nothing'} is not a number${unit ? ` in ${unit}` : ''}` : value < low || value > high ? `${told(value, unit)} is not within the range from ${R.say(low)} to ${told(high, unit)}` : '';
      element.note.textContent = bad;
      element.note.classList.toggle('bad', bad !== '');
      if (!bad) element.set(value, true);
    });
    /** What a key does to it. @param {KeyboardEvent} event */
    element.key = (event) => {
      const by = { ArrowRight: 0.01, ArrowUp: 0.01, ArrowLeft: -0.01, ArrowDown: -0.01, PageUp: 0.1, PageDown: -0.1 }[event.key];
      const to = by !== undefined ? element.value + by * wide * (event.shiftKey ? 0.1 : 1) : event.key === 'Home' ? low : event.key === 'End' ? high : null;
      if (to === null || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      element.set(round(to), false);
    };
    element.share = () => Math.min(Math.max((element.value - low) / wide, 0), 1);
    Object.assign(element, { low, high, round, field });
    return element;
  };

  const slider = (/** @type {any} */ item) => {
    const element = number(item);
    const line = R.make('input', { type: 'range', min: String(element.low), max: String(element.high), step: 'any', 'aria-label': element.label });
    element.shown = () => { line.value = String(element.value); line.setAttribute('aria-valuetext', element.say()); };
    line.addEventListener('input', () => element.set(element.round(Number(line.value)), false));
    line.addEventListener('keydown', element.key);
    element.row = R.make('div', { class: 'element slider' }, R.make('bdi', { title: item.name }, element.label), R.make('span', { class: 'amount' }, element.field, R.make('span', { class: 'unit' }, item.shown)), line, element.note);
    element.focus = line;
    element.adopt(undefined);
    return element;
  };

  const knob = (/** @type {any} */ item) => {
    const element = number(item);
    const way = svg('path', { class: 'knob-way' }), pin = svg('path', { class: 'knob-pin' });
    const dial = R.make('div', { class: 'dial', role: 'slider', tabindex: '0', 'aria-label': element.label, 'aria-valuemin': String(element.low), 'aria-valuemax': String(element.high), title: 'Drag up and down, or use the arrow keys; a double click goes back to the written value' },
      svg('svg', { viewBox: '0 0 72 66', 'aria-hidden': 'true' }, svg('path', { class: 'knob-track', d: arc(0, 1) }), way, svg('circle', { class: 'knob-body', cx: '36', cy: '36', r: '22' }), pin));
    element.shown = () => {
      const share = element.share();
      way.setAttribute('d', share > 0.001 ? arc(0, share) : '');
      pin.setAttribute('d', `M${point(share, 10)} L${point(share, 21)}`);
      dial.setAttribute('aria-valuenow', String(element.value));
      dial.setAttribute('aria-valuetext', element.say());
    };
    dial.addEventListener('keydown', element.key);
    dial.addEventListener('dblclick', () => element.reset());
    dial.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
      if (event.button !== 0) return;
      dial.setPointerCapture(event.pointerId);
      let y = event.clientY, value = element.value;
      const move = (/** @type {PointerEvent} */ to) => {
        value += (y - to.clientY) / 160 * (element.high - element.low) * (to.shiftKey ? 0.1 : 1);
        y = to.clientY;
        if (element.round(value) !== element.value) element.set(element.round(value), false);
      };
      dial.addEventListener('pointermove', move);
      for (const end of ['pointerup', 'pointercancel']) dial.addEventListener(end, () => dial.removeEventListener('pointermove', move), { once: true });
    });
    element.row = R.make('div', { class: 'element knob-element' }, R.make('bdi', { title: item.name }, element.label), dial, R.make('span', { class: 'amount' }, element.field, R.make('span', { class: 'unit' }, item.shown)), element.note);
    element.focus = dial;
    element.adopt(undefined);
    return element;
  };

  /** What switches and buttons share: two values. @param {any} item */
  const two = (item) => {
    const element = /** @type {any} */ (base(item));
    element.isOn = item.isOn;
    element.isWritten = () => element.isOn === item.isOn;
    element.text = () => element.isOn ? item.on : item.off;
    /** @param {boolean} on */
    element.set = (on) => { element.isOn = on; element.shown(); send(element, element.text()); };
    element.now = () => ({ isOn: element.isOn });
    /** @param {any} now */
    element.isMeant = (now) => now.name === item.name && now.off === item.off && now.on === item.on;
    /** @param {any} now */
    element.isAt = (now) => element.isOn === now.isOn;
    /** @param {any} now */
    element.adopt = (now) => { element.isOn = now?.isOn ?? item.isOn; element.shown(); element.note.textContent = ''; };
    element.reset = () => element.set(item.isOn);
    return element;
  };
  const switched = (/** @type {any} */ item) => {
    const element = two(item), plain = item.off === 'false' && item.on === 'true';
    const state = R.make('span', { class: 'switch-state' });
    const button = R.make('button', { type: 'button', role: 'switch', class: 'switch', 'aria-label': element.label }, R.make('span', { class: 'switch-body', 'aria-hidden': 'true' }), state);
    element.shown = () => {
      button.setAttribute('aria-checked', String(element.isOn));
      state.textContent = plain ? element.isOn ? 'on' : 'off' : pretty(element.text());
    };
    button.addEventListener('click', () => element.set(!element.isOn));
    element.row = R.make('div', { class: 'element' }, R.make('bdi', { title: item.name }, element.label), button, element.note);
    element.focus = button;
    element.adopt(undefined);
    return element;
  };
  const pushed = (/** @type {any} */ item) => {
    const element = two(item);
    const button = R.make('button', { type: 'button', class: 'push', 'aria-pressed': 'false', title: `${item.name} is ${item.on} as long as it is pressed` }, R.make('bdi', {}, element.label));
    element.shown = () => button.setAttribute('aria-pressed', String(element.isOn));
    /** @param {boolean} on */
    const press = (on) => {
      if (element.isOn === on) return;
      if (on && !run.running()) { element.note.textContent = 'acts while a run goes on'; return; }
      element.set(on);
    };
    button.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => { if (event.button === 0) { button.setPointerCapture(event.pointerId); press(true); } });
    for (const end of ['pointerup', 'pointercancel', 'blur']) button.addEventListener(end, () => press(false));
    button.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if ((event.key === ' ' || event.key === 'Enter') && !event.ctrlKey && !event.metaKey) { event.preventDefault(); if (!event.repeat) press(true); } });
    button.addEventListener('keyup', (/** @type {KeyboardEvent} */ event) => { if (event.key === ' ' || event.key === 'Enter') { event.preventDefault(); press(false); } });
    element.row = R.make('div', { class: 'element' }, button, element.note);
    element.focus = button;
    element.adopt(undefined);
    return element;
  };

  /** A gauge without a range is a number. @param {any} item */
  const gauge = (item) => {
    const element = /** @type {any} */ (base(item)), range = item.range;
    const amount = R.make('b', {}, '–'), side = R.make('span', { class: 'note' });
    const needle = svg('path', { class: 'gauge-needle' }), way = svg('path', { class: 'gauge-way' });
    const meter = R.make('div', { class: 'meter', role: 'meter', 'aria-label': element.label, ...(range ? { 'aria-valuemin': String(range[0]), 'aria-valuemax': String(range[1]) } : {}) },
      ...(range ? [svg('svg', { viewBox: '0 0 72 66', 'aria-hidden': 'true' }, svg('path', { class: 'gauge-track', d: arc(0, 1) }), way, needle, svg('circle', { class: 'gauge-hub', cx: '36', cy: '36', r: '3' }))] : []));
    let heard = 0;
    element.show = (/** @type {number} */ x) => {
      amount.textContent = R.say(x, 4);
      if (range) {
        const share = Number.isFinite(x) ? (x - range[0]) / (range[1] - range[0]) : 0, inside = Math.min(Math.max(share, 0), 1);
        const zero = Math.min(Math.max(-range[0] / (range[1] - range[0]), 0), 1), [from, to] = inside < zero ? [inside, zero] : [zero, inside];
        way.setAttribute('d', to - from > 0.001 ? arc(from, to) : '');
        needle.setAttribute('d', `M36 36 L${point(inside, 27)}`);
        side.textContent = share > 1 ? '▲ above' : share < 0 ? '▼ below' : '';
        meter.classList.toggle('beyond', side.textContent !== '');
      }
      if (performance.now() - heard < HEAR) return;
      heard = performance.now();
      meter.setAttribute('aria-valuenow', String(Number.isFinite(x) ? x : 0));
      meter.setAttribute('aria-valuetext', `${told(x, item.unit)} ${side.textContent}`.trim());
    };
    element.quiet = () => { amount.textContent = '–'; };
    element.row = R.make('div', { class: 'element gauge' }, R.make('bdi', { title: item.name }, element.label), meter, R.make('span', { class: 'amount' }, amount, R.make('span', { class: 'unit' }, item.unit), side));
    return element;
  };
  const lamp = (/** @type {any} */ item) => {
    const element = /** @type {any} */ (base(item)), light = R.make('span', { class: 'lamp', role: 'img' }), word = R.make('span', {}, '–');
    element.show = (/** @type {number} */ x) => {
      const on = x !== 0 && !Number.isNaN(x);
      if (light.classList.contains('lit') === on && word.textContent !== '–') return;
      light.classList.toggle('lit', on);
      word.textContent = on ? 'on' : 'off';
      light.setAttribute('aria-label', `${element.label}: ${word.textContent}`);
    };
    element.quiet = () => { word.textContent = '–'; light.classList.remove('lit'); light.setAttribute('aria-label', `${element.label}: not known`); };
    element.quiet();
    element.row = R.make('div', { class: 'element lamp-element' }, light, R.make('bdi', { title: item.name }, element.label), word);
    return element;
  };

  const MAKE = /** @type {Record<string, (item: any) => any>} */ ({ Slider: slider, Knob: knob, Switch: switched, Button: pushed, Gauge: gauge, Lamp: lamp });
  const turned = () => elements.filter((element) => element.set);
  /** Whether there is something to take back. */
  const again = () => { if (place.again) place.again.hidden = turned().every((element) => element.isWritten()); };

  /** Shows the panel of a model. What was turned stays with its model, where that says the same of it. @param {any[]} items @param {string} of The model. */
  const renew = (items, of) => {
    const text = JSON.stringify([of, items]);
    if (text === known || !place) return;
    known = text;
    others.set(model, new Map(turned().filter((element) => !element.isWritten()).map((element) => [JSON.stringify(element.item), element.now()])));
    model = of;
    elements = items.map((item) => MAKE[item.kind](item));
    for (const element of turned()) { const now = others.get(model)?.get(JSON.stringify(element.item)); if (now) element.adopt(now); }
    place.again = Desk.button('As written', () => { for (const element of turned()) if (!element.isWritten()) element.reset(); }, { title: 'All controls back to the values of the model' });
    place.view.replaceChildren(...(elements.length ? [R.make('h2', {}, 'Panel'), ...elements.map((element) => element.row), place.again] : []));
    place.view.closest('.run-parts').classList.toggle('with-panel', elements.length > 0);
    again();
  };

  /** @param {HTMLElement} view @param {{running: () => boolean, set: (set: string) => void}} owner */
  const build = (view, owner) => { place = { view, again: null }; run = owner; };
  /** What came of a change. @param {any} told */
  const tuned = ({ t, set, refused, help, without_effect: lost }) => {
    const [name, ...rest] = set.split('=');
    // What has been turned on since has an answer of its own.
    for (const element of turned().filter((one) => one.name === name && one.sent === rest.join('='))) {
      element.waits = false;
      if (!refused) element.since = t;
      element.note.textContent = refused ? [refused, help].filter(Boolean).join(' – ') : lost?.length ? `values at the start of ${lost.join(', ')} have no effect any more` : since(t);
      element.note.classList.toggle('bad', Boolean(refused));
    }
  };
  /** @param {number|null} t */
  const since = (t) => t === null ? '' : `since ${R.say(t)} s`;
  /** Shows the present values of the signals of the panel, in its order. @param {number[]} values */
  const show = (values) => { let n = 0; for (const element of elements) if (element.show && n < values.length) element.show(values[n++]); };
  const quiet = () => { for (const element of elements) element.quiet?.(); };
  /** What differs from the model, as `--set` takes it. @returns {string[]} */
  const settings = () => turned().filter((element) => !element.isWritten()).map((element) => `${element.name}=${element.text()}`);
  /** All controls stand where the run does, but for those whose change is still on its way to it.
   * @param {any[]} standing What the run tells of its controls. @param {Map<string, {t: number|null}>} changed When parameters were set last. */
  const stand = (standing, changed) => {
    for (const element of turned()) {
      const now = standing.find(element.isMeant), t = changed.get(element.name)?.t ?? null;
      if (!now || element.waits) continue;
      if (!element.isAt(now)) element.adopt(now); else if (element.since === t) continue;
      element.since = t;
      element.note.textContent = since(t);
      element.note.classList.remove('bad');
    }
    again();
  };
  /** No run answers any more what was sent. */
  const settle = () => { for (const element of turned()) element.waits = false; };
  const focus = () => elements.find((element) => element.focus)?.focus.focus();
  return { build, renew, tuned, show, quiet, settings, stand, settle, focus, elements: () => elements };
})();
