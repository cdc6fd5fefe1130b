// @ts-check
'use strict';
// Records the 3D view as a film (WebM) while its time goes from one instant to another.
/* global R */

R.Recorder = (() => {
  /** VP8 first: it keeps up with the pictures where there is no graphics card. */
  const KINDS = ['video/webm;codecs=vp8', 'video/webm;codecs=vp9', 'video/webm'];
  /** Widest picture of a film, dots, and bits of each dot in a second. */
  const WIDEST = 1280, BITS = 8;
  /** A film without a picture for so long is given up, ms. */
  const STILL = 20000;
  /** How long the last picture stays, and how long the coder, which goes on beside the page, may take for what it has, ms. */
  const LAST = 300, LATE = 10000;
  /** Bytes that a film has at least when its first picture has been coded. */
  const FIRST = 1000;
  /** The next picture waits for the coder, which leaves out what comes too fast; how long at most, and how often it is asked, ms. */
  const CODED = 5000, ASKED = 10;
  /** @type {any} What goes on. */ let film = null;
  /** @type {any} */ const place = { line: null, from: null, to: null, speed: null, go: null, told: null };

  /** Why this browser cannot record; empty if it can. */
  const trouble = () => {
    if (typeof MediaRecorder === 'undefined' || !('captureStream' in HTMLCanvasElement.prototype)) return 'This browser cannot record films; Firefox, Chrome and Edge can.';
    return KINDS.some((kind) => MediaRecorder.isTypeSupported(kind)) ? '' : 'This browser cannot record films as WebM; Firefox, Chrome and Edge can.';
  };
  const told = (/** @type {string} */ text, bad = false) => { place.told.replaceChildren(text); place.told.classList.toggle('bad', bad); };
  /** An instant as typed, with a decimal comma or a point. @param {string} text */
  const instant = (text) => /^\s*\d*[.,]?\d+(e[+-]?\d+)?\s*s?\s*$/i.test(text) ? Number(text.replace('s', '').replace(',', '.')) : NaN;
  /** Times of the movement that can be seen. */
  const ends = () => { const time = R.data.space.time; return [Math.max(time[0], R.span[0]), Math.min(time[time.length - 1], R.span[1])]; };
  const name = (/** @type {number} */ from, /** @type {number} */ to) => {
    const title = document.title.replace(/ – blocksim$/, '').replace(/[^\p{L}\p{N}._-]+/gu, '_').slice(0, 60) || 'run';
    return `${title}_${R.say(from, 4)}s_to_${R.say(to, 4)}s.webm`;
  };

  const start = () => {
    if (film) { stop(); return; }
    const why = trouble();
    if (why) { told(why, true); return; }
    const [first, last] = ends(), from = instant(place.from.value), to = instant(place.to.value), speed = Number(place.speed.value);
    for (const [field, value] of [[place.from, from], [place.to, to]]) {
      const bad = Number.isNaN(value) ? `${field.value.trim() || 'nothing'} is not a time in s` : value < first - 1e-9 || value > last + 1e-9 ? `${R.say(value)} s is not between ${R.say(first)} s and ${R.say(last)} s` : '';
      field.toggleAttribute('aria-invalid', bad !== '');
      if (bad) { told(bad, true); field.focus(); return; }
    }
    if (!(to > from)) { told(`the film ends at ${R.say(to)} s, before it begins`, true); place.to.focus(); return; }
    const { canvas } = R.Space.stage(), scale = Math.min(1, WIDEST / Math.max(canvas.clientWidth, 1));
    const picture = /** @type {HTMLCanvasElement} */ (R.make('canvas'));
    // Coders want even numbers.
    [picture.width, picture.height] = [canvas.clientWidth, canvas.clientHeight].map((size) => 2 * Math.max(Math.round(size * scale / 2), 8));
    const pen = picture.getContext('2d');
    if (!pen) { told('This browser has no canvas to record.', true); return; }
    try {
      const stream = picture.captureStream(0), kind = KINDS.find((one) => MediaRecorder.isTypeSupported(one));
      const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: Math.min(BITS * picture.width * picture.height, 12e6) });
      /** @type {Blob[]} */ const parts = [];
      recorder.addEventListener('dataavailable', (event) => {
        if (event.data.size) { parts.push(event.data); next(); } else if (film?.wait) setTimeout(hurry, ASKED);
      });
      recorder.addEventListener('error', (event) => { film && (film.failed = /** @type {any} */ (event).error?.message ?? 'the recorder stopped'); stop(); });
      film = { recorder, track: stream.getVideoTracks()[0], picture, pen, parts, from, to, speed, frames: 0, begin: 0, failed: '', watch: 0, wait: 0 };
      recorder.addEventListener('stop', () => save());
      recorder.start(1000);
    } catch (error) {
      film = null;
      told(`The film cannot be recorded: ${error instanceof Error ? error.message : error}`, true);
      return;
    }
    place.go.textContent = '■ Stop';
    R.Space.hold(null);
    R.setTime(from);
    film.begin = performance.now();
    alive();
    R.Space.ask();
  };
  /** A film whose pictures do not come ends with those that it has. */
  const alive = () => {
    clearTimeout(film.watch);
    film.watch = setTimeout(() => { if (film && !document.hidden) { film.failed ||= `no picture came for ${STILL / 1000} s`; stop(); } else if (film) alive(); }, STILL);
  };
  /** A picture has been drawn. @param {HTMLCanvasElement} canvas */
  const frame = (canvas) => {
    if (!film || film.recorder.state !== 'recording') return;
    const { picture, pen, track, to } = film, dark = R.colour('text');
    pen.fillStyle = R.colour('raised');
    pen.fillRect(0, 0, picture.width, picture.height);
    pen.drawImage(canvas, 0, 0, picture.width, picture.height);
    pen.fillStyle = dark;
    pen.font = `${Math.max(12, Math.round(picture.height / 28))}px system-ui, sans-serif`;
    pen.fillText(`t = ${R.time(R.now)} s`, 10, picture.height - 10);
    track.requestFrame();
    film.frames++;
    alive();
    told(`${R.say(Math.min(R.now, to), 3)} of ${R.say(to, 3)} s …`);
    if (R.now >= to - 1e-9) { last(performance.now(), coded()); return; }
    clearTimeout(film.wait);
    film.wait = setTimeout(next, CODED);
    hurry();
  };
  /** Asks the coder for what it has. */
  const hurry = () => { if (film?.wait && film.recorder.state === 'recording') film.recorder.requestData(); };
  /** The time of the film goes on, unless it does already. */
  const next = () => {
    if (!film?.wait) return;
    clearTimeout(film.wait);
    film.wait = 0;
    requestAnimationFrame(() => {
      if (film?.recorder.state !== 'recording') return;
      R.setTime(Math.min(film.from + (performance.now() - film.begin) / 1000 * film.speed, film.to));
      R.Space.ask();
    });
  };
  /** Bytes of the film so far. */
  const coded = () => film.parts.reduce((/** @type {number} */ sum, /** @type {Blob} */ part) => sum + part.size, 0);
  /** Shows the last picture until the coder has it. @param {number} since @param {number} had Bytes of the film before it. */
  const last = (since, had) => {
    if (!film || film.recorder.state !== 'recording') return;
    clearTimeout(film.watch);
    // What has not been drawn on is not taken again.
    film.pen.drawImage(film.picture, 0, 0);
    film.track.requestFrame();
    film.recorder.requestData();
    const gone = performance.now() - since, size = coded();
    if (gone >= LATE || (gone >= LAST && size > had && size >= FIRST)) { stop(); return; }
    film.watch = setTimeout(() => last(since, had), 60);
  };
  const stop = () => {
    if (!film) return;
    clearTimeout(film.watch);
    place.go.textContent = '● Record';
    if (film.recorder.state !== 'inactive') film.recorder.stop(); else save();
  };
  /** Hands the film over as a file; the link stays, should the browser not take it. */
  const save = () => {
    if (!film) return;
    const { parts, frames, from, failed } = film, to = Math.min(R.now, film.to), blob = new Blob(parts, { type: 'video/webm' });
    film = null;
    if (!blob.size || !frames) { told(`Nothing was recorded: ${failed || 'the film was too short for this browser'}.`, true); return; }
    if (place.url) URL.revokeObjectURL(place.url);
    place.url = URL.createObjectURL(blob);
    const link = R.make('a', { href: place.url, download: name(from, to) }, name(from, to));
    told(failed ? `${failed}; what there is: ` : 'Saved as ', failed !== '');
    place.told.append(link, ` (${R.say(blob.size / 1000, 3)} kB, ${frames} pictures)`);
    Object.assign(/** @type {any} */ (window).__m, { film: blob, film_frames: frames });
    link.click();
  };

  /** @param {HTMLElement} bar Where the button stands. @param {HTMLElement} under Behind what its fields stand. */
  const build = (bar, under) => {
    const field = (/** @type {string} */ label) => R.make('input', { type: 'text', size: '7', 'aria-label': label, spellcheck: 'false', inputmode: 'decimal' });
    [place.from, place.to] = [field('Film from, s'), field('Film to, s')];
    place.speed = R.make('select', { 'aria-label': 'Speed of the film' }, ...[0.1, 0.25, 0.5, 1, 2, 5, 10].map((x) => R.make('option', { value: String(x) }, `${x}×`)));
    place.speed.value = '1';
    place.go = R.make('button', { type: 'button' }, '● Record');
    place.go.addEventListener('click', start);
    place.told = R.make('span', { class: 'note', role: 'status' });
    place.line = R.make('div', { class: 'film', hidden: '' }, R.make('label', {}, 'from ', place.from, ' s'), R.make('label', {}, 'to ', place.to, ' s'), R.make('label', {}, 'at ', place.speed), place.go, place.told);
    const open = R.make('button', { type: 'button', 'aria-expanded': 'false', title: 'Record the view as a film (WebM)' }, 'Film');
    open.addEventListener('click', () => {
      place.line.hidden = !place.line.hidden;
      open.setAttribute('aria-expanded', String(!place.line.hidden));
      if (place.line.hidden) { stop(); return; }
      const [first, last] = ends(), short = (/** @type {number} */ x) => String(Number(x.toPrecision(12)));
      // What was typed stays, as long as it can be meant.
      if (!place.from.value || !(instant(place.to.value) <= last)) [place.from.value, place.to.value] = [short(first), short(last)];
      told(trouble(), true);
      place.from.focus();
    });
    bar.append(open);
    under.after(place.line);
    // A page that nobody looks at draws nothing: the film waits.
    document.addEventListener('visibilitychange', () => {
      if (!film) return;
      if (document.hidden) { film.recorder.pause(); return; }
      film.recorder.resume();
      film.begin = performance.now() - (R.now - film.from) / film.speed * 1000;
      alive();
      R.Space.ask();
    });
  };
  return { build, frame, active: () => film !== null };
})();
