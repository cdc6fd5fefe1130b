// @ts-check
'use strict';
// From where one looks at the mechanism: standard views, by hand, and as near as shows everything.
/* global R */

R.camera = () => {
  /** Distance at which two metres fill the height, m. */
  const LENS = 2.4;
  /** Azimuth and elevation of the standard views. @type {Record<string, [number, number, string]>} */
  const VIEWS = { 1: [-0.65, 0.4, 'oblique'], 2: [0, 0, 'front'], 3: [Math.PI, 0, 'back'], 4: [Math.PI / 2, 0, 'left'], 5: [-Math.PI / 2, 0, 'right'], 6: [0, Math.PI / 2 - 1e-3, 'above'] };
  const view = { azimuth: VIEWS[1][0], elevation: VIEWS[1][1], distance: 4, target: [0, 0, 0.8] };

  /** Directions of who looks: to the right, up, and back to the eye. */
  const axes = () => {
    const [ca, sa, ce, se] = [Math.cos(view.azimuth), Math.sin(view.azimuth), Math.cos(view.elevation), Math.sin(view.elevation)];
    return { back: [ce * ca, ce * sa, se], right: [-sa, ca, 0], up: [-se * ca, -se * sa, ce] };
  };

  /** From metres of the world to the screen. @param {HTMLCanvasElement} canvas */
  const looking = (canvas) => {
    const { back, right, up } = axes(), { distance: d, target: t } = view;
    const dot = (/** @type {number[]} */ u) => u[0] * t[0] + u[1] * t[1] + u[2] * t[2];
    const eye = Float64Array.of(right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right), -dot(up), -dot(back) - d, 1);
    const near = d / 100, far = d * 10 + 20, wide = canvas.width / canvas.height;
    return R.Shapes.times(Float64Array.of(LENS / wide, 0, 0, 0, 0, LENS, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0), eye);
  };

  /** The light comes over the shoulder of who looks, so that no view is dark. */
  const sun = () => {
    const { back, right, up } = axes();
    return [0, 1, 2].map((k) => 0.72 * back[k] + 0.42 * up[k] - 0.55 * right[k]);
  };

  /** Goes as near as shows all points, with as much room on the left as on the right, above as below.
   * @param {number[][]} points @param {HTMLCanvasElement} canvas */
  const fit = (points, canvas) => {
    if (!points.length) return;
    const { right, up, back } = axes(), wide = canvas.clientWidth / canvas.clientHeight || 2;
    const dot = (/** @type {number[]} */ u, /** @type {number[]} */ p) => u.reduce((sum, x, k) => sum + x * (p[k] - view.target[k]), 0);
    const ends = (/** @type {number[]} */ all) => all.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);
    view.target = [0, 1, 2].map((k) => { const [low, high] = ends(points.map((p) => p[k])); return (low + high) / 2; });
    for (let turn = 0; turn < 4; turn++) {
      const far = points.map((p) => dot(back, p) + LENS * Math.max(Math.abs(dot(right, p)) / wide, Math.abs(dot(up, p))));
      view.distance = Math.max(1.06 * ends(far)[1], 0.05);
      // What is near looks larger: the middle of what is seen is not that of what is there.
      const off = [right, up].map((u) => { const [low, high] = ends(points.map((p) => dot(u, p) / (view.distance - dot(back, p)))); return (low + high) / 2 * view.distance; });
      view.target = view.target.map((x, k) => x + right[k] * off[0] + up[k] * off[1]);
    }
  };

  /** @param {string} number */
  const look = (number) => { [view.azimuth, view.elevation] = VIEWS[number]; };

  /** Drag turns, Shift and drag moves, the wheel goes nearer. @param {HTMLCanvasElement} canvas @param {() => void} ask Asks for a new picture. */
  const mouse = (canvas, ask) => {
    canvas.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
      canvas.setPointerCapture(event.pointerId);
      let [x, y] = [event.clientX, event.clientY];
      const move = (/** @type {PointerEvent} */ to) => {
        const [dx, dy] = [to.clientX - x, to.clientY - y];
        [x, y] = [to.clientX, to.clientY];
        if (event.shiftKey || event.button === 1) {
          const scale = view.distance / canvas.clientHeight * 0.85, [ca, sa] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
          view.target = [view.target[0] + sa * dx * scale, view.target[1] - ca * dx * scale, view.target[2] + dy * scale];
        } else {
          view.azimuth -= dx * 0.008;
          view.elevation = Math.min(Math.max(view.elevation + dy * 0.008, -1.55), 1.569);
        }
        ask();
      };
      canvas.addEventListener('pointermove', move);
      canvas.addEventListener('pointerup', () => canvas.removeEventListener('pointermove', move), { once: true });
    });
    canvas.addEventListener('wheel', (/** @type {WheelEvent} */ event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      view.distance *= Math.exp(event.deltaY * 0.001);
      ask();
    }, { passive: false });
  };

  return { VIEWS, looking, sun, fit, look, mouse };
};
R.Camera = R.camera();
