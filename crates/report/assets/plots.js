// @ts-check
'use strict';
// All pictures: one range of time for all of them, and nothing is drawn that is out of sight.
/* global R */

R.Plots = (() => {
  /** @type {any[]} */ const panels = [];
  /** Numbers beside the pictures change no more often than can be read, ms. */
  const READ = 100;
  let told = 0, waiting = 0;
  /** @type {IntersectionObserver|null} */ let watch = null;
  /** Times that are shown. */
  /** @type {[number, number]} */ let range = [0, 1];

  const drawings = () => panels.flatMap((panel) => [panel.main, panel.strip].filter(Boolean));

  /** @param {any} panel */
  const scale = (panel) => {
    panel.stale = false;
    for (const u of [panel.main, panel.strip]) u?.setScale('x', { min: range[0], max: range[1] });
  };
  /** Shows a range of time in all pictures. @param {number} min @param {number} max */
  const show = (min, max) => {
    if (!(max > min)) return;
    range = [min, max];
    for (const tell of R.onRange) tell();
    for (const panel of panels) if (panel.seen) scale(panel); else panel.stale = true;
  };

  /** The range of a picture was changed by hand: the others follow. @param {number} min @param {number} max */
  const zoomed = (min, max) => { if (min !== range[0] || max !== range[1]) show(min, max); };

  /** Lays out and draws pictures, those of one group under one heading. @param {HTMLElement} place @param {any[]} all */
  const cards = (place, all) => {
    let group = null, box = place;
    // All cards are laid out before anything is drawn: a row that is not full yet is wider.
    /** @type {(() => void)[]} */ const draw = [];
    for (const panel of all) {
      if (panel.group !== group) {
        group = panel.group;
        if (group) place.append(R.make('h3', {}, group));
        box = R.make('div', { class: 'grid' });
        place.append(box);
      }
      draw.push(...R.Picture.lay(panel, box));
    }
    for (const one of draw) one();
  };

  const build = () => {
    const place = document.getElementById('plots');
    if (!place) return;
    let [begin, end] = [Infinity, -Infinity];
    for (const panel of R.data.panels) {
      panel.time = R.list(panel.time);
      for (const s of panel.series) if (s.values) s.values = R.list(s.values);
      for (const s of panel.series) if (s.other) s.other = R.list(s.other);
      for (const s of panel.series) {
        if (!s.error) continue;
        s.error = R.list(s.error);
        const set = panel.series[panel.pair[0]].values;
        s.values = s.error.map((/** @type {number} */ e, /** @type {number} */ n) => set[n] - e);
        // Where one of them has jumped by a turn already and the other has not, a turn is no error.
        if (panel.turn) s.error = s.error.map((/** @type {number} */ e) => e - panel.turn * Math.round(e / panel.turn));
      }
      panel.byOrder = [...panel.series];
      // Set values come last and so on top: dashes stay visible where both agree.
      const pair = panel.pair?.map((/** @type {number} */ at) => panel.series[at]);
      panel.series = [false, true].flatMap((last) => panel.series.filter((/** @type {any} */ s) => (s.role === 'set') === last));
      if (pair) panel.pair = pair.map((/** @type {any} */ s) => panel.series.indexOf(s));
      if (panel.time.length) {
        begin = Math.min(begin, panel.time[0]);
        end = Math.max(end, panel.time[panel.time.length - 1]);
      }
      panels.push(panel);
    }
    // Of a single instant the page shows a second.
    if (end >= begin) R.span = [begin, end > begin ? end : begin + 1];
    range = [...R.span];
    cards(place, panels);
    for (const panel of panels) panel.stale = panel.time[0] !== R.span[0] || panel.time[panel.time.length - 1] !== R.span[1];
    // What is out of sight is brought up to date when it comes into sight.
    watch = new IntersectionObserver((all) => {
      for (const one of all) {
        const panel = panels.find((candidate) => candidate.card === one.target);
        panel.seen = one.isIntersecting;
        for (const tell of R.onRange) tell();
        if (panel.seen) refresh(panel);
      }
    }, { rootMargin: '200px' });
    for (const panel of panels) watch.observe(panel.card);
    R.onTime.push(() => { for (const panel of panels) if (panel.seen) R.Picture.mark(panel); tell(); });
    R.onCursors.push(() => { for (const panel of panels) if (panel.seen) R.Picture.mark(panel); told = 0; tell(); });
    R.onTheme.push(redraw);
    let wait = 0;
    window.addEventListener('resize', () => { clearTimeout(wait); wait = setTimeout(fit, 80); });
    window.addEventListener('beforeprint', () => { for (const panel of panels) { if (panel.stale) scale(panel); R.Picture.mark(panel); for (const s of panel.series) s.tell(); } document.documentElement.classList.add('printing'); fit(); redraw(); });
    window.addEventListener('afterprint', () => { document.documentElement.classList.remove('printing'); fit(); redraw(); });
  };

  const refresh = (/** @type {any} */ panel) => { if (panel.stale) scale(panel); R.Picture.mark(panel); for (const s of panel.series) s.tell(); };
  const tell = () => {
    clearTimeout(waiting);
    const left = told + READ - performance.now();
    if (left > 0) { waiting = setTimeout(tell, left); return; }
    told = performance.now();
    for (const panel of panels) if (panel.seen) for (const s of panel.series) s.tell();
  };
  const redraw = () => { for (const u of drawings()) u.redraw(false, true); };
  const fit = () => {
    for (const u of drawings()) {
      const width = u.root.parentElement.clientWidth;
      const height = document.documentElement.classList.contains('printing') ? u.heights.paper : u.heights.screen;
      if (width > 0) u.setSize({ width, height });
    }
  };

  /** Widens or narrows the range around the present time. @param {number} factor */
  const zoom = (factor) => {
    const [min, max] = range;
    const centre = R.now > min && R.now < max ? R.now : (min + max) / 2;
    show(Math.max(R.span[0], centre - (centre - min) * factor), Math.min(R.span[1], centre + (max - centre) * factor));
  };
  /** Moves the range. @param {number} share */
  const pan = (share) => {
    const [min, max] = range;
    show(min + (max - min) * share, max + (max - min) * share);
  };
  /** Adds a picture that was asked for. @param {any} panel */
  const add = (panel) => {
    const place = document.getElementById('plots');
    if (!place) return;
    panel.byOrder = panel.series;
    const last = panels[panels.length - 1];
    if (last?.group !== panel.group) place.append(R.make('h3', {}, panel.group), R.make('div', { class: 'grid' }));
    panels.push(panel);
    R.data.panels.push(panel);
    for (const draw of R.Picture.lay(panel, /** @type {HTMLElement} */ (place.lastElementChild))) draw();
    panel.stale = true;
    watch?.observe(panel.card);
    for (const s of panel.series) s.tell();
  };
  /** Shows the picture of a signal. @param {string} path */
  const find = (path) => {
    const card = R.data.panels.find((/** @type {any} */ panel) => panel.series.some((/** @type {any} */ s) => s.path === path))?.card;
    card?.scrollIntoView({ block: 'center' });
    card?.focus({ preventScroll: true });
  };
  return { build, cards, add, panels, show, zoomed, range: () => range, zoom, pan, redraw, find, all: () => show(...R.span) };
})();
