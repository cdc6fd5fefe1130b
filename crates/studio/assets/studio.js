// @ts-check
'use strict';
// Puts the page together: one screen at a time, brought up to date by news.
/* global R */

(() => {
  const { Desk, Project, Panel, Live, Values, Motion, Runs, Sweep, Linear, Plugins, Keys } = /** @type {any} */ (R);
  let drawn = 0;
  /** @type {any} */ let texts = null;
  /** What the scopes of the model show of each wire, level by level. @type {any[]} */ let known = [];

  /** What stands in an address; as it is, where that means nothing. @param {string} text */
  const plain = (text) => { try { return decodeURIComponent(text); } catch { return text; } };

  /** The screen that the address names, and what stands behind it. */
  const asked = () => { const [screen, ...rest] = location.hash.slice(1).split('/'); return [document.getElementById(screen)?.matches('main > section') ? screen : 'project', plain(rest.join('/'))]; };

  const show = () => {
    const [screen, rest] = asked();
    for (const section of document.querySelectorAll('main > section')) /** @type {HTMLElement} */ (section).hidden = section.id !== screen;
    for (const link of document.querySelectorAll('#rail a')) if (link.getAttribute('href') === `#${screen}`) link.setAttribute('aria-current', 'page'); else link.removeAttribute('aria-current');
    if (screen === 'values') Values.renew();
    if (screen === 'runs') Runs.renew(rest);
    if (screen === 'run') { Live.span(); Live.fit(); }
    if (screen === 'motion') Motion.renew(Project.known()?.version ?? 0);
    if (screen === 'sweep') Sweep.renew(Project.known()?.version ?? 0);
    if (screen === 'linear') Linear.renew(Project.known()?.version ?? 0);
    if (screen === 'plugins') Plugins.renew();
    if (screen === 'diagram') { Live.span(); diagram(); }
    scrollTo(0, 0);
  };

  /** What the wires carry is told by the scopes of the run, where they show it; those of another model tell nothing of this one. */
  const probe = () => {
    /** @type {Map<string, [number, number]>} */ const places = new Map();
    if (Live.shows(texts.model)) R.data.panels.forEach((/** @type {any} */ panel, /** @type {number} */ at) => panel.byOrder?.forEach((/** @type {any} */ s, /** @type {number} */ n) => { if (!places.has(s.path)) places.set(s.path, [at, n]); }));
    texts.levels.forEach((/** @type {any} */ level, /** @type {number} */ n) => {
      level.probes = known[n].map((/** @type {any[]} */ probes, /** @type {number} */ at) => {
        const scoped = probes.flatMap(([element, panel, place]) => { const there = places.get(texts.panels[panel]?.[place]); return there ? [[element, ...there]] : []; });
        const name = level.signals[at];
        if (scoped.length || !name) return scoped;
        // What was asked for in this run alone.
        return [...places].filter(([path]) => path === name || path.startsWith(`${name}[`) || path.startsWith(`${name}.`)).map(([path, there]) => [path.slice(name.length), ...there]);
      });
    });
  };

  /** Draws the model, if it has changed since and somebody looks at it. @param {number} [version] Of the model as it is now. */
  const diagram = async (version = Project.known()?.version ?? 0) => {
    if (drawn === version || asked()[0] !== 'diagram') return;
    texts = await Desk.ask('diagram');
    if (!texts) return;
    drawn = version;
    const style = document.getElementById('drawing-style');
    if (style) style.textContent = texts.style;
    known = texts.levels.map((/** @type {any} */ level) => level.probes);
    probe();
    R.guarded('The diagram', () => {
      R.Signals.build(texts);
      if (R.Diagram.has()) R.Diagram.renew(texts); else R.Diagram.build(texts);
    });
    R.guarded('The search', () => R.Search.renew(texts));
    /** @type {any} */ (window).__m.drawn = performance.now();
  };

  /** @param {number} [version] Of the model, if that has changed: who looks at its picture sees that first. */
  const renew = async (version) => {
    try {
      if (version && R.Diagram.has()) await diagram(version);
      const told = await Desk.ask('project');
      Project.renew(told);
      Panel.renew(told.panel, told.path);
      Live.of(told.model, told.path, told.panel.length > 0);
      Live.renew(told.run);
      document.title = `${told.title} – blocksim`;
      await Live.catchUp();
      await diagram();
      const [screen, rest] = asked();
      if (screen === 'values') await Values.renew();
      if (screen === 'motion') await Motion.renew(told.version);
      if (screen === 'sweep') await Sweep.renew(told.version);
      if (screen === 'linear') await Linear.renew(told.version);
      if (screen === 'plugins') await Plugins.renew();
      if (screen === 'runs') await Runs.renew(rest);
      document.documentElement.dataset.ready = 'true';
    } catch (error) {
      Desk.refuse(error);
    }
  };

  // What is found in the diagram, or shown over time, stands on another screen.
  const onScreen = (/** @type {any} */ owner, /** @type {string} */ name, /** @type {string} */ screen) => {
    const does = owner[name];
    owner[name] = (/** @type {any[]} */ ...all) => { location.hash = `#${screen}`; show(); does(...all); };
  };
  onScreen(R.Diagram, 'show', 'diagram');
  onScreen(R.Plots, 'find', 'run');
  onScreen(Values, 'find', 'values');
  R.change = Values.find;
  /** @param {string} path */
  R.showBlock = async (path) => {
    location.hash = '#diagram';
    await diagram().catch(Desk.refuse);
    const parts = path.split('/');
    R.Diagram.show(parts.slice(0, -1).join('/'), parts[parts.length - 1]);
  };
  R.record = Live.record;
  Keys.build();
  Live.build();
  document.getElementById('models')?.addEventListener('change', (event) => {
    drawn = 0;
    Desk.ask('model', { model: /** @type {HTMLSelectElement} */ (event.target).value }).catch(Desk.refuse);
  });
  window.addEventListener('hashchange', show);
  // Whoever comes back, or was away for a while, asks for everything anew.
  Desk.on('open', () => { Live.again(); renew(); });
  Desk.on('scopes', () => { if (texts && R.Diagram.has()) R.guarded('The diagram', () => { probe(); R.Signals.build(texts); R.Diagram.renew(texts); }); });
  Desk.on('model', (/** @type {any} */ told) => renew(told.version));
  Desk.on('run', (/** @type {any} */ now) => { if (['done', 'stopped', 'failed'].includes(now.state)) renew(); });
  show();
  Desk.listen();
})();
