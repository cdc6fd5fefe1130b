// @ts-check
'use strict';
// The page's data: texts as JSON, numbers as one compressed block of bytes. All scripts share the object `R`.
const R = {
  /** @type {any} */ data: JSON.parse(document.getElementById('report-data')?.textContent || '{}'),
  /** @type {ArrayBuffer} */ bytes: new ArrayBuffer(0),
  /** Present time, s. */ now: 0,
  /** @type {[number|null, number|null]} Cursors A and B, s. */ cursors: [null, null],
  /** @type {((t: number) => void)[]} */ onTime: [],
  /** @type {(() => void)[]} */ onCursors: [],
  /** @type {(() => void)[]} What is shown has changed. */ onRange: [],
  /** @type {(() => void)[]} */ onTheme: [],
  /** @type {((what: 'level'|'block'|'wire') => void)[]} Something of the diagram is looked at. */ onChosen: [],
  /** @type {Record<string, string>} Colours that were asked for. */ colours: {},
  dark: matchMedia('(prefers-color-scheme: dark)'),
  /** @type {[number, number]} */ span: [0, 1],
  /** @type {any} */ Picture: null,
  /** @type {any} */ Plots: null,
  /** @type {any} */ Stretches: null,
  /** @type {any} */ Readings: null,
  /** @type {any} */ Overlay: null,
  /** @type {any} The 3D view. */ Space: null,
  /** Makes a 3D view, of which a page may have several. @type {any} */ view: null,
  /** @type {any} */ Shapes: null,
  /** @type {any} */ Meshes: null,
  /** @type {any} */ Draw3d: null,
  /** @type {any} Where the eye of the 3D view is. */ Camera: null,
  /** Makes an eye. @type {any} */ camera: null,
  /** @type {any} */ Recorder: null,
  /** @type {any} Colours of the path by speed. */ Speed: null,
  /** Arcs of torques. @type {any} */ efforts: null,
  /** Tables of a pose. @type {any} */ poseTable: null,
  /** @type {any} */ Signals: null,
  /** @type {any} */ Wires: null,
  /** @type {any} */ Diagram: null,
  /** @type {any} */ Tables: null,
  /** @type {any} */ Search: null,
  /** @type {any} */ Measure: null,
  /** Leads to where a parameter can be changed, if it can. @type {((name: string) => void)|null} */ change: null,
  /** Shows a block in the diagram by its path, if that can be done. @type {((path: string) => void)|null} */ showBlock: null,
  /** Records a signal and shows it over time, if that can be done. @type {((name: string) => void)|null} */ record: null,

  /** A list of numbers from the block. @param {[number, number, number]} where @returns {Float64Array} */
  list([at, count, width]) {
    const bytes = new Uint8Array(R.bytes, at, count * width), whole = new Uint8Array(count * width);
    for (let byte = 0; byte < width; byte++) {
      for (let n = 0, from = byte * count; n < count; n++) whole[n * width + byte] = bytes[from + n];
    }
    if (width === 2) return Float64Array.from(new Uint16Array(whole.buffer));
    return width === 8 ? new Float64Array(whole.buffer) : Float64Array.from(new Float32Array(whole.buffer));
  },

  /** Bytes of a compressed block of the page. @param {string} id @returns {Promise<ArrayBuffer|null>} */
  async unpack(id) {
    const place = document.getElementById(id);
    return place && R.inflate(place.textContent || '');
  },

  /** Bytes of a compressed block in base64. @param {string} packedText @returns {Promise<ArrayBuffer>} */
  async inflate(packedText) {
    const text = atob(packedText);
    const packed = new Uint8Array(text.length);
    for (let n = 0; n < text.length; n++) packed[n] = text.charCodeAt(n);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Response(stream).arrayBuffer();
  },

  /** @param {number} t */
  setTime(t) {
    R.now = Math.min(Math.max(t, R.span[0]), R.span[1]);
    for (const tell of R.onTime) tell(R.now);
  },

  /** @param {0|1} which @param {number|null} t */
  setCursor(which, t) {
    R.cursors[which] = t;
    for (const tell of R.onCursors) tell();
  },

  /** Value of a course at a time, straight between its points (or held); NaN outside.
   * @param {ArrayLike<number>} time @param {ArrayLike<number>} values @param {number} t @param {boolean} [held] */
  at(time, values, t, held) {
    let low = 0, high = time.length - 1;
    if (high < 0 || t < time[0] || t > time[high]) return NaN;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (time[middle] <= t) low = middle; else high = middle;
    }
    if (t >= time[high]) return values[high];
    const wide = time[high] - time[low];
    // At a point its value counts, whatever comes behind it.
    if (held || !(wide > 0) || t === time[low]) return values[low];
    return values[low] + (values[high] - values[low]) * (t - time[low]) / wide;
  },

  /** A number for people. @param {number} x @param {number} [digits] */
  say(x, digits = 5) {
    if (Number.isNaN(x)) return '–';
    if (!Number.isFinite(x)) return x > 0 ? '∞' : '−∞';
    if (x === 0) return '0';
    const size = Math.abs(x);
    if (size < 1e6 && size >= 1e-4) return String(Number(x.toPrecision(digits))).replace('-', '−');
    const [front, power] = x.toExponential(digits - 2).split('e');
    const raised = [...power.replace('+', '')].map((sign) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)] ?? '⁻').join('');
    return `${Number(front)}·10${raised}`.replace('-', '−');
  },

  /** A time for people, with as many digits as tell a thousandth of all times. @param {number} t */
  time(t) {
    const digits = Math.ceil(3 - Math.log10(R.span[1] - R.span[0]));
    return t.toFixed(Math.min(Math.max(digits, 3), 12)).replace('-', '−');
  },

  /** Rows of an angle that jumped by a whole turn to get there, because its scale has ends. The rule is that of the tables, in
   * `turns.rs` of blocksim-analysis: what remains of a jump less the turn is motion like that beside it; a step that is
   * requested leaves more. @param {ArrayLike<number>} time @param {ArrayLike<number>} values @param {number|null} turn @returns {number[]} */
  jumps(time, values, turn) {
    if (!turn) return [];
    const isLarge = (/** @type {number} */ size) => Math.abs(size) >= 0.75 && Math.abs(size) < 1.25;
    let some = false;
    for (let n = 0, before = NaN; n < values.length; n++) {
      if (!Number.isFinite(values[n])) continue;
      some ||= isLarge((values[n] - before) / turn);
      before = values[n];
    }
    if (!some) return [];
    // Rows of one value, and the changes from each to the next: how far, how long from row to row, and from beginning to beginning.
    /** @type {{ value: number, row: number, from: number, to: number }[]} */ const levels = [];
    for (let row = 0; row < values.length; row++) {
      const value = values[row] / turn, last = levels[levels.length - 1];
      if (!Number.isFinite(value)) continue;
      if (last && last.value === value) last.to = time[row]; else levels.push({ value, row, from: time[row], to: time[row] });
    }
    const changes = levels.slice(1).map((b, n) => {
      const a = levels[n], size = b.value - a.value;
      return { size, gap: b.from - a.to, hold: b.from - a.from, isLarge: isLarge(size) };
    });
    const least = 1e-9 * (levels[levels.length - 1].to - levels[0].from);
    /** What is beside a change: positions, the nearest first; none where a step is among them. @param {number} at */
    const beside = (at) => {
      /** @type {[number[], number[]]} */ const found = [[], []];
      for (const [side, way] of [[0, -1], [1, 1]]) {
        for (let n = at + way, seen = 0; n >= 0 && n < changes.length && seen < 8 && found[side].length < 4; n += way, seen++) {
          if (!changes[n].isLarge) found[side].push(n);
        }
      }
      return found.flat().every((n) => Math.abs(changes[n].size) < 0.25) ? found : null;
    };
    const isStair = (/** @type {{ gap: number, hold: number }} */ change) => change.gap < change.hold / 2;
    const isAlike = (/** @type {number} */ at, /** @type {number[][]} */ near) => {
      const own = changes[at];
      let [down, up] = [0, 0];
      for (const n of near.flat()) {
        const one = changes[n], row = one.gap > least ? own.gap / one.gap : 0;
        const far = one.size * Math.max(row, isStair(one) && isStair(own) && one.hold > least ? own.hold / one.hold : 0);
        [down, up] = [Math.min(down, far), Math.max(up, far)];
      }
      return Math.abs(1 - Math.abs(own.size)) <= 1.5 * (up - down) + 1e-6;
    };
    const movesOn = (/** @type {number} */ at) => {
      if (Math.abs(1 - Math.abs(changes[at].size)) <= 1e-3) return true;
      const near = beside(at);
      return near !== null && isAlike(at, near);
    };
    const goesRound = (/** @type {number} */ at) => {
      const near = beside(at);
      if (!near) return false;
      /** @type {number[]} */ const nearest = near.flatMap((side) => side.slice(0, 1));
      if (!nearest.length || !nearest.every((n) => changes[n].size * changes[at].size < 0)) return false;
      const before = near[0].length ? changes[near[0][0]].hold : 0, next = near[1][0];
      const behind = near[1].length ? (changes[next + 1] ?? changes[next]).hold : 0;
      const longest = 3 * Math.max(before, behind) + least;
      return !levels.slice(at, at + 2).some((level) => level.to - level.from > longest) && isAlike(at, near);
    };
    /** @type {number[]} */ const found = [];
    for (const [low, high] of [[-0.5, 0.5], [0, 1]]) {
      const within = (/** @type {number} */ n) => levels[n].value >= low - 1e-6 && levels[n].value <= high + 1e-6;
      const all = [...changes.keys()].filter((n) => changes[n].isLarge && within(n) && within(n + 1));
      // The scale is the same all the time: all of them are jumps, or none is.
      if (2 * all.filter(low < 0 ? movesOn : goesRound).length >= all.length) found.push(...all.map((n) => levels[n + 1].row));
    }
    return found.sort((a, b) => a - b);
  },

  /** A number with its unit, with the prefix that reads best: 733 µA for 0.000733 A. Digits that `off`, how far the
   * number may be off, makes meaningless are left away. @param {number} x @param {string} unit @param {number} [digits] @param {number} [off] */
  quantity(x, unit, digits = 4, off = 0) {
    if (off > 0 && Number.isFinite(x) && x !== 0) {
      const least = 10 ** Math.floor(Math.log10(off));
      digits = Math.max(1, Math.min(digits, Math.floor(Math.log10(Math.abs(x) / least)) + 1));
      if (Math.abs(x) < least) x = 0;
    }
    const size = Math.abs(x), own = /^([mµkMG]?)(A|V|W|N|m|Pa|J|H|F|Hz|C|T|Ω|Wb|s|rad|VA|var)(?![a-zA-Zµ²³⁴⁻])(.*)$/u.exec(unit);
    if (!own || !(size > 0) || !Number.isFinite(x) || (size >= 0.1 && size < 1e4)) return unit ? `${R.say(x, digits)} ${unit}` : R.say(x, digits);
    const [, prefix, base, rest] = own, steps = 'pnµm kMG', from = steps.indexOf(prefix || ' ');
    // Nobody says kiloseconds or kiloradians.
    const most = base === 's' || base === 'rad' ? 4 : 7;
    const to = Math.max(0, Math.min(Math.floor(Math.log10(size) / 3) + from, Math.max(most, from)));
    return `${R.say(x / 1000 ** (to - from), digits)} ${steps[to].trim()}${base}${rest}`;
  },

  /** A colour of the style sheet. @param {string} name */
  colour(name) {
    const root = document.documentElement, look = `${name} ${root.dataset.theme} ${root.className} ${R.dark.matches}`;
    return R.colours[look] ??= getComputedStyle(root).getPropertyValue('--' + name).trim();
  },

  /** @param {string} tag @param {Record<string, string>} [attributes] @param {(Node|string)[]} inside @returns {any} */
  make(tag, attributes = {}, ...inside) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...inside);
    return element;
  },

  /** A picture for those who do not see it: by its name. @param {any} u @param {string} name */
  named(u, name) {
    u.ctx.canvas.setAttribute('role', 'img');
    u.ctx.canvas.setAttribute('aria-label', name);
    u.root.querySelector('.u-legend')?.setAttribute('aria-label', `${name}, values`);
  },

  /** Runs a part of the page; where it fails the others go on. The message goes when the part can be shown again. @param {string} name @param {() => void} part */
  guarded(name, part) {
    const place = document.getElementById('trouble');
    for (const old of [...place?.children ?? []]) if (old.getAttribute('data-part') === name) old.remove();
    try {
      part();
    } catch (error) {
      place?.append(R.make('p', { class: 'warning', 'data-part': name }, `${name} cannot be shown: ${error instanceof Error ? error.message : error}`));
    }
  },
};
/** Measured times in ms, for tests of the page. */
/** @type {any} */ (window).__m = { started: performance.now() };
