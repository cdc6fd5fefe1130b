// @ts-check
'use strict';
// Puts the page together: one screen at a time, brought up to date by news.
/* global R */

(() => {
  const { Desk, Project, Live, Values, Motion, Runs, Keys } = /** @type {any} */ (R);
  let drawn = 0;

  /** The screen that the address names, and what stands behind it. */
  const asked = () => { const [screen, ...rest] = location.hash.slice(1).split('/'); return [document.getElementById(screen)?.matches('main > section') ? screen : 'project', decodeURIComponent(rest.join('/'))]; };

  const show = () => {
    const [screen, rest] = asked();
    for (const section of document.querySelectorAll('main > section')) /** @type {HTMLElement} */ (section).hidden = section.id !== screen;
    for (const link of document.querySelectorAll('#rail a')) if (link.getAttribute('href') === `#${screen}`) link.setAttribute('aria-current', 'page'); else link.removeAttribute('aria-current');
    if (screen === 'values') Values.renew();
    if (screen === 'runs') Runs.renew(rest);
    if (screen === 'run') { Live.span(); Live.fit(); }
    if (screen === 'motion') Motion.renew(Project.known()?.version ?? 0);
    if (screen === 'diagram') { Live.span(); diagram(); }
    scrollTo(0, 0);
  };

  /** Draws the model, if it has changed since and somebody looks at it. */
  const diagram = async () => {
    const version = Project.known()?.version ?? 0;
    if (drawn === version || asked()[0] !== 'diagram') return;
    const texts = await Desk.ask('diagram');
    if (!texts) return;
    drawn = version;
    const style = document.getElementById('drawing-style');
    if (style) style.textContent = texts.style;
    // What the wires carry is told by the scopes of a run, if it is of this model.
    const same = JSON.stringify(texts.panels) === JSON.stringify(R.data.panels.map((/** @type {any} */ panel) => panel.byOrder?.map((/** @type {any} */ s) => s.path) ?? []));
    if (!same) for (const level of texts.levels) level.probes = level.probes.map(() => []);
    R.guarded('The diagram', () => {
      R.Signals.build(texts);
      if (R.Diagram.has()) R.Diagram.renew(texts); else R.Diagram.build(texts);
    });
    R.guarded('The search', () => R.Search.renew(texts));
    /** @type {any} */ (window).__m.drawn = performance.now();
  };

  const renew = async () => {
    try {
      const told = await Desk.ask('project');
      Project.renew(told);
      Live.renew(told.run);
      document.title = `${told.title} – blocksim`;
      await Live.catchUp();
      await diagram();
      const [screen, rest] = asked();
      if (screen === 'values') await Values.renew();
      if (screen === 'motion') await Motion.renew(told.version);
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
  Keys.build();
  Live.build();
  document.getElementById('models')?.addEventListener('change', (event) => {
    drawn = 0;
    Desk.ask('model', { model: /** @type {HTMLSelectElement} */ (event.target).value }).catch(Desk.refuse);
  });
  window.addEventListener('hashchange', show);
  // Whoever comes back, or was away for a while, asks for everything anew.
  Desk.on('open', () => { Live.again(); renew(); });
  Desk.on('model', renew);
  Desk.on('run', (/** @type {any} */ now) => { if (['done', 'stopped', 'failed'].includes(now.state)) renew(); });
  show();
  Desk.listen();
})();
