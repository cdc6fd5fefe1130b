// @ts-check
'use strict';
// The text of the model beside its picture: lines with numbers, problems where they are, completion, saving; nothing typed is lost.
/* global R */

/** @type {any} */ (R).Text = (() => {
  const { Desk, Project } = /** @type {any} */ (R);
  /** How long somebody has to pause until the text is checked, and until completions are asked for, ms. */
  const PAUSE = 160, SOON = 60;
  /** Most completions that are listed. */
  const LISTED = 60;
  /** @typedef {{base: string, text: string, tokens: [number, number, string][], problems: any[], theirs: string|null, difference: string}} Draft */
  /** @type {Map<string, Draft>} What is known of the files that were opened. */ const drafts = new Map();
  let file = '', shown = false, count = 0, asked = 0, line = 0;
  /** @type {any[]} */ let items = [];
  let chosen = 0, begun = 0;
  /** @type {any} */ let timer = 0;
  /** @type {any} */ let soon = 0;
  /** @type {Record<'pane'|'area'|'colours'|'gutter'|'files'|'state'|'save'|'list'|'problems'|'conflict'|'toggle'|'revert', any>} */
  const place = { pane: null, area: null, colours: null, gutter: null, files: null, state: null, save: null, list: null, problems: null, conflict: null, toggle: null, revert: null };
  const may = () => Project.known()?.edit === true;
  const plain = (/** @type {string} */ text) => text.replaceAll('\r\n', '\n');
  const draft = () => /** @type {Draft} */ (drafts.get(file));
  const dirty = (/** @type {Draft|undefined} */ one) => one !== undefined && one.text !== plain(one.base);

  /** Marks what the drawing of the text is made of: tokens and places of problems. */
  const paint = () => {
    const { text, tokens, problems } = draft();
    const marks = problems.filter((problem) => problem.at).map((problem) => [problem.at[0], Math.max(problem.at[1], problem.at[0] + 1), problem.severity]);
    const cuts = new Set([0, text.length]);
    for (const [start, long] of tokens) { cuts.add(start); cuts.add(start + long); }
    for (const [start, end] of marks) { cuts.add(start); cuts.add(end); }
    const all = [...cuts].filter((at) => at <= text.length).sort((a, b) => a - b);
    const made = document.createDocumentFragment();
    let token = 0;
    for (let n = 0; n + 1 < all.length; n++) {
      const [start, end] = [all[n], all[n + 1]];
      while (token < tokens.length && tokens[token][0] + tokens[token][1] <= start) token++;
      const kind = token < tokens.length && tokens[token][0] <= start ? tokens[token][2] : '';
      const wrong = marks.find(([from, to]) => from <= start && end <= to);
      const piece = text.slice(start, end);
      if (!kind && !wrong) { made.append(piece); continue; }
      made.append(R.make('span', { class: `${kind ? `t-${kind}` : ''}${wrong ? ` wrong ${wrong[2]}` : ''}` }, piece));
    }
    // A line feed at the end would not be drawn.
    place.colours.replaceChildren(made, '\n');
    const lines = text.split('\n').length, /** @type {Map<number, any>} */ at = new Map();
    for (const problem of problems) if (problem.at && !at.has(problem.line)) at.set(problem.line, problem);
    place.gutter.replaceChildren(...Array.from({ length: lines }, (_, n) => { const problem = at.get(n + 1); return R.make('div', problem ? { class: problem.severity, title: problem.message } : {}, `${problem ? { error: '✕ ', warning: '! ', note: 'i ' }[/** @type {'error'} */ (problem.severity)] : ''}${n + 1}`); }));
    place.gutter.children[line - 1]?.classList.add('here');
    follow();
  };
  const follow = () => { place.colours.scrollTop = place.gutter.scrollTop = place.area.scrollTop; place.colours.scrollLeft = place.area.scrollLeft; };

  /** Moves what is known of places along with a change of the text. @param {Draft} one @param {string} text */
  const move = (one, text) => {
    const old = one.text, most = Math.min(old.length, text.length);
    let head = 0, tail = 0;
    while (head < most && old[head] === text[head]) head++;
    while (tail < most - head && old[old.length - 1 - tail] === text[text.length - 1 - tail]) tail++;
    const end = old.length - tail, by = text.length - old.length;
    const to = (/** @type {number} */ at) => at <= head ? at : at >= end ? at + by : head;
    one.tokens = one.tokens.map(([start, long, kind]) => /** @type {[number, number, string]} */ ([to(start), to(start + long) - to(start), kind])).filter(([, long]) => long > 0);
    // What is typed within a text or a comment belongs to it.
    for (const token of one.tokens) if (token[0] < head && token[0] + token[1] === head && by > 0) token[1] += by;
    for (const problem of one.problems) if (problem.at) problem.at = [to(problem.at[0]), to(problem.at[1])];
    one.text = text;
  };

  const told = () => {
    const one = draft(), is = dirty(one);
    place.state.textContent = one.theirs !== null ? 'changed by others as well' : is ? 'not saved' : 'saved';
    place.state.classList.toggle('bad', one.theirs !== null);
    place.save.disabled = !is || !may();
    place.revert.hidden = !is;
    for (const option of place.files.options) option.textContent = `${option.value}${dirty(drafts.get(option.value)) ? ' •' : ''}`;
    place.conflict.hidden = one.theirs === null;
    if (one.theirs !== null) place.conflict.replaceChildren(R.make('p', {}, `${file} has been changed by others since it was read here. What you wrote is kept.`), R.make('div', { class: 'buttons' }, Desk.button('Take theirs', theirs), Desk.button('Replace it by mine', mine)), R.make('pre', { class: 'difference' }, one.difference));
    const here = one.problems, line = (/** @type {any} */ problem) => {
      const press = Desk.button(problem.at ? `line ${problem.line}` : `${problem.file ?? ''}${problem.line ? `:${problem.line}` : ''}`, () => problem.at ? go(problem.at[0], problem.at[1]) : problem.file && show(problem.file), { class: 'quiet' });
      return R.make('li', { class: problem.severity }, R.make('b', {}, problem.severity), ' ', press, ` ${problem.message}`, ...(problem.help ? [R.make('div', { class: 'note' }, problem.help)] : []),
        ...(problem.fix && may() ? [Desk.button('Fix', () => { place.area.focus(); place.area.setSelectionRange(...problem.fix.at); document.execCommand('insertText', false, problem.fix.new); }, { title: `Write ${problem.fix.new.trim() || 'nothing'} there` })] : []));
    };
    place.problems.replaceChildren(...here.map(line));
  };
  /** @param {number} start @param {number} end */
  const go = (start, end) => {
    place.area.focus();
    place.area.setSelectionRange(start, Math.max(start, end));
    reveal(start);
  };
  /** The height of a line, and the width of a letter. */
  const size = () => { const style = getComputedStyle(place.area), pen = document.createElement('canvas').getContext('2d'); if (pen) pen.font = style.font; return { high: parseFloat(style.lineHeight), wide: pen?.measureText('m').width ?? 8 }; };
  const reveal = (/** @type {number} */ at) => {
    const line = place.area.value.slice(0, at).split('\n').length - 1, { high } = size(), top = line * high;
    if (top < place.area.scrollTop || top > place.area.scrollTop + place.area.clientHeight - 2 * high) place.area.scrollTop = Math.max(0, top - place.area.clientHeight / 3);
  };

  /** Has the text checked. */
  const check = async () => {
    const mine = ++count, name = file, { text } = draft();
    try {
      const found = await Desk.ask('draft', { file: name, text });
      const one = drafts.get(name);
      if (mine !== count || !one || one.text !== text) return;
      [one.problems, one.tokens] = [found.problems, found.tokens];
      if (name === file) { paint(); told(); }
    } catch (error) { Desk.refuse(error); }
  };
  const typed = () => {
    move(draft(), place.area.value);
    paint();
    told();
    clearTimeout(timer);
    timer = setTimeout(check, PAUSE);
  };

  /** Opens a file. @param {string} [name] */
  const show = async (name) => {
    try {
      const read = await Desk.ask('text', { file: name ?? file });
      file = read.file;
      const known = drafts.get(file);
      if (known && dirty(known)) { if (read.text !== known.base) other(known, read.text); }
      else drafts.set(file, { base: read.text, text: plain(read.text), tokens: read.text === plain(read.text) ? read.tokens : [], problems: known?.problems ?? [], theirs: null, difference: '' });
      place.files.replaceChildren(...read.files.map((/** @type {string} */ one) => R.make('option', { value: one }, one)));
      place.files.value = file;
      fill();
      check();
    } catch (error) { Desk.refuse(error); }
  };
  /** Puts the text that is known where it is written. */
  const fill = () => {
    const { text } = draft(), at = place.area.selectionStart, top = place.area.scrollTop;
    if (place.area.value !== text) { place.area.value = text; place.area.setSelectionRange(Math.min(at, text.length), Math.min(at, text.length)); place.area.scrollTop = top; }
    place.area.setAttribute('aria-label', `Text of ${file}`);
    place.area.readOnly = !may();
    paint();
    told();
  };
  /** Others have changed the file. @param {Draft} one @param {string} text @param {string} [difference] */
  const other = (one, text, difference) => { if (text === one.base) return; one.theirs = text; one.difference = difference ?? ''; };
  const theirs = () => { const one = draft(); drafts.set(file, { ...one, base: one.theirs ?? one.base, text: plain(one.theirs ?? one.base), tokens: [], theirs: null, difference: '' }); fill(); check(); };
  const mine = () => { const one = draft(); one.base = one.theirs ?? one.base; one.theirs = null; save(); };

  const save = async () => {
    const one = draft(), name = file, sent = one.text;
    if (!may() || !dirty(one)) { Desk.say(may() ? `${file} is saved` : 'this page may not change files: start it with `blocksim studio --edit`', !may()); return; }
    try {
      const done = await Desk.ask('save', { file: name, base: one.base, text: sent });
      // Who typed on meanwhile has a draft on top of what was saved.
      [one.base, one.theirs, one.difference] = [done.text, null, ''];
      /** @type {any} */ (R).Edit.tell({ ...done, notes: [] });
    } catch (error) {
      const { why } = /** @type {any} */ (error);
      if (why?.theirs !== undefined) other(one, why.theirs, why.difference);
      Desk.refuse(error);
    }
    if (name === file) told();
  };
  /** The model has been read anew: a text that nobody has changed here is that of the file. */
  const renew = async () => {
    if (!shown || !file) return;
    try {
      const read = await Desk.ask('text', { file }), one = drafts.get(file);
      if (!one || read.text === one.base) return;
      if (dirty(one) && plain(read.text) !== one.text) {
        if (one.theirs === read.text) return;
        // The difference is told by whoever refuses to save; until then what is theirs is shown whole.
        other(one, read.text, read.text);
        told();
        Desk.say(`${file} has been changed by others; what you wrote is kept`, true);
        return;
      }
      drafts.set(file, { ...one, base: read.text, text: plain(read.text), tokens: read.tokens, theirs: null, difference: '' });
      fill();
      check();
    } catch { /* The file may be gone for a moment. */ }
  };

  /** What stands before the cursor that a completion goes on with. @param {any} item */
  const stem = (item) => {
    const before = place.area.value.slice(0, place.area.selectionStart);
    return (item && (item.kind === 'file' || item.kind === 'folder') ? /[^"/]*$/ : /\w*$/).exec(before)?.[0] ?? '';
  };
  const complete = async () => {
    const mine = ++asked, at = place.area.selectionStart;
    try {
      const all = await Desk.ask('complete', { file, text: place.area.value, at });
      if (mine !== asked || place.area.selectionStart !== at || document.activeElement !== place.area) return;
      const low = (/** @type {string} */ text) => text.toLowerCase(), fits = (/** @type {any} */ item) => low(item.label).includes(low(stem(item)));
      const first = (/** @type {any} */ item) => low(item.label).startsWith(low(stem(item))) ? 0 : 1;
      items = all.filter(fits).sort((/** @type {any} */ a, /** @type {any} */ b) => first(a) - first(b)).slice(0, LISTED);
      // What stands there already needs no list.
      if (items.length === 1 && items[0].label === stem(items[0])) items = [];
      chosen = 0;
      list();
    } catch { hide(); }
  };
  const list = () => {
    place.list.hidden = !items.length;
    if (!items.length) { place.area.removeAttribute('aria-activedescendant'); return; }
    place.list.replaceChildren(...items.map((item, n) => {
      const line = R.make('li', { role: 'option', id: `complete-${n}`, 'aria-selected': String(n === chosen) }, R.make('b', {}, item.label), ' ', R.make('span', { class: 'more' }, item.detail || item.doc.split('\n')[0].slice(0, 80)));
      line.addEventListener('mousedown', (/** @type {MouseEvent} */ event) => { event.preventDefault(); chosen = n; take(); });
      return line;
    }));
    place.list.children[chosen]?.scrollIntoView({ block: 'nearest' });
    place.area.setAttribute('aria-activedescendant', `complete-${chosen}`);
    const before = place.area.value.slice(0, place.area.selectionStart).split('\n'), { high, wide } = size();
    const left = 10 + wide * (before[before.length - 1].length - stem(items[0]).length) - place.area.scrollLeft, below = 6 + high * before.length - place.area.scrollTop;
    // Above the line where there is more room than below it.
    const tall = place.list.offsetHeight, top = below + tall > place.area.clientHeight && below > place.area.clientHeight / 2 ? Math.max(0, below - high - tall) : below;
    place.list.style.left = `${Math.max(0, Math.min(left, place.area.clientWidth - 260))}px`;
    place.list.style.top = `${top}px`;
  };
  const hide = () => { items = []; asked++; clearTimeout(soon); if (place.list) list(); };
  /** Writes the chosen completion; the first place to be filled in is selected. */
  const take = () => {
    const item = items[chosen];
    if (!item) return;
    const end = place.area.selectionStart, start = end - stem(item).length;
    let text = item.insert, hole = -1;
    // What stands behind the place already needs no brackets.
    if (place.area.value[end] === '(' && text.includes('(')) text = text.slice(0, text.indexOf('('));
    else if (item.places) { hole = text.search(/\$(?:\{\d+\}|\d+)/); text = text.replaceAll(/\$(?:\{\d+\}|\d+)/g, ''); }
    place.area.setSelectionRange(start, end);
    document.execCommand('insertText', false, text);
    if (hole >= 0) place.area.setSelectionRange(start + hole, start + hole);
    hide();
  };

  /** @param {KeyboardEvent} event */
  const key = (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[event.key], control = event.ctrlKey || event.metaKey;
    if (control && event.key.toLowerCase() === 's') { event.preventDefault(); save(); return; }
    if (control && event.key === ' ') { event.preventDefault(); complete(); return; }
    if (event.key === 'F8') { event.preventDefault(); next(event.shiftKey ? -1 : 1); return; }
    if (items.length && !control && !event.altKey) {
      if (by) { event.preventDefault(); chosen = Math.min(Math.max(chosen + by, 0), items.length - 1); list(); return; }
      if (event.key === 'Enter' || event.key === 'Tab') { event.preventDefault(); take(); return; }
      if (event.key === 'Escape') { event.preventDefault(); event.stopPropagation(); hide(); return; }
    }
    if (event.key === 'Escape') { event.stopPropagation(); look()?.focus(); return; }
    if (event.key === 'Enter' && !control && !event.shiftKey && may()) {
      // A new line begins as the one before, further in behind a bracket.
      const before = place.area.value.slice(0, place.area.selectionStart), line = before.slice(before.lastIndexOf('\n') + 1);
      event.preventDefault();
      document.execCommand('insertText', false, `\n${/^ */.exec(line)?.[0] ?? ''}${/[([{]\s*$/.test(line) ? '    ' : ''}`);
    }
  };
  /** The block that was looked at, to go back to. */
  const look = () => /** @type {any} */ (R.Diagram.now().nodes.get(R.Diagram.now().chosen));
  /** To the next problem, or the one before. @param {number} by */
  const next = (by) => {
    const all = draft().problems.filter((problem) => problem.at).sort((a, b) => a.at[0] - b.at[0]), at = place.area.selectionStart;
    if (!all.length) { Desk.say('no problems in this text'); return; }
    const one = by > 0 ? all.find((problem) => problem.at[0] > at) ?? all[0] : all.findLast((problem) => problem.at[0] < at) ?? all[all.length - 1];
    go(one.at[0], one.at[1]);
    Desk.say(`${one.severity}, line ${one.line}: ${one.message}`, one.severity === 'error');
  };
  const input = (/** @type {any} */ event) => {
    typed();
    clearTimeout(soon);
    const sign = event.data ?? '';
    if (/[\w".(/ ]$/.test(sign) || items.length) soon = setTimeout(complete, SOON); else hide();
  };

  /** The line of the block that is looked at. @param {'level'|'block'|'wire'} what */
  const beside = (what) => {
    const parts = document.querySelector('#diagram-view .diagram-parts'), bar = document.querySelector('#diagram-view .diagram-bar');
    if (!place.toggle && bar && parts) {
      place.toggle = Desk.button('Text (T)', toggle, { 'aria-expanded': 'false', title: 'The text beside the picture (T)' });
      bar.append(place.toggle);
    }
    if (!shown || what !== 'block') return;
    const { level, chosen: n } = R.Diagram.now(), at = level.lines?.[level.blocks[n]?.[0]];
    if (!at) return;
    const here = () => {
      place.gutter.children[line - 1]?.classList.remove('here');
      line = at;
      place.gutter.children[line - 1]?.classList.add('here');
      if (document.activeElement !== place.area) reveal(place.area.value.split('\n', at - 1).join('\n').length);
    };
    const own = of(level);
    if (own && own !== file) show(own).then(here); else here();
  };
  /** The file of a level, if it is one of those that are listed. @param {any} level @returns {string|undefined} */
  const of = (level) => [...place.files.options].find((/** @type {any} */ option) => level.file === option.value || level.file?.endsWith(`/${option.value}`))?.value;
  const toggle = async () => {
    const parts = document.querySelector('#diagram-view .diagram-parts');
    if (!parts) return;
    if (!place.pane) build(parts);
    shown = !shown;
    place.pane.hidden = !shown;
    parts.classList.toggle('with-text', shown);
    place.toggle.setAttribute('aria-expanded', String(shown));
    if (!shown) { look()?.focus(); return; }
    const { level } = R.Diagram.now();
    await show(file);
    const own = of(level);
    if (own && own !== file) await show(own);
    beside('block');
    place.area.focus();
  };
  /** @param {Element} parts */
  const build = (parts) => {
    place.files = R.make('select', { 'aria-label': 'File' });
    place.files.addEventListener('change', () => show(place.files.value));
    place.state = R.make('span', { class: 'note', role: 'status' });
    place.save = Desk.button('Save (Ctrl S)', save, { class: 'main' });
    place.revert = Desk.button('Discard', () => { const one = draft(); drafts.set(file, { ...one, text: plain(one.base), tokens: [] }); fill(); check(); }, { title: 'Back to the text of the file' });
    place.area = R.make('textarea', { spellcheck: 'false', wrap: 'off', autocomplete: 'off', autocapitalize: 'off', 'aria-autocomplete': 'list', 'aria-controls': 'completions', 'aria-describedby': 'text-problems' });
    place.colours = R.make('pre', { class: 'colours', 'aria-hidden': 'true' });
    place.gutter = R.make('div', { class: 'gutter', 'aria-hidden': 'true' });
    place.list = R.make('ul', { role: 'listbox', id: 'completions', class: 'completions', 'aria-label': 'Completions', hidden: '' });
    place.problems = R.make('ul', { class: 'problems', id: 'text-problems' });
    place.conflict = R.make('div', { class: 'conflict', role: 'alert', hidden: '' });
    place.pane = R.make('section', { class: 'text-pane', 'aria-label': 'Text', hidden: '' }, R.make('div', { class: 'text-bar' }, place.files, place.save, place.revert, place.state), place.conflict, R.make('div', { class: 'text-frame' }, place.gutter, R.make('div', { class: 'text-lines' }, place.colours, place.area, place.list)), place.problems);
    parts.prepend(place.pane);
    place.area.addEventListener('input', input);
    place.area.addEventListener('keydown', key);
    place.area.addEventListener('scroll', () => { follow(); if (items.length) list(); });
    place.area.addEventListener('blur', hide);
    place.area.addEventListener('click', hide);
    window.addEventListener('beforeunload', (event) => { if ([...drafts.values()].some(dirty)) event.preventDefault(); });
  };
  document.addEventListener('keydown', (event) => {
    const typing = event.target instanceof HTMLElement && event.target.matches('select, textarea, input');
    if (event.defaultPrevented || typing || event.ctrlKey || event.metaKey || event.altKey || document.getElementById('diagram')?.hidden || !place.toggle || document.querySelector('dialog[open]')) return;
    if (event.key.toLowerCase() === 't' && /** @type {any} */ (R).Keys.single()) { event.preventDefault(); event.stopPropagation(); toggle(); }
  }, true);
  R.onChosen.push(beside);
  Desk.on('model', renew);
  return { toggle, show, dirty: () => [...drafts.entries()].filter(([, one]) => dirty(one)).map(([name]) => name) };
})();
