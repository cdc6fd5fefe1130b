// @ts-check
'use strict';
// Keys, and light or dark.
/* global R */

/** @type {any} */ (R).Keys = (() => {
  const { Live, Panel, Futures, Values } = /** @type {any} */ (R);
  const KEYS = [
    ['F5', 'run the model'], ['Esc', 'end the run; what it has recorded is kept'], ['Space', 'pause and go on'], ['S', 'paused: to the next row'],
    ['A, C, R, Del, G', 'diagram: add a block, connect, rename, delete, group in a subsystem'], ['X', 'diagram: select one more block (also Shift and a click)'], ['T', 'diagram: the text beside the picture'], ['Ctrl S, F8, Ctrl Space', 'text: save, to the next problem, complete'],
    ['1 – 9', 'project, diagram, parameters, motion, run, results, sweep, linear analysis, plug-ins'], ['Ctrl Z', 'take the last change of a text back'],
    ['arrows', 'diagram: along the wires, where a block is chosen'], ['Enter, Backspace', 'diagram: into a block, one level up'], ['W', 'diagram: from wire to wire (Shift: back)'],
    ['P', 'to the panel of the model'], ['B', 'back to the instant that one looks at'], ['M', 'keep that instant in the list'], ['V', 'diagram: values on wires'], ['/', 'find a block, a signal, a parameter (also Ctrl K)'], ['D', 'light or dark'], ['?', 'this list'],
  ];
  const SCREENS = ['project', 'diagram', 'values', 'motion', 'run', 'runs', 'sweep', 'linear', 'plugins'];
  let single = true;

  const theme = () => {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    root.dataset.theme = dark ? 'light' : 'dark';
    try { localStorage.setItem('theme', root.dataset.theme); } catch { /* A browser that keeps nothing shows what the system prefers. */ }
    for (const tell of R.onTheme) tell();
  };
  const help = () => {
    const dialog = /** @type {HTMLDialogElement} */ (document.getElementById('keys'));
    if (dialog.open) { dialog.close(); return; }
    if (!dialog.firstChild) {
      const close = R.make('button', { type: 'button' }, 'Close (Esc)'), letters = R.make('input', { type: 'checkbox' });
      close.addEventListener('click', () => dialog.close());
      letters.checked = single;
      letters.addEventListener('change', () => { single = letters.checked; });
      dialog.append(R.make('h2', {}, 'Keys'), R.make('p', {}, R.make('label', {}, letters, ' single letters act as keys')), R.make('dl', {}, ...KEYS.flatMap(([key, does]) => [R.make('dt', {}, R.make('kbd', {}, key)), R.make('dd', {}, does)])), close);
    }
    dialog.showModal();
  };

  /** @param {KeyboardEvent} event */
  const key = (event) => {
    if (event.defaultPrevented || /** @type {HTMLDialogElement} */ (document.getElementById('keys')).open && event.key !== '?') return;
    const typing = event.target instanceof HTMLElement && event.target.matches('select, textarea, input');
    const letter = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (letter === 'z' && !typing) { event.preventDefault(); Values.undo(); }
      return;
    }
    /** @type {Record<string, () => void>} */
    const does = { F5: Live.start };
    if (!typing && !event.altKey) {
      Object.assign(does, { Escape: Live.end, Backspace: () => R.Diagram?.out() });
      if (single) Object.assign(does, { ' ': Live.pause, s: Live.step, d: theme, b: Futures.back, m: Futures.mark, p: () => { location.hash = '#run'; setTimeout(Panel.focus); }, '?': help, '/': () => R.Search?.open(), w: () => R.Diagram?.walk(event.shiftKey ? -1 : 1), v: () => R.Diagram?.keys.v() }, Object.fromEntries(SCREENS.map((screen, n) => [String(n + 1), () => { location.hash = `#${screen}`; }])));
    }
    const action = does[event.key] ?? does[letter];
    if (!action || (event.key === ' ' && event.target instanceof HTMLButtonElement)) return;
    event.preventDefault();
    action();
  };

  const build = () => {
    try { const kept = localStorage.getItem('theme'); if (kept === 'light' || kept === 'dark') document.documentElement.dataset.theme = kept; } catch { /* As above. */ }
    document.getElementById('theme')?.addEventListener('click', theme);
    document.getElementById('help')?.addEventListener('click', help);
    document.getElementById('start')?.addEventListener('click', Live.start);
    document.getElementById('end')?.addEventListener('click', Live.end);
    document.addEventListener('keydown', key);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { for (const tell of R.onTheme) tell(); });
  };
  return { build, single: () => single };
})();
