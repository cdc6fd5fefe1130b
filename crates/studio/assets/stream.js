// @ts-check
'use strict';
// News of the program. A browser opens six connections to a server at most, and news need one all the time: so one of all tabs holds it
// and hands the news on. Which one is settled by a lock that the browser passes on when that tab is closed.
/* global R */

/** @type {any} */ (R).Stream = (() => {
  const NAME = 'blocksim-news';
  /** How long the tab that listens may take to answer, and how soon a connection that was refused is tried again, ms. */
  const ANSWER = 1500, AGAIN = 1000;
  /** @type {any} What to do with news. */ let owner = null;
  /** @type {EventSource|null} */ let source = null;
  /** Number of the last news, and which server counted them. */ let last = -1, since = '';
  let leads = false, waits = false, later = 0, asked = 0;
  /** Ends the wait for the lock. @type {AbortController|null} */ let turn = null;
  const shares = 'locks' in navigator && 'BroadcastChannel' in window;
  const channel = shares ? new BroadcastChannel(NAME) : null;

  /** Takes what the tab that listens has heard. @param {any} told */
  const take = (told) => {
    if (told.lost) { owner.lost(); return; }
    if (told.here !== undefined) {
      // Another tab may have been told less than this one.
      const missed = told.since !== since || told.here > last;
      if (missed) [last, since] = [told.here, told.since];
      owner.here(missed);
      return;
    }
    // Who does not know where the count stands will soon hear it.
    if (!since || told.id <= last) return;
    const missed = told.id > last + 1;
    last = told.id;
    if (missed) owner.here(true); else owner.news(told.name, JSON.parse(told.data), told.id);
  };
  /** Hands on and takes. @param {any} told */
  const tell = (told) => { channel?.postMessage(told); take(told); };

  /** Listens to the program. */
  const open = () => {
    clearTimeout(later);
    source?.close();
    const now = source = new EventSource('/api/news');
    now.addEventListener('here', (event) => tell({ here: Number(event.lastEventId), since: JSON.parse(event.data).since }));
    for (const name of owner.names) now.addEventListener(name, (event) => tell({ id: Number(event.lastEventId), name, data: event.data }));
    now.addEventListener('error', () => {
      tell({ lost: true });
      // After a refusal the browser does not try again.
      if (now.readyState === EventSource.CLOSED && now === source) later = setTimeout(open, AGAIN);
    });
  };
  /** Waits for the lock, or takes it from a tab that does not answer, as one that sleeps. @param {boolean} steal */
  const lead = (steal) => {
    turn?.abort();
    const own = turn = new AbortController();
    // A lock that is taken cannot be waited for as well.
    const how = steal ? { steal } : { signal: own.signal };
    // What this tab has asked for later counts alone: it may have taken the lock from itself, or it may be given one that it no longer waits for.
    const held = () => own === turn ? new Promise(() => { leads = true; open(); }) : null;
    navigator.locks.request(NAME, how, held).catch(() => {
      if (own !== turn) return;
      // Another tab has taken it.
      leads = false;
      clearTimeout(later);
      source?.close();
      source = null;
      lead(false);
    });
  };
  /** Whether the tab that listens still does; asked by those that somebody looks at. */
  const watch = () => {
    if (leads || document.hidden) { waits = false; return; }
    const now = performance.now();
    if (!waits) { [waits, asked] = [true, now]; channel?.postMessage({ ask: true }); } else if (now - asked >= ANSWER) { waits = false; lead(true); }
  };

  /** Begins. @param {{names: string[], news: (name: string, data: any, id: number) => void, here: (missed: boolean) => void, lost: () => void}} given */
  const begin = (given) => {
    owner = given;
    if (!channel) { leads = true; open(); return; }
    channel.addEventListener('message', ({ data: told }) => {
      if (!told.ask) { waits = false; take(told); return; }
      if (!leads || !source) return;
      if (source.readyState === EventSource.OPEN && since) channel.postMessage({ here: last, since });
      else if (source.readyState === EventSource.CLOSED) { channel.postMessage({ lost: true }); open(); } else channel.postMessage({ lost: true });
    });
    lead(false);
    channel.postMessage({ ask: true });
    setInterval(watch, ANSWER / 3);
    document.addEventListener('visibilitychange', watch);
  };
  return { begin, leads: () => leads };
})();
