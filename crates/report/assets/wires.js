// @ts-check
'use strict';
// What the wires of the diagram carry at the present time: numbers on them, and all of a bus where one looks at it.
/* global R */

R.Wires = (() => {
  const SVG = 'http://www.w3.org/2000/svg';
  /** Most elements that are told where one only looks. */
  const TOLD = 12;
  /** @type {(() => void)[]} */ let labels = [];
  /** @type {any} */ let tip = null;
  /** What brings the numbers of the tip up to date. @type {(() => void)|null} */ let fresh = null;

  /** Signals of a wire, each with its element: empty where it is alone. @param {any} level @param {number} net @returns {{element: string, signal: any}[]} */
  const on = (level, net) => (level.probes[net] ?? []).map((/** @type {[string, number, number]} */ [element, at, place]) => ({ element, signal: R.Signals.of(at, place) })).filter((/** @type {any} */ one) => one.signal);

  /** What is written on a wire: a number, or the first elements of a list; of a bus nothing. @param {{element: string, signal: any}[]} carried */
  const short = (carried) => {
    if (carried.length === 1 && !carried[0].element) return carried[0].signal.say();
    if (!carried.every(({ element }) => element.startsWith('['))) return '';
    const first = carried.slice(0, 3).map(({ signal }) => R.say(R.at(signal.time, signal.values, R.now, signal.held), 3));
    const unit = carried[0].signal.unit, more = carried.length > 3 ? `, … ${carried.length}` : '';
    return `[${first.join(', ')}${more}]${unit ? ' ' + unit : ''}`;
  };

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

  const hide = () => { if (tip) tip.hidden = true; fresh = null; };
  /** Shows what a wire carries beside it. @param {HTMLElement} frame @param {Element} group @param {string} title @param {{element: string, signal: any}[]} carried @param {{clientX: number, clientY: number}|null} mouse */
  const point = (frame, group, title, carried, mouse) => {
    tip ??= R.make('div', { class: 'tip', role: 'tooltip' });
    if (tip.parentNode !== document.body) document.body.append(tip);
    const values = carried.slice(0, TOLD).map(({ element, signal }) => ({ cell: R.make('td', { class: 'n' }), element, signal }));
    const more = carried.length - values.length;
    tip.replaceChildren(R.make('strong', {}, R.make('bdi', {}, title)), carried.length
      ? R.make('table', { 'aria-label': 'Values of the wire' }, R.make('tbody', {}, ...values.map(({ element, cell, signal }) => R.make('tr', {}, R.make('td', {}, element || signal.path), cell))))
      : R.make('p', {}, 'not recorded'), more > 0 ? R.make('p', {}, `and ${more} more: a click lists them`) : '');
    fresh = () => { for (const { cell, signal } of values) cell.textContent = signal.say(); };
    fresh();
    tip.hidden = false;
    const at = mouse ?? (() => { const box = group.getBoundingClientRect(); return { clientX: (box.left + box.right) / 2, clientY: box.bottom }; })();
    const { width, height } = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, Math.min(at.clientX + 14, innerWidth - width - 4))}px`;
    tip.style.top = `${at.clientY + 16 + height > innerHeight ? Math.max(4, at.clientY - height - 12) : at.clientY + 16}px`;
  };

  /** Makes the wires of a drawing easy to hit, and writes values on those that were recorded.
   * @param {SVGSVGElement} svg @param {HTMLElement} frame @param {any} level @param {any[]} nets @param {(net: number) => void} chosen */
  const dress = (svg, frame, level, nets, chosen) => {
    labels = [];
    hide();
    for (const group of svg.querySelectorAll('[data-net]')) {
      const at = Number(group.getAttribute('data-net')), path = group.querySelector('path');
      if (!path || !nets[at]) continue;
      const wide = /** @type {any} */ (path.cloneNode());
      wide.setAttribute('style', 'stroke: transparent; stroke-width: 9px; fill: none');
      // The page tells more than the title would, and at once.
      group.querySelector('title')?.remove();
      group.append(wide);
      group.setAttribute('tabindex', '-1');
      const carried = on(level, at), where = spot(path.getAttribute('d') ?? ''), [title, , directed] = nets[at];
      group.addEventListener('click', (event) => { event.stopPropagation(); hide(); chosen(at); });
      if (directed) {
        group.addEventListener('pointerenter', (event) => { if (/** @type {PointerEvent} */ (event).pointerType === 'mouse') point(frame, group, title, carried, /** @type {PointerEvent} */ (event)); });
        group.addEventListener('focus', () => { if (group.matches(':focus-visible')) point(frame, group, title, carried, null); });
        for (const event of ['pointerleave', 'blur']) group.addEventListener(event, hide);
      }
      group.setAttribute('role', 'button');
      group.setAttribute('aria-label', `${directed ? 'signal' : 'connection'} ${title}`);
      group.classList.toggle('recorded', carried.length > 0);
      if (!carried.length || !where || !short(carried)) continue;
      const text = document.createElementNS(SVG, 'text');
      text.setAttribute('class', 'value');
      text.setAttribute('x', String(where.x));
      text.setAttribute('y', String(where.y));
      group.append(text);
      labels.push(() => { text.textContent = short(carried); });
    }
  };

  /** @param {boolean} written Whether values stand on the wires. */
  const tell = (written) => {
    if (written) for (const one of labels) one();
    fresh?.();
  };
  return { on, short, dress, tell, hide };
})();
