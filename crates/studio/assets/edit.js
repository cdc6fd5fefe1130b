// @ts-check
'use strict';
// Changes of the diagram: rename, delete, connect, add, group, choose. Each is a small edit of the text, shown as a difference.
/* global R */

/** @type {any} */ (R).Edit = (() => {
  const { Desk, Project } = /** @type {any} */ (R);
  const SVG = 'http://www.w3.org/2000/svg';
  /** @type {Record<'bar'|'chips'|'task'|'done'|'marks'|'column', any>} */ const place = { bar: null, chips: null, task: null, done: null, marks: null, column: null };
  /** Names of blocks of this level that are chosen together. @type {Set<string>} */ const marked = new Set();
  let markedAt = '';
  /** The port that a wire is to come from: its level and its end. @type {{level: string, end: string, kind: string, domain: string}|null} */ let from = null;
  /** The block to look at when the model has been drawn anew. @type {string|null} */ let wanted = null;
  /** The last version of the model that an answer has named. */ let answered = 0;
  /** What is open beside the picture; nothing if none. @type {string} */ let task = '';

  const may = () => Project.known()?.edit === true;
  const look = () => R.Diagram.now();
  const level = () => look().level;
  /** A path from the top. @param {string} name */
  const path = (name) => level().path ? `${level().path}/${name}` : name;
  /** The name of the chosen block; nothing if none is. @returns {string|null} */
  const block = () => { const { level: at, chosen, place: { frame } } = look(); return chosen >= 0 && at.blocks[chosen] && frame.querySelector('.chosen[data-node]') ? at.blocks[chosen][0] : null; };
  /** Those that are chosen together, or the chosen one. @returns {string[]} */
  const blocks = () => { const one = block(); return marked.size ? [...marked] : one ? [one] : []; };

  /** Ports of a block of this level: name, `i`, `o` or `c`, its domain, whether it may stay open. @param {string} name @returns {[string, string, string, boolean][]} */
  const ports = (name) => level().ports?.[name] ?? [];
  /** Ends of the wires of this level, the source first. @returns {{ends: string[], directed: boolean, at: number}[]} */
  const nets = () => { const { texts } = look(), drawing = texts.drawings[level().drawing]; return (drawing.ends ?? []).map((/** @type {string[]} */ ends, /** @type {number} */ at) => ({ ends: ends.filter(Boolean), directed: drawing.nets[at][2] === 1, at })); };
  /** What a port is connected to. @param {string} end @param {string} kind @returns {string[]} */
  const joined = (end, kind) => nets().flatMap(({ ends, directed }) => {
    // An element of a bus comes from its port.
    const own = ends.findIndex((one) => one === end || kind === 'o' && one.startsWith(`${end}.`));
    if (own < 0) return [];
    if (!directed) return ends.filter((one) => one !== end);
    return own === 0 ? ends.slice(1) : [ends[0]];
  });

  /** @param {any} body What is to be done. @param {(reason: any) => void} wrong Shows why it is not. */
  const act = async (body, wrong) => {
    try {
      const done = await Desk.ask('edit', { ...body, version: Math.max(answered, Project.known()?.version ?? 0) });
      answered = done.version ?? answered;
      marked.clear();
      close();
      wanted = done.block ?? null;
      attend();
      tell(done);
      return true;
    } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      wrong({ message, help: why?.help, shared: why?.shared === true ? () => act({ ...body, all: true }, wrong) : null });
      return false;
    }
  };
  /** Why something is not done, with a press that does it all the same where that may be meant. @param {any} reason */
  const why = ({ message, help, shared }) => R.make('div', { class: 'answer', role: 'alert' }, R.make('span', { class: 'bad' }, message), ...(help ? [R.make('div', { class: 'note' }, help)] : []),
    ...(shared ? [Desk.button('Change it for all of them', shared)] : []));
  /** Shows a reason where the wires and blocks are told of. @param {any} reason */
  const beside = (reason) => { place.done.replaceChildren(why(reason)); Desk.say(reason.message, true); };
  /** Shows what was written. @param {any} done */
  const tell = (done) => {
    const notes = (done.notes ?? []).map((/** @type {string} */ note) => R.make('p', { class: 'note' }, note));
    const seen = done.difference ? [R.make('details', {}, R.make('summary', {}, 'what changed in the text'), R.make('pre', { class: 'difference' }, done.difference))] : [];
    place.done?.replaceChildren(R.make('p', {}, done.message), ...notes, ...(done.difference ? [Desk.button('Undo (Ctrl Z)', undo)] : []), ...seen);
    Desk.say([done.message, ...(done.notes ?? [])].join('; '));
  };
  const again = (/** @type {string} */ what) => async () => { try { tell({ ...await Desk.ask(what, {}), notes: [] }); } catch (error) { Desk.refuse(error); } };
  const undo = again('undo'), redo = again('redo');

  /** Opens something beside the picture. @param {string} name @param {string} title @param {...any} inside */
  const open = (name, title, ...inside) => {
    task = name;
    const shut = Desk.button('Close (Esc)', close, { class: 'quiet' });
    place.task.replaceChildren(R.make('section', { class: 'task', 'aria-label': title }, R.make('h3', {}, title), ...inside, shut));
    place.task.querySelector('input, select, button')?.focus();
  };
  const close = () => {
    const held = place.task?.contains(document.activeElement);
    // No wire is begun any more.
    if (from) Desk.say('');
    task = '';
    from = null;
    place.task?.replaceChildren();
    arm();
    if (held) /** @type {any} */ (look().nodes.get(look().chosen))?.focus();
  };
  /** A line with a field, a button and a place for what is wrong. @param {string} label @param {string} value @param {string} does @param {(value: string, wrong: (reason: any) => void) => void} go */
  const form = (label, value, does, go) => {
    const field = R.make('input', { type: 'text', value, 'aria-label': label, spellcheck: 'false', autocomplete: 'off' });
    const answer = R.make('div');
    const wrong = (/** @type {any} */ reason) => answer.replaceChildren(why(reason));
    const done = () => { answer.replaceChildren(); go(field.value, wrong); };
    field.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') { event.preventDefault(); done(); } });
    queueMicrotask(() => field.select());
    return R.make('div', {}, R.make('label', { class: 'ask' }, R.make('span', {}, label), field), Desk.button(does, done, { class: 'main' }), answer);
  };
  const nothing = (/** @type {string} */ what) => Desk.say(`select ${what} first`, true);

  const rename = () => {
    const old = block();
    if (!may() || !old) { nothing('a block'); return; }
    open('rename', `Rename ${old}`, form('New name', old, 'Rename', (name, wrong) => act({ do: 'rename', block: path(old), name }, wrong)));
  };
  const remove = () => {
    if (!may()) return;
    const { wire } = look();
    if (wire >= 0) { const net = nets()[wire]; if (net) cut(net.directed ? net.ends[0] : net.ends.slice(1)); return; }
    const all = blocks();
    if (!all.length) { nothing('a block or a wire'); return; }
    act({ do: 'delete', blocks: all.map(path) }, beside);
  };
  /** Deletes wires by their ends, one after the other. @param {string|string[]} ends */
  const cut = async (ends) => {
    for (const end of [ends].flat()) if (!await act({ do: 'disconnect', end: path(end) }, beside)) return;
  };
  const group = () => {
    const all = blocks();
    if (!may() || !all.length) { nothing('blocks (X selects one more)'); return; }
    open('group', `Group ${all.length === 1 ? all[0] : `${all.length} blocks`} in a subsystem`, R.make('p', { class: 'note' }, all.join(', ')),
      form('Name of the subsystem and of its file', '', 'Group', (name, wrong) => act({ do: 'wrap', blocks: all.map(path), name }, wrong)));
  };

  /** Chooses one more block, or one less. @param {string|null} name */
  const mark = (name) => {
    if (!name) return;
    if (marked.has(name)) marked.delete(name); else marked.add(name);
    marks();
    Desk.say(marked.size ? `${marked.size} ${marked.size === 1 ? 'block is' : 'blocks are'} selected: ${[...marked].join(', ')}` : 'no blocks are selected together');
  };
  const marks = () => {
    if (markedAt !== level().path) { marked.clear(); markedAt = level().path; }
    const { nodes, level: at } = look();
    for (const [n, group] of nodes) { const on = marked.has(at.blocks[n]?.[0]); group.classList.toggle('also', on); if (on) group.setAttribute('aria-pressed', 'true'); else group.removeAttribute('aria-pressed'); }
    place.marks?.replaceChildren(...(marked.size ? [`${marked.size} selected `, Desk.button('Clear', () => { marked.clear(); marks(); })] : []));
  };

  /** Whether a wire can lead from one port to another by what they are. @param {string} kind @param {string} domain @param {string} other @param {string} otherDomain */
  const fits = (kind, domain, other, otherDomain) => kind === 'c' ? other === 'c' && (!domain || !otherDomain || domain === otherDomain) : other !== 'c' && kind !== other;
  /** Begins a wire. @param {string} end @param {string} kind @param {string} domain */
  const begin = (end, kind, domain) => {
    from = { level: level().path, end, kind, domain };
    open('connect', `Connect ${end} to …`, R.make('p', { class: 'note' }, 'Click a port or a block, or choose a port here. In the picture arrows lead to another block, and Enter connects it.'), choice());
    arm();
    Desk.say(`Connect ${end} to a port: click one, or a block`);
  };
  /** All ports that the wire may lead to, those that need one first. */
  const choice = () => {
    if (!from) return '';
    const { kind, domain, end } = from;
    const all = Object.keys(level().ports ?? {}).flatMap((name) => ports(name).filter(([, other, of]) => fits(kind, domain, other, of)).map(([port, other, , optional]) => ({ end: `${name}.${port}`, open: !optional && !joined(`${name}.${port}`, other).length, driven: other === 'i' && joined(`${name}.${port}`, other).length > 0 }))).filter((one) => one.end !== end && !one.driven);
    all.sort((a, b) => Number(b.open) - Number(a.open));
    const list = R.make('select', { 'aria-label': `Port to connect ${end} to` }, ...all.map((one) => R.make('option', { value: one.end }, one.open ? `${one.end} (open)` : one.end)));
    return all.length ? R.make('div', { class: 'pick' }, list, Desk.button('Connect', () => finish(list.value), { class: 'main' })) : R.make('p', { class: 'note' }, 'No port of this level fits and is free.');
  };
  /** Ends the wire. @param {string} end */
  const finish = (end) => {
    if (!from) return;
    const begun = from;
    act({ do: 'connect', from: begun.level ? `${begun.level}/${begun.end}` : begun.end, to: path(end) }, (reason) => {
      // One may try another port.
      beside(reason);
      from = begun;
      arm();
    });
  };
  /** The port that a click on a block means, if only one fits. @param {string} name */
  const meant = (name) => {
    if (!from) return;
    const { kind, domain, end } = from;
    const all = ports(name).filter(([port, other, of]) => fits(kind, domain, other, of) && `${name}.${port}` !== end && !(other === 'i' && joined(`${name}.${port}`, other).length));
    if (all.length === 1) { finish(`${name}.${all[0][0]}`); return; }
    if (!all.length) beside({ message: `no free port of ${name} fits ${end}` });
  };
  const connect = () => {
    const name = block();
    if (!may() || !name) { nothing('a block'); return; }
    const own = ports(name), out = own.filter(([, kind]) => kind === 'o');
    if (out.length === 1 && !own.some(([, kind]) => kind === 'c')) { begin(`${name}.${out[0][0]}`, 'o', ''); return; }
    const all = own.map(([port, kind, domain]) => Desk.button(`${port}${kind === 'i' ? ' (input)' : kind === 'o' ? ' (output)' : ` (${domain})`}`, () => begin(`${name}.${port}`, kind, domain)));
    open('connect', `Connect a port of ${name}`, R.make('div', { class: 'buttons' }, ...all), ...(all.length ? [] : [R.make('p', { class: 'note' }, 'It has no ports.')]));
  };

  /** The block that an event is about. @param {Event} event @returns {string|null} */
  const pointed = (event) => { const group = event.target instanceof Element ? event.target.closest('[data-node]') : null; return group ? level().blocks[Number(group.getAttribute('data-node'))]?.[0] ?? null : null; };

  /** Handles at the ports of the picture. */
  const handles = () => {
    const { texts, place: { frame } } = look();
    const inner = frame.querySelector('svg > g');
    if (!inner || !may()) return;
    for (const [, end, kind, x, y] of texts.drawings[level().drawing].ports ?? []) {
      const dot = document.createElementNS(SVG, 'circle');
      for (const [name, value] of Object.entries({ class: 'handle', cx: x, cy: y, r: 5, role: 'button', tabindex: '-1', 'aria-label': `port ${end}`, 'data-end': end, 'data-kind': kind })) dot.setAttribute(name, String(value));
      const title = document.createElementNS(SVG, 'title');
      title.textContent = `${end}: click to connect`;
      dot.append(title);
      dot.addEventListener('click', (event) => {
        event.stopPropagation();
        const [name, port] = end.split('.'), domain = ports(name).find(([own]) => own === port)?.[2] ?? '';
        // An output of this level takes a signal, an input of it gives one.
        if (from && from.end !== end) finish(end); else begin(end, kind, domain);
      });
      inner.append(dot);
    }
  };
  /** Shows which ports a begun wire may lead to. */
  const arm = () => {
    const { place: { frame } } = look();
    frame?.classList.toggle('connecting', from !== null);
    for (const dot of frame?.querySelectorAll('.handle') ?? []) {
      const end = dot.getAttribute('data-end') ?? '', kind = dot.getAttribute('data-kind') ?? '', [name, port] = end.split('.');
      const domain = ports(name).find(([own]) => own === port)?.[2] ?? '';
      dot.classList.toggle('fits', from !== null && end !== from.end && fits(from.kind, from.domain, kind, domain) && !(kind === 'i' && joined(end, kind).length));
      dot.classList.toggle('begun', from?.end === end);
    }
  };

  /** Where a new block goes: into the chosen wire, beside the chosen block, or anywhere. */
  const places = () => {
    const { wire } = look(), net = wire >= 0 ? nets()[wire] : null, own = block();
    /** @type {[string, any][]} */ const all = [];
    if (net && net.ends.length > 1) {
      const [first, ...rest] = net.ends;
      if (rest.length > 1 && net.directed) all.push([`into the wire from ${first}, before all of its ends`, { into: [first] }]);
      for (const end of net.directed ? rest : net.ends) all.push([net.directed ? `into the wire from ${first} to ${end}` : `between ${end} and the rest of the connection`, { into: net.directed ? [first, end] : [net.ends.find((one) => one !== end), end] }]);
      if (!net.directed) all.push(['joined to the connection', { into: [first] }]);
    }
    if (own) {
      all.push([`beside ${own}`, { beside: own }]);
      for (const [port, kind] of ports(own)) if (kind === 'o' && joined(`${own}.${port}`, 'o').length) all.push([`into the wire from ${own}.${port}`, { into: [`${own}.${port}`] }]);
    }
    all.push(['alone', {}]);
    return all;
  };

  /** The palette. */
  const add = () => {
    if (!may()) return;
    let chosen = 0, count = 0;
    /** @type {any[]} */ let found = [];
    const input = R.make('input', { type: 'search', role: 'combobox', 'aria-expanded': 'true', 'aria-controls': 'palette', 'aria-autocomplete': 'list', 'aria-label': 'Search a kind of block', autocomplete: 'off', spellcheck: 'false', placeholder: 'such as: low pass, spring, limit' });
    const list = R.make('ul', { role: 'listbox', id: 'palette', class: 'palette', 'aria-label': 'Kinds of block' });
    const note = R.make('p', { class: 'note', role: 'status' });
    const at = places();
    const pick = () => {
      [...list.children].forEach((line, n) => { line.setAttribute('aria-selected', String(n === chosen)); if (n === chosen) line.scrollIntoView({ block: 'nearest' }); });
      if (found.length) input.setAttribute('aria-activedescendant', `kind-${chosen}`); else input.removeAttribute('aria-activedescendant');
    };
    const seek = async () => {
      const mine = ++count;
      try {
        const all = await Desk.ask('kinds', { words: input.value });
        if (mine !== count) return;
        found = all;
      } catch (error) { Desk.refuse(error); return; }
      chosen = 0;
      let category = '';
      list.replaceChildren(...found.map((kind, n) => {
        const head = input.value.trim() ? '' : kind.category === category ? '' : category = kind.category;
        const line = R.make('li', { role: 'option', id: `kind-${n}` }, ...(head ? [R.make('span', { class: 'head' }, head)] : []), R.make('b', {}, kind.kind), ' ', R.make('span', { class: 'more' }, kind.does));
        line.addEventListener('click', () => fill(found[n].kind, at));
        return line;
      }));
      note.textContent = found.length ? '' : 'Nothing fits; fewer or other words may.';
      pick();
    };
    input.addEventListener('input', seek);
    input.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[event.key];
      if (by && found.length) chosen = Math.min(Math.max(chosen + by, 0), found.length - 1);
      else if (event.key === 'Enter') { event.preventDefault(); if (found[chosen]) fill(found[chosen].kind, at); return; }
      else return;
      event.preventDefault();
      pick();
    });
    open('add', 'Add a block', input, note, list);
    seek();
  };
  /** Asks for what a kind needs. @param {string} kind @param {[string, any][]} at */
  const fill = async (kind, at) => {
    /** @type {any} */ let known;
    try { known = await Desk.ask('kind', { kind, level: level().path }); } catch (error) { Desk.refuse(error); return; }
    const name = R.make('input', { type: 'text', value: known.name, 'aria-label': 'Name', spellcheck: 'false', autocomplete: 'off' });
    const spot = R.make('select', { 'aria-label': 'Place' }, ...at.map(([text], n) => R.make('option', { value: String(n) }, text)));
    // What has no way in or no way out stands better beside.
    const has = (/** @type {string} */ side) => !known.ports || known.ports.some((/** @type {string[]} */ [, of]) => of === side || of === 'c');
    if (!has('i') && at[0][1].into) spot.value = String(at.findIndex(([, one]) => !one.into));
    /** @type {Map<string, any>} */ const fields = new Map();
    const line = (/** @type {any} */ field, /** @type {boolean} */ needed) => {
      const input = R.make('input', { type: 'text', value: needed ? field.example : '', placeholder: needed ? '' : field.default, 'aria-label': `${field.name}${field.unit ? `, ${field.unit}` : ''}`, spellcheck: 'false', autocomplete: 'off' });
      fields.set(field.name, input);
      input.addEventListener('keydown', enter);
      return R.make('label', { class: 'ask', title: field.doc }, R.make('span', {}, field.name, field.unit ? R.make('small', {}, ` ${field.unit}`) : ''), input);
    };
    const answer = R.make('div');
    const done = () => {
      answer.replaceChildren();
      const parameters = Object.fromEntries([...fields].filter(([, input]) => input.value.trim()).map(([own, input]) => [own, input.value]));
      act({ do: 'add', level: level().path, kind, name: name.value, parameters, ...at[Number(spot.value)][1] }, (reason) => answer.replaceChildren(why(reason)));
    };
    const enter = (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') { event.preventDefault(); done(); } };
    name.addEventListener('keydown', enter);
    const needed = known.fields.map((/** @type {any} */ field) => line(field, true)), others = known.others.map((/** @type {any} */ field) => line(field, false));
    open('add', `Add ${kind}`, R.make('p', { class: 'note' }, known.doc.split('\n\n')[0]), R.make('label', { class: 'ask' }, R.make('span', {}, 'name'), name), R.make('label', { class: 'ask' }, R.make('span', {}, 'place'), spot), ...needed,
      ...(others.length ? [R.make('details', {}, R.make('summary', {}, `${others.length} more, with defaults`), ...others)] : []), Desk.button('Add', done, { class: 'main' }), Desk.button('Other kind', add), answer);
    name.select();
  };

  /** What can be done with what is looked at, below what is told of it. @param {'level'|'block'|'wire'} what */
  const chosen = (what) => {
    const { place: { side }, wire } = look();
    // Why something was not done has been read when one looks elsewhere.
    if (place.done?.querySelector('.answer') && !from) place.done.replaceChildren();
    if (what === 'level') { arrived(); return; }
    // Who looks at something else meanwhile goes on looking at it.
    wanted = null;
    if (what === 'wire' && wire >= 0) {
      const net = nets()[wire];
      if (!net || !may()) return;
      const ends = net.directed ? net.ends.slice(1) : net.ends;
      side.append(R.make('h4', {}, 'change'), R.make('div', { class: 'buttons' }, Desk.button('Insert a block (A)', add), ...ends.map((end) => Desk.button(net.directed ? `Delete the wire to ${end}` : `Take ${end} out`, () => cut(end)))));
      return;
    }
    const name = block();
    if (!name) return;
    const own = level().choices?.[name];
    if (own) side.append(R.make('h4', {}, 'choice'), chip(own.by, own, level().path));
    const all = ports(name);
    if (!all.length) return;
    const row = (/** @type {[string, string, string, boolean]} */ [port, kind, domain, optional]) => {
      const end = `${name}.${port}`, others = joined(end, kind);
      const side = kind === 'i' ? 'input' : kind === 'o' ? 'output' : domain || 'connection';
      const does = may() ? [Desk.button(from ? 'Connect here' : 'Connect', () => { if (from && from.end !== end) finish(end); else begin(end, kind, domain); }, { 'aria-label': `Connect ${end}` }), ...(others.length ? [Desk.button('✕', () => cut(end), { 'aria-label': `Delete the wires of ${end}`, title: 'Delete its wires' })] : [])] : [];
      return R.make('tr', others.length || optional ? {} : { class: 'open' }, R.make('td', {}, port), R.make('td', {}, side), R.make('td', {}, others.join(', ') || (optional ? '' : 'open')), R.make('td', {}, ...does));
    };
    side.append(R.make('h4', {}, 'ports'), R.make('table', { class: 'ports', 'aria-label': 'Ports' }, R.make('thead', {}, R.make('tr', {}, ...['port', '', 'connected to', ''].map((head) => R.make('th', { scope: 'col' }, head)))), R.make('tbody', {}, ...all.map(row))));
    if (may()) side.append(R.make('div', { class: 'buttons' }, Desk.button('Rename (R)', rename), Desk.button('Delete (Del)', remove), Desk.button('Add beside it (A)', add), Desk.button(marked.has(name) ? 'Deselect (X)' : 'Select too (X)', () => { mark(name); R.Diagram.choose(look().chosen); })));
  };
  /** A choice of a model: `drive: [dc]`. @param {string} by @param {{chosen: string, of: string[]}} known @param {string} at Path of its level. */
  const chip = (by, known, at) => {
    const list = R.make('select', { 'aria-label': by, ...(may() ? {} : { disabled: '', title: 'start the page with --edit to choose' }) }, ...known.of.map((one) => R.make('option', { value: one }, one)));
    list.value = known.chosen;
    list.addEventListener('change', () => { const value = list.value; list.value = known.chosen; act({ do: 'choose', level: at, by, value }, beside); });
    return R.make('label', { class: 'chip' }, `${by}: `, list);
  };

  /** A level has been drawn. */
  const arrived = () => {
    build();
    if (!place.bar) return;
    const { texts } = look();
    place.bar.hidden = !may();
    place.chips.replaceChildren(...(texts.choices ?? []).map((/** @type {any} */ one) => chip(one.name, one, '')));
    if (from && from.level !== level().path) close();
    handles();
    marks();
    arm();
    attend();
  };
  /** Chooses the block that was changed last, as soon as it is drawn: the picture may come before the answer or behind it. */
  const attend = () => {
    if (wanted === null) return;
    const slash = wanted.lastIndexOf('/'), at = wanted.slice(0, Math.max(slash, 0)), name = wanted.slice(slash + 1);
    const n = at === level().path ? level().blocks.findIndex((/** @type {any} */ one) => one?.[0] === name) : -1;
    if (n < 0) return;
    wanted = null;
    // A level that is being shown is not finished yet.
    queueMicrotask(() => R.Diagram.choose(n, !place.task.contains(document.activeElement)));
  };

  const build = () => {
    const parts = document.querySelector('#diagram-view .diagram-parts'), bar = document.querySelector('#diagram-view .diagram-bar'), side = look().place.side;
    if (place.bar || !parts || !bar || !side) return;
    place.chips = R.make('span', { class: 'chips' });
    place.marks = R.make('span', { class: 'marks', role: 'status' });
    place.bar = R.make('div', { class: 'edit-bar screen', role: 'toolbar', 'aria-label': 'Change the diagram' }, Desk.button('Add block (A)', add), Desk.button('Connect (C)', connect), Desk.button('Rename (R)', rename), Desk.button('Delete (Del)', remove), Desk.button('Group (G)', group), Desk.button('Undo', undo, { title: 'Take the last change back (Ctrl Z)' }), Desk.button('Redo', redo, { title: 'Make it again (Ctrl Y)' }), place.marks);
    bar.append(place.chips);
    bar.after(place.bar);
    place.task = R.make('div');
    place.done = R.make('div', { class: 'change', 'aria-live': 'polite' });
    place.column = R.make('div', { class: 'side-column' });
    side.replaceWith(place.column);
    place.column.append(place.task, place.done, side);
    // A click with Shift or Ctrl chooses one more.
    look().place.frame.addEventListener('click', (/** @type {MouseEvent} */ event) => {
      const name = pointed(event);
      if (!name) return;
      if (event.shiftKey || event.ctrlKey || event.metaKey) mark(name);
      else if (from && !(event.target instanceof Element && event.target.closest('.handle'))) meant(name);
      else return;
      event.stopPropagation();
      event.preventDefault();
    }, true);
  };

  /** @param {KeyboardEvent} event */
  const key = (event) => {
    const shown = !document.getElementById('diagram')?.hidden;
    if (event.defaultPrevented || !shown || !R.Diagram.has() || document.querySelector('dialog[open]')) return;
    const typing = event.target instanceof HTMLElement && event.target.matches('select, textarea, input');
    const letter = event.key.toLowerCase();
    const back = { z: event.shiftKey ? redo : undo, y: redo }[letter];
    if ((event.ctrlKey || event.metaKey) && back && !typing) { event.preventDefault(); back(); return; }
    if (event.key === 'Enter' && from && pointed(event)) { event.preventDefault(); event.stopPropagation(); meant(pointed(event) ?? ''); return; }
    if (event.key === 'Escape' && task) { event.preventDefault(); event.stopPropagation(); close(); return; }
    if (typing || event.ctrlKey || event.metaKey || event.altKey || !may()) return;
    /** @type {Record<string, () => void>} */ const does = { Delete: remove, F2: rename, ...(/** @type {any} */ (R).Keys.single() ? { a: add, c: connect, r: rename, g: group, x: () => { mark(block()); R.Diagram.choose(look().chosen, true); } } : {}) };
    const action = does[event.key] ?? does[letter];
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action();
  };
  document.addEventListener('keydown', key, true);
  R.onChosen.push(chosen);
  return { tell, undo, redo, marked: () => [...marked], begun: () => from };
})();
