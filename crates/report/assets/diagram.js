// @ts-check
'use strict';
// The block diagram: one level at a time, what is known of a block, values on the wires at the present time.
/* global R */

R.Diagram = (() => {
  const SVG = 'http://www.w3.org/2000/svg';
  /** @type {any} */ let texts = null;
  /** @type {Map<string, any>} */ const levels = new Map();
  /** @type {any} */ let level = null;
  /** @type {Map<number, Element>} */ let nodes = new Map();
  /** @type {(() => void)[]} What shows values beside the drawing and in it. */ let labels = [];
  /** @type {(() => void)[]} */ let lines = [];
  let chosen = -1, seen = true, valued = true;
  /** @type {Record<'frame'|'crumbs'|'side'|'list', any>} */ const place = { frame: null, crumbs: null, side: null, list: null };

  /** A drawing of its own, as a part of this page. @param {number} at @returns {SVGSVGElement} */
  const drawn = (at) => {
    const read = new DOMParser().parseFromString(texts.drawings[at].svg, 'image/svg+xml').documentElement;
    if (read.nodeName !== 'svg') throw new Error('a drawing cannot be read');
    const svg = /** @type {any} */ (document.importNode(read, true));
    svg.removeAttribute('role');
    for (const child of [...svg.children]) if (child.nodeName === 'title') child.remove();
    const width = Number(svg.getAttribute('width'));
    // Larger than it was drawn where there is room, smaller where there is little, but never too small to be read.
    svg.style.width = `clamp(${Math.round(width * 0.65)}px, 100%, ${Math.round(width * 1.35)}px)`;
    svg.removeAttribute('width');
    svg.removeAttribute('height');
    return svg;
  };
  const inside = (/** @type {number} */ n) => {
    const block = level.blocks[n], path = block && (level.path ? `${level.path}/${block[0]}` : block[0]);
    return block && levels.has(path) ? path : null;
  };
  /** Signals of a wire: element, values, unit. @param {number} net */
  const signals = (net) => (level.probes[net] ?? []).map((/** @type {[string, number, number]} */ [element, at, place]) => {
    const panel = R.data.panels[at], s = panel.byOrder[place];
    return { element, panel, s, say: () => `${R.say(R.at(panel.time, s.values, R.now, s.held), 4)}${panel.unit ? ' ' + panel.unit : ''}` };
  });
  const net = (/** @type {number} */ n) => texts.drawings[level.drawing].nets[n];

  /** Where a value stands: above the middle of the longest level stretch of its wire. @param {string} data */
  const spot = (data) => {
    let best = null, x = 0, y = 0;
    for (const [, letter, first, second] of data.matchAll(/([MHV])(-?[\d.]+)(?: (-?[\d.]+))?/g)) {
      if (letter === 'M') [x, y] = [Number(first), Number(second)];
      if (letter === 'H') {
        const to = Number(first);
        if (!best || Math.abs(to - x) > best.long) best = { long: Math.abs(to - x), x: (x + to) / 2, y: y - 3 };
        x = to;
      }
      if (letter === 'V') y = Number(first);
    }
    return best;
  };

  /** Makes wires easy to hit and writes values on those that were recorded. @param {SVGSVGElement} svg */
  const wire = (svg) => {
    labels = [];
    for (const group of svg.querySelectorAll('[data-net]')) {
      const at = Number(group.getAttribute('data-net')), path = group.querySelector('path');
      if (!path || !net(at)) continue;
      const wide = /** @type {any} */ (path.cloneNode());
      wide.setAttribute('style', 'stroke: transparent; stroke-width: 9px; fill: none');
      group.append(wide);
      group.addEventListener('click', (event) => { event.stopPropagation(); follow(at); });
      const carried = signals(at), where = spot(path.getAttribute('d') ?? '');
      group.classList.toggle('recorded', carried.length > 0);
      // What a bus carries is told in the list beside the drawing.
      if (carried.length !== 1 || carried[0].element || !where) continue;
      const text = document.createElementNS(SVG, 'text');
      text.setAttribute('class', 'value');
      text.setAttribute('x', String(where.x));
      text.setAttribute('y', String(where.y));
      group.append(text);
      labels.push(() => { text.textContent = carried[0].say(); });
    }
  };

  const middle = (/** @type {number} */ n) => {
    const box = /** @type {any} */ (nodes.get(n)).getBBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  /** The block that an arrow key leads to: along wires to the right and left, by place up and down.
   * @param {number} from @param {string} key */
  const beside = (from, key) => {
    const [x, y] = middle(from), on = key === 'ArrowRight';
    /** @type {number[]} */ let found = [];
    if (key === 'ArrowUp' || key === 'ArrowDown') {
      const far = (/** @type {number} */ n) => {
        const [u, v] = middle(n), down = key === 'ArrowDown' ? v - y : y - v;
        return down > 3 ? down + 2 * Math.abs(u - x) : Infinity;
      };
      found = [...nodes.keys()].filter((n) => n !== from && far(n) < Infinity).sort((a, b) => far(a) - far(b));
      return found[0] ?? -1;
    }
    for (const [, ends, directed] of texts.drawings[level.drawing].nets) {
      if (!ends.includes(from)) continue;
      if (!directed) found.push(...ends.filter((/** @type {number} */ n) => n !== from && (middle(n)[0] > x) === on));
      else if (on && ends[0] === from) found.push(...ends.slice(1));
      else if (!on && ends[0] !== from) found.push(ends[0]);
    }
    found = found.filter((n) => n !== from && nodes.has(n));
    const far = (/** @type {number} */ n) => { const [u, v] = middle(n); return Math.hypot(u - x, v - y); };
    return found.sort((a, b) => far(a) - far(b))[0] ?? -1;
  };

  /** @param {string} text @param {() => void} does */
  const button = (text, does) => {
    const made = R.make('button', { type: 'button' }, text);
    made.addEventListener('click', does);
    return made;
  };
  /** Values of a wire that go with the time. @param {number} at */
  const courses = (at) => signals(at).map((/** @type {any} */ { element, panel, s, say }) => {
    const value = R.make('b', {}, say());
    lines.push(() => { value.textContent = say(); });
    const show = button('picture', () => { panel.card?.scrollIntoView({ block: 'center' }); panel.card?.focus(); });
    show.setAttribute('aria-label', `show ${s.path} over time`);
    return R.make('li', {}, element || s.path, ' ', value, ' ', show);
  });

  /** Tells of a wire. @param {number} at */
  const follow = (at) => {
    lines = [];
    for (const group of place.frame.querySelectorAll('.chosen')) group.classList.remove('chosen');
    place.frame.querySelector(`[data-net="${at}"]`)?.classList.add('chosen');
    const carried = courses(at);
    place.side.replaceChildren(R.make('h3', {}, net(at)[0]),
      carried.length ? R.make('ul', { class: 'carried' }, ...carried) : R.make('p', { class: 'note' }, net(at)[2] ? 'This signal was not recorded.' : 'A physical connection: it has no direction.'));
  };

  /** Tells of a block. @param {number} n @param {boolean} [focus] */
  const choose = (n, focus) => {
    lines = [];
    for (const group of place.frame.querySelectorAll('.chosen')) group.classList.remove('chosen');
    nodes.get(chosen)?.setAttribute('tabindex', '-1');
    const group = /** @type {any} */ (nodes.get(n));
    if (!group) return;
    chosen = n;
    group.setAttribute('tabindex', '0');
    group.classList.add('chosen');
    if (focus) group.focus();
    const block = level.blocks[n], path = inside(n);
    if (!block) { place.side.replaceChildren(R.make('h3', {}, group.querySelector('title')?.textContent ?? '')); return; }
    const [name, kind, written, variant, parameters] = block, known = texts.kinds[kind];
    const about = R.make('dl', {}, R.make('dt', {}, 'kind'), R.make('dd', {}, kind, known?.does ? ` – ${known.does}` : ''));
    if (variant) about.append(R.make('dt', {}, 'variant'), R.make('dd', {}, variant));
    about.append(R.make('dt', {}, 'written in'), R.make('dd', {}, written));
    const parts = [R.make('h3', {}, name), about];
    if (path !== null) parts.push(button('Go inside (Enter)', () => go(path, true)));
    if (parameters.length) {
      const means = new Map(known?.parameters ?? []);
      parts.push(R.make('table', {}, R.make('thead', {}, R.make('tr', {}, ...['parameter', 'written', 'value'].map((head) => R.make('th', { scope: 'col' }, head)))),
        R.make('tbody', {}, ...parameters.map((/** @type {string[]} */ [own, text, value]) => R.make('tr', { title: means.get(own) ?? '' }, R.make('td', {}, own), R.make('td', {}, R.make('code', {}, text)), R.make('td', { class: 'n' }, value))))));
    }
    const out = texts.drawings[level.drawing].nets.flatMap((/** @type {any} */ [, ends, directed], /** @type {number} */ at) => directed && ends[0] === n ? courses(at) : []);
    if (out.length) parts.push(R.make('h4', {}, 'its outputs now'), R.make('ul', { class: 'carried' }, ...out));
    place.side.replaceChildren(...parts);
  };

  /** Shows a level; `from` is the block to stand on. @param {string} path @param {boolean} [focus] @param {string} [from] */
  const go = (path, focus, from) => {
    level = levels.get(path) ?? levels.get('');
    const svg = drawn(level.drawing), parts = level.path ? level.path.split('/') : [];
    svg.setAttribute('role', 'group');
    svg.setAttribute('aria-label', `Blocks of ${level.path || 'the top'}; arrows go along the wires`);
    nodes = new Map();
    for (const group of svg.querySelectorAll('[data-node]')) {
      const n = Number(group.getAttribute('data-node')), block = level.blocks[n];
      nodes.set(n, group);
      group.setAttribute('tabindex', '-1');
      group.setAttribute('role', 'button');
      group.setAttribute('aria-label', block ? `${block[0]}, ${block[1]}${inside(n) !== null ? ', Enter goes inside' : ''}` : group.querySelector('title')?.textContent ?? '');
      group.classList.toggle('enters', inside(n) !== null);
      group.addEventListener('click', () => choose(n));
      group.addEventListener('focus', () => { if (chosen !== n || !group.classList.contains('chosen')) choose(n); });
      group.addEventListener('dblclick', () => { const path = inside(n); if (path !== null) go(path, true); });
    }
    wire(svg);
    svg.addEventListener('keydown', pressed);
    place.frame.replaceChildren(svg);
    place.crumbs.replaceChildren(...['', ...parts].flatMap((name, n) => {
      const target = parts.slice(0, n).join('/');
      const link = R.make('button', { type: 'button', ...(target === level.path ? { 'aria-current': 'page' } : {}) }, name || 'top');
      link.addEventListener('click', () => go(target, false, parts[n]));
      return n ? [' / ', link] : [link];
    }), R.make('span', { class: 'note' }, level.title && level.title !== parts[parts.length - 1] ? ` – ${level.title}` : ''));
    chosen = -1;
    lines = [];
    place.side.replaceChildren(R.make('p', { class: 'note' }, 'A click on a block or a wire tells what it is; a double click or Enter goes inside, Backspace out again, arrows along the wires.'));
    const all = [...nodes.keys()], at = all.find((n) => from !== undefined && level.blocks[n]?.[0] === from) ?? all.find((n) => level.blocks[n]);
    if (at !== undefined && (focus || from !== undefined)) choose(at, focus);
    else if (at !== undefined) { chosen = at; nodes.get(at)?.setAttribute('tabindex', '0'); }
    if (place.list.open) table();
    tell();
  };

  const pressed = (/** @type {KeyboardEvent} */ event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const path = event.key === 'Enter' ? inside(chosen) : null;
    if (path !== null) go(path, true);
    else if (event.key === 'Backspace' && level.path) out();
    else if (/^Arrow/.test(event.key)) { const next = beside(chosen, event.key); if (next >= 0) choose(next, true); }
    else if (event.key === 'Enter' || event.key === ' ') choose(chosen);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  /** One level up. */
  const out = () => {
    if (!level?.path) return;
    const parts = level.path.split('/');
    go(parts.slice(0, -1).join('/'), true, parts[parts.length - 1]);
  };

  /** All wires as a table: the diagram for those who do not see it. */
  const table = () => {
    const rows = texts.drawings[level.drawing].nets.map((/** @type {any} */ [title], /** @type {number} */ at) => R.make('tr', {}, R.make('td', {}, title), R.make('td', {}, signals(at).map((/** @type {any} */ one) => `${one.element} ${one.say()}`.trim()).join(', '))));
    place.list.replaceChildren(place.list.firstChild, R.make('table', {}, R.make('thead', {}, R.make('tr', {}, R.make('th', { scope: 'col' }, 'connection'), R.make('th', { scope: 'col' }, `value at ${R.now.toFixed(3)} s`))), R.make('tbody', {}, ...rows)));
  };

  const tell = () => {
    if (!seen || !level) return;
    if (valued) for (const one of labels) one();
    for (const one of lines) one();
  };

  /** All drawings below each other, for paper. */
  const print = () => {
    const done = new Set();
    const all = [...levels.values()].filter((one) => !done.has(one.drawing) && done.add(one.drawing));
    const same = (/** @type {any} */ one) => [...levels.values()].filter((other) => other.drawing === one.drawing).map((other) => other.path || 'top');
    return R.make('div', { class: 'paper' }, ...all.map((one) => {
      const names = same(one), shown = names.slice(0, 3).join(', ') + (names.length > 3 ? ` and ${names.length - 3} more` : '');
      const svg = drawn(one.drawing);
      // Nine tenths of a dot a dot: letters of two millimetres.
      svg.style.width = `${Math.round(0.9 * svg.viewBox.baseVal.width)}px`;
      return R.make('figure', { class: 'level' }, R.make('figcaption', {}, `${shown}${one.title ? ' – ' + one.title : ''}`), svg);
    }));
  };

  /** @param {any} read Texts of the page. */
  const build = (read) => {
    const view = document.getElementById('diagram-view');
    if (!view || !read.levels.length) return;
    texts = read;
    for (const one of texts.levels) levels.set(one.path, one);
    place.crumbs = R.make('nav', { id: 'crumbs', 'aria-label': 'Level of the diagram' });
    place.frame = R.make('div', { class: 'level' });
    place.side = R.make('aside', { class: 'inspector', 'aria-live': 'polite', 'aria-label': 'Block or wire' });
    place.list = R.make('details', { class: 'connections' }, R.make('summary', {}, 'Connections of this level as a table'));
    place.list.addEventListener('toggle', () => { if (place.list.open) table(); });
    const values = R.make('input', { type: 'checkbox', id: 'wire-values' });
    values.checked = valued;
    values.addEventListener('change', () => { valued = values.checked; place.frame.classList.toggle('bare', !valued); tell(); });
    const all = R.make('datalist', { id: 'all-blocks' }), find = R.make('input', { list: 'all-blocks', placeholder: 'find a block', 'aria-label': 'Find a block', size: '24', id: 'find-block' });
    for (const one of texts.levels) for (const block of one.blocks) if (block) all.append(R.make('option', { value: one.path ? `${one.path}/${block[0]}` : block[0] }));
    find.addEventListener('change', () => {
      const parts = find.value.trim().split('/'), name = parts.pop(), path = parts.join('/');
      if (name && levels.get(path)?.blocks.some((/** @type {any} */ b) => b?.[0] === name)) go(path, true, name);
    });
    view.append(R.make('div', { class: 'diagram-bar screen' }, place.crumbs, R.make('label', {}, values, ' values (V)'), find, all), R.make('div', { class: 'diagram-parts screen' }, place.frame, place.side), place.list);
    new IntersectionObserver((all) => { seen = all.some((one) => one.isIntersecting); tell(); }).observe(place.frame);
    R.onTime.push(tell);
    /** @type {any} */ let paper = null;
    window.addEventListener('beforeprint', () => { paper ??= print(); view.append(paper); });
    window.addEventListener('afterprint', () => { paper?.remove(); });
    go('');
  };
  return { build, out, go, keys: { v: () => document.getElementById('wire-values')?.click(), '/': () => document.getElementById('find-block')?.focus() } };
})();
