// Programs, textures and buffers of WebGL2.

/** @param {WebGL2RenderingContext} gl @param {{ vertex: string, fragment: string }} sources */
export function program(gl, sources) {
  const made = gl.createProgram();
  for (const [kind, source] of /** @type {[number, string][]} */ ([
    [gl.VERTEX_SHADER, sources.vertex],
    [gl.FRAGMENT_SHADER, sources.fragment],
  ])) {
    const shader = gl.createShader(kind);
    if (!shader) throw new Error('The cell cannot be drawn: the graphics context is lost.');
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
      throw new Error(`The cell cannot be drawn: ${gl.getShaderInfoLog(shader)}`);
    }
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  const known = new Map();
  const at = (/** @type {string} */ name) => {
    if (!known.has(name)) known.set(name, gl.getUniformLocation(made, name));
    return known.get(name);
  };
  return { program: made, at };
}

/** @param {WebGL2RenderingContext} gl @param {number} filter */
export function texture(gl, filter) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_2D, side, filter);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
    gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
  return made;
}

/** @param {WebGL2RenderingContext} gl @param {number} size pixels of a side */
export function shadowMap(gl, size) {
  const made = texture(gl, gl.LINEAR);
  gl.texImage2D(
    gl.TEXTURE_2D,
    0,
    gl.DEPTH_COMPONENT24,
    size,
    size,
    0,
    gl.DEPTH_COMPONENT,
    gl.UNSIGNED_INT,
    null,
  );
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
  return made;
}

/**
 * @param {WebGL2RenderingContext} gl
 * @param {number} place
 * @param {number} size
 * @param {number} type
 * @param {ArrayBufferView} data
 */
export function attribute(gl, place, size, type, data) {
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, /** @type {ArrayBufferView<ArrayBuffer>} */ (data), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(place);
  if (type === gl.UNSIGNED_SHORT) gl.vertexAttribIPointer(place, size, type, 0, 0);
  else gl.vertexAttribPointer(place, size, type, type !== gl.FLOAT, 0, 0);
}

/**
 * @template {Float32Array | Uint32Array | Uint8Array} A
 * @param {new (size: number) => A} Kind
 * @param {A[]} parts
 * @returns {A}
 */
export function joined(Kind, parts) {
  const out = new Kind(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

/** For each vertex the number of its body. @param {number[]} counts */
export function numbers(counts) {
  return Uint16Array.from(counts.flatMap((count, body) => Array(count).fill(body)));
}
