// @ts-check
'use strict';
// Plug-ins of the model: what they offer, how they are, and new ones.
/* global R */

/** @type {any} */ (R).Plugins = (() => {
  const { Desk, Project } = /** @type {any} */ (R);
  const LANGUAGES = [['rust', 'Rust'], ['c', 'C'], ['cpp', 'C++']];
  /** @type {any} */ const place = { list: null, made: null, name: null };

  /** A number of elements behind a name. @param {any} one */
  const sized = (one) => one.length === 1 ? one.name : `${one.name}[${one.length}]`;
  const code = (/** @type {string} */ text) => R.make('code', {}, text);
  /** @param {any} kind @param {any} plugin */
  const controller = (kind, plugin) => {
    const row = (/** @type {any} */ one, /** @type {string} */ side) => [code(sized(one)), side, one.unit || 'any', one.default?.join(', ') ?? '', R.make('bdi', {}, one.doc)];
    const all = [[kind.inputs, 'input'], [kind.outputs, 'output'], [kind.parameters, 'parameter'], [kind.continuous_states, 'continuous state'], [kind.discrete_states, 'sampled state']];
    const rows = all.flatMap(([list, side]) => list.map((/** @type {any} */ one) => row(one, side)));
    return R.make('section', { 'aria-label': kind.kind }, R.make('h3', {}, kind.kind), R.make('p', {}, R.make('bdi', {}, kind.doc.trim())), Desk.table(`Ports, parameters and states of ${kind.kind}`, ['name', '', 'unit', 'default', ''], rows),
      R.make('p', { class: 'note' }, code(`Plugin(library: ${JSON.stringify(plugin.path)}, block: ${JSON.stringify(kind.kind)})`), ' – the path as seen from the folder in which the studio was started'));
  };
  /** @param {any} told */
  const show = (told) => {
    const state = told.state ? [R.make('p', {}, R.make('span', { class: `state ${told.state}` }, `${Project.SIGNS[told.state]} ${told.state}`), ' ', R.make('bdi', {}, told.detail))] : [R.make('p', { class: 'note' }, 'The model has no plug-ins.')];
    const problems = told.problems.map((/** @type {any} */ one) => R.make('pre', { class: 'bad' }, [one.message, one.help].filter(Boolean).join('\n')));
    const plugins = told.plugins.flatMap((/** @type {any} */ one) => [R.make('h2', {}, `${one.name} ${one.version}`), ...one.kinds.map((/** @type {any} */ kind) => controller(kind, one))]);
    place.list.replaceChildren(...state, ...problems, ...plugins);
    place.form.hidden = !told.edit;
  };
  const make = async () => {
    try {
      const made = await Desk.ask('plugin', { name: place.name.value, language: place.language.value });
      place.made.replaceChildren(`The controller ${made.kind} is there: write its law in `, code(made.source), ', run it with ', code(made.demo), ', and put it into a diagram as ', code(made.call), '.');
      place.made.classList.remove('bad');
      Desk.say(`${made.source} is written`);
    } catch (error) {
      const { message, why } = /** @type {any} */ (error);
      place.made.replaceChildren([message, why?.help].filter(Boolean).join(' – '));
      place.made.classList.add('bad');
    }
  };
  const build = () => {
    place.list = R.make('div', {});
    place.name = R.make('input', { type: 'text', 'aria-label': 'Name of the plug-in', placeholder: 'my_controller', size: '20', spellcheck: 'false' });
    place.language = R.make('select', { 'aria-label': 'Language' }, ...LANGUAGES.map(([value, text]) => R.make('option', { value }, text)));
    place.made = R.make('p', { role: 'status' });
    place.name.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') make(); });
    place.form = R.make('div', { class: 'new-plugin' }, R.make('h2', {}, 'A new plug-in'), R.make('div', { class: 'tools' }, place.name, place.language, Desk.button('Make it', make)), place.made);
    document.getElementById('plugins-view')?.replaceChildren(place.list, place.form);
  };

  /** Sources may have changed though the model has not. */
  const renew = async () => {
    if (document.getElementById('plugins')?.hidden) return;
    if (!place.list) build();
    try { show(await Desk.ask('plugins')); } catch (error) { Desk.refuse(error); }
  };
  return { renew };
})();
