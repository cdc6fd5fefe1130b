// @ts-check
'use strict';
// How quick the page is here: `report.html#measure` tells it above everything else.
/* global R */

R.Measure = (() => {
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const said = (/** @type {number} */ x) => x.toFixed(1);

  /** Moves cursor A through all times and waits for nothing but the layout. @returns {{mean: number, worst: number}} ms */
  const drag = () => {
    const steps = 60, all = [];
    for (let n = 0; n < steps; n++) {
      const begin = performance.now();
      R.setCursor(0, R.span[0] + (R.span[1] - R.span[0]) * n / steps);
      document.body.getBoundingClientRect();
      all.push(performance.now() - begin);
    }
    R.setCursor(0, null);
    return { mean: all.reduce((a, b) => a + b, 0) / steps, worst: Math.max(...all) };
  };

  /** Plays for some seconds; frames in a second. @param {number} seconds */
  const play = async (seconds) => {
    // What has just come into sight is drawn first.
    for (let n = 0; n < 3; n++) await frame();
    const begin = performance.now();
    let frames = 0, now = begin;
    while (now - begin < 1000 * seconds) {
      R.setTime(R.span[0] + (R.span[1] - R.span[0]) * (now - begin) / 1000 / seconds);
      await frame();
      now = performance.now();
      frames++;
    }
    return frames / ((now - begin) / 1000);
  };

  const run = async () => {
    const m = /** @type {any} */ (window).__m, lines = [`${R.data.panels.length} pictures drawn after ${said(m.drawn - m.started)} ms, all ready after ${said(m.ready - m.started)} ms`];
    document.getElementById('scopes')?.scrollIntoView();
    await frame();
    await frame();
    const plain = drag();
    lines.push(`a move of a cursor: ${said(plain.mean)} ms, ${said(plain.worst)} ms at worst`);
    R.Readings.toggle();
    const table = drag();
    R.Readings.write();
    lines.push(`with the table open: ${said(table.mean)} ms, ${said(table.worst)} ms at worst; the table itself ${said(m.table_ms)} ms`);
    R.Readings.toggle();
    lines.push(`playing over the pictures: ${said(await play(2))} frames/s`);
    if (R.data.space) {
      document.getElementById('space')?.scrollIntoView();
      await frame();
      lines.push(`playing in 3D by ${m.space}: ${said(await play(3))} frames/s`);
    }
    R.setTime(R.span[0]);
    scrollTo(0, 0);
    m.measured = lines.join('\n');
    document.querySelector('main')?.prepend(R.make('pre', { class: 'warning' }, m.measured));
  };
  return { run };
})();
