// @ts-check
'use strict';
// Draws meshes and lines: with WebGL, or as a wire frame on a 2D canvas.
/* global R */

R.Draw3d = (() => {
  const VERTEX = 'attribute vec3 p; attribute vec3 n; uniform mat4 view; uniform mat4 place; varying vec3 normal; void main() { normal = mat3(place) * n; gl_Position = view * place * vec4(p, 1.0); }';
  const FRAGMENT = 'precision mediump float; varying vec3 normal; uniform vec4 colour; uniform float lit; uniform vec3 sun; void main() { vec3 d = normalize(normal); float light = lit > 0.5 ? 0.42 + 0.16 * d.z + 0.48 * max(dot(d, sun), 0.0) : 1.0; gl_FragColor = vec4(colour.rgb * light, colour.a); }';

  /** Whether there is no graphics card: smooth edges would cost most of the time. */
  const isSlow = () => {
    const gl = document.createElement('canvas').getContext('webgl'), about = gl?.getExtension('WEBGL_debug_renderer_info');
    const name = gl ? String(gl.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : '';
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  };

  /** @param {HTMLCanvasElement} canvas */
  const webgl = (canvas) => {
    const gl = canvas.getContext('webgl', { antialias: !isSlow(), alpha: false });
    if (!gl) return null;
    const program = gl.createProgram();
    for (const [kind, text] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]])) {
      const shader = gl.createShader(kind);
      if (!shader || !program) return null;
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    if (!program) return null;
    gl.bindAttribLocation(program, 0, 'p');
    gl.bindAttribLocation(program, 1, 'n');
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
    gl.useProgram(program);
    const where = Object.fromEntries(['view', 'place', 'colour', 'lit', 'sun'].map((name) => [name, gl.getUniformLocation(program, name)]));
    const buffers = new WeakMap();
    /** @param {object} key @param {number[]|Float32Array} numbers */
    const buffer = (key, numbers) => {
      let found = buffers.get(key);
      if (!found) {
        found = gl.createBuffer();
        buffers.set(key, found);
        gl.bindBuffer(gl.ARRAY_BUFFER, found);
        gl.bufferData(gl.ARRAY_BUFFER, Float32Array.from(numbers), gl.STATIC_DRAW);
      }
      gl.bindBuffer(gl.ARRAY_BUFFER, found);
    };
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enableVertexAttribArray(0);
    return {
      name: 'WebGL',
      /** @param {ArrayLike<number>} view @param {number[]} sun Where the light comes from, of length one. @param {number[]} ground Colour behind everything. */
      begin(view, sun, ground) {
        gl.enable(gl.DEPTH_TEST);
        gl.uniform3fv(where.sun, sun);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(ground[0], ground[1], ground[2], 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.uniformMatrix4fv(where.view, false, Float32Array.from(view));
      },
      /** What follows shines through all that was drawn. */
      through() { gl.disable(gl.DEPTH_TEST); },
      /** Nothing will be drawn any more. */
      end() { gl.getExtension('WEBGL_lose_context')?.loseContext(); },
      /** @param {any} mesh Of one colour from all sides where it is `plain`. @param {ArrayLike<number>} place @param {number[]} colour */
      solid(mesh, place, colour) {
        const ghost = colour[3] < 1;
        if (ghost) gl.enable(gl.BLEND); else gl.disable(gl.BLEND);
        gl.depthMask(!ghost);
        buffer(mesh.triangles, mesh.triangles);
        gl.enableVertexAttribArray(1);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 24, 0);
        gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 24, 12);
        gl.uniformMatrix4fv(where.place, false, Float32Array.from(place));
        gl.uniform4fv(where.colour, colour);
        gl.uniform1f(where.lit, mesh.plain ? 0 : 1);
        gl.drawArrays(gl.TRIANGLES, 0, mesh.triangles.length / 6);
        gl.depthMask(true);
      },
      /** @param {number[]} lines @param {ArrayLike<number>} place @param {number[]} colour */
      lines(lines, place, colour) {
        gl.disable(gl.BLEND);
        buffer(lines, lines);
        gl.disableVertexAttribArray(1);
        gl.vertexAttrib3f(1, 0, 0, 1);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
        gl.uniformMatrix4fv(where.place, false, Float32Array.from(place));
        gl.uniform4fv(where.colour, colour);
        gl.uniform1f(where.lit, 0);
        gl.drawArrays(gl.LINES, 0, lines.length / 3);
      },
    };
  };

  /** @param {HTMLCanvasElement} canvas */
  const flat = (canvas) => {
    const context = canvas.getContext('2d');
    if (!context) return null;
    /** @type {ArrayLike<number>} */ let looking = [];
    /** @param {number[]} lines @param {ArrayLike<number>} place @param {number[]} colour @param {number} width */
    const stroke = (lines, place, colour, width) => {
      const m = R.Shapes.times(looking, place), [w, h] = [canvas.width / 2, canvas.height / 2];
      context.strokeStyle = `rgba(${colour.slice(0, 3).map((c) => Math.round(c * 255)).join(',')},${colour[3]})`;
      context.lineWidth = width * devicePixelRatio;
      context.beginPath();
      for (let n = 0; n + 5 < lines.length; n += 6) {
        for (let end = 0; end < 2; end++) {
          const p = lines.slice(n + 3 * end, n + 3 * end + 3);
          const deep = m[3] * p[0] + m[7] * p[1] + m[11] * p[2] + m[15];
          const x = w + w * (m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12]) / Math.max(deep, 1e-3);
          const y = h - h * (m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13]) / Math.max(deep, 1e-3);
          if (end) context.lineTo(x, y); else context.moveTo(x, y);
        }
      }
      context.stroke();
    };
    return {
      name: 'wire frame',
      /** @param {ArrayLike<number>} view */
      begin(view) { looking = view; context.clearRect(0, 0, canvas.width, canvas.height); },
      through() {},
      /** @param {any} mesh @param {ArrayLike<number>} place @param {number[]} colour */
      solid(mesh, place, colour) { stroke(mesh.lines, place, colour, 1); },
      /** @param {number[]} lines @param {ArrayLike<number>} place @param {number[]} colour */
      lines(lines, place, colour) { stroke(lines, place, colour, 1.5); },
    };
  };
  return { webgl, flat };
})();
