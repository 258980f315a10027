// Many straight lines in one draw call. Widths are in pixels; a line may have an arrowhead at its end, dashes, a shift
// to its left, so that two opposite arrows do not cover each other, and an age with which it fades.
import {BufferAttribute, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, ShaderMaterial, Vector2} from "/vendor/three/build/three.module.js";

const VERTEX = `
  attribute vec3 start, end;
  attribute vec4 tint;
  attribute vec3 form;  // width, shift to the left, length of dashes (px)
  attribute float born;
  uniform vec2 viewport;
  uniform float head, trim, radius, newest, lifetime;
  varying vec4 vTint;
  varying vec4 vForm;   // width, head, dash, length (px)
  varying vec2 vPlace;  // along, across (px)

  float trimmed(float w) { return max(trim, radius * projectionMatrix[1][1] * viewport.y * 0.5 / w); }

  void main() {
    const float near = 0.01;
    vec4 a = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
    vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
    float fade = lifetime > 0.0 ? clamp(1.0 - (newest - born) / lifetime, 0.0, 1.0) : 1.0;
    vTint = vec4(tint.rgb, tint.a * fade);
    if (vTint.a <= 0.0 || (a.w < near && b.w < near)) { gl_Position = vec4(0.0, 0.0, 2.0, 1.0); return; }
    if (a.w < near) a = mix(b, a, (b.w - near) / (b.w - a.w));
    if (b.w < near) b = mix(a, b, (a.w - near) / (a.w - b.w));
    vec2 from = a.xy / a.w * viewport * 0.5, to = b.xy / b.w * viewport * 0.5;
    float length_px = max(distance(from, to), 1e-3);
    vec2 along = (to - from) / length_px, across = vec2(-along.y, along.x);
    float cutFrom = trim > 0.0 ? min(trimmed(a.w), 0.4 * length_px) : 0.0;
    float cutTo = trim > 0.0 ? min(trimmed(b.w), 0.4 * length_px) : 0.0;
    length_px -= cutFrom + cutTo;
    float headNow = min(head, 0.7 * length_px), side = max(0.5 * form.x, 0.5 * headNow) + 1.0;
    vForm = vec4(form.x, headNow, form.z, length_px);
    vPlace = vec2(position.x * length_px, position.y * side);
    vec2 place = from + along * (cutFrom + vPlace.x) + across * (vPlace.y + form.y);
    // w = 1: what varies along the line varies evenly on the screen.
    gl_Position = vec4(place / (viewport * 0.5), mix(a.z / a.w, b.z / b.w, position.x), 1.0);
  }`;

const FRAGMENT = `
  precision highp float;
  varying vec4 vTint;
  varying vec4 vForm;
  varying vec2 vPlace;
  void main() {
    float left = vForm.w - vPlace.x;
    bool inHead = left < vForm.y;
    if (!inHead && vForm.z > 0.0 && mod(vPlace.x, 2.0 * vForm.z) > vForm.z) discard;
    float side = inHead ? 0.42 * left : 0.5 * vForm.x;
    float cover = clamp(side + 0.5 - abs(vPlace.y), 0.0, 1.0);
    if (cover * vTint.a < 0.004) discard;
    gl_FragColor = vec4(vTint.rgb, vTint.a * cover);
  }`;

const QUAD = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0]);
const viewport = new Vector2(1, 1);  // of all ribbons, in pixels of the screen

export const setViewport = (width, height) => viewport.set(width, height);

export class Ribbons extends Mesh {
  /**
   * `head`: length of arrowheads, `trim`: least distance from both ends (px); `lifetime`: how far a
   * line's birth is behind the newest when the line is gone, 0: lines do not fade.
   */
  constructor(capacity, {head = 0, trim = 0, lifetime = 0, order = 0} = {}) {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(QUAD, 3));
    for (const [name, size] of [["start", 3], ["end", 3], ["tint", 4], ["form", 3], ["born", 1]])
      geometry.setAttribute(
          name, new InstancedBufferAttribute(new Float32Array(size * capacity), size).setUsage(DynamicDrawUsage));
    geometry.maxInstancedCount = 0;
    const uniforms = Object.fromEntries(
        Object.entries({viewport, head, trim, radius: 0, newest: 0, lifetime}).map(([name, value]) => [name, {value}]));
    super(
        geometry,
        new ShaderMaterial(
            {vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, depthWrite: false}));
    Object.assign(this, {frustumCulled: false, renderOrder: order, capacity});
  }

  get count() { return this.geometry.maxInstancedCount; }
  set count(count) { this.geometry.maxInstancedCount = Math.min(count, this.capacity); }

  uniform(name, value) { this.material.uniforms[name].value = value; }

  /** From (x, y, z) at `a` of one array to that at `b` of another. */
  place(k, from, a, to, b) {
    const {start, end} = this.geometry.attributes;
    start.setXYZ(k, from[a], from[a + 1], from[a + 2]);
    end.setXYZ(k, to[b], to[b + 1], to[b + 2]);
  }

  paint(k, [red, green, blue], alpha) { this.geometry.attributes.tint.setXYZW(k, red, green, blue, alpha); }

  shape(k, width, shift = 0, dash = 0) { this.geometry.attributes.form.setXYZ(k, width, shift, dash); }

  /** Sends these attributes to the graphics card, all lines or `count` from `first` on. */
  send(names, first = 0, count = -1) {
    for (const name of names) {
      const attribute = this.geometry.attributes[name];
      if (count >= 0) attribute.updateRange = {offset: first * attribute.itemSize, count: count * attribute.itemSize};
      attribute.needsUpdate = true;
    }
  }

  dispose() {
    this.geometry.dispose();
    this.material.dispose();
  }
}
