// @ts-check
'use strict';
// Linear analysis: poles that move with a slider, magnitude and phase, the response in the complex plane, the response to a step.
/* global R */

/** @type {any} */ (R).Linear = (() => {
  const { Desk, Charts } = /** @type {any} */ (R);
  /** Wait behind the last key or turn before the model is analysed anew, ms. */
  const WAIT = 120;
  /** @type {any} */ const place = {};
  let version = -1, wait = 0, asked = 0;
  /** @type {any} */ let found = null;
  /** Poles that were seen while the slider moved, the last ones. @type {number[][]} */ let trail = [];
  /** Poles over the range of the slider. @type {any} */ let locus = null;
  /** @type {any[]} */ let drawn = [];

  /** @param {string} label @param {HTMLElement} input @param {string} [hint] */
  const field = (label, input, hint) => R.make('label', { class: 'field' }, R.make('span', {}, label), input, R.make('span', { class: 'note' }, hint ?? ''));
  /** @param {string} label @param {string} value @param {string} [list] */
  const entry = (label, value, list) => {
    const input = R.make('input', { type: 'text', value, spellcheck: 'false', size: '24', 'aria-label': label, ...(list ? { list } : {}) });
    input.addEventListener('input', () => later(true));
    return input;
  };
  const what = () => ({ from: place.from.value, to: place.to.value, open: place.open.value, at: place.at.value, steady: place.steady.checked, sampled: place.sampled.checked });
  /** The parameter of the slider and its range. */
  const varied = () => {
    const name = place.name.value.trim(), [low, high] = [place.low.value, place.high.value].map((text) => Number(text.trim().replace(',', '.')));
    return name && Number.isFinite(low) && Number.isFinite(high) && high > low ? { name, low, high, unit: place.unit.value.trim() } : null;
  };
  const value = () => {
    const vary = varied();
    if (!vary) return null;
    const by = Number(place.slider.value) / 1000;
    // Over ranges of more than a decade a gain is turned by factors.
    const x = place.log.checked && vary.low > 0 ? vary.low * (vary.high / vary.low) ** by : vary.low + (vary.high - vary.low) * by;
    return `${Number(x.toPrecision(4))} ${vary.unit}`.trim();
  };

  /** Asks anew a little later. @param {boolean} whole Whether more than the slider has changed. */
  const later = (whole) => {
    if (whole) { locus = null; trail = []; }
    const now = value();
    place.value.textContent = now ?? '';
    place.slider.disabled = now === null;
    place.slider.setAttribute('aria-valuetext', now ?? '');
    clearTimeout(wait);
    wait = setTimeout(ask, WAIT);
  };
  const ask = async () => {
    const number = ++asked, now = value(), vary = varied();
    place.told.classList.remove('bad');
    place.told.textContent = '…';
    const set = now === null || !vary ? [] : [`${vary.name}=${now}`];
    let answer;
    try { answer = await Desk.ask('linear', { ...what(), set }); } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      if (number !== asked) return;
      // What was found last stays, and is shown as such.
      place.told.textContent = [message, why?.help].filter(Boolean).join(' – ');
      place.told.classList.add('bad');
      place.view.classList.add('old');
      return;
    }
    if (number !== asked) return;
    found = answer;
    const { poles, closed, way } = shown();
    trail.push(...(way?.margins ? closed : poles.map((/** @type {any} */ one) => one.pole)));
    trail = trail.slice(-600);
    place.view.classList.remove('old');
    show();
  };
  /** Where the poles go over the whole range of the slider. */
  const follow = async () => {
    const vary = varied();
    if (!vary) { place.told.textContent = 'name a parameter and its range first'; return; }
    const range = `${vary.name}=${vary.low}..${vary.high} ${vary.unit}`.trim() + `/41${place.log.checked && vary.low > 0 ? 'log' : ''}`;
    place.told.textContent = 'the poles are followed over the range …';
    try { locus = (await Desk.ask('linear', { at: place.at.value, steady: place.steady.checked, sampled: place.sampled.checked, locus: range })).locus; show(); } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      place.told.textContent = [message, why?.help].filter(Boolean).join(' – ');
      place.told.classList.add('bad');
    }
  };

  /** What is looked at: the way from a signal to another one, or the whole model. @returns {any} */
  const shown = () => {
    const way = found.ways[0];
    return way ? { poles: way.poles, zeros: way.zeros ?? [], closed: way.margins?.closed_poles ?? [], way } : { poles: found.poles, zeros: [], closed: [], way: null };
  };
  const show = () => {
    const { poles, zeros, closed, way } = shown(), sampled = found.period !== null;
    for (const u of drawn) u.destroy();
    drawn = [];
    place.charts.replaceChildren();
    const number = (/** @type {number[]} */ [re, im]) => `${R.say(re, 4)}${im ? ` ${im < 0 ? '−' : '+'} ${R.say(Math.abs(im), 4)}j` : ''}`;
    const marks = [
      ...(locus?.points ?? []).flatMap((/** @type {any} */ point) => point.poles.map((/** @type {number[]} */ [x, y]) => ({ x, y, sign: 'dot', name: `at ${point.value}`, look: 'path' }))),
      ...trail.map(([x, y]) => ({ x, y, sign: 'dot', name: 'before', look: 'before' })),
      ...closed.map((/** @type {number[]} */ z) => ({ x: z[0], y: z[1], sign: 'plus', name: `pole of the closed loop ${number(z)}` })),
      ...zeros.map((/** @type {number[]} */ z) => ({ x: z[0], y: z[1], sign: 'ring', name: `zero ${number(z)}` })),
      ...poles.map((/** @type {any} */ { pole }) => ({ x: pole[0], y: pole[1], sign: 'cross', name: `pole ${number(pole)}` })),
    ];
    const circle = Array.from({ length: 121 }, (_, n) => [Math.cos(n * Math.PI / 60), Math.sin(n * Math.PI / 60)]);
    const stable = (/** @type {number[]} */ [re, im]) => sampled ? Math.hypot(re, im) < 1 : re < 0;
    const unstable = (way?.margins ? closed : poles.map((/** @type {any} */ { pole }) => pole)).filter((/** @type {number[]} */ z) => !stable(z)).length;
    const chart = (/** @type {string} */ title, /** @type {Element} */ drawing, /** @type {string} */ note) => place.charts.append(R.make('figure', { class: 'card' }, R.make('figcaption', {}, R.make('span', { class: 'title' }, title), R.make('span', { class: 'note' }, note)), drawing));
    const seen = marks.filter((mark) => mark.look !== 'path' || marks.length < 5000);
    const [x0, x1] = Charts.around([...seen.map((mark) => mark.x), ...(sampled ? [-1, 1] : [0])]), [y0, y1] = Charts.around([...seen.map((mark) => mark.y), ...(sampled ? [-1, 1] : [])]);
    chart('Poles and zeros', Charts.plane({ label: `${poles.length} poles, ${zeros.length} zeros; ${unstable ? `${unstable} not stable` : 'stable'}`, axes: sampled ? ['real part of z', 'imaginary part of z'] : ['real part [rad/s]', 'imaginary part [rad/s]'], equal: sampled, marks, lines: sampled ? [{ points: circle, look: 'limit' }] : [], range: [x0, x1, y0, y1] }),
      `✕ poles${zeros.length ? ', ○ zeros' : ''}${closed.length ? ', + of the closed loop' : ''}${locus ? ', coloured dots: over the range' : ''}${trail.length > poles.length ? ', grey dots: before' : ''}`);
    const curves = way?.curves;
    if (curves?.frequency.length) {
      const x = curves.frequency, row = R.make('div', {});
      place.charts.append(row);
      drawn.push(Charts.curves(row, { title: 'Magnitude [dB]', x, series: [{ name: 'magnitude', values: curves.magnitude }], log: true, across: 'frequency [rad/s]' }), Charts.curves(row, { title: 'Phase [°]', x, series: [{ name: 'phase', values: curves.phase }], log: true, across: 'frequency [rad/s]' }));
      const points = curves.response, mirrored = points.map((/** @type {number[]} */ [re, im]) => [re, -im]), loop = Boolean(way.margins);
      // An integrator goes on without end: what is near the critical point counts.
      const sizes = points.map((/** @type {number[]} */ z) => Math.hypot(...z)).filter(Number.isFinite), most = Math.max(...sizes), far = loop ? Math.min(most, way.static_gain === null ? 3 : 20) : most;
      const near = points.filter((/** @type {number[]} */ z) => Math.hypot(...z) <= far * 1.0001), [re0, re1] = Charts.around([...near.map((/** @type {number[]} */ z) => z[0]), ...(loop ? [-1.3, 1] : [0])]), [, im] = Charts.around([...near.map((/** @type {number[]} */ z) => Math.abs(z[1])), ...(loop ? [1] : [])]);
      chart('Nyquist', Charts.plane({ label: way.margins ? `loop gain in the complex plane; ${way.margins.stable ? 'stable' : 'unstable'} when closed` : 'response in the complex plane', axes: ['real part', 'imaginary part'], equal: true, range: [re0, re1, -im, im], lines: [...(loop ? [{ points: circle, look: 'limit' }] : []), { points: mirrored, look: 'curve dashed' }, { points, look: 'curve' }], marks: loop ? [{ x: -1, y: 0, sign: 'plus', name: 'critical point' }] : [] }), loop ? '+ critical point; dashed: frequencies below zero' : 'dashed: frequencies below zero');
      if (curves.step) {
        const under = R.make('div', {});
        place.charts.append(under);
        drawn.push(Charts.curves(under, { title: loop ? 'Step response of the closed loop' : 'Step response', x: curves.step.map((/** @type {number[]} */ point) => point[0]), series: [{ name: 'answer', values: curves.step.map((/** @type {number[]} */ point) => point[1]) }], across: 'time [s]', height: 240 }));
      }
    }
    facts(poles, way, unstable, number);
  };
  /** The same in numbers. @param {any[]} poles @param {any} way @param {number} unstable @param {(z: number[]) => string} number */
  const facts = (poles, way, unstable, number) => {
    const parts = [];
    const margins = way?.margins, db = (/** @type {number} */ x) => `${R.say(20 * Math.log10(x), 4)} dB`;
    if (margins) {
      const least = (/** @type {any[]} */ all, /** @type {(x: number) => number} */ size) => [...all].sort((a, b) => size(a.value) - size(b.value))[0];
      const gain = least(margins.gain, (x) => Math.abs(Math.log(x))), phase = least(margins.phase, Math.abs);
      parts.push(['closed loop', margins.stable ? 'stable' : 'unstable']);
      if (gain) parts.push(['gain margin', `${db(gain.value)} at ${R.say(gain.frequency, 4)} rad/s`]);
      if (phase) parts.push(['phase margin', `${R.say(phase.value * 180 / Math.PI, 4)}° at ${R.say(phase.frequency, 4)} rad/s`]);
      if (margins.delay) parts.push(['delay margin', `${R.say(margins.delay.value, 3)} s`]);
      parts.push(['sensitivity', `up to ${R.say(margins.sensitivity.value, 4)} at ${R.say(margins.sensitivity.frequency, 4)} rad/s`]);
    } else {
      parts.push([way ? 'this way' : 'the model', unstable ? `${unstable} of ${poles.length} poles do not die down` : 'stable']);
      if (way) parts.push(['static gain', way.static_gain === null ? 'infinite, it integrates' : R.say(way.static_gain, 5)]);
      if (way?.bandwidth) parts.push(['bandwidth', `${R.say(way.bandwidth, 4)} rad/s`]);
      if (way?.step) parts.push(['step', `overshoot ${R.say(100 * way.step.overshoot, 4)} %, rise ${R.say(way.step.rise, 3)} s, settling ${R.say(way.step.settling, 3)} s`]);
    }
    if (found.not_smooth?.length || found.stuck?.length || found.limited?.length) parts.push(['at this instant', [found.stuck?.length ? `stuck: ${found.stuck.join(', ')}` : '', found.limited?.length ? `at a limit: ${found.limited.join(', ')}` : '', found.not_smooth?.length ? `not smooth: ${found.not_smooth.length} places` : ''].filter(Boolean).join('; ')]);
    place.told.textContent = `${found.title}, at ${R.say(found.t)} s${found.period ? `, from hit to hit of ${R.say(found.period)} s` : ''}`;
    place.facts.replaceChildren(R.make('dl', { class: 'figures' }, ...parts.flatMap(([name, text]) => [R.make('dt', {}, name), R.make('dd', {}, text)])),
      Desk.table('Poles', ['pole [rad/s]', 'frequency [rad/s]', 'damping', 'time constant [s]'].map((head, n) => n === 0 && found.period ? 'pole, z' : head), poles.map((mode) => [number(mode.pole), R.say(mode.frequency, 4), R.say(mode.damping, 3), mode.time_constant === null ? '∞' : R.say(mode.time_constant, 4)])));
  };

  const build = () => {
    const view = document.getElementById('linear-view');
    if (!view) return false;
    place.signals = R.make('datalist', { id: 'linear-signals' });
    place.names = R.make('datalist', { id: 'linear-names' });
    place.from = entry('From', '', 'linear-signals');
    place.to = entry('To', '', 'linear-signals');
    place.open = entry('Open the loop at', '', 'linear-signals');
    place.at = entry('At', '0 s');
    const box = () => { const made = R.make('input', { type: 'checkbox' }); made.addEventListener('change', () => later(true)); return made; };
    [place.steady, place.sampled, place.log] = [box(), box(), box()];
    place.name = entry('Parameter', '', 'linear-names');
    place.name.addEventListener('change', () => suggest(place.name.value.trim()));
    [place.low, place.high, place.unit] = [entry('Lowest value', ''), entry('Highest value', ''), entry('Unit', '')];
    for (const one of [place.low, place.high, place.unit]) one.size = 7;
    place.slider = R.make('input', { type: 'range', min: '0', max: '1000', value: '500', 'aria-label': 'Value of the parameter' });
    place.slider.addEventListener('input', () => later(false));
    place.value = R.make('output', {});
    place.told = R.make('p', { class: 'note', role: 'status' });
    place.charts = R.make('div', { class: 'linear-charts' });
    place.facts = R.make('div', {});
    place.view = R.make('div', { class: 'linear-seen' }, place.charts, place.facts);
    const form = R.make('div', { class: 'move-form' }, place.signals, place.names,
      field('Open the loop at', place.open, 'its loop gain, once around'), field('From', place.from, 'a signal that is changed'), field('To', place.to, 'a signal that answers'), field('At', place.at, 'the model is run until then'),
      R.make('label', { class: 'field' }, R.make('span', {}, 'At rest'), place.steady, R.make('span', { class: 'note' }, 'a steady state near there')), R.make('label', { class: 'field' }, R.make('span', {}, 'Sampled'), place.sampled, R.make('span', { class: 'note' }, 'from one sample hit to the next')),
      R.make('h2', {}, 'A parameter that is turned'), field('Parameter', place.name), R.make('div', { class: 'range-fields' }, place.low, ' to ', place.high, ' ', place.unit, R.make('label', {}, place.log, ' by factors')),
      R.make('div', { class: 'move-time' }, place.slider, place.value), Desk.button('Follow the poles over the range', follow));
    view.replaceChildren(R.make('div', { class: 'move-parts' }, form, R.make('div', {}, place.told, place.view)));
    R.onTheme.push(() => { for (const u of drawn) u.redraw(false, true); });
    return true;
  };
  /** A range around the value that a parameter has. @param {string} name */
  const suggest = (name) => {
    const target = place.targets?.find((/** @type {any} */ one) => one.name === name);
    const [, number, unit] = /^([+-]?[\d.]+(?:e[+-]?\d+)?)\s*(.*)$/i.exec(target?.written ?? '') ?? [], x = Number(number);
    if (!target || !number || !x) return;
    [place.low.value, place.high.value] = x > 0 ? [String(Number((x / 10).toPrecision(3))), String(Number((x * 10).toPrecision(3)))] : [String(2 * x), '0'];
    place.unit.value = unit;
    place.log.checked = x > 0;
    place.slider.value = x > 0 ? '500' : '500';
    later(true);
  };
  /** @param {number} now Version of the model. */
  const renew = async (now) => {
    const view = document.getElementById('linear-view');
    if (!view || view.closest('section')?.hidden || (version === now && place.form !== null && place.told)) return;
    if (!place.told && !build()) return;
    version = now;
    try {
      const [signals, values] = await Promise.all([Desk.ask('signals'), Desk.ask('parameters')]);
      const options = (/** @type {string[]} */ all) => all.slice(0, 2000).map((name) => R.make('option', { value: name }));
      place.signals.replaceChildren(...options(signals.all));
      place.targets = values.targets;
      place.names.replaceChildren(...options(values.targets.filter((/** @type {any} */ one) => /^[+-]?[\d.]/.test(one.written)).map((/** @type {any} */ one) => one.name)));
    } catch (error) { Desk.refuse(error); return; }
    later(true);
  };
  return { renew, found: () => found, place };
})();
