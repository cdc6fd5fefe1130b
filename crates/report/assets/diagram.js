// @ts-check
'use strict';
// The block diagram: one level at a time, what is known of a block, values on the wires at the present time.
/* global R */

R.Diagram = (() => {
  /** @type {any} */ let texts = null;
  /** @type {Map<string, any>} */ const levels = new Map();
  /** @type {any} */ let level = null;
  /** @type {Map<number, Element>} */ let nodes = new Map();
  /** @type {(() => void)[]} What shows values beside the drawing. */ let lines = [];
  let chosen = -1, wire = -1, seen = true, valued = true;
  /** What can be laid over the drawing, and what of it is. */
  const LAYERS = [['units', 'units'], ['rates', 'sample times'], ['order', 'order'], ['feedback', 'feedback'], ['loops', 'algebraic loops']];
  /** @type {Set<string>} */ const over = new Set();
  /** A level without blocks. */
  const NOTHING = { path: '', title: '', drawing: 0, blocks: [], signals: [], probes: [] };
  /** @type {Record<'frame'|'crumbs'|'side'|'list'|'legend', any>} */ const place = { frame: null, crumbs: null, side: null, list: null, legend: null };

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
  const net = (/** @type {number} */ n) => texts.drawings[level.drawing].nets[n];

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
  /** The name of a parameter; where it can be changed it leads there. @param {string} path @param {string} own */
  const named = (path, own) => { const { change } = R; return change ? button(own, () => change(`${path}.${own}`)) : own; };
  /** Values of a wire that go with the time. @param {number} at */
  const courses = (at) => R.Wires.on(level, at).map((/** @type {any} */ { element, signal }) => {
    const value = R.make('b', {}, signal.say());
    lines.push(() => { value.textContent = signal.say(); });
    const show = button('over time', () => R.Signals.show(signal));
    show.setAttribute('aria-label', `show ${signal.path} over time`);
    return R.make('li', {}, R.make('span', { title: signal.path }, element || signal.path), ' ', value, ' ', show);
  });
  /** How a signal that was not recorded can be seen. @param {number} at */
  const unrecorded = (at) => {
    const [, , directed] = net(at), name = level.signals[at], { record } = R;
    if (!directed) return R.make('p', { class: 'note' }, 'A physical connection: it has no direction.');
    if (!name) return R.make('p', { class: 'note' }, 'This signal comes from outside of this level; it can be recorded where it begins.');
    const written = ['In the diagram ', R.make('code', {}, `record: ["${name}"]`), ' records it.'];
    if (!record) return R.make('p', { class: 'note' }, 'This signal was not recorded. ', ...written);
    const add = button('+ scope', () => record(name));
    add.setAttribute('title', 'Record this signal and show it over time (Enter)');
    return R.make('div', {}, add, R.make('p', { class: 'note' }, 'No scope shows this signal yet. For good: ', ...written));
  };

  /** What is known of a wire or of a block, where the model was compiled. @param {any} known */
  const facts = (known) => {
    if (!known) return [];
    const parts = [];
    if (known.unit) parts.push(['unit', known.unit]);
    if (known.order?.length) parts.push(['order of evaluation', known.order.join(', ')]);
    if (known.pace) parts.push(['changes', known.pace]);
    if (known.back) parts.push(['direction', 'leads back (feedback)']);
    if (known.loops?.length) parts.push(['algebraic loop', known.loops.join(', ')]);
    return parts.length ? [R.make('dl', {}, ...parts.flatMap(([name, value]) => [R.make('dt', {}, name), R.make('dd', {}, value)]))] : [];
  };
  /** Lays over the drawing what is wanted. */
  const lay = () => {
    const svg = place.frame.querySelector('svg'), inner = svg?.querySelector('g[transform]');
    for (const one of svg?.querySelectorAll('.layer') ?? []) one.remove();
    const layers = level.layers;
    for (const [name] of LAYERS) {
      if (!inner || !layers?.svg[name] || !over.has(name)) continue;
      const read = new DOMParser().parseFromString(`<svg xmlns="http://www.w3.org/2000/svg">${layers.svg[name]}</svg>`, 'image/svg+xml').documentElement;
      if (read.nodeName === 'svg') inner.append(...[...read.children].map((child) => document.importNode(child, true)));
    }
    const loops = new Set((layers?.wires ?? []).flatMap((/** @type {any} */ one) => one.loops)), back = (layers?.wires ?? []).filter((/** @type {any} */ one) => one.back).length;
    const words = [];
    if (over.has('feedback')) words.push(back ? `${back} ${back === 1 ? 'wire leads' : 'wires lead'} back: dashed` : 'no wire leads back here');
    if (over.has('loops')) words.push(loops.size ? `${loops.size} algebraic ${loops.size === 1 ? 'loop' : 'loops'} here` : 'no algebraic loop here');
    place.legend.replaceChildren(...(over.has('rates') ? (layers?.legend ?? []).map((/** @type {[string, string]} */ [name, text]) => R.make('span', { class: 'pace' }, R.make('i', { class: name }), text)) : []), words.length ? R.make('span', {}, words.join('; ')) : '');
  };

  const tellChosen = (/** @type {'level'|'block'|'wire'} */ what) => { for (const tell of R.onChosen) tell(what); };
  /** Tells of a wire. @param {number} at @param {boolean} [focus] */
  const follow = (at, focus) => {
    lines = [];
    for (const group of place.frame.querySelectorAll('.chosen')) group.classList.remove('chosen');
    const group = place.frame.querySelector(`[data-net="${at}"]`);
    if (!group) return;
    wire = at;
    group.classList.add('chosen');
    if (focus) group.focus();
    const carried = courses(at);
    place.side.replaceChildren(R.make('h3', {}, net(at)[0]), ...facts(level.layers?.wires[at]), carried.length ? R.make('ul', { class: 'carried' }, ...carried) : unrecorded(at));
    tellChosen('wire');
  };
  /** The next wire, or the one before. @param {number} by */
  const walk = (by) => {
    const count = texts.drawings[level.drawing].nets.length;
    for (let n = 1, at = wire; n <= count; n++) {
      at = (at + by + count + (at < 0 && by < 0 ? 1 : 0)) % count;
      if (place.frame.querySelector(`[data-net="${at}"]`)) { follow(at, true); return; }
    }
  };

  /** Tells of a block. @param {number} n @param {boolean} [focus] */
  const choose = (n, focus) => {
    lines = [];
    for (const group of place.frame.querySelectorAll('.chosen')) group.classList.remove('chosen');
    nodes.get(chosen)?.setAttribute('tabindex', '-1');
    const group = /** @type {any} */ (nodes.get(n));
    if (!group) return;
    [chosen, wire] = [n, -1];
    group.setAttribute('tabindex', '0');
    group.classList.add('chosen');
    if (focus) group.focus();
    const block = level.blocks[n], path = inside(n);
    if (!block) { place.side.replaceChildren(R.make('h3', {}, group.querySelector('title')?.textContent ?? '')); tellChosen('block'); return; }
    const [name, kind, written, variant, parameters] = block, known = texts.kinds[kind];
    const about = R.make('dl', {}, R.make('dt', {}, 'kind'), R.make('dd', {}, kind, known?.does ? ` – ${known.does}` : ''));
    if (variant) about.append(R.make('dt', {}, 'variant'), R.make('dd', {}, variant));
    about.append(R.make('dt', {}, 'written in'), R.make('dd', {}, written));
    const parts = [R.make('h3', {}, name), about, ...facts(level.layers?.blocks[n])];
    if (path !== null) parts.push(button('Go inside (Enter)', () => go(path, true)));
    if (parameters.length) {
      const means = new Map(known?.parameters ?? []);
      parts.push(R.make('table', { 'aria-label': 'Parameters of the block' }, R.make('thead', {}, R.make('tr', {}, ...['parameter', 'written', 'value'].map((head) => R.make('th', { scope: 'col' }, head)))),
        R.make('tbody', {}, ...parameters.map((/** @type {string[]} */ [own, text, value]) => R.make('tr', { title: means.get(own) ?? '' }, R.make('td', {}, named(level.path ? `${level.path}/${name}` : name, own)), R.make('td', {}, R.make('code', {}, text)), R.make('td', { class: 'n' }, value))))));
    }
    const out = texts.drawings[level.drawing].nets.flatMap((/** @type {any} */ [, ends, directed], /** @type {number} */ at) => directed && ends[0] === n ? courses(at) : []);
    if (out.length) parts.push(R.make('h4', {}, 'its outputs now'), R.make('ul', { class: 'carried' }, ...out));
    place.side.replaceChildren(...parts);
    tellChosen('block');
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
    svg.addEventListener('keydown', pressed);
    place.frame.replaceChildren(svg);
    lay();
    R.Wires.dress(svg, place.frame, level, texts.drawings[level.drawing].nets, (/** @type {number} */ at) => follow(at));
    place.crumbs.replaceChildren(...['', ...parts].flatMap((name, n) => {
      const target = parts.slice(0, n).join('/');
      const link = R.make('button', { type: 'button', ...(target === level.path ? { 'aria-current': 'page' } : {}) }, name || 'top');
      link.addEventListener('click', () => go(target, false, parts[n]));
      return n ? [' / ', link] : [link];
    }), R.make('span', { class: 'note' }, level.title && level.title !== parts[parts.length - 1] ? ` – ${level.title}` : ''));
    chosen = wire = -1;
    lines = [];
    place.side.replaceChildren(R.make('p', { class: 'note' }, 'Click a block or a wire for its details. A double click or Enter goes inside, Backspace out again; arrows move along the wires, W from wire to wire.'));
    tellChosen('level');
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
    else if (wire >= 0 && /^Arrow(Left|Right)$/.test(event.key)) { const ends = net(wire)[1]; choose(event.key === 'ArrowLeft' ? ends[0] : ends[1] ?? ends[0], true); }
    else if (/^Arrow/.test(event.key)) { const next = beside(chosen, event.key); if (next >= 0) choose(next, true); }
    else if (wire >= 0 && (event.key === 'Enter' || event.key === ' ')) place.side.querySelector('button')?.click();
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

  /** Shows a block, and one of its parameters. @param {string} path @param {string} name @param {string} [parameter] */
  const show = (path, name, parameter) => {
    document.getElementById('diagram')?.scrollIntoView();
    go(path, true, name);
    const line = parameter && [...place.side.querySelectorAll('tbody tr')].find((row) => row.firstChild?.textContent === parameter);
    line?.classList.add('chosen');
    line?.scrollIntoView({ block: 'nearest' });
  };

  /** All wires as a table: the diagram for those who do not see it. */
  const table = () => {
    const rows = texts.drawings[level.drawing].nets.map((/** @type {any} */ [title], /** @type {number} */ at) => R.make('tr', {}, R.make('td', {}, title), R.make('td', {}, R.Wires.on(level, at).map((/** @type {any} */ one) => `${one.element} ${one.signal.say()}`.trim()).join(', '))));
    place.list.replaceChildren(place.list.firstChild, R.make('table', { 'aria-label': 'Connections' }, R.make('thead', {}, R.make('tr', {}, R.make('th', { scope: 'col' }, 'connection'), R.make('th', { scope: 'col' }, `value at ${R.time(R.now)} s`))), R.make('tbody', {}, ...rows)));
  };

  const tell = () => {
    if (!seen || !level) return;
    R.Wires.tell(valued);
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
  const take = (read) => {
    // A model without a text that can be read has nothing to draw, but may have something soon.
    texts = read.levels.length ? read : { ...read, levels: [NOTHING], drawings: [{ svg: '<svg xmlns="http://www.w3.org/2000/svg"/>', nets: [] }] };
    levels.clear();
    for (const one of texts.levels) levels.set(one.path, one);
  };
  /** Other texts in the place of those that are shown: the level and the block that one looks at stay, as far as they are still there. @param {any} read */
  const renew = (read) => {
    const [path, name] = [level?.path ?? '', level?.blocks[chosen]?.[0]], told = place.frame.querySelector('.chosen') !== null && wire < 0;
    take(read);
    go(levels.has(path) ? path : '', false, told ? name : undefined);
  };

  /** @param {any} read Texts of the page. */
  const build = (read) => {
    const view = document.getElementById('diagram-view');
    if (!view || !read.levels.length) return;
    take(read);
    place.crumbs = R.make('nav', { id: 'crumbs', 'aria-label': 'Level of the diagram' });
    place.frame = R.make('div', { class: 'level' });
    place.side = R.make('aside', { class: 'inspector', 'aria-live': 'polite', 'aria-label': 'Block or wire' });
    place.list = R.make('details', { class: 'connections' }, R.make('summary', {}, 'Connections of this level as a table'));
    place.list.addEventListener('toggle', () => { if (place.list.open) table(); });
    const values = R.make('input', { type: 'checkbox', id: 'wire-values' });
    values.checked = valued;
    values.addEventListener('change', () => { valued = values.checked; place.frame.classList.toggle('bare', !valued); tell(); });
    const find = button('Find (/)', () => R.Search.open());
    const layers = LAYERS.map(([name, text]) => {
      const box = R.make('input', { type: 'checkbox' });
      box.addEventListener('change', () => { if (box.checked) over.add(name); else over.delete(name); lay(); });
      return R.make('label', {}, box, ` ${text}`);
    });
    place.legend = R.make('div', { class: 'legend', role: 'status' });
    view.append(R.make('div', { class: 'diagram-bar screen' }, place.crumbs, R.make('label', {}, values, ' values (V)'), ...(read.levels[0].layers ? layers : []), find), R.make('div', { class: 'diagram-parts screen' }, R.make('div', {}, place.frame, place.legend), place.side), place.list);
    new IntersectionObserver((all) => { seen = all.some((one) => one.isIntersecting); tell(); }).observe(place.frame);
    R.onTime.push(tell);
    /** @type {any} */ let paper = null;
    window.addEventListener('beforeprint', () => { paper ??= print(); view.append(paper); });
    window.addEventListener('afterprint', () => { paper?.remove(); });
    go('');
  };
  return { build, renew, has: () => level !== null, now: () => ({ texts, level, nodes, chosen, wire, place }), choose, follow, out, go, show, walk, keys: { v: () => document.getElementById('wire-values')?.click() } };
})();
