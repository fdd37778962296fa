// Programs for the graphics processor.
//
// All bodies are drawn in one call. A vertex carries the number of its body; a texture has six texels for
// each body:
// four columns of its matrix, its tint, and whether it is hidden, the floor, or casts no shadow.

/** Texels of a body. */
export const TEXELS = 6;

const BODY = `#version 300 es
precision highp float;
uniform sampler2D bodies;
vec4 texel(uint body, int at) { return texelFetch(bodies, ivec2(at, int(body)), 0); }
mat4 pose(uint body) { return mat4(texel(body, 0), texel(body, 1), texel(body, 2), texel(body, 3)); }
`;

/** Distance from the middle of the cell at which the floor fades into the background, metres. */
const FADE = `
float fade(vec3 place) { return clamp((length(place.xy - vec2(.4, -.6)) - 3.1) / 3.2, 0., 1.); }
`;

export const SURFACE = {
  vertex: `${BODY}
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 direction;
layout(location = 2) in vec3 tone;
layout(location = 3) in uint body;
uniform mat4 view, light;
out vec3 facing, colour, place;
out vec4 lit, tint;
flat out float floorLike;
void main() {
  mat4 matrix = pose(body);
  vec4 world = matrix * vec4(position, 1.);
  place = world.xyz;
  facing = mat3(matrix) * direction;
  colour = tone;
  lit = light * (world + vec4(normalize(facing) * .012, 0.));
  tint = texel(body, 4);
  vec4 kind = texel(body, 5);
  floorLike = kind.y;
  gl_Position = kind.x > .5 ? vec4(0., 0., 2., 1.) : view * world;
}`,
  fragment: `#version 300 es
precision highp float;
precision highp sampler2DShadow;
in vec3 facing, colour, place;
in vec4 lit, tint;
flat in float floorLike;
out vec4 pixel;
uniform sampler2DShadow shadows;
uniform vec3 sun, eye, background, sky, ground, floorColour;
uniform float exposure, sunlight;
${FADE}
float shadow() {
  vec3 at = lit.xyz / lit.w * .5 + .5;
  if (at.x < 0. || at.x > 1. || at.y < 0. || at.y > 1.) return 1.;
  float sum = 0.;
  for (int i = -1; i <= 1; i++) for (int j = -1; j <= 1; j++)
    sum += texture(shadows, vec3(at.xy + vec2(i, j) / 2048., at.z - .0011));
  return sum / 9.;
}
void main() {
  vec3 outward = normalize(facing), toEye = normalize(eye - place);
  if (dot(outward, toEye) < 0.) outward = -outward;
  vec3 base = pow(colour, vec3(2.2));
  if (floorLike > .5 && abs(colour.r - colour.b) < .12) base = floorColour;
  float direct = max(dot(outward, sun), 0.) * shadow();
  float gloss = pow(max(dot(outward, normalize(sun + toEye)), 0.), 48.) * .16 * direct;
  vec3 ambient = mix(ground, sky, outward.z * .5 + .5);
  vec3 shade = base * (ambient + vec3(1., .975, .94) * direct * sunlight) + gloss;
  float rim = pow(1. - max(dot(outward, toEye), 0.), 4.);
  shade += sky * rim * .10;
  shade = mix(shade, pow(tint.rgb, vec3(2.2)), tint.a * (.55 + .45 * rim));
  shade *= exposure;
  shade = pow(shade / (1. + shade * .22), vec3(1. / 2.2));
  float far = fade(place);
  pixel = vec4(mix(shade, background, far * far), 1.);
}`,
};

export const SHADOW = {
  vertex: `${BODY}
layout(location = 0) in vec3 position;
layout(location = 3) in uint body;
uniform mat4 light;
void main() {
  vec4 kind = texel(body, 5);
  gl_Position = kind.x > .5 || kind.z > .5 ? vec4(0., 0., 2., 1.) : light * pose(body) * vec4(position, 1.);
}`,
  fragment: `#version 300 es
precision mediump float;
out vec4 pixel;
void main() { pixel = vec4(1.); }`,
};

export const EDGES = {
  vertex: `${BODY}
layout(location = 0) in vec3 position;
layout(location = 3) in uint body;
uniform mat4 view;
out vec3 place;
void main() {
  vec4 world = pose(body) * vec4(position, 1.);
  place = world.xyz;
  vec4 kind = texel(body, 5);
  gl_Position = kind.x > .5 || kind.y > .5 ? vec4(0., 0., 2., 1.) : view * world;
  gl_Position.z -= .00006 * gl_Position.w;
}`,
  fragment: `#version 300 es
precision highp float;
in vec3 place;
out vec4 pixel;
uniform vec4 line;
${FADE}
void main() { pixel = vec4(line.rgb, line.a * (1. - fade(place))); }`,
};

/** Marks in the world: trail, rings, balls. */
export const MARKS = {
  vertex: `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 view;
void main() { gl_Position = view * vec4(position, 1.); }`,
  fragment: `#version 300 es
precision mediump float;
uniform vec4 colour;
out vec4 pixel;
void main() { pixel = colour; }`,
};

/** The background: one triangle over the whole picture. */
export const BACKDROP = {
  vertex: `#version 300 es
out float height;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3. : -1., gl_VertexID == 2 ? 3. : -1.);
  height = corner.y;
  gl_Position = vec4(corner, .9999, 1.);
}`,
  fragment: `#version 300 es
precision mediump float;
in float height;
uniform vec3 low, high;
out vec4 pixel;
void main() {
  float t = clamp((height - .1) / 1.3, 0., 1.);
  pixel = vec4(mix(low, high, t * (2. - t)), 1.);
}`,
};
