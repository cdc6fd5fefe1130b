// @ts-check
'use strict';
// What the page asks the program, and the news that it hears from it.
/* global R */

/** @type {any} */ (R).Desk = (() => {
  /** @type {Record<string, ((data: any, id: number) => void)[]>} */ const readers = {};
  const lost = () => /** @type {HTMLElement} */ (document.getElementById('lost'));

  /** What the program answers; what it refuses is thrown, with its reason. @param {string} path @param {any} [body] */
  const ask = async (path, body) => {
    const how = body === undefined ? {} : { method: 'POST', headers: { 'Content-Type': 'application/json', 'X-Blocksim': '1' }, body: JSON.stringify(body) };
    const answer = await fetch(`/api/${path}`, how);
    const text = await answer.text();
    if (answer.ok) return text ? JSON.parse(text) : null;
    let why = null;
    try { why = JSON.parse(text).refused; } catch { why = { message: text }; }
    throw Object.assign(new Error(why?.message ?? 'the program refused'), { why });
  };

  /** Hears news of a name, with their number. @param {string} name @param {(data: any, id: number) => void} does */
  const on = (name, does) => { (readers[name] ??= []).push(does); };

  /** Begins to listen; whatever was missed is asked for anew when the program is there again. */
  const listen = () => {
    const all = (/** @type {string} */ name, /** @type {any} */ data, /** @type {number} */ id) => { for (const does of readers[name] ?? []) does(data, id); };
    /** @type {any} */ (R).Stream.begin({
      names: Object.keys(readers).filter((name) => name !== 'open'),
      news: all,
      here: (/** @type {boolean} */ missed) => { lost().hidden = true; if (missed) all('open', null, 0); },
      lost: () => { lost().hidden = false; },
    });
  };

  /** A line at the foot of the page, which is read out as well. @param {string} text @param {boolean} [bad] */
  const say = (text, bad) => {
    const place = document.getElementById('status');
    if (place) { place.textContent = text; place.classList.toggle('bad', bad === true); }
  };
  /** Says why something could not be done. @param {any} error */
  const refuse = (error) => say([error.message, error.why?.help].filter(Boolean).join(' – '), true);

  /** A button. @param {string} text @param {() => void} does @param {Record<string, string>} [attributes] */
  const button = (text, does, attributes) => {
    const made = R.make('button', { type: 'button', ...attributes }, text);
    made.addEventListener('click', does);
    return made;
  };
  /** A table. @param {string} name @param {string[]} head @param {(Node|string)[][]} rows */
  const table = (name, head, rows) => R.make('div', { class: 'wide' }, R.make('table', { 'aria-label': name }, R.make('thead', {}, R.make('tr', {}, ...head.map((name) => R.make('th', { scope: 'col' }, name)))),
    R.make('tbody', {}, ...rows.map((cells) => R.make('tr', {}, ...cells.map((cell) => R.make('td', {}, cell)))))));
  return { ask, on, listen, say, refuse, button, table };
})();
